# SPDX-License-Identifier: BSD-3-Clause
"""Shows a robot, what its sensor sees and the shortest segment between them: a number and a picture.

Without --rerun, --picture or --page it prints the number and writes clearance.png. Without a robot it shows a small
scene of its own: an arm before a table with boxes.
"""

import pathlib
import tempfile

import numpy as np

from clearance import words
from clearance.words import numbers, pairs, pose


def add(parser):
    parser.add_argument("robot", nargs="?", help="robot description, URDF (default: a small arm)")
    parser.add_argument(
        "--cloud",
        nargs="+",
        metavar="FILE",
        action="extend",
        help="point clouds: .npy .npz .pcd .ply .txt .xyz .csv .las .laz; several are seen together",
    )
    parser.add_argument("--depth", metavar="FILE", help="a depth image: 16-bit .png, or .npy")
    parser.add_argument("--intrinsics", metavar="FX,FY,CX,CY", help="of the depth image, pixels")
    parser.add_argument(
        "--depth-scale", type=float, help="metres per unit of a depth image (default: 0.001; 1 for float32)"
    )
    parser.add_argument("--cloud-scale", type=float, metavar="METRES", help="per unit of the clouds (default: 1)")
    parser.add_argument(
        "--pose",
        metavar="X,Y,Z,QX,QY,QZ,QW",
        help="world-from-cloud or world-from-camera (default: the world's origin)",
    )
    words.add_joints(parser, "a joint; others are at rest")
    parser.add_argument("--base", metavar="X,Y,Z,QX,QY,QZ,QW", help="world-from-base (default: the world's origin)")
    parser.add_argument("--package", metavar="NAME=DIR", action="append", default=[], help="where package://NAME/ is")
    parser.add_argument("--gltf-up", choices=("y", "z"), help="which axis of glTF meshes is up (default: a note says)")
    parser.add_argument("--geometry", choices=("collision", "visual"), default="collision")
    parser.add_argument(
        "--exclude-link", metavar="LINK", action="append", default=[], help="leave out this link's geometry"
    )
    parser.add_argument("--model", choices=("triangles", "spheres"), help="default: triangles; spheres with --spheres")
    parser.add_argument("--spheres", type=int, metavar="N", help="inner spheres per link")
    parser.add_argument("--zones", metavar="D,...", help="thresholds in metres: points get the colours of their zones")
    parser.add_argument("--margin", type=float, help="metres: said with the number")
    parser.add_argument(
        "--farthest", type=float, default=0.5, help="up to which distance points have colours (default: 0.5 m)"
    )
    parser.add_argument(
        "--points", type=int, default=30000, metavar="N", help="draw about N points at most; 0: all (default: 30000)"
    )
    parser.add_argument("--device", default="cpu", help='of the live page: "cpu" (default) or "cuda:0"')
    parser.add_argument("--picture", metavar="FILE.png", help="write a picture")
    parser.add_argument("--rerun", metavar="FILE.rrd", help="write a recording for rerun")
    parser.add_argument("--page", action="store_true", help="serve a live page with sliders, until Ctrl-C")
    parser.add_argument("--port", type=int, help="of the live page (default: 8080); implies --page")
    parser.add_argument("--host", default="127.0.0.1", help="of the live page (default: only this machine)")


def robot_maker(asked, file):
    """A function (model) -> robot, and the model that was asked for."""
    import clearance

    if asked.model == "triangles" and asked.spheres is not None:
        raise ValueError("--spheres is for --model spheres")
    packages = pairs(asked.package, "--package")

    def make(model):
        return clearance.Robot.from_urdf(
            file,
            model=model,
            spheres=asked.spheres if model == "spheres" else None,
            geometry=asked.geometry,
            packages=packages,
            exclude_links=asked.exclude_link,
            gltf_up=asked.gltf_up,
        )

    return make, asked.model or ("spheres" if asked.spheres is not None else "triangles")


def scaled(points, scale):
    """Points in metres, whose file has other units."""
    from clearance.seeing import scenes

    if not 1e-9 <= scale <= 1e9:
        raise ValueError(f"--cloud-scale is {scale} metres per unit; it is from 1e-9 to 1e9")
    return scenes.as_points(points) * np.float64(scale)


