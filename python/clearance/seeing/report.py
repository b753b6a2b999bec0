# SPDX-License-Identifier: BSD-3-Clause
"""The rows of `clearance run` (JSON, CSV) or `clearance play` (CSV) as one HTML page that needs nothing else."""

import base64
import csv
import dataclasses
import html
import json
import math
import pathlib

from . import history
from .scenes import metres

STATES = ("free", "possible", "collision", "no_data", "unknown")
BLIND = ("no_data", "unknown")  # nothing is known then: lower 0, upper infinite


@dataclasses.dataclass
class Moment:
    """One row. Metres, seconds, microseconds; None: the row does not say it."""

    number: int
    state: str
    distance: float
    lower: float
    upper: float
    stamp: float = None
    file: str = None
    topic: str = None
    link: str = None
    point: int = None
    at: tuple = None
    nearest: tuple = None
    seen: int = None
    valid: int = None
    dropped: dict = None
    latency: float = None
    note: str = ""
    unseen: tuple = None  # distance, lower and upper to what no camera sees; infinite where no pixel hides anything
    reaches: bool = False  # into what no camera sees


def _number(value, name, where, whole=False):
    if value is None or value == "":
        return None
    try:
        return int(value) if whole else float(value)
    except (TypeError, ValueError):
        raise ValueError(f"clearance: {where}: {name} is {value!r}, which is no number") from None


def moment(row, k, where="a row"):
    """Row k, of either kind: a dictionary of words or of JSON's values."""
    state = row.get("state")
    if state not in STATES:
        raise ValueError(f"clearance: {where}: the state is {state!r}, which is none of {', '.join(STATES)}")
    blind = state in BLIND
    value = {
        name: _number(row.get(name), name, where) for name in ("distance", "lower", "upper", "latency_us", "stamp")
    }
    if not blind and any(value[name] is None for name in ("distance", "lower")):
        raise ValueError(f"clearance: {where}: the state is {state}, but there is no distance and bracket")
    points = row.get("points") or {}
    dropped = points.get("dropped", row.get("dropped") or None)
    if isinstance(dropped, str):
        dropped = json.loads(dropped)

    def triple(name, columns):
        given = row.get(name)
        given = given if isinstance(given, list) else [row.get(f"{columns}_{axis}") for axis in "xyz"]
        values = tuple(_number(v, name, where) for v in given)
        return values if None not in values else None

    unseen, reaches = _unseen(row, where)
    return Moment(
        number=_number(row.get("frame"), "frame", where, True)
        if "topic" not in row and row.get("frame") not in (None, "")
        else k,
        state=state,
        distance=math.nan if blind else value["distance"],
        lower=0.0 if blind else value["lower"],
        upper=math.inf if blind or value["upper"] is None else value["upper"],
        stamp=value["stamp"],
        file=row.get("file") or None,
        topic=row.get("topic") or None,
        link=row.get("part") or row.get("link") or None,
        point=_number(row.get("point"), "point", where, True),
        at=triple("point_xyz", "point" if "point_x" in row else "at"),
        nearest=triple("nearest_xyz", "nearest"),
        seen=_number(points.get("seen", row.get("seen")), "seen", where, True),
        valid=_number(points.get("valid", row.get("valid")), "valid", where, True),
        dropped=dropped,
        latency=value["latency_us"],
        note=row.get("note") or "",
        unseen=unseen,
        reaches=reaches,
    )


def _unseen(row, where):
    """Distance, lower and upper of a row of --unseen, and whether the robot reaches into it; else None, False."""
    given = row.get("unseen")
    if not isinstance(given, dict):
        given = {name: row.get(f"unseen_{name}") for name in ("state", "distance", "lower")}
    state = given.get("state")
    if not state or state == "no_data":
        return None, False
    if state not in STATES:
        raise ValueError(f"clearance: {where}: unseen has the state {state!r}, which is none of {', '.join(STATES)}")
    values = [_number(given.get(name), f"unseen {name}", where) for name in ("distance", "lower", "upper")]
    distance = math.inf if values[0] is None else values[0]
    return (distance, distance if values[1] is None else values[1], distance if values[2] is None else values[2]), (
        state == "unknown"
    )


