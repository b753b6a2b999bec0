# SPDX-License-Identifier: BSD-3-Clause
"""The undamaged cases: small robots before small clouds, in every format, whose answer expect.py knows."""

import os
import pathlib
import re

import packings
import writers as w
from expect import Case

_near = [(0.31, 0.29, 0.56), (1, 0, 0.25), (0.75, 0.5, -0.25), (-0.5, 1, 0.5), (0.625, 0.625, 0.75), (-1, -0.375, 0), (0.125, 0.875, 1),
         (0, -0.75, -1), (2, 1.5, 0.5), (1.25, -0.5, 0.25)]
_inside = _near[:6] + [(0.3, 0.32, 0.31)] + _near[6:]
_clouds = {"near": _near, "inside": _inside}


def _urdf(links, joints=""):
    return f'<?xml version="1.0"?>\n<robot name="r">\n{links}{joints}</robot>\n'.encode()


def _link(name, shape, origin="", more=""):
    return f'<link name="{name}"><collision>{origin}<geometry>{shape}</geometry></collision>{more}</link>\n'


def _joint(name, kind, parent, child, xyz, more="", rpy="0 0 0"):
    limit = '<limit lower="-3" upper="3" effort="1" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/>{limit}{more}</joint>\n')


_small = '<box size="0.1 0.1 0.1"/>'
_large = '<box size="0.2 0.3 0.4"/>'
_fixed = _joint("j", "fixed", "a", "b", "0.3 0.3 0.3")
_two_boxes = _urdf(_link("a", _small) + _link("b", _large), _fixed)
_slider = '<axis xyz="1 0 0"/>'
_arm = _urdf(_link("a", _small) + _link("b", _large) + _link("c", '<box size="0.1 0.2 0.1"/>'),
             _joint("turn", "revolute", "a", "b", "0.3 0.3 0.3", '<axis xyz="0 0 1"/>')
             + _joint("slide", "prismatic", "b", "c", "0 0 0.3", _slider))


def _query(form, files, target, *options, robot="r.urdf", cloud="c.xyz", **more):
    given = [["--robot", robot], *options, ["--cloud", cloud], ["--model", "triangles"], ["--json", None]]
    return Case(form, "query", given, files, target, **more)


def _robots():
    inertial = '<inertial><mass value="1"/><origin xyz="0 0 0.1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    visual = '<visual><origin xyz="0 0 0.5"/><geometry><box size="0.05 0.05 0.05"/></geometry><material name="m"><color rgba="1 0 0 1"/></material></visual>'
    at = '<origin xyz="0.01 0.02 0.03" rpy="0.1 0.2 0.3"/>'
    second = f'<collision><geometry>{_large}</geometry></collision>'
    yield _two_boxes
    yield _urdf(_link("a", _small, at, inertial + visual) + _link("b", '<box size="0.02 0.02 0.02"/>', '<origin xyz="1 1 1"/>', second), _fixed)
    yield _urdf(_link("a", '<sphere radius="0.05"/>') + _link("b", '<cylinder radius="0.15" length="0.4"/>', at), _fixed)
    yield _arm
    follow = '<axis xyz="0 1 0"/><mimic joint="turn" multiplier="0.5" offset="0.1"/><dynamics damping="1" friction="0"/>'
    yield _urdf(_link("a", _small) + '<link name="mid"/>\n' + _link("b", _large, "", visual),
                _joint("turn", "continuous", "a", "mid", "0.1 0.1 0.1", '<axis xyz="0 0 1"/>') + _joint("bow", "revolute", "mid", "b", "0.2 0.2 0.2", follow))
    yield _urdf(_link("a", _small) + '<link name="b"><visual><geometry>' + _large + "</geometry></visual></link>\n", _fixed)
    yield _urdf(_link("a", _small) + _link("b", '<capsule radius="0.1" length="0.3"/>'), _fixed)
    yield _urdf(_link("a", _small) + _link("b", '<mesh filename="m.stl" scale="1 1.5 2"/>', at), _fixed)


