# SPDX-License-Identifier: BSD-3-Clause
"""What cannot be asked is refused with one sentence, which names the argument and what it got."""

import re
import sys

import numpy as np
import pytest

import clearance
from clearance import _device

good = np.zeros((5, 3), "f4") + 1
one = np.eye(4)[None]


@pytest.fixture
def ball():
    return clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.1]], "f4")})


@pytest.fixture
def ask(ball):
    return clearance.Query(ball, clearance.MinDistance())


def refused(call, *said, kind=ValueError):
    """The sentence with which `call` is refused; it holds all of `said`."""
    with pytest.raises(kind) as error:
        call()
    text = str(error.value)
    assert "\n" not in text.strip(), f"not one sentence: {text}"
    assert not re.search(r"std::|bad_cast|Eigen|nanobind|incompatible function", text), text
    for word in said:
        assert word in text, f"{word!r} is not in: {text}"
    return text


@pytest.mark.parametrize("points, said", [
    (np.zeros((5, 2), "f4"), ["(5, 2)", "float32"]),
    (np.zeros(3, "f4"), ["(3,)"]),
    (np.float32(1), []),
    (np.array(1, "f4"), ["()"]),
    (np.zeros((2, 2, 2, 3), "f4"), ["(2, 2, 2, 3)"]),
    (np.zeros((3, 100), "f4"), ["(3, 100)"]),
    (np.zeros((5, 3), "f2"), ["float16"]),
    (np.zeros((5, 3), "i4"), ["int32"]),
    (np.zeros((5, 3), "u1"), ["uint8"]),
    (np.zeros((5, 3), "c8"), ["complex64"]),
    (np.zeros((5, 3), bool), ["bool"]),
    (np.zeros((5, 3), ">f4"), [">f4"]),
    (np.zeros((5, 3), object), ["object"]),
    ("cloud.pcd", ["str"]),
    (b"123", ["bytes"]),
    (7, ["int"]),
    ({"x": 1}, ["dict"]),
    ([[1, 2, 3], [4, 5]], ["list"]),
    ([["a", "b", "c"]], ["list"]),
    (iter([]), []),
])
def test_points_that_are_none(ask, points, said):
    refused(lambda: ask(points, poses=one), "points", *said)
    refused(lambda: clearance.points(points), "points", *said)


def test_points_of_records_without_their_fields():
    refused(lambda: clearance.points(np.zeros(5, [("x", "f4"), ("y", "f4"), ("w", "f4")])), "points", "no field z", "w")
    refused(lambda: clearance.points(np.zeros(5, [("x", "f4"), ("y", "f4"), ("z", "f8")])), "points", "different types")
    refused(lambda: clearance.points(np.zeros(5, [("x", ">f4"), ("y", ">f4"), ("z", ">f4")])), "points", "byte")
    refused(lambda: clearance.points(np.zeros(5, [("x", "i4"), ("y", "i4"), ("z", "i4")])), "points")
    refused(lambda: clearance.points(np.zeros((2, 3, 5), [("x", "f4"), ("y", "f4"), ("z", "f4")])), "points", "(2, 3, 5)")


def test_arrays_that_run_backwards_say_what_to_do():
    for points in (good[::-1], good[:, ::-1], np.zeros((4, 5, 3), "f4")[::-1], np.zeros((4, 5, 3), "f4")[:, ::-1]):
        refused(lambda: clearance.points(points), "points", "backwards", "numpy.ascontiguousarray")
    camera = (1, 1, 0, 0)
    refused(lambda: clearance.depth_image(np.ones((4, 5), "f4")[::-1], camera), "depth", "backwards")
    refused(lambda: clearance.depth_image(np.ones((4, 5), "f4")[:, ::-1], camera), "depth")
    refused(lambda: clearance.depth_image(np.ones((4, 5), "f4")[:, ::2], camera), "depth", "copy")


def test_rows_that_begin_between_pixels():
    """Whose step is no whole number of pixels: they cannot be read in place, and must not be read elsewhere."""
    rows = np.ndarray((4, 5), "<u2", np.arange(64, dtype="u1").tobytes(), 0, (11, 2))
    refused(lambda: clearance.depth_image(rows, (1, 1, 0, 0)), "depth")


def test_a_masked_array_is_not_read_behind_its_mask(ask):
    masked = np.ma.masked_array(good, mask=False)
    masked[0] = np.ma.masked
    refused(lambda: ask(masked, poses=one), "points", "mask")


