# SPDX-License-Identifier: BSD-3-Clause
"""Damages a case: bytes, words, lines, XML, JSON, chunks with their lengths and checksums, options. What the damage means is
not decided here, but by reading the file anew (expect.py)."""

import copy
import json
import os
import re
import struct

import packings
import writers
import urdf_words
import xml_tree
from strict import Invalid, Unknown

NUMBERS = ["", "nan", "NaN", "inf", "-inf", "0,5", "1e300", "-1e308", "1e400", "1e-300", "1e39", "-1", "0", "1", "4294967301", "4294967296",
           "18446744073709551617", "-2147483649", "2147483648", "0.3junk", "0x10", "1.5.2", "1e", "--1", "+0.25", "0.5", "1000000",
           "0." + 330 * "0" + "1", "1_0", "٣", "1 2", "0.1f", "1d0", "1.#QNAN"]
_real = re.compile(rb"(?<![\w.#])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
_uints = [0, 1, 2, 3, 7, 255, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**32 - 4]


def _spot(rng, size):
    return rng.randrange(size) if size else 0


def _range(rng, data):
    begin = _spot(rng, len(data) + 1)
    return begin, min(len(data), begin + rng.choice([1, 1, 2, 4, 12, 50, 200]))


# ---- any bytes ----

def flip(rng, data):
    at = _spot(rng, len(data))
    return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1:] if data else data


def put(rng, data):
    at = _spot(rng, len(data))
    return data[:at] + bytes([rng.choice([0, 10, 13, 32, 34, 35, 44, 45, 48, 60, 62, 92, 127, 128, 255, rng.randrange(256)])]) + data[at + 1:]


def insert(rng, data):
    at = _spot(rng, len(data) + 1)
    return data[:at] + bytes(rng.randrange(256) for _ in range(rng.choice([1, 1, 4, 16]))) + data[at:]


def delete(rng, data):
    begin, end = _range(rng, data)
    return data[:begin] + data[end:]


def double(rng, data):
    begin, end = _range(rng, data)
    return data[:end] + data[begin:end] + data[end:]


def truncate(rng, data):
    return data[:_spot(rng, len(data))]


def extend(rng, data):
    return data + rng.choice([b"\0", b"\n", b"\n\n \t\n", b"1 2 3\n", b"junk", bytes(16), data[-20:]])


def word4(rng, data):
    """Four bytes become a number that is often wrong there."""
    if len(data) < 4:
        return data
    at = rng.randrange(len(data) - 3)
    at -= rng.choice([0, at % 4])
    value = rng.choice([struct.pack("<I", rng.choice(_uints)), struct.pack("<f", rng.choice([float("nan"), float("inf"), 1e30, -0.0, 0.5, -1.0, 1e-40])),
                        struct.pack(">I", rng.choice(_uints))])
    return data[:at] + value + data[at + 4:]


BYTES = [flip, flip, put, insert, delete, double, truncate, extend]


# ---- words and lines ----

def number(rng, data):
    found = list(_real.finditer(data))
    if not found:
        return flip(rng, data)
    at = rng.choice(found)
    new = rng.choice(NUMBERS).encode() if rng.random() < 0.8 else str(round(rng.uniform(-2, 2), rng.randrange(4))).encode()
    if rng.random() < 0.1:  # the same number in other words
        new = rng.choice([b"+" + at[0].lstrip(b"+-"), at[0] + b"e0", b"0" + at[0].lstrip(b"+-")])
    return data[:at.start()] + new + data[at.end():]


def count(rng, data):
    """A whole number becomes a neighbour."""
    found = [m for m in _real.finditer(data) if m[0].isdigit()]
    if not found:
        return number(rng, data)
    at = rng.choice(found[:20] if rng.random() < 0.5 else found)
    return data[:at.start()] + str(max(0, int(at[0]) + rng.choice([-2, -1, 1, 2, 10]))).encode() + data[at.end():]


def word(rng, data):
    found = list(re.finditer(rb"\S+", data))
    if not found:
        return data
    at, other = rng.choice(found), rng.choice(found)
    new = rng.choice([b"", at[0] + b" " + at[0], other[0], at[0].swapcase(), at[0] + b"x", at[0][:-1], b"\xc3\x28", b"\x1b[2J", b"#" + at[0]])
    return data[:at.start()] + new + data[at.end():]