def _robot_cases():
    for robot in _robots():
        for cloud in _clouds.values():
            files = {"r.urdf": robot, "c.xyz": w.xyz(cloud)}
            if b"m.stl" in robot:
                files["m.stl"] = w.stl_binary(w.halved(w.box(0.2, 0.2, 0.2)))
            yield _query("urdf", files, "r.urdf")
            if cloud is _near:
                text = _query("urdf", files, "r.urdf")
                text.options = [o for o in text.options if o[0] != "--json"]
                yield text
    for cloud in _clouds.values():
        yield _query("urdf", {"r.urdf": _arm, "c.xyz": w.xyz(cloud)}, "r.urdf", ["--joints", "0.5,0.25"], ["--geometry", "visual"])


def _mesh_cases():
    quads = w.box(0.2, 0.3, 0.4)
    mesh = w.halved(quads)
    made = [("stl ascii", "m.stl", w.stl_text(mesh)), ("stl binary", "m.stl", w.stl_binary(mesh)), ("obj", "m.obj", w.obj(mesh)),
            ("obj", "m.obj", w.obj(quads)), ("off", "m.off", w.off(mesh)), ("off", "m.off", w.off(quads)),
            ("off", "m.off", w.off(mesh, "COFF", (255, 0, 7, 255), (0.5, 0, 1))), ("off", "m.off", w.off(quads, "NOFF", (0, 0, 1), (3,))),
            ("ply mesh ascii", "m.ply", w.ply_mesh(quads)), ("ply mesh binary", "m.ply", w.ply_mesh(mesh, "binary_little_endian")),
            ("ply mesh binary", "m.ply", w.ply_mesh(mesh, "binary_big_endian")), ("dae", "m.dae", w.dae(mesh)), ("glb", "m.glb", w.glb(mesh)),
            ("gltf", "m.gltf", w.gltf(mesh)),
            ("ply mesh ascii", "m.ply", w.ply_strips()), ("ply mesh binary", "m.ply", w.ply_strips("binary_little_endian"))]
    mark, assets = b"\xef\xbb\xbf", b'<asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>'
    named = w.obj(quads).replace(b"vn 0 0 1", b"# from C:\\\nusemtl a\\\nvn 0 \\\n0 1\nf 1 2", 1)
    made += [("obj", "m.obj", named), ("obj", "m.obj", mark + w.obj(mesh)), ("off", "m.off", mark + w.off(mesh)), ("stl ascii", "m.stl", mark + w.stl_text(mesh)),
             ("ply mesh ascii", "m.ply", mark + w.ply_mesh(mesh)), ("dae", "m.dae", mark + w.dae(mesh)),
             ("dae", "m.dae", re.sub(rb'(<library_geometries>|<geometry [^>]*>|<visual_scene [^>]*>|<node [^>]*>)', rb"\1" + assets, w.dae(mesh)))]
    for form, name, data in made:
        robot = _urdf(_link("a", _small) + _link("b", f'<mesh filename="{name}"/>'), _fixed)
        for cloud in _clouds.values():
            yield _query(form, {"r.urdf": robot, "c.xyz": w.xyz(cloud), name: data}, name)
        if form in ("stl binary", "obj", "off"):
            yield Case("pack", "pack", [["", name], ["--spheres", "5"], ["--no-cache", None], ["--out", "o.ist"], ["--json", None]], {name: data},
                       name, outputs=["o.ist"])


