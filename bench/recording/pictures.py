# SPDX-License-Identifier: BSD-3-Clause
"""Draws triangles and points by a plain z-buffer into a PNG, and reads binary glTF. Needs nothing but Python."""

import array
import json
import math
import struct
import zlib

up = (0, 0, 1)


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a)) or 1.0
    return (a[0] / length, a[1] / length, a[2] / length)


def times(a, b):
    """Product of two 4x4 matrices, column by column as glTF has them."""
    return [sum(a[k * 4 + r] * b[c * 4 + k] for k in range(4)) for c in range(4) for r in range(4)]


def glb(file):
    """Yields (mode, positions in world coordinates with z up, indices, colour, name of the node, its matrix as glTF has it)
    for each primitive of a binary glTF file."""
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    binary = data[20 + length + 8 :]

    def values(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        count = accessor["count"] * {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        kind = {5121: "B", 5123: "H", 5125: "I", 5126: "f"}[accessor["componentType"]]
        return struct.unpack_from(f"<{count}{kind}", binary, view.get("byteOffset", 0) + accessor.get("byteOffset", 0))

    def walk(number, above):
        node = document["nodes"][number]
        here = times(above, node["matrix"]) if "matrix" in node else above
        if "mesh" in node:
            for part in document["meshes"][node["mesh"]]["primitives"]:
                flat = values(part["attributes"]["POSITION"])
                m = here
                points = []
                for i in range(0, len(flat), 3):
                    x, y, z = flat[i : i + 3]
                    p = [m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r] for r in range(3)]
                    points.append((p[0], -p[2], p[1]))  # glTF's y is up
                indices = values(part["indices"]) if "indices" in part else range(len(points))
                paint = document["materials"][part["material"]]["pbrMetallicRoughness"].get("baseColorFactor", [0.7, 0.7, 0.7, 1])
                yield part.get("mode", 4), points, indices, paint, node.get("name", ""), here
        for child in node.get("children", []):
            yield from walk(child, here)

    identity = [1.0 if i % 5 == 0 else 0.0 for i in range(16)]
    for top in document["scenes"][document.get("scene", 0)]["nodes"]:
        yield from walk(top, identity)


class Canvas:
    """`w` x `h` pixels, seen from `eye` towards `target` by a lens of `view_degrees`."""

    def __init__(self, w, h, eye, target, view_degrees):
        self.w, self.h, self.eye = w, h, eye
        self.depth = array.array("d", [math.inf]) * (w * h)
        self.paint = bytearray(b"\xff" * (3 * w * h))
        forward = unit(sub(target, eye))
        right = unit(cross(forward, up))
        self.axes = right, cross(right, forward), forward
        self.focal = h / 2 / math.tan(math.radians(view_degrees / 2))

    def project(self, p):
        d = sub(p, self.eye)
        z = dot(d, self.axes[2])
        if z < 0.05:
            return None
        return self.w / 2 + self.focal * dot(d, self.axes[0]) / z, self.h / 2 - self.focal * dot(d, self.axes[1]) / z, z

    def put(self, x, y, z, colour):
        i = y * self.w + x
        if z < self.depth[i]:
            self.depth[i] = z
            self.paint[3 * i : 3 * i + 3] = colour

    def dot(self, p, colour, size, nearer=0.0):
        at = self.project(p)
        if at is None:
            return
        x0, y0, z = int(at[0] - size / 2), int(at[1] - size / 2), at[2] - nearer
        for y in range(max(y0, 0), min(y0 + size, self.h)):
            for x in range(max(x0, 0), min(x0 + size, self.w)):
                self.put(x, y, z, colour)

    def triangle(self, corners, colour):
        a, b, c = (self.project(p) for p in corners)
        if a is None or b is None or c is None:
            return
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(area) < 1e-9:
            return
        for y in range(max(math.ceil(min(a[1], b[1], c[1])), 0), min(math.floor(max(a[1], b[1], c[1])) + 1, self.h)):
            for x in range(max(math.ceil(min(a[0], b[0], c[0])), 0), min(math.floor(max(a[0], b[0], c[0])) + 1, self.w)):
                v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
                w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
                if v >= 0 and w >= 0 and v + w <= 1:
                    self.put(x, y, a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2]), colour)

    def save(self, file, samples):
        save_png(file, self.w, self.h, self.paint, samples)


def save_png(file, width, height, paint, samples):
    """Averages squares of `samples` x `samples` pixels of bytes r,g,b."""
    w, h, above = width // samples, height // samples, bytearray(3 * (width // samples))
    plain, filtered = bytearray(), bytearray()  # which is smaller depends on the picture
    for y in range(h):
        row = bytearray()
        for x in range(w):
            for k in range(3):
                total = 0
                for dy in range(samples):
                    at = 3 * ((y * samples + dy) * width + x * samples) + k
                    for dx in range(samples):
                        total += paint[at + 3 * dx]
                row.append(total // samples**2)
        left = bytes(3) + row[:-3]
        # Of PNG's filters 0, 1, 2 and 3, the one with the smallest numbers usually compresses best.
        filters = (row, [(a - b) & 255 for a, b in zip(row, left)], [(a - b) & 255 for a, b in zip(row, above)],
                   [(a - (b + c) // 2) & 255 for a, b, c in zip(row, left, above)])
        kind = min(range(4), key=lambda f: sum(min(v, 256 - v) for v in filters[f]))
        plain += bytes(1) + row
        filtered += bytes([kind]) + bytes(filters[kind])
        above = row
    packed = min((zlib.compress(bytes(rows), 9) for rows in (plain, filtered)), key=len)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", w, h, 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def shade(paint, light):
    return bytes(min(255, int(255 * math.pow(max(0.0, c * light), 1 / 1.4))) for c in paint[:3])
