# SPDX-License-Identifier: BSD-3-Clause
"""The cell: an arm on a table, a box it carries, a screen to hide behind, two depth cameras. MuJoCo knows the truth and renders it.

Nothing here asks clearance anything. Metres, radians, seconds; the table's top is z = 0.
"""

from __future__ import annotations

import importlib
import os
import sys
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

if sys.platform == "linux":
    os.environ.setdefault("MUJOCO_GL", "osmesa")  # "egl" where there is a GPU
mujoco: Any = importlib.import_module("mujoco")  # whose types are not complete

Array = NDArray[np.float64]

# Each link: its joint's axis and place in the link before, then its cylinders and boxes: their middle, and radius and length, or edges.
LINKS: dict[str, tuple[str, float, list[tuple[tuple[float, float, float], tuple[float, ...]]]]] = {
    "base": ("", 0.0, [((0, 0, 0.08), (0.08, 0.16))]),
    "shoulder": ("0 0 1", 0.16, [((0, 0, 0.10), (0.07, 0.20))]),
    "upper_arm": ("0 1 0", 0.20, [((0, 0, 0.10), (0.065, 0.20))]),
    "upper_roll": ("0 0 1", 0.20, [((0, 0, 0.10), (0.06, 0.20))]),
    "elbow": ("0 1 0", 0.20, [((0, 0, 0.10), (0.06, 0.20))]),
    "forearm": ("0 0 1", 0.20, [((0, 0, 0.10), (0.055, 0.20))]),
    "wrist": ("0 1 0", 0.20, [((0, 0, 0.05), (0.05, 0.10))]),
    "hand": ("0 0 1", 0.10, [((0, 0, 0.02), (0.16, 0.06, 0.04)), ((0, 0.05, 0.08), (0.03, 0.02, 0.08)),
                             ((0, -0.05, 0.08), (0.03, 0.02, 0.08))]),
}
LIMIT = 2.9
GRASP = 0.10  # from the hand's origin to the middle of what it holds

BOX = (0.06, 0.08, 0.06)  # what is carried: its edges
# What stands still and is known: middle and edges.
THINGS = {
    "table": ((0.0, 0.0, -0.02), (1.5, 1.3, 0.04)),
    "from": ((0.45, -0.35, 0.02), (0.24, 0.24, 0.04)),  # the low stands on which the box lies
    "to": ((0.45, 0.35, 0.02), (0.24, 0.24, 0.04)),
}
SCREEN = ((1.15, -1.25, 0.10), (0.60, 0.06, 1.70))  # a person fits behind it
FLOOR = -0.75
WALLS = [((x, 0, 0.75), (0.1, 7.0, 3.0)) for x in (-3.5, 3.5)] + [((0, y, 0.75), (7.0, 0.1, 3.0)) for y in (-3.5, 3.5)]

