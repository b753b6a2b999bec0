# SPDX-License-Identifier: BSD-3-Clause
"""Strict readers of meshes with a scene graph, COLLADA and binary glTF: each gives triangles as they stand in the scene."""

import base64
import json
import math
import re
import struct

import xml_tree
from geometry import IDENTITY, apply, compose, determinant, quaternion, rotation
from meshes import triangles
from strict import Invalid, Unknown, demand, number, numbers, whole

_most = 100_000  # triangles; more are not worth the time of these readers


def _placed(mesh, pose):
    turned = determinant(pose[0]) < 0
    for a, b, c in triangles(mesh):
        a, b, c = apply(pose, a), apply(pose, b), apply(pose, c)
        yield (a, c, b) if turned else (a, b, c)


# ---- COLLADA ----

_inside = {  # what an element may contain, of those that matter to geometry
    "COLLADA": "asset library_geometries library_visual_scenes scene library_nodes library_materials library_effects library_images extra",
    "library_geometries": "asset geometry extra", "geometry": "asset mesh convex_mesh spline extra",
    "mesh": "source vertices lines linestrips polygons polylist triangles trifans tristrips extra",
    "source": "asset float_array int_array IDREF_array Name_array bool_array technique_common technique",
    "technique_common": "accessor", "accessor": "param", "vertices": "input extra", "triangles": "input p extra",
    "polylist": "input vcount p extra", "polygons": "input p ph extra", "library_visual_scenes": "asset visual_scene extra",
    "visual_scene": "asset node evaluate_scene extra", "scene": "instance_visual_scene instance_physics_scene extra",
    "node": "asset lookat matrix rotate scale skew translate instance_camera instance_controller instance_geometry instance_light"
            " instance_node node extra",
    "instance_geometry": "bind_material extra", "asset": "contributor created keywords modified revision subject title unit up_axis",
}


