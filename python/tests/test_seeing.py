# SPDX-License-Identifier: BSD-3-Clause
"""What is seen: the scene, the picture, the recording for rerun, the commands view and report."""

import json
import math
import pathlib
import re
import subprocess
import sys
import zlib

import numpy as np
import pytest

import clearance
from clearance.__main__ import main
from clearance.seeing import colours, demo, files, history, letters, pictures, raster, show
from clearance.seeing import picture as picture_of
from clearance.seeing import scene as scene_of

DATA = pathlib.Path(__file__).resolve().parents[2].parent / "shared/data"


def ball(radius=0.2, at=(0, 0, 0)):
    """A robot of one part of one sphere."""
    return clearance.Robot.from_spheres({"ball": np.array([[*at, radius]], np.float32)})


def cube(half=0.1):
    corners = half * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    return clearance.Robot.from_meshes({"cube": (corners, np.array(faces))}, model="triangles")


def decode(data):
    """The pixels of one of our PNG files, by the format's rules."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        assert zlib.crc32(kind + body) == int.from_bytes(data[at + 8 + length : at + 12 + length], "big")
        if kind == b"IHDR":
            size = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
            assert body[8:] == b"\x08\x02\0\0\0"
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    columns, rows = size
    lines = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(rows, 1 + 3 * columns)
    out = np.zeros((rows, columns, 3), np.uint8)
    for y, line in enumerate(lines):
        row = line[1:].reshape(columns, 3)
        if line[0] == 0:
            out[y] = row
        elif line[0] == 1:
            out[y] = np.cumsum(row, axis=0, dtype=np.uint8)
        else:
            assert line[0] == 2
            out[y] = row + (out[y - 1] if y else 0)
    return out


def close_to(pixel, colour, within=3):
    return np.abs(pixel.astype(int) - np.asarray(colour)).max() <= within


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return clearance.Robot.from_urdf(demo.write_urdf(tmp_path_factory.mktemp("arm")), model="triangles", cache=False)


@pytest.fixture(scope="module")
def before_the_arm():
    return {"depth": demo.depth_image(), "intrinsics": demo.CAMERA, "camera_pose": demo.camera_pose()}


# The scene.


def test_a_scene_says_what_the_library_answers(arm, before_the_arm):
    made = scene_of(arm, joints=demo.JOINTS, margin=0.05, most=2000, **before_the_arm)
    asked = clearance.Query(arm, clearance.MinDistance())(joints=demo.JOINTS, **before_the_arm)
    assert made.result.distance == asked.distance and made.result.point == asked.point
    assert made.label == f"{asked.distance:.3f} m" and asked.link in made.title and f"{asked.point:,}" in made.title
    assert np.allclose(made.segment, [asked.nearest, asked.at])
    assert np.linalg.norm(made.segment[1] - made.segment[0]) == pytest.approx(asked.distance, abs=1e-4)
    assert [part.name for part in made.parts] == list(arm.parts)
    assert [part.name for part in made.parts if part.colour == colours.NEAREST_PART] == [asked.link]
    assert "; above the margin of 0.050 m" in made.title
    assert made.all_points == asked.valid and len(made.points) == math.ceil(made.all_points / made.step) <= 2000


def test_the_drawn_points_of_a_depth_image_are_those_that_the_library_sees(arm, before_the_arm):
    made = scene_of(arm, joints=demo.JOINTS, most=0, colour="none", **before_the_arm)
    from_points = clearance.Query(arm, clearance.MinDistance())(made.points, joints=demo.JOINTS)
    assert from_points.valid == made.result.valid and from_points.distance == pytest.approx(
        made.result.distance, abs=1e-6
    )
    assert made.step == 1 and np.abs(made.points - np.asarray(made.result.at)).sum(axis=1).min() < 1e-5


def test_points_have_the_colours_of_their_distance_and_of_their_zones():
    points = np.array(
        [(0.25, 0, 0), (0.35, 0, 0), (0.65, 0, 0), (1.5, 0, 0)], np.float32
    )  # 0.05, 0.15, 0.45 and 1.3 away
    made = scene_of(ball(), points, poses=np.eye(4)[None], farthest=0.5)
    assert made.distance[:3] == pytest.approx([0.05, 0.15, 0.45], abs=1e-6) and np.isinf(made.distance[3])
    assert (made.point_colours == colours.by_distance([0.05, 0.15, 0.45, np.inf], 0.5)).all()
    assert made.point_colours[0, 0] > made.point_colours[2, 0] and tuple(made.point_colours[3]) == colours.UNKNOWN
    zoned = scene_of(ball(), points, poses=np.eye(4)[None], zones=[0.2, 0.1])
    assert [tuple(c) for c in zoned.point_colours] == [
        colours.ZONES[0],
        colours.ZONES[1],
        colours.UNKNOWN,
        colours.UNKNOWN,
    ]
    assert [(zone.threshold, zone.points) for zone in zoned.zones] == [(0.1, 1), (0.2, 1)]


def test_the_cloud_and_the_robot_stand_where_their_poses_put_them():
    turn = np.array([(0, -1, 0, 1.0), (1, 0, 0, 2.0), (0, 0, 1, 3.0), (0, 0, 0, 1)])
    robot = ball()
    made = scene_of(robot, np.array([[0.5, 0, 0]]), poses=(turn @ np.eye(4))[None], cloud_pose=turn)
    assert np.allclose(made.points, [[1, 2.5, 3]]) and np.allclose(made.parts[0].pose, turn)
    assert made.result.distance == pytest.approx(0.3, abs=1e-6) and np.allclose(
        made.segment, [[1, 2.2, 3], [1, 2.5, 3]], atol=1e-5
    )


def test_nothing_seen_is_said_and_has_no_segment():
    made = scene_of(ball(), np.full((3, 3), np.nan, np.float32), poses=np.eye(4)[None])
    assert (
        made.segment is None
        and made.title.startswith("no_data: none of 3 points is valid")
        and made.label == "nothing seen"
    )
    assert len(made.points) == 0
    assert decode(raster.png(pictures.render(made, width=320, height=200))).shape == (200, 320, 3)


@pytest.mark.parametrize(
    "what, sentence",
    [
        ({}, "give either points= or depth="),
        ({"points": np.zeros((3, 2))}, "points have the shape"),
        ({"points": np.zeros((3, 3)), "clouds": [1]}, "clouds=... cannot be drawn"),
        ({"depth": np.zeros((3, 3), np.uint16)}, "depth needs intrinsics"),
        ({"points": np.zeros((3, 3)), "cloud_pose": np.eye(3)}, "cloud_pose is a matrix of shape (4, 4)"),
        ({"points": np.zeros((3, 3), "f4"), "zones": [-1.0]}, "zones are thresholds"),
        ({"points": np.zeros((3, 3), "f4"), "colour": "pink"}, "not 'pink'"),
        ({"points": np.zeros((3, 3), "f4"), "result": 3}, "not int"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_sentence(what, sentence):
    with pytest.raises(ValueError) as error:
        scene_of(ball(), poses=np.eye(4)[None], **what)
    assert sentence in str(error.value)


# The picture.


def test_a_picture_has_the_segment_s_colour_where_the_segment_is(arm, before_the_arm, tmp_path):
    made = scene_of(arm, joints=demo.JOINTS, most=4000, **before_the_arm)
    canvas = pictures.draw(made)
    file = picture_of(made, output=tmp_path / "p.png")
    pixels = decode(pathlib.Path(file).read_bytes())
    assert pixels.shape == (640, 960, 3)
    a, b = (canvas.pixel(p) for p in made.segment)
    assert np.linalg.norm(b - a) > 15
    for share in (0.2, 0.5, 0.8):
        x, y = np.floor(a + share * (b - a)).astype(int)
        assert close_to(pixels[y, x], made.segment_colour), (share, pixels[y, x])
    beside = np.floor((a + b) / 2 + 400 * np.array([0, 1]) * (-1 if (a + b)[1] > 640 else 0)).astype(int)
    assert not close_to(pixels[beside[1] % 640 - 30, 5], made.segment_colour, 40)


def test_what_is_nearer_to_the_eye_hides_what_is_behind():
    canvas = raster.Canvas(100, 100, (0, -2, 0), (0, 0, 0))

    def square(y, half):
        return np.array(
            [
                [(-half, y, -half), (half, y, -half), (half, y, half)],
                [(-half, y, -half), (half, y, half), (-half, y, half)],
            ]
        )

    canvas.triangles(square(0.5, 0.5), (255, 0, 0))
    canvas.triangles(square(0, 0.1), (0, 0, 255))
    canvas.triangles(square(0.6, 0.5), (0, 255, 0))
    canvas.points(
        np.array([[0, -0.2, 0], [0.3, 0.4, 0], [0.3, 0.7, 0.3]]),
        np.array([(9, 9, 9), (8, 8, 8), (7, 7, 7)], np.uint8),
        3,
    )
    pixels = canvas.finish()
    x, y = canvas.pixel((0.05, 0, 0.05)).astype(int)
    assert pixels[y, x, 2] > 100 and pixels[y, x, 0] == 0  # blue before red
    x, y = canvas.pixel((0.3, 0.5, 0.3)).astype(int)
    assert pixels[y, x, 0] > 100 and pixels[y, x, 1] == 0  # red before green and before the point behind
    x, y = np.round(canvas.pixel((0, -0.2, 0))).astype(int)
    assert pixels[y, x].max() < 140  # the point before blue
    assert tuple(pixels[0, 0]) == (255, 255, 255)


def test_a_triangle_covers_the_pixels_that_its_projection_covers():
    canvas = raster.Canvas(120, 80, (0, -3, 0.4), (0.1, 0, 0), samples=1)
    corners = np.array([[(-0.5, 0.2, -0.3), (0.6, -0.1, -0.2), (0.1, 0.3, 0.5)]])
    canvas.triangles(corners, (200, 200, 200))
    seen = canvas.project(corners[0])[:, :2]
    y, x = np.mgrid[:80, :120] + 0.5
    sides = [
        (seen[(k + 1) % 3, 0] - seen[k, 0]) * (y - seen[k, 1]) - (seen[(k + 1) % 3, 1] - seen[k, 1]) * (x - seen[k, 0])
        for k in range(3)
    ]
    inside = np.all(np.array(sides) > 0, axis=0) | np.all(np.array(sides) < 0, axis=0)
    painted = (canvas.finish() != 255).any(axis=-1)
    assert inside.sum() > 300 and (painted == inside).all()


def test_robots_without_meshes_are_drawn_as_their_spheres():
    made = scene_of(ball(0.2), np.array([[0.5, 0, 0]], np.float32), poses=np.eye(4)[None])
    canvas = pictures.draw(made, width=300, height=200, azimuth=-90, elevation=0)
    pixels, (x, y) = canvas.finish(), canvas.pixel((-0.05, -0.2, 0))
    r, g, b = pixels[int(y), int(x)].astype(int)
    assert r > g > b  # the nearest part's orange, lit
    edge = canvas.pixel((-0.26, 0, 0)).astype(int)
    assert tuple(pixels[edge[1], edge[0]]) == (255, 255, 255)


def test_letters_are_different_and_of_one_size():
    masks = {letter: letters.mask(letter, 1) for letter in letters._ROWS}
    assert {m.shape for m in masks.values()} == {(8, 6)}
    assert len({m.tobytes() for m in masks.values()}) == len(masks)
    assert letters.mask("ab", 2).shape == (16, 24) and letters.mask("").size == 0


def test_a_picture_of_another_kind_of_file_is_refused(tmp_path):
    with pytest.raises(ValueError, match="a picture is a .png file"):
        picture_of(ball(), np.zeros((1, 3), "f4"), poses=np.eye(4)[None], output=tmp_path / "p.jpg")


# The recording for rerun.


def test_a_recording_holds_robot_points_segment_image_and_plots(arm, before_the_arm, tmp_path):
    pytest.importorskip("rerun", reason="rerun-sdk is not installed")
    from clearance.seeing.rerun_file import write

    moments = []
    for k in range(3):
        moments.append(
            scene_of(arm, joints=demo.JOINTS | {"turn": 0.4 + 0.1 * k}, most=500, margin=0.05, **before_the_arm)
        )
    moments.append(scene_of(arm, np.full((2, 3), np.nan, "f4"), joints=demo.JOINTS))
    file = write(tmp_path / "out.rrd", moments, [1.7e9 + k for k in range(4)])
    told = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "verify", file], capture_output=True, text=True, timeout=120
    )
    assert told.returncode == 0, told.stderr
    told = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "print", "-vvv", file], capture_output=True, text=True, timeout=120
    ).stdout
    for path in (
        "/world/robot/gripper",
        "/world/robot/gripper/mesh",
        "/world/points",
        "/world/segment",
        "/world/camera/lens",
        "/image/depth",
        "/clearance/distance",
        "/clearance/lower",
        "/clearance/upper",
        "/clearance/bracket",
        "/clearance/margin",
        "/points/valid",
        "/points/missing",
        "/answer",
    ):
        assert path in told, path
    assert moments[0].label in told and "no_data: none of 2 points is valid" in told
    read = read_back(file)
    for k in range(3):
        for name in ("distance", "lower", "upper"):
            assert read[f"/clearance/{name}"][k] == pytest.approx(getattr(moments[k].result, name), abs=1e-9)
        low, high = moments[k].result.lower, moments[k].result.upper
        band = read["/clearance/bracket"][3 * k : 3 * k + 3]
        assert sorted(band) == pytest.approx([low, low, high], abs=1e-9)
    assert math.isnan(read["/clearance/distance"][3])


def read_back(file):
    """{entity: its scalars, in the order of frames}."""
    from rerun.chunk import RrdReader

    rows = {}
    for chunk in RrdReader(file).stream():
        batch = chunk.to_record_batch()
        if "Scalars:scalars" in batch.schema.names and not chunk.is_static:
            values = zip(batch.column("frame").to_pylist(), batch.column("Scalars:scalars").to_pylist())
            rows.setdefault(chunk.entity_path, []).extend((frame, value[0]) for frame, value in values)
    return {entity: [value for _, value in sorted(pairs)] for entity, pairs in rows.items()}


def test_show_writes_both_files_of_one_scene(arm, before_the_arm, tmp_path):
    pytest.importorskip("rerun", reason="rerun-sdk is not installed")
    written = show(
        arm, joints=demo.JOINTS, rerun=tmp_path / "a.rrd", picture=tmp_path / "a.png", most=300, **before_the_arm
    )
    assert [pathlib.Path(f).name for f in written] == ["a.rrd", "a.png"] and all(
        pathlib.Path(f).stat().st_size > 1000 for f in written
    )


def test_a_missing_viewer_is_one_sentence_that_names_the_extra(arm, before_the_arm, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(ImportError, match=r"pip install clearance\[rerun\]"):
        show(arm, joints=demo.JOINTS, rerun=tmp_path / "a.rrd", most=10, **before_the_arm)
    with pytest.raises(ImportError, match=r"pip install clearance\[view\]"):
        show(arm, joints=demo.JOINTS, wait=False, **before_the_arm)


# Clearance over time.


def test_the_band_holds_the_line_and_a_moment_without_data_is_a_bar():
    times, states = [0, 1, 2, 3, 4], ["free", "free", "no_data", "free", "free"]
    text = history.svg(
        times,
        [0.3, 0.2, math.nan, 0.1, 0.4],
        [0.28, 0.19, 0, 0.08, 0.39],
        [0.31, 0.21, math.inf, 0.11, 0.41],
        states,
        margin=0.15,
    )
    import xml.etree.ElementTree as tree

    root = tree.fromstring(text)

    def of(kind):
        return [e for e in root.iter() if e.get("class") == kind]

    assert len(of("band")) == len(of("distance")) == 2 and len(of("no-data")) == 1 and len(of("margin")) == 1
    for band, line in zip(of("band"), of("distance")):
        edge = [tuple(map(float, p.split(","))) for p in band.get("points").split()]
        along = [tuple(map(float, p.split(","))) for p in line.get("points").split()]
        upper, lower = edge[: len(along)], edge[len(along) :][::-1]
        assert all(u[0] == p[0] == low[0] and u[1] < p[1] < low[1] for u, p, low in zip(upper, along, lower))
    assert history.svg([], [], [], [], []).startswith("<svg")


def test_a_histogram_counts_every_value():
    import xml.etree.ElementTree as tree

    values = [*np.linspace(10, 20, 500), 1000.0]
    root = tree.fromstring(history.histogram_svg(values))
    assert sum(int(e.find("{*}title").text) for e in root.iter() if e.get("class") == "bar") == 501
    assert "2 above 19.98, at most 1000" in tree.tostring(root, encoding="unicode")


# The report.

JSON = [
    '{"frame":0,"file":"f.npy","state":"free","distance":0.3,"lower":0.29,"upper":0.31,"point":1,"part":"gripper",'
    '"point_xyz":[1,2,3],"nearest_xyz":[1,2,2.7],"points":{"seen":10,"valid":7,"dropped":{"not_finite":0,"missing":3}},"latency_us":50}',
    '{"frame":1,"file":"g.npy","state":"no_data","distance":null,"lower":null,"upper":null,"point":null,"part":null,"point_xyz":null,'
    '"nearest_xyz":null,"points":{"seen":10,"valid":0,"dropped":{"not_finite":4,"missing":6}},"latency_us":20}',
    '{"frame":2,"file":"f.npy","state":"possible","distance":0.004,"lower":-0.001,"upper":0.005,"point":2,"part":"gripper",'
    '"point_xyz":[1,2,3],"nearest_xyz":[1,2,2.7],"points":{"seen":10,"valid":10,"dropped":{"not_finite":0,"missing":0}},"latency_us":90}',
]
PLAYED = """stamp,topic,frame,state,distance,lower,upper,link,point,seen,valid,dropped,note,parts,checked,\
at_x,at_y,at_z,nearest_x,nearest_y,nearest_z
100.5,/cloud,lens,free,0.2,0.19,0.21,hand,7,10,9,"{""missing"": 1}",,,,1,2,3,1,2,2.8
100.6,/cloud,lens,unknown,nan,0.0,inf,,,0,0,{},no transform <here>,,,,,,,,
100.7,/cloud,lens,collision,0.0,0.0,0.0,hand,8,10,10,"{""missing"": 0}",,,,1,2,3,1,2,3
"""


def page_of(tmp_path, text, *words, name="rows.txt"):
    import html.parser

    (tmp_path / name).write_text(text)
    code = main(["report", str(tmp_path / name), "--output", str(tmp_path / "out.html"), *words])
    told = (tmp_path / "out.html").read_text() if code == 0 else ""
    parser = html.parser.HTMLParser()
    parser.feed(told)
    assert (
        not any(f'{loads}="http' in told for loads in ("src", "href")) and "<script" not in told
    )  # it needs nothing else
    return told


def test_a_report_of_json_rows_says_what_is_in_them(tmp_path):
    told = page_of(tmp_path, "\n".join(JSON), "--margin", "0.1")
    for words in (
        "<b>0.004 m</b> (certainly -0.001 to 0.005)",
        "frame 2, f.npy",
        "3: 1 free, 1 possible, 1 no_data",
        "above the margin of 0.100 m in 1 of 3 frames; it is <b>not</b> in 1",
        "<b>Nothing is known in 1 of 3 frames</b>",
        "Nothing is known at: frame 1, g.npy",
        "<td>17</td><td>56.7 %</td>",
        "<td>9</td><td>30.0 %</td>",
        "30 points in 3 frames",
        "all at most 90 us",
        'class="no-data"',
        'class="margin"',
    ):
        assert words in told, words


def test_a_report_has_a_second_band_about_what_is_not_seen(tmp_path):
    rows = [
        {"frame": 0, "state": "free", "distance": 0.5, "lower": 0.49, "upper": 0.51},
        {"frame": 1, "state": "free", "distance": 0.4, "lower": 0.39, "upper": 0.41},
        {"frame": 2, "state": "free", "distance": 0.4, "lower": 0.39, "upper": 0.41},
    ]
    none = page_of(tmp_path, "\n".join(map(json.dumps, rows)))
    assert "unseen" not in none and "no camera" not in none
    rows[0]["unseen"] = {"state": "free", "distance": 0.31, "lower": 0.3, "upper": 0.32}
    rows[1]["unseen"] = {"state": "unknown", "distance": 0, "lower": 0, "upper": 0.002}
    rows[2]["unseen"] = {"state": "free", "distance": None, "lower": None, "upper": None}
    told = page_of(tmp_path, "\n".join(map(json.dumps, rows)))
    for words in (
        "What no camera sees is certainly at least 0.000 m away, at frame 1; the robot <b>reaches into it</b> in 1 frames.",
        'class="unseen-band"',
        'class="unseen-distance"',
        "Orange: the same to what no camera sees.",
    ):
        assert words in told, words
    table = "frame,state,distance,lower,upper,unseen_state,unseen_distance,unseen_lower\n0,free,0.5,0.49,0.51,free,0.3,0.25\n"
    assert "certainly at least 0.250 m away" in page_of(tmp_path, table, name="rows.csv")
    assert page_of(tmp_path, table.replace("free,0.3", "odd,0.3"), name="rows.csv") == ""


def test_a_report_of_played_rows_says_what_is_in_them(tmp_path):
    told = page_of(tmp_path, PLAYED)
    for words in (
        "<b>0.000 m</b> (certainly 0.000 to 0.000), hand, at 100.700 s, /cloud",
        "1 free, 1 collision, 1 unknown",
        "100.600 s, /cloud (no transform &lt;here&gt;)",
        "<td>19</td><td>95.0 %</td>",
        "The rows do not say it.",
    ):
        assert words in told, words


def row_of(stamp, topic, distance, lower=None, state=None):
    lower = max(distance, 0) if lower is None else lower
    state = state or ("free" if lower > 0 else "collision" if distance < 0 else "possible")
    return {"stamp": stamp, "topic": topic, "state": state, "distance": distance, "lower": lower, "upper": max(distance, 0),
            "link": "hand", "point": 3}  # fmt: skip


def told_of(tmp_path, rows, *words):
    """The sentences at the top of the page, as text."""
    table = "\n".join([",".join(rows[0])] + [",".join(map(str, row.values())) for row in rows])
    page = page_of(tmp_path, table, *words, name="rows.csv")
    return re.sub("<.*?>", "", "\n".join(re.findall("<p class=verdict>(.*?)</p>", page))), page


def test_the_least_distance_of_a_report_is_the_least(tmp_path):
    """Collisions all have the lower end 0, and the deepest of them is the worst."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        deep = rng.permutation([-0.001, -0.2, -0.05, 0.3, 0.4]).round(3)
        rows = [row_of(100 + k, "/cloud", far) for k, far in enumerate(deep)]
        said, page = told_of(tmp_path, rows)
        at = f"at {100 + deep.argmin()}.000 s, /cloud"
        assert said == f"The least distance is -0.200 m (certainly 0.000 to 0.000), hand, {at}."
        assert "<b>1. -0.200 m</b>" in page