@pytest.mark.parametrize("depth, said", [
    (np.zeros((4, 5), "f8"), ["float64"]),
    (np.zeros((4, 5), "i2"), ["int16"]),
    (np.zeros((4, 5), "u1"), ["uint8"]),
    (np.zeros((4, 5), ">u2"), [">u2"]),
    (np.zeros((4, 5, 1), "u2"), ["(4, 5, 1)"]),
    (np.zeros(20, "u2"), ["(20,)"]),
    ("depth.png", ["str"]),
])
def test_depth_images_that_are_none(ask, depth, said):
    refused(lambda: clearance.depth_image(depth, (1, 1, 0, 0)), "depth", *said)
    refused(lambda: ask(depth=depth, intrinsics=(1, 1, 0, 0), poses=one), "depth", *said)


@pytest.mark.parametrize("intrinsics, said", [
    ((1, 1, 0), ["fx, fy, cx, cy"]),
    (np.eye(4), ["(4, 4)"]),
    ((np.nan, 1, 0, 0), ["finite"]),
    ((0, 1, 0, 0), ["focal"]),
    ((-5, 1, 0, 0), ["focal"]),
    ([[500, 1, 320], [0, 500, 240], [0, 0, 1]], ["skew"]),
    ([[500, 0, 320], [0, 500, 240], [0, 0, 2]], ["last row"]),
    ("camera.yaml", ["str"]),
    ({"fx": 1}, ["dict"]),
])
def test_intrinsics_that_are_none(intrinsics, said):
    refused(lambda: clearance.depth_image(np.ones((4, 5), "f4"), intrinsics), "intrinsics", *said)


def test_a_depth_image_needs_a_camera_and_only_one():
    image, rays = np.ones((4, 5), "f4"), np.zeros((4, 5, 2), "f4")
    refused(lambda: clearance.depth_image(image), "intrinsics", "rays")
    refused(lambda: clearance.depth_image(image, (1, 1, 0, 0), rays=rays), "intrinsics", "rays")
    refused(lambda: clearance.depth_image(image, rays=rays[:3]), "rays", "(4, 5, 2)", "(3, 5, 2)")
    refused(lambda: clearance.depth_image(image, rays=rays.astype("f8")), "rays", "float64")
    refused(lambda: clearance.depth_image(image, (1, 1, 0, 0), nearest=2, farthest=1), "farthest")
    refused(lambda: clearance.depth_image(image, (1, 1, 0, 0), nearest=np.nan), "nearest")


@pytest.mark.parametrize("scale", [0, -1, np.nan, np.inf, "mm"])
def test_a_scale_is_above_0(scale):
    refused(lambda: clearance.depth_image(np.ones((4, 5), "f4"), (1, 1, 0, 0), scale=scale), "scale",
            kind=(ValueError, TypeError))


@pytest.mark.parametrize("sensor", [(0, 0), "here", 3, (np.nan, 0, 0)])
def test_a_sensor_is_a_place(sensor):
    refused(lambda: clearance.points(good, sensor=sensor), "sensor", kind=(ValueError, TypeError))


def test_limits_of_points_that_cannot_be():
    for limits in ({"nearest": -1}, {"nearest": np.nan}, {"farthest": np.nan}, {"nearest": 2, "farthest": 1}):
        refused(lambda: clearance.points(good, **limits), "nearest", "farthest")


def bad_poses():
    """Poses that are none, and a word of what is wrong."""
    yield np.full((4, 4), np.nan), ""
    broken = np.eye(4)
    broken[0, 3] = np.inf
    yield broken, ""
    yield np.diag([2.0, 2, 2, 1]), "scale"
    yield np.diag([1.0, 1, -1, 1]), "mirror"
    sheared = np.eye(4)
    sheared[0, 1] = 0.1
    yield sheared, ""
    last = np.eye(4)
    last[3] = (0, 0, 1, 1)
    yield last, "last row"
    yield np.zeros((4, 4)), ""


@pytest.mark.parametrize("number", range(7))
def test_poses_that_are_not_rigid(ask, arm, number):
    pose, word = list(bad_poses())[number]
    for call in (lambda: ask(good, poses=pose[None]), lambda: ask(good, poses=one, cloud_pose=pose),
                 lambda: ask(clearance.points(good, pose), poses=one),
                 lambda: clearance.Query(arm, clearance.MinDistance())(good, base=pose, rest=True),
                 lambda: ask(depth=np.ones((4, 4), "f4"), intrinsics=(1, 1, 0, 0), camera_pose=pose, poses=one)):
        text = refused(call)
        assert re.search("pose|base", text), text
        if word == "last row":
            assert word in text


