# SPDX-License-Identifier: BSD-3-Clause
"""What the command must answer to a case, worked out from its files and options alone. `expected(case)` gives a list of Frame
(one for `query`, one a frame for `run`, one a configuration for `plan`), a dict of parts for `info`, None where only manners count; or raises Invalid or
Unknown."""

import math
import os
import re
from dataclasses import dataclass, field

import clouds
import packings
import robots
from geometry import IDENTITY, apply, compose, distance_range, inverse, quaternion
from strict import Unknown, demand, lines_of, number, text_of, whole

FLAGS = {"--ignore-limits", "--use-viewpoint", "--zero-is-missing", "--no-cache", "--json", "--merge", "--allow-overlap", "--csv", "--gradient", "--between", "--fields", "--cells", "--strict"}
PER_CLOUD = {"--camera-pose", "--camera-link", "--intrinsics", "--depth-scale", "--range", "--use-viewpoint", "--zero-is-missing", "--cloud-scale"}
SINGLE = {
    "query": {"--robot", "--joints", "--geometry", "--base-pose", "--model", "--volume", "--spheres", "--packing", "--cache", "--backend",
              "--check", "--scene", "--unfold-limit", "--zones", "--min-points", "--distances", "--d-max", "--self-filter", "--min-support",
              "--support-limit", "--nearest", "--threads", "--deadline"},
    "plan": {"--robot", "--geometry", "--base-pose", "--model", "--spheres", "--packing", "--cache", "--backend", "--check", "--unfold-limit",
             "--configurations", "--d-max", "--threads"},
    "run": {"--robot", "--geometry", "--base-pose", "--model", "--volume", "--spheres", "--packing", "--cache", "--backend", "--check",
            "--frames", "--trajectory", "--unfold-limit", "--plan", "--svg", "--threads"},
    "pack": {"", "--threads", "--spheres", "--gap", "--smallest-radius", "--seconds", "--seed", "--cache", "--geometry", "--joints"},
    "demo": {"--threads", "--spheres", "--cache", "--scene"},
    "info": {""},
}
_of_robots = {"--package", "--exclude-link", "--mesh-limit", "--attach", "--attach-pose"}
MANY = {"query": {"--joint", "--cloud"} | _of_robots, "plan": {"--joint", "--cloud"} | _of_robots, "run": {"--joint"} | _of_robots,
        "pack": {"--out", "--package", "--exclude-link", "--mesh-limit"}, "demo": set(), "info": set()}
OWN_FLAGS = {"pack": {"--strict", "--no-cache", "--json", "--allow-overlap"}, "demo": {"--no-cache"}, "info": {"--json"}}
FAR = 1e18  # metres; the square of what is beyond it is no float, and it may count as not finite


@dataclass
class Case:
    format: str
    command: str  # query, run, plan, pack, info, demo
    options: list  # [name, value] in their order; value None for a flag; name "" for a word by itself
    files: dict  # name in the scratch folder: bytes
    target: str  # which file is damaged, or "options", or a folder "f/" of frames
    outputs: list = field(default_factory=list)  # files that the command may write
    file_limit: int = 0  # bytes a written file may have, as on a full disk; 0: no limit
    cpu: float = 20.0
    links: dict = field(default_factory=dict)  # name: what a link of that name leads to; "" for a folder, None for a pipe
    believes: bool = True  # False: the damaged file carries a certificate of its own, so its bracket may be anything

    def words(self):
        return [self.command] + [word for name, value in self.options for word in ((name, value) if name else (value,))
                                 if word is not None]


@dataclass
class Frame:
    low: float
    high: float
    seen: int
    valid: range  # how many points may count
    parts: list
    near: list = field(default_factory=list)  # of each part: (low, high) of each point
    plan: list = field(default_factory=list)  # of `run --plan`: a Frame for each configuration to come


def _real(text, finite=True):
    value = number(text.strip(" "), finite=False)
    demand(not math.isnan(value) and (not finite or math.isfinite(value)), f"{text[:40]!r} is no number here")
    return value


def _reals(text, count, finite=True):
    words = text.split(",")
    demand(len(words) == count, f"{count} numbers wanted")
    return [_real(word, finite) for word in words]


def _pose(text):
    x, y, z, *q = _reals(text, 7)
    demand(abs(math.sqrt(sum(v * v for v in q)) - 1) <= 1e-3, "a quaternion that is not of unit length")
    return quaternion(*q), (x, y, z)


def _assignment(text):
    name, equals, value = text.partition("=")
    demand(name and equals and value, "no name=value")
    return name, value