def test_a_report_has_a_line_for_each_topic(tmp_path):
    """Frames of several sensors alternate, so those beside one are of others."""
    rows = [row_of(100 + k / 10, topic, far) for k in range(4)
            for topic, far in (("/a", -0.001 - k / 1000), ("/b", -0.2 + k / 100), ("/c", 0.5 + k / 10))]  # fmt: skip
    rows.append(row_of(101, "/d", 0.1, state="unknown"))
    said, page = told_of(tmp_path, rows)
    assert said.splitlines() == [
        "The least distance of /a is -0.004 m (certainly 0.000 to 0.000), hand, at 100.300 s.",
        "The least distance of /b is -0.200 m (certainly 0.000 to 0.000), hand, at 100.000 s.",
        "The least distance of /c is 0.500 m (certainly 0.500 to 0.500), hand, at 100.000 s.",
        "Nothing is known in 1 of 13 frames, because they have no valid point or could not be asked.",
    ]
    worst = re.findall(r"<b>\d\. (.*?)</b>.*?<br>(.*?)<", page)
    assert worst == [("-0.200 m", "100.000 s, /b"), ("-0.004 m", "100.300 s, /a"), ("0.500 m", "100.000 s, /c")]


def test_a_report_says_where_the_least_is_least_certain(tmp_path):
    rows = [row_of(100, "/a", 0.3, 0.05), row_of(101, "/a", 0.2, 0.19), row_of(102, "/a", -0.00001)]
    said, page = told_of(tmp_path, rows[:2])
    assert said.splitlines() == [
        "The least distance is 0.200 m (certainly 0.190 to 0.200), hand, at 101.000 s, /a.",
        "It is certainly above 0.050 m only, at 100.000 s, /a.",
    ]
    assert "-0.000" not in told_of(tmp_path, rows)[1]


