# SPDX-License-Identifier: BSD-3-Clause
"""What is asked besides questions: masked clouds, motions, closing speeds, separations; how many threads work; and a
description that is no file."""

import pickle

import numpy as np
import pytest
from conftest import ARM, random_robot, rigid, shared
from test_errors import refused
from test_questions import questions

import clearance

# ---- masks


def test_hidden_points_are_as_if_they_were_not_there(rng):
    robot, _, poses = random_robot(rng)
    points = rng.uniform(-1, 1, (400, 3)).astype("f4")
    hidden = rng.random(400) < 0.6
    for given in (points, points.astype("f8"), points[None]):
        cloud = clearance.masked(clearance.points(given), hidden)
        for question in (clearance.MinDistance(), clearance.InCollision(0.1), clearance.Zones([0.1, 0.3]), clearance.Within(0.2)):
            ask = clearance.Query(robot, question)
            r, bare = ask(cloud, poses=poses), ask(given, poses=poses)
            rest = ask(points[~hidden], poses=poses)
            assert str(r).split(" to point")[0] == str(rest).split(" to point")[0]
            counts = r if question == clearance.MinDistance() else r.counts
            assert counts.seen == 400 and counts.dropped["masked"] == hidden.sum() and counts.valid == (~hidden).sum()
            assert str(bare) != "" and repr(ask(given, poses=poses)) == repr(bare)  # no mask stays behind
    every = clearance.Query(robot, clearance.Distances())(clearance.masked(clearance.points(points), hidden), poses=poses)
    plain = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    assert np.isnan(every.distance[hidden]).all() and (every.distance[~hidden] == plain[~hidden]).all()


def test_points_keep_their_numbers_behind_a_mask_and_labels_are_a_filters(rng):
    arm = clearance.Robot.from_spheres({"arm": np.array([[0, 0, 0, 0.3]], "f4")})
    other = clearance.Robot.from_spheres({"other": np.array([[1, 0, 0, 0.1]], "f4")})
    points = rng.uniform(-1, 1, (3000, 3)).astype("f4")
    own = clearance.Query(arm, clearance.SelfFilter(0.05))(points, rest=True)
    seen = [clearance.masked(clearance.points(points), own.labels), np.array([[9, 9, 9]], "f4")]
    r = clearance.Query(arm, clearance.MinDistance())(clouds=seen, rest=True)
    away = np.linalg.norm(points.astype("f8"), axis=1) - 0.3
    away[own.labels == clearance.PointLabel.own] = np.inf
    assert (r.cloud, r.point) == (0, away.argmin()) and r.distance == pytest.approx(away.min(), abs=1e-6) and r.distance > 0.04
    assert r.seen == 3001 and r.dropped["masked"] == own.counts.own > 0
    uncertain = clearance.masked(clearance.uncertain(clearance.points(points), shift=0.01), own.labels)
    certain = clearance.Query(arm, clearance.CertainDistance())(uncertain, rest=True)
    assert certain.nominal.distance == r.distance and certain.lower == pytest.approx(r.lower - 0.01, abs=1e-5)
    many = np.stack([np.eye(4)] * 3)[:, None]
    plan = clearance.Query(other, clearance.MinDistances())(clearance.masked(clearance.points(points), own.labels), poses=many)
    assert (plan.of["distance"] == plan.of["distance"][0]).all()


def test_a_robot_that_a_camera_sees_is_no_obstacle(arm, rng):
    q, base = rng.uniform(-1, 1, 3), rigid(rng)
    links = arm.poses(q, base)
    own = np.concatenate([links[k, :3, 3] + links[k, :3, :3] @ [0, 0, 0.1] + rng.normal(size=(20, 3)) * 0.001 for k in range(4)])
    points = np.concatenate([own, rng.uniform(-1, 1, (50, 3)) + [3, 0, 0]])
    r = clearance.min_distance_filtered(arm, points, q, base=base, filter=clearance.SelfFilter(0.05))
    bare = clearance.Query(arm, clearance.MinDistance())(points[80:], q, base=base)
    assert r.filter.counts.own == 80 and r.rest.dropped["masked"] == 80
    assert r.rest.point == bare.point + 80 and r.rest.distance == pytest.approx(bare.distance, abs=1e-6)
    two = clearance.min_distance_filtered(arm, clouds=[points[:80], clearance.points(points[80:])], joints=q, base=base,
                                          filter=clearance.SelfFilter(0.05))
    assert (two.rest.cloud, two.rest.point) == (1, bare.point) and two.filter.counts.own == 80
    assert str(two) == f"{two.rest}; {two.filter}"
    pose = rigid(rng)
    seen = (points - pose[:3, 3]) @ pose[:3, :3]
    moved_cloud = clearance.min_distance_filtered(arm, seen, q, base=base, cloud_pose=pose, filter=clearance.SelfFilter(0.05))
    assert moved_cloud.rest.distance == pytest.approx(bare.distance, abs=1e-5)
    refused(lambda: clearance.min_distance_filtered(arm, joints=q), "nothing is given to look at")
    refused(lambda: clearance.min_distance_filtered(arm, points, q, camera_pose=pose), "about depth")
    image, lens = np.full((4, 6), 0.5, "f4"), {"intrinsics": (5, 5, 3, 2), "camera_pose": links[3]}
    every = clearance.min_distance_filtered(arm, points, q, depth=image, clouds=[points], base=base, **lens)
    assert every.rest.seen == every.filter.counts.points.seen == 2 * 130 + 24
    assert every.filter.offsets.tolist() == [0, 130, 154, 284]
    refused(lambda: clearance.min_distance_filtered(arm, points), "joints are not given")


