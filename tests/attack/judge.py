# SPDX-License-Identifier: BSD-3-Clause
"""Is what the command did right? The verdicts are the columns of the table."""

import json
import math
import os
import re
import struct
import xml.etree.ElementTree
from dataclasses import dataclass

import expect
import execute
import packings
import ply
import scenes
from strict import Invalid, Unknown

FAULTS = ["crash", "hang", "memory", "message", "silent", "file"]
PASSES = ["refused", "same", "explained"]
LONGEST = 400
NO_ANSWER = "no answer"  # of an undamaged case that was refused


@dataclass
class Answer:
    state: str
    low: float
    high: float
    seen: int
    valid: int
    parts: list  # None where the answer does not name all
    zones: list = None  # of each part: how many points are in each of its zones
    innermost: int = None
    plan: list = None  # of `run --plan`: the lower end of each configuration to come

    def like(self, other):
        return (self.state, self.low, self.high) == (other.state, other.low, other.high)


def _once(pairs):
    if len({key for key, _ in pairs}) != len(pairs):
        raise ValueError("a key twice")
    return dict(pairs)


def _json_answer(text):
    top = json.loads(text, object_pairs_hook=_once)
    high = math.inf if top["upper"] is None else top["upper"]
    low = math.inf if top["state"] == "no_data" else -math.inf if top["lower"] is None else top["lower"]
    parts = [part["name"] for part in top["parts"]] if "parts" in top else None
    made = Answer(top["state"], low, high, top["points"]["seen"], top["points"]["valid"], parts)
    if "zones" in top:
        made.zones, made.innermost = [[zone["points"] for zone in part["zones"]] for part in top["parts"]], top["zones"]["innermost"]
    if "plan" in top:
        made.plan = [-math.inf if low is None else low for low in top["plan"]["lower"]]
    return made


def _plan_answers(text):
    """Of each configuration; the last line has the points."""
    *rows, last = text.splitlines()
    points = json.loads(last, object_pairs_hook=_once)["points"]
    return [_json_answer(json.dumps(dict(json.loads(row, object_pairs_hook=_once), points=points))) for row in rows]


def _text_answer(text, zones):
    state = re.search(r"^state     (collision|possible|free|no data)", text, re.M)[1].replace(" ", "_")
    bracket = re.search(r"certainly (\S+) to (\S+) m$", text, re.M)
    low, high = (float(bracket[1]), float(bracket[2])) if bracket else (math.inf, math.inf)
    seen = re.search(r"^points    (\d+) seen, (\d+) valid", text, re.M)
    within = re.search(r"^zones     the innermost is within (\S+) m$", text, re.M)
    first = [f"{float(z):g}" for z in zones.split(",")].index(within[1]) if within else None
    return Answer(state, low, high, int(seen[1]), int(seen[2]), None, innermost=first)


def answers(case, outcome):
    """What the command printed, or None for the commands that answer something else."""
    text = outcome.out.decode("utf-8")
    if case.command == "query":
        return [_json_answer(text) if ["--json", None] in case.options else _text_answer(text, _option(case, "--zones") or "")]
    if case.command == "plan":
        return None if ["--csv", None] in case.options else _plan_answers(text)
    if case.command == "run":
        return None if ["--csv", None] in case.options else [_json_answer(each) for each in text.splitlines()]
    if case.command == "pack" and ["--json", None] in case.options:
        return re.sub(r'"(seconds|cached|mesh)": [^\n]*', "", text)
    if case.command == "info" and ["--json", None] in case.options and any(name == "" for name, _ in case.options):
        return {part["name"]: (part["spheres"], part["radius_min"], part["radius_max"]) for part in json.loads(text)["parts"]}
    return None


def _bad_text(data, what, sentences=False):
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return f"{what} is not UTF-8"
    bad = re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", text)
    if bad:
        return f"{what} has the control character {ord(bad[0])}"
    for each in text.splitlines() if sentences else ():
        if len(each.removeprefix("clearance: ").removeprefix("note: ")) > LONGEST:
            return f"{what} has a sentence of {len(each)} characters"
    return None


