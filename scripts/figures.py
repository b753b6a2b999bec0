# SPDX-License-Identifier: BSD-3-Clause
"""The figures that pages name: `<!-- = gpu_us("spheres_warm<sphere>") -->19.3<!-- /= -->`.

One short function for each kind of number. The first argument, `of`, has what scripts/recorded.py reads recorded files with;
a page does not write it. Every function says which file it reads and in which unit the result is.
"""

import functools
import types

entries = {}


def figure(function):
    entries[function.__name__] = function
    return function


def named(phrases):
    """All figures, for pages whose recorded files `phrases` reads."""
    of = types.SimpleNamespace(**phrases)
    return {name: functools.partial(function, of) for name, function in entries.items()}


@figure
def apt_commands(of):
    """What to install on Debian 12, by the lists of scripts/lib.sh."""
    return of.apt_lines(library="the library alone", io="+ files: meshes, robots, ...", command="+ the command", all="+ tests, benchmarks")


@figure
def python_commands(of):
    """What a bare Debian 12 needs for the Python package, by scripts/lib.sh; then from a checkout to a picture."""
    return of.apt_for("python") + '\n    python3 -m venv venv && venv/bin/pip install ".[view]" && venv/bin/clearance view'


# One frame. bench_device.txt: an H200; min_distance.txt: CPU threads.


@figure
def gpu_us(of, row, points=307200):
    """Microseconds of a frame on the GPU."""
    return format(of.number("bench_device.txt", f"{row}/points:{points}"), ".1f")


@figure
def cpu_ms(of, row):
    """Milliseconds of a frame on one CPU thread."""
    return format(of.number("min_distance.txt", f"{row}/threads:1"), ".2f")


@figure
def triangles_over_spheres(of, form=".2f"):
    """How many times as long a warm frame takes on the GPU with triangles in boxes as with inner spheres."""
    return format(of.number("bench_device.txt", "triangles_warm<aabb>/points:307200") / of.number("bench_device.txt", "spheres_warm<sphere>/points:307200"), form)


@figure
def latency(of, row, which=0, form=".1f"):
    """Microseconds until the answer is on the host, of bench_latency.txt; `which` as of `number`."""
    return format(of.number("bench_latency.txt", row, which), form)


@figure
def demo_boxes(of, backend):
    """How many times as long `clearance demo` took with triangles in spheres as in axis-aligned boxes."""
    return format(of.number("demo.txt", f"{backend} triangles sphere", -1) / of.number("demo.txt", f"{backend} triangles aabb", -1), ".1f")


# The goals for a frame: the measured value, after "missed" if the goal is not reached.


@figure
def goal_over_read(of, row, points, limit):
    """Microseconds over a kernel that only reads the points."""
    took = of.number("bench_device.txt", f"{row}_queued<sphere>/points:{points}")
    return of.goal(took - of.number("bench_device.txt", f"read/queued/points:{points}"), limit, ".1f", "+ ")


@figure
def goal_times_read(of, row, points, limit):
    """Times as long as a kernel that only reads the points."""
    took = of.number("bench_device.txt", f"{row}_queued<sphere>/points:{points}")
    return of.goal(took / of.number("bench_device.txt", f"read/queued/points:{points}"), limit, ".2f")


@figure
def goal_every_part(of, points):
    """Every part's minimum over one bound's time, warm."""
    took = of.number("bench_device.txt", f"every_part_warm<sphere>/points:{points}")
    return of.goal(took / of.number("bench_device.txt", f"spheres_warm<sphere>/points:{points}"), 1.3, ".2f")


@figure
def goal_latency(of, row, limit, which=0, form=".1f"):
    """Microseconds of bench_latency.txt."""
    return of.goal(of.number("bench_latency.txt", row, which), limit, form)


@figure
def goal_copy(of):
    """5M points from pinned memory, over their copy alone."""
    return of.goal(of.number("bench_latency.txt", "pinned_points/given/5000000") / of.number("bench_latency.txt", "pinned_points/copy_alone/5000000"), 1.05, ".2f")


@figure
def goal_triangles(of):
    """Triangles over spheres, warm, with the launch."""
    return of.goal(of.number("bench_device.txt", "triangles_warm<aabb>/points:307200") / of.number("bench_device.txt", "spheres_warm<sphere>/points:307200"), 2, ".2f")


@figure
def goal_warp(of, row, how):
    """A way to ask NVIDIA Warp, over ours (`cold` or `warm`)."""
    ours = of.number("bench_device.txt", f"triangles_{how}_queued<aabb>/points:307200")
    return of.goal(of.number("peers-warp.txt", row) / ours, 4, ".1f", least=True)


@figure
def goal_paper(of, scene, points, limit):
    """The paper's kernels over ours, cold."""
    return of.goal(of.paper("headline", "the paper's over ours cold", scene, points, "ratio"), limit, ".1f", least=True)


