# SPDX-License-Identifier: BSD-3-Clause
"""Distances from points to bodies, plainly and in double. A pose is (rotation as three rows, translation)."""

import math

IDENTITY = (((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0))


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.hypot(a[0], a[1], a[2])


def apply(pose, p):
    rows, t = pose
    return (dot(rows[0], p) + t[0], dot(rows[1], p) + t[1], dot(rows[2], p) + t[2])


def compose(a, b):
    columns = list(zip(*b[0]))
    return tuple(tuple(dot(row, column) for column in columns) for row in a[0]), apply(a, b[1])


def inverse(pose):
    """Of a rigid pose."""
    rows = tuple(zip(*pose[0]))
    return rows, tuple(-dot(row, pose[1]) for row in rows)


def determinant(rows):
    return dot(rows[0], cross(rows[1], rows[2]))


def rotation(axis, angle):
    norm = length(axis)
    x, y, z = (a / norm for a in axis)
    c, s = math.cos(angle), math.sin(angle)
    d = 1 - c
    return (
        (c + x * x * d, x * y * d - z * s, x * z * d + y * s),
        (y * x * d + z * s, c + y * y * d, y * z * d - x * s),
        (z * x * d - y * s, z * y * d + x * s, c + z * z * d),
    )


def roll_pitch_yaw(r, p, y):
    about = lambda axis, angle: (rotation(axis, angle), (0.0, 0.0, 0.0))
    return compose(compose(about((0, 0, 1), y), about((0, 1, 0), p)), about((1, 0, 0), r))[0]


def quaternion(x, y, z, w):
    n = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / n, y / n, z / n, w / n
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )


def to_segment(p, a, b):
    along = sub(b, a)
    square = dot(along, along)
    t = min(1.0, max(0.0, dot(sub(p, a), along) / square)) if square > 0 else 0.0
    return length(sub(p, tuple(a[k] + t * along[k] for k in range(3))))


def to_triangle(p, t):
    a, b, c = t
    best = min(to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a))
    normal = cross(sub(b, a), sub(c, a))
    if length(normal) > 0 and all(dot(cross(sub(v, u), sub(p, u)), normal) >= 0 for u, v in ((a, b), (b, c), (c, a))):
        best = min(best, abs(dot(sub(p, a), normal)) / length(normal))
    return best


class Shape:
    """A box, cylinder, sphere or capsule: `distance` to the solid, 0 inside."""

    exact = True

    def __init__(self, kind, size, pose):
        self.kind, self.size, self.back = kind, size, inverse(pose)
        self.key = (kind, tuple(size), pose)

    def distance(self, point):
        x, y, z = apply(self.back, point)
        s = self.size
        if self.kind == "box":
            return math.hypot(*(max(0.0, abs(v) - side / 2) for v, side in zip((x, y, z), s)))
        if self.kind == "sphere":
            return max(0.0, math.hypot(x, y, z) - s[0])
        if self.kind == "cylinder":  # radius, length
            return math.hypot(max(0.0, math.hypot(x, y) - s[0]), max(0.0, abs(z) - s[1] / 2))
        return max(0.0, math.hypot(x, y, max(0.0, abs(z) - s[1] / 2)) - s[0])  # capsule


class Mesh:
    """Triangles. What is inside is certain only of one closed surface that faces out; else the surface alone counts."""

    def __init__(self, triangles):
        self.triangles = triangles
        self.key = tuple(triangles)
        self.exact = self._closed()

    def _closed(self):
        edges, parent = {}, {}

        def root(v):
            while parent.setdefault(v, v) != v:
                v = parent[v]
            return v

        volume = 0.0
        base = self.triangles[0][0] if self.triangles else (0, 0, 0)
        for t in self.triangles:
            if len(set(t)) < 3 or length(cross(sub(t[1], t[0]), sub(t[2], t[0]))) == 0:
                return False
            volume += dot(sub(t[0], base), cross(sub(t[1], base), sub(t[2], base)))
            for u, v in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
                if (u, v) in edges:
                    return False
                edges[u, v] = True
                parent[root(u)] = root(v)
        size = max((length(sub(v, base)) for v in parent), default=0)
        return (size < 1e100 and volume > 1e-6 * size**3 and all((v, u) in edges for u, v in edges)
                and len({root(v) for v in list(parent)}) == 1)

    def surface(self, point):
        return min(to_triangle(point, t) for t in self.triangles)

    def winding(self, point):
        total = 0.0
        for t in self.triangles:
            a, b, c = (sub(v, point) for v in t)
            la, lb, lc = length(a), length(b), length(c)
            total += math.atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
        return total / (2 * math.pi)


def distance_range(bodies, point):
    """(low, high): what the distance from a point to the union of bodies certainly is between."""
    low = high = math.inf
    for body in bodies:
        if isinstance(body, Shape):
            least = most = body.distance(point)
        else:
            least = most = body.surface(point)
            turns = body.winding(point) if body.exact and most > 1e-9 else 0.0
            if not body.exact or (abs(turns) > 0.1 and turns < 0.9):
                least = 0.0
            elif turns >= 0.9:
                least = most = 0.0
        low, high = min(low, least), min(high, most)
    return low, high
