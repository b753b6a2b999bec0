# SPDX-License-Identifier: BSD-3-Clause
"""Recordings: files whole, damaged and truncated; clouds, images and cameras; joints and transforms at a stamp."""

import io
import math
import shutil
import sqlite3
import struct
import zlib

import numpy as np
import pytest

from clearance import recordings

pytest.importorskip("rosbags", reason="rosbags is not installed (extra ros)")
from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: E402
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402

STORE = get_typestore(Stores.LATEST)
START = 1_700_000_000_000_000_000
MS = 1_000_000


def make(kind, **fields):
    return STORE.types[kind](**fields)


def header(stamp, frame=""):
    return make(
        "std_msgs/msg/Header",
        stamp=make("builtin_interfaces/msg/Time", sec=stamp // 10**9, nanosec=stamp % 10**9),
        frame_id=frame,
    )


def cloud_message(stamp, frame, points, *, kind="<f4", offsets=(0, 4, 8), point_step=16, row_padding=0, big=False):
    points = np.asarray(points, float)
    rows, columns = (1, len(points)) if points.ndim == 2 else points.shape[:2]
    row_step = columns * point_step + row_padding
    data = np.full(rows * row_step, 0xAB, np.uint8)
    record = np.dtype({"names": ["x", "y", "z"], "formats": [kind] * 3, "offsets": offsets, "itemsize": point_step})
    view = np.ndarray((rows, columns), record, data.data, strides=(row_step, point_step))
    for axis, name in enumerate("xyz"):
        view[name] = points.reshape(rows, columns, 3)[..., axis]
    number = {"f4": 7, "f8": 8, "i4": 5}[kind[1:]]
    fields = [
        make("sensor_msgs/msg/PointField", name=name, offset=offset, datatype=number, count=1)
        for name, offset in zip("xyz", offsets, strict=True)
    ]
    return make(
        "sensor_msgs/msg/PointCloud2",
        header=header(stamp, frame),
        height=rows,
        width=columns,
        fields=fields,
        is_bigendian=big,
        point_step=point_step,
        row_step=row_step,
        data=data,
        is_dense=False,
    )


def image_message(stamp, frame, image, encoding=None, padding=0, big=0):
    rows, columns = image.shape[:2]
    step = image[0].nbytes + padding
    data = np.full((rows, step), 0xCD, np.uint8)
    data[:, : image[0].nbytes] = np.ascontiguousarray(image).view(np.uint8).reshape(rows, -1)
    encoding = encoding or {"u": "16UC1", "f": "32FC1"}[image.dtype.kind]
    return make(
        "sensor_msgs/msg/Image",
        header=header(stamp, frame),
        height=rows,
        width=columns,
        encoding=encoding,
        is_bigendian=big,
        step=step,
        data=data.ravel(),
    )


def png(image):
    """A 16-bit grey PNG."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in image)
    head = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def rvl(image):
    """An image in RVL, by its paper: runs of zeros and of differences, in nibbles of three bits."""
    nibbles = []

    def put(value):
        while True:
            nibbles.append(value & 7 | (8 if value > 7 else 0))
            value >>= 3
            if not value:
                return

    pixels, last, i = image.ravel().astype(int), 0, 0
    while i < len(pixels):
        begin = i
        while i < len(pixels) and pixels[i] == 0:
            i += 1
        put(i - begin)
        begin = i
        while i < len(pixels) and pixels[i] != 0:
            i += 1
        put(i - begin)
        for pixel in pixels[begin:i]:
            step = pixel - last
            put(int(2 * step if step >= 0 else -2 * step - 1))
            last = pixel
    nibbles += [0] * (-len(nibbles) % 8)
    words = [sum(n << 28 - 4 * k for k, n in enumerate(nibbles[at : at + 8])) for at in range(0, len(nibbles), 8)]
    return struct.pack("<II", image.shape[1], image.shape[0]) + struct.pack(f"<{len(words)}I", *words)


def compressed_message(stamp, frame, image, *, by="png", step=100.0, farthest=10.0, kind=None):
    """As compressed_depth_image_transport writes it: uint16 as it is, float32 as inverse depths with `step`."""
    a, b = 0.0, 0.0
    if image.dtype.kind == "f":
        a = np.float32(step) * (np.float32(step) + np.float32(1))
        b = np.float32(1) - a / np.float32(farthest)
        with np.errstate(invalid="ignore", divide="ignore"):
            packed = np.where(image < farthest, a / image.astype("f4") + b, 0).astype("u2")
    else:
        packed = image
    encoding = {"u": "16UC1", "f": "32FC1"}[image.dtype.kind]
    data = struct.pack("<iff", 0, a, b) + (rvl(packed) if by == "rvl" else png(packed))
    return make(
        "sensor_msgs/msg/CompressedImage",
        header=header(stamp, frame),
        format=f"{encoding}; compressedDepth{' rvl' if by == 'rvl' else ''}" if kind is None else kind,
        data=np.frombuffer(data, np.uint8),
    )


def info_message(stamp, frame, shape, k, d=(), model="plumb_bob", p=None, binning=1, roi=(0, 0, 0, 0)):
    fx, fy, cx, cy = k
    matrix = np.array([fx, 0, cx, 0, fy, cy, 0, 0, 1], float)
    if p is None:
        p = np.array([fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0], float)
    region = make(
        "sensor_msgs/msg/RegionOfInterest",
        x_offset=roi[0],
        y_offset=roi[1],
        width=roi[2],
        height=roi[3],
        do_rectify=False,
    )
    return make(
        "sensor_msgs/msg/CameraInfo",
        header=header(stamp, frame),
        height=shape[0],
        width=shape[1],
        distortion_model=model,
        d=np.array(d, float),
        k=matrix,
        r=np.eye(3).ravel(),
        p=np.asarray(p, float),
        binning_x=binning,
        binning_y=binning,
        roi=region,
    )


def joint_message(stamp, values):
    return make(
        "sensor_msgs/msg/JointState",
        header=header(stamp),
        name=list(values),
        position=np.array(list(values.values()), float),
        velocity=np.zeros(0),
        effort=np.zeros(0),
    )


def transform(stamp, parent, child, at=(0, 0, 0), turn=(0, 0, 0, 1)):
    vector = make("geometry_msgs/msg/Vector3", **dict(zip("xyz", map(float, at), strict=True)))
    quaternion = make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, turn), strict=True)))
    return make(
        "geometry_msgs/msg/TransformStamped",
        header=header(stamp, parent),
        child_frame_id=child,
        transform=make("geometry_msgs/msg/Transform", translation=vector, rotation=quaternion),
    )


def tf_message(*transforms):
    return make("tf2_msgs/msg/TFMessage", transforms=list(transforms))


def about_z(angle):
    return (0, 0, math.sin(angle / 2), math.cos(angle / 2))


def write_bag(folder, messages, kind="mcap", compression=None):
    """A rosbag2 folder of (topic, log time, message), and the file in it."""
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if compression:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        topics = {}
        for topic, log_time, message in messages:
            name = message.__msgtype__
            if topic not in topics:
                topics[topic] = writer.add_connection(topic, name, typestore=STORE)
            writer.write(topics[topic], log_time, STORE.serialize_cdr(message, name))
    return next(each for each in folder.iterdir() if each.name != "metadata.yaml")


def some_clouds(count=12, points=40_000):
    """More than a chunk each, so that a file has many chunks."""
    random = np.random.default_rng(3)
    return [
        (
            "/cloud",
            START + k * 50 * MS,
            cloud_message(START + k * 50 * MS, "camera", random.uniform(-2, 2, (points, 3))),
        )
        for k in range(count)
    ]


def read_all(path, topics=None):
    found = []
    try:
        with recordings.Recording(path) as recording:
            found.extend(recording.messages(topics))
    except recordings.Damaged as error:
        return found, str(error)
    return found, None


# ---- files


@pytest.mark.parametrize("kind", ["mcap", "sqlite3"])
@pytest.mark.parametrize("compression", [None, CompressionMode.FILE, CompressionMode.MESSAGE])
def test_a_whole_recording_is_read_in_the_order_of_time(tmp_path, kind, compression):
    clouds = some_clouds(4, 500)
    joints = [("/joint_states", START + k * 9 * MS, joint_message(START + k * 9 * MS, {"a": k})) for k in range(20)]
    file = write_bag(tmp_path / "bag", clouds + joints, kind, compression)
    paths = [tmp_path / "bag"] + ([file] if compression is None else [])
    for path in paths:
        found, damage = read_all(path)
        assert damage is None
        assert [each.log_time for each in found] == sorted(log for _, log, _ in clouds + joints)
        got = [each.decode() for each in found if each.topic == "/cloud"]
        for message, (_, _, sent) in zip(got, clouds, strict=True):
            assert np.array_equal(recordings.cloud(message), recordings.cloud(sent))
        assert [each.decode().position[0] for each in found if each.topic == "/joint_states"] == list(range(20))


def test_reading_is_lazy(tmp_path):
    file = write_bag(tmp_path / "bag", some_clouds(8))
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 0xFF  # damage in the middle is met only when it is reached
    file.write_bytes(data)
    with recordings.Recording(file) as recording:
        assert next(recording.messages()).log_time == START


@pytest.mark.parametrize("part", [0.03, 0.2, 0.5, 0.9, 0.999])
def test_a_truncated_mcap_gives_what_is_before_the_end(tmp_path, part):
    clouds = some_clouds()
    file = write_bag(tmp_path / "bag", clouds)
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * part)])
    for path in (file, tmp_path / "bag"):
        found, damage = read_all(path)
        assert damage is not None and "bag" in damage
        assert len(found) >= int(len(clouds) * part) - 2
        for each, (_, log_time, sent) in zip(found, clouds, strict=False):
            assert each.log_time == log_time
            assert np.array_equal(each.decode().data, sent.data)


def add_checksums(data):
    """Writes the checksum of each chunk, which rosbags leaves out."""
    at = 8
    while at < len(data) - 8:
        end = at + 9 + int.from_bytes(data[at + 1 : at + 9], "little")
        if data[at] == 6:
            start = at + 9 + 28 + 4 + int.from_bytes(data[at + 37 : at + 41], "little") + 8
            data[at + 33 : at + 37] = zlib.crc32(data[start:end]).to_bytes(4, "little")
        at = end


def test_a_flipped_byte_of_an_mcap_ends_it_there(tmp_path):
    clouds = some_clouds()
    file = write_bag(tmp_path / "bag", clouds)
    data = bytearray(file.read_bytes())
    add_checksums(data)
    data[len(data) // 2] ^= 0x10
    file.write_bytes(data)
    found, damage = read_all(file)
    assert damage is not None and "damaged after" in damage
    assert 4 <= len(found) < 12
    for each, (_, _, sent) in zip(found, clouds, strict=False):
        assert np.array_equal(each.decode().data, sent.data)


@pytest.mark.parametrize("part", [0.3, 0.6, 0.95])
def test_a_truncated_database_gives_what_is_before_the_end(tmp_path, part):
    clouds = some_clouds()
    file = write_bag(tmp_path / "bag", clouds, "sqlite3")
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * part)])
    for path in (file, tmp_path / "bag"):
        found, damage = read_all(path)
        assert damage is not None
        assert int(len(clouds) * part) - 2 <= len(found) < len(clouds)
        for each, (_, log_time, sent) in zip(found, clouds, strict=False):
            assert each.log_time == log_time and np.array_equal(each.decode().data, sent.data)


def test_a_database_that_was_not_closed_keeps_its_log(tmp_path):
    file = write_bag(tmp_path / "bag", some_clouds(3, 100), "sqlite3")
    base = sqlite3.connect(file)
    base.execute("PRAGMA journal_mode=WAL")
    base.execute("PRAGMA wal_autocheckpoint=0")
    base.execute("INSERT INTO messages SELECT NULL, topic_id, timestamp + 1000000000, data FROM messages")
    base.commit()
    copy = tmp_path / "copy"
    shutil.copytree(tmp_path / "bag", copy)  # as after a kill: the log is still there
    base.close()
    assert (copy / "bag.db3-wal").stat().st_size > 0
    for path in (copy, copy / "bag.db3"):
        found, damage = read_all(path)
        assert damage is None and len(found) == 6


def test_a_ros_1_bag_is_read(tmp_path):
    from rosbags.rosbag1 import Writer as Writer1

    store = get_typestore(Stores.ROS1_NOETIC)
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=5, nanosec=7)
    head = types["std_msgs/msg/Header"](seq=3, stamp=stamp, frame_id="camera")
    region = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    k, p = np.array([50.0, 0, 31, 0, 51, 23, 0, 0, 1]), np.zeros(12)
    info = types["sensor_msgs/msg/CameraInfo"](
        head, 48, 64, "plumb_bob", D=np.zeros(5), K=k, R=np.zeros(9), P=p, binning_x=0, binning_y=0, roi=region
    )
    joints = types["sensor_msgs/msg/JointState"](head, ["a"], np.array([1.5]), np.zeros(0), np.zeros(0))
    with Writer1(tmp_path / "old.bag") as writer:
        for topic, message in (("/camera_info", info), ("/joint_states", joints)):
            kind = message.__msgtype__
            connection = writer.add_connection(topic, kind, typestore=store)
            writer.write(connection, START, store.serialize_ros1(message, kind))
    found, damage = read_all(tmp_path / "old.bag")
    assert damage is None and [each.topic for each in found] == ["/camera_info", "/joint_states"]
    assert recordings.camera(found[0].decode(), (48, 64)) == {"intrinsics": (50.0, 51.0, 31.0, 23.0)}
    samples = recordings.JointSamples()
    samples.add(found[1].decode())
    assert samples.at("a", 5_000_000_007, 0.1) == 1.5


def test_a_folder_without_metadata_is_read(tmp_path):
    write_bag(tmp_path / "bag", some_clouds(3, 100))
    (tmp_path / "bag" / "metadata.yaml").unlink()
    found, damage = read_all(tmp_path / "bag")
    assert damage is None and len(found) == 3


def mcap_record(kind, body):
    return bytes([kind]) + len(body).to_bytes(8, "little") + body


def text(value):
    value = value.encode() if isinstance(value, str) else value
    return len(value).to_bytes(4, "little") + value


@pytest.mark.parametrize("profile", ["ros2", ""])
@pytest.mark.parametrize("end", [True, False])
def test_an_mcap_without_index_or_profile_is_read_as_written(tmp_path, profile, end):
    topics = {1: ("/a", "sensor_msgs/msg/JointState"), 2: ("/b", "sensor_msgs/msg/JointState")}
    data = recordings.MAGIC + mcap_record(1, text(profile) + text("another writer"))
    for number, (topic, kind) in topics.items():
        schema = STORE.generate_msgdef(kind, ros_version=2)[0]
        data += mcap_record(3, number.to_bytes(2, "little") + text(kind) + text("ros2msg") + text(schema))
        data += mcap_record(4, number.to_bytes(2, "little") * 2 + text(topic) + text("cdr") + text(b""))
    log = [START, START + 5, START + 3, START + 9]  # topics overlap, as writers flush them
    for k, log_time in enumerate(log):
        message = joint_message(log_time, {"a": k})
        body = (1 + k % 2).to_bytes(2, "little") + bytes(4) + log_time.to_bytes(8, "little") * 2
        data += mcap_record(5, body + bytes(STORE.serialize_cdr(message, message.__msgtype__)))
    if end:
        data += mcap_record(15, bytes(4)) + mcap_record(2, bytes(20)) + recordings.MAGIC
    (tmp_path / "file.mcap").write_bytes(data)
    found, damage = read_all(tmp_path / "file.mcap")
    assert [each.log_time for each in found] == log
    assert [each.decode().position[0] for each in found] == [0, 1, 2, 3]
    assert (damage is None) == end


def mcap_of(profile, channels, messages):
    """An MCAP file without an index. channels: (topic, type, encoding of the schema, of messages); messages: (channel,
    log time, bytes)."""
    data = recordings.MAGIC + mcap_record(1, text(profile) + text(""))
    for number, (topic, kind, schema, encoding) in enumerate(channels, 1):
        data += mcap_record(3, number.to_bytes(2, "little") + text(kind) + text(schema) + text("x"))
        data += mcap_record(4, number.to_bytes(2, "little") * 2 + text(topic) + text(encoding) + text(b""))
    for number, log_time, body in messages:
        data += mcap_record(5, (number + 1).to_bytes(2, "little") + bytes(4) + log_time.to_bytes(8, "little") * 2 + body)
    return data + mcap_record(15, bytes(4)) + mcap_record(2, bytes(20)) + recordings.MAGIC


@pytest.mark.parametrize("profile", ["ros1", "", "x", "something-longer", "ros2"])
def test_ros_1_messages_in_an_mcap_file_are_read_and_others_are_named(tmp_path, profile):
    """As `mcap convert old.bag new.mcap` writes them, beside what no ROS writes."""
    store = get_typestore(Stores.ROS1_NOETIC)
    stamp = store.types["builtin_interfaces/msg/Time"](sec=5, nanosec=7)
    head = store.types["std_msgs/msg/Header"](seq=3, stamp=stamp, frame_id="camera")
    joints = store.types["sensor_msgs/msg/JointState"](head, ["a"], np.array([1.5]), np.zeros(0), np.zeros(0))
    old = bytes(store.serialize_ros1(joints, joints.__msgtype__))
    message = joint_message(START, {"a": 2.5})
    new = bytes(STORE.serialize_cdr(message, message.__msgtype__))
    channels = [
        ("/old", "sensor_msgs/JointState", "ros1msg", "ros1"),
        ("/new", "sensor_msgs/msg/JointState", "ros2msg", "cdr"),
        ("/other", "foxglove.PointCloud", "protobuf", "protobuf"),
        ("/text", "note", "jsonschema", "json"),
    ]
    file = tmp_path / "file.mcap"
    file.write_bytes(mcap_of(profile, channels, [(0, START, old), (1, START + 1, new), (2, START + 2, b"\x08\x01")]))
    with recordings.Recording(file) as recording:
        assert recording.damage is None
        assert recording.topics == {
            "/old": "sensor_msgs/msg/JointState",
            "/new": "sensor_msgs/msg/JointState",
            "/other": "foxglove.PointCloud",
            "/text": "note",
        }
        assert recording.encodings == {"/old": "ros1", "/new": "cdr", "/other": "protobuf", "/text": "json"}
        found = [each.decode() for each in recording.messages(["/old", "/new"])]
        assert [each.position[0] for each in found] == [1.5, 2.5]
        assert recordings.nanoseconds(found[0].header.stamp) == 5_000_000_007
        with pytest.raises(ValueError, match="/other is encoded as 'protobuf', which is not read"):
            list(recording.messages())
    file.write_bytes(file.read_bytes()[:-60])
    found, damage = read_all(file, ["/old", "/new"])
    assert damage is not None and "truncated" in damage and found[0].decode().position[0] == 1.5


def test_rosbags_is_left_as_it_was(tmp_path):
    from rosbags.rosbag2 import storage_mcap

    before = storage_mcap.get_msgdef
    (tmp_path / "good.mcap").write_bytes(mcap_of("ros1", [("/a", "b", "protobuf", "protobuf")], []))
    (tmp_path / "bad.mcap").write_bytes(b"no recording, but long enough to have a footer at its end")
    recordings.Recording(tmp_path / "good.mcap").close()
    assert storage_mcap.get_msgdef is before
    with pytest.raises(ValueError):
        recordings.Recording(tmp_path / "bad.mcap")
    assert storage_mcap.get_msgdef is before


def test_what_is_no_recording_is_a_sentence(tmp_path):
    (tmp_path / "empty.mcap").write_bytes(b"")
    (tmp_path / "other.mcap").write_bytes(b"no recording at all, but long enough to have a footer")
    (tmp_path / "other.db3").write_bytes(b"no database either" * 100)
    (tmp_path / "other.txt").write_bytes(b"text")
    (tmp_path / "folder").mkdir()
    for name in ("empty.mcap", "other.mcap", "other.db3", "other.txt", "folder", "absent.mcap"):
        with pytest.raises(ValueError, match=name):
            recordings.Recording(tmp_path / name)


def test_no_truncation_of_a_small_file_crashes(tmp_path):
    clouds = some_clouds(3, 20)
    for kind in ("mcap", "sqlite3"):
        data = write_bag(tmp_path / kind, clouds, kind).read_bytes()
        path = tmp_path / f"cut.{'mcap' if kind == 'mcap' else 'db3'}"
        for size in range(0, len(data), max(1, len(data) // 150)):
            path.write_bytes(data[:size])
            try:
                found, damage = read_all(path)
            except ValueError as error:
                assert "cut" in str(error)
                continue
            assert damage is not None, f"{kind} of {size} bytes of {len(data)}"
            for each in found:
                assert any(np.array_equal(each.decode().data, sent.data) for _, _, sent in clouds)


def test_a_message_that_is_none_is_a_sentence(tmp_path):
    with recordings.Recording(write_bag(tmp_path / "bag", some_clouds(1, 20))) as recording:
        each = next(recording.messages())
    broken = recordings.Message(each.topic, each.type, each.log_time, each._data[: len(each._data) // 2], each._decode)
    with pytest.raises(ValueError, match="/cloud is no sensor_msgs/msg/PointCloud2"):
        broken.decode()


# ---- clouds


@pytest.mark.parametrize("kind", ["<f4", "<f8"])
@pytest.mark.parametrize("padding", [0, 12])
def test_a_cloud_is_a_view_of_its_points(kind, padding):
    points = np.random.default_rng(0).uniform(-1, 1, (5, 7, 3)).astype(kind)
    size = np.dtype(kind).itemsize
    message = cloud_message(
        START, "f", points, kind=kind, offsets=(3, 3 + 2 * size, 3 + size), point_step=4 * size + 5, row_padding=padding
    )
    view = recordings.cloud(message)
    assert view.shape == (5, 7) and np.shares_memory(view, message.data)
    for axis, name in enumerate("xyz"):
        assert np.array_equal(view[name], points[..., axis])
    import clearance

    robot = clearance.Robot.from_spheres({"ball": np.array([[0.0, 0, 3, 0.5]])})
    ask = clearance.Query(robot, clearance.MinDistance())
    distance = ask(view, poses=np.eye(4)[None]).distance
    assert distance == pytest.approx(np.linalg.norm(points.astype(float) - [0, 0, 3], axis=-1).min() - 0.5, abs=1e-6)


@pytest.mark.parametrize("data", [bytes, bytearray, lambda raw: memoryview(raw).cast("i")])
def test_a_cloud_of_any_bytes_is_read(data):
    message = cloud_message(START, "f", np.arange(12.0).reshape(4, 3))
    expected = recordings.cloud(message).copy()
    message.data = data(message.data.tobytes())
    assert np.array_equal(recordings.cloud(message), expected)


def test_a_cloud_without_points_is_empty():
    assert recordings.cloud(cloud_message(START, "f", np.zeros((0, 3)))).shape == (0,)


@pytest.mark.parametrize("said", [0, 1, 55, 57, 112, 280, 2**31])
def test_a_row_step_that_cannot_be_is_not_read_where_rows_lie_without_gaps(said):
    points = np.random.default_rng(0).uniform(-1, 1, (5, 7, 3)).astype("f4")
    message = cloud_message(START, "f", points, point_step=16)
    message.row_step = said
    view = recordings.cloud(message)
    assert all(np.array_equal(view[axis], points[..., k]) for k, axis in enumerate("xyz"))
    image = np.arange(35, dtype="<u2").reshape(5, 7)
    message = image_message(START, "f", image)
    message.step = said
    assert np.array_equal(recordings.depth(message), image)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"is_bigendian": True}, "big-endian"),
        ({"fields": []}, "no field x"),
        ({"width": -1}, "width is -1"),
        ({"row_step": 1 << 40}, "row_step is 1099511627776"),
        ({"point_step": 10}, "point_step"),
        ({"point_step": 0}, "point_step"),
        ({"width": 21}, "holds"),
        ({"height": 3, "width": 6, "row_step": 90}, "in rows of 90 bytes .row_step., but holds 320"),
        ({"data": np.zeros(3, np.uint8)}, "holds 3 bytes"),
    ],
)
def test_a_cloud_that_cannot_be_is_refused(change, says):
    message = cloud_message(START, "f", np.zeros((20, 3)))
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(ValueError, match=says):
        recordings.cloud(message)


def test_a_cloud_of_integers_is_refused():
    with pytest.raises(ValueError, match="FLOAT32"):
        recordings.cloud(cloud_message(START, "f", np.zeros((3, 3)), kind="<i4"))


# ---- images and cameras


@pytest.mark.parametrize("by", ["png", "rvl"])
def test_compressed_depth_is_what_was_packed(by):
    random = np.random.default_rng(4)
    image = random.integers(0, 65536, (23, 31)).astype("u2")
    image[random.random(image.shape) < 0.3] = 0
    image[5:9] = 0
    found, off = recordings.compressed_depth(compressed_message(START, "f", image, by=by))
    assert off is None and found.dtype == np.uint16 and np.array_equal(found, image)
    depth = random.uniform(0.2, 12, (23, 31)).astype("f4")
    depth[3] = np.nan
    found, off = recordings.compressed_depth(compressed_message(START, "f", depth, by=by))
    lost = ~(depth < 10)
    assert found.dtype == off.dtype == np.float32 and np.array_equal(np.isnan(found), lost) and lost.sum() > 40
    there = depth[~lost]
    assert (found[~lost] >= there * (1 - 1e-6)).all() and (found[~lost] - off[~lost] <= there).all()
    assert (off[~lost] < 1.1 * there**2 / 10100 + 1e-6).all()


@pytest.mark.parametrize(
    ("kind", "cut", "says"),
    [
        ("bgr8; jpeg compressed bgr8", None, "bgr8; jpeg compressed bgr8.*which is no depth"),
        ("", None, "which is no depth"),
        ("16UC1; compressedDepth", 5, "ends in the middle"),
        ("16UC1; compressedDepth", 40, "cut short"),
        ("16UC1; compressedDepth rvl", None, "more than the limit"),
        ("32FC1; compressedDepth", None, "parameters that no depth follows from"),
    ],
)
def test_a_compressed_image_that_is_no_depth_is_refused(kind, cut, says):
    message = compressed_message(START, "f", np.arange(35, dtype="u2").reshape(5, 7), kind=kind)
    message.data = message.data[:cut]
    with pytest.raises(ValueError, match=says):
        recordings.compressed_depth(message)


@pytest.mark.parametrize(("kind", "encoding"), [("<u2", None), ("<f4", None), ("<u2", "mono16")])
@pytest.mark.parametrize("padding", [0, 6])
def test_a_depth_image_is_a_view(kind, encoding, padding):
    image = (np.arange(35).reshape(5, 7) * 100).astype(kind)
    message = image_message(START, "f", image, encoding, padding)
    view = recordings.depth(message)
    assert np.array_equal(view, image) and np.shares_memory(view, message.data)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"is_bigendian": 1}, "big-endian"),
        ({"encoding": "rgb8"}, "rgb8"),
        ({"step": 5, "height": 4}, "in rows of 5 bytes .step., but holds 70"),
        ({"height": 9}, "holds"),
        ({"width": 0}, "pixels"),
    ],
)
def test_an_image_that_cannot_be_is_refused(change, says):
    message = image_message(START, "f", np.ones((5, 7), "<u2"))
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(ValueError, match=says):
        recordings.depth(message)


def bend(rays, model, d):
    """Written from OpenCV's documentation, one ray at a time."""
    x, y = rays
    r = math.hypot(x, y)
    if model == "equidistant":
        t = math.atan(r)
        seen = t * (1 + d[0] * t**2 + d[1] * t**4 + d[2] * t**6 + d[3] * t**8)
        return (x * seen / r, y * seen / r) if r else (0.0, 0.0)
    d = [*d, *[0.0] * (12 - len(d))]
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 = d
    radial = (1 + k1 * r**2 + k2 * r**4 + k3 * r**6) / (1 + k4 * r**2 + k5 * r**4 + k6 * r**6)
    return (
        x * radial + 2 * p1 * x * y + p2 * (r**2 + 2 * x**2) + s1 * r**2 + s2 * r**4,
        y * radial + p1 * (r**2 + 2 * y**2) + 2 * p2 * x * y + s3 * r**2 + s4 * r**4,
    )


LENSES = [
    ("plumb_bob", (-0.28, 0.07, 0.0005, -0.0008, 0.0)),
    ("plumb_bob", (0.13, -0.02, 0.001, 0.002)),
    ("rational_polynomial", (0.55, 0.06, -1e-4, 2e-4, 0.002, 0.88, 0.12, 0.01)),
    ("rational_polynomial", (0.5, 0.06, 0, 0, 0.002, 0.8, 0.12, 0.01, 1e-3, 2e-4, -1e-3, 1e-4)),
    ("equidistant", (0.02, -0.006, 0.001, -0.0002)),
]


@pytest.mark.parametrize(("model", "d"), LENSES)
def test_rays_are_those_that_the_lens_bends_to_the_pixels(model, d):
    fx, fy, cx, cy = 310.0, 305.0, 317.2, 243.9
    found = recordings.camera(info_message(START, "f", (480, 640), (fx, fy, cx, cy), d, model), (480, 640))["rays"]
    assert found.shape == (480, 640, 2) and found.dtype == np.float32
    for v, u in [(0, 0), (0, 639), (479, 0), (479, 639), (240, 320), (17, 400), (333, 50)]:
        x, y = bend(found[v, u].astype(float), model, d)
        assert (x * fx + cx, y * fy + cy) == pytest.approx((u, v), abs=1e-3)


def test_a_camera_without_distortion_is_its_four_numbers():
    for model, d in (("plumb_bob", (0.0,) * 5), ("", ()), ("rational_polynomial", (0.0,) * 8)):
        found = recordings.camera(info_message(START, "f", (48, 64), (50.0, 51.0, 31, 23), d, model), (48, 64))
        assert found == {"intrinsics": (50.0, 51.0, 31.0, 23.0)}


def test_a_region_and_binning_are_taken_into_account():
    info = info_message(START, "f", (480, 640), (500.0, 500.0, 320, 240), binning=2, roi=(100, 40, 400, 200))
    assert recordings.camera(info, (100, 200)) == {"intrinsics": (250.0, 250.0, 110.0, 100.0)}


def test_of_a_rectified_image_p_holds():
    p = [400, 0, 300, 0, 0, 401, 200, 0, 0, 0, 1, 0]
    info = info_message(START, "f", (480, 640), (500.0, 500.0, 320, 240), LENSES[0][1], p=p)
    assert recordings.camera(info, (480, 640), rectified=True) == {"intrinsics": (400.0, 401.0, 300.0, 200.0)}
    assert "rays" in recordings.camera(info, (480, 640))


@pytest.mark.parametrize(
    ("info", "says"),
    [
        (dict(k=(50, 50, 32, 24), model="double_sphere", d=(0.1, 0.2)), "double_sphere"),
        (dict(k=(50, 50, 32, 24), model="", d=(0.1, 0.2, 0, 0, 0)), "''"),
        (dict(k=(50, 50, 32, 24), d=(0.1, 0.2)), "2 coefficients"),
        (dict(k=(50, 50, 32, 24), model="rational_polynomial", d=(0.1,) * 14), "14 coefficients"),
        (dict(k=(50, 50, 32, 24), model="equidistant", d=()), "0 coefficients"),
        (dict(k=(0, 0, 0, 0)), "not calibrated"),
        (dict(k=(math.nan, 50, 0, 0)), "K that is not finite"),
        (dict(k=(50, 50, 32, 24), shape=(24, 64)), "24 x 64 pixels, the image of 48 x 64"),
        (dict(k=(1, 1, -900, -900), model="equidistant", d=(0, 0, 0, 0)), "leaves no pixel a ray"),
    ],
)
def test_a_camera_that_contradicts_itself_is_refused(info, says):
    message = info_message(START, "f", info.pop("shape", (48, 64)), **{"model": "plumb_bob", "d": (), **info})
    with pytest.raises(ValueError, match=says):
        recordings.camera(message, (48, 64))


@pytest.mark.parametrize(
    ("model", "d", "reach"),
    [
        ("plumb_bob", (-0.5, 0, 0, 0, 0), 2 / 3 * math.sqrt(2 / 3)),  # r (1 - r^2 / 2) turns back there
        ("equidistant", (0, 0, 0, 0), 1.55),  # wider, depth along the axis says nothing
    ],
)
def test_a_pixel_without_a_ray_is_dropped_and_counted(model, d, reach):
    import clearance

    info = info_message(START, "f", (48, 64), (20.0, 20.0, 32, 24), d, model)
    lens = recordings.camera(info, (48, 64))
    v, u = np.mgrid[0:48, 0:64]
    blind = np.hypot(u - 32, v - 24) / 20 > reach
    assert 0 < blind.sum() < blind.size and np.array_equal(np.isnan(lens["rays"]).any(-1), blind)
    robot = clearance.Robot.from_spheres({"ball": np.array([[0.0, 0, 1, 0.5]])})
    seen = clearance.depth_image(np.full((48, 64), 2.0, np.float32), **lens)
    result = clearance.Query(robot, clearance.MinDistance())(clouds=[seen], poses=np.eye(4)[None])
    assert result.dropped["not_finite"] == blind.sum() and result.valid == (~blind).sum()


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (dict(k=np.eye(4)), "k is a matrix of shape"),
        (dict(k="K"), "k is an array of numbers, not str"),
        (dict(d=[[1], [1, 2]]), "d is an array of numbers, not list"),
        (dict(roi=(600, 0, 41, 480)), "reaches beyond its 640 x 480"),
        (dict(binning=(-1, 0)), "bins -1 x 0 pixels"),
        (dict(width=0), "0 x 480 pixels"),
    ],
)
def test_a_camera_without_ros_is_refused_in_the_same_way(given, says):
    import clearance

    k = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]
    good = dict(width=640, height=480, k=k)
    seen = clearance.Camera(**good, roi=(100, 40, 400, 200), binning=(2, 2))
    assert (seen.width, seen.height, seen.intrinsics) == (200, 100, (250.0, 250.0, 110.0, 100.0))
    assert seen.rays().shape == (100, 200, 2)
    with pytest.raises(ValueError, match=f"^clearance: .*{says}"):
        clearance.Camera(**{**good, **given})


