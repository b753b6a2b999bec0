# SPDX-License-Identifier: BSD-3-Clause
"""A still picture of a scene, with nothing but NumPy."""

from __future__ import annotations

import math
import os
import pathlib
import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import colours
from .raster import Canvas, png, unit
from .scenes import Scene, metres, scene

if TYPE_CHECKING:
    from .._core import _Array, Cloud, Robot


def _corners(part):
    """A part's triangles in the world, (n, 3, 3); without a mesh, those of its spheres."""
    if len(part.triangles):
        local = np.asarray(part.vertices, float)[np.asarray(part.triangles, int)]
    else:
        ball = _ball(1 if len(part.spheres) < 3000 else 0)
        local = (part.spheres[:, None, None, :3] + part.spheres[:, None, None, 3:] * ball).reshape(-1, 3, 3)
    return local @ part.pose[:3, :3].T + part.pose[:3, 3]


def _ball(splits):
    """A sphere of radius 1 as triangles: an octahedron, each face split into four `splits` times."""
    faces = np.array([[(x, 0, 0), (0, y, 0), (0, 0, z)] for x in (1, -1) for y in (1, -1) for z in (1, -1)], float)
    for _ in range(splits + 1):
        a, b, c = faces[:, 0], faces[:, 1], faces[:, 2]
        ab, bc, ca = (m / np.linalg.norm(m, axis=1, keepdims=True) for m in (a + b, b + c, c + a))
        faces = np.concatenate([np.stack(f, axis=1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return faces


def _framed(seen, corners):
    """What the picture must hold: the robot, and the part of the cloud near it. Its centre and radius."""
    robot = np.concatenate([c.reshape(-1, 3) for c in corners]) if corners else np.zeros((0, 3))
    near = seen.points
    if len(robot):  # the points that have a colour, if they are near enough
        middle = (robot.min(axis=0) + robot.max(axis=0)) / 2
        reach = np.linalg.norm(robot.max(axis=0) - robot.min(axis=0)) / 2
        close = np.linalg.norm(near - middle, axis=1) < 2 * reach
        near = near[close & (seen.distance <= seen.farthest) if seen.distance is not None else close]
    held = np.concatenate([robot, near.astype(float)] + ([seen.segment] if seen.segment is not None else []))
    if not len(held):
        return np.zeros(3), 1.0
    low, high = np.percentile(held, 0.5, axis=0), np.percentile(held, 99.5, axis=0)
    if len(robot):
        low, high = np.minimum(low, robot.min(axis=0)), np.maximum(high, robot.max(axis=0))
    return (low + high) / 2, max(float(np.linalg.norm(high - low)) / 2, 1e-3)


def _from(azimuth, elevation):
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def _best_azimuth(seen, corners, middle, radius, field, elevation):
    """From where most of the shortest segment is seen, of eight directions."""
    if seen.segment is None:
        return -55.0
    triangles = np.concatenate(corners) if corners else np.zeros((0, 3, 3))
    triangles = triangles[:: max(1, len(triangles) // 20000)]
    along = seen.segment[0] + np.linspace(0.02, 0.98, 40)[:, None] * (seen.segment[1] - seen.segment[0])

    def seen_from(azimuth):
        canvas = Canvas(240, 160, middle + _distance(radius, field) * _from(azimuth, elevation), middle, field, 1)
        canvas.triangles(triangles, (0, 0, 0))
        canvas.points(seen.points[::4], seen.point_colours[::4], 1)
        at = canvas.project(along)
        x, y = np.clip(at[:, 0].astype(int), 0, canvas.w - 1), np.clip(at[:, 1].astype(int), 0, canvas.h - 1)
        depth = (canvas.keys[y * canvas.w + x] >> np.uint64(32)).astype(np.uint32).view(np.float32)
        free = np.count_nonzero(~(depth < at[:, 2] - 0.01 * radius)) / len(along)
        usual = 1.3 if azimuth in (-55, -100) else 1.0  # from the side, unless that hides much
        return usual * (0.2 + free) * np.linalg.norm(at[-1, :2] - at[0, :2])

    return max((-55, -100, -10, 35, 80, 125, 170, -145), key=seen_from)


def _distance(radius, field):
    return 0.92 * radius / math.sin(math.radians(field) / 2)


def draw(seen, *, width=960, height=640, azimuth=None, elevation=24.0, spheres=False):
    """The canvas of a scene, before it is finished."""
    corners = [_corners(_as_spheres(p) if spheres else p) for p in seen.parts]
    field = 35.0
    middle, radius = _framed(seen, corners)
    if azimuth is None:
        azimuth = _best_azimuth(seen, corners, middle, radius, field, elevation)
    eye = middle + _distance(radius, field) * _from(azimuth, elevation)
    canvas = Canvas(width, height, eye, middle, field)
    for part, its in zip(seen.parts, corners):
        canvas.triangles(its, part.colour)
    canvas.points(
        seen.points, seen.point_colours, 4 if seen.step > 4 else 3 if seen.step > 1 or len(seen.points) < 100000 else 2
    )
    if seen.segment is not None:
        a, b = seen.segment
        canvas.line(a, b, seen.segment_colour, 3)
        x, y = canvas.pixel((a + b) / 2)
        if np.isfinite((x, y)).all():
            across = canvas.pixel(b) - canvas.pixel(a)
            side = unit(np.array([-across[1], across[0]])) if np.linalg.norm(across) > 1 else np.array([1.0, 0.0])
            side = side if side[0] >= 0 else -side
            words = 12 * len(seen.label)
            x, y = x + 14 * side[0] + (0 if side[0] > 0.3 else -words / 2), y + 22 * side[1] - 8
            canvas.text(
                min(max(x, 6), width - words - 6), min(max(y, 40), height - 60), seen.label, seen.segment_colour
            )
    for k, words in enumerate(textwrap.wrap(seen.title, max(20, (width - 24) // 12))):
        canvas.text(12, 10 + 22 * k, words)
    _legend(canvas, seen)
    return canvas


def _as_spheres(part):
    """The part without its mesh; if it has no spheres, as it is."""
    if not len(part.spheres):
        return part
    return type(part)(part.name, part.pose, part.vertices[:0], part.triangles[:0], part.spheres, part.colour)


def _legend(canvas, seen):
    """What the colours of the points mean, at the lower edge."""
    y, x = canvas.height - 26, 12
    if seen.zones:
        for zone in seen.zones:
            words = f"within {metres(zone.threshold)}" + (f": {zone.points:,}" if seen.step == 1 else "")
            canvas.box(x, y, 14, 14, zone.colour)
            canvas.text(x + 20, y, words)
            x += 40 + 12 * len(words)
    elif seen.distance is not None:
        for k in range(96):
            canvas.box(x + k * 2, y, 2, 14, colours.by_distance(np.array([k / 96]), 1.0)[0])
        words = f"0 to {seen.farthest:g} m"
        canvas.text(x + 200, y, words)
        x += 220 + 12 * len(words)
    if seen.step > 1:
        canvas.text(x + 12, y, f"drawn: 1 point in {seen.step}", (90, 90, 90))


def render(seen, **options):
    """The picture of a scene: uint8 (height, width, 3)."""
    return draw(seen, **options).finish()


def picture(
    robot: Robot | Scene,
    points: _Array | Cloud | None = None,
    joints: _Array | Mapping[str, float] | None = None,
    *,
    output: str | os.PathLike[str] = "clearance.png",
    width: int = 960,
    height: int = 640,
    azimuth: float | None = None,
    elevation: float = 24.0,
    spheres: bool = False,
    **what: Any,
) -> pathlib.Path:
    """Writes a PNG picture of a robot before a cloud, with the shortest segment and its number; returns the path.

    robot, points, joints and `what`: as in show and in a call of Query; or robot is a Scene. azimuth and elevation:
    from where, in degrees (azimuth: by itself, where most of the segment is seen). spheres: draws the inner spheres
    instead of meshes. Needs nothing but NumPy.
    """
    seen = robot if isinstance(robot, Scene) else scene(robot, points, joints, **what)
    output = pathlib.Path(output)
    if output.suffix.lower() != ".png":
        raise ValueError(f"clearance: a picture is a .png file, not {output}")
    output.write_bytes(
        png(render(seen, width=width, height=height, azimuth=azimuth, elevation=elevation, spheres=spheres))
    )
    return str(output)
