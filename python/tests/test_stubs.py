# SPDX-License-Identifier: BSD-3-Clause
"""What type checkers read is what the module is, and users' programs pass their strictest rules."""

import ast
import enum
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import re
import site
import subprocess
import sys

import numpy as np
import pytest
from test_values import ask_all, options

import clearance

here = pathlib.Path(__file__).resolve().parent
root = here.parents[1]

PROGRAM = """
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import clearance


def least(file: str, points: NDArray[np.float32], q: list[float]) -> float:
    robot = clearance.Robot.from_urdf(file, model="triangles")
    ask = clearance.Query(robot, clearance.MinDistance())
    r = ask(points, joints=q)
    assert_type(r, clearance.MinDistanceResult)
    assert_type(r.lower, float)
    assert_type(r.point, int | None)
    assert_type(r.link, str | None)
    assert_type(r.dropped, dict[str, int])
    assert_type(r.at, tuple[float, float, float])
    if r.state == clearance.State.collision or r.lower < 0.1:
        return 0.0
    each = clearance.Query(robot, clearance.Distances(d_max=0.5, which=True))(points, q)
    assert_type(each.distance, NDArray[np.float32])
    assert_type(each.part, NDArray[np.uint32])
    assert_type(each.counts.valid, int)
    assert_type(each.certain.lower(0.1), float)
    near = clearance.Query(robot, clearance.Zones([0.1, 0.3]))(points, q)
    assert_type(near.of(0, 1).nearest, float)
    assert_type(near.innermost(), int)
    plan = clearance.Query(robot, clearance.MinDistances(0.5))(points, [q, q])
    assert_type(plan.of, NDArray[np.void])
    assert_type(clearance.InCollision(np.zeros(4)).margins, tuple[float, ...])
    assert_type(robot.poses(q), NDArray[np.float64])
    assert_type(robot.jacobian(q, "hand", r.nearest), NDArray[np.float64])
    witnesses = clearance.Query(robot, clearance.PartWitnesses(
        clearance.Query(robot, clearance.MinDistancePerPart)(points, q).parts))(points, q)
    assert_type(witnesses, NDArray[np.void])
    there = clearance.DeviceArray(points, "cuda:0")
    answer = clearance.Query(robot, clearance.Distances(), device="cuda:0").enqueue(there, q, stream=1)
    assert_type(answer, clearance.DeviceAnswer)
    assert_type(answer.certain, clearance.DistanceCertainty | None)
    assert_type(there.shape, tuple[int, ...])
    enough: NDArray[np.float32] = answer["distance"].numpy()
    assert enough.shape == there.shape[:1]
    clouds = [clearance.points(points, np.eye(4), nearest=0.3), clearance.depth_image(np.zeros((4, 4), "u2"), (1, 1, 0, 0))]
    return ask(clouds=clouds, joints={"elbow": 0.5}).upper
"""

WRONG = {
    "r.lowest": "def f(r: clearance.MinDistanceResult) -> float:\n    return r.lowest",
    "a point that may be None": "def f(r: clearance.MinDistanceResult) -> int:\n    return r.point",
    "an option that is not there": "clearance.Distances(dmax=1)",
    "a result as a question": "def f(robot: clearance.Robot, r: clearance.MinDistanceResult) -> None:\n"
                              "    clearance.Query(robot, r)",
    "a model that is none": "clearance.Robot.from_urdf('arm.urdf', model='mesh')",
    "joints that are a name": "def f(robot: clearance.Robot) -> None:\n    robot.poses(joints=robot)",
    "the result of another question": "def f(ask: 'clearance.Query[clearance.PointDistances]') -> float:\n"
                                      "    return ask([[1.0, 2.0, 3.0]]).lower",
}