def test_the_worst_moments_are_dips_and_not_neighbours_of_one():
    from clearance.seeing.report import Moment, worst

    lower = [0.5, 0.2, 0.1, 0.2, 0.5, 0.4, 0.3, 0.4, None, 0.9]
    moments = [
        Moment(k, "free", v, v, v) if v is not None else Moment(k, "no_data", math.nan, 0.0, math.inf)
        for k, v in enumerate(lower)
    ]
    assert worst(moments, 2) == [2, 6] and worst(moments, 3) == [2, 6, 9] and worst(moments, 0) == []
    assert 8 not in worst(moments, 99) and len(worst(moments, 99)) == 9


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("", "is empty"),
        ("a,b\n1,2\n", "has no column state"),
        ('{"state":"fine"}', "the state is 'fine'"),
        ("[1]", "is no JSON object"),
        ("{", "has no rows (line 1 of"),
        ('{"state":"free","distance":null,"lower":0}', "there is no distance"),
        ("state,distance,lower,upper\nfree,x,1,1\n", "distance is 'x'"),
    ],
)
def test_rows_that_mean_nothing_are_refused_in_a_sentence(tmp_path, capsys, text, sentence):
    assert page_of(tmp_path, text) == "" and not (tmp_path / "out.html").exists()
    said = capsys.readouterr().err
    assert sentence in said and said.count("\n") == 1


