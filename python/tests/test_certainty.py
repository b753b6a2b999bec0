# SPDX-License-Identifier: BSD-3-Clause
"""Every question beside everything that says that something is uncertain: asked, or refused in a sentence.

The table is made of what the package declares: questions, sources, noises, and options about radii. Which cells are asked
stands in docs/uncertainty.md. What is asked holds wherever points and parts may be; the rest says who takes it.
"""

import pathlib
import re

import numpy as np
import pytest
from conftest import moved, random_robot, rigid
from test_questions import questions
from test_values import options

import clearance

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROWS, COLUMNS, CAMERA = 12, 16, (20.0, 25.0, 7.5, 5.25)


def takers():
    """The questions that take uncertain clouds, as the page about uncertainty says it."""
    page = ROOT / "docs" / "uncertainty.md"
    if not page.exists():
        pytest.skip("needs a checkout")
    table = page.read_text().split("## Other questions")[1].split("\n## ")[0]
    names = re.findall(r"`(\w+)`", " ".join(line.split("|")[1] for line in table.splitlines() if line.startswith("| `")))
    python = {"".join(word.capitalize() for word in name.split("_")) for name in [*names, "certain_distance"]}
    return python & set(questions())  # motion_clearance is none in Python


MANY = ("MinDistances", "MinDistancesPerPart", "InCollisions")
IMAGES = ("uint16", "float32", "rays")
DOUBTS = {
    "radii": None,  # an array, made for each cloud
    "shift": {"shift": 0.02},
    "turn": {"turn": 0.01},
    "age": {"max_speed": 1.5, "age": 0.01},
    "kinect": {"noise": clearance.KinectNoise(1)},
    "stereo": {"noise": clearance.StereoNoise(424, 0.05, 0.08)},
    "tof": {"noise": clearance.TofNoise(0.004, 0.003)},
    "lidar": {"noise": clearance.LidarNoise(0.01, 0.002)},
    "nothing": {},
}


def sources(rng):
    """{name: (a cloud, its points in the world, their sensor's place)} of every kind."""
    depth = rng.uniform(0.3, 0.9, (ROWS, COLUMNS)).astype("f4")
    pose = rigid(rng)
    v, u = np.mgrid[:ROWS, :COLUMNS]
    across = np.stack([(u - CAMERA[2]) / CAMERA[0], (v - CAMERA[3]) / CAMERA[1], np.ones_like(u, float)], -1)
    made = {}
    for name in IMAGES:
        image = np.round(depth * 1000).astype("u2") if name == "uint16" else depth
        lens = {"rays": np.ascontiguousarray(across[..., :2].astype("f4"))} if name == "rays" else {"intrinsics": CAMERA}
        z = image.astype(float) * (0.001 if name == "uint16" else 1)
        made[name] = clearance.depth_image(image, pose=pose, **lens), moved(pose, (across * z[..., None]).reshape(-1, 3))
    points = rng.uniform(-1, 1, (150, 3))
    record = np.zeros(150, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("i", "u1")])
    for k, axis in enumerate("xyz"):
        record[axis] = points[:, k]
    for name, array in (("points", points.astype("f4")), ("doubles", points), ("records", record)):
        made[name] = clearance.points(array, pose), moved(pose, points)
    return {name: (*its, pose[:3, 3]) for name, its in made.items()}


def radius_of(name, doubt, rng, cloud, points, sensor):
    """The doubts of a cloud as `uncertain` takes them, and each point's radius, where this test knows it."""
    away = np.linalg.norm(points - sensor, axis=1)
    if name == "radii":
        radii = rng.uniform(0, 0.05, len(cloud)).astype("f4")
        return {"noise": radii}, radii.astype(float)
    radii = doubt.get("shift", 0) + doubt.get("turn", 0) * away + doubt.get("max_speed", 0) * doubt.get("age", 0)
    if isinstance(doubt.get("noise"), clearance.TofNoise):
        radii = 3 * (0.004 + 0.003 * away**2)
    elif isinstance(doubt.get("noise"), clearance.LidarNoise):
        radii = 3 * (0.01 + 0.002 * away)
    elif "noise" in doubt:
        radii = None  # along the ray, by the slant
    return doubt, np.broadcast_to(radii, len(points)) if radii is not None else None