@pytest.mark.parametrize("poses, said", [
    (np.eye(3), "(3, 3)"),
    (np.eye(4)[:3], "(3, 4)"),
    (np.zeros(16), "(16,)"),
    ("identity", "str"),
    (np.eye(4).astype(object), ""),
    (3, "int"),
    ([[1, 2], [3]], "list"),
])
def test_poses_of_wrong_shapes(ask, poses, said):
    if isinstance(poses, np.ndarray) and poses.dtype == object:
        assert ask(good, poses=poses[None]).valid == 5  # numbers in another wrapping
        return
    refused(lambda: ask(good, poses=poses), "poses", "(..., 4, 4)", said)
    refused(lambda: ask(good, poses=one, cloud_pose=poses), "(..., 4, 4)", said)
    refused(lambda: clearance.points(good, poses), "pose", "(..., 4, 4)", said)


def test_as_many_poses_as_parts():
    robot = clearance.Robot.from_spheres({"a": np.ones((1, 4)), "b": np.ones((1, 4))})
    text = refused(lambda: clearance.Query(robot, clearance.MinDistance())(good, poses=one))
    assert "2" in text and "1" in text
    text = refused(lambda: clearance.Query(robot, clearance.MinDistances())(good, poses=np.stack([np.eye(4)] * 3)))
    assert "2" in text and "3" in text
    refused(lambda: clearance.points(good, np.stack([np.eye(4)] * 2)), "pose", "(2, 4, 4)")


def test_joints_that_cannot_be(arm):
    ask = clearance.Query(arm, clearance.MinDistance())
    refused(lambda: ask(good, joints=[0, 0]), "joints", "3", "list")
    refused(lambda: ask(good, joints=np.zeros(4)), "joints", "(4,)")
    refused(lambda: ask(good, joints=np.zeros((2, 3))), "8 poses", "4 parts")
    refused(lambda: ask(good, joints=[0, np.nan, 0]), "elbow")
    refused(lambda: ask(good, joints=[0, 9, 0]), "elbow", "9")
    assert ask(good, joints=[0, 9, 0], ignore_limits=True).valid == 5
    refused(lambda: ask(good, joints={"elbo": 1}), "elbo")
    refused(lambda: ask(good, joints={"elbow": "up"}), "joints")
    refused(lambda: ask(good, joints="home"), "joints", "str")
    refused(lambda: ask(good, joints=0), "joints", "int")
    refused(lambda: arm.poses(np.zeros(5)), "joints", "(5,)")
    refused(lambda: arm.link_pose("nose"), "nose")
    refused(lambda: arm.jacobian([0, 0, 0], "nose", (0, 0, 0)), "nose")
    refused(lambda: arm.jacobian([0, 0, 0], 17, (0, 0, 0)), "17")
    refused(lambda: arm.jacobian([0, 0], 0, (0, 0, 0)), "joints")
    refused(lambda: arm.jacobian(np.zeros((2, 3)), 0, (0, 0, 0)), "joints")


@pytest.mark.parametrize("part", [-1, 1.5, None])
def test_a_jacobian_of_no_part(arm, part):
    refused(lambda: arm.jacobian([0, 0, 0], part, (0, 0, 0)), "part", kind=(ValueError, TypeError))


def test_a_robot_without_joints_has_none(ball, ask):
    refused(lambda: ask(good, joints=[1]), "joints")
    refused(lambda: ball.poses([1]), "joints")
    two = clearance.Robot.from_spheres({"a": np.ones((1, 4)), "b": np.ones((1, 4))})
    refused(lambda: clearance.Query(two, clearance.MinDistance())(good), "poses")


def test_what_would_be_ignored_is_refused(ask, arm):
    refused(lambda: ask(poses=one), "points", "depth", "clouds")
    refused(lambda: ask(cloud_pose=np.eye(4), depth=np.ones((4, 4), "f4"), intrinsics=(1, 1, 0, 0), poses=one), "cloud_pose")
    refused(lambda: ask(good, poses=one, intrinsics=(1, 1, 0, 0)), "intrinsics", "depth")
    refused(lambda: ask(good, poses=one, camera_pose=np.eye(4)), "camera_pose", "depth")
    refused(lambda: ask(good, poses=one, depth_scale=0.001), "depth_scale", "depth")
    refused(lambda: clearance.Query(arm, clearance.MinDistance())(good, joints=[0, 0, 0], poses=arm.poses(rest=True)), "poses",
            "joints")
    refused(lambda: ask(good, poses=one, base=np.eye(4)), "poses", "base")
    refused(lambda: ask(good, poses=one, stream=1), "stream", "CUDA")
    refused(lambda: ask(good, poses=one, question=clearance.Distances()), "MinDistance", "Distances", kind=TypeError)
    refused(lambda: ask(clouds=[good, "b"], poses=one), "str")


