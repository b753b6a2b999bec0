# SPDX-License-Identifier: BSD-3-Clause
"""A recording played past a robot: one row for each cloud or depth image, at the time of its stamp."""

from __future__ import annotations

import collections
import csv
import dataclasses
import json
import math
import os
import pathlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from . import _core, recordings, words
from .seeing import scenes
from .recordings import Damaged, Unknown, nanoseconds

WAIT = 1_000_000_000  # ns of recorded time that a frame waits for later joints and transforms


@dataclasses.dataclass(slots=True)
class Row:
    """What is known about one frame. Metres; points in the base frame.

    state: free, possible, collision, no_data (no valid point), or unknown (the frame could not be asked; note says
    why). With the last two lower is 0 and upper infinite, so that `row.lower < margin` stops.
    """

    stamp_ns: int | None  # nanoseconds; None: it has none
    topic: str
    frame: str
    state: str = "unknown"
    distance: float = math.nan
    lower: float = 0.0
    upper: float = math.inf
    link: str = ""
    point: int | None = None
    at: tuple[float, float, float] | None = None
    nearest: tuple[float, float, float] | None = None
    seen: int = 0
    valid: int = 0
    dropped: dict[str, int] = dataclasses.field(default_factory=dict)
    note: str = ""
    parts: dict[str, float] | None = None  # the distance to each part, if the question was MinDistancePerPart
    checked: float | None = None  # the distance by NumPy, if a check was asked for

    def say(self, sentence):
        """Adds a sentence to the note."""
        self.note += f"; {sentence}" if self.note else sentence

    @property
    def stamp(self):
        """Seconds: of today's stamps, a float knows a fraction of a microsecond."""
        return math.nan if self.stamp_ns is None else self.stamp_ns / 1e9


@dataclasses.dataclass(slots=True)
class Sight:
    """What a row is about: the robot's poses, what its sensor saw (arguments of Query), and the result."""

    robot: object
    poses: np.ndarray
    result: object
    seen: dict

    def scene(self, **what):
        """The seeing.Scene of it. what: as in seeing.scene, such as margin."""
        return scenes.compose(self.robot, scenes.Seen(**self.seen), self.poses, self.result, **what)


