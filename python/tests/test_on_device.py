# SPDX-License-Identifier: BSD-3-Clause
"""On a GPU: the host's answers to the bit, streams, arrays that stay there, threads, and what is refused.

Skipped without a GPU, unless CLEARANCE_REQUIRE_DEVICE is set. Needs NumPy and pytest alone; torch and CuPy are tried if
they are there, and streams by the driver's own interface.
"""

import ctypes
import gc
import os
import threading
import time

import numpy as np
import pytest
from conftest import ARM, random_robot, rigid
from test_errors import refused
from test_questions import questions

import clearance
from clearance import _device

GPU = "cuda:0"
none = clearance.none

try:
    _device.door()
    WHY = ""
except (ImportError, RuntimeError) as error:
    WHY = str(error)
if WHY and os.environ.get("CLEARANCE_REQUIRE_DEVICE"):
    raise RuntimeError(WHY)
if WHY:
    pytest.skip(WHY, allow_module_level=True)


# ---- what is asked -----------------------------------------------------------------------------------------------------

PLANS = ("MinDistances", "MinDistancesPerPart", "InCollisions")
WAITS = ("CertainDistance", "MinDistanceSupported", "SeenAndUnseen", "Unseen")
OPTIONS = {
    "Distances": [{}, {"d_max": 0.5, "which": True}], "SignedDistances": [{}, {"d_max": 0.5, "which": True}],
    "DistancesPerPart": [{"d_max": 0.5}], "InCollision": [{"margins": 0.0}, {"margins": 0.2}],
    "InCollisions": [{"margins": 0.15}], "MinDistances": [{}, {"d_max": 0.3}], "MinDistancesPerPart": [{"d_max": 0.5}],
    "MinDistanceSupported": [{"min_points": 4, "radius": 0.2, "most": 100}], "NearestK": [{"k": 7}, {"k": 2, "d_max": 0.3}],
    "SelfFilter": [{"padding": 0.03}], "Within": [{"radius": 0.25}], "Zones": [{"thresholds": [0.05, 0.3]}],
}
QUESTIONS = questions()


class Scene:
    """A robot of each kind, where it is, and what is seen: points with NaN among them, and an image."""

    def __init__(self, model, folder, rng):
        if model == "spheres":
            self.robot, _, self.poses = random_robot(rng, parts=5, spheres=60)
            self.plan = np.stack([[rigid(rng) for _ in range(5)] for _ in range(40)])
        else:
            (folder / "arm.urdf").write_text(ARM)
            self.robot = clearance.Robot.from_urdf(str(folder / "arm.urdf"), model="triangles")
            q = rng.uniform(-1.5, 1.5, (40, 3))
            self.plan = self.robot.poses(q)
            self.poses = self.plan[0]
        self.points = rng.normal(0, 0.6, (20_000, 3)).astype("f4")
        self.points[::97] = np.nan
        self.pose, self.camera = rigid(rng, 0.1), rigid(rng, 0.4)
        self.depth = rng.integers(200, 2500, (60, 80)).astype("u2")
        self.depth[::7, ::5] = 0

    def seen(self, there=lambda array: array):
        """Two clouds; there(array) puts an array where it is read."""
        return {"clouds": [clearance.points(there(self.points), self.pose),
                           clearance.depth_image(there(self.depth), (70, 70, 40, 30), self.camera)]}

    def where(self, name):
        return {"poses": self.plan if name in PLANS else self.poses}


@pytest.fixture(scope="module", params=["spheres", "triangles"])
def scene(request, tmp_path_factory):
    return Scene(request.param, tmp_path_factory.mktemp("robot"), np.random.default_rng(3))


def asked(scene, name):
    """The questions of a kind; none, if this robot cannot be asked."""
    if name == "SignedDistances" and scene.robot.model == "spheres" or name in ("Unseen", "SeenAndUnseen"):  # of images
        return []
    if name == "PartWitnesses":
        least = clearance.Query(scene.robot, clearance.MinDistancePerPart())
        return [clearance.PartWitnesses(least(**scene.seen(), poses=scene.poses).parts)]
    return [getattr(clearance, name)(**options) for options in OPTIONS.get(name, [{}])]