def line(rng, data):
    lines = data.split(b"\n")
    at, other = _spot(rng, len(lines)), _spot(rng, len(lines))
    kind = rng.randrange(6)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(at, lines[at])
    elif kind == 2:
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 3:
        lines.insert(at, rng.choice([b"", b" ", b"# a comment", b"comment x", b"\0", b"0 0 0", b"x" * 3000, b"\xef\xbb\xbf", b"# C:\\", b"usemtl a\\", b"f 1 2",
                                     b"surf 0 1 0 1 1 2 3 4", b"call x.obj", b"element more 1\nproperty list uchar int vertex_indices"]))
    elif kind == 4 and at + 1 < len(lines):
        lines[at:at + 2] = [lines[at] + b" " + lines[at + 1]]
    else:
        lines[at] = lines[at].replace(b" ", b"\n", 1) if rng.random() < 0.5 else lines[at] + rng.choice([b" 1", b" x", b"\\", b"\t", b" #x", b" # C:\\", b","])
    return b"\n".join(lines)


def endings(rng, data):
    kind = rng.randrange(5)
    if kind == 0:
        return data.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
    if kind == 1:
        return data.replace(b"\n", b"\r")
    if kind == 2:
        return b"\xef\xbb\xbf" + data
    if kind == 3:
        return data.rstrip(b"\n") + rng.choice([b"", b"\n\n", b"\r", b"\n \n\t\n"])
    return re.sub(rb"\n", lambda _: rng.choice([b"\n", b"\r\n", b"\r"]), data)


def in_header(change):
    """A change of the text before binary data alone."""
    def changed(rng, data):
        for end in (b"end_header\n", b"DATA binary\n", b"DATA binary_compressed\n"):
            at = data.find(end)
            if at >= 0:
                return change(rng, data[:at + len(end)]) + data[at + len(end):]
        return change(rng, data)
    return changed


TEXT = [number, number, number, number, count, count, word, word, line, line, line, endings]
HEADER = [in_header(change) for change in (number, count, count, word, line, endings)]


# ---- XML ----

def xml(rng, data):
    try:
        elements = [e for e in xml_tree.parse(data).walk()]
    except (Invalid, Unknown):
        return number(rng, data)
    inner = elements[1:] or elements
    element, other = rng.choice(inner), rng.choice(inner)
    whole = data[element.begin:element.end]
    head_end = element.begin + re.match(rb"<[^>]*>", whole).end()
    head = data[element.begin:head_end]
    kind = rng.randrange(10)
    if kind == 0:
        return data[:element.begin] + data[element.end:]
    if kind == 1:
        return data[:element.end] + whole + data[element.end:]
    if kind == 2:
        new = rng.choice([b"unknown", element.name.encode() + b"x", other.name.encode(), element.name.upper().encode()])
        return data[:element.begin] + re.sub(rb"(</?)" + element.name.encode() + rb"(?=[\s/>])", rb"\1" + new, whole) + data[element.end:]
    if kind == 3:
        return data[:other.end] + whole + data[other.end:]
    if kind == 4:
        return data[:element.begin] + rng.choice([b"<!-- x -->", b"<![CDATA[ x ]]>", b"<x>", b"</x>", b"<x/>", b"&lt;", b"&none;", b"<" * 3,
                                                  b"<x>" * 300 + b"</x>" * 300, b"<?x y?>"]) + data[element.begin:]
    if kind == 5:
        return re.sub(rb"(<\?xml[^>]*>)?", lambda m: (m[0] or b"") + b'<!DOCTYPE x [<!ENTITY e "0.1">]>', data, count=1).replace(
            b"0.1", b"&e;", rng.randrange(2))
    found = list(re.finditer(rb'\s([\w:]+)\s*=\s*"([^"]*)"', head))
    if not found:
        return number(rng, data)
    at = rng.choice(found)
    value = at[2]
    if at[1] == b"filename" and rng.random() < 0.3:
        value = rng.choice([b"/dev/zero", b"file:///dev/zero", b".", b"/", b"c.xyz", b"r.urdf", b"package://x/" + value, b"file://" + value, b"./" + value])
    new = rng.choice([
        b"", b" " + at[1] + b'=""', at[0] + at[0], at[0].replace(at[1], at[1] + b"x", 1), at[0].replace(at[1], at[1].upper(), 1),
        b" " + at[1] + b'="' + value + rng.choice([b" 1", b" x", b",1", b"\n", b"&#9;", b"&#27;[2J", b"&#10;", b"&amp;", b"\xff\xfe", b"\xc2\x9b", b"x" * 2000]) + b'"',
        b" " + at[1] + b'="' + b" ".join(value.split()[:-1]) + b'"', b" " + at[1] + b'="' + value.replace(b" ", b",") + b'"',
        b" " + at[1] + b'="' + b"".join(b"&#%d;" % c for c in value[:50]) + b'"', b" " + at[1] + b"='" + value + b"'", b" " + at[1] + b"=" + value,
        b" " + at[1] + b'="' + number(rng, value) + b'"' if _real.search(value) else b" " + at[1] + b'="' + word(rng, value).replace(b'"', b"") + b'"'])
    return data[:element.begin] + head[:at.start()] + new + head[at.end():] + data[head_end:]