def test_masks_that_do_not_fit_are_refused():
    three = clearance.points(np.zeros((3, 3)))
    refused(lambda: clearance.masked(three, np.zeros(2, bool)), "labels", "3 points", "(2,)")
    refused(lambda: clearance.masked(three, np.zeros(3)), "labels", "uint8", "float64")
    refused(lambda: clearance.masked(three, np.zeros(6, "u1")[::2]), "labels", "gaps")
    refused(lambda: clearance.masked(clearance.masked(three, [False] * 3), np.zeros(3, bool)), "labels")
    refused(lambda: clearance.masked(clearance.masked(three, np.zeros(3, bool)), np.zeros(3, bool)), "masked already")
    refused(lambda: clearance.masked(np.zeros((3, 3)), np.zeros(3, bool)), "points(...)", kind=TypeError)
    ball = clearance.Robot.from_spheres({"a": [[0, 0, 0, 0.1]]})
    image = clearance.masked(clearance.depth_image(np.ones((2, 2), "f4"), (1, 1, 0, 0)), np.zeros(4, bool))
    refused(lambda: clearance.Query(ball, clearance.Unseen())(image, rest=True), "masked", "labels")
    assert clearance.Query(ball, clearance.MinDistance())(
        clearance.masked(clearance.points(np.zeros((0, 3))), np.zeros(0, bool)), rest=True).seen == 0


# ---- motions


def test_a_motion_is_never_nearer_than_it_says(arm, rng):
    ask, least = clearance.Query(arm, clearance.MinDistancePerPart()), clearance.Query(arm, clearance.MinDistances())
    points, base = rng.uniform(-1, 1, (50, 3)) + [1.2, 0, 0.5], rigid(rng, 0.1)
    for _ in range(5):
        start, end = rng.uniform(-1.5, 1.5, (2, 3))
        r = clearance.motion_clearance(ask, start, end, points, base=base, tolerance=0.005)
        steps = start + np.linspace(0, 1, 500)[:, None] * (end - start)
        of = least(points, steps, base=base).of
        assert r.settled and r.lower <= of["distance"].min() <= r.upper + 1e-3 and r.lower >= of["lower"].min() - 0.006
        assert r.state == (clearance.State.free if r.lower > 0 else r.state) and 0 <= r.from_ <= r.to <= 1
        assert r.nearest.distance == pytest.approx(least(points, start + r.time * (end - start), base=base).of["distance"][0], abs=1e-6)
        by_name = clearance.motion_clearance(ask, dict(zip(arm.joints, start)), dict(zip(arm.joints, end)), points, base=base,
                                             tolerance=0.005)
        assert repr(by_name) == repr(r) and repr(pickle.loads(pickle.dumps(r))) == repr(r)
        assert str(r).startswith(f"{r.state.name}: over the motion certainly ")
        wide = clearance.motion_clearance(ask, start, end, points, base=base, tolerance=0.005, radii=0.01)
        assert wide.lower <= r.lower
    hidden = clearance.masked(clearance.points(points), np.arange(50) > 0)
    one = clearance.motion_clearance(ask, start, end, hidden, base=base)
    assert one.nearest.valid == 1 and one.nearest.point in (0, None)


