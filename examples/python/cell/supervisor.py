# SPDX-License-Identifier: BSD-3-Clause
"""Depth images in, a share of the arm's full speed out: speed and separation as ISO 10218-2:2025 (ISO/TS 15066) has it, link by link.

Each frame: which pixels are the arm's own or known things' (`self_filter`), how near the rest may be (`certain_distance`), how near
is what no camera sees (`unseen`), and the greatest speed at which the arm could still stop before either reaches it.
"""

from __future__ import annotations

import time
from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import clearance
from task import STOP, Leg, part_speeds
from world import BOX, FOCAL, GRASP, HEIGHT, INTRINSICS, THINGS, WIDTH

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stated:
    """What the cell's engineer states of cameras, clocks, joints and people."""

    human: float = 1.6  # metres per second, of any place of a person
    age: float = 0.045  # seconds at most from a frame's stamp until its answer counts
    period: float = 0.055  # seconds at most from an answer to the next
    disparity: float = 0.06  # pixels at a focal length of 424 pixels and a baseline of 0.095 m
    shift: float = 0.004  # of a camera's pose: metres
    turn: float = 0.002  # radians
    joints: float = 0.001  # radians
    padding: float = 0.05  # metres around the arm that are its own


ROOM = clearance.Hiding(nearest=0.3, farthest=6.0)  # metres of z


def separation(speed: float, share: float, stated: Stated) -> float:
    """How far a part that moves at `speed`, at full speed of the arm, has to be from people if the arm has that share of it. What is
    measured wrongly is in the distances already."""
    return clearance.protective_separation(
        human_speed=stated.human, robot_speed=share * speed, reaction_time=stated.period, stopping_time=share * STOP,
        stopping_distance=share * speed * share * STOP / 2, intrusion=0, human_uncertainty=0, robot_uncertainty=0)


@dataclass(frozen=True)
class Frame:
    """What arrives from the sensors, of one moment."""

    images: list[NDArray[np.float32]]
    cameras: list[Array]  # world-from-camera, as believed
    q: Array
    leg: int
    second: float  # on that leg, at full speed
    speed: float  # share of full speed


@dataclass
class Verdict:
    """The share of full speed that is allowed, and what was known."""

    share: float
    lower: float = 0.0  # of what is seen, metres
    hidden: float = 0.0  # of what no camera sees
    edge: float = 0.0  # of what is beside all images
    part: str | None = None  # that slows the arm down


def filled(depth: NDArray[np.float32], own: NDArray[np.bool_]) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Holes of a pixel have the nearest depth around that is not the arm's own: what would hide in one is thinner than two pixels."""
    rows, columns = depth.shape

    def around(of: NDArray[Any]) -> NDArray[Any]:
        padded = np.pad(of, 1)
        return np.stack([padded[1 + i:1 + i + rows, 1 + j:1 + j + columns] for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j])

    hole = (depth == 0) & (around(depth > 0).sum(axis=0) >= 3)
    rest = around(np.where((depth > 0) & ~own, depth, 0))
    nearest: NDArray[Any] = np.where(rest > 0, rest, np.inf).min(axis=0)
    owns = hole & ~np.isfinite(nearest)  # among the arm's own pixels alone
    nearest = np.where(owns, around(depth).max(axis=0), nearest)
    return np.where(hole, nearest, depth).astype("f4"), own | owns


