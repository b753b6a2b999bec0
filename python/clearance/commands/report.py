# SPDX-License-Identifier: BSD-3-Clause
"""Makes one HTML page of the rows that clearance run or clearance play wrote.

What was asked, clearance over time, the worst moments, dropped points, latency. With --robot, and the files that the
rows name, the worst moments get pictures; their distances are then asked again and compared with the rows.
"""

import csv
import math
import os
import pathlib

import numpy as np

from clearance import words

from . import view


def add(parser):
    parser.add_argument("rows", help="what clearance run printed (JSON or --csv), or what clearance play --csv wrote")
    parser.add_argument("--output", "-o", required=True, metavar="FILE.html", help="the page")
    parser.add_argument("--margin", type=float, help="metres")
    add_page(parser)
    add_pictures(parser)


def add_pictures(parser):
    """What pictures of the worst moments need."""
    pictures = parser.add_argument_group("for pictures, as they were given to clearance run")
    pictures.add_argument("--robot", metavar="FILE", help="URDF")
    pictures.add_argument(
        "--trajectory", metavar="FILE", help="CSV: names of joints, then one row for each frame, or one for all"
    )
    words.add_joints(pictures, "a joint without a column")
    pictures.add_argument("--ignore-limits", action="store_true", help="joints may be outside their limits")
    pictures.add_argument("--intrinsics", metavar="FX,FY,CX,CY", help="of depth images, pixels")
    pictures.add_argument("--depth-scale", type=float, help="metres per unit of a depth image (default: 0.001)")
    pictures.add_argument(
        "--camera-pose", metavar="X,Y,Z,QX,QY,QZ,QW", help="world-from-cloud, or link-from-cloud with --camera-link"
    )
    pictures.add_argument("--camera-link", metavar="LINK", help="the link that carries the camera")
    pictures.add_argument("--base-pose", metavar="X,Y,Z,QX,QY,QZ,QW", help="world-from-base")
    pictures.add_argument("--package", metavar="NAME=DIR", action="append", default=[], help="where package://NAME/ is")
    pictures.add_argument("--gltf-up", choices=("y", "z"), help="which axis of glTF meshes is up (default: a note says)")
    pictures.add_argument("--geometry", choices=("collision", "visual"), default="collision")
    pictures.add_argument("--exclude-link", metavar="LINK", action="append", default=[])
    pictures.add_argument(
        "--model", choices=("triangles", "spheres"), help="default: triangles; spheres with --spheres"
    )
    pictures.add_argument("--spheres", type=int, metavar="N", help="inner spheres per link")


def trajectory(file):
    """The names of the joints, and rows of values."""
    with open(file, newline="", encoding="utf-8") as text:
        lines = [line for line in csv.reader(text) if line]
    names = [name.strip() for name in lines[0]] if lines else []
    try:
        rows = [[float(word) for word in line] for line in lines[1:]]
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
    if not rows or any(len(row) != len(names) for row in rows):
        raise ValueError(f"{file} has a line with the names of the joints, then rows of as many numbers")
    return names, rows


class Pictures:
    """Draws moments of a recording, with what clearance run was given."""

    def __init__(self, asked):
        make, model = view.robot_maker(asked, asked.robot)
        self.robot, self.asked = make(model), asked
        self.names, self.rows = trajectory(asked.trajectory) if asked.trajectory else ([], [[]])
        self.fixed = words.by_name(self.robot, words.joints_of(asked))
        self.pose, self.base = words.pose(asked.camera_pose, "--camera-pose"), words.pose(asked.base_pose, "--base-pose")
        self.camera = tuple(words.numbers(asked.intrinsics, 4, "--intrinsics")) if asked.intrinsics else None

    def of(self, moment):
        """A PNG, and a sentence: what the picture's own answer is, where it differs from the row."""
        from clearance import seeing
        from clearance.seeing import files
        from clearance.seeing.pictures import render
        from clearance.seeing.raster import png

        if moment.file is None:
            return None, "no picture: the row names no file"
        file = self._found(moment.file)
        if len(self.rows) != 1 and moment.number >= len(self.rows):
            return None, f"no picture: the trajectory has no row {moment.number}"
        row = self.rows[0 if len(self.rows) == 1 else moment.number]
        joints = self.fixed | dict(zip(self.names, row))
        pose = np.eye(4) if self.pose is None else self.pose
        if self.asked.camera_link:
            carrier = self.robot.link_pose(self.asked.camera_link, joints, self.base, self.asked.ignore_limits)
            pose = np.asarray(carrier) @ pose
        if (
            file.suffix.lower() in (".png", ".tif", ".tiff")
            or file.suffix.lower() == ".npy"
            and self.camera is not None
        ):
            if self.camera is None:
                return None, "no picture: a depth image needs --intrinsics"
            seen = {
                "depth": files.read_depth(file),
                "intrinsics": self.camera,
                "depth_scale": self.asked.depth_scale,
                "camera_pose": pose,
            }
        else:
            seen = {"points": files.read_cloud(file)[0], "cloud_pose": pose}
        made = seeing.scene(
            self.robot,
            joints=joints,
            base=self.base,
            margin=self.asked.margin,
            ignore_limits=self.asked.ignore_limits,
            **seen,
        )
        answer = seeing.least_of(made.result)
        apart = abs(float(answer.distance) - moment.distance)
        within = max(moment.upper - moment.lower, float(answer.upper) - float(answer.lower), 1e-4)
        differs = not (apart <= within or moment.distance == answer.distance)
        said = (
            f"the picture's own answer is {answer.distance:z.4f} m: options or files differ from those of the row"
            if differs
            else ""
        )
        return png(render(made, width=860, height=560)), said

    def _found(self, name):
        for folder in ("", pathlib.Path(self.asked.rows).parent):
            if (file := folder / pathlib.Path(name)).is_file():
                return file
        raise ValueError(f"{name}, which the rows name, is no file (neither from here nor from the rows' folder)")


