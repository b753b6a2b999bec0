# SPDX-License-Identifier: BSD-3-Clause
"""Recordings, read without ROS: MCAP, rosbag2 and ROS 1 bags (extra `ros`), and LAS, LAZ and COPC files (extra `las`).

Messages are any objects with the fields of ROS's: those of `rosbags`, of a DDS library, or of ROS itself.
"""

import bisect
import io
import pathlib
import re
import shutil
import sqlite3
import tempfile

import numpy as np

from . import _core

CLOUD = "sensor_msgs/msg/PointCloud2"
IMAGE = "sensor_msgs/msg/Image"
CAMERA = "sensor_msgs/msg/CameraInfo"
JOINTS = "sensor_msgs/msg/JointState"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
OLD_TRANSFORMS = "tf/msg/tfMessage"
READ = (CLOUD, IMAGE, CAMERA, JOINTS, TRANSFORMS, OLD_TRANSFORMS)

MAGIC = b"\x89MCAP0\r\n"


class Damaged(ValueError):
    """A recording ends before its end: what was read before this is whole."""


class Unknown(ValueError):
    """What a frame needs is missing or too old, so it cannot be asked."""


def needs(extra, error):
    """The sentence about an extra that is not installed."""
    return ImportError(f"{error.name} is not installed: pip install clearance[{extra}]")


