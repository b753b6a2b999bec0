# SPDX-License-Identifier: BSD-3-Clause
"""A person beside an arm: nothing that moves touches anybody while clearance watches, and with nobody watching it does."""

import ctypes.util
import importlib.util
import os
import pathlib
import sys

import numpy as np
import pytest

folder = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python" / "cell"


@pytest.fixture(scope="module")
def cell():
    if importlib.util.find_spec("mujoco") is None:  # not imported before world has chosen its renderer
        pytest.skip("needs the extra: pip install clearance[test]")
    if os.environ.get("MUJOCO_GL", "osmesa") == "osmesa" and ctypes.util.find_library("OSMesa") is None:
        pytest.skip("needs libosmesa6")
    sys.path.insert(0, str(folder))
    try:
        import episodes
        made = episodes.Cell()
        yield made
        made.world.close()
    finally:
        sys.path.remove(str(folder))


def test_nothing_that_moves_touches_anybody(cell):
    """Twenty episodes, four of each kind of person; six seconds each."""
    outcomes = [cell.run("clearance", seed, seconds=6) for seed in range(20)]
    assert [seed for seed, o in enumerate(outcomes) if o.contacts] == []
    assert sum(o.short for o in outcomes) == 0, "it was never faster than the true distance allows"
    assert np.mean([o.progress for o in outcomes]) > 1.5, "it works, too"
    assert any(o.least_moving < 0.5 for o in outcomes), "somebody came near"


def test_without_a_supervisor_people_are_hit(cell):
    outcomes = [cell.run("none", seed, seconds=6) for seed in range(5)]
    assert sum(o.contacts for o in outcomes) > 0
    assert all(o.progress > 5 for o in outcomes)


@pytest.mark.parametrize("who", ["clearance", "without unseen", "without radii"])
def test_without_a_valid_pixel_it_stops(cell, who):
    import supervisor
    import world

    blind = [np.zeros((world.HEIGHT, world.WIDTH), "f4")] * 2
    cameras = [world.looking(*of) for of in world.CAMERAS.values()]
    assert cell.judge(who).ask(supervisor.Frame(blind, cameras, cell.task.legs[0].start, 0, 0.0, 1.0)).share == 0


def test_an_episode_is_the_same_again(cell):
    first, again = (cell.run("clearance", 3, seconds=2) for _ in range(2))
    assert first == again


def test_a_person_is_no_faster_than_stated(cell):
    import episodes
    import person

    for seed, kind in enumerate(person.KINDS):
        motion = person.random_motion(kind, np.random.default_rng(seed), episodes.FASTEST)
        times = np.arange(-0.5, motion.duration + 0.5, 0.005)
        at = np.array([[end for pair in motion.at(t).values() for end in pair] for t in times])
        assert np.linalg.norm(np.diff(at, axis=0), axis=2).max() / 0.005 < 1.02 * episodes.FASTEST < cell.stated.human


def test_sensors_are_as_wrong_as_stated(cell):
    """Camera poses within what is stated; noise within three deviations but for a few pixels."""
    import world

    random, sensor, stated = np.random.default_rng(1), world.Sensor(), cell.stated
    for _ in range(20):
        for pose, (place, at) in zip(sensor.wrong_poses(random), world.CAMERAS.values()):
            off = np.linalg.inv(world.looking(place, at)) @ pose
            assert np.linalg.norm(off[:3, 3]) <= stated.shift + 1e-9
            assert np.arccos(np.clip((np.trace(off[:3, :3]) - 1) / 2, -1, 1)) <= stated.turn + 1e-6
            assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3))
    depth = np.full((108, 192), 2.0, "f4")
    seen = sensor.measured(depth, random)
    deviation = 4 * stated.disparity / (424 * 0.095)
    valid = seen > 0
    assert 0.99 < valid.mean() < 1 and 0.9 * deviation < (seen[valid] - 2).std() < 1.1 * deviation
