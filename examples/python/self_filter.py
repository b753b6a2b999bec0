# SPDX-License-Identifier: BSD-3-Clause
"""Two cameras see an arm and somebody's hand. Which points are the arm itself, and how far is the rest?"""

import sys

import numpy as np
from numpy.typing import NDArray

import clearance

CAMERA = (150.0, 150.0, 79.5, 59.5)  # fx, fy, cx, cy; 160 x 120 pixels


def looking(at: tuple[float, float, float], place: tuple[float, float, float]) -> NDArray[np.float64]:
    """World-from-camera of a camera at `place`: z forward, x right, y down."""
    z = np.array(at) - np.array(place)
    z /= np.linalg.norm(z)
    x = np.cross(z, (0, 0, 1))
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    pose[:3, 3] = place
    return pose


def rendered(pose: NDArray[np.float64], balls: NDArray[np.float64]) -> NDArray[np.uint16]:
    """The depth image of balls, in millimetres; 0 where nothing is."""
    v, u = np.mgrid[:120, :160]
    rays = np.stack([(u - CAMERA[2]) / CAMERA[0], (v - CAMERA[3]) / CAMERA[1], np.ones((120, 160))], axis=-1)
    depth = np.full((120, 160), np.inf)
    for ball in balls:
        centre = np.linalg.inv(pose)[:3, :3] @ ball[:3] + np.linalg.inv(pose)[:3, 3]
        a, b, c = (rays * rays).sum(-1), rays @ centre, centre @ centre - ball[3] ** 2
        root = b * b - a * c
        hit = root >= 0
        depth[hit] = np.minimum(depth[hit], (b[hit] - np.sqrt(root[hit])) / a[hit])
    return np.where(np.isfinite(depth), np.round(depth * 1000), 0).astype("u2")


def main() -> int:
    arm = np.array([[0.05 * k, 0, 0.5, 0.06] for k in range(13)])  # x, y, z, radius
    hand = np.array([[0.6, 0.0, 0.85, 0.05]])
    robot = clearance.Robot.from_spheres({"arm": arm})
    poses = [np.eye(4)]
    cameras = [looking((0.3, 0, 0.5), (0.3, -1.2, 0.9)), looking((0.3, 0, 0.5), (1.2, 1.0, 1.0))]
    images = [rendered(camera, np.concatenate([arm, hand])) for camera in cameras]

    # [self_filter]
    # Two cameras, one frame. The padding covers noise and calibration: 1 cm.
    clouds = [clearance.depth_image(image, CAMERA, pose) for image, pose in zip(images, cameras)]
    own = clearance.Query(robot, clearance.SelfFilter(padding=0.01))(clouds=clouds, poses=poses)
    print(f"{own.counts.own} points are the arm's, {len(own.rest)} are not, {own.counts.uncertain} of these are uncertain")

    # How far is the rest: its points have the numbers own.rest, through both cameras.
    each = clearance.Query(robot, clearance.Distances())(clouds=clouds, poses=poses)
    nearest = int(own.rest[np.argmin(each.distance[own.rest])])
    camera = int(np.searchsorted(own.offsets, nearest, "right")) - 1
    row, column = divmod(nearest - int(own.offsets[camera]), 160)
    print(f"the nearest is {each.distance[nearest]:.3f} m away: pixel ({row}, {column}) of camera {camera}")
    # [self_filter]

    exact = np.linalg.norm(arm[:, :3] - hand[0, :3], axis=1).min() - 0.06 - 0.05
    without = clearance.Query(robot, clearance.MinDistance())(clouds=clouds, poses=poses)
    seen = sum((image > 0).sum() for image in images)
    print(f"without a filter it would be {without.distance:.3f} m; the hand is {exact:.3f} m away")
    right = (own.counts.points.valid == seen and own.counts.own + len(own.rest) == seen and own.counts.own > 500
             and exact - 0.001 < each.distance[nearest] < exact + 0.02 and without.distance < 0.005)
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