def bits(value):
    """A value as what can be compared, to the bit: arrays and floats as bytes, results by their members."""
    if isinstance(value, np.ndarray) and value.dtype.names:  # without the bytes between the fields
        return {name: bits(value[name]) for name in value.dtype.names}
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, float):
        return np.float64(value).tobytes()
    if isinstance(value, tuple):
        return tuple(map(bits, value))
    if isinstance(value, clearance.DistanceCertainty):
        return tuple(value.lower(d) for d in (0.0, 0.1, 1.0, 10.0))
    if type(value).__module__.startswith("clearance") and not hasattr(value, "value"):
        members = (m for m in dir(value) if not m.startswith("_"))
        return {m: bits(getattr(value, m)) for m in members if not callable(getattr(value, m))}
    return value


def same_as(record, value):
    """Whether an entry of a device's array is what the host has as an object."""
    if isinstance(record, np.void) and record.dtype.names:
        return all(same_as(record[name], getattr(value, name)) for name in record.dtype.names if hasattr(value, name))
    if value is None:
        return record == none
    if isinstance(value, dict):
        return list(record)[1:] == list(value.values())
    if isinstance(value, tuple):
        return np.array_equal(np.array(record, "f8"), np.array(value, "f8"), equal_nan=True)
    if hasattr(value, "value"):  # an enumeration
        return record == value.value
    return record == value or (record != record and value != value)


def assert_written(answer, name, question, expected, parts):
    """Whether the arrays of an answer are what the host says."""
    arrays = {key: answer[key].numpy() for key in answer.keys()}
    if name == "PartWitnesses":
        assert bits(arrays["witnesses"]) == bits(expected)
        return
    if hasattr(expected, "certain"):
        assert bits(answer.certain) == bits(expected.certain)
    if "pairs" in arrays:
        count = int(arrays["count"][0])
        its = np.sort(arrays["pairs"][:count], order=["part", "distance", "cloud", "point"])
        if name == "NearestK":
            listed = expected.pairs[expected.pairs["cloud"] != none]
            found = {pair.item() for pair in its}
            assert all(pair.item() in found for pair in listed) and len(found) == count
            for k in range(parts):
                mine, theirs = its[its["part"] == k], listed[listed["part"] == k]
                assert (mine["distance"] <= theirs["distance"].max(initial=-np.inf)).all()
        else:
            assert bits(its) == bits(expected.pairs)
        assert same_as(arrays["counts"][0], expected.counts)
        return
    for key, array in arrays.items():
        theirs = getattr(expected, {"result": "all", "minima": "parts"}.get(key, key), expected)
        if isinstance(theirs, np.ndarray):
            assert array.dtype == theirs.dtype and bits(array) == bits(theirs), key
        else:
            assert len(array) == 1 and same_as(array[0], theirs), key


@pytest.mark.parametrize("name", QUESTIONS)
def test_a_call_answers_with_the_bits_of_the_host(scene, name):
    for question in asked(scene, name):
        here, there = clearance.Query(scene.robot, question), clearance.Query(scene.robot, question, device=GPU)
        assert there.device == GPU
        expected = bits(here(**scene.seen(), **scene.where(name)))
        for _ in range(2):  # the second one remembers the first
            assert bits(there(**scene.seen(), **scene.where(name))) == expected
        on_device = scene.seen(lambda array: clearance.DeviceArray(array, GPU))
        assert bits(there(**on_device, **scene.where(name))) == expected


@pytest.mark.parametrize("name", [n for n in QUESTIONS if n not in WAITS])
def test_an_enqueued_answer_has_the_bits_of_the_host(scene, name):
    on_device = scene.seen(lambda array: clearance.DeviceArray(array, GPU))
    for question in asked(scene, name):
        expected = clearance.Query(scene.robot, question)(**scene.seen(), **scene.where(name))
        ask = clearance.Query(scene.robot, question, device=GPU)
        answer = ask.enqueue(**on_device, **scene.where(name))
        assert_written(answer, name, question, expected, len(scene.robot))
        # Into the same arrays, while the last one may still be on its way.
        again = ask.enqueue(**on_device, **scene.where(name), out=answer)
        assert all(again[key] is answer[key] for key in answer.keys()) and len(again) == len(answer)
        assert_written(again, name, question, expected, len(scene.robot))


@pytest.mark.parametrize("name", WAITS)
def test_what_needs_the_host_is_not_enqueued(scene, name):
    question = getattr(clearance, name)() if name.endswith("Unseen") else asked(scene, name)[0]
    ask = clearance.Query(scene.robot, question, device=GPU)
    with pytest.raises(ValueError, match=f"{name} cannot be enqueued"):
        ask.enqueue(clearance.DeviceArray(scene.points), **scene.where(name))


# ---- arrays ------------------------------------------------------------------------------------------------------------