class Watch:
    """A robot, and what its sensors' messages say of it: take() the joints and transforms, then ask for a row()."""

    def __init__(
        self,
        robot,
        *,
        question=None,
        device="cpu",
        base_frame=None,
        max_age=0.1,
        joints=None,
        nearest=0.0,
        farthest=math.inf,
        zero_is_missing=False,
        cloud_scale=1.0,
        camera_info=None,
        crop=(),
        check=False,
        each=None,
        only=None,
    ):
        self.each, self.only = each, only
        self.robot = robot = the_robot(robot)
        self.question = _core.MinDistance() if question is None else question
        kinds = (_core.MinDistance, _core.MinDistancePerPart, _core.MinDistanceSupported)
        if not isinstance(self.question, kinds):
            raise ValueError(
                f"a row has one minimum, which {type(self.question).__name__} does not ask for "
                "(MinDistance, MinDistancePerPart and MinDistanceSupported do)"
            )
        if check and (robot.model != "spheres" or isinstance(self.question, _core.MinDistanceSupported)):
            raise ValueError("a check by NumPy needs a robot of spheres, and the nearest of all points")
        if check and crop:
            raise ValueError("a check by NumPy is about all points, and crop leaves some out")
        self.crop = crop
        self._obstacles(_core.points(np.zeros((0, 3), np.float32)))  # refuse what is no crop before a frame is read
        if not max_age >= 0:
            raise ValueError(f"max_age is {max_age} s; it is 0 or more")
        if not 1e-9 <= cloud_scale <= 1e9:
            raise ValueError(f"cloud_scale is {cloud_scale} metres per unit; it is from 1e-9 to 1e9")
        self.ask, self.device = _core.Query(robot, self.question, device), device
        self.ask_certain = None  # made when it is first needed
        self.base_frame, self.max_age, self.check = base_frame, max_age, check
        self.nearest, self.farthest, self.zero_is_missing = nearest, farthest, zero_is_missing
        self.cloud_scale, self.sized = cloud_scale, set()
        self.fixed, self.mimics = words.by_name(robot, joints or {}), robot.mimics
        if strange := sorted(set(self.fixed) - set(robot.joints) - set(self.mimics)):
            raise ValueError(f"the robot has no joint {strange[0]!r} (it has: {', '.join(robot.joints) or 'none'})")
        self.moving = [name for name in robot.joints if name not in self.fixed]
        self.turns = {
            name
            for name, (low, high) in zip(robot.joints, robot.limits, strict=True)
            if low == -math.inf and high == math.inf
        }
        for _ in self.mimics:  # what follows a wheel turns as it does
            self.turns |= {name for name, (other, *_) in self.mimics.items() if other in self.turns}
        try:  # without a URDF, transforms place the parts
            robot.poses(robot.rest)
            self.by_joints = True
        except ValueError:
            self.by_joints = False
        self.camera_info = camera_info
        self.cameras = recordings.Cameras()
        self.joints, self.transforms, self.infos = recordings.JointSamples(), recordings.Transforms(), {}
        self.notes = collections.Counter()

    def take(self, topic, kind, message, keep=False):
        """Takes a JointState, a TFMessage or a CameraInfo. keep: what is known already stays."""
        if kind == recordings.JOINTS:
            try:
                self.joints.add(message)
            except ValueError as error:
                self.notes[f"{topic}: {error}"] += 1
        elif kind in (recordings.TRANSFORMS, recordings.OLD_TRANSFORMS):
            self.transforms.add(message, static=topic.rsplit("/", 1)[-1] == "tf_static", keep=keep)
        elif kind == recordings.CAMERA and not (keep and topic in self.infos):
            self.infos[topic] = message

    def info_topic(self, topic):
        """The topic of an image's CameraInfo: camera_info says it, or it is the image's neighbour."""
        said = self.camera_info
        said = said.get(topic) if isinstance(said, dict) else said
        return said or recordings.lens_topic(topic).rsplit("/", 1)[0] + "/camera_info"

    def ready(self, topic, kind, message):
        """Whether all that a frame needs is known up to its stamp."""
        stamp = nanoseconds(message.header.stamp)
        if kind != recordings.CLOUD:
            info = self.infos.get(self.info_topic(topic))
            if info is None or nanoseconds(info.header.stamp) < stamp:
                return False
        if not self.by_joints:
            frame = self.base_frame or message.header.frame_id
            return all(
                self.transforms.covers(frame, name, stamp) for name in (*self.robot.parts, message.header.frame_id)
            )
        if not self.joints.covers((*self.moving, *self._measured_mimics()), stamp):
            return False
        try:
            base = self._base()
        except Unknown:
            return False
        frame = message.header.frame_id
        return self.transforms.covers(base, frame, stamp) or (
            not self.transforms.knows(frame) and self._own_link(frame)
        )

    def row(self, topic, kind, message):
        """The Row of a PointCloud2 or Image, with what is known now."""
        row = Row(nanoseconds(message.header.stamp), topic, message.header.frame_id)
        if self.only is not None and (row.stamp_ns, topic) not in self.only:
            row.note = "not asked"
            return row
        try:
            sight = self._ask(row, topic, kind, message)
        except ValueError as error:  # Unknown, or a message that cannot be
            sight = None
            row.note = str(error).removeprefix("clearance: ")
            for said in self.transforms.refused[:3]:
                if said not in row.note:
                    row.say(said)
            if self.notes:
                row.say(f"{sum(self.notes.values())} messages were refused before ({next(iter(self.notes))})")
        if sight and self.each:
            self.each(row, sight)
        return row

    def _judge_unit(self, row, kind, poses, seen):
        """Says where a unit is likely to be another one than metres."""
        hint = "(cloud_scale)" if kind == recordings.CLOUD else "(16UC1 is in millimetres, 32FC1 in metres)"
        if math.isfinite(row.distance) and row.distance > 50:
            row.say(f"no point is within 50 m of the robot: are they in metres? {hint}")
        if kind != recordings.CLOUD or row.topic in self.sized or row.valid < 2:
            return
        self.sized.add(row.topic)  # once: it takes as long as the answer
        robot = np.linalg.norm(np.ptp(poses[:, :3, 3], axis=0))
        local = scenes.as_points(seen["points"])
        local = local[np.isfinite(local).all(1)]
        cloud = np.linalg.norm(np.ptp(local, axis=0)) if len(local) else 0.0
        if cloud > 0 and robot > 100 * cloud:
            row.say(f"the robot is {robot / cloud:.3g} times as large as the cloud: what is its unit? {hint}")

    def _base(self):
        if self.base_frame is None:
            for name in self.transforms.frames:
                if self._stands_at_root(name):
                    self.base_frame = name
                    break
            else:
                raise Unknown("no transform names the robot's root link; say in which frame it stands (base_frame)")
        return self.base_frame

    def _stands_at_root(self, name):
        """Whether a link is the root or fixed to it without an offset: so it is in every configuration."""
        low, high = np.asarray(self.robot.limits, float).reshape(-1, 2).T
        bounded = np.isfinite(low) & np.isfinite(high)
        other = np.where(bounded, np.where(bounded, low, 0) * 0.63 + np.where(bounded, high, 0) * 0.37, 0.7)
        return self._own_link(name) and all(
            (self._link(name, at) == np.eye(4)).all() for at in (self.robot.rest, other)
        )

    def _own_link(self, name):
        try:
            self._link(name)
            return True
        except ValueError:
            return False

    def _link(self, name, joints=None):
        # Measured joints are facts, also where an encoder is beyond a limit.
        return self.robot.link_pose(name.lstrip("/"), self.robot.rest if joints is None else joints, ignore_limits=True)

    def _measured_mimics(self):
        """The joints that follow others by <mimic>, and are published or said all the same: that value wins."""
        return [name for name in self.mimics if name in self.fixed or name in self.joints.tracks]

    def _joints(self, row, stamp):
        """What robot.poses takes, of the joints at a stamp."""

        def value(name):
            if name in self.fixed:
                return self.fixed[name]
            return self.joints.at(name, stamp, self.max_age, name in self.turns)

        values = {name: value(name) for name in self.robot.joints}
        own = {name: value(name) for name in self._measured_mimics()}

        def followed(name):
            if name in values or name in own:
                return values.get(name, own.get(name))
            other, factor, offset = self.mimics[name]
            return factor * followed(other) + offset

        for name, measured in own.items():
            other, factor, offset = self.mimics[name]
            if abs(measured - (by_mimic := factor * followed(other) + offset)) > 1e-3:
                how = "given" if name in self.fixed else "published"
                row.say(f"{name} is at {measured:.4g} as {how}, not at {by_mimic:.4g} as <mimic> says")
        return values | own if own else np.array(list(values.values()), float)

    def _ask(self, row, topic, kind, message):
        stamp, frame = nanoseconds(message.header.stamp), message.header.frame_id
        short_by = None
        if kind == recordings.CLOUD:
            points = recordings.cloud(message)
            if self.cloud_scale != 1:
                points = scenes.as_points(points) * np.float64(self.cloud_scale)
        else:
            if kind == recordings.COMPRESSED:
                image, short_by = recordings.compressed_depth(message)
            else:
                image = recordings.depth(message)
            about = self.infos.get(self.info_topic(topic))
            if about is None:
                raise Unknown(f"no CameraInfo was seen on {self.info_topic(topic)}")
            rectified = "rect" in recordings.lens_topic(topic).rsplit("/", 1)[-1]
            lens = self.cameras.of(about, image.shape, rectified, topic)
        if self.by_joints:
            values = self._joints(row, stamp)
            where = self._camera_pose(frame, stamp, values)
            poses = self.robot.poses(values, ignore_limits=True)
        else:
            world = self.base_frame or frame
            where = self.transforms.at(world, frame, stamp, self.max_age)
            poses = np.stack([self.transforms.at(world, name, stamp, self.max_age) for name in self.robot.parts])
        limits = {"nearest": self.nearest, "farthest": self.farthest}
        if kind == recordings.CLOUD:
            cloud = self._obstacles(_core.points(points, where, zero_is_missing=self.zero_is_missing, **limits))
            seen = {"points": points, "cloud_pose": where}
        else:
            cloud = self._obstacles(_core.depth_image(image, pose=where, **lens, **limits))
            seen = {"depth": image, "camera_pose": where, **lens}
        result = self.ask(clouds=[cloud], poses=poses)
        self._write(row, result)
        self._judge_unit(row, kind, poses, seen)
        if short_by is not None:
            # Of depths that may be less, those that may be within `farthest` count.
            near = np.where(image - short_by > self.farthest, np.float32(np.nan), image)
            cloud = self._obstacles(_core.depth_image(near, pose=where, nearest=self.nearest, **lens))
            self._widen(row, cloud, poses, short_by * _lengths_of_rays(image.shape, **lens))
        if self.check:
            local = scenes.as_points(points) if kind == recordings.CLOUD else _seen_depth(image, lens)
            # The robot is put into the sensor's frame: it has fewer numbers than the points.
            row.checked = by_numpy(self.robot, recordings.inverse(where) @ poses, local, self._counting)
            if not agree(row):
                row.say(f"NumPy says {row.checked:.9g} m")
        return Sight(self.robot, poses, result, seen)

    def _obstacles(self, cloud):
        for each in self.crop:
            cloud = _core.cropped(cloud, **each)
        return cloud

    def _counting(self, local):
        """Those points, in the sensor's frame, that count."""
        local = local.astype(float)
        far = _lengths(local)
        near = (far >= self.nearest) & (far <= self.farthest) & np.isfinite(far)
        if self.zero_is_missing:
            near &= far > 0
        return local if near.all() else local[near]

    def _widen(self, row, cloud, poses, radii):
        """Widens a row's bracket by how far points may be from where they are: radii, one a pixel, metres."""
        if row.state == "no_data":
            return
        self.ask_certain = self.ask_certain or _core.Query(self.robot, _core.CertainDistance(), self.device)
        radii = np.nextafter(radii.astype(np.float32), np.float32(np.inf))
        certain = self.ask_certain(clouds=[_core.uncertain(cloud, radii)], poses=poses)
        row.lower = min(row.lower, float(certain.lower))
        if isinstance(self.question, _core.MinDistanceSupported):  # of other points than the nearest
            row.upper += float(radii.max())
            row.state = "possible" if row.state == "collision" else row.state
        else:
            row.upper = max(row.upper, float(certain.upper))
        if row.state != certain.state.name:
            row.state = "possible"

    def _camera_pose(self, frame, stamp, values):
        # Where no transform can place the sensor, its frame may be a link of the robot.
        if not self.transforms.knows(frame) and self._own_link(frame):
            return self._link(frame, values)
        return self.transforms.at(self._base(), frame, stamp, self.max_age)

    def _write(self, row, result):
        if hasattr(result, "all"):
            row.parts = dict(zip(self.robot.parts, map(float, result.parts["distance"]), strict=True))
            result = result.all
        counts = getattr(result, "counts", result)
        row.state, row.distance, row.lower = result.state.name, float(result.distance), float(result.lower)
        row.upper = float(getattr(result, "upper", result.distance))
        row.seen, row.valid = int(counts.seen), int(counts.valid)
        row.dropped = {name: int(count) for name, count in counts.dropped.items() if count}
        if result.point is not None:
            row.link, row.point = result.link, int(result.point)
            row.at, row.nearest = getattr(result, "at", None), getattr(result, "nearest", None)


