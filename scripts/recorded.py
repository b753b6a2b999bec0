# SPDX-License-Identifier: BSD-3-Clause
"""Reads bench/records, for the scripts that put its numbers into pages. Needs nothing but Python."""

import collections
import csv
import functools
import math
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
records = root / "bench/records"
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


def record(name):
    """A file of bench/records, such as h200/latency.txt."""
    if not (records / name).is_file():
        raise Mistake(f"there is no bench/records/{name}")
    return records / name


@functools.cache
def lines_of(name):
    return [" ".join(line.split()) for line in record(name).read_text().splitlines()]


numbers = re.compile(r"(?<=\s)-?\d[\d,]*(?:\.\d+)?")
microseconds = {"us": 1, "ms": 1e3, "s": 1e6}


def number(name, row, what="0"):
    """A number of the row that begins with `row`: as a time in the unit `what`, at that place, after that word, or in the column of
    that heading. Of a .csv a row is axis/scene/points/variant, and `what` its metric."""
    if name.endswith(".csv"):
        axis, scene, points, variant = row.split("/", 3)
        metric = "us" if what in microseconds else what
        return paper(name).value(axis, variant, scene, int(points), metric) / microseconds.get(what, 1)
    begins = " ".join(row.split()) + " "
    at = [k for k, line in enumerate(lines_of(name)) if line.startswith(begins)]
    if len(at) != 1:
        raise Mistake(f"bench/records/{name} has {len(at)} rows '{row}', not one")
    text = lines_of(name)[at[0]][len(begins) - 1 :]
    found = [float(n.replace(",", "")) for n in numbers.findall(text)]
    if re.fullmatch(r"-?\d+", what):
        return found[int(what)]
    if what in microseconds:
        unit = re.match(r" [\d.,]+ (us|ms|s)\b", text)
        if not unit:
            raise Mistake(f"bench/records/{name}: the row '{row}' begins with no time")
        return found[0] * microseconds[unit[1]] / microseconds[what]
    if text.count(f" {what} ") == 1:
        return float(numbers.search(text, text.index(f" {what} ") + len(what) + 1)[0].replace(",", ""))
    for heading in reversed(lines_of(name)[: at[0]]):
        if what in heading.split() and len(heading.split()) == len(found):
            return found[heading.split().index(what)]
    raise Mistake(f"bench/records/{name}: the row '{row}' has no '{what}'")


def commit_of(file):
    """The commit that the first lines of a record name."""
    found = set(re.findall(r"\bcommit ([0-9a-f]{7,40})\b", file.read_text().split("\n\n")[0]))
    if len(found) != 1:
        raise Mistake(f"the first lines of {file.name} name {len(found)} commits, not one")
    return found.pop()


def says_where(text):
    """Whether the first line of a record names a machine and a commit."""
    first = text.split("\n", 1)[0]
    return re.search("NVIDIA|AMD|Intel|ARM", first) and re.search(r"\bcommits? [0-9a-f]{7,40}\b", first)


def goal(value, limit, form, prefix="", least=False):
    """What was measured, and whether it is within its goal."""
    met = value >= limit if least else value <= limit
    return f"{'' if met else 'missed: '}{prefix}{value:{form}}"


key_of = re.compile(r"([\w./-]+): (?:(commit)|(.+), (?:(\S+) )?(,?\.\d+[fg])(?:, at (most|least) ([\d.]+))?)")


def key(text):
    """What a page gets for {h200/latency.txt: new_pose, us .1f}: a number of a record, in a unit and a format. `{..., at most 12}`
    says whether it is within a goal, `{h200/latency.txt: commit}` of which commit the record is."""
    parts = key_of.fullmatch(text)
    if not parts:
        raise Mistake("a key is {file: row, unit format} or {file: commit}")
    name, commit, row, what, form, side, limit = parts.groups()
    if commit:
        return commit_of(record(name))
    value = number(name, row, what or "0")
    return goal(value, float(limit), form, least=side == "least") if side else format(value, form)


@functools.cache
def paper(name="h200/paper.csv"):
    return Paper(record(name))


def spread(values, form=""):
    """The range of some values; without a format they are factors."""
    return span(list(values), lambda v: format(v, form) if form else factor(v))


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
