# SPDX-License-Identifier: BSD-3-Clause
"""What results hand out: everything that a number names is there or refused, and states compare as states."""

import enum
import re

import numpy as np
import pytest
from conftest import random_robot, rigid
from test_questions import configurations, depth_of_integers, plain
from test_values import ask_all

import clearance

HOSTILE = (-1, -2, -(2**31), -(2**63), 2**31, 2**32 - 1, 2**32, 2**63 - 1, 2**63, 2**64 - 1, 2**64, 10**30, 10**8,
           1.0, 0.5, float("nan"), float("inf"), "0", "first", b"0", None, [], [0], {}, np.zeros(1, int), np.float32(1),
           np.datetime64(1, "s"), object(), 1j)  # fmt: skip


def methods(result):
    """{name: the names of arguments, one tuple for each overload} of a result's own methods."""
    found = {}
    for name in dir(result):
        if not name.startswith("_") and callable(getattr(result, name)):
            lines = re.findall(rf"^(?:\d+\. )?``?{name}\(self(.*?)\) ->|^{name}\(self(.*?)\) ->",
                               getattr(type(result), name).__doc__, re.MULTILINE)  # fmt: skip
            said = [a or b for a, b in lines]
            found[name] = [tuple(re.findall(r", (\w+):", each)) for each in said]
            assert found[name], (type(result).__name__, name)
    return found


def everything(rng):
    """A result of every kind, and what it holds: results within results, too."""
    waiting = [result for _, result in ask_all(rng)]
    seen = set()
    while waiting:
        result = waiting.pop()
        if not type(result).__module__.startswith("clearance") or isinstance(result, enum.Enum):
            continue
        if type(result) not in seen:
            seen.add(type(result))
            yield result
        waiting += [value for name in dir(result) if not name.startswith("_")
                    if not callable(value := getattr(result, name))]  # fmt: skip


def tried(call, *arguments):
    """The value of a call, or its error, which is a sentence of ours."""
    try:
        return call(*arguments)
    except (IndexError, TypeError, ValueError) as error:
        text = str(error)
        assert "\n" not in text and not re.search("incompatible function|nanobind|std::", text), (arguments, text)
        return error


def test_no_argument_of_any_method_reads_what_a_result_does_not_hold(rng):
    tested = set()
    for result in everything(rng):
        for name, overloads in methods(result).items():
            call = getattr(result, name)
            for names in overloads:
                for k, argument in enumerate(names):
                    for hostile in HOSTILE:
                        arguments = [1] * len(names)
                        arguments[k] = hostile
                        found = tried(call, *arguments)
                        number = isinstance(hostile, int)
                        if argument == "part" and hostile is None and name == "lower":
                            assert not isinstance(found, Exception)  # whichever part the distance is of
                        elif argument in ("margin", "distance"):
                            assert isinstance(hostile, (int, float, np.floating)) or isinstance(found, Exception)
                        elif number and argument != "horizon":
                            assert isinstance(found, IndexError), (type(result), name, arguments, found)
                        else:
                            assert isinstance(found, Exception), (type(result), name, arguments, found)
                        tested.add((type(result).__name__, name))
    assert {("ZonesResult", "of"), ("NearestKResult", "of"), ("PartDistances", "of"), ("MinDistancesPerPartResult", "of"),
            ("MinDistancesResult", "trajectory"), ("InCollisionsResult", "trajectory"), ("DistanceCertainty", "lower"),
            ("MinDistancesResult", "first_below")} <= tested  # fmt: skip