class ByProtocol:
    """An array of another library, with one of the protocols."""

    def __init__(self, array, *names):
        self.array, self.names = array, names

    def __getattr__(self, name):
        if name in self.names:
            return getattr(self.array, name)
        raise AttributeError(name)


def by_dlpack(array):
    class Other:
        def __dlpack__(self, **options):
            return array.__dlpack__(**options)

        def __dlpack_device__(self):
            return array.__dlpack_device__()
    return Other()


def by_interface(array):
    return ByProtocol(array, "__cuda_array_interface__")


@pytest.fixture
def small(rng):
    robot, _, poses = random_robot(rng, parts=3, spheres=40)
    points = rng.uniform(-1, 1, (5000, 3)).astype("f4")
    return robot, poses, points


@pytest.mark.parametrize("via", [lambda a: a, by_dlpack, by_interface])
@pytest.mark.parametrize("kind", ["f4", "f8", "rows", "packed", "image"])
def test_arrays_on_the_device_are_read_there(small, via, kind):
    robot, poses, points = small
    points = {"f8": points.astype("f8") + 1e-9, "image": points.reshape(50, 100, 3)}.get(kind, points)
    there = clearance.DeviceArray(points, GPU)
    if kind in ("rows", "packed"):  # of records, of which x, y and z are a part
        record = np.zeros(len(points), [("intensity", "f4"), ("at", "f4", 3), ("ring", "u4" if kind == "rows" else "u2")])
        record["at"] = points
        there = clearance.DeviceArray(record, GPU)["at"]
        assert there.shape == (5000, 3)
    if kind == "packed" and via is by_dlpack:
        with pytest.raises(BufferError, match="no steps of 18 bytes between values of 4"):
            there.__dlpack__()
        return
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses)
    ask = clearance.Query(robot, clearance.Distances(), device=GPU)
    assert bits(ask(via(there), poses=poses)) == bits(expected)
    assert ask.enqueue(via(there), poses=poses)["distance"].numpy().tobytes() == expected.distance.tobytes()


@pytest.mark.parametrize("kind", ["u2", "f4", "rays"])
def test_images_on_the_device_are_read_there(small, rng, kind):
    robot, poses, _ = small
    depth = rng.uniform(0.3, 2, (48, 64)).astype("f4")
    depth = (1000 * depth).astype("u2") if kind == "u2" else depth
    rays = rng.uniform(-0.6, 0.6, (48, 64, 2)).astype("f4")

    def given(there):
        return {"depth": there(depth), **({"rays": there(rays)} if kind == "rays" else {"intrinsics": (60, 60, 32, 24)})}
    expected = clearance.Query(robot, clearance.MinDistance())(**given(lambda a: a), poses=poses)
    ask = clearance.Query(robot, clearance.MinDistance(), device=GPU)
    on_device = given(lambda a: clearance.DeviceArray(a, GPU))
    assert bits(ask(**on_device, poses=poses)) == bits(expected)
    assert same_as(ask.enqueue(**on_device, poses=poses)["result"].numpy()[0], expected)


ARRAYS = [np.arange(12, dtype="f4").reshape(3, 4), np.arange(5, dtype="u2"), np.float64(2.5), np.zeros((0, 3), "i2"),
          np.arange(24, dtype="i8").reshape(2, 3, 4)[:, ::2], np.array([True, False]),
          np.array([(1, 2.5)], [("a", "u1"), ("b", "f8")])]


@pytest.mark.parametrize("array", ARRAYS, ids=lambda a: str(np.asarray(a).dtype))
def test_a_copy_comes_back_as_it_was(array):
    there = clearance.DeviceArray(array, GPU)
    array = np.asarray(array)
    assert there.shape == array.shape and there.dtype == array.dtype and there.device == GPU
    back = there.numpy()
    assert back.dtype == array.dtype and back.shape == array.shape and back.tobytes() == array.tobytes()
    interface = there.__cuda_array_interface__
    assert interface["version"] == 3 and interface["shape"] == array.shape and interface["typestr"] == array.dtype.str
    assert not interface["data"][1] and interface["stream"] != 0
    assert there.__dlpack_device__() == (2, 0)
    if array.dtype.names is None:
        assert "dltensor" in repr(there.__dlpack__())
        assert "dltensor" in repr(there.__dlpack__(stream=-1)) and "dltensor" in repr(there.__dlpack__(stream=2))
    else:
        with pytest.raises(BufferError, match="records"):
            there.__dlpack__()


