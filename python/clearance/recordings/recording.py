# SPDX-License-Identifier: BSD-3-Clause
"""A recording as messages in the order of time: MCAP, rosbag2, ROS 1 bags, or what something else has read."""

import pathlib
import re
import shutil
import sqlite3
import tempfile

from .common import Damaged, needs, plain
from .files import SqliteRows, WholeRecords, encoding_of, in_order, logs, opened, type_of


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

    topics: {name: type}. encodings: {name: how its messages are encoded}: "cdr" and "ros1" are read. damage: None, or
    the sentence about what was found when it was opened.
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
        self._decode = {
            "cdr": rosbags.typesys.get_typestore(stores.LATEST).deserialize_cdr,
            "ros1": rosbags.typesys.get_typestore(stores.ROS1_NOETIC).deserialize_ros1,
        }
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
        self.topics, self.encodings = {}, {}
        for file in self._files:
            for each in file.connections:
                kind = type_of(each)
                if self.topics.setdefault(each.topic, kind) != kind:
                    raise ValueError(f"{self.path}: the topic {each.topic} has two types")
                if self.encodings.setdefault(each.topic, encoding_of(each)) != encoding_of(each):
                    raise ValueError(f"{self.path}: the topic {each.topic} has two encodings")

    def _open_folder(self):
        from rosbags.rosbag2 import Reader

        names = sorted(
            (each for each in self.path.iterdir() if each.suffix in (".mcap", ".db3")),
            key=lambda each: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", each.name)],
        )
        if (self.path / "metadata.yaml").exists() and not any(logs(each) for each in names):
            try:
                self._files = [opened(Reader(self.path))]
                return
            except Exception as error:
                if not names:
                    raise ValueError(f"{self.path}: {plain(error)}") from None
                if "Profile" not in plain(error):  # another writer's, which is read as it is
                    self._note(f"the folder could not be read by its metadata.yaml ({plain(error)})")
        if not names:
            raise ValueError(f"{self.path} holds no .mcap or .db3 file")
        self._files = [self._open_file(each) for each in names]

    def _open_file(self, path):
        from rosbags.rosbag1 import Reader as Reader1
        from rosbags.rosbag2 import Reader as Reader2

        if path.suffix not in (".mcap", ".db3", ".bag"):
            raise ValueError(f"{path} is no .mcap, .db3 or .bag file, and no folder of rosbag2")
        original = path
        if logs(path):
            path = self._with_log(path)
        try:
            return opened(Reader1(path) if path.suffix == ".bag" else Reader2(path))
        except Exception as error:
            why = plain(error)
        if path.suffix == ".bag":
            raise ValueError(f"{original}: {why}")
        try:
            if path.suffix == ".db3":
                file = SqliteRows(path)
            else:
                whole = WholeRecords(path)
                file = opened(Reader2(whole))
        except Exception as error:
            again = plain(error)
            raise ValueError(f"{original} cannot be read: {why if again == why else f'{why}; {again}'}") from None
        if "Profile" not in why or whole.rest_from + 37 > path.stat().st_size:
            self._note(f"{original.name} is truncated or damaged ({why}); it was read up to there")
        return file

    def _with_log(self, path):
        self._folder = self._folder or tempfile.TemporaryDirectory(prefix="clearance-")
        copy = pathlib.Path(self._folder.name) / path.name
        shutil.copy(path, copy)
        for each in logs(path):
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
                if not is_read(self, each.topic):
                    raise ValueError(
                        f"{self.path}: {each.topic} is encoded as {encoding_of(each)!r}, which is not read (CDR and "
                        "ROS 1's encoding are)"
                    )
            try:
                for each, log_time, data in in_order(file, of):
                    count += 1
                    yield Message(each.topic, type_of(each), log_time, data, self._decode[encoding_of(each)])
            except GeneratorExit:
                raise
            except Exception as error:
                raise Damaged(f"{self.path} is damaged after {count} messages: {plain(error)}") from None
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
        self.encodings = dict.fromkeys(self.topics, "cdr")

    def messages(self, topics=None):
        """Yields each Message of the topics (all, unless given) in the order of time."""
        return (each for each in self._read if topics is None or each.topic in topics)

    def close(self):
        self._read = []

    __enter__, __exit__ = Recording.__enter__, Recording.__exit__


def is_read(recording, topic):
    """Whether messages of a topic are in an encoding that is read."""
    return recording.encodings[topic] in ("cdr", "ros1")
