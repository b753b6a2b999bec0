# SPDX-License-Identifier: BSD-3-Clause
"""A plan is watched: all of its configurations in every frame, and the robot stops before the first that is too near.

An arm swings about its shoulder. In the third frame somebody puts a ball into its way.
"""

import pathlib
import sys
import tempfile

import numpy as np
from numpy.typing import ArrayLike, NDArray

import clearance

ARM = """<robot name="arm">
  <link name="base"><collision><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision></link>
  <link name="arm">
    <collision><origin xyz="0.4 0 0"/><geometry><box size="0.8 0.1 0.1"/></geometry></collision>
  </link>
  <joint name="swing" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.25"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>"""


def ball(centre: tuple[float, float, float], radius: float) -> NDArray[np.float32]:
    """What a sensor sees of a ball."""
    directions = np.random.default_rng(1).normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return (np.array(centre) + radius * directions).astype("f4")


# [monitor]
def first_too_near(ask: "clearance.Query[clearance.MinDistancesResult]", seen: ArrayLike, plan: NDArray[np.float64],
                   margin: float) -> int | None:
    """The number of the first configuration that is not certainly farther away than the margin."""
    of = ask(seen, joints=plan).of
    near = np.flatnonzero(~(of["lower"] > margin))  # 0 in a collision and without a valid point, so both stop
    return int(near[0]) if len(near) else None
# [monitor]


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "arm.urdf")
        file.write_text(ARM)
        robot = clearance.Robot.from_urdf(str(file), model="triangles")
    margin = 0.05
    ask = clearance.Query(robot, clearance.MinDistances(d_max=2 * margin))  # what is farther away costs little
    plan = np.linspace(-1.5, 1.5, 301)[:, None]  # a joint value for each configuration
    wall = ball((-2, 0, 0.3), 0.3)
    frames = [wall, wall, np.concatenate([wall, ball((0.7, 0.3, 0.25), 0.05)])]
    stops = [first_too_near(ask, seen, plan, margin) for seen in frames]
    for number, stop in enumerate(stops):
        print(f"frame {number}: " + ("go on" if stop is None else f"stop before configuration {stop}, at {plan[stop, 0]:.2f} rad"))

    # The ball's centre is 0.762 m away at 0.405 rad, and reaches 0.05 m; half of the arm is 0.05 m wide.
    angle = np.arctan2(0.3, 0.7) - plan[:, 0]
    x, y = np.hypot(0.3, 0.7) * np.cos(angle), np.hypot(0.3, 0.7) * np.sin(angle)
    exact = np.hypot(np.maximum(x - 0.8, 0), np.maximum(np.abs(y) - 0.05, 0)) - 0.05
    expected = int(np.flatnonzero((exact < margin) & (x > 0))[0])
    nothing = first_too_near(ask, np.full((10, 3), np.nan), plan, margin)
    print(f"without a valid point: stop before configuration {nothing}")
    return 0 if stops[:2] == [None, None] and stops[2] in (expected, expected + 1) and nothing == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
