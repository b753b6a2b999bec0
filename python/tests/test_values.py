# SPDX-License-Identifier: BSD-3-Clause
"""Questions, robots and results as Python values: what is printed, pickled, compared, shared and kept alive."""

import copy
import gc
import os
import pickle
import subprocess
import sys
import threading
import time
import weakref

import numpy as np
import pytest
from conftest import moved, random_robot, rigid
from test_questions import configurations, depth_of_integers, plain, questions

import clearance


def options():
    """Every question with options other than its own."""
    given = {"Distances": {"d_max": 0.5, "which": True}, "SignedDistances": {"d_max": 0.5, "which": True},
             "InCollision": {"margins": [0.1, 0.2]}, "InCollisions": {"margins": [0.1, 0.2]},
             "Zones": {"thresholds": [0.1, 0.3], "each_part": False, "min_points": 3}, "Within": {"radius": 0.25},
             "MinDistanceSupported": {"min_points": 4, "radius": 0.5, "most": 100}, "NearestK": {"k": 3, "d_max": 2.0},
             "SelfFilter": {"padding": 0.03}, "MinDistances": {"d_max": 1.5}, "MinDistancesPerPart": {"d_max": 1.5},
             "DistancesPerPart": {"d_max": 0.5},
             "Unseen": {"room": clearance.Hiding(0.25, 5.0, True), "half_pixel": 0.01, "labels": np.array([0, 1], "u1"),
                        "places": True}}
    given["SeenAndUnseen"] = given["Unseen"]
    minima = np.zeros(2, [("distance", "<f4"), ("cloud", "<u4"), ("point", "<u4"), ("primitive", "<u4")])
    given["PartWitnesses"] = {"minima": minima}
    radii = [("joints", "<f8"), ("delay", "<f8")]
    given["CertainDistance"] = {"parts": np.array([(0.25, 0.0), (0.0, 0.125), (0.5, 0.5)], radii)}
    return {name: given.get(name, {}) for name in questions()}


@pytest.mark.parametrize("name", questions())
def test_a_question_is_a_value(name):
    kind, with_options = getattr(clearance, name), options()[name]
    question, same = kind(**with_options), kind(*with_options.values())
    assert question == same and hash(question) == hash(same)
    assert (question == kind()) == (not with_options)
    assert question != "something else"
    for copied in (pickle.loads(pickle.dumps(question)), copy.copy(question), copy.deepcopy(question)):
        assert type(copied) is kind and copied == question
    assert repr(question).startswith(name + "(")
    for option in with_options:
        assert option + "=" in repr(question)
        with pytest.raises(AttributeError):
            setattr(question, option, getattr(question, option))
    with pytest.raises(AttributeError):
        question.something = 1


@pytest.mark.parametrize("name", [n for n in questions() if n != "PartWitnesses"])
def test_what_is_printed_of_a_question_makes_it_again(name):
    question = getattr(clearance, name)(**options()[name])
    known = {name: getattr(clearance, name), "inf": np.inf, "Hiding": clearance.Hiding, "array": np.array, "uint8": np.uint8}
    assert eval(repr(question), known) == question
    assert eval(repr(type(question)()), known) == type(question)()


def ask_all(rng):
    """The result of every question that a robot of spheres can answer."""
    s = plain(rng)
    for name in questions():
        question = getattr(clearance, name)(**options()[name])
        if name == "SignedDistances":
            continue
        if name == "PartWitnesses":
            question = clearance.PartWitnesses(s.ask(clearance.MinDistancePerPart()).parts)
        if name.startswith("InCollision"):
            question = type(question)(0.1)
        if name in ("Unseen", "SeenAndUnseen"):
            yield name, depth_of_integers(rng).ask(type(question)())
            continue
        plan = name in ("MinDistances", "MinDistancesPerPart", "InCollisions")
        yield name, s.ask(question, **({"poses": configurations(s)[0]} if plan else {}))


def test_every_result_is_printed(rng):
    for name, result in ask_all(rng):
        if isinstance(result, np.ndarray):
            continue
        text = repr(result)
        assert text.startswith(type(result).__name__ + "(") and "object at 0x" not in text, name
        assert str(result)
        for member in (m for m in dir(result) if not m.startswith("_")):
            assert callable(getattr(result, member)) or member == "link" or member + "=" in text, (name, member)


