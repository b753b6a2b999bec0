# SPDX-License-Identifier: BSD-3-Clause
"""bench/record packing: a robot filled with spheres, and its tree level by level."""

import array
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

from recorded import root

from . import pictures

dot, cross, sub, unit = pictures.dot, pictures.cross, pictures.sub, pictures.unit

width, height, samples = 780, 600, 3
towards_eye = unit((0.75, -1.0, 0.42))
light = unit((0.55, -0.75, 1.0))
joints = "0.3,0.95,0.25,-1.75,0.2,1.0,0"
# Radii from small to large.
colours = [(0.18, 0.12, 0.50), (0.10, 0.35, 0.75), (0.05, 0.62, 0.66), (0.50, 0.80, 0.28), (1.00, 0.80, 0.15), (0.98, 0.45, 0.10)]


def read_ist(file):
    """Names and spheres of an .ist file's parts."""
    data = file.read_bytes()
    magic, version, count, size = struct.unpack_from("<8sIIQ", data)
    if magic != b"\x89IST\r\n\x1a\n" or version != 1 or size != len(data) or struct.unpack("<I", data[-4:])[0] != zlib.crc32(data[:-4]):
        sys.exit(f"{file} is no .ist file, or damaged")
    parts, at = {}, 24
    for _ in range(count):
        length = struct.unpack_from("<I", data, at)[0]
        name = data[at + 4 : at + 4 + length].decode()
        at += 4 + length + 32 + 8 + 64 + 4
        spheres = struct.unpack_from("<Q", data, at)[0]
        parts[name] = list(struct.iter_unpack("<4f", data[at + 8 : at + 8 + 16 * spheres]))
        at += 8 + 16 * spheres
    return parts


def colour_of(radius, low, high):
    t = (math.log(radius) - math.log(low)) / (math.log(high) - math.log(low)) * (len(colours) - 1)
    k = min(int(t), len(colours) - 2)
    return tuple(a + (t - k) * (b - a) for a, b in zip(colours[k], colours[k + 1]))


def smooth(points, indices):
    """A normal for each corner of each triangle: the mean over the triangles around its place that face nearly the same way."""
    faces, around = [], {}
    for i in range(0, len(indices) - 2, 3):
        corners = [points[j] for j in indices[i : i + 3]]
        normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))
        if dot(normal, normal) == 0:
            continue
        keys = [tuple(round(c * 1e5) for c in p) for p in corners]
        for key in keys:
            around.setdefault(key, []).append((normal, unit(normal)))
        faces.append((corners, keys, unit(normal)))
    for corners, keys, own in faces:
        normals = []
        for key in keys:
            total = [0.0, 0.0, 0.0]
            for normal, direction in around[key]:
                if dot(direction, own) > 0.75:
                    for k in range(3):
                        total[k] += normal[k]
            normals.append(unit(total))
        yield corners, normals


class Picture:
    def __init__(self, corners, width=width, height=height, samples=samples):
        self.right = unit(cross((0, 0, 1), towards_eye))
        self.up = cross(towards_eye, self.right)
        across = [dot(p, self.right) for p in corners]
        along = [dot(p, self.up) for p in corners]
        self.samples, self.w, self.h = samples, width * samples, height * samples
        self.scale = 0.95 * min(self.w / (max(across) - min(across)), self.h / (max(along) - min(along)))
        self.x0 = self.w / 2 - self.scale * (max(across) + min(across)) / 2
        self.y0 = self.h / 2 + self.scale * (max(along) + min(along)) / 2
        size = self.w * self.h
        self.depth = array.array("d", [-math.inf]) * size
        self.paint = array.array("f", [1.0]) * (3 * size)
        self.glass_depth = array.array("d", [-math.inf]) * size
        self.glass = array.array("f", [0.0]) * (2 * size)  # how much of it is seen, and how bright it shines

    def place(self, p):
        return self.x0 + self.scale * dot(p, self.right), self.y0 - self.scale * dot(p, self.up), self.scale * dot(p, towards_eye)

    def sphere(self, center, radius, colour):
        cx, cy, cz = self.place(center)
        r = radius * self.scale
        lx, ly, lz = dot(light, self.right), dot(light, self.up), dot(light, towards_eye)
        half = unit((lx, ly, lz + 1))
        for y in range(max(math.ceil(cy - r), 0), min(math.floor(cy + r) + 1, self.h)):
            dy = (cy - y) / r
            wide = math.sqrt(max(0.0, 1 - dy * dy))
            for x in range(max(math.ceil(cx - wide * r), 0), min(math.floor(cx + wide * r) + 1, self.w)):
                dx = (x - cx) / r
                dz = math.sqrt(max(0.0, 1 - dx * dx - dy * dy))
                i = y * self.w + x
                z = cz + dz * r
                if z <= self.depth[i]:
                    continue
                self.depth[i] = z
                lit = 0.40 + 0.75 * max(0.0, lx * dx + ly * dy + lz * dz)
                lit *= 0.6 + 0.4 * dz
                shine = 0.35 * max(0.0, half[0] * dx + half[1] * dy + half[2] * dz) ** 40
                for k in range(3):
                    self.paint[3 * i + k] = min(1.0, colour[k] * lit + shine)

    def pane(self, corners, normals):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (self.place(p) for p in corners)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < 1e-9:
            return
        half = unit(tuple(a + b for a, b in zip(light, towards_eye)))
        facing = [abs(dot(n, towards_eye)) for n in normals]
        shining = [abs(dot(n, half)) for n in normals]
        for y in range(max(math.ceil(min(ay, by, cy)), 0), min(math.floor(max(ay, by, cy)) + 1, self.h)):
            for x in range(max(math.ceil(min(ax, bx, cx)), 0), min(math.floor(max(ax, bx, cx)) + 1, self.w)):
                v = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
                w = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
                if v < 0 or w < 0 or v + w > 1:
                    continue
                z = az + v * (bz - az) + w * (cz - az)
                i = y * self.w + x
                if z <= self.glass_depth[i]:
                    continue
                self.glass_depth[i] = z
                u = 1 - v - w
                self.glass[2 * i] = 0.06 + 0.70 * (1 - (u * facing[0] + v * facing[1] + w * facing[2])) ** 2
                self.glass[2 * i + 1] = 0.5 * (u * shining[0] + v * shining[1] + w * shining[2]) ** 60

    def painted(self):
        paint = bytearray(3 * self.w * self.h)
        tint = (0.60, 0.68, 0.80)
        for i in range(self.w * self.h):
            seen, shine = self.glass[2 * i], self.glass[2 * i + 1]
            if self.glass_depth[i] == -math.inf:
                seen = shine = 0.0
            for k in range(3):
                value = self.paint[3 * i + k] * (1 - seen) + tint[k] * seen + shine * 0.6
                paint[3 * i + k] = int(255 * min(1.0, value) ** (1 / 1.25) + 0.5)
        return paint

    def save(self, file):
        pictures.save_png(file, self.w, self.h, self.painted(), self.samples)