def test_a_camera_is_computed_once():
    cameras = recordings.Cameras()
    infos = [info_message(START + k, "f", (48, 64), (50.0, 50, 32, 24), LENSES[0][1]) for k in range(3)]
    first = cameras.of(infos[0], (48, 64), key="a")
    assert cameras.of(infos[1], (48, 64), key="a") is first
    infos[2].k[2] += 1
    assert cameras.of(infos[2], (48, 64), key="a") is not first


# ---- joints and transforms


def test_joints_are_interpolated_and_never_from_afar():
    joints = recordings.JointSamples()
    for k in (0, 2, 1):  # one is late
        joints.add(joint_message(START + k * 40 * MS, {"a": 10.0 * k, "b": 3.0}))
    joints.add(joint_message(START + 20 * MS, {"c": 1.0}))
    assert joints.at("a", START + 10 * MS, 0.1) == pytest.approx(2.5)
    assert joints.at("a", START + 50 * MS, 0.1) == pytest.approx(12.5)
    assert joints.at("a", START + 80 * MS, 0.1) == 20.0
    assert joints.at("a", START + 150 * MS, 0.1) == 20.0  # the last one is held for max_age
    with pytest.raises(recordings.Unknown, match="0.101 s older"):
        joints.at("a", START + 181 * MS, 0.1)
    with pytest.raises(recordings.Unknown, match="newer"):
        joints.at("c", START - 200 * MS, 0.1)
    with pytest.raises(recordings.Unknown, match="no JointState names the joint 'd'"):
        joints.at("d", START, 0.1)


