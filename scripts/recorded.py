# SPDX-License-Identifier: BSD-3-Clause
"""What was recorded, for the scripts that put its numbers into the documentation. Needs nothing but Python."""

import collections
import csv
import functools
import math
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
scenes = ("table", "room")


class Mistake(Exception):
    pass


def thousands(points):
    return f"{points / 1e6:g}M" if points >= 1e6 else f"{points / 1e3:.3g}k"


def factor(value):
    return f"{value:.2f}" if value < 9.995 else f"{value:.0f}"


def span(values, text):
    """The least and the largest of them, each by `text`."""
    low, high = text(min(values)), text(max(values))
    return low if low == high else f"{low} to {high}"


class Paper:
    """What bench_paper_device wrote: value[axis, scene, metric][variant][points], and [x] for what is no cloud's size."""

    columns = ("axis", "scene", "points", "x", "variant", "metric", "value")

    def __init__(self, file):
        try:
            text = file.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise Mistake(f"{file.name} cannot be read: {error}") from None
        lines = text.splitlines()
        heads = [line for line in lines if line.startswith("#")]
        self.stamp = "; ".join(line.lstrip("# ") for line in heads)
        if lines[: len(heads) + 1] != [*heads, ",".join(self.columns)] or "commit " not in self.stamp:
            raise Mistake(f"{file.name} is not what bench_paper_device writes: it begins with no stamp (GPU, driver, commit), or not with its columns")
        self.points_of = collections.defaultdict(lambda: collections.defaultdict(dict))
        self.steps_of = collections.defaultdict(lambda: collections.defaultdict(dict))
        seen = set()
        for at, r in enumerate(csv.reader(lines[len(heads) + 1 :]), len(heads) + 2):
            try:
                axis, scene, points, x, variant, metric, value = r
                points, x, value = int(points), float(x), float(value)
                what = axis, scene, metric, variant, points, x
                least = sys.float_info.min if metric.startswith("us") else 0  # no time is 0; a count may be
                if scene not in scenes or not (value >= least and math.isfinite(value) and math.isfinite(x)) or what in seen:
                    raise ValueError
            except ValueError:
                raise Mistake(f"{file.name}, line {at}: not a row of a measurement, or the second of the same") from None
            seen.add(what)
            self.points_of[axis, scene, metric][variant][points] = value
            self.steps_of[axis, scene, metric][variant][x] = value
        if not text.endswith("\n"):
            raise Mistake(f"{file.name} ends within a line")

    def require_figures(self):
        """Throws unless all that the figures are drawn from was measured."""
        for axis in ("traversal", "schedule", "transform", "sharing", "cache", "seed", "transfer", "competitors", "culling", "block size", "motion"):
            for scene in scenes:
                if (axis, scene, "node_tests" if axis == "culling" else "us") not in self.points_of:
                    raise Mistake(f"of {axis}, {scene}, nothing was measured")
        steps = {(variant, *sorted(self.steps_of["motion", scene, metric][variant])) for scene in scenes for metric in ("m", "us", "us_p10", "us_p90")
                 for variant in self.steps_of["motion", scene, metric]}
        if len({whole[1:] for whole in steps}) != 1:
            raise Mistake("the run of the robot (motion) was not measured to its end")

    def value(self, axis, variant, scene, points, metric="us"):
        try:
            return self.points_of[axis, scene, metric][variant][points]
        except KeyError:
            raise Mistake(f"{axis}, {variant}, {scene}, {points}, {metric} was not measured") from None

    def values(self, axis, variant, scene=None, metric="us"):
        """Of all clouds, or of all of one scene: {(scene, points): value}."""
        found = {(s, p): v for s in scenes if scene in (None, s)
                 for p, v in self.points_of.get((axis, s, metric), {}).get(variant, {}).items()}
        if not found:
            raise Mistake(f"{axis}, {variant}, {scene}, {metric} was not measured")
        return found

    def ratios(self, axis, over, under, scene=None, under_axis=None):
        above, below = self.values(axis, over, scene), self.values(under_axis or axis, under, scene)
        if above.keys() != below.keys():
            raise Mistake(f"{axis}: {over} and {under} were measured with different clouds")
        return [above[cloud] / below[cloud] for cloud in above]


