# SPDX-License-Identifier: BSD-3-Clause
"""A statement does one thing: no comma joins two. statements.py   Exit code 1, and a line for each that does.

It reads what clang-format leaves (`a < b` compares, `a<b>` is a template), so it needs no compiler. Declarations of several
names, arguments, members' initialisers and the headers of `for` have commas that join no statements.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("include", "src", "tools")

# Comments, literals and directives.
SILENT = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"|(?<!\w)\'(?:[^\'\\\n]|\\.)+\'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*',
    re.S | re.M)
# What stands before a statement and is none.
HEAD = re.compile(r"(?:(?:if|while|for|switch)(?: constexpr)?\s*\(\)|else\b|do\b|case\b[^:]*:(?!:)|default:|\w+:(?!:)|"
                  r"\[\[\w+\]\]|CLEARANCE_UNROLL\b|CLEARANCE_ROLLED\b|CLEARANCE_HD\b)\s*")
DECLARATION = re.compile(
    r"(?:template|using|typedef|struct|class|enum|union|friend|extern|static|constexpr|const|auto|inline|mutable|volatile|"
    r"unsigned|alignas|requires|concept|operator|namespace|explicit|virtual|__\w+__)\b|"
    r"(?:typename )?(?:::)?\w+(?:<>)?(?:::\w+(?:<>)?)*(?: const)?(?:[&*]+ ?| )[&*]*\w+|"
    r"[^,]* << ")  # Eigen lists coefficients so
OPENS = {"(": ")", "[": "]", "{": "}", "<": ">"}


def silenced(text):
    """The text with blanks for what says nothing to a compiler; every other character keeps its place."""
    def blank(m):
        blanks = re.sub(r"[^\n]", " ", m[0])
        return '"' + blanks[1:-1] + '"' if m[0][0] in "\"R'" else blanks
    return SILENT.sub(blank, text)


class Reader:
    """Finds statements with a comma outside of all brackets."""

    def __init__(self, text):
        self.text, self.at, self.found = silenced(text), 0, []
        self.read("")

    def opens(self, at):
        """Does a bracket open here? Of `<` only a template's: it has no blank before it."""
        before = self.text[max(0, at - 12):at]
        return self.text[at] in "([{" or (self.text[at] == "<" and re.search(r"(?:\btemplate |\w)$", before) and
                                          not before.endswith("operator"))

    def read(self, opened):
        """Reads until `opened` is closed, and judges the statements inside. Returns whether that was a block."""
        before = self.text[max(0, self.at - 200):max(0, self.at - 1)]
        is_block = opened == "{" and bool(re.search(r"(?:\)|\b(?:const|override|noexcept|final|mutable|else|do)) $", before))
        in_requires = bool(re.search(r"\brequires ?(?:\([^{}]*\))? $", before))
        statements, said = [], []  # characters with their places; of what is in brackets, only the brackets
        while self.at < len(self.text):
            at, c = self.at, self.text[self.at]
            self.at += 1
            if self.opens(at):
                was_block = self.read(c)
                said += [(c, at), (OPENS[c], self.at - 1)]
                if was_block and not re.match(r"\s*[,;).(]", self.text[self.at:self.at + 200]):
                    said = []  # a body or a compound statement has ended, and no lambda in an expression
            elif opened and c == OPENS[opened] and not (c == ">" and self.text[at - 1] == "-"):
                break
            elif c == ";":
                is_block = is_block or opened == "{"
                statements.append(said)
                said = []
            elif not c.isspace():
                said.append((c, at))
            elif said and said[-1][0] != " ":
                said.append((" ", at))
        if opened in ("{", "") and not in_requires:
            for statement in statements:
                self.judge(statement)
        return is_block

    def judge(self, statement):
        text, begin = "".join(c for c, _ in statement), 0
        while head := HEAD.match(text, begin):
            begin = head.end()
        if "," not in text[begin:]:
            return
        is_return = bool(re.match(r"return\b", text[begin:]))
        if is_return or not DECLARATION.match(text, begin):
            self.found.append((self.text.count("\n", 0, statement[begin][1]) + 1, is_return, text[begin:]))


def self_test():
    """Does the reader still find what it is for, and pass what is allowed?"""
    bad = ["int f() { return a = 1, b; }", "void f() { a = 1, b = 2; }", "void f() { if (x) a(), b(); }",
           "void f() { for (int i = 0, j = 0; i < j; ++i, --j) x[i] = 1, y[i] = 2; }", "auto g = [&] { p.x += 1, ++n; };",
           "void f() { CLEARANCE_UNROLL\n  for (int j = 0; j < 4; ++j) f[j] = 1, g[j] = 2; }"]
    good = ["int a = 1, b = 2;", "void f() { for (; i < n; ++i, ++j) g(a, b); }", "struct s { s() : a(1), b(2) {} };",
            "auto f() { return pair<int, float>{a, b}; }", "template <class A, class B>\nvoid f(A a, B b);",
            'void f() { s = "a, b";  // c, d\n}', "void f() { axes.row(0) << 1, 2, 3; }",
            "concept c = requires(T t) { t.a, t.b; };", "void f() { const auto [a, b] = g(); }"]
    return ([f"does not find: {code}" for code in bad if not Reader(code).found] +
            [f"finds: {code}" for code in good if Reader(code).found])


if __name__ == "__main__":
    faults = self_test()
    for file in sorted(file for folder in FOLDERS for file in (ROOT / folder).rglob("*")):
        if file.suffix in {".hpp", ".cuh", ".cpp", ".cu"}:
            faults += [f"{file.relative_to(ROOT)}:{line}: {text}" for line, _, text in Reader(file.read_text()).found]
    print("\n".join(faults) or "no statement has a comma")
    sys.exit(bool(faults))
