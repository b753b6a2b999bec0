# SPDX-License-Identifier: BSD-3-Clause
"""Every question against NumPy: all distances of all points to all spheres, in double.

A scene is a robot of spheres and what a sensor gives, in every form that Python has for it. Each question has a check,
which is found by the question's name. A question without one fails.
"""

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
from conftest import moved, random_robot, rigid

import clearance
from clearance import State

near_enough = 4e-6  # metres: what floats may lose at about a metre


@dataclasses.dataclass
class Scene:
    """`asked` goes to the query. `clouds` are what it must see: (points in the world, why each counts or not)."""

    robot: clearance.Robot
    spheres: list
    poses: np.ndarray
    asked: dict
    clouds: list
    exact: bool = False  # All distances are exact in floats, so equal ones are equal, and the lowest number must win.

    def __post_init__(self):
        self.world = np.concatenate([p for p, _ in self.clouds]) if self.clouds else np.zeros((0, 3))
        self.why = np.concatenate([w for _, w in self.clouds]) if self.clouds else np.zeros(0, object)
        self.valid = self.why == "valid"
        self.sizes = [len(p) for p, _ in self.clouds]
        self.first = np.concatenate([[0], np.cumsum(self.sizes)]).astype(int)
        self.of_parts, self.primitives = self.table(self.poses)

    def table(self, poses):
        """Distances (parts, points), NaN where there is no point, and the nearest sphere of each."""
        rows, primitives = [], []
        for spheres, pose in zip(self.spheres, poses):
            centres = moved(pose, spheres[:, :3])
            with np.errstate(invalid="ignore"):
                d = np.linalg.norm(self.world[:, None] - centres, axis=2) - spheres[:, 3]
            d[~self.valid] = np.nan
            lowest = np.argmin(np.where(np.isnan(d), np.inf, d), axis=1)
            rows.append(d[np.arange(len(d)), lowest])
            primitives.append(lowest)
        shape = (len(self.spheres), len(self.world))
        return np.reshape(rows, shape), np.reshape(primitives, shape)

    def number(self, cloud, point):
        return self.first[cloud] + point

    def place(self, number):
        cloud = int(np.searchsorted(self.first, number, "right")) - 1
        return cloud, int(number - self.first[cloud])

    def ask(self, question, **other):
        return clearance.Query(self.robot, question)(**{"poses": self.poses, **self.asked, **other})

    def least(self):
        return np.nanmin(self.of_parts) if self.valid.any() else np.nan

    def check_counts(self, counts):
        assert counts.seen == len(self.world)
        assert counts.valid == self.valid.sum()
        for reason, count in counts.dropped.items():
            assert count == (self.why == reason).sum(), reason

    def check_pair(self, distance, cloud, point, part, primitive=None, of_parts=None):
        """That a named pair is as near as it says."""
        of_parts = self.of_parts if of_parts is None else of_parts
        assert of_parts[part, self.number(cloud, point)] == pytest.approx(distance, abs=near_enough)
        if primitive is not None and of_parts is self.of_parts:
            at = self.world[self.number(cloud, point)]
            sphere = self.spheres[part][primitive]
            assert np.linalg.norm(at - moved(self.poses[part], sphere[:3])) - sphere[3] == pytest.approx(
                distance, abs=near_enough)


def why_of(points):
    return np.where(np.isfinite(np.asarray(points, "f8")).all(axis=-1), "valid", "not_finite").astype(object).reshape(-1)


def scene_of(rng, given, points, pose=None, why=None, robot=None):
    """One cloud: `given` to the query; `points` in its frame, as they should be read."""
    robot = robot or random_robot(rng)
    points = np.asarray(points, "f8").reshape(-1, 3)
    with np.errstate(invalid="ignore"):
        world = points if pose is None else moved(pose, points)
    return Scene(*robot, given, [(world, why_of(points) if why is None else why)])


def some(rng, n=300):
    return rng.uniform(-1, 1, (n, 3)).astype("f4")


scenes = {}


def scene(make):
    scenes[make.__name__] = make
    return make


@scene
def plain(rng):
    p = some(rng)
    return scene_of(rng, {"points": p}, p)


@scene
def far_away(rng):
    p = some(rng) + np.float32(3)
    return scene_of(rng, {"points": p}, p)


@scene
def with_a_pose(rng):
    p, pose = some(rng), rigid(rng)
    return scene_of(rng, {"points": p, "cloud_pose": pose}, p, pose)


@scene
def not_finite(rng):
    p = some(rng)
    p[::3, 0], p[1::7, 1], p[2::11, 2] = np.nan, np.inf, -np.inf
    return scene_of(rng, {"points": p}, p)


@scene
def all_not_finite(rng):
    p = np.full((50, 3), np.nan, "f4")
    return scene_of(rng, {"points": p}, p)


@scene
def no_points(rng):
    p = np.zeros((0, 3), "f4")
    return scene_of(rng, {"points": p}, p)


@scene
def no_clouds(rng):
    return Scene(*random_robot(rng), {"clouds": []}, [])


@scene
def one_point(rng):
    p = some(rng, 1)
    return scene_of(rng, {"points": p}, p)


@scene
def a_list(rng):
    p = some(rng, 5)
    return scene_of(rng, {"points": p.tolist()}, p)


@scene
def several_clouds(rng):
    robot, clouds, seen = random_robot(rng), [], []
    for n in (100, 0, 333, 1):
        p, pose = some(rng, n), rigid(rng)
        p[::9] = np.nan
        clouds.append(clearance.points(p, pose))
        with np.errstate(invalid="ignore"):
            seen.append((moved(pose, p), why_of(p)))
    return Scene(*robot, {"clouds": clouds}, seen)


@scene
def points_and_depth_and_clouds(rng):
    robot, p, more, pose = random_robot(rng), some(rng, 60), some(rng, 70), rigid(rng)
    image = rng.integers(300, 900, (12, 16)).astype("u2")
    view, why = pixels(image, camera, 0.001)
    asked = {"points": p, "depth": image, "intrinsics": camera, "camera_pose": pose, "clouds": [more]}
    return Scene(*robot, asked, [(p.astype("f8"), why_of(p)), (moved(pose, view), why), (more.astype("f8"), why_of(more))])


@scene
def doubles(rng):
    p = some(rng).astype("f8") + rng.uniform(-1e-9, 1e-9, (300, 3))
    return scene_of(rng, {"points": p}, p)


@scene
def fortran_order(rng):
    p = np.asfortranarray(some(rng))
    return scene_of(rng, {"points": p}, p)


@scene
def every_third(rng):
    p = some(rng, 900)[::3]
    return scene_of(rng, {"points": p}, p)