def test_a_motion_between_poses_goes_straight():
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.1]], "f4")})
    ask = clearance.Query(ball, clearance.MinDistancePerPart())
    start, end = np.eye(4)[None].copy(), np.eye(4)[None].copy()
    start[0, 0, 3], end[0, 0, 3] = -1, 1
    r = clearance.motion_clearance(ask, start, end, np.array([[0, 0.5, 0]]), tolerance=1e-3)
    assert 0.399 - 1e-3 <= r.lower <= 0.4 and r.upper >= 0.4 - 1e-6 and r.time == pytest.approx(0.5, abs=0.1)
    assert r.state == clearance.State.free and r.link == "ball"
    assert clearance.motion_clearance(ask, start, end, np.array([[0, 0.5, 0]]), margin=0.45).state == clearance.State.collision


def test_motions_that_cannot_be_asked_are_refused(arm):
    ask, q, points = clearance.Query(arm, clearance.MinDistancePerPart()), np.zeros(3), np.ones((1, 3))
    refused(lambda: clearance.motion_clearance(clearance.Query(arm, clearance.MinDistance()), q, q, points), "MinDistancePerPart")
    refused(lambda: clearance.motion_clearance(ask, q, q[:2], points), "joints", "(2,)")
    refused(lambda: clearance.motion_clearance(ask, [q, q], [q, q], points), "one configuration each")
    refused(lambda: clearance.motion_clearance(ask, q, q + 9, points), "limits")
    refused(lambda: clearance.motion_clearance(ask, q, q), "nothing is given to look at")
    refused(lambda: clearance.motion_clearance(ask, q, q, points, tolerance=-1), "tolerance")
    refused(lambda: clearance.motion_clearance(ask, q, q, points, most_queries=0), "0 queries")
    refused(lambda: clearance.motion_clearance(ask, q, q, points, radii=[1, 2]), "radii")
    refused(lambda: clearance.motion_clearance(ask, arm.poses(q), arm.poses(q)[:3], points), "4 poses", "3")


# ---- speeds and separations


def test_how_fast_a_gap_closes(arm):
    q, speeds, points = np.array([0.3, -0.4, 0.2]), np.array([0.5, -0.2, 0.1]), np.array([[1.4, 0.3, 0.9]])
    ask = clearance.Query(arm, clearance.MinDistance())
    r = ask(points, q)
    twist = arm.jacobian(q, r.part, r.nearest) @ speeds
    closing = clearance.approach_speed(r, twist[:3], twist[3:], r.nearest)
    step = 1e-3
    assert closing == pytest.approx((ask(points, q - step * speeds).distance - ask(points, q + step * speeds).distance) / (2 * step), abs=2e-3)
    assert closing == pytest.approx(-clearance.joint_gradients(arm, q, r) @ speeds, abs=1e-6)
    away = np.array(r.normal)
    assert clearance.approach_speed(r, (0, 0, 0), point_velocity=away) == pytest.approx(-1)
    inside = ask(arm.poses(q)[1:2, :3, 3] + [0, 0, 0.0], q)
    assert clearance.approach_speed(inside, (1, 0, 0)) is None or inside.distance != 0
    with pytest.raises(TypeError, match="MinDistanceResult"):
        clearance.approach_speed(r.distance, (0, 0, 0))
    refused(lambda: clearance.approach_speed(r, (0, np.nan, 0)), "velocity", "finite")


def test_the_protective_separation_is_the_standards_sum():
    terms = {"human_speed": 1.6, "robot_speed": 0.5, "reaction_time": 0.1, "stopping_time": 0.3, "stopping_distance": 0.08,
             "intrusion": 0.2, "human_uncertainty": 0.05, "robot_uncertainty": 0.01}
    assert clearance.protective_separation(**terms) == pytest.approx(1.6 * 0.4 + 0.5 * 0.1 + 0.08 + 0.2 + 0.05 + 0.01)
    for name in terms:
        with pytest.raises(TypeError):  # none has a default
            clearance.protective_separation(**{k: v for k, v in terms.items() if k != name})
        refused(lambda: clearance.protective_separation(**{**terms, name: -1}), name)


# ---- threads


@pytest.mark.parametrize("name", [n for n in questions() if n in ("MinDistance", "Distances", "Zones", "MinDistances", "SelfFilter")])
def test_any_number_of_threads_has_the_same_answer(name, rng):
    robot, _, poses = random_robot(rng)
    points = rng.uniform(-1, 1, (20_000, 3)).astype("f4")
    kind = getattr(clearance, name)
    question = kind([0.1]) if name == "Zones" else kind()
    answers = {repr(clearance.Query(robot, question, threads=n)(points, poses=poses)) for n in (None, 1, 2, 3)}
    assert len(answers) == 1


