# SPDX-License-Identifier: BSD-3-Clause
"""Every example runs by itself, in an empty folder, and checks its own answer. The notebook runs, too."""

import pathlib
import subprocess
import sys

import pytest

folder = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"
programs = sorted(f.name for f in folder.glob("*.py") if not f.name.startswith("fleet_"))


def test_there_are_examples():
    assert {"first.py", "monitor_plan.py", "descent.py", "keep_away.py", "self_filter.py"} <= set(programs)


NEEDS = {"keep_away.py": "proxsuite"}


@pytest.fixture(autouse=True)
def needed(request):
    module = NEEDS.get(getattr(request.node, "callspec", None) and request.node.callspec.params["name"])
    if module:
        pytest.importorskip(module, reason="needs the extra: pip install clearance[test]")


@pytest.mark.parametrize("name", programs)
def test_it_finds_what_it_expects(name, tmp_path):
    done = subprocess.run([sys.executable, "-W", "error", str(folder / name)], cwd=tmp_path, capture_output=True, text=True,
                          timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout and not done.stderr
    assert not list(tmp_path.iterdir()), "it leaves files behind"


WRONG = """
import runpy, sys
import clearance

class Wrong:
    def __init__(self, of):
        self.of_query = of

    def __getattr__(self, name):
        value = getattr(self.of_query, name)
        if name in ("distance", "lower", "upper"):
            return value * 1.3 + 0.03
        if name in ("of", "all") and value.dtype.names:
            value = value.copy()
            value["lower"] += 0.03
        return value

query = clearance.Query

def wrong(robot, question):
    ask = query(robot, question)
    return lambda *given, **named: Wrong(ask(*given, **named))

gradients = clearance.joint_gradients
clearance.joint_gradients = lambda robot, joints, result: gradients(robot, joints, getattr(result, "of_query", result))
clearance.Query = wrong
runpy.run_path(sys.argv[1], run_name="__main__")
"""


@pytest.mark.parametrize("name", programs)
def test_it_notices_a_wrong_answer(name, tmp_path):
    """With distances that are a third and 3 cm too large."""
    done = subprocess.run([sys.executable, "-c", WRONG, str(folder / name)], cwd=tmp_path, capture_output=True, text=True,
                          timeout=120)
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stdout + done.stderr


@pytest.mark.parametrize("name", sorted(f.name for f in folder.glob("*.ipynb")))
def test_a_notebook_runs(name, tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="needs the extra: pip install clearance[test]")
    nbclient = pytest.importorskip("nbclient", reason="needs the extra: pip install clearance[test]")
    pytest.importorskip("ipykernel", reason="needs the extra: pip install clearance[test]")
    notebook = nbformat.read(folder / name, 4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "it is stored without outputs"
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    text = str(notebook.cells)
    assert "free: " in text and "slow down" in text or "stop" in text