@scene
def columns_of_a_wider_array(rng):
    p = rng.uniform(-1, 1, (500, 7)).astype("f4")[:, 2:5]
    return scene_of(rng, {"points": p}, p)


@scene
def one_point_many_times(rng):
    p = np.broadcast_to(some(rng, 1), (40, 3))
    return scene_of(rng, {"points": p}, p)


@scene
def read_only(rng):
    p = some(rng)
    p.flags.writeable = False
    return scene_of(rng, {"points": p}, p)


@scene
def organised(rng):
    p = some(rng, 30 * 40).reshape(30, 40, 3)
    return scene_of(rng, {"points": p}, p)


@scene
def a_window_of_an_organised_cloud(rng):
    p = some(rng, 30 * 40).reshape(30, 40, 3)[3:25:2, 5:31]
    return scene_of(rng, {"points": p}, p)


@scene
def columns_before_rows(rng):
    p = some(rng, 30 * 40).reshape(30, 40, 3).transpose(1, 0, 2)
    return scene_of(rng, {"points": p}, p)


@scene
def records(rng):
    """As of a PointCloud2: padded, unaligned, with other fields between."""
    kind = np.dtype({"names": ["ring", "z", "x", "y", "intensity"], "formats": ["u1", "<f4", "<f4", "<f4", "<f4"],
                     "offsets": [0, 3, 11, 19, 24], "itemsize": 31})
    p, cloud = some(rng, 300), np.zeros(300, kind)
    for k, axis in enumerate("xyz"):
        cloud[axis] = p[:, k]
    return scene_of(rng, {"points": cloud}, p)


@scene
def rows_of_records_of_doubles(rng):
    kind = np.dtype([("x", "<f8"), ("y", "<f8"), ("z", "<f8"), ("rgb", "<u4")])
    p, cloud = some(rng, 200).astype("f8"), np.zeros((10, 20), kind)
    for k, axis in enumerate("xyz"):
        cloud[axis] = p[:, k].reshape(10, 20)
    return scene_of(rng, {"points": cloud[2:9, 3:]}, p.reshape(10, 20, 3)[2:9, 3:])


@scene
def a_field_of_odd_records(rng):
    """Whose steps are no whole numbers of floats."""
    cloud = np.zeros(200, np.dtype([("ring", "u1"), ("xyz", "<f4", (3,)), ("time", "<u2")]))
    cloud["xyz"] = some(rng, 200)
    return scene_of(rng, {"points": cloud["xyz"]}, cloud["xyz"])


@scene
def a_sensor_with_limits(rng):
    p, sensor = some(rng), np.array([0.25, -0.5, 0.125])
    p[::5] = sensor
    away = np.linalg.norm(p - sensor, axis=1)
    why = np.where(away == 0, "missing", np.where((away >= 0.5) & (away <= 1.25), "valid", "out_of_range")).astype(object)
    cloud = clearance.points(p, nearest=0.5, farthest=1.25, sensor=tuple(sensor), zero_is_missing=True)
    return scene_of(rng, {"points": cloud}, p, why=why)


camera = (20.0, 25.0, 7.5, 5.25)


def pixels(image, k, scale, nearest=0, farthest=np.inf):
    """A depth image's points in double, and why each counts or not."""
    v, u = np.mgrid[:image.shape[0], :image.shape[1]]
    with np.errstate(invalid="ignore"):
        z = image.astype("f8") * scale
        points = np.stack([(u - k[2]) / k[0] * z, (v - k[3]) / k[1] * z, z], axis=-1)
        out = (z < nearest) | (z > farthest)
    why = np.where(out, "out_of_range", "valid").astype(object)
    why[~np.isfinite(z)] = "not_finite"
    why[image == 0] = "missing"
    if image.dtype.kind == "u":
        why[image == 65535] = "saturated"
    else:
        why[np.isneginf(image)] = "too_close"
    return points.reshape(-1, 3), why.reshape(-1)


@scene
def depth_of_integers(rng):
    image = rng.integers(300, 900, (12, 16)).astype("u2")
    image[rng.random(image.shape) < 0.1] = 0
    image[rng.random(image.shape) < 0.1] = 65535
    pose = rigid(rng)
    points, why = pixels(image, camera, 0.001)
    return scene_of(rng, {"depth": image, "intrinsics": camera, "camera_pose": pose}, points, pose, why)


@scene
def depth_of_floats(rng):
    image = rng.uniform(0.3, 0.9, (12, 16)).astype("f4")
    for odd in (0, np.nan, np.inf):
        image[rng.random(image.shape) < 0.1] = odd
    pose, k = rigid(rng), np.array([[camera[0], 0, camera[2]], [0, camera[1], camera[3]], [0, 0, 1]])
    points, why = pixels(image, camera, 1)
    return scene_of(rng, {"depth": image, "intrinsics": k, "camera_pose": pose}, points, pose, why)


@scene
def something_too_close_to_measure(rng):
    image = rng.uniform(0.3, 0.9, (12, 16)).astype("f4")
    image[3, 4] = -np.inf
    points, why = pixels(image, camera, 1)
    return scene_of(rng, {"depth": image, "intrinsics": camera}, points, why=why)


@scene
def a_crop_of_a_depth_image(rng):
    image = rng.integers(300, 900, (40, 50)).astype("u2")[7:31, 11:30]
    points, why = pixels(image, camera, 0.001)
    return scene_of(rng, {"depth": image, "intrinsics": camera}, points, why=why)


@scene
def every_second_row_of_a_depth_image(rng):
    image = rng.uniform(0.3, 0.9, (40, 32)).astype("f4")[1::2]
    points, why = pixels(image, camera, 1)
    return scene_of(rng, {"depth": image, "intrinsics": camera}, points, why=why)


@scene
def a_depth_image_with_a_scale_and_limits(rng):
    image = rng.integers(1, 5000, (12, 16)).astype("u2")
    points, why = pixels(image, camera, 2.0**-12, 0.25, 0.75)
    cloud = clearance.depth_image(image, camera, scale=2.0**-12, nearest=0.25, farthest=0.75)
    return scene_of(rng, {"points": cloud}, points, why=why)


@scene
def a_depth_image_with_rays(rng):
    image = rng.integers(300, 900, (12, 16)).astype("u2")
    rays = rng.uniform(-0.7, 0.7, (12, 16, 2)).astype("f4")
    z = image.astype("f8") * 0.001
    points = np.concatenate([rays.astype("f8") * z[..., None], z[..., None]], axis=2)
    return scene_of(rng, {"depth": image, "rays": rays}, points)