def nanoseconds(stamp):
    """A ROS stamp as an integer."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


# ---- files ----------------------------------------------------------------------------------------------------------


class _WholeRecords(io.RawIOBase):
    """An MCAP file as far as its records are whole, with a header and a footer that rosbags accepts."""

    suffix = ".mcap"

    def __init__(self, path):
        self.path = path
        self.file = None

    def exists(self):
        return True

    def is_dir(self):
        return False

    def __str__(self):
        return str(self.path)

    def open(self, mode="rb"):
        self.file = open(self.path, "rb")
        size = self.file.seek(0, 2)
        self.file.seek(0)
        self.head = self._header(self.file)
        at = len(self.head)
        while at + 9 <= size:
            self.file.seek(at)
            record = self.file.read(9)
            end = at + 9 + int.from_bytes(record[1:], "little")
            if record[0] in (0x00, 0x02, 0x0F) or end > size:  # the footer, the data's end, or no record
                break
            at = end
        self.rest_from = at
        self.tail = b"\x02" + (20).to_bytes(8, "little") + bytes(20) + MAGIC
        self.size = at + len(self.tail)
        self.at = 0
        return self

    def _header(self, file):
        head = file.read(17)
        length = int.from_bytes(head[9:17], "little")
        if head[:8] != MAGIC or head[8:9] != b"\x01" or length > 1 << 20:
            raise ValueError(f"{self.path} does not begin as an MCAP file does")
        body = file.read(length)
        profile = body[4 : 4 + int.from_bytes(body[:4], "little")]
        # Other writers may give no profile; schemas still say what the file holds. Lengths stay the same.
        if profile == b"" and len(body) >= 12:
            library = body[8 : 8 + int.from_bytes(body[4:8], "little") - 4]
            if len(library) + 12 == len(body):
                body = (4).to_bytes(4, "little") + b"ros2" + len(library).to_bytes(4, "little") + library
        return head + body

    def readable(self):
        return True

    def seekable(self):
        return True

    def tell(self):
        return self.at

    def seek(self, to, whence=0):
        self.at = max(0, to + (0, self.at, self.size)[whence])
        return self.at

    def read(self, count=-1):
        end = self.size if count is None or count < 0 else min(self.size, self.at + count)
        pieces = []
        while self.at < end:
            if self.at < len(self.head):
                piece = self.head[self.at : end]
            elif self.at < self.rest_from:
                self.file.seek(self.at)
                piece = self.file.read(min(end, self.rest_from) - self.at)
            else:
                piece = self.tail[self.at - self.rest_from : end - self.rest_from]
            if not piece:
                break
            pieces.append(piece)
            self.at += len(piece)
        return pieces[0] if len(pieces) == 1 else b"".join(pieces)

    def close(self):
        if self.file:
            self.file.close()
        super().close()


class _SqliteRows:
    """A rosbag2 database that rosbags does not open: its rows in the order of writing, as far as they can be read."""

    def __init__(self, path):
        import apsw

        with open(path, "rb") as file:
            head = file.read(18)
        page = int.from_bytes(head[16:18], "big")
        page = 65536 if page == 1 else max(512, page)

        class WholePages(apsw.VFSFile):  # of half a page SQLite would read the rest as zeros
            def __init__(self, name, flags):
                super().__init__("", name, flags)

            def xFileSize(self):
                size = super().xFileSize()
                return size - size % page

        class Files(apsw.VFS):
            def __init__(self):
                super().__init__("clearance", "")

            def xOpen(self, name, flags):
                return WholePages(name, flags)

        self.files = Files()
        self.base = apsw.Connection(
            f"{pathlib.Path(path).absolute().as_uri()}?immutable=1",
            flags=apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI,
            vfs="clearance",
        )
        self.base.execute("PRAGMA writable_schema=ON")  # SQLite reads what is there, though the file is too short
        topics = self.base.execute("SELECT id, name, type, serialization_format FROM topics").fetchall()
        self.connections = [_Topic(*topic) for topic in topics]

    def messages(self, connections):
        wanted = {each.id: each for each in connections}
        for topic, log_time, data in self.base.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id"):
            if topic in wanted:
                yield wanted[topic], log_time, data

    def close(self):
        self.base.close()


class _Topic:
    def __init__(self, number, topic, msgtype, encoding):
        self.id, self.topic, self.msgtype, self.encoding = number, topic, msgtype, encoding


class Message:
    """One message of a recording: topic, type, when it was recorded (ns), and decode()."""

    __slots__ = ("topic", "type", "log_time", "_data", "_decode")

    def __init__(self, topic, kind, log_time, data, decode):
        self.topic, self.type, self.log_time, self._data, self._decode = topic, kind, log_time, data, decode

    def decode(self):
        """The message itself; a payload is a view of what was read. ValueError if its bytes are not such a message."""
        try:
            return self._decode(self._data, self.type)
        except Exception as error:
            what = f"{error}".strip() or type(error).__name__
            raise ValueError(f"a message of {self.topic} is no {self.type} ({what})") from None


class Recording:
    """A recording: an MCAP file, a rosbag2 folder or database, or a ROS 1 bag. A context manager.

    topics: {name: type}. damage: None, or the sentence about what was found when it was opened.
    """

    def __init__(self, path):
        try:
            import rosbags.rosbag1  # noqa: F401
            import rosbags.rosbag2  # noqa: F401
            import rosbags.typesys
        except ImportError as error:
            raise needs("ros", error) from None
        self.path = pathlib.Path(path)
        self.damage = None
        self._folder = None
        self._files = []
        stores = rosbags.typesys.Stores
        ros1 = self.path.suffix == ".bag" and not self.path.is_dir()
        types = rosbags.typesys.get_typestore(stores.ROS1_NOETIC if ros1 else stores.LATEST)
        self._decode = types.deserialize_ros1 if ros1 else types.deserialize_cdr
        if not self.path.exists():
            raise ValueError(f"there is no recording {self.path}")
        try:
            if self.path.is_dir():
                self._open_folder()
            else:
                self._files = [self._open_file(self.path)]
        except BaseException:
            self.close()
            raise
        self.topics = {}
        for file in self._files:
            for each in file.connections:
                if self.topics.setdefault(each.topic, each.msgtype) != each.msgtype:
                    raise ValueError(f"{self.path}: the topic {each.topic} has two types")

    def _open_folder(self):
        from rosbags.rosbag2 import Reader

        names = sorted(
            (each for each in self.path.iterdir() if each.suffix in (".mcap", ".db3")),
            key=lambda each: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", each.name)],
        )
        if (self.path / "metadata.yaml").exists() and not any(_logs(each) for each in names):
            try:
                self._files = [_opened(Reader(self.path))]
                return
            except Exception as error:
                if not names:
                    raise ValueError(f"{self.path}: {_plain(error)}") from None
                self._note(f"the folder could not be read by its metadata.yaml ({_plain(error)})")
        if not names:
            raise ValueError(f"{self.path} holds no .mcap or .db3 file")
        self._files = [self._open_file(each) for each in names]

    def _open_file(self, path):
        from rosbags.rosbag1 import Reader as Reader1
        from rosbags.rosbag2 import Reader as Reader2

        if path.suffix not in (".mcap", ".db3", ".bag"):
            raise ValueError(f"{path} is no .mcap, .db3 or .bag file, and no folder of rosbag2")
        original = path
        if _logs(path):
            path = self._with_log(path)
        try:
            return _opened(Reader1(path) if path.suffix == ".bag" else Reader2(path))
        except Exception as error:
            why = _plain(error)
        if path.suffix == ".bag":
            raise ValueError(f"{original}: {why}")
        try:
            if path.suffix == ".db3":
                file = _SqliteRows(path)
            else:
                whole = _WholeRecords(path)
                file = _opened(Reader2(whole))
        except Exception as error:
            again = _plain(error)
            raise ValueError(f"{original} cannot be read: {why if again == why else f'{why}; {again}'}") from None
        if "Profile" not in why or whole.rest_from + 37 > path.stat().st_size:
            self._note(f"{original.name} is truncated or damaged ({why}); it was read up to there")
        return file

    def _with_log(self, path):
        self._folder = self._folder or tempfile.TemporaryDirectory(prefix="clearance-")
        copy = pathlib.Path(self._folder.name) / path.name
        shutil.copy(path, copy)
        for each in _logs(path):
            shutil.copy(each, copy.parent / each.name)
        with sqlite3.connect(copy) as base:
            base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            base.execute("PRAGMA journal_mode=DELETE")
        base.close()
        return copy

    def _note(self, sentence):
        self.damage = f"{self.damage}; {sentence}" if self.damage else sentence

    def messages(self, topics=None):
        """Yields each Message of the topics (all, unless given) in the order of time, reading only as far as asked.

        Raises Damaged, after what could be read, if the recording is damaged or truncated.
        """
        wanted = None if topics is None else set(topics)
        count = 0
        for file in self._files:
            of = [each for each in file.connections if wanted is None or each.topic in wanted]
            if not of:
                continue
            for each in of:
                encoding = getattr(each, "encoding", getattr(getattr(each, "ext", None), "serialization_format", "cdr"))
                if encoding not in ("cdr", "ros1"):
                    raise ValueError(f"{self.path}: {each.topic} is encoded as {encoding!r}, not as CDR")
            try:
                for each, log_time, data in _in_order(file, of):
                    count += 1
                    yield Message(each.topic, each.msgtype, log_time, data, self._decode)
            except GeneratorExit:
                raise
            except Exception as error:
                raise Damaged(f"{self.path} is damaged after {count} messages: {_plain(error)}") from None
        if self.damage:
            raise Damaged(f"{self.path}: {self.damage}")

    def close(self):
        for file in self._files:
            file.close()
        self._files = []
        if self._folder:
            self._folder.cleanup()
            self._folder = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Messages:
    """Messages that something else has read, such as Ray's read_mcap, as a Recording. A context manager.

    read: (topic, type, when it was recorded (ns), CDR bytes) of each message, in any order.
    """

    damage = None

    def __init__(self, path, read):
        try:
            import rosbags.typesys
        except ImportError as error:
            raise needs("ros", error) from None
        decode = rosbags.typesys.get_typestore(rosbags.typesys.Stores.LATEST).deserialize_cdr
        self.path = path
        self._read = sorted((Message(*each, decode) for each in read), key=lambda each: each.log_time)
        self.topics = {each.topic: each.type for each in self._read}

    def messages(self, topics=None):
        """Yields each Message of the topics (all, unless given) in the order of time."""
        return (each for each in self._read if topics is None or each.topic in topics)

    def close(self):
        self._read = []

    __enter__, __exit__ = Recording.__enter__, Recording.__exit__


def _opened(reader):
    reader.open()
    return reader


def _logs(path):
    """What a database that was not closed keeps beside it; rosbags would not see it."""
    logs = (pathlib.Path(f"{path}{end}") for end in ("-wal", "-journal") if path.suffix == ".db3")
    return [each for each in logs if each.exists() and each.stat().st_size > 0]


def _in_order(file, connections):
    storage = getattr(file, "storage", None)
    # A file without an index is read as it was written; rosbags would refuse it if two topics overlap in time.
    if hasattr(storage, "messages_scan") and not storage.chunks:
        return storage.messages_scan(connections)
    return file.messages(connections)


def _plain(error):
    return (str(error).strip() or type(error).__name__).rstrip(".")


# ---- clouds and images ----------------------------------------------------------------------------------------------


def cloud(message):
    """A PointCloud2 as a structured view, (width,) or (height, width), of x, y and z: nothing is copied.

    ValueError with a sentence if it has no x, y and z of FLOAT32 or FLOAT64, is big-endian, or is shorter than it says.
    """
    data = memoryview(message.data).cast("B")
    offsets, size, rows, columns, step, row_step = _core._cloud_layout(message, data)
    point = np.dtype({"names": ["x", "y", "z"], "formats": [f"<f{size}"] * 3, "offsets": offsets, "itemsize": step})
    if not rows or not columns:
        return np.empty(0, point)
    view = np.ndarray((rows, columns), point, data, strides=(row_step, step))
    return view[0] if rows == 1 else view


def depth(message):
    """A depth Image as a view, (rows, columns): uint16 millimetres (16UC1, mono16) or float32 metres (32FC1)."""
    if message.is_bigendian:
        raise ValueError("the image is big-endian")
    kinds = {"16UC1": "<u2", "mono16": "<u2", "32FC1": "<f4"}
    if message.encoding not in kinds:
        raise ValueError(
            f"the image is encoded as {message.encoding!r}, which is no depth (16UC1, mono16 and 32FC1 are)"
        )
    kind = np.dtype(kinds[message.encoding])
    rows, columns, step = int(message.height), int(message.width), int(message.step)
    if step < columns * kind.itemsize:
        raise ValueError(f"the image's step is {step} bytes, too few for {columns} pixels of {kind.itemsize} bytes")
    data = memoryview(message.data)
    if not rows or not columns:
        raise ValueError(f"the image has {rows} x {columns} pixels")
    if len(data) < (rows - 1) * step + columns * kind.itemsize:
        raise ValueError(f"the image says {rows} rows of {step} bytes, but holds {len(data)} bytes")
    return np.ndarray((rows, columns), kind, data, strides=(step, kind.itemsize))


# ---- cameras --------------------------------------------------------------------------------------------------------


def _field(info, name):
    value = getattr(info, name, None)
    return np.asarray(getattr(info, name.upper()) if value is None else value, float)  # ROS 1 writes K, D and P


class Cameras:
    """From a CameraInfo to what depth_image takes; computed anew only when the CameraInfo changes."""

    def __init__(self):
        self._last = {}

    def of(self, info, shape, rectified=False, key=None):
        """{"intrinsics": (fx, fy, cx, cy)}, or {"rays": (rows, columns, 2)} if the lens distorts.

        shape: of the image. rectified: the image was undistorted, so P holds and K and D do not.
        A pixel at which the lens cannot be inverted has the ray NaN. ValueError with a sentence if the model is unknown.
        """
        roi = info.roi
        said = (
            int(info.width),
            int(info.height),
            info.distortion_model,
            int(info.binning_x),
            int(info.binning_y),
            int(roi.x_offset),
            int(roi.y_offset),
            int(roi.width),
            int(roi.height),
            tuple(shape),
            bool(rectified),
            *(_field(info, name).tobytes() for name in "kdp"),
        )
        if self._last.get(key, (None,))[0] != said:
            self._last[key] = (said, camera(info, shape, rectified))
        return self._last[key][1]


def camera(info, shape, rectified=False):
    """What depth_image takes for a CameraInfo, as Cameras.of, computed anew."""
    rows, columns = shape
    k, d, p = _field(info, "k"), _field(info, "d"), _field(info, "p").reshape(3, 4)
    if rectified:
        if not p[0, 0] and d.any():
            raise ValueError("the image is rectified, but the CameraInfo's P is empty")
        k, d = p[:, :3] if p[0, 0] else k, ()
    roi = info.roi
    made = _core.Camera(
        int(info.width),
        int(info.height),
        k,
        d,
        "" if rectified else info.distortion_model,
        binning=(int(info.binning_x), int(info.binning_y)),
        roi=(int(roi.x_offset), int(roi.y_offset), int(roi.width), int(roi.height)),
    )
    if (made.height, made.width) != (rows, columns):
        raise ValueError(f"the CameraInfo is of {made.height} x {made.width} pixels, the image of {rows} x {columns}")
    return {"rays": made.rays()} if made.intrinsics is None else {"intrinsics": made.intrinsics}


# ---- what is known at a stamp ---------------------------------------------------------------------------------------

KEPT = 30_000_000_000  # ns of samples that are kept
BACK = 2_000_000_000  # ns; a stamp that is older by more means a clock that was set back


class Track:
    """Samples of one thing, by stamp (ns): the pair around a stamp, never one that is farther than max_age seconds."""

    def __init__(self):
        self.stamps, self.values = [], []

    def add(self, stamp, value):
        stamps = self.stamps
        if stamps and stamp < stamps[-1] - BACK:  # what was known is of another time
            stamps.clear()
            self.values.clear()
        if not stamps or stamp > stamps[-1]:
            stamps.append(stamp)
            self.values.append(value)
        else:
            at = bisect.bisect_left(stamps, stamp)
            if stamps[at] == stamp:
                self.values[at] = value
            else:
                stamps.insert(at, stamp)
                self.values.insert(at, value)
        if len(stamps) > 256 and stamps[0] < stamps[-1] - 2 * KEPT:
            old = bisect.bisect_left(stamps, stamps[-1] - KEPT)
            del stamps[:old], self.values[:old]

    def covers(self, stamp):
        return bool(self.stamps) and self.stamps[-1] >= stamp

    def around(self, stamp, max_age, what):
        """(before, after, how far between them, 0 to 1); the same sample twice where only one is near enough."""
        if not self.stamps:
            raise Unknown(f"{what}: there is none")
        after = bisect.bisect_left(self.stamps, stamp)
        limit = max_age * 1e9
        if after < len(self.stamps) and self.stamps[after] == stamp:
            return self.values[after], self.values[after], 0.0
        old = stamp - self.stamps[after - 1] if after > 0 else np.inf
        new = self.stamps[after] - stamp if after < len(self.stamps) else np.inf
        if min(old, new) > limit:
            near, side = (old, "older") if old <= new else (new, "newer")
            raise Unknown(
                f"{what}: the nearest is {near / 1e9:.3g} s {side} than the frame (at most {max_age:g} s is allowed)"
            )
        if max(old, new) <= limit:
            return self.values[after - 1], self.values[after], old / (old + new)
        near = self.values[after - 1] if old < new else self.values[after]
        return near, near, 0.0


class JointSamples:
    """JointState messages, by joint: they may name some joints each."""

    def __init__(self):
        self.tracks = {}

    def add(self, message):
        """ValueError if positions and names do not agree."""
        names, positions = list(message.name), message.position
        if len(positions) == 0:
            return  # only velocities or efforts
        if len(names) != len(positions):
            raise ValueError(f"a JointState has {len(names)} names and {len(positions)} positions")
        stamp = nanoseconds(message.header.stamp)
        for name, position in zip(names, positions, strict=True):
            self.tracks.setdefault(name, Track()).add(stamp, float(position))

    def covers(self, names, stamp):
        return all(name in self.tracks and self.tracks[name].covers(stamp) for name in names)

    def at(self, name, stamp, max_age, turns=False):
        """A joint's value at a stamp, interpolated. turns: it has no limits, so it takes the shorter way round."""
        if name not in self.tracks:
            raise Unknown(f"no JointState names the joint {name!r}")
        before, after, part = self.tracks[name].around(stamp, max_age, f"JointState of {name!r}")
        step = after - before
        if turns:
            step = (step + np.pi) % (2 * np.pi) - np.pi
        value = before + part * step
        if not np.isfinite(value):
            raise Unknown(f"the joint {name!r} is at {value}")
        return value


