# SPDX-License-Identifier: BSD-3-Clause
"""bench/record demo: what `clearance demo` prints, and a picture of it."""

import difflib
import pathlib
import re
import subprocess
import sys
import tempfile

import recorded
from readme import comparable, without_device
from recorded import root

from . import pictures

shown = root / "docs/demo-output.txt"
width, height, samples = 960, 540, 2  # pixels; and how many rays a pixel has along each side
eye, target, view_degrees = (-0.35, -1.75, 1.35), (0.60, 0.10, 0.46), 33


def draw(scene, file):
    canvas = pictures.Canvas(width * samples, height * samples, eye, target, view_degrees)
    towards_light = pictures.unit((-0.3, -0.8, 1.0))
    for mode, points, indices, paint, _, _ in pictures.glb(scene):
        red = paint[0] > 0.8 and paint[1] < 0.3  # the witness: drawn over what would hide it
        if mode == 0:
            low = min((p[2] for p in points), default=0.0)
            high = max((p[2] for p in points), default=1.0)
            for p in points:
                t = (p[2] - low) / ((high - low) or 1.0)
                canvas.dot(p, pictures.shade((0.12 + 0.3 * t * t, 0.25 + 0.5 * t, 0.55 + 0.25 * t), 0.9), 3)
            continue
        if red:
            ends = points[0], max(points, key=lambda p: pictures.dot(pictures.sub(p, points[0]), pictures.sub(p, points[0])))
            for k in range(400):
                at = tuple(a + k / 399 * (b - a) for a, b in zip(*ends))
                canvas.dot(at, pictures.shade(paint, 1.0), 5, 0.3)
            continue
        for i in range(0, len(indices), 3):
            corners = [points[j] for j in indices[i : i + 3]]
            normal = pictures.unit(pictures.cross(pictures.sub(corners[1], corners[0]), pictures.sub(corners[2], corners[0])))
            light = 0.35 + 0.6 * abs(pictures.dot(normal, towards_light))
            canvas.triangle(corners, pictures.shade(paint, light))
    file.parent.mkdir(parents=True, exist_ok=True)
    canvas.save(file, samples)


def run_demo(program, *options):
    done = subprocess.run([program, "demo", "--no-cache", *options], stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stdout}\nrecord demo: {program} demo failed (exit {done.returncode})")
    return done.stdout


def answers(text, backend):
    """The rows of a backend without its name and without times."""
    return [line.split()[1:-1] for line in text.splitlines() if line.startswith(backend) and not line.endswith(":")]


def device_rows(host):
    """Of the record of a GPU, with a line that says what they are; none if its answers are not the host's."""
    file = recorded.record("h200/demo.txt")
    text, name = file.read_text(), file.relative_to(root)
    commit = recorded.commit_of(file)
    gpu = re.search(r"Device: (.*)\.$", text, re.MULTILINE)
    rows = [line for line in text.splitlines(keepends=True) if line.startswith("device")]
    if not gpu or not rows:
        raise recorded.Mistake(f"{name} has no rows of a GPU")
    if answers(text, "device") != answers(host, "host"):
        print(f"record demo: {name} (commit {commit}) gives other answers than this program, so its rows are left out; record it again")
        return ""
    return f"device   on an {gpu[1]}, recorded at commit {commit}:\n" + "".join(rows)


def check(program):
    said, promised = run_demo(program), shown.read_text()
    wrong = list(difflib.unified_diff(comparable(promised), comparable(said), str(shown.relative_to(root)), f"{program} demo", lineterm=""))
    if "".join(line for line in promised.splitlines(keepends=True) if line.startswith("device")) != device_rows(promised):
        wrong.append("docs/demo-output.txt: the rows of the device are not those of the record of a GPU, with the host's answers")
    if (rows := answers(said, "device")) and rows != answers(promised, "host"):
        wrong.append(f"{program} demo: the device gives other answers than the host's in docs/demo-output.txt")
    for line in wrong:
        print(line)
    if wrong:
        print("record demo: run bench/record demo and scripts/quote-docs, and commit what they write")
    return 1 if wrong else 0


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--check":
        return check(arguments[1])
    if len(arguments) != 1 or arguments[0].startswith("-"):
        return None
    if arguments[0].endswith(".glb"):
        draw(pathlib.Path(arguments[0]), root / "docs/figures/demo.png")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "demo.glb"
        said = without_device(run_demo(arguments[0], "--scene", scene))
        last = max(i for i, line in enumerate(said.splitlines()) if line.startswith("host"))
        lines = said.splitlines(keepends=True)
        shown.write_text("".join(lines[: last + 1]) + device_rows(said) + "".join(lines[last + 1 :]))
        draw(scene, root / "docs/figures/demo.png")
    return 0
