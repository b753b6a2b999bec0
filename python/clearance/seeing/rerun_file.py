# SPDX-License-Identifier: BSD-3-Clause
"""Scenes as a recording for rerun: one .rrd file with robot, points, segment, image, plots and a time line."""

import math

import numpy as np

from . import colours
from .scenes import least_of


def _rerun():
    try:
        import rerun
    except ImportError:
        raise ImportError("clearance: a .rrd file needs rerun: pip install clearance[rerun]") from None
    return rerun


class Recording:
    """Writes scenes into a .rrd file, one after the other. A context manager: what was added is kept in any case."""

    def __init__(self, file, name="clearance", timeline="frame"):
        self.rr = rr = _rerun()
        import rerun.blueprint as views

        self.timeline, self.added, self.colours = timeline, 0, {}
        self.stream = rr.RecordingStream(name)
        self.stream.save(
            str(file),
            default_blueprint=views.Blueprint(
                views.Horizontal(
                    views.Spatial3DView(origin="world", name="scene"),
                    views.Vertical(
                        views.TimeSeriesView(origin="clearance", name="clearance, m"),
                        views.TimeSeriesView(origin="points", name="points"),
                        views.Spatial2DView(origin="image", name="depth"),
                        views.TextLogView(origin="answer", name="answers"),
                    ),
                    column_shares=[3, 2],
                )
            ),
        )
        self.stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        # rerun draws no areas. A line that runs down and up at each moment is a band where moments are dense.
        self.stream.log(
            "clearance/bracket",
            rr.SeriesLines(
                colors=[(143, 182, 221, 150)],
                names=["bracket"],
                widths=[4],
                aggregation_policy=rr.components.AggregationPolicy.Off,
            ),
            static=True,
        )
        for line, colour, width in (
            ("lower", (143, 182, 221), 1.5),
            ("distance", (31, 79, 139), 2.5),
            ("upper", (143, 182, 221), 1.5),
            ("margin", colours.SEGMENT["collision"], 1.0),
        ):
            self.stream.log(
                f"clearance/{line}", rr.SeriesLines(colors=[colour], names=[line], widths=[width]), static=True
            )

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Ends the file."""
        self.stream.flush()
        self.stream.disconnect()

    def add(self, scene, *, stamp=None, frame=None):
        """One more moment: stamp, seconds since 1970 (or since any start); frame: its number, else one more."""
        rr, log = self.rr, self.stream.log
        self._time(stamp, frame)
        for part in scene.parts:
            at = f"world/robot/{rr.escape_entity_path_part(part.name)}"
            log(at, rr.Transform3D(translation=part.pose[:3, 3], mat3x3=part.pose[:3, :3]))
            known = self.colours.get(part.name)
            if known is None and len(part.spheres):
                log(
                    f"{at}/spheres",
                    rr.Points3D(part.spheres[:, :3], radii=part.spheres[:, 3], colors=[colours.SPHERE]),
                    static=True,
                )
            # The mesh is logged again only when its colour changes.
            if len(part.triangles) and known != part.colour:
                log(
                    f"{at}/mesh",
                    rr.Mesh3D(
                        vertex_positions=np.asarray(part.vertices, np.float32),
                        triangle_indices=part.triangles,
                        albedo_factor=part.colour,
                        vertex_normals=_normals(part),
                    ),
                )
            self.colours[part.name] = part.colour
        log("world/points", rr.Points3D(scene.points, colors=scene.point_colours, radii=0.004))
        if scene.segment is not None:
            log(
                "world/segment",
                rr.LineStrips3D(
                    [scene.segment], colors=[scene.segment_colour], radii=0.004, labels=[scene.label], show_labels=True
                ),
            )
        else:
            log("world/segment", rr.Clear(recursive=False))
        if scene.image is not None:
            self._image(scene.image)
        self._numbers(scene)

    def add_unknown(self, sentence, *, stamp=None, frame=None):
        """A moment of which nothing is known: a gap in the plots, nothing in the scene, and the sentence."""
        rr = self.rr
        self._time(stamp, frame)
        for gone in ("world/points", "world/segment", "image/depth"):
            self.stream.log(gone, rr.Clear(recursive=False))
        self._bracket(math.nan, math.nan, math.nan)
        self.stream.log("answer", rr.TextLog(sentence, level=rr.TextLogLevel.WARN))

    def _time(self, stamp, frame):
        self.stream.set_time(self.timeline, sequence=self.added if frame is None else frame)
        if stamp is not None and math.isfinite(stamp):
            if stamp > 1e8:
                self.stream.set_time("time", timestamp=float(stamp))
            else:
                self.stream.set_time("time", duration=float(stamp))
        self.added += 1

    def _bracket(self, distance, lower, upper):
        # rerun draws no infinity: a gap, and the sentence says it.
        distance, lower, upper = (v if math.isfinite(v) else math.nan for v in (distance, lower, upper))
        for name, value in (("distance", distance), ("lower", lower), ("upper", upper)):
            self.stream.log(f"clearance/{name}", self.rr.Scalars(value))
        for value in (lower, upper, lower):
            self.stream.log("clearance/bracket", self.rr.Scalars(value))

    def _image(self, image):
        rr = self.rr
        rows, columns = image.depth.shape
        self.stream.log("world/camera", rr.Transform3D(translation=image.pose[:3, 3], mat3x3=image.pose[:3, :3]))
        if image.intrinsics is not None:
            fx, fy, cx, cy = image.intrinsics
            self.stream.log(
                "world/camera/lens",
                rr.Pinhole(
                    image_from_camera=[(fx, 0, cx), (0, fy, cy), (0, 0, 1)],
                    resolution=[columns, rows],
                    image_plane_distance=0.15,
                ),
            )
        self.stream.log("image/depth", rr.DepthImage(image.depth, meter=1 / image.scale))

    def _numbers(self, scene):
        rr, log, least = self.rr, self.stream.log, least_of(scene.result)
        self._bracket(*(float(getattr(least, name)) for name in ("distance", "lower", "upper")))
        if scene.margin is not None:
            log("clearance/margin", rr.Scalars(scene.margin))
        log("points/valid", rr.Scalars(least.valid))
        for reason, count in least.dropped.items():
            log(f"points/{reason}", rr.Scalars(count))
        level = rr.TextLogLevel.INFO if least.state.name == "free" else rr.TextLogLevel.WARN
        log("answer", rr.TextLog(scene.title, level=level))


def _normals(part):
    """Of the vertices: the mean of their triangles', by area."""
    corners = np.asarray(part.vertices, float)[np.asarray(part.triangles, int)]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out = np.zeros((len(part.vertices), 3))
    for k in range(3):
        np.add.at(out, part.triangles[:, k], faces)
    return (out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-30)).astype(np.float32)


def write(file, scenes, stamps=None):
    """Writes scenes (any iterable) into a .rrd file; returns its path."""
    with Recording(file) as recording:
        for k, scene in enumerate(scenes):
            recording.add(scene, stamp=None if stamps is None else stamps[k])
    return str(file)
