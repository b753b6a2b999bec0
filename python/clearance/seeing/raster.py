# SPDX-License-Identifier: BSD-3-Clause
"""A small renderer in NumPy, so that a picture needs no viewer and no GPU: triangles, points, lines, text, PNG."""

import struct
import zlib

import numpy as np

from . import letters

AT_ONCE = 2_000_000  # fragments that are handled together


def unit(v):
    """v with length 1."""
    return v / (np.linalg.norm(v) or 1.0)


def png(pixels):
    """A PNG file of uint8 (rows, columns, 3)."""
    rows, columns = pixels.shape[:2]
    plain = np.ascontiguousarray(pixels).reshape(rows, -1)
    above = np.concatenate([plain[:1] * 0, plain[:-1]])
    left = np.concatenate([plain[:, :3] * 0, plain[:, :-3]], axis=1)
    tried = [
        np.insert(lines, 0, kind, axis=1).tobytes()
        for kind, lines in ((0, plain), (1, plain - left), (2, plain - above))
    ]
    packed = min((zlib.compress(lines, 9) for lines in tried), key=len)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", packed)
        + chunk(b"IEND", b"")
    )


class Canvas:
    """`width` x `height` pixels, seen from `eye` towards `target`; field: the lens' angle over the height, degrees."""

    def __init__(self, width, height, eye, target, field=35.0, samples=2, background=(255, 255, 255)):
        self.width, self.height, self.samples = width, height, samples
        self.w, self.h, self.eye = width * samples, height * samples, np.asarray(eye, float)
        forward = unit(np.asarray(target, float) - self.eye)
        right = unit(np.cross(forward, (0, 0, 1) if abs(forward[2]) < 0.999 else (0, 1, 0)))
        self.axes = np.stack([right, np.cross(forward, right), forward])  # x right, y down, z away
        self.focal = self.h / 2 / np.tan(np.radians(field) / 2)
        self.keys = np.full(self.w * self.h, np.iinfo(np.uint64).max, np.uint64)  # depth, then number: the least wins
        self.paint = np.full((self.w * self.h, 3), background, np.uint8)
        self.overlay, self.fragments = [], 0

    def project(self, points):
        """x and y in samples, and z in metres, of world points (n, 3)."""
        at = (np.asarray(points, float) - self.eye) @ self.axes.T
        z = np.where(at[:, 2] > 0.02, at[:, 2], np.nan)
        return np.stack([self.w / 2 + self.focal * at[:, 0] / z, self.h / 2 + self.focal * at[:, 1] / z, z], axis=-1)

    def pixel(self, point):
        """Where a world point is in the finished picture: x, y."""
        return self.project(np.reshape(point, (1, 3)))[0, :2] / self.samples

    def put(self, at, z, colour):
        """Fragments: pixel numbers, depths, colours. The nearest stays; of equally near ones the first."""
        depth = z.astype(np.float32).view(np.uint32).astype(np.uint64)  # positive floats are ordered like their bits
        key = depth << np.uint64(32) | (np.arange(len(at), dtype=np.uint64) + np.uint64(self.fragments))
        self.fragments += len(at)
        np.minimum.at(self.keys, at, key)
        won = self.keys[at] == key
        self.paint[at[won]] = colour[won]

    def triangles(self, corners, colour):
        """Triangles (n, 3, 3) in the world, lit; colour (3,) or (n, 3). One that reaches behind the eye is left out."""
        corners = np.asarray(corners, float)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
        light = unit(-self.axes[2] + 0.5 * np.array([0, 0, 1.0]) - 0.35 * self.axes[0])
        shade = 0.45 + 0.55 * np.abs(normal @ light)  # both sides: an open mesh has no inside
        paint = np.clip(shade[:, None] * np.broadcast_to(np.asarray(colour, float), (len(corners), 3)), 0, 255).astype(
            np.uint8
        )
        seen = self.project(corners.reshape(-1, 3)).reshape(-1, 3, 3)
        low = np.floor(seen[:, :, :2].min(axis=1))
        high = np.ceil(seen[:, :, :2].max(axis=1))
        inside = np.isfinite(low).all(axis=1) & (high >= 0).all(axis=1) & (low[:, 0] < self.w) & (low[:, 1] < self.h)
        seen, paint = seen[inside], paint[inside]
        low = np.maximum(low[inside], 0).astype(int)
        high = np.minimum(high[inside], (self.w - 1, self.h - 1)).astype(int)
        size = np.maximum(high - low + 1, 0)
        counts, first = size[:, 0] * size[:, 1], 0
        ends = np.cumsum(counts)
        while first < len(counts):
            last = max(first + 1, int(np.searchsorted(ends, (ends[first - 1] if first else 0) + AT_ONCE, "right")))
            chosen = np.repeat(np.arange(first, last), counts[first:last])
            k = np.arange(len(chosen)) - np.repeat(
                ends[first:last] - counts[first:last] - (ends[first - 1] if first else 0), counts[first:last]
            )
            x, y = low[chosen, 0] + k % size[chosen, 0], low[chosen, 1] + k // size[chosen, 0]
            a, b, c = (seen[chosen, i, :2] - np.stack([x + 0.5, y + 0.5], axis=-1) for i in range(3))
            weights = np.stack(
                [
                    b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0],
                    c[:, 0] * a[:, 1] - c[:, 1] * a[:, 0],
                    a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
                ],
                axis=-1,
            )
            area = weights.sum(axis=1)
            hit = ((weights >= 0).all(axis=1) | (weights <= 0).all(axis=1)) & (area != 0)
            chosen, weights = chosen[hit], weights[hit] / area[hit, None]
            z = 1 / (weights / seen[chosen, :, 2]).sum(axis=1)
            self.put(y[hit] * self.w + x[hit], z, paint[chosen])
            first = last

    def points(self, points, colours, size):
        """Squares of `size` samples."""
        seen = self.project(points)
        there = np.isfinite(seen).all(axis=1) & (np.abs(seen[:, :2]) < 1e6).all(axis=1)
        seen, colours = seen[there], np.asarray(colours)[there]
        x0, y0 = np.floor(seen[:, 0] - size / 2 + 0.5).astype(int), np.floor(seen[:, 1] - size / 2 + 0.5).astype(int)
        for dy in range(size):
            for dx in range(size):
                x, y = x0 + dx, y0 + dy
                on = (x >= 0) & (x < self.w) & (y >= 0) & (y < self.h)
                self.put(y[on] * self.w + x[on], seen[on, 2], colours[on])

    def line(self, a, b, colour, width=3.0):
        """A line between world points, above everything, with a white edge; width in pixels."""
        self.overlay.append(("line", self.pixel(a), self.pixel(b), colour, width))

    def text(self, x, y, words, colour=(20, 20, 20), scale=2, halo=True):
        """Words whose upper left corner is at a pixel."""
        self.overlay.append(("text", (x, y), words, colour, scale, halo))

    def box(self, x, y, w, h, colour):
        """A filled rectangle of the picture."""
        self.overlay.append(("box", (x, y, w, h), colour))

    def finish(self):
        """The picture, uint8 (height, width, 3)."""
        s = self.samples
        picture = self.paint.reshape(self.height, s, self.width, s, 3).mean(axis=(1, 3))
        for kind, *what in self.overlay:
            getattr(self, "_" + kind)(picture, *what)
        return (picture + 0.5).astype(np.uint8)

    def _blend(self, picture, x0, y0, mask, colour):
        h, w = mask.shape
        top, left, bottom, right = max(0, -y0), max(0, -x0), min(h, self.height - y0), min(w, self.width - x0)
        if top < bottom and left < right:
            cut = mask[top:bottom, left:right, None]
            into = picture[y0 + top : y0 + bottom, x0 + left : x0 + right]
            into += cut * (np.asarray(colour, float) - into)

    def _line(self, picture, a, b, colour, width):
        if not (np.isfinite(a).all() and np.isfinite(b).all()) or max(np.abs(a).max(), np.abs(b).max()) > 1e5:
            return
        low = np.maximum(np.floor(np.minimum(a, b) - width - 3), 0).astype(int)
        high = np.minimum(np.ceil(np.maximum(a, b) + width + 4), (self.width, self.height)).astype(int)
        if (high <= low).any():
            return
        y, x = np.mgrid[low[1] : high[1], low[0] : high[0]]
        p, along = np.stack([x + 0.5, y + 0.5], axis=-1) - a, b - a
        t = np.clip((p @ along) / max(along @ along, 1e-9), 0, 1)
        away = np.linalg.norm(p - t[..., None] * along, axis=-1)
        for half, paint in ((width / 2 + 1.5, (255, 255, 255)), (width / 2, colour)):
            self._blend(picture, low[0], low[1], np.clip(half + 0.5 - away, 0, 1), paint)

    def _text(self, picture, at, words, colour, scale, halo):
        mask = letters.mask(words, scale)
        x, y = int(round(at[0])), int(round(at[1]))
        if halo:
            self._blend(picture, x - 4, y - 4, np.full((mask.shape[0] + 8, mask.shape[1] + 8), 0.8), (255, 255, 255))
        self._blend(picture, x, y, mask, colour)

    def _box(self, picture, at, colour):
        x, y, w, h = (int(v) for v in at)
        self._blend(picture, x, y, np.ones((h, w)), colour)