def test_fields_sampled_on_a_device_change_no_bit(scene):
    fielded = scene.robot.with_fields(40_000, device=GPU)
    assert fielded.has_fields
    for name in PLANS:
        for question in asked(scene, name):
            for device in "cpu", GPU:
                one, other = (clearance.Query(robot, question, device=device)(**scene.seen(), **scene.where(name))
                              for robot in (scene.robot, fielded))
                assert bits(one) == bits(other), (question, device)


def test_cells_made_on_a_device_change_no_bit(scene):
    celled = scene.robot.with_cells(device=GPU)
    assert celled.has_cells
    for question in clearance.Distances(which=True), clearance.Distances(d_max=0.2), clearance.Within(0.2):
        for device in "cpu", GPU:
            one, other = (clearance.Query(robot, question, device=device)(**scene.seen(), **scene.where("Distances"))
                          for robot in (scene.robot, celled))
            assert bits(one) == bits(other), (question, device)


def test_fields_are_views(small):
    robot, poses, points = small
    ask = clearance.Query(robot, clearance.MinDistance(), device=GPU)
    result = ask.enqueue(clearance.DeviceArray(points), poses=poses)["result"]
    all_of = result.numpy()
    for name in all_of.dtype.names:
        field = result[name]
        assert field.numpy().tobytes() == all_of[name].tobytes() and field.shape == all_of[name].shape, name
        assert field.dtype.names is None
    with pytest.raises(KeyError):
        result["nearest_of_all"]
    with pytest.raises(TypeError, match="no fields"):
        result["distance"]["distance"]
    with pytest.raises(TypeError, match=r"numpy\(\) copies it"):
        np.asarray(result)


@pytest.mark.parametrize("wrong, said", [
    (np.array(["a"]), "dtype <U1"), (np.array([None]), "dtype object"), (None, "dtype object"), (np.zeros(3, ">f4"), "dtype >f4"),
    (np.zeros(2, "c8"), "dtype complex64")])
def test_what_no_device_knows_is_not_copied(wrong, said):
    with pytest.raises(ValueError, match=f"array is one of numbers or records.*{said}"):
        clearance.DeviceArray(wrong, GPU)
    with pytest.raises(ValueError, match="not on the cpu"):
        clearance.DeviceArray(np.zeros(3), "cpu")


def test_an_answer_outlives_its_query(small):
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    ask = clearance.Query(robot, clearance.Distances(), device=GPU)
    distance = ask.enqueue(clearance.DeviceArray(points), poses=poses)["distance"]  # and its points
    del ask, robot, small
    gc.collect()
    clearance.DeviceArray(np.full(1 << 20, -1.0))
    assert distance.numpy().tobytes() == expected.tobytes()


# ---- streams -----------------------------------------------------------------------------------------------------------


class Driver:
    """Streams and slow work by the driver's own interface."""

    def __init__(self):
        self.lib = ctypes.CDLL("libcuda.so.1")
        self.context = ctypes.c_void_p()
        self.call("cuInit", 0)
        self.call("cuDevicePrimaryCtxRetain", ctypes.byref(self.context), 0)
        self.call("cuCtxSetCurrent", self.context)
        self.size = 256 << 20
        self.rooms = [ctypes.c_uint64(), ctypes.c_uint64()]
        for room in self.rooms:
            self.call("cuMemAlloc_v2", ctypes.byref(room), ctypes.c_size_t(self.size))

    def call(self, name, *arguments):
        code = getattr(self.lib, name)(*arguments)
        assert code == 0, f"{name} says {code}"

    def stream(self):
        made = ctypes.c_void_p()
        self.call("cuStreamCreate", ctypes.byref(made), 1)  # which waits for no default stream
        return made.value

    def is_done(self, stream):
        code = self.lib.cuStreamQuery(ctypes.c_void_p(stream))
        assert code in (0, 600), code
        return code == 0

    def wait(self, stream):
        self.call("cuStreamSynchronize", ctypes.c_void_p(stream))

    def delay(self, stream):
        """Copies that take more than a hundredth of a second on the fastest memory; fewer than a stream can hold."""
        for _ in range(600):
            self.copy(self.rooms[0].value, self.rooms[1].value, self.size, stream)

    def copy(self, to, there, size, stream):
        self.call("cuMemcpyDtoDAsync_v2", ctypes.c_uint64(to), ctypes.c_uint64(there), ctypes.c_size_t(size),
                  ctypes.c_void_p(stream))


@pytest.fixture(scope="module")
def driver():
    try:
        return Driver()
    except OSError as error:
        pytest.skip(str(error))


def address(array):
    return array.__cuda_array_interface__["data"][0]