@scene
def ties(rng):
    """Whole numbers: floats are exact, and many distances are equal."""
    spheres = {"a": np.array([[0, 0, 0, 1], [4, 0, 0, 1]], "f4"), "b": np.array([[0, 4, 0, 1], [0, 0, 0, 1]], "f4")}
    robot = clearance.Robot.from_spheres(spheres)
    p = np.stack(np.meshgrid(*[np.arange(-4, 5)] * 3, indexing="ij"), axis=-1).reshape(-1, 3).astype("f4")
    p = p[rng.permutation(len(p))]
    clouds = [clearance.points(p[:300]), clearance.points(p[300:])]
    return Scene(robot, [s.astype("f8") for s in spheres.values()], np.stack([np.eye(4)] * 2), {"clouds": clouds},
                 [(p[:300].astype("f8"), why_of(p[:300])), (p[300:].astype("f8"), why_of(p[300:]))], exact=True)


@scene
def inside(rng):
    robot = random_robot(rng)
    centre = moved(robot[2][1], robot[1][1][:1, :3])
    p = (centre + rng.uniform(-0.01, 0.01, (30, 3))).astype("f4")
    return scene_of(rng, {"points": p}, p, robot=robot)


checks = {}


def check(question):
    return lambda its: checks.__setitem__(question, its) or its


def questions():
    """The classes whose instances a query accepts."""
    robot = clearance.Robot.from_spheres({"a": np.array([[0, 0, 0, 1]], "f4")})
    found = []
    for name, kind in vars(clearance).items():
        try:
            question = kind()
        except Exception:
            continue
        try:
            clearance.Query(robot, question)
        except TypeError:
            continue
        except ValueError:
            pass  # it is about other robots
        found.append(name)
    return sorted(found)


def test_every_question_has_a_check():
    assert len(questions()) >= 14
    for name in questions():
        assert name in checks, f"clearance.{name} is a question, and nothing here compares it with NumPy: write a check"
    for name in checks:
        assert name in questions(), f"there is a check of {name}, and clearance has no such question"


@pytest.mark.parametrize("made", scenes)
@pytest.mark.parametrize("question", questions())
def test_it_says_what_numpy_says(question, made, rng):
    checks[question](scenes[made](rng))


def check_minimum(s, r, of_parts=None, poses=None):
    """One result of a minimum of the parts whose rows these are."""
    of_parts = s.of_parts if of_parts is None else of_parts
    if not s.valid.any():
        assert r.state == State.no_data and r.lower == 0 and r.upper == np.inf and np.isnan(r.distance)
        assert r.point is None and r.part is None and r.link is None
        return
    d = np.nanmin(of_parts)
    assert r.distance == pytest.approx(d, abs=near_enough)
    assert r.lower <= max(d, 0) <= r.upper
    unknown = (s.why == "too_close").any()
    assert r.upper - r.lower < 5e-5 or unknown
    assert r.lower == 0 or not unknown
    s.check_pair(r.distance, r.cloud, r.point, r.part, r.primitive, of_parts)
    if d > near_enough * 5:
        assert r.state == (State.possible if unknown else State.free)
    elif d < -near_enough * 5:
        assert r.state == State.collision
    if s.exact:
        assert r.distance == d
        number = int(np.flatnonzero((of_parts == d).any(axis=0))[0])
        part = int(np.flatnonzero(of_parts[:, number] == d)[0])
        assert (r.cloud, r.point, r.part) == (*s.place(number), part)
        assert r.primitive == s.primitives[part, number]


@check("MinDistance")
def _(s):
    r = s.ask(clearance.MinDistance())
    check_minimum(s, r)
    s.check_counts(r)
    if r.point is None:
        return
    number = s.number(r.cloud, r.point)
    sphere = s.spheres[r.part][r.primitive]
    centre = moved(s.poses[r.part], sphere[:3])
    away = s.world[number] - centre
    assert r.link == s.robot.parts[r.part]
    assert r.at == pytest.approx(s.world[number], abs=near_enough)
    if not away.any():
        assert r.normal == (0, 0, 0)  # at the centre of a sphere there is no direction
        return
    assert r.nearest == pytest.approx(centre + away / np.linalg.norm(away) * sphere[3], abs=2e-5)
    assert r.normal == pytest.approx(away / np.linalg.norm(away), abs=2e-4)


@check("MinDistancePerPart")
def _(s):
    r = s.ask(clearance.MinDistancePerPart())
    check_minimum(s, r.all)
    s.check_counts(r.all)
    assert len(r.parts) == len(s.spheres)
    for k, part in enumerate(r.parts):
        if not s.valid.any():
            assert part["distance"] == np.inf and part["point"] == clearance.none
            continue
        assert part["distance"] == pytest.approx(np.nanmin(s.of_parts[k]), abs=near_enough)
        s.check_pair(part["distance"], part["cloud"], part["point"], k, part["primitive"])
        if s.exact:
            number = int(np.nanargmin(s.of_parts[k]))
            assert (part["cloud"], part["point"]) == s.place(number)
            assert part["primitive"] == s.primitives[k, number]


@check("MinDistanceSupported")
def _(s):
    radius, least = 0.15, 3
    r = s.ask(clearance.MinDistanceSupported(min_points=least, radius=radius))
    s.check_counts(r.counts)
    if not s.valid.any():
        assert r.state == State.no_data and r.point is None
        return
    nearest = s.of_parts.min(axis=0)
    others = s.world[s.valid]
    support = np.array([(np.linalg.norm(others - p, axis=1) <= radius).sum() if ok else 0
                        for p, ok in zip(s.world, s.valid)])
    confirmed = support >= least
    if not confirmed.any():
        assert r.state == State.possible and r.distance == np.inf and r.point is None
        assert r.isolated == s.valid.sum()
        return
    d = nearest[confirmed].min()
    assert r.distance == pytest.approx(d, abs=near_enough)
    assert r.lower <= max(d, 0)
    assert confirmed[s.number(r.cloud, r.point)]
    s.check_pair(r.distance, r.cloud, r.point, r.part, r.primitive)
    assert r.isolated == (nearest[s.valid & ~confirmed] < d).sum()
    if r.isolated:
        alone = r.nearest_isolated
        assert alone.distance == pytest.approx(nearest[s.valid & ~confirmed].min(), abs=near_enough)
        assert not confirmed[s.number(alone.cloud, alone.point)]


def configurations(s):
    """A few configurations of the robot, (3, parts, 4, 4), and the distances of each."""
    moves = np.stack([s.poses] * 3)
    moves[1, :, 0, 3] += 0.5
    moves[2, :, 2, 3] -= 4
    return moves, [s.table(poses)[0] for poses in moves]


def check_within_d_max(s, r, of_parts, d_max):
    if s.valid.any() and np.nanmin(of_parts) > d_max:
        assert r.distance == np.inf and r.point is None and r.part is None
        unknown = (s.why == "too_close").any()
        assert r.lower == 0 if unknown else d_max - 5e-5 < r.lower <= d_max
        assert r.state == (State.possible if unknown else State.free)
    else:
        check_minimum(s, r, of_parts)


