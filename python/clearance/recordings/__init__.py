# SPDX-License-Identifier: BSD-3-Clause
"""Recordings, read without ROS: MCAP, rosbag2 and ROS 1 bags (extra `ros`), and LAS, LAZ and COPC files (extra `las`).

Messages are any objects with the fields of ROS's: those of `rosbags`, of a DDS library, or of ROS itself.
"""

from .common import (
    CAMERA,
    CLOUD,
    COMPRESSED,
    IMAGE,
    JOINTS,
    MAGIC,
    OLD_TRANSFORMS,
    READ,
    SEEING,
    SENSED,
    TRANSFORMS,
    Damaged,
    Unknown,
    nanoseconds,
    needs,
)
from .decoding import Cameras, camera, cloud, compressed_depth, depth, is_depth, lens_topic
from .recording import Message, Messages, Recording, is_read
from .surveys import las
from .tracks import BACK, KEPT, JointSamples, Track, Transforms, inverse, pose, slerp

__all__ = [
    "CAMERA",
    "CLOUD",
    "COMPRESSED",
    "Damaged",
    "IMAGE",
    "JOINTS",
    "MAGIC",
    "OLD_TRANSFORMS",
    "READ",
    "SEEING",
    "SENSED",
    "TRANSFORMS",
    "Unknown",
    "nanoseconds",
    "needs",
    "Cameras",
    "camera",
    "cloud",
    "compressed_depth",
    "depth",
    "is_depth",
    "is_read",
    "lens_topic",
    "Message",
    "Messages",
    "Recording",
    "las",
    "BACK",
    "JointSamples",
    "KEPT",
    "Track",
    "Transforms",
    "inverse",
    "pose",
    "slerp",
]
