# SPDX-License-Identifier: BSD-3-Clause
"""The table of the paper's claims, for bench/paper/figures, which writes it, and scripts/quote-docs, which compares it."""

from recorded import factor, scenes, span, thousands


def claims(paper):
    """The numbers behind the paper's claims: a row for each claim, a column for each cloud, and the range over all clouds."""
    clouds = ()

    def number(value):
        return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"

    def digits(value):
        return f"{value:.0f}" if value >= 10 else f"{value:.1g}"

    def line(name, cell, width=16, last=""):
        def at(scene, points):
            try:
                return cell(lambda axis, variant, metric="us": paper.points_of[axis, scene, metric][variant][points])
            except KeyError:  # not measured: no OctoMap, say
                return "-"

        return f"{name:<48}" + "".join(f"{at(scene, points):>{width}}" for scene, points in clouds) + f"{last:>20}".rstrip() + "\n"

    def heading(width=16, last=""):
        titles = "".join(f"{scene + ' ' + thousands(points):>{width}}" for scene, points in clouds)
        return f"{'':<48}{titles}" + f"{last:>20}".rstrip() + "\n"

    def measured(*variants):
        """Whether a run has them: an older one does not have all."""
        return all((axis, s, "us") in paper.points_of and variant in paper.points_of[axis, s, "us"] for axis, variant in variants for s in scenes)

    def microseconds(name, axis, variant):
        if not measured((axis, variant)):
            return ""
        return line(name, lambda t: number(t(axis, variant)), 16, span(paper.values(axis, variant).values(), number))

    def times(name, axis, over, under, under_axis=None):
        if not measured((axis, over), (under_axis or axis, under)):
            return ""
        all_clouds = span(paper.ratios(axis, over, under, under_axis=under_axis), factor) + " x"
        return line(name, lambda t: factor(t(axis, over) / t(under_axis or axis, under)) + " x", 16, all_clouds)

    ours, papers = "GPU ours, ", "GPU the paper's, "
    cores = next(iter(paper.points_of["competitors", "table", "threads"].get("CPU ours (all threads)", {0: 16}).values()))
    clouds = (("table", 307200), ("table", 1000000), ("room", 307200), ("room", 5000000))
    rows = [
        heading(16, "all clouds"),
        "microseconds, points resident, CUDA events\n",
        microseconds("  the paper's kernels", "transfer", "the paper's kernels"),
        microseconds("  ours, cold", "transfer", "our kernel, cold"),
        microseconds("  ours, warm", "transfer", "our kernel, warm"),
        "microseconds, points on the host, until the answer is there, host clock\n",
        microseconds("  copying alone, pinned memory", "transfer", "copy from pinned memory"),
        microseconds("  the paper's, pinned", "competitors", papers + "pinned"),
        microseconds("  ours, pinned", "competitors", ours + "pinned"),
        microseconds("  the paper's, pageable", "competitors", papers + "pageable"),
        microseconds("  ours, pageable", "competitors", ours + "pageable"),
        microseconds("  octree, then GPU (octree given)", "competitors", "octree + GPU"),
        microseconds("  CPU octree, query", "competitors", "CPU octree query"),
        microseconds("  CPU octree, construction", "competitors", "CPU octree construction"),
        microseconds("  CPU octree, construction and query", "competitors", "CPU octree construction and query"),
        microseconds("  CPU, the paper's Algorithm 1, one thread", "competitors", "CPU Algorithm 1 (1 thread)"),
        microseconds("  CPU, the same, SIMD, eight points", "competitors", "CPU SIMD, eight points (1 thread)"),
        microseconds("  CPU, the same, SIMD, eight children", "competitors", "CPU SIMD, eight children (1 thread)"),
        microseconds("  CPU, the same, SIMD, points, then children", "competitors", "CPU SIMD, both (1 thread)"),
        microseconds("  CPU, ours, one thread", "competitors", "CPU ours (1 thread)"),
        microseconds(f"  CPU, SIMD, eight points, all {cores:.0f} processors", "competitors", "CPU SIMD, eight points (all threads)"),
        microseconds(f"  CPU, SIMD, eight children, all {cores:.0f}", "competitors", "CPU SIMD, eight children (all threads)"),
        microseconds(f"  CPU, SIMD, points, then children, all {cores:.0f}", "competitors", "CPU SIMD, both (all threads)"),
        microseconds(f"  CPU, ours, all {cores:.0f} processors", "competitors", "CPU ours (all threads)"),
        *([] if not measured(("competitors", "CPU SIMD, both (1 thread)")) else [
            "CPU over the paper's kernels, points resident: times as long\n",
            *(times("  " + name, "competitors", variant, "the paper's kernels", "transfer") for name, variant in (
                ("Algorithm 1 as compiled, one thread", "CPU Algorithm 1 (1 thread)"),
                ("SIMD, eight points, one thread", "CPU SIMD, eight points (1 thread)"),
                ("SIMD, points, then children, one thread", "CPU SIMD, both (1 thread)"),
                (f"SIMD, points, then children, all {cores:.0f}", "CPU SIMD, both (all threads)"),
                ("ours, one thread", "CPU ours (1 thread)"),
                (f"ours, all {cores:.0f} processors", "CPU ours (all threads)"))),
        ]),
        "the paper's kernels, one axis changed: times as long as its own choice\n",
        times("  stack instead of recursion", "traversal", "stack", "recursive"),
        times("  near child first instead of recursion", "traversal", "near first", "recursive"),
        times("  eight lanes per point instead of recursion", "traversal", "cooperative", "recursive"),
        times("  parts in sequence instead of streams", "schedule", "recursive; sequential", "recursive; streams"),
        times("  parts fused instead of streams", "schedule", "recursive; fused", "recursive; streams"),
        times("  a grid of parts x points instead of streams", "schedule", "recursive; grid", "recursive; streams"),
        times("  trees moved beforehand instead of points", "transform", "trees beforehand", "points into parts"),
        times("  volumes moved in the walk instead of points", "transform", "volumes in the walk", "points into parts"),
        times("  balls around parts first, then points", "transform", "survivors into parts", "points into parts"),
        times("  bound shared by a block instead of by all", "sharing", "recursive; block", "recursive; all"),
        times("  the same, as few threads as a GTX 780 holds", "sharing", "recursive; block; few threads", "recursive; all; few threads"),
        times("  bound shared by nobody instead of by all", "sharing", "recursive; nobody", "recursive; all"),
        times("  no cache preference instead of PreferL1", "cache", "recursive; no preference", "recursive; prefer L1"),
        times("  PreferShared instead of PreferL1", "cache", "recursive; prefer shared", "recursive; prefer L1"),
        times("  last witness as seed instead of none", "seed", "recursive streams; last witness", "recursive streams; none"),
    ]
    clouds = (("table", 102400), ("table", 1000000), ("room", 307200), ("room", 5000000))
    rows += ["\n" + heading(), "node tests per point, all parts (updates of the bound per point)\n"]
    for variant in ("recursive; sequential", "recursive; nobody", "recursive; block", "recursive; all", "recursive; all; sequential parts",
                    "recursive; all; fused parts", "recursive; all; grid of parts", "recursive; block; few threads", "recursive; all; few threads", "near first; nobody",
                    "near first; block", "near first; all", "near first; all; last witness"):
        if not paper.points_of["culling", "table", "node_tests"].get(variant):
            continue
        label = variant.replace("recursive; sequential", "recursive; on one CPU thread") if variant.endswith("sequential") else variant
        rows.append(line("  " + label.replace(";", ","),
                           lambda t: f"{number(t('culling', variant, 'node_tests'))} ({digits(t('culling', variant, 'updates'))})"))
    clouds = (("table", 307200), ("table", 5000000), ("room", 307200), ("room", 5000000))
    rows += ["\n" + heading(), "the paper's kernels, best width, over\n"]
    over = "the paper's over ours "
    for how in ("cold", "warm"):
        rows.append(line(f"  ours, {how}", lambda t: f"{t('headline', over + how, 'ratio'):.1f} x"))
    clouds = (("table", 307200), ("room", 307200))
    rows += ["\n" + heading(30), "microseconds: the paper's kernels | near first, fused, otherwise the same | ours cold | ours warm\n"]
    methods = ("the paper's; ", "near first fused; ", "ours cold; ", "ours warm; ")
    for axis in ("width", "volume", "fit", "split"):
        measured = paper.points_of[axis, "table", "us"]
        for variant in dict.fromkeys(v.split("; ", 1)[1] for v in measured):
            rows.append(line("  " + variant.replace(";", ","),
                               lambda t: " | ".join(number(t(axis, m + variant)) for m in methods if m + variant in measured), 30))
    rows.append("microseconds: ours cold | ours warm\n")
    for variant in paper.points_of["layout", "table", "bytes_a_point"]:
        rows.append(line(f"  points as {variant}", lambda t: " | ".join(number(t("layout", f"{variant}; {how}")) for how in ("cold", "warm")), 30))
    return paper.stamp + "\n\n" + "".join(rows)