def test_numbers_name_what_they_say_up_to_the_last_and_nothing_beyond(rng):
    s = plain(rng)
    plan = configurations(s)[0]
    zones = s.ask(clearance.Zones([0.1, 0.3]))
    for part in range(3):
        for z in range(2):
            assert zones.of(part, z).points == zones.zones[2 * part + z]["points"]
        assert "there is no zone 2: there are 2" in str(tried(zones.of, part, 2))
    near, each = s.ask(clearance.NearestK(4)), s.ask(clearance.DistancesPerPart())
    of_parts = s.ask(clearance.MinDistancesPerPart(), poses=plan)
    count = len(of_parts.all) // 3
    for call, rows, number, what in (
        (near.of, near.pairs, 3, "part"),
        (each.of, each.distance, 3, "part"),
        (of_parts.of, of_parts.all, count, "configuration"),
    ):
        assert b"".join(call(k).tobytes() for k in range(number)) == rows.tobytes()
        for beyond in (number, number + 1):
            assert f"there is no {what} {beyond}: there are {number}" in str(tried(call, beyond))
    assert call(np.int64(0)).tobytes() == call(0).tobytes() == call(np.uint8(0)).tobytes() == call(False).tobytes()
    for question in (clearance.MinDistances(), clearance.InCollisions(0.1)):
        r = s.ask(question, poses=plan)
        assert b"".join(r.trajectory(k, 1).tobytes() for k in range(count)) == r.of.tobytes()
        assert isinstance(tried(r.trajectory, count, 1), IndexError) and isinstance(tried(r.trajectory, 1, count), IndexError)
        for horizon in (0, count + 1):
            assert "no whole trajectories" in str(tried(r.trajectory, 0, horizon))
    empty = clearance.Query(s.robot, clearance.DistancesPerPart())(np.zeros((0, 3), "f4"), poses=s.poses)
    assert [len(empty.of(k)) for k in range(3)] == [0, 0, 0] and isinstance(tried(empty.of, 3), IndexError)


def enumerations(rng):
    """(the enumeration, numbers) of each array of a result whose numbers are an enumeration's."""
    s = plain(rng)
    few = clearance.Query(s.robot, clearance.InCollisions(float(np.quantile(s.of_parts, 0.02))))
    yield clearance.State, few(s.asked["points"], poses=configurations(s)[0]).of
    yield clearance.State, s.ask(clearance.MinDistances(), poses=configurations(s)[0]).of["state"]
    yield clearance.PointLabel, s.ask(clearance.SelfFilter(0.1)).labels
    unseen = depth_of_integers(rng).ask(clearance.Unseen())
    for array in (value for name in dir(unseen) if isinstance(value := getattr(unseen, name), np.ndarray)):
        if array.dtype.names and "state" in array.dtype.names:
            yield clearance.State, array["state"]


def test_states_and_labels_in_arrays_equal_their_names(rng):
    kinds, several = set(), False
    for kind, array in enumerations(rng):
        assert issubclass(kind, int) and len(array)
        assert sum(int((array == member).sum()) for member in kind) == len(array), kind
        assert (np.isin(array, list(kind))).all() and kind(array[0]) in list(kind)
        for member in kind:
            assert (array == member).any() == any(kind(int(value)) is member for value in array)
            assert (array == member).any() == (member in array.tolist())
        several |= len(np.unique(array)) > 1
        kinds.add(kind)
    assert kinds == {clearance.State, clearance.PointLabel} and several


def test_a_robot_stops_where_arrays_say_collision():
    robot = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.5]], "f4")})
    poses = np.stack([np.eye(4)] * 3)[:, None]
    poses[1, 0, 0, 3] = 1
    points = np.array([[1, 0, 0]], "f4")
    r = clearance.Query(robot, clearance.InCollisions(0.0))(points, poses=poses)
    assert (r.of == clearance.State.collision).tolist() == [False, True, False]
    assert (r.of == clearance.State.free).tolist() == [True, False, True]
    labels = clearance.Query(robot, clearance.SelfFilter(0.1))(points, poses=poses[1:2, 0]).labels
    assert (labels == clearance.PointLabel.own).any()
    state = clearance.Query(robot, clearance.MinDistance())(points, poses=poses[1]).state
    assert state is clearance.State.collision and f"{state}" == str(state) == "State.collision" and state.name == "collision"


