# SPDX-License-Identifier: BSD-3-Clause
"""A strict reader of URDF: links with their bodies, and where they stand."""

import math
import os

import meshes
import scenes
import xml_tree
from geometry import IDENTITY, Mesh, Shape, apply, compose, determinant, roll_pitch_yaw, rotation
from strict import Invalid, demand, number, numbers

_known = {"origin": "xyz rpy", "box": "size", "sphere": "radius", "cylinder": "radius length", "capsule": "radius length",
          "mesh": "filename scale", "axis": "xyz", "limit": "lower upper effort velocity", "mimic": "joint multiplier offset"}
_fields = {"box": ("size", 3), "sphere": ("radius", 1), "cylinder": ("radius length", 1), "capsule": ("radius length", 1)}


def _lengths(element, names, count):
    values = [v for name in names.split() for v in numbers(element.get(name), count)]
    demand(all(v > 0 for v in values), "a length that is not above 0")
    return values


def _origin(element):
    at = element.one("origin")
    if at is None:
        return IDENTITY
    return (roll_pitch_yaw(*numbers(at.attributes.get("rpy", "0 0 0"), 3)), tuple(numbers(at.attributes.get("xyz", "0 0 0"), 3)))


def load_mesh(name, files):
    data = files.get(name.removeprefix("file://").removeprefix("./"))
    demand(data is not None, f"there is no {name[:40]!r}")
    ending = os.path.splitext(name)[1].lower()
    if ending in (".dae", ".glb"):
        return (scenes.read_dae if ending == ".dae" else scenes.read_glb)(data)
    demand(ending in meshes.readers, f"{name[:40]!r} is no mesh by its name")
    return meshes.triangles(meshes.readers[ending](data))


def _body(element, files):
    """The body of a <visual> or <collision>, in the link's frame."""
    for child in element.children:
        demand(child.name in ("origin", "geometry", "material", "name", "verbose", "contact_coefficients"), f"<{child.name}>")
    pose, kinds = _origin(element), element.need("geometry").children
    demand(len(kinds) == 1, "a geometry of other than one shape")
    shape = kinds[0]
    if shape.name in _fields:
        return Shape(shape.name, _lengths(shape, *_fields[shape.name]), pose)
    demand(shape.name == "mesh", f"a geometry <{shape.name}>")
    scale = numbers(shape.attributes.get("scale", "1 1 1"), 3)
    demand(all(scale), "a scale of 0")
    sized = (tuple(tuple(v * s for v, s in zip(row, scale)) for row in pose[0]), pose[1])
    turned = determinant(sized[0]) < 0
    found = [tuple(apply(sized, v) for v in t) for t in load_mesh(shape.get("filename"), files)]
    return Mesh([(a, c, b) if turned else (a, b, c) for a, b, c in found])


class Joint:
    def __init__(self, element):
        self.name, self.kind = element.get("name"), element.get("type")
        for child in element.children:
            demand(child.name in ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "calibration",
                                  "safety_controller"), f"<{child.name}> in a joint")
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
                number(limit.get(needed))
            demand(self.low <= self.high, "limits that exclude all")
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
        demand(root.name == "robot" and "name" in root.attributes, "no <robot> with a name")
        for e in root.walk():  # a misspelt attribute would leave its default in silence
            demand(not e.name.startswith("xacro:"), "xacro")
            demand(e.name not in _known or set(e.attributes) <= set(_known[e.name].split()), f"an unknown attribute of <{e.name}>")
        self.links, self.bodies, self.notes = [], {}, 0
        for link in root.all("link"):
            name = link.get("name")
            demand(name not in self.links, "a link twice")
            self.links.append(name)
            self._inertial(link)
            found = {kind: [_body(e, files) for e in link.all(kind)] for kind in ("collision", "visual")}
            first, second = ("visual", "collision") if visual else ("collision", "visual")
            used = found[first] or found[second]
            if used and name not in excluded:
                self.bodies[name] = used
                self.notes += not found[first]
        demand(all(name in self.links for name in excluded), "no link of that name to exclude")
        demand(self.bodies, "no link has geometry")
        self.joints = [Joint(e) for e in root.all("joint")]
        self.by_name = {joint.name: joint for joint in self.joints}
        demand(len(self.by_name) == len(self.joints), "a joint twice")
        self.above = {joint.child: joint for joint in self.joints}
        demand(len(self.above) == len(self.joints) == len(self.links) - 1, "the joints make no tree")
        demand(all(j.parent in self.links and j.child in self.links for j in self.joints), "a joint of an unknown link")
        for name in self.links:
            for _ in self.links:
                name = self.above[name].parent if name in self.above else name
            demand(name not in self.above, "the joints make a ring")
        self.movable = [j for j in self.joints if j.kind != "fixed" and j.leader is None]
        for joint in self.joints:
            self.value(joint, {})

    @staticmethod
    def _inertial(link):
        inertial = link.one("inertial")
        if inertial is None:
            return
        _origin(inertial)
        number(inertial.need("mass").get("value"))
        for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            number(inertial.need("inertia").get(name))

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
