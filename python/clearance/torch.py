# SPDX-License-Identifier: BSD-3-Clause
"""Clearance as a differentiable function of joints, for PyTorch (which is optional)."""

import torch

from ._core import MinDistances, Query, joint_gradients


class _LeastDistances(torch.autograd.Function):
    @staticmethod
    def forward(context, joints, query, seen):
        values = joints.detach().to("cpu", torch.float64).numpy()
        result = query(joints=values, **seen)
        context.about = query.robot, values, result, seen.get("base")
        distances = torch.tensor(result.of["distance"].copy()).reshape(joints.shape[:-1])
        return distances.to(joints)

    @staticmethod
    def backward(context, upstream):
        robot, values, result, base = context.about
        rows = torch.from_numpy(joint_gradients(robot, values, result, base))
        # A distance without a gradient does not change to first order (inside), or is not known to (beyond d_max).
        return torch.nan_to_num(rows).to(upstream) * upstream.unsqueeze(-1), None, None


def least_distances(query, joints, **seen):
    """The least distance of each configuration: joints (..., joints) to distances (...), with a gradient.

    query: a Query of MinDistances. seen: as for the query: points, cloud_pose, depth, clouds, base, and so on. The
    gradient is that of the nearest pair; it is 0 where a distance has none. Raises TypeError for another question.
    """
    if not isinstance(query, Query) or not isinstance(query.question, MinDistances):
        raise TypeError("query is a Query of MinDistances, because the distances of many configurations are asked")
    return _LeastDistances.apply(joints, query, seen)