XML = [xml, xml, xml, xml, number, number, line]


def asset(rng, data):
    """A unit or an axis of its own for a part of a COLLADA file."""
    found = list(re.finditer(rb"<(library_geometries|geometry|source|library_visual_scenes|visual_scene|node)\b[^>/]*>", data))
    if not found:
        return number(rng, data)
    stated = rng.choice([b'<unit meter="10"/>', b'<unit meter="0.01"/>', b"<unit/>", b'<unit meter="0"/>', b"<up_axis>Y_UP</up_axis>", b"<up_axis>Z_UP</up_axis>", b""])
    at = rng.choice(found).end()
    return data[:at] + b"<asset>" + stated + b"</asset>" + data[at:]


# ---- binary glTF ----

def _change_json(rng, top):
    """One value somewhere in a JSON tree."""
    spots = []
    pending = [top]
    while pending:
        at = pending.pop()
        for key in (at if isinstance(at, dict) else range(len(at))):
            spots.append((at, key))
            if isinstance(at[key], (dict, list)):
                pending.append(at[key])
    at, key = rng.choice(spots)
    value = at[key]
    kind = rng.randrange(8)
    if kind == 0:
        del at[key]
    elif kind == 1 and isinstance(at, dict):
        at[str(key) + "x"] = at.pop(key)
    elif kind == 2 and isinstance(at, list):
        at.insert(key, copy.deepcopy(value))
    elif kind == 3:
        at[key] = rng.choice([None, True, "x", "", [], {}, [value], {"x": value}, str(value)])
    elif kind == 4:
        other, where = rng.choice(spots)
        at[key] = copy.deepcopy(other[where]) if where in (other if isinstance(other, dict) else range(len(other))) else 0
    elif kind == 5:
        for _ in range(rng.choice([5, 60, 400])):
            at[key] = [at[key]]
    else:
        at[key] = rng.choice([0, 1, 2, 3, -1, 4, 255, 65536, 2**31, 2**32 + 5, 2**32 - 1, 2**53, 1e30, 0.5, 1.5, -0.25, 5126, 5125, 5121, "SCALAR"])


def glb_json(rng, data):
    try:
        size = struct.unpack_from("<I", data, 12)[0]
        top = json.loads(data[20:20 + size])
        _change_json(rng, top)
        text = json.dumps(top).encode()
    except (ValueError, IndexError, TypeError, struct.error, UnicodeDecodeError):
        return flip(rng, data)
    if rng.random() < 0.1:  # a key twice, or a word that JSON does not have
        text = rng.choice([text.replace(b"}", b', "count": 3}', 1), text.replace(b"0", b"NaN", 1), text.replace(b"0", b"00", 1), text + b"}", text[:-3]])
    return writers.pack_glb(text, data[28 + size:])


def gltf_text(rng, data):
    return glb_json(rng, writers.pack_glb(data, b""))[20:-8]


def glb_chunk(rng, data):
    """The lengths and kinds of chunks."""
    at = rng.choice([4, 8, 12, 16, 20 + struct.unpack_from("<I", data, 12)[0] if len(data) > 20 else 4])
    if at + 4 > len(data):
        return truncate(rng, data)
    old = struct.unpack_from("<I", data, at)[0]
    return data[:at] + struct.pack("<I", rng.choice([*_uints, old + 4, max(0, old - 4), old ^ 1])) + data[at + 4:]