class Transforms:
    """A tree of frames. Rigid poses are interpolated at a stamp; what is missing or too old is a sentence (Unknown)."""

    def __init__(self):
        self._tracks = {}
        self._fixed = {}
        self._refused = {}

    def add(self, message, static=False, keep=False):
        """A TFMessage. static: its transforms always hold. keep: those that are known already stay."""
        for each in message.transforms:
            parent, child = each.header.frame_id.lstrip("/"), each.child_frame_id.lstrip("/")
            t, q = each.transform.translation, each.transform.rotation
            at, turn = np.array([t.x, t.y, t.z], float), np.array([q.x, q.y, q.z, q.w], float)
            length = np.linalg.norm(turn)
            if not np.isfinite(at).all() or not abs(length - 1) < 0.01 or parent == child or not parent or not child:
                self._refused[child] = f"a transform of {child!r} in {parent!r} was refused: it is no rigid pose"
                continue
            self._refused.pop(child, None)
            if static:
                if not keep or child not in self._fixed:
                    self._fixed[child] = (parent, pose(at, turn / length))
            else:
                self._tracks.setdefault(child, Track()).add(nanoseconds(each.header.stamp), (parent, at, turn / length))

    @property
    def frames(self):
        """The names of all frames."""
        names = dict.fromkeys((*self._fixed, *self._tracks))
        names.update(dict.fromkeys(each[0] for each in self._fixed.values()))
        names.update(dict.fromkeys(track.values[-1][0] for track in self._tracks.values()))
        return list(names)

    def knows(self, frame):
        """Whether a transform names a frame."""
        frame = frame.lstrip("/")
        return frame in self._fixed or frame in self._tracks or frame in self.frames

    def _step(self, child, stamp, max_age):
        if child in self._fixed:
            return self._fixed[child]
        if child not in self._tracks:
            return None
        before, after, part = self._tracks[child].around(stamp, max_age, f"transform of {child!r}")
        if before[0] != after[0]:
            raise Unknown(
                f"the frame {child!r} changes its parent from {before[0]!r} to {after[0]!r} at the frame's time"
            )
        return before[0], pose(before[1] + part * (after[1] - before[1]), slerp(before[2], after[2], part))

    def at(self, target, source, stamp, max_age):
        """The pose of source in target, (4, 4), at a stamp (ns): target-from-source."""
        target, source = target.lstrip("/"), source.lstrip("/")
        if target == source:
            return np.eye(4)
        # Only what is between the two frames has to hold: so a stale transform above both is no matter.
        downs = self._names_up(target, stamp)
        common = next((name for name in self._names_up(source, stamp) if name in downs), None)
        if common is None:
            why = next((said for name, said in self._refused.items() if name in (target, source)), None)
            known = self.frames
            lost = next((name for name in (source, target) if name not in known), None)
            text = f"no transform names the frame {lost!r}" if lost else f"no transforms join {source!r} to {target!r}"
            raise Unknown(f"{text}; {why}" if why else text)
        found = self._pose_in(source, common, stamp, max_age)
        return found if common == target else inverse(self._pose_in(target, common, stamp, max_age)) @ found

    def _names_up(self, frame, stamp):
        names = [frame]
        while parent := self._parent(names[-1], stamp):
            if parent in names:
                raise Unknown(f"the frames form a ring at {parent!r}")
            names.append(parent)
        return names

    def _parent(self, child, stamp):
        if child in self._fixed:
            return self._fixed[child][0]
        track = self._tracks.get(child)
        if not track or not track.stamps:
            return None
        at = bisect.bisect_left(track.stamps, stamp)
        before, after = max(0, at - 1), min(at, len(track.stamps) - 1)
        return track.values[before if stamp - track.stamps[before] <= track.stamps[after] - stamp else after][0]

    def _pose_in(self, frame, above, stamp, max_age):
        at = np.eye(4)
        while frame != above:
            frame, step = self._step(frame, stamp, max_age)
            at = step @ at
        return at

    def covers(self, target, source, stamp):
        """Whether the transforms between two frames are known up to a stamp, so that none needs to be waited for."""
        target, source = target.lstrip("/"), source.lstrip("/")
        try:
            ups = [self._names_up(name, stamp) for name in (target, source)]
        except Unknown:
            return False
        if target != source and not set(ups[0]) & set(ups[1]):
            return False
        moving = set(ups[0]) ^ set(ups[1])
        return all(
            self._tracks[name].covers(stamp) for name in moving if name in self._tracks and name not in self._fixed
        )


