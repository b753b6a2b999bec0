# SPDX-License-Identifier: BSD-3-Clause
"""The files that once broke the command (../shared/data/attack, see its SOURCES.md), and what is right for them. Where no verdict
stands, expect.py has it."""

import json
import math
import os
import random
import shlex
import struct
import zlib

import scenes
import writers
from expect import Case

_near = "--cloud near.xyz --model triangles --json"
_in = "--cloud in.xyz --model triangles --json"
_meshes = ["dae-no-vcount", "dae-no-p", "dae-selfnode-entity", "dae-instance-lost", "dae-index-wraps"]
_TABLE = {
    "link-ref": (f"query --robot link-ref.urdf {_near}", "answered"),
    "link-capsule": (f"query --robot link-capsule.urdf {_near}", None),
    "link-box-comma": (f"query --robot link-box-comma.urdf {_near}", "refused"),
    "link-second-lost": (f"query --robot link-second-lost.urdf {_near}", None),
    "far-inside": ("query --robot box.urdf --base-pose 0.25,0.25,0,0,0,0,1 --cloud far-inside.xyz --model triangles --json", "answered"),
    "plate": ("pack plate.urdf --spheres 5 --no-cache --json", None),
    "near-coplanar": ("pack near-coplanar.obj --spheres 5 --no-cache --json", None),
    "check-empty": (f"query --robot box.urdf {_in} --check ''", "refused"),
    **{name: (f"query --robot {name}.urdf {_near}", "refused") for name in _meshes},
    "dae-instance-ok": (f"query --robot dae-instance-ok.urdf {_near}", "answered"),
    "glb-ok": (f"query --robot glb-ok.urdf {_near}", "answered"),
    "glb-child-lost": (f"query --robot glb-child-lost.urdf {_near}", "refused"),
    "glb-chain20000": (f"query --robot glb-chain20000.urdf {_near}", None),
    "ply-ok": ("query --robot box.urdf --cloud ply-ok.ply --model triangles --json", "answered"),
    **{name: (f"query --robot box.urdf --cloud {name}.ply --model triangles --json", "refused") for name in ("ply-neg", "ply-int-shift", "ply-count-low")},
    "xyz-ok": ("query --robot box.urdf --cloud xyz-ok.xyz --model triangles --json", "answered"),
    "xyz-cr": ("query --robot box.urdf --cloud xyz-cr.xyz --model triangles --json", None),
    "order-plain": ("query --robot order-plain.urdf --joints 2.5,0 --cloud one.xyz --model triangles --json", "answered"),
    "order-entity": ("query --robot order-entity.urdf --joints 2.5,0 --cloud one.xyz --model triangles --json", None),
    "esc": ("query --robot esc.urdf --cloud in.xyz --model triangles", "manners"),
    "mimic-inf": ("query --robot mimic-inf.urdf --joint 1=3 --cloud one.xyz --model triangles --json", "refused"),
    "yamll": ("info yamll.yaml --json", "refused"),
}
_TABLE_INSIDE = {  # ../shared/data/inside: what other formats say than was understood
    "plate": ("query --robot plate.urdf --cloud p-plate.xyz --model triangles --json", "answered"),
    "comma": ("query --robot r.urdf --cloud comma.xyz --model triangles --json", "refused"),
    **{name: (f"query --robot {name}.urdf --cloud p-{name}.xyz --model triangles --json", "refused") for name in ("surf", "node", "multi")},
}