def read_rows(file):
    """The moments of a file, and notes: sentences about what is damaged."""
    file = pathlib.Path(file)
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise ValueError(f"clearance: {file} is no text in UTF-8") from None
    return rows_of(text, file)


def rows_of(text, file):
    """read_rows of a text; file: what it is called."""
    if not text.strip():
        raise ValueError(f"clearance: {file} is empty")
    if text.lstrip()[0] in "[{":
        rows, notes = _json_rows(text, file)
    else:
        rows, notes = _csv_rows(text, file)
    moments = [moment(row, k, where) for k, (where, row) in enumerate(rows)]
    if not moments:
        raise ValueError(f"clearance: {file} has no rows" + (f" ({notes[0]})" if notes else ""))
    return moments, notes


def _json_rows(text, file):
    if text.lstrip()[0] == "[":
        try:
            rows = json.loads(text)
        except json.JSONDecodeError as error:
            raise ValueError(f"clearance: {file} is no JSON: {error}") from None
        rows = [(f"{file}, row {k + 1}", row) for k, row in enumerate(rows)]
    else:
        rows = []
        for k, line in enumerate(text.splitlines(), 1):
            if not line.strip():
                continue
            try:
                rows.append((f"{file}, line {k}", json.loads(line)))
            except json.JSONDecodeError:
                return rows, [f"line {k} of {file} is damaged; only the {len(rows)} rows before it are shown"]
    for where, row in rows:
        if not isinstance(row, dict):
            raise ValueError(f"clearance: {where} is no JSON object")
    return rows, []


def _csv_rows(text, file):
    table = csv.DictReader(text.splitlines())
    wanted = ("state", "distance", "lower", "upper")
    missing = [name for name in wanted if name not in (table.fieldnames or [])]
    if missing:
        raise ValueError(
            f"clearance: {file} has no column {missing[0]} (clearance run --csv and clearance play --csv write it)"
        )
    rows = []
    for row in table:
        if None in row or None in row.values():
            return rows, [f"line {table.line_num} of {file} is damaged; only the {len(rows)} rows before it are shown"]
        rows.append((f"{file}, line {table.line_num}", row))
    return rows, []


def nearness(m):
    """What is compared of two moments: the lower end, and, because that is 0 in each collision, the distance."""
    return m.lower, m.distance


def by_topic(moments):
    """{topic: the indices of its moments}, in the order of time; rows of clearance run have the topic None."""
    of = {}
    for k, m in enumerate(moments):
        of.setdefault(m.topic, []).append(k)
    return of


def worst(moments, count):
    """The nearest moments: first the nearest of all, then those that are no farther than their topic's neighbours."""
    dips = set()
    for its in by_topic(moments).values():
        for i, k in enumerate(its):
            beside = [moments[j] for j in its[max(0, i - 1) : i + 2] if moments[j].state not in BLIND]
            if moments[k].state not in BLIND and all(nearness(moments[k]) <= nearness(other) for other in beside):
                dips.add(k)
    known = [k for k, m in enumerate(moments) if m.state not in BLIND]
    order = sorted(known, key=lambda k: (k not in dips, nearness(moments[k]), k))
    return sorted(order[:count], key=lambda k: (nearness(moments[k]), k))


def _name(m, with_topic=True):
    if m.stamp is not None:
        return f"{m.stamp:.3f} s" + (f", {m.topic}" if m.topic and with_topic else "")
    return f"frame {m.number}" + (f", {pathlib.Path(m.file).name}" if m.file else "")


def _table(rows, head=()):
    out = ["<table>"]
    if head:
        out.append("<tr>" + "".join(f"<th>{html.escape(h)}</th>" for h in head) + "</tr>")
    for row in rows:
        out.append(
            "<tr>"
            + "".join(f"<td>{cell if isinstance(cell, Raw) else html.escape(str(cell))}</td>" for cell in row)
            + "</tr>"
        )
    return "".join(out) + "</table>"


class Raw(str):
    """Text that is HTML already."""


