# SPDX-License-Identifier: BSD-3-Clause
"""play(): each row is what the library and NumPy say of that frame; what cannot be asked is unknown."""

import csv
import json
import math
import pickle
import subprocess
import sys

import numpy as np
import pytest

import clearance
from clearance import __main__ as command
from clearance import playing, recordings

pytest.importorskip("rosbags", reason="rosbags is not installed (extra ros)")
from test_recordings import (  # noqa: E402
    LENSES,
    MS,
    START,
    about_z,
    cloud_message,
    compressed_message,
    image_message,
    info_message,
    joint_message,
    make,
    tf_message,
    transform,
    write_bag,
)

URDF = """<robot name="pair">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.1 0.1"/></geometry></collision></link>
  <link name="wheel"><collision><origin xyz="0.1 0 0"/>
    <geometry><box size="0.2 0.1 0.05"/></geometry></collision></link>
  <link name="eye"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="spin" type="continuous"><parent link="arm"/><child link="wheel"/>
    <origin xyz="0.7 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="eye"/>
    <origin xyz="0.2 0 0.1" rpy="0 1.5707963 0"/></joint>
</robot>"""
K = (60.0, 61.0, 39.5, 29.5)


@pytest.fixture(scope="module")
def urdf(tmp_path_factory):
    file = tmp_path_factory.mktemp("robot") / "pair.urdf"
    file.write_text(URDF)
    return file


@pytest.fixture(scope="module")
def robot(urdf):
    return clearance.Robot.from_urdf(str(urdf), spheres=64)


def shoulder(stamp):
    return 1.5 * math.sin((stamp - START) / 1e9 * 5)


def camera_at(stamp):
    """The pose of the moving camera in the base, and its transform's parts."""
    seconds = (stamp - START) / 1e9
    return (1.5 + 0.2 * seconds, 0.1, 0.4), about_z(math.pi / 2 + 0.3 * seconds)


def scene(stamp, count=400):
    random = np.random.default_rng(stamp % 2**32)
    points = random.uniform(-1, 1, (count, 3)) + [0, 1, 0]
    points[::50] = np.nan
    return points


def depth_scene(stamp, kind):
    image = 0.6 + 0.4 * np.random.default_rng(stamp % 2**31).random((60, 80))
    image[10:14] = 0
    return (image * 1000).astype("<u2") if kind == "u2" else image.astype("<f4")