def box_mesh(edges: tuple[float, float, float]) -> tuple[Array, NDArray[np.uint32]]:
    """A closed mesh of a box about the origin."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(edges) / 2
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7),
             (1, 7, 3)]
    return corners, np.array(faces, "u4")


def moved(x: float, y: float, z: float) -> Array:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


class Arm:
    """An arm with or without the box, its prepared questions, and how fast its parts move on each leg."""

    def __init__(self, robot: clearance.Robot, legs: list[Leg], stated: Stated) -> None:
        self.robot = robot
        self.own = clearance.Query(robot, clearance.SelfFilter(stated.padding))
        self.certain = clearance.Query(robot, clearance.CertainDistance())
        self.plain = clearance.Query(robot, clearance.MinDistancesPerPart())
        self.unseen = clearance.Query(robot, clearance.Unseen())
        corners = [robot.mesh(k)[0] for k in range(len(robot))]
        self.speeds = [part_speeds(robot, corners, leg) for leg in legs]  # (steps, parts) of each leg


class Supervisor:
    """Says how fast the arm may go. `unseen` and `radii` can be left out, to show what they prevent."""

    def __init__(self, robot: clearance.Robot, legs: list[Leg], boxes: list[Array | None], stated: Stated, unseen: bool = True,
                 radii: bool = True) -> None:
        self.legs, self.boxes, self.stated, self.unseen, self.radii = legs, boxes, stated, unseen, radii
        self.box = box_mesh(BOX)
        box = clearance.Robot.from_meshes({"box": self.box}, model="triangles")
        self.empty = Arm(robot, legs, stated)
        self.full = Arm(robot.attach("hand", box, moved(0, 0, GRASP)), legs, stated)
        meshes = {name: box_mesh(edges) for name, (_, edges) in THINGS.items()}
        things = clearance.Robot.from_meshes({**meshes, "box": self.box}, model="triangles")
        self.things = clearance.Query(things, clearance.SelfFilter(stated.padding))
        self.allowed = 0.0
        self.seconds: dict[str, list[float]] = defaultdict(list)

    def _ahead(self, arm: Arm, leg: int, second: float) -> Array:
        """How fast each part moves at most in the next 0.4 s, at full speed."""
        most, left, at = np.zeros(len(arm.robot)), 0.4, second
        for k in range(leg, leg + 3):
            of, seconds = arm.speeds[k % len(self.legs)], self.legs[k % len(self.legs)].seconds
            first = int(np.clip(at / seconds * len(of), 0, len(of) - 1))
            last = int(np.clip(np.ceil((at + left) / seconds * len(of)), first + 1, len(of)))
            most = np.maximum(most, of[first:last].max(axis=0))
            left, at = left - (seconds - at), 0.0
            if left <= 0:
                break
        return most

    def _timed(self, stage: str, since: float) -> float:
        now = time.perf_counter()
        self.seconds[stage].append(now - since)
        return now

    def ask(self, frame: Frame) -> Verdict:
        """The verdict on one frame."""
        since = time.perf_counter()
        leg, following = frame.leg % len(self.legs), (frame.leg + 1) % len(self.legs)
        arm = self.full if self.legs[leg].holds or self.legs[following].holds else self.empty
        # [own]
        images = [clearance.depth_image(image, INTRINSICS, pose) for image, pose in zip(frame.images, frame.cameras)]
        own = arm.own(clouds=images, joints=frame.q).labels == clearance.PointLabel.own
        known = self.things(clouds=images, poses=self._things(leg)).labels == clearance.PointLabel.own
        # [own]
        whole = [filled(image, of) for image, of in zip(frame.images, (own | known).reshape(len(images), HEIGHT, WIDTH))]
        images = [clearance.depth_image(image, INTRINSICS, pose) for (image, _), pose in zip(whole, frame.cameras)]
        labels = np.where([of for _, of in whole], clearance.PointLabel.own, clearance.PointLabel.rest).astype("u1")
        self._timed("own", since)
        lower, hidden, edge = self.near(arm, frame, images, labels)

        # [speed]
        near = np.minimum(lower, np.minimum(hidden, edge))
        most = self._ahead(arm, leg, frame.second)
        moves = most > 0
        share, part = 0.0, None
        for wanted in (1.0, 0.75, 0.5, 0.25, 0.1):
            v = max(wanted, frame.speed)
            slack = near - [separation(speed, v, self.stated) for speed in most]
            if (slack[moves] > 0).all():
                share = wanted
                break
            part = arm.robot.parts[int(np.flatnonzero(moves)[np.argmin(slack[moves])])]
        # [speed]
        self.allowed = share
        return Verdict(share, float(lower[moves].min()), float(hidden[moves].min()), float(edge[moves].min()), part)

    def near(self, arm: Arm, frame: Frame, images: list[clearance.Cloud], labels: NDArray[np.uint8]) -> tuple[Array, Array, Array]:
        """How near each part is at least: to what is seen, to what no camera sees, and to the images' edges. Metres. labels: (images, rows,
        columns)."""
        stated, since = self.stated, time.perf_counter()
        both = [self.legs[(frame.leg + k) % len(self.legs)] for k in (0, 1)]

        # [radii]
        noise = clearance.StereoNoise(424, 0.095, stated.disparity)
        half_pixel = 0.5 * np.sqrt(2) / FOCAL  # radians; what lies between the middles of two pixels is seen by neither
        rate = np.maximum(*(np.abs(leg.end - leg.start) / leg.seconds for leg in both)) * max(frame.speed, self.allowed)
        parts = arm.robot.part_radii(frame.q, stated.joints, rate, stated.age)
        # [radii]

        # [seen]
        seen = [clearance.masked(image, label) for image, label in zip(images, labels)]
        if self.radii:
            seen = [clearance.uncertain(cloud, noise, shift=stated.shift, turn=stated.turn + half_pixel, max_speed=stated.human,
                                        age=stated.age) for cloud in seen]
            r = arm.certain(clouds=seen, joints=frame.q, question=clearance.CertainDistance(parts))
            lower = np.array([r.of(part).lower for part in arm.robot.parts])
            if r.state == clearance.State.no_data:
                lower[:] = 0  # nothing is known
        else:
            lower = arm.plain(clouds=seen, joints=frame.q).all["lower"].astype(float)
        # [seen]
        since = self._timed("seen", since)

        # [unseen]
        hidden = edge = np.full(len(lower), np.inf)
        if self.unseen:
            if self.radii:
                images = [clearance.uncertain(image, noise, shift=stated.shift, turn=stated.turn, max_speed=stated.human, age=stated.age)
                          for image in images]
            u = arm.unseen(clouds=images, joints=frame.q, question=clearance.Unseen(
                ROOM, labels=labels.ravel(), edges=True, radii=parts["joints"] + parts["delay"] if self.radii else ()))
            hidden, edge = u.parts["lower"].astype(float), u.parts["to_edge"].astype(float)
        # [unseen]
        self._timed("unseen", since)
        return lower, hidden, edge

    def _things(self, leg: int) -> list[Array]:
        box = self.boxes[leg]
        return [moved(*middle) for middle, _ in THINGS.values()] + [moved(*(box if box is not None else (0, 0, -5)))]