def the_robot(recipe):
    """A Robot; or one read from a URDF file, or by Robot.from_urdf's arguments as a dict: what a worker can be told."""
    if isinstance(recipe, (str, os.PathLike)):
        recipe = {"file": os.fspath(recipe)}
    return _core.Robot.from_urdf(**recipe) if isinstance(recipe, dict) else recipe


def play(
    path: str | os.PathLike[str] | recordings.Messages,
    robot: _core.Robot | str | os.PathLike[str] | Mapping[str, Any],
    *,
    topics: Sequence[str] | None = None,
    question: _core.MinDistance | _core.MinDistancePerPart | _core.MinDistanceSupported | None = None,
    device: str = "cpu",
    base_frame: str | None = None,
    joint_topic: str | Sequence[str] | None = None,
    max_age: float = 0.1,
    check: bool = False,
    joints: Mapping[str, float] | Sequence[float] | None = None,
    tf_topics: Sequence[str] | None = None,
    camera_info: str | Mapping[str, str] | None = None,
    nearest: float = 0.0,
    farthest: float = math.inf,
    zero_is_missing: bool = False,
    cloud_scale: float = 1.0,
    crop: Sequence[Mapping[str, Any]] = (),
    each: Callable[[Row, Sight], object] | None = None,
    only: Collection[tuple[int | None, str]] | None = None,
) -> Played:
    """Gives a Row for each PointCloud2 and depth image of a recording: how far the robot was from what was seen.

    path: an MCAP file, a rosbag2 folder or database, or a ROS 1 bag; or recordings.Messages. It is read as rows are
    asked for.
    robot: a Robot; or the name of its URDF file, or a dict of Robot.from_urdf's arguments.
    topics: of clouds and images; all PointCloud2 and all Images and CompressedImages of 16UC1 or 32FC1, unless given.
    question: MinDistance(), MinDistancePerPart() or MinDistanceSupported(...).
    base_frame: the frame in which the robot's root link stands; the root link itself, unless given.
    joint_topic: of the JointStates; needed if there are several. joints: {name: value} of those that no JointState
    names, or the values of all. max_age: seconds. Joints and transforms are interpolated at a frame's stamp. What is farther from it is not
    used. camera_info: the topic of the CameraInfo, or {image's topic: topic}; `camera_info` beside the image, unless
    given. nearest, farthest: metres from the sensor between which points count. zero_is_missing: a point at the sensor
    is none. cloud_scale: metres per unit of the clouds. crop: arguments of cropped as dicts, such as [{"height": (0.1, 2)}],
    in the base frame. check: computes each distance again by NumPy, from the spheres; a row that differs says so in its note.
    each: is called with each row that was asked and its Sight, whose scene() can be drawn. only: {(stamp_ns, topic)} of
    the frames that are asked; the rows of others are "unknown".

    The rows are an iterator, whose `notes` name the topics of sensors that are not read, and what else was refused.
    A frame that cannot be asked (a transform is missing, say) has the state "unknown", and a note. A robot that has no
    URDF is placed by the transforms of frames that are named as its parts. Raises recordings.Damaged after the last
    whole frame of a damaged file.
    """
    watch = Watch(
        robot,
        question=question,
        device=device,
        base_frame=base_frame,
        max_age=max_age,
        joints=joints,
        nearest=nearest,
        farthest=farthest,
        zero_is_missing=zero_is_missing,
        cloud_scale=cloud_scale,
        camera_info=camera_info,
        crop=crop,
        check=check,
        each=each,
        only=only,
    )
    recording = path if isinstance(path, recordings.Messages) else recordings.Recording(path)
    try:
        frames, others = _chosen(recording, watch, topics, joint_topic, tf_topics)
    except ValueError as error:
        recording.close()
        if recording.damage:  # so what is missing may be what is lost
            raise Damaged(f"{recording.path}: {recording.damage}; {error}") from None
        raise
    return Played(recording, watch, frames, others, named=topics is not None)