def test_a_cloud_has_its_pose_already(ask):
    refused(lambda: ask(clearance.points(good), poses=one, cloud_pose=np.eye(4)), "cloud_pose")


@pytest.mark.parametrize("clouds", [5, good])
def test_clouds_are_a_sequence_of_clouds(ask, clouds):
    refused(lambda: ask(clouds=clouds, poses=one), "clouds", kind=(ValueError, TypeError))


@pytest.mark.parametrize("make, said", [
    (lambda: clearance.Distances(dmax=1), ["Distances", "dmax", "d_max"]),
    (lambda: clearance.MinDistance(1), ["MinDistance", "0", "1"]),
    (lambda: clearance.MinDistance(margin=1), ["MinDistance", "margin"]),
    (lambda: clearance.Distances(1, True, 3), ["Distances", "2", "3"]),
    (lambda: clearance.Distances(1, d_max=2), ["d_max", "twice"]),
    (lambda: clearance.Distances("far"), ["d_max", "number", "'far'"]),
    (lambda: clearance.Distances(which=1), ["which", "True or False"]),
    (lambda: clearance.NearestK(1.5), ["k", "whole number"]),
    (lambda: clearance.NearestK(-1), ["k", "whole number"]),
    (lambda: clearance.InCollision("0.1"), ["margins"]),
    (lambda: clearance.InCollision([None]), ["margins"]),
    (lambda: clearance.Zones(None), ["thresholds"]),
    (lambda: clearance.PartWitnesses("all"), ["minima"]),
    (lambda: clearance.Unseen(0.1), ["Unseen", "room is a Hiding", "0.1"]),
    (lambda: clearance.Hiding("near"), ["Hiding", "nearest", "number"]),
    (lambda: clearance.CertainDistance(0.1), ["CertainDistance", "parts", "sequence of tuples", "0.1"]),
    (lambda: clearance.CertainDistance([0.1, 0.2]), ["parts", "sequence of tuples"]),
    (lambda: clearance.CertainDistance(np.ones((3, 2))), ["parts", "sequence of tuples"]),
    (lambda: clearance.CertainDistance([(0.1, 0, 0)]), ["parts", "sequence of tuples"]),
    (lambda: clearance.uncertain(good), ["cloud", "points(...)"]),
    (lambda: clearance.StereoNoise(424, 0.05, "s"), ["StereoNoise", "disparity", "number"]),
])
def test_options_that_are_none(make, said, recwarn, capfd):
    refused(make, *said, kind=TypeError)
    assert capfd.readouterr().err == "" and len(recwarn) == 0


@pytest.mark.parametrize("question, said", [
    (clearance.Distances(np.nan), "d_max"),
    (clearance.NearestK(0), "k is 0"),
    (clearance.InCollision([0.1, 0.2, 0.3]), "3 margins"),
    (clearance.InCollision(np.nan), "margin"),
    (clearance.Within([]), "radii"),
    (clearance.Within(np.nan), "radius"),
    (clearance.Zones([0.2, 0.1]), "threshold"),
    (clearance.Zones([]), "threshold"),
    (clearance.Zones([-0.1]), "threshold"),
    (clearance.SelfFilter(-0.1), "padding"),
    (clearance.Unseen(clearance.Hiding(0.0)), "unseen room is from"),
    (clearance.Unseen(labels=[0, 1, 0]), "3 labels"),
    (clearance.Unseen(), "asked about depth images"),
    (clearance.MinDistanceSupported(min_points=0), "0 points"),
    (clearance.CertainDistance([(0.1, 0), (0, 0)]), "1 parts, but 2 radii"),
    (clearance.CertainDistance([(-0.1, 0)]), "radius by its joints"),
    (clearance.CertainDistance([(0, np.nan)]), "radius by a delay"),
])
def test_options_that_the_question_refuses(ball, question, said):
    refused(lambda: clearance.Query(ball, question)(good, poses=one), said)