def _check_limits(texts):
    """Each names a limit once. What a limit refuses is the command's business."""
    names = []
    for text in texts:
        name, value = _assignment(text)
        demand(name in ("bytes", "triangles", "values", "nodes", "depth") and name not in names, "no limit of meshes, or one twice")
        names.append(name)
        whole(value, 1, 1000 if name == "depth" else 2**40)


class _Options:
    """The options of `query`, `run` and `plan`."""

    def __init__(self, case):
        self.command, self.one, self.many, self.flags, self.sensors = case.command, {}, {}, set(), []
        before, current, attached = {}, None, None
        for name, value in case.options:
            if name in FLAGS:
                demand(value is None, f"{name} takes no value")
            else:
                demand(name and value is not None, "a word that belongs to no option")
                demand(value != "", f"{name} is empty")
            if name == "--attach-pose":
                _pose(value)
                demand(attached == "bare", "a pose of nothing, or one twice")
            if name in ("--attach", "--attach-pose"):
                attached = "bare" if name == "--attach" else "placed"
            if name in PER_CLOUD:
                demand(name not in (before if current is None else current["own"]), f"{name} twice for one cloud")
                (before if current is None else current)[name] = value
                if current is not None:
                    current["own"].add(name)
            elif name == "--cloud" and case.command in ("query", "plan"):
                current = dict(before, file=value, own=set())
                self.sensors.append(current)
            elif name in FLAGS:
                self.flags.add(name)
            elif name in MANY[case.command]:
                self.many.setdefault(name, []).append(value)
            else:
                demand(name in SINGLE[case.command], f"no option {name}")
                demand(name not in self.one, f"{name} twice")
                self.one[name] = value
        self.before = before
        for name, choices in (("--model", "spheres triangles"), ("--volume", "sphere aabb obb"), ("--backend", "host"),
                              ("--geometry", "collision visual")):
            demand(self.one.get(name, choices.split()[0]) in choices.split(), f"{name} is none of its choices")
        demand("--robot" in self.one, "no robot")
        of_spheres = {"--packing", "--spheres", "--cache", "--no-cache"} & (self.one.keys() | self.flags)
        demand(not of_spheres or self.one.get("--model", "spheres") == "spheres", "an option of spheres with triangles")
        if case.command != "run":
            self.check_all(self.sensors)
        self.base = _pose(self.one["--base-pose"]) if "--base-pose" in self.one else IDENTITY
        whole(self.one.get("--spheres", "1"), 1, 10_000_000)
        whole(self.one.get("--unfold-limit", "1"), 1, 10_000_000)
        _check_limits(self.many.get("--mesh-limit", []))
        if "--check" in self.one:
            demand(_real(self.one["--check"]) >= 0, "a margin below 0")
        self._questions()
        for sensor in [before] + self.sensors:
            for name, reader in (("--camera-pose", _pose), ("--intrinsics", lambda t: _reals(t, 4)), ("--depth-scale", _real), ("--cloud-scale", _real),
                                 ("--range", lambda t: _reals(t, 2, False))):
                if name in sensor:
                    reader(sensor[name])

    def check_all(self, sensors):
        """What is said of all clouds is for one of them."""
        images = sum(os.path.splitext(sensor["file"])[1].lower() == ".png" for sensor in sensors)
        demand(not sensors or images > 0 or not self.before.keys() & {"--intrinsics", "--depth-scale"}, "an option of images, and none")
        demand(not sensors or images < len(sensors) or not self.before.keys() & {"--use-viewpoint", "--zero-is-missing", "--cloud-scale"}, "an option of clouds, and none")

    def _questions(self):
        if "--zones" in self.one:
            values = [_real(word) for word in self.one["--zones"].split(",")]
            demand(values == sorted(values) and values[0] >= 0, "thresholds that fall, or are below 0")
        if "--min-points" in self.one:
            whole(self.one["--min-points"], 1, 10_000_000)
            demand("--zones" in self.one, "--min-points without --zones")
        if "--distances" in self.one:
            demand(os.path.splitext(self.one["--distances"])[1].lower() == ".ply", "distances that are no PLY")
            demand(os.path.normpath(self.one["--distances"]) != os.path.normpath(self.one.get("--scene", "")), "one file for two")
        if "--d-max" in self.one:
            demand(_real(self.one["--d-max"]) > 0, "--d-max is not above 0")
            demand(self.one.keys() & {"--distances", "--nearest"} or self.command == "plan", "--d-max without --distances")
            demand(self.command != "plan" or "--check" not in self.one or _real(self.one["--d-max"]) > _real(self.one["--check"]), "--d-max within --check")

        if "--self-filter" in self.one:
            demand(0 <= _real(self.one["--self-filter"]) <= 1e15, "a padding that is none")
        if "--min-support" in self.one:
            points, _, radius = self.one["--min-support"].partition("@")
            whole(points, 2, 10_000_000)
            demand(0 <= _real(radius) <= 1e15, "a radius that is none")
        if "--support-limit" in self.one:
            whole(self.one["--support-limit"], 1, 1 << 20)
            demand("--min-support" in self.one, "--support-limit without --min-support")
        if "--nearest" in self.one:
            whole(self.one["--nearest"], 1, 1 << 20)
        if "--threads" in self.one:
            whole(self.one["--threads"], 1, 1024)
        if "--deadline" in self.one:
            demand(0 <= _real(self.one["--deadline"]) <= 1e9, "a deadline that is none")
            demand(not any(name in self.one for name in ("--zones", "--distances", "--self-filter", "--min-support", "--nearest")) and "--gradient" not in self.flags,
                   "more than a deadline is for")
            usual = "obb" if self.one.get("--model") == "triangles" else "sphere"
            demand(self.one.get("--volume", usual) == usual, "--deadline with another volume")
        if "--svg" in self.one:
            demand(os.path.splitext(self.one["--svg"])[1].lower() == ".svg", "a picture that is no SVG")

    def held(self, robot, files):
        """What links hold. It is one part more, or many points fewer: then only manners count, as by a deadline."""
        for text in self.many.get("--attach", []):
            link, name = _assignment(text)
            demand(link in robot.links, "something held by no link")
            ending = os.path.splitext(name)[1].lower()
            demand(name.removeprefix("./") in files, f"there is no {name[:40]!r}")
            demand(ending not in (".ist", ".csv", ".yaml", ".yml") or self.one.get("--model", "spheres") == "spheres", "spheres among triangles")
        if "--attach" in self.many or "--self-filter" in self.one or "--deadline" in self.one:
            raise Unknown("something held, hidden, or not looked at")

    def joints(self, robot):
        ignore = "--ignore-limits" in self.flags
        given = {}
        for text in self.many.get("--joint", []):
            name, value = _assignment(text)
            demand(name not in given, "a joint twice")
            given[name] = _real(value)
        if "--joints" in self.one:
            demand(not given, "--joints and --joint")
            values = _reals(self.one["--joints"], len(robot.movable))
            given = {joint.name: value for joint, value in zip(robot.movable, values)}
        robot.check(given, ignore)
        return given


