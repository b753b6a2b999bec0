# SPDX-License-Identifier: BSD-3-Clause
"""A node on ROS 2's wire without ROS (extra `node`): sensors' topics in, the clearance out.

DDS types are made from the message definitions, and bytes are read and written by `rosbags`: so a payload is not
copied.
"""

import collections
import math
import os
import time

import numpy as np

from . import _core, playing, recordings
from .recordings import nanoseconds

RANGE = "sensor_msgs/msg/Range"
MARKERS = "visualization_msgs/msg/MarkerArray"
STOP = "nav2_msgs/msg/CollisionMonitorState"
CLEARANCE = "clearance_msgs/msg/Clearance"

# As in python/clearance_msgs/msg, without comments; a test compares them.
DEFINITIONS = {
    CLEARANCE: """
uint8 UNKNOWN=0
uint8 NO_DATA=1
uint8 FREE=2
uint8 POSSIBLE=3
uint8 COLLISION=4
uint32 NO_POINT=4294967295
std_msgs/Header header
string topic
string sensor_frame
uint8 state
float64 distance
float64 lower
float64 upper
string link
uint32 point
geometry_msgs/Point at
geometry_msgs/Point nearest
uint64 seen
uint64 valid
Dropped[] dropped
PartClearance[] parts
uint64 late
uint64 skipped
string note
""",
    "clearance_msgs/msg/Dropped": "string reason\nuint64 count\n",
    "clearance_msgs/msg/PartClearance": "string link\nfloat64 distance\n",
    STOP: """
uint8 DO_NOTHING=0
uint8 STOP=1
uint8 SLOWDOWN=2
uint8 APPROACH=3
uint8 LIMIT=4
uint8 action_type
string polygon_name
""",
}


class _Sample:
    """What came over the wire: decode() gives the message."""

    def __init__(self, data, decode):
        self.data, self.decode = data, decode