@pytest.mark.parametrize("stream", [None, -1, 1, 2])
def test_streams_by_their_numbers(small, stream):
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.MinDistance())(points, poses=poses)
    ask, there = clearance.Query(robot, clearance.MinDistance(), device=GPU), clearance.DeviceArray(points)
    assert bits(ask(there, poses=poses, stream=stream)) == bits(expected)
    answer = ask.enqueue(there, poses=poses, stream=stream)
    answer.wait()
    assert same_as(answer["result"].numpy()[0], expected)


def test_work_before_and_after_waits_and_the_host_does_not(small, driver):
    """In one stream: slow work, then new points, the question, and a copy of its answer."""
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    ask, stream = clearance.Query(robot, clearance.Distances(), device=GPU), driver.stream()
    old, new = clearance.DeviceArray(points + 100), clearance.DeviceArray(points)
    copied = clearance.DeviceArray(np.zeros(len(points), "f4"))
    answer = ask.enqueue(old, poses=poses, stream=stream)  # prepared, and with its arrays
    answer.wait()
    for _ in range(3):
        driver.delay(stream)
        driver.copy(address(old), address(new), points.nbytes, stream)
        begin = time.perf_counter()
        ask.enqueue(old, poses=poses, out=answer, stream=stream)
        took = time.perf_counter() - begin
        driver.copy(address(copied), address(answer["distance"]), expected.nbytes, stream)
        assert not driver.is_done(stream), f"the host waited for {took:.3f} s"
        driver.wait(stream)
        assert copied.numpy().tobytes() == expected.tobytes()
        assert took < 0.05


def test_a_call_waits_for_its_stream(small, driver):
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.MinDistance())(points, poses=poses)
    ask, stream = clearance.Query(robot, clearance.MinDistance(), device=GPU), driver.stream()
    old, new = clearance.DeviceArray(points + 100), clearance.DeviceArray(points)
    driver.delay(stream)
    driver.copy(address(old), address(new), points.nbytes, stream)
    assert bits(ask(old, poses=poses, stream=stream)) == bits(expected)


def test_another_stream_waits_for_what_it_takes_by_dlpack(small, driver):
    """The producer orders the consumer's stream after what is on its way."""
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    ask, slow, quick = clearance.Query(robot, clearance.Distances(), device=GPU), driver.stream(), driver.stream()
    there, copied = clearance.DeviceArray(points), clearance.DeviceArray(np.zeros(len(points), "f4"))
    answer = ask.enqueue(there, poses=poses, stream=slow)
    driver.delay(slow)
    ask.enqueue(there, poses=poses, stream=slow, out=answer)
    answer["distance"].__dlpack__(stream=quick)
    driver.copy(address(copied), address(answer["distance"]), expected.nbytes, quick)
    assert not driver.is_done(quick)
    driver.wait(quick)
    assert copied.numpy().tobytes() == expected.tobytes()


def test_the_host_waits_for_the_last_one_that_writes_an_array(small, driver):
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    one, other = (clearance.Query(robot, clearance.Distances(), device=GPU) for _ in range(2))
    stream, there = driver.stream(), clearance.DeviceArray(points)
    answer = one.enqueue(clearance.DeviceArray(points + 1), poses=poses)
    distance = answer["distance"]
    other.enqueue(there, poses=poses)
    driver.delay(stream)
    other.enqueue(there, poses=poses, out=answer, stream=stream)
    assert not driver.is_done(stream)
    assert distance.numpy().tobytes() == expected.tobytes()


def test_python_runs_while_a_call_waits_for_the_device(small, driver):
    robot, poses, points = small
    ask, there = clearance.Query(robot, clearance.MinDistance(), device=GPU), clearance.DeviceArray(points)
    stream = driver.stream()
    ask(there, poses=poses)
    driver.delay(stream)
    work = threading.Thread(target=lambda: ask(there, poses=poses, stream=stream))
    work.start()
    turns = 0
    while work.is_alive():
        turns += 1
        time.sleep(0.001)
    assert turns > 5


