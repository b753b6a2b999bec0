# SPDX-License-Identifier: BSD-3-Clause
"""What docs/performance.md and docs/gpu-runs/goals.md read from bench_latency.txt is what scripts/bench-table writes, without a hand between."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
root = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(root / "scripts"))
import recorded  # noqa: E402

page = "".join((root / "docs" / name).read_text() for name in ("performance.md", "gpu-runs/goals.md"))
asked = set(re.findall(r'<!-- = latency\("([^"]+)"(?:, "([^"]+)")?(?:, form="[^"]+")?\)', page))
asked |= set(re.findall(r'<!-- = goal_latency\("([^"]+)", \d+(?:, "([^"]+)")?(?:, form="[^"]+")?\)', page))
asked = sorted(asked | set(re.findall(r'of\.number\("bench_latency\.txt", "([^"]+)"()\)', (root / "scripts/figures.py").read_text())))
assert len(asked) > 5, "the pages ask for no latencies"
rows = sorted({row for row, _ in asked})
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "summary.txt").write_text("2026-01-02 03:04 UTC, commit 0123abc\nA GPU, 580.1, 9.0\nA CPU, 16 processors\n\n")
    benchmarks = [{"name": row, "run_name": f"{row}/iterations:1/manual_time", "real_time": 100.0 + k, "time_unit": "us",
                   "distance_mm": 300.0 + k, "p99_9_us": 500.0 + k, "max_us": 700.0 + k} for k, row in enumerate(rows)]
    (folder / "b.json").write_text(json.dumps({"benchmarks": benchmarks}))
    table = folder / "bench_latency.txt"
    table.write_text(subprocess.run([root / "scripts/bench-table", folder / "b.json"], check=True, capture_output=True, text=True).stdout)
    print(table.read_text())
    for row, word in asked:
        found = recorded.number_in(table, row, word or 0)
        assert found == (500 if word else 100) + rows.index(row), f"{row} {word}: {found}"
    assert recorded.commit_of(table) == "0123abc"
