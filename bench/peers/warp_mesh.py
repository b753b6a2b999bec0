# SPDX-License-Identifier: BSD-3-Clause
"""NVIDIA Warp's mesh query beside ours: the least distance of one frame to all triangles, exact.

    pip install warp-lang numpy
    python3 bench/peers/warp_mesh.py build/bench/bench_peers_fcl
    python3 bench/peers/warp_mesh.py build/bench/bench_min_distance_device --device cuda:0

The program named gives the scene (--write-scene) and the time of ours, before and after: bench_peers_fcl or
bench_peers_embree for the CPU, bench_min_distance_device for a GPU. Each row of Warp's is the best over its ways to build
the tree, leaf sizes and, on a GPU, block sizes, each the median of its replays; the tree is made beforehand. On the CPU
the time is one thread's; on a GPU, CUDA events around a replayed graph that waits behind another kernel, so that no time of
the host is counted. The bound that all points share and the seeds are written by hand: Warp has neither.
"""
import argparse
import itertools
import json
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import warp as wp

FAR = 1.0e6
TOLERANCE = 1.0e-6  # metres: some units in the last place of a float at 2 m, where the robot is
wp.config.log_level = wp.LOG_WARNING
wp.init()
wp.set_module_options({"enable_backward": False})


@wp.func
def offer(d: float, best: wp.array(dtype=float)):
    if d < best[0]:
        wp.atomic_min(best, 0, d)


@wp.kernel
def alone(mesh: wp.uint64, points: wp.array(dtype=wp.vec3), best: wp.array(dtype=float)):
    p = points[wp.tid()]
    q = wp.mesh_query_point_no_sign(mesh, p, FAR)
    if q.result:
        offer(wp.length(p - wp.mesh_eval_position(mesh, q.face, q.u, q.v)), best)


@wp.kernel
def shared(mesh: wp.uint64, points: wp.array(dtype=wp.vec3), stride: int, best: wp.array(dtype=float)):
    p = points[wp.tid() * stride]
    q = wp.mesh_query_point_no_sign(mesh, p, best[0])
    if q.result:
        offer(wp.length(p - wp.mesh_eval_position(mesh, q.face, q.u, q.v)), best)


@wp.kernel
def vertices_to_points(vertices: wp.array(dtype=wp.vec3), points: wp.array(dtype=wp.vec3), stride: int, best: wp.array(dtype=float)):
    p = points[wp.tid() * stride]
    least = float(FAR)
    for i in range(vertices.shape[0]):
        least = wp.min(least, wp.length(p - vertices[i]))
    offer(least, best)


@wp.kernel
def loosen(factor: float, best: wp.array(dtype=float)):
    best[0] = best[0] * factor


@wp.kernel
def keep_busy(rounds: int, never: wp.array(dtype=int)):
    x = rounds
    for _ in range(rounds):
        x = (x ^ (x >> 15)) * 1664525  # each round waits for the one before, and no two fold into one
    never[0] = x


def median_on_cpu(run, replays):
    took = []
    for _ in range(replays):
        start = time.process_time()
        run()
        took.append((time.process_time() - start) * 1e3)
    return statistics.median(took)


def median_on_gpu(run, replays):
    with wp.ScopedCapture() as capture:
        run()
    start, stop = wp.Event(enable_timing=True), wp.Event(enable_timing=True)
    never = wp.zeros(1, dtype=int)

    def replay():
        wp.launch(keep_busy, 1, [30000, never])
        wp.record_event(start)
        wp.capture_launch(capture.graph)
        wp.record_event(stop)
        return wp.get_event_elapsed_time(start, stop) * 1e3

    for _ in range(10):
        replay()
    return statistics.median(replay() for _ in range(replays))