def draw(ist, scene, file):
    spheres, meshes, poses = read_ist(ist), [], {}
    for _, points, indices, _, name, matrix in pictures.glb(scene):
        if name.endswith(" mesh"):
            meshes.append((points, indices))
            poses[name.removesuffix(" mesh")] = matrix
    placed = []
    for name, balls in spheres.items():
        m = poses[name]
        for x, y, z, r in balls:
            p = [m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k] for k in range(3)]
            placed.append((r, (p[0], -p[2], p[1])))  # glTF's y is up
    picture = Picture([p for points, _ in meshes for p in points])
    low, high = min(r for r, _ in placed), max(r for r, _ in placed)
    low = max(low, high / 100)
    for r, center in sorted(placed, key=lambda ball: -dot(ball[1], towards_eye)):
        picture.sphere(center, r, colour_of(min(max(r, low), high), low, high))
    for points, indices in meshes:
        for corners, normals in smooth(points, indices):
            picture.pane(corners, normals)
    picture.save(file)


def balls_of(points):
    """Centres and radii from the corners that the .glb has for each: of the largest ball many, of the small ones few."""
    balls, at = [], 0
    while at < len(points):
        count = 642 if not balls else 162 if len(balls) < 6 else 42 if len(balls) < 48 else 12
        corners = points[at : at + count]
        center = tuple(sum(c[k] for c in corners) / count for k in range(3))
        balls.append((center, math.dist(center, corners[0])))
        at += count
    return balls


def draw_levels(ist, scene, file):
    """A panel for each level but the root's own and the last, every link in a colour of its own; and the inner spheres."""
    levels, poses = {}, {}
    for _, points, _, _, name, matrix in pictures.glb(scene):
        if found := re.fullmatch(r"(.+) level (\d+)", name):
            poses[found[1]] = matrix
            levels.setdefault(int(found[2]), {})[found[1]] = balls_of(points)
    depth = max(levels)
    inner = {}
    for name, balls in read_ist(ist).items():
        m = poses[name]
        places = ([m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k] for k in range(3)] for x, y, z, _ in balls)
        inner[name] = [((p[0], -p[2], p[1]), ball[3]) for p, ball in zip(places, balls)]
    shown = [levels[k] for k in range(depth)] + [inner]
    ends = [tuple(c + side * r for c in center) for balls in levels[0].values() for center, r in balls for side in (-0.75, 0.75)]
    wide, high, rays = 240, 250, 2
    paint = [bytearray() for _ in range(high * rays)]
    for panel in shown:
        picture = Picture(ends, wide, high, rays)
        for k, name in enumerate(poses):
            for center, radius in panel.get(name, []):
                picture.sphere(center, radius, colours[(2 * k + k // 3) % len(colours)])
        flat = picture.painted()
        for y, row in enumerate(paint):
            row += flat[3 * picture.w * y : 3 * picture.w * (y + 1)]
    pictures.save_png(file, wide * rays * len(shown), high * rays, bytearray().join(paint), rays)


def main(arguments):
    levels = arguments[:1] == ["--levels"]
    arguments = arguments[levels:]
    if len(arguments) != 2:
        return None
    with tempfile.TemporaryDirectory() as folder:
        ist, scene = pathlib.Path(folder) / "robot.ist", pathlib.Path(folder) / "robot.glb"
        command = [arguments[0], "pack", arguments[1], "--geometry", "visual", "--spheres", "2048", "--joints", joints, "--no-cache"]
        try:
            failed = subprocess.run([*command, "--out", ist, "--out", scene]).returncode != 0
        except OSError as error:
            sys.exit(f"{arguments[0]} does not run: {error.strerror}")
        if failed or not (ist.exists() and scene.exists()):
            sys.exit(f"{arguments[0]} pack did not write what is to be drawn")
        picture = root / "docs/figures" / ("kuka-levels.png" if levels else "kuka-spheres.png")
        try:
            (draw_levels if levels else draw)(ist, scene, picture)
        except OSError as error:
            sys.exit(f"{picture} cannot be written: {error.strerror}")
    return 0