GLB = [glb_json, glb_json, glb_json, glb_json, glb_chunk, word4]


# ---- what has a checksum ----

def png(rng, data):
    """One chunk, with its checksum made right again."""
    chunks, at = [], 8
    while at + 12 <= len(data):
        size = struct.unpack_from(">I", data, at)[0]
        chunks.append([data[at + 4:at + 8], data[at + 8:at + 8 + size]])
        at += 12 + size
    if not chunks:
        return flip(rng, data)
    k = rng.randrange(len(chunks))
    kind = rng.randrange(6)
    if kind == 0:
        del chunks[k]
    elif kind == 1:
        chunks.insert(rng.randrange(len(chunks)), chunks[k])
    elif kind == 2:
        chunks.insert(k, [rng.choice([b"tEXt", b"PLTE", b"tRNS", b"CgBI", b"xxXx", b"XXXX", b"gAMA"]), rng.choice([b"", b"\0\0\0\1", b"a\0b"])])
    else:
        chunks[k][1] = rng.choice([flip, word4, truncate, put, double])(rng, chunks[k][1]) if chunks[k][1] else b"x"
    return data[:8] + b"".join(writers.png_chunk(*chunk) for chunk in chunks)


def ist(rng, data):
    changed = rng.choice([flip, word4, word4, delete, double])(rng, data[:-4]) + bytes(4)
    if len(changed) > 28:
        changed = changed[:16] + struct.pack("<Q", len(changed)) + changed[24:]
    return packings.with_checksum(changed)


STL = [word4, word4, word4]
KINDS = {
    "urdf": XML * 3 + [urdf_words.damage] * 12 + BYTES, "dae": (XML + [asset]) * 3 + BYTES, "glb": GLB * 2 + BYTES, "gltf": [gltf_text] * 8 + BYTES, "png": [png] * 16 + BYTES, "ist": [ist] * 8 + BYTES,
    "stl binary": STL * 3 + BYTES, "ply mesh binary": HEADER + STL + BYTES, "ply cloud binary": HEADER + STL + BYTES,
    "pcd binary": HEADER + STL + BYTES, "pcd compressed": HEADER + STL + BYTES, "pack": TEXT + STL,
}


# ---- options ----

_read = ("--robot", "--cloud", "--frames", "--trajectory", "--packing", "--configurations", "--plan")  # only these may name what is outside of the scratch folder