# ---- joints


def test_joints_that_are_forgotten_are_refused_by_name(arm, arm_file):
    from clearance import seeing

    points = np.ones((4, 3), "f4")
    ask, plan = clearance.Query(arm, clearance.MinDistance()), clearance.Query(arm, clearance.MinDistances())
    cloud = {"points": points}
    calls = [
        lambda **j: ask(points, **j),
        lambda **j: plan(points, **j),
        lambda **j: arm.poses(**j),
        lambda **j: arm.link_pose("eye", **j),
        lambda **j: arm.jacobian(j.pop("joints", None), 0, (0, 0, 0), **j),
        lambda **j: arm.part_radii(j.pop("joints", None), 0.1, **j),
        lambda **j: clearance.joint_gradients(arm, j.pop("joints", None), ask(points, arm.rest), **j),
        lambda **j: seeing.scene(arm, **cloud, **j),
    ]
    for call in calls:
        for joints, names in (
            ({}, ("shoulder", "elbow", "wrist")),
            ({"joints": {"elbow": 0.0}}, ("shoulder", "wrist")),
            ({"joints": {}}, ("shoulder", "elbow", "wrist")),
            ({"joints": {"wrist": 0.0, "elbow": 0.0}}, ("shoulder",)),
        ):
            with pytest.raises(ValueError) as error:
                call(**joints)
            text = str(error.value)
            assert "rest=True" in text and [n for n in arm.joints if f'"{n}"' in text] == [
                n for n in arm.joints if n in names
            ], text
            call(**joints, rest=True)
        call(joints={"shoulder": 0.0, "elbow": 0.0, "wrist": 0.0})
        call(joints=[0, 0, 0])
    assert repr(ask(points, rest=True)) == repr(ask(points, arm.rest))
    assert repr(ask(points, {"elbow": 0.7}, rest=True)) == repr(ask(points, [0, 0.7, 0]))
    fixed = arm_file.with_name("fixed.urdf")
    fixed.write_text(arm_file.read_text().replace('"revolute"', '"fixed"'))
    still = clearance.Robot.from_urdf(str(fixed), model="triangles")
    assert clearance.Query(still, clearance.MinDistance())(points).valid == 4  # nothing is forgotten


def test_a_robot_of_meshes_stands_where_it_is_said_to(rng):
    points = np.ones((4, 3), "f4")
    one = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.1]])})
    two, _, poses = random_robot(rng, parts=2)
    for robot, name in ((one, "ball"), (two, "part 0")):
        ask = clearance.Query(robot, clearance.MinDistance())
        for call in (lambda **w: ask(points, **w), lambda **w: robot.poses(**w)):
            with pytest.raises(ValueError, match=f'poses are not given, .*"{name}".*rest=True'):
                call()
            call(rest=True)
        with pytest.raises(ValueError, match="poses are given, so joints, base and rest cannot be"):
            ask(points, poses=np.stack([np.eye(4)] * len(robot)), rest=True)
    base = rigid(rng)
    ask = clearance.Query(one, clearance.MinDistance())
    assert repr(ask(points, base=base)) == repr(ask(points, poses=base[None])) == repr(ask(points, base=base, rest=True))
    with pytest.raises(ValueError, match="poses are not given"):
        clearance.Query(two, clearance.MinDistance())(points, base=base)
    at_base = clearance.Query(two, clearance.MinDistance())
    assert repr(at_base(points, base=base, rest=True)) == repr(at_base(points, poses=np.stack([base] * 2)))


