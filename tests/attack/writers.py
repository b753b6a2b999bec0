# SPDX-License-Identifier: BSD-3-Clause
"""Writes small undamaged files of every format that the command reads."""

import base64
import json
import struct
import zlib

from geometry import cross, sub


def box(x, y, z):
    """(vertices, quads that face out) of a box around 0."""
    v = [(i * x / 2, j * y / 2, k * z / 2) for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)]
    return v, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def halved(mesh):
    vertices, faces = mesh
    return vertices, [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]


def _row(values):
    return " ".join(f"{v:g}" for v in values)


def stl_text(mesh):
    lines = ["solid box"]
    for face in mesh[1]:
        a, b, c = (mesh[0][i] for i in face)
        lines += [f"facet normal {_row(cross(sub(b, a), sub(c, a)))}", "outer loop", *(f"vertex {_row(v)}" for v in (a, b, c)), "endloop", "endfacet"]
    return "\n".join(lines + ["endsolid box", ""]).encode()


def stl_binary(mesh):
    data = b"made by tests/attack/attack".ljust(80) + struct.pack("<I", len(mesh[1]))
    for face in mesh[1]:
        data += struct.pack("<12fH", 0, 0, 0, *(c for i in face for c in mesh[0][i]), 0)
    return data


def obj(mesh):
    lines = ["# a box", "o box", *(f"v {_row(v)}" for v in mesh[0]), "vn 0 0 1", "s off"]
    lines += ["f " + " ".join(f"{i + 1}//1" if k % 2 else str(i + 1) for i in face) for k, face in enumerate(mesh[1])]
    return "\n".join(lines + [""]).encode()


def off(mesh, kind="OFF", more=(), colour=()):
    """`more` follows each vertex, as its kind has it; `colour` each face."""
    lines = [kind, f"{len(mesh[0])} {len(mesh[1])} 0", *(_row((*v, *more)) for v in mesh[0])]
    return "\n".join(lines + [_row((len(face), *face, *colour)) for face in mesh[1]] + [""]).encode()


def ply_mesh(mesh, form="ascii"):
    head = f"ply\nformat {form} 1.0\ncomment a box\nelement vertex {len(mesh[0])}\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"property uchar red\nelement face {len(mesh[1])}\nproperty list uchar int vertex_indices\nend_header\n"
    if form == "ascii":
        lines = [_row((*v, 200)) for v in mesh[0]] + [_row((len(face), *face)) for face in mesh[1]]
        return (head + "\n".join(lines) + "\n").encode()
    order = "<" if "little" in form else ">"
    data = b"".join(struct.pack(order + "3fB", *v, 200) for v in mesh[0])
    return head.encode() + data + b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in mesh[1])


def ply_strips(form="ascii", size=(0.2, 0.3, 0.4)):
    """A box as triangle strips: four sides in one, top and bottom each."""
    vertices, _ = box(*size)
    strips = [0, 4, 1, 5, 3, 7, 2, 6, 0, 4, -1, 0, 1, 2, 3, -1, 4, 6, 5, 7, -1]
    head = f"ply\nformat {form} 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    if form == "ascii":
        return (head + "\n".join(_row(v) for v in vertices) + f"\n{_row((len(strips), *strips))}\n").encode()
    return head.encode() + b"".join(struct.pack("<3f", *v) for v in vertices) + struct.pack(f"<{len(strips) + 1}i", len(strips), *strips)


def dae(mesh):
    """In centimetres; a polylist and triangles; the box stands at a node within a node."""
    values = " ".join(_row(100 * c for c in v) for v in mesh[0])
    split = len(mesh[1]) // 2
    lists = [" ".join(_row(face) for face in faces) for faces in (mesh[1][:split], mesh[1][split:])]
    normals = " ".join(f"{i} 0" for face in mesh[1][split:] for i in face)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="{3 * len(mesh[0])}">{values}</float_array><technique_common><accessor source="#pa" count="{len(mesh[0])}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="n"><float_array id="na" count="3">0 0 1</float_array><technique_common><accessor source="#na" count="1" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="{split}"><input semantic="VERTEX" source="#v" offset="0"/><vcount>{" ".join("3" for _ in range(split))}</vcount><p>{lists[0]}</p></polylist>
