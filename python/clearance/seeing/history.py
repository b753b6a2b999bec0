# SPDX-License-Identifier: BSD-3-Clause
"""Clearance over time, with the bracket as a band."""

import html
import math

from . import colours


def _nice(span):
    """A step of 1, 2 or 5 times a power of ten, of which about five fit into the span."""
    raw = span / 5 or 1.0
    power = 10.0 ** math.floor(math.log10(raw))
    return next(k * power for k in (1, 2, 5, 10) if k * power >= raw * 0.999)


def _hex(colour):
    return "#%02x%02x%02x" % tuple(colour)


def svg(
    times, distance, lower, upper, states, *, unseen=None, margin=None, width=900, height=260, unit="frame", marks=()
):
    """An SVG picture: the distance as a line, [lower, upper] as a band, moments without data as grey bars.

    times, distance, lower, upper: sequences of floats, metres; states: words. marks: indices that get a number (worst
    moments). unseen: (distance, lower, upper) to what no camera sees, each as above, NaN where nothing is known. What is
    infinite ends at the picture's edge.
    """
    left, right, top, bottom = 62, 14, 12, 38
    w, h = width - left - right, height - top - bottom
    count = len(times)
    more = [v for values in (unseen or ())[:2] for v in values]
    finite = [v for v in [*distance, *lower, *more, *([margin] if margin is not None else [])] if math.isfinite(v)]
    low = min([0.0, *finite])
    high = max([*finite, low + 1e-3]) * 1.08
    t0, t1 = (times[0], times[-1]) if count else (0, 1)
    t1 = t1 if t1 > t0 else t0 + 1

    def x(t):
        return left + w * (t - t0) / (t1 - t0)

    def y(v):
        return top + h * (1 - (min(max(v, low), high) - low) / (high - low))

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    step = _nice(high - low)
    for k in range(math.ceil(low / step), math.floor(high / step) + 1):
        out.append(
            f'<line x1="{left}" x2="{width - right}" y1="{y(k * step):.1f}" y2="{y(k * step):.1f}" stroke="#e4e4e4"/>'
            f'<text x="{left - 6}" y="{y(k * step) + 4:.1f}" text-anchor="end">{k * step:g} m</text>'
        )
    step = _nice(t1 - t0)
    for k in range(math.ceil(t0 / step), math.floor(t1 / step) + 1):
        out.append(f'<text x="{x(k * step):.1f}" y="{height - 20}" text-anchor="middle">{k * step:g}</text>')
    out.append(f'<text x="{left + w / 2}" y="{height - 5}" text-anchor="middle">{html.escape(unit)}</text>')
    half = w / max(count - 1, 1) / 2
    for k in range(count):
        if states[k] == "no_data" or math.isnan(distance[k]):
            out.append(
                f'<rect class="no-data" x="{x(times[k]) - half:.1f}" y="{top}" '
                f'width="{max(2 * half, 1):.1f}" height="{h}" '
                f'fill="{_hex(colours.UNKNOWN)}" fill-opacity="0.45"/>'
            )

    def curve(distance, lower, upper, known, name, light, dark):
        runs, run = [], []
        for k in range(count):
            if not known(k):
                run = []
                continue
            if not run:
                runs.append(run := [])
            run.append(k)
        for run in runs:
            if len(run) == 1:
                k = run[0]
                out.append(
                    f'<line x1="{x(times[k]):.1f}" x2="{x(times[k]):.1f}" y1="{y(lower[k]):.1f}" y2="{y(upper[k]):.1f}" '
                    f'stroke="{light}" stroke-width="5"/>'
                    f'<circle cx="{x(times[k]):.1f}" cy="{y(distance[k]):.1f}" r="2.5" fill="{dark}"/>'
                )
                continue
            edge = [f"{x(times[k]):.1f},{y(upper[k]):.1f}" for k in run] + [
                f"{x(times[k]):.1f},{y(lower[k]):.1f}" for k in reversed(run)
            ]
            line = " ".join(f"{x(times[k]):.1f},{y(distance[k]):.1f}" for k in run)
            out.append(
                f'<polygon class="{name}band" points="{" ".join(edge)}" fill="{light}" fill-opacity="0.6"/>'
                f'<polyline class="{name}distance" points="{line}" fill="none" stroke="{dark}" stroke-width="1.5"/>'
            )

    if unseen:
        curve(*unseen, lambda k: not math.isnan(unseen[0][k]), "unseen-", "#f3c58b", "#a55000")
    known = [states[k] != "no_data" and not math.isnan(distance[k]) for k in range(count)]
    curve(distance, lower, upper, lambda k: known[k], "", "#8fb6dd", "#1f4f8b")
    if margin is not None:
        out.append(
            f'<line class="margin" x1="{left}" x2="{width - right}" y1="{y(margin):.1f}" y2="{y(margin):.1f}" '
            f'stroke="{_hex(colours.SEGMENT["collision"])}" stroke-dasharray="6 4"/>'
        )
    for number, k in enumerate(marks, 1):
        at = distance[k] if math.isfinite(distance[k]) else low
        out.append(
            f'<circle cx="{x(times[k]):.1f}" cy="{y(at):.1f}" r="7" fill="white" '
            f'stroke="{_hex(colours.SEGMENT["collision"])}"/>'
            f'<text x="{x(times[k]):.1f}" y="{y(at) + 4:.1f}" text-anchor="middle" font-size="10">{number}</text>'
        )
    return "\n".join(out + ["</svg>"])


def histogram_svg(values, *, unit="us", width=900, height=200, bins=40):
    """How often which value, as bars; the last bar also holds what is above the 99.5th percentile, and says so."""
    values = sorted(v for v in values if math.isfinite(v))
    if not values:
        return ""
    left, right, top, bottom = 62, 14, 12, 38
    w, h = width - left - right, height - top - bottom
    last = values[min(len(values) - 1, int(0.995 * len(values)))]
    first = values[0]
    last = last if last > first else first + 1
    counts = [0] * bins
    above = 0
    for v in values:
        above += v > last
        counts[min(bins - 1, int((v - first) / (last - first) * bins))] += 1
    most = max(counts)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for k, n in enumerate(counts):
        if n:
            out.append(
                f'<rect class="bar" x="{left + w * k / bins:.1f}" y="{top + h * (1 - n / most):.1f}" '
                f'width="{w / bins - 1:.1f}" '
                f'height="{h * n / most:.1f}" fill="#1f4f8b"><title>{n}</title></rect>'
            )
    step = _nice(last - first)
    for k in range(math.ceil(first / step), math.floor(last / step) + 1):
        out.append(
            f'<text x="{left + w * (k * step - first) / (last - first):.1f}" y="{height - 20}" '
            f'text-anchor="middle">{k * step:g}</text>'
        )
    beyond = f"; {above} above {last:g}, at most {values[-1]:g}" if above else ""
    out.append(
        f'<text x="{left + w / 2}" y="{height - 5}" text-anchor="middle">{html.escape(unit + beyond)}</text>'
        f'<text x="{left - 6}" y="{top + 10}" text-anchor="end">{most}</text></svg>'
    )
    return "\n".join(out)