class _Collada:
    def __init__(self, data):
        self.root = xml_tree.parse(data)
        demand(self.root.name == "COLLADA", "no COLLADA file")
        self.ids, self.made = {}, []
        normals = {i.attributes.get("source", "")[1:] for i in self.root.walk() if i.attributes.get("semantic") == "NORMAL"}
        for element in self.root.walk():
            allowed = _inside.get(element.name)
            if element.name == "source" and element.attributes.get("id") in normals:
                continue  # nobody reads it
            for child in element.children if allowed else ():
                demand(child.name in allowed.split(), f"<{child.name}> in <{element.name}>")
            if "id" in element.attributes:
                demand(element.attributes["id"] not in self.ids, "an id twice")
                self.ids[element.attributes["id"]] = element
            if element.name in ("lines", "linestrips", "trifans", "tristrips", "convex_mesh", "spline", "ph", "lookat", "skew",
                                "instance_controller", "library_nodes"):
                raise Unknown(f"<{element.name}>")

    def at(self, url, *names):
        demand(url.startswith("#") and url[1:] in self.ids, f"{url[:40]!r} leads nowhere")
        demand(self.ids[url[1:]].name in names, f"{url[:40]!r} is another kind of element")
        return self.ids[url[1:]]

    def positions(self, url):
        vertices = self.at(url, "vertices")
        found = [i for i in vertices.all("input") if i.get("semantic") == "POSITION"]
        demand(len(found) == 1, "vertices without one POSITION")
        source = self.at(found[0].get("source"), "source")
        accessor = source.need("technique_common").need("accessor")
        array = self.at(accessor.get("source"), "float_array")
        values = [number(word) for word in array.text.split()]
        demand(whole(array.get("count")) == len(values), "a float_array of another count")
        count, stride = whole(accessor.get("count")), whole(accessor.attributes.get("stride", "1"), 1)
        offset = whole(accessor.attributes.get("offset", "0"))
        if count == len(values) > 3:
            raise Unknown("an accessor that counts floats")
        demand(offset + count * stride <= len(values), "an accessor beyond its array")
        names = [p.attributes.get("name") for p in accessor.all("param")]
        if names != ["X", "Y", "Z"] or any(p.attributes.get("type", "float") != "float" for p in accessor.all("param")):
            raise Unknown("parameters other than X, Y, Z")
        demand(stride >= 3, "a stride below three")
        return [tuple(values[offset + i * stride:offset + i * stride + 3]) for i in range(count)]

    def mesh(self, geometry):
        vertices, faces = [], []
        mesh = geometry.need("mesh")
        for group in mesh.all("triangles", "polylist", "polygons"):
            inputs = group.all("input")
            offsets = [whole(i.get("offset"), 0, 1000) for i in inputs]
            demand(inputs, "faces without input")
            stride = max(offsets) + 1
            about = [(i, o) for i, o in zip(inputs, offsets) if i.get("semantic") == "VERTEX"]
            demand(len(about) == 1, "faces without one VERTEX")
            first = len(vertices)
            points = self.positions(about[0][0].get("source"))
            count = whole(group.get("count"))
            lists = [[whole(word) for word in p.text.split()] for p in group.all("p")]
            if group.name == "polygons":
                demand(len(lists) == count, "polygons of another count")
                sizes = [len(p) // stride for p in lists]
                demand(all(len(p) % stride == 0 for p in lists), "a polygon is cut short")
            else:
                demand(len(lists) == 1 or (count == 0 and not lists), "not one <p>")
                sizes = [3] * count if group.name == "triangles" and count < _most else []
                if group.name == "polylist":
                    sizes = [whole(word) for word in group.need("vcount").text.split()]
                demand(len(sizes) == count and sum(sizes) * stride == sum(map(len, lists)), "indices of another count")
            indices = [i for p in lists for i in p][about[0][1]::stride]
            demand(all(i < len(points) for i in indices), "an index beyond the vertices")
            at = 0
            for size in sizes:
                faces.append([first + i for i in indices[at:at + size]])
                at += size
            vertices += points
        return vertices, faces

    def node(self, node, pose, above):
        demand(node not in above, "a node contains itself")
        if len(above) > 150 or len(self.made) > _most:
            raise Unknown("a scene too deep or too large")
        for step in node.children:
            if step.name == "matrix":
                m = numbers(step.text, 16)
                demand(m[12:] == [0, 0, 0, 1], "a matrix that is not affine")
                pose = compose(pose, ((tuple(m[0:3]), tuple(m[4:7]), tuple(m[8:11])), (m[3], m[7], m[11])))
            elif step.name == "translate":
                pose = compose(pose, (IDENTITY[0], tuple(numbers(step.text, 3))))
            elif step.name == "rotate":
                *axis, angle = numbers(step.text, 4)
                demand(any(axis), "a rotation without axis")
                pose = compose(pose, (rotation(axis, math.radians(angle)), (0, 0, 0)))
            elif step.name == "scale":
                x, y, z = numbers(step.text, 3)
                pose = compose(pose, (((x, 0, 0), (0, y, 0), (0, 0, z)), (0, 0, 0)))
        for step in node.children:
            if step.name == "instance_geometry":
                mesh = self.mesh(self.at(step.get("url"), "geometry"))
                if mesh[1]:
                    self.made += _placed(mesh, pose)
            elif step.name == "instance_node":
                self.node(self.at(step.get("url"), "node"), pose, above + [node])
            elif step.name == "node":
                self.node(step, pose, above + [node])

    def read(self):
        for geometry in [e for e in self.root.walk() if e.name == "geometry"]:
            self.mesh(geometry)
        scene = self.root.one("scene")
        if scene is None or scene.one("instance_visual_scene") is None:
            raise Unknown("no scene")
        shown = self.at(scene.need("instance_visual_scene").get("url"), "visual_scene")
        asset = self.root.one("asset")
        unit = asset.one("unit") if asset else None
        metres = number(unit.attributes.get("meter", "1")) if unit else 1.0
        demand(metres > 0, "a unit that is no length")
        axis = asset.one("up_axis") if asset else None
        axis = axis.text.strip() if axis else "Y_UP"
        for library in self.root.all("library_geometries", "library_visual_scenes"):
            for own in [e.one("asset") for e in library.walk() if e.one("asset")]:
                stated, up = own.one("unit"), own.one("up_axis")
                demand(stated is None or number(stated.attributes.get("meter", "1")) == metres, "another unit for a part of the file")
                demand(up is None or up.text.strip() == axis, "another up axis for a part of the file")
        for node in shown.all("node"):
            self.node(node, _scaled(metres), [])
        demand(self.made, "no triangles")
        return self.made


def _scaled(s):
    return ((s, 0.0, 0.0), (0.0, s, 0.0), (0.0, 0.0, s)), (0.0, 0.0, 0.0)


def read_dae(data):
    return _Collada(data).read()


# ---- binary glTF ----

def split_glb(data):
    """(JSON text, binary chunk)."""
    demand(len(data) >= 20 and data[:4] == b"glTF", "no GLB file")
    version, size = struct.unpack_from("<II", data, 4)
    demand(version == 2 and size == len(data), "a wrong version or size")
    at, chunks = 12, []
    while at < len(data):
        demand(at + 8 <= len(data), "cut short")
        length, kind = struct.unpack_from("<I4s", data, at)
        demand(length % 4 == 0 and at + 8 + length <= len(data), "a chunk of a wrong length")
        chunks.append((kind, data[at + 8:at + 8 + length]))
        at += 8 + length
    demand(chunks[0][0] == b"JSON" and all(k not in (b"JSON",) for k, _ in chunks[1:]), "the first chunk is not JSON")
    demand(all(k != b"BIN\0" for k, _ in chunks[2:]), "a late binary chunk")
    return chunks[0][1], chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else None


def _once(pairs):
    demand(len({key for key, _ in pairs}) == len(pairs), "a key twice")
    return dict(pairs)


def _refuse_constant(word):
    raise Invalid(f"{word} in JSON")


class _Gltf:
    def __init__(self, data, ending):
        text, self.binary = split_glb(data) if ending == ".glb" else (data, None)
        try:
            self.top = json.loads(text.decode("utf-8"), object_pairs_hook=_once, parse_constant=_refuse_constant)
        except RecursionError as error:
            raise Unknown("JSON nested too deep") from error
        except ValueError as error:
            raise Invalid(f"no JSON: {error}") from error
        demand(isinstance(self.top, dict), "JSON that is no object")
        asset = self.top.get("asset")
        demand(isinstance(asset, dict) and isinstance(asset.get("version"), str) and asset["version"].startswith("2."), "no version")
        if "extensionsRequired" in self.top:
            raise Unknown("extensions")
        self.made, self.seen = [], set()

    def item(self, kind, index):
        held = self.top.get(kind)
        demand(isinstance(held, list) and isinstance(index, int) and not isinstance(index, bool) and 0 <= index < len(held),
               f"{kind} {index!r:.40} does not exist")
        demand(isinstance(held[index], dict), f"{kind} that is no object")
        return held[index]

    @staticmethod
    def count(of, key, default=None, low=0):
        value = of.get(key, default)
        demand(isinstance(value, int) and not isinstance(value, bool) and value >= low, f"{key} is {value!r:.40}")
        return value

    def values(self, index, kinds):
        """The rows of an accessor."""
        accessor = self.item("accessors", index)
        if "sparse" in accessor or "bufferView" not in accessor:
            raise Unknown("a sparse accessor")
        if accessor.get("normalized") or "KHR_mesh_quantization" in str(self.top.get("extensionsUsed")):
            raise Unknown("numbers of another scale")
        component, shape = accessor.get("componentType"), accessor.get("type")
        demand(isinstance(component, int) and isinstance(shape, str) and (component, shape) in kinds, f"an accessor of {component!r:.20} {shape!r:.20}")
        letter, width = kinds[component, shape]
        size = struct.calcsize(letter)
        view = self.item("bufferViews", accessor["bufferView"])
        buffer = self.item("buffers", view.get("buffer"))
        held, binary = self.count(buffer, "byteLength", low=1), self.binary
        if "uri" in buffer:
            match = re.fullmatch(r"data:[^,]*;base64,([A-Za-z0-9+/]*={0,2})", buffer["uri"]) if isinstance(buffer["uri"], str) else None
            if match is None or len(match[1]) % 4 != 0:
                raise Unknown("a buffer elsewhere, or data in another form")
            binary = base64.b64decode(match[1])
            demand(held <= len(binary), "a buffer of another length")
        else:
            demand(view["buffer"] == 0 and binary is not None, "a buffer that is not there")
            demand(held <= len(binary) <= held + 3, "a buffer of another length")
        begin, length = self.count(view, "byteOffset", 0), self.count(view, "byteLength", low=1)
        demand(begin + length <= held, "a view beyond its buffer")
        count, at = self.count(accessor, "count", low=1), self.count(accessor, "byteOffset", 0)
        stride = self.count(view, "byteStride", size * width, 1)
        demand(stride >= size * width and stride % size == 0 and (begin + at) % size == 0, "a wrong stride or offset")
        demand(at + stride * (count - 1) + size * width <= length, "an accessor beyond its view")
        return [struct.unpack_from(f"<{width}{letter}", binary, begin + at + i * stride) for i in range(count)]

    def mesh(self, index):
        mesh = self.item("meshes", index)
        vertices, faces = [], []
        demand(isinstance(mesh.get("primitives"), list) and mesh["primitives"], "a mesh without primitives")
        for primitive in mesh["primitives"]:
            demand(isinstance(primitive, dict) and isinstance(primitive.get("attributes"), dict), "a primitive without attributes")
            if self.count(primitive, "mode", 4) != 4 or "targets" in primitive or "extensions" in primitive:
                demand(primitive.get("mode", 4) < 7, "an unknown mode")
                raise Unknown("a primitive other than triangles")
            demand("POSITION" in primitive["attributes"], "a primitive without POSITION") if primitive["attributes"] == {} else None
            if "POSITION" not in primitive["attributes"]:
                raise Unknown("a primitive without POSITION")
            points = self.values(primitive["attributes"]["POSITION"], {(5126, "VEC3"): ("f", 3)})
            demand(all(map(math.isfinite, (c for p in points for c in p))), "a vertex that is not finite")
            indices = list(range(len(points)))
            if "indices" in primitive:
                kinds = {(5121, "SCALAR"): ("B", 1), (5123, "SCALAR"): ("H", 1), (5125, "SCALAR"): ("I", 1)}
                indices = [i for i, in self.values(primitive["indices"], kinds)]
            demand(len(indices) % 3 == 0 and all(i < len(points) for i in indices), "indices that make no triangles")
            faces += [[len(vertices) + i for i in indices[k:k + 3]] for k in range(0, len(indices), 3)]
            vertices += points
        return vertices, faces

    @staticmethod
    def reals(node, key, default):
        values = node.get(key, default)
        demand(isinstance(values, list) and len(values) == len(default), f"{key} of another length")
        demand(all(isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v) for v in values), f"{key} of no numbers")
        return [float(v) for v in values]

    def node(self, index, pose, depth):
        node = self.item("nodes", index)
        demand(index not in self.seen, "a node in two places")
        self.seen.add(index)
        if depth > 150 or len(self.made) > _most or "skin" in node or "extensions" in node:
            raise Unknown("a scene too deep or too large, or a skin")
        demand("matrix" not in node or not {"translation", "rotation", "scale"} & set(node), "a matrix beside other motions")
        if "matrix" in node:
            m = self.reals(node, "matrix", [0] * 16)
            demand(m[3::4] == [0, 0, 0, 1], "a matrix that is not affine")
            here = (tuple(zip(m[0:3], m[4:7], m[8:11])), tuple(m[12:15]))
        else:
            q, s = self.reals(node, "rotation", [0, 0, 0, 1]), self.reals(node, "scale", [1, 1, 1])
            if abs(math.sqrt(sum(v * v for v in q)) - 1) > 1e-6:
                demand(abs(math.sqrt(sum(v * v for v in q)) - 1) < 1e-3, "a rotation that is not of unit length")
                raise Unknown("a rotation that is nearly of unit length")
            rows = tuple(tuple(v * k for v, k in zip(row, s)) for row in quaternion(*q))
            here = (rows, tuple(self.reals(node, "translation", [0, 0, 0])))
        pose = compose(pose, here)
        if "mesh" in node:
            mesh = self.mesh(node["mesh"])
            if mesh[1]:
                self.made += _placed(mesh, pose)
        children = node.get("children", [])
        demand(isinstance(children, list), "children that are no list")
        for child in children:
            self.node(child, pose, depth + 1)

    def read(self):
        for kind in ("nodes", "meshes", "scenes"):
            demand(isinstance(self.top.get(kind, []), list), f"{kind} is no list")
        for index in range(len(self.top.get("meshes", []))):
            self.mesh(index)
        if "scene" not in self.top:
            raise Unknown("no scene is said to be shown")
        roots = self.item("scenes", self.top["scene"]).get("nodes", [])
        demand(isinstance(roots, list), "roots that are no list")
        for index in roots:
            self.node(index, IDENTITY, 0)
        demand(self.made, "no triangles")
        return self.made


def read_gltf(data, ending):
    return _Gltf(data, ending).read()
