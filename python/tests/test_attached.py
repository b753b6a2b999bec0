# SPDX-License-Identifier: BSD-3-Clause
"""A robot that holds something: its joints, many configurations, gradients and motions go on; and without it again."""

import copy
import pickle

import numpy as np
import pytest
from conftest import moved, rigid
from test_errors import refused

import clearance

BOX = ([[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (0, 0.2)],
       [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
        [1, 5, 7], [1, 7, 3]])


@pytest.fixture
def box():
    return clearance.Robot.from_meshes({"box": BOX}, model="triangles")


def at(z):
    pose = np.eye(4)
    pose[2, 3] = z
    return pose


def test_what_is_held_moves_with_its_link(arm, box, rng):
    grip = rigid(rng, 0.1)
    held = arm.attach("hand", box, grip)
    assert held.parts == [*arm.parts, "box"] and held.joints == arm.joints and held.attached == ["box"]
    q, base = rng.uniform(-1, 1, (4, 3)), rigid(rng)
    assert held.poses(q, base)[:, :4] == pytest.approx(arm.poses(q, base), abs=1e-15)
    assert held.poses(q, base)[:, 4] == pytest.approx(arm.poses(q, base)[:, 3] @ grip, abs=1e-12)
    assert held.link_pose("box", q[0], base) == pytest.approx(held.poses(q[0], base)[4], abs=1e-15)
    points = rng.uniform(-1, 1, (300, 3))
    bare, own = (clearance.Query(r, clearance.MinDistances()) for r in (arm, box))
    r = clearance.Query(held, clearance.MinDistances())(points, q, base=base)
    alone = bare(points, q, base=base).of["distance"]
    others = own(points, poses=held.poses(q, base)[:, 4:]).of["distance"]
    assert r.of["distance"] == pytest.approx(np.minimum(alone, others), abs=1e-6)
    assert (r.of["part"] == 4).any() or (others > alone).all()


def test_the_gradient_of_what_is_held_is_that_of_differences(arm, box):
    held = arm.attach("hand", box, at(0.1))
    q, points = np.array([0.3, -0.4, 0.2]), np.array([[0.5, 0.1, 2.0]])
    ask = clearance.Query(held, clearance.MinDistance())
    r = ask(points, q)
    assert r.link == "box"
    row, step = clearance.joint_gradients(held, q, r), 1e-4
    for k in range(3):
        d = np.eye(3)[k] * step
        assert row[k] == pytest.approx((ask(points, q + d).distance - ask(points, q - d).distance) / (2 * step), abs=2e-3)
    j = held.jacobian(q, "box", r.nearest)
    assert -np.array(r.normal) @ j[:3] == pytest.approx(row, abs=1e-6)
    assert held.part_radii(q, 0.001)["joints"][4] >= held.part_radii(q, 0.001)["joints"][3]
    way = clearance.motion_clearance(clearance.Query(held, clearance.MinDistancePerPart()), q, q + 0.1, points)
    assert way.lower <= r.distance


def test_what_is_held_is_released(arm, box, rng):
    ball = clearance.Robot.from_meshes({"tip": BOX}, model="triangles")
    both = arm.attach("hand", box).attach("box", ball, at(0.2))
    assert both.attached == ["box", "tip"] and both.parts[-2:] == ["box", "tip"]
    points, q = rng.uniform(-1, 1, (300, 3)), rng.uniform(-1, 1, 3)
    ask = lambda robot: repr(clearance.Query(robot, clearance.MinDistancePerPart())(points, q))
    assert both.release().parts == arm.parts and both.release().attached == [] and ask(both.release()) == ask(arm)
    assert both.release(["tip"]).attached == ["box"] and ask(both.release(["tip"])) == ask(arm.attach("hand", box))
    refused(lambda: both.release(["box"]), "tip")  # which would hang on nothing
    refused(lambda: both.release(["cup"]), '"cup"', '"box" and "tip"')
    refused(lambda: arm.release(["cup"]), '"cup"')
    for robot in (both, both.release(["tip"])):
        for again in (pickle.loads(pickle.dumps(robot)), copy.deepcopy(robot)):
            assert again.attached == robot.attached and ask(again) == ask(robot)


def test_spheres_hold_spheres(arm_file):
    arm = clearance.Robot.from_urdf(str(arm_file), spheres=64)
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.05]])}, gap=0.01, tolerance=0.002)
    held = arm.attach("eye", ball, at(0.5))  # a link without geometry
    point = moved(held.link_pose("eye", rest=True), [[0, 0, 0.8]])
    r = clearance.Query(held, clearance.MinDistance())(point, rest=True)
    assert r.link == "ball" and r.distance == pytest.approx(0.25, abs=1e-6)
    assert r.lower == pytest.approx(0.25 - 0.012, abs=1e-5)


def test_what_cannot_be_held_is_refused(arm, box, arm_file):
    refused(lambda: arm.attach("claw", box), "claw")
    refused(lambda: arm.attach("hand", clearance.Robot.from_meshes({"hand": BOX}, model="triangles")), '"hand"', "links")
    refused(lambda: arm.attach("hand", clearance.Robot.from_spheres({"a": [[0, 0, 0, 1]]})), "spheres", "triangles")
    refused(lambda: arm.attach("hand", clearance.Robot.from_urdf(str(arm_file), model="triangles")), "joints of its own")
    refused(lambda: arm.attach("hand", box, np.eye(3)), "pose", "(..., 4, 4)")
    refused(lambda: box.attach("box", arm), "joints")
    with pytest.raises(TypeError, match="object is a Robot"):
        arm.attach("hand", BOX)