def with_radii(name, parts, rng):
    """A question's options that say by how much parts may be elsewhere, and those radii; None: it has no such option."""
    radii = rng.uniform(0, 0.03, parts)
    if name == "CertainDistance":
        return {"parts": np.array([(r, 0) for r in radii], [("joints", "<f8"), ("delay", "<f8")])}, radii
    kind = getattr(clearance, name)
    return ({"radii": radii}, radii) if hasattr(kind, "radii") else (None, radii)


def asked(name, margin):
    """Options with which a question says something about this scene."""
    usual = options()[name]
    if name.startswith("InCollision"):
        return {"margins": [margin]}
    if name == "Zones":
        return {"thresholds": [margin]}
    return {} if name in ("Unseen", "CertainDistance", *MANY) else usual


def elsewhere(rng, points, radii):
    """Points somewhere in their balls: many on the rim."""
    way = rng.normal(size=points.shape)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return points + way * (radii * rng.choice([1, 1, 0.5], len(points)))[:, None]


def check_holds(name, result, margin, true, counts, of_parts):
    """That an answer holds for places of points and parts whose distances are `true` (parts,), with so many points of
    each part within the margin. of_parts: the radii of parts."""
    slack = 2e-6
    least = true.min()
    if name == "CertainDistance":
        assert result.lower <= max(least, 0) + slack and result.upper >= max(least, 0) - slack
        assert all(pair["lower"] <= max(far, 0) + slack for pair, far in zip(result.parts, true))
        assert result.state != clearance.State.free or least > -slack
        assert result.state != clearance.State.collision or least < slack
    elif name in ("InCollision", "InCollisions"):
        state = result.state if name == "InCollision" else clearance.State(int(result.of[0]))
        assert state != clearance.State.free or least > margin - slack
        assert state != clearance.State.collision or least < margin + slack
    elif name == "Zones":
        for k, far in enumerate(true):
            assert result.of(k, 0).points >= counts[k]
            assert result.of(k, 0).nearest <= max(far, 0) + of_parts[k] + slack or far > margin  # less points' radii
    else:
        rows = [result.of[0]] if name == "MinDistances" else list(result.of(0))
        for row, far in zip(rows, [least] if name == "MinDistances" else true, strict=True):
            assert row["lower"] <= max(far, 0) + slack  # upper and collision are about the nearest places
            assert row["state"] != clearance.State.free or far > -slack


@pytest.mark.parametrize("name", questions())
def test_a_question_beside_what_is_uncertain_is_asked_or_refused(name, rng):
    """All cells of one question: sources, doubts, and radii of parts."""
    robot, spheres, poses = random_robot(rng)
    if name == "SignedDistances":
        robot = of_triangles()
        poses = np.eye(4)[None]
    cells = dict.fromkeys(("asked", "refused"), 0)
    for source, (cloud, points, sensor) in sources(rng).items():
        bare = clearance.Query(robot, clearance.MinDistance())(clouds=[cloud], poses=poses).distance
        margin = max(0.02, float(bare) - 0.01)
        for doubt, its in DOUBTS.items():
            for moves in (False, True):
                option, of_parts = with_radii(name, len(robot), rng)
                if moves and option is None:
                    continue
                options_here = asked(name, margin) | (option if moves else {})
                if name.endswith("Unseen") and source == "rays":
                    options_here["half_pixel"] = 0.05
                ask = clearance.Query(robot, getattr(clearance, name)(**options_here))
                where = {"poses": poses[None] if name in MANY else poses}
                doubts, radii = radius_of(doubt, its, rng, cloud, points, sensor)
                seen = clearance.uncertain(cloud, **doubts)
                if name not in takers() or name == "Unseen" and source not in IMAGES:
                    with pytest.raises(ValueError) as error:
                        ask(clouds=[seen], **where)
                    text = str(error.value)
                    assert "\n" not in text and "clearance: " in text
                    if name not in takers():
                        assert f"in Python {name} takes points where they were measured" in text
                        assert {taker for taker in questions() if re.search(rf"\b{taker}\b", text)} == takers() | {name}
                    cells["refused"] += 1
                    continue
                result = ask(clouds=[seen], **where)
                cells["asked"] += 1
                if name == "Unseen":
                    check_hidden(robot, poses, result, cloud, options_here, moves)
                    continue
                if radii is None:
                    continue  # test_questions compares these with their formulas
                for _ in range(4):
                    there = elsewhere(rng, points, radii)
                    off = rng.normal(size=(len(robot), 3))
                    off *= (of_parts * moves / np.linalg.norm(off, axis=1))[:, None]
                    table = []
                    for k, (part, pose) in enumerate(zip(spheres, poses)):
                        centres = moved(pose, part[:, :3]) + off[k]
                        table.append((np.linalg.norm(there[:, None] - centres, axis=2) - part[:, 3]).min(1))
                    table = np.array(table)
                    counts = (table <= margin - 2e-6).sum(1)
                    check_holds(name, result, margin, table.min(1), counts, of_parts * moves)
    all_cells = 6 * len(DOUBTS) * (1 if with_radii(name, 1, rng)[0] is None else 2)
    of_images = all_cells // 2 if name == "Unseen" else all_cells
    assert cells == {"asked": of_images * (name in takers()), "refused": all_cells - of_images * (name in takers())}


