# SPDX-License-Identifier: BSD-3-Clause
"""The node over loopback: its answers are those of play(), and where it knows nothing it says so and stops."""

import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import clearance
from clearance import playing, recordings

pytest.importorskip("rosbags", reason="rosbags is not installed (extra ros)")
pytest.importorskip("cyclonedds", reason="cyclonedds is not installed (extra node)")
from test_playing import URDF, bag, compressed_drive, drive  # noqa: E402
from test_recordings import MS, START, cloud_message, joint_message, tf_message, transform  # noqa: E402

from clearance import node as nodes  # noqa: E402

LOOPBACK = """<CycloneDDS><Domain id="any"><General><Interfaces>
<NetworkInterface name="lo" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<MaxAutoParticipantIndex>30</MaxAutoParticipantIndex><Peers><Peer Address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""
MESSAGES = pathlib.Path(__file__).resolve().parents[1] / "clearance_msgs"
DOMAIN = 40 + os.getpid() % 60
STOP, GO = 1, 0


@pytest.fixture(scope="module")
def wire():
    os.environ["CYCLONEDDS_URI"] = LOOPBACK
    return nodes.Wire(DOMAIN)


@pytest.fixture(scope="module")
def urdf(tmp_path_factory):
    file = tmp_path_factory.mktemp("robot") / "pair.urdf"
    file.write_text(URDF)
    clearance.Robot.from_urdf(str(file), spheres=64)  # into the cache
    return file


class Bench:
    """A node in a process of its own, and what is said to it and heard from it."""

    def __init__(self, wire, urdf, name, *arguments, clouds=("/lidar/points",), images=(), compressed=()):
        self.wire, self.name = wire, name
        self.command = [
            sys.executable,
            "-m",
            "clearance",
            "node",
            "--robot",
            str(urdf),
            "--spheres",
            "64",
            "--domain",
            str(DOMAIN),
            "--name",
            name,
            "--joint-topic",
            f"/{name}/joint_states",
            "--tf-topic",
            f"/{name}/tf",
            "--tf-topic",
            f"/{name}/tf_static",
            "--report",
            *(each for topic in clouds for each in ("--cloud", f"/{name}{topic}")),
            *(each for topic in images for each in ("--image", f"/{name}{topic}")),
            *(each for topic in compressed for each in ("--compressed-image", f"/{name}{topic}")),
            *map(str, arguments),
        ]
        kinds = {"/joint_states": recordings.JOINTS, "/tf": recordings.TRANSFORMS, "/tf_static": recordings.TRANSFORMS}
        kinds.update(dict.fromkeys(clouds, recordings.CLOUD) | dict.fromkeys(images, recordings.IMAGE))
        kinds.update(dict.fromkeys(compressed, recordings.COMPRESSED))
        kinds.update({topic.rsplit("/", 1)[0] + "/camera_info": recordings.CAMERA for topic in images})
        self.writers = {
            topic: wire.writer(name + topic, kind, "latched" if topic == "/tf_static" else "sensor", 100)
            for topic, kind in kinds.items()
        }
        self.readers = {
            kind: wire.reader(f"{name}/{what}", kind, "reliable", 1000)
            for what, kind in (
                ("clearance", nodes.CLEARANCE),
                ("range", nodes.RANGE),
                ("markers", nodes.MARKERS),
                ("stop", nodes.STOP),
            )
        }
        self.heard = {kind: [] for kind in self.readers}
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert "listening" in self.process.stderr.readline()
        end = time.monotonic() + 20
        while time.monotonic() < end:
            if all(len(write.of.get_matched_subscriptions()) == 1 for write in self.writers.values()) and all(
                len(reader.get_matched_publications()) == 1 for reader in self.readers.values()
            ):
                return
            time.sleep(0.02)
        raise AssertionError("the node was not found")

    def say(self, topic, message):
        self.writers[topic](message)

    def hear(self):
        for kind, reader in self.readers.items():
            self.heard[kind] += [each.decode() for each in self.wire.taken(reader)]
        return self.heard[nodes.CLEARANCE]

    def until(self, holds, seconds=10):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if holds(self.hear()):
                return
            time.sleep(0.005)
        raise AssertionError(f"not heard within {seconds} s; the last is {self.heard[nodes.CLEARANCE][-1:]}")

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        out, err = self.process.communicate(timeout=20)
        assert self.process.returncode == 0, err
        return out


@pytest.fixture
def bench(wire, urdf):
    made = []

    def make(*arguments, **options):
        made.append(Bench(wire, urdf, f"b{os.getpid()}x{time.monotonic_ns()}", *arguments, **options))
        return made[-1]

    yield make
    for each in made:
        if each.process.poll() is None:
            each.process.kill()
            each.process.communicate()


def state(message):
    return nodes.STATES[message.state]


def answers(heard):
    """What was said of frames, and not of their absence."""
    return [each for each in heard if "no frame" not in each.note]


def static(bench):
    bench.say("/tf_static", tf_message(transform(0, "base", "lidar", (0.5, 0.4, 0.3))))


def joints(bench, stamp):
    bench.say("/joint_states", joint_message(stamp, {"shoulder": 0.3, "spin": 0.1}))


def points(bench, stamp, seed=0, frame="lidar"):
    scene = np.random.default_rng(seed).uniform(0.5, 1.5, (200, 3))
    bench.say("/lidar/points", cloud_message(stamp, frame, scene))


# ---- messages


def test_dds_types_are_named_as_ros_2_names_them(wire):
    for kind, name in (
        (nodes.CLEARANCE, "clearance_msgs::msg::dds_::Clearance_"),
        (recordings.CLOUD, "sensor_msgs::msg::dds_::PointCloud2_"),
        (recordings.TRANSFORMS, "tf2_msgs::msg::dds_::TFMessage_"),
    ):
        assert wire._topic("some/topic", kind).get_type_name() == name
    assert wire._topic("/some/topic", nodes.RANGE).get_name() == "rt/some/topic"


def test_bytes_are_those_of_the_dds_library(wire):
    """Messages are written by rosbags; cyclonedds, from the same types, must read and write the same bytes."""
    from cyclonedds.idl import IdlStruct

    header = wire.make(
        "std_msgs/msg/Header", stamp=wire.make("builtin_interfaces/msg/Time", sec=7, nanosec=9), frame_id="abc"
    )
    row = playing.Row(
        7.0,
        "/t",
        "abc",
        "free",
        0.5,
        0.4,
        0.5,
        "arm",
        3,
        (1.0, 2.0, 3.0),
        (4.0, 5.0, 6.0),
        10,
        9,
        {"not_finite": 1},
        "a note",
        {"arm": 0.5, "hand": 0.75},
    )
    message = nodes.clearance_of(wire, row, nodes._Sensor(0), header)
    made = wire.type_of(nodes.CLEARANCE)
    data = bytes(wire.store.serialize_cdr(message, nodes.CLEARANCE))
    read = made.__idl__.deserialize(data)
    assert (read.header.stamp.nanosec, read.header.frame_id, read.state, read.distance) == (9, "abc", 2, 0.5)
    assert [(each.link, each.distance) for each in read.parts] == [("arm", 0.5), ("hand", 0.75)]
    assert [(each.reason, each.count) for each in read.dropped] == [("not_finite", 1)] and read.note == "a note"
    written = IdlStruct.serialize(read, use_version_2=False)
    assert written.rstrip(b"\0") == data.rstrip(b"\0")


def bare(text):
    return [re.sub(r"\s+", " ", line.split("#")[0]).strip() for line in text.splitlines() if line.split("#")[0].strip()]


def test_definitions_are_those_of_the_package():
    files = sorted((MESSAGES / "msg").glob("*.msg"))
    assert [f"clearance_msgs/msg/{file.stem}" for file in files] == sorted(
        k for k in nodes.DEFINITIONS if k.startswith("clearance")
    )
    for file in files:
        assert bare(file.read_text()) == bare(nodes.DEFINITIONS[f"clearance_msgs/msg/{file.stem}"])
        assert f"msg/{file.name}" in (MESSAGES / "CMakeLists.txt").read_text()


def test_definitions_pass_rosidl(tmp_path):
    """Debian's rosidl turns them into IDL with the same members; test_ros2_package builds them."""
    python = "/usr/bin/python3"
    if (
        not os.path.exists(python)
        or subprocess.run(
            [python, "-c", "import rosidl_adapter, rosidl_parser"], capture_output=True
        ).returncode
    ):
        pytest.skip("rosidl is not installed (Debian: python3-rosidl)")
    program = """
import pathlib, sys
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_parser.definition import IdlLocator, Message
from rosidl_parser.parser import parse_idl_file
package, out = map(pathlib.Path, sys.argv[1:])
for each in sorted((package / "msg").glob("*.msg")):
    convert_msg_to_idl(package, "clearance_msgs", each.relative_to(package), out / "msg")
    content = parse_idl_file(IdlLocator(out, pathlib.Path("msg") / f"{each.stem}.idl")).content
    message, = content.get_elements_of_type(Message)
    print("FOUND", each.stem, ",".join(member.name for member in message.structure.members))
"""
    done = subprocess.run([python, "-c", program, MESSAGES, tmp_path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    said = dict(line.split()[1:] for line in done.stdout.splitlines() if line.startswith("FOUND "))
    for kind, text in nodes.DEFINITIONS.items():
        if kind.startswith("clearance_msgs"):
            members = [line.split()[1] for line in bare(text) if "=" not in line]
            assert said[kind.rsplit("/", 1)[1]].split(",") == members


# ---- over the wire


def test_the_node_says_what_play_says(bench, urdf, tmp_path):
    images = ("/depth/image_raw", "/far/image")
    compressed = tuple(f"{topic}/compressedDepth" for topic in images)
    packed = [each for each in compressed_drive(12) if each[0] in compressed]
    messages = [each for each in drive(12) if not each[0].startswith("/colour")] + packed
    messages.sort(key=lambda each: each[1])
    rows = list(
        playing.play(
            bag(tmp_path / "bag", messages), {"file": str(urdf), "spheres": 64}, question=clearance.MinDistancePerPart()
        )
    )
    node = bench("--wait", 2, "--timeout", 5, images=images, compressed=compressed)
    for topic, _, message in messages:
        node.say(topic, message)
        time.sleep(0.003)
    for k in range(4):  # so that the last frames need not wait
        stamp = START + (800 + 30 * k) * MS
        node.say("/joint_states", joint_message(stamp, {"shoulder": 0.0, "spin": 0.0}))
        node.say("/tf", tf_message(transform(stamp, "mast", "rig")))
    node.until(lambda heard: len(heard) >= len(rows), 20)
    heard = {
        (each.topic.removeprefix(f"/{node.name}"), recordings.nanoseconds(each.header.stamp)): each
        for each in node.hear()
    }
    assert len(heard) == len(rows) == 60
    for row in rows:
        said = heard[row.topic, row.stamp_ns]
        assert (state(said), said.link, said.point, said.seen, said.valid) == (
            row.state,
            row.link,
            row.point,
            row.seen,
            row.valid,
        )
        assert (said.distance, said.lower, said.upper) == (row.distance, row.lower, row.upper)  # to the bit
        assert (said.at.x, said.at.y, said.at.z) == row.at and (
            said.nearest.x,
            said.nearest.y,
            said.nearest.z,
        ) == row.nearest
        assert {each.link: each.distance for each in said.parts} == row.parts
        assert {each.reason: each.count for each in said.dropped} == row.dropped
        assert said.header.frame_id == "base" and said.sensor_frame == row.frame and said.note == row.note == ""
    ranges = node.heard[nodes.RANGE]
    assert sorted(each.range for each in ranges) == pytest.approx(sorted(row.lower for row in rows), abs=1e-6)
    lines = [each.markers[0] for each in node.heard[nodes.MARKERS]]
    assert len(lines) == 60 and all(len(each.points) == 2 and each.type == 5 and each.action == 0 for each in lines)
    out = node.stop()
    assert "60 frames" in out and "0 frames came late, 0 were overtaken" in out


def test_the_stop_follows_the_margin(bench):
    node = bench("--margin", 0.3, "--slow", 0.6, "--timeout", 5, "--wait", 0)
    static(node)
    joints(node, START)
    time.sleep(0.3)
    for k, (far, action) in enumerate(((1.0, GO), (0.5, 2), (0.2, STOP), (1.0, GO))):
        scene = np.array([[-0.5, -0.4, far + 0.4 - 0.3 + 0.0]])  # above the middle of the base, whose top is at 0.1
        node.say("/lidar/points", cloud_message(START + k * MS, "lidar", scene))
        node.until(lambda heard, k=k: len(answers(heard)) == k + 1 and len(node.heard[nodes.STOP]) == k + 1)
        said = node.heard[nodes.CLEARANCE][-1]
        assert {GO: said.lower >= 0.6, 2: 0.3 <= said.lower < 0.6, STOP: said.lower < 0.3}[action], said.lower
        assert node.heard[nodes.STOP][-1].action_type == action
    assert node.heard[nodes.STOP][2].polygon_name in ("base", "arm", "wheel")


def test_a_publisher_that_dies_makes_it_unknown(bench):
    node = bench("--timeout", 0.4, "--margin", 0.01)
    static(node)
    for k in range(5):
        joints(node, START + k * 20 * MS)
        points(node, START + k * 20 * MS, k)
        time.sleep(0.03)
    node.until(lambda heard: any(state(each) == "free" for each in heard))
    begin = time.monotonic()
    node.until(lambda heard: state(heard[-1]) == "unknown" and "no frame could be answered for 0.4 s" in heard[-1].note)
    assert time.monotonic() - begin < 1.5
    node.until(
        lambda _: node.heard[nodes.STOP][-1].action_type == STOP and node.heard[nodes.RANGE][-1].range == -np.inf
    )
    last = node.heard[nodes.CLEARANCE][-1]
    assert (
        last.lower == 0
        and last.upper == np.inf
        and last.point == 0xFFFFFFFF
        and last.topic == f"/{node.name}/lidar/points"
    )
    joints(node, START + 200 * MS)  # it comes back
    points(node, START + 200 * MS)
    node.until(lambda heard: state(heard[-1]) == "free" and node.heard[nodes.STOP][-1].action_type == GO)


def test_it_stops_before_the_first_frame(bench):
    node = bench("--timeout", 0.2)
    node.until(lambda heard: len(heard) >= 2 and node.heard[nodes.STOP])
    assert all(state(each) == "unknown" for each in node.heard[nodes.CLEARANCE])
    assert all(each.action_type == STOP for each in node.heard[nodes.STOP])


def test_late_and_missing_and_out_of_order(bench):
    node = bench("--wait", 0.05, "--timeout", 5)
    static(node)
    for k in (0, 20, 40):
        joints(node, START + k * MS)
    time.sleep(0.2)
    points(node, START + 10 * MS)
    node.until(lambda heard: len(heard) == 1)
    points(node, START + 30 * MS)
    node.until(lambda heard: len(heard) == 2)
    points(node, START + 20 * MS)  # out of order: an older answer would hide the newer one
    points(node, START + 30 * MS)  # twice
    time.sleep(0.2)
    points(node, START + 40 * MS)
    node.until(lambda heard: len(heard) == 3)
    said = node.heard[nodes.CLEARANCE]
    assert [recordings.nanoseconds(each.header.stamp) - START for each in said] == [10 * MS, 30 * MS, 40 * MS]
    assert [each.late for each in said] == [0, 0, 2] and all(state(each) == "free" for each in said)
    points(node, START + 120 * MS)  # joints are behind, but not too old
    node.until(lambda heard: len(heard) == 4)
    assert state(said[-1]) == "free"
    points(node, START + 160 * MS)  # too old
    node.until(lambda heard: len(heard) == 5)
    assert state(said[-1]) == "unknown" and "JointState of 'shoulder': the nearest is 0.12 s older" in said[-1].note
    joints(node, START + 200 * MS)
    points(node, START + 200 * MS, frame="elsewhere")
    node.until(lambda heard: len(heard) == 6)
    assert state(said[-1]) == "unknown" and "no transform names the frame 'elsewhere'" in said[-1].note
    assert node.heard[nodes.STOP][-1].action_type == STOP
    joints(node, START - 60_000 * MS)  # the clock is set back, as when a recording is played again
    points(node, START - 60_000 * MS)
    node.until(lambda heard: len(heard) == 7)
    assert state(said[-1]) == "free"


def test_old_frames_can_be_refused(bench):
    node = bench("--max-delay", 0.5, "--timeout", 5, "--wait", 0)
    static(node)
    now = time.time_ns()
    for stamp, expected in ((now, "free"), (now - 1000 * MS, None)):
        joints(node, stamp)
        time.sleep(0.1)
        points(node, stamp)
        if expected:
            node.until(lambda heard: len(heard) == 1)
            assert state(node.heard[nodes.CLEARANCE][-1]) == expected
    time.sleep(0.6)
    joints(node, now + 100 * MS)
    points(node, now + 100 * MS)
    node.until(lambda heard: len(heard) == 2)
    said = node.heard[nodes.CLEARANCE][-1]
    assert state(said) == "unknown" and "s old (at most 0.5 s is allowed)" in said.note


def test_a_node_that_is_killed_and_started_again_answers(bench):
    node = bench("--timeout", 5)
    static(node)
    joints(node, START)
    points(node, START)
    node.until(lambda heard: len(heard) == 1)
    node.process.kill()
    node.process.communicate()
    time.sleep(0.2)
    before = len(node.hear())
    node.start()  # static transforms were said before, and are heard again
    for k in range(1, 100):
        joints(node, START + k * 20 * MS)
        points(node, START + k * 20 * MS, k)
        time.sleep(0.02)
        if any(state(each) == "free" for each in node.hear()[before:]):
            break
    assert state(node.hear()[-1]) == "free"
    node.stop()


def test_a_message_that_is_none_is_said(bench, wire):
    node = bench("--timeout", 5)
    static(node)
    joints(node, START)
    broken = cloud_message(START, "lidar", np.zeros((20, 3)))
    broken.fields = broken.fields[1:]
    node.say("/lidar/points", broken)
    node.until(lambda heard: len(heard) == 1)
    assert state(node.heard[nodes.CLEARANCE][0]) == "unknown" and "no field x" in node.heard[nodes.CLEARANCE][0].note
    points(node, START + MS)
    node.until(lambda heard: len(heard) == 2)
    assert state(node.heard[nodes.CLEARANCE][1]) == "free"


def test_the_latency_is_measured(bench):
    node = bench("--timeout", 5, "--wait", 0)
    static(node)
    joints(node, START)
    time.sleep(0.2)
    for k in range(60):
        points(node, START + k * MS, k)
        time.sleep(0.02)
    node.until(lambda heard: len(heard) >= 55)
    out = node.stop()
    found = re.search(
        r"(\d+) frames; from receipt to publication ([\d.]+) ms .* without the library's call ([\d.]+), ", out
    )
    assert found, out
    assert int(found[1]) >= 55 and 0 < float(found[3]) <= float(found[2])
    print(out)
    # The aim is 0.5 ms on an idle machine; the tests' machine is not.
    assert float(found[3]) < 5


def test_a_node_needs_topics(urdf, wire):
    with pytest.raises(ValueError, match="a topic of clouds or images"):
        nodes.Node(str(urdf), wire=wire)