def drive(frames=8, joints=True, transforms=True, infos=True):
    """A recording in which a camera and a robot move: joints each 20 ms, transforms each 30, frames each 50."""
    messages = [
        (
            "/tf_static",
            START,
            tf_message(
                transform(0, "base", "mast"),
                transform(0, "rig", "camera", (0, 0, 0.05)),
                transform(0, "rig", "lidar", (0, 0, -0.1), about_z(0.5)),
            ),
        )
    ]
    for k in range(frames * 50 // 20 + 8 if joints else 0):
        stamp = START + k * 20 * MS
        messages.append(
            (
                "/joint_states",
                stamp + MS,
                joint_message(stamp, {"shoulder": shoulder(stamp), "other": 9, "spin": k * 0.5}),
            )
        )
    for k in range(frames * 50 // 30 + 6 if transforms else 0):
        stamp = START + k * 30 * MS
        messages.append(("/tf", stamp + 2 * MS, tf_message(transform(stamp, "mast", "rig", *camera_at(stamp)))))
    for k in range(frames):
        stamp = START + k * 50 * MS + 7 * MS
        messages.append(("/lidar/points", stamp + 60 * MS, cloud_message(stamp, "lidar", scene(stamp))))
        messages.append(("/depth/image_raw", stamp + 30 * MS, image_message(stamp, "camera", depth_scene(stamp, "u2"))))
        messages.append(("/far/image", stamp + 30 * MS, image_message(stamp, "camera", depth_scene(stamp, "f4"))))
        messages.append(("/colour/image_raw", stamp, image_message(stamp, "camera", np.zeros((6, 8, 3), "u1"), "rgb8")))
        if infos:
            messages.append(("/depth/camera_info", stamp + 31 * MS, info_message(stamp, "camera", (60, 80), K)))
            messages.append(
                ("/far/camera_info", stamp + 31 * MS, info_message(stamp, "camera", (60, 80), K, LENSES[0][1]))
            )
    return messages


def bag(folder, messages, kind="mcap"):
    write_bag(folder, sorted(messages, key=lambda each: each[1]), kind)
    return folder


@pytest.fixture(scope="module")
def drive_bag(tmp_path_factory):
    return bag(tmp_path_factory.mktemp("drive") / "bag", drive())


def interpolated(stamp, of, step):
    """Linear between the samples around a stamp."""
    before = START + (stamp - START) // (step * MS) * step * MS
    part = (stamp - before) / (step * MS)
    return of(before) + part * (of(before + step * MS) - of(before))


def expected(robot, topic, stamp, question=None):
    """The library, asked directly, with poses that this test computes in its own way."""
    joints = [interpolated(stamp, shoulder, 20), interpolated(stamp, lambda at: (at - START) / (20 * MS) * 0.5, 20)]
    rig = np.eye(4)
    rig[:3, 3] = interpolated(stamp, lambda at: np.array(camera_at(at)[0]), 30)
    turn = math.pi / 2 + 0.3 * (stamp - START) / 1e9  # at an even pace, so slerp is linear
    rig[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    if topic == "/lidar/points":
        mount = np.eye(4)
        mount[:3, 3] = 0, 0, -0.1
        mount[:2, :2] = [[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]]
        cloud = clearance.points(scene(stamp).astype(np.float32), rig @ mount)
    else:
        mount = np.eye(4)
        mount[2, 3] = 0.05
        if topic == "/far/image":
            lens = recordings.camera(info_message(0, "", (60, 80), K, LENSES[0][1]), (60, 80))
            cloud = clearance.depth_image(depth_scene(stamp, "f4"), pose=rig @ mount, **lens)
        else:
            cloud = clearance.depth_image(depth_scene(stamp, "u2"), K, rig @ mount)
    ask = clearance.Query(robot, question or clearance.MinDistance())
    return ask(clouds=[cloud], joints=joints, ignore_limits=True)


def test_each_row_is_what_the_library_says(robot, drive_bag):
    rows = list(clearance.playing.play(drive_bag, robot, check=True))
    assert [row.topic for row in rows].count("/lidar/points") == 8 and len(rows) == 24
    kinds = set()
    for row in rows:
        stamp = round((row.stamp - START / 1e9) * 1000) * MS + START
        result = expected(robot, row.topic, stamp)
        kinds.add(row.state)
        assert row.note == "" and row.state == result.state.name
        assert row.distance == pytest.approx(result.distance, abs=1e-6)
        assert (row.lower, row.upper) == pytest.approx((result.lower, result.upper), abs=1e-6)
        assert (row.link, row.point, row.seen, row.valid) == (result.link, result.point, result.seen, result.valid)
        assert row.at == pytest.approx(result.at, abs=1e-5) and row.nearest == pytest.approx(result.nearest, abs=1e-5)
        assert row.dropped == {name: count for name, count in result.dropped.items() if count}
        assert row.checked == pytest.approx(row.distance, abs=1e-5)
    assert "free" in kinds
    assert len({round(row.distance, 4) for row in rows}) > 15


def test_a_database_gives_the_same_rows(robot, drive_bag, tmp_path):
    other = bag(tmp_path / "bag", drive(), "sqlite3")
    assert list(playing.play(other, robot)) == list(playing.play(drive_bag, robot))


def test_topics_and_questions_can_be_said(robot, drive_bag):
    rows = list(playing.play(drive_bag, robot, topics="/lidar/points", question=clearance.MinDistancePerPart()))
    assert [row.topic for row in rows] == ["/lidar/points"] * 8
    for row in rows:
        assert list(row.parts) == robot.parts and min(row.parts.values()) == pytest.approx(row.distance, abs=1e-6)
    some = list(
        playing.play(drive_bag, robot, topics=["/far/image"], question=clearance.MinDistanceSupported(3, 0.1, 100))
    )
    assert len(some) == 8 and all(row.state == "free" and row.seen == 4800 for row in some)
    near = list(playing.play(drive_bag, robot, topics="/lidar/points", farthest=0.9, check=True))
    assert all(
        row.dropped["out_of_range"] > 10 and row.checked == pytest.approx(row.distance, abs=1e-5) for row in near
    )
    high = list(playing.play(drive_bag, robot, topics="/lidar/points", crop=[{"height": (50, 60)}]))
    assert all(row.state == "no_data" and row.dropped["cropped"] > 10 for row in high)
    for options, says in (
        ({"crop": [{"height": (2, 1)}]}, "lower end"),
        ({"crop": [{"height": (1, 2)}], "check": True}, "crop leaves some out"),
        ({"question": clearance.NearestK(3, 1.0)}, "NearestK"),
        ({"topics": "/none"}, "/none is not in the recording"),
        ({"topics": "/tf"}, "is a tf2_msgs/msg/TFMessage"),
        ({"joints": {"elbow": 1}}, "no joint 'elbow'"),
        ({"joint_topic": "/tf"}, "/tf is no JointState"),
        ({"tf_topics": "/x"}, "/x is no TFMessage"),
        ({"max_age": -1}, "max_age"),
    ):
        with pytest.raises(ValueError, match=says):
            playing.play(drive_bag, robot, **options)


def test_a_check_finds_a_wrong_distance(robot, drive_bag):
    row = next(playing.play(drive_bag, robot, check=True))
    assert playing.agree(row)
    row.distance += 1e-3
    assert not playing.agree(row)
    row.distance = math.nan
    assert not playing.agree(row)
    triangles = clearance.Robot.from_meshes(
        {"a": (np.eye(4, 3), [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])}, model="triangles"
    )
    with pytest.raises(ValueError, match="spheres"):
        playing.play(drive_bag, triangles, check=True)


def test_the_check_is_the_least_of_all_pairs():
    random = np.random.default_rng(5)
    spheres = {name: np.c_[random.uniform(-1, 1, (40, 3)), random.uniform(0.01, 0.2, 40)] for name in "abc"}
    robot = clearance.Robot.from_spheres(spheres)
    for _ in range(5):
        points = random.uniform(-4, 4, (500, 3))
        poses = np.tile(np.eye(4), (3, 1, 1))
        poses[:, :3, 3] = random.uniform(-2, 2, (3, 3))
        plain = min(
            (np.linalg.norm(points[:, None] - s[:, :3] - at[:3, 3], axis=2) - s[:, 3]).min()
            for at, s in zip(poses, spheres.values(), strict=True)
        )
        assert playing.by_numpy(robot, poses, points) == pytest.approx(plain, abs=1e-6)
    assert math.isnan(playing.by_numpy(robot, poses, points[:0]))


def unknown(rows, says):
    for row in rows:
        assert row.state == "unknown" and says in row.note, row
        assert row.lower == 0 and row.upper == math.inf and math.isnan(row.distance)


def test_what_is_missing_is_unknown(robot, tmp_path):
    rows = list(playing.play(bag(tmp_path / "a", drive(joints=False)), robot))
    assert len(rows) == 24
    unknown(rows, "no JointState names the joint 'shoulder'")
    rows = list(playing.play(bag(tmp_path / "b", drive(transforms=False)), robot))
    assert len(rows) == 24
    unknown(rows, "no transforms join")
    rows = list(playing.play(bag(tmp_path / "c", drive(infos=False)), robot))
    unknown([row for row in rows if "image" in row.topic], "no CameraInfo was seen on /")
    assert all(row.state != "unknown" for row in rows if "points" in row.topic) and len(rows) == 24
    rows = list(playing.play(tmp_path / "c", robot, base_frame="nowhere"))
    unknown([row for row in rows if "points" in row.topic], "no transform names the frame 'nowhere'")


def test_a_joint_can_be_said(robot, tmp_path):
    messages = [each for each in drive() if each[0] != "/joint_states"]
    messages += [
        ("/joint_states", START + k * 20 * MS, joint_message(START + k * 20 * MS, {"shoulder": 0.5})) for k in range(30)
    ]
    folder = bag(tmp_path / "bag", messages)
    unknown(playing.play(folder, robot), "no JointState names the joint 'spin'")
    assert all(row.state != "unknown" for row in playing.play(folder, robot, joints={"spin": 1.0}))


def test_joints_that_end_are_stale(robot, tmp_path):
    messages = [each for each in drive(40) if each[0] != "/joint_states" or each[1] < START + 500 * MS]
    rows = list(playing.play(bag(tmp_path / "bag", messages), robot, topics="/lidar/points"))
    known = [row for row in rows if row.state != "unknown"]
    assert len(rows) == 40 and all(row.stamp - START / 1e9 < 0.6 for row in known) and len(known) >= 10
    unknown(rows[len(known) :], "JointState of 'shoulder': the nearest is")


def test_several_joint_states_are_not_mixed(robot, tmp_path):
    more = [("/wanted/states", START, joint_message(START, {"shoulder": 1.0}))]
    folder = bag(tmp_path / "a", drive() + more)
    assert all(row.state != "unknown" for row in playing.play(folder, robot))  # /joint_states by its name
    unknown(playing.play(folder, robot, joint_topic="/wanted/states", joints={"shoulder": 1.0}), "the joint 'spin'")
    renamed = [("/left/states" if topic == "/joint_states" else topic, *rest) for topic, *rest in drive() + more]
    with pytest.raises(ValueError, match="/left/states, /wanted/states"):
        playing.play(bag(tmp_path / "b", renamed), robot)


def test_static_transforms_that_are_said_late_hold(robot, tmp_path):
    messages = drive()
    messages[0] = ("/tf_static", START + 10_000 * MS, messages[0][2])
    assert all(row.state != "unknown" for row in playing.play(bag(tmp_path / "bag", messages), robot))


def test_a_camera_on_the_robot_needs_no_transforms(robot, tmp_path):
    """Where no transform names the sensor, its frame is a link of the robot."""
    messages = [
        ("/joint_states", START + k * 20 * MS, joint_message(START + k * 20 * MS, {"shoulder": k * 0.1, "spin": 0}))
        for k in range(20)
    ]
    stamp = START + 110 * MS
    messages.append(("/eye/points", stamp, cloud_message(stamp, "eye", scene(stamp))))
    row = next(playing.play(bag(tmp_path / "bag", messages), robot))
    joints = [0.55, 0]
    result = clearance.Query(robot, clearance.MinDistance())(
        scene(stamp).astype(np.float32), joints, cloud_pose=robot.link_pose("eye", joints)
    )
    assert row.state == result.state.name and row.distance == pytest.approx(result.distance, abs=1e-6)


def test_the_root_is_not_a_link_that_only_starts_there(tmp_path):
    """At rest the turret is where the root is. Joints move it, so it is not the frame in which the robot stands."""
    file = tmp_path / "turret.urdf"
    box = '<collision><origin xyz="0.5 0 0"/><geometry><box size="0.2 0.2 0.2"/></geometry></collision>'
    file.write_text(f"""<robot name="turret"><link name="plate"/><link name="turret">{box}</link>
      <joint name="turn" type="revolute"><parent link="plate"/><child link="turret"/><axis xyz="0 0 1"/>
      <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>""")
    turret = clearance.Robot.from_urdf(str(file), spheres=32)
    messages = [
        (
            "/tf",
            START,
            tf_message(transform(START, "plate", "turret", turn=about_z(1.0)), transform(START, "plate", "lidar")),
        ),
        ("/joint_states", START, joint_message(START, {"turn": 1.0})),
        ("/points", START, cloud_message(START, "lidar", [[1.0, 0.0, 0.0]])),
    ]
    row = next(playing.play(bag(tmp_path / "bag", messages), turret))
    result = clearance.Query(turret, clearance.MinDistance())(np.array([[1.0, 0, 0]], np.float32), [1.0])
    assert row.distance == pytest.approx(result.distance, abs=1e-6) and row.distance > 0.5


def test_a_wheel_turns_the_shorter_way(robot, tmp_path):
    assert playing.Watch(robot).turns == {"spin"}
    file = tmp_path / "wheels.urdf"
    wheel = URDF.replace('"wheel"', '"other"').split('<link name="other">')[1].split("</link>")[0]
    joint = """<joint name="{0}" type="continuous"><parent link="base"/><child link="{0}"/><mimic joint="{1}"/></joint>"""
    links = "".join(f'<link name="{name}">{wheel}</link>' for name in ("second", "third"))
    file.write_text(URDF.replace("</robot>", links + joint.format("third", "second") + joint.format("second", "spin"))
                    + "</robot>")  # fmt: skip
    assert playing.Watch(str(file)).turns == {"spin", "second", "third"}


def test_parts_without_a_urdf_are_placed_by_transforms(tmp_path):
    balls = clearance.Robot.from_spheres({"rig": np.array([[0, 0, 0, 0.1]]), "mast": np.array([[0, 0, 0, 0.2]])})
    rows = list(playing.play(bag(tmp_path / "bag", drive()), balls, topics="/lidar/points", check=True))
    assert len(rows) == 8
    for row in rows:
        stamp = round((row.stamp - START / 1e9) * 1000) * MS + START
        points = scene(stamp)[~np.isnan(scene(stamp)[:, 0])].astype(np.float32)
        assert row.distance <= np.linalg.norm(points - [0, 0, 0.1], axis=1).min() - 0.1 + 1e-6
        assert row.checked == pytest.approx(row.distance, abs=1e-5) and row.state in ("free", "collision")


def test_a_broken_message_is_unknown_and_the_rest_is_played(robot, tmp_path):
    messages = drive(3)
    index = next(k for k, each in enumerate(messages) if each[0] == "/lidar/points")
    messages[index][2].fields = messages[index][2].fields[:2]
    rows = list(playing.play(bag(tmp_path / "bag", messages), robot, topics="/lidar/points"))
    assert len(rows) == 3
    unknown(rows[:1], "no field z")
    assert all(row.state != "unknown" for row in rows[1:])


def test_a_cloud_without_valid_points_is_no_data(robot, tmp_path):
    messages = [each for each in drive(2) if each[0] != "/lidar/points"]
    stamp = START + 7 * MS
    messages.append(("/empty", stamp, cloud_message(stamp, "lidar", np.full((9, 3), np.nan))))
    row = next(playing.play(bag(tmp_path / "bag", messages), robot, topics="/empty"))
    assert (row.state, row.lower, row.upper, row.point, row.at) == ("no_data", 0, math.inf, None, None)
    assert (row.seen, row.valid, row.dropped) == (9, 0, {"not_finite": 9})


def test_clouds_in_other_units_are_hinted_at_and_scaled(robot, urdf, tmp_path, capsys):
    def with_clouds(name, scale):
        messages = [each for each in drive(2) if each[0] != "/lidar/points"]
        for k in range(2):
            stamp = START + (7 + 50 * k) * MS
            messages.append(("/lidar/points", stamp + 60 * MS, cloud_message(stamp, "lidar", scene(stamp) * scale)))
        return bag(tmp_path / name, messages)

    metres = list(playing.play(with_clouds("metres", 1), robot, topics="/lidar/points"))
    assert [row.note for row in metres] == ["", ""]
    thousand = with_clouds("millimetres", 1000)
    for row, right in zip(playing.play(thousand, robot, topics="/lidar/points"), metres, strict=True):
        assert row.distance > 50 and "no point is within 50 m of the robot: are they in metres? (cloud_scale)" in row.note
    scaled = playing.play(thousand, robot, topics="/lidar/points", cloud_scale=0.001, check=True)
    for row, right in zip(scaled, metres, strict=True):
        assert row.note == "" and row.state == right.state and row.point == right.point
        assert row.distance == pytest.approx(right.distance, abs=1e-5)
    tiny = list(playing.play(with_clouds("kilometres", 1e-3), robot, topics="/lidar/points"))
    assert "as large as the cloud: what is its unit? (cloud_scale)" in tiny[0].note and tiny[1].note == ""
    arguments = ("--robot", urdf, "--spheres", 64, "--topic", "/lidar/points", "--cloud-scale")
    status, out, _ = played(capsys, thousand, *arguments, 0.001)
    assert status == 0 and "50 m" not in out
    for scale in (0, -1, "inf", "nan"):
        status, _, err = played(capsys, thousand, *arguments[:-1], f"--cloud-scale={scale}")
        assert status == 1 and "metres per unit; it is from 1e-9 to 1e9" in err


def test_a_truncated_recording_gives_its_rows_and_a_sentence(robot, tmp_path):
    messages = drive(60)
    file = write_bag(tmp_path / "bag", sorted(messages, key=lambda each: each[1]))
    whole = list(playing.play(file, robot))
    file.write_bytes(file.read_bytes()[: int(file.stat().st_size * 0.6)])
    found = []
    with pytest.raises(recordings.Damaged, match="truncated or damaged"):
        for row in playing.play(file, robot):
            found.append(row)
    known = [row for row in found if row.state != "unknown"]
    assert 0.3 * len(whole) < len(known) and known == whole[: len(known)]
    rows = playing.rows(file, robot)
    assert [str(row) for row in rows[:-1]] == [str(row) for row in found]
    unknown(rows[-1:], "truncated or damaged")
    file.write_bytes(file.read_bytes()[:3000])  # not even a topic is left
    with pytest.raises(recordings.Damaged, match="truncated or damaged"):
        playing.play(file, robot)
    unknown(playing.rows(file, robot), "truncated or damaged")


def test_rows_and_recipes_travel_to_workers(robot, urdf, drive_bag):
    recipe = pickle.loads(pickle.dumps({"file": str(urdf), "spheres": 64}))
    rows = pickle.loads(pickle.dumps(playing.rows(drive_bag, recipe)))
    assert rows == list(playing.play(drive_bag, robot))


def test_play_does_not_read_ahead(robot, tmp_path):
    file = write_bag(tmp_path / "bag", sorted(drive(200), key=lambda each: each[1]))
    rows = playing.play(file, robot)
    next(rows)
    data = file.read_bytes()
    with open(file, "r+b") as damaged:  # in place, while it is open
        damaged.seek(len(data) * 3 // 4)
        damaged.write(bytes(len(data) // 8))
    seen = 1
    with pytest.raises(ValueError, match="damaged after"):
        for _ in rows:
            seen += 1
    assert 200 < seen < 600


def test_stamps_keep_their_nanoseconds(robot, tmp_path):
    odd = START + 7 * MS + 123
    messages = [each for each in drive(1) if each[0] in ("/tf_static", "/tf", "/joint_states")]
    messages += [("/lidar/points", odd, cloud_message(odd + k, "lidar", scene(odd))) for k in range(3)]
    folder = bag(tmp_path / "bag", messages)
    rows = list(playing.play(folder, robot))
    assert [row.stamp_ns for row in rows] == [odd, odd + 1, odd + 2] and len({row.stamp for row in rows}) == 1
    only = list(playing.play(folder, robot, only={(odd + 1, "/lidar/points")}))
    assert [row.note for row in only] == ["not asked", "", "not asked"]
    with playing.Csv(tmp_path / "a.csv") as table:
        for row in rows:
            table.write(row)
    with open(tmp_path / "a.csv", newline="") as file:
        assert [int(line["stamp_ns"]) for line in csv.DictReader(file)] == [odd, odd + 1, odd + 2]


def compressed_drive(frames=6):
    """The drive, whose images were also compressed."""
    messages = drive(frames)
    more = []
    for topic, log_time, message in messages:
        if topic in ("/depth/image_raw", "/far/image"):
            stamp = recordings.nanoseconds(message.header.stamp)
            image = depth_scene(stamp, "u2" if topic.startswith("/depth") else "f4")
            for by in ("png", "rvl"):
                packed = compressed_message(stamp, "camera", image, by=by, farthest=5.0)
                where = topic if by == "png" else f"{topic}/rvl"
                more.append((f"{where}/compressedDepth", log_time, packed))
    return [each for each in messages if "points" not in each[0]] + more


def test_compressed_depth_is_played_as_the_image_that_was_packed(urdf, tmp_path):
    robot = clearance.Robot.from_urdf(str(urdf), model="triangles")  # exact, so that the bracket is about the image
    info = {
        f"{topic}/rvl/compressedDepth": f"/{topic.split('/')[1]}/camera_info" for topic in ("/depth/image_raw", "/far/image")
    }
    played = playing.play(bag(tmp_path / "bag", compressed_drive()), robot, camera_info=info)
    rows = list(played)
    assert len(rows) == 36 and played.notes == ["no depth, so not played: /colour/image_raw (rgb8)"]
    of = {(row.topic, row.stamp_ns): row for row in rows}
    quantised = 0
    for row in rows:
        assert row.state != "unknown", row.note
        if "compressed" not in row.topic:
            continue
        whole = of[row.topic.replace("/rvl", "").removesuffix("/compressedDepth"), row.stamp_ns]
        if row.topic.startswith("/depth"):
            assert (row.distance, row.lower, row.upper, row.point) == (whole.distance, whole.lower, whole.upper, whole.point)
            continue
        # Inverse depths were rounded: the bracket holds what was measured, and is no wider than it must be.
        assert row.lower <= whole.distance <= row.upper and row.upper - row.lower < 5e-4
        assert row.seen == whole.seen and row.valid == whole.valid
        quantised += row.distance != whole.distance
    assert quantised > 8
    with pytest.raises(ValueError, match=r"cloud_scale is for PointCloud2s, and none of the topics that are played is one; .*/far/"):
        playing.play(bag(tmp_path / "again", compressed_drive()), robot, topics="/far/image", cloud_scale=0.001)


def test_what_quantised_depth_hides_is_not_free(tmp_path):
    """A surface 0.1 mm before the robot, seen from 3 m away: coarse inverse depths put it 0.4 m farther."""
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 4.0, 0.5]])})
    image = np.full((9, 9), 3.4999, "f4")
    lens = info_message(START, "camera", (9, 9), (60.0, 60, 4, 4))
    frames = {"/raw/image": image_message(START, "camera", image)}
    for step in (1.0, 100.0):
        frames[f"/{step:g}/image/compressedDepth"] = compressed_message(START, "camera", image, step=step, farthest=20.0)
    messages = [("/tf_static", START, tf_message(transform(0, "camera", "ball")))]
    messages += [(topic, START, message) for topic, message in frames.items()]
    messages += [(f"/{topic.split('/')[1]}/camera_info", START, lens) for topic in frames]
    for question in (clearance.MinDistance(), clearance.MinDistancePerPart(), clearance.MinDistanceSupported(3, 0.5, 50)):
        rows = {row.topic: row for row in playing.play(bag(tmp_path / type(question).__name__, messages), ball,
                                                       question=question)}  # fmt: skip
        assert rows["/raw/image"].state == "free"
        coarse = rows["/1/image/compressedDepth"]
        assert coarse.state == "possible" and coarse.lower == 0 and coarse.upper >= rows["/raw/image"].upper
        for row in rows.values():
            assert row.lower <= rows["/raw/image"].distance <= row.upper


def test_a_limit_of_depth_comes_after_what_its_rounding_may_hide(tmp_path):
    """A surface within `farthest` that coarse depths put just beyond it is not dropped from what is certain."""
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 2.5, 0.4]])})
    image = np.full((9, 9), 2.0, "f4")
    image[0, 0] = 1.0  # so that something is within in any case
    lens = info_message(START, "camera", (9, 9), (60.0, 60, 4, 4))
    messages = [("/tf_static", START, tf_message(transform(0, "camera", "ball")))]
    for step in (1.0, 3.0, 10.0, 100.0):
        packed = compressed_message(START, "camera", image, step=step, farthest=20.0)
        messages += [(f"/{step:g}/image/compressedDepth", START, packed), (f"/{step:g}/camera_info", START, lens)]
    decoded = {}
    for row in playing.play(bag(tmp_path / "bag", messages), ball, farthest=2.001):
        found, off = recordings.compressed_depth(dict((t, m) for t, _, m in messages)[row.topic])
        decoded[row.topic] = found[4, 4] > 2.001
        assert row.lower <= 0.1 <= row.upper + decoded[row.topic] and row.lower >= 0.1 - 2.2 * off[4, 4]
    assert set(decoded.values()) == {True, False}