def test_a_damaged_line_is_said_and_the_rows_before_it_are_shown(tmp_path, capsys):
    told = page_of(tmp_path, "\n".join(JSON)[:-40])
    assert "line 3 of" in told and "only the 2 rows before it are shown" in told and "2: 1 free, 1 no_data" in told
    assert "only the 2 rows" in capsys.readouterr().out
    assert "only the 2 rows" in page_of(tmp_path, PLAYED[: PLAYED.rindex("8,10,10")])


def test_a_report_draws_the_worst_moments_and_says_where_its_answer_differs(tmp_path, before_the_arm, capsys):
    import base64
    import re

    from clearance.seeing.page import quaternion

    robot = demo.write_urdf(tmp_path)
    np.save(tmp_path / "f.npy", before_the_arm["depth"])
    names = list(demo.JOINTS)
    (tmp_path / "moves.csv").write_text(
        ",".join(names) + "\n" + "\n".join(",".join(map(str, demo.JOINTS.values())) for _ in range(3))
    )
    pose = demo.camera_pose()
    q = quaternion(pose[:3, :3])
    right = clearance.Query(clearance.Robot.from_urdf(robot, model="triangles"), clearance.MinDistance())(
        joints=demo.JOINTS, **before_the_arm
    )
    first = json.loads(JSON[0]) | {"distance": right.distance, "lower": right.lower, "upper": right.upper}
    told = page_of(
        tmp_path,
        "\n".join([json.dumps(first), *JSON[1:]]),
        "--robot",
        robot,
        "--trajectory",
        str(tmp_path / "moves.csv"),
        "--intrinsics",
        ",".join(map(str, demo.CAMERA)),
        "--camera-pose=" + ",".join(map(str, (*pose[:3, 3], *q[1:], q[0]))),
    )
    found = re.findall(r"data:image/png;base64,([^\"]+)", told)
    assert len(found) == 2 and all(decode(base64.b64decode(p)).shape == (560, 860, 3) for p in found)
    assert told.count("own answer is") == 2  # as a note and beside the picture; only the row that says 0.004
    assert f"moment 1: the picture&#x27;s own answer is {right.distance:.4f} m" in told
    assert "moment 1: the picture's own answer" in capsys.readouterr().out


