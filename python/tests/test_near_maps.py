# SPDX-License-Identifier: BSD-3-Clause
"""A robot with fields or cells answers as it does without them, in every bit."""

import copy
import pickle

import numpy as np
import pytest
from conftest import random_robot, rigid
from test_errors import refused

import clearance

SMALL = 40_000  # bytes; a field of fewer than 512 cubes a box is refused
PLANS = [clearance.MinDistances(), clearance.MinDistances(d_max=0.2), clearance.MinDistancesPerPart(d_max=0.3),
         clearance.InCollisions(0.05)]


def rows(robot, question, points, **where):
    r = clearance.Query(robot, question)(points, **where)
    return (r.all if isinstance(question, clearance.MinDistancesPerPart) else r.of).tobytes()


def test_configurations_have_the_same_bits_with_fields_of_spheres(rng):
    robot, _, _ = random_robot(rng)
    plan = np.stack([[rigid(rng) for _ in range(3)] for _ in range(200)])
    points = rng.normal(0, 0.6, (3000, 3)).astype("f4")
    fielded = robot.with_fields(SMALL)
    assert fielded.has_fields and not robot.has_fields
    assert (fielded.parts, fielded.model, fielded.notes, repr(fielded)) == (robot.parts, robot.model, robot.notes, repr(robot))
    for question in PLANS:
        assert rows(fielded, question, points, poses=plan) == rows(robot, question, points, poses=plan), question
    for question in clearance.MinDistance(), clearance.MinDistancePerPart():
        one, other = (clearance.Query(r, question)(points, poses=plan[0]) for r in (robot, fielded))
        assert repr(one) == repr(other)


def test_configurations_have_the_same_bits_with_fields_of_triangles(arm, rng):
    q, points = rng.uniform(-1.5, 1.5, (200, 3)), rng.normal(0, 0.8, (3000, 3)).astype("f4")
    fielded = arm.with_fields(bytes=SMALL, device="cpu")
    assert fielded.has_fields and fielded.joints == arm.joints
    for question in PLANS:
        assert rows(fielded, question, points, joints=q) == rows(arm, question, points, joints=q), question
    for again in pickle.loads(pickle.dumps(fielded)), copy.deepcopy(fielded):
        assert again.has_fields and rows(again, PLANS[0], points, joints=q) == rows(arm, PLANS[0], points, joints=q)
    assert arm.with_fields(SMALL).with_fields(SMALL).has_fields


def test_fields_are_kept_in_the_cache_and_only_there(rng, tmp_path, monkeypatch):
    monkeypatch.setenv("CLEARANCE_CACHE", str(tmp_path))
    robot, _, _ = random_robot(rng)
    plan = np.stack([[rigid(rng) for _ in range(3)] for _ in range(50)])
    points = rng.normal(0, 0.6, (500, 3)).astype("f4")
    assert robot.with_fields(SMALL, cache=False).has_fields and not list(tmp_path.iterdir())
    first = robot.with_fields(SMALL)
    kept = {f: f.stat().st_mtime_ns for f in tmp_path.iterdir()}
    assert len(kept) == 3 and {f.suffix for f in kept} == {".fields"}
    again = pickle.loads(pickle.dumps(robot.with_fields(SMALL)))
    assert {f: f.stat().st_mtime_ns for f in tmp_path.iterdir()} == kept  # read, not written anew
    for its in first, again:
        assert its.has_fields and rows(its, PLANS[0], points, poses=plan) == rows(robot, PLANS[0], points, poses=plan)
    file = min(kept)
    file.write_bytes(file.read_bytes()[:-1] + b"?")
    assert rows(robot.with_fields(SMALL), PLANS[0], points, poses=plan) == rows(robot, PLANS[0], points, poses=plan)
    assert file.stat().st_mtime_ns != kept[file]


def test_why_there_is_no_field_is_a_note_and_what_is_wrong_is_refused(rng):
    robot = clearance.Robot.from_spheres({"huge": [[0, 0, 0, 2e6]], "small": [[0, 0, 0, 0.1]]})
    bare = robot.with_fields(SMALL)
    assert not bare.has_fields
    assert bare.notes == ['part "huge": a part without a finite size has no field; so no field is used']
    points, plan = np.array([[0, 0, 3.0]], "f4"), np.stack([[rigid(rng), rigid(rng)]])
    assert rows(bare, PLANS[0], points, poses=plan) == rows(robot, PLANS[0], points, poses=plan)
    few = robot.with_fields(bytes=16)
    assert not few.has_fields and few.notes[1].startswith('part "small": 16 bytes are too few for a field; it needs ')
    for wrong in -1, 0.5, "much", None:
        refused(lambda: robot.with_fields(bytes=wrong), "bytes is a whole number, 0 or more")
    refused(lambda: robot.with_fields(device="gpu"), "device")
    with pytest.raises(AttributeError):
        robot.has_fields = True


CELLS = {"bytes": 4_000_000, "reach": 0.3}


def every_distance(robot, points, **where):
    return [tuple(getattr(r, what).tobytes() for what in ("distance", "part", "primitive"))
            for d_max in (0.2, np.inf)
            for r in [clearance.Query(robot, clearance.Distances(d_max=d_max, which=True))(points, **where)]]


def test_every_distance_has_the_same_bits_with_cells_and_with_both_maps(rng):
    spheres, _, poses = random_robot(rng)
    corners = np.vstack([np.zeros(3), 0.3 * np.eye(3)]), np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    mesh = clearance.Robot.from_meshes({"corner": corners}, model="triangles")
    points = rng.normal(0, 0.8, (3000, 3)).astype("f4")
    for robot, where in (spheres, {"poses": poses}), (mesh, {"poses": poses[:1]}):
        celled = robot.with_cells(**CELLS)
        assert celled.has_cells and not celled.has_fields and not robot.has_cells and celled.notes == robot.notes
        for both in celled.with_fields(SMALL), robot.with_fields(SMALL).with_cells(**CELLS), pickle.loads(pickle.dumps(celled)):
            assert both.has_cells
            assert every_distance(both, points, **where) == every_distance(robot, points, **where)


def test_why_there_are_no_cells_is_a_note_and_what_is_wrong_is_refused():
    robot = clearance.Robot.from_spheres({"huge": [[0, 0, 0, 2e6]], "small": [[0, 0, 0, 0.1]]})
    some = robot.with_cells(**CELLS)
    assert some.has_cells  # each part has its own
    assert some.notes == ['part "huge": a part without a finite size has no cells; so it has none']
    none = robot.with_cells(bytes=16)
    assert not none.has_cells and none.notes[1].startswith('part "small": 16 bytes are too few for cells of its 1 primitives')
    for wrong in -1, 0.5, "much", None:
        refused(lambda: robot.with_cells(bytes=wrong), "bytes is a whole number, 0 or more")
    refused(lambda: robot.with_cells(reach=-1), "cells reach -1.000000 m")
    refused(lambda: robot.with_cells(device="gpu"), "device")
