# SPDX-License-Identifier: BSD-3-Clause
"""Clouds of surveys: LAS, LAZ and COPC files."""

import numpy as np

from .common import needs, plain


def las(path):
    """A LAS, LAZ or COPC file: points (n, 3), float64, and origin (3,): its coordinates are points + origin.

    The origin is whole, and near the points, so that nothing is lost where coordinates are large. Every point is read,
    whatever its class. Lengths are those of the file.
    """
    try:
        import laspy
    except ImportError as error:
        raise needs("las", error) from None
    try:
        with laspy.open(path) as file:
            header = file.header
            read = file.read()
            counts = np.stack([np.asarray(read.X), np.asarray(read.Y), np.asarray(read.Z)], -1)
            expected = header.point_count
    except (OSError, ImportError):
        raise
    except Exception as error:  # laspy and its decompressors raise many kinds
        raise ValueError(f"{path} cannot be read: {plain(error)}") from None
    if len(counts) != expected:
        raise ValueError(f"{path} says {expected} points, but holds {len(counts)}")
    scale, offset = np.asarray(header.scales, float), np.asarray(header.offsets, float)
    low = counts.min(0) if len(counts) else np.zeros(3)
    origin = np.floor(low * scale + offset)
    return counts * scale + (offset - origin), origin