def each_result(rows):
    """Rows of results of minima, as the results of single ones."""
    state = {s.value: s for s in State}
    named = lambda n: None if n == clearance.none else int(n)
    for row in rows:
        yield type("Row", (), {"state": state[int(row["state"])], "link": None,
                               **{n: float(row[n]) for n in ("distance", "lower", "upper")},
                               **{n: named(row[n]) for n in ("cloud", "point", "part", "primitive")}})


@check("MinDistances")
def _(s):
    if s.exact:
        return check_exact_configurations(s)
    moves, tables = configurations(s)
    for d_max in (np.inf, 1.0):
        r = s.ask(clearance.MinDistances(d_max), poses=moves)
        assert len(r.of) == 3
        for one, table in zip(each_result(r.of), tables):
            check_within_d_max(s, one, table, d_max)


def check_exact_configurations(s):
    """Each is what the question about one configuration says, to the bit."""
    moves, _ = configurations(s)
    r = s.ask(clearance.MinDistances(), poses=moves)
    for row, poses in zip(r.of, moves):
        alone = s.ask(clearance.MinDistance(), poses=poses)
        assert (row["distance"], row["point"], row["part"]) == (alone.distance, alone.point, alone.part)


@check("MinDistancesPerPart")
def _(s):
    moves, tables = configurations(s)
    for d_max in (np.inf, 1.0):
        r = s.ask(clearance.MinDistancesPerPart(d_max), poses=moves)
        assert r.parts == len(s.spheres) and r.size() == 3
        for c, table in enumerate(tables):
            for k, one in enumerate(each_result(r.of(c))):
                if one.part is not None:
                    assert one.part == k
                alone = np.full_like(table, np.nan)
                alone[k] = table[k]
                if s.exact:
                    assert one.distance == pytest.approx(np.nanmin(alone), abs=near_enough) or np.nanmin(alone) > d_max
                else:
                    check_within_d_max(s, one, alone, d_max)


def margins_around(s):
    """Margins that are certainly above and below the least distance."""
    return (0.01, 5.0) if not s.valid.any() else (s.least() - 0.01, s.least() + 0.02)


@check("InCollision")
def _(s):
    for margin in margins_around(s):
        r = s.ask(clearance.InCollision(margin))
        s.check_counts(r.counts)
        if not s.valid.any():
            assert r.state == State.no_data and r.point is None
            continue
        if margin < s.least():
            assert r.state == (State.possible if (s.why == "too_close").any() else State.free) and r.point is None
            continue
        assert r.state == State.collision
        assert s.of_parts[r.part, s.number(r.cloud, r.point)] <= margin + near_enough
        if not s.exact and (np.abs(s.of_parts[:, s.valid] - margin) < 2e-5).any():
            continue  # one may count, or not
        number = int(np.flatnonzero((s.of_parts <= margin).any(axis=0))[0])
        part = int(np.flatnonzero(s.of_parts[:, number] <= margin)[0])
        assert (r.cloud, r.point, r.part) == (*s.place(number), part)


@check("InCollisions")
def _(s):
    moves, tables = configurations(s)
    for margin in margins_around(s):
        r = s.ask(clearance.InCollisions([margin] * len(s.spheres)), poses=moves)
        s.check_counts(r.counts)
        first = None
        for c, (state, table) in enumerate(zip(r.of, tables)):
            state = State(int(state))
            if not s.valid.any():
                expected = State.no_data
            elif abs(np.nanmin(table) - margin) < 1e-4:
                continue
            elif np.nanmin(table) < margin:
                expected = State.collision
            else:
                expected = State.possible if (s.why == "too_close").any() else State.free
            assert state == expected
            first = c if first is None and expected != State.free else first
        assert r.first_not_free() == (3 if first is None else first)


def check_each_point(s, found, expected, d_max):
    """One number for each point."""
    assert found.dtype == np.float32 and len(found) == expected.size
    assert np.isnan(found[np.isnan(expected)]).all()
    within = expected < d_max - near_enough
    assert np.abs(found[within] - expected[within]).max(initial=0) < near_enough
    assert np.isposinf(found[expected > d_max + near_enough]).all()


@check("Distances")
def _(s):
    expected = s.of_parts.min(axis=0)
    for d_max in (np.inf, 0.4):
        r = s.ask(clearance.Distances(d_max, which=True))
        s.check_counts(r.counts)
        check_each_point(s, r.distance, expected, d_max)
        for number in np.flatnonzero(np.isfinite(r.distance))[:100]:
            s.check_pair(r.distance[number], *s.place(number), r.part[number], r.primitive[number])
            distance = float(r.distance[number])
            of_its_part = r.certain.lower(distance, part=r.part[number])
            assert r.certain.lower(distance) <= of_its_part <= max(expected[number], 0)
        nothing = ~np.isfinite(r.distance)
        assert (r.part[nothing] == clearance.none).all() and (r.primitive[nothing] == clearance.none).all()
        if s.exact and d_max == np.inf:
            assert (r.part == s.of_parts.argmin(axis=0)).all()
            assert (r.primitive == np.take_along_axis(s.primitives, r.part[None].astype(int), 0)[0]).all()
    assert len(s.ask(clearance.Distances()).part) == 0


@check("SignedDistances")
def _(s):
    with pytest.raises(ValueError, match="robots of triangles"):
        s.ask(clearance.SignedDistances())
    half = np.array([0.3, 0.2, 0.1])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
             [1, 5, 7], [1, 7, 3]]
    robot = clearance.Robot.from_meshes({"box": (corners, faces)}, model="triangles")
    pose = s.poses[:1]
    r = clearance.Query(robot, clearance.SignedDistances())(**{**s.asked, "poses": pose})
    with np.errstate(invalid="ignore"):
        beyond = np.abs(moved(np.linalg.inv(pose[0]), s.world)) - half
        expected = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1, initial=-9), 0)
    expected[~s.valid] = np.nan
    s.check_counts(r.counts)
    check_each_point(s, r.distance, expected, np.inf)


@check("DistancesPerPart")
def _(s):
    for d_max in (np.inf, 0.4):
        r = s.ask(clearance.DistancesPerPart(d_max))
        s.check_counts(r.counts)
        assert r.points == len(s.world)
        check_each_point(s, r.distance, s.of_parts.reshape(-1), d_max)
        for k in range(len(s.spheres)):
            check_each_point(s, r.of(k), s.of_parts[k], d_max)
            assert r.certain.lower(0.5) <= r.certain.lower(0.5, part=k) <= 0.5
        for wrong in (len(s.spheres), -1):
            with pytest.raises(IndexError):
                r.certain.lower(0.5, part=wrong)


