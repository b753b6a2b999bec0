#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What must not compile, by one compiler: must_not_compile.py ARGUMENTS SOURCE... -- COMPILER FLAG...

Passes when no SOURCE compiles and the compiler says the sentence after "// expected-error: " of each; with a line "// and no
other error" it must be all that g++ says. All are compiled together first, each in a namespace, because they share most of
their headers: an error that names the source and says its sentence is enough. The others are compiled alone.
"""

import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

mark = "// expected-error: "
alone = "// and no other error"


def run(command, folder, name, text):
    (folder / name).write_text(text)
    done = subprocess.run([*command, folder / name], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def errors(output, nvcc):
    """Each error with what instantiated it, which g++ and clang say beside it and nvcc after it."""
    if nvcc:
        return re.split(r"\n\s*\n", output)
    found, block = [], []
    for line in output.splitlines():
        block.append(line)
        if re.search(r": (error|note|warning): ", line):
            found.append("\n".join(block))
            block = []
    return found


def is_about(error, source, sentence):
    # One source's name may end as another's: distances_of_hidden_room_fail and min_distances_of_hidden_room_fail.
    return ": error: " in error and sentence in error and re.search(rf"(?<!\w){re.escape(source.name)}", error)


def together(texts):
    include = re.compile(r"^#include <.*>$", re.MULTILINE)
    lines = sorted({line for text in texts.values() for line in include.findall(text)})
    for source, text in texts.items():
        lines.append(f'namespace {source.stem} {{\n#line 1 "{source.name}"\n{include.sub("", text)}}}')
    return "\n".join(lines) + "\n"


def main():
    at = sys.argv.index("--")
    sources = [pathlib.Path(name) for name in sys.argv[2:at]]
    nvcc = "nvcc" in pathlib.Path(sys.argv[at + 1]).name
    command = sys.argv[at + 1 :] + pathlib.Path(sys.argv[1]).read_text().split()
    if nvcc:
        command += ["-Xcudafe", "--error_limit=10000"]  # by default it stops at 100
    texts, expected = {}, {}
    for source in sources:
        lines = source.read_text().splitlines()
        sentences = [line[len(mark) :] for line in lines if line.startswith(mark)]
        if len(sentences) != 1:
            sys.exit(f"{source.name} has no line '{mark}...'")
        expected[source] = sentences[0]
        # Without that line, so that it cannot be what is found in the output.
        texts[source] = "\n".join("" if line.startswith(mark) else line for line in lines) + "\n"

    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        said = [] if len(sources) == 1 else errors(run(command, folder, "together.cpp", together(texts))[1], nvcc)
        left = [
            source
            for source in sources
            if (alone in texts[source] and not nvcc) or not any(is_about(error, source, expected[source]) for error in said)
        ]

        def fault(source):
            status, output = run(command, folder, f"{source.stem}_alone.cpp", texts[source])
            if status == 0:
                return f"{source.name} compiles, and must not"
            if expected[source] not in output:
                return f"{source.name} fails without saying\n  {expected[source]}\nbut\n{output}"
            count = output.count("error: ")
            if alone in texts[source] and not nvcc and count != 1:
                return f"{source.name} fails with {count} errors, not one:\n{output}"
            return None

        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("CLEARANCE_JOBS", os.cpu_count()))) as pool:
            faults = [it for it in pool.map(fault, left) if it]
    print(f"{len(sources)} do not compile, {len(left)} of them alone: {' '.join(source.stem for source in left)}")
    sys.exit("\n".join(faults) if faults else None)


main()
