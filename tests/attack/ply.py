# SPDX-License-Identifier: BSD-3-Clause
"""A strict reader of PLY files: every value fits its type, every record is whole, and nothing is left over."""

import math
import struct

from strict import Unknown, demand, lines_of, number, text_of, whole, without_mark, words_of

_types = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
          "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}


def _header(data):
    """(format, elements, bytes after the header); an element is (name, count, properties), a property (name, type, count type)."""
    data = without_mark(data)
    demand(data[:3] in (b"ply", b"PLY"), "no PLY file")
    end = data.find(b"end_header")
    demand(end >= 0, "no end_header")
    lines = lines_of(data[:end])
    demand(lines[0].rstrip(" \t").lower() == "ply" and lines[-1].strip(" \t") == "", "a damaged line in the header")
    form, elements = None, []
    for line in lines[1:-1]:
        word = words_of(line)
        if not word or word[0] in ("comment", "obj_info") or word[:2] == ["Created", "by"]:  # an old Blender's
            continue
        if word[0] == "format":
            demand(form is None and len(word) == 3 and word[2] == "1.0", "a damaged format line")
            demand(word[1] in ("ascii", "binary_little_endian", "binary_big_endian"), "an unknown format")
            form = word[1]
        elif word[0] == "element":
            demand(len(word) == 3 and word[1] not in [e[0] for e in elements], "a damaged element line")
            elements.append((word[1], whole(word[2], 0, 2**63), []))
        elif word[0] == "property":
            a_list = len(word) == 5 and word[1] == "list"
            demand(elements and (a_list or len(word) == 3), "a damaged property line")
            kind, count = (word[3], word[2]) if a_list else (word[1], None)
            demand(kind in _types and (count is None or _types.get(count, "f") not in "fd"), "an unknown type")
            demand(word[-1] not in [p[0] for p in elements[-1][2]], "a property twice")
            elements[-1][2].append((word[-1], _types[kind], count and _types[count]))
        else:
            demand(False, f"{word[0]!r} is no header entry")
    demand(form, "no format")
    rest = data[end + len(b"end_header"):]
    for ending in (b"\r\n", b"\n", b"\r"):
        if rest.startswith(ending):
            return form, elements, rest[len(ending):]
    demand(not rest, "end_header is not at the end of its line")
    return form, elements, rest


def _fit(word, kind):
    if kind in "fd":
        return number(word, finite=False)
    size = 8 * struct.calcsize("<" + kind)
    return whole(word, -(2 ** (size - 1)) if kind.islower() else 0, 2 ** (size - 1) - 1 if kind.islower() else 2**size - 1)


def _ascii(elements, rest):
    lines = [words_of(line) for line in lines_of(rest)]
    lines = [line for line in lines if line]
    demand(sum(e[1] for e in elements) == len(lines), "the counts are not those of the records")
    at = 0
    for name, count, properties in elements:
        records = []
        for words in lines[at:at + count]:
            record, k = {}, 0
            for prop, kind, counted in properties:
                demand(k < len(words), "a record is too short")
                if counted:
                    n = _fit(words[k], counted)
                    demand(0 <= n <= len(words) - k - 1, "a list is longer than its line")
                    record[prop] = [_fit(w, kind) for w in words[k + 1:k + 1 + n]]
                    k += 1 + n
                else:
                    record[prop] = _fit(words[k], kind)
                    k += 1
            demand(k == len(words), "a record is too long")
            records.append(record)
        at += count
        yield name, properties, records


def _binary(elements, rest, order):
    at = 0

    def take(kind):
        nonlocal at
        size = struct.calcsize("<" + kind)
        demand(at + size <= len(rest), "cut short")
        at += size
        return struct.unpack_from(order + kind, rest, at - size)[0]

    for name, count, properties in elements:
        demand(not properties or count <= len(rest), "more records than bytes")
        records = []
        for _ in range(count if properties else 0):
            record = {}
            for prop, kind, counted in properties:
                if counted:
                    n = take(counted)
                    demand(0 <= n <= len(rest) - at, "a list is longer than the file")
                    record[prop] = [take(kind) for _ in range(n)]
                else:
                    record[prop] = take(kind)
            records.append(record)
        yield name, properties, records
    demand(at == len(rest), "bytes after the last record")


def _elements(data):
    form, elements, rest = _header(data)
    if form == "ascii" and any(count and not properties for _, count, properties in elements):
        raise Unknown("records without properties")
    read = _ascii(elements, rest) if form == "ascii" else _binary(elements, rest, "<" if "little" in form else ">")
    return {name: (properties, records) for name, properties, records in read}


def _points(elements):
    demand("vertex" in elements, "no vertices")
    properties, records = elements["vertex"]
    plain = [p[0] for p in properties if not p[2]]
    demand(all(axis in plain for axis in "xyz"), "vertices without x, y or z")
    return [(float(r["x"]), float(r["y"]), float(r["z"])) for r in records]


def read_cloud(data):
    return _points(_elements(data))


def read_mesh(data):
    """(vertices, faces)."""
    elements = _elements(data)
    vertices = _points(elements)
    demand(all(math.isfinite(c) for v in vertices for c in v), "a vertex that is not finite")
    faces = []
    for name, (properties, records) in elements.items():
        lists = [p[0] for p in properties if p[2] and p[0] in ("vertex_indices", "vertex_index")]
        if name not in ("face", "tristrips"):
            demand(not lists or not records, f"faces in the element {name[:20]!r}")
            continue
        demand(len(lists) == 1, "faces without one list of vertices")
        found = [r[lists[0]] for r in records]
        if any(isinstance(i, float) for face in found for i in face):
            raise Unknown("indices that are floats")
        faces += found if name == "face" else [face for strips in found for face in _strips(strips)]
    return vertices, faces


def _strips(indices):
    """Triangles of strips, each ended by -1; every second one is turned round."""
    demand(len(indices) >= 3, "strips of fewer than three vertices")
    strips, faces = [[]], []
    for i in indices:
        strips[-1].append(i) if i != -1 else strips.append([])
    for strip in strips:
        demand(len(strip) not in (1, 2), "a strip of one vertex or two")
        for k in range(2, len(strip)):
            a, b, c = strip[k - 2:k + 1]
            faces.append([b, a, c] if k % 2 else [a, b, c])
    return faces