def paper_claims(paper):
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
    claims = [
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
    claims += ["\n" + heading(), "node tests per point, all parts (updates of the bound per point)\n"]
    for variant in ("recursive; sequential", "recursive; nobody", "recursive; block", "recursive; all", "recursive; all; sequential parts",
                    "recursive; all; fused parts", "recursive; all; grid of parts", "recursive; block; few threads", "recursive; all; few threads", "near first; nobody",
                    "near first; block", "near first; all", "near first; all; last witness"):
        if not paper.points_of["culling", "table", "node_tests"].get(variant):
            continue
        label = variant.replace("recursive; sequential", "recursive; on one CPU thread") if variant.endswith("sequential") else variant
        claims.append(line("  " + label.replace(";", ","),
                           lambda t: f"{number(t('culling', variant, 'node_tests'))} ({digits(t('culling', variant, 'updates'))})"))
    clouds = (("table", 307200), ("table", 5000000), ("room", 307200), ("room", 5000000))
    claims += ["\n" + heading(), "the paper's kernels, best width, over\n"]
    over = "the paper's over ours "
    for how in ("cold", "warm"):
        claims.append(line(f"  ours, {how}", lambda t: f"{t('headline', over + how, 'ratio'):.1f} x"))
    clouds = (("table", 307200), ("room", 307200))
    claims += ["\n" + heading(30), "microseconds: the paper's kernels | near first, fused, otherwise the same | ours cold | ours warm\n"]
    methods = ("the paper's; ", "near first fused; ", "ours cold; ", "ours warm; ")
    for axis in ("width", "volume", "fit", "split"):
        measured = paper.points_of[axis, "table", "us"]
        for variant in dict.fromkeys(v.split("; ", 1)[1] for v in measured):
            claims.append(line("  " + variant.replace(";", ","),
                               lambda t: " | ".join(number(t(axis, m + variant)) for m in methods if m + variant in measured), 30))
    claims.append("microseconds: ours cold | ours warm\n")
    for variant in paper.points_of["layout", "table", "bytes_a_point"]:
        claims.append(line(f"  points as {variant}", lambda t: " | ".join(number(t("layout", f"{variant}; {how}")) for how in ("cold", "warm")), 30))
    return paper.stamp + "\n\n" + "".join(claims)


def newest(name, beside=None):
    """The file of this name in the newest run that has one; a page that lies beside one speaks of that."""
    if beside and (beside / name).exists():
        return beside / name
    found = sorted(root.glob(f"docs/*-runs/*/{name}"))
    if not found:
        raise Mistake(f"no run has recorded a {name}")
    return found[-1]


def number_in(file, row, which=0):
    """A number of the row that begins with `row`: the one at this place after it, or the first after the word `which`."""
    lines = [" ".join(line.split()) for line in file.read_text().splitlines()]
    begins = " ".join(row.split()) + " "
    rows = [line[len(begins) - 1 :] for line in lines if line.startswith(begins)]
    if len(rows) != 1:
        raise Mistake(f"{file.relative_to(root)} has {len(rows)} rows '{row}', not one")
    text = rows[0]
    if isinstance(which, str):
        if text.count(f" {which} ") != 1:
            raise Mistake(f"{file.name}: the row '{row}' does not say '{which}' once")
        text, which = text[text.index(f" {which} ") + len(which) + 1 :], 0
    numbers = re.findall(r"(?<=\s)-?\d[\d,]*(?:\.\d+)?", text)
    return float(numbers[which].replace(",", ""))


def commit_of(file):
    """The commit that the first lines of a recorded file name."""
    found = set(re.findall(r"\bcommit ([0-9a-f]{7,40})\b", file.read_text().split("\n\n")[0]))
    if len(found) != 1:
        raise Mistake(f"the first lines of {file.relative_to(root)} name {len(found)} commits, not one")
    return found.pop()


def packages(name):
    """A list of scripts/lib.sh, such as packages_test, with what it includes."""
    text = (root / "scripts/lib.sh").read_text().replace("\\\n", "")
    found = re.search(rf'^{name}="([^"]*)"', text, re.MULTILINE)
    if not found:
        raise Mistake(f"scripts/lib.sh has no list {name}")
    return [p for word in found[1].split() for p in (packages(word.strip("${}")) if word.startswith("$") else [word])]


def apt_lines(**titles):
    """A line for each named list of scripts/lib.sh: `apt install` of what the lists before it do not have, and its title."""
    lines, before = [], []
    for name, title in titles.items():
        names = packages("packages_" + name)
        lines.append(("    apt install " + " ".join(p for p in names if p not in before), title))
        before += names
    return "\n".join(f"{line:<75}    # {title}" for line, title in lines)


def apt_for(name):
    """`apt install` of a whole list of scripts/lib.sh."""
    return "    apt install " + " ".join(packages("packages_" + name))


@functools.cache
def phrases(folder):
    """What `<!-- = ... -->` in a page of this folder may use: each reads recorded files, and the result is put into the text."""
    paper = Paper(newest("paper.csv", folder))

    def number(name, row, which=0):
        return number_in(newest(name, folder), row, which)

    def commit(name):
        return commit_of(newest(name, folder))

    def spread(values, form=""):
        """The range of some values; without a format they are factors."""
        return span(list(values), lambda v: format(v, form) if form else factor(v))

    def times(axis, over, under, scene=None, form="", under_axis=None):
        """How many times as long `over` takes as `under` (of another axis): the range over all clouds that were measured."""
        return spread(paper.ratios(axis, over, under, scene, under_axis), form)

    def clouds(*keys, scene=None):
        """For each cloud that was measured the values of all keys: (axis, variant[, metric]), or "points"."""
        columns = [None if key == "points" else paper.values(key[0], key[1], scene, *key[2:]) for key in keys]
        first = next(column for column in columns if column is not None)
        if any(column is not None and column.keys() != first.keys() for column in columns):
            raise Mistake(f"{keys} were measured with different clouds")
        return [tuple(cloud[1] if column is None else column[cloud] for column in columns) for cloud in first]

    def measured(axis, variant, scene=None, metric="us", scale=1, form=",.0f"):
        return spread([scale * v for v in paper.values(axis, variant, scene, metric).values()], form)

    def along(variant, scene, scale=1, form=",.0f", metric="us"):
        """The range along the run of the robot (axis motion)."""
        return spread([scale * v for v in paper.steps_of["motion", scene, metric][variant].values()], form)

    def goal(value, limit, form, prefix="", least=False):
        """What was measured, and whether it is within its goal."""
        met = value >= limit if least else value <= limit
        return f"{'' if met else 'missed: '}{prefix}{value:{form}}"

    return {"number": number, "commit": commit, "paper": paper.value, "times": times, "measured": measured,
            "clouds": clouds, "along": along, "spread": spread, "goal": goal, "format": format, "apt_lines": apt_lines,
            "apt_for": apt_for, "min": min, "max": max}