def test_a_result_does_not_change(rng):
    for name, result in ask_all(rng):
        arrays = [result] if isinstance(result, np.ndarray) else []
        if not arrays:
            for member in (m for m in dir(result) if not m.startswith("_")):
                value = getattr(result, member)
                if callable(value):
                    continue
                with pytest.raises(AttributeError):
                    setattr(result, member, value)
                arrays += [value] if isinstance(value, np.ndarray) else []
        for array in arrays:
            assert not array.flags.writeable, name


def test_the_sentence_of_a_minimum():
    robot = clearance.Robot.from_spheres({"hand": np.array([[0, 0, 0, 0.25]], "f4")})
    ask = clearance.Query(robot, clearance.MinDistance())
    cloud = np.full((100_000, 3), 2, "f4")
    cloud[84_612] = (0.5, 0, 0)
    pose = np.eye(4)[None]
    assert str(ask(cloud, poses=pose)) == "free: 0.250 m (certainly 0.250 to 0.250), hand to point 84,612"
    assert str(ask(clouds=[cloud[:9], cloud], poses=pose)).endswith("hand to cloud 1, point 84,612")
    assert str(ask(cloud * np.nan, poses=pose)) == "no_data: none of 100,000 points is valid"
    assert str(ask(cloud * 0, poses=pose)).startswith("collision: -0.250 m")


def test_a_robot_is_pickled(arm_file, rng):
    points = rng.uniform(-1, 1, (300, 3)).astype("f4")
    of_spheres, spheres, poses = random_robot(rng)
    made = [(clearance.Robot.from_urdf(str(arm_file), model="triangles", exclude_links=["hand"]), {"joints": [0.1, 0.2, 0.3]}),
            (clearance.Robot.from_urdf(str(arm_file), spheres=64), {"joints": [0.1, 0.2, 0.3]}),
            (of_spheres, {"poses": poses}),
            (clearance.Robot.from_meshes({"a": (np.eye(4)[:, :3], [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]])},
                                         model="triangles"), {"poses": np.eye(4)[None]})]
    for robot, where in made:
        again = pickle.loads(pickle.dumps(robot))
        assert (again.parts, again.model, again.name, repr(again)) == (robot.parts, robot.model, robot.name, repr(robot))
        one, other = (clearance.Query(r, clearance.MinDistance())(points, **where) for r in (robot, again))
        assert repr(one) == repr(other)


def test_what_was_pickled_is_the_robot_that_was_made_not_what_its_arrays_became(rng):
    spheres = np.array([[0, 0, 0, 0.25]], "f4")
    given = {"a": spheres}
    robot = clearance.Robot.from_spheres(given)
    spheres[0, 3] = 9
    given["b"] = spheres
    again = pickle.loads(pickle.dumps(robot))
    assert again.parts == ["a"] and again.spheres(0)[0, 3] == 0.25


def test_a_robot_tells_what_it_is(arm):
    assert arm.name == "demo_arm" and arm.model == "triangles" and len(arm) == 4
    assert arm.parts == ["base", "upper", "lower", "hand"]
    assert arm.joints == ["shoulder", "elbow", "wrist"]
    assert arm.limits.tolist() == [[-2, 2], [-2.5, 2.5], [-3, 3]]
    assert arm.rest.tolist() == [0, 0, 0]
    assert repr(arm).startswith('<Robot "demo_arm": 4 parts, ') and repr(arm).endswith(" triangles>")
    with pytest.raises(AttributeError):
        arm.name = "other"


