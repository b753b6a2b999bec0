# SPDX-License-Identifier: BSD-3-Clause
"""An episode as a film, and its distances and speed over time as a picture.

    pip install matplotlib; python examples/python/cell/film.py --seed 1 --to out/cell
"""

from __future__ import annotations

import argparse
import importlib
import pathlib
import sys
from typing import Any

from episodes import Cell, Outcome
from supervisor import Verdict

image: Any = importlib.import_module("PIL.Image")
draw: Any = importlib.import_module("PIL.ImageDraw")

EVERY = 3  # frames of the cameras for one of the film


def film(cell: Cell, who: str, seed: int, seconds: float) -> tuple[list[Any], Outcome]:
    """The film's frames, and what came of the episode."""
    frames: list[Any] = []
    count = 0

    def each(when: float, verdict: Verdict) -> None:
        nonlocal count
        count += 1
        if count % EVERY:
            return
        picture = image.fromarray(cell.world.picture())
        pen = draw.Draw(picture)
        colour = (200, 40, 40) if verdict.share == 0 else (220, 160, 0) if verdict.share < 1 else (40, 150, 60)
        pen.rectangle([0, 0, 400, 22], fill=(20, 20, 24))
        pen.rectangle([250, 6, 250 + 140 * verdict.share, 16], fill=colour)
        pen.rectangle([250, 6, 390, 16], outline=(200, 200, 200))
        words = "stop" if verdict.share == 0 else f"{100 * verdict.share:.0f} % of full speed"
        pen.text((8, 6), f"{when:4.1f} s  {words}, certainly {verdict.lower:.2f} m", fill=(235, 235, 235))
        frames.append(picture.quantize(64, dither=image.Dither.NONE))

    outcome = cell.run(who, seed, each=each, seconds=seconds)
    return frames, outcome


def plot(outcomes: dict[str, Outcome], file: pathlib.Path) -> None:
    """True distance, what the supervisor knew, and the arm's speed."""
    matplotlib: Any = importlib.import_module("matplotlib")
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "clearance"
    pyplot: Any = importlib.import_module("matplotlib.pyplot")
    figure, rows = pyplot.subplots(2, len(outcomes), figsize=(4.2 * len(outcomes), 4), sharex=True, sharey="row", squeeze=False)
    for column, (who, outcome) in enumerate(outcomes.items()):
        time = [t["time"] for t in outcome.trace]
        above, below = rows[0][column], rows[1][column]
        above.plot(time, [t["distance"] for t in outcome.trace], label="true distance", color="black")
        if who != "none":
            above.plot(time, [min(t["lower"], 1) for t in outcome.trace], label="lower end, seen", color="tab:blue")
            above.plot(time, [min(t["hidden"], 1) for t in outcome.trace], label="lower end, hidden", color="tab:purple", alpha=0.6)
        above.axhline(0, color="red", linewidth=0.8)
        above.set_title(who)
        below.plot(time, [t["speed"] for t in outcome.trace], color="tab:green")
        below.set_xlabel("s")
    rows[0][0].set_ylabel("m")
    rows[1][0].set_ylabel("fastest place, m/s")
    rows[0][0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--to", type=pathlib.Path, default=pathlib.Path("out/cell"), metavar="FOLDER")
    given = parser.parse_args()
    given.to.mkdir(parents=True, exist_ok=True)
    cell = Cell()
    frames, watched = film(cell, "clearance", given.seed, given.seconds)
    frames[0].save(given.to / "cell.gif", save_all=True, append_images=frames[1:], duration=100, loop=0, optimize=True)
    plot({"clearance": watched, "none": cell.run("none", given.seed, seconds=given.seconds)}, given.to / "cell.svg")
    print(f"{given.to / 'cell.gif'}, {(given.to / 'cell.gif').stat().st_size / 1e6:.1f} MB; {given.to / 'cell.svg'}")
    cell.world.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