class Wire:
    """Topics of ROS 2 on a DDS domain: readers and writers of messages, by ROS's names."""

    def __init__(self, domain=None):
        try:
            import cyclonedds.core
            import cyclonedds.domain
            import cyclonedds.idl
            import cyclonedds.pub
            import cyclonedds.qos
            import cyclonedds.sub
            import cyclonedds.topic
            import cyclonedds.util
            import rosbags.typesys
        except ImportError as error:
            raise recordings.needs("node", error) from None
        self.dds = cyclonedds
        self.store = rosbags.typesys.get_typestore(rosbags.typesys.Stores.LATEST)
        types = {}
        for name, text in DEFINITIONS.items():
            types.update(rosbags.typesys.get_types_from_msg(text, name))
        self.store.register(types)
        domain = int(os.environ.get("ROS_DOMAIN_ID") or 0) if domain is None else domain
        self.participant = cyclonedds.domain.DomainParticipant(domain)
        self._types = {}
        policy = cyclonedds.qos.Policy
        self._sensor = (policy.Reliability.BestEffort, policy.Durability.Volatile)
        self._reliable = (
            policy.Reliability.Reliable(cyclonedds.util.duration(milliseconds=100)),
            policy.Durability.Volatile,
        )
        self._latched = (self._reliable[0], policy.Durability.TransientLocal)

    def make(self, kind, **fields):
        """A message."""
        return self.store.types[kind](**fields)

    def type_of(self, kind):
        """The DDS type of a message, named as ROS 2 names it."""
        if kind not in self._types:
            from rosbags.interfaces import Nodetype

            idl = self.dds.idl.types
            plain = {"bool": bool, "byte": idl.byte, "char": idl.uint8, "string": str}

            def of(field):
                node, what = field
                if node == Nodetype.BASE:
                    return plain.get(what[0]) or getattr(idl, what[0])
                if node == Nodetype.NAME:
                    return self.type_of(what)
                inner = of(what[0])
                return idl.array[inner, what[1]] if node == Nodetype.ARRAY else idl.sequence[inner]

            package, _, name = kind.split("/")
            fields = {each: of(field) for each, field in self.store.fielddefs[kind][1]}
            made = self.dds.idl.make_idl_struct(f"{name}_", f"{package}.msg.dds_.{name}_", fields)
            made.serialize = lambda sample, **_: bytes(self.store.serialize_cdr(sample.message, kind))
            made.deserialize = lambda data, **_: _Sample(data, lambda: self.store.deserialize_cdr(data, kind))
            self._types[kind] = made
            self.store.get_msgdef(kind)  # its codec is made now, and not at the first message
        return self._types[kind]

    def _topic(self, topic, kind):
        return self.dds.topic.Topic(self.participant, f"rt/{topic.lstrip('/')}", self.type_of(kind))

    def _qos(self, quality, depth):
        policy = self.dds.qos.Policy
        return self.dds.qos.Qos(
            *getattr(self, f"_{quality}"),
            policy.History.KeepLast(depth),
            policy.DataRepresentation(use_cdrv0_representation=True),
        )

    def reader(self, topic, kind, quality="sensor", depth=5):
        """quality: "sensor" (best effort), "reliable" or "latched" (reliable, and what was said before is heard)."""
        return self.dds.sub.DataReader(self.participant, self._topic(topic, kind), self._qos(quality, depth))

    def writer(self, topic, kind, quality="reliable", depth=5):
        """A function that publishes a message."""
        made = self.type_of(kind)
        writer = self.dds.pub.DataWriter(self.participant, self._topic(topic, kind), self._qos(quality, depth))

        def write(message):
            sample = made.__new__(made)
            sample.message = message
            writer.write(sample)

        write.of = writer
        return write

    def taken(self, reader, most=1000):
        """The samples that a reader holds: decode() gives the message."""
        return [each for each in reader.take(most) if each.sample_info.valid_data]

    def waits(self, readers):
        """A function that waits for one of the readers, at most so many seconds."""
        states = self.dds.core
        waitset = states.WaitSet(self.participant)
        mask = states.ViewState.Any | states.InstanceState.Any | states.SampleState.NotRead
        keep = [states.ReadCondition(reader, mask) for reader in readers]
        for condition in keep:
            waitset.attach(condition)

        def wait(seconds):
            return waitset.wait(max(1, int(seconds * 1e9))) if keep else time.sleep(seconds)

        wait.keep = keep
        return wait