<triangles count="{len(mesh[1]) - split}"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/><p>{normals}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="a" name="a"><translate>0 0 -10</translate><rotate>0 0 1 90</rotate><node id="b"><matrix>0 1 0 0 -1 0 0 0 0 0 1 10 0 0 0 1</matrix><scale>1 1 1</scale><instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
""".encode()


def pack_glb(text, binary):
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def glb(mesh):
    """Indices first, so that the vertices begin at another offset; the mesh hangs on a child."""
    indices = struct.pack(f"<{3 * len(mesh[1])}H", *(i for face in mesh[1] for i in face))
    places = b"".join(struct.pack("<3f", *v) for v in mesh[0])
    top = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "translation": [0, 0.1, 0]}, {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.1, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0, "mode": 4}]}],
        "accessors": [{"bufferView": 0, "componentType": 5123, "count": 3 * len(mesh[1]), "type": "SCALAR"},
                      {"bufferView": 1, "componentType": 5126, "count": len(mesh[0]), "type": "VEC3",
                       "min": [min(c) for c in zip(*mesh[0])], "max": [max(c) for c in zip(*mesh[0])]}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(indices)},
                        {"buffer": 0, "byteOffset": len(indices), "byteLength": len(places)}],
        "buffers": [{"byteLength": len(indices) + len(places)}],
    }
    return pack_glb(json.dumps(top).encode(), indices + places)


def gltf(mesh):
    """The same as text, with its numbers in a data URI."""
    whole = glb(mesh)
    size = struct.unpack_from("<I", whole, 12)[0]
    top = json.loads(whole[20:20 + size])
    data = whole[28 + size:][:top["buffers"][0]["byteLength"]]
    top["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps(top).encode()


def xyz(points):
    return "".join(f"{_row(p)}\n" for p in points).encode()


def ply_cloud(points, form="ascii", kind="float"):
    head = f"ply\nformat {form} 1.0\nelement vertex {len(points)}\nproperty uchar intensity\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nproperty short ring\nend_header\n"
    if form == "ascii":
        return (head + "".join(f"{12 + i} {_row(p)} {-i}\n" for i, p in enumerate(points))).encode()
    pattern = ("<" if "little" in form else ">") + ("B3fh" if kind == "float" else "B3dh")
    return head.encode() + b"".join(struct.pack(pattern, 12 + i, *p, -i) for i, p in enumerate(points))


def pcd(points, form="ascii", kind="f", view="0 0 0 1 0 0 0"):
    size = struct.calcsize(kind)
    head = f"# .PCD v0.7\nVERSION 0.7\nFIELDS intensity x y z\nSIZE 1 {size} {size} {size}\nTYPE U F F F\nCOUNT 1 1 1 1\n"
    head += f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT {view}\nPOINTS {len(points)}\nDATA {form}\n"
    if form == "ascii":
        return (head + "".join(f"{i} {_row(p)}\n" for i, p in enumerate(points))).encode()
    if form == "binary":
        return head.encode() + b"".join(struct.pack("<B3" + kind, i, *p) for i, p in enumerate(points))
    flat = bytes(range(len(points))) + b"".join(struct.pack(f"<{len(points)}{kind}", *axis) for axis in zip(*points))
    packed = b"".join(bytes([len(flat[i:i + 32]) - 1]) + flat[i:i + 32] for i in range(0, len(flat), 32))
    return head.encode() + struct.pack("<II", len(packed), len(flat)) + packed


def png_chunk(name, body):
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def png(width, height, pixels):
    rows = [struct.pack(f">{width}H", *pixels[y * width:(y + 1) * width]) for y in range(height)]
    head = png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    half = len(data) // 2
    return b"\x89PNG\r\n\x1a\n" + head + png_chunk(b"IDAT", data[:half]) + png_chunk(b"IDAT", data[half:]) + png_chunk(b"IEND", b"")


def csv_spheres(spheres):
    return ("x,y,z,r\n" + "".join(",".join(f"{v:g}" for v in s) + "\n" for s in spheres)).encode()


def yaml_spheres(parts):
    lines = ["collision_spheres:"]
    for name, spheres in parts.items():
        lines.append(f"  {name}:")
        for x, y, z, r in spheres:
            lines += [f"    - center: [{x:g}, {y:g}, {z:g}]", f"      radius: {r:g}"]
    return ("\n".join(lines) + "\n").encode()
