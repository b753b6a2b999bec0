# SPDX-License-Identifier: BSD-3-Clause
"""A cropped cloud is the cloud without the points that are no obstacles by their place in the world."""

import numpy as np
import pytest

import clearance


@pytest.fixture
def robot(rng):
    return clearance.Robot.from_spheres({"a": rng.uniform(0.05, 0.2, (20, 4)), "b": rng.uniform(0.05, 0.2, (9, 4))})


def pose_of(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3] = q * np.sign(np.linalg.det(q))
    pose[:3, 3] = rng.uniform(-1, 1, 3)
    return pose


CROPS = {
    "height": ({"height": (-0.4, 0.7)}, lambda p: (p[:, 2] > -0.4) & (p[:, 2] < 0.7)),
    "inside": ({"inside": [[-1, -1, -0.5], [1, np.inf, 2]]}, lambda p: ((p > [-1, -1, -0.5]) & (p < [1, np.inf, 2])).all(1)),
    "outside": ({"outside": [[-1, -1, -1], [0.5, 1, 1]]}, lambda p: ~((p > [-1, -1, -1]) & (p < [0.5, 1, 1])).all(1)),
    "plane": ({"plane": (0, 2, 0, 0.5, 0.3)}, lambda p: np.abs(p[:, 1] - 0.25) > 0.3),
}


@pytest.mark.parametrize("kind", CROPS)
@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_answers_are_those_of_the_points_that_are_left(kind, dtype, robot, rng):
    arguments, keeps = CROPS[kind]
    points, pose, poses = rng.uniform(-2, 2, (400, 3)).astype(dtype), pose_of(rng), np.stack([pose_of(rng), pose_of(rng)])
    points[3] = np.nan
    with np.errstate(invalid="ignore"):
        kept = keeps(points @ pose[:3, :3].T + pose[:3, 3])
    left = np.where(kept[:, None], points, np.nan).astype(dtype)
    kept &= np.isfinite(points).all(1)  # the point that is none lies in no box, too
    dropped = 399 - kept.sum()
    assert 20 < dropped < 380
    cloud = clearance.cropped(clearance.points(points, pose), **arguments)
    for question in (clearance.MinDistance, clearance.MinDistances, clearance.Zones([0.3, 0.6]), clearance.Distances):
        ask = clearance.Query(robot, question)
        found, expected = ask(clouds=[cloud], poses=poses), ask(clouds=[clearance.points(left, pose)], poses=poses)
        if isinstance(found, clearance.MinDistanceResult):
            assert (found.distance, found.point, found.lower) == (expected.distance, expected.point, expected.lower)
            assert found.dropped["cropped"] == dropped and found.dropped["not_finite"] == 1
        elif isinstance(found, clearance.PointDistances):
            np.testing.assert_array_equal(found.distance, expected.distance)
            assert found.counts.dropped["cropped"] == dropped
        else:
            name = "of" if hasattr(found, "of") and not callable(found.of) else "zones"
            fields = [f for f in getattr(found, name).dtype.names if f != "dropped"]
            for field in fields:
                np.testing.assert_array_equal(getattr(found, name)[field], getattr(expected, name)[field])


def test_crops_add_up_and_an_uncertain_point_counts_if_it_may_be_an_obstacle(robot):
    points = np.array([[0, 0, 3], [0, 0, 1.05]], "f4")
    poses = np.tile(np.eye(4), (2, 1, 1))
    low = clearance.cropped(clearance.points(points), height=(-np.inf, 1))
    least = clearance.Query(robot, clearance.MinDistance)(clouds=[low], poses=poses)
    assert least.state == clearance.State.no_data and least.dropped["cropped"] == 2
    certain = clearance.Query(robot, clearance.CertainDistance)
    assert certain(clouds=[clearance.uncertain(low, shift=0.01)], poses=poses).certain.point is None
    assert certain(clouds=[clearance.uncertain(low, shift=0.1)], poses=poses).certain.point == 1
    assert certain(clouds=[clearance.cropped(clearance.uncertain(clearance.points(points), shift=0.1), height=(-np.inf, 1))],
                   poses=poses).certain.point == 1
    for _ in range(3):
        low = clearance.cropped(low, plane=(0, 0, 1, -5, 0.1))
    with pytest.raises(ValueError, match="more than 4 boxes"):
        clearance.cropped(low, height=(0, 1))


def test_what_an_image_hides_stays_hidden(robot):
    depth, poses = np.full((60, 80), 1500, "u2"), np.tile(np.eye(4), (2, 1, 1))
    camera = np.eye(4)
    camera[2, 3] = -2
    image = clearance.depth_image(depth, (80, 80, 39.5, 29.5), camera)
    cropped = clearance.cropped(image, height=(5, 6))
    ask = clearance.Query(robot, clearance.Unseen)
    whole, behind = ask(clouds=[image], poses=poses), ask(clouds=[cropped], poses=poses)
    assert whole.all.lower == behind.all.lower and whole.all.point == behind.all.point
    assert clearance.Query(robot, clearance.MinDistance)(clouds=[cropped], poses=poses).dropped["cropped"] == depth.size


def test_what_is_no_crop_is_refused():
    cloud = clearance.points(np.zeros((3, 3), "f4"))
    for arguments, sentence in [
        ({}, "needs inside, outside, height or plane"),
        ({"height": 3}, r"height is \(low, high\), metres, not"),
        ({"height": (2, 1)}, "lower end"),
        ({"plane": (0, 0, 0, 1, 1)}, "a normal that is not 0"),
        ({"inside": [[0, 0], [1, 1]]}, r"array of shape \(2, 3\)"),
        ({"height": (0, 1), "pose": np.eye(4)}, "neither is given"),
    ]:
        with pytest.raises(ValueError, match=sentence):
            clearance.cropped(cloud, **arguments)
    with pytest.raises(TypeError, match="what points"):
        clearance.cropped(np.zeros((3, 3)), height=(0, 1))
