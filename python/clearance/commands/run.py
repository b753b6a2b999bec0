# SPDX-License-Identifier: BSD-3-Clause
"""The least distance in every frame of a recording: the compiled command's `clearance run`, and one HTML page about it.

All words but these go to the compiled command, which must be on the PATH.
"""

import argparse
import os
import shlex
import subprocess
import sys

HANDS_ON = True


def add(parser):
    from clearance.commands import report

    parser.add_argument("--report", metavar="FILE.html", help="also write one page that needs nothing else")
    report.add_page(parser)
    parser.add_argument("-h", "--help", action="store_true", help="say this, and what the compiled command takes")
    parser.set_defaults(print_help=parser.print_help)


def as_pictures(words):
    """What pictures need of the words that clearance run was given."""
    from clearance.commands import report

    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    report.add_pictures(parser)
    parser.add_argument("--check", type=float, dest="margin")
    asked, _ = parser.parse_known_args(words)
    asked.model = asked.model or "spheres"
    return asked


def run(asked):
    from clearance.__main__ import compiled_command, joined
    from clearance.commands import report
    from clearance.seeing import report as pages

    found = compiled_command()
    if asked.help:
        asked.print_help()
        print(flush=True)
        if found:
            os.execv(found, [found, "run", "--help"])
        return 0
    if found is None:
        raise ValueError("the compiled command clearance, which answers, is not on the PATH")
    if asked.report is None:
        if asked.title is not None or asked.worst != 3:
            raise ValueError("--title and --worst are for --report")
        os.execv(found, [found, "run", *asked.others])
    report.check_page(asked)
    output = report.page_file(asked.report, "--report")
    lines = []
    with subprocess.Popen([found, "run", *asked.others], stdout=subprocess.PIPE, text=True) as child:
        for line in child.stdout:
            lines.append(line)
            sys.stdout.write(line)
            sys.stdout.flush()
    if not lines:
        return child.returncode or 1
    moments, notes = pages.rows_of("".join(lines), "what clearance run printed")
    if child.returncode not in (0, 2, 3):
        notes.append(f"clearance run failed after {len(moments)} frames")
    told = [("command", shlex.join(["clearance", "run", *asked.others]))]
    what = as_pictures(joined(asked.others))
    what.worst, what.title, what.rows = asked.worst, asked.title, ""
    try:
        pictures, said, about = report.pictures_of(what, moments)
    except (ValueError, RuntimeError, OSError) as error:
        pictures, said, about = {}, [f"no pictures: {str(error).removeprefix('clearance: ')}"], []
    report.write(
        output,
        moments,
        what,
        told=told + about,
        notes=notes + said,
        pictures=pictures,
        title="clearance run",
        to=sys.stderr,
    )
    return child.returncode if child.returncode >= 0 else 1
