# SPDX-License-Identifier: BSD-3-Clause
"""What README.md promises a new user, for the scripts that hold it to its word."""

import re


class Missing(Exception):
    """README.md no longer shows something that a script looks for."""


def _found(pattern, text, what):
    match = re.search(pattern, text, re.MULTILINE)
    if not match:
        raise Missing(f"README.md no longer shows {what}")
    return match[1]


def _blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def apt_line(text):
    """The command that installs what the library alone needs."""
    return _found(r"^    (apt install .*?) +# the library alone$", text, "a line 'apt install ...    # the library alone'")


def install_command(text, prefix):
    """The command that installs the library, into a folder of the caller's."""
    command = _found(r"`(cmake -B build[^`]*? --prefix) \.\.\.`", text, "`cmake -B build ... --prefix ...`")
    return f"{command} {prefix}"


def python_commands(text):
    """The two commands that lead from a bare machine and a checkout to a number and a picture."""
    what = "the two commands of the Python package, 'apt install ...' and '... clearance view'"
    apt = _found(r"^    (apt install .* python3-venv .*)\n    python3 -m venv ", text, what)
    return apt, _found(r"^    (python3 -m venv .* && .*clearance view)$", text, what)


def quotation(text, path):
    """The block that is quoted from a file."""
    return _found(rf"^<!-- quote {re.escape(path)} -->\n```\w*\n((?:(?!```).*\n)*)```$", text, f"a quotation of {path}")


def printed(text):
    """What the program of examples/first.cpp prints, by lines."""
    block = _found(r"^It prints\n\n((?:    .*\n)+)", text, "'It prints' and what the program prints")
    return [line.strip() for line in block.splitlines()]


def cmake_lists(text, how):
    """The CMakeLists.txt that uses the library by find_package or by FetchContent."""
    for block in _blocks(text, "cmake"):
        if f"{how}(clearance" in block or f"{how}_Declare(clearance" in block:
            return block
    raise Missing(f"README.md no longer shows a CMakeLists.txt with {how}")


def without_device(text):
    return "".join(line for line in text.splitlines(keepends=True) if not line.startswith("device"))


def comparable(text):
    """What `clearance demo` prints on every machine, by lines: no times, no GPU."""
    text = re.sub(r"made in [\d.]+ s", "made in TIME s", re.sub(r"Device: .*", "Device: ANY", without_device(text)))
    return [re.sub(r" +[\d.]+$", " TIME", line) if line.startswith("host") else line for line in text.splitlines()]
