# SPDX-License-Identifier: BSD-3-Clause
"""Which way is away? An arm with three joints goes down the slope of its clearance until it is far enough from a wall.

The witness says which point of which link is nearest, and the direction from it to the obstacle. The Jacobian says what
each joint does to that point. Their product is how the clearance changes with each joint.
"""

import pathlib
import sys
import tempfile

import numpy as np
from numpy.typing import NDArray

import clearance

LINK = """<link name="{0}"><collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.05" length="0.4"/></geometry>
</collision></link>"""
JOINT = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 {3}"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>"""
ARM = ('<robot name="arm"><link name="base"/>' + LINK.format("lower") + LINK.format("upper") + LINK.format("hand") +
       JOINT.format("shoulder", "base", "lower", 0) + JOINT.format("elbow", "lower", "upper", 0.4) +
       JOINT.format("wrist", "upper", "hand", 0.4) + "</robot>")


# [gradient]
def slope(robot: clearance.Robot, q: NDArray[np.float64], r: clearance.MinDistanceResult) -> NDArray[np.float64]:
    """Metres of clearance per radian of each joint, or zeros if there is no direction."""
    if r.link is None:
        return np.zeros(len(q))
    velocity = robot.jacobian(q, r.link, r.nearest)[:3]  # of the nearest point on the robot
    return -np.array(r.normal) @ velocity  # the normal points at the obstacle
# [gradient]


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "arm.urdf")
        file.write_text(ARM)
        robot = clearance.Robot.from_urdf(str(file), model="triangles")
    y, z = np.meshgrid(np.linspace(-0.5, 0.5, 101), np.linspace(0, 1.5, 151))
    wall = np.stack([np.full(y.size, 0.65), y.ravel(), z.ravel()], axis=1).astype("f4")
    ask = clearance.Query(robot, clearance.MinDistance())

    wanted, checked, wrong = 0.4, 0, 0
    q = np.array([0.3, 0.2, 0.1])
    r = ask(wall, joints=q)
    for step in range(100):
        if r.lower >= wanted:
            break
        g = slope(robot, q, r)
        for k, turn in enumerate(np.eye(3) * 1e-3):  # the slope is what small steps say
            there, back = ask(wall, joints=q + turn), ask(wall, joints=q - turn)
            if there.point == back.point and there.primitive == back.primitive:  # elsewhere is a kink
                checked += 1
                wrong += abs((there.distance - back.distance) / 2e-3 - g[k]) > 1e-3
        q = q + 0.02 * g / np.linalg.norm(g)
        before, r = r, ask(wall, joints=q)
        if step % 5 == 0:
            print(f"step {step}: {r}")
        wrong += r.distance < before.distance - 1e-3
    print(f"at {np.round(q, 2)}: {r}")
    return 0 if wrong == 0 and checked > 20 and r.lower >= wanted else 1


if __name__ == "__main__":
    sys.exit(main())