def _shown(name):
    """As a message may show it: what controls a terminal, and what is no UTF-8, byte by byte."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f\udc80-\udcff]", lambda m: "".join(f"\\x{b:02x}" for b in m[0].encode("utf-8", "surrogateescape")), name)


def _message(case, outcome):
    """What is wrong with how the command speaks, or None."""
    bad = _bad_text(outcome.err, "stderr", sentences=True) or _bad_text(outcome.out, "stdout")
    if bad:
        return bad
    said = [each for each in outcome.err.decode().splitlines() if not each.startswith("note: ")]
    if outcome.code != 1:
        return f"stderr says {said[0][:80]!r} with exit code {outcome.code}" if said else None
    if len(said) != 1 or not said[0].startswith("clearance: "):
        return f"{len(said)} sentences for one error: {said[:2]!r}"
    named = list(case.files) + [name for name, value in case.options if name] + [value for _, value in case.options if value]
    first = said[0].removeprefix("clearance: ").split(": ")[0]
    quoted = first.strip("?") and (" " not in first or case.command == "run") and any(  # a file that a file names
        re.search(re.sub(r"\\\\x[0-9a-f]{2}|\\\?", ".{1,4}", re.escape(first)).encode(), data, re.DOTALL) for data in case.files.values())
    named += ['joint "'] if any(name in ("--joint", "--joints") for name, _ in case.options) else []
    if first != "the command line" and "--help says more" not in said[0] and not quoted and not any(_shown(name)[:30] in said[0] for name in named) and " --" not in said[0]:
        return f"names neither file nor option: {said[0][:120]!r}"
    return None


def _written(case, outcome):
    for name in outcome.changed:
        return f"the input {name} was changed"
    for name, data in outcome.written.items():
        if name not in case.outputs and case.command in ("query", "plan", "pack") and case.target != "options":
            return f"left {name} behind"
        if data is None or case.files.get(name) == data:
            if name in case.outputs and outcome.code in (0, 2, 3) and any(value == name for _, value in case.options):
                return f"exit code {outcome.code}, but {name} was not written"
            continue
        try:
            if name.endswith(".glb"):
                json.loads(scenes.split_glb(data)[0])
            elif name.endswith(".ply"):
                ply.read_cloud(data)
            elif name.endswith(".svg"):
                xml.etree.ElementTree.fromstring(data)
            elif os.path.splitext(name)[1] in packings.readers:
                packings.readers[os.path.splitext(name)[1]](data)
        except (Invalid, ValueError, struct.error, xml.etree.ElementTree.ParseError) as error:
            return f"{name} was half written: {error}"
        except Unknown:
            pass
    return None


def _option(case, wanted, default=None):
    return next((value for name, value in case.options if name == wanted), default)


def _zones(case, frame, answer):
    """Why the zones are not what the files mean, or None. Points that may be within count; how far that goes is known of triangles."""
    if answer.zones is None:
        return None
    thresholds = [float(word) for word in _option(case, "--zones").split(",")]
    least = int(_option(case, "--min-points", 1))
    full = [z for counts in answer.zones for z, count in enumerate(counts) if count >= least]
    if answer.innermost != min(full, default=None):
        return f"the innermost zone is {answer.innermost}, by its points {min(full, default=None)}"
    for counts, points in zip(answer.zones, frame.near):
        for threshold, count in zip(thresholds, counts):
            low = sum(b <= threshold - 1e-5 for _, b in points)
            high = sum(a <= threshold + 1e-3 for a, _ in points) if _option(case, "--model") == "triangles" else len(points)
            if not low <= count <= high:
                return f"{count} points within {threshold}, the files have {low} to {high}"
    return None


def _ahead(frame, answer, slack):
    if len(answer.plan or []) != len(frame.plan):
        return f"{len(answer.plan or [])} configurations to come, the files have {len(frame.plan)}"
    for low, wanted in zip(answer.plan or [], frame.plan):
        if low > wanted.high + slack:
            return f"a configuration to come at {low:.6g} or more, the files say {wanted.high:.6g}"
    return None


def _disagrees(case, wanted, found, outcome):
    """Why an answer is not what the files mean, or None."""
    if wanted is None or found is None or isinstance(found, str):
        return None
    if isinstance(wanted, dict):
        for name, spheres in wanted.items():
            count, low, high = found.get(name, (None, 0, 0)) if len(found) > 1 else next(iter(found.values()))
            if count != len(spheres):
                return f"{count} spheres of {name!r}, the file has {len(spheres)}"
            radii = [s[3] for s in spheres]
            if not (math.isclose(low, min(radii), rel_tol=1e-6, abs_tol=1e-37) and math.isclose(high, max(radii), rel_tol=1e-6)):
                return f"radii {low} to {high}, the file has {min(radii)} to {max(radii)}"
        return None if len(wanted) == len(found) else f"{len(found)} parts, the file has {len(wanted)}"
    if len(wanted) != len(found):
        return f"{len(found)} answers, {len(wanted)} frames"
    for frame, answer in zip(wanted, found):
        if answer.seen != frame.seen or answer.valid not in frame.valid:
            return f"{answer.seen} points, {answer.valid} valid; the files have {frame.seen}, {frame.valid.start} valid"
        if answer.parts is not None and len(answer.parts) != len(frame.parts):
            return f"{len(answer.parts)} parts, the file has {len(frame.parts)}"
        if answer.state == "no_data":
            if frame.valid.start > 0:
                return "no data, but there are valid points"
            continue
        slack = 2e-6 + 1e-6 * min(frame.high, 1e30)
        if case.believes and frame.high < 1e15 and (answer.low > frame.high + slack or answer.high < frame.low - slack):
            return f"bracket {answer.low:.6g} to {answer.high:.6g} ({answer.state}), the files say {frame.low:.6g} to {frame.high:.6g}"
        wrong = _zones(case, frame, answer) or _ahead(frame, answer, slack)
        if wrong:
            return wrong
    margin = _option(case, "--check")
    codes = [3 if a.state == "no_data" else 2 if a.innermost == 0 or margin is not None and not min([a.low, *(a.plan or [])]) > float(margin) else 0
             for a in found]
    return None if outcome.code == max(codes) else f"exit code {outcome.code}, the answers say {max(codes)}"


def judge(case, outcome, base, manners=False):
    """(verdict, one line). `base` are the answers to the undamaged case. With `manners`, what is answered does not count."""
    if b"Sanitizer" in outcome.err or b"runtime error:" in outcome.err:
        return "crash", "a sanitizer reports " + outcome.err.decode("latin-1").strip().splitlines()[0][:160]
    if outcome.hung:
        return "hang", "no end in time"
    if outcome.memory > execute.MEMORY:
        return "memory", f"{outcome.memory / 2**30:.1f} GiB"
    if outcome.code not in (0, 1, 2, 3):
        return "crash", f"exit code {outcome.code}: " + outcome.err.decode("latin-1").strip()[:160]
    wrong = _written(case, outcome)
    if wrong:
        return "file", wrong
    try:
        wanted, why = Unknown if manners else expect.expected(case), None
    except Invalid as error:
        wanted, why = Invalid, str(error)
    except (Unknown, RecursionError, OverflowError, MemoryError):
        wanted, why = Unknown, None
    message = _message(case, outcome)
    if outcome.code == 1:
        return ("message", message) if message else ("refused", "" if why or wanted is Unknown else "refused, though valid: " + outcome.err.decode("latin-1").strip()[:140])
    try:
        found = answers(case, outcome)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        return ("message", message) if message else ("silent", f"exit code {outcome.code}, but no answer can be read: {error!r}"[:160])
    if base == NO_ANSWER:
        same = False
    elif isinstance(found, list):
        same = len(found) == len(base) and all(a.like(b) for a, b in zip(found, base))
    else:
        same = found == base
    if wanted is Invalid and not same:
        said = str(found)[:110] if found is not None else f"exit code {outcome.code}"
        if found is not None or base == NO_ANSWER:
            return "silent", f"the file is damaged ({why[:100]}), the answer another: {said}"
    if wanted not in (Invalid, Unknown):
        disagrees = _disagrees(case, wanted, found, outcome)
        if disagrees:
            return "silent", disagrees
    if message:
        return "message", message
    return ("same" if same else "explained"), ""
