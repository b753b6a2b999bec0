# SPDX-License-Identifier: BSD-3-Clause
"""All mutants in one set of headers, each behind a switch that is read when a program starts (mutant schemata: Untch,
Offutt and Harrold, 1993). So a test is built once, and a mutant costs one run of it."""

import collections
import re
import sys

from sites import OPERATORS, OPPOSITE

NUMBER = re.compile(r"\bmutant<(\d+)>")


def room(mutant):
    """How far the expression that a mutant changes reaches at least: as [begin, end)."""
    end = mutant.at + len(mutant.was)
    if mutant.was in OPERATORS:
        return mutant.at - 1, end + 1
    return mutant.at, end + (mutant.was in OPPOSITE or mutant.was == "!")  # a call's bracket, an operand


def expressions(folder, mutants):
    """The smallest expression around each mutant's place, as [begin, end) of its header's text. Some have none."""
    if not mutants:
        return {}
    sys.path.append("/usr/lib/python3/dist-packages")  # where Debian's is, if this is another Python
    try:
        from clang import cindex
    except ImportError:
        sys.exit("tests/mutate/mutate needs clang's Python module: apt-get install python3-clang-19")
    by_file = collections.defaultdict(list)
    for mutant in mutants:
        by_file[str(folder / "clearance" / mutant.header)].append(mutant)
    source = "".join(f'#include "{path}"\n' for path in by_file)
    unit = cindex.Index.create().parse(
        "all.cpp", ["-std=c++20", "-I", str(folder), "-isystem", "/usr/include/eigen3"], [("all.cpp", source)])
    wrong = [d for d in unit.diagnostics if d.severity >= cindex.Diagnostic.Error]
    if wrong:
        raise RuntimeError(f"clang: {wrong[0]}")
    declarations = (cindex.CursorKind.VAR_DECL, cindex.CursorKind.FIELD_DECL)
    found = {}

    def visit(cursor, its=None):
        for child in cursor.get_children():
            begin, end = child.extent.start, child.extent.end
            here = begin.file.name if begin.file else None
            if here is None or end.file is None or end.file.name != here:
                continue
            at_most = by_file.get(here, []) if its is None else its  # None: at the top
            inside = [m for m in at_most if begin.offset <= m.at < end.offset]
            if not inside:
                continue
            if cursor.kind in declarations and inside[0].before[: begin.offset].rstrip().endswith("["):
                continue  # an array's bound: with a switch g++ would take it for one that is known when it runs
            if child.kind.is_expression():
                for m in inside:
                    first, last = room(m)
                    had = found.get(m, (0, sys.maxsize))
                    if begin.offset <= first and last <= end.offset and end.offset - begin.offset <= had[1] - had[0]:
                        found[m] = begin.offset, end.offset
            visit(child, inside)

    visit(unit.cursor)
    return found


def switched(text, places):
    """The header's text in which each mutant of `places` {number: (mutant, begin, end)} has a switch."""
    spans = collections.defaultdict(list)
    for number, (mutant, begin, end) in places.items():
        spans[begin, end].append((number, mutant))

    def between(begin, end, outer):
        """That piece of text, with switches at all places inside, but for the place that is the piece itself."""
        out, at = "", begin
        for (b, e), its in sorted(spans.items(), key=lambda item: (item[0][0], -item[0][1])):
            if b < at or e > end or (b, e) == outer:
                continue  # the larger one has it already
            arms = "".join(f"mutant<{n}>() ? ({changed(m, b, e)}) : " for n, m in its)
            out += f"{text[at:b]}({arms}({between(b, e, (b, e))}))"
            at = e
        return out + text[at:end]

    def changed(mutant, begin, end):
        """Only one mutant is ever on, so that the others inside need no switch here."""
        rest = text[mutant.at + len(mutant.was) : end]
        if mutant.was == "!":
            return f"bool({rest})"
        return text[begin : mutant.at] + mutant.now + rest

    return between(0, len(text), None)


class Overlay:
    """Changed headers in a folder, and which mutants they have. It makes new ones without those that do not compile."""

    def __init__(self, folder, work, numbers):
        self.folder, self.work, self.version = folder, work, 0
        found = expressions(folder, [m for m in numbers if not m.compiled])  # others are built one at a time
        self.places = {numbers[m]: (m, *found[m]) for m in numbers if m in found}
        self.write()

    def write(self):
        self.version += 1
        at = self.work / f"headers-{self.version}"
        by_header = collections.defaultdict(dict)
        for number, place in self.places.items():
            by_header[place[0].header][number] = place
        for header, places in by_header.items():
            path = at / "clearance" / header
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(switched((self.folder / "clearance" / header).read_text(), places))
        self.at = at

    def has(self, number):
        return number in self.places

    def without(self, words):
        """Takes out those that a compiler names, in its words or in the lines that it shows. False if it names none."""
        blamed = {int(number) for number in NUMBER.findall(words)}
        there = blamed & self.places.keys()
        for number in there:
            del self.places[number]
        if there:
            self.write()
        return bool(blamed)
