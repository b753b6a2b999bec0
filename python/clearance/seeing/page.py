# SPDX-License-Identifier: BSD-3-Clause
"""A live page: sliders for the joints, the margin and the model; the distance follows."""

import collections
import html
import math
import sys
import threading
import time

import numpy as np

from .. import _core
from . import colours
from .scenes import Seen, compose, number, poses_of, sentence

SECONDS = 20.0  # of clearance over time
AFTER = 0.25  # seconds without a change until the points get new colours
MOST_A_SECOND = 60  # updates; more than a screen shows would only cost


def _viser():
    try:
        import viser
    except ImportError:
        raise ImportError("clearance: the live page needs viser: pip install clearance[view]") from None
    return viser


def quaternion(matrix):
    """w, x, y, z of a rotation matrix."""
    m = np.asarray(matrix, float)
    squares = np.array(
        [
            1 + m[0, 0] + m[1, 1] + m[2, 2],
            1 + m[0, 0] - m[1, 1] - m[2, 2],
            1 - m[0, 0] + m[1, 1] - m[2, 2],
            1 - m[0, 0] - m[1, 1] + m[2, 2],
        ]
    )
    k = int(squares.argmax())  # the largest is far from 0
    q = np.array(
        [
            [squares[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], squares[1], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], squares[2], m[2, 1] + m[1, 2]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], squares[3]],
        ]
    )[k]
    return q / np.linalg.norm(q)


def joint_values(robot, joints):
    """Of all joints, in their order, where sliders begin: at rest, unless they are named. And {name: value} of joints
    that follow others and are named."""
    values, own = np.array(robot.rest, float), {}
    if joints is None:
        return values, own
    if isinstance(joints, dict):
        for name, value in joints.items():
            if name in robot.mimics:
                own[name] = value
            elif name not in robot.joints:
                raise ValueError(f'clearance: the robot has no joint "{name}" (it has: {", ".join(robot.joints)})')
            else:
                values[robot.joints.index(name)] = value
        return values, own
    given = np.asarray(joints, float)
    if given.shape != values.shape:
        raise ValueError(f"clearance: joints have the shape {values.shape}, not {given.shape}")
    return given.copy(), own


