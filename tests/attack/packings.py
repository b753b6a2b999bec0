# SPDX-License-Identifier: BSD-3-Clause
"""Strict readers of spheres in files: each gives {part: [(x, y, z, r), ...]}, the only part of a CSV file named "";
and the writer of .ist files, by docs/packing.md."""

import math
import re
import struct
import zlib

from strict import Unknown, demand, lines_of, number, text_of, uncommented, words_of

magic = b"\x89IST\r\n\x1a\n"


def write_ist(parts):
    """parts: {name: (spheres, gap)}."""
    body = b""
    for name, (spheres, gap) in parts.items():
        radii = struct.unpack(f"<{len(spheres)}f", struct.pack(f"<{len(spheres)}f", *(s[3] for s in spheres)))
        body += struct.pack("<I", len(name)) + name.encode() + bytes(32) + struct.pack("<d", 0.0)
        body += struct.pack("<8d", gap, gap, gap, 0.5, min(radii), max(radii), 0.0, 0.0) + struct.pack("<IQ", 0, len(spheres))
        body += b"".join(struct.pack("<4f", *s) for s in spheres)
    return with_checksum(magic + struct.pack("<IIQ", 1, len(parts), 28 + len(body)) + body + bytes(4))


def with_checksum(data):
    return data[:-4] + struct.pack("<I", zlib.crc32(data[:-4]))


def _check(spheres):
    demand(spheres, "no sphere")
    for sphere in spheres:
        single = struct.unpack("<4f", struct.pack("<4f", *(max(-3e38, min(3e38, v)) for v in sphere)))
        demand(all(map(math.isfinite, sphere)) and single[3] > 0 and max(map(abs, sphere)) < 3e38, "a sphere that is none")
    return spheres


def read_csv(data):
    lines = [words_of(uncommented(line), " \t\v\f,;") for line in lines_of(data)]
    lines = [line for line in lines if line]
    if lines and lines[0] in (["x", "y", "z", "r"], ["x", "y", "z", "radius"]):
        lines = lines[1:]
    demand(all(len(line) == 4 for line in lines), "a line of other than four numbers")
    return {"": _check([tuple(number(word) for word in line) for line in lines])}


def read_yaml(data):
    """The plain layout of the seeds alone; whatever else YAML can say is not for this reader."""
    parts, center = {}, None
    lines = [line.split(" #")[0].rstrip() for line in lines_of(data)]
    lines = [line for line in lines if line.strip() and not line.startswith("#")]
    if not lines or lines[0] != "collision_spheres:" or b"\r" in data.replace(b"\r\n", b""):
        raise Unknown("another layout")
    word = r"([-+.\w]+)"
    for line in lines[1:]:
        name = re.fullmatch(r"  ([A-Za-z_]\w*):", line)
        first = re.fullmatch(rf"    - center: \[{word}, {word}, {word}\]", line)
        radius = re.fullmatch(rf"      radius: {word}", line)
        if name and center is None:
            demand(name[1] not in parts and (not parts or list(parts.values())[-1]), "a link twice, or without spheres")
            parts[name[1]] = []
        elif first and center is None and parts:
            center = first.groups()
        elif radius and center is not None:
            list(parts.values())[-1].append(tuple(number(w) for w in (*center, radius[1])))
            center = None
        elif radius or first:
            demand(False, "a key twice, or a sphere without center or radius")
        else:
            raise Unknown("another layout")
    demand(center is None and parts, "a sphere without radius")
    return {name: _check(spheres) for name, spheres in parts.items()}


def read_ist(data):
    demand(data[:8] == magic and len(data) >= 28, "no .ist file")
    version, count, size = struct.unpack_from("<IIQ", data, 8)
    demand(version == 1 and size == len(data) and count > 0 and with_checksum(data) == data, "a damaged header or checksum")
    at, parts = 24, {}

    def take(form):
        nonlocal at
        demand(at + struct.calcsize(form) <= len(data) - 4, "cut short")
        at += struct.calcsize(form)
        return struct.unpack_from(form, data, at - struct.calcsize(form))

    for _ in range(count):
        name, = take(f"<{take('<I')[0]}s")
        demand(name not in parts, "a part twice")
        take("<32s")
        figures = take("<9d")
        demand(all(v >= 0 for v in figures), "a figure that is negative or NaN")
        stop, n = take("<IQ")
        demand(stop <= 6 and 0 < n <= len(data) // 16, "a wrong reason or count")
        spheres = [take("<4f") for _ in range(n)]
        radii = [s[3] for s in _check(spheres)]
        demand(figures[5] == min(radii) and figures[6] == max(radii), "radii other than its figures")
        parts[name] = spheres
    demand(at == len(data) - 4, "bytes after the last part")
    return {name.decode("latin-1"): spheres for name, spheres in parts.items()}


readers = {".csv": read_csv, ".yaml": read_yaml, ".yml": read_yaml, ".ist": read_ist}
