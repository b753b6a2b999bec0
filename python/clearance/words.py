# SPDX-License-Identifier: BSD-3-Clause
"""What the words of a command mean: numbers, poses, names with values, and joints."""

import math

import numpy as np


def numbers(text, count, option, infinite=False):
    """Numbers between commas, finite unless infinite is set; count None: one or more."""
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    wrong = any(map(math.isnan, values)) if infinite else not all(map(math.isfinite, values))
    if not values or count and len(values) != count or wrong:
        raise ValueError(f"{option} takes {count or 'one or more'} numbers between commas, not {text!r}")
    return values


def pose(text, option):
    """A matrix of x,y,z,qx,qy,qz,qw; None for None."""
    if text is None:
        return None
    x, y, z, *q = numbers(text, 7, option)
    length = math.sqrt(sum(v * v for v in q))
    if abs(length - 1) > 1e-3:
        raise ValueError(f"{option}: the quaternion has the length {length:.6g}, not 1")
    i, j, k, w = (v / length for v in q)
    return np.array(
        [
            [1 - 2 * (j * j + k * k), 2 * (i * j - k * w), 2 * (i * k + j * w), x],
            [2 * (i * j + k * w), 1 - 2 * (i * i + k * k), 2 * (j * k - i * w), y],
            [2 * (i * k - j * w), 2 * (j * k + i * w), 1 - 2 * (i * i + j * j), z],
            [0, 0, 0, 1],
        ]
    )


def pairs(words, option):
    """{name: text} of NAME=TEXT words."""
    out = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not name or not value or name in out:
            raise ValueError(f"{option} takes NAME=VALUE once for each name, not {word!r}")
        out[name] = value
    return out


def add_joints(parser, what):
    """The option about joints, by either of its names. what: which joints they are."""
    parser.add_argument(
        "--joint",
        "--joints",
        metavar="NAME=VALUE,...",
        action="append",
        default=[],
        help=f"radians or metres, of {what}; may be given several times; or once VALUE,... of all joints in the file's order",
    )


def joints_of(asked):
    """Of --joint: {joint: value}, or a list of all values."""
    words = [word for text in asked.joint for word in text.split(",") if word]
    if words and not any("=" in word for word in words):
        if len(asked.joint) > 1:
            raise ValueError("--joints has the values of all joints, so it is given once")
        try:
            return numbers(asked.joint[0], None, "--joints")
        except ValueError:
            raise ValueError(
                f"--joints takes NAME=VALUE,..., or the values of all joints, not {asked.joint[0]!r}"
            ) from None
    bare = [word for word in words if "=" not in word]
    if bare:
        raise ValueError(f"--joints takes NAME=VALUE of each joint, or only values; {bare[0]!r} has no name")
    return {name: numbers(value, 1, f"--joint {name}=")[0] for name, value in pairs(words, "--joint").items()}


def by_name(robot, joints):
    """{joint: value} of what joints_of gives."""
    if isinstance(joints, dict):
        return joints
    if len(joints) != len(robot.joints):
        raise ValueError(
            f"--joints has {len(joints)} values, and the robot has {len(robot.joints)} joints: {', '.join(robot.joints)}"
        )
    return dict(zip(robot.joints, joints, strict=True))