def test_a_gap_of_joints_is_not_bridged():
    joints = recordings.JointSamples()
    joints.add(joint_message(START, {"a": 0.0}))
    joints.add(joint_message(START + 1000 * MS, {"a": 1.0}))
    assert joints.at("a", START + 90 * MS, 0.1) == 0.0
    with pytest.raises(recordings.Unknown):
        joints.at("a", START + 500 * MS, 0.1)
    assert joints.at("a", START + 950 * MS, 0.1) == 1.0


def test_a_joint_without_limits_takes_the_shorter_way():
    joints = recordings.JointSamples()
    joints.add(joint_message(START, {"a": 3.1}))
    joints.add(joint_message(START + 10 * MS, {"a": -3.1}))
    middle = joints.at("a", START + 5 * MS, 0.1, turns=True)
    assert math.cos(middle) == pytest.approx(-1)


def test_joint_states_that_cannot_be_are_refused():
    joints = recordings.JointSamples()
    message = joint_message(START, {"a": 1.0})
    message.name = ["a", "b"]
    with pytest.raises(ValueError, match="2 names and 1 positions"):
        joints.add(message)
    joints.add(joint_message(START, {"a": math.nan}))
    with pytest.raises(recordings.Unknown, match="nan"):
        joints.at("a", START, 0.1)


