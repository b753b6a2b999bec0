# SPDX-License-Identifier: BSD-3-Clause
"""What is known at a stamp: joint values and transforms, between samples."""

import bisect

import numpy as np

from .common import Unknown, nanoseconds

KEPT = 30_000_000_000  # ns of samples that are kept
BACK = 2_000_000_000  # ns; a stamp that is older by more means a clock that was set back


class Track:
    """Samples of one thing, by stamp (ns): the pair around a stamp, never one that is farther than max_age seconds."""

    def __init__(self):
        self.stamps, self.values = [], []

    def add(self, stamp, value):
        stamps = self.stamps
        if stamps and stamp < stamps[-1] - BACK:  # what was known is of another time
            stamps.clear()
            self.values.clear()
        if not stamps or stamp > stamps[-1]:
            stamps.append(stamp)
            self.values.append(value)
        else:
            at = bisect.bisect_left(stamps, stamp)
            if stamps[at] == stamp:
                self.values[at] = value
            else:
                stamps.insert(at, stamp)
                self.values.insert(at, value)
        if len(stamps) > 256 and stamps[0] < stamps[-1] - 2 * KEPT:
            old = bisect.bisect_left(stamps, stamps[-1] - KEPT)
            del stamps[:old], self.values[:old]

    def covers(self, stamp):
        return bool(self.stamps) and self.stamps[-1] >= stamp

    def around(self, stamp, max_age, what):
        """(before, after, how far between them, 0 to 1); the same sample twice where only one is near enough."""
        if not self.stamps:
            raise Unknown(f"{what}: there is none")
        after = bisect.bisect_left(self.stamps, stamp)
        limit = max_age * 1e9
        if after < len(self.stamps) and self.stamps[after] == stamp:
            return self.values[after], self.values[after], 0.0
        old = stamp - self.stamps[after - 1] if after > 0 else np.inf
        new = self.stamps[after] - stamp if after < len(self.stamps) else np.inf
        if min(old, new) > limit:
            near, side = (old, "older") if old <= new else (new, "newer")
            raise Unknown(
                f"{what}: the nearest is {near / 1e9:.3g} s {side} than the frame (at most {max_age:g} s is allowed)"
            )
        if max(old, new) <= limit:
            return self.values[after - 1], self.values[after], old / (old + new)
        near = self.values[after - 1] if old < new else self.values[after]
        return near, near, 0.0


class JointSamples:
    """JointState messages, by joint: they may name some joints each."""

    def __init__(self):
        self.tracks = {}

    def add(self, message):
        """ValueError if positions and names do not agree."""
        names, positions = list(message.name), message.position
        if len(positions) == 0:
            return  # only velocities or efforts
        if len(names) != len(positions):
            raise ValueError(f"a JointState has {len(names)} names and {len(positions)} positions")
        stamp = nanoseconds(message.header.stamp)
        for name, position in zip(names, positions, strict=True):
            self.tracks.setdefault(name, Track()).add(stamp, float(position))

    def covers(self, names, stamp):
        return all(name in self.tracks and self.tracks[name].covers(stamp) for name in names)

    def at(self, name, stamp, max_age, turns=False):
        """A joint's value at a stamp, interpolated. turns: it has no limits, so it takes the shorter way round."""
        if name not in self.tracks:
            raise Unknown(f"no JointState names the joint {name!r}")
        before, after, part = self.tracks[name].around(stamp, max_age, f"JointState of {name!r}")
        step = after - before
        if turns:
            step = (step + np.pi) % (2 * np.pi) - np.pi
        value = before + part * step
        if not np.isfinite(value):
            raise Unknown(f"the joint {name!r} is at {value}")
        return value


