# SPDX-License-Identifier: BSD-3-Clause
"""What the arm does all day: it carries a box from one stand to the other and back. And how fast each link moves on the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import clearance
from world import BOX, GRASP, THINGS

Array = NDArray[np.float64]
FAST = 1.2  # radians per second: so fast the joint that has the longest way moves
RISE, STOP = 0.3, 0.15  # seconds from rest to full speed, and from full speed to rest
HOME = np.array([0.0, -0.5, 0.0, 1.6, 0.0, 1.0, 0.0])


def reached(robot: clearance.Robot, place: Array, start: Array) -> Array:
    """The joints that have the hand above `place`, fingers down: damped least squares from `start`."""
    q = start.copy()
    for _ in range(300):
        pose = robot.link_pose("hand", q)
        turn = np.cross(pose[:3, 2], (0, 0, -1)) + np.cross(pose[:3, 0], (1, 0, 0))
        wrong = np.concatenate([place - pose[:3, 3], 0.7 * turn])
        if np.linalg.norm(wrong) < 1e-4:
            return q
        rows = robot.jacobian(q, "hand", pose[:3, 3])
        q = np.clip(q + rows.T @ np.linalg.solve(rows @ rows.T + 1e-3 * np.eye(6), np.clip(wrong, -0.1, 0.1)), -2.8, 2.8)
    raise ValueError(f"the arm does not reach {place}")


@dataclass(frozen=True)
class Leg:
    """A straight way of the joints, and whether the hand holds the box on it."""

    start: Array
    end: Array
    holds: bool

    @property
    def seconds(self) -> float:
        """At full speed."""
        return max(float(np.abs(self.end - self.start).max()) / FAST, 1e-3)

    def at(self, second: float) -> Array:
        return self.start + min(second / self.seconds, 1.0) * (self.end - self.start)


class Task:
    """One round of legs, again and again."""

    def __init__(self, robot: clearance.Robot) -> None:
        high = 0.22
        top = {name: THINGS[name][0][2] + THINGS[name][1][2] / 2 for name in ("from", "to")}
        self.stands = {n: np.array([*THINGS[n][0][:2], top[n] + BOX[2] / 2 + 0.001]) for n in ("from", "to")}
        hand = {n: p + (0, 0, GRASP) for n, p in self.stands.items()}
        above = {n: reached(robot, p + (0, 0, high), HOME) for n, p in hand.items()}
        on = {n: reached(robot, p, above[n]) for n, p in hand.items()}
        ways = [("from", "to"), ("to", "from")]
        self.legs: list[Leg] = []
        at = above["to"]
        for a, b in ways:
            self.legs += [Leg(at, above[a], False), Leg(above[a], on[a], False), Leg(on[a], above[a], True),
                          Leg(above[a], above[b], True), Leg(above[b], on[b], True), Leg(on[b], above[b], False)]
            at = above[b]

    def box(self, leg: int) -> Array | None:
        """Where the box lies while the arm is on that leg of a round; None in the hand."""
        k = leg % len(self.legs)
        if self.legs[k].holds:
            return None
        return self.stands["from" if k < 2 or k == 11 else "to"]


def part_speeds(robot: clearance.Robot, corners: list[Array], leg: Leg, steps: int = 24) -> Array:
    """How fast each part's fastest point moves on a leg at full speed, (steps, parts), metres per second: by its hull's corners."""
    times = np.linspace(0, leg.seconds, steps + 1)
    poses = robot.poses(np.array([leg.at(t) for t in times]))
    speeds = np.zeros((steps, len(corners)))
    for part, of in enumerate(corners):
        at = np.einsum("tij,nj->tni", poses[:, part, :3, :3], of) + poses[:, part, None, :3, 3]
        speeds[:, part] = np.linalg.norm(np.diff(at, axis=0), axis=2).max(axis=1) / np.diff(times)[:, None].max(axis=1)
    return 1.05 * speeds  # a straight line between two times is shorter than the way
