# SPDX-License-Identifier: BSD-3-Clause
"""Seeing a robot, a cloud and the shortest segment between them: a picture, a recording for rerun, a live page.

Everything draws the same plain description, scenes.Scene.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from .pictures import picture
from .pictures import picture as write_picture  # show has an argument of the name
from .scenes import Scene, least_of, scene

if TYPE_CHECKING:
    from .._core import _Array, Cloud, Robot

__all__ = ["Scene", "least_of", "picture", "scene", "show"]


def show(
    robot: Robot | Scene,
    points: _Array | Cloud | None = None,
    joints: _Array | Mapping[str, float] | None = None,
    *,
    rerun: str | os.PathLike[str] | None = None,
    picture: str | os.PathLike[str] | None = None,
    port: int = 8080,
    host: str = "127.0.0.1",
    wait: bool = True,
    remake: Callable[[str], Robot] | None = None,
    **what: Any,
) -> Any:
    """Shows a robot before what its sensor sees, with the shortest segment and its number.

    rerun="out.rrd" writes a recording for rerun, picture="out.png" a still picture; the file's path is returned (of
    both, a pair). Without either, a live page opens under http://localhost:PORT, with sliders for the joints and the
    margin: it stays until Ctrl-C (wait=True), or until close() of the Page that is returned (wait=False).

    points with cloud_pose, or depth with intrinsics and camera_pose; joints, or poses; base: as in a call of Query.
    result: an answer about this frame (for files; the page asks by itself). zones: thresholds in metres, drawn in
    colours. margin: metres. farthest: up to which distance points have colours, metres. most: how many points are
    drawn; the answer is about all.
    """
    written = []
    if rerun is not None or picture is not None:
        made = robot if isinstance(robot, Scene) else scene(robot, points, joints, **what)
        if rerun is not None:
            from .rerun_file import write

            written.append(write(rerun, [made]))
        if picture is not None:
            written.append(write_picture(made, output=picture))
        return written[0] if len(written) == 1 else tuple(written)
    from .page import Page

    if what.pop("result", None) is not None:
        raise ValueError("clearance: a live page asks by itself; result= is for rerun= and picture=")
    page = Page(robot, points, joints, port=port, host=host, remake=remake, **what)
    print(f"clearance: {page.url} (Ctrl-C ends it)")
    if not wait:
        return page
    try:
        while True:
            time.sleep(1)
    except KeyboardInterrupt:
        page.close()
    return None