class Page:
    """The page of one cloud and one robot. It runs in threads of its own until close()."""

    def __init__(
        self,
        robot,
        points=None,
        joints=None,
        *,
        poses=None,
        base=None,
        zones=None,
        margin=None,
        farthest=0.5,
        most=30000,
        port=8080,
        host="127.0.0.1",
        remake=None,
        device="cpu",
        ignore_limits=False,
        rest=False,
        **what,
    ):
        """remake: a function (model) -> robot, for the switch of the model; without it there is none."""
        viser = _viser()
        self.robot, self.base, self.device, self.remake, self.ignore_limits = robot, base, device, remake, ignore_limits
        self.seen = Seen(points, **what)
        self.zones, self.farthest, self.most = zones, farthest, most
        self.fixed = None
        if poses is not None or not self._has_joints():
            self.fixed, self.values = poses_of(robot, joints, poses, base, rest=rest), np.empty(0)
        else:
            self.values, self.own = joint_values(robot, joints)
        self.query = _core.Query(robot, _core.MinDistance(), device=device)
        self.margin = margin if margin is not None else 0.05
        self.wake, self.ended, self.lock = threading.Condition(), False, threading.Lock()
        self.asked, self.changed = 1, time.monotonic()
        self.past = collections.deque()  # (time, distance, lower, upper)
        self.rates, self.plotted = collections.deque(maxlen=120), 0.0
        self.took = dict.fromkeys(("ask", "send"), 0.0)  # seconds of the last update
        self.updates, self.coloured, self.error, self.result = 0, 0, None, None

        first = self._answer(self.values)[1]  # before there is a server: an error is the caller's
        self.server = viser.ViserServer(host=host, port=port, label="clearance", verbose=False)
        self.url = f"http://{'localhost' if host in ('127.0.0.1', '0.0.0.0') else host}:{self.server.get_port()}"
        self._draw(
            compose(
                robot,
                self.seen,
                self._poses(self.values),
                first,
                zones=zones,
                margin=self.margin,
                farthest=farthest,
                most=most,
                colour="none",
            )
        )
        self._controls(viser)
        self.threads = [threading.Thread(target=f, daemon=True) for f in (self._follow, self._colour)]
        for thread in self.threads:
            thread.start()

    def _has_joints(self):
        try:
            return len(self.robot.joints) > 0
        except ValueError:
            return False

    def _poses(self, values):
        if self.fixed is None and self.own:
            values = dict(zip(self.robot.joints, values)) | self.own
        return (
            self.fixed if self.fixed is not None else poses_of(self.robot, values, None, self.base, self.ignore_limits)
        )

    def _answer(self, values):
        poses = self._poses(values)
        return poses, self.query(poses=poses, **self.seen.asked)

    # What is on the page.

    def _draw(self, scene):
        """Makes everything once; later only what changes is sent."""
        draw = self.server.scene
        draw.set_up_direction("+z")
        draw.configure_default_lights(cast_shadow=False)  # without a GPU, shadows and reflections cost most of a frame
        draw.configure_environment_map(None)
        draw.add_light_ambient("/light", intensity=1.5)
        self.frames, self.balls = [], []
        for k, part in enumerate(scene.parts):
            frame = draw.add_frame(f"/robot/{k}", show_axes=False)
            if len(part.triangles):
                draw.add_mesh_simple(
                    f"/robot/{k}/mesh",
                    part.vertices,
                    part.triangles,
                    color=colours.PART,
                    flat_shading=True,
                    side="double",
                )
            self.frames.append(frame)
        self._balls(not all(len(part.triangles) for part in scene.parts))
        self.drawn, self.step = scene.points, scene.step
        self.cloud = draw.add_point_cloud(
            "/points", self.drawn, scene.point_colours, point_size=0.004, precision="float32", point_shading="flat"
        )
        self.line = draw.add_line_segments("/segment", np.zeros((1, 2, 3), np.float32), (35, 120, 60), thickness=0.006)
        self.label = draw.add_label("/number", "")
        robot = np.concatenate([p.pose[:3, 3][None] for p in scene.parts])
        middle = robot.mean(axis=0)
        reach = max(float(np.linalg.norm(robot - middle, axis=1).max()), 0.3)
        middle = middle + 0.5 * reach * np.array([0.85, 0.53, 0])  # the panel covers the right
        self.server.initial_camera.position = tuple(middle + reach * np.array([1.5, -2.4, 1.4]))
        self.server.initial_camera.look_at = tuple(middle)

    def _balls(self, visible):
        """The inner spheres, one handle per part; none for a robot of triangles."""
        from .pictures import _ball

        for ball in self.balls:
            ball.remove()
        corners = _ball(0).reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3)
        self.balls = []
        for k in range(len(self.robot)):
            spheres = np.asarray(self.robot.spheres(k))
            if len(spheres):
                self.balls.append(
                    self.server.scene.add_batched_meshes_simple(
                        f"/robot/{k}/spheres",
                        corners,
                        faces,
                        np.tile((1.0, 0, 0, 0), (len(spheres), 1)),
                        spheres[:, :3],
                        batched_scales=spheres[:, 3],
                        batched_colors=colours.SPHERE,
                        lod="off",
                        cast_shadow=False,
                        visible=visible,
                    )
                )

    def _controls(self, viser):
        gui = self.server.gui
        self.words = gui.add_html("")
        self.sliders = []
        if self.fixed is None:
            for name, value, (low, high) in zip(self.robot.joints, self.values, self.robot.limits):
                low, high = (low if math.isfinite(low) else -math.pi), (high if math.isfinite(high) else math.pi)
                slider = gui.add_slider(
                    name,
                    min=float(min(low, value)),
                    max=float(max(high, value)),
                    step=0.001,
                    initial_value=float(value),
                )
                slider.on_update(self._moved)
                self.sliders.append(slider)
            self.swing = gui.add_checkbox("swing", False, hint="moves the joints to and fro")
            self.swing.on_update(self._moved)
        self.margin_slider = gui.add_slider(
            "margin", min=0.0, max=0.5, step=0.001, initial_value=float(min(max(self.margin, 0), 0.5))
        )
        self.margin_slider.on_update(self._moved)
        if self.remake is not None:
            self.model = gui.add_dropdown("model", ("triangles", "spheres"), initial_value=self.robot.model)
            self.model.on_update(self._remodel)
        self.show = gui.add_checkbox(
            "inner spheres", bool(self.balls) and self.balls[0].visible, disabled=not self.balls
        )
        self.show.on_update(self._visible)
        nothing = np.array([0.0, 1.0]), *[np.full(2, np.nan)] * 4
        self.plot = gui.add_uplot(
            nothing,
            (
                {},
                {"label": "upper", "stroke": "#8fb6dd", "width": 1},
                {"label": "lower", "stroke": "#8fb6dd", "width": 1},
                {"label": "distance", "stroke": "#1f4f8b", "width": 2},
                {"label": "margin", "stroke": "#be141e", "width": 1},
            ),
            bands=({"series": (1, 2), "fill": "rgba(143,182,221,0.6)"},),
            scales={"x": {"time": False}, "y": {"auto": True}},
            axes=({"label": "s"}, {"label": "m"}),
            legend={"show": False},
            height=200,
        )

    def _visible(self, _):
        for ball in self.balls:
            ball.visible = self.show.value

    def _moved(self, _):
        with self.wake:
            self.asked += 1
            self.wake.notify_all()

    def _remodel(self, _):
        """Another model of the same robot; the old one answers until it is there."""
        wanted = self.model.value
        if wanted == self.robot.model:
            return
        note = self.server.gui.add_markdown(f"making the {wanted} ... ")
        try:
            robot = self.remake(wanted)
            query = _core.Query(robot, _core.MinDistance(), device=self.device)
        except (ValueError, RuntimeError) as error:
            note.content = str(error)
            self.model.value = self.robot.model
            return
        note.remove()
        with self.lock:
            self.robot, self.query = robot, query
            self._balls(False)
            self.show.disabled, self.show.value = not self.balls, False
        self._moved(None)

    # What follows the sliders.

    def _wanted(self):
        """The joint values to answer for now."""
        if self.fixed is not None:
            return self.values
        values = np.array([slider.value for slider in self.sliders])
        if self.swing.value:
            limits = np.array([(slider.min, slider.max) for slider in self.sliders])
            turn = math.sin(0.8 * time.monotonic())
            values[0] = np.clip(values[0] + 0.5 * turn, *limits[0])
            values[-1] = np.clip(values[-1] + 0.3 * turn, *limits[-1])
        return values

    def _follow(self):
        """Answers whenever something changed; what came meanwhile is answered once."""
        answered = 0
        while True:
            with self.wake:
                while not self.ended and answered == self.asked and not (self.fixed is None and self.swing.value):
                    self.wake.wait(0.2)
                if self.ended:
                    return
                answered = self.asked
            begun = time.perf_counter()
            try:
                with self.lock:
                    self.values = self._wanted()
                    poses, result = self._answer(self.values)
                    middle = time.perf_counter()
                    self.took["ask"] = middle - begun
                    self._send(poses, result)
                    self.error = None
            except Exception as error:  # noqa: BLE001  the page says it: a number that stands still would be a lie
                self.error = str(error)
                said = f'style="{_STYLE}color:#be141e">{html.escape(self.error)}</div>'
                self.words.content = f'<div id="clearance-number" data-state="error" {said}'
                middle = time.perf_counter()
            now = time.perf_counter()
            self.took["send"] = now - middle
            self.changed = time.monotonic()
            self.updates += 1
            time.sleep(max(0.0, 1 / MOST_A_SECOND - (now - begun)))

    def _send(self, poses, result):
        """The number, the robot, the segment and the plot."""
        self.result, self.margin = result, self.margin_slider.value
        now = time.monotonic()
        self.rates.append(now)
        state = result.state.name
        any_pair = result.point is not None and result.part is not None
        with self.server.atomic():
            for frame, pose in zip(self.frames, poses):
                frame.wxyz, frame.position = quaternion(pose[:3, :3]), pose[:3, 3]
            self.line.visible = self.label.visible = any_pair
            if any_pair:
                segment = np.array([[result.nearest, result.at]], np.float32)
                self.line.points, self.line.colors = segment, np.array(colours.SEGMENT[state], np.uint8)
                self.label.position, self.label.text = segment[0].mean(axis=0), number(result)
            self.words.content = self._html(result)
            self.past.append((now, float(result.distance), float(result.lower), float(result.upper)))
            while self.past and self.past[0][0] < now - SECONDS:
                self.past.popleft()
            if now - self.plotted > 0.2:
                self.plotted = now
                self._plot(now)

    def _html(self, result):
        lately = [t for t in self.rates if t > self.rates[-1] - 1]
        coloured = (
            f"zones: {', '.join(f'{z:g}' for z in self.zones)} m"
            if self.zones
            else f"red 0 to blue {self.farthest:g} m"
        )
        rate = f"{len(lately)} updates/s; " if len(lately) > 2 else ""
        above = result.lower > self.margin
        colour = "#237840" if above else "#be141e"
        return (
            f'<div id="clearance-number" data-state="{result.state.name}" data-distance="{float(result.distance)!r}" '
            f'data-update="{self.updates}" style="{_STYLE}color:{colour}">{number(result)}</div>'
            f'<div style="padding:0 1em 0.5em">{html.escape(sentence(result, self.margin))}<br>'
            f"<small>{rate}asked in {1000 * self.took['ask']:.1f} ms; drawn: 1 point in {self.step}; "
            f"{coloured}; model: {self.robot.model}</small></div>"
        )

    def _plot(self, now):
        past = np.array(self.past)
        past[~np.isfinite(past)] = np.nan  # a gap
        self.plot.data = (past[:, 0] - now, past[:, 3], past[:, 2], past[:, 1], np.full(len(past), self.margin))

    def _colour(self):
        """New colours once nothing has changed for a moment, because they cost more than the answer."""
        of, settled = None, 0
        while not self.ended:
            time.sleep(0.05)
            if time.monotonic() - self.changed < AFTER:
                continue
            values, robot = self.values, self.robot
            if settled != self.updates:  # the last plot may be older than the last answer
                with self.lock:
                    settled = self.updates
                    self.rates.clear()
                    if self.error is None and self.past:
                        self._plot(self.past[-1][0])
                        self.words.content = self._html(self.result)
            if of is not None and of[0] is robot and np.array_equal(of[1], values):
                continue
            of = robot, values
            try:
                poses = self._poses(values)
                farthest = max(self.zones) if self.zones else self.farthest
                distance = np.asarray(
                    _core.Query(robot, _core.Distances(d_max=float(farthest)))(self.drawn, poses=poses).distance
                )
                paint = (
                    colours.by_zone(distance, sorted(self.zones))
                    if self.zones
                    else colours.by_distance(distance, farthest)
                )
            except Exception as error:  # noqa: BLE001  grey points mean "unknown", and the terminal says why
                print(f"clearance: the points get no colours: {error}", file=sys.stderr)
                paint = np.full(self.drawn.shape, colours.UNKNOWN, np.uint8)
            if np.array_equal(values, self.values):  # otherwise they are old already
                self.cloud.colors = paint
                self.coloured += 1

    def close(self):
        """Ends the page."""
        with self.wake:
            self.ended = True
            self.wake.notify_all()
        for thread in self.threads:
            thread.join(5)
        self.server.stop()


_STYLE = "font-size:2.2em;font-weight:bold;padding:0.2em 0.45em 0;"