@pytest.mark.parametrize("options, said", [
    ({"noise": 0.1}, ["noise", "KinectNoise", "radii"]),
    ({"noise": clearance.MinDistance()}, ["noise", "KinectNoise"]),
    ({"noise": clearance.StereoNoise()}, ["focal length and baseline", "above 0"]),
    ({"noise": clearance.StereoNoise(424, 0.05, -1)}, ["disparity", "0 or more"]),
    ({"noise": clearance.TofNoise()}, ["TofNoise(", "0 a metre away", "None"]),
    ({"noise": clearance.LidarNoise(0.01, k=0)}, ["LidarNoise(", "0 a metre away"]),
    ({"noise": clearance.KinectNoise(np.nan)}, ["k", "0 or more"]),
    ({"noise": clearance.LidarNoise(0.01, np.inf)}, ["LiDAR", "0 or more"]),
    ({"noise": np.zeros(2, "f4")}, ["3 points", "2 radii"]),
    ({"noise": np.zeros(3)}, ["radii", "float32", "float64"]),
    ({"noise": np.zeros(6, "f4")[::2]}, ["gaps"]),
    ({"noise": np.array([0, -1, 0], "f4")}, ["radius of point 1", "0 or more"]),
    ({"noise": np.array([0, 0, np.nan], "f4")}, ["radius of point 2", "0 or more"]),
    ({"shift": -1}, ["shift", "0 or more"]),
    ({"turn": np.nan}, ["turn", "0 or more"]),
    ({"max_speed": np.inf}, ["speed", "0 or more"]),
    ({"max_speed": 1, "age": -1}, ["age", "0 or more"]),
])
def test_what_cannot_be_uncertain(options, said):
    cloud = clearance.points(np.ones((3, 3), "f4"))
    refused(lambda: clearance.uncertain(cloud, **options), *said)


def test_an_uncertain_cloud_is_for_its_question(ball):
    cloud = clearance.uncertain(clearance.points(good), shift=0.01)
    within, certain = (clearance.Query(ball, q) for q in (clearance.Within(0.1), clearance.CertainDistance()))
    refused(lambda: within(cloud, poses=one), "uncertain", "Within", "CertainDistance", "Zones")
    refused(lambda: clearance.uncertain(cloud), "uncertain already")
    refused(lambda: certain(cloud, poses=one, cloud_pose=np.eye(4)), "cloud_pose")


def test_part_radii_that_cannot_be(arm, ball):
    refused(lambda: arm.part_radii([0, 0, 0], [0.1, 0.2]), "3 values", "2 errors")
    refused(lambda: arm.part_radii([0, 0, 0], -0.1), "error of joint", "0 or more")
    refused(lambda: arm.part_radii([0, 0, 0], speeds=np.nan, delay=1), "speed of joint", "finite")
    refused(lambda: arm.part_radii([0, 0, 0], delay=-1), "delay", "0 or more")
    refused(lambda: arm.part_radii([0, 0, 0], "much"), "errors", "number")
    refused(lambda: arm.part_radii([[0, 0, 0]], 0.1), "joints", "one configuration")
    refused(lambda: ball.part_radii([], 0.1), "no joints")


def test_numbers_of_numpy_are_options():
    assert clearance.NearestK(np.int64(4)).k == 4
    assert clearance.Distances(np.float32(0.5)).d_max == 0.5
    assert clearance.InCollision(np.float64(0.5)).margins == (0.5,)
    assert clearance.InCollision(np.float32(0.5)).margins == (0.5,)
    assert clearance.InCollision(np.array([0.5, 0.25])).margins == (0.5, 0.25)
    assert clearance.InCollision(1).margins == (1.0,)


def test_without_the_gpu_part_the_sentence_says_how_to_get_it(ball, monkeypatch):
    monkeypatch.setitem(sys.modules, "clearance._cuda", None)
    monkeypatch.delattr(clearance, "_cuda", raising=False)
    refused(_device.door, "the GPU part is not in this installation", "CLEARANCE_CUDA=1 pip install .", kind=ImportError)


def test_a_query_on_the_cpu_enqueues_nothing(ball):
    ask = clearance.Query(ball, clearance.MinDistance())
    refused(lambda: ask.enqueue(np.zeros((1, 3), "f4"), rest=True), "enqueue is for a query on a CUDA device", "on the cpu")
    refused(lambda: ask(np.zeros((1, 3), "f4"), rest=True, stream=1), "stream is for a query on a CUDA device")
    refused(lambda: clearance.DeviceArray(np.zeros(3), "cpu"), "lies on a CUDA device")


