# SPDX-License-Identifier: BSD-3-Clause
"""NVIDIA Warp's mesh query on the CPU (one thread) beside ours: exact triangles, one frame, nothing known before.

    python3 bench/peers/warp_cpu.py build/bench/bench_peers_fcl      (pip install warp-lang numpy)

The bound that all points share and the seed from a sample are written by hand: Warp has neither. The program named on the
command line (bench_peers_fcl or bench_peers_embree) gives the scene, and the time of ours before and after.
"""
import json
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import warp as wp

wp.config.quiet = True
wp.init()


@wp.kernel
def alone(mesh: wp.uint64, points: wp.array(dtype=wp.vec3), best: wp.array(dtype=wp.float32)):
    p = points[wp.tid()]
    q = wp.mesh_query_point_no_sign(mesh, p, 1.0e6)
    if q.result:
        wp.atomic_min(best, 0, wp.length(p - wp.mesh_eval_position(mesh, q.face, q.u, q.v)))


@wp.kernel
def shared(mesh: wp.uint64, points: wp.array(dtype=wp.vec3), stride: int, best: wp.array(dtype=wp.float32)):
    p = points[wp.tid() * stride]
    q = wp.mesh_query_point_no_sign(mesh, p, best[0])
    if q.result:
        d = wp.length(p - wp.mesh_eval_position(mesh, q.face, q.u, q.v))
        if d < best[0]:
            wp.atomic_min(best, 0, d)


def ours(program):
    out = subprocess.run([program, "--benchmark_filter=^peers::ours_cold$", "--benchmark_format=json"], check=True,
                         capture_output=True, text=True).stdout
    row = json.loads(out)["benchmarks"][0]
    return row["cpu_time"], row["distance_mm"]


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "--write-scene", folder], check=True, stderr=subprocess.DEVNULL)
        corners = np.fromfile(folder + "/robot.f32", np.float32).reshape(-1, 3)
        points = np.fromfile(folder + "/points.f32", np.float32).reshape(-1, 3)
    # Warp answers nothing for NaN; it is spared the test, which ours makes.
    points = np.ascontiguousarray(points[np.isfinite(points).all(axis=1)])
    before = ours(program)
    with wp.ScopedDevice("cpu"):
        mesh = wp.Mesh(wp.array(corners, dtype=wp.vec3), wp.array(np.arange(len(corners)), dtype=wp.int32))
        cloud = wp.array(points, dtype=wp.vec3)
        best = wp.zeros(1, dtype=wp.float32)

        def seeded(seed_stride):
            best.fill_(1.0e6)
            if seed_stride:
                wp.launch(shared, len(points) // seed_stride, [mesh.id, cloud, seed_stride, best])
            wp.launch(shared, len(points), [mesh.id, cloud, 1, best])

        def each():
            best.fill_(1.0e6)
            wp.launch(alone, len(points), [mesh.id, cloud, best])

        print(f"{len(points)} valid points, {len(corners) // 3} triangles; CPU time of one thread")
        print(f"ours, cold                     {before[0]:8.3f} ms   distance_mm {before[1]:.4f}")
        for name, run, times in (("Warp, every point by itself", each, 3), ("Warp, shared bound", lambda: seeded(0), 100),
                                 ("Warp, seeded and shared", lambda: seeded(256), 100)):
            run()
            took = []
            for _ in range(times):
                start = time.process_time()
                run()
                took.append((time.process_time() - start) * 1e3)
            ms = statistics.median(took)
            print(f"{name:30} {ms:8.3f} ms   distance_mm {float(best.numpy()[0]) * 1e3:.4f}   {ms / before[0]:.1f} x ours")
    after = ours(program)
    print(f"ours, cold, again              {after[0]:8.3f} ms   distance_mm {after[1]:.4f}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
