# SPDX-License-Identifier: BSD-3-Clause
"""How far is each of 300,000 points from a robot, and how far the nearest: this library, Warp and torch on one GPU.

  bench/python/gpu_peers.py [--device cuda:0] [--points 300000] [--urdf ROBOT.urdf] [--json FILE]

Two robots of the same shape: of triangles, as Warp's mesh_query_point takes them, and of spheres, as torch.cdist does.
The points lie on the device, and answers stay there; a time is that of a call until the device has finished: the median
of up to 101, after ten to warm up. All that is timed runs in turn, call after call, so that a clock that changes changes
all of them. "worst" is the largest difference to our distances on the CPU, which are exact; more than 10 um fails, or
2 cm of cdist's matrix product. Ours takes the parts' poses in every call; the others take one mesh or one list of
spheres in the world ("build": what they do when the robot moves). Every call is about the same frame, which is the best
case of what we remember from the last one. A library that is not installed is left out, and named. --device cpu
--points 3000 tries the program without a GPU.
"""

import argparse
import json
import pathlib
import platform
import sys
import time

import numpy as np
from peers import arm, kinect_like, one_mesh

import clearance

tolerance = 1e-5


class Timed:
    """A call of one library: `finish` waits for the device, and `read` gives the distances on the host."""

    def __init__(self, name, call, finish, read, build=None):
        self.name, self.call, self.finish, self.read, self.build = name, call, finish, read, build
        self.each, self.result = [], None

    def once(self):
        begin = time.perf_counter()
        self.result = self.call()
        self.finish()
        self.each.append(1000 * (time.perf_counter() - begin))


def ours(robot, poses, points, device):
    """Distances and the least one, with answers that stay on the device, and as a call."""
    made = []
    names = {"Distances()": clearance.Distances(), "MinDistance()": clearance.MinDistance()}
    on_device = device != "cpu"
    there = clearance.DeviceArray(points, device) if on_device else points
    for name, question in names.items():
        ask = clearance.Query(robot, question, device=device)
        if on_device:
            answer = ask.enqueue(there, poses=poses)
            first = "distance" if name.startswith("Distances") else "result"

            def read(r, first=first):
                its = r[first].numpy()
                return its if first == "distance" else its["distance"]
            made.append(Timed(f"clearance {name}, enqueued",
                              lambda ask=ask, out=answer: ask.enqueue(there, poses=poses, out=out), answer.wait, read))
        made.append(Timed(f"clearance {name}, to the host", lambda ask=ask: ask(there, poses=poses), lambda: None,
                          lambda r: np.atleast_1d(r.distance)))
    return made


def of_warp(vertices, triangles, points, device):
    """mesh_query_point of a mesh without a sign, and the least of all by an atomic minimum."""
    import warp
    warp.config.quiet = True
    warp.init()

    @warp.kernel
    def nearest(mesh: warp.uint64, p: warp.array(dtype=warp.vec3), d: warp.array(dtype=float)):
        i = warp.tid()
        found = warp.mesh_query_point_no_sign(mesh, p[i], 1.0e6)
        d[i] = warp.length(p[i] - warp.mesh_eval_position(mesh, found.face, found.u, found.v))

    @warp.kernel
    def least(mesh: warp.uint64, p: warp.array(dtype=warp.vec3), d: warp.array(dtype=float)):
        i = warp.tid()
        found = warp.mesh_query_point_no_sign(mesh, p[i], d[0])  # the least so far is enough
        if found.result:
            warp.atomic_min(d, 0, warp.length(p[i] - warp.mesh_eval_position(mesh, found.face, found.u, found.v)))

    def build():
        made = warp.Mesh(warp.array(vertices.astype("f4"), dtype=warp.vec3, device=device),
                         warp.array(triangles.astype("i4").ravel(), dtype=int, device=device))
        warp.synchronize_device(device)
        return made
    p = warp.array(points, dtype=warp.vec3, device=device)
    all_of, one, mesh = warp.zeros(len(points), dtype=float, device=device), warp.zeros(1, dtype=float, device=device), build()

    def call(kernel, d, start=None):
        if start is not None:
            d.fill_(start)
        warp.launch(kernel, dim=len(points), inputs=[mesh.id, p, d], device=device)
        return d

    def finish():
        warp.synchronize_device(device)
    return [Timed("Warp mesh_query_point_no_sign", lambda: call(nearest, all_of), finish, lambda d: d.numpy(), build),
            Timed("Warp the same, the least one", lambda: call(least, one, 1.0e6), finish, lambda d: d.numpy(), build)]