class Node:
    """Takes frames, joints and transforms from the wire, and publishes the clearance of each frame.

    clouds, images: topics of PointCloud2, of depth Image. compressed: of CompressedImage that holds depth. margin: metres; the stop topic says STOP while the lower end
    of any sensor is not above it, or is unknown. slow: the same for SLOWDOWN. timeout: seconds without an answer for a
    sensor after which it is unknown. wait: seconds that a frame waits for joints and transforms up to its stamp.
    max_delay: seconds by the system's clock after its stamp at which a frame is too old to be an answer. Other options
    as in play().
    """

    def __init__(
        self,
        robot,
        *,
        clouds=(),
        images=(),
        compressed=(),
        joint_topic="/joint_states",
        tf_topics=("/tf", "/tf_static"),
        name="clearance",
        domain=None,
        margin=0.1,
        slow=0.0,
        timeout=0.5,
        wait=0.05,
        max_delay=math.inf,
        question=None,
        wire=None,
        **options,
    ):
        if not clouds and not images and not compressed:
            raise ValueError("a node needs a topic of clouds or images")
        self.watch = playing.Watch(robot, question=question or _core.MinDistancePerPart(), **options)
        self.wire = wire = wire or Wire(domain)
        self.margin, self.slow, self.timeout, self.wait, self.max_delay = margin, slow, timeout, wait, max_delay
        self.frames = {}  # reader: (topic, type)
        self.others = {}
        for topic in clouds:
            self.frames[wire.reader(topic, recordings.CLOUD)] = (topic, recordings.CLOUD)
        for topic in images:
            self.frames[wire.reader(topic, recordings.IMAGE)] = (topic, recordings.IMAGE)
        for topic in compressed:
            self.frames[wire.reader(topic, recordings.COMPRESSED)] = (topic, recordings.COMPRESSED)
        for topic in sorted({self.watch.info_topic(topic) for topic in (*images, *compressed)}):
            self.others[wire.reader(topic, recordings.CAMERA)] = (topic, recordings.CAMERA)
        for topic in tf_topics:
            static = topic.rsplit("/", 1)[-1] == "tf_static"
            reader = wire.reader(topic, recordings.TRANSFORMS, "latched" if static else "sensor", 1000)
            self.others[reader] = (topic, recordings.TRANSFORMS)
        if self.watch.by_joints and self.watch.moving:
            for topic in [joint_topic] if isinstance(joint_topic, str) else joint_topic:
                self.others[wire.reader(topic, recordings.JOINTS, "sensor", 1000)] = (topic, recordings.JOINTS)
        name = name.strip("/")
        self.publish = {
            kind: wire.writer(f"{name}/{what}", kind)
            for what, kind in (("clearance", CLEARANCE), ("range", RANGE), ("markers", MARKERS), ("stop", STOP))
        }
        self._until = wire.waits([*self.frames, *self.others])
        now = time.monotonic()
        self.sensors = {topic: _Sensor(now) for topic, _ in self.frames.values()}
        self.latencies = []  # (seconds from receipt to publication, of which the library's call)
        self.stopped = False
        self._warm()
        self._ask, self._asked = self.watch.ask, 0.0
        self.watch.ask = self._timed

    def _warm(self):
        """The first frame shall not wait for what is prepared once."""
        self.watch.ask(np.zeros((1, 3), np.float32), poses=np.tile(np.eye(4), (len(self.watch.robot), 1, 1)))
        row = playing.Row(0, "", "", parts={"": 0.0}, dropped={"": 0}, at=(0.0,) * 3, nearest=(0.0,) * 3)
        header = header_of(self.wire, row, self.watch)
        for kind, message in (
            (CLEARANCE, clearance_of(self.wire, row, _Sensor(0.0), header)),
            (RANGE, range_of(self.wire, row, self.watch, header)),
            (MARKERS, markers_of(self.wire, row, header)),
            (STOP, self.wire.make(STOP, action_type=0, polygon_name="")),
        ):
            self.wire.store.serialize_cdr(message, kind)

    def _timed(self, *arguments, **options):
        begin = time.perf_counter()
        try:
            return self._ask(*arguments, **options)
        finally:
            self._asked += time.perf_counter() - begin

    def run(self, seconds=math.inf):
        """Answers until stopped is set, or so many seconds have gone."""
        end = time.monotonic() + seconds
        while not self.stopped and time.monotonic() < end:
            self.step(min(self._pause(), max(0.0, end - time.monotonic())))

    def _pause(self):
        """Seconds until something is due without a message."""
        now = time.monotonic()
        due = [each.answered + self.timeout for each in self.sensors.values()]
        due += [each.waiting[0][0] for each in self.sensors.values() if each.waiting]
        return min(0.2, max(0.001, min(due) - now))

    def step(self, seconds):
        """Waits for messages at most so long, and answers what can be answered."""
        self._until(seconds)
        received, clock = time.perf_counter(), time.monotonic()
        # Frames are taken first: what is needed for them was said before them.
        frames = [(of, self.wire.taken(reader, 100)) for reader, of in self.frames.items()]
        for reader, (topic, kind) in self.others.items():
            for sample in self.wire.taken(reader):
                try:
                    self.watch.take(topic, kind, sample.decode())
                except Exception as error:
                    self.watch.notes[f"{topic}: no {kind} ({error})"] += 1
        for (topic, kind), samples in frames:
            self._receive(topic, kind, samples, received, clock)
        for topic, sensor in self.sensors.items():
            self._answer(topic, sensor)

    def _receive(self, topic, kind, samples, received, clock):
        sensor = self.sensors[topic]
        for sample in samples:
            try:
                message = sample.decode()
            except Exception as error:
                row = playing.Row(time.time_ns(), topic, "", note=f"{topic}: a message is no {kind} ({error})")
                self._say(row, sensor, received)
                continue
            stamp = nanoseconds(message.header.stamp)
            if sensor.newest - recordings.BACK <= stamp <= sensor.newest:
                sensor.late += 1
                continue
            sensor.newest = stamp
            sensor.waiting.append((clock + self.wait, kind, message, received))

    def _due(self, topic, frame):
        return time.monotonic() >= frame[0] or self.watch.ready(topic, *frame[1:3])

    def _answer(self, topic, sensor):
        while sensor.waiting and self._due(topic, sensor.waiting[0]):
            until, kind, message, received = sensor.waiting.popleft()
            # Behind by more than a frame may wait, the newest counts.
            if sensor.waiting and time.monotonic() > until and self._due(topic, sensor.waiting[0]):
                sensor.skipped += 1
                continue
            stamp = nanoseconds(message.header.stamp)
            delay = (time.time_ns() - stamp) / 1e9
            if delay > self.max_delay:
                row = playing.Row(
                    stamp,
                    topic,
                    message.header.frame_id,
                    note=f"the frame is {delay:.3g} s old (at most {self.max_delay:g} s is allowed)",
                )
            else:
                row = self.watch.row(topic, kind, message)
            self._say(row, sensor, received, message.header.stamp)
        if time.monotonic() >= sensor.answered + self.timeout:
            self._say(
                playing.Row(time.time_ns(), topic, "", note=f"no frame could be answered for {self.timeout:g} s"), sensor
            )

    def _say(self, row, sensor, received=None, stamp=None):
        sensor.answered, sensor.lower, sensor.link = time.monotonic(), row.lower, row.link
        worst = min(self.sensors.values(), key=lambda each: each.lower)
        action = 1 if not worst.lower >= self.margin else 2 if not worst.lower >= self.slow else 0
        self.publish[STOP](self.wire.make(STOP, action_type=action, polygon_name=worst.link if action else ""))
        header = header_of(self.wire, row, self.watch, stamp)
        self.publish[CLEARANCE](clearance_of(self.wire, row, sensor, header))
        if received is not None:
            self.latencies.append((time.perf_counter() - received, self._asked))
            del self.latencies[:-100_000]
        self._asked = 0.0
        self.publish[RANGE](range_of(self.wire, row, self.watch, header))
        self.publish[MARKERS](markers_of(self.wire, row, header))

    def report(self):
        """A sentence on the latency from receipt to publication of the stop and the clearance."""
        if not self.latencies:
            return "no frame was answered"
        whole = sorted(each for each, _ in self.latencies)
        own = sorted(each - asked for each, asked in self.latencies)

        def at(values, part):
            return values[min(len(values) - 1, int(part * len(values)))] * 1e3

        late, skipped = (sum(getattr(each, name) for each in self.sensors.values()) for name in ("late", "skipped"))
        return (
            f"{len(whole)} frames; from receipt to publication {at(whole, 0.5):.3f} ms in the median, "
            f"{at(whole, 0.95):.3f} ms "
            f"(95 %), {whole[-1] * 1e3:.3f} ms at most; "
            f"without the library's call {at(own, 0.5):.3f}, {at(own, 0.95):.3f} and "
            f"{own[-1] * 1e3:.3f} ms; {late} frames came late, {skipped} were overtaken"
        )