def test_sensors_that_are_not_read_are_named(robot, tmp_path):
    scan = make("sensor_msgs/msg/LaserScan", header=make("std_msgs/msg/Header", stamp=make(
        "builtin_interfaces/msg/Time", sec=0, nanosec=0), frame_id="lidar"), angle_min=0.0, angle_max=1.0,
        angle_increment=0.1, time_increment=0.0, scan_time=0.0, range_min=0.0, range_max=9.0, ranges=np.ones(3, "f4"),
        intensities=np.zeros(0, "f4"))  # fmt: skip
    jpeg = make("sensor_msgs/msg/CompressedImage", header=scan.header, format="bgr8; jpeg compressed bgr8",
                data=np.zeros(3, np.uint8))  # fmt: skip
    messages = [*drive(2), ("/scan", START, scan), ("/colour/image_raw/compressed", START, jpeg)]
    folder = bag(tmp_path / "bag", messages)
    played = playing.play(folder, robot)
    assert len(list(played)) == 6
    assert played.notes == [
        "not read: /scan (sensor_msgs/msg/LaserScan)",
        "no depth, so not played: /colour/image_raw (rgb8), /colour/image_raw/compressed (bgr8; jpeg compressed bgr8)",
    ]
    assert playing.rows(folder, robot).notes == played.notes
    named = playing.play(folder, robot, topics=["/lidar/points"])  # who names topics knows of the others
    assert len(list(named)) == 2 and named.notes == []
    only = [each for each in messages if each[0] in ("/scan", "/tf_static")]
    with pytest.raises(ValueError, match=r"there is no PointCloud2 and no depth Image to play; .*/scan \("):
        playing.play(bag(tmp_path / "scan", only), robot)
    only = [each for each in messages if each[0] in ("/colour/image_raw/compressed", "/tf_static")]
    with pytest.raises(ValueError, match="only /colour/image_raw/compressed .bgr8; jpeg"):
        list(playing.play(bag(tmp_path / "jpeg", only), robot))