@pytest.fixture
def compiled(tmp_path, monkeypatch):
    """A stand-in for the compiled command: it notes its words, prints rows and ends with a code."""

    def make(lines, code=0):
        folder = tmp_path / "bin"
        folder.mkdir(exist_ok=True)
        (tmp_path / "printed").write_text("".join(line + "\n" for line in lines))
        script = folder / "clearance"
        script.write_text(
            f'#!/bin/sh\nfor word; do echo "$word"; done > {tmp_path}/words\ncat {tmp_path}/printed\nexit {code}\n'
        )
        script.chmod(0o755)
        monkeypatch.setenv("PATH", f"{folder}:/bin:/usr/bin")
        return lambda: (tmp_path / "words").read_text().splitlines()

    return make


def test_a_run_of_the_compiled_command_gets_a_page(tmp_path, before_the_arm, capsys, compiled):
    import re

    from clearance.seeing.page import quaternion

    robot = demo.write_urdf(tmp_path)
    np.save(tmp_path / "f.npy", before_the_arm["depth"])
    pose = demo.camera_pose()
    q = quaternion(pose[:3, :3])
    right = clearance.Query(clearance.Robot.from_urdf(robot, spheres=64), clearance.MinDistance())(
        joints=demo.JOINTS, **before_the_arm
    )
    rows = [json.loads(line) | {"file": str(tmp_path / "f.npy")} for line in JSON]
    rows[0] |= {"distance": right.distance, "lower": right.lower, "upper": right.upper}
    words = compiled([json.dumps(row) for row in rows], 2)
    own = ["--robot", robot, "--frames", str(tmp_path), "--spheres", "64", "--check", "0.1", "--merge"]
    own += [word for name, value in demo.JOINTS.items() for word in ("--joint", f"{name}={value}")]
    own += ["--intrinsics", ",".join(map(str, demo.CAMERA))]
    own += ["--camera-pose", ",".join(map(str, (*pose[:3, 3], *q[1:], q[0])))]
    page = tmp_path / "out.html"
    code = main(["run", *own[:4], "--report", str(page), *own[4:], "--worst=2", "--title", "a b"])
    said = capsys.readouterr()
    told = page.read_text()
    assert code == 2 and said.out.splitlines() == [json.dumps(row) for row in rows]  # as without the page
    assert words() == ["run", *own]
    assert len(re.findall("data:image/png", told)) == 2 and "<h1>a b</h1>" in told and "clearance run --robot" in told
    assert told.count("own answer is") == 2  # of the row that says 0.004
    assert "above the margin of 0.100 m" in told and "all at most 90 us" in told and 'class="margin"' in told