def _sizes():
    """Small files that unfold to much: they end in time and memory, by an answer or a sentence."""
    cloud = {"c.xyz": b"3 0 0\n"}
    query = [["--robot", "r.urdf"], ["--cloud", "c.xyz"], ["--model", "triangles"], ["--json", None]]
    robot = lambda shapes: b'<robot name="r"><link name="a">' + b"".join(
        b"<collision><geometry>" + s + b"</geometry></collision>" for s in shapes) + b"</link></robot>"
    for name, shapes in (("spheres", [b'<sphere radius="1"/>'] * 300), ("sphere-large", [b'<sphere radius="1e6"/>']), ("cylinder-large", [b'<cylinder radius="1e9" length="1"/>']),
                         ("dev-zero", [b'<mesh filename="file:///dev/zero"/>']), ("thin", [b'<box size="1 1 1e-7"/>'])):
        yield name, Case("regression", "query", query, dict(cloud, **{"r.urdf": robot(shapes)}), "", cpu=20)
    for name, side in (("plate-1e-4", b"1 1 1e-4"), ("needle-1e-5", b"1 1e-5 1e-5")):
        packed = [["", "r.urdf"], ["--spheres", "5"], ["--no-cache", None], ["--json", None]]
        yield name, Case("regression", "pack", packed, {"r.urdf": robot([b'<box size="' + side + b'"/>'])}, "")
    # A graph of nodes in which each holds the next twice.
    nodes = [{"children": [k + 1, k + 1]} for k in range(26)] + [{"mesh": 0}]
    glb = writers.glb(writers.halved(writers.box(1, 1, 1)))
    top = json.loads(scenes.split_glb(glb)[0])
    top["nodes"], binary = nodes, scenes.split_glb(glb)[1]
    mesh = robot([b'<mesh filename="m.glb"/>'])
    yield "glb-unfolds", Case("regression", "query", query, dict(cloud, **{"r.urdf": mesh, "m.glb": writers.pack_glb(json.dumps(top).encode(), binary)}), "")
    dae = writers.dae(writers.halved(writers.box(1, 1, 1)))
    many = dae.replace(b'<param name="Z" type="float"/>', b'<param name="Z" type="float"/>' + b'<param name="W" type="float"/>' * 100_000, 1)
    mesh = robot([b'<mesh filename="m.dae"/>'])
    yield "dae-params", Case("regression", "query", query, dict(cloud, **{"r.urdf": mesh, "m.dae": many}), "")
    side = 22_000
    packer, row = zlib.compressobj(1), bytes(2 * side + 1)
    data = b"".join(packer.compress(row * 100) for _ in range(side // 100)) + packer.flush()
    head = writers.png_chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 16, 0, 0, 0, 0))
    image = b"\x89PNG\r\n\x1a\n" + head + writers.png_chunk(b"IDAT", data) + writers.png_chunk(b"IEND", b"")
    seen = [["--robot", "r.urdf"], ["--cloud", "c.png"], ["--intrinsics", "10,10,1,1"], ["--model", "triangles"], ["--json", None]]
    box = robot([b'<box size="1 1 1"/>'])
    yield "png-unfolds", Case("regression", "query", seen, {"r.urdf": box, "c.png": image}, "")
    repeats = 120_000_000 * 3 // 264  # three bytes a point; each reference repeats 264 zeros
    packed = b"\x02\0\0\0" + b"\xe0\xff\0" * repeats
    points = 1 + 264 * repeats // 3
    head = f"FIELDS x y z\nSIZE 1 1 1\nTYPE I I I\nWIDTH {points}\nHEIGHT 1\nDATA binary_compressed\n".encode()
    seen = [[name, "c.pcd" if name == "--cloud" else value] for name, value in query]
    yield "pcd-unfolds", Case("regression", "query", seen, {"r.urdf": box, "c.pcd": head + struct.pack("<II", len(packed), 3 * points) + packed}, "")