def _chosen(recording, watch, topics, joint_topic, tf_topics):
    """The topics of frames and those of what they need."""
    of = recording.topics
    by_kind = collections.defaultdict(list)
    for topic, kind in sorted(of.items()):
        by_kind[kind].append(topic)
    read = [topic for topic in of if recordings.is_read(recording, topic)]
    has = f"{recording.path} has: {', '.join(_described(recording, t) for t in sorted(of)) or 'no topic'}"
    if topics is None:
        frames = [topic for kind in recordings.SEEING for topic in by_kind[kind] if topic in read]
    else:
        frames = [topics] if isinstance(topics, str) else list(topics)
        for topic in frames:
            if of.get(topic) not in recordings.SEEING:
                what = f"is a {of[topic]}, not a PointCloud2 or an Image" if topic in of else "is not in the recording"
                raise ValueError(f"the topic {topic} {what}; {has}")
            if topic not in read:
                raise ValueError(f"the topic {_described(recording, topic)} is in no encoding that is read; {has}")
    if not frames:
        raise ValueError(f"there is no PointCloud2 and no depth Image to play; {has}")
    if watch.cloud_scale != 1 and all(of[topic] != recordings.CLOUD for topic in frames):
        raise ValueError(f"cloud_scale is for PointCloud2s, and none of the topics that are played is one; {has}")
    others = []
    if watch.by_joints and watch.moving:
        named = [joint_topic] if isinstance(joint_topic, str) else list(joint_topic or by_kind[recordings.JOINTS])
        if joint_topic is None and len(named) > 1:
            named = ["/joint_states"] if "/joint_states" in named else named
            if len(named) > 1:
                raise ValueError(
                    f"there are several JointStates, so say which is the robot's (joint_topic): {', '.join(named)}"
                )
        for topic in named:
            if of.get(topic) != recordings.JOINTS:
                raise ValueError(f"the topic {topic} is no JointState of the recording; {has}")
        others += named
    trees = [tf_topics] if isinstance(tf_topics, str) else list(tf_topics or ())
    found = by_kind[recordings.TRANSFORMS] + by_kind[recordings.OLD_TRANSFORMS]
    for topic in trees:
        if topic not in found:
            raise ValueError(f"the topic {topic} is no TFMessage of the recording; {has}")
    if not trees:
        trees = [topic for topic in found if topic in ("/tf", "/tf_static")] or found
        if len({topic.rsplit("/", 1)[0] for topic in trees}) > 1:
            raise ValueError(f"there are several trees of transforms, so say which (tf_topics): {', '.join(trees)}")
    infos = {watch.info_topic(topic) for topic in frames if of[topic] != recordings.CLOUD}
    others += [*trees, *(topic for topic in sorted(infos) if of.get(topic) == recordings.CAMERA)]
    for topic in others:
        if topic not in read:
            raise ValueError(f"the topic {_described(recording, topic)} is in no encoding that is read; {has}")
    return frames, others