# Peers.


@figure
def peer(of, row, which=0, form=".0f"):
    """Milliseconds of a peer on one CPU thread, of peers.txt."""
    return format(of.number("peers.txt", row, which), form)


@figure
def warp_us(of, row):
    """Microseconds of a way to ask NVIDIA Warp on the GPU."""
    return format(of.number("peers-warp.txt", row), ".0f")


@figure
def competitor_ms(of, variant, points, form=".1f"):
    """Milliseconds at the table, of the paper's competitors."""
    return format(0.001 * of.paper("competitors", variant, "table", points), form)


@figure
def competitor_us(of, variant, points):
    """Microseconds at the table, of the paper's competitors."""
    return format(of.paper("competitors", variant, "table", points), ".0f")


@figure
def capt(of, who, spheres, apart, which=0, form=".1f"):
    """1,000 configurations by ours or VAMP's CAPT: milliseconds, or the number after the word `which`; `apart` in mm."""
    return format(of.number("peers-capt.txt", f"{who}/spheres:{spheres}/margin_mm:0/apart_mm:{apart}/threads:1", which), form)


# A deadline: microseconds in deadline.txt without one, divided into pieces.


@figure
def piece(of, row, pieces, form=",.0f"):
    """What one of so many pieces takes, in microseconds (or, of 1000 times as many, in milliseconds)."""
    return format(of.number("deadline.txt", f"{row}/deadline_us:0") / pieces, form)


# Packing.


@figure
def packing_seconds(of, row, form):
    """Seconds of a row of packing.txt, whose times are milliseconds."""
    return format(of.number("packing.txt", row) / 1000, form)


@figure
def packing_fill(of, row):
    """The fill ratio of a row of packing.txt."""
    return format(of.number("packing.txt", row, "fill"), ".3f")


@figure
def tried_fill(of, *rows):
    """The fill ratio, or the range of several, of packing-tried.txt."""
    return of.spread((of.number("packing-tried.txt", row, 1) for row in rows), ".3f")


@figure
def tried_gap(of, *rows):
    """The largest gap in mm, or the range of several, of packing-tried.txt."""
    return of.spread((of.number("packing-tried.txt", row, 4) for row in rows), ".1f")


@figure
def openvdb(of, row, column, form):
    """A column of openvdb.txt: 0 CPU seconds, 3 times, 4 the certificate's seconds, 5 fill, 6 to 8 gaps in mm, 9 spheres that stick out."""
    return format(of.number("openvdb.txt", row, column), form)


@figure
def layered_over_wrapped(of):
    """How many times as many tests layered trees take as wrapped ones, over the widths."""
    def tests(fit, width):
        return sum(of.number("packing-trees.txt", f"surface_area/{fit}/width:{width}", column) for column in (0, 1))

    return of.spread(tests("layered", width) / tests("wrapped", width) for width in (2, 4, 8))


@figure
def gas_over_best(of):
    """Neural gas over the better of median and principal split, in time, over the widths."""
    def us(rule, width):
        return of.number("packing-splits.txt", f"{rule}/wrapped/width:{width}", 2)

    return of.spread(us("neural_gas", w) / min(us("median", w), us("principal", w)) for w in (2, 4, 8))


@figure
def split_at_width_8(of):
    """The surface-area cost over principal split, in time, at width 8."""
    at = "{}/wrapped/width:8".format
    return format(of.number("packing-splits.txt", at("surface_area"), 2) / of.number("packing-splits.txt", at("principal"), 2), ".2f")


@figure
def split_frame(of, primitives, rule):
    """A frame on the GPU with trees split by a rule, over the surface-area cost: cold and warm, table and room."""
    def us(how, which, scene):
        return of.paper("split", f"ours {how}; {primitives}, {which}", scene, 307200)

    return of.spread(us(h, rule, s) / us(h, "surface area", s) for h in ("cold", "warm") for s in ("table", "room"))


@figure
def split_distances(of, primitives, rule):
    """Every point's distance on the CPU with trees split by a rule, over the surface-area cost."""
    at = f"{primitives}/distances/{{}}".format
    return format(of.number("packing-splits.txt", at(rule)) / of.number("packing-splits.txt", at("surface_area")), ".2f")


# Several GPUs, bench_devices.txt, in microseconds; chunks, bench_chunked.txt.


@figure
def devices_us(of, row, form=",.0f"):
    """Microseconds of a row of bench_devices.txt."""
    return format(of.number("bench_devices.txt", row), form)


@figure
def devices_times(of, row, points):
    """How many times as long one GPU takes as two; `row` has {} where the number of GPUs stands."""
    one, two = (of.number("bench_devices.txt", f"{row.format(which)}/{points}") for which in ("one", "two"))
    return format(one / two, ".2f")


