# SPDX-License-Identifier: BSD-3-Clause
"""How far the robot was from what its sensors saw, for each frame of a recording (MCAP, rosbag2, ROS 1 bag).

A line for each cloud and each depth image. A frame that cannot be asked is "unknown", and says why. The command fails
if the recording is damaged (after the last whole frame), if no frame could be asked, or if --check finds a difference.
"""

import contextlib
import pathlib
import sys

from clearance import playing, words
from clearance.commands import report
from clearance.seeing import report as pages
from clearance.seeing import rerun_file
from clearance.seeing.pictures import render
from clearance.seeing.raster import png


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
    parser.add_argument("--rerun", metavar="FILE.rrd", help="write all frames as a recording for rerun (extra rerun)")
    parser.add_argument("--report", metavar="FILE.html", help="write one page that needs nothing else")
    parser.add_argument("--margin", type=float, metavar="METRES", help="of --rerun and --report")
    report.add_page(parser)


def add_robot(parser):
    parser.add_argument("--robot", required=True, metavar="FILE", help="its URDF file")
    parser.add_argument("--model", choices=["spheres", "triangles"], default="spheres")
    parser.add_argument("--spheres", type=int, help="spheres a link")
    parser.add_argument(
        "--package", action="append", default=[], metavar="NAME=FOLDER", help="the folder of package://NAME"
    )
    parser.add_argument("--gltf-up", choices=("y", "z"), help="which axis of glTF meshes is up (default: a note says)")
    parser.add_argument("--exclude-link", action="append", default=[], metavar="LINK", help="a link that is left out")
    parser.add_argument("--device", default="cpu", help="cpu, or cuda:0 and so on")


# As the compiled command has them.
CROPS = {
    "--crop": ("X0,Y0,Z0,X1,Y1,Z1", "only points in that box (metres, in the base frame) are obstacles"),
    "--crop-out": ("X0,Y0,Z0,X1,Y1,Z1", "no point in that box is an obstacle"),
    "--height": ("LOW,HIGH", "only points from low to high along z are obstacles (--height=-0.1,2)"),
    "--plane": ("A,B,C,D,T", "no point within t of the plane ax + by + cz = d is an obstacle"),
}


def crops(asked):
    """Those options as arguments of cropped."""

    def corners(text, option):
        values = words.numbers(text, 6, option, infinite=True)
        return [values[:3], values[3:]]

    return [
        *({"inside": corners(text, "--crop")} for text in asked.crop),
        *({"outside": corners(text, "--crop-out")} for text in asked.crop_out),
        *({"height": words.numbers(text, 2, "--height", infinite=True)} for text in asked.height),
        *({"plane": words.numbers(text, 5, "--plane")} for text in asked.plane),
    ]


def add_frames(parser):
    parser.add_argument(
        "--camera-info", metavar="TOPIC", help="the CameraInfo of the images (default: camera_info beside each)"
    )
    parser.add_argument("--base-frame", help="the frame in which the robot's root link stands (default: the root link)")
    words.add_joints(parser, "a joint that no JointState names")
    parser.add_argument(
        "--max-age", type=float, default=0.1, metavar="SECONDS", help="of joints and transforms (default: 0.1)"
    )
    parser.add_argument(
        "--nearest", type=float, default=0.0, metavar="METRES", help="from the sensor; nearer points do not count"
    )
    parser.add_argument(
        "--farthest", type=float, default=float("inf"), metavar="METRES", help="farther points do not count"
    )
    parser.add_argument(
        "--cloud-scale", type=float, metavar="METRES", help="per unit of the clouds (default: 1)"
    )
    parser.add_argument("--zero-is-missing", action="store_true", help="a point at the sensor is no point")
    for option, (metavar, what) in CROPS.items():
        parser.add_argument(option, action="append", default=[], metavar=metavar, help=what)


def robot(asked):
    """Robot.from_urdf's arguments."""
    return {
        "file": asked.robot,
        "model": asked.model,
        "spheres": asked.spheres,
        "packages": words.pairs(asked.package, "--package"),
        "exclude_links": asked.exclude_link,
        "gltf_up": asked.gltf_up,
    }


def frames(asked):
    """Arguments of play that add_frames asked for."""
    return {
        "camera_info": asked.camera_info,
        "base_frame": asked.base_frame,
        "joints": words.joints_of(asked),
        "max_age": asked.max_age,
        "nearest": asked.nearest,
        "farthest": asked.farthest,
        "zero_is_missing": asked.zero_is_missing,
        "crop": crops(asked),
        **({} if asked.cloud_scale is None else {"cloud_scale": asked.cloud_scale}),
    }


