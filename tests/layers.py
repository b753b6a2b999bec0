# SPDX-License-Identifier: BSD-3-Clause
"""Checks the include graph, and that each header opens with a headline: layers.py include/clearance"""
import pathlib
import re
import sys

# Bottom to top. A folder ends in "/"; the longest entry that fits a header is its layer. Headers of one layer do not
# know one another, except inside a folder marked "*", where they may, as long as there is no cycle.
LAYERS = [
    ["ground/*"],
    ["point_source.hpp"],
    ["concepts/*"],
    ["concepts.hpp"],
    ["result.hpp"],
    ["primitive/", "volume/", "points/*", "visitor/"],
    ["backends/*"],
    ["bvh/*"],
    ["traversal/*"],
    ["solid/*"],
    ["packing/*"],
    ["robot/*"],
    ["frames/*"],
    ["scan/*"],
    ["cloud_tree/*"],
    ["minimum/*"],
    ["pairwise/*", "pointwise/*"],
    ["plan/*"],
    ["query/*"],
    ["questions/*"],  # one question a file
    ["*"],  # what a user includes besides: whatever lies beside this list at the top
    ["any/"],
    ["io/*", "mpi/*"],
    ["clearance.hpp"],
]
FORBIDDEN = {
    "cub/cub.cuh": "include the one cub header that is needed",
    "Eigen/Dense": "include Eigen/Core or Eigen/Geometry",
    "iostream": "the library never prints",
    **{name: "files are read and written in src/" for name in (
        "expat.h", "nlohmann/json.hpp", "yaml-cpp/yaml.h", "stb_image.h", "stb/stb_image.h", "liblzf/lzf.h", "xxhash.h")},
}

root = pathlib.Path(sys.argv[1])
headers = {str(p.relative_to(root)): p.read_text().splitlines() for p in sorted(root.rglob("*.[hc]*")) if
           p.suffix in {".hpp", ".cuh"}}
faults = []


def layer(name):
    best = None
    for rank, entries in enumerate(LAYERS):
        for entry in entries:
            plain = entry.rstrip("*")
            fits = name == plain or (plain.endswith("/") and name.startswith(plain)) or (not plain and "/" not in name)
            if fits and (best is None or len(plain) > len(best[1].rstrip("*"))):
                best = (rank, entry)
    return best


for entry in (entry for entries in LAYERS for entry in entries):
    plain = entry.rstrip("*")  # "" is the top itself
    if not any(name == plain or plain.endswith("/") and name.startswith(plain) for name in headers) and plain:
        faults.append(f"{sys.argv[0]}: LAYERS names {entry}, which no header is")

includes = {name: [] for name in headers}
for name, lines in headers.items():
    own = layer(name)
    if own is None:
        faults.append(f"{name}: its folder has no layer; add it to LAYERS in {sys.argv[0]}")
        continue
    if "SPDX-License-Identifier: BSD-3-Clause" not in lines[0] or "#pragma once" not in lines[:3]:
        faults.append(f"{name}: begins with its licence and #pragma once")
    if not lines[2].startswith("// "):
        faults.append(f"{name}: its third line begins a headline, `// ...`: what the file is for")
    for_nvcc = False  # between #if defined(__CUDACC__) and its #endif
    for line in lines:
        for_nvcc = line == "#if defined(__CUDACC__)" or (for_nvcc and line != "#endif")
        if m := re.match(r'\s*#\s*include\s*"', line):
            faults.append(f"{name}: {line.strip()}: write #include <clearance/...>")
        m = re.match(r"\s*#\s*include\s*<([^>]+)>", line)
        if not m:
            continue
        if m[1] in FORBIDDEN:
            faults.append(f"{name} may not include {m[1]}: {FORBIDDEN[m[1]]}")
        if not m[1].startswith("clearance/"):
            continue
        target = m[1].removeprefix("clearance/")
        if target not in headers:
            faults.append(f"{name} includes {target}, which does not exist")
            continue
        includes[name].append(target)
        if name.endswith(".hpp") and target.endswith(".cuh") and not for_nvcc:
            faults.append(f"{name} is for every compiler, and may not include {target}")
        other = layer(target)
        same_folder = other == own and own[1].endswith("*")
        if other is not None and other[0] >= own[0] and not same_folder:
            faults.append(f"{name} (layer {own[1]}) may not include {target} (layer {other[1]})")

done = set()


def walk(name, above):
    if name in above:
        faults.append("a cycle: " + " > ".join(above[above.index(name):] + [name]))
    elif name not in done:
        for target in includes[name]:
            walk(target, above + [name])
        done.add(name)


for name in headers:
    walk(name, [])
print("\n".join(faults) or f"{len(headers)} headers in layers")
sys.exit(1 if faults else 0)
