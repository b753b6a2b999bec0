# SPDX-License-Identifier: BSD-3-Clause
"""A strict reader of URDF: links with their bodies, and where they stand."""

import math
import os

import meshes
import scenes
import xml_tree
from geometry import IDENTITY, Mesh, Shape, apply, compose, determinant, roll_pitch_yaw, rotation
from strict import Invalid, Unknown, demand, number, numbers

# Attributes and children that decide where a body is. What is nearly one of them must not be passed over.
_attributes = {"origin": "xyz rpy", "box": "size", "sphere": "radius", "cylinder": "radius length", "capsule": "radius length",
               "mesh": "filename scale", "axis": "xyz", "limit": "lower upper", "mimic": "joint multiplier offset"}
_shapes = ("box", "sphere", "cylinder", "capsule", "mesh")
_parts = "visual collision geometry"
_children = {"robot": "link joint", "link": _parts, "visual": "origin geometry", "collision": "origin geometry", "geometry": " ".join(_shapes),
             "joint": "origin parent child axis limit mimic " + _parts}
_fields = {"box": ("size", 3), "sphere": ("radius", 1), "cylinder": ("radius length", 1), "capsule": ("radius length", 1)}


def _lengths(element, names, count):
    values = [v for name in names.split() for v in numbers(element.get(name), count)]
    demand(all(v >= 0 for v in values), "a length below 0")
    return values


def _edits(a, b):
    """Letters put in, left out, changed or swapped with the next."""
    rows = [list(range(len(b) + 1))]
    for i, x in enumerate(a):
        row = [i + 1]
        for j, y in enumerate(b):
            row.append(min(rows[-1][j + 1] + 1, row[j] + 1, rows[-1][j] + (x != y)))
            if i and j and x == b[j - 1] and a[i - 1] == y:
                row[-1] = min(row[-1], rows[-2][j - 1] + 1)
        rows.append(row)
    return rows[-1][-1]


def _misspelt(name, words):
    """Whether a name is nearly, but not quite, one of the words: docs/io.md says when."""
    own = [name.lower(), name.lower().split(":")[-1]]
    return any(_edits(form[:40], word) <= (1 if len(word) <= 4 else 2) for form in own for word in words.split() if name != word)


def _check_words(element, uris, known=True):
    """Nothing that matters is misspelt, and nothing is xacro's. Only where URDF knows an element its words are judged."""
    uris = dict(uris, **{k[6:]: v for k, v in element.attributes.items() if k.startswith("xmlns:")})
    prefix = element.name.partition(":")[0] if ":" in element.name else ""
    demand("xacro" not in uris.get(prefix, prefix).lower(), "xacro")
    for name in element.attributes if known else ():
        words = _attributes.get(element.name, "")
        demand(name in words.split() or not _misspelt(name, words), f"an attribute {name[:20]!r} of <{element.name}>")
    for child in element.children:
        words = _children.get(element.name, "")
        demand(not known or child.name in words.split() or not _misspelt(child.name, words), f"<{child.name[:20]}> in <{element.name}>")
        _check_words(child, uris, known and (child.name in words.split() or child.name in _attributes))


def _origin(element):
    at = element.one("origin")
    if at is None:
        return IDENTITY
    return (roll_pitch_yaw(*numbers(at.attributes.get("rpy", "0 0 0"), 3)), tuple(numbers(at.attributes.get("xyz", "0 0 0"), 3)))


def load_mesh(name, files):
    data = files.get(name.removeprefix("file://").removeprefix("./"))
    demand(data is not None, f"there is no {name[:40]!r}")
    ending = os.path.splitext(name)[1].lower()
    if ending == ".dae":
        return scenes.read_dae(data)
    if ending in (".glb", ".gltf"):  # y is up there, z in a robot
        return [tuple((x, -z, y) for x, y, z in corners) for corners in scenes.read_gltf(data, ending)]
    demand(ending in meshes.readers, f"{name[:40]!r} is no mesh by its name")
    return meshes.triangles(meshes.readers[ending](data))


def _body(element, files):
    """The body of a <visual> or <collision>, in the link's frame."""
    pose, kinds = _origin(element), element.need("geometry").all(*_shapes)
    demand(len(kinds) == 1, "a geometry of other than one shape")
    shape = kinds[0]
    if shape.name in _fields:
        return Shape(shape.name, _lengths(shape, *_fields[shape.name]), pose)
    scale = numbers(shape.attributes.get("scale", "1 1 1"), 3)
    demand(all(scale), "a scale of 0")
    sized = (tuple(tuple(v * s for v, s in zip(row, scale)) for row in pose[0]), pose[1])
    turned = determinant(sized[0]) < 0
    found = [tuple(apply(sized, v) for v in t) for t in load_mesh(shape.get("filename"), files)]
    return Mesh([(a, c, b) if turned else (a, b, c) for a, b, c in found])


