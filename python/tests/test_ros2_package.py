# SPDX-License-Identifier: BSD-3-Clause
"""The package for ROS 2, without ROS 2: its node against messages of Debian's rosidl and stand-ins for rclcpp and tf2."""

import json
import math
import pathlib
import shutil
import subprocess
import xml.etree.ElementTree

import pytest

import clearance

pytest.importorskip("rosbags", reason="rosbags is not installed (extra ros)")

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "packaging" / "ros2" / "clearance_ros"
STAND_INS = pathlib.Path(__file__).resolve().parent / "ros2_stand_ins"

GENERATE = """
import json, pathlib, sys
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_generator_cpp import generate_cpp
folder = pathlib.Path(sys.argv[1])
for package in sorted(each for each in folder.iterdir() if (each / "msg").is_dir()):
    names = []
    for each in sorted((package / "msg").glob("*.msg")):
        convert_msg_to_idl(package, package.name, each.relative_to(package), package / "msg")
        names.append(f"{package}:msg/{each.stem}.idl")
    arguments = {
        "package_name": package.name, "output_dir": str(folder / "include" / package.name), "idl_tuples": names,
        "template_dir": "/usr/share/rosidl_generator_cpp/resource", "ros_interface_dependencies": [],
        "target_dependencies": [],
    }
    (package / "arguments.json").write_text(json.dumps(arguments))
    generate_cpp(str(package / "arguments.json"))
"""


def messages(folder):
    """Headers of all messages that the node uses, made by rosidl."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.LATEST)
    for kind in store.fielddefs:
        package, _, name = kind.split("/")
        if package in ("builtin_interfaces", "std_msgs", "geometry_msgs", "sensor_msgs") and name in (
            "Time Header Point PointCloud2 PointField Image CameraInfo RegionOfInterest Range".split()
        ):
            (folder / package / "msg").mkdir(parents=True, exist_ok=True)
            text = store.generate_msgdef(kind, ros_version=2)[0]
            (folder / package / "msg" / f"{name}.msg").write_text(text.split("=" * 80)[0])
    shutil.copytree(ROOT / "python" / "clearance_msgs" / "msg", folder / "clearance_msgs" / "msg")
    done = subprocess.run(["/usr/bin/python3", "-c", GENERATE, folder], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def node(tmp_path_factory):
    """The node as a program, with stand-ins for ROS 2."""
    have = subprocess.run(["/usr/bin/python3", "-c", "import rosidl_generator_cpp, rosidl_adapter"], capture_output=True)
    if have.returncode or not pathlib.Path("/usr/include/rosidl_runtime_cpp").is_dir():
        pytest.skip("rosidl is not installed (Debian: rosidl-generator-c-cpp librosidl-runtime-c-cpp-dev)")
    if not shutil.which("g++") or not pathlib.Path("/usr/include/yaml-cpp").is_dir():
        pytest.skip("there is no compiler, or no yaml-cpp")
    folder = tmp_path_factory.mktemp("ros2")
    messages(folder)
    include = [ROOT / "include", STAND_INS, PACKAGE / "src", folder / "include", "/usr/include/eigen3"]
    include += ["/usr/include/stb", "/usr/include/rosidl_runtime_cpp", "/usr/include/rosidl_runtime_c"]
    include += ["/usr/include/rosidl_typesupport_interface"]
    words = [word for each in include for word in ("-isystem" if "/usr" in str(each) else "-I", str(each))]
    libraries = ["-ltbb", "-lexpat", "-lyaml-cpp", "-lxxhash", "-llzf", "-lpthread"]
    words += ["-std=c++20", "-O1", "-Wall", "-Wextra", "-o", str(folder / "node"), str(STAND_INS / "frames.cpp")]
    done = subprocess.run(["g++", *words, *libraries], capture_output=True, text=True)
    assert done.returncode == 0 and not done.stderr, done.stderr[:4000]
    (folder / "ball.urdf").write_text(
        '<robot name="r"><link name="ball"><collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision></link></robot>'
    )

    def run(*parameters):
        words = [f"urdf:={folder / 'ball.urdf'}", "spheres:=64", *parameters]
        return subprocess.run([folder / "node", *words], capture_output=True, text=True)

    run.robot = clearance.Robot.from_urdf(folder / "ball.urdf", spheres=64)
    return run


def rows(done):
    assert done.returncode == 0 and done.stderr == "", done.stderr
    for line in done.stdout.splitlines():
        words, _, note = line.partition("|")
        state, distance, lower, upper, link, point, seen, valid, dropped, part, range_, topic = words.split()
        yield (int(state), float(distance), float(lower), float(upper), link, int(point), int(seen), int(valid),
               int(dropped), float(part), float(range_), topic, note)  # fmt: skip


def test_the_node_says_of_a_cloud_what_python_says(node):
    known, unknown = rows(node("cloud:=/cloud"))
    pose = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.5], [0, 0, 0, 1]]
    right = clearance.Query(node.robot, clearance.MinDistance())(
        [[0.0, 0, 3], [0, 0.5, 1], [0, 0, math.nan]], cloud_pose=pose
    )
    assert known[:4] == (2, *(pytest.approx(each, abs=1e-8) for each in (right.distance, right.lower, right.upper)))
    assert known[4:9] == ("ball", 1, 3, 2, 1) and known[9] == pytest.approx(right.distance, abs=1e-8)
    assert known[10] == pytest.approx(right.lower, abs=1e-8) and known[11:] == ("/cloud", "")
    assert unknown[0] == 0 and math.isnan(unknown[1]) and unknown[2:6] == (0, math.inf, "-", 0xFFFFFFFF)
    assert unknown[10] == -math.inf and unknown[12] == "no transform from nowhere to base_link"


def test_the_node_reads_a_depth_image_of_its_camera_only(node):
    early, known, other = rows(node("image:=/depth/image"))
    assert early[0] == 0 and early[12] == "no CameraInfo was heard yet"
    right = clearance.Query(node.robot, clearance.MinDistance())([[0.0, 0, 2.5]])  # the pixel at cx, cy
    assert known[0] == 2 and known[1] == pytest.approx(right.distance, abs=1e-6) and known[5:9] == (19, 32, 1, 1)
    assert other[0] == 0 and "rays for 8 x 4 pixels, but the image has 6 x 4" in other[12]


def test_what_is_not_asked_or_is_no_robot_is_a_sentence(node):
    for parameters, says in (
        ((), "say one topic: cloud or image"),
        (("cloud:=/a", "image:=/b"), "say one topic: cloud or image"),
        (("cloud:=/a", "urdf:=/no/arm.urdf"), "/no/arm.urdf"),
    ):
        done = node(*parameters)
        assert done.returncode == 1 and says in done.stderr


def test_the_package_names_what_its_source_includes():
    package = xml.etree.ElementTree.parse(PACKAGE / "package.xml").getroot()
    depends = {each.text for each in package.findall("depend")}
    said = (PACKAGE / "CMakeLists.txt").read_text()
    source = (PACKAGE / "src" / "clearance_node.cpp").read_text()
    used = {line.split("<")[1].split("/")[0] for line in source.splitlines() if line.startswith("#include <") and "/" in line}
    assert used <= depends and json.dumps(sorted(depends - {"clearance"})) == json.dumps(
        sorted(said.split("set(needs ")[1].split(")")[0].split())
    )
