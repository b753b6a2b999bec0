# SPDX-License-Identifier: BSD-3-Clause
"""From messages to points, depths and lenses: PointCloud2, Image, CompressedImage and CameraInfo."""

import re

import numpy as np

from .. import _core
from .common import COMPRESSED


def cloud(message):
    """A PointCloud2 as a structured view, (width,) or (height, width), of x, y and z: nothing is copied.

    ValueError with a sentence if it has no x, y and z of FLOAT32 or FLOAT64, is big-endian, or is shorter than it says.
    """
    data = memoryview(message.data).cast("B")
    offsets, size, rows, columns, step, row_step = _core._cloud_layout(message, data)
    point = np.dtype({"names": ["x", "y", "z"], "formats": [f"<f{size}"] * 3, "offsets": offsets, "itemsize": step})
    if not rows or not columns:
        return np.empty(0, point)
    view = np.ndarray((rows, columns), point, data, strides=(row_step, step))
    return view[0] if rows == 1 else view


def depth(message):
    """A depth Image as a view, (rows, columns): uint16 millimetres (16UC1, mono16) or float32 metres (32FC1)."""
    if message.is_bigendian:
        raise ValueError("the image is big-endian")
    kinds = {"16UC1": "<u2", "mono16": "<u2", "32FC1": "<f4"}
    if message.encoding not in kinds:
        raise ValueError(
            f"the image is encoded as {message.encoding!r}, which is no depth (16UC1, mono16 and 32FC1 are)"
        )
    kind = np.dtype(kinds[message.encoding])
    rows, columns, said = int(message.height), int(message.width), int(message.step)
    data = memoryview(message.data).cast("B")
    if not rows or not columns:
        raise ValueError(f"the image has {rows} x {columns} pixels")
    step = _core._row_step(rows, columns * kind.itemsize, said, len(data))
    if step is None:
        raise ValueError(
            f"the image says {rows} x {columns} pixels of {kind.itemsize} bytes, in rows of {said} bytes (step), but "
            f"holds {len(data)} bytes"
        )
    return np.ndarray((rows, columns), kind, data, strides=(step, kind.itemsize))


def compressed_depth(message):
    """A CompressedImage of depth: the image as depth() gives it, and by how much less each depth may be, or None.

    Inverse depths (32FC1) were rounded, so a surface may be nearer by so many metres of depth. ValueError with a
    sentence for a picture, and for what is damaged.
    """
    try:
        return _core._compressed_depth(message.format, np.frombuffer(message.data, np.uint8))
    except RuntimeError as error:
        raise ValueError(str(error)) from None


def is_depth(kind, message):
    """Whether an Image or CompressedImage says that it holds depth, and is no picture."""
    return _core._is_depth(message.format) if kind == COMPRESSED else message.encoding in ("16UC1", "32FC1")


def lens_topic(topic):
    """The topic of an image without what a transport that compresses it adds."""
    return re.sub(r"/compressed(Depth)?$", "", topic)


# ---- cameras -----------------------------------------------------------------------------------------------------------


def _field(info, name):
    value = getattr(info, name, None)
    return np.asarray(getattr(info, name.upper()) if value is None else value, float)  # ROS 1 writes K, D and P


class Cameras:
    """From a CameraInfo to what depth_image takes; computed anew only when the CameraInfo changes."""

    def __init__(self):
        self._last = {}

    def of(self, info, shape, rectified=False, key=None):
        """{"intrinsics": (fx, fy, cx, cy)}, or {"rays": (rows, columns, 2)} if the lens distorts.

        shape: of the image. rectified: the image was undistorted, so P holds and K and D do not.
        A pixel at which the lens cannot be inverted has the ray NaN. ValueError with a sentence if the model is unknown.
        """
        roi = info.roi
        said = (
            int(info.width),
            int(info.height),
            info.distortion_model,
            int(info.binning_x),
            int(info.binning_y),
            int(roi.x_offset),
            int(roi.y_offset),
            int(roi.width),
            int(roi.height),
            tuple(shape),
            bool(rectified),
            *(_field(info, name).tobytes() for name in "kdp"),
        )
        if self._last.get(key, (None,))[0] != said:
            self._last[key] = (said, camera(info, shape, rectified))
        return self._last[key][1]


def camera(info, shape, rectified=False):
    """What depth_image takes for a CameraInfo, as Cameras.of, computed anew."""
    rows, columns = shape
    k, d, p = _field(info, "k"), _field(info, "d"), _field(info, "p").reshape(3, 4)
    if rectified:
        if not p[0, 0] and d.any():
            raise ValueError("the image is rectified, but the CameraInfo's P is empty")
        k, d = p[:, :3] if p[0, 0] else k, ()
    roi = info.roi
    made = _core.Camera(
        int(info.width),
        int(info.height),
        k,
        d,
        "" if rectified else info.distortion_model,
        binning=(int(info.binning_x), int(info.binning_y)),
        roi=(int(roi.x_offset), int(roi.y_offset), int(roi.width), int(roi.height)),
    )
    if (made.height, made.width) != (rows, columns):
        raise ValueError(f"the CameraInfo is of {made.height} x {made.width} pixels, the image of {rows} x {columns}")
    return {"rays": made.rays()} if made.intrinsics is None else {"intrinsics": made.intrinsics}
