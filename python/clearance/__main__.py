# SPDX-License-Identifier: BSD-3-Clause
"""The command `clearance`: what Python adds. Each file in commands/ is a subcommand: its docstring, add(parser), run(asked).

One that has HANDS_ON = True gets the words that it does not know as asked.others, and -h as asked.help.
"""

import argparse
import importlib
import os
import pathlib
import pkgutil
import re
import shutil
import sys

from . import __version__, commands


def compiled_command():
    """The compiled command of the same name, if another one is on the PATH."""
    here = pathlib.Path(sys.argv[0]).resolve()
    for folder in os.environ.get("PATH", "").split(os.pathsep):
        found = shutil.which("clearance", path=folder)
        if found and pathlib.Path(found).resolve() != here and not _of_python(found):
            return found
    return None


def _of_python(file):
    """Whether it is this command, as pip installed it elsewhere: the two would call one another for ever."""
    with open(file, "rb") as script:
        head = script.read(1000)
    return head.startswith(b"#!") and b"clearance.__main__" in head


def joined(words):
    """`--option -0.5,1` as one word: argparse would take such a value for an option."""
    out = []
    for word in words:
        if out and re.fullmatch(r"--[\w-]+", out[-1]) and re.match(r"-[\d.]", word):
            out[-1] += f"={word}"
        else:
            out.append(word)
    return out


def check_once(parser, words):
    """Refuses an option with one value that is given twice: the last would win, in silence."""
    for action in parser._actions:
        if action.option_strings and action.nargs is None and isinstance(action, argparse._StoreAction):
            given = [word.partition("=")[0] for word in words if word.partition("=")[0] in action.option_strings]
            if len(given) > 1:
                parser.error(f"{given[0]} is given {len(given)} times, and it has one value")


def main(arguments=None):
    arguments = sys.argv[1:] if arguments is None else arguments
    known = {m.name.replace("_", "-"): m.name for m in pkgutil.iter_modules(commands.__path__)}
    if arguments and arguments[0] not in known and not arguments[0].startswith("-"):
        if found := compiled_command():
            os.execv(found, [found, *arguments])
        print(f"clearance: {arguments[0]} is no command of the Python package (it has: {', '.join(sorted(known))}); "
              "query, plan, pack, info and demo are of the compiled command, which is not on the PATH", file=sys.stderr)
        return 1
    parser = argparse.ArgumentParser(prog="clearance", description="How far a robot is from what its sensors see.")
    parser.add_argument("--version", action="version", version=f"clearance {__version__}")
    of = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    its = {}
    for name, module in sorted(known.items()):
        if arguments and arguments[0] not in (name, "-h", "--help"):
            continue
        each = importlib.import_module(f"{commands.__name__}.{module}")
        its[name] = of.add_parser(name, help=each.__doc__.strip().splitlines()[0], description=each.__doc__,
                                  allow_abbrev=False, add_help=not getattr(each, "HANDS_ON", False))
        each.add(its[name])
    asked, others = parser.parse_known_args(joined(arguments))
    check_once(its[asked.command], joined(arguments))
    if others and not getattr(importlib.import_module(f"{commands.__name__}.{known[asked.command]}"), "HANDS_ON", False):
        parser.error(f"unrecognized arguments: {' '.join(others)}")
    asked.others = others
    try:
        status = importlib.import_module(f"{commands.__name__}.{known[asked.command]}").run(asked) or 0
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # who read what is printed has gone, such as head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what Python flushes at its end
        return 141
    except (ValueError, RuntimeError, OSError, ImportError) as error:
        print(f"clearance {asked.command}: {str(error).removeprefix('clearance: ')}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