@pytest.mark.parametrize(
    "lines, code, words, sentence",
    [
        ([], 1, ["--report", "out.txt"], "--report writes an .html file"),
        ([], 1, ["--title", "x"], "--title and --worst are for --report"),
        (["oops"], 0, ["--report", "out.html"], "what clearance run printed has no column state"),
    ],
)
def test_a_run_without_a_page_is_said(tmp_path, monkeypatch, capsys, compiled, lines, code, words, sentence):
    monkeypatch.chdir(tmp_path)
    compiled(lines, code)
    assert main(["run", "--robot", "r.urdf", *words]) == 1
    said = capsys.readouterr().err
    assert sentence in said and said.count("\n") == 1 and not (tmp_path / "out.html").exists()


def test_a_run_that_fails_keeps_its_code_and_what_it_answered(tmp_path, capsys, compiled):
    compiled(JSON[:2], 1)
    assert main(["run", "--robot", str(tmp_path / "no.urdf"), "--report", str(tmp_path / "out.html")]) == 1
    told = (tmp_path / "out.html").read_text()
    assert "clearance run failed after 2 frames" in told and "no pictures: " in told
    compiled([], 1)
    (tmp_path / "out.html").unlink()
    assert main(["run", "--report", str(tmp_path / "out.html")]) == 1 and not (tmp_path / "out.html").exists()


def test_a_value_that_begins_with_a_minus_is_one():
    from clearance.__main__ import joined

    given = ["report", "--base-pose", "-0.5,0,1", "--joint", "a=-1", "--x", "--y=1", "-2", "-h"]
    assert joined(given) == ["report", "--base-pose=-0.5,0,1", "--joint", "a=-1", "--x", "--y=1", "-2", "-h"]


