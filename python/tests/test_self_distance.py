# SPDX-License-Identifier: BSD-3-Clause
"""How far a robot is from itself, over the pairs of parts that can meet; and which these are, by its joints, by an SRDF
file and by samples."""

import copy
import pickle

import numpy as np
import pytest
from conftest import ARM, rigid
from test_errors import refused

import clearance

SRDF = """<?xml version="1.0"?>
<robot name="demo_arm">
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="lower" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="hand" reason="Never"/>
  <disable_collisions link1="hand" link2="eye" reason="Adjacent"/>
</robot>
"""


@pytest.fixture
def packed(arm_file):
    return clearance.Robot.from_urdf(str(arm_file), spheres=64)


def some_robot(rng, parts=4):
    """Parts of random spheres, and poses that leave many of them apart."""
    given = {f"part {k}": np.concatenate([rng.uniform(-0.3, 0.3, (20, 3)), rng.uniform(0.01, 0.05, (20, 1))], 1)
             for k in range(parts)}
    return clearance.Robot.from_spheres(given), np.stack([rigid(rng, 1) for _ in range(parts)])


def brute(robot, poses, a, b):
    """The least distance of two parts' spheres, and which attain it."""
    one, other = ((poses[k][:3, :3] @ robot.spheres(k)[:, :3].T.astype("f8")).T + poses[k][:3, 3] for k in (a, b))
    d = np.linalg.norm(one[:, None] - other[None], axis=2) - robot.spheres(a)[:, None, 3] - robot.spheres(b)[None, :, 3]
    at = np.unravel_index(d.argmin(), d.shape)
    return d[at], at


# ---- distances


@pytest.mark.parametrize("base", [np.eye(4), None])
def test_each_pairs_distance_is_that_of_a_loop_over_all_spheres(rng, base):
    for _ in range(20):
        robot, poses = some_robot(rng)
        if base is None:
            poses = rigid(rng, 3000)[None] @ poses
        r = clearance.SelfQuery(robot)(poses=poses)
        assert len(r.pairs) == 6 and not r.pairs.flags.writeable
        for row in r.pairs:
            is_, at = brute(robot, poses, row["a"], row["b"])
            assert row["distance"] == pytest.approx(is_, abs=2e-3 if base is None else 1e-6)
            assert row["lower"] <= max(is_, 0) + 1e-12
            if base is not None:
                assert (row["sphere_a"], row["sphere_b"]) == at
        least = r.pairs[r.pairs["distance"].argmin()]
        assert (r.a, r.b, r.distance) == (least["a"], least["b"], least["distance"])
        assert r.links == (f"part {r.a}", f"part {r.b}")
        is_ = max(brute(robot, poses, r.a, r.b)[0], 0)
        assert r.lower <= is_ <= r.upper
        if r.state == clearance.State.free:
            way = np.array(r.at_a) - np.array(r.at_b)
            assert np.linalg.norm(way) == pytest.approx(r.distance, abs=2e-3) and r.lower > 0
            assert way / np.linalg.norm(way) == pytest.approx(r.normal, abs=2e-2)


def test_each_pair_has_a_place_and_a_gradient(packed, rng):
    ask = clearance.SelfQuery(packed, clearance.part_pairs(packed, SRDF))
    for _ in range(10):
        q, base = rng.uniform(-1.5, 1.5, 3), rigid(rng)
        r = ask(q, base=base)
        rows, step = clearance.joint_gradients(packed, q, r, base), 1e-4
        assert rows.shape == (len(r.pairs), 3) and np.isfinite(rows).all()
        way = r.pairs["at_a"] - r.pairs["at_b"]
        assert (way * r.pairs["normal"]).sum(1) == pytest.approx(r.pairs["distance"], abs=1e-5)
        for k in range(3):
            ends = [ask(q + s * step * np.eye(3)[k], base=base).pairs for s in (-1, 1)]
            same = (ends[0]["sphere_a"] == ends[1]["sphere_a"]) & (ends[0]["sphere_b"] == ends[1]["sphere_b"])
            by = (ends[1]["distance"].astype("f8") - ends[0]["distance"]) / (2 * step)
            assert rows[same, k] == pytest.approx(by[same], abs=0.02) and same.any()
        with pytest.raises(ValueError, match="of other joints"):
            clearance.joint_gradients(packed, q + 0.1, r, base)


