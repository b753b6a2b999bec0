# SPDX-License-Identifier: BSD-3-Clause
"""What the readers of recordings share: names of types, two errors, and a stamp as a number."""

import re

CLOUD = "sensor_msgs/msg/PointCloud2"
IMAGE = "sensor_msgs/msg/Image"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
CAMERA = "sensor_msgs/msg/CameraInfo"
JOINTS = "sensor_msgs/msg/JointState"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
OLD_TRANSFORMS = "tf/msg/tfMessage"
READ = (CLOUD, IMAGE, COMPRESSED, CAMERA, JOINTS, TRANSFORMS, OLD_TRANSFORMS)
SEEING = (CLOUD, IMAGE, COMPRESSED)
# Words in the names of types that say what a sensor saw, of whoever's package they are.
SENSED = re.compile(r"cloud|image|depth|scan|range|lidar|livox|custommsg|radar|sonar|echo|packet", re.IGNORECASE)

MAGIC = b"\x89MCAP0\r\n"


class Damaged(ValueError):
    """A recording ends before its end: what was read before this is whole."""


class Unknown(ValueError):
    """What a frame needs is missing or too old, so it cannot be asked."""


def needs(extra, error):
    """The sentence about an extra that is not installed."""
    return ImportError(f"{error.name} is not installed: pip install clearance[{extra}]")


def nanoseconds(stamp):
    """A ROS stamp as an integer."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def plain(error):
    return (str(error).strip() or type(error).__name__).rstrip(".")