def seen_of(asked, say):
    """What the sensor sees: the arguments of a call."""
    from clearance.seeing import files

    if asked.cloud and asked.depth:
        raise ValueError("give --cloud or --depth, not both")
    if asked.cloud_scale is not None and not asked.cloud:
        raise ValueError("--cloud-scale is for --cloud")
    if asked.depth:
        if asked.intrinsics is None:
            raise ValueError("--depth needs --intrinsics FX,FY,CX,CY")
        return {
            "depth": files.read_depth(asked.depth),
            "intrinsics": tuple(numbers(asked.intrinsics, 4, "--intrinsics")),
            "depth_scale": asked.depth_scale,
            "camera_pose": pose(asked.pose, "--pose"),
        }
    if asked.intrinsics or asked.depth_scale is not None:
        raise ValueError("--intrinsics and --depth-scale are for --depth")
    if not asked.cloud:
        raise ValueError("a robot needs something before it: --cloud FILE, or --depth FILE --intrinsics FX,FY,CX,CY")
    read = []
    for file in asked.cloud:
        points, notes = files.read_cloud(file)
        for note in notes:
            say(note)
        read.append(points if asked.cloud_scale is None else scaled(points, asked.cloud_scale))
    points = (
        read[0] if len(read) == 1 else np.concatenate([p.reshape(-1, 3).astype(np.result_type(*read)) for p in read])
    )
    return {"points": points, "cloud_pose": pose(asked.pose, "--pose")}


def run(asked):
    from clearance import seeing
    from clearance.seeing import demo

    def say(note):
        print(f"note: {note}")

    for option, file, end in (("--picture", asked.picture, ".png"), ("--rerun", asked.rerun, ".rrd")):
        if file is not None and pathlib.Path(file).suffix.lower() != end:
            raise ValueError(f"{option} writes a {end} file, not {file}")
    joints = words.joints_of(asked)
    with tempfile.TemporaryDirectory() as folder:
        if asked.robot is None:
            if asked.cloud or asked.depth:
                raise ValueError("--cloud and --depth need a robot: clearance view ROBOT.urdf ...")
            make, model = robot_maker(asked, demo.write_urdf(folder))
            seen = {"depth": demo.depth_image(), "intrinsics": demo.CAMERA, "camera_pose": demo.camera_pose()}
            joints = demo.JOINTS | joints if isinstance(joints, dict) else joints
            say("a scene made by code: an arm before a table; clearance view ROBOT.urdf --cloud FILE shows yours")
        else:
            make, model = robot_maker(asked, asked.robot)
            seen = seen_of(asked, say)
        robot = make(model)
        for note in robot.notes:
            say(note)
        joints = words.by_name(robot, joints)
        resting = [name for name in robot.joints if name not in joints]
        for name in joints:
            if name in robot.mimics:
                say(f"joint {name} has a value of its own here, which wins over <mimic>")
        if resting:
            say(f"at rest: {', '.join(resting)}")
        what = {
            **seen,
            "joints": joints,
            "rest": True,
            "base": pose(asked.base, "--base"),
            "margin": asked.margin,
            "zones": numbers(asked.zones, None, "--zones") if asked.zones else None,
            "farthest": asked.farthest,
            "most": asked.points,
        }
        if asked.page or asked.port is not None:
            if asked.picture or asked.rerun:
                raise ValueError("--page stays until Ctrl-C; write --picture and --rerun without it")
            seeing.show(robot, port=asked.port or 8080, host=asked.host, remake=make, device=asked.device, **what)
            return 0
        made = seeing.scene(robot, **what)
        print(made.title)
        least = seeing.least_of(made.result)
        if least.state.name != "no_data" and least.distance > 50:
            option = "--cloud-scale" if asked.cloud else "--depth-scale"
            say(f"no point is within 50 m of the robot: are they in metres? ({option})")
        written = []
        if asked.rerun:
            written.append(seeing.show(made, rerun=asked.rerun))
        if asked.picture or not asked.rerun:
            written.append(seeing.picture(made, output=asked.picture or "clearance.png"))
        print("written: " + ", ".join(written))
    return (
        3 if least.state.name == "no_data" else 2 if asked.margin is not None and not least.lower > asked.margin else 0
    )