def test_poses_are_those_of_the_chain(arm, rng):
    def turn(axis, angle):
        c, s = np.cos(angle), np.sin(angle)
        made = np.eye(4)
        made[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]] if axis == "y" else [[c, -s, 0], [s, c, 0], [0, 0, 1]]
        return made

    def up(z, y=0.0):
        made = np.eye(4)
        made[1:3, 3] = y, z
        return made
    for q in rng.uniform(-1.5, 1.5, (5, 3)):
        base = rigid(rng)
        upper = base @ up(0.2) @ turn("y", q[0])
        lower = upper @ up(0.4) @ turn("y", q[1])
        hand = lower @ up(0.3) @ turn("z", q[2])
        assert arm.poses(q, base) == pytest.approx(np.stack([base, upper, lower, hand]), abs=1e-12)
        assert arm.link_pose("eye", q, base) == pytest.approx(hand @ up(0.1, 0.03), abs=1e-12)
    assert arm.poses(rng.uniform(-1, 1, (2, 5, 3))).shape == (2, 5, 4, 4, 4)
    assert (arm.poses(rest=True) == arm.poses(arm.rest)).all()


def test_a_jacobian_is_what_small_steps_do(arm, rng):
    step = 1e-6
    for part in range(4):
        q, base, at = rng.uniform(-1, 1, 3), rigid(rng), rng.uniform(-0.1, 0.1, 3)
        place = lambda joints: moved(arm.poses(joints, base)[part], at[None])[0]
        steps = np.eye(3) * step
        expected = np.stack([(place(q + d) - place(q - d)) / (2 * step) for d in steps], axis=1)
        j = arm.jacobian(q, part, place(q), base)
        assert j.shape == (6, 3)
        assert j[:3] == pytest.approx(expected, abs=1e-8)
        assert (j == arm.jacobian(q, arm.parts[part], tuple(place(q)), base)).all()


def test_views_keep_their_result_alive(rng):
    s = plain(rng)
    distance = s.ask(clearance.Distances()).distance
    before = distance.copy()
    part = s.ask(clearance.MinDistancePerPart()).parts["distance"]
    its = part.copy()
    pairs = s.ask(clearance.NearestK(4)).of(1)
    theirs = pairs.copy()
    for _ in range(50):
        s.ask(clearance.Distances())
        s.ask(clearance.NearestK(4))
    gc.collect()
    assert (distance == before).all() and (part == its).all() and (pairs == theirs).all()


def test_a_cloud_keeps_its_array_alive_and_lets_it_go(rng):
    class Array(np.ndarray):
        pass

    array = np.array(rng.uniform(-1, 1, (1000, 3)), "f4").view(Array)
    gone = weakref.ref(array)
    first = array[0].tolist()
    cloud = clearance.points(array)
    del array
    gc.collect()
    assert gone() is not None
    robot = clearance.Robot.from_spheres({"a": np.array([[*first, 0.001]], "f4")})
    r = clearance.Query(robot, clearance.MinDistance())(cloud, rest=True)
    assert r.point == 0
    del cloud
    gc.collect()
    assert gone() is None


def test_a_cloud_is_a_view():
    """What changes in the array is seen in the next frame."""
    array = np.full((10, 3), 5, "f4")
    cloud = clearance.points(array)
    ask = clearance.Query(clearance.Robot.from_spheres({"a": np.array([[0, 0, 0, 1]], "f4")}), clearance.MinDistance())
    far = ask(cloud, rest=True).distance
    array[7] = (2, 0, 0)
    near = ask(cloud, rest=True)
    assert far > 7 and near.distance == 1 and near.point == 7
    assert len(cloud) == 10 and cloud.device == "cpu"


def test_a_query_keeps_what_it_needs(rng):
    robot, spheres, poses = random_robot(rng)
    minima = clearance.Query(robot, clearance.MinDistancePerPart())(np.ones((3, 3), "f4"), poses=poses).parts
    ask = clearance.Query(robot, clearance.PartWitnesses(minima.copy()))
    del robot, minima
    gc.collect()
    np.ones(1000)
    assert ask(np.ones((3, 3), "f4"), poses=poses)["point"].tolist() == [0, 0, 0]
    assert ask.robot.parts == ["part 0", "part 1", "part 2"] and ask.device == "cpu"
    assert isinstance(ask.question, clearance.PartWitnesses)