@check("NearestK")
def _(s):
    for d_max in (np.inf, 0.4):
        r = s.ask(clearance.NearestK(5, d_max))
        s.check_counts(r.counts)
        assert r.per_part == 5 and len(r.pairs) == 5 * len(s.spheres)
        for k in range(len(s.spheres)):
            its = r.of(k)
            order = [n for n in np.argsort(s.of_parts[k], kind="stable") if s.of_parts[k, n] <= d_max][:5]
            assert (its["part"] == k).all()
            there = its["point"] != clearance.none
            if s.valid.any() and np.nanmin(np.abs(s.of_parts[k] - d_max)) < near_enough:
                continue
            assert there.sum() == len(order)
            assert np.isposinf(its["distance"][~there]).all()
            assert its["distance"][there] == pytest.approx(s.of_parts[k, order], abs=near_enough)
            for pair in its[there]:
                s.check_pair(pair["distance"], pair["cloud"], pair["point"], k, pair["primitive"])
            if s.exact:
                assert [(p["cloud"], p["point"]) for p in its] == [s.place(n) for n in order]


@check("Within")
def _(s):
    for radius in (0.3, [0.1 * (k + 1) for k in range(len(s.spheres))]):
        r = s.ask(clearance.Within(radius))
        s.check_counts(r.counts)
        assert len(r.offsets) == len(s.spheres) + 1 and r.offsets[-1] == len(r.pairs)
        for k in range(len(s.spheres)):
            most = radius if isinstance(radius, float) else radius[k]
            its = r.pairs[int(r.offsets[k]):int(r.offsets[k + 1])]
            certain = set(np.flatnonzero(s.of_parts[k] < most - near_enough))
            possible = set(np.flatnonzero(s.of_parts[k] <= most + near_enough))
            listed = [s.number(p["cloud"], p["point"]) for p in its]
            assert len(listed) == len(set(listed)) and certain <= set(listed) <= possible
            assert (its["part"] == k).all() and (np.diff(its["distance"]) >= 0).all()
            for pair in its:
                s.check_pair(pair["distance"], pair["cloud"], pair["point"], k, pair["primitive"])


@check("Zones")
def _(s):
    thresholds = [0.05, 0.21, 0.55]
    r = s.ask(clearance.Zones(thresholds, min_points=2))
    s.check_counts(r.counts)
    assert r.per_part == 3 and r.min_points == 2 and r.unseen == 0
    innermost = 3
    for k in range(len(s.spheres)):
        for z, threshold in enumerate(thresholds):
            its = r.of(k, z)
            near = s.of_parts[k] <= threshold
            if s.valid.any() and np.nanmin(np.abs(s.of_parts[k] - threshold)) < 2e-5:
                continue
            assert its.points == near.sum() == r.zones[k * 3 + z]["points"]
            if near.any():
                assert its.nearest == pytest.approx(np.nanmin(s.of_parts[k]), abs=near_enough)
                s.check_pair(its.nearest, its.nearest_cloud, its.nearest_point, k)
                assert (its.first_cloud, its.first_point) == s.place(np.flatnonzero(near)[0])
            else:
                assert its.nearest == np.inf and its.first_point is None and its.nearest_point is None
            if near.sum() >= 2:
                innermost = min(innermost, z)
    known = s.valid.any() and not (s.why == "too_close").any()
    assert r.innermost() == (innermost if known else 0)


@check("SelfFilter")
def _(s):
    padding = 0.1
    r = s.ask(clearance.SelfFilter(padding))
    s.check_counts(r.counts.points)
    nearest = s.of_parts.min(axis=0)
    labels = np.array([clearance.PointLabel(int(label)) for label in r.labels], object)
    assert len(labels) == len(s.world)
    assert (labels[~s.valid] == clearance.PointLabel.no_point).all()
    assert (labels[nearest < padding - 2e-5] == clearance.PointLabel.own).all()
    assert (labels[nearest > padding + 2e-5] == clearance.PointLabel.rest).all()
    assert r.counts.own == (labels == clearance.PointLabel.own).sum()
    assert r.counts.uncertain == (labels == clearance.PointLabel.uncertain).sum()
    hidden = (labels == clearance.PointLabel.own) | (labels == clearance.PointLabel.no_point)
    assert (r.rest == np.flatnonzero(~hidden)).all()
    assert list(r.offsets) == list(s.first)


@check("PartWitnesses")
def _(s):
    minima = s.ask(clearance.MinDistancePerPart()).parts
    found = s.ask(clearance.PartWitnesses(minima))
    assert len(found) == len(s.spheres)
    for k, (one, least) in enumerate(zip(found, minima)):
        if least["point"] == clearance.none:
            assert one["point"] == clearance.none and one["distance"] == np.inf
            continue
        for name in ("distance", "cloud", "point", "primitive"):
            assert one[name] == least[name]
        assert one["part"] == k
        at = s.world[s.number(one["cloud"], one["point"])]
        sphere = s.spheres[k][one["primitive"]]
        away = at - moved(s.poses[k], sphere[:3])
        assert one["at"] == pytest.approx(at, abs=near_enough)
        direction = away / np.linalg.norm(away) if away.any() else (0, 0, 0)
        assert one["normal"] == pytest.approx(direction, abs=2e-4)