class _Sensor:
    """What is known of one topic. Until its first answer it is unknown, so the robot stops."""

    def __init__(self, now):
        self.answered, self.lower, self.link = now, 0.0, ""
        self.newest, self.late, self.skipped, self.waiting = -(2**63), 0, 0, collections.deque()


COLOURS = {"free": (0.1, 0.8, 0.2), "possible": (1.0, 0.7, 0.0), "collision": (0.9, 0.1, 0.1)}
STATES = ("unknown", "no_data", "free", "possible", "collision")


def header_of(wire, row, watch, stamp=None):
    """The header of all messages about a row. stamp: of the frame, to the nanosecond."""
    if stamp is None:
        seconds, rest = divmod(row.stamp_ns, 1_000_000_000)
        stamp = wire.make("builtin_interfaces/msg/Time", sec=seconds, nanosec=rest)
    return wire.make("std_msgs/msg/Header", stamp=stamp, frame_id=watch.base_frame or row.frame)


def _point(wire, at):
    return wire.make("geometry_msgs/msg/Point", **dict(zip("xyz", at or (math.nan,) * 3, strict=True)))


def clearance_of(wire, row, sensor, header):
    """A row as a Clearance."""
    return wire.make(
        CLEARANCE,
        header=header,
        topic=row.topic,
        sensor_frame=row.frame,
        state=STATES.index(row.state),
        distance=row.distance,
        lower=row.lower,
        upper=row.upper,
        link=row.link,
        point=0xFFFFFFFF if row.point is None else row.point,
        at=_point(wire, row.at),
        nearest=_point(wire, row.nearest),
        seen=row.seen,
        valid=row.valid,
        dropped=[
            wire.make("clearance_msgs/msg/Dropped", reason=name, count=count) for name, count in row.dropped.items()
        ],
        parts=[
            wire.make("clearance_msgs/msg/PartClearance", link=name, distance=far)
            for name, far in (row.parts or {}).items()
        ],
        late=sensor.late,
        skipped=sensor.skipped,
        note=row.note,
    )


