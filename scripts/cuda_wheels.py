#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""NVIDIA's CUDA compiler from PyPI: which wheels it takes, and what they lack.

  scripts/cuda_wheels.py                  print the requirement
  scripts/cuda_wheels.py complete FOLDER  complete the toolkit that they unpacked to FOLDER, such as .../nvidia/cu13
"""

import pathlib
import sys

requirement = "cuda-toolkit[nvcc,cudart,cccl]"
version = ">=13"


def complete(toolkit):
    """The wheels have no lib64, and no file that a linker finds as -lcudart; CMake looks for both."""
    toolkit = pathlib.Path(toolkit)
    links = {library.with_name(library.name.split(".so.")[0] + ".so"): library.name
             for library in (toolkit / "lib").glob("*.so.*")}
    for link, target in {**links, toolkit / "lib64": "lib"}.items():
        if not link.exists():
            link.symlink_to(target)


if __name__ == "__main__":
    if sys.argv[1:] == []:
        print(requirement)
    elif len(sys.argv) == 3 and sys.argv[1] == "complete":
        complete(sys.argv[2])
    else:
        sys.exit(__doc__)