def script():
    loader = importlib.machinery.SourceFileLoader("stubs", str(root / "python" / "stubs"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("stubs", loader))
    paths = list(sys.path)
    loader.exec_module(module)
    sys.path[:] = paths
    return module


def test_the_stubs_are_those_of_the_installed_module(capsys):
    pytest.importorskip("nanobind", reason="needs the extra: pip install clearance[test]")
    wrong = script().main(["--check"])
    assert wrong == 0, "python/clearance/_core.pyi is not what python/stubs writes; run it:\n" + capsys.readouterr().out[:4000]


def test_the_stubs_have_every_name():
    stubs = (root / "python" / "clearance" / "_core.pyi").read_text()
    for name in clearance._core.__dict__:
        if not name.startswith("_"):
            assert any(f"{kind}{name}" in stubs for kind in ("class ", "def ", "")), name


def test_help_is_made_of_sentences_that_stand_alone():
    stubs = ast.parse((root / "python" / "clearance" / "_core.pyi").read_text())
    said = [(place.name, line) for place in ast.walk(stubs)
            if isinstance(place, (ast.ClassDef, ast.FunctionDef)) and place.name != "__init__"
            for line in (ast.get_docstring(place) or "").splitlines()]
    assert len(said) > 200
    for name, line in said:
        assert line.endswith((".", "?")), f"{name}: {line}"
        assert not re.match(r"(Of|And|Or|Nor|Also|That|Those|and|or|nor|which|also)\b", line), f"{name}: {line}"


def is_a(value, annotation):
    """Whether a value is what a stub says, in the words that stubs have."""
    if annotation.endswith(" | None"):
        return value is None or is_a(value, annotation.removesuffix(" | None"))
    if m := re.fullmatch(r"NDArray\[numpy\.(\w+)\]", annotation):
        kind = getattr(np, m[1])
        return isinstance(value, np.ndarray) and (value.dtype.type is kind or kind is not np.void and value.dtype == kind)
    if m := re.fullmatch(r"tuple\[(.*)\]", annotation):
        return isinstance(value, tuple) and all(isinstance(v, float) for v in value) and (
            m[1] == "float, ..." or len(value) == m[1].count("float") == 3)
    if annotation == "dict[str, int]":
        return isinstance(value, dict) and all(isinstance(k, str) and isinstance(v, int) for k, v in value.items())
    return type(value).__name__ == annotation


def test_real_results_and_questions_are_of_the_types_that_stand_there(rng):
    stubs = ast.parse((root / "python" / "clearance" / "_core.pyi").read_text())
    members = {c.name: {f.name: ast.unparse(f.returns) for f in c.body if isinstance(f, ast.FunctionDef) and f.returns and any(
        ast.unparse(d) == "property" for d in f.decorator_list)} for c in stubs.body if isinstance(c, ast.ClassDef)}
    looked = set()

    def look(value):
        for name, annotation in members[type(value).__name__].items():
            its = getattr(value, name)
            assert is_a(its, annotation), f"{type(value).__name__}.{name} is said to be {annotation}, and is {its!r}"
            looked.add(type(value).__name__)
            if type(its).__name__ in members and not isinstance(its, enum.Enum):
                look(its)
    for name, result in ask_all(rng):
        look(getattr(clearance, name)(**options()[name]))
        if not isinstance(result, np.ndarray):
            look(result)
    assert {"MinDistanceResult", "PointCounts", "ZonesResult", "SelfFilterResult", "Distances", "Zones"} <= looked


def package_folder():
    """The folder on Python's path, if it is no folder for installed packages: checkers have to be told."""
    folder = pathlib.Path(clearance.__file__).parent.parent
    return None if str(folder) in site.getsitepackages() else folder


def mypy(folder, files):
    pytest.importorskip("mypy", reason="needs mypy")
    path = {"MYPYPATH": str(package_folder())} if package_folder() else {}
    command = ["mypy", "--strict", "--no-error-summary", "--cache-dir", str(folder / "cache"), *map(str, files)]
    return said_by(command, folder, path)


def pyright(folder, files):
    pytest.importorskip("basedpyright", reason="needs basedpyright")
    extra = [str(root / "examples" / "python" / "cell")] + ([str(package_folder())] if package_folder() else [])
    (folder / "pyrightconfig.json").write_text(json.dumps({"typeCheckingMode": "strict", "extraPaths": extra,
                                                           "include": [str(f) for f in files]}))
    return said_by(["basedpyright", "-p", str(folder), "--pythonpath", sys.executable], folder, {})


def said_by(command, folder, path):
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, env=os.environ | path, cwd=folder)
    return [line for line in (done.stdout + done.stderr).splitlines() if re.search(r"\berror\b", line)]


def examples():
    files = sorted((root / "examples" / "python").glob("*.py")) + sorted((root / "examples" / "python" / "cell").glob("*.py"))
    return [f for f in files if not f.name.startswith("fleet_")]


@pytest.fixture(scope="module", params=[mypy, pyright], ids=["mypy", "pyright"])
def errors(request, tmp_path_factory):
    """What a checker says of all programs, in one run."""
    folder = tmp_path_factory.mktemp("typed")
    (folder / "program.py").write_text(PROGRAM)
    for number, text in enumerate(WRONG.values()):
        (folder / f"wrong_{number}.py").write_text(f"import clearance\n\n{text}\n")
    return request.param(folder, [*sorted(folder.glob("*.py")), *examples()])


def test_a_program_with_every_kind_of_result_is_clean(errors):
    assert not [e for e in errors if "program.py" in e]


def test_mistakes_are_found(errors):
    for number, what in enumerate(WRONG):
        assert any(f"wrong_{number}.py" in e for e in errors), f"nothing is said of {what}"


def test_the_examples_are_clean(errors):
    assert examples()
    assert not [e for e in errors if not re.search(r"wrong_\d\.py|program\.py", e)]


def test_every_public_member_says_what_it_is():
    silent = []
    for name, its in vars(clearance).items():
        if name.startswith("_") or isinstance(its, (int, type(clearance))):
            continue
        if not (its.__doc__ or "").strip():
            silent.append(name)
        if not isinstance(its, type) or issubclass(its, int):
            continue
        for member, value in vars(its).items():
            said = (getattr(value, "__doc__", "") or "").strip().splitlines()
            if not member.startswith("_") and not [line for line in said if line and not re.match(r"\w+\(self.*\) -> ", line)]:
                silent.append(f"{name}.{member}")
    assert not silent, f"help() says nothing of {silent}"
