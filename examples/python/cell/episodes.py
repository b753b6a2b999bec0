# SPDX-License-Identifier: BSD-3-Clause
"""Random episodes of a person beside an arm that carries a box, under a supervisor and without: what comes of it.

    python examples/python/cell/episodes.py --episodes 20 --who clearance none
"""

from __future__ import annotations

import argparse
import json
import pathlib
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

import clearance
import others
from person import CAPSULES, KINDS, Motion, random_motion
from supervisor import Frame, Stated, Supervisor, Verdict, separation
from task import RISE, STOP, Task
from world import CAMERAS, Sensor, World, urdf

Array = NDArray[np.float64]
TICK = 1 / 120  # seconds of a step of the simulation
PERIOD = 4  # ticks between two frames
LATE = (3, 5)  # ticks from a frame to its answer: at least, at most
SECONDS = 10.0
FASTEST = 1.55  # metres per second: a person's fastest place; 1.6 is stated


class Judge(Protocol):
    """Whoever says how fast the arm may go."""

    seconds: dict[str, list[float]]

    def ask(self, frame: Frame) -> Verdict: ...


@dataclass
class Outcome:
    """What came of an episode."""

    kind: str
    contacts: int = 0  # how often something moved into a person
    contact_speed: float = 0.0  # metres per second of the arm's fastest place, at worst
    least_moving: float = 1.0  # metres between the arm and the person while the arm moved
    least_speed: float = 0.0  # the arm's fastest place then, metres per second
    short: int = 0  # frames in which the arm was faster than the true distance allows
    false_stops: int = 0  # frames in which it was stopped though the true distance allows full speed
    frames: int = 0
    progress: float = 0.0  # seconds of work done, at full speed
    trace: list[dict[str, float]] = field(default_factory=list)  # of each frame


class Cell:
    """The world, the task, and those who can watch over it."""

    def __init__(self) -> None:
        self.robot = clearance.Robot.from_urdf(urdf(), model="triangles")
        self.task, self.world, self.stated = Task(self.robot), World(CAPSULES), Stated()
        self.boxes = [self.task.box(k) for k in range(len(self.task.legs))]
        self.judges: dict[str, Callable[[], Judge]] = {
            "clearance": lambda: Supervisor(self.robot, self.task.legs, self.boxes, self.stated),
            "without unseen": lambda: Supervisor(self.robot, self.task.legs, self.boxes, self.stated, unseen=False),
            "without radii": lambda: Supervisor(self.robot, self.task.legs, self.boxes, self.stated, radii=False),
            "voxels of 2 cm": lambda: others.Voxels(self.robot, self.task.legs, self.boxes, self.stated),
            "spheres and 5 cm": lambda: others.PaddedSpheres(self.robot, self.task.legs, self.boxes, self.stated, urdf()),
            "none": others.Nobody,
        }
        self.made: dict[str, Judge] = {}

    def judge(self, who: str) -> Judge:
        if who not in self.made:
            self.made[who] = self.judges[who]()
        return self.made[who]

    def speed_at(self, leg: int, second: float, share: float) -> float:
        """The arm's fastest place, metres per second."""
        speeds = self._speeds[leg]
        return share * float(speeds[min(int(second / self.task.legs[leg].seconds * len(speeds)), len(speeds) - 1)].max())

    def run(self, who: str, seed: int, person: Motion | None = None, kind: str = "", each: Callable[[float, Verdict], None] | None = None,
            seconds: float = SECONDS) -> Outcome:
        """An episode: the same for everybody with the same seed."""
        judge = self.judge(who)
        if isinstance(judge, Supervisor):
            judge.allowed = 0.0
        self._speeds = judge.full.speeds if isinstance(judge, Supervisor) else self.judge_speeds()
        random = np.random.default_rng(seed)
        kind = kind or KINDS[seed % len(KINDS)]
        person = person or random_motion(kind, random, FASTEST)
        begin = float(random.uniform(0, 2))
        sensor, noise = Sensor(), np.random.default_rng([seed, 1])
        cameras = sensor.wrong_poses(noise)
        leg, second, share, allowed = int(random.integers(len(self.task.legs))), 0.0, 0.0, 0.0
        arrivals: list[tuple[int, Verdict]] = []
        outcome, touching = Outcome(kind), False
        verdict = Verdict(0.0)
        for tick in range(int(seconds / TICK)):
            here = self.task.legs[leg].at(second)
            held = self.task.legs[leg].holds
            self.world.put(here, person.at(tick * TICK - begin), self.boxes[leg])
            distance = self.world.distance(held)
            speed = self.speed_at(leg, second, share)
            if share > 0:
                if distance < outcome.least_moving:
                    outcome.least_moving, outcome.least_speed = distance, speed
                if distance <= 0:
                    outcome.contacts += not touching
                    outcome.contact_speed = max(outcome.contact_speed, speed)
            touching = distance <= 0
            if tick % PERIOD == 0:
                images = [sensor.measured(self.world.depth(name), noise) for name in CAMERAS]
                measured = here + noise.uniform(-1, 1, len(here)) * 0.0007
                given = judge.ask(Frame(images, cameras, measured, leg, second, share))
                arrivals.append((tick + int(noise.integers(LATE[0], LATE[1] + 1)), given))
                outcome.frames += 1
                full = self.speed_at(leg, second, 1.0)
                outcome.short += bool(share > 0 and distance < separation(full, share, self.stated))
                outcome.false_stops += bool(given.share == 0 and distance > separation(full, 1.0, self.stated))
                outcome.trace.append({"time": tick * TICK, "distance": distance, "speed": speed, "share": share, "lower": verdict.lower,
                                      "hidden": verdict.hidden})
                if each:
                    each(tick * TICK, verdict)
            for arrived, given in [a for a in arrivals if a[0] <= tick]:
                verdict, allowed = given, given.share
                arrivals.remove((arrived, given))
            share = min(share + TICK / RISE, allowed) if share < allowed else max(share - TICK / STOP, allowed)
            second += share * TICK
            outcome.progress += share * TICK
            if second >= self.task.legs[leg].seconds:
                second -= self.task.legs[leg].seconds
                leg = (leg + 1) % len(self.task.legs)
        return outcome

    def judge_speeds(self) -> list[Array]:
        """Of the arm with the box, whoever judges."""
        judge = self.judge("clearance")
        assert isinstance(judge, Supervisor)
        return judge.full.speeds


