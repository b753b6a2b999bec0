# SPDX-License-Identifier: BSD-3-Clause
"""An arm follows its task, and a moving obstacle pushes it aside: an answer about each link gives its distance's lower end and
gradient, and a quadratic program (ProxQP, pip install proxsuite) the joint speeds nearest to the task's.

Each link is a row of a control barrier function: the nearer it is, the more slowly it may approach, also while the obstacle
comes as fast as it may. So no link comes nearer than the margin.
"""

from __future__ import annotations

import importlib
import pathlib
import sys
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

import clearance

proxqp: Any = importlib.import_module("proxsuite").proxqp  # which has no types

LINK = """<link name="{0}"><collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.05" length="0.4"/></geometry>
</collision></link>"""
JOINT = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 {3}"/>
<axis xyz="{4}"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>"""
ARM = ('<robot name="arm"><link name="base"/>' + LINK.format("lower") + LINK.format("upper") + LINK.format("hand") +
       JOINT.format("shoulder", "base", "lower", 0, "0 1 0") + JOINT.format("roll", "lower", "upper", 0.4, "1 0 0") +
       JOINT.format("elbow", "upper", "hand", 0.4, "0 1 0") + "</robot>")

MARGIN, STEP, RATE, FASTEST = 0.08, 0.01, 5.0, 1.5  # metres, seconds, per second, radians per second
APPROACH = 0.3  # metres per second: so fast the obstacle may come
SEEN = 0.6  # metres: links that are farther away need no row


def ball_at(centre: NDArray[np.float64], radius: float = 0.15) -> NDArray[np.float32]:
    """The points of a ball's surface."""
    k = np.arange(600) + 0.5
    turn, z = np.pi * (1 + 5**0.5) * k, 1 - 2 * k / 600
    way = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], axis=1)
    return (centre + radius * way).astype("f4")


def truly(robot: clearance.Robot, points: NDArray[np.float32], q: NDArray[np.float64]) -> float:
    """The least distance of the links' cylinders, without clearance."""
    least = np.inf
    for pose in robot.poses(q, ignore_limits=True):
        x, y, z = pose[:3, :3].T @ (points.astype(float) - pose[:3, 3]).T
        beside, beyond = np.maximum(np.hypot(x, y) - 0.05, 0), np.maximum(np.abs(z - 0.2) - 0.2, 0)
        least = min(least, float(np.hypot(beside, beyond).min()))
    return least


# [rows]
def speeds(robot: clearance.Robot, ask: clearance.Query[clearance.MinDistancesPerPartResult], points: NDArray[np.float32],
           q: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.float64]:
    """The joint speeds nearest to `wanted` with which each link's distance h obeys dh/dt >= -RATE (h - MARGIN)."""
    r = ask(points, joints=q)
    rows = clearance.joint_gradients(robot, q, r)  # (parts, joints), metres per radian
    near = np.isfinite(rows).all(axis=1)  # the others are farther away than d_max
    least = APPROACH - RATE * (r.all["lower"][near].astype(float) - MARGIN)
    # [rows]
    qp = proxqp.dense.QP(len(q), 0, int(near.sum()), True)
    limit = np.full(len(q), FASTEST)
    qp.init(np.eye(len(q)), -wanted, None, None, rows[near], least, None, -limit, limit)
    qp.solve()
    if qp.results.info.status != proxqp.QPSolverOutput.PROXQP_SOLVED:
        return np.zeros(len(q))  # no speeds obey all rows: stop
    return np.asarray(qp.results.x, dtype=np.float64)


def episode(robot: clearance.Robot, guarded: bool) -> tuple[float, float]:
    """The least distance of six seconds, and how far the arm was from its task in the end."""
    ask = clearance.Query(robot, clearance.MinDistancesPerPart(d_max=SEEN))
    task, q, least = np.array([0.6, 0.0, 0.6]), np.array([0.6, 0.0, 0.6]), np.inf
    for step in range(600):
        # It comes from the side, stays where the arm would be, and leaves again.
        away = 0.9 - APPROACH * STEP * min(step, 300) if step < 400 else APPROACH * STEP * (step - 400)
        points = ball_at(np.array([0.45, 0.05 + away, 0.65]))
        wanted = 2 * (task - q)
        q = q + STEP * (speeds(robot, ask, points, q, wanted) if guarded else wanted)
        now = truly(robot, points, q)
        least = min(least, now)
        if guarded and step % 100 == 0:
            print(f"{step * STEP:.0f} s: {np.round(q, 2)}, {now:.3f} m")
    return least, float(np.abs(task - q).max())


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "arm.urdf")
        file.write_text(ARM)
        robot = clearance.Robot.from_urdf(str(file), model="triangles")
    (least, left), (without, _) = episode(robot, True), episode(robot, False)
    print(f"nearest: {least:.3f} m, and {without:.3f} m without rows; {left:.3f} rad from the task in the end")
    return 0 if MARGIN < least < MARGIN + 0.1 and without < MARGIN / 2 and left < 0.05 else 1


if __name__ == "__main__":
    sys.exit(main())