class Joint:
    def __init__(self, element):
        self.name, self.kind = element.get("name"), element.get("type")
        if self.kind in ("planar", "floating"):
            raise Unknown("a joint of several values")
        demand(self.kind in ("fixed", "revolute", "continuous", "prismatic"), f"a joint of type {self.kind[:20]!r}")
        self.origin = _origin(element)
        self.parent, self.child = element.need("parent").get("link"), element.need("child").get("link")
        axis, limit, mimic = element.one("axis"), element.one("limit"), element.one("mimic")
        self.axis = numbers(axis.get("xyz"), 3) if axis else [1.0, 0.0, 0.0]
        demand(self.kind == "fixed" or any(self.axis), "an axis without direction")
        self.low, self.high = -math.inf, math.inf
        if self.kind in ("revolute", "prismatic"):
            demand(limit is not None, "a joint without limits")
            self.low, self.high = (number(limit.attributes.get(side, "0")) for side in ("lower", "upper"))
            for needed in ("effort", "velocity"):
                number(limit.attributes.get(needed, "0"))
            if self.low > self.high:  # noted, and none
                self.low, self.high = -math.inf, math.inf
        elif limit is not None:
            for value in limit.attributes.values():
                number(value)
        for name in ("dynamics", "calibration", "safety_controller"):
            for value in element.one(name).attributes.values() if element.one(name) else ():
                number(value)
        self.leader = None
        if mimic is not None and self.kind != "fixed":
            self.leader = mimic.get("joint")
            self.factor, self.offset = (number(mimic.attributes.get(k, d)) for k, d in (("multiplier", "1"), ("offset", "0")))

    def motion(self, value):
        if self.kind == "fixed":
            return self.origin
        if self.kind == "prismatic":
            n = math.hypot(*self.axis)
            return compose(self.origin, (IDENTITY[0], tuple(value * a / n for a in self.axis)))
        return compose(self.origin, (rotation(self.axis, value), (0.0, 0.0, 0.0)))


class Robot:
    """What a URDF file says: `joints` in its order, `bodies` by link for the links that have any."""

    def __init__(self, data, files, visual=False, excluded=()):
        root = xml_tree.parse(data)
        demand(root.name == "robot", "no <robot>")  # its name says nothing of where it is
        _check_words(root, {})
        self.links, self.bodies = [], {}
        for link in root.all("link"):
            name = link.get("name")
            demand(name not in self.links, "a link twice")
            self.links.append(name)
            found = {kind: [_body(e, files) for e in link.all(kind)] for kind in ("collision", "visual")}
            first, second = ("visual", "collision") if visual else ("collision", "visual")
            used = found[first] or found[second]
            if used and name not in excluded:
                self.bodies[name] = used
        demand(all(name in self.links for name in excluded), "no link of that name to exclude")
        demand(self.bodies, "no link has geometry")
        self.joints = [Joint(e) for e in root.all("joint")]
        self.by_name = {joint.name: joint for joint in self.joints}
        demand(len(self.by_name) == len(self.joints), "a joint twice")
        for joint in self.joints:  # one that follows a joint of another file moves by itself; a misspelt name is refused
            if joint.leader is not None and joint.leader not in self.by_name:
                demand(all(_edits(joint.leader[:200], other) > 1 for other in self.by_name if other != joint.name), "a leader that is misspelt")
                joint.leader = None
        self.above = {joint.child: joint for joint in self.joints}
        demand(len(self.above) == len(self.joints) == len(self.links) - 1, "the joints make no tree")
        if any(j.parent == "world" for j in self.joints):
            raise Unknown("the link that every simulator has")
        demand(all(j.parent in self.links and j.child in self.links for j in self.joints), "a joint of an unknown link")
        for name in self.links:
            for _ in self.links:
                name = self.above[name].parent if name in self.above else name
            demand(name not in self.above, "the joints make a ring")
        self.movable = [j for j in self.joints if j.kind != "fixed" and j.leader is None]
        for joint in self.joints:
            self.value(joint, {})

    def value(self, joint, given):
        if joint.leader is None:
            return given.get(joint.name, min(max(0.0, joint.low), joint.high))
        seen, factor, offset = set(), 1.0, 0.0
        while joint.leader is not None:
            demand(joint.name not in seen and joint.leader in self.by_name, "a mimic that leads nowhere")
            seen.add(joint.name)
            offset, factor = offset + factor * joint.offset, factor * joint.factor
            joint = self.by_name[joint.leader]
        demand(joint.kind != "fixed", "a mimic of a fixed joint")
        value = factor * self.value(joint, given) + offset
        demand(math.isfinite(value), "a mimic that is not finite")
        if abs(value) > 1000 or abs(offset) > 1000:
            raise Unknown("a mimic that may be too far to be known")
        return value

    def check(self, given, ignore_limits):
        for name, value in given.items():
            demand(name in [j.name for j in self.movable], f"{name[:40]!r} takes no value")
            demand(math.isfinite(value), "a value that is not finite")
            demand(ignore_limits or self.by_name[name].low <= value <= self.by_name[name].high, "a value beyond its limits")

    def link_pose(self, name, given):
        demand(name in self.links, f"no link {name[:40]!r}")
        pose = IDENTITY
        while name in self.above:
            joint = self.above[name]
            pose = compose(joint.motion(self.value(joint, given)), pose)
            name = joint.parent
        return pose