class asked:
    """One tree and one block size; its rows leave the least distance in `best`."""

    def __init__(self, vertices, corners, points, constructor, leaf, block):
        self.mesh = wp.Mesh(wp.array(vertices, dtype=wp.vec3), wp.array(corners, dtype=wp.int32), bvh_constructor=constructor,
                            bvh_leaf_size=leaf)
        self.points, self.block = wp.array(points, dtype=wp.vec3), block
        self.sample = wp.array(vertices[:: len(vertices) // 128][:128], dtype=wp.vec3)
        self.best = wp.zeros(1, dtype=float)

    def launch(self, kernel, first, stride=None):
        wp.launch(kernel, len(self.points) // (stride or 1), [first, self.points] + ([stride] if stride else []) + [self.best],
                  block_dim=self.block)

    def every_point(self):
        self.best.fill_(FAR)
        self.launch(alone, self.mesh.id)

    def cold(self, seed=None, stride=1):
        self.best.fill_(FAR)
        if seed == "points":
            self.launch(shared, self.mesh.id, stride)
        elif seed == "vertices":
            self.launch(vertices_to_points, self.sample, stride)
        self.launch(shared, self.mesh.id, 1)

    def warm(self, factor):
        wp.launch(loosen, 1, [factor, self.best])
        self.launch(shared, self.mesh.id, 1)

    def rows(self):
        yield "every point by itself", "cold", self.every_point
        yield "shared bound", "cold", self.cold
        for stride in (32, 256):
            yield f"seeded by 1 point in {stride}", "cold", lambda s=stride: self.cold("points", s)
        for stride in (8, 32, 256):
            yield f"128 vertices, 1 point in {stride}", "cold", lambda s=stride: self.cold("vertices", s)
        for factor in (1.05, 1.0001):
            yield f"last frame's bound x {factor}", "warm", lambda f=factor: self.warm(f)


def indexed(corners):
    """Vertices in the order of the triangles, each once, and the triangles' corners as indices of them."""
    vertices, first, index = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return vertices[order], rank[index.reshape(-1)]


def ours(program):
    """{"cold": (time, metres), "warm": ...}, in ms of one thread or in us on a GPU, there behind other work too."""
    which = "--benchmark_filter=^(peers::ours_(cold|warm)$|triangles_(cold|warm)_queued<clearance::aabb>/)"
    out = subprocess.run([program, which, "--benchmark_format=json"], check=True, capture_output=True, text=True).stdout
    found = {}
    for row in json.loads(out)["benchmarks"]:
        if "error_message" in row:
            sys.exit(f"{row['name']}: {row['error_message']}")
        if row.get("aggregate_name", "median") == "median":
            took = row["real_time" if "manual_time" in row["name"] else "cpu_time"]
            found["cold" if "_cold" in row["name"] else "warm"] = took, row["distance_mm"] * 1e-3
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--device", default="cpu", help="cpu or cuda:0")
    parser.add_argument("--replays", type=int, default=200)
    parser.add_argument("--all", action="store_true", help="every tree and block size too")
    args = parser.parse_args()
    gpu = args.device != "cpu"
    unit = "us" if gpu else "ms"
    variants = list(itertools.product((64, 128, 256) if gpu else (1,), ("sah", "cubql", "lbvh" if gpu else "median"), (1, 2, 4)))

    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([args.program, "--write-scene", folder], check=True, stderr=subprocess.DEVNULL)
        vertices, corners = indexed(np.fromfile(folder + "/robot.f32", np.float32).reshape(-1, 3))
        points = np.fromfile(folder + "/points.f32", np.float32).reshape(-1, 3)
    # Warp answers nothing for NaN; it is spared the test, which ours makes.
    points = np.ascontiguousarray(points[np.isfinite(points).all(axis=1)])
    before = ours(args.program)
    best, wrong = {}, []
    with wp.ScopedDevice(args.device) as device:
        print(f"Warp {wp.config.version}, {device.name}; {len(points)} valid points, {len(corners) // 3} triangles")
        for block, constructor, leaf in variants:
            one = asked(vertices, corners, points, constructor, leaf, block)
            how = f"{constructor}, leaf {leaf}" + (f", block {block}" if gpu else "")
            for name, kind, run in one.rows():
                run()
                slow = name.startswith("every") and not gpu
                took = median_on_gpu(run, args.replays) if gpu else median_on_cpu(run, 3 if slow else args.replays)
                metres = float(one.best.numpy()[0])
                if abs(metres - before[kind][1]) > TOLERANCE:
                    wrong.append(f"{name} ({how}): {metres} m, ours {before[kind][1]} m")
                if args.all:
                    print(f"  {name:34} {took:10.3f} {unit}   {how}")
                if name not in best or took < best[name][0]:
                    best[name] = took, how, kind, metres
        if gpu:
            floor = wp.zeros(1, dtype=float)
            print(f"{'floor: fills one number':36} {median_on_gpu(lambda: floor.fill_(FAR), args.replays):10.3f} {unit}")
    after = ours(args.program)
    for kind in before:
        print(f"ours, {kind + ', before and after':30} {before[kind][0]:10.3f} {unit} {after[kind][0]:10.3f} {unit}"
              f"   distance_mm {before[kind][1] * 1e3:.4f}")
    for name, (took, how, kind, metres) in best.items():
        print(f"Warp, {name:30} {took:10.3f} {unit}   distance_mm {metres * 1e3:.4f}   {how}")
    for kind in before:
        took, how, name = min((took, how, name) for name, (took, how, of, _) in best.items() if of == kind)
        ratio = 2 * took / (before[kind][0] + after[kind][0])
        print(f"Warp's best over ours, {kind}: {ratio:.2f} x   ({name}; {how})")
    if wrong:
        sys.exit("Not the distance that ours found:\n" + "\n".join(wrong))


if __name__ == "__main__":
    main()
