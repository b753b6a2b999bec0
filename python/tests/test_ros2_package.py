# SPDX-License-Identifier: BSD-3-Clause
"""The package for ROS 2, without ROS 2: its node against messages of Debian's rosidl and stand-ins for rclcpp and tf2."""

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

SYSTEM = {"PATH": "/usr/bin:/bin"}  # Debian's CMake and Python, which has ament's and rosidl's modules
PARTS = {  # of ROS's own messages: what the node uses
    "builtin_interfaces": ("Time", ()),
    "std_msgs": ("Header", ("builtin_interfaces",)),
    "geometry_msgs": ("Point", ()),
    "sensor_msgs": ("PointCloud2 PointField Image CameraInfo RegionOfInterest Range", ("std_msgs",)),
}
PACKAGE_XML = """<package format="3"><name>{name}</name><version>0.1.0</version><description>A part of it.</description>
<maintainer email="clearance@example.org">The clearance authors</maintainer><license>BSD-3-Clause</license>
<buildtool_depend>ament_cmake</buildtool_depend>{depends}
<member_of_group>rosidl_interface_packages</member_of_group><export><build_type>ament_cmake</build_type></export></package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.16)
project({name} C CXX)
foreach(package ament_cmake rosidl_default_generators {needs})
  find_package(${{package}} REQUIRED)
endforeach()
rosidl_generate_interfaces({name} {files} DEPENDENCIES {needs})
ament_export_dependencies({needs})
ament_package()
"""


def write_messages(folder):
    """Packages of the messages that ROS has, from rosbags' definitions."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.LATEST)
    for name, (kinds, needs) in PARTS.items():
        (folder / name / "msg").mkdir(parents=True)
        for kind in kinds.split():
            text = store.generate_msgdef(f"{name}/msg/{kind}", ros_version=2)[0]
            (folder / name / "msg" / f"{kind}.msg").write_text(text.split("=" * 80)[0])
        depends = "".join(f"<depend>{each}</depend>" for each in needs)
        (folder / name / "package.xml").write_text(PACKAGE_XML.format(name=name, depends=depends))
        files = " ".join(f"msg/{kind}.msg" for kind in kinds.split())
        (folder / name / "CMakeLists.txt").write_text(CMAKE.format(name=name, files=files, needs=" ".join(needs)))


def install(source, folder, *options):
    """Builds a package as colcon would, into folder / "install"."""
    build = folder / "build" / source.name
    stand_ins = [f"-D{each.name.removesuffix('Config.cmake')}_DIR={each.parent}" for each in STAND_INS.glob("cmake/*.cmake")]
    words = ["-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -Wall -Wextra", "-DPython3_EXECUTABLE=/usr/bin/python3"]
    words += [f"-DCMAKE_PREFIX_PATH={folder / 'install'}", f"-DCMAKE_INSTALL_PREFIX={folder / 'install'}", *stand_ins]
    for command in (
        ["cmake", "-S", source, "-B", build, "-Wno-dev", "--no-warn-unused-cli", *words, *options],
        ["cmake", "--build", build, "--parallel", "2"],
        ["cmake", "--install", build],
    ):
        done = subprocess.run(command, capture_output=True, text=True, env=SYSTEM)
        assert done.returncode == 0, (done.stdout + done.stderr)[-6000:]
        assert "warning:" not in done.stdout + done.stderr, (done.stdout + done.stderr)[-6000:]


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """clearance_msgs and the messages that it and the node need, built by Debian's ament and rosidl."""
    have = subprocess.run(["/usr/bin/python3", "-c", "import rosidl_generator_cpp, ament_package"], capture_output=True)
    if have.returncode or not shutil.which("cmake", path=SYSTEM["PATH"]):
        pytest.skip("ament and rosidl are not installed (Debian: ament-cmake rosidl-generator-c-cpp)")
    folder = tmp_path_factory.mktemp("ros2")
    write_messages(folder / "source")
    for name in PARTS:
        install(folder / "source" / name, folder)
    install(ROOT / "python" / "clearance_msgs", folder)
    return folder


@pytest.fixture(scope="module")
def node(workspace):
    """The node, built by its own CMake project with stand-ins for rclcpp and tf2."""
    if not pathlib.Path("/usr/include/yaml-cpp").is_dir():
        pytest.skip("what the component io needs is not installed")
    off = [f"-DCLEARANCE_BUILD_{each}=OFF" for each in ("TESTS", "EXAMPLES", "BENCH", "TOOLS")]
    install(ROOT, workspace, *off, "-DCLEARANCE_CUDA=OFF")
    install(PACKAGE, workspace)
    urdf = workspace / "ball.urdf"
    box = '<collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision>'
    urdf.write_text(f'<robot name="r"><link name="ball">{box}</link></robot>')

    def run(*parameters):
        program = workspace / "install" / "lib" / "clearance_ros" / "clearance_node"
        return subprocess.run([program, f"urdf:={urdf}", "spheres:=64", *parameters], capture_output=True, text=True)

    run.robot = clearance.Robot.from_urdf(urdf, spheres=64)
    return run


def test_the_messages_are_made_for_c_and_for_cpp(workspace):
    made = workspace / "install" / "include" / "clearance_msgs" / "clearance_msgs" / "msg"
    for name in ("clearance", "dropped", "part_clearance"):
        assert (made / f"{name}.h").is_file() and (made / f"{name}.hpp").is_file()
    assert (workspace / "install" / "lib" / "libclearance_msgs__rosidl_generator_c.so").is_file()


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
        (("cloud:=/a", "spheres:=-1"), "spheres is -1; it is 1 or more"),
    ):
        done = node(*parameters)
        assert done.returncode == 1 and says in done.stderr


def test_the_package_names_what_its_source_includes():
    package = xml.etree.ElementTree.parse(PACKAGE / "package.xml").getroot()
    depends = {each.text for each in package.findall("depend")}
    source = (PACKAGE / "src" / "clearance_node.cpp").read_text()
    includes = [line.split("<")[1] for line in source.splitlines() if line.startswith("#include <")]
    assert {each.split("/")[0] for each in includes if "/" in each} == depends