GRIPPER = """<robot name="gripper"><link name="hand"/>
  <link name="left"><collision><geometry><box size="0.1 0.02 0.1"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.1 0.02 0.1"/></geometry></collision></link>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/></joint>
  <joint name="grip2" type="prismatic"><parent link="hand"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/><mimic joint="grip"/></joint></robot>"""


@pytest.mark.parametrize(
    ("published", "joints", "distance", "note"),
    [
        ({"grip": 0.01}, {}, 0.08, ""),
        ({"grip": 0.01, "grip2": 0.01}, {}, 0.08, ""),
        ({"grip": 0.01, "grip2": 0.0104}, {}, 0.0796, ""),
        ({"grip": 0.01, "grip2": 0.04}, {}, 0.05, "grip2 is at 0.04 as published, not at 0.01 as <mimic> says"),
        ({"grip": 0.01, "grip2": 0.06}, {}, 0.03, "grip2 is at 0.06 as published"),  # an encoder beyond its limit
        ({"grip": 0.01}, {"grip2": 0.04}, 0.05, "grip2 is at 0.04 as given, not at 0.01 as <mimic> says"),
        ({"grip": 0.01, "grip2": 0.02}, {"grip2": 0.04}, 0.05, "grip2 is at 0.04 as given"),
    ],
)
def test_a_published_value_of_a_mimic_joint_wins(tmp_path, published, joints, distance, note):
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    messages = [("/joint_states", START + k * 10 * MS, joint_message(START + k * 10 * MS, published)) for k in range(5)]
    messages.append(("/tf_static", START, tf_message(transform(0, "hand", "camera"))))
    messages.append(("/points", START + 15 * MS, cloud_message(START + 15 * MS, "camera", [[0, -0.1, 0]])))
    robot = {"file": tmp_path / "gripper.urdf", "model": "triangles"}
    row = next(playing.play(bag(tmp_path / "bag", messages), robot, joints=joints))
    assert row.distance == pytest.approx(distance, abs=1e-6) and (note in row.note if note else row.note == "")


