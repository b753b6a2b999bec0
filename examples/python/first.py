# SPDX-License-Identifier: BSD-3-Clause
"""A link of a robot, three points, and how far they are."""

import sys

import numpy as np

import clearance

# [robot]
# A link of a robot, filled with spheres (x, y, z, radius), and where the link is now. Metres.
robot = clearance.Robot.from_spheres({"link": [[0, 0, 0, 0.10], [0, 0, 0.15, 0.08], [0, 0, 0.3, 0.05]]})
pose = np.eye(4)  # world from link
pose[:3, 3] = 0, 0, 0.5
ask = clearance.Query(robot, clearance.MinDistance())  # once

points = np.array([[0.4, 0, 0.5], [0, 0.2, 0.8], [0, 0, 1.2]], "f4")  # what the sensor sees in this frame
r = ask(points, poses=[pose])  # in every frame
print(r)
print("nearest on the robot:", np.round(r.nearest, 3))
# [robot]

sys.exit(0 if r.point == 1 and r.link == "link" and r.lower > 0.149 and r.upper < 0.151 else 1)
