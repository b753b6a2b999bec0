# SPDX-License-Identifier: BSD-3-Clause
"""Strict readers of meshes without a scene graph: each gives (vertices, faces)."""

import math
import struct

import ply
from geometry import cross, dot, length, sub
from strict import Unknown, demand, lines_of, number, text_of, uncommented, whole, words_of

_obj_names = ("g", "o", "usemtl", "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj")  # their words may end in a backslash
_obj_more = ("surf", "curv", "curv2", "bsp", "bzp", "cdc", "cdp", "call", "csh")  # bring geometry that is not read
_obj_words = set("""v vw vt vn vp f l p g o s usemtl mtllib usemap maplib mg bevel c_interp d_interp lod shadow_obj trace_obj cstype
deg bmat step curv curv2 surf parm trim hole scrv sp end con ctech stech call csh bsp bzp cdc cdp res maxsize""".split())


def _vertex(words):
    for word in words[3:]:  # a weight, a colour, a normal
        number(word, finite=False)
    return tuple(number(word) for word in words[:3])


def _obj_statements(data):
    """Words, and whether nothing follows. A backslash joins no line to a comment, and none that begins a statement to a name."""
    lines = lines_of(data)
    ended = lines[-1] == ""
    lines = lines[:-1] if ended else lines
    at = 0
    while at < len(lines):
        line, first = lines[at], words_of(lines[at])[:1]
        at += 1
        while line.endswith("\\") and at < len(lines) and uncommented(line) == line:
            after = words_of(lines[at])
            if first and first[0] in _obj_names and (not after or after[0].startswith("#") or after[0] in _obj_words):
                break
            line = line[:-1] + " " + lines[at]
            at += 1
        yield words_of(uncommented(line)), at == len(lines) and not ended


def read_obj(data):
    demand(b"\0" not in data, "zero bytes")
    vertices, faces, whole_faces = [], [], 0
    for words, last in _obj_statements(data):
        if not words:
            continue
        demand(words[0] not in _obj_more, f"{words[0]} is not read")
        if words[0] not in _obj_words:  # FCL's files begin with two counts
            demand(not vertices and len(words) < 3, f"{words[0][:20]!r} is no statement")
            whole(words[0], 0, 2**64 - 1)
            [number(word, finite=False) for word in words[1:]]
        if words[0] == "v":
            demand(len(words) in (4, 5, 7, 8), "a vertex of other than 3, 4, 6 or 7 numbers")
            vertices.append(_vertex(words[1:]))
        elif words[0] == "f":
            face = []
            for word in words[1:]:
                parts = word.split("/")
                demand(len(parts) <= 3 and parts[0], "a damaged corner")
                for part in parts[1:]:
                    part == "" or whole(part, -(2**63), 2**63)
                index = whole(parts[0], -(2**32), 2**32)
                face.append(index - 1 if index > 0 else len(vertices) + index)
                demand(index != 0 and face[-1] >= 0, "an index before the first")
            demand(face and (len(face) >= 3 or not last), "a face that is cut short")
            whole_faces += len(face) >= 3
            faces.append(face + [face[-1]] * (3 - len(face)))  # an edge is a triangle without area
        elif words[0] in ("vn", "vt", "vp", "s", "l", "p"):
            demand(not _obj_words & set(words[1:]), "two statements in one line")
    demand(whole_faces or not faces, "no face of three corners")
    return vertices, faces