def test_a_stale_value_of_a_mimic_joint_is_not_replaced_by_another(tmp_path):
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    messages = [("/joint_states", START, joint_message(START, {"grip2": 0.04}))]
    messages += [("/joint_states", START + 900 * MS, joint_message(START + 900 * MS, {"grip": 0.01}))]
    messages.append(("/tf_static", START, tf_message(transform(0, "hand", "camera"))))
    messages.append(("/points", START + 901 * MS, cloud_message(START + 901 * MS, "camera", [[0, -0.1, 0]])))
    robot = {"file": tmp_path / "gripper.urdf", "model": "triangles"}
    unknown(playing.play(bag(tmp_path / "bag", messages), robot), "JointState of 'grip2': the nearest is 0.901 s older")


def test_a_camera_on_a_link_whose_joint_is_beyond_its_limit_is_where_it_is_measured(robot, tmp_path):
    messages = [("/joint_states", START, joint_message(START, {"shoulder": 2.1, "spin": 0.0}))]  # at most 2
    messages.append(("/eye/points", START, cloud_message(START, "eye", scene(START))))
    row = next(playing.play(bag(tmp_path / "bag", messages), robot))
    poses = robot.poses([2.1, 0.0], ignore_limits=True)
    eye = robot.link_pose("eye", [2.1, 0.0], ignore_limits=True)
    r = clearance.Query(robot, clearance.MinDistance())(scene(START).astype("f4"), poses=poses, cloud_pose=eye)
    assert row.state == r.state.name and row.distance == pytest.approx(r.distance, abs=1e-6)