def page_file(name, option="--output"):
    """The page's path."""
    output = pathlib.Path(name)
    if output.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"{option} writes an .html file, not {output}")
    if not output.parent.is_dir():
        raise ValueError(f"{option}: there is no folder {output.parent}")
    if output.is_dir() or not os.access(output if output.exists() else output.parent, os.W_OK):
        raise ValueError(f"{option}: {output} cannot be written")
    return output


def add_page(parser):
    """How the page is made, whoever makes it."""
    parser.add_argument("--worst", type=int, default=3, metavar="N", help="how many moments are shown (default: 3)")
    parser.add_argument("--title", help="of the page (default: the name of what it is about)")


def check_page(asked):
    if asked.worst < 0:
        raise ValueError(f"--worst is {asked.worst}; it is 0 or more")


def drawn(moments, count, draw):
    """{index of a moment: (PNG or None, sentence)} of the worst ones, and notes. draw: from a moment to that pair."""
    from clearance.seeing import report

    pictures, notes = {}, []
    for number, k in enumerate(report.worst(moments, count), 1):
        try:
            pictures[k] = draw(moments[k])
        except (ValueError, RuntimeError, OSError) as error:
            pictures[k] = None, f"no picture: {str(error).removeprefix('clearance: ')}"
        if pictures[k][1]:
            notes.append(f"moment {number}: {pictures[k][1]}")
    return pictures, notes


def write(output, moments, asked, *, told, notes=(), pictures=None, title, to=None):
    """Writes the page, and says so."""
    from clearance.seeing import report

    text = report.page(
        moments,
        asked=told,
        margin=asked.margin,
        notes=notes,
        pictures=pictures,
        count=asked.worst,
        title=asked.title or title,
    )
    output.write_text(text, encoding="utf-8")
    for note in notes:
        print(f"note: {note}", file=to)
    least = min((m.lower for m in moments), default=math.nan)
    print(f"{len(moments)} frames, least lower end {least:z.3f} m; written: {output}", file=to)


def pictures_of(asked, moments):
    """Pictures, notes and what was asked, of options that were given to clearance run."""
    draws = Pictures(asked)
    told = [("robot", asked.robot), ("parts", ", ".join(draws.robot.parts)), ("model", draws.robot.model)]
    pictures, notes = drawn(moments, asked.worst, draws.of)
    return pictures, notes + draws.robot.notes, told


def run(asked):
    from clearance.seeing import report

    output = page_file(asked.output)
    if output.resolve() == pathlib.Path(asked.rows).resolve():
        raise ValueError("--output would overwrite the rows")
    check_page(asked)
    moments, notes = report.read_rows(asked.rows)
    pictures, told = {}, [("rows", asked.rows)]
    if asked.robot:
        pictures, said, about = pictures_of(asked, moments)
        notes, told = notes + said, told + about
    elif asked.trajectory or asked.intrinsics or asked.camera_pose:
        raise ValueError("--trajectory, --intrinsics and --camera-pose are for pictures, which need --robot")
    for name in ("trajectory", "intrinsics", "camera_pose", "camera_link", "base_pose"):
        if getattr(asked, name):
            told.append((name.replace("_", " "), getattr(asked, name)))
    write(output, moments, asked, told=told, notes=notes, pictures=pictures, title=pathlib.Path(asked.rows).name)