def test_a_wrong_joint_of_many_configurations_says_which(arm):
    points = np.ones((4, 3), "f4")
    q = np.zeros((4096, 3))
    q[1234, 1] = 9
    for call in (lambda j: clearance.Query(arm, clearance.MinDistances())(points, j), arm.poses):
        with pytest.raises(ValueError, match=r'joints\[1234\]: joint "elbow" at 9.0'):
            call(q)
        with pytest.raises(ValueError, match=r'joints\[19, 18\]: joint "elbow" at 9.0'):
            call(q.reshape(64, 64, 3))
        with pytest.raises(ValueError, match=r'^clearance: joint "elbow" at 9.0'):
            call(q[1234])
    q[1234, 1] = np.nan
    with pytest.raises(ValueError, match=r'joints\[1234\]: joint "elbow" has a value that is not finite'):
        arm.poses(q)


def test_many_configurations_for_a_question_about_one_are_named_and_no_other_error_is(arm):
    points, two = np.ones((4, 3), "f4"), np.zeros((2, 3))
    with pytest.raises(ValueError, match="joints gives 2 configurations, so 8 poses of 4 parts, and MinDistance asks about one"):
        clearance.Query(arm, clearance.MinDistance())(points, two)
    ask = clearance.Query(arm, clearance.MinDistances())
    with pytest.raises(ValueError) as error:
        ask(points, two, question=clearance.MinDistances(np.nan))
    assert "d_max" in str(error.value) and "configurations" not in str(error.value)


MIMIC = """<robot name="gripper">
  <link name="hand"/><link name="cam"/>
  <link name="left"><collision><geometry><box size="0.1 0.02 0.1"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.1 0.02 0.1"/></geometry></collision></link>
  <link name="tip"><collision><geometry><box size="0.02 0.02 0.02"/></geometry></collision></link>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/></joint>
  <joint name="grip2" type="prismatic"><parent link="hand"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/><mimic joint="grip" multiplier="2" offset="0.01"/></joint>
  <joint name="tip2" type="prismatic"><parent link="right"/><child link="tip"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="grip2"/></joint>
  <joint name="mount" type="fixed"><parent link="hand"/><child link="cam"/></joint>
</robot>"""


@pytest.fixture
def gripper(tmp_path):
    file = tmp_path / "gripper.urdf"
    file.write_text(MIMIC)
    return clearance.Robot.from_urdf(str(file), model="triangles")


def test_a_value_of_a_joint_that_follows_another_wins(gripper):
    assert gripper.joints == ["grip"] and gripper.mimics == {"grip2": ("grip", 2.0, 0.01), "tip2": ("grip2", 1.0, 0.0)}
    place = lambda **j: gripper.poses(j)[:, :3, 3]
    assert place(grip=0.03) == pytest.approx(np.array([[0, 0.03, 0], [0, -0.07, 0], [0.07, -0.07, 0]]))
    assert place(grip=0.03, grip2=0.02) == pytest.approx(np.array([[0, 0.03, 0], [0, -0.02, 0], [0.02, -0.02, 0]]))
    assert place(grip=0.03, tip2=0.5) == pytest.approx(np.array([[0, 0.03, 0], [0, -0.07, 0], [0.5, -0.07, 0]]))
    assert place(grip=0.03, grip2=0.02, tip2=0.5)[2] == pytest.approx([0.5, -0.02, 0])
    joints = {"grip": 0.03, "grip2": 0.02}
    points = np.array([[0, -0.2, 0]], "f4")
    ask = clearance.Query(gripper, clearance.MinDistance())
    assert ask(points, joints).distance == pytest.approx(0.2 - 0.02 - 0.01, abs=1e-6)
    assert ask(points, {"grip": 0.03}).distance == pytest.approx(0.2 - 0.07 - 0.01, abs=1e-6)
    assert gripper.link_pose("tip", joints)[:3, 3] == pytest.approx([0.02, -0.02, 0])
    # A joint that has its own value does not move with the one that it would follow.
    assert gripper.jacobian({"grip": 0.03}, "right", (0, 0, 0))[:3, 0] == pytest.approx([0, -2, 0])
    assert gripper.jacobian(joints, "right", (0, 0, 0))[:, 0] == pytest.approx(np.zeros(6))
    assert gripper.jacobian(joints, "left", (0, 0, 0))[:3, 0] == pytest.approx([0, 1, 0])
    assert clearance.joint_gradients(gripper, joints, ask(points, joints)) == pytest.approx([0])
    assert clearance.joint_gradients(gripper, {"grip": 0.03}, ask(points, {"grip": 0.03})) == pytest.approx([-2], abs=1e-6)
    assert gripper.part_radii(joints, 0.001)["joints"] == pytest.approx([0.001, 0.001, 0.002])
    assert gripper.part_radii({"grip": 0.03}, [0.001])["joints"] == pytest.approx([0.001, 0.002, 0.004])
    with pytest.raises(ValueError, match="errors is one number for all here"):
        gripper.part_radii(joints, [0.001])
    with pytest.raises(ValueError, match='"grip2" at 0.5.* is outside its limits'):
        gripper.poses({"grip": 0, "grip2": 0.5})
    assert gripper.poses({"grip": 0, "grip2": 0.5}, ignore_limits=True)[1, 1, 3] == -0.5
    with pytest.raises(ValueError, match='no value|"mount" is fixed|takes no value'):
        gripper.poses({"grip": 0, "mount": 1})
    with pytest.raises(ValueError, match='joints says nothing of "grip"'):
        gripper.poses({"grip2": 0.01})


