# SPDX-License-Identifier: BSD-3-Clause
"""Robots of triangles against trimesh and Open3D: meshes made here, and real robots with a real Kinect frame."""

import numpy as np
import pytest
from conftest import moved, read_pcd, rigid, shared

import clearance

trimesh = pytest.importorskip("trimesh", reason="needs the extra: pip install clearance[test]")
near_enough = 5e-6


@pytest.fixture(scope="module")
def open3d():
    return pytest.importorskip("open3d", reason="needs open3d")


def meshes():
    """Closed solids: convex and not, with one part and with two, with needles."""
    ring = trimesh.creation.torus(0.3, 0.08, major_sections=20, minor_sections=8)
    needle = trimesh.creation.cylinder(0.001, 1.2, sections=5)
    two = trimesh.util.concatenate([trimesh.creation.box((0.2, 0.3, 0.1)),
                                    trimesh.creation.icosphere(1, 0.15).apply_translation((0.5, 0, 0))])
    return {"box": trimesh.creation.box((0.4, 0.3, 0.2)), "ball": trimesh.creation.icosphere(2, 0.3),
            "capsule": trimesh.creation.capsule(0.4, 0.1, count=(8, 8)), "ring": ring, "needle": needle, "two": two}


def robot_of(named):
    return clearance.Robot.from_meshes({n: (m.vertices, m.faces) for n, m in named.items()}, model="triangles")