def test_a_clock_that_is_set_back_starts_anew():
    joints = recordings.JointSamples()
    joints.add(joint_message(START + 100_000 * MS, {"a": 1.0}))
    joints.add(joint_message(START, {"a": 5.0}))
    assert joints.at("a", START, 0.1) == 5.0


def test_old_samples_are_let_go():
    track = recordings.Track()
    for k in range(20_000):
        track.add(k * 10 * MS, k)
    assert len(track.stamps) < 7000 and track.around(199_990 * MS, 0.1, "")[0] == 19_999


def test_a_chain_of_transforms():
    tree = recordings.Transforms()
    tree.add(tf_message(transform(0, "base", "mast", (0, 0, 1))), static=True)
    tree.add(tf_message(transform(0, "flange", "camera", (0.1, 0, 0), about_z(math.pi / 2))), static=True)
    for k in range(2):
        tree.add(tf_message(transform(START + k * 100 * MS, "mast", "flange", (k, 0, 0), about_z(k * math.pi / 2))))
    found = tree.at("base", "camera", START + 50 * MS, 0.1)
    angle = math.pi / 4
    turn = np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])
    assert found[:3, 3] == pytest.approx([0.5 + 0.1 * math.cos(angle), 0.1 * math.sin(angle), 1])
    assert found[:3, :3] == pytest.approx(turn @ [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert tree.at("camera", "base", START + 50 * MS, 0.1) @ found == pytest.approx(np.eye(4))
    assert tree.at("mast", "base", START + 10**12, 0.1)[2, 3] == -1  # static ones always hold
    assert tree.at("base", "/base", START, 0.1) == pytest.approx(np.eye(4))
    with pytest.raises(recordings.Unknown, match="transform of 'flange': the nearest is 0.3 s older"):
        tree.at("base", "camera", START + 400 * MS, 0.1)
    with pytest.raises(recordings.Unknown, match="newer"):
        tree.at("base", "camera", START - 400 * MS, 0.1)
    with pytest.raises(recordings.Unknown, match="no transform names the frame 'lidar'"):
        tree.at("base", "lidar", START, 0.1)
    tree.add(tf_message(transform(0, "moon", "lidar")), static=True)
    with pytest.raises(recordings.Unknown, match="no transforms join 'lidar' to 'base'"):
        tree.at("base", "lidar", START, 0.1)


def test_a_stale_transform_above_two_frames_does_not_matter():
    tree = recordings.Transforms()
    tree.add(tf_message(transform(START, "map", "base", (5, 0, 0))))
    tree.add(tf_message(transform(0, "base", "camera", (0, 0, 1))), static=True)
    assert tree.at("base", "camera", START + 10**12, 0.1)[2, 3] == 1


def test_no_transform_is_guessed():
    tree = recordings.Transforms()
    tree.add(
        tf_message(transform(START, "base", "a", (math.nan, 0, 0)), transform(START, "base", "b", turn=(0, 0, 0, 0)))
    )
    for name, why in (("a", "its translation is nan, 0, 0"), ("b", "its quaternion is 0, 0, 0, 0")):
        with pytest.raises(recordings.Unknown, match=f"{name!r} in 'base' was refused: it is no rigid pose, because {why}"):
            tree.at("base", name, START, 0.1)
    # Also of what is between two frames, and of one that was good before.
    tree.add(tf_message(transform(0, "b", "c"), transform(0, "d", "d"), transform(0, "", "e")), static=True)
    with pytest.raises(recordings.Unknown, match="no transform names the frame 'base'; a transform of 'b' in 'base' was"):
        tree.at("base", "c", START, 0.1)
    assert len(tree.refused) == 4 and all("it does not name two frames" in said for said in tree.refused[2:])
    tree.add(tf_message(transform(START, "base", "f"), transform(START + 50 * MS, "base", "f", turn=(0, 0, 0, 0))))
    with pytest.raises(recordings.Unknown, match="0.4 s older.*'f' in 'base' was refused.*quaternion is 0, 0, 0, 0"):
        tree.at("base", "f", START + 400 * MS, 0.1)
    tree.add(tf_message(transform(START + 390 * MS, "/base", "/f", turn=(0, 0, 0, 1))))
    assert tree.at("/base", "f", START + 400 * MS, 0.1) == pytest.approx(np.eye(4))
    tree.add(tf_message(transform(START, "p", "q"), transform(START, "q", "p")))
    with pytest.raises(recordings.Unknown, match="ring"):
        tree.at("base", "p", START, 0.1)
    tree.add(tf_message(transform(START, "base", "tool"), transform(START + 100 * MS, "hand", "tool")))
    tree.add(tf_message(transform(START, "base", "hand")), static=True)
    with pytest.raises(recordings.Unknown, match="changes its parent"):
        tree.at("base", "tool", START + 50 * MS, 0.1)


def test_slerp_goes_the_shorter_way_at_an_even_pace():
    a, b = np.array(about_z(0.2)), -np.array(about_z(1.4))
    for part in (0.0, 0.25, 0.5, 1.0):
        found = recordings.pose(np.zeros(3), recordings.slerp(a, b, part))
        assert math.atan2(found[1, 0], found[0, 0]) == pytest.approx(0.2 + 1.2 * part)


# ---- surveys


def las_file(path, points, offsets, scale=0.001):
    laspy = pytest.importorskip("laspy", reason="laspy is not installed (extra las)")
    header = laspy.LasHeader(point_format=3, version="1.2")
    header.offsets, header.scales = offsets, [scale] * 3
    file = laspy.LasData(header)
    file.x, file.y, file.z = points.T
    try:
        file.write(path)
    except Exception as error:
        pytest.skip(f"laspy cannot write {path.suffix}: {error}")


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize("offsets", [[0, 0, 0], [445_000, 1_400_000, 0]])
def test_a_survey_keeps_its_millimetres(tmp_path, suffix, offsets):
    points = np.array([445_123.4, 1_412_345.6, 101.0]) + np.random.default_rng(1).uniform(-40, 40, (5000, 3))
    las_file(tmp_path / f"survey{suffix}", points, offsets)
    found, origin = recordings.las(tmp_path / f"survey{suffix}")
    assert found.dtype == np.float64 and found.shape == (5000, 3)
    assert found.min() >= -1e-9 and found.max() < 82
    assert np.array_equal(origin, np.floor(origin))
    assert found + origin == pytest.approx(points, abs=0.00051)
    data = (tmp_path / f"survey{suffix}").read_bytes()
    (tmp_path / f"cut{suffix}").write_bytes(data[: len(data) * 2 // 3])
    with pytest.raises(ValueError, match="cut"):
        recordings.las(tmp_path / f"cut{suffix}")


def copc_file(path, points, scale=0.001):
    """A small COPC file of two nodes, by its specification: chunks of different sizes, and where each of them lies."""
    laspy = pytest.importorskip("laspy", reason="laspy is not installed (extra las)")
    lazrs = pytest.importorskip("lazrs", reason="lazrs is not installed (extra las)")
    header = laspy.LasHeader(point_format=6, version="1.4")
    origin = np.floor(points.min(0))
    header.offsets, header.scales = origin, [scale] * 3
    whole = laspy.LasData(header)
    whole.x, whole.y, whole.z = points.T
    header.update(whole.points)
    middle, half = (points.min(0) + points.max(0)) / 2, np.ptp(points, axis=0).max() / 2 + 1
    packed = lazrs.LazVlr.new_for_compression(6, 0, True)
    points_at = 375 + 2 * 54 + 160 + len(packed.record_data())
    out = io.BytesIO()
    out.write(bytes(points_at))
    compressor = lazrs.LasZipCompressor(out, packed)
    compressor.reserve_offset_to_chunk_table()
    raw = np.frombuffer(whole.points.memoryview(), np.uint8)
    size, split, nodes = whole.points.point_size, len(points) // 3, []
    for level, (first, last) in enumerate(((0, split), (split, len(points)))):
        begin = out.tell()
        compressor.compress_many(raw[first * size : last * size])
        compressor.finish_current_chunk()
        nodes.append(struct.pack("<4iQ2i", level, 0, 0, 0, begin, out.tell() - begin, last - first))
    compressor.done()
    pages_at = out.tell() + 60
    out.write(struct.pack("<H16sHQ32s", 0, b"copc", 1000, 32 * len(nodes), b"") + b"".join(nodes))
    info = struct.pack("<5d2Q2d", *middle, half, half / 64, pages_at, 32 * len(nodes), 0, 0) + bytes(88)
    data = bytearray(out.getvalue())
    with io.BytesIO() as text:
        header.write_to(text)
        data[:375] = text.getvalue()[:375]
    struct.pack_into("<HIIBH", data, 94, 375, points_at, 2, 6 | 0x80, size)
    struct.pack_into("<QIQ", data, 235, pages_at - 60, 1, len(points))
    vlr = struct.pack("<H16sHH32s", 0, b"copc", 1, 160, b"") + info
    vlr += struct.pack("<H16sHH32s", 0, b"laszip encoded", 22204, len(packed.record_data()), b"")
    data[375:points_at] = vlr + bytes(packed.record_data())
    path.write_bytes(data)


def test_a_copc_file_is_read_whole(tmp_path):
    laspy = pytest.importorskip("laspy", reason="laspy is not installed (extra las)")
    points = np.array([445_123.4, 1_412_345.6, 101.0]) + np.random.default_rng(2).uniform(-40, 40, (6000, 3))
    copc_file(tmp_path / "survey.copc.laz", points)
    with laspy.CopcReader.open(tmp_path / "survey.copc.laz") as reader:  # so it is one
        assert len(reader.query(level=0)) == 2000 and len(reader.query()) == 6000
    found, origin = recordings.las(tmp_path / "survey.copc.laz")
    assert found + origin == pytest.approx(points, abs=0.00051)
    from clearance.seeing import files

    assert np.array_equal(files.read_cloud(tmp_path / "survey.copc.laz")[0], found + origin)
    data = (tmp_path / "survey.copc.laz").read_bytes()
    (tmp_path / "cut.copc.laz").write_bytes(data[: len(data) // 2])
    with pytest.raises(ValueError, match="cut"):
        recordings.las(tmp_path / "cut.copc.laz")
