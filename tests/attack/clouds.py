# SPDX-License-Identifier: BSD-3-Clause
"""Strict readers of point clouds and depth images. A cloud is (points, viewpoint or None); coordinates may be NaN or inf."""

import re
import struct
import zlib

import ply
from strict import Unknown, demand, lines_of, number, numbers, uncommented, whole, without_mark, words_of


_thousands = re.compile(r"[-+]?\d{1,3}(,\d{3})+(\..*)?\Z", re.ASCII)


def _one_number(word):
    """May commas within a word, beside others in its line, be those of one number?"""
    word = word.strip(",")
    before, comma, after = word.partition(",")
    if "," in after:
        return bool(_thousands.match(word))
    return comma != "" and not ("." in before and "." in after)


def _fields(line):
    """Words, empty ones between commas or semicolons among them. A separator at the end separates nothing."""
    made = re.split(r"[ \t\v\f]*[,;][ \t\v\f]*|[ \t\v\f]+", line.strip(" \t\v\f"))
    return made[:-1] if made[-1] == "" else made


def read_xyz(data):
    points, usual = [], None
    for line in lines_of(data):
        line = uncommented(line)
        if line.startswith("//") or not words_of(line, " \t\v\f,;"):
            continue
        fields, chunks, seen = _fields(line), words_of(line, " \t\v\f;"), 0
        several = len([chunk for chunk in chunks if chunk.strip(",")]) > 1
        for chunk in chunks:
            demand(seen >= 3 or not several or not _one_number(chunk), f"{chunk[:20]!r} may be one number or several")
            seen += len(words_of(chunk, ","))
        demand(len(fields) >= 3 and usual in (None, len(fields)), "a point of fewer than three numbers, or of more than the others")
        usual = len(fields)
        points.append(tuple(number(word, finite=False) for word in fields[:3]))
    return points, None


def _unpack_lzf(data, size):
    out, at = bytearray(), 0
    try:
        while at < len(data):
            control = data[at]
            at += 1
            if control < 32:
                demand(at + control + 1 <= len(data), "a literal beyond the end")
                out += data[at:at + control + 1]
                at += control + 1
            else:
                count = control >> 5
                if count == 7:
                    count += data[at]
                    at += 1
                start = len(out) - ((control & 31) << 8 | data[at]) - 1
                at += 1
                demand(start >= 0, "a reference before the beginning")
                for k in range(count + 2):
                    out.append(out[start + k])
            demand(len(out) <= size, "more than the size it states")
    except IndexError:
        demand(False, "cut short")
    demand(len(out) == size, "less than the size it states")
    return bytes(out)