def _described(recording, topic):
    """A topic with its type, and its encoding if that is not read."""
    encoding = "" if recordings.is_read(recording, topic) else f", encoded as {recording.encodings[topic]!r}"
    return f"{topic} ({recording.topics[topic]}{encoding})"


class Played:
    """The rows of play(), one after another. notes: sentences; there may be more after the last row."""

    def __init__(self, recording, watch, frames, others, named):
        self._watch = watch
        self._pictures = {}
        self._unread = [
            _described(recording, topic)
            for topic, kind in sorted(recording.topics.items())
            if topic not in frames and not named and recordings.SENSED.search(kind.rsplit("/", 1)[-1])
            if kind != recordings.CAMERA
        ]
        self._rows = _rows(recording, watch, frames, others, named, self._pictures)

    def __iter__(self) -> Iterator[Row]:
        return self

    def __next__(self) -> Row:
        return next(self._rows)

    def close(self) -> None:
        """Closes the recording before its end."""
        self._rows.close()

    @property
    def notes(self) -> list[str]:
        pictures = [f"{topic} ({what})" for topic, what in sorted(self._pictures.items())]
        found = [f"not read: {', '.join(self._unread)}"] if self._unread else []
        if pictures:
            found.append(f"no depth, so not played: {', '.join(pictures)}")
        found += [f"{said} ({count} times)" if count > 1 else said for said, count in self._watch.notes.items()]
        return found + self._watch.transforms.refused