def test_what_is_no_question_or_device(ball):
    for question in (5, "MinDistance", None, clearance.State.free):
        refused(lambda: clearance.Query(ball, question), "question", "MinDistance()", kind=TypeError)
    for device in ("gpu", "cuda:", "cuda:x", "cuda:-1", ""):
        refused(lambda: clearance.Query(ball, clearance.MinDistance(), device=device), "device", "cpu")
    with pytest.raises(ValueError, match="device"):
        clearance.Query(ball, clearance.MinDistance(), device="cuda:99999999999999999999")


def test_robots_that_cannot_be(tmp_path, arm_file):
    make = clearance.Robot
    refused(lambda: make.from_urdf(str(tmp_path / "none.urdf")), "none.urdf", kind=(RuntimeError, OSError))
    (tmp_path / "bad.urdf").write_text("<robot")
    refused(lambda: make.from_urdf(str(tmp_path / "bad.urdf")), "bad.urdf", kind=RuntimeError)
    refused(lambda: make.from_urdf(str(arm_file), model="cubes"), "model", "cubes", "spheres", "triangles")
    refused(lambda: make.from_urdf(str(arm_file), geometry="both"), "geometry", "both", "collision", "visual")
    refused(lambda: make.from_urdf(str(arm_file), model="triangles", spheres=5), "spheres")
    refused(lambda: make.from_urdf(str(arm_file), exclude_links=["nose"], model="triangles"), "nose",
            kind=(ValueError, RuntimeError))
    refused(lambda: make.from_spheres({"a": np.ones((2, 3))}), "spheres", "a", "(2, 3)", "(n, 4)")
    refused(lambda: make.from_spheres({"a": np.ones((1, 4))}, gap=-1), "gap")
    refused(lambda: make.from_spheres({"a": np.ones((1, 4))}, tolerance=np.nan), "tolerance")
    refused(lambda: make.from_meshes({"a": 5}), "a", "int")
    refused(lambda: make.from_meshes({"a": (np.ones((3, 2)), [[0, 1, 2]])}), "a", "(n, 3)")
    refused(lambda: make.from_meshes({"a": (np.ones((3, 3)), [[0, 1, 3]])}, model="triangles"), "a", "vertex 3")
    refused(lambda: make.from_meshes({"a": (np.ones((3, 3)), [[0, 1, -1]])}, model="triangles"), "a", "-1")
    refused(lambda: make.from_meshes({"a": (np.full((3, 3), np.nan), [[0, 1, 2]])}, model="triangles"), "a",
            kind=(ValueError, RuntimeError))
    refused(lambda: make.from_meshes({"a": str(tmp_path / "none.stl")}), "none.stl", kind=(RuntimeError, OSError))


@pytest.mark.parametrize("spheres", [0, -1, "many", 2.5])
def test_a_number_of_spheres(arm_file, spheres):
    refused(lambda: clearance.Robot.from_urdf(str(arm_file), spheres=spheres), "spheres", kind=(ValueError, TypeError))


@pytest.mark.parametrize("radius", [np.nan, -1.0])
def test_a_sphere_that_is_none_is_named_with_its_part(radius):
    refused(lambda: clearance.Robot.from_spheres({"upper arm": [[0, 0, 0, radius]]}), "upper arm")


def test_triangles_are_whole_numbers():
    refused(lambda: clearance.Robot.from_meshes({"a": (np.eye(3), [[0.5, 1, 2]])}, model="triangles"), "triangle")


def test_parts_that_are_not_there(ball, arm):
    for call in (ball.spheres, arm.mesh):
        for part in (len(arm), 10**8, -1, 10**30):
            refused(lambda: call(part), "part", kind=IndexError)
        for part in (0.0, None):
            refused(lambda: call(part), "part", kind=TypeError)
        refused(lambda: call("claw"), "no part \"claw\"")


def test_minima_of_another_frame_have_no_witness(ball, ask):
    minima = clearance.Query(ball, clearance.MinDistancePerPart())(good, poses=one).parts
    moved = np.stack([np.eye(4)])
    moved[0, 0, 3] = 0.25
    text = refused(lambda: clearance.Query(ball, clearance.PartWitnesses(minima))(good, poses=moved))
    assert "minimum" in text
    text = refused(lambda: clearance.Query(ball, clearance.PartWitnesses(np.repeat(minima, 2)))(good, poses=one))
    assert "1" in text and "2" in text
