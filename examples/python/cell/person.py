# SPDX-License-Identifier: BSD-3-Clause
"""A person made of capsules, who walks, reaches in, bends over and hides, no faster than stated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from world import FLOOR, SCREEN

Array = NDArray[np.float64]
Ends = dict[str, tuple[Array, Array]]

UPPER, FORE = 0.30, 0.34  # of an arm, with the hand
CAPSULES = [("torso", 0.15, 0.48), ("hips", 0.14, 0.16), ("head", 0.10, 0.12), ("right_upper_arm", 0.05, UPPER),
            ("right_forearm", 0.045, FORE), ("left_upper_arm", 0.05, UPPER), ("left_forearm", 0.045, FORE),
            ("right_leg", 0.075, 0.78), ("left_leg", 0.075, 0.78)]

# A key frame: x, y, yaw, lean; the right hand's goal in the world and how much it wants it; the same of the left one.
KEY = 12


def ends(key: Array) -> Ends:
    """Where each capsule's ends are."""
    x, y, yaw, lean = key[:4]
    ahead, left, up = np.array([np.cos(yaw), np.sin(yaw), 0]), np.array([-np.sin(yaw), np.cos(yaw), 0]), np.array([0, 0, 1.0])
    hip = np.array([x, y, FLOOR + 0.95])
    spine = np.cos(lean) * up + np.sin(lean) * ahead
    neck = hip + 0.50 * spine
    at: Ends = {"torso": (hip + 0.02 * spine, neck), "hips": (hip - 0.08 * left, hip + 0.08 * left),
                "head": (neck + 0.22 * spine, neck + 0.34 * spine)}
    for side, sign, first in (("right", -1, 4), ("left", 1, 8)):
        shoulder = neck + sign * 0.20 * left
        rest = shoulder - (UPPER + FORE - 0.06) * up + 0.05 * sign * left
        goal = rest + key[first + 3] * (key[first:first + 3] - rest)
        reach = goal - shoulder
        far = float(np.clip(np.linalg.norm(reach), 0.15, UPPER + FORE - 1e-3))
        way = reach / np.linalg.norm(reach)
        hand = shoulder + far * way
        # The elbow is below and outside of the line from shoulder to hand.
        along = (UPPER**2 - FORE**2 + far**2) / (2 * far)
        side_way = -up + 0.5 * sign * left - 0.3 * ahead
        side_way -= side_way @ way * way
        elbow = shoulder + along * way + np.sqrt(max(UPPER**2 - along**2, 0)) * side_way / np.linalg.norm(side_way)
        at[f"{side}_upper_arm"], at[f"{side}_forearm"] = (shoulder, elbow), (elbow, hand)
        foot = hip + sign * 0.10 * left - 0.10 * up
        at[f"{side}_leg"] = (foot, foot - 0.78 * up)
    return at


class Motion:
    """Key frames, passed at given speeds: that of the person's fastest end of a capsule, metres per second."""

    def __init__(self, keys: list[Array], speeds: list[float], waits: list[float]) -> None:
        self.names = list(ends(keys[0]))
        places, times = [self._places(keys[0])], [0.0]
        for before, after, speed, wait in zip(keys, keys[1:], speeds, waits):
            for share in np.linspace(0, 1, 101)[1:]:
                places.append(self._places(before + share * (after - before)))
                times.append(times[-1] + max(float(np.linalg.norm(places[-1] - places[-2], axis=1).max()) / speed, 1e-4))
            places.append(places[-1])
            times.append(times[-1] + max(wait, 1e-4))
        self.places, self.times, self.duration = np.array(places), np.array(times), times[-1]

    @staticmethod
    def _places(key: Array) -> Array:
        return np.array([end for pair in ends(key).values() for end in pair])

    def at(self, time: float) -> Ends:
        """The capsules' ends then, straight between two samples; before and after all, the person stands still."""
        k = int(np.clip(np.searchsorted(self.times, time), 1, len(self.times) - 1))
        share = np.clip((time - self.times[k - 1]) / (self.times[k] - self.times[k - 1]), 0, 1)
        here = self.places[k - 1] + share * (self.places[k] - self.places[k - 1])
        return {name: (here[2 * n], here[2 * n + 1]) for n, name in enumerate(self.names)}


KINDS = ("walks by", "reaches in", "bends over", "lunges", "hides")


def random_motion(kind: str, random: np.random.Generator, fastest: float) -> Motion:
    """About ten seconds of a person who does not care for the robot."""
    def key(x: float, y: float, yaw: float, lean: float = 0.0, right: tuple[float, float, float] | None = None,
            left: tuple[float, float, float] | None = None) -> Array:
        row = np.zeros(KEY)
        row[:4] = x, y, yaw, lean
        for first, goal in ((4, right), (8, left)):
            if goal is not None:
                row[first:first + 3], row[first + 3] = goal, 1
        return row

    def place() -> tuple[float, float, float]:
        """Somewhere in the arm's way."""
        return (float(random.uniform(0.25, 0.6)), float(random.uniform(-0.45, 0.45)), float(random.uniform(0.08, 0.5)))

    def pace(least: float = 0.4) -> float:
        return float(random.uniform(least, 1.0)) * fastest

    side = random.choice([-1.0, 1.0])
    if kind == "walks by":
        x = float(random.uniform(0.95, 1.25))
        keys = [key(x, -1.9 * side, np.pi / 2 * side), key(x, 0, np.pi / 2 * side),
                key(x - 0.05, 0.3 * side, np.pi / 2 * side, 0, place() if random.uniform() < 0.5 else None), key(x, 1.9 * side, np.pi / 2 * side)]
        return Motion(keys, [pace() for _ in keys[1:]], [float(random.uniform(0, 0.7)) for _ in keys[1:]])
    if kind in ("reaches in", "bends over", "lunges"):
        x, y, yaw = 0.98, float(random.uniform(-0.35, 0.35)), np.pi + float(random.uniform(-0.3, 0.3))
        lean = {"reaches in": 0.15, "bends over": 0.75, "lunges": 0.5}[kind]
        keys, waits = [key(1.7, y, yaw), key(x, y, yaw)], [float(random.uniform(0.2, 1.5))]
        for _ in range(int(random.integers(1, 4))):
            both = random.uniform() < 0.4
            keys.append(key(x, y, yaw, lean, place(), place() if both else None))
            keys.append(key(x + float(random.uniform(0, 0.2)), y, yaw))
            waits += [float(random.uniform(0, 1.0)), float(random.uniform(0.3, 1.5))]
        return Motion(keys, [fastest if kind == "lunges" else pace() for _ in keys[1:]], waits)
    # Behind the screen, then round its edge or over it, at full speed.
    sx, sy = SCREEN[0][:2]
    behind = key(sx + 0.02, sy - 0.35, np.pi / 2)
    round_it = key(sx - 0.32 + float(random.uniform(-0.1, 0.1)), sy - 0.30, np.pi / 2 + 0.2, 0.3)
    keys = [key(sx + 0.5, -1.9, np.pi / 2), behind, round_it, key(sx - 0.40, sy - 0.10, np.pi / 2 + 0.3, 0.7, place()),
            key(sx - 0.38, sy - 0.3, np.pi / 2, 0.1), behind]
    return Motion(keys, [pace(), fastest, fastest, pace(), pace()], [float(random.uniform(0.5, 4)), 0, 0.3, 0.2, 1])