# ---- gradients


def test_gradients_are_those_of_differences_and_only_of_what_was_asked(arm, arm_file, rng):
    points = rng.uniform(-1, 1, (60, 3)).astype("f4") + np.float32([1.5, 0, 0])
    q, base = rng.uniform(-1, 1, (2, 3, 3)), rigid(rng)
    ask = clearance.Query(arm, clearance.MinDistances())
    result = ask(points, q, base=base)
    rows = clearance.joint_gradients(arm, q, result, base)
    assert rows.shape == (2, 3, 3) and np.isfinite(rows).all()
    step = 1e-3
    for k in range(3):
        d = np.eye(3)[k] * step
        ends = [ask(points, q + s * d, base=base).of["distance"].astype(float).reshape(2, 3) for s in (-1, 1)]
        assert rows[..., k] == pytest.approx((ends[1] - ends[0]) / (2 * step), abs=0.02)
    other = clearance.Robot.from_urdf(str(arm_file), model="triangles")
    close = q.copy()
    close[1, 2, 0] = np.nextafter(close[1, 2, 0], 9)
    for given, says in (
        ((other, q, result, base), "of another robot"),
        ((arm, close, result, base), "of other joints, or of another base"),
        ((arm, q, result), "of other joints, or of another base"),
        ((arm, q[:1], result, base), "about 6 configurations, and joints has 3"),
        ((arm, q[..., ::-1], result, base), "of other joints"),
        ((arm, q, result.of, base), "MinDistancesResult"),
    ):
        with pytest.raises(ValueError, match=says):
            clearance.joint_gradients(*given)
    fielded = arm.with_fields(100_000)  # the same robot
    assert (clearance.joint_gradients(fielded, q, result, base) == rows).all()
    one = clearance.Query(arm, clearance.MinDistance())(points, q[0, 0], base=base)
    assert clearance.joint_gradients(arm, q[0, 0], one, base) == pytest.approx(rows[0, 0], abs=1e-6)
    by_poses = clearance.Query(arm, clearance.MinDistances())(points, poses=arm.poses(q, base))
    assert (clearance.joint_gradients(arm, q, by_poses, base) == rows).all()
    certain = clearance.Query(arm, clearance.CertainDistance())(points, q[0, 0], base=base)
    assert (clearance.joint_gradients(arm, q[0, 0], certain.nominal, base) == rows[0, 0]).all()


