# SPDX-License-Identifier: BSD-3-Clause
"""Clearance as a differentiable function of joints and points, for PyTorch (which is optional)."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from ._core import MinDistances, MinDistancesPerPart, MinDistancesPerPartResult, MinDistancesResult, Query, joint_gradients, none


class _FirstOnly(torch.autograd.Function):
    """Rows of a first derivative, which change with `by` in a way that is not known."""

    @staticmethod
    def forward(context, rows, *by):
        return rows.clone()

    @staticmethod
    def backward(context, upstream):
        raise RuntimeError("clearance: the second derivative of distances is not known")


def _all(result):
    return result.all if isinstance(result, MinDistancesPerPartResult) else result.of


class _LeastDistances(torch.autograd.Function):
    @staticmethod
    def forward(context, joints, points, query, seen):
        values = joints.detach().to("cpu", torch.float64).numpy().copy()  # they may change before backward
        given = {} if points is None else {"points": points.detach() if isinstance(points, torch.Tensor) else points}
        result = query(joints=values, **given, **seen)
        context.about = query.robot, values, result, seen
        context.by = [each for each in (joints, points) if isinstance(each, torch.Tensor)]
        per_part = isinstance(result, MinDistancesPerPartResult)
        shape = (*joints.shape[:-1], result.parts) if per_part else joints.shape[:-1]
        return torch.tensor(_all(result)["distance"].copy()).reshape(shape).to(joints)

    @staticmethod
    def backward(context, upstream):
        robot, values, result, seen = context.about
        by_joints = by_points = None
        if context.needs_input_grad[0]:
            rows = joint_gradients(robot, values, result, seen.get("base"), seen.get("ignore_limits", False))
            # Without a gradient the distance does not change to first order, or is not known to.
            known = torch.nan_to_num(torch.from_numpy(rows)).to(upstream)
            by_joints = _FirstOnly.apply(known, *context.by) * upstream.unsqueeze(-1)
            if isinstance(result, MinDistancesPerPartResult):
                by_joints = by_joints.sum(-2)
        if context.needs_input_grad[1]:
            of, pose, points = _all(result).reshape(-1), seen.get("cloud_pose"), context.by[-1]
            turn = np.eye(3) if pose is None else np.asarray(pose.cpu() if isinstance(pose, torch.Tensor) else pose)[:3, :3]
            moves = (of["part"] != none) & (of["cloud"] == 0) & np.isfinite(of["distance"]) & (of["distance"] != 0)
            rows = _FirstOnly.apply(torch.from_numpy(of["normal"][moves].astype("f8") @ turn), *context.by)
            each = upstream.reshape(-1)[torch.from_numpy(moves).to(upstream.device)].to("cpu", torch.float64)
            zeros = torch.zeros((points.numel() // 3, 3), dtype=torch.float64)
            nearest = torch.from_numpy(of["point"][moves].astype("i8"))
            by_points = zeros.index_add(0, nearest, rows * each.unsqueeze(-1)).reshape(points.shape).to(points)
        return by_joints, by_points, None, None


def least_distances(
    query: Query[MinDistancesResult] | Query[MinDistancesPerPartResult], joints: torch.Tensor, points: Any = None, **seen: Any
) -> torch.Tensor:
    """The least distance of each configuration: joints (..., joints), floating, to distances (...), metres.

    query: a Query of MinDistances; or of MinDistancesPerPart, for (..., parts). points, and seen (cloud_pose, depth, clouds,
    base, and so on) as for the query. Gradients are those of the nearest pairs; 0 where a distance has none. Raises TypeError for
    another question, for joints of integers, and if another argument requires a gradient; RuntimeError for a second
    derivative.
    """
    if not isinstance(query, Query) or not isinstance(query.question, (MinDistances, MinDistancesPerPart)):
        raise TypeError("query is a Query of MinDistances or MinDistancesPerPart, because many configurations are asked about")
    if not isinstance(joints, torch.Tensor):
        raise TypeError(f"joints is a tensor of torch, not {type(joints).__name__}")
    if not joints.is_floating_point():
        raise TypeError(f"joints is a floating tensor, of which distances have a gradient, not {joints.dtype}")
    for name, value in seen.items():
        each = value if name == "clouds" and isinstance(value, (list, tuple)) else [value]
        if any(isinstance(v, torch.Tensor) and v.requires_grad for v in each):
            raise TypeError(f"{name} requires a gradient, and only joints and points have one: give {name}.detach()")
    return _LeastDistances.apply(joints, points, query, seen)