def _quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def page(moments, *, asked=(), margin=None, notes=(), pictures=None, count=3, title="clearance"):
    """The HTML text. asked: pairs of words. pictures: {index of a moment: (PNG bytes or None, sentence)}."""
    pictures = pictures or {}
    chosen = worst(moments, count)
    blind = [k for k, m in enumerate(moments) if m.state in BLIND]
    known = [m for m in moments if m.state not in BLIND]
    times = (
        [m.stamp - moments[0].stamp for m in moments]
        if all(m.stamp is not None for m in moments)
        else [m.number for m in moments]
    )
    body = [f"<h1>{html.escape(title)}</h1>"]
    verdict = []
    topics = by_topic(moments)
    for topic, its in topics.items():
        near = [moments[k] for k in its if moments[k].state not in BLIND]
        if not near:
            continue
        least = min(near, key=lambda m: (m.distance, m.lower))
        verdict.append(
            f"The least distance{f' of {html.escape(topic)}' if len(topics) > 1 and topic else ''} is "
            f"<b>{metres(least.distance)}</b> (certainly {least.lower:z.3f} to {least.upper:z.3f}), "
            f"{html.escape(least.link or 'no part')}, at {html.escape(_name(least, len(topics) == 1))}."
        )
        lowest = min(near, key=lambda m: m.lower)
        if lowest.lower < least.lower:
            verdict.append(f"It is certainly above {lowest.lower:z.3f} m only, at {html.escape(_name(lowest))}.")
    if margin is not None:
        below = sum(not m.lower > margin for m in known)
        verdict.append(
            f"The lower end is above the margin of {metres(margin)} in "
            f"{len(known) - below:,} of {len(moments):,} frames"
            + (f"; it is <b>not</b> in {below:,}" if below else "")
            + "."
        )
    if blind:
        verdict.append(
            f"<b>Nothing is known in {len(blind):,} of {len(moments):,} frames</b>, because they have no valid "
            "point or could "
            "not be asked."
        )
    hidden = [m for m in moments if m.unseen]
    if hidden:
        nearest = min(hidden, key=lambda m: m.unseen[1])
        reach = sum(m.reaches for m in hidden)
        away = f"certainly at least {nearest.unseen[1]:z.3f} m" if math.isfinite(nearest.unseen[1]) else "as far as asked"
        verdict.append(
            f"What no camera sees is {away} away, at {html.escape(_name(nearest))}"
            + (f"; the robot <b>reaches into it</b> in {reach:,} frames" if reach else "")
            + "."
        )
    body += [f"<p class=verdict>{each}</p>" for each in verdict]
    body += [f"<p class=note>{html.escape(note)}</p>" for note in notes]

    body.append("<h2>What was asked</h2>")
    states = ", ".join(
        f"{sum(m.state == s for m in moments):,} {s}" for s in STATES if any(m.state == s for m in moments)
    )
    rows = [*asked, ("frames", f"{len(moments):,}: {states}")]
    if margin is not None:
        rows.append(("margin", metres(margin)))
    body.append(_table(rows))

    body.append("<h2>Clearance over time</h2>")
    body.append(
        history.svg(
            times,
            [m.distance for m in moments],
            [m.lower for m in moments],
            [m.upper for m in moments],
            [("no_data" if m.state in BLIND else m.state) for m in moments],
            unseen=[[m.unseen[i] if m.unseen else math.nan for m in moments] for i in range(3)] if hidden else None,
            margin=margin,
            marks=chosen,
            unit="seconds since the first frame" if moments[0].stamp is not None else "frame",
        )
    )
    body.append(
        "<p class=small>Line: the distance. Band: the bracket, which certainly holds the distance to the solid. "
        "Grey: nothing is "
        "known. Dashed: the margin. Numbers: the worst moments below."
        + (" Orange: the same to what no camera sees." if hidden else "")
        + "</p>"
    )

    body.append("<h2>Worst moments</h2><div class=moments>")
    for number, k in enumerate(chosen, 1):
        m = moments[k]
        picture, sentence = pictures.get(k, (None, ""))
        image = (
            f'<img alt="moment {number}" src="data:image/png;base64,{base64.b64encode(picture).decode()}">'
            if picture
            else ""
        )
        where = "".join(
            f"<br>{name} {', '.join(f'{v:.4f}' for v in at)}"
            for name, at in (("point at", m.at), ("robot at", m.nearest))
            if at
        )
        point = f" to point {m.point:,}" if m.point is not None else ""
        body.append(
            f"<div>{image}<p><b>{number}. {metres(m.distance)}</b> (certainly {m.lower:z.3f} to "
            f"{m.upper:z.3f}), {m.state}, "
            f"{html.escape(m.link or '')}{point}<br>{html.escape(_name(m))}{where}"
            + (f"<br><i>{html.escape(sentence)}</i>" if sentence else "")
            + "</p></div>"
        )
    body.append("</div>" if chosen else "<p>No frame has a distance.</p></div>")
    if blind:
        listed = ", ".join(
            html.escape(_name(moments[k]) + (f" ({moments[k].note})" if moments[k].note else "")) for k in blind[:50]
        )
        body.append(
            f"<p>Nothing is known at: {listed}"
            + (f" and {len(blind) - 50:,} more" if len(blind) > 50 else "")
            + ".</p>"
        )

    body.append("<h2>Points dropped, by reason</h2>" + _dropped(moments))
    body.append("<h2>Latency</h2>" + _latency(moments))
    return (
        f"<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><title>{html.escape(title)}</title>"
        f"<style>{_STYLE}</style></head>"
        f"<body>{''.join(body)}</body></html>\n"
    )