def test_many_configurations_are_answered_as_one_by_one(packed, rng):
    ask = clearance.SelfQuery(packed)
    q = rng.uniform(-2, 2, (3, 5, 3))
    base = rigid(rng)
    all_ = ask.many(q, base=base)
    assert all_.shape == (3, 5) and not all_.flags.writeable
    for at in np.ndindex(3, 5):
        one = ask(q[at], base=base)
        assert all_["distance"][at] == pytest.approx(one.distance, abs=1e-5)
        assert (all_["a"][at], all_["b"][at]) == (one.a, one.b) and all_["state"][at] == one.state
        assert all_["lower"][at] == pytest.approx(one.lower, abs=1e-5)
    assert ask.many(poses=packed.poses(q, base)).tobytes() == all_.tobytes()
    assert ask.many(q[:0]).shape == (0, 5) and ask.many(q[0, 0]).shape == ()
    in_a_row = ask.many(poses=packed.poses(q, base).reshape(-1, 4, 4))
    assert in_a_row.shape == (15,) and in_a_row.tobytes() == all_.tobytes()


def test_a_robot_without_a_pair_says_so_and_is_not_free():
    robot = clearance.Robot.from_spheres({"ball": [[0, 0, 0, 1]]})
    r = clearance.SelfQuery(robot)(rest=True)
    assert r.state == clearance.State.no_data and r.lower == 0 and r.a is None and r.links is None and len(r.pairs) == 0
    assert str(r) == "no_data: no pair of parts can meet"


def test_a_result_says_its_line_and_is_kept(packed):
    r = clearance.SelfQuery(packed)({"shoulder": 1, "elbow": 2.4}, rest=True)
    assert r.links == ("base", "hand") or r.links == ("base", "lower")
    assert str(r).startswith(r.state.name + ": ") and str(r).endswith(f", {r.links[0]} to {r.links[1]}")
    for again in (pickle.loads(pickle.dumps(r)), copy.deepcopy(r)):
        assert repr(again) == repr(r) and again.links == r.links and (again.pairs == r.pairs).all()
    assert r.to_dict()["a"] == r.a


# ---- pairs


def test_without_a_file_all_but_neighbours_can_meet(packed, rng):
    pairs = clearance.part_pairs(packed)
    assert list(pairs) == [("base", "lower"), ("base", "hand"), ("upper", "hand")] and len(pairs) == 3
    assert ("hand", "base") in pairs and (0, "hand") in pairs and ("base", "upper") not in pairs and (1, 1) not in pairs
    assert list(clearance.SelfQuery(packed).pairs) == list(pairs)
    apart = clearance.Robot.from_spheres({k: [[0, 0, 0, 1]] for k in "abc"})
    assert len(clearance.part_pairs(apart)) == 3  # no joints say which are neighbours


def test_an_srdf_file_says_which_pairs_can_meet(packed, tmp_path):
    file = tmp_path / "arm.srdf"
    file.write_text(SRDF)
    for given in (file, str(file), SRDF):
        pairs = clearance.part_pairs(packed, given)
        assert list(pairs) == [("base", "lower"), ("base", "hand"), ("lower", "hand")] and pairs.notes == []
    other = clearance.part_pairs(packed, SRDF.replace("demo_arm", "other").replace('"upper" reason', '"uper" reason', 1))
    assert len(other) == 4 and any("uper" in n for n in other.notes) and any("another robot" in n for n in other.notes)
    refused(lambda: clearance.part_pairs(packed, SRDF.replace("disable", "disabel", 1)), "disable_collisions?", kind=RuntimeError)
    refused(lambda: clearance.part_pairs(packed, ARM), "is a URDF file", kind=RuntimeError)
    refused(lambda: clearance.part_pairs(packed, tmp_path / "none.srdf"), "none.srdf", kind=RuntimeError)