def _cloud_cases():
    little, big = "binary_little_endian", "binary_big_endian"
    for cloud in _clouds.values():
        made = [("xyz", "c.xyz", w.xyz(cloud)), ("xyz", "c.txt", b"# points\n" + w.xyz(cloud).replace(b" ", b",")),
                ("ply cloud ascii", "c.ply", w.ply_cloud(cloud)), ("ply cloud ascii", "c.ply", w.ply_cloud(cloud, kind="double")),
                ("ply cloud binary", "c.ply", w.ply_cloud(cloud, little)), ("ply cloud binary", "c.ply", w.ply_cloud(cloud, big, "double")),
                ("pcd ascii", "c.pcd", w.pcd(cloud)), ("pcd binary", "c.pcd", w.pcd(cloud, "binary")),
                ("pcd binary", "c.pcd", w.pcd(cloud, "binary", "d")), ("pcd compressed", "c.pcd", w.pcd(cloud, "binary_compressed")),
                ("xyz", "c.xyz", w.xyz(cloud).replace(b" ", b", ").replace(b"\n", b", 7\n")), ("xyz", "c.txt", b"//X Y Z\n" + w.xyz(cloud).replace(b" ", b";")),
                ("pcd ascii", "c.pcd", w.pcd(cloud).replace(b"x y z", b"X Y Z")), ("pcd binary", "c.pcd", w.pcd(cloud, "binary") + bytes(3000) + b"\n"),
                ("pcd ascii", "c.pcd", b"\xef\xbb\xbf" + w.pcd(cloud)), ("ply cloud ascii", "c.ply", b"\xef\xbb\xbf" + w.ply_cloud(cloud))]
        for form, name, data in made:
            yield _query(form, {"r.urdf": _two_boxes, name: data}, name, cloud=name)
        far = [(500000.0 + 0.001 * i, 5000000.0, 3.0) for i in range(12)] + cloud
        yield _query("far", {"r.urdf": _two_boxes, "c.xyz": w.xyz([tuple(map(float, p)) for p in far])}, "c.xyz")
    view = w.pcd([(x - 1, y, z) for x, y, z in _near], view="1 0 0 1 0 0 0")
    yield _query("pcd ascii", {"r.urdf": _two_boxes, "c.pcd": view}, "c.pcd", ["--use-viewpoint", None], cloud="c.pcd")
    for depth in (600, 330):  # before the box, and in it
        pixels = [1200 + 7 * (i * 37 % 50) for i in range(8 * 6)]
        pixels[0], pixels[9], pixels[27], pixels[28] = 0, 65535, depth, depth + 20
        camera = ["--intrinsics", "10,10,3.5,2.5"], ["--camera-pose", "0.3,0.3,0,0,0,0,1"]
        yield _query("png", {"r.urdf": _two_boxes, "c.png": w.png(8, 6, pixels)}, "c.png", *camera, cloud="c.png")


def _packing_cases():
    parts = {"a": [(0, 0, 0, 0.05)], "b": [(0, 0, 0.1, 0.1), (0, 0, -0.1, 0.1), (0, 0.1, 0, 0.05)]}
    made = [("yaml", "p.yaml", w.yaml_spheres(parts)), ("csv", "p.csv", w.csv_spheres(parts["b"])),
            ("ist", "p.ist", packings.write_ist({name: (spheres, 0.2) for name, spheres in parts.items()}))]
    for form, name, data in made:
        yield Case(form, "info", [["", name], ["--json", None]], {name: data}, name)
        robot = _urdf(_link("b", _large)) if form == "csv" else _two_boxes
        case = _query(form, {"r.urdf": robot, "c.xyz": w.xyz([(x + 0.4, y, z) for x, y, z in _near]), name: data}, name, ["--packing", name])
        case.options = [["--model", "spheres"] if o[0] == "--model" else o for o in case.options] + [["--no-cache", None]]
        yield case


def _recording_cases():
    frames = {f"{k}.xyz": w.xyz(cloud) for k, cloud in enumerate((_near, _inside, _near[1:]))}
    rows = b"turn,slide\n0,0\n0.25,0.5\n-0.5,-0.25\n"
    for target in ("t.csv", "frames.txt"):
        for more in ([], [["--merge", None], ["--camera-link", "a"]], [["--check", "0.01"]]):
            files = {"r.urdf": _arm, "t.csv": rows, "frames.txt": b"0.xyz\n1.xyz\n2.xyz\n", **frames}
            yield Case("recording", "run", [["--robot", "r.urdf"], ["--frames", "frames.txt"], ["--trajectory", "t.csv"], ["--model", "triangles"],
                                            *more], files, target)
    folder = {"r.urdf": _arm, "t.csv": rows, **{"f/" + name: data for name, data in frames.items()}}
    for more in ([], [["--merge", None]], [["--csv", None]]):
        yield Case("recording", "run", [["--robot", "r.urdf"], ["--frames", "f"], ["--trajectory", "t.csv"], ["--model", "triangles"], *more], folder, "f/")