def test_the_help_of_run_is_that_of_both_commands(tmp_path, compiled):
    words = compiled(["what the compiled command takes"])
    done = subprocess.run([sys.executable, "-m", "clearance", "run", "--help"], capture_output=True, text=True)
    assert done.returncode == 0 and words() == ["run", "--help"]
    assert "--report FILE.html" in done.stdout and done.stdout.rstrip().endswith("what the compiled command takes")


def test_the_command_says_its_version(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0 and capsys.readouterr().out == f"clearance {clearance.__version__}\n"


def test_a_run_needs_the_compiled_command_and_not_this_one_again(tmp_path, monkeypatch, capsys):
    script = tmp_path / "clearance"
    script.write_text("#!/bin/sh\nexec python3 -c 'from clearance.__main__ import main' \n")
    script.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(["run", "--robot", "r.urdf"]) == 1
    assert "the compiled command clearance, which answers, is not on the PATH" in capsys.readouterr().err


# Files.


def test_clouds_of_every_kind_of_file_are_the_same_points(tmp_path):
    points = np.random.default_rng(2).uniform(-1, 1, (50, 3)).astype(np.float32)
    np.save(tmp_path / "a.npy", points)
    np.savez(tmp_path / "a.npz", points=points, other=np.zeros(3))
    np.savetxt(tmp_path / "a.txt", points, fmt="%.9g", header="x y z")
    (tmp_path / "a.csv").write_text("x,y,z\n" + "\n".join(",".join(f"{v:.9g}" for v in p) for p in points))
    (tmp_path / "b.npy").write_bytes(b"")
    fields = np.zeros(50, [("intensity", "f4"), ("x", "f4"), ("y", "f4"), ("z", "f4")])
    for k, axis in enumerate("xyz"):
        fields[axis] = points[:, k]
    np.save(tmp_path / "c.npy", fields)
    for name in ("a.npy", "a.npz", "a.txt", "a.csv", "c.npy"):
        read, notes = files.read_cloud(tmp_path / name)
        assert notes == [] and np.array_equal(read.astype(np.float32), points), name


def test_a_ply_and_a_pcd_of_an_old_version_are_read(tmp_path):
    pytest.importorskip("plyfile", reason="plyfile is not installed")
    pytest.importorskip("pypcd4", reason="pypcd4 is not installed")
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n1 2 3\n4 5 6\n"
    )
    head = "# .PCD\nVERSION .5\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    head += "POINTS 2\nDATA ascii\n"
    (tmp_path / "a.pcd").write_text(head + "1 2 3\n4 5 6\n")
    for name in ("a.ply", "a.pcd"):
        assert files.read_cloud(tmp_path / name)[0].tolist() == [[1, 2, 3], [4, 5, 6]], name
    (tmp_path / "b.pcd").write_text(
        head.replace("VERSION .5", "VERSION 0.7\nVIEWPOINT 0 0 1 1 0 0 0") + "1 2 3\n4 5 6\n"
    )
    assert "VIEWPOINT is not applied" in files.read_cloud(tmp_path / "b.pcd")[1][0]


@pytest.mark.parametrize(
    "name, content, sentence",
    [
        ("a.xyz", "1 2\n3 4\n", "has no rows of x y z"),
        ("a.txt", "1 2 3\n4 x 6\n", "a word that is no number"),
        ("a.txt", "", "has no rows"),
        ("a.csv", "y,x,z\n1,2,3\n", "begin with y x z"),
        ("a.obj", "v 1 2 3", "is no cloud that can be read"),
        ("a.npy", "junk", "is no NumPy array"),
    ],
)
def test_a_cloud_that_cannot_be_read_is_refused_in_a_sentence(tmp_path, name, content, sentence):
    (tmp_path / name).write_text(content)
    with pytest.raises(ValueError) as error:
        files.read_cloud(tmp_path / name)
    assert sentence in str(error.value) and name in str(error.value) and "\n" not in str(error.value)


def test_a_depth_image_is_read_to_the_bit_and_a_colour_image_is_refused(tmp_path):
    image = pytest.importorskip("PIL.Image", reason="pillow is not installed")
    depth = demo.depth_image()
    image.fromarray(depth).save(tmp_path / "d.png")
    np.save(tmp_path / "d.npy", depth)
    assert np.array_equal(files.read_depth(tmp_path / "d.png"), depth) and np.array_equal(
        files.read_depth(tmp_path / "d.npy"), depth
    )
    image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(tmp_path / "c.png")
    with pytest.raises(ValueError, match="mode RGB"):
        files.read_depth(tmp_path / "c.png")
    (tmp_path / "cut.png").write_bytes((tmp_path / "d.png").read_bytes()[:5000])
    with pytest.raises(ValueError, match="damaged|no image"):
        files.read_depth(tmp_path / "cut.png")


@pytest.mark.skipif(not DATA.is_dir(), reason="there is no ../shared/data")
def test_every_real_pcd_is_read():
    pytest.importorskip("pypcd4", reason="pypcd4 is not installed")
    found = sorted((DATA / "clouds").rglob("*.pcd"))
    assert len(found) > 10
    for file in found:
        assert files.read_cloud(file)[0].shape[-1] == 3, file


# The command.


def test_view_without_arguments_prints_a_number_and_writes_a_picture(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["view"]) == 0
    said = capsys.readouterr().out
    assert "free: 0." in said and "gripper" in said and "written: clearance.png" in said
    assert decode((tmp_path / "clearance.png").read_bytes()).shape == (640, 960, 3)


