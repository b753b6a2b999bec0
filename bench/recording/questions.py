# SPDX-License-Identifier: BSD-3-Clause
"""bench/record questions: what some questions answer, as pictures."""

import math
import pathlib
import struct
import subprocess
import tempfile
import xml.etree.ElementTree
import zlib

from recorded import root

from . import pictures

dot, cross, sub, unit = pictures.dot, pictures.cross, pictures.sub, pictures.unit

columns, rows, focal = 320, 240, 285.0
joints = "2.1,0.75,0.1,-1.2,0.2,0.9,0"
camera, aim = (-0.75, -1.45, 1.25), (0.35, 0.25, 0.35)
frames, shown, margin, room = 60, 27, 0.1, "0.3:2.1"


def ball(frame):
    """Where the ball is, and its radius: it comes, hesitates and goes."""
    t = frame / (frames - 1)
    return (1.1 - 0.75 * math.sin(math.pi * t) ** 1.5, -0.75 + 1.3 * t, 0.62 + 0.12 * math.cos(3 * math.pi * t)), 0.09


def seen(origin, way, frame):
    """How far along the way something is."""
    nearest = math.inf
    center, radius = ball(frame)
    d = sub(origin, center)
    b, c = dot(d, way), dot(d, d) - radius * radius
    if b * b > c and -b - math.sqrt(b * b - c) > 0:
        nearest = -b - math.sqrt(b * b - c)
    for low, high in (((-0.6, -0.9, -0.16), (1.5, 1.1, -0.12)), ((-0.8, 1.1, -0.9), (1.7, 1.16, 1.3)), ((0.55, -0.65, -0.12), (0.85, -0.35, 0.16))):
        enter, leave = 0.0, math.inf
        for k in range(3):
            if abs(way[k]) < 1e-12:
                if not low[k] <= origin[k] <= high[k]:
                    leave = -1.0
                continue
            t = sorted(((low[k] - origin[k]) / way[k], (high[k] - origin[k]) / way[k]))
            enter, leave = max(enter, t[0]), min(leave, t[1])
        if enter < leave:
            nearest = min(nearest, enter)
    return nearest


def depth_png(file, frame, sky=0):
    forward = unit(sub(aim, camera))
    right = unit(cross(forward, (0, 0, 1)))
    down = cross(forward, right)
    lines = bytearray()
    for v in range(rows):
        lines.append(0)
        for u in range(columns):
            x, y = (u - (columns - 1) / 2) / focal, (v - (rows - 1) / 2) / focal
            way = tuple(forward[k] + x * right[k] + y * down[k] for k in range(3))
            length = math.sqrt(dot(way, way))
            far = seen(camera, tuple(c / length for c in way), frame) / length  # along the axis
            lines += struct.pack(">H", round(1000 * far) if far < 60 else sky)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", columns, rows, 16, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(lines))) + chunk(b"IEND", b""))


def camera_pose():
    """x,y,z,qx,qy,qz,qw of the camera, whose z looks forward and y down."""
    z = unit(sub(aim, camera))
    x = unit(cross(z, (0, 0, 1)))
    y = cross(z, x)
    w = math.sqrt(1 + x[0] + y[1] + z[2]) / 2
    q = ((y[2] - z[1]) / (4 * w), (z[0] - x[2]) / (4 * w), (x[1] - y[0]) / (4 * w), w)
    return ",".join(f"{c:.17g}" for c in camera + q)


def written_points(file):
    """Positions and colours of what --distances has written."""
    data = file.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    kinds = {"float": "f", "double": "d", "uchar": "B", "int": "i", "uint": "I", "uint8": "B", "float32": "f", "float64": "d"}
    names, layout, count = [], "<", 0
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            count = int(words[2])
        elif words[0] == "property":
            names.append(words[2])
            layout += kinds[words[1]]
    at = [names.index(n) for n in ("x", "y", "z", "red", "green", "blue")]
    for values in struct.iter_unpack(layout, data[end : end + count * struct.calcsize(layout)]):
        yield tuple(values[k] for k in at[:3]), bytes(values[k] for k in at[3:])


def draw(scene, ply, file):
    samples, width, height = 2, 780, 520
    canvas = pictures.Canvas(width * samples, height * samples, (-1.25, -1.75, 1.35), (0.42, 0.1, 0.25), 40)
    light = unit((-0.4, -0.8, 1.0))
    for p, colour in written_points(ply):
        canvas.dot(p, bytes(int(0.9 * c) for c in colour), 5)
    for mode, points, indices, paint, _, _ in pictures.glb(scene):
        if mode == 0 or paint[0] > 0.8 and paint[1] < 0.3:  # the points are drawn; the witness is left out
            continue
        for i in range(0, len(indices) - 2, 3):
            corners = [points[j] for j in indices[i : i + 3]]
            normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
            canvas.triangle(corners, pictures.shade((0.62, 0.62, 0.64), 0.35 + 0.6 * abs(dot(normal, light))))
    canvas.save(file, samples)


