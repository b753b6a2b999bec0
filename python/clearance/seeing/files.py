# SPDX-License-Identifier: BSD-3-Clause
"""Clouds and depth images from files, by the libraries that know them."""

import io
import pathlib
import re

import numpy as np

CLOUDS = (".npy", ".npz", ".pcd", ".ply", ".txt", ".xyz", ".csv", ".las", ".laz")


def _needs(module, what):
    return ImportError(f"clearance: {what} needs {module}: pip install clearance[view]")


def _xyz(array, file):
    """float32 or float64 (n, 3), or (rows, columns, 3)."""
    array = np.asarray(array)
    if array.dtype.names:
        missing = [axis for axis in "xyz" if axis not in array.dtype.names]
        if missing:
            raise ValueError(f"clearance: {file} has no field {missing[0]} (it has: {', '.join(array.dtype.names)})")
        array = np.stack([array[axis] for axis in "xyz"], axis=-1)
    if array.dtype.kind not in "fiu" or array.ndim < 2 or array.shape[-1] < 3 or array.ndim > 3:
        raise ValueError(
            f"clearance: {file} holds {array.dtype} of shape {array.shape}, and points have the shape (n, 3)"
        )
    return np.ascontiguousarray(array[..., :3], np.float64 if array.dtype.itemsize > 4 else np.float32)


def read_cloud(file):
    """The points of a file, (n, 3) or (rows, columns, 3), and what a person should know: a list of sentences."""
    file = pathlib.Path(file)
    kind = file.suffix.lower()
    if kind not in CLOUDS:
        raise ValueError(f"clearance: {file} is no cloud that can be read here ({', '.join(CLOUDS)})")
    if not file.is_file():
        raise ValueError(f"clearance: {file} is no file")
    try:
        points, notes = _readers[kind](file)
    except (ValueError, ImportError, OSError):
        raise
    except Exception as error:  # a library's own kinds of errors
        raise ValueError(f"clearance: {file} cannot be read: {' '.join(str(error).split())}") from None
    return _xyz(points, file), notes


def _npy(file):
    try:
        return np.load(file, allow_pickle=False), []
    except (EOFError, OSError, ValueError) as error:
        raise ValueError(f"clearance: {file} is no NumPy array: {error}") from None


def _npz(file):
    with np.load(file, allow_pickle=False) as kept:
        names = list(kept)
        if len(names) != 1 and "points" not in names:
            raise ValueError(
                f"clearance: {file} holds {', '.join(names)}; of several arrays the cloud is called points"
            )
        return kept["points" if "points" in names else names[0]], []


def _text(file):
    lines = [
        line
        for line in file.read_text(encoding="utf-8", errors="replace").replace(",", " ").replace(";", " ").splitlines()
        if line.strip() and not line.lstrip().startswith(("#", "//"))
    ]
    if lines and not re.match(r"\s*([-+.\d]|nan|inf)", lines[0], re.IGNORECASE):
        names = lines.pop(0).lower().split()
        if names[:3] != ["x", "y", "z"]:
            raise ValueError(f"clearance: the columns of {file} begin with {' '.join(names[:3])}, not with x y z")
    rows = np.array([line.split()[:3] for line in lines if len(line.split()) != 1], dtype=object)
    if rows.ndim != 2 or rows.shape[1:] != (3,):
        raise ValueError(f"clearance: {file} has no rows of x y z")
    try:
        return rows.astype(float), []
    except ValueError as error:
        raise ValueError(f"clearance: {file} holds a word that is no number: {error}") from None


def _pcd(file):
    try:
        from pypcd4 import PointCloud
    except ImportError:
        raise _needs("pypcd4", "a .pcd file") from None
    data = file.read_bytes()
    # Older versions differ in what is optional, and pypcd4 refuses them by their number alone.
    data = re.sub(rb"(?m)^VERSION\s+0?\.[56]\s*$", b"VERSION 0.7", data, count=1)
    if not re.search(rb"(?m)^VIEWPOINT\b", data[:4096]):
        data = re.sub(rb"(?m)^POINTS\b", b"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS", data, count=1)
    cloud = PointCloud.from_fileobj(io.BytesIO(data))
    fields = cloud.metadata.fields
    if any(axis not in fields for axis in "xyz"):
        raise ValueError(f"clearance: {file} has no fields x, y, z (it has: {', '.join(fields)})")
    points = cloud.numpy(("x", "y", "z"))
    if len(points) != cloud.metadata.points:
        raise ValueError(f"clearance: {file} promises {cloud.metadata.points:,} points and holds {len(points):,}")
    view = tuple(cloud.metadata.viewpoint)
    turned = view not in ((0, 0, 0, 1, 0, 0, 0), (0, 0, 0, -1, 0, 0, 0))
    return points, [f"{file}: its VIEWPOINT is not applied; --pose says where the cloud is"] if turned else []


def _ply(file):
    try:
        from plyfile import PlyData
    except ImportError:
        raise _needs("plyfile", "a .ply file") from None
    read = PlyData.read(str(file))
    if "vertex" not in read:
        raise ValueError(f"clearance: {file} has no element vertex")
    return read["vertex"].data, []


def _las(file):
    from clearance import recordings

    points, origin = recordings.las(file)
    return points + origin, []


_readers = {
    ".npy": _npy,
    ".npz": _npz,
    ".txt": _text,
    ".xyz": _text,
    ".csv": _text,
    ".pcd": _pcd,
    ".ply": _ply,
    ".las": _las,
    ".laz": _las,
}


def read_depth(file):
    """A depth image: uint16 of a 16-bit .png or .tif, or the array of an .npy file (uint16, or float32 metres)."""
    file = pathlib.Path(file)
    if not file.is_file():
        raise ValueError(f"clearance: {file} is no file")
    if file.suffix.lower() == ".npy":
        depth = _npy(file)[0]
    else:
        try:
            from PIL import Image, UnidentifiedImageError
        except ImportError:
            raise _needs("pillow", "an image file") from None
        try:
            with Image.open(file) as image:
                if not image.mode.startswith("I;16") and image.mode not in ("I", "F"):
                    raise ValueError(
                        f"clearance: {file} is an image of mode {image.mode}; a depth image has 16 bits and one channel"
                    )
                depth = np.array(image)
        except UnidentifiedImageError:
            raise ValueError(f"clearance: {file} is no image that can be read") from None
        except OSError as error:
            raise ValueError(f"clearance: {file} is damaged: {error}") from None
    if depth.dtype == np.int32 and depth.size and 0 <= depth.min() and depth.max() <= 65535:
        depth = depth.astype(np.uint16)
    if depth.ndim != 2 or depth.dtype not in (np.uint16, np.float32):
        raise ValueError(
            f"clearance: {file} holds {depth.dtype} of shape {depth.shape}; depth is uint16 or float32, (rows, columns)"
        )
    return depth