def _rows(recording, watch, frames, others, named, pictures):
    with recording:
        # Static transforms always hold, also those that were said late.
        try:
            for each in recording.messages([t for t in others if t.rsplit("/", 1)[-1] == "tf_static"] or [""]):
                watch.take(each.topic, each.type, each.decode(), keep=True)
        except ValueError:
            pass  # it is met again below
        waiting = collections.deque()
        depths = set(frames) if named else {topic for topic in frames if recording.topics[topic] == recordings.CLOUD}
        failed = None
        messages = recording.messages([*frames, *others])
        while True:
            try:
                each = next(messages, None)
            except Damaged as error:
                each, failed = None, error
            while waiting and (each is None or each.log_time > waiting[0][0] + WAIT or watch.ready(*waiting[0][1:])):
                yield watch.row(*waiting.popleft()[1:])
            if each is None:
                break
            if each.topic in pictures:
                continue
            try:
                message = each.decode()
            except ValueError as error:
                if each.topic in others:
                    watch.notes[str(error)] += 1
                    continue
                while waiting:
                    yield watch.row(*waiting.popleft()[1:])
                yield Row(each.log_time, each.topic, "", note=str(error))
                continue
            if each.topic in others:
                watch.take(each.topic, each.type, message)
            else:
                if each.topic not in depths:
                    if not recordings.is_depth(each.type, message):  # a picture, which nobody asked about
                        pictures[each.topic] = message.format if each.type == recordings.COMPRESSED else message.encoding
                        continue
                    depths.add(each.topic)
                waiting.append((each.log_time, each.topic, each.type, message))
        if failed is None and not depths:
            failed = ValueError(
                f"{recording.path} has neither a PointCloud2 nor an image of 16UC1 or 32FC1"
                + (f", only {', '.join(f'{t} ({what})' for t, what in pictures.items())}" if pictures else "")
                + "; say topics to play others"
            )
        if failed:
            raise failed