class Transforms:
    """A tree of frames. Rigid poses are interpolated at a stamp; what is missing or too old is a sentence (Unknown)."""

    def __init__(self):
        self._tracks = {}
        self._fixed = {}
        self._refused = {}

    def add(self, message, static=False, keep=False):
        """A TFMessage. static: its transforms always hold. keep: those that are known already stay."""
        for each in message.transforms:
            parent, child = each.header.frame_id.lstrip("/"), each.child_frame_id.lstrip("/")
            t, q = each.transform.translation, each.transform.rotation
            at, turn = np.array([t.x, t.y, t.z], float), np.array([q.x, q.y, q.z, q.w], float)
            if why := self._unfit(parent, child, at, turn):
                self._refused[child] = f"a transform of {child!r} in {parent!r} was refused: {why}"
                continue
            length = np.linalg.norm(turn)
            self._refused.pop(child, None)
            if static:
                if not keep or child not in self._fixed:
                    self._fixed[child] = (parent, pose(at, turn / length))
            else:
                self._tracks.setdefault(child, Track()).add(nanoseconds(each.header.stamp), (parent, at, turn / length))

    @staticmethod
    def _unfit(parent, child, at, turn):
        """Why it is no transform; empty if it is."""
        if not parent or not child or parent == child:
            return "it does not name two frames"
        if not np.isfinite(at).all():
            return f"it is no rigid pose, because its translation is {', '.join(f'{x:g}' for x in at)}"
        if not abs(np.linalg.norm(turn) - 1) < 0.01:
            return f"it is no rigid pose, because its quaternion is {', '.join(f'{x:g}' for x in turn)}"
        return ""

    @property
    def refused(self):
        """A sentence for each frame whose last transform was refused."""
        return list(self._refused.values())

    @property
    def frames(self):
        """The names of all frames."""
        names = dict.fromkeys((*self._fixed, *self._tracks))
        names.update(dict.fromkeys(each[0] for each in self._fixed.values()))
        names.update(dict.fromkeys(track.values[-1][0] for track in self._tracks.values()))
        return list(names)

    def knows(self, frame):
        """Whether a transform names a frame."""
        frame = frame.lstrip("/")
        return frame in self._fixed or frame in self._tracks or frame in self.frames

    def _step(self, child, stamp, max_age):
        if child in self._fixed:
            return self._fixed[child]
        if child not in self._tracks:
            return None
        try:
            before, after, part = self._tracks[child].around(stamp, max_age, f"transform of {child!r}")
        except Unknown as error:
            raise Unknown(f"{error}; {self._refused[child]}" if child in self._refused else str(error)) from None
        if before[0] != after[0]:
            raise Unknown(
                f"the frame {child!r} changes its parent from {before[0]!r} to {after[0]!r} at the frame's time"
            )
        return before[0], pose(before[1] + part * (after[1] - before[1]), slerp(before[2], after[2], part))

    def at(self, target, source, stamp, max_age):
        """The pose of source in target, (4, 4), at a stamp (ns): target-from-source."""
        target, source = target.lstrip("/"), source.lstrip("/")
        if target == source:
            return np.eye(4)
        # Only what is between the two frames has to hold: so a stale transform above both is no matter.
        downs, ups = self._names_up(target, stamp), self._names_up(source, stamp)
        common = next((name for name in ups if name in downs), None)
        if common is None:
            why = next((self._refused[name] for name in (*ups, *downs) if name in self._refused), None)
            known = self.frames
            lost = next((name for name in (source, target) if name not in known), None)
            text = f"no transform names the frame {lost!r}" if lost else f"no transforms join {source!r} to {target!r}"
            raise Unknown(f"{text}; {why}" if why else text)
        found = self._pose_in(source, common, stamp, max_age)
        return found if common == target else inverse(self._pose_in(target, common, stamp, max_age)) @ found

    def _names_up(self, frame, stamp):
        names = [frame]
        while parent := self._parent(names[-1], stamp):
            if parent in names:
                raise Unknown(f"the frames form a ring at {parent!r}")
            names.append(parent)
        return names

    def _parent(self, child, stamp):
        if child in self._fixed:
            return self._fixed[child][0]
        track = self._tracks.get(child)
        if not track or not track.stamps:
            return None
        at = bisect.bisect_left(track.stamps, stamp)
        before, after = max(0, at - 1), min(at, len(track.stamps) - 1)
        return track.values[before if stamp - track.stamps[before] <= track.stamps[after] - stamp else after][0]

    def _pose_in(self, frame, above, stamp, max_age):
        at = np.eye(4)
        while frame != above:
            frame, step = self._step(frame, stamp, max_age)
            at = step @ at
        return at

    def covers(self, target, source, stamp):
        """Whether the transforms between two frames are known up to a stamp, so that none needs to be waited for."""
        target, source = target.lstrip("/"), source.lstrip("/")
        try:
            ups = [self._names_up(name, stamp) for name in (target, source)]
        except Unknown:
            return False
        if target != source and not set(ups[0]) & set(ups[1]):
            return False
        moving = set(ups[0]) ^ set(ups[1])
        return all(
            self._tracks[name].covers(stamp) for name in moving if name in self._tracks and name not in self._fixed
        )


def inverse(rigid):
    """Of a rigid pose."""
    back = np.eye(4)
    back[:3, :3] = rigid[:3, :3].T
    back[:3, 3] = -rigid[:3, :3].T @ rigid[:3, 3]
    return back


def pose(at, turn):
    """A (4, 4) matrix of a position and a unit quaternion x, y, z, w."""
    x, y, z, w = turn
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = at
    return matrix


def slerp(a, b, part):
    """Between two unit quaternions, along the shorter way."""
    if part == 0:
        return a
    cosine = float(a @ b)
    if cosine < 0:
        b, cosine = -b, -cosine
    if cosine > 1 - 1e-9:
        mixed = a + part * (b - a)
        return mixed / np.linalg.norm(mixed)
    angle = np.arccos(cosine)
    return (np.sin((1 - part) * angle) * a + np.sin(part * angle) * b) / np.sin(angle)
