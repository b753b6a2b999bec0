# SPDX-License-Identifier: BSD-3-Clause
"""The figures that pages name, `<!--= triangles_over_spheres()-->1.3<!--/=-->`: what is computed of several recorded numbers.

A single number has no function here, but its key in the page: `<!--= {h200/latency.txt: new_pose, us .1f}-->`.
"""

from recorded import apt_for, apt_lines, goal, number, paper, spread


def apt_commands():
    """What to install on Debian 12, by the lists of scripts/lib.sh."""
    return apt_lines(library="the library alone", io="+ files: meshes, robots, ...", command="+ the command", all="+ tests, benchmarks")


def python_commands():
    """What a bare Debian 12 needs for the Python package, by scripts/lib.sh; then from a checkout to a picture."""
    return apt_for("python") + '\n    python3 -m venv venv && venv/bin/pip install ".[view]" && venv/bin/clearance view'


# One frame on an H200.


def _frame(row, points=307200):
    return number("h200/min_distance.txt", f"{row}/points:{points}", "us")


def triangles_over_spheres(form=".1f"):
    """How many times as long a warm frame takes with triangles in boxes as with inner spheres."""
    return format(_frame("triangles_warm<aabb>") / _frame("spheres_warm<sphere>"), form)


def demo_boxes(backend):
    """How many times as long `clearance demo` took with triangles in spheres as in axis-aligned boxes."""
    sphere, aabb = (number("h200/demo.txt", f"{backend} triangles {volume}", "-1") for volume in ("sphere", "aabb"))
    return format(sphere / aabb, ".1f")


# The goals for a frame: the measured value, after "missed" if the goal is not reached.


def goal_over_read(row, points, limit):
    """Microseconds over a kernel that only reads the points."""
    return goal(_frame(f"{row}_queued<sphere>", points) - _frame("read/queued", points), limit, ".1f", "+ ")


def goal_times_read(row, points, limit):
    """Times as long as a kernel that only reads the points."""
    return goal(_frame(f"{row}_queued<sphere>", points) / _frame("read/queued", points), limit, ".2f")


def goal_every_part(points):
    """Every part's minimum over one bound's time, warm."""
    return goal(_frame("every_part_warm<sphere>", points) / _frame("spheres_warm<sphere>", points), 1.3, ".2f")


def goal_copy():
    """5M points from pinned memory, over their copy alone."""
    given, alone = (number("h200/latency.txt", f"pinned_points/{what}/5000000", "us") for what in ("given", "copy_alone"))
    return goal(given / alone, 1.05, ".2f")


def goal_triangles():
    """Triangles over spheres, warm, with the launch."""
    return goal(_frame("triangles_warm<aabb>") / _frame("spheres_warm<sphere>"), 2, ".2f")


def goal_warp(row, how):
    """A way to ask NVIDIA Warp, over ours (`cold` or `warm`)."""
    return goal(number("h200/peers_warp.txt", row, "us") / _frame(f"triangles_{how}_queued<aabb>"), 4, ".1f", least=True)


# A deadline, several GPUs, and the rules that split nodes.


def piece(row, pieces):
    """Microseconds of one of so many pieces, without a deadline."""
    return format(number("h200/deadline.txt", f"{row}/deadline_us:0", "us") / pieces, ",.0f")


def devices_times(points):
    """How many times as long one GPU takes as two, warm, for points that stay."""
    one, two = (number("h200/devices.txt", f"stays/{which}_warm/{points}", "us") for which in ("one", "two"))
    return format(one / two, ".2f")


def second_gpu_us():
    """What the second GPU adds to 300k points."""
    one, two = (number("h200/devices.txt", f"stays/{which}_warm/307200", "us") for which in ("one", "two"))
    return format(two - one, ".1f")


def split_distances(primitives, rule):
    """Every point's distance on the CPU with trees split by a rule, over the surface-area cost."""
    by, area = (number("epyc/packing_trees.txt", f"{primitives}/distances/{which}") for which in (rule, "surface_area"))
    return format(by / area, ".2f")


# The paper's design space, for bench/paper/README.md. Without a scene a range is over all clouds that were measured.


def times(axis, over, under, scene=None, form="", under_axis=None):
    """How many times as long `over` takes as `under` (of another axis)."""
    return spread(paper().ratios(axis, over, under, scene, under_axis), form)


def over_1m(axis, over, under, under_axis=None):
    """The same for a million points at the table alone."""
    above, below = (paper().value(a, v, "table", 1000000) for a, v in ((axis, over), (under_axis or axis, under)))
    return format(above / below, ".0f")


def measured(axis, variant, scene=None, metric="us", scale=1, form=",.0f"):
    """A number itself."""
    return spread([scale * v for v in paper().values(axis, variant, scene, metric).values()], form)


def along(variant, scene, scale=1, form=",.0f", metric="us"):
    """A number along the run of the robot (axis motion)."""
    return spread([scale * v for v in paper().steps_of["motion", scene, metric][variant].values()], form)


def _table_and_room(axis, over, under=None, hows=("cold", "warm"), form=""):
    def us(variant, how, scene):
        return paper().value(axis, variant.format(how), scene, 307200)

    return spread([us(o, h, s) / us(under, h, s) if under else us(o, h, s) for h in hows for o in over for s in ("table", "room")], form)


def boxes_over_spheres():
    """Triangles in boxes over spheres in spheres, by ours."""
    return _table_and_room("volume", ("ours {}; triangles in aabb", "ours {}; triangles in obb"), "ours {}; spheres in spheres")


def layered_kernels(tree):
    """The paper's kernels on layered over wrapped trees."""
    return _table_and_room("fit", (f"the paper's; layered; {tree}",), f"the paper's; wrapped; {tree}", ("",))


def wide_over_narrow(method):
    """Width 8 over width 2, with leaves of 1 and of 4."""
    return spread(r for k in (1, 4) for r in paper().ratios("width", f"{method}; width 8 leaf {k}", f"{method}; width 2 leaf {k}"))


def layout_times(layout):
    """Points of a layout over packed floats, by ours."""
    return _table_and_room("layout", (layout + "; {}",), "float3; {}")


def layout_us(layout):
    """Microseconds with points of a layout, by ours."""
    return _table_and_room("layout", (layout + "; {}",), form=".0f")


def share_of_copy(memory):
    """Percent of the paper's time, points on the host, that is not its kernels'."""
    kernels = paper().ratios("transfer", "the paper's kernels", f"GPU the paper's, {memory}", under_axis="competitors")
    return spread((100 * (1 - r) for r in kernels), ".0f")


def octree_copies(scene):
    """Percent of the points that an octree leaves for the GPU."""
    copied = paper().values("competitors", "octree + GPU", scene, "copied_points")
    return spread((100 * left / points for (_, points), left in copied.items()), ".1f")
