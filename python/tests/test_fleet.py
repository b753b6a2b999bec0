# SPDX-License-Identifier: BSD-3-Clause
"""Fleets: recordings played on workers give the same rows, also if a worker is killed."""

import importlib.util
import os
import pathlib
import signal
import time

import pytest

import clearance
from clearance import playing

pytest.importorskip("rosbags", reason="rosbags is not installed (extra ros)")
from test_playing import URDF, bag, drive  # noqa: E402

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"


def example(name):
    if not (EXAMPLES / f"{name}.py").exists():
        pytest.skip("the examples are not beside these tests")
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """(paths of recordings, one of them damaged; how the robot is made)."""
    folder = tmp_path_factory.mktemp("fleet")
    (folder / "pair.urdf").write_text(URDF)
    recipe = {"file": str(folder / "pair.urdf"), "spheres": 64}
    clearance.Robot.from_urdf(**recipe)  # into the cache
    paths = [str(bag(folder / f"bag{k}", drive(2 + k % 3), "sqlite3" if k % 2 else "mcap")) for k in range(6)]
    whole = next(bag(folder / "long", drive(60)).glob("*.mcap"))
    (folder / "cut.mcap").write_bytes(whole.read_bytes()[: whole.stat().st_size * 2 // 3])
    return [*paths, str(folder / "cut.mcap")], recipe


def local(paths, recipe):
    return {path: [str(row) for row in playing.rows(path, recipe)] for path in paths}  # as text, because nan is not nan


def slow_rows(path, recipe, folder):
    """As the example's task, but long enough to be killed in."""
    pathlib.Path(folder, f"{os.getpid()}-{pathlib.Path(path).name}").touch()
    time.sleep(0.4)
    return path, playing.rows(path, recipe)


def test_dask_gives_the_same_rows_though_a_worker_is_killed(fleet, tmp_path, monkeypatch):
    pytest.importorskip("dask.distributed", reason="dask is not installed")
    import dask
    from dask.distributed import Client, LocalCluster

    fleet_dask = example("fleet_dask")
    paths, recipe = fleet
    expected = local(paths, recipe)
    assert any("truncated" in rows[-1] for rows in expected.values())
    with (
        dask.config.set({"distributed.worker.daemon": False}),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        found = dict(fleet_dask.play_all(client, paths, recipe))
        assert {path: list(map(str, rows)) for path, rows in found.items()} == expected

        monkeypatch.setattr(
            fleet_dask, "rows", lambda path, recipe, task=slow_rows, to=str(tmp_path): task(path, recipe, to)
        )
        pids = client.run(os.getpid)
        victim = next(iter(pids.values()))
        results = fleet_dask.play_all(client, paths, recipe)
        found = dict([next(results)])
        os.kill(victim, signal.SIGKILL)
        found.update(results)
        assert {path: list(map(str, rows)) for path, rows in found.items()} == expected
        began = list(tmp_path.iterdir())
        assert len({each.name.split("-")[0] for each in began}) >= 2  # both worked
        assert len(began) > len(paths)  # and what the killed one had in hand was done again


def test_ray_gives_the_same_rows(fleet):
    ray = pytest.importorskip("ray", reason="ray is not installed")
    pytest.importorskip("ray.data", reason="ray[data] is not installed")
    fleet_ray = example("fleet_ray")
    paths, recipe = fleet
    tests, package = str(pathlib.Path(__file__).parent), str(pathlib.Path(clearance.__file__).parents[1])
    path = os.pathsep.join([tests, package, str(EXAMPLES)])
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": path}})
    try:
        found = fleet_ray.data_set(paths, recipe).take_all()
        whole = [str(file) for each in paths for file in pathlib.Path(each).glob("*.mcap")]
        read_by_ray = fleet_ray.data_set_in_a_bucket(whole, recipe).take_all() if has_mcap() else []
    finally:
        ray.shutdown()
    same_rows(found, paths, recipe)
    if has_mcap():
        assert len(whole) == 3
        same_rows(read_by_ray, whole, recipe)


def has_mcap():
    return importlib.util.find_spec("mcap") is not None


def same_rows(found, paths, recipe):
    expected = {path: playing.rows(path, recipe) for path in paths}
    assert len(found) == sum(map(len, expected.values()))
    for path, rows in expected.items():
        said = [each for each in found if each["path"] == path]
        assert [
            (repr(each["stamp"]), each["topic"], each["state"], repr(each["distance"]), each["note"]) for each in said
        ] == [(repr(row.stamp), row.topic, row.state, repr(row.distance), row.note) for row in rows]
