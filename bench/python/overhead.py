# SPDX-License-Identifier: BSD-3-Clause
"""What a call from Python costs above the library's own: the same robot, the same points, one after the other.

  bench/python/overhead.py     needs g++ and the library's packages; compiles bench/python/overhead.cpp

Each number is the least of five medians of 1,000 calls, in microseconds. "above" is what Python adds. It says nothing
of large clouds, where a call takes milliseconds and Python adds the same few microseconds.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import clearance

here = pathlib.Path(__file__).resolve().parent
root = here.parents[1]


def time_of(call):
    """Microseconds per call: the least of several medians."""
    least = np.inf
    for _ in range(5):
        each = np.empty(1000)
        for i in range(len(each)):
            begin = time.perf_counter_ns()
            call()
            each[i] = time.perf_counter_ns() - begin
        least = min(least, float(np.median(each)))
    return least / 1000


def compiled(folder):
    program = folder / "overhead"
    subprocess.run(["g++", "-std=c++20", "-O3", "-DNDEBUG", "-I", str(root / "include"), "-I", "/usr/include/eigen3",
                    str(here / "overhead.cpp"), "-o", str(program), "-ltbb", "-lpthread"], check=True)
    return program


def scene(parts, points):
    """Links of 64 spheres and points two metres around them."""
    rng = np.random.default_rng(3)
    spheres = np.concatenate([rng.uniform(-0.1, 0.1, (parts, 64, 3)), rng.uniform(0.01, 0.05, (parts, 64, 1))], axis=2)
    poses = np.stack([np.eye(4)] * parts)
    poses[:, :3, 3] = rng.uniform(-0.5, 0.5, (parts, 3))
    return spheres.astype("f4"), poses, rng.uniform(-1, 1, (points, 3)).astype("f4")


def library_time(program, folder, spheres, poses, points):
    file = folder / "scene.bin"
    with open(file, "wb") as out:
        for array, count in ((spheres, spheres.size // 4), (poses, poses.size), (points, len(points))):
            out.write(np.uint64(count).tobytes() + array.tobytes())
    said = subprocess.run([str(program), str(file)], check=True, capture_output=True, text=True).stdout.split()
    return tuple(map(float, said))


def main():
    rows, worst = [], 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        program = compiled(folder)
        for parts, count in ((1, 1), (1, 100), (7, 100)):
            spheres, poses, points = scene(parts, count)
            robot = clearance.Robot.from_spheres({f"link {k}": s for k, s in enumerate(spheres)})
            least, each = clearance.Query(robot, clearance.MinDistance()), clearance.Query(robot, clearance.Distances())
            cloud = clearance.points(points)
            own, own_all, answer = library_time(program, folder, spheres, poses, points)
            if least(points, poses=poses).distance != answer:
                print("the two do not find the same", file=sys.stderr)
                return 1
            for what, call, base in (
                ("MinDistance, float32", lambda: least(points, poses=poses), own),
                ("MinDistance, a Cloud", lambda: least(cloud, poses=poses), own),
                ("MinDistance, and its lower", lambda: least(points, poses=poses).lower, own),
                ("Distances, float32", lambda: each(points, poses=poses), own_all),
                ("Distances, and its array", lambda: each(points, poses=poses).distance, own_all),
            ):
                took = time_of(call)
                rows.append({"parts": parts, "points": count, "call": what, "python": took, "library": base,
                             "above": took - base})
                worst = max(worst, took - base)
    if "--json" in sys.argv[1:]:
        print(json.dumps(rows, indent=1))
        return 0
    print(f"{'parts':>5} {'points':>6}  {'call':<28} {'Python':>8} {'C++':>8} {'above':>8}   us")
    for r in rows:
        print(f"{r['parts']:>5} {r['points']:>6}  {r['call']:<28} {r['python']:8.2f} {r['library']:8.2f} {r['above']:8.2f}")
    print(f"at most {worst:.2f} us above C++ (goal: 5)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