def row(who: str, outcomes: list[Outcome], judge: Judge) -> dict[str, Any]:
    """What is told of one who watched over all episodes."""
    moving = min(outcomes, key=lambda o: o.least_moving)
    frames = sum(o.frames for o in outcomes)
    return {
        "who": who, "episodes": len(outcomes), "contacts": sum(o.contacts for o in outcomes),
        "contact speed": max(o.contact_speed for o in outcomes), "least distance moving": moving.least_moving,
        "speed then": moving.least_speed, "too fast, % of frames": 100 * sum(o.short for o in outcomes) / frames,
        "false stops, % of frames": 100 * sum(o.false_stops for o in outcomes) / frames,
        "work, %": 100 * sum(o.progress for o in outcomes) / (len(outcomes) * (SECONDS - RISE / 2)),
        "ms a frame": 1000 * sum(float(np.median(s)) for s in judge.seconds.values()),
        "stages": {stage: 1000 * float(np.median(s)) for stage, s in judge.seconds.items()},
    }


def told(rows: list[dict[str, Any]]) -> str:
    """The table of README.md."""
    names = ["contacts", "contact speed", "least distance moving", "speed then", "too fast, % of frames", "false stops, % of frames",
             "work, %", "ms a frame"]
    digits = [0, 2, 3, 2, 1, 1, 0, 1]
    lines = ["| who watches | " + " | ".join(names) + " |", "| --- |" + " --- |" * len(names)]
    for r in rows:
        lines.append(f"| {r['who']} | " + " | ".join(f"{r[n]:.{d}f}" for n, d in zip(names, digits)) + " |")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="of the first episode")
    parser.add_argument("--who", nargs="+", default=["clearance", "none"], help="one or more of those in README.md, or all")
    parser.add_argument("--json", type=pathlib.Path, help="write all outcomes")
    given = parser.parse_args()
    cell = Cell()
    who = list(cell.judges) if given.who == ["all"] else given.who
    for name in who:
        if name not in cell.judges:
            parser.error(f"--who: nobody is called {name!r}; there are {', '.join(cell.judges)}")
    rows: list[dict[str, Any]] = []
    all_outcomes: dict[str, list[Outcome]] = {}
    for name in who:
        since = time.monotonic()
        outcomes = [cell.run(name, given.first + k) for k in range(given.episodes)]
        rows.append(row(name, outcomes, cell.judge(name)))
        all_outcomes[name] = outcomes
        bad = [given.first + k for k, o in enumerate(outcomes) if o.contacts]
        print(f"{name}: {given.episodes} episodes in {time.monotonic() - since:.0f} s" + (f"; contacts in {bad}" if bad else ""), flush=True)
    print(told(rows))
    if given.json:
        given.json.write_text(json.dumps({"rows": rows, "outcomes": {n: [asdict(o) for o in of] for n, of in all_outcomes.items()}}))
    cell.world.close()
    return 1 if any(o.contacts for o in all_outcomes.get("clearance", [])) else 0


if __name__ == "__main__":
    sys.exit(main())
