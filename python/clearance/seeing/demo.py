# SPDX-License-Identifier: BSD-3-Clause
"""A scene made by code, so that there is something to see at once: an arm before a table with boxes."""

import math
import pathlib

import numpy as np

JOINTS = {"turn": 0.40, "shoulder": 0.45, "elbow": 1.00, "wrist": 0.70, "hand": 0.0}
CAMERA = (525.0, 525.0, 319.5, 239.5)
FILE = "demo-arm.urdf"

# The arm stands on a pedestal, 0.8 m above the floor. Of each link: its name; its cylinders (length, radius, height
# of the middle, lying or not); the height of the next joint above its own.
_LINKS = [
    ("base", [(0.24, 0.10, 0.12, 0)], 0.24),
    ("column", [(0.14, 0.075, 0.07, 0), (0.19, 0.075, 0.14, 1)], 0.14),
    ("upper_arm", [(0.38, 0.058, 0.19, 0), (0.16, 0.066, 0.38, 1)], 0.38),
    ("forearm", [(0.34, 0.048, 0.17, 0), (0.13, 0.055, 0.34, 1)], 0.34),
    ("flange", [(0.12, 0.040, 0.06, 0)], 0.12),
]
_AXES = {"turn": "0 0 1", "shoulder": "0 1 0", "elbow": "0 1 0", "wrist": "0 1 0", "hand": "0 0 1"}
_LIMITS = {
    "turn": (-2.8, 2.8),
    "shoulder": (-1.7, 1.7),
    "elbow": (-2.4, 2.4),
    "wrist": (-2.0, 2.0),
    "hand": (-2.8, 2.8),
}


def urdf():
    """The arm's description: five joints, and a gripper of boxes."""

    def piece(shape, x, y, z, roll=0.0):
        place = f'<origin xyz="{x:g} {y:g} {z:g}" rpy="{roll:g} 0 0"/><geometry>{shape}</geometry>'
        return f"<visual>{place}</visual><collision>{place}</collision>"

    out = ['<robot name="demo_arm">']
    for name, cylinders, _ in _LINKS:
        pieces = [
            piece(f'<cylinder length="{length}" radius="{radius}"/>', 0, 0, z, math.pi / 2 if across else 0)
            for length, radius, z, across in cylinders
        ]
        out.append(f'<link name="{name}">{"".join(pieces)}</link>')
    gripper = [
        piece(f'<box size="{size}"/>', 0, y, z)
        for size, y, z in (
            ("0.07 0.15 0.05", 0, 0.025),
            ("0.03 0.02 0.10", 0.06, 0.10),
            ("0.03 0.02 0.10", -0.06, 0.10),
        )
    ]
    out.append(f'<link name="gripper">{"".join(gripper)}</link>')
    names = [link[0] for link in _LINKS] + ["gripper"]
    for k, joint in enumerate(_AXES):
        low, high = _LIMITS[joint]
        out.append(
            f'<joint name="{joint}" type="revolute"><parent link="{names[k]}"/><child link="{names[k + 1]}"/>'
            f'<origin xyz="0 0 {_LINKS[k][2]:g}"/><axis xyz="{_AXES[joint]}"/>'
            f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint>'
        )
    return "\n".join(out + ["</robot>"])


def write_urdf(folder):
    """Writes the arm's description into a folder; returns the file's path."""
    file = pathlib.Path(folder) / FILE
    file.write_text(urdf(), encoding="utf-8")
    return str(file)


def camera_pose():
    """World-from-camera: beside the table, looking down at it."""
    eye, target = np.array([0.75, -1.15, 1.05]), np.array([0.72, 0.05, 0.35])
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=-1)
    pose[:3, 3] = eye
    return pose


def depth_image():
    """What the camera sees of floor, table and boxes (not of the arm): uint16 (480, 640), millimetres, 0 is missing."""
    boxes = [
        ((0.6, 0, -0.85), (6, 6, 0.1), 0),
        ((0.85, 0.05, 0.33), (0.8, 1.0, 0.04), 0),
        ((0.78, 0.17, 0.44), (0.09, 0.09, 0.18), 30),
        ((0.70, -0.25, 0.41), (0.12, 0.10, 0.12), -20),
        ((1.05, 0.30, 0.43), (0.14, 0.10, 0.16), 10),
        ((1.00, -0.10, 0.39), (0.10, 0.16, 0.08), 55),
    ]
    pose = camera_pose()
    v, u = np.indices((480, 640))
    rays = (
        np.stack([(u - CAMERA[2]) / CAMERA[0], (v - CAMERA[3]) / CAMERA[1], np.ones(u.shape)], axis=-1) @ pose[:3, :3].T
    )
    depth = np.full(u.shape, np.inf)
    for centre, size, degrees in boxes:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        turn = np.array([(c, -s, 0), (s, c, 0), (0, 0, 1)])
        origin, along = (pose[:3, 3] - centre) @ turn, rays @ turn
        with np.errstate(divide="ignore"):
            one, other = (-np.array(size) / 2 - origin) / along, (np.array(size) / 2 - origin) / along
        enter, leave = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
        depth = np.where((enter > 0) & (enter <= leave) & (enter < depth), enter, depth)
    random = np.random.default_rng(1)
    noisy = depth + (0.0004 + 0.0012 * np.where(np.isfinite(depth), depth, 0) ** 2) * random.standard_normal(
        depth.shape
    )
    lost = ~np.isfinite(depth) | (depth > 4) | (random.random(depth.shape) < 0.015)
    return np.where(lost, 0, np.rint(1000 * np.where(lost, 0, noisy))).astype(np.uint16)