@check("Unseen")
def _(s):
    if not s.clouds:
        assert s.ask(clearance.Unseen()).all.state == State.no_data
        return
    if not (set(s.asked) <= {"depth", "intrinsics", "rays", "camera_pose"}):
        try:  # one is an image with limits, all others are points, or points among them
            assert s.ask(clearance.Unseen()).all.seen == len(s.world)
            assert isinstance(s.asked["points"], clearance.Cloud)
        except ValueError as refused:
            assert "asked about depth images" in str(refused)
        return
    image, rays, pose = s.asked["depth"], s.asked.get("rays"), s.asked.get("camera_pose", np.eye(4))
    k = camera if rays is None else (1, 1, 0, 0)
    v, u = np.mgrid[:image.shape[0], :image.shape[1]]
    across = np.stack([(u - k[2]) / k[0], (v - k[3]) / k[1]], axis=-1) if rays is None else rays.astype("f8")
    ways = np.concatenate([across, np.ones(image.shape + (1,))], axis=-1).reshape(-1, 3)
    with np.errstate(invalid="ignore"):
        z = image.astype("f8").reshape(-1) * (0.001 if image.dtype.kind == "u" else 1)
    labels = np.where(np.arange(z.size) % 5 == 0, 1, 0).astype("u1")
    for farthest, own in ((10.0, None), (0.6, None), (10.0, labels)):
        start = np.where(s.why == "valid", z, np.where(s.why == "too_close", 0, 0.2))
        mine = (labels == 1) & (s.why == "valid") if own is not None else np.zeros(z.size, bool)
        hides = (start < farthest) & ~mine
        room = clearance.Hiding(0.2, farthest)
        r = s.ask(clearance.Unseen(room, 0.2, () if own is None else own))
        assert r.all.seen == len(s.world) and r.all.valid == hides.sum()
        assert r.own_shadow.valid == (mine & (start < farthest)).sum()
        least = []
        for spheres, part in zip(s.spheres, s.poses):
            c = moved(np.linalg.inv(pose), moved(part, spheres[:, :3]))
            t = np.clip((c @ ways.T) / (ways * ways).sum(axis=1), start, farthest)
            d = np.linalg.norm(c[:, None] - t[..., None] * ways, axis=2) - spheres[:, 3:]
            least.append(d[:, hides].min() if hides.any() else np.inf)
        assert np.allclose(r.parts["distance"], least, atol=2e-5)
        assert (r.parts["lower"] <= np.maximum(least, 0)).all()
        assert r.all.lower <= max(min(least), 0) <= r.all.upper + 2e-5
        assert (r.all.state == State.free) == (r.all.lower > 0)
        if rays is None:
            assert ((r.parts["out_of_view"] >= 0) & (r.parts["out_of_view"] <= 1)).all()
        else:
            assert np.isnan(r.parts["out_of_view"]).all()


@check("SeenAndUnseen")
def _(s):
    width = {"half_pixel": 0.2} if "rays" in s.asked else {}
    both, unseen, seen = clearance.SeenAndUnseen(**width), clearance.Unseen(**width), clearance.MinDistance()
    try:
        bare = s.ask(unseen)
    except ValueError as refused:
        with pytest.raises(ValueError, match="asked about depth images"):
            s.ask(both)
        assert "asked about depth images" in str(refused)
        return
    r = s.ask(both)
    assert repr(r.seen) == repr(s.ask(seen)) and repr(r.all) == repr(bare.all)
    assert repr(r.parts) == repr(bare.parts) and repr(r.own_shadow) == repr(bare.own_shadow)
    labels = np.where(np.arange(len(s.world)) % 5 == 0, 1, 0).astype("u1")
    if s.clouds and set(s.asked) <= {"depth", "intrinsics", "rays", "camera_pose"}:
        r, bare = (s.ask(kind(labels=labels, **width)) for kind in (clearance.SeenAndUnseen, clearance.Unseen))
        hidden = [clearance.masked(clearance.depth_image(s.asked["depth"], s.asked.get("intrinsics"),
                                                         s.asked.get("camera_pose"), rays=s.asked.get("rays")), labels)]
        assert repr(r.all) == repr(bare.all) and r.seen.dropped["masked"] == (s.valid & (labels == 1)).sum()
        assert repr(r.seen) == repr(clearance.Query(s.robot, seen)(clouds=hidden, poses=s.poses))


def clouds_of(asked):
    """What a scene gives to the query, as clouds."""
    made = [clearance.points(c) if not isinstance(c, clearance.Cloud) else c for c in asked.get("clouds", [])]
    if "depth" in asked:
        made.insert(0, clearance.depth_image(asked["depth"], asked.get("intrinsics"), asked.get("camera_pose"),
                                             rays=asked.get("rays")))
    if isinstance(asked.get("points"), clearance.Cloud):
        made.insert(0, asked["points"])
    elif "points" in asked:
        made.insert(0, clearance.points(asked["points"], asked.get("cloud_pose")))
    return made


def check_certain(s, r, radii, parts):
    """That places may be elsewhere by their radii (points,), and parts by theirs (parts,)."""
    assert repr(r.nominal) == repr(s.ask(clearance.MinDistance()))
    anywhere = (s.why == "too_close").sum()
    assert r.anywhere == anywhere
    if not s.valid.any():
        assert r.state == State.no_data and r.lower == 0 and r.upper == np.inf and r.certain.part is None
        return
    off = s.of_parts - radii - np.asarray(parts)[:, None]
    least = np.nanmin(off, axis=1)
    for pair, its, k in [*zip(r.parts, least, range(len(least))), (None, least.min(), None)]:
        if pair is None:
            c = r.certain
            pair = {"part": c.part, "cloud": c.cloud, "point": c.point, "distance": c.distance, "lower": r.lower}
            noise, of_part, sums = c.shares.noise, c.shares.joints + c.shares.delay, c.shares.sum()
        else:
            assert pair["part"] == k
            shares = pair["shares"]
            noise, of_part, sums = shares["noise"], shares["joints"] + shares["delay"], sum(shares.tolist())
        number = s.number(pair["cloud"], pair["point"])
        if not s.valid[number]:  # beyond a limit by less than its radius, so it counts, and may be the nearest
            assert pair["distance"] - sums <= its + near_enough
            continue
        assert off[pair["part"], number] == pytest.approx(its, abs=near_enough)
        assert s.of_parts[pair["part"], number] == pytest.approx(pair["distance"], abs=near_enough)
        assert of_part == parts[pair["part"]]
        assert noise <= radii[number] * (1 + 1e-5)
        assert pair["lower"] <= max(its, 0)
        assert pair["lower"] == pytest.approx(0 if anywhere else max(its, 0), abs=3 * near_enough)
        if pair["lower"] > 0:
            assert pair["distance"] - sums == pytest.approx(pair["lower"], abs=3 * near_enough)
    n = r.nominal
    most = n.distance + radii[s.number(n.cloud, n.point)] + parts[n.part]
    assert r.upper >= max(most, 0) and r.upper == pytest.approx(max(most, 0), abs=3 * near_enough)
    if abs(most) > near_enough and (anywhere or abs(least.min()) > near_enough):
        expected = State.collision if most < 0 else State.free if r.lower > 0 else State.possible
        assert r.state == expected


