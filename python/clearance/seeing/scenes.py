# SPDX-License-Identifier: BSD-3-Clause
"""What is to be seen, as plain data: made once, drawn by every backend (picture, rerun, page)."""

import dataclasses

import numpy as np

from .. import _core
from . import colours


@dataclasses.dataclass
class Part:
    """A rigid part. Its mesh and its inner spheres are in its own frame, metres; either may be empty."""

    name: str
    pose: np.ndarray  # world-from-part, (4, 4)
    vertices: np.ndarray  # (n, 3)
    triangles: np.ndarray  # (m, 3)
    spheres: np.ndarray  # (k, 4): x, y, z, radius
    colour: tuple


@dataclasses.dataclass
class Zone:
    """The points within `threshold` metres that are in no nearer zone."""

    threshold: float
    colour: tuple
    points: int  # of those drawn


@dataclasses.dataclass
class Image:
    """A depth image, as its sensor gave it."""

    depth: np.ndarray  # (rows, columns), uint16 or float32
    scale: float  # metres per unit
    intrinsics: tuple  # fx, fy, cx, cy in pixels; None if there are rays
    pose: np.ndarray  # world-from-camera, (4, 4)


@dataclasses.dataclass
class Scene:
    """A robot before a cloud, and how near they are. World coordinates, metres."""

    parts: list
    points: np.ndarray  # (n, 3) float32, finite
    point_colours: np.ndarray  # (n, 3) uint8
    distance: np.ndarray  # (n,) metres, inf beyond the farthest that has a colour; None if it was not asked
    farthest: float  # up to which distance points have colours
    step: int  # one in `step` of the points that are some is drawn
    all_points: int  # how many those are
    segment: np.ndarray  # (2, 3), from the robot to the point; None if there is none
    segment_colour: tuple
    label: str  # the number that belongs to the segment
    title: str  # one sentence
    zones: list
    image: Image  # None if there is none
    result: object  # what was asked of the library
    margin: float  # None if there is none


def metres(value):
    """A length in words: 0.164 m."""
    if value != value:
        return "unknown"
    return ("-" if value < 0 else "") + "infinite" if np.isinf(value) else f"{value:z.3f} m"


def number(result):
    """What stands at the shortest segment."""
    return "nothing seen" if result.state == _core.State.no_data else metres(result.distance)


def sentence(result, margin=None):
    """The result in one sentence."""
    text = str(result)
    if margin is not None:
        text += f"; {'above' if result.lower > margin else 'NOT above'} the margin of {metres(margin)}"
    return text


def least_of(result):
    """The result about the whole robot: itself, or its `all`."""
    return getattr(result, "all", result)


def pose_of(given, name):
    """A 4x4 matrix; None is the identity."""
    if given is None:
        return np.eye(4)
    pose = np.asarray(given, float)
    if pose.shape != (4, 4) or not np.isfinite(pose).all():
        raise ValueError(f"clearance: {name} is a matrix of shape (4, 4) of finite numbers, not of shape {pose.shape}")
    return pose


def camera_of(intrinsics):
    """fx, fy, cx, cy of four numbers or of K, (3, 3)."""
    if intrinsics is None:
        return None
    given = np.asarray(intrinsics, float)
    if given.shape == (3, 3):
        return given[0, 0], given[1, 1], given[0, 2], given[1, 2]
    if given.shape != (4,):
        raise ValueError(f"clearance: intrinsics are (fx, fy, cx, cy) or K (3, 3), not of shape {given.shape}")
    return tuple(given)


def on_host(array, name):
    """NumPy's view of an array, or a copy of one that lies on a device."""
    if hasattr(array, "detach"):  # torch
        array = array.detach().cpu()
    elif hasattr(array, "get") and hasattr(array, "__cuda_array_interface__"):  # CuPy
        array = array.get()
    array = np.asarray(array)
    if array.dtype == object:
        raise ValueError(f"clearance: {name} must be an array of numbers to be drawn")
    return array


def as_points(points):
    """(n, 3), in the sensor's frame, of what points= takes."""
    local = on_host(points, "points")
    if local.dtype.names:
        local = np.stack([local[axis] for axis in "xyz"], axis=-1)
    if local.ndim < 2 or local.shape[-1] != 3:
        raise ValueError(
            f"clearance: points have the shape (n, 3), (rows, columns, 3) or the fields x, y, z; not {local.shape}"
        )
    return local.reshape(-1, 3)


def deprojected(pixels, scale, camera=None, rays=None):
    """The points of a depth image, (n, 3), double, in the camera's frame: NaN where a pixel is no measurement.

    scale: metres per unit. camera: fx, fy, cx, cy; or rays, (rows, columns, 2).
    """
    z = pixels.astype(float) * scale
    z[(pixels == 0) | (pixels == 65535) if pixels.dtype.kind == "u" else ~(z > 0)] = np.nan
    if rays is not None:
        across = on_host(rays, "rays").astype(float)
    elif camera is None:
        raise ValueError("clearance: depth needs intrinsics= (fx, fy, cx, cy) or rays=")
    else:
        v, u = np.indices(z.shape)
        across = np.stack([(u - camera[2]) / camera[0], (v - camera[3]) / camera[1]], axis=-1)
    return np.concatenate([across * z[..., None], z[..., None]], axis=-1).reshape(-1, 3)