def _plan_cases():
    rows = b"turn,slide\n0,0\n0.25,0.5\n-0.5,-0.25\n"
    files = {"r.urdf": _arm, "q.csv": rows, "t.csv": b"turn,slide\n0,0\n", "frames.txt": b"c.xyz\nd.xyz\n", "c.xyz": w.xyz(_near), "d.xyz": w.xyz(_inside)}
    for cloud in ("c.xyz", "d.xyz"):
        for more in ([], [["--check", "0.01"], ["--d-max", "0.3"]], [["--camera-link", "b"]], [["--csv", None]]):
            yield Case("plan", "plan", [["--robot", "r.urdf"], ["--configurations", "q.csv"], *more, ["--cloud", cloud], ["--model", "triangles"]], files, "q.csv")
    for more in ([], [["--merge", None]], [["--check", "0.01"]], [["--csv", None]]):
        yield Case("plan", "run", [["--robot", "r.urdf"], ["--frames", "frames.txt"], ["--trajectory", "t.csv"], ["--plan", "q.csv"], ["--model", "triangles"],
                                   *more], files, "q.csv")


def _option_cases():
    files = {"r.urdf": _arm, "c.xyz": w.xyz(_near), "d.xyz": w.xyz(_inside), "m.obj": w.obj(w.box(0.2, 0.3, 0.4))}
    for cloud in ("c.xyz", "d.xyz"):
        yield _query("options", files, "options", ["--joints", "0.25,0.5"], ["--check", "0.02"], ["--base-pose", "0.05,0,0,0,0,0,1"], cloud=cloud)
        yield _query("options", files, "options", ["--joint", "turn=0.25"], ["--range", "0,10"], ["--camera-link", "a"],
                     ["--camera-pose", "0,0,0,0,0,0.6,0.8"], ["--geometry", "collision"], ["--volume", "aabb"], ["--exclude-link", "c"], cloud=cloud)
    pixels = [1000] * 48
    image = dict(files, **{"c.png": w.png(8, 6, pixels)})
    yield _query("options", image, "options", ["--intrinsics", "10,10,3.5,2.5"], ["--depth-scale", "0.001"], ["--range", "0.1,2"],
                 ["--camera-pose", "0.3,0.3,-0.5,0,0,0,1"], ["--backend", "host"], ["--mesh-limit", "triangles=1000"], ["--unfold-limit", "5"],
                 cloud="c.png")
    for cloud in ("c.xyz", "d.xyz"):
        yield _query("options", files, "options", ["--joints", "0.25,0.5"], ["--zones", "0.05,0.2,0.6"], ["--min-points", "2"], ["--distances", "o.ply"],
                     ["--d-max", "0.5"], ["--scene", "o.glb"], cloud=cloud, outputs=["o.ply", "o.glb"])
        yield _query("options", files, "options", ["--joints", "0.25,0.5"], ["--min-support", "3@0.5"], ["--support-limit", "100"], ["--gradient", None], ["--nearest", "7"],
                     ["--threads", "2"], ["--check", "0.02"], cloud=cloud)
        yield _query("options", files, "options", ["--joints", "0.25,0.5"], ["--deadline", "1000"], ["--check", "0.02"], cloud=cloud)
        yield _query("options", files, "options", ["--joints", "0.25,0.5"], ["--self-filter", "0.05"], ["--attach", "c=m.obj"],
                     ["--attach-pose", "0,0,0.2,0,0,0,1"], ["--gradient", None], cloud=cloud)
        yield Case("options", "plan", [["--robot", "r.urdf"], ["--configurations", "q.csv"], ["--joint", "slide=0.5"], ["--check", "0.02"], ["--d-max", "0.5"],
                                       ["--camera-link", "b"], ["--cloud", cloud], ["--model", "triangles"]], dict(files, **{"q.csv": b"turn\n0\n0.5\n"}), "options")
    recorded = dict(files, **{"t.csv": b"turn\n0\n", "frames.txt": b"c.xyz\nd.xyz\n"})
    yield Case("options", "run", [["--robot", "r.urdf"], ["--frames", "frames.txt"], ["--trajectory", "t.csv"], ["--model", "triangles"],
                                  ["--joint", "slide=0.5"], ["--check", "0"], ["--base-pose", "0.05,0,0,0,0,0,1"], ["--camera-link", "b"], ["--plan", "t.csv"], ["--svg", "o.svg"]], recorded, "options", outputs=["o.svg"])
    yield Case("options", "pack", [["", "m.obj"], ["--spheres", "5"], ["--no-cache", None], ["--gap", "0.05"], ["--smallest-radius", "0.001"],
                                   ["--seconds", "5"], ["--seed", "7"], ["--out", "o.csv"], ["--json", None]], files, "options", outputs=["o.csv"])
    yield Case("options", "demo", [["--spheres", "3"], ["--no-cache", None]], {}, "options", cpu=60)


