# SPDX-License-Identifier: BSD-3-Clause
"""How far is each of 300,000 points from a robot of triangles: this library and others, on this CPU, in one run.

  bench/python/peers.py [ROBOT.urdf]     without a file: an arm of seven capsules, 10,000 triangles

Each is given the same points and the same triangles, and finds every point's distance. Ours takes the robot's parts and
their poses in every call; the others take one mesh of all parts, which they build again when the robot moves ("build").
"worst" is the largest difference to a loop over all triangles in double, of 500 points. What takes too long is asked
about fewer points, and its time is scaled up, which is said. A library that is not installed is left out, and named.
"""

import os
import platform
import sys
import time

import numpy as np

import clearance

count = 300_000


def arm():
    """Seven capsules in a chain, as a robot and as one mesh."""
    import trimesh
    parts, poses = {}, []
    for k in range(7):
        parts[f"link {k}"] = trimesh.creation.capsule(0.25, 0.06, count=(27, 27))
        turn = trimesh.transformations.rotation_matrix(0.4 * (-1) ** k, (0, 1, 0))
        poses.append((poses[-1] @ trimesh.transformations.translation_matrix((0, 0, 0.3)) if k else np.eye(4)) @ turn)
    robot = clearance.Robot.from_meshes({n: (m.vertices, m.faces) for n, m in parts.items()}, model="triangles")
    return robot, np.stack(poses)


def one_mesh(robot, poses):
    vertices, triangles, n = [], [], 0
    for k, pose in enumerate(poses):
        v, t = robot.mesh(k)
        vertices.append(v @ pose[:3, :3].T + pose[:3, 3])
        triangles.append(t.astype("i8") + n)
        n += len(v)
    return np.concatenate(vertices), np.concatenate(triangles)


def kinect_like(near):
    """A depth camera's view of a room with a table and boxes, of which none touches the robot; metres, world."""
    rng = np.random.default_rng(5)
    v, u = np.mgrid[:480, :640]
    rays = np.stack([(u - 319.5) / 525, (v - 239.5) / 525, np.ones((480, 640))], axis=-1).reshape(-1, 3)
    depth = np.minimum(3.0, np.where(rays[:, 1] > 0.05, 0.9 / np.maximum(rays[:, 1], 1e-9), np.inf))
    for _ in range(12):
        x, y, z, half = rng.uniform(-1, 1), rng.uniform(-0.5, 0.5), rng.uniform(1.2, 2.5), rng.uniform(0.05, 0.25)
        hit = (np.abs(rays[:, 0] * z - x) < half) & (np.abs(rays[:, 1] * z - y) < half)
        depth[hit] = np.minimum(depth[hit], z)
    depth += rng.normal(0, 0.002, depth.shape) * depth**2
    points = rays * depth[:, None]
    world = points[:, [2, 0, 1]] * (1, -1, -1) + (-0.6 + near[0] - 1.2, near[1], near[2])
    return np.ascontiguousarray(world[:count], "f4")


def exact(vertices, triangles, points):
    import trimesh
    corners, least = vertices[triangles], []
    for p in points:
        on = trimesh.triangles.closest_point(corners, np.broadcast_to(p, (len(corners), 3)))
        least.append(np.linalg.norm(on - p, axis=1).min())
    return np.array(least)


peers = {}


def peer(name, at_most=None):
    """`make(vertices, triangles, points)` builds, and gives a call that finds all distances. At most so many points."""
    return lambda make: peers.__setitem__(name, (make, at_most)) or make


@peer("Open3D RaycastingScene.compute_distance")
def _(vertices, triangles, points):
    import open3d
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(vertices.astype("f4"), triangles.astype("u4"))
    scene.compute_distance(points[:1])  # builds the tree
    return lambda: scene.compute_distance(points).numpy()


@peer("Warp mesh_query_point_no_sign, cpu")
def _(vertices, triangles, points):
    import warp
    warp.config.quiet = True
    warp.init()

    @warp.kernel
    def nearest(mesh: warp.uint64, p: warp.array(dtype=warp.vec3), d: warp.array(dtype=float)):
        i = warp.tid()
        found = warp.mesh_query_point_no_sign(mesh, p[i], 1.0e6)
        d[i] = warp.length(p[i] - warp.mesh_eval_position(mesh, found.face, found.u, found.v))
    mesh = warp.Mesh(warp.array(vertices.astype("f4"), dtype=warp.vec3, device="cpu"),
                     warp.array(triangles.astype("i4").ravel(), dtype=int, device="cpu"))
    d = warp.zeros(len(points), dtype=float, device="cpu")

    def call(mesh=mesh):
        p = warp.array(points, dtype=warp.vec3, device="cpu", copy=False)
        warp.launch(nearest, dim=len(points), inputs=[mesh.id, p, d], device="cpu")
        return d.numpy()
    return call