def test_view_shows_a_robot_and_a_cloud_of_files(tmp_path, capsys):
    robot = demo.write_urdf(tmp_path)
    np.save(tmp_path / "c.npy", np.array([[0.9, 0, 0.4], [2, 2, 2]], np.float32))
    picture = tmp_path / "v.png"
    code = main(
        [
            "view",
            robot,
            "--cloud",
            str(tmp_path / "c.npy"),
            "--joints",
            "elbow=1.5",
            "--picture",
            str(picture),
            "--margin",
            "5",
        ]
    )
    said = capsys.readouterr().out
    asked = clearance.Query(clearance.Robot.from_urdf(robot, model="triangles"), clearance.MinDistance())
    r = asked(np.array([[0.9, 0, 0.4], [2, 2, 2]], np.float32), joints=[0, 0, 1.5, 0, 0])
    assert (
        code == 2 and f"{r.state.name}: {r.distance:.3f} m" in said and "at rest: turn, shoulder, wrist, hand" in said
    )
    assert picture.stat().st_size > 2000


def test_view_hints_at_clouds_in_other_units_and_scales_them(tmp_path, capsys):
    np.save(tmp_path / "c.npy", np.array([[900, 0, 400], [2000, 2000, 2000]], np.float32))
    words = ["view", demo.write_urdf(tmp_path), "--cloud", str(tmp_path / "c.npy"), "--picture", str(tmp_path / "v.png")]
    assert main(words) == 0
    assert "note: no point is within 50 m of the robot: are they in metres? (--cloud-scale)" in capsys.readouterr().out
    assert main([*words, "--cloud-scale", "0.001", "--margin", "5"]) == 2
    assert "within 50 m" not in capsys.readouterr().out


def test_view_takes_a_joint_that_follows_another_by_either_option(tmp_path, monkeypatch, capsys):
    from test_playing import GRIPPER

    monkeypatch.chdir(tmp_path)
    pathlib.Path("gripper.urdf").write_text(GRIPPER)
    np.save("one.npy", np.array([[0, -0.1, 0]], "f4"))
    words = ["view", "gripper.urdf", "--cloud", "one.npy", "--margin", "0.01"]
    for joints, said in (
        (["--joint", "grip=0.01"], "free: 0.080 m"),
        (["--joint", "grip=0.01", "--joint", "grip2=0.04"], "joint grip2 has a value of its own here"),
        (["--joints", "grip=0.01,grip2=0.04"], "free: 0.050 m"),
        (["--joints", "0.02"], "free: 0.070 m"),
        (["--joint", "grip2=0.04"], "note: at rest: grip\n"),
    ):
        assert main([*words, *joints]) == 0
        assert said in capsys.readouterr().out
    page = pytest.importorskip("viser") and clearance.seeing.show(
        clearance.Robot.from_urdf("gripper.urdf", model="triangles"),
        np.load("one.npy"),
        {"grip": 0.01, "grip2": 0.04},
        port=8237,
        wait=False,
    )
    try:
        assert page._answer(page.values)[1].distance == pytest.approx(0.05, abs=1e-6)
    finally:
        page.close()


@pytest.mark.parametrize(
    "words, sentence",
    [
        (["--cloud", "x.npy"], "need a robot"),
        (["ARM"], "needs something before it"),
        (["ARM", "--cloud", "no.npy"], "no.npy is no file"),
        (["ARM", "--depth", "d.npy"], "--depth needs --intrinsics"),
        (["--joints", "knee=1"], 'no joint "knee"'),
        (["--joints", "elbow"], "NAME=VALUE"),
        (["--joints", "elbow=x"], "--joint elbow="),
        (["--joints", "0.1,0.2"], "--joints has 2 values, and the robot has 5 joints"),
        (["--joints", "0,0,0", "--joint", "elbow=1"], "'0' has no name"),
        (["--joint", "elbow=1", "--joints", "elbow=2"], "once for each name"),
        (["--zones", "a"], "--zones takes"),
        (["--picture", "a.gif"], ".png"),
        (["--joints", "elbow=99"], "elbow"),
        (["--spheres", "9", "--model", "triangles"], "--spheres is for"),
        (["ARM", "--depth", "d.npy", "--cloud-scale", "0.1"], "--cloud-scale is for --cloud"),
        (["ARM", "--cloud", "one.npy", "--cloud-scale", "0"], "metres per unit; it is from 1e-9 to 1e9"),
        (["ARM", "--cloud", "one.npy", "--pose", "0,0,0,0,0,0,2"], "quaternion has the length 2"),
    ],
)
def test_view_refuses_in_a_sentence(tmp_path, monkeypatch, capsys, words, sentence):
    monkeypatch.chdir(tmp_path)
    np.save("one.npy", np.zeros((1, 3), "f4"))
    arm = demo.write_urdf(tmp_path)
    assert main(["view", *[arm if w == "ARM" else w for w in words]]) == 1
    said = capsys.readouterr().err
    assert sentence in said and said.startswith("clearance view: ") and said.count("\n") == 1
    assert not pathlib.Path("clearance.png").exists()


def test_view_ends_with_3_if_nothing_is_seen(tmp_path, capsys):
    np.save(tmp_path / "n.npy", np.full((4, 3), np.nan, "f4"))
    code = main(
        ["view", demo.write_urdf(tmp_path), "--cloud", str(tmp_path / "n.npy"), "--picture", str(tmp_path / "p.png")]
    )
    assert code == 3 and "no_data" in capsys.readouterr().out