class ByDLPack:
    """An array of another library: only the protocol."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_arrays_of_other_libraries_come_by_dlpack(rng):
    p, (robot, _, poses) = rng.uniform(-1, 1, (200, 3)).astype("f4"), random_robot(rng)
    ask = clearance.Query(robot, clearance.Distances())
    expected = ask(p, poses=poses).distance
    for given in (ByDLPack(p), ByDLPack(p.astype("f8")), ByDLPack(np.asfortranarray(p)), ByDLPack(np.repeat(p, 2, 0)[::2])):
        assert np.abs(ask(given, poses=poses).distance - expected).max() < 1e-6
    for name in ("torch", "jax.numpy"):
        try:
            library = __import__(name, fromlist=["asarray"])
        except ImportError:
            continue
        assert (ask(library.asarray(p), poses=poses).distance == expected).all()
    assert np.from_dlpack(ask(p, poses=poses).distance.copy()).shape == (200,)


def test_many_threads_ask_one_query(rng):
    robot, _, poses = random_robot(rng, parts=4, spheres=300)
    clouds = [rng.uniform(-1, 1, (20_000, 3)).astype("f4") for _ in range(8)]
    ask = clearance.Query(robot, clearance.MinDistance())
    alone = [repr(ask(c, poses=poses)) for c in clouds]
    wrong = []
    start = threading.Barrier(8)

    def work(k):
        start.wait()
        for i in range(30):
            c = (k + i) % 8
            if repr(ask(clouds[c], poses=poses)) != alone[c]:
                wrong.append((k, i))
    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert not wrong


def test_python_runs_while_a_query_works(rng):
    """A thread counts while another asks: with the interpreter locked it would stand still."""
    robot, _, poses = random_robot(rng, parts=4, spheres=500)
    cloud = rng.uniform(-1, 1, (20_000, 3)).astype("f4")
    ask = clearance.Query(robot, clearance.DistancesPerPart())
    ask(cloud, poses=poses)
    spans, done = [], threading.Event()

    def work():
        for _ in range(5):
            begin = time.perf_counter()
            ask(cloud, poses=poses)
            spans.append((begin, time.perf_counter()))
        done.set()
    ticks = []
    asking = threading.Thread(target=work)
    asking.start()
    while not done.is_set():
        ticks.append(time.perf_counter())
        time.sleep(0)
    asking.join()
    ticks = np.array(ticks)
    longest = max(b - a for a, b in spans)
    assert longest > 0.01, "this is too quick to see anything"
    within = [((ticks > a) & (ticks < b)).sum() for a, b in spans]
    assert min(within) > 20, f"ticks while each call ran: {within}"


AT_EXIT = """
import sys, threading, time
import numpy as np
import clearance

robot = clearance.Robot.from_spheres({"a": [[0, 0, 0, 0.1]]})
ask = clearance.Query(robot, clearance.MinDistance())
kept = ask(np.ones((3, 3), "f4"), rest=True), clearance.points(np.ones((3, 3), "f4"))
sys.kept_by_a_module = ask
threading.Thread(target=lambda: (time.sleep(60), kept, ask), daemon=True).start()
"""


def test_the_end_of_a_program_is_silent():
    """Also with a daemon thread that still holds a query, as a live page has one."""
    done = subprocess.run([sys.executable, "-c", AT_EXIT], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def memory():
    """Bytes that this process holds."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_nothing_leaks(rng, arm):
    p = rng.uniform(-1, 1, (16, 3)).astype("f4")
    image = rng.integers(300, 900, (4, 8)).astype("u2")
    q = np.zeros(3)
    least, each = clearance.Query(arm, clearance.MinDistance()), clearance.Query(arm, clearance.Distances(which=True))

    def round_of(n):
        for _ in range(n):
            least(p, joints=q).link
            each(p, joints=q).distance
            least(depth=image, intrinsics=(5, 5, 4, 2), joints=q)
            least(clouds=[clearance.points(p), p], joints=q)
            hash(clearance.InCollision([0.1, 0.2]))
            try:
                least(q, joints="x")
            except ValueError:
                pass
    round_of(1000)
    gc.collect()
    before = memory()
    round_of(4000)
    gc.collect()
    assert memory() - before < 1_000_000  # 24,000 calls: less than 42 bytes each