def range_of(wire, row, watch, header):
    """A row as a Range: the lower end; where nothing is known -inf, REP 117's "too near", so `range < margin` stops."""
    known = row.state not in ("unknown", "no_data")
    farthest = watch.farthest if math.isfinite(watch.farthest) else 1000.0
    return wire.make(
        RANGE,
        header=header,
        radiation_type=1,
        field_of_view=0.0,
        min_range=0.0,
        max_range=farthest,
        range=row.lower if known else -math.inf,
        variance=0.0,
    )


def markers_of(wire, row, header):
    """A row as markers: the shortest segment, and its number."""
    make, nothing = wire.make, np.zeros(0, np.uint8)
    red, green, blue = COLOURS.get(row.state, (0.6, 0.6, 0.6))
    here = row.at is not None and row.nearest is not None
    ends = [_point(wire, row.at), _point(wire, row.nearest)] if here else []
    middle = tuple((a + b) / 2 for a, b in zip(row.at, row.nearest, strict=True)) if here else (0.0, 0.0, 0.0)
    text = f"{row.distance:z.3f} m {row.link}" if here else f"{row.topic}: {row.state}"
    shared = {
        "header": header,
        "ns": f"clearance{row.topic}",
        "color": make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=1.0),
        "lifetime": make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
        "frame_locked": False,
        "colors": [],
        "texture_resource": "",
        "uv_coordinates": [],
        "mesh_resource": "",
        "mesh_use_embedded_materials": False,
        "texture": make("sensor_msgs/msg/CompressedImage", header=header, format="", data=nothing),
        "mesh_file": make("visualization_msgs/msg/MeshFile", filename="", data=nothing),
    }
    upright = make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)

    def marker(number, kind, action, at, size, points, text):
        pose = make("geometry_msgs/msg/Pose", position=_point(wire, at), orientation=upright)
        scale = make("geometry_msgs/msg/Vector3", x=size, y=size, z=size)
        return make(
            "visualization_msgs/msg/Marker",
            id=number,
            type=kind,
            action=action,
            pose=pose,
            scale=scale,
            points=points,
            text=text,
            **shared,
        )

    line = marker(0, 5, 0 if here else 2, (0.0, 0.0, 0.0), 0.01, ends, "")  # 2: what was drawn is deleted
    return make(MARKERS, markers=[line, marker(1, 9, 0, middle, 0.08, [], text)])
