# SPDX-License-Identifier: BSD-3-Clause
"""bench/record FOLDER or FILE: what programs printed, into bench/records."""

import argparse
import datetime
import json
import pathlib
import re

import recorded
from recorded import Mistake

from . import table


def ran_in(folder):
    """Of the summary.txt that scripts/gpu-run left: {device or host: its machine}, the commit and the day; nothing without one."""
    if not (folder / "summary.txt").is_file():
        return {}, None, None
    lines = (folder / "summary.txt").read_text().splitlines()
    when = re.match(r"(\S+) \S+ UTC, commit (\S*)", lines[0])
    gpus = [", driver ".join(line.split(", ")[:2]) for line in lines[1:4] if line.startswith("NVIDIA")]
    cpus = [line for line in lines[1:4] if line.endswith(" processors")]
    if not when or not cpus:
        raise Mistake(f"{folder}/summary.txt is not what scripts/gpu-run writes")
    several = {2: "two ", 4: "four ", 8: "eight "}.get(len(gpus), "")
    return {"device": several + gpus[0] if gpus else None, "host": cpus[0]}, when[2], when[1]


def folder_of(head):
    """The folder of bench/records that the machine's name has."""
    folders = [f for f in sorted(recorded.records.iterdir()) if f.is_dir() and re.search(rf"\b{f.name}\b", head.lower())]
    if not folders:
        raise Mistake(f"no folder of bench/records is a word of '{head}': make one, such as bench/records/h200")
    return min(folders, key=lambda f: head.lower().index(f.name))


def how_it_was_run(older):
    """The sentences below the first line of a record of rows, if it has some."""
    paragraphs = older.read_text().split("\n\n") if older.is_file() else []
    return [paragraphs[1]] if len(paragraphs) > 2 and paragraphs[1].endswith(".") else []


def record(file, asked):
    """Writes the record of a file, and returns where it lies."""
    machines, commit, day = ran_in(file.parent)
    program, text = file.stem, file.read_text()
    if file.suffix == ".json":
        text = table.table(json.loads(text))
    if file.name == "demo.txt":
        program = "clearance demo"
        text = text.split("\n\n", 1)[1] if machines else text  # scripts/gpu-run's own head
    if file.suffix == ".json" or not recorded.says_where(text):
        machine = asked.machine or machines.get("device" if program.endswith(("_device", " demo")) else "host")
        commit, day = asked.commit or commit, asked.day or day or datetime.date.today().isoformat()
        if not machine or not commit:
            raise Mistake(f"{file} does not say on which machine and of which commit it was made: --machine, --commit")
        if not re.fullmatch("[0-9a-f]{7,40}", commit):
            raise Mistake(f"{file} is of '{commit}', which is no commit that somebody else has")
        text = f"# {program}; {machine}; commit {commit}; {day}\n\n{text}"
    if not recorded.says_where(text):
        raise Mistake(f"{file}: '{text.splitlines()[0]}' does not name a machine and a commit")
    name = re.sub("^bench_|_device$", "", file.stem)
    there = folder_of(text.splitlines()[0]) / f"{name.removeprefix('min_distance_')}.txt"
    if file.suffix == ".json":
        head, rows = text.split("\n\n", 1)
        text = "\n\n".join([head, *how_it_was_run(there), rows])
    there.write_text("\n".join(line.rstrip() for line in text.strip("\n").splitlines()) + "\n")
    return there


def main(arguments):
    asked = argparse.ArgumentParser(prog="bench/record", description=__doc__)
    asked.add_argument("--machine", help='such as "AMD EPYC (Zen 5), two cores", of a file that does not say it')
    asked.add_argument("--commit")
    asked.add_argument("--day", help="such as 2026-11-26; by default today")
    asked.add_argument("file", nargs="+", type=pathlib.Path)
    asked = asked.parse_args(arguments)
    files = []
    for file in asked.file:
        if not file.exists():
            raise Mistake(f"there is no {file}")
        found = [f for f in sorted(file.glob("bench_*.json")) + [file / "demo.txt"] if f.is_file()] if file.is_dir() else [file]
        if not found:
            raise Mistake(f"{file} has no bench_*.json and no demo.txt")
        files += found
    for file in files:
        print(record(file, asked).relative_to(recorded.root))
    print("Run scripts/quote-docs: pages quote these. What bench_paper_device wrote is recorded by bench/compare-with-paper.")
    return 0