WIDTH, HEIGHT, FOVY = 192, 108, 72.0
FOCAL = HEIGHT / 2 / np.tan(np.radians(FOVY) / 2)  # pixels
INTRINSICS = (FOCAL, FOCAL, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
CAMERAS = {"left": ((-1.55, -1.75, 1.75), (0.25, 0.05, 0.25)), "right": ((1.25, 2.05, 1.75), (0.25, -0.05, 0.25))}  # from, towards


def urdf() -> str:
    """The arm, as a user has it."""
    text, before = '<robot name="arm">', ""
    for name, (axis, height, shapes) in LINKS.items():
        text += f'<link name="{name}">'
        for (x, y, z), size in shapes:
            shape = (f'<cylinder radius="{size[0]}" length="{size[1]}"/>' if len(size) == 2 else
                     f'<box size="{size[0]} {size[1]} {size[2]}"/>')
            text += f'<collision><origin xyz="{x} {y} {z}"/><geometry>{shape}</geometry></collision>'
        text += "</link>"
        if before:
            text += (f'<joint name="j_{name}" type="revolute"><parent link="{before}"/><child link="{name}"/>'
                     f'<origin xyz="0 0 {height}"/><axis xyz="{axis}"/>'
                     f'<limit lower="{-LIMIT}" upper="{LIMIT}" effort="1" velocity="2"/></joint>')
        before = name
    return text + "</robot>"


def looking(place: tuple[float, float, float], at: tuple[float, float, float]) -> Array:
    """World-from-camera: z forward, x right, y down."""
    z = np.array(at) - np.array(place)
    z /= np.linalg.norm(z)
    x = np.cross(z, (0, 0, 1))
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    pose[:3, 3] = place
    return pose


def _mjcf(capsules: list[tuple[str, float, float]]) -> str:
    def shape(middle: tuple[float, float, float], size: tuple[float, ...], more: str) -> str:
        kind, half = ("cylinder", size[0:1] + (size[1] / 2,)) if len(size) == 2 else ("box", tuple(s / 2 for s in size))
        return (f'<geom type="{kind}" pos="{middle[0]} {middle[1]} {middle[2]}" size="{" ".join(map(str, half))}" {more}/>')

    arm = ""
    for name, (axis, height, shapes) in LINKS.items():
        joint = f'<joint axis="{axis}" range="{-LIMIT} {LIMIT}"/>' if axis else ""
        arm += (f'<body name="{name}" pos="0 0 {height}"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>{joint}' +
                "".join(shape(m, s, 'rgba=".85 .85 .88 1"') for m, s in shapes))
    arm += "</body>" * len(LINKS)
    still = "".join(shape(m, s, 'rgba=".55 .45 .35 1"') for m, s in THINGS.values()) + shape(*SCREEN, 'rgba=".4 .45 .5 1"')
    walls = "".join(shape(m, s, 'rgba=".8 .82 .84 1"') for m, s in WALLS)
    blue = 'rgba=".2 .5 .9 1"'
    moved = f'<body name="box" mocap="true">{shape((0, 0, 0), BOX, blue)}</body>'
    for name, radius, length in capsules:
        moved += (f'<body name="{name}" mocap="true"><geom type="capsule" size="{radius} {length / 2}" '
                  f'rgba="{".9 .7 .55 1" if "arm" in name or name == "head" else ".9 .45 .1 1"}"/></body>')
    cameras = ""
    for name, (place, at) in {**CAMERAS, "film": ((2.0, -0.9, 1.6), (0.1, 0.05, 0.2))}.items():
        turn = looking(place, at)[:3, :3]
        x, y = turn[:, 0], -turn[:, 1]
        cameras += (f'<camera name="{name}" pos="{place[0]} {place[1]} {place[2]}" fovy="{FOVY if name != "film" else 58}" '
                    f'xyaxes="{" ".join(map(str, [*x, *y]))}"/>')
    return (f'<mujoco><visual><map znear="0.02" zfar="20"/><headlight ambient=".4 .4 .4" diffuse=".4 .4 .4"/>'
            f'<global offwidth="640" offheight="480"/><quality shadowsize="0"/></visual><worldbody><light pos="0 0 4" dir="0 0 -1"/>'
            f'<geom type="plane" size="8 8 .1" pos="0 0 {FLOOR}" rgba=".75 .78 .8 1"/>{walls}{still}{arm}{moved}{cameras}</worldbody></mujoco>')


@dataclass(frozen=True)
class Sensor:
    """What is wrong with the cameras of an episode, within what their user states."""

    disparity: float = 0.06  # pixels of the sensor whose image was made smaller: focal length 424 pixels, baseline 0.095 m
    shift: float = 0.004  # by how much a camera may be elsewhere, metres
    turn: float = 0.002  # and turned, radians
    holes: float = 0.002  # the share of pixels without a return

    def wrong_poses(self, random: np.random.Generator) -> list[Array]:
        """Where the cameras are believed to be."""
        poses: list[Array] = []
        for place, at in CAMERAS.values():
            pose, axis, off = looking(place, at), random.normal(size=3), random.normal(size=3)
            angle = self.turn * random.uniform() / np.linalg.norm(axis) * axis
            turn = np.eye(3) + np.array([[0, -angle[2], angle[1]], [angle[2], 0, -angle[0]], [-angle[1], angle[0], 0]])
            pose[:3, :3] = np.linalg.qr(turn)[0] * np.sign(np.diag(np.linalg.qr(turn)[1])) @ pose[:3, :3]
            pose[:3, 3] += self.shift * random.uniform() / np.linalg.norm(off) * off
            poses.append(pose)
        return poses

    def measured(self, depth: NDArray[np.float32], random: np.random.Generator) -> NDArray[np.float32]:
        """With noise and holes; along edges, where stereo finds no match, every second pixel is a hole."""
        z = depth.astype(float)
        sigma = z * z * self.disparity / (424 * 0.095)
        z = z + sigma * random.normal(size=z.shape)
        jump = np.zeros(z.shape, bool)
        jump[:, 1:] |= np.abs(np.diff(depth, axis=1)) > 0.1 * depth[:, 1:]
        hole = (random.uniform(size=z.shape) < self.holes) | (jump & (random.uniform(size=z.shape) < 0.5))
        return np.where(hole | (depth > 8), 0, z).astype("f4")


class World:
    """The truth: where all is, how far the arm is from the person, and what cameras see."""

    def __init__(self, capsules: list[tuple[str, float, float]]) -> None:
        self.model = mujoco.MjModel.from_xml_string(_mjcf(capsules))
        self.data = mujoco.MjData(self.model)
        self.capsules = [name for name, _, _ in capsules]
        body = {self.model.body(b).name: b for b in range(self.model.nbody)}
        self._mocap = {n: int(self.model.body_mocapid[b]) for n, b in body.items() if self.model.body_mocapid[b] >= 0}
        geoms = {n: [g for g in range(self.model.ngeom) if self.model.geom_bodyid[g] == b] for n, b in body.items()}
        self._arm = [g for n in LINKS if n != "base" for g in geoms[n]]
        self._box, self._person = geoms["box"][0], [geoms[n][0] for n in self.capsules]
        self._hand = body["hand"]
        self._depth = mujoco.Renderer(self.model, HEIGHT, WIDTH)
        self._depth.enable_depth_rendering()
        self._film: Any = None

    def put(self, q: Array, person: dict[str, tuple[Array, Array]], box: Array | None) -> None:
        """The arm's joints, each capsule's ends, and where the box is: None in the hand."""
        self.data.qpos[:] = q
        for name, (a, b) in person.items():
            k, way = self._mocap[name], b - a
            self.data.mocap_pos[k] = (a + b) / 2
            quat = np.zeros(4)
            mujoco.mju_quatZ2Vec(quat, way / max(float(np.linalg.norm(way)), 1e-9))
            self.data.mocap_quat[k] = quat
        if box is not None:
            self.data.mocap_pos[self._mocap["box"]], self.data.mocap_quat[self._mocap["box"]] = box, (1, 0, 0, 0)
        mujoco.mj_kinematics(self.model, self.data)
        if box is None:
            hand = self.data.xmat[self._hand].reshape(3, 3)
            self.data.mocap_pos[self._mocap["box"]] = self.data.xpos[self._hand] + GRASP * hand[:, 2]
            self.data.mocap_quat[self._mocap["box"]] = self.data.xquat[self._hand]
            mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def distance(self, held: bool, most: float = 1.0) -> float:
        """The true least distance of the arm, with what it holds, and the person; at most `most`. Below 0: a contact."""
        least, between = most, np.zeros(6)
        for a in self._arm + ([self._box] if held else []):
            for b in self._person:
                reach = self.model.geom_rbound[a] + self.model.geom_rbound[b]
                if np.linalg.norm(self.data.geom_xpos[a] - self.data.geom_xpos[b]) - reach < least:
                    least = min(least, mujoco.mj_geomDistance(self.model, self.data, a, b, least, between))
        return float(least)

    def depth(self, camera: str) -> NDArray[np.float32]:
        """Along z, without noise."""
        self._depth.update_scene(self.data, camera=camera)
        return np.array(self._depth.render())

    def picture(self) -> NDArray[np.uint8]:
        """The cell in colours, for a film."""
        if self._film is None:
            self._film = mujoco.Renderer(self.model, 300, 400)
        self._film.update_scene(self.data, camera="film")
        return np.array(self._film.render())

    def close(self) -> None:
        """Gives the renderers back."""
        self._depth.close()
        if self._film is not None:
            self._film.close()
