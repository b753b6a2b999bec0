# SPDX-License-Identifier: BSD-3-Clause
"""Who else could watch over the cell, by the same rule: nobody, a voxel map with coal, coarse spheres with a padding.

They know the arm's own pixels and the known things' as well as the supervisor does, and differ in what they call near.
"""

from __future__ import annotations

import importlib
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

import clearance
from supervisor import Arm, Array, Frame, Stated, Supervisor, Verdict
from task import Leg
from world import BOX, GRASP, INTRINSICS, LINKS, WIDTH


class Nobody:
    """Lets the arm go at full speed."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = {}

    def ask(self, frame: Frame) -> Verdict:
        return Verdict(1.0)


def seen_points(frame: Frame, labels: NDArray[np.uint8]) -> Array:
    """The world's points that are neither the arm's nor a known thing's, (n, 3)."""
    found: list[Array] = []
    for image, pose, label in zip(frame.images, frame.cameras, labels.reshape(len(frame.images), -1)):
        v, u = np.divmod(np.flatnonzero((label != clearance.PointLabel.own) & (image.ravel() > 0)), WIDTH)
        z = image[v, u].astype(float)
        at = np.stack([(u - INTRINSICS[2]) / INTRINSICS[0] * z, (v - INTRINSICS[3]) / INTRINSICS[1] * z, z], axis=1)
        found.append(at @ pose[:3, :3].T + pose[:3, 3])
    return np.concatenate(found)


class PaddedSpheres(Supervisor):
    """A few spheres for each link, and 5 cm for all that is not known."""

    def __init__(self, robot: clearance.Robot, legs: list[Leg], boxes: list[Array | None], stated: Stated, urdf: str) -> None:
        super().__init__(robot, legs, boxes, stated)
        arm = clearance.Robot.from_urdf(urdf, model="spheres", spheres=64)
        held = clearance.Robot.from_meshes({"box": self.box}, model="spheres", spheres=8)
        pose = np.eye(4)
        pose[2, 3] = GRASP
        self.ask_empty = clearance.Query(arm, clearance.MinDistancesPerPart())
        self.ask_full = clearance.Query(arm.attach("hand", held, pose), clearance.MinDistancesPerPart())

    def near(self, arm: Arm, frame: Frame, images: list[clearance.Cloud], labels: NDArray[np.uint8]) -> tuple[Array, Array, Array]:
        since = time.perf_counter()
        ask = self.ask_full if arm is self.full else self.ask_empty
        r = ask(seen_points(frame, labels).astype("f4"), joints=frame.q)
        near = r.all["distance"].astype(float) - 0.05
        self._timed("seen", since)
        return near, np.full(len(near), np.inf), np.full(len(near), np.inf)


class Voxels(Supervisor):
    """Cubes of 2 cm where something is seen, and the links' cylinders and boxes: coal's distances (pip install coal)."""

    size = 0.02

    def __init__(self, robot: clearance.Robot, legs: list[Leg], boxes: list[Array | None], stated: Stated) -> None:
        super().__init__(robot, legs, boxes, stated)
        self.coal: Any = importlib.import_module("coal")
        make = self.coal
        self.shapes = [[(make.Cylinder(*size) if len(size) == 2 else make.Box(*size), np.array(middle)) for middle, size in shapes]
                       for _, _, shapes in LINKS.values()]
        self.held = [(make.Box(*BOX), np.zeros(3))]

    def near(self, arm: Arm, frame: Frame, images: list[clearance.Cloud], labels: NDArray[np.uint8]) -> tuple[Array, Array, Array]:
        since, make = time.perf_counter(), self.coal
        points = seen_points(frame, labels)
        points = points[np.linalg.norm(points, axis=1) < 2]  # farther away does not matter
        near = np.full(len(arm.robot), np.inf)
        if len(points):
            tree, here, request = make.makeOctree(points, self.size), make.Transform3s(), make.DistanceRequest()
            for part, pose in enumerate(arm.robot.poses(frame.q)):
                for shape, middle in self.shapes[part] if part < len(self.shapes) else self.held:
                    there = make.Transform3s(pose[:3, :3], pose[:3, :3] @ middle + pose[:3, 3])
                    near[part] = min(near[part], make.distance(tree, here, shape, there, request, make.DistanceResult()))
        self._timed("seen", since)
        return near, np.full(len(near), np.inf), np.full(len(near), np.inf)