def test_a_transform_that_is_none_is_named_in_each_row_that_needs_it(robot, tmp_path):
    messages = [each for each in drive(2) if each[0] != "/tf_static"]
    messages.append(("/tf_static", START, tf_message(transform(0, "base", "mast", turn=(0, 0, 0, 0)))))
    played = playing.play(bag(tmp_path / "bag", messages), robot, topics="/lidar/points")
    unknown(played, "a transform of 'mast' in 'base' was refused: it is no rigid pose, because its quaternion is 0, 0, 0, 0")
    assert any("'mast'" in note for note in played.notes)


def test_frames_may_begin_with_a_slash(robot, tmp_path, drive_bag):
    messages = []
    for topic, log_time, message in drive():
        if topic in ("/tf", "/tf_static"):
            for each in message.transforms:
                each.header.frame_id, each.child_frame_id = f"/{each.header.frame_id}", f"/{each.child_frame_id}"
        elif hasattr(message, "header") and message.header.frame_id:
            message.header.frame_id = f"/{message.header.frame_id}"
        messages.append((topic, log_time, message))
    plain = [(row.topic, row.state, row.distance) for row in playing.play(drive_bag, robot)]
    for options in ({}, {"base_frame": "/base"}, {"base_frame": "base"}):
        rows = playing.play(bag(tmp_path / f"bag{len(options)}{options.get('base_frame', '')[:1] == '/'}", messages), robot,
                            **options)  # fmt: skip
        assert [(row.topic, row.state, row.distance) for row in rows] == plain