def test_threads_that_cannot_be(arm):
    assert clearance.Query(arm, clearance.MinDistance(), threads=2).threads == 2
    assert clearance.Query(arm, clearance.MinDistance()).threads is None
    refused(lambda: clearance.Query(arm, clearance.MinDistance(), threads=0), "threads is 0", "1 to 4096")
    refused(lambda: clearance.Query(arm, clearance.MinDistance(), threads=-1), "threads")
    refused(lambda: clearance.Query(arm, clearance.MinDistance(), device="cuda:0", threads=1), "threads")


# ---- a description that is no file


def test_a_robot_is_read_from_its_description(arm, rng):
    points, q = rng.uniform(-1, 1, (100, 3)), rng.uniform(-1, 1, 3)
    for text in (ARM, "\n  " + ARM):
        robot = clearance.Robot.from_urdf(text, model="triangles")
        for one in (robot, pickle.loads(pickle.dumps(robot))):
            assert (one.name, one.parts, one.joints) == (arm.name, arm.parts, arm.joints)
            asked = [repr(clearance.Query(r, clearance.MinDistance())(points, q)) for r in (one, arm)]
            assert asked[0] == asked[1]
    refused(lambda: clearance.Robot.from_urdf("<robot name='a'><link/></robot>"), "robot_description", kind=RuntimeError)
    refused(lambda: clearance.Robot.from_urdf("<robot"), "robot_description", kind=RuntimeError)


def test_a_descriptions_meshes_are_found_from_the_working_folder(tmp_path, monkeypatch):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((0.2, 0.2, 0.2)).export(tmp_path / "cube.stl")
    text = '<robot name="a"><link name="cube"><collision><geometry><mesh filename="cube.stl"/></geometry></collision></link></robot>'
    monkeypatch.chdir(tmp_path)
    robot = clearance.Robot.from_urdf(text, model="triangles")
    r = clearance.Query(robot, clearance.MinDistance())(np.array([[1.0, 0, 0]]), rest=True)
    assert r.distance == pytest.approx(0.9, abs=1e-6)


# ---- names where numbers stand


def test_a_link_stands_for_its_number(arm, rng):
    points, q = rng.uniform(-1, 1, (100, 3)), rng.uniform(-1, 1, 3)
    each = clearance.Query(arm, clearance.MinDistancePerPart())(points, q)
    for k, name in enumerate(arm.parts):
        assert repr(each.of(name)) == repr(each.of(k)) and each.of(name).distance == each.parts[k]["distance"]
    far = clearance.Query(arm, clearance.DistancesPerPart())(points, q)
    assert (far.of("hand") == far.of(3)).all()
    zones = clearance.Query(arm, clearance.Zones([0.2, 2.0]))(points, q)
    assert repr(zones.of("upper", 1)) == repr(zones.of(1, 1)) and zones.of("upper", 1).points > 0
    certain = clearance.Query(arm, clearance.CertainDistance())(points, q)
    assert certain.of("lower").link == "lower" and repr(certain.of("lower")) == repr(certain.of(2))
    assert (arm.mesh("hand")[0] == arm.mesh(3)[0]).all()
    spheres = clearance.Robot.from_urdf(ARM, spheres=8)
    assert (spheres.spheres("base") == spheres.spheres(0)).all()
    for call in (lambda: each.of("claw"), lambda: zones.of("claw", 0), lambda: arm.mesh("claw")):
        refused(call, 'no part "claw"', '"base", "upper", "lower", "hand"')
    refused(lambda: each.of(4), "no part 4", kind=IndexError)
    assert pickle.loads(pickle.dumps(each)).of("hand").distance == each.of("hand").distance


# ---- shapes that batches have


def test_results_have_the_shape_of_the_configurations(arm, rng):
    points, q, base = rng.uniform(-1, 1, (100, 3)), rng.uniform(-1, 1, (4, 5, 3)), rigid(rng)
    for question in (clearance.MinDistances(), clearance.InCollisions(0.1)):
        ask = clearance.Query(arm, question)
        flat = ask(points, q.reshape(-1, 3), base=base).of
        r = ask(points, q, base=base)
        assert flat.shape == (20,) and r.of.shape == (4, 5) and r.of.tobytes() == flat.tobytes()
        assert ask(points, poses=arm.poses(q, base)).of.shape == (4, 5) and not r.of.flags.writeable
        assert ask(points, q[:, :0], base=base).of.shape == (4, 0)
        assert ask(points, q[0, 0], base=base).of.shape == (1,)
        assert pickle.loads(pickle.dumps(r)).of.shape == r.to_dict()["of"].shape == (4, 5)
    assert clearance.Query(arm, clearance.MinDistances())(points, q, base=base).trajectory(2, 5).shape == (5,)