@figure
def goal_two_gpus(of):
    """10^9 points that stay, warm: how many times as fast two GPUs are."""
    return of.goal(of.number("bench_devices.txt", "stays/one_warm/1000000000") / of.number("bench_devices.txt", "stays/two_warm/1000000000"), 1.9, ".2f", least=True)


@figure
def goal_second_gpu(of):
    """What the second GPU adds to 300k points."""
    return of.goal(_second_gpu(of), 15, ".1f", "+ ")


@figure
def cold_over_warm(of, points, form=".1f"):
    """What a cold frame takes over a warm one on two GPUs, in microseconds."""
    return format(of.number("bench_devices.txt", f"stays/two_cold/{points}") - of.number("bench_devices.txt", f"stays/two_warm/{points}"), form)


def _floor(of):
    return of.number("bench_devices.txt", "stays/one_warm/307200")


def _second_gpu(of):
    return of.number("bench_devices.txt", "stays/two_warm/307200") - _floor(of)


def _million(of):
    """Microseconds for a million points that are read from a GPU's memory."""
    return (of.number("bench_devices.txt", "stays/one_warm/1000000000") - of.number("bench_devices.txt", "stays/one_warm/100000000")) / 900


@figure
def second_gpu_us(of):
    """l of the model: what one more GPU costs."""
    return format(_second_gpu(of), ".1f")


@figure
def million_us(of):
    """b of the model: a million points."""
    return format(_million(of), ".2f")


@figure
def million_tb(of):
    """The same as TB/s."""
    return format(12 / _million(of), ".1f")


@figure
def two_gpus_from(of):
    """Million points from which two GPUs are quicker than one."""
    return format(2 * _second_gpu(of) / _million(of), ".0f")


def _on(of, gpus, millions):
    return _floor(of) + (gpus - 1) * _second_gpu(of) + millions / gpus * _million(of)


@figure
def eight_gpus_us(of):
    """10^9 points on eight GPUs, by the model."""
    return format(_on(of, 8, 1000), ",.0f")


@figure
def eight_gpus_times(of):
    """The same, as times one GPU."""
    return format(of.number("bench_devices.txt", "stays/one_warm/1000000000") / _on(of, 8, 1000), ".1f")


@figure
def most_points_ms(of, gpus=1):
    """As many points as a call takes, by the model."""
    return format((4295 * _million(of) if gpus == 1 else _on(of, gpus, 4295)) / 1000, ".1f")


@figure
def best_gpus(of):
    """How many GPUs are best for 10^9 points, by the model."""
    return format((1000 * _million(of) / _second_gpu(of)) ** 0.5, ".0f")


@figure
def link_gb(of):
    """GB/s of a GPU's link, by copies of 10^8 points."""
    return format(1200000 / of.number("bench_devices.txt", "comes/pinned_copy_alone_one/100000000"), ".0f")


@figure
def link_over_memory(of):
    """10^8 points from pinned memory over the same that stay."""
    return format(of.number("bench_devices.txt", "comes/pinned_one/100000000") / of.number("bench_devices.txt", "stays/one_warm/100000000"), ".0f")


@figure
def arborx_ms(of):
    """133 million points on a GPU here."""
    return format(133 * _million(of) / 1000, ".1f")


@figure
def chunked_ms(of, row, points=4194304, file="bench_chunked.txt"):
    """Milliseconds for 10^8 points, in chunks of so many."""
    return format(of.number(file, f"{row}/100000000/{points}") / 1000, ".1f")


def _chunked(of, row):
    return of.number("bench_chunked.txt", f"{row}/100000000/4194304")


@figure
def chunked_goal(of, over, under, limit, form):
    """A row as percent of another, which should be so many at least."""
    return of.goal(100 * _chunked(of, over) / _chunked(of, under), limit, form, least=True)


@figure
def chunked_percent(of, over, under):
    """A row as percent of another."""
    return format(100 * _chunked(of, over) / _chunked(of, under), ".0f")


@figure
def chunked_gb(of, row):
    """GB/s of 1.2 GB."""
    return format(1.2e6 / _chunked(of, row), ".0f")


@figure
def link_million_us(of):
    """Microseconds for a million points over a GPU's link."""
    return format(_chunked(of, "copy_alone/pinned") / 100, ".0f")


@figure
def link_frame_millions(of):
    """Million points that a link brings in 33 ms."""
    return format(33e3 / _chunked(of, "copy_alone/pinned") * 100, ".0f")


@figure
def robots_per_copy(of):
    """Kernels over 10^8 points that take as long as their copy."""
    return format(_chunked(of, "copy_alone/pinned") / of.number("bench_devices.txt", "stays/one_warm/100000000"), ".0f")


