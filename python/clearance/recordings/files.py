# SPDX-License-Identifier: BSD-3-Clause
"""Files that rosbags does not open as they are: cut short, without an index, by other writers, or still open."""

import contextlib
import io
import pathlib
import re
import threading

from .common import MAGIC


class WholeRecords(io.RawIOBase):
    """An MCAP file as far as its records are whole, with a header and a footer that rosbags accepts.

    Other writers give no profile, or another one, such as ros1. Channels still say what the file holds.
    """

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
        self.begin = at = self._after_header(self.file)
        while at + 9 <= size:
            self.file.seek(at)
            record = self.file.read(9)
            end = at + 9 + int.from_bytes(record[1:], "little")
            if record[0] in (0x00, 0x02, 0x0F) or end > size:  # the footer, the data's end, or no record
                break
            at = end
        self.rest_from = at
        self.head = MAGIC + b"\x01" + (12).to_bytes(8, "little") + (4).to_bytes(4, "little") + b"ros2" + bytes(4)
        self.tail = b"\x02" + (20).to_bytes(8, "little") + bytes(20) + MAGIC
        self.whole = at - self.begin
        self.size = len(self.head) + self.whole + len(self.tail)
        self.at = 0
        return self

    def _after_header(self, file):
        head = file.read(17)
        length = int.from_bytes(head[9:17], "little")
        if head[:8] != MAGIC or head[8:9] != b"\x01" or length > 1 << 20:
            raise ValueError(f"{self.path} does not begin as an MCAP file does")
        return len(head) + length

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
            inside = self.at - len(self.head)
            if inside < 0:
                piece = self.head[self.at : end]
            elif inside < self.whole:
                self.file.seek(self.begin + inside)
                piece = self.file.read(min(end - self.at, self.whole - inside))
            else:
                piece = self.tail[inside - self.whole :][: end - self.at]
            if not piece:
                break
            pieces.append(piece)
            self.at += len(piece)
        return pieces[0] if len(pieces) == 1 else b"".join(pieces)

    def close(self):
        if self.file:
            self.file.close()
        super().close()


_opening = threading.Lock()


@contextlib.contextmanager
def _any_schema():
    """rosbags opens no MCAP file that holds a schema of another kind, though it need not be read."""
    from rosbags.rosbag2 import storage_mcap

    known = storage_mcap.get_msgdef

    def lenient(schema):
        try:
            return known(schema)
        except KeyError:
            return known(None)

    with _opening:
        storage_mcap.get_msgdef = lenient
        try:
            yield
        finally:
            storage_mcap.get_msgdef = known


class SqliteRows:
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


def opened(reader):
    with _any_schema():
        reader.open()
    return reader


def encoding_of(connection):
    if hasattr(connection, "encoding"):
        return connection.encoding
    return getattr(getattr(connection, "ext", None), "serialization_format", "ros1")  # of a ROS 1 bag it is not said


def type_of(connection):
    """Its type as ROS 2 writes it: ROS 1 leaves out the middle."""
    return re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", connection.msgtype)


def logs(path):
    """What a database that was not closed keeps beside it; rosbags would not see it."""
    logs = (pathlib.Path(f"{path}{end}") for end in ("-wal", "-journal") if path.suffix == ".db3")
    return [each for each in logs if each.exists() and each.stat().st_size > 0]


def in_order(file, connections):
    storage = getattr(file, "storage", None)
    # A file without an index is read as it was written; rosbags would refuse it if two topics overlap in time.
    if hasattr(storage, "messages_scan") and not storage.chunks:
        return storage.messages_scan(connections)
    return file.messages(connections)