def test_every_parts_gradients_are_rows_of_their_own(arm, rng):
    points = rng.uniform(-1, 1, (60, 3)).astype("f4") + np.float32([1.5, 0, 0])
    q, base = rng.uniform(-1, 1, (2, 3, 3)), rigid(rng)
    ask = clearance.Query(arm, clearance.MinDistancesPerPart())
    result, parts = ask(points, q, base=base), len(arm)
    rows = clearance.joint_gradients(arm, q, result, base)
    assert rows.shape == (2, 3, parts, 3) and np.isfinite(rows).all()
    step = 1e-3
    for k in range(3):
        d = np.eye(3)[k] * step
        ends = [ask(points, q + s * d, base=base).all["distance"].astype(float).reshape(2, 3, parts) for s in (-1, 1)]
        assert rows[..., k] == pytest.approx((ends[1] - ends[0]) / (2 * step), abs=0.02)
    least = clearance.Query(arm, clearance.MinDistances())(points, q, base=base)
    at = result.all["distance"].reshape(6, parts).argmin(1)
    assert clearance.joint_gradients(arm, q, least, base).reshape(6, 3) == pytest.approx(
        rows.reshape(6, parts, 3)[np.arange(6), at], abs=1e-6)
    assert clearance.joint_gradients(arm, q[1, 2], ask(points, q[1, 2], base=base), base) == pytest.approx(rows[1, 2], abs=1e-6)
    nothing = clearance.Query(arm, clearance.MinDistancesPerPart(d_max=0.01))(points + np.float32(50), q)
    assert np.isnan(clearance.joint_gradients(arm, q, nothing)).all()
    with pytest.raises(ValueError, match="of other joints"):
        clearance.joint_gradients(arm, q[::-1], result, base)
    with pytest.raises(ValueError, match="about 6 configurations, and joints has 1"):
        clearance.joint_gradients(arm, q[0, 0], result, base)


# ---- far away


@pytest.mark.parametrize("place", [(0, 0, 0), (5e6, -7.3e6, 120.4), (1000.5, 40.25, -33)])
@pytest.mark.parametrize("by", ["joints", "poses"])
def test_of_far_doubles_each_of_many_configurations_has_the_answer_that_it_has_alone(arm, rng, place, by):
    base = rigid(rng)
    base[:3, 3] += place
    points = np.asarray(place) + rng.uniform(-1.5, 1.5, (200, 3))
    q = rng.uniform(-1.5, 1.5, (40, 3))
    where = lambda j: {"joints": j, "base": base} if by == "joints" else {"poses": arm.poses(j, base)}
    ask = lambda question, j: clearance.Query(arm, question)(points, **where(j))
    many, of_parts = ask(clearance.MinDistances(), q), ask(clearance.MinDistancesPerPart(), q)
    margin = float(np.median(many.of["distance"]))
    states = ask(clearance.InCollisions(margin), q)
    for k, one in enumerate(q):
        alone, each = ask(clearance.MinDistance(), one), ask(clearance.MinDistancePerPart(), one)
        for name in ("distance", "lower", "upper", "point", "part"):
            assert many.of[k][name] == getattr(alone, name)
        assert (of_parts.of(k)["distance"] == each.parts["distance"]).all()
        assert states.of[k] == ask(clearance.InCollision(margin), one).state
        assert ask(clearance.Distances(), one).distance.min() == alone.distance
        assert ask(clearance.NearestK(1), one).pairs["distance"].min() == alone.distance
        assert ask(clearance.DistancesPerPart(), one).distance.min() == alone.distance


# ---- nothing to see, and what is refused early


class Interface:
    """An array that has nothing but NumPy's interface."""

    def __init__(self, array):
        self.__array_interface__ = array.__array_interface__
        self.array = array


def test_an_array_that_was_broadcast_is_that_many_points():
    query = clearance.Query(clearance.Robot.from_spheres({"a": np.array([[0, 0, 0, 0.1]], "f4")}), clearance.MinDistance())
    row = np.broadcast_to(np.array([[[1, 0, 0], [2, 0, 0]]], "f4"), (4, 2, 3))
    records = np.broadcast_to(np.array([(1, 0, 0)], [("x", "f4"), ("y", "f4"), ("z", "f4")]), (8,))
    for points in (row, row.astype("f8")[:1].repeat(4, 0), records, Interface(row), np.broadcast_to(row[0, 0], (8, 3))):
        r = query(points, poses=np.eye(4)[None])
        assert r.seen == 8 and abs(r.distance - 0.9) < 1e-6


