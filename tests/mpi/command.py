# SPDX-License-Identifier: BSD-3-Clause
"""`clearance query --shard` and `clearance plan --shard` say what they say without it, on however many ranks; and what is wrong on one of them
ends all.
Arguments: mpiexec, its option for the number of ranks, the command."""
import json
import os
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import zlib

mpiexec, number, command = sys.argv[1:]
# Open MPI asks twice before it serves root, and once before it starts more ranks than there are cores.
environment = os.environ | {"CLEARANCE_CACHE": "", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
robot = """<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="tool"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""


def said_by(words):
    return subprocess.run(words, env=environment, capture_output=True, text=True, timeout=120)


def plain(*options, sub="query"):
    return said_by([command, sub, *options])


def on_ranks(*each, sub="query"):
    """Each: how many ranks, and their options."""
    words = [mpiexec]
    for k, (ranks, options) in enumerate(each):
        words += [":"] * (k > 0) + [number, str(ranks), command, sub, "--shard", *options]
    return said_by(words)


def without_times(text):
    text = re.sub(r"^seconds .*\n", "seconds\n", text, flags=re.M)
    return re.sub(r'"seconds": ?\{[^}]*\}', '"seconds": {}', text)


def png(width, height, pixels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + struct.pack(f">{width}H", *pixels[v * width:(v + 1) * width]) for v in range(height))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


with tempfile.TemporaryDirectory() as name:
    folder, dice = pathlib.Path(name), random.Random(17)

    def written(file, data):
        (folder / file).write_bytes(data if isinstance(data, bytes) else data.encode())
        return str(folder / file)

    def cloud(file, count, least):
        """Points out of a box, the nearest of which comes twice: the lower number counts."""
        points = [[dice.uniform(least, 2) * dice.choice([-1, 1]) for _ in range(3)] for _ in range(count)]
        points[count // 3] = points[count - 2] = [least / 2 + 0.1, 0, 0]
        points[1], points[count // 2] = [float("nan"), 0, 0], [0, 0, 0]
        return written(file, "".join("%r %r %r\n" % tuple(p) for p in points))

    near, far, empty, one = cloud("near.xyz", 1003, 0.3), cloud("far.xyz", 50, 1), written("empty.xyz", "# nothing\n"), written("one.xyz", "0.5 0 0\n")
    touching = written("touching.xyz", "2 0 0\n0.1 0.02 0.03\n3 0 0\n")
    inside = written("inside.xyz", "".join(f"{x} 0.01 0.02\n" for x in (3, 2, 1, 0.2, 0.05, 0.01, 2, 3)))
    image = written("image.png", png(8, 6, [dice.choice([0, 65535, 900, 1000, 3000]) for _ in range(48)]))
    lens = ["--intrinsics", "10,10,3.5,2.5", "--camera-pose", "0.1,0,-0.9,0,0,0,1"]
    base = ["--backend", "host", "--robot", written("robot.urdf", robot)]
    triangles, spheres = base + ["--model", "triangles"], base + ["--spheres", "40", "--no-cache"]
    rows = ["--configurations", written("rows.csv", "slide\n0\n0.1\n0.3\n0.7\n1\n")]
    images = triangles + ["--json", "--cloud", far, "--zero-is-missing", "--cloud", image, *lens, "--cloud", image, *lens]
    two = triangles + ["--json", "--joint", "slide=0.3", "--cloud", inside, "--cloud", near, "--zero-is-missing"]
    ply, scene = str(folder / "distances.ply"), str(folder / "scene.glb")
    asked = [
        triangles + ["--cloud", near, "--zero-is-missing"],
        triangles + ["--json", "--check", "0.1", "--cloud", far, "--zero-is-missing", "--cloud", near, "--zero-is-missing", "--cloud", empty, "--cloud", one],
        triangles + ["--json", "--check", "0.1", "--joint", "slide=0.3", "--cloud", inside, "--cloud", far],
        images,
        triangles + ["--json", "--cloud", touching, "--scene", scene],
        triangles + ["--json", "--check", "0", "--cloud", empty],
        spheres + ["--cloud", near, "--range", "0.4,1.5", "--check", "0.3"],
        spheres + ["--json", "--volume", "obb", "--cloud", inside, "--cloud", near, "--zero-is-missing"],
        images + ["--self-filter", "0.3", "--zones", "0,0.4,1", "--min-points", "2", "--nearest", "7", "--d-max", "1.3", "--gradient"],
        two + ["--self-filter", "0.01", "--zones", "0.1,0.4", "--nearest", "20", "--gradient", "--distances", ply, "--signed", "--scene", scene],
        spheres + ["--cloud", touching, "--cloud", one, "--zones", "0.1,9", "--nearest", "2", "--gradient", "--distances", ply, "--d-max", "0.7"],
        spheres + ["--cloud", empty, "--self-filter", "0.1", "--zones", "0.1", "--nearest", "2", "--gradient", "--distances", ply],
    ]
    planned = [
        triangles + rows + ["--cloud", near, "--zero-is-missing", "--cloud", far],
        triangles + rows + ["--cloud", inside, "--between", "--check", "0.05", "--csv"],
        spheres + rows + ["--cloud", far, "--zero-is-missing", "--cloud", image, *lens, "--d-max", "0.4", "--check", "0.1", "--between"],
        spheres + rows + ["--cloud", empty],
    ]
    codes, states = set(), set()

    def answers(words, say):
        """What is said, and what the files hold that were written."""
        for file in (ply, scene):
            pathlib.Path(file).unlink(missing_ok=True)
        return say(words), [pathlib.Path(file).read_bytes() if pathlib.Path(file).exists() else None for file in (ply, scene)]

    for k, (sub, options) in enumerate([("query", options) for options in asked] + [("plan", options) for options in planned]):
        expected, files = answers(options, lambda words: plain(*words, sub=sub))
        assert expected.stdout, expected.stderr
        codes.add(expected.returncode)
        if sub == "query" and "--json" in options:
            states.add(json.loads(expected.stdout)["state"])
        for ranks in (1, 2, 3) if k < 2 else (2 + k % 2,):  # to start them takes longer than all else
            found, written_by_ranks = answers(options, lambda words: on_ranks((ranks, words), sub=sub))
            assert found.returncode == expected.returncode, f"{ranks} ranks end with {found.returncode}, not {expected.returncode}: {found.stderr}"
            assert without_times(found.stdout) == without_times(expected.stdout), f"{ranks} ranks say {found.stdout}, not {expected.stdout}"
            assert written_by_ranks == files, f"{ranks} ranks write other files: {options}"
            for line in expected.stderr.splitlines():
                assert found.stderr.splitlines().count(line) == 1, f"{ranks} ranks do not say once: {line}"
    assert codes == {0, 2, 3} and states == {"free", "collision", "possible", "no_data"}, (codes, states)

    def ends(sentences, *each):
        """All ranks end, each with a sentence; one that is expected of several may come from any."""
        found = on_ranks(*each)
        assert found.returncode != 0 and found.stdout == "", f"ranks end with {found.returncode}: {found.stdout}"
        said = sorted(line for line in found.stderr.splitlines() if line.startswith("clearance: "))
        assert said == sorted("clearance: " + sentence for sentence in sentences), f"ranks say {said}"

    good, damaged = triangles + ["--cloud", near], written("damaged.xyz", "1 2 3\n4 5\n")
    why = plain(*triangles, "--cloud", damaged).stderr.removeprefix("clearance: ").rstrip("\n")
    assert why.startswith(damaged), why
    ends([why] * 2, (2, triangles + ["--cloud", damaged]))
    ends([f"rank 1 of 3: {why}", why, f"rank 1 of 3: {why}"], (1, good), (1, triangles + ["--cloud", damaged]), (1, good))
    nowhere = str(folder / "nowhere.xyz")
    ends([f"{nowhere}: there is no such file", f"rank 0 of 2: {nowhere}: there is no such file"], (1, triangles + ["--cloud", nowhere]), (1, good))
    other = written("other.urdf", robot.replace('0.2 0.2 0.2', '0.2 0.2 0.21').encode())

    def differ(what):
        return [f"rank 1 has another {what} than rank 0"] * 2

    ends(differ("--joint"), (1, good), (1, good + ["--joint", "slide=0.1"]))
    ends(["rank 1 asks about 2 clouds, rank 0 about 1"] * 2, (1, good), (1, good + ["--cloud", one]))
    ends(differ("--zones"), (1, good), (1, good + ["--zones", "0.1"]))
    ends(differ("--zones"), (1, good + ["--zones", "0.1,0.2"]), (1, good + ["--zones", "0.1"]))
    ends(differ("cloud 0"), (1, good), (1, triangles + ["--cloud", far]))
    for option in (["--range", "0.1,9"], ["--camera-pose", "0.01,0,0,0,0,0,1"], ["--base-pose", "0,0,0.01,0,0,0,1"], ["--check", "0.1"], ["--zero-is-missing"]):
        ends(differ(option[0]), (1, good), (1, good + option))
    ends(differ("robot"), (1, good), (1, [other if word == triangles[triangles.index("--robot") + 1] else word for word in good]))
    unwritable = str(folder / "no" / "folder.glb")
    why = plain(*good, "--scene", unwritable).stderr.removeprefix("clearance: ").rstrip("\n")
    assert unwritable in why, why
    ends([why], (2, good + ["--scene", unwritable]))  # rank 0 alone writes, once all have answered