FIELD = {
    "60-pointcloud2-row-step/organised_right": 0.5,
    "60-pointcloud2-row-step/organised_step_is_total": 0.5,
    "60-pointcloud2-row-step/one_row_step_0": 0.5,
    "60-pointcloud2-row-step/one_row_step_of_another": 0.5,
    "62-pointcloud2-big-endian/bag": "big-endian",
    "65-compressed-depth/bag": 0.5,
    "65-compressed-depth/with_cloud": 0.5,
    "67-ros1-in-mcap/converted.mcap": 0.5,
    "67-ros1-in-mcap/protobuf.mcap": "encoded as 'protobuf'",
    "73-transform-zero-quaternion/bag": "no rigid pose, because its quaternion is 0, 0, 0, 0",
    "73-transform-zero-quaternion/slashes": 0.5,
    "75-measured-mimic-joint/bag": 0.01,
}


@pytest.mark.parametrize("case", FIELD)
def test_recordings_of_the_field_have_their_right_answers(case):
    from conftest import shared

    path = shared(f"field/{case}")
    folder = path.parents[len(path.relative_to(shared("field")).parts) - 2]
    robot = {"file": next(folder.glob("*.urdf")), "model": "triangles"}
    expected = FIELD[case]
    if "protobuf" in case:
        with pytest.raises(ValueError, match=expected):
            playing.play(path, robot)
        return
    rows = list(playing.play(path, robot))
    if isinstance(expected, str):
        unknown(rows, expected)
    else:
        assert min(row.distance for row in rows) == pytest.approx(expected, abs=1e-6)
        assert all(row.state == "free" for row in rows)


def test_every_recording_of_the_field_is_asked():
    from conftest import shared

    field = shared("field")
    there = {
        str((each.parent if each.stem == each.parent.name else each).relative_to(field)) for each in field.rglob("*.mcap")
    }
    assert there == set(FIELD)


# ---- the command


