# SPDX-License-Identifier: BSD-3-Clause
"""What is drawn in which colour. Colours are uint8 (n, 3): red, green, blue."""

import numpy as np

PART = (176, 178, 184)
NEAREST_PART = (226, 158, 68)
SPHERE = (120, 160, 200)
SEGMENT = {"free": (35, 120, 60), "possible": (200, 110, 0), "collision": (190, 20, 30), "no_data": (90, 90, 90)}
UNKNOWN = (150, 156, 166)  # a point whose distance was not asked, or that lies beyond every zone
ZONES = [(203, 32, 39), (240, 130, 35), (244, 200, 60), (120, 190, 90), (70, 150, 200)]

# From near to far, in shares of the farthest distance that has a colour.
_SHARES = [0, 0.15, 0.4, 1]
_SCALE = np.array([(203, 32, 39), (240, 150, 50), (92, 182, 188), (45, 84, 158)], float)


def by_distance(distance, farthest):
    """Red is near, blue is `farthest` (metres); what is farther or unknown is grey."""
    distance = np.asarray(distance, float)
    share = np.clip(np.nan_to_num(distance, nan=np.inf, posinf=2 * farthest) / farthest, 0, 1)
    colours = np.stack([np.interp(share, _SHARES, _SCALE[:, k]) for k in range(3)], axis=-1).astype(np.uint8)
    colours[~(distance <= farthest)] = UNKNOWN
    return colours


def of_zone(k):
    """The colour of zone k: 0 is the innermost."""
    return ZONES[min(k, len(ZONES) - 1)]


def by_zone(distance, thresholds):
    """A point in a zone (distance <= threshold, the innermost counts) has its colour; beyond all zones it is grey."""
    distance = np.asarray(distance, float)
    colours = np.empty((*distance.shape, 3), np.uint8)
    colours[:] = UNKNOWN
    for k in reversed(range(len(thresholds))):
        colours[distance <= thresholds[k]] = of_zone(k)
    return colours