def read_off(data):
    lines = [words_of(uncommented(line)) for line in lines_of(data)]
    lines = [line for line in lines if line]
    more = {"OFF": (0,), "COFF": (3, 4), "NOFF": (3,), "STOFF": (2,)}
    demand(lines and lines[0][0] in more, "no OFF file")
    more, head = more[lines[0][0]], lines[0][1:]
    at = 1
    if not head:
        demand(len(lines) > 1, "no counts")
        head, at = lines[1], 2
    demand(len(head) in (2, 3), "no counts")
    count, faces_count, _ = (*map(whole, head), 0)[:3]
    demand(at + count + faces_count == len(lines), "the counts are not those of the lines")
    vertices, faces = [], []
    for line in lines[at:at + count]:
        demand(len(line) - 3 in more, "a vertex of another count of numbers")
        more = (len(line) - 3,)
        vertices.append(_vertex(line))
    for line in lines[at + count:]:
        n = whole(line[0], 3)
        demand(n < len(line), "a face is cut short")
        faces.append([whole(word) for word in line[1:n + 1]])
        demand(len(line) - n - 1 in (0, 1, 3, 4), "a face with what is no colour")
        for word in line[n + 1:]:
            number(word, finite=False)
    return vertices, faces


def _stl_text(data):
    vertices, faces, words, name = [], [], [], True
    lines = lines_of(data)
    state = 0  # outside of a solid
    for line in lines:
        found = line.split()
        if state == 0 and found:
            demand(found[0].lower() == "solid", f"{found[0][:20]!r} instead of solid")
            state = 1
        elif state == 1 and found and found[0].lower() == "endsolid":
            demand(not words, "a facet is cut short")
            state = 0
        elif state == 1:
            words += found
            if len(words) >= 21:
                demand(len(words) == 21, "words that belong to no facet")
                small = [w.lower() for w in words]
                demand(small[:2] == ["facet", "normal"] and small[5:7] == ["outer", "loop"] and small[19:] == ["endloop", "endfacet"]
                       and all(small[k] == "vertex" for k in (7, 11, 15)), "a damaged facet")
                for word in words[2:5]:
                    number(word, finite=False)
                faces.append([len(vertices), len(vertices) + 1, len(vertices) + 2])
                vertices += [tuple(number(w) for w in words[k:k + 3]) for k in (8, 12, 16)]
                words = []
    demand(state == 0, "no endsolid")
    return vertices, faces


def read_stl(data):
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        vertices = []
        for at in range(84, len(data), 50):
            values = struct.unpack_from("<9f", data, at + 12)
            demand(all(map(math.isfinite, values)), "a vertex that is not finite")
            vertices += [values[0:3], values[3:6], values[6:9]]
        return vertices, [[i, i + 1, i + 2] for i in range(0, len(vertices), 3)]
    if len(data) >= 84 and 0 < len(data) - 84 - 50 * struct.unpack_from("<I", data, 80)[0] < 50:
        raise Unknown("less than a triangle after the last one")
    demand(b"\0" not in data, "neither text nor as long as a binary STL file says")
    return _stl_text(data)


def _flat_and_convex(corners):
    total = [0.0, 0.0, 0.0]
    for k in range(1, len(corners) - 1):
        part = cross(sub(corners[k], corners[0]), sub(corners[k + 1], corners[0]))
        total = [a + b for a, b in zip(total, part)]
    size = max(length(sub(c, corners[0])) for c in corners)
    turns = [dot(cross(sub(b, a), sub(c, b)), total) for a, b, c in zip(corners, corners[1:] + corners[:1], corners[2:] + corners[:2])]
    return length(total) > 0 and all(t > 0 for t in turns) and all(
        abs(dot(sub(c, corners[0]), total)) <= 1e-9 * size * length(total) for c in corners)


def triangles(mesh):
    """The triangles of a mesh; polygons that can be cut into triangles in several ways are not for these readers."""
    vertices, faces = mesh
    made = []
    for face in faces:
        demand(len(face) >= 3 and all(0 <= i < len(vertices) for i in face), "an index beyond the vertices")
        corners = [vertices[i] for i in face]
        if len(face) > 3 and not _flat_and_convex(corners):
            raise Unknown("a polygon that is bent or not convex")
        made += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    demand(made, "no triangles")
    return made


readers = {".stl": read_stl, ".obj": read_obj, ".off": read_off, ".ply": ply.read_mesh}
