# SPDX-License-Identifier: BSD-3-Clause
"""with_eigen.py FOLDER: the headers below it that include <Eigen/Geometry>, themselves or by others; a list of CMake's."""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
includes = {str(path.relative_to(root)): re.findall(r"^#include <(.+)>", path.read_text(), re.MULTILINE)
            for path in root.rglob("*.hpp")}
found = {"Eigen/Geometry"}
while more := {name for name, of in includes.items() if name not in found and found.intersection(of)}:
    found |= more
print(";".join(sorted(found - {"Eigen/Geometry"})), end="")
