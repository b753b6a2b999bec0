# SPDX-License-Identifier: BSD-3-Clause
"""How far the robot was from what its sensors saw, for each frame of a recording (MCAP, rosbag2, ROS 1 bag).

A line for each cloud and each depth image. A frame that cannot be asked is "unknown", and says why. The command fails
if the recording is damaged (after the last whole frame), if no frame could be asked, or if --check finds a difference.
"""

import contextlib

from clearance import playing


def add(parser):
    parser.add_argument("recording", help="an .mcap, .db3 or .bag file, or a folder of rosbag2")
    add_robot(parser)
    parser.add_argument(
        "--topic", action="append", help="a PointCloud2 or Image; may be given several times (default: all)"
    )
    parser.add_argument(
        "--joint-topic", action="append", help="the JointState (default: /joint_states, or the only one)"
    )
    parser.add_argument(
        "--tf-topic", action="append", help="a TFMessage; may be given several times (default: /tf, /tf_static)"
    )
    add_frames(parser)
    parser.add_argument("--csv", metavar="FILE", help="write the rows as CSV")
    parser.add_argument("--parquet", metavar="FILE", help="write the rows as Parquet (extra parquet)")
    parser.add_argument("--check", action="store_true", help="compute each distance again by NumPy, from the spheres")


def add_robot(parser):
    parser.add_argument("--robot", required=True, metavar="FILE", help="its URDF file")
    parser.add_argument("--model", choices=["spheres", "triangles"], default="spheres")
    parser.add_argument("--spheres", type=int, help="spheres a link")
    parser.add_argument(
        "--package", action="append", default=[], metavar="NAME=FOLDER", help="the folder of package://NAME"
    )
    parser.add_argument("--exclude-link", action="append", default=[], metavar="LINK", help="a link that is left out")
    parser.add_argument("--device", default="cpu", help="cpu, or cuda:0 and so on")


def add_frames(parser):
    parser.add_argument(
        "--camera-info", metavar="TOPIC", help="the CameraInfo of the images (default: camera_info beside each)"
    )
    parser.add_argument("--base-frame", help="the frame in which the robot's root link stands (default: the root link)")
    parser.add_argument(
        "--joint", action="append", default=[], metavar="NAME=VALUE", help="a joint that no JointState names"
    )
    parser.add_argument(
        "--max-age", type=float, default=0.1, metavar="SECONDS", help="of joints and transforms (default: 0.1)"
    )
    parser.add_argument(
        "--nearest", type=float, default=0.0, metavar="METRES", help="from the sensor; nearer points do not count"
    )
    parser.add_argument(
        "--farthest", type=float, default=float("inf"), metavar="METRES", help="farther points do not count"
    )
    parser.add_argument("--zero-is-missing", action="store_true", help="a point at the sensor is no point")


def pairs(given, option, of=str):
    """{name: value} of NAME=VALUE."""
    found = {}
    for each in given:
        name, equals, value = each.partition("=")
        try:
            found[name] = of(value)
        except ValueError:
            equals = ""
        if not name or not equals or not value:
            raise ValueError(f"--{option} {each!r} is not NAME=VALUE")
    return found


def robot(asked):
    """Robot.from_urdf's arguments."""
    return {
        "file": asked.robot,
        "model": asked.model,
        "spheres": asked.spheres,
        "packages": pairs(asked.package, "package"),
        "exclude_links": asked.exclude_link,
    }


def frames(asked):
    """Arguments of play that add_frames asked for."""
    return {
        "camera_info": asked.camera_info,
        "base_frame": asked.base_frame,
        "joints": pairs(asked.joint, "joint", float),
        "max_age": asked.max_age,
        "nearest": asked.nearest,
        "farthest": asked.farthest,
        "zero_is_missing": asked.zero_is_missing,
    }


def sentence(row):
    """A row as a line."""
    if row.state in ("unknown", "no_data"):
        return f"{row.stamp:.6f} {row.topic} {row.state}: {row.note or 'no valid point'}"
    note = f" ({row.note})" if row.note else ""
    return (
        f"{row.stamp:.6f} {row.topic} {row.state}: {row.distance:.4f} m "
        f"(certainly {row.lower:.4f} to {row.upper:.4f}), "
        f"{row.link} to point {row.point:,}{note}"
    )


def run(asked):
    found = playing.play(
        asked.recording,
        robot(asked),
        topics=asked.topic,
        device=asked.device,
        joint_topic=asked.joint_topic,
        tf_topics=asked.tf_topic,
        check=asked.check,
        **frames(asked),
    )
    count = unknown = differ = 0
    least = None
    try:
        with contextlib.ExitStack() as tables:
            into = [
                tables.enter_context(kind(path))
                for kind, path in ((playing.Csv, asked.csv), (playing.Parquet, asked.parquet))
                if path
            ]
            for row in found:
                for table in into:
                    table.write(row)
                print(sentence(row), flush=True)
                count += 1
                unknown += row.state in ("unknown", "no_data")
                differ += not playing.agree(row)
                if row.state not in ("unknown", "no_data") and (least is None or row.distance < least.distance):
                    least = row
    finally:
        print(
            f"{count} frames, {unknown} of them unknown"
            + (f", {differ} of them differ from NumPy" if asked.check else "")
            + (f"; the least is {least.distance:.4f} m at {least.stamp:.6f}" if least else "")
        )
    return 1 if differ or unknown == count else 0