def _points(sensor, files):
    """(points in the cloud's frame or None where they do not count, how many are seen)."""
    name = sensor["file"]
    data = files.get(name.removeprefix("./"))
    demand(data, f"there is no {name[:40]!r}, or it is empty")
    ending, own = os.path.splitext(name)[1].lower(), sensor.get("own", set())  # what is said of all clouds may fit others alone
    near, far = _reals(sensor["--range"], 2, False) if "--range" in sensor else (0.0, math.inf)
    demand(0 <= near < far, "a range that is none")
    if "--cloud-scale" in sensor:
        raise Unknown("a cloud in another unit")
    if ending == ".png":
        demand("--intrinsics" in sensor, "an image without intrinsics")
        demand(not own & {"--use-viewpoint", "--zero-is-missing"}, "an option of clouds for an image")
        fx, fy, cx, cy = _reals(sensor["--intrinsics"], 4)
        scale = _real(sensor.get("--depth-scale", "0.001"))
        demand(fx > 0 and fy > 0 and scale > 0, "a camera that is none")
        width, height, pixels = clouds.read_png(data)
        made = []
        for i, raw in enumerate(pixels):
            z = raw * scale
            if raw not in (0, 65535) and near <= z <= far:
                made.append(((i % width - cx) / fx * z, (i // width - cy) / fy * z, z))
        return made, len(pixels), IDENTITY
    demand(not own & {"--intrinsics", "--depth-scale"}, "an option of images for a cloud")
    readers = {".pcd": clouds.read_pcd, ".ply": clouds.read_ply, ".xyz": clouds.read_xyz, ".txt": clouds.read_xyz}
    demand(ending in readers, "no cloud by its name")
    points, view = readers[ending](data)
    placed = IDENTITY
    if "--use-viewpoint" in sensor:
        demand(view and abs(math.sqrt(sum(v * v for v in view[3:])) - 1) <= 1e-3, "no proper VIEWPOINT")
        placed = (quaternion(view[4], view[5], view[6], view[3]), tuple(view[:3]))
    made = [p for p in points if all(map(math.isfinite, p)) and near <= math.hypot(*p) <= far
            and not ("--zero-is-missing" in sensor and not any(p))]
    return made, len(points), placed


def _frame(robot, given, base, sensors, carriers, files):
    low = high = math.inf
    seen = least = most = 0
    poses = {name: compose(base, robot.link_pose(name, given)) for name in robot.bodies}
    near = {name: [] for name in robot.bodies}
    for sensor, carrier in zip(sensors, carriers):
        points, count, placed = _points(sensor, files)
        seen, most = seen + count, most + len(points)
        world = compose(compose(carrier, _pose(sensor["--camera-pose"]) if "--camera-pose" in sensor else IDENTITY), placed)
        for p in points:
            at = apply(world, p)
            if not max(map(abs, p)) < FAR:
                continue
            least += 1
            for name, bodies in robot.bodies.items():
                a, b = distance_range(bodies, apply(inverse(poses[name]), at))
                near[name].append((a, b))
                low, high = min(low, a), min(high, b)
    return Frame(low, high, seen, range(least, most + 1), list(robot.bodies), list(near.values()))


def _robot(options, files):
    name = options.one["--robot"]
    demand(name.removeprefix("./") in files, f"there is no {name[:40]!r}")
    names = [_assignment(text)[0] for text in options.many.get("--package", [])]
    demand(len(set(names)) == len(names), "a package twice")
    return robots.Robot(files[name.removeprefix("./")], files, options.one.get("--geometry") == "visual",
                        options.many.get("--exclude-link", []))


def _check_packing(options, robot, files):
    if "--packing" not in options.one:
        return
    name = options.one["--packing"]
    ending = os.path.splitext(name)[1]
    demand(name in files and ending in packings.readers, f"there is no {name[:40]!r}")
    parts = packings.readers[ending](files[name])
    if not (len(parts) == 1 and len(robot.bodies) == 1):
        for part in parts:
            demand(part in robot.bodies or part in options.many.get("--exclude-link", []), "spheres of an unknown link")
    if "--spheres" in options.one and "--attach" not in options.many:
        all_given = len(parts) == len(robot.bodies) == 1 or all(body in parts for body in robot.bodies)
        demand(not all_given, "--spheres, and nothing to pack")


def _carrier(robot, given, base, sensor):
    if "--camera-link" not in sensor:
        return IDENTITY
    return compose(base, robot.link_pose(sensor["--camera-link"], given))


def _query(case):
    options = _Options(case)
    demand(options.sensors, "no cloud")
    robot = _robot(options, case.files)
    given = options.joints(robot)
    _check_packing(options, robot, case.files)
    if "--distances" in options.one:
        demand(options.one["--distances"] in case.outputs or options.one["--distances"] not in case.files, "the distances would replace an input")
    if "--scene" in options.one:
        demand(options.one["--scene"] in case.outputs or options.one["--scene"] not in case.files, "the scene would replace an input")
        if not options.one["--scene"].endswith(".glb"):
            raise Unknown("a scene by another name")
    carriers = [_carrier(robot, given, options.base, sensor) for sensor in options.sensors]
    options.held(robot, case.files)
    _check_sizes(options.sensors, case.files)
    return [_frame(robot, given, options.base, options.sensors, carriers, case.files)]


def _trajectory(data, robot, fixed, ignore):
    lines = lines_of(data)
    while lines and not lines[-1].strip(" \t"):
        lines.pop()
    demand(lines, "no line")
    names = [word.strip(" \t") for word in lines[0].split(",")]
    if not robot.movable:
        raise Unknown("a robot without joints")
    demand(sorted(names + list(fixed)) == sorted(j.name for j in robot.movable), "columns other than the joints")
    demand(len(lines) > 1, "no row")
    rows = []
    for line in lines[1:]:
        given = dict(fixed, **dict(zip(names, _reals(line.replace("\t", " "), len(names)))))
        robot.check(given, ignore)
        rows.append(given)
    return rows


def _rows(options, robot, name, files):
    demand(name in files, f"no {name[:40]!r}")
    if files[name][:2] in (b"\xff\xfe", b"\xfe\xff") or b'"' in files[name]:
        raise Unknown("text in UTF-16, or words in quotes")
    fixed = dict(_assignment(text) for text in options.many.get("--joint", []))
    fixed = {joint: _real(value) for joint, value in fixed.items()}
    return _trajectory(files[name], robot, fixed, "--ignore-limits" in options.flags)


def _plan(case):
    options = _Options(case)
    demand(options.sensors and "--configurations" in options.one, "no cloud or no configurations")
    robot = _robot(options, case.files)
    rows = _rows(options, robot, options.one["--configurations"], case.files)
    _check_packing(options, robot, case.files)
    carriers = [_carrier(robot, rows[0], options.base, sensor) for sensor in options.sensors]
    options.held(robot, case.files)
    _check_sizes(options.sensors, case.files)
    return [_frame(robot, row, options.base, options.sensors, carriers, case.files) for row in rows]


def _natural(name):
    """By bytes, but numbers by their values."""
    return [(48, int(word)) if word[0] in "0123456789" else (ord(word), -1) for word in re.findall("[0-9]+|[^0-9]", name, re.S)], name


def _check_sizes(sensors, files):
    """Images that share intrinsics have one size."""
    heads = [files.get(sensor["file"].removeprefix("./"), b"")[:24] for sensor in sensors
             if os.path.splitext(sensor["file"])[1].lower() == ".png" and "--intrinsics" not in sensor.get("own", ())]
    sizes = {head[16:24] for head in heads if len(head) == 24 and head.startswith(b"\x89PNG\r\n\x1a\n")}
    demand(len(sizes) < 2, "images of several sizes for one camera")


def _listed(case, where):
    """The files of the frames, in their order."""
    if where in case.files and os.path.splitext(where)[1].lower() in (".pcd", ".ply", ".xyz", ".png"):
        listed = [where]
    elif where in case.files:
        listed = [os.path.normpath(name) for name in (line.strip(" \t") for line in lines_of(case.files[where])) if name]
    else:
        endings = (".pcd", ".ply", ".xyz", ".txt", ".png")
        held = sorted((name for name in [*case.files, *case.links] if os.path.dirname(name) == where and os.path.splitext(name)[1].lower() in endings),
                      key=_natural)
        listed = [os.path.join(where, case.links[name] or "") if name in case.links else name for name in held]
    demand(listed and all(name in case.files for name in listed), "a frame that does not exist")
    return listed


def _run(case):
    options = _Options(case)
    robot = _robot(options, case.files)
    demand("--frames" in options.one, "no --frames")
    demand("--trajectory" in options.one and options.one["--trajectory"] in case.files, "no --trajectory")
    rows = _rows(options, robot, options.one["--trajectory"], case.files)
    ahead = _rows(options, robot, options.one["--plan"], case.files) if "--plan" in options.one else []
    listed = _listed(case, options.one["--frames"])
    demand(len(rows) in (1, len(listed)), "rows for other than the frames")
    sensors = [dict(options.before, file=name) for name in listed]
    options.check_all(sensors)
    _check_sizes(sensors, case.files)
    rows = rows if len(rows) > 1 else rows * len(listed)
    options.held(robot, case.files)
    frames, carriers = [], [_carrier(robot, row, options.base, sensor) for row, sensor in zip(rows, sensors)]
    for k, row in enumerate(rows):
        merged = "--merge" in options.flags
        seen = (options.base, sensors if merged else sensors[k:k + 1], carriers if merged else carriers[k:k + 1], case.files)
        frames.append(_frame(robot, row, *seen))
        frames[-1].plan = [_frame(robot, to_come, *seen) for to_come in ahead]
    return frames


def _plain(case):
    """The options of the other commands, each once, by name; "" is the word by itself."""
    given = {}
    for name, value in case.options:
        known = OWN_FLAGS[case.command] if value is None else SINGLE[case.command] | MANY[case.command]
        demand(name in known and value != "", f"{name} is none of its options, or is empty")
        demand(name in MANY[case.command] or value is None or name not in given, f"{name} twice")
        given[name] = value
    demand("--spheres" not in given or whole(given["--spheres"], 1, 10_000_000), "--spheres")
    return given


def _info(case):
    name = _plain(case).get("")
    if name is None:
        return None
    ending = os.path.splitext(name)[1]
    demand(name in case.files and ending in packings.readers, "no such file")
    return packings.readers[ending](case.files[name])


def _pack(case):
    given = _plain(case)
    demand(given.get("", "") in case.files and "--spheres" in given, "no such input, or no --spheres")
    for name in ("--gap", "--smallest-radius", "--seconds"):
        demand(name not in given or _real(given[name]) > 0, f"{name} is not above 0")
    if not given[""].endswith(".urdf"):
        robots.load_mesh(given[""], case.files)
    return None


def _demo(case):
    _plain(case)
    return None


def expected(case):
    return {"query": _query, "run": _run, "plan": _plan, "info": _info, "pack": _pack, "demo": _demo}[case.command](case)