@check("CertainDistance")
def _(s):
    clouds, odd = clouds_of(s.asked), np.random.default_rng(5)
    r = s.ask(clearance.CertainDistance())  # nothing is uncertain
    check_certain(s, r, np.zeros(len(s.world)), np.zeros(len(s.spheres)))
    radii = [odd.uniform(0, 0.05, n).astype("f4") for n in s.sizes]
    parts = [tuple(odd.uniform(0, 0.02, 2)) for _ in s.spheres]
    seen = [clearance.uncertain(c, r) for c, r in zip(clouds, radii)]
    of_parts = [sum(part) for part in parts]
    ask = clearance.Query(s.robot, clearance.CertainDistance(parts))
    check_certain(s, ask(clouds=seen, poses=s.poses), np.concatenate(radii or [[]]), of_parts)
    # Some are uncertain, and some are not.
    mixed = [c if k % 2 else clearance.uncertain(c, max_speed=1.5, age=0.02) for k, c in enumerate(clouds)]
    by_time = np.concatenate([np.full(n, 0 if k % 2 else 0.03) for k, n in enumerate(s.sizes)] or [[]])
    r = ask(clouds=mixed, poses=s.poses, question=clearance.CertainDistance())
    if s.valid.any():
        off = s.of_parts - by_time
        assert r.lower == pytest.approx(0 if r.anywhere else max(np.nanmin(off), 0), abs=3 * near_enough)
        assert r.certain.shares.time == pytest.approx(0 if r.certain.cloud % 2 else 0.03, rel=1e-4)


def test_an_uncertain_point_is_near_wherever_it_may_be(rng):
    points = some(rng)
    s = scene_of(rng, {"points": clearance.points(points)}, points)
    radii = rng.uniform(0, 0.05, len(points)).astype("f4")
    seen, off = clearance.uncertain(clearance.points(points), radii), s.of_parts - radii
    for margin in (np.quantile(off, 0.2), off.min() - 0.01):
        r = clearance.Query(s.robot, clearance.InCollision(margin))(clouds=[seen], poses=s.poses)
        assert r.state == (State.possible if (off <= margin).any() else State.free)
        if r.point is not None:
            assert off[r.part, r.point] <= margin + near_enough
    threshold = max(np.quantile(off, 0.3), 0.01)
    r = clearance.Query(s.robot, clearance.Zones([threshold]))(clouds=[seen], poses=s.poses)
    for k, its in enumerate(off):
        assert abs(r.of(k, 0).points - (its <= threshold).sum()) <= (np.abs(its - threshold) < near_enough).sum()
        if its.min() <= threshold:
            assert r.of(k, 0).nearest == pytest.approx(its.min(), abs=near_enough)


def test_many_configurations_are_as_near_as_an_uncertain_point_may_be(rng):
    points = some(rng)
    s = scene_of(rng, {"points": clearance.points(points)}, points)
    radii = rng.uniform(0, 0.05, len(points)).astype("f4")
    moves, tables = configurations(s)
    ask = lambda q: clearance.Query(s.robot, q)(clouds=[clearance.uncertain(clearance.points(points), radii)], poses=moves)
    offs = [table - radii for table in tables]
    least, of_parts = ask(clearance.MinDistances()), ask(clearance.MinDistancesPerPart())
    for c, off in enumerate(offs):
        row, number = next(each_result([least.of[c]])), off.argmin()
        assert row.distance == pytest.approx(off.min(), abs=near_enough) and row.lower <= max(off.min(), 0)
        assert off[row.part, row.point] == pytest.approx(off.ravel()[number], abs=near_enough)
        assert of_parts.of(c)["distance"] == pytest.approx(off.min(axis=1), abs=near_enough)
    margin = np.sort([off.min() for off in offs])[:2].mean()
    states = [State(int(state)) for state in ask(clearance.InCollisions(margin)).of]
    assert states == [State.possible if off.min() <= margin else State.free for off in offs]


def test_what_an_uncertain_image_may_hide():
    image = clearance.depth_image(np.full((12, 16), 2.0, "f4"), camera)
    ask = clearance.Query(clearance.Robot.from_spheres({"ball": np.array([[0, 0, 1, 0.1]], "f4")}), clearance.Unseen())
    bare, r = (ask(clouds=[c], poses=np.eye(4)[None]).all for c in (image, clearance.uncertain(image, shift=0.03)))
    assert bare.lower - 0.031 < r.lower < bare.lower - 0.0299 and r.upper == np.inf


@pytest.mark.parametrize("noise, sigma", [
    (clearance.KinectNoise(2), lambda p, away: 2 * (0.0012 + 0.0019 * (p[:, 2] - 0.4) ** 2) * away / p[:, 2]),
    (clearance.StereoNoise(424, 0.05, 0.08), lambda p, away: 3 * 0.08 / (424 * 0.05) * p[:, 2] * away),
    (clearance.TofNoise(0.004, 0.003), lambda p, away: 3 * (0.004 + 0.003 * away**2)),
    (clearance.LidarNoise(constant=0.01, share=0.002, k=1), lambda p, away: 0.01 + 0.002 * away),
    (None, lambda p, away: 0 * away),
])
@pytest.mark.parametrize("kind", ["uint16", "float32", "rays", "points", "far points"])
def test_noise_calibration_and_age_are_radii(noise, sigma, kind, rng):
    robot, pose = random_robot(rng), rigid(rng)
    pose[:3, 3] += 5000.25 * (kind == "far points")
    robot[2][:, :3, 3] += 5000.25 * (kind == "far points")
    image = rng.uniform(0.3, 0.9, (12, 16))
    image = np.round(image * 1000).astype("u2") if kind == "uint16" else image.astype("f4")
    view, why = pixels(image, camera, 0.001 if kind == "uint16" else 1)
    if kind in ("points", "far points"):
        local = view.astype("f4") if kind == "points" else view
        sensor = (0, 0, 0)
        where = pose
        if kind == "far points":  # doubles of the world, where the sensor is
            local, sensor, where = view + pose[:3, 3], pose[:3, 3], np.eye(4)
        cloud = clearance.points(local, where, sensor=sensor)
        s = scene_of(rng, {"points": cloud}, local, where, robot=robot)
        seen = np.asarray(local, "f8") - sensor
    else:
        rays = (pixels(np.ones((12, 16), "f4"), camera, 1)[0][:, :2]).astype("f4").reshape(12, 16, 2)
        given = {"rays": rays} if kind == "rays" else {"intrinsics": camera}
        s = scene_of(rng, {"depth": image, "camera_pose": pose, **given}, view, pose, why, robot=robot)
        cloud, seen = clouds_of(s.asked)[0], view
    away = np.linalg.norm(seen, axis=1)
    made = clearance.uncertain(cloud, noise, shift=0.004, turn=0.01, max_speed=1.6, age=0.0125)
    r = clearance.Query(robot[0], clearance.CertainDistance())(clouds=[made], poses=s.poses)
    radii = sigma(seen, away) + 0.004 + 0.01 * away + 0.02
    off = s.of_parts - radii
    allowed = near_enough * (100 if kind == "far points" else 1)
    assert r.lower == pytest.approx(max(np.nanmin(off), 0), abs=allowed)
    shares = r.certain.shares
    assert shares.noise == pytest.approx(sigma(seen, away)[r.certain.point], abs=allowed)
    assert shares.calibration == pytest.approx(0.004 + 0.01 * away[r.certain.point], abs=allowed)
    assert shares.time == pytest.approx(0.02, rel=1e-4)
    assert off[r.certain.part, r.certain.point] == pytest.approx(np.nanmin(off), abs=allowed)


