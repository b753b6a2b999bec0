# SPDX-License-Identifier: BSD-3-Clause
"""What a benchmark program wrote as JSON, as a plain table."""

import re

COUNTERS = ("distance_mm", "p99_9_us", "max_us", "query_ms", "fill", "gap_mean_mm", "gap_p95_mm", "gap_mm", "out", "bounds",
            "spheres", "us_a_point", "kB", "error_mm_5cm", "worst_mm_5cm", "error_mm_20cm", "worst_mm_20cm",
            "error_mm_100cm", "worst_mm_100cm", "loaded", "seen", "late_us", "late_p99_us", "late_max_us", "hits", "points", "missed", "thin_ms", "build_ms")
NAMES = {"p99_9_us": "99.9 %", "max_us": "max"}  # as the pages look them up (scripts/recorded.py)


def table(run):
    """Of repeated benchmarks the median of the repetitions and their coefficient of variation."""
    rows = {}
    for b in run["benchmarks"]:
        name = re.sub(r"clearance::", "", b.get("run_name", b["name"]))
        name = re.sub(r"/(iterations|repeats):\d+|/manual_time|/process_time|/real_time", "", name)
        row = rows.setdefault(name, {})
        if "error_message" in b:
            row["time"] = b["error_message"]
        elif b.get("aggregate_name", "median") == "median":
            row["time"] = f"{b['real_time']:.2f} {b['time_unit']}"
            row["more"] = "  ".join(f"{NAMES.get(k, k)} {b[k]:.4g}" for k in COUNTERS if k in b)
        elif b["aggregate_name"] == "cv":
            row["spread"] = f"+-{100 * b['real_time']:.1f} %"
    width = max(map(len, rows), default=0)
    return "".join(f"{name:<{width}}  {row.get('time', ''):>14}  {row.get('spread', ''):>8}  {row.get('more', '')}".rstrip() + "\n"
                   for name, row in rows.items())