def exact_of(mesh, points):
    """The nearest triangle to each point in double, by a loop over all triangles."""
    triangles = np.asarray(mesh.triangles)
    least = np.empty(len(points))
    for some in np.array_split(np.arange(len(points)), max(1, len(points) * len(triangles) // 100_000)):
        pairs = np.repeat(points[some], len(triangles), axis=0)
        on = trimesh.triangles.closest_point(np.tile(triangles, (len(some), 1, 1)), pairs)
        least[some] = np.linalg.norm(on - pairs, axis=1).reshape(len(some), -1).min(axis=1)
    return least


@pytest.mark.parametrize("name", meshes())
def test_distances_are_those_of_trimesh(name, rng):
    mesh, pose = meshes()[name], rigid(rng)
    points = rng.uniform(-0.7, 0.7, (400, 3)).astype("f4")
    robot = robot_of({name: mesh})
    r = clearance.Query(robot, clearance.Distances(which=True))(points, poses=pose[None])
    in_part = moved(np.linalg.inv(pose), points)
    expected = exact_of(mesh, in_part)
    inside = mesh.contains(in_part)
    clear_of_the_surface = expected > 1e-4
    assert (r.distance[inside & clear_of_the_surface] == 0).all()
    assert np.abs(r.distance - expected)[~inside].max() < near_enough
    assert (r.primitive[inside & clear_of_the_surface] == clearance.none).all()
    # and the named triangle is so far away
    vertices, triangles = robot.mesh(0)
    for n in np.flatnonzero(~inside & clear_of_the_surface)[:50]:
        triangle = vertices[triangles[r.primitive[n]]]
        on = trimesh.triangles.closest_point(triangle[None], in_part[n:n + 1])
        assert np.linalg.norm(on - in_part[n]) == pytest.approx(r.distance[n], abs=near_enough)


@pytest.mark.parametrize("name", meshes())
def test_signed_distances_are_those_of_trimesh(name, rng):
    mesh, pose = meshes()[name], rigid(rng)
    points = np.concatenate([rng.uniform(-0.7, 0.7, (300, 3)),
                             moved(pose, mesh.sample(100, seed=3) + rng.normal(0, 0.01, (100, 3)))]).astype("f4")
    r = clearance.Query(robot_of({name: mesh}), clearance.SignedDistances(which=True))(points, poses=pose[None])
    in_part = moved(np.linalg.inv(pose), points)
    expected = exact_of(mesh, in_part)
    expected[mesh.contains(in_part)] *= -1
    assert np.abs(r.distance - expected).max() < near_enough
    assert (r.primitive < len(mesh.faces)).all()


def test_the_bracket_of_the_least_distance_contains_that_of_trimesh(rng):
    named = meshes()
    robot = robot_of(named)
    ask = clearance.Query(robot, clearance.MinDistance())
    states = set()
    for _ in range(20):
        poses = np.stack([rigid(rng, 1.0) for _ in named])
        points = (rng.uniform(-1.2, 1.2, 3) + rng.uniform(-0.2, 0.2, (30, 3))).astype("f4")
        r = ask(points, poses=poses)
        least = np.inf
        for mesh, pose in zip(named.values(), poses):
            in_part = moved(np.linalg.inv(pose), points)
            distance = exact_of(mesh, in_part)
            distance[mesh.contains(in_part)] = 0
            least = min(least, distance.min())
        assert r.lower <= least <= r.upper
        assert r.distance == pytest.approx(least, abs=near_enough)
        assert (r.state == clearance.State.free) == (least > 0) or least < near_enough
        states.add(r.state)
    assert {clearance.State.free, clearance.State.collision} <= states


def test_a_mesh_is_given_as_arrays_as_an_object_or_as_a_file(tmp_path, rng):
    mesh = meshes()["capsule"]
    file = tmp_path / "capsule.stl"
    mesh.export(file)
    points = rng.uniform(-0.7, 0.7, (200, 3)).astype("f4")
    found = []
    for given in ((mesh.vertices, mesh.faces), (mesh.vertices.tolist(), mesh.faces.tolist()), mesh, file, str(file)):
        robot = clearance.Robot.from_meshes({"part": given}, model="triangles")
        found.append(clearance.Query(robot, clearance.Distances())(points, poses=np.eye(4)[None]).distance)
    for other in found[1:]:
        assert np.abs(other - found[0]).max() < near_enough


def test_gltf_meshes_stand_as_gltf_up_says(tmp_path):
    file, urdf = tmp_path / "post.glb", tmp_path / "post.urdf"
    trimesh.creation.box((0.2, 1, 0.2)).export(file)  # 1 m along its y
    urdf.write_text('<robot name="r"><link name="a"><collision><geometry><mesh filename="post.glb"/></geometry></collision>'
                    "</link></robot>")
    above = np.array([[0, 0, 0.8]], "f4")
    for up, expected in (("y", 0.3), ("z", 0.7), (None, 0.3)):
        for robot in (clearance.Robot.from_meshes({"post": file}, model="triangles", gltf_up=up),
                      clearance.Robot.from_urdf(urdf, model="triangles", gltf_up=up)):
            r = clearance.Query(robot, clearance.MinDistance())(above, poses=np.eye(4)[None])
            assert abs(r.distance - expected) < near_enough
    with pytest.raises(ValueError, match='it is "y", "z" or None'):
        clearance.Robot.from_urdf(urdf, model="triangles", gltf_up="x")


def test_spheres_are_inside_the_mesh_and_the_gap_is_as_it_says(rng):
    """Packed spheres: between the distance to them, less the gap, and that distance lies the one to the mesh."""
    mesh = meshes()["box"]
    robot = clearance.Robot.from_meshes({"box": mesh}, model="spheres", spheres=256, cache=False)
    spheres = robot.spheres(0).astype("f8")
    assert 0 < len(spheres) <= 256
    depth = trimesh.proximity.signed_distance(mesh, spheres[:, :3])
    assert (spheres[:, 3] <= depth + 1e-6).all()
    points = rng.uniform(-0.7, 0.7, (300, 3)).astype("f4")
    ask = clearance.Query(robot, clearance.MinDistance())
    for p in points:
        r = ask(p[None], poses=np.eye(4)[None])
        exact = 0 if mesh.contains(p[None])[0] else exact_of(mesh, p[None].astype("f8"))[0]
        assert r.lower <= exact + 1e-9 and exact <= r.upper + 1e-9


def raycasting(open3d, vertices, triangles):
    made = open3d.t.geometry.RaycastingScene()
    made.add_triangles(np.ascontiguousarray(vertices, "f4"), np.ascontiguousarray(triangles, "u4"))
    return made


@pytest.mark.parametrize("name", meshes())
def test_signed_distances_are_those_of_open3d(name, open3d, rng):
    mesh = meshes()[name]
    points = rng.uniform(-0.7, 0.7, (5000, 3)).astype("f4")
    r = clearance.Query(robot_of({name: mesh}), clearance.SignedDistances())(points, poses=np.eye(4)[None])
    theirs = raycasting(open3d, mesh.vertices, mesh.faces).compute_signed_distance(points, nsamples=11).numpy()
    assert np.abs(np.abs(r.distance) - np.abs(theirs)).max() < near_enough * 4
    apart = np.abs(theirs) > 1e-4
    assert (np.sign(r.distance) == np.sign(theirs))[apart].all()


robots = ["ur5e/ur5e.urdf", "kuka_lwr_kresse/kuka.urdf", "jvrc1/jvrc1.urdf"]
frame = "clouds/kinect_seq/frame_20121214T142255.814212"


@pytest.mark.parametrize("file", robots)
def test_a_real_robot_in_a_real_frame_is_as_far_as_open3d_says(file, open3d, rng):
    robot = clearance.Robot.from_urdf(str(shared(f"robots/{file}")), model="triangles")
    points = read_pcd(shared(frame + ".pcd"))[::3]
    camera = np.eye(4)
    camera[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]  # looks along x
    camera[:3, 3] = (-1.0, 0, 0.5)
    q = np.clip(rng.uniform(-0.6, 0.6, len(robot.joints)), *robot.limits.T)
    poses = robot.poses(q)
    valid = np.isfinite(points).all(axis=1)
    world = moved(camera, points[valid])
    least = np.full(len(world), np.inf)
    for k, pose in enumerate(poses):
        vertices, triangles = robot.mesh(k)
        # in the part's own frame, as floats lose less there
        theirs = raycasting(open3d, vertices, triangles).compute_distance(
            moved(np.linalg.inv(pose), world).astype("f4")).numpy()
        least = np.minimum(least, theirs)
    r = clearance.Query(robot, clearance.Distances())(points, joints=q, cloud_pose=camera)
    assert r.counts.seen == len(points) and r.counts.valid == valid.sum()
    assert np.isnan(r.distance[~valid]).all()
    ours = r.distance[valid]
    outside = ours > 0
    assert outside.mean() > 0.5
    assert np.abs(ours - least)[outside].max() < 2e-5
    one = clearance.Query(robot, clearance.MinDistance())(points, joints=q, cloud_pose=camera)
    assert one.distance == ours.min()
    assert one.link in robot.parts
    if one.distance > 0:
        assert one.lower <= least.min() + 1e-6 and least.min() - 1e-6 <= one.upper


def test_a_frame_is_the_same_by_its_points_and_by_its_depth_image():
    """The PCD file and the depth image are the same frame; the camera is that of its description."""
    image = pytest.importorskip("PIL.Image", reason="needs pillow")
    depth = np.array(image.open(shared(frame + "_depth.png"))).astype("u2")
    points = read_pcd(shared(frame + ".pcd"))
    sphere = np.array([[0.1, 0, 0.4, 0.05]], "f4")
    robot = clearance.Robot.from_spheres({"a": sphere})
    by_depth = clearance.Query(robot, clearance.Distances())(depth=depth, intrinsics=(525, 525, 320, 240), rest=True)
    by_points = clearance.Query(robot, clearance.Distances())(points, rest=True)
    assert by_depth.counts.valid == by_points.counts.valid > 200_000
    both = np.isfinite(by_points.distance)
    assert (both == np.isfinite(by_depth.distance)).all()
    assert np.abs(by_depth.distance - by_points.distance)[both].max() < near_enough


def test_a_real_frame_against_spheres_is_as_numpy_says(rng):
    points = read_pcd(shared(frame + ".pcd")).reshape(480, 640, 3)
    spheres = np.column_stack([rng.uniform(-0.5, 0.5, (64, 3)) + (0, 0, 1), rng.uniform(0.02, 0.1, 64)]).astype("f4")
    robot = clearance.Robot.from_spheres({"a": spheres})
    r = clearance.Query(robot, clearance.Distances(which=True))(points, rest=True)
    flat = points.reshape(-1, 3).astype("f8")
    valid = np.isfinite(flat).all(axis=1)
    d = np.full(len(flat), np.inf)
    for s in spheres.astype("f8"):
        d[valid] = np.minimum(d[valid], np.linalg.norm(flat[valid] - s[:3], axis=1) - s[3])
    assert np.abs(r.distance - d)[valid].max() < near_enough
    assert np.isnan(r.distance[~valid]).all()
    near = clearance.Query(robot, clearance.NearestK(10))(points, rest=True)
    assert near.pairs["distance"] == pytest.approx(np.sort(d)[:10], abs=near_enough)
