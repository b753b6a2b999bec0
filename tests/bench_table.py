# SPDX-License-Identifier: BSD-3-Clause
"""What pages quote of bench/records/h200/latency.txt is found in what bench/record writes, without a hand between; and a file that
does not say on which machine and of which commit it was made is refused."""
import json
import pathlib
import re
import sys
import tempfile

sys.dont_write_bytecode = True
root = pathlib.Path(__file__).resolve().parent.parent
sys.path += [str(root / "scripts"), str(root / "bench")]
import recorded  # noqa: E402
from recording import records  # noqa: E402

pages = "".join((root / name).read_text() for name in ("docs/performance.md", "bench/goals.md", "bench/paper/README.md"))
keys = set(re.findall(r"{h200/latency\.txt: [^}]+}", pages))
asked = {m[1]: m[2] for key in keys if (m := re.match(r"{[^:]+: (.+), (us|%) ,?\.\d", key))}
asked["pinned_points/given/5000000"] = "us"  # goal_copy
assert len(asked) > 5, "the pages ask for no latencies"
rows = sorted(asked)


def refused(*arguments):
    try:
        records.main([str(a) for a in arguments])
    except recorded.Mistake:
        return True
    return False


with tempfile.TemporaryDirectory() as name:
    recorded.root, recorded.records = pathlib.Path(name), pathlib.Path(name) / "records"
    run = recorded.root / "run"
    for folder in (run, recorded.records / "h200", recorded.records / "epyc"):
        folder.mkdir(parents=True)
    summary = "2026-01-02 03:04 UTC, commit 0123abc\nNVIDIA H200, 580.1, 9.0\nA CPU, 16 processors\n\n"
    (run / "summary.txt").write_text(summary)
    benchmarks = [{"name": row, "run_name": f"{row}/iterations:1/manual_time", "real_time": 100.0 + k, "time_unit": "us",
                   "distance_mm": 300.0 + k, "p99_9_us": 500.0 + k, "max_us": 700.0 + k} for k, row in enumerate(rows)]
    (run / "bench_min_distance_latency_device.json").write_text(json.dumps({"benchmarks": benchmarks}))
    (run / "demo.txt").write_text("NVIDIA H200, 580.1; commit 0123abc\n\nAn arm.\n")
    records.main([str(run)])
    written = recorded.records / "h200/latency.txt"
    print(written.read_text())
    assert written.read_text().startswith("# bench_min_distance_latency_device; NVIDIA H200, driver 580.1; commit 0123abc; 2026-01-02\n\n")
    assert (recorded.records / "h200/demo.txt").read_text() == "# clearance demo; NVIDIA H200, driver 580.1; commit 0123abc; 2026-01-02\n\nAn arm.\n"
    for k, row in enumerate(rows):
        assert recorded.number("h200/latency.txt", row, "us") == 100 + k
        assert recorded.key(f"h200/latency.txt: {row}, ms .4f") == f"{(100 + k) / 1000:.4f}"
        assert recorded.number("h200/latency.txt", row, "%") == 500 + k
    assert recorded.key(f"h200/latency.txt: {rows[1]}, us .1f, at most 100") == "missed: 101.0"
    assert recorded.key(f"h200/latency.txt: {rows[1]}, us .1f, at least 101") == "101.0"
    assert recorded.key("h200/latency.txt: commit") == "0123abc"

    said, rows_then = "How it was run, which no program prints.", written.read_text()
    written.write_text(rows_then.replace("\n\n", f"\n\n{said}\n\n", 1))
    records.main([str(run)])
    assert written.read_text() == rows_then.replace("\n\n", f"\n\n{said}\n\n", 1), "a person's sentences are kept"

    (run / "summary.txt").write_text(summary.replace("0123abc", "0123abc-dirty"))
    assert refused(run), "a commit that nobody else has"
    alone = recorded.root / "fuzz.txt"
    alone.write_text("target  seeds\n")
    assert refused(alone) and refused("--commit", "0123abc", alone) and refused("--machine", "AMD EPYC", alone)
    assert refused("--commit", "0123abc", "--machine", "a machine of no folder", alone)
    records.main(["--commit", "0123abc", "--machine", "AMD EPYC (Zen 5)", "--day", "2026-01-02", str(alone)])
    assert (recorded.records / "epyc/fuzz.txt").read_text() == "# fuzz; AMD EPYC (Zen 5); commit 0123abc; 2026-01-02\n\ntarget  seeds\n"