def of_torch(spheres, points, device):
    """torch.cdist to all centres, less the radii: the least of each row, and the least of all."""
    import torch
    rows = torch.tensor(spheres, device=device)
    p = torch.tensor(points, device=device)
    torch.backends.cuda.matmul.allow_tf32 = False

    def distances(mode):
        least = [(torch.cdist(some, rows[:, :3], compute_mode=mode) - rows[:, 3]).amin(1) for some in p.split(1 << 16)]
        return torch.cat(least)

    def build():
        torch.tensor(spheres, device=device)
        finish()

    def finish():
        if device != "cpu":
            torch.cuda.synchronize(device)
    exact, quick = "donot_use_mm_for_euclid_dist", "use_mm_for_euclid_dist"
    return [Timed("torch.cdist", lambda: distances(exact), finish, lambda d: d.cpu().numpy(), build),
            Timed("torch.cdist by a matrix product", lambda: distances(quick), finish, lambda d: d.cpu().numpy(), build),
            Timed("torch.cdist, the least one", lambda: distances(exact).amin(), finish,
                  lambda d: np.atleast_1d(d.cpu().numpy()), build)]


def compared(title, made, truth, budget):
    """Prints a row for each, and returns them; `truth` are all distances."""
    for each in made:
        for _ in range(10):
            each.once()
        each.each.clear()
    end = time.perf_counter() + budget
    while len(made[0].each) < 3 or (time.perf_counter() < end and len(made[0].each) < 101):
        for each in made:
            each.once()
    print(f"\n{title:<46} {'median ms':>10} {'least ms':>9} {'build ms':>9} {'worst m':>9}")
    rows = []
    for each in made:
        found = each.read(each.result)
        worst = float(np.abs(found - (truth if len(found) == len(truth) else truth.min())).max())
        # The matrix product loses half of the digits, which is why torch has the other mode.
        agrees = worst <= (2e-2 if "matrix" in each.name else tolerance)
        build = None
        if each.build:
            begin = time.perf_counter()
            each.build()
            build = 1000 * (time.perf_counter() - begin)
        rows.append({"robot": title, "name": each.name, "median_ms": float(np.median(each.each)), "least_ms": min(each.each),
                     "calls": len(each.each), "build_ms": build, "worst_m": worst, "agrees": agrees})
        print(f"{each.name:<46} {rows[-1]['median_ms']:10.4f} {rows[-1]['least_ms']:9.4f} "
              f"{'' if build is None else format(build, '.2f'):>9} {worst:9.1e}{'' if agrees else '  DIFFERS'}", flush=True)
    return rows


def device_says(device):
    """What the machine calls its device."""
    if device == "cpu":
        return platform.processor() or platform.machine()
    try:
        import torch
        return torch.cuda.get_device_name(device)
    except ImportError:
        import warp
        return warp.get_device(device).name


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--urdf", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=300_000)
    parser.add_argument("--seconds", type=float, default=20, help="for each robot")
    given = parser.parse_args(arguments)
    robot = clearance.Robot.from_urdf(str(given.urdf), model="triangles") if given.urdf else None
    robot, poses = (robot, robot.poses(rest=True)) if robot else arm()
    meshes = {name: robot.mesh(k) for k, name in enumerate(robot.parts)}
    filled = clearance.Robot.from_meshes(meshes, spheres=256)
    vertices, triangles = one_mesh(robot, poses)
    spheres = np.concatenate([np.column_stack([s[:, :3] @ pose[:3, :3].T + pose[:3, 3], s[:, 3]])
                              for s, pose in ((filled.spheres(k), poses[k]) for k in range(len(filled)))]).astype("f4")
    points = kinect_like(vertices.mean(axis=0))
    points = np.ascontiguousarray(points[::max(1, len(points) // given.points)][:given.points])
    try:
        name = device_says(given.device)
    except ImportError:
        name = given.device
    print(f"{name}; {len(points):,} points, {len(robot)} parts, {len(triangles):,} triangles, {len(spheres):,} spheres")
    rows = []
    for title, model, peer in (("triangles", robot, lambda: of_warp(vertices, triangles, points, given.device)),
                               ("spheres", filled, lambda: of_torch(spheres, points, given.device))):
        truth = clearance.Query(model, clearance.Distances())(points, poses=poses).distance
        made = ours(model, poses, points, given.device)
        try:
            made += peer()
        except ImportError as error:
            print(f"not installed: {error}")
        rows += compared(title, made, truth, given.seconds)
    if given.json:
        given.json.write_text(json.dumps({"device": name, "points": len(points), "rows": rows}, indent=1) + "\n")
    return 0 if all(row["agrees"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
