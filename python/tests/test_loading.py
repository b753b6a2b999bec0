# SPDX-License-Identifier: BSD-3-Clause
"""Who waits for a robot is told by the logger "clearance" how far it is, once a second; a quick load says nothing."""

import logging
import re

import pytest

import clearance


def box(length):
    corners = [(x, y, z) for x in (0, length) for y in (0, 1) for z in (0, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


def load(spheres):
    return clearance.Robot.from_meshes({"hand": box(1), "arm": box(2)}, spheres=spheres, cache=False)


def test_a_slow_load_says_how_many_links_are_done(caplog):
    caplog.set_level(logging.INFO, "clearance")
    load(10_000)
    said = [record.getMessage() for record in caplog.records if record.name == "clearance"]
    assert said
    for line in said:
        assert re.fullmatch(r"packing 2 links: [0-2] done, \d+/20000 spheres", line)


def test_near_maps_are_said_before_they_are_made(caplog):
    caplog.set_level("INFO", "clearance")
    ball = clearance.Robot.from_spheres({"a": [[0, 0, 0, 0.1]], "b": [[1, 0, 0, 0.1]]})
    ball.with_fields(40_000)
    ball.with_cells(40_000, reach=1)
    assert [r.message for r in caplog.records] == ["reading or sampling fields of 2 parts", "making cells of 2 parts"]


def test_a_quick_load_says_nothing(caplog):
    caplog.set_level(logging.INFO, "clearance")
    load(10)
    assert not [record for record in caplog.records if record.name == "clearance"]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_handler_that_fails_stops_no_load(monkeypatch):
    def fails(*_):
        raise OSError("the disk is full")

    monkeypatch.setattr(logging.getLogger("clearance"), "info", fails)
    assert load(10_000).parts == ["hand", "arm"]
