# SPDX-License-Identifier: BSD-3-Clause
"""Seeds of the fuzz targets: the undamaged files of tests/attack, the documents that tests/io damages, and packed clouds of nothing but
bytes. And dictionaries: the words of a target's seeds, and the numbers with which the attack damages."""

import pathlib
import re
import struct
import sys

tests = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(tests / "attack"))
import mutate  # noqa: E402
import seeds  # noqa: E402

_FORMS = {
    "pcd": ("pcd ascii", "pcd binary", "pcd compressed"), "ply_cloud": ("ply cloud ascii", "ply cloud binary"), "xyz": ("xyz",),
    "obj": ("obj",), "off": ("off",), "stl": ("stl ascii", "stl binary"), "ply_mesh": ("ply mesh ascii", "ply mesh binary"), "dae": ("dae",),
    "glb": ("glb",), "gltf": ("gltf",), "png": ("png",), "ist": ("ist",), "spheres_csv": ("csv",), "spheres_yaml": ("yaml",), "urdf": ("urdf",),
}
_MORE_WORDS = {  # that no seed has
    "pcd": ["COLUMNS", "binary_compressed", "VERSION .5", "TYPE I", "COUNT 2"], "ply_cloud": ["property list", "double", "obj_info", "int8", "float64"],
    "ply_mesh": ["tristrips", "property list uint8 int32", "vertex_index", "uint16", "float64"], "obj": ["vt", "vp", "-1", "1/1/1", "l", "p", "curv", "\\\\\\x0a"],
    "off": ["4OFF", "nOFF", "STOFF", "CNOFF", "BINARY"], "stl": ["\\\\x00\\\\x00\\\\xc0\\\\x7f", "endloop", "endfacet"],
    "dae": ["lookat", "skew", "instance_controller", "library_controllers", "linestrips", "ph", "h", "X_UP", "xml:base", "<!DOCTYPE", "&lt;", "]]>"],
    "gltf_json": ["byteStride", "sparse", "KHR_draco_mesh_compression", "extensionsRequired", "uri", "normalized", "5120", "5121", "5122", "5125", "VEC4"],
    "spheres_yaml": ["robot_cfg", "kinematics", "&a", "*a", "<<: *a", "!!float", "---", "- ", "? ", "|-", ">-", "%YAML 1.2", ".nan", ".inf", "!<!>"],
    "urdf": ["<!DOCTYPE", "xacro:include", "calibration", "safety_controller", "transmission", "floating", "planar", "file:///", "model://"],
}


def _documents(start):
    """Raw strings of tests/io that begin so."""
    for source in sorted((tests / "io").glob("*_test.cpp")):
        yield from (found.encode() for found in re.findall(r'R"\((.*?)\)"', source.read_text(), re.S) if found.startswith(start))


def seeds_of(target):
    cases = seeds.cases()
    made = []
    for form in _FORMS.get(target, ()):
        for case in cases[form]:
            data = case.files[case.target]
            if target == "urdf" and "m.stl" in case.files:
                data = data.replace(b"m.stl", b"given") + b"\0" + case.files["m.stl"]
            made.append(data)
    if target == "urdf":
        made += [d for d in _documents("<") if b"<robot" in d]
    if target == "dae":
        made += [d for d in _documents("<") if b"<COLLADA" in d]
    if target == "gltf_json":
        glb = cases["glb"][0]
        data = glb.files[glb.target]
        made += [data[20:20 + int.from_bytes(data[12:16], "little")], *_documents('{"asset')]
    if target == "compressed_depth":
        png = cases["png"][0]
        head = bytes(4) + struct.pack("<ff", 10100.0, -1.0)
        made += [words + b"\n" + (b"" if b"png comp" in words else head) + png.files[png.target]
                 for words in (b"16UC1; compressedDepth", b"32FC1; compressedDepth png", b"mono16; png compressed ")]
        # Of 4 x 2 pixels: a run of 2 zeros, 3 differences of 1, 2 zeros, 1 difference of 1000.
        rvl = struct.pack("<IIII", 4, 2, 0x23222218, 0xAF300000)
        made += [words + b"\n" + head + rvl for words in (b"16UC1; compressedDepth rvl", b"32FC1; compressedDepth rvl")]
    if target == "fields":  # damages of five bytes, after one that says whether the checksum fits
        places = (12, 30, 40, 50, 63, 250)
        made += [b"\1"] + [bytes([k, kind, 0, at, 1, 0]) for k in (0, 1) for kind in range(6) for at in places]
    if target.startswith("same_"):
        made += [bytes([k]) + bytes(range(k, 256, 3)) + bytes([240]) * 5 for k in (0, 1, 7, 255)]
    return sorted(set(made))


def write(target, folder):
    """Writes the seeds into a new folder, and the dictionary beside it; returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    made = seeds_of(target)
    if not made:
        raise SystemExit(f"tests/fuzz/fuzz_seeds.py knows no seeds of the target {target}")
    words = set(_MORE_WORDS.get(target, ())) | {n for n in mutate.NUMBERS if n.isascii()} | {"nan", "-nan", "inf"}
    for number, data in enumerate(made):
        (folder / f"{number:03}").write_bytes(data)
        if not target.startswith("same_") and target != "fields":
            words |= {w.decode() for w in re.findall(rb"[A-Za-z_][A-Za-z_0-9:]{1,30}", data)}
    dictionary = folder.with_suffix(".dict")
    dictionary.write_text("".join('"' + w.replace('"', '\\"') + '"\n' for w in sorted(words) if w))
    return dictionary