def test_part_radii_hold_for_joints_that_are_wrong(arm, rng):
    """No vertex of a part is farther from where joints have it than its radius says."""
    q, errors, speeds = np.array([0.3, -0.5, 1.0]), [0.01, 0.02, 0.3], [1.0, 0.5, 0.0]
    radii = arm.part_radii(q, errors, speeds=speeds, delay=0.05)
    assert radii.dtype.names == ("joints", "delay") and len(radii) == len(arm)
    assert radii[0].tolist() == (0, 0)  # the base does not move
    meshes = [arm.mesh(k)[0] for k in range(len(arm))]
    stand = [moved(p, v) for p, v in zip(arm.poses(q), meshes)]
    most = np.zeros(len(arm))
    for _ in range(300):
        wrong = rng.choice([-1, 1], 3) * (np.array(errors) + 0.05 * np.array(speeds))
        for k, pose in enumerate(arm.poses(q + wrong)):
            most[k] = max(most[k], np.linalg.norm(moved(pose, meshes[k]) - stand[k], axis=1).max())
    whole = radii["joints"] + radii["delay"]
    assert (most <= whole).all() and (whole[1:] <= 3 * most[1:]).all()
    assert (arm.part_radii(q, 0.01)["joints"] == arm.part_radii(q, [0.01] * 3)["joints"]).all()
    cloud = rng.uniform(-1, 1, (200, 3)).astype("f4") + np.float32(1)
    ask = clearance.Query(arm, clearance.CertainDistance(radii))
    for record, pair in zip(radii, ask(cloud, joints=q).parts):
        assert pair["shares"]["joints"] == record["joints"] and pair["shares"]["delay"] == record["delay"]


def test_half_a_pixel_of_a_table_of_rays():
    v, u = np.mgrid[:6, :8].astype("f4")
    rays = np.ascontiguousarray(np.stack([(u - 3) / 50, (v - 2) / 40], axis=-1))
    assert clearance.half_pixel_of(rays) == pytest.approx(np.hypot(1 / 50, 1 / 40) / 2, rel=1e-5)
    with pytest.raises(ValueError, match="rays"):
        clearance.half_pixel_of(rays[..., :1])


@pytest.mark.parametrize("place", [0.0, 1e3, 5e6, -7.3e6])
@pytest.mark.parametrize("by_cloud_pose", [False, True])
def test_far_from_the_origin_the_bracket_contains_the_distance_in_exact_arithmetic(place, by_cloud_pose, rng):
    """As in UTM coordinates: doubles of the world, or of a map's frame, with a robot that is there."""
    for _ in range(20):
        offset = np.round(rng.uniform(0.5, 1, 3) * place, 3)
        points = offset + rng.uniform(-1, 1, (60, 3))
        pose = np.eye(4)
        pose[:3, 3] = (0, 0, 0) if by_cloud_pose else offset + rng.uniform(-0.1, 0.1, 3)
        cloud_pose = np.eye(4)
        cloud_pose[:3, 3] = -offset if by_cloud_pose else (0, 0, 0)
        sphere = np.array([0.125, -0.25, 0.0625, 0.25], "f4")
        robot = clearance.Robot.from_spheres({"a": sphere[None]})
        r = clearance.Query(robot, clearance.MinDistance())(points, poses=pose[None], cloud_pose=cloud_pose)
        centre = [Fraction(float(sphere[k])) + Fraction(pose[k, 3]) - Fraction(cloud_pose[k, 3]) for k in range(3)]
        radius = Fraction(float(sphere[3]))
        squares = [sum((Fraction(float(x)) - c) ** 2 for x, c in zip(p, centre)) for p in points]
        least = min(squares)
        # lower <= sqrt(least) - radius <= upper, in whole numbers
        lower, upper = Fraction(r.lower) + radius, Fraction(r.upper) + radius
        assert least <= upper**2
        assert lower**2 <= least or r.lower == 0
        assert r.upper - r.lower < 1e-4
        assert squares[r.point] <= (upper**2)


def test_a_sensor_far_from_the_origin_filters_by_its_distance(rng):
    """nearest and farthest count from the sensor, wherever that is."""
    sensor = np.array([5e6 + 0.3, -4e6 - 0.7, 123.45])
    points = sensor + rng.normal(size=(500, 3))
    away = np.linalg.norm(points - sensor, axis=1)
    cloud = clearance.points(points, nearest=1.0, farthest=2.0, sensor=tuple(sensor))
    pose = np.eye(4)
    pose[:3, 3] = sensor
    robot = clearance.Robot.from_spheres({"a": np.array([[0, 0, 0, 0.1]], "f4")})
    r = clearance.Query(robot, clearance.MinDistance())(cloud, poses=pose[None])
    assert r.valid == ((away >= 1) & (away <= 2)).sum()


def test_joints_place_the_parts_as_poses_do(arm, rng):
    points = rng.uniform(-1, 1, (500, 3)).astype("f4")
    ask = clearance.Query(arm, clearance.MinDistance())
    base = rigid(rng)
    for q in rng.uniform(-1, 1, (10, 3)):
        by_joints = ask(points, joints=q, base=base)
        by_names = ask(points, joints=dict(zip(arm.joints, q.tolist())), base=base)
        by_poses = ask(points, poses=arm.poses(q, base))
        assert repr(by_joints) == repr(by_names) == repr(by_poses)


def test_many_configurations_by_joints_are_those_one_by_one(arm, rng):
    points = rng.uniform(-1, 1, (500, 3)).astype("f4")
    q = rng.uniform(-1, 1, (4, 6, 3))
    r = clearance.Query(arm, clearance.MinDistances())(points, joints=q)
    alone = clearance.Query(arm, clearance.MinDistance())
    assert r.of.shape == (4, 6)
    for row, one in zip(r.of.reshape(-1), q.reshape(-1, 3)):
        expected = alone(points, joints=one)
        assert (row["distance"], row["lower"], row["point"]) == (expected.distance, expected.lower, expected.point)
    assert r.trajectory(2, 6)["point"].tolist() == r.of[2]["point"].tolist()


def test_another_question_for_one_call(rng):
    s = plain(rng)
    ask = clearance.Query(s.robot, clearance.InCollision(0.0))
    least = s.least()
    assert ask(s.asked["points"], poses=s.poses, question=clearance.InCollision(least + 0.01)).state == State.collision
    assert ask(s.asked["points"], poses=s.poses, question=clearance.InCollision(least - 0.01)).state == State.free
    assert ask(s.asked["points"], poses=s.poses).counts.seen == 300