def seconds(row):
    """A row's stamp, without a float between."""
    return "nan" if row.stamp_ns is None else f"{row.stamp_ns // 10**9}.{row.stamp_ns % 10**9:09d}"


def sentence(row):
    """A row as a line."""
    if row.state in ("unknown", "no_data"):
        return f"{seconds(row)} {row.topic} {row.state}: {row.note or 'no valid point'}"
    note = f" ({row.note})" if row.note else ""
    return (
        f"{seconds(row)} {row.topic} {row.state}: {row.distance:z.4f} m "
        f"(certainly {row.lower:.4f} to {row.upper:.4f}), "
        f"{row.link} to point {row.point:,}{note}"
    )


class Printed:
    """Lines to the terminal. If whoever reads them goes, and files are written too, those are finished all the same."""

    def __init__(self, goes_on):
        self.goes_on, self.gone = goes_on, False

    def __call__(self, line):
        try:
            if not self.gone:
                print(line, flush=True)
        except BrokenPipeError:
            if not self.goes_on:
                raise
            self.gone = True

    def finish(self):
        """Says at the end what was not heard."""
        if self.gone:
            raise BrokenPipeError


def run(asked):
    if asked.margin is not None and not (asked.rerun or asked.report):
        raise ValueError("--margin is for --rerun and --report")
    if asked.rerun and pathlib.Path(asked.rerun).suffix.lower() != ".rrd":
        raise ValueError(f"--rerun writes an .rrd file, not {asked.rerun}")
    for option, file in (("--csv", asked.csv), ("--parquet", asked.parquet)):
        if file and pathlib.Path(file).resolve() == pathlib.Path(asked.recording).resolve():
            raise ValueError(f"{option} would overwrite the recording")
    report.check_page(asked)
    page = report.page_file(asked.report, "--report") if asked.report else None
    options = {
        "topics": asked.topic,
        "device": asked.device,
        "joint_topic": asked.joint_topic,
        "tf_topics": asked.tf_topic,
        **frames(asked),
    }
    who = robot(asked)
    count = unknown = differ = 0
    least = None
    rows, damage, played = [], None, None
    say = Printed(asked.csv or asked.parquet or asked.report or asked.rerun)
    try:
        with contextlib.ExitStack() as files:
            into = [
                files.enter_context(kind(path)).write
                for kind, path in ((playing.Csv, asked.csv), (playing.Parquet, asked.parquet))
                if path
            ]
            each = None
            if asked.rerun:
                scenes = files.enter_context(rerun_file.Recording(asked.rerun))

                def each(row, sight):
                    scenes.add(sight.scene(margin=asked.margin), stamp=row.stamp)

            played = playing.play(asked.recording, who, check=asked.check, each=each, **options)
            for row in played:
                for write in into:
                    write(row)
                if page:
                    rows.append(row)
                if asked.rerun and row.state == "unknown":
                    scenes.add_unknown(sentence(row), stamp=row.stamp)
                say(sentence(row))
                count += 1
                unknown += row.state in ("unknown", "no_data")
                differ += not playing.agree(row)
                if row.state not in ("unknown", "no_data") and (least is None or row.distance < least.distance):
                    least = row
    except playing.Damaged as error:
        damage = str(error)
        raise
    finally:
        notes = played.notes if played else []
        for note in notes:
            print(f"note: {note}", file=sys.stderr)
        say(
            f"{count} frames, {unknown} of them unknown"
            + (f", {differ} of them differ from NumPy" if asked.check else "")
            + (f"; the least is {least.distance:z.4f} m at {seconds(least)} on {least.topic}" if least else "")
        )
        if rows:
            write_page(page, asked, rows, [damage, *notes] if damage else notes, who, options)
    say.finish()
    return 1 if differ or unknown == count else 0


def write_page(page, asked, rows, notes, who, options):
    """The page about rows. The worst are played again, to draw them."""
    moments = [pages.moment(playing.flat(row), k) for k, row in enumerate(rows)]
    drawn = {}

    def draw(row, sight):
        drawn[row.stamp_ns, row.topic] = png(render(sight.scene(margin=asked.margin), width=860, height=560)), ""

    worst = {(rows[k].stamp_ns, rows[k].topic): k for k in pages.worst(moments, asked.worst)}
    with contextlib.suppress(playing.Damaged):
        for _ in playing.play(asked.recording, who, each=draw, only=worst, **options):
            if len(drawn) == len(worst):
                break
    told = [("recording", asked.recording), ("robot", asked.robot), ("model", asked.model)]
    told += [(name.replace("_", " "), value) for name, value in options.items() if value]
    report.write(
        page,
        moments,
        asked,
        told=told,
        notes=notes,
        pictures={worst[key]: picture for key, picture in drawn.items()},
        title=pathlib.Path(asked.recording).name,
    )