def options(rng, case):
    """One option: its value, its name, its place, or one more."""
    given = case.options
    k = rng.randrange(len(given))
    name, value = given[k]
    kind = rng.randrange(9)
    if kind <= 3 and value is not None:
        words = value.split(",")
        if kind == 0:
            given[k][1] = ""
        elif kind == 1:
            words[rng.randrange(len(words))] = rng.choice(NUMBERS)
            given[k][1] = ",".join(words)
        elif kind == 2:
            given[k][1] = rng.choice([value + ",1", ",".join(words[:-1]) or ",", value + ",", "," + value, " " + value, value + " ", value + "x", value.upper(),
                                      value.replace(",", ";"), value[:-1], "=", "a=", "=1", "a=b=c", ".", "x" * 5000, "\x1b[2J", "\udcff", "é", "-", "--",
                                      "-1,0,0,0,0,0,1", *(["/", "..", "/dev/null", "/dev/zero"] if name in _read else [])])
        else:
            given[k][1] = str(round(rng.uniform(-1, 2), 2)) if len(words) == 1 else ",".join([str(round(rng.uniform(-1, 1), 2)), *words[1:]])
    elif kind == 4:
        given.insert(rng.randrange(len(given) + 1), list(given[k]))
    elif kind == 5:
        del given[k]
    elif kind == 6:
        given[k][0] = rng.choice([name[:-1], name + "x", name.upper(), "-" + name, name.lstrip("-"), "--unknown"]) if name else "--unknown"
    elif kind == 7:
        other = rng.randrange(len(given))
        given[k], given[other] = given[other], given[k]
    else:
        given.insert(rng.randrange(len(given) + 1), rng.choice([
            ["--check", ""], ["--base-pose", ""], ["--joints", ""], ["--camera-link", ""], ["--packing", ""], ["--scene", ""], ["--range", ""], ["--model", ""],
            ["--volume", ""], ["--exclude-link", ""], ["--package", ""], ["--joint", ""], ["--cache", ""], ["--geometry", ""], ["--spheres", ""],
            ["--backend", ""], ["--mesh-limit", ""], ["--mesh-limit", "nodes=5"], ["--unfold-limit", ""], ["--check", "nan"], ["--range", "1,1"], ["--range", "0,inf"], ["--joint", "turn=0.5"], ["--joint", "slide=0.5"],
            ["--package", "x=."], ["--cloud", "d.xyz"], ["--ignore-limits", None], ["--zero-is-missing", None], ["--use-viewpoint", None], ["--strict", None],
            ["--exclude-link", "b"], ["--zones", ""], ["--zones", "0.2,0.1"], ["--zones", "0.1,0.2"], ["--min-points", ""], ["--min-points", "0"], ["--distances", ""],
            ["--distances", "p.ply"], ["--distances", "p.xyz"], ["--d-max", ""], ["--d-max", "-1"], ["--d-max", "0.2"], ["--plan", ""], ["--plan", "t.csv"],
            ["--configurations", ""], ["--csv", None], ["--check", "-1"], ["--check", "1e300"], ["--spheres", "4294967297"],
            ["--self-filter", ""], ["--self-filter", "0.02"], ["--self-filter", "nan"], ["--self-filter", "-1"], ["--self-filter", "1e15"], ["--min-support", ""],
            ["--min-support", "3@0.1"], ["--min-support", "3@"], ["--min-support", "1@0.1"], ["--min-support", "2@nan"], ["--gradient", None],
            ["--deadline", ""], ["--deadline", "0"], ["--deadline", "1e9"], ["--deadline", "-1"], ["--deadline", "nan"], ["--deadline", "1e300"], ["--attach", ""],
            ["--attach", "a=m.obj"], ["--attach", "b=c.xyz"], ["--attach", "x=m.obj"], ["--attach-pose", "0,0,1,0,0,0,1"], ["--attach-pose", "0,0,1,0,0,0,2"],
            ["--svg", ""], ["--svg", "o.svg"], ["--svg", "c.xyz"], ["--svg", "r.urdf.svg"],
            ["--min-support", "9999999@1e15"], ["--min-support", "4@0.5"], ["--support-limit", ""], ["--support-limit", "1"], ["--support-limit", "1048577"],
            ["--nearest", ""], ["--nearest", "3"], ["--nearest", "1048576"], ["--nearest", "1048577"], ["--threads", ""], ["--threads", "0"], ["--threads", "2"],
            ["--threads", "1e3"], ["--threads", "1024"], ["--threads", "1025"], ["--between", None]]))


def folder(rng, case):
    """One file more or less among frames, or what is none."""
    held = sorted(name for name in case.files if name.startswith(case.target))
    name = case.target + rng.choice(["0a.xyz", "1b.pcd", "9.txt", "a.png", "A.PLY", "b.md", "c"])
    kind = rng.randrange(5)
    if kind == 0:
        del case.files[rng.choice(held)]
    elif kind == 1:
        case.files[name] = case.files[rng.choice(held)]
    elif kind == 2:
        at = rng.choice(held)
        case.links[at] = rng.choice(["nothing.xyz", "", None, ".", "..", os.path.basename(at)])
        del case.files[at]
    elif name not in case.files:
        case.links[name] = rng.choice(["nothing.xyz", "", None, ".", os.path.basename(rng.choice(held))])


def mutated(rng, case):
    """A damaged copy of a case."""
    made = copy.copy(case)
    made.options, made.files, made.links = copy.deepcopy(case.options), dict(case.files), dict(case.links)
    for _ in range(1 if made.target.endswith("/") else rng.choice([1, 1, 1, 1, 2, 3])):
        if made.target.endswith("/"):
            folder(rng, made)
        elif made.target == "options":
            if made.options:
                options(rng, made)
        else:
            kinds = KINDS.get(made.format, TEXT * 2 + BYTES)
            made.files[made.target] = rng.choice(kinds)(rng, made.files[made.target])
            made.believes = made.believes and made.format != "ist"
    return made