def read_pcd(data):
    data = without_mark(data)
    known = ("VERSION", "FIELDS", "COLUMNS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "POINTS", "VIEWPOINT", "DATA")
    header, rest, ends = {}, data, set()
    while "DATA" not in header:
        demand(rest, "no DATA")
        end = re.search(rb"\r*\n|\r", rest)
        line, rest = (rest[: end.start()], rest[end.end() :]) if end else (rest, b"")
        ends.add(end and end[0] == b"\r")
        demand(len(ends) == 1, "lines by several endings")
        words = words_of(line.decode("latin-1"))
        if not words or words[0].startswith("#"):
            continue
        key = "FIELDS" if words[0] == "COLUMNS" else words[0]
        demand(key in known and len(words) > 1 and key not in header, f"a damaged header entry {words[0][:20]!r}")
        header[key] = words[1:]
    demand(header.get("VERSION", [".7"])[0] in (".5", ".6", ".7", "0.5", "0.6", "0.7"), "an unknown version")
    for key in ("VERSION", "WIDTH", "HEIGHT", "POINTS", "DATA"):
        demand(len(header.get(key, "1")) == 1, f"{key} has more than one value")
    names = [name.lower() if name in ("X", "Y", "Z") else name for name in header.get("FIELDS", [])]
    for key in ("SIZE", "TYPE", "COUNT"):
        demand(len(header.get(key, names)) == len(names), f"{key} is not one a field")
    demand(all(names.count(axis) == 1 for axis in "xyz"), "no x, y or z")
    form = header["DATA"][0]
    demand(form in ("ascii", "binary", "binary_compressed"), "unknown DATA")
    demand(form == "ascii" or ("SIZE" in header and "TYPE" in header), "no SIZE or TYPE")
    sizes = [whole(w, 1, 8) for w in header.get("SIZE", ["4"] * len(names))]
    kinds = header.get("TYPE", ["F"] * len(names))
    counts = [whole(w) for w in header.get("COUNT", ["1"] * len(names))]
    letters = {"F": {4: "f", 8: "d"}, "I": {1: "b", 2: "h", 4: "i", 8: "q"}, "U": {1: "B", 2: "H", 4: "I", 8: "Q"}}
    demand(all(s in letters.get(k, {}) for s, k in zip(sizes, kinds)), "an unknown type")
    demand(all(counts[names.index(axis)] == 1 for axis in "xyz"), "a coordinate of several values")
    demand("WIDTH" in header or "POINTS" in header, "no WIDTH and no POINTS")
    width = whole(header.get("WIDTH", header.get("POINTS"))[0])
    height = whole(header.get("HEIGHT", ["1"])[0])
    points = whole(header.get("POINTS", [str(width * height)])[0], 0, 2**64)
    demand(width * height == points, "WIDTH times HEIGHT is not POINTS")
    view = numbers(" ".join(header["VIEWPOINT"]), 7) if "VIEWPOINT" in header else None
    if form == "ascii":
        lines = [words_of(line) for line in lines_of(rest.replace(b"\0", b" "))]
        lines = [line for line in lines if line]
        columns = [sum(counts[:names.index(axis)]) for axis in "xyz"]
        demand(len(lines) == points and all(len(line) == sum(counts) for line in lines), "records and POINTS disagree")
        return [tuple(number(line[c], finite=False) for c in columns) for line in lines], view
    record = sum(s * c for s, c in zip(sizes, counts))
    if form == "binary_compressed":
        if points == 0:
            return [], view
        demand(len(rest) >= 8, "cut short")
        packed, unpacked = struct.unpack_from("<II", rest)
        demand(packed <= len(rest) - 8 and unpacked == points * record and unpacked <= 300 * packed, "wrong sizes")
        rest = _unpack_lzf(rest[8:8 + packed], unpacked)
    demand(points * record <= len(rest), "cut short")
    made = []
    for axis in "xyz":
        at = names.index(axis)
        before, kind = sum(s * c for s, c in zip(sizes[:at], counts[:at])), letters[kinds[at]][sizes[at]]
        start, step = (before * points, sizes[at]) if form == "binary_compressed" else (before, record)
        made.append([float(struct.unpack_from("<" + kind, rest, start + i * step)[0]) for i in range(points)])
    return list(zip(*made)), view


def read_ply(data):
    return ply.read_cloud(data), None


def read_png(data):
    """(width, height, pixels) of a 16-bit grey PNG."""
    demand(data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG file")
    at, head, packed, name, states = 8, None, b"", None, []
    while name != b"IEND":
        demand(at + 12 <= len(data), "cut short")
        size, name = struct.unpack_from(">I4s", data, at)
        demand(at + 12 + size <= len(data), "cut short")
        body = data[at + 8:at + 8 + size]
        demand(zlib.crc32(name + body) == struct.unpack_from(">I", data, at + 8 + size)[0], "a wrong checksum")
        demand((name == b"IHDR") == (at == 8), "IHDR is not the first chunk, once")
        if name == b"IHDR":
            demand(size == 13, "a damaged header")
            head = struct.unpack(">IIBBBBB", body)
        elif name == b"IDAT":
            demand(name not in states or states[-1] == name, "IDAT chunks apart")
            packed += body
        elif name != b"IEND":
            demand(name.isalpha() and (name[0] & 32), f"an unknown critical chunk {name!r}")
        states.append(name)
        at += 12 + size
    width, height, depth, colour, compression, filtering, interlaced = head
    demand(depth == 16 and colour == 0 and width and height, "not 16-bit grey")
    demand(compression == 0 and filtering == 0 and interlaced < 2, "a damaged header")
    if interlaced:
        raise Unknown("an interlaced image")
    demand((2 * width + 1) * height <= 1100 * len(packed), "more pixels than the data can hold")
    unpacker = zlib.decompressobj()
    try:
        raw = unpacker.decompress(packed)
    except zlib.error:
        demand(False, "damaged deflate data")
    demand(unpacker.eof and len(raw) == (2 * width + 1) * height, "not as many bytes as pixels")
    before, pixels = bytes(2 * width), []
    for y in range(height):
        kind, line = raw[y * (2 * width + 1)], bytearray(raw[y * (2 * width + 1) + 1:(y + 1) * (2 * width + 1)])
        demand(kind < 5, "an unknown filter")
        for i in range(2 * width):
            left, up, corner = line[i - 2] if i > 1 else 0, before[i], before[i - 2] if i > 1 else 0
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda v: abs(guess - v))
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        pixels += struct.unpack(f">{width}H", line)
        before = line
    return width, height, pixels