def _file_cases():
    """Written files: whole, and never an input; also where the disk is full after some bytes."""
    files = {"r.urdf": _arm, "c.xyz": w.xyz(_near), "m.obj": w.obj(w.box(0.2, 0.3, 0.4))}
    for limit in (0, 100, 1024, 4096):
        for old in ({}, {"o.glb": b"an older file", "o.ist": b"an older file"}):
            case = _query("written files", dict(files, **{k: v for k, v in old.items() if k == "o.glb"}), "r.urdf", ["--scene", "o.glb"],
                          outputs=["o.glb"], file_limit=limit)
            yield case
            if not old:
                yield _query("written files", files, "r.urdf", ["--distances", "o.ply"], outputs=["o.ply"], file_limit=limit)
            yield Case("written files", "pack", [["", "m.obj"], ["--spheres", "20"], ["--no-cache", None], ["--out", "o.ist"], ["--json", None]],
                       dict(files, **{k: v for k, v in old.items() if k == "o.ist"}), "m.obj", outputs=["o.ist"], file_limit=limit)
    for target in ("c.xyz", "r.urdf"):
        yield _query("written files", files, "c.xyz", ["--scene", target])
        yield _query("written files", dict(files, **{"c.ply": w.ply_cloud(_near)}), "c.ply", ["--distances", "c.ply"], cloud="c.ply")


def _data_cases(folder):
    """Small files of real tools, where they are."""
    endings = {".stl": "stl", ".obj": "obj", ".off": "off", ".ply": "ply mesh", ".dae": "dae", ".glb": "glb", ".gltf": "gltf", ".pcd": "pcd"}
    for file in sorted(pathlib.Path(folder).glob("*/*/*")):
        ending = file.suffix.lower()
        if ending not in endings or not file.is_file() or file.stat().st_size > 12_000 or "malformed" in file.parts:
            continue
        data = file.read_bytes()
        binary = b"\0" in data
        form = endings[ending]
        if form in ("stl", "ply mesh"):
            form += " binary" if binary else " ascii"
        if form == "pcd":
            form = "pcd compressed" if b"binary_compressed" in data else "pcd binary" if binary else "pcd ascii"
            yield _query(form, {"r.urdf": _two_boxes, "c.pcd": data}, "c.pcd", cloud="c.pcd")
        else:
            name = "m" + ending
            robot = _urdf(_link("a", _small) + _link("b", f'<mesh filename="{name}"/>'), _fixed)
            yield _query(form, {"r.urdf": robot, "c.xyz": w.xyz(_near), name: data}, name)


def cases(data_folder=None):
    """{format: [case, ...]}, always in the same order."""
    made = {}
    for source in (_robot_cases, _mesh_cases, _cloud_cases, _packing_cases, _recording_cases, _plan_cases, _option_cases, _file_cases):
        for case in source():
            made.setdefault(case.format, []).append(case)
    if data_folder and os.path.isdir(data_folder):
        for case in _data_cases(data_folder):
            made.setdefault(case.format, []).append(case)
    return made
