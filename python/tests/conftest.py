# SPDX-License-Identifier: BSD-3-Clause
"""What the tests share: a small arm, clouds, and real robots and frames where they are beside the checkout."""

import os
import pathlib
import struct

import numpy as np
import pytest

import clearance

ARM = """<?xml version="1.0"?>
<robot name="demo_arm">
  <link name="base">
    <collision><origin xyz="0 0 0.1"/><geometry><box size="0.3 0.3 0.2"/></geometry></collision>
  </link>
  <link name="upper">
    <collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.06" length="0.4"/></geometry></collision>
  </link>
  <link name="lower">
    <collision><origin xyz="0 0 0.15"/><geometry><box size="0.08 0.08 0.3"/></geometry></collision>
  </link>
  <link name="hand">
    <collision><origin xyz="0 0 0.05"/><geometry><box size="0.1 0.04 0.1"/></geometry></collision>
  </link>
  <link name="eye"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2.5" upper="2.5" effort="1" velocity="1"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="lower"/><child link="hand"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="hand"/><child link="eye"/><origin xyz="0 0.03 0.1"/>
  </joint>
</robot>
"""


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    """Packings go to a folder of this run, so that no test reads what another version has packed."""
    before = os.environ.get("XDG_CACHE_HOME")
    os.environ["XDG_CACHE_HOME"] = str(tmp_path_factory.mktemp("cache"))
    yield
    if before is None:
        del os.environ["XDG_CACHE_HOME"]
    else:
        os.environ["XDG_CACHE_HOME"] = before


@pytest.fixture
def arm_file(tmp_path):
    """A URDF file: four links of boxes and a cylinder, three joints, and a link without geometry."""
    file = tmp_path / "arm.urdf"
    file.write_text(ARM)
    return file


@pytest.fixture
def arm(arm_file):
    return clearance.Robot.from_urdf(str(arm_file), model="triangles")


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def rigid(rng, reach=0.5):
    """A random pose, (4, 4)."""
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3] = rotation * np.sign(np.linalg.det(rotation))
    pose[:3, 3] = rng.uniform(-reach, reach, 3)
    return pose


def moved(pose, points):
    """Points by a pose, in double."""
    return np.asarray(points, "f8") @ pose[:3, :3].T + pose[:3, 3]


def random_robot(rng, parts=3, spheres=20):
    """A robot of spheres, its spheres in double by part, and the poses of its parts."""
    of = {}
    for k in range(parts):
        centres = rng.uniform(-0.2, 0.2, (spheres, 3))
        of[f"part {k}"] = np.column_stack([centres, rng.uniform(0.02, 0.08, spheres)]).astype("f4")
    poses = np.stack([rigid(rng) for _ in range(parts)])
    return clearance.Robot.from_spheres(of), [s.astype("f8") for s in of.values()], poses


def shared_data():
    """The folder of real robots and frames beside the checkout, or None."""
    for folder in pathlib.Path(__file__).resolve().parents:
        if (found := folder / "shared" / "data").is_dir():
            return found
    return None


def shared(path):
    """A file of real data; the test is skipped where it is not."""
    data = shared_data()
    if data is None or not (data / path).exists():
        pytest.skip(f"needs ../shared/data/{path}")
    return data / path


def lzf(data, size):
    """The bytes that liblzf packed."""
    out, at = bytearray(), 0
    while at < len(data):
        control = data[at]
        at += 1
        if control < 32:
            out += data[at:at + control + 1]
            at += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[at]
            at += 1
        back = len(out) - ((control & 31) << 8) - data[at] - 1
        at += 1
        for _ in range(length + 2):
            out.append(out[back])
            back += 1
    assert len(out) == size, "the packed bytes are not as many as their head says"
    return bytes(out)


def read_pcd(file):
    """The points of a PCD file of floats, (n, 3): a plain reader, so that the tests do not read by what they test."""
    raw = file.read_bytes()
    end = raw.index(b"\n", raw.index(b"\nDATA")+1) + 1
    head = dict(line.split(None, 1) for line in raw[:end].decode().splitlines() if line and not line.startswith("#"))
    names, kinds, sizes = head["FIELDS"].split(), head["TYPE"].split(), [int(s) for s in head["SIZE"].split()]
    counts, n = [int(c) for c in head.get("COUNT", "1 " * len(names)).split()], int(head["POINTS"])
    kind = head["DATA"].strip()
    if kind == "ascii":
        rows = np.loadtxt(raw[end:].decode().splitlines(), ndmin=2)
        first = np.cumsum([0, *counts])
        return np.column_stack([rows[:, first[names.index(axis)]] for axis in "xyz"]).astype("f4")
    types = [f"{'f' if k == 'F' else k.lower()}{s}" for k, s in zip(kinds, sizes)]
    if kind == "binary":
        record = np.dtype([(f"{name}{i}" if name == "_" else name, t, (c,))
                           for i, (name, t, c) in enumerate(zip(names, types, counts))])
        rows = np.frombuffer(raw, record, n, end)
        return np.column_stack([rows[axis][:, 0] for axis in "xyz"])
    packed, whole = struct.unpack_from("<II", raw, end)
    body = lzf(raw[end + 8:end + 8 + packed], whole)
    axes, at = {}, 0
    for name, t, size, count in zip(names, types, sizes, counts):
        axes[name] = np.frombuffer(body, t, n * count, at)
        at += n * size * count
    return np.column_stack([axes[axis] for axis in "xyz"])