def _obj(triangles):
    """Each triangle with corners of its own."""
    lines = ["v %.4g %.4g %.4g" % corner for triangle in triangles for corner in triangle]
    return "\n".join(lines + [f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}" for k in range(len(triangles))] + [""]).encode()


def _unclosed():
    """Small meshes that are long to close: they end in 20 s of the processor below 1 MB, in 60 s below 10."""
    rng = random.Random(3)
    point = lambda: tuple(rng.uniform(-0.5, 0.5) for _ in range(3))
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    sheets = []
    for k in range(4000):
        a, b, c, d = [(x, y, k / 8000) for x, y in corners]
        sheets += [(a, b, c), (a, c, d)]
    around = [(0.5 * math.cos(k), 0.5 * math.sin(k), 0.1 * (k % 3)) for k in range(20_000)]
    edge = b"v 0 0 -0.5\nv 0 0 0.5\n" + b"".join(b"v %.4g %.4g %.4g\n" % at for at in around)
    edge += b"".join(b"f 1 2 %d\n" % (k + 3) for k in range(len(around)))
    boxes = b"".join(b'<collision><origin xyz="%.3f %.3f %.3f"/><geometry><box size=".1 .1 .1"/></geometry></collision>' % point() for _ in range(20_000))
    meshes = {"sheets": _obj(sheets), "random": _obj([(point(), point(), point()) for _ in range(8000)]), "one-edge": edge}
    query = [["--robot", "r.urdf"], ["--cloud", "c.xyz"], ["--model", "triangles"], ["--json", None]]
    for name, mesh in meshes.items():
        robot = b'<robot name="r"><link name="a"><collision><geometry><mesh filename="m.obj"/></geometry></collision></link></robot>'
        yield "unclosed-" + name, Case("regression", "query", query, {"r.urdf": robot, "m.obj": mesh, "c.xyz": b"3 0 0\n"}, "", cpu=20)
    robot = b'<robot name="r"><link name="a">' + boxes + b"</link></robot>"
    yield "unclosed-boxes", Case("regression", "query", query, {"r.urdf": robot, "c.xyz": b"3 0 0\n"}, "", cpu=60)


def _flat_png(side, depth=1500):
    """Many equal pixels in few bytes."""
    packer, row = zlib.compressobj(9), b"\0" + struct.pack(">H", depth) * side
    data = b"".join(packer.compress(row) for _ in range(side)) + packer.flush()
    head = writers.png_chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 16, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + writers.png_chunk(b"IDAT", data) + writers.png_chunk(b"IEND", b"")


def _zeros_pcd(points):
    """Points that are all (0, 0, 0), in few bytes."""
    packed = b"\x02\0\0\0" + b"\xe0\xff\0" * ((3 * points - 3) // 264)
    points = 1 + 264 * ((3 * points - 3) // 264) // 3
    head = f"FIELDS x y z\nSIZE 1 1 1\nTYPE I I I\nWIDTH {points}\nHEIGHT 1\nDATA binary_compressed\n".encode()
    return head + struct.pack("<II", len(packed), 3 * points) + packed


def _many(parts):
    """A robot of boxes on a slide, which stand beside one another."""
    links = "".join(f'<link name="l{k}"><collision><geometry><box size=".1 .08 .06"/></geometry></collision></link><joint name="j{k}" type="fixed"><parent link="a"/>'
                    f'<child link="l{k}"/><origin xyz="{k % 7 * 0.12} {k // 7 % 7 * 0.12} {k // 49 * 0.12}"/></joint>' for k in range(parts))
    return ('<robot name="r"><link name="base"/><link name="a"/><joint name="s" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>'
            '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>' + links + "</robot>").encode()


def _questions():
    """Small questions that once took minutes, or gigabytes."""
    frame = writers.png(640, 480, [1200 + (x * x + 3 * y) % 97 + x // 3 for y in range(480) for x in range(640)])
    camera = [["--intrinsics", "525,525,319.5,239.5"], ["--camera-pose", "0.3,0.3,-0.5,0,0,0,1"]]
    query = [["--robot", "r.urdf"], ["--cloud", "c.png"], *camera, ["--spheres", "50"], ["--no-cache", None], ["--threads", "1"], ["--json", None]]
    files = {"r.urdf": _many(46), "c.png": frame}
    for name, more in (("nearest-50", ["--nearest", "50"]), ("support-above-all", ["--min-support", "1000000@10"]),
                       ("support-nearly-all", ["--min-support", "300000@10"]), ("support-part", ["--min-support", "200000@0.4"])):
        yield name, Case("regression", "query", query + [more], files, "")
    rows = b"s\n" + b"".join(f"{k / 400}\n".encode() for k in range(200))
    rng = random.Random(7)
    cell = [tuple(v + rng.random() * 1e-6 for v in at) for at in ((1.1, 0.3, 0.2), (1.1, 0, 0)) for _ in range(30_000)]
    head = f"FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH {len(cell)}\nHEIGHT 1\nDATA binary\n".encode()
    crowds = {"equal.pcd": _zeros_pcd(2_000_000), "cell.pcd": head + b"".join(struct.pack("<3d", *p) for p in cell), "c.png": _flat_png(400)}
    for cloud, data in crowds.items():
        for model in ("spheres", "triangles") if cloud != "c.png" else ("spheres",):  # so many nearly equal points take triangles longer
            plan = [["--robot", "r.urdf"], ["--cloud", cloud], ["--camera-pose", "0,0,0,0,0,0,1" if cloud == "cell.pcd" else "1.1,0.3,0.2,0,0,0,1"],
                    ["--configurations", "q.csv"], ["--threads", "1"], ["--model", model]]
            plan += [["--intrinsics", "1e9,1e9,0,0"]] if cloud == "c.png" else []
            plan += [["--spheres", "200"], ["--no-cache", None]] if model == "spheres" else []
            yield f"plan-{cloud}-{model}", Case("regression", "plan", plan, {"r.urdf": _many(6), "q.csv": rows, cloud: data}, "")
    image = {"r.urdf": _many(2), "q.csv": b"s\n0\n0.1\n", "c.png": _flat_png(8400)}
    for name, more in (("query", []), ("distances", [["--distances", "o.ply"]]), ("scene", [["--scene", "o.glb"]]), ("zones", [["--zones", "1,3"]]),
                       ("self-filter", [["--self-filter", "0.1"]]), ("nearest", [["--nearest", "100"]]), ("min-support", [["--min-support", "100000@0.01"]])):
        asked = [["--robot", "r.urdf"], ["--cloud", "c.png"], ["--intrinsics", "8000,8000,4200,4200"], ["--model", "triangles"], ["--threads", "1"], ["--json", None]]
        yield f"flat-{name}", Case("regression", "query", asked + more, image, "", outputs=["o.ply", "o.glb"])
    asked = [["--robot", "r.urdf"], ["--cloud", "c.png"], ["--intrinsics", "8000,8000,4200,4200"], ["--model", "triangles"], ["--configurations", "q.csv"]]
    yield "flat-plan", Case("regression", "plan", asked, image, "")


def cases(data):
    """[(name, case, what is right or None), ...]; those with files of their own everywhere, the others where the data is."""
    return [(name, case, "manners") for name, case in (*_sizes(), *_unclosed(), *_questions())] + _recorded(data and os.path.join(data, "attack"), _TABLE) + [
        ("inside-" + name, case, right) for name, case, right in _recorded(data and os.path.join(data, "inside"), _TABLE_INSIDE)]


def _recorded(folder, table):
    made, held = [], {}
    if not os.path.isdir(folder):
        return []
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            held[name] = file.read()
    for name, (line, right) in table.items():
        command, *words = shlex.split(line)
        options = []
        while words:
            word = words.pop(0)
            if not word.startswith("--"):
                options.append(["", word])
            else:
                options.append([word, None if word in ("--json", "--no-cache") else words.pop(0)])
        if any(value in held or value.startswith(name) for _, value in options if value):
            files = {k: v for k, v in held.items() if k.startswith(name) or k in [value for _, value in options]}
            made.append((name, Case("regression", command, options, files, ""), right))
    return made