def _dropped(moments):
    told = [m for m in moments if m.dropped is not None and m.seen is not None]
    if not told:
        return "<p>The rows do not say it (clearance run prints it as JSON, not with --csv).</p>"
    seen, valid = sum(m.seen for m in told), sum(m.valid or 0 for m in told)
    total = {}
    for m in told:
        for reason, n in m.dropped.items():
            total[reason] = total.get(reason, 0) + n

    def bar(n, kind):
        return Raw(
            f'<div class="bar {kind}" style="width:{max(300 * n / seen, 1 if n else 0) if seen else 0:.1f}px"></div>'
        )

    rows = [("valid", f"{valid:,}", f"{100 * valid / seen if seen else 0:.1f} %", bar(valid, "good"))]
    rows += [
        (r, f"{n:,}", f"{100 * n / seen if seen else 0:.1f} %", bar(n, "bad"))
        for r, n in sorted(total.items(), key=lambda i: -i[1])
        if n
    ]
    none = [r for r, n in total.items() if not n]
    note = f"<p class=small>{seen:,} points in {len(told):,} frames" + (
        f"; no point was {', '.join(map(html.escape, none))}" if none else ""
    )
    if len(told) < len(moments):
        note += f"; {len(moments) - len(told):,} frames do not say it"
    return _table(rows) + note + ".</p>"


def _latency(moments):
    told = [m.latency for m in moments if m.latency is not None]
    if not told:
        return "<p>The rows do not say it.</p>"
    return (
        history.histogram_svg(told, unit="microseconds a query") + f"<p class=small>Half of the queries took at most "
        f"{_quantile(told, 0.5):,.0f} us, 99 of 100 at most "
        f"{_quantile(told, 0.99):,.0f} us, all at most {max(told):,.0f} us.</p>"
    )


_STYLE = """body{font:15px/1.45 sans-serif;max-width:960px;margin:2em auto;padding:0 1em;color:#222}h2{margin-top:1.6em}
table{border-collapse:collapse}td,th{padding:.15em .9em .15em 0;text-align:left;vertical-align:middle}
.verdict{font-size:1.15em}.note{background:#fff3cd;padding:.5em 1em}.small{color:#666;font-size:.85em}
.moments img{width:100%;border:1px solid #ddd}
.moments{display:grid;grid-template-columns:repeat(auto-fill,minmax(430px,1fr));gap:1em}
.bar{height:.9em}.good{background:#1f4f8b}.bad{background:#be141e}svg{max-width:100%;height:auto}"""
