# SPDX-License-Identifier: BSD-3-Clause
"""What is kept for later, or sent to another process, is what it was: results, queries, clouds and cameras; and what a
result says as a dictionary and as a line."""

import copy
import json
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import random_robot, rigid
from test_questions import configurations, plain
from test_values import ask_all

import clearance


def ways(value):
    return pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)


def same(one, other):
    """To the bit, also within nested dictionaries; NaN is itself."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, np.ndarray):
        if one.dtype.names:  # without the bytes between the fields
            return one.dtype == other.dtype and all(same(one[name].copy(), other[name].copy()) for name in one.dtype.names)
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return type(one) is type(other) and repr(one) == repr(other)


def members(result):
    return [m for m in dir(result) if not m.startswith("_") and not callable(getattr(result, m))]


def test_results_are_pickled_and_copied_in_every_bit(rng):
    for name, result in ask_all(rng):
        for again in ways(result):
            assert type(again) is type(result), name
            if isinstance(result, np.ndarray):
                assert same(result, again)
                continue
            assert repr(again) == repr(result) and str(again) == str(result), name
            assert same(again.to_dict(), result.to_dict()), name
            for array in (getattr(again, m) for m in members(again)):
                assert not isinstance(array, np.ndarray) or not array.flags.writeable, name


def test_what_a_result_is_asked_after_it_was_pickled(rng):
    s = plain(rng)
    within = pickle.loads(pickle.dumps(s.ask(clearance.Within(0.3))))
    assert within.certain.lower(0.2, 1) == s.ask(clearance.Within(0.3)).certain.lower(0.2, 1) > 0.19
    zones = pickle.loads(pickle.dumps(s.ask(clearance.Zones([0.1, 0.3]))))
    assert zones.innermost() == s.ask(clearance.Zones([0.1, 0.3])).innermost()
    with pytest.raises((ValueError, TypeError, RuntimeError)):
        type(zones).__new__(type(zones)).__setstate__(((1,), (None, b"", ())))


def test_a_result_as_a_dictionary(rng):
    for name, result in ask_all(rng):
        if isinstance(result, np.ndarray):
            continue
        said = result.to_dict()
        assert set(said) == set(members(result)), name
        for member, value in said.items():
            its = getattr(result, member)
            if isinstance(its, np.ndarray):
                assert same(value, its) and not np.shares_memory(value, its) and value.flags.writeable
            elif isinstance(its, clearance.State):
                assert value == its.name
            elif hasattr(its, "to_dict"):
                assert same(value, its.to_dict())
            else:
                assert same(value, its)
        json.dumps(said, default=lambda array: array.tolist())


def test_a_result_is_one_line(rng):
    lines = {}
    for name, result in ask_all(rng):
        if isinstance(result, np.ndarray):
            continue
        lines[name] = str(result)
        assert "\n" not in lines[name] and not lines[name].startswith(type(result).__name__), name
    assert lines["InCollisions"].startswith(f"{len(configurations(plain(rng))[0])} configurations: ")
    ball = clearance.Robot.from_spheres({"hand": np.array([[0, 0, 0, 0.25]], "f4")})
    points = np.array([[0.5, 0, 0], [1, 0, 0], [np.nan, 0, 0]], "f4")

    def said(question, **more):
        return str(clearance.Query(ball, question)(points, **{"poses": np.eye(4)[None], **more}))

    assert said(clearance.MinDistancePerPart()) == (
        "free: 0.250 m (certainly 0.250 to 0.250), hand to point 0; of 1 part"
    )
    assert said(clearance.InCollision(0.3)) == "collision: hand to point 0"
    assert said(clearance.InCollision(0.1)) == "free: of 2 valid points none is within the margins"
    assert said(clearance.Zones([0.3, 1])) == "zone 0 of 2 is entered: 1 point"
    assert said(clearance.Zones([0.1])) == "no zone of 1 is entered"
    assert said(clearance.Within(1)) == "2 pairs within the radius, of 2 valid points"
    assert said(clearance.NearestK(1)) == "the nearest 1 pair, at most 1 a part, of 2 valid points"
    assert said(clearance.Distances()) == "distances of 2 valid points, the least 0.250 m"
    assert said(clearance.DistancesPerPart()) == "distances of 2 valid points, the least 0.250 m, from each of 1 part"
    assert said(clearance.SelfFilter(0.3)) == "1 of 2 valid points are the robot's own, 0 uncertain"
    many = np.tile(np.eye(4), (3, 1, 1, 1))
    many[1, 0, 0, 3] = 0.1
    assert said(clearance.MinDistances(), poses=many) == (
        "3 configurations, the nearest is number 1: free: 0.150 m (certainly 0.150 to 0.150), hand to point 0"
    )
    assert said(clearance.InCollisions(0.2), poses=many) == "3 configurations: 2 free, 1 collision"
    assert str(clearance.Query(ball, clearance.Distances())(points, poses=np.eye(4)[None]).counts) == (
        "2 of 3 points valid, 1 not_finite"
    )


def clouds(rng):
    points, pose = rng.uniform(-1, 1, (50, 3)), rigid(rng)
    image = rng.integers(0, 3000, (6, 8)).astype("u2")
    yield clearance.points(points, pose, nearest=0.1, farthest=1.2, sensor=(0.1, 0, 0), zero_is_missing=True)
    yield clearance.points(points.astype("f4"))
    yield clearance.depth_image(image, (5, 5, 4, 3), pose, scale=0.002, farthest=4)
    yield clearance.depth_image(image, rays=rng.uniform(-1, 1, (6, 8, 2)).astype("f4"))
    yield clearance.masked(clearance.points(points), np.arange(50) % 3 == 0)


def test_clouds_are_pickled_and_copied(rng):
    robot, _, poses = random_robot(rng)
    ask = clearance.Query(robot, clearance.MinDistance())
    for cloud in clouds(rng):
        for again in ways(cloud):
            assert len(again) == len(cloud) and again.device == "cpu" and repr(again) == repr(cloud)
            assert repr(ask(again, poses=poses)) == repr(ask(cloud, poses=poses))
    certain = clearance.Query(robot, clearance.CertainDistance())
    for noise in (None, clearance.KinectNoise(), rng.uniform(0, 0.1, 50).astype("f4")):
        cloud = clearance.uncertain(clearance.points(rng.uniform(-1, 1, (50, 3))), noise, shift=0.01, age=0.1, max_speed=1)
        for again in ways(cloud):
            assert repr(certain(again, poses=poses)) == repr(certain(cloud, poses=poses))
    assert repr(clearance.points(np.zeros((3, 3)))) == "<Cloud of 3 points on cpu>"


def test_a_copy_of_a_cloud_sees_the_same_array_and_a_deep_copy_its_own(rng):
    array = np.array([[2, 0, 0]], "f4")
    ball = clearance.Robot.from_spheres({"a": np.array([[0, 0, 0, 0.5]], "f4")})
    ask = clearance.Query(ball, clearance.MinDistance())
    cloud = clearance.points(array)
    view, own = copy.copy(cloud), copy.deepcopy(cloud)
    array[0, 0] = 3
    assert [ask(each, rest=True).distance for each in (cloud, view, own)] == [2.5, 2.5, 1.5]


def test_cameras_are_pickled_and_copied():
    k = np.array([[300.0, 0, 160], [0, 300, 120], [0, 0, 1]])
    lens = clearance.Camera(320, 240, k, [-0.2, 0.03, 0, 0, 0], "plumb_bob", binning=[2, 2], roi=[20, 10, 200, 100])
    k[0, 0] = 1  # a copy is of what the camera is
    for again in ways(lens):
        assert (again.width, again.height, again.intrinsics) == (lens.width, lens.height, lens.intrinsics)
        assert again.rays().tobytes() == lens.rays().tobytes() and repr(again) == "<Camera of 100 x 50 pixels>"


def test_queries_are_pickled_and_copied(arm, rng):
    points, q = rng.uniform(-1, 1, (200, 3)), rng.uniform(-1, 1, 3)
    ask = clearance.Query(arm, clearance.InCollision([0.2]), threads=1)
    for again in ways(ask):
        assert (again.question, again.device, again.threads) == (ask.question, "cpu", 1)
        assert repr(again(points, q)) == repr(ask(points, q)) and repr(again) == repr(ask)
    assert copy.copy(ask).robot is arm


def test_another_process_reads_what_this_one_kept(rng, tmp_path):
    s = plain(rng)
    kept = {"cloud": clearance.points(s.asked["points"]), "ask": clearance.Query(s.robot, clearance.MinDistance())}
    kept["result"] = kept["ask"](kept["cloud"], poses=s.poses)
    (tmp_path / "kept").write_bytes(pickle.dumps({**kept, "poses": s.poses}))
    program = (
        "import pickle, sys; k = pickle.load(open(sys.argv[1], 'rb'))\n"
        "assert repr(k['ask'](k['cloud'], poses=k['poses'])) == repr(k['result']); print(k['result'])"
    )
    ran = subprocess.run([sys.executable, "-c", program, str(tmp_path / "kept")], capture_output=True, text=True)
    assert ran.returncode == 0 and ran.stdout.strip() == str(kept["result"]), ran.stderr
