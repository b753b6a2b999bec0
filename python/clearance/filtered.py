# SPDX-License-Identifier: BSD-3-Clause
"""How far a robot is from all points that are not its own: two questions, one after another, on the CPU."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._core import Cloud, MinDistance, MinDistanceResult, Query, Robot, SelfFilter, SelfFilterResult

if TYPE_CHECKING:
    from ._core import _Array


class FilteredDistance(NamedTuple):
    """What was the robot's own, and the least distance of all other points, which keep their numbers."""

    filter: SelfFilterResult
    rest: MinDistanceResult  # hidden points are dropped as masked; the state is about the others alone

    def __str__(self) -> str:
        return f"{self.rest}; {self.filter}"


@functools.lru_cache(maxsize=16)
def _prepared(robot: Robot, question: Any) -> Query[Any]:
    return Query(robot, question)


def min_distance_filtered(
    robot: Robot,
    points: _Array | Cloud | None = None,
    joints: _Array | Mapping[str, float] | None = None,
    *,
    filter: SelfFilter = SelfFilter(),
    cloud_pose: Any = None,
    depth: _Array | None = None,
    intrinsics: Any = None,
    rays: _Array | None = None,
    depth_scale: float | None = None,
    camera_pose: Any = None,
    clouds: Iterable[_Array | Cloud] | None = None,
    **where: Any,
) -> FilteredDistance:
    """How far `robot` is from all points that `filter` leaves: what its own camera sees of it does not count.

    Where the robot is, and what is seen: as in a call of Query. The robot's two queries are made once. Raises ValueError as a call.
    """
    seen = [cloud if isinstance(cloud, Cloud) else _core.points(cloud) for cloud in clouds or ()]
    if depth is not None:
        seen.insert(0, _core.depth_image(depth, intrinsics, camera_pose, scale=depth_scale, rays=rays))
    elif any(given is not None for given in (intrinsics, rays, depth_scale, camera_pose)):
        raise ValueError("clearance: intrinsics, rays, depth_scale and camera_pose are about depth, which is not given")
    if points is not None:
        seen.insert(0, points if isinstance(points, Cloud) and cloud_pose is None else _core.points(points, cloud_pose))
    elif cloud_pose is not None:
        raise ValueError("clearance: cloud_pose is given without points")
    if not seen and clouds is None:
        raise ValueError("clearance: nothing is given to look at: points, depth or clouds")
    own = _prepared(robot, filter)(clouds=seen, joints=joints, **where)
    begin = own.offsets.tolist()
    rest = [_core.masked(cloud, own.labels[begin[k] : begin[k + 1]]) for k, cloud in enumerate(seen)]
    return FilteredDistance(own, _prepared(robot, MinDistance())(clouds=rest, joints=joints, **where))