def test_images_without_pixels_are_no_data_as_clouds_without_points_are():
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.1]])})
    ask = clearance.Query(ball, clearance.MinDistance())
    for shape in ((0, 4), (4, 0), (0, 0)):
        assert ask(np.zeros((*shape, 3), "f4"), rest=True).state == clearance.State.no_data
        for kind in ("u2", "f4"):
            image = np.zeros(shape, kind)
            for lens in ({"intrinsics": (1, 1, 0, 0)}, {"rays": np.zeros((*shape, 2), "f4")}):
                r = ask(depth=image, rest=True, **lens)
                assert r.state == clearance.State.no_data and r.lower == 0 and r.seen == 0
                seen = [clearance.depth_image(image, **lens), np.ones((1, 3), "f4")]
                assert ask(clouds=seen, rest=True).seen == 1
    with pytest.raises(ValueError, match=r"\(0, 4, 2\).*\(0, 5, 2\)"):
        ask(depth=np.zeros((0, 4), "u2"), rays=np.zeros((0, 5, 2), "f4"), rest=True)


@pytest.mark.parametrize(
    "question, says",
    [
        (clearance.Zones(), "zones need a threshold"),
        (clearance.Zones([0.3, 0.1]), "nor fall"),
        (clearance.Zones([-0.1]), "negative"),
        (clearance.NearestK(0), "k is 0"),
        (clearance.Within(np.nan), "radius"),
        (clearance.Distances(np.nan), "d_max"),
        (clearance.MinDistances(np.nan), "d_max"),
        (clearance.MinDistances(radii=[0.1, 0.2, 0.3]), "radii"),
        (clearance.InCollision([0.1, 0.2, 0.3]), "3 margins"),
        (clearance.InCollisions(np.nan), "margin"),
        (clearance.SelfFilter(-0.1), "padding"),
        (clearance.CertainDistance([(0.1, 0), (0, 0)]), "2 radii"),
        (clearance.MinDistanceSupported(min_points=0), "0 points"),
        (clearance.Unseen(clearance.Hiding(0.0)), "unseen room"),
    ],
)
def test_options_that_no_frame_could_mend_are_refused_when_the_query_is_made(question, says):
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.1]])})
    with pytest.raises(ValueError, match=says):
        clearance.Query(ball, question)


def test_a_robot_says_what_widens_its_brackets(arm, gripper, tmp_path):
    assert arm.insides == ["closed"] * 4 and (arm.gaps == 0).all()
    assert arm.tolerances[0] == 0 and 0 < arm.tolerances[1] < 2e-4  # a box, and a cylinder of flat sides
    balls = clearance.Robot.from_spheres({"a": np.array([[0, 0, 0, 0.5]])}, gap=0.25, tolerance=0.125)
    assert (balls.insides, balls.gaps.tolist(), balls.tolerances.tolist()) == ([None], [0.25], [0.125])
    r = clearance.Query(balls, clearance.MinDistance())(np.array([[2, 0, 0]], "f4"), rest=True)
    assert r.lower == pytest.approx(r.distance - 0.25 - 0.125, abs=1e-5)
    assert r.upper == pytest.approx(r.distance + 0.125, abs=1e-5)


def test_a_small_negative_distance_has_no_sign_of_its_own():
    ball = clearance.Robot.from_spheres({"ball": np.array([[0, 0, 0, 0.5]], "f4")})
    r = clearance.Query(ball, clearance.MinDistance())(np.array([[0.4999, 0, 0]], "f4"), rest=True)
    assert -0.0005 < r.distance < 0 and str(r).startswith("collision: 0.000 m")