def test_many_threads_ask_and_enqueue_one_query(rng):
    robot, _, poses = random_robot(rng, parts=4, spheres=200)
    clouds = [rng.uniform(-1, 1, (20_000, 3)).astype("f4") for _ in range(6)]
    there = [clearance.DeviceArray(c) for c in clouds]
    expected = [bits(clearance.Query(robot, clearance.MinDistance())(c, poses=poses)) for c in clouds]
    ask = clearance.Query(robot, clearance.MinDistance(), device=GPU)
    one = [ask(c, poses=poses) for c in there]
    wrong, start = [], threading.Barrier(6)

    def work(k):
        try:
            start.wait()
            for i in range(30):
                c = (k + i) % 6
                if bits(ask(there[c] if i % 2 else clouds[c], poses=poses)) != expected[c]:
                    wrong.append((k, i))
                answer = ask.enqueue(there[c], poses=poses, stream=2 if i % 3 else None)
                if not same_as(answer["result"].numpy()[0], one[c]):
                    wrong.append((k, i, "enqueued"))
        except Exception as error:
            wrong.append(error)
    threads = [threading.Thread(target=work, args=(k,)) for k in range(6)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert not wrong


# ---- what is refused ---------------------------------------------------------------------------------------------------


def test_enqueue_takes_what_lies_on_the_device(small):
    robot, poses, points = small
    there = clearance.DeviceArray(points)
    ask = clearance.Query(robot, clearance.MinDistance(), device=GPU)
    refused(lambda: ask.enqueue(points, poses=poses), "points lies on the cpu", 'DeviceArray(array, "cuda:0")')
    refused(lambda: ask.enqueue(depth=np.ones((4, 4), "f4"), intrinsics=(1, 1, 1, 1), poses=poses), "depth lies on the cpu")
    refused(lambda: ask.enqueue(clouds=[there, points], poses=poses), "one of the clouds lies on the cpu")
    refused(lambda: ask.enqueue(poses=poses), "nothing is given to look at")
    here = clearance.Query(robot, clearance.MinDistance())
    refused(lambda: here.enqueue(there, poses=poses), "enqueue is for a query on a CUDA device")
    refused(lambda: here(there, poses=poses), "points lies on cuda:0", "asks on the cpu")
    for call in (lambda: clearance.Query(robot, clearance.MinDistance(), device="cuda:63"),
                 lambda: clearance.DeviceArray(points, "cuda:63")):
        refused(call, "invalid device ordinal", kind=RuntimeError)
    assert same_as(ask.enqueue(there, poses=poses)["result"].numpy()[0], ask(points, poses=poses))


def test_a_second_device_answers_alike_and_does_not_read_the_first(small):
    robot, poses, points = small
    here = clearance.DeviceArray(points, GPU)
    try:
        there = clearance.DeviceArray(points, "cuda:1")
    except RuntimeError as error:
        pytest.skip(str(error))
    ask = clearance.Query(robot, clearance.MinDistance(), device="cuda:1")
    expected = clearance.Query(robot, clearance.MinDistance())(points, poses=poses)
    assert bits(ask(there, poses=poses)) == bits(expected) and there.device == "cuda:1"
    answer = ask.enqueue(there, poses=poses)
    assert same_as(answer["result"].numpy()[0], expected) and answer["result"].__dlpack_device__() == (2, 1)
    for call in (ask, ask.enqueue):
        refused(lambda: call(here, poses=poses), "points lies on cuda:0", "asks on cuda:1")
    first = clearance.Query(robot, clearance.MinDistance(), device=GPU)
    refused(lambda: first.enqueue(here, poses=poses, out=answer), 'out["result"]', "not one on cuda:1")


@pytest.mark.parametrize("question, n", [("MinDistance", 1), ("MinDistances", 1), ("InCollisions", 4)])
def test_poses_that_cannot_be_are_named(small, question, n):
    robot, poses, points = small
    there, ask = clearance.DeviceArray(points), clearance.Query(robot, getattr(clearance, question)(), device=GPU)
    plan = np.repeat(poses[None], n, 0)
    for value in (np.nan, 7.0):
        wrong = plan.copy()
        wrong[-1, 1, 0, 0] = value
        wrong = wrong[0] if question == "MinDistance" else wrong
        refused(lambda: ask(points, poses=wrong), "rigid", "1")
        refused(lambda: ask.enqueue(there, poses=wrong), "rigid", "1")
    refused(lambda: ask.enqueue(there, poses=poses[:2]), "3 parts" if question != "MinDistance" else "3")
    assert ask.enqueue(there, poses=plan if n > 1 else poses).keys()


def test_arrays_to_write_are_checked(small):
    robot, poses, points = small
    there, n = clearance.DeviceArray(points), len(points)
    ask = clearance.Query(robot, clearance.Distances(), device=GPU)
    wrong_ones = [(clearance.DeviceArray(np.zeros(shape, kind)), said) for shape, kind, said in (
        (n - 1, "f4", "(4999,)"), (n, "f8", "float64"), (n, "u4", "uint32"), ((n, 2), "f4", "(5000, 2)"))]
    for wrong, said in (*wrong_ones, (np.zeros(n, "f4"), "one on the cpu"), ("text", "str"), (None, "None")):
        refused(lambda: ask.enqueue(there, poses=poses, out={"distance": wrong}),
                'out["distance"] is an array of 5000 values', said)
    for name in ("distances", "part"):  # the second one only if `which` is set
        refused(lambda: ask.enqueue(there, poses=poses, out={name: there}), f"out['{name}']", "it writes: distance, counts")
    refused(lambda: ask.enqueue(there, poses=poses, out=there), "out is a mapping")
    refused(lambda: ask.enqueue(there, poses=poses, capacity=5), "capacity is of pairs, and Distances lists none")
    gaps = clearance.DeviceArray(np.zeros(n, [("a", "f4"), ("b", "f4")]))["a"]
    refused(lambda: ask.enqueue(there, poses=poses, out={"distance": gaps}), "gaps")
    lying = ByProtocol(there, "__cuda_array_interface__")
    lying.__dict__["__cuda_array_interface__"] = {**there.__cuda_array_interface__, "shape": (n,), "strides": None,
                                                  "data": (np.zeros(n, "f4").ctypes.data, False)}
    refused(lambda: ask.enqueue(there, poses=poses, out={"distance": lying}), "memory that is not its own")
    fixed = ByProtocol(there, "__cuda_array_interface__")
    fixed.__dict__["__cuda_array_interface__"] = {**there.__cuda_array_interface__, "data": (address(there), True)}
    refused(lambda: ask.enqueue(there, poses=poses, out={"distance": fixed}), "read-only")


def test_pairs_beyond_the_capacity_are_counted(small):
    robot, poses, points = small
    there, expected = clearance.DeviceArray(points), clearance.Query(robot, clearance.Within(0.3))(points, poses=poses).pairs
    ask = clearance.Query(robot, clearance.Within(0.3), device=GPU)
    assert len(expected) > 20
    few = ask.enqueue(there, poses=poses, capacity=10)
    assert few["pairs"].shape == (10,) and few["count"].numpy()[0] == len(expected)
    known = {pair.item() for pair in expected}
    assert all(pair.item() in known for pair in few["pairs"].numpy())
    room = clearance.DeviceArray(np.zeros(len(expected) + 5, expected.dtype))
    its = ask.enqueue(there, poses=poses, out={"pairs": room})["pairs"].numpy()[:len(expected)]
    assert np.sort(its, order=["part", "distance", "point"]).tolist() == expected.tolist()
    for wrong in (-1, 1.5, "many"):
        refused(lambda: ask.enqueue(there, poses=poses, capacity=wrong), "capacity is a whole number")
    refused(lambda: ask.enqueue(there, poses=poses, capacity=10**18), "no device has room for 1000000000000000000 values")
    none_fits = ask.enqueue(there, poses=poses, capacity=0)
    assert none_fits["pairs"].numpy().shape == (0,) and none_fits["count"].numpy()[0] == len(expected)


def test_minima_on_the_device_lead_to_witnesses(small):
    robot, poses, points = small
    there = clearance.DeviceArray(points)
    least = clearance.Query(robot, clearance.MinDistancePerPart(), device=GPU).enqueue(there, poses=poses)
    ask = clearance.Query(robot, clearance.PartWitnesses(np.zeros(0, least["minima"].dtype)), device=GPU)
    found = ask.enqueue(there, poses=poses, out={"minima": least["minima"]})["witnesses"].numpy()
    expected = clearance.Query(robot, clearance.PartWitnesses(least["minima"].numpy()))(points, poses=poses)
    assert bits(found) == bits(expected)
    refused(lambda: ask.enqueue(there, poses=poses), "minima of PartWitnesses has 0 values, and there are 3 parts")


@pytest.mark.parametrize("wrong, said, kind", [
    ("0", "stream is an integer", TypeError), (1.5, "stream is an integer", TypeError), (-2, "stream is -2", ValueError),
    (object(), "stream is an integer", TypeError)])
def test_what_is_no_stream(small, wrong, said, kind):
    robot, poses, points = small
    there, ask = clearance.DeviceArray(points), clearance.Query(robot, clearance.MinDistance(), device=GPU)
    refused(lambda: ask(there, poses=poses, stream=wrong), said, kind=kind)
    refused(lambda: ask.enqueue(there, poses=poses, stream=wrong), said, kind=kind)


# ---- other libraries ---------------------------------------------------------------------------------------------------


def test_torch_reads_and_writes_the_same_arrays(small):
    torch = pytest.importorskip("torch")
    if not torch.cuda.is_available():
        pytest.skip("torch has no CUDA")
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    ask = clearance.Query(robot, clearance.Distances(), device=GPU)
    stream = torch.cuda.Stream()
    with torch.cuda.stream(stream):
        there, out = torch.tensor(points, device=GPU), torch.zeros(len(points), device=GPU)
        answer = ask.enqueue(there, poses=poses, out={"distance": out}, stream=stream)
        assert answer["distance"] is out
        total = (out * 2).cpu().numpy()
    assert (total == expected * 2).all()
    answer = ask.enqueue(there, poses=poses, stream=torch.cuda.current_stream())
    for made in (torch.from_dlpack(answer["distance"]), torch.as_tensor(answer["distance"], device=GPU)):
        assert made.device.type == "cuda" and made.data_ptr() == address(answer["distance"])
        assert (made.cpu().numpy() == expected).all()
    least = clearance.Query(robot, clearance.MinDistance(), device=GPU).enqueue(there, poses=poses)
    assert float(torch.from_dlpack(least["result"]["distance"])[0]) == expected.min()


def test_cupy_reads_and_writes_the_same_arrays(small):
    cupy = pytest.importorskip("cupy")
    robot, poses, points = small
    expected = clearance.Query(robot, clearance.Distances())(points, poses=poses).distance
    ask, stream = clearance.Query(robot, clearance.Distances(), device=GPU), cupy.cuda.Stream(non_blocking=True)
    with stream:
        there, out = cupy.asarray(points), cupy.zeros(len(points), "f4")
        ask.enqueue(there, poses=poses, out={"distance": out}, stream=stream)
        assert (cupy.asnumpy(out) == expected).all()
    answer = ask.enqueue(there, poses=poses)
    for made in (cupy.from_dlpack(answer["distance"]), cupy.asarray(answer["distance"])):
        assert (cupy.asnumpy(made) == expected).all()


def test_what_is_certain_is_the_same_on_a_device(scene):
    off, size = {"shift": 0.004, "turn": 0.002, "max_speed": 1.6, "age": 0.01}, len(scene.points)
    radii = np.random.default_rng(8).uniform(0, 0.04, size).astype("f4")
    question = clearance.CertainDistance([(0.01 * k, 0.002) for k in range(len(scene.robot))])
    there, noise = clearance.DeviceArray(radii, GPU), clearance.StereoNoise(424, 0.05, 0.08)
    expected = None
    for put, its in ((np.asarray, radii), (np.asarray, there), (lambda a: clearance.DeviceArray(a, GPU), there)):
        points, image = scene.seen(put)["clouds"]
        seen = [clearance.uncertain(points, its, **off), clearance.uncertain(image, noise, **off), points]
        ask = clearance.Query(scene.robot, question, device="cpu" if expected is None else GPU)
        found = ask(clouds=seen, poses=scene.poses)
        expected = expected or bits(found)
        assert bits(found) == expected
    clouds = [clearance.uncertain(clearance.points(scene.points), its, **off) for its in (radii, there)]
    many = np.stack([scene.poses] * 2)
    for question in (clearance.MinDistances(radii=[0.01]), clearance.MinDistancesPerPart(0.5),
                     clearance.InCollisions(0.05)):
        here, on_gpu = (clearance.Query(scene.robot, question, device=d)(clouds=[c], poses=many)
                        for d, c in zip(("cpu", GPU), clouds))
        assert bits(here) == bits(on_gpu)
    ask = clearance.Query(scene.robot, clearance.CertainDistance(), device=GPU)
    with pytest.raises(ValueError, match="radii of one of the clouds lie on cpu"):
        ask(clouds=[clearance.uncertain(clearance.points(scene.points), radii)], poses=scene.poses)


def test_what_is_unseen_is_the_same_on_a_device(scene):
    labels = (np.arange(scene.depth.size) % 7 == 0).astype("u1")
    for question in (clearance.Unseen(), clearance.Unseen(clearance.Hiding(0.3, 2.0), labels=labels)):
        there = clearance.DeviceArray(scene.depth, GPU)
        seen = [clearance.depth_image(d, (70, 70, 40, 30), scene.camera) for d in (scene.depth, there)]
        expected = clearance.Query(scene.robot, question)(clouds=seen[:1], poses=scene.poses)
        for image in seen:
            found = clearance.Query(scene.robot, question, device=GPU)(clouds=[image], poses=scene.poses)
            assert bits(found) == bits(expected)