def draw_hidden(scene, file):
    """The robot and its points; what the camera does not see is a veil over what is behind it."""
    samples, width, height = 2, 780, 520
    view = (width * samples, height * samples, (1.15, -1.35, 1.75), (0.48, -0.06, 0.1), 42)
    canvas, veil = pictures.Canvas(*view), pictures.Canvas(*view)
    light, violet = unit((0.4, -0.8, 1.0)), (0.55, 0.25, 0.75)
    for mode, points, indices, paint, name, _ in pictures.glb(scene):
        if mode == 0:
            for p in points:  # as large as the gaps between them
                darker = max(0.4, 1 - 0.6 * max(0.0, p[2] + 0.12))  # by height above the table
                canvas.dot(p, pictures.shade((0.62, 0.72, 0.78), darker), round(27 / math.dist(p, view[2])))
            continue
        if name in ("hidden way", "witness of what is hidden"):
            ends = points[0], max(points, key=lambda p: dot(sub(p, points[0]), sub(p, points[0])))
            for k in range(600):
                canvas.dot(tuple(a + k / 599 * (b - a) for a, b in zip(*ends)), pictures.shade(paint, 1.0), 6, 0.5)
            continue
        if name == "witness":
            continue
        for i in range(0, len(indices) - 2, 3):
            corners = [points[j] for j in indices[i : i + 3]]
            normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
            lit = 0.35 + 0.6 * abs(dot(normal, light))
            if name.endswith(" hides"):
                veil.triangle(corners, pictures.shade(violet, 0.6 + 0.4 * lit))
            else:
                link = (0.95, 0.6, 0.2) if paint[0] > 0.9 else (0.62, 0.62, 0.64)
                canvas.triangle(corners, pictures.shade(link, lit))
    for i, depth in enumerate(veil.depth):
        if depth < canvas.depth[i] - 0.08:  # its walls are of blocks of pixels, so a little before the points
            for k in range(3 * i, 3 * i + 3):
                canvas.paint[k] = (11 * canvas.paint[k] + 9 * veil.paint[k]) // 20
    canvas.save(file, samples)


def main(arguments):
    if len(arguments) != 2:
        return None
    program, robot = arguments
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "frames").mkdir()
        for k in range(frames):
            depth_png(folder / f"frames/{k:03}.png", k)
        program, robot = (str(pathlib.Path(file).resolve()) for file in (program, robot))
        lens = f"{focal},{focal},{(columns - 1) / 2},{(rows - 1) / 2}"
        asked = ["--robot", robot, "--geometry", "visual", "--exclude-link", "calib_kuka_arm_base_link", "--camera-pose", camera_pose(),
                 "--intrinsics", lens, "--spheres", "1000", "--cache", str(folder / "cache")]
        one = [*asked, "--joints", joints, "--cloud", folder / f"frames/{shown:03}.png"]
        subprocess.run([program, "query", *one, "--distances", folder / "d.ply", "--d-max", "1.2", "--scene", folder / "scene.glb"],
                       stdout=subprocess.DEVNULL, check=True)
        draw(folder / "scene.glb", folder / "d.ply", root / "docs/figures/distances.png")
        depth_png(folder / "sky.png", shown, 60000)  # far away, so that it hides nothing
        subprocess.run([program, "query", *one[:-1], folder / "sky.png", "--unseen", room, "--scene", folder / "hidden.glb"],
                       stdout=subprocess.DEVNULL, check=True)
        draw_hidden(folder / "hidden.glb", root / "docs/figures/hidden.png")
        described = xml.etree.ElementTree.parse(robot).getroot().iter("joint")
        moving = [j.get("name") for j in described if j.get("type", "fixed") != "fixed" and j.find("mimic") is None]
        (folder / "joints.csv").write_text(",".join(moving) + "\n" + joints + "\n")
        code = subprocess.run([program, "run", *asked, "--frames", "frames", "--trajectory", "joints.csv", "--check", str(margin), "--svg",
                        root / "docs/figures/clearance-over-time.svg"], stdout=subprocess.DEVNULL, cwd=folder).returncode
    return 0 if code == 2 else 1  # the ball comes nearer than the margin
