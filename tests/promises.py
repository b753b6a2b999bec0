# SPDX-License-Identifier: BSD-3-Clause
"""Does every promise of docs/promises.md name a test that exists? Exit code 1, and a line for each that does not.

Each row of a table that begins with "promise" must name, in its last column, `folder/x_test.cpp`: "the name of its case", or a script.
"""

import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
CASE = re.compile(r'TEST_CASE\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)')


def cases(file):
    """Names of the cases in a source; adjacent literals are one."""
    return {"".join(re.findall(r'"((?:[^"\\]|\\.)*)"', found)) for found in CASE.findall(file.read_text())}


def faults(page):
    found, rows, in_table = [], 0, False
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if not line.startswith("|"):
            in_table = False
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if cells[0] == "promise":
            in_table = True
            continue
        if not in_table or set(line) <= set("| -"):
            continue
        rows += 1
        held = cells[-1]
        named = re.findall(r'`([\w/]+_test\.cu|[\w/]+_test\.cpp)`: "([^"]+)"', held)
        scripts = re.findall(r"`((?:scripts|tests/\w+)/[\w-]+)`", held)
        rest = re.sub(r'`[\w/.-]+`(: "[^"]+")?|[;\s]', "", held)
        if len(cells) != 3 or not (named or scripts) or rest:
            found.append(f"{page.name}:{number}: a row needs a promise, a figure and tests, and has {held!r}")
        for name, case in named:
            source = root / "tests" / name
            if not source.exists():
                found.append(f"{page.name}:{number}: there is no tests/{name}")
            elif case not in cases(source):
                found.append(f'{page.name}:{number}: tests/{name} has no case "{case}"')
        found += [f"{page.name}:{number}: there is no {name}" for name in scripts if not (root / name).exists()]
    if not rows:
        found.append(f"{page.name}: has no promise")
    return found


if __name__ == "__main__":
    wrong = faults(root / "docs/promises.md")
    print("\n".join(wrong) if wrong else "every promise names tests that exist")
    sys.exit(bool(wrong))