def test_a_reader_that_goes_away_ends_the_command_without_a_traceback(urdf, drive_bag, tmp_path):
    words = [sys.executable, "-m", "clearance", "play", str(drive_bag), "--robot", str(urdf), "--spheres", "64"]
    for more in ([], ["--csv", str(tmp_path / "all.csv")]):
        with subprocess.Popen(words + more, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
            first = child.stdout.readline()
            child.stdout.close()
            said = child.stderr.read()
        assert " free: " in first and child.returncode == 141
        assert "Traceback" not in said and "Broken" not in said and "leaked" not in said, said
    with open(tmp_path / "all.csv", newline="") as file:
        assert len(list(csv.DictReader(file))) == 24  # what is written is whole


def test_an_option_with_one_value_is_given_once(urdf, drive_bag, capsys):
    with pytest.raises(SystemExit):
        played(capsys, drive_bag, "--robot", urdf, "--base-frame", "a", "--base-frame=b")
    assert "--base-frame is given 2 times, and it has one value" in capsys.readouterr().err
    for more in (("--joint", "spin=1", "--joint", "spin=2"), ("--joint", "spin=1", "--joints", "spin=2"),
                 ("--package", "a=b", "--package", "a=c")):  # fmt: skip
        status, _, err = played(capsys, drive_bag, "--robot", urdf, *more)
        assert status == 1 and "once for each name" in err


def test_joints_are_said_in_either_form(urdf, robot, tmp_path, capsys):
    folder = bag(tmp_path / "bag", [each for each in drive(2) if each[0] not in ("/joint_states", "/colour/image_raw")])
    expected = [row.distance for row in playing.play(folder, robot, joints={"shoulder": 0.5, "spin": 1.0})]
    assert expected == [row.distance for row in playing.play(folder, robot, joints=[0.5, 1.0])]
    for words in (["--joint", "spin=1", "--joint", "shoulder=0.5"], ["--joints", "spin=1,shoulder=0.5"], ["--joints", "0.5,1"],
                  ["--joint", "spin=1", "--joints", "shoulder=0.5"]):  # fmt: skip
        status, out, _ = played(capsys, folder, "--robot", urdf, "--spheres", 64, *words)
        assert status == 0 and [f" {far:.4f} m " in line for far, line in zip(expected, out.splitlines())] == [True] * 6
    status, _, err = played(capsys, folder, "--robot", urdf, "--joints", "1")
    assert status == 1 and "--joints has 1 values, and the robot has 2 joints: shoulder, spin" in err


def played(capsys, *arguments):
    status = command.main(["play", *map(str, arguments)])
    out = capsys.readouterr()
    return status, out.out, out.err


def test_the_command_writes_tables(urdf, robot, drive_bag, tmp_path, capsys):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed (extra parquet)")
    import pyarrow.parquet

    status, out, err = played(
        capsys,
        drive_bag,
        "--robot",
        urdf,
        "--spheres",
        64,
        "--csv",
        tmp_path / "a.csv",
        "--parquet",
        tmp_path / "a.parquet",
        "--check",
    )
    assert (
        status == 0
        and err == "note: no depth, so not played: /colour/image_raw (rgb8)\n"
        and "24 frames, 0 of them unknown, 0 of them differ from NumPy; the least is" in out
    )
    rows = list(playing.play(drive_bag, robot, check=True))
    with open(tmp_path / "a.csv", newline="") as file:
        read = list(csv.DictReader(file))
    table = pyarrow.parquet.read_table(tmp_path / "a.parquet").to_pylist()
    assert len(read) == len(table) == 24
    for row, said, kept in zip(rows, read, table, strict=True):
        assert (
            float(said["distance"]) == kept["distance"] == row.distance and said["state"] == kept["state"] == row.state
        )
        assert int(said["point"]) == kept["point"] == row.point and kept["at_x"] == row.at[0]
        assert int(said["stamp_ns"]) == kept["stamp_ns"] == row.stamp_ns
        assert json.loads(said["dropped"]) == json.loads(kept["dropped"]) == row.dropped


def test_the_command_fails_where_it_must(urdf, tmp_path, capsys):
    arguments = ("--robot", urdf, "--spheres", 64)
    status, out, _ = played(capsys, bag(tmp_path / "a", drive(joints=False)), *arguments)
    assert status == 1 and "24 frames, 24 of them unknown" in out
    file = write_bag(tmp_path / "b", sorted(drive(60), key=lambda each: each[1]))
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    status, out, err = played(capsys, file, *arguments)
    assert status == 1 and "truncated" in err and len(err.strip().splitlines()) == 2 and " free: " in out
    status, _, err = played(capsys, tmp_path / "a", *arguments, "--joint", "shoulder")
    assert status == 1 and "NAME=VALUE" in err
    status, _, err = played(capsys, tmp_path / "none.mcap", *arguments)
    assert status == 1 and "there is no recording" in err


def test_a_play_is_one_page_with_pictures_and_a_recording_for_rerun(urdf, robot, drive_bag, tmp_path, capsys):
    pytest.importorskip("rerun", reason="rerun-sdk is not installed")
    import base64
    import re

    from test_seeing import decode, read_back

    page, recording = tmp_path / "out.html", tmp_path / "out.rrd"
    what = (drive_bag, "--robot", urdf, "--spheres", 64, "--margin", 0.3, "--report", page, "--rerun", recording)
    status, out, _ = played(capsys, *what, "--worst", 2)
    assert status == 0 and f"written: {page}" in out
    rows = list(clearance.playing.play(drive_bag, robot))
    told = page.read_text()
    pictures = re.findall(r"data:image/png;base64,([^\"]+)", told)
    assert len(pictures) == 2 and all(decode(base64.b64decode(each)).shape == (560, 860, 3) for each in pictures)
    assert pictures[0] != pictures[1]
    least = min(rows, key=lambda row: row.lower)
    assert f"1. {least.distance:.3f} m</b> (certainly {least.lower:.3f} to {least.upper:.3f})" in told
    assert 'class="band"' in told and 'class="margin"' in told
    assert f"{sum(row.seen for row in rows):,} points in 24 frames" in told

    read = read_back(recording)
    for name in ("distance", "lower", "upper"):
        assert read[f"/clearance/{name}"] == pytest.approx([getattr(row, name) for row in rows], abs=1e-9)
    band = sorted(v for row in rows for v in (row.lower, row.lower, row.upper))
    assert sorted(read["/clearance/bracket"]) == pytest.approx(band, abs=1e-9)


def test_a_recording_for_rerun_has_a_gap_where_nothing_is_known(urdf, tmp_path, capsys):
    pytest.importorskip("rerun", reason="rerun-sdk is not installed")
    from test_seeing import read_back

    damaged = [each for each in drive(4) if each[0] != "/far/camera_info"]
    folder = bag(tmp_path / "bag", damaged)
    status, out, _ = played(capsys, folder, "--robot", urdf, "--spheres", 64, "--rerun", tmp_path / "out.rrd")
    states = [" unknown: " in line for line in out.splitlines()[:-1]]
    assert status == 0 and states.count(True) == 4 and len(states) == 12
    assert [math.isnan(v) for v in read_back(tmp_path / "out.rrd")["/clearance/distance"]] == states


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--report", "out.txt"), "--report writes an .html file, not out.txt"),
        (("--report", "no/folder/out.html"), "there is no folder no/folder"),
        (("--report", "folder.html"), "folder.html cannot be written"),
        (("--rerun", "out.mcap"), "--rerun writes an .rrd file, not out.mcap"),
        (("--worst", -1), "--worst is -1"),
        (("--margin", 0.1), "--margin is for --rerun and --report"),
    ],
)
def test_a_page_that_cannot_be_is_refused_before_it_is_played(
    urdf, drive_bag, tmp_path, monkeypatch, capsys, words, says
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.html").mkdir()
    status, out, err = played(capsys, drive_bag, "--robot", urdf, *words)
    assert status == 1 and out == "" and says in err and err.count("\n") == 1


def test_a_table_does_not_overwrite_the_recording(urdf, tmp_path, capsys):
    file = next(bag(tmp_path / "bag", drive(2)).glob("*.mcap"))
    before = file.read_bytes()
    for option in ("--csv", "--parquet"):
        status, _, err = played(capsys, file, "--robot", urdf, option, file.parent / "." / file.name)
        assert status == 1 and f"{option} would overwrite the recording" in err and file.read_bytes() == before


def test_messages_that_something_else_has_read_give_the_same_rows(robot, drive_bag):
    with recordings.Recording(drive_bag) as recording:
        read = [(each.topic, each.type, each.log_time, bytes(each._data)) for each in recording.messages()]
    np.random.default_rng(3).shuffle(order := np.arange(len(read)))
    messages = recordings.Messages("elsewhere", [read[k] for k in order])
    rows = list(playing.play(messages, robot, topics=["/lidar/points", "/far/image"]))
    expected = playing.play(drive_bag, robot, topics=["/lidar/points", "/far/image"])
    assert len(rows) == 16 and sorted(map(str, rows)) == sorted(map(str, expected))
    with pytest.raises(ValueError, match="elsewhere has: no topic"):
        playing.play(recordings.Messages("elsewhere", []), robot)


def test_a_check_leaves_out_what_does_not_count(robot, drive_bag):
    whole = [row.distance for row in playing.play(drive_bag, robot, check=True)]
    rows = list(playing.play(drive_bag, robot, check=True, nearest=1.5, farthest=2.2, zero_is_missing=True))
    assert all(playing.agree(row) and row.note == "" for row in rows)
    assert sum(row.checked is not None and row.distance != far for row, far in zip(rows, whole, strict=True)) > 5


def test_of_a_damaged_recording_the_page_shows_what_was_read(urdf, tmp_path, capsys):
    file = write_bag(tmp_path / "bag", sorted(drive(60), key=lambda each: each[1]))
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    status, _, err = played(capsys, file, "--robot", urdf, "--spheres", 64, "--report", tmp_path / "out.html")
    told = (tmp_path / "out.html").read_text()
    assert status == 1 and "truncated" in err and "truncated" in told and "data:image/png" in told