class Rows(list):
    """A list of rows, with the notes about their recording."""

    notes = ()


def rows(path, robot, **options):
    """play() as a list, for workers: of a damaged recording the last row is "unknown", and its note says the damage."""
    found, played = Rows(), None
    try:
        played = play(path, robot, **options)
        found.extend(played)
    except Damaged as error:
        # extend() keeps what was yielded before the error.
        found.append(Row(found[-1].stamp_ns if found else None, "", "", note=str(error)))
    found.notes = played.notes if played else []
    return found


# ---- the check ------------------------------------------------------------------------------------------------------


def _seen_depth(image, lens):
    """The points of an image in the camera's frame, by NumPy in double."""
    scale = 0.001 if image.dtype.kind == "u" else 1.0
    return scenes.deprojected(image, scale, lens.get("intrinsics"), lens.get("rays"))


def _lengths_of_rays(shape, intrinsics=None, rays=None):
    """How long each pixel's ray is at z = 1, (rows, columns); 0 where there is none."""
    if rays is None:
        v, u = np.indices(shape)
        rays = np.stack([(u - intrinsics[2]) / intrinsics[0], (v - intrinsics[3]) / intrinsics[1]], axis=-1)
    return np.nan_to_num(np.sqrt(1 + np.square(np.asarray(rays, float)).sum(-1)))


def _lengths(vectors):
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))


