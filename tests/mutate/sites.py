# SPDX-License-Identifier: BSD-3-Clause
"""Which places of a header, or of a source below src/, can be changed, and into what."""

import dataclasses
import functools
import os
import pathlib
import re
import subprocess

STRING = "\x01"  # stands for each character of a literal, so that what is beside one can be left alone
OPERATORS = {
    "<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
    "&&": ["||"], "||": ["&&"], "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["/"],
    "+=": ["-="], "-=": ["+="], "*=": ["/="], "&": ["|"], "|": ["&"], "<<": [">>"], ">>": ["<<"],
}  # fmt: skip
LITERAL = re.compile(
    r"""//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<!\w)'(?:\\.|[^'\\\n])+'""", re.S
)  # or comment
BINARY = re.compile(r"(?<=[\w)\]] )(" + "|".join(sorted(map(re.escape, OPERATORS), key=len, reverse=True)) + r")(?=\s)")
NOT = re.compile(r"!(?=[\w(])")
BOUND = re.compile(r"\b(?:(min|max)(?=\()|rounded_(down|up)(?=\())")
OPPOSITE = {"min": "max", "max": "min", "rounded_down": "rounded_up", "rounded_up": "rounded_down"}
WORD = re.compile(r"\b(true|false)\b")
INTEGER = re.compile(r"(?<![\w.'])(\d+)(?=[uU]?(?![\w.']))")
FLOAT = re.compile(r"(?<![\w.])((?:0x[\da-f.]+p[+-]?\d+|\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)f?)(?![\w.])")


def path_of(folder, header):
    """`folder`: include."""
    return folder.parent / header if header.startswith("src/") else folder / "clearance" / header


@dataclasses.dataclass(frozen=True)
class Mutant:
    folder: pathlib.Path = dataclasses.field(repr=False)
    header: str  # below include/clearance; or a source: src/...
    at: int
    was: str
    now: str

    @functools.cached_property
    def before(self):
        return path_of(self.folder, self.header).read_text()

    @property
    def compiled(self):
        """Is it in what src/ compiles once?"""
        return self.header.startswith("src/")

    @functools.cached_property
    def change(self):
        first = self.before.rfind("\n", 0, self.at) + 1
        line = self.before[first:].split("\n", 1)[0]
        column = self.at - first
        return (line[:column] + f"[{self.was} -> {self.now}]" + line[column + len(self.was):]).strip()

    @property
    def key(self):
        """Names it by its line's text, so that it is still found if lines above it change."""
        return f"{self.header}: {self.change}"

    def text(self):
        return self.before[: self.at] + self.now + self.before[self.at + len(self.was):]

    def __str__(self):
        line = self.before.count("\n", 0, self.at) + 1
        return f"{self.header}:{line}: {self.change}"


def blank(text, begin, end, by=" "):
    return text[:begin] + re.sub(r"[^\n]", by, text[begin:end]) + text[end:]


def end_of(text, begin, opening, closing):
    """The place behind the bracket that closes the one at `begin`."""
    depth = 0
    for k in range(begin, len(text)):
        depth += (text[k] == opening) - (text[k] == closing)
        if depth == 0:
            return k + 1
    return len(text)


def code_of(text):
    """The text with everything blank that is not to be changed: comments, literals, directives, static_assert, template
    heads, concepts, attributes, and what is thrown."""
    text = LITERAL.sub(lambda m: re.sub(r"[^\n]", " " if m[0][0] == "/" else STRING, m[0]), text)
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.M)
    for begin in [m.start() for m in re.finditer(r"\bstatic_assert\b", text)]:
        text = blank(text, begin, end_of(text, text.index("(", begin), "(", ")"))
    for begin in [m.start() for m in re.finditer(r"\btemplate <", text)]:
        text = blank(text, begin, end_of(text, text.index("<", begin), "<", ">"))
    for begin in [m.start() for m in re.finditer(r"\b(?:throw|concept|asm|namespace|using)\b", text)]:
        ends = [k for k in (text.find(";", begin), text.find("{", begin)) if k >= 0]
        text = blank(text, begin, min(ends, default=len(text)))
    for begin in [m.start() for m in re.finditer(r"\[\[", text)]:
        text = blank(text, begin, end_of(text, begin, "[", "]"))
    return text


def compiled_lines(folder, path):
    """Numbers of the lines that the host compiles: the preprocessor says."""
    command = [os.environ.get("CXX", "g++"), "-std=c++20", "-E", "-I", str(folder), "-isystem", "/usr/include/eigen3"]
    command += ["-I", str(folder.parent / "src"), "-x", "c++", str(path)]
    lines, number, here = set(), 0, False
    for line in subprocess.run(command, capture_output=True, check=True, text=True).stdout.splitlines():
        if marker := re.match(r'# (\d+) "(.*?)"', line):
            number, here = int(marker[1]), marker[2] == str(path)
        else:
            if here and line.strip():
                lines.add(number)
            number += 1
    return lines


def sites_of(folder, header):
    """Every mutant of a header, or of a source, in the order of the text."""
    path = path_of(folder, header)
    code, compiled = code_of(path.read_text()), compiled_lines(folder, path)
    found = []

    def add(at, was, *nows):
        beside = (code[:at].rstrip()[-1:], code[at + len(was):].lstrip()[:1])
        if STRING not in beside and code.count("\n", 0, at) + 1 in compiled:
            found.extend(Mutant(folder, header, at, was, now) for now in nows)

    for m in BINARY.finditer(code):
        add(m.start(), m[1], *OPERATORS[m[1]])
    for m in NOT.finditer(code):
        add(m.start(), "!", "")
    for m in BOUND.finditer(code):
        add(m.start(), m[0], OPPOSITE[m[0]])
    for m in WORD.finditer(code):
        add(m.start(), m[0], "false" if m[0] == "true" else "true")
    for m in FLOAT.finditer(code):
        add(m.start(), m[1], f"(2 * {m[1]})", f"({m[1]} / 2)") if float_of(m[1]) else add(m.start(), m[1], "1.0f")
    code = FLOAT.sub(lambda m: " " * len(m[0]), code)  # digits of an exponent are no constant of their own
    for m in INTEGER.finditer(code):
        add(m.start(), m[1], str(int(m[1]) + 1))
        if int(m[1]) > 0:
            add(m.start(), m[1], str(int(m[1]) - 1))
    return sorted(found, key=lambda mutant: (mutant.at, mutant.now))


def float_of(text):
    text = text.rstrip("f") if not text.startswith("0x") else text.removesuffix("f")
    return float.fromhex(text) if text.startswith("0x") else float(text)