def inverse(rigid):
    """Of a rigid pose."""
    back = np.eye(4)
    back[:3, :3] = rigid[:3, :3].T
    back[:3, 3] = -rigid[:3, :3].T @ rigid[:3, 3]
    return back


def pose(at, turn):
    """A (4, 4) matrix of a position and a unit quaternion x, y, z, w."""
    x, y, z, w = turn
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = at
    return matrix


def slerp(a, b, part):
    """Between two unit quaternions, along the shorter way."""
    if part == 0:
        return a
    cosine = float(a @ b)
    if cosine < 0:
        b, cosine = -b, -cosine
    if cosine > 1 - 1e-9:
        mixed = a + part * (b - a)
        return mixed / np.linalg.norm(mixed)
    angle = np.arccos(cosine)
    return (np.sin((1 - part) * angle) * a + np.sin(part * angle) * b) / np.sin(angle)


# ---- surveys --------------------------------------------------------------------------------------------------------


def las(path):
    """A LAS, LAZ or COPC file: points (n, 3), float64, and origin (3,): its coordinates are points + origin.

    The origin is whole, and near the points, so that nothing is lost where coordinates are large. Every point is read,
    whatever its class. Lengths are those of the file.
    """
    try:
        import laspy
    except ImportError as error:
        raise needs("las", error) from None
    try:
        with laspy.open(path) as file:
            header = file.header
            read = file.read()
            counts = np.stack([np.asarray(read.X), np.asarray(read.Y), np.asarray(read.Z)], -1)
            expected = header.point_count
    except (OSError, ImportError):
        raise
    except Exception as error:  # laspy and its decompressors raise many kinds
        raise ValueError(f"{path} cannot be read: {_plain(error)}") from None
    if len(counts) != expected:
        raise ValueError(f"{path} says {expected} points, but holds {len(counts)}")
    scale, offset = np.asarray(header.scales, float), np.asarray(header.offsets, float)
    low = counts.min(0) if len(counts) else np.zeros(3)
    origin = np.floor(low * scale + offset)
    return counts * scale + (offset - origin), origin