def of_triangles():
    corners = np.array([[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]])
    return clearance.Robot.from_meshes({"a": (corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])}, model="triangles")


def check_hidden(robot, poses, result, cloud, its, moves):
    """That what may be hidden is never farther than what is hidden as measured, and that its upper end is open."""
    bare = clearance.Query(robot, clearance.Unseen(**{k: v for k, v in its.items() if k != "radii"}))
    measured = bare(clouds=[cloud], poses=poses).all
    assert result.all.lower <= measured.lower + 1e-6 and result.all.upper == np.inf
    assert result.all.state in (clearance.State.free, clearance.State.possible, clearance.State.unknown)


def test_every_option_about_radii_is_on_the_page_and_others_are_refused_by_name():
    for name in questions():
        option, _ = with_radii(name, 1, np.random.default_rng(0))
        assert (option is not None) == (name in takers() | {"SeenAndUnseen"}), name
        if option is None:
            with pytest.raises(TypeError, match=f"{name} has no option radii"):
                getattr(clearance, name)(radii=[0.1])


def test_an_uncertain_cloud_beside_a_bare_one_makes_no_question_forget_it(rng):
    robot, _, poses = random_robot(rng)
    bare, seen = (clearance.points(rng.uniform(-1, 1, (50, 3)).astype("f4")) for _ in range(2))
    doubtful = clearance.uncertain(seen, shift=0.05)
    for name in questions():
        if name.endswith("Unseen"):
            continue
        its, where = (robot, poses[None] if name in MANY else poses)
        if name == "SignedDistances":
            its, where = of_triangles(), np.eye(4)[None]
        if name == "PartWitnesses":
            continue  # of a frame's minima
        ask = clearance.Query(its, getattr(clearance, name)(**asked(name, 0.3)))
        for clouds in ([bare, doubtful], [doubtful, bare]):
            if name not in takers():
                with pytest.raises(ValueError, match="a cloud is uncertain"):
                    ask(clouds=clouds, poses=where)
            else:
                ask(clouds=clouds, poses=where)
    certain = clearance.Query(robot, clearance.CertainDistance())
    both = certain(clouds=[bare, doubtful], poses=poses).lower
    assert both == min(certain(clouds=[cloud], poses=poses).lower for cloud in (bare, doubtful))


def test_gradients_of_what_is_uncertain_are_those_of_its_pair(arm, rng):
    """A radius does not change with the joints."""
    points = rng.uniform(-1, 1, (60, 3)).astype("f4") + np.float32([1.5, 0, 0])
    cloud = clearance.uncertain(clearance.points(points), rng.uniform(0, 0.05, 60).astype("f4"))
    q = rng.uniform(-1, 1, 3)
    ask = clearance.Query(arm, clearance.MinDistances())
    rows = clearance.joint_gradients(arm, q[None], ask(clouds=[cloud], joints=q[None]))
    for k in range(3):
        d = np.eye(3)[k] * 1e-3
        ends = [float(ask(clouds=[cloud], joints=(q + s * d)[None]).of["distance"][0]) for s in (-1, 1)]
        assert rows[0, k] == pytest.approx((ends[1] - ends[0]) / 2e-3, abs=0.02)