class Seen:
    """The points of one call, in world coordinates, and the arguments with which the library is asked about them."""

    def __init__(
        self,
        points=None,
        *,
        cloud_pose=None,
        depth=None,
        intrinsics=None,
        rays=None,
        depth_scale=None,
        camera_pose=None,
        clouds=None,
    ):
        if clouds is not None:
            raise ValueError(
                "clearance: clouds=... cannot be drawn, because a Cloud does not give its points back; give "
                "points= or depth="
            )
        if (points is None) == (depth is None):
            raise ValueError("clearance: give either points= or depth=, so that there is something to see")
        self.image = None
        if points is not None:
            self.asked = {"points": points, "cloud_pose": cloud_pose}
            local, pose = as_points(points), pose_of(cloud_pose, "cloud_pose")
        else:
            self.asked = {
                "depth": depth,
                "intrinsics": intrinsics,
                "rays": rays,
                "depth_scale": depth_scale,
                "camera_pose": camera_pose,
            }
            pixels = on_host(depth, "depth")
            if pixels.ndim != 2:
                raise ValueError(f"clearance: depth has the shape (rows, columns), not {pixels.shape}")
            scale = depth_scale if depth_scale is not None else 0.001 if pixels.dtype.kind == "u" else 1.0
            camera, pose = camera_of(intrinsics), pose_of(camera_pose, "camera_pose")
            local = deprojected(pixels, scale, camera, rays)
            self.image = Image(pixels, scale, camera, pose)
        there = np.flatnonzero(np.isfinite(local).all(axis=1))
        self.points = (local[there] @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)

    def drawn(self, most):
        """At most `most` of the points, evenly, and the step between them."""
        step = max(1, -(-len(self.points) // most)) if most else 1
        return np.ascontiguousarray(self.points[::step]), step


def parts_of(robot, poses, nearest=None):
    """The robot's parts where `poses` (parts, 4, 4) puts them; part `nearest` has its own colour."""
    return [
        Part(name, poses[k], *robot.mesh(k), robot.spheres(k), colours.NEAREST_PART if k == nearest else colours.PART)
        for k, name in enumerate(robot.parts)
    ]


def poses_of(robot, joints, poses, base, ignore_limits=False, rest=False):
    """World-from-part of every part."""
    if poses is not None:
        if joints is not None:
            raise ValueError("clearance: give joints= or poses=, not both")
        poses = on_host(poses, "poses").astype(float)
    else:
        poses = np.asarray(robot.poses(joints, base, ignore_limits, rest))
    if poses.shape != (len(robot), 4, 4):
        raise ValueError(
            f"clearance: one configuration is drawn, so poses have the shape ({len(robot)}, 4, 4); not {poses.shape}"
        )
    return poses


def distances_of(robot, points, poses, farthest):
    """Of each point to the robot, metres; inf beyond `farthest`."""
    if not len(points):
        return np.empty(0, np.float32)
    return np.asarray(_core.Query(robot, _core.Distances(d_max=float(farthest)))(points, poses=poses).distance)


def scene(
    robot,
    points=None,
    joints=None,
    *,
    poses=None,
    base=None,
    result=None,
    zones=None,
    margin=None,
    farthest=0.5,
    most=60000,
    colour="distance",
    ignore_limits=False,
    rest=False,
    **seen,
):
    """What is to be seen of one frame.

    Where the robot is, and what is seen (Seen's arguments): as in a call of Query. result: what the library answered
    about this frame; without it, the least distance is asked. zones: thresholds in metres; points in them get the zones' colours.
    Otherwise they are coloured by their distance up to `farthest` metres (colour="distance"), or not at all ("none").
    most: how many points are drawn, evenly chosen (0: all of them); the answer is about all of them. margin: metres,
    said in the title.
    """
    seen = Seen(points, **seen)
    placed = poses_of(robot, joints, poses, base, ignore_limits, rest)
    if result is None:
        result = _core.Query(robot, _core.MinDistance())(poses=placed, **seen.asked)
    return compose(robot, seen, placed, result, zones=zones, margin=margin, farthest=farthest, most=most, colour=colour)


def compose(robot, seen, poses, result, *, zones=None, margin=None, farthest=0.5, most=60000, colour="distance"):
    """The scene of points that were read (Seen), poses and a result."""
    least = least_of(result)
    if not hasattr(least, "nearest") or not hasattr(least, "state"):
        raise ValueError(
            f"clearance: result is what MinDistance or MinDistancePerPart gives, not {type(result).__name__}"
        )
    if colour not in ("distance", "none"):
        raise ValueError(f'clearance: colour is "distance" or "none", not {colour!r}')
    thresholds = sorted(float(z) for z in zones) if zones is not None else []
    if thresholds and not thresholds[0] >= 0:
        raise ValueError(f"clearance: zones are thresholds in metres, 0 or more, not {thresholds}")
    drawn, step = seen.drawn(most)
    distance = None
    if thresholds or colour == "distance":
        distance = distances_of(robot, drawn, poses, thresholds[-1] if thresholds else farthest)
    if thresholds:
        paint = colours.by_zone(distance, thresholds)
    elif distance is not None:
        paint = colours.by_distance(distance, farthest)
    else:
        paint = np.full(drawn.shape, colours.UNKNOWN, np.uint8)
    below = [int(np.count_nonzero(distance <= t)) for t in thresholds]
    any_pair = least.point is not None and least.part is not None
    return Scene(
        parts=parts_of(robot, poses, least.part if any_pair else None),
        points=drawn,
        point_colours=paint,
        distance=distance,
        farthest=thresholds[-1] if thresholds else farthest,
        step=step,
        all_points=len(seen.points),
        segment=np.array([least.nearest, least.at], float) if any_pair else None,
        segment_colour=colours.SEGMENT[least.state.name],
        label=number(least),
        title=sentence(least, margin),
        zones=[Zone(t, colours.of_zone(k), below[k] - (below[k - 1] if k else 0)) for k, t in enumerate(thresholds)],
        image=seen.image,
        result=result,
        margin=margin,
    )