# The paper's design space, for docs/gpu-runs/*/paper.md.


def _table_and_room(of, axis, over, under=None, hows=("cold", "warm"), form=""):
    def us(variant, how, scene):
        return of.paper(axis, variant.format(how), scene, 307200)

    return of.spread([us(o, h, s) / us(under, h, s) if under else us(o, h, s)
                      for h in hows for o in over for s in ("table", "room")], form)


@figure
def boxes_over_spheres(of):
    """Triangles in boxes over spheres in spheres, by ours."""
    return _table_and_room(of, "volume", ("ours {}; triangles in aabb", "ours {}; triangles in obb"), "ours {}; spheres in spheres")


@figure
def layered_kernels(of, tree):
    """The paper's kernels on layered over wrapped trees."""
    return _table_and_room(of, "fit", (f"the paper's; layered; {tree}",), f"the paper's; wrapped; {tree}", ("",))


@figure
def wide_over_narrow(of, method):
    """Width 8 over width 2, with leaves of 1 and of 4."""
    return of.spread(a / b for k in (1, 4) for a, b in of.clouds(("width", f"{method}; width 8 leaf {k}"), ("width", f"{method}; width 2 leaf {k}")))


@figure
def layout_times(of, layout):
    """Points of a layout over packed floats, by ours."""
    return _table_and_room(of, "layout", (layout + "; {}",), "float3; {}")


@figure
def layout_us(of, layout):
    """Microseconds with points of a layout, by ours."""
    return _table_and_room(of, "layout", (layout + "; {}",), form=".0f")


@figure
def share_of_copy(of, memory):
    """Percent of the paper's time, points on the host, that is not its kernels'."""
    pairs = of.clouds(("transfer", "the paper's kernels"), ("competitors", f"GPU the paper's, {memory}"))
    return of.spread((100 * (1 - a / b) for a, b in pairs), ".0f")


@figure
def paper_ms(of, axis, variant, scene, points, form):
    """Milliseconds of one cloud."""
    return format(0.001 * of.paper(axis, variant, scene, points), form)


@figure
def paper_us(of, axis, variant, scene, points):
    """Microseconds of one cloud."""
    return format(of.paper(axis, variant, scene, points), ".0f")


@figure
def over_1m(of, variant, axis, under):
    """A competitor over another variant, for a million points at the table."""
    return format(of.paper("competitors", variant, "table", 1000000) / of.paper(axis, under, "table", 1000000), ".0f")


@figure
def node_tests(of, variant, points=1000000, form=".0f"):
    """Node tests for a point at the table, all parts."""
    return format(of.paper("culling", variant, "table", points, "node_tests"), form)


@figure
def nobody_over_all(of):
    """A bound shared by nobody over one shared by all, in time, for a million points at the table."""
    return format(of.paper("sharing", "recursive; nobody", "table", 1000000) / of.paper("sharing", "recursive; all", "table", 1000000), ".0f")


@figure
def few_threads(of, scene):
    """A bound shared by a block over one shared by all, with as few threads as a GTX 780 holds."""
    return of.times("sharing", "recursive; block; few threads", "recursive; all; few threads", scene)


@figure
def both_over_kernels(of):
    """SIMD over points, then children, on one CPU thread over the paper's kernels."""
    return of.times("competitors", "CPU SIMD, both (1 thread)", "the paper's kernels", under_axis="transfer")


@figure
def octree_ms(of):
    """The CPU octree, made and asked."""
    return of.measured("competitors", "CPU octree construction and query", scale=1e-3, form=".0f")


@figure
def octree_over_kernels(of):
    """The same over the paper's kernels from pinned memory."""
    return of.times("competitors", "CPU octree construction and query", "GPU the paper's, pinned")


@figure
def octree_copies(of, scene):
    """Percent of the points that an octree leaves for the GPU."""
    pairs = of.clouds(("competitors", "octree + GPU", "copied_points"), "points", scene=scene)
    return of.spread((100 * a / b for a, b in pairs), ".1f")


@figure
def processors(of):
    """How many processors the CPU competitors had."""
    return format(of.paper("competitors", "CPU ours (all threads)", "table", 1000000, "threads"), ".0f")


@figure
def headline(of, scene, points):
    """The paper's kernels over ours, cold."""
    return format(of.paper("headline", "the paper's over ours cold", scene, points, "ratio"), ".1f")


@figure
def capt_without_thinning(of, who, spheres):
    """1,000 configurations by ours or CAPT, thinned to 2 cm: milliseconds without the thinning."""
    row = f"{who}/spheres:{spheres}/margin_mm:0/apart_mm:20/threads:1"
    return format(of.number("peers-capt.txt", row) - of.number("peers-capt.txt", row, "thin_ms"), ".1f")