def test_a_real_robot_names_its_links():
    robot = clearance.Robot.from_urdf(shared("robots/ur5e/ur5e.urdf"), model="triangles")
    each = clearance.Query(robot, clearance.MinDistancePerPart())(np.array([[0.6, 0, 0.4]]), rest=True)
    assert each.of("wrist_3_link").distance == each.parts[robot.parts.index("wrist_3_link")]["distance"]


# ---- many worlds in one call


def test_each_world_has_the_answer_that_it_has_alone(arm, rng):
    sizes = [40, 0, 7, 300, 1]
    points, splits = rng.uniform(-1, 1, (348, 3)), np.cumsum([0, *sizes])
    q, base = rng.uniform(-1, 1, (5, 3)), np.stack([rigid(rng) for _ in sizes])
    clouds = [points[a:b] for a, b in zip(splits, splits[1:])]
    ask, safe = clearance.Query(arm, clearance.MinDistance()), clearance.Query(arm, clearance.InCollision(0.1))
    together = ask.worlds(points, q, splits=splits, base=base)
    states = safe.worlds(clouds, q, base=base)
    assert together.of.shape == states.of.shape == (5,)
    for w, cloud in enumerate(clouds):
        alone = ask(cloud, q[w], base=base[w])
        for name in ("state", "distance", "lower", "upper", "point", "seen", "valid"):
            value = getattr(alone, name)
            value = clearance.none if value is None else value
            assert together.of[w][name] == value or np.isnan(value), (w, name)
        assert states.of[w] == safe(cloud, q[w], base=base[w]).state
    assert together.of["state"].tolist()[1] == clearance.State.no_data and states.counts.seen == 348
    assert repr(ask.worlds(clouds, q, base=base).of) == repr(together.of)
    assert repr(ask.worlds([clearance.points(c) for c in clouds], q, base=base).of) == repr(together.of)
    one = clearance.Query(arm, clearance.MinDistance(), threads=1)
    assert repr(one.worlds(points, q, splits=splits, base=base).of) == repr(together.of)


def test_each_world_has_many_configurations_and_gradients(arm, rng):
    points, plan = rng.uniform(-1, 1, (3, 50, 3)) + [1.5, 0, 0], rng.uniform(-1, 1, (3, 2, 4, 3))
    ask = clearance.Query(arm, clearance.MinDistances())
    r = ask.worlds(list(points), plan)
    assert r.of.shape == (3, 2, 4)
    for w in range(3):
        assert (r.of[w]["distance"] == ask(points[w], plan[w]).of["distance"]).all()
    rows = clearance.joint_gradients(arm, plan, r)
    assert rows.shape == (3, 2, 4, 3)
    assert (rows[1] == clearance.joint_gradients(arm, plan[1], ask(points[1], plan[1]))).all()
    by_poses = ask.worlds(list(points), poses=arm.poses(plan))
    assert repr(by_poses.of) == repr(r.of)
    assert ask.worlds([], plan[:0]).of.shape == (0,)


def test_worlds_that_cannot_be_asked_are_refused(arm, rng):
    ask, points, q = clearance.Query(arm, clearance.MinDistance()), np.ones((6, 3)), np.zeros((2, 3))
    for splits in ([0, 3], [1, 3, 6], [0, 4, 3, 6], [], ["a"], 6):
        refused(lambda: ask.worlds(points, q, splits=splits), "splits is (worlds + 1) row numbers")
    refused(lambda: ask.worlds(points, q), "splits")
    refused(lambda: ask.worlds([points] * 3, q), "3 worlds", "joints is for 2")
    refused(lambda: ask.worlds([points] * 2, [[0, 0, 0], [0, 9, 0]]), "limits")
    refused(lambda: ask.worlds([points] * 2, np.zeros((2, 4, 3))), "MinDistance", "asks about one")
    refused(lambda: clearance.Query(arm, clearance.Zones([0.1])).worlds([points], q[:1]), "many worlds", "Zones")
    skew = np.stack([np.eye(4)] * 2)
    skew[1, 0, 0] = 2
    refused(lambda: ask.worlds([points] * 2, q, base=skew), "world 1", "rigid")