@peer("fcpw findClosestPoints")
def _(vertices, triangles, points):
    import fcpw
    scene = fcpw.scene_3D()
    scene.set_object_count(1)
    scene.set_object_vertices(vertices.astype("f4"), 0)
    scene.set_object_triangles(triangles.astype("i4"), 0)
    scene.build(fcpw.aggregate_type.bvh_surface_area, True, True, False)

    def call():
        found = fcpw.interaction_3D_list()
        scene.find_closest_points(points, np.full(len(points), np.inf, "f4"), found)
        return np.array([i.d for i in found])
    return call


@peer("coal distance(BVHModelOBBRSS, Sphere), a call per point", 3000)
def _(vertices, triangles, points):
    import coal
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), len(vertices))
    mesh.addVertices(vertices)
    mesh.addTriangles(triangles.astype("i8"))
    mesh.endModel()
    point, here, request = coal.Sphere(1e-9), coal.Transform3s(), coal.DistanceRequest()

    def call():
        d = np.empty(len(points))
        for k, p in enumerate(points.astype("f8")):
            place = coal.Transform3s()
            place.setTranslation(p)
            result = coal.DistanceResult()
            d[k] = coal.distance(mesh, here, point, place, request, result)
        return d + 1e-9
    return call


@peer("trimesh.proximity.closest_point", 1000)
def _(vertices, triangles, points):
    import trimesh
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.triangles_tree
    return lambda: trimesh.proximity.closest_point(mesh, points)[1]


def timed(call, budget=6.0):
    """The median of several calls in milliseconds, and the last result."""
    result, each, end = call(), [], time.perf_counter() + budget
    while len(each) < 3 or (time.perf_counter() < end and len(each) < 21):
        begin = time.perf_counter()
        result = call()
        each.append(time.perf_counter() - begin)
    return 1000 * float(np.median(each)), result


def main(arguments):
    if arguments:
        robot = clearance.Robot.from_urdf(arguments[0], model="triangles")
        poses = robot.poses(rest=True)
    else:
        robot, poses = arm()
    vertices, triangles = one_mesh(robot, poses)
    points = kinect_like(vertices.mean(axis=0))
    tried = np.random.default_rng(1).choice(len(points), 500, replace=False)
    truth = exact(vertices, triangles, points[tried].astype("f8"))
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; "
          f"{len(points):,} points, {len(robot)} parts, {len(triangles):,} triangles")
    print(f"{'':<58} {'ms':>9} {'build ms':>9} {'worst m':>9}")

    def row(name, took, build, worst, said=""):
        print(f"{name:<58} {took:9.1f} {build:9.1f} {worst:9.1e}  {said}", flush=True)

    ask = clearance.Query(robot, clearance.Distances())
    took, r = timed(lambda: ask(points, poses=poses).distance)
    outside = truth > 0
    row("clearance Distances()", took, 0, np.abs(r[tried] - truth)[outside & (r[tried] > 0)].max())
    near = clearance.Query(robot, clearance.Distances(d_max=0.5))
    took, cut = timed(lambda: near(points, poses=poses).distance)
    row("clearance Distances(d_max=0.5)", took, 0, np.abs(cut - r)[np.isfinite(cut)].max(), "farther ones are infinite")
    least = clearance.Query(robot, clearance.MinDistance())
    took, one = timed(lambda: least(points, poses=poses))
    row("clearance MinDistance()", took, 0, abs(one.distance - r.min()), "the least alone, with its bracket")
    for name, (make, at_most) in peers.items():
        others = points[::len(points) // (at_most or count)][:(at_most or count) - len(tried)]
        some = np.concatenate([points[tried], others]) if at_most else points
        try:
            make(vertices, triangles, some)  # and imports what it needs
            begin = time.perf_counter()
            call = make(vertices, triangles, some)
            build = 1000 * (time.perf_counter() - begin)
            took, found = timed(call)
        except ImportError as error:
            print(f"{name:<58} not installed: {error}")
            continue
        its = found[tried] if at_most is None else found[:len(tried)]
        said = f"of {len(some):,} points, scaled" if at_most else ""
        row(name, took * len(points) / len(some), build, np.abs(its - truth).max(), said)
    print("VAMP's CAPT answers yes or no about spheres: bench/peers/capt.cpp compares it in C++")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