def test_pairs_are_taken_out_put_back_and_kept(packed):
    pairs = clearance.part_pairs(packed)
    less = pairs.without("hand", "base")
    assert ("base", "hand") not in less and ("base", "hand") in pairs and len(less) == 2
    assert list(less.including(0, 3)) == list(pairs)
    for again in (pickle.loads(pickle.dumps(less)), copy.copy(less), copy.deepcopy(less)):
        assert list(again) == list(less) and repr(again) == repr(less)
        assert list(clearance.SelfQuery(packed, again).pairs) == list(less)
    ask = pickle.loads(pickle.dumps(clearance.SelfQuery(packed, less)))
    assert list(ask.pairs) == list(less) and ask(rest=True).distance == clearance.SelfQuery(packed, less)(rest=True).distance
    refused(lambda: pairs.without("hand", "wrist"), "wrist")
    refused(lambda: pairs.without("hand", "hand"), "no pair")
    refused(lambda: pairs.without("hand", 9), "9", kind=(IndexError, ValueError))


def test_samples_say_what_always_touches_and_what_is_never_near(packed, rng):
    q = rng.uniform(*packed.limits.T, (100, 3))
    pairs = clearance.sample_pairs(packed, q, 0.02)
    assert set(pairs) | set(pairs.always) | set(pairs.never) == set(clearance.part_pairs(packed))
    assert ("upper", "hand") in pairs.never  # the lower link is between them
    near = clearance.SelfQuery(packed).many(q)["lower"].min()
    assert near == 0 or near > 0.02 or len(pairs) > 0
    everything = clearance.part_pairs(packed).including("base", "upper").including("lower", "hand")
    touching = clearance.sample_pairs(packed, q, 0.02, everything)
    assert ("lower", "hand") in touching.always and ("lower", "hand") not in touching
    refused(lambda: clearance.sample_pairs(packed, q, -1), "-1")
    refused(lambda: clearance.sample_pairs(packed, q[:0], 0.1), "no whole configurations")


def test_what_is_held_does_not_meet_what_holds_it(packed):
    box = clearance.Robot.from_spheres({"box": [[0, 0, 0, 0.05]]})
    held = packed.attach("hand", box, np.eye(4))
    for srdf in (None, SRDF):
        pairs = clearance.part_pairs(held, srdf)
        assert ("box", "hand") not in pairs and ("box", "base") in pairs
    assert any("attached" in n for n in clearance.part_pairs(held, SRDF).notes)


# ---- refusals


def test_what_cannot_be_asked_is_refused(arm, packed, rng):
    refused(lambda: clearance.SelfQuery(arm), "inner spheres", 'model="spheres"')
    ask = clearance.SelfQuery(packed)
    refused(lambda: ask(), "rest=True")
    refused(lambda: ask(rng.uniform(-1, 1, (2, 3))), "many(...)")
    refused(lambda: ask(np.zeros(3), poses=packed.poses(np.zeros(3))), "poses are given")
    refused(lambda: ask(poses=packed.poses(np.zeros(3))[:2]), "2 poses")
    refused(lambda: ask.many(np.zeros((2, 4))), "(2, 4)")
    refused(lambda: clearance.SelfQuery(packed, [("hand", "base")]), "part_pairs(robot)", kind=TypeError)
    refused(lambda: clearance.SelfQuery(packed, clearance.part_pairs(packed.attach(
        "hand", clearance.Robot.from_spheres({"box": [[0, 0, 0, 1]]}), np.eye(4)))), "another robot")
    bare = clearance.Robot.from_spheres({"a": [[0, 0, 0, 1]], "b": [[3, 0, 0, 1]]})
    refused(lambda: clearance.part_pairs(bare, SRDF), "URDF")