def by_numpy(robot, poses, points, counting=None, block=1 << 17):
    """The least distance of points (n, 3) to the spheres of a robot whose parts are at poses: plain NumPy, in double.

    counting: from a block of points to those that count; all, unless given. Points that are farther from a ball around
    a part than the least so far are left out; the others meet every sphere.
    """
    parts = []
    for part, at in enumerate(np.asarray(poses, float)):
        spheres = np.asarray(robot.spheres(part), float)
        centres, radii = spheres[:, :3] @ at[:3, :3].T + at[:3, 3], spheres[:, 3]
        middle = centres.mean(0)
        parts.append((middle, centres - middle, radii, (_lengths(centres - middle) + radii).max()))
    least = math.inf
    for begin in range(0, len(points), block):  # so that a block stays in the processor's cache
        some = points[begin : begin + block]
        some = some if counting is None else counting(some)
        for middle, centres, radii, reach in parts:
            from_middle = some - middle  # products of small numbers lose little
            far = _lengths(from_middle)
            order = [slice(None)] if len(far) <= 100 else [np.argpartition(far, 100)[:100], slice(None)]
            for chosen in order:
                near = from_middle[chosen][far[chosen] - reach <= least + 1e-9]
                step = max(1, 2_000_000 // max(1, len(centres)))
                for first in range(0, len(near), step):
                    p = near[first : first + step]
                    square = (p * p).sum(1)[:, None] + (centres * centres).sum(1) - 2 * (p @ centres.T)
                    least = min(least, (np.sqrt(np.maximum(square, 0)) - radii).min())
    return float(least) if math.isfinite(least) else math.nan


def agree(row):
    """Whether a row's distance is the one that NumPy found. Both round: 2e-5 of it and 10 micrometres are allowed."""
    if row.checked is None or math.isnan(row.checked) or math.isnan(row.distance):
        return row.checked is None or math.isnan(row.checked) == math.isnan(row.distance)
    return abs(row.checked - row.distance) <= 1e-5 + 2e-5 * abs(row.checked)


# ---- tables ---------------------------------------------------------------------------------------------------------

def flat(row):
    """A Row as a line of a table: a dictionary of numbers and words."""
    flat = {"stamp": row.stamp, **dataclasses.asdict(row)}
    flat["dropped"] = json.dumps(row.dropped)
    flat["parts"] = None if row.parts is None else json.dumps(row.parts)
    for name in ("at", "nearest"):
        value = flat.pop(name)
        for axis, letter in enumerate("xyz"):
            flat[f"{name}_{letter}"] = None if value is None else float(value[axis])
    return flat


class Csv:
    """Rows to a CSV file; a context manager with write(row)."""

    def __init__(self, path):
        self.file = open(path, "w", newline="", encoding="utf-8")
        self.table = csv.DictWriter(self.file, list(flat(Row(0, "", ""))))
        self.table.writeheader()

    def write(self, row):
        self.table.writerow(flat(row))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()


class Parquet:
    """Rows to a Parquet file, a group of rows at a time (extra `parquet`); a context manager with write(row)."""

    def __init__(self, path):
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError as error:
            raise recordings.needs("parquet", error) from None
        self.pyarrow = pyarrow
        whole, text = ("stamp_ns", "point", "seen", "valid"), ("topic", "frame", "state", "link", "note", "dropped", "parts")
        self.schema = pyarrow.schema(
            [
                (name, pyarrow.int64() if name in whole else pyarrow.string() if name in text else pyarrow.float64())
                for name in flat(Row(0, "", ""))
            ]
        )
        self.file = pyarrow.parquet.ParquetWriter(pathlib.Path(path), self.schema)
        self.rows = []

    def write(self, row):
        self.rows.append(flat(row))
        if len(self.rows) >= 10_000:
            self._flush()

    def _flush(self):
        if self.rows:
            self.file.write_table(self.pyarrow.Table.from_pylist(self.rows, self.schema))
            self.rows = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._flush()
        self.file.close()
