"""What a user waits for besides the integration: the start of the program, long scenes, and the first run of a car."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from stiffmbs.cache.entries import DIRECTORY_VARIABLE

from ...benchmark import Row
from ...drives import SCENES
from ...processes import seconds_of_children
from ..cart_pendulum import SCENE

ROUNDS = 11
PROGRAM = (sys.executable, "-m", "stiffmbs")
LOAD = """
import sys, time, stiffmbs
stiffmbs.load_scene(sys.argv[1])
begun = time.process_time()
stiffmbs.load_scene(sys.argv[2])
print(time.process_time() - begun)
"""
INTEGRATE = "import sys, stiffmbs; stiffmbs.run(stiffmbs.load_scene(sys.argv[1]), duration=1e-3, points=2)"
TYRE_FORCE, CHANGED = "force: ['(mu*max(", "force: ['((1+sin(t)/9)*mu*max("
"""The beginning of the longitudinal force of a tyre, and the same with a factor more."""


def _told(*program: str, cache: str) -> str:
    """What a process prints that keeps its cache in a folder."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment = {**kept, DIRECTORY_VARIABLE: cache}
    return subprocess.run(program, check=True, capture_output=True, text=True, env=environment).stdout


def process_seconds(*program: str, cache: str) -> float:
    """Processor time of a process with its children, s, from its start to its end."""
    before = seconds_of_children()
    _told(*program, cache=cache)
    return seconds_of_children() - before


@dataclass(frozen=True)
class Start:
    """Processes that find everything in the cache, from their start to their end."""

    name: str

    def measured(self) -> list[Row]:
        """Medians; the first of each, which fills the cache, is left out."""
        return list(self._rows(ROUNDS))

    def glanced(self) -> list[Row]:
        """One of each."""
        return list(self._rows(1))

    def _rows(self, rounds: int) -> Iterator[Row]:
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder, "cart_pendulum.yaml")
            scene.write_text(SCENE, encoding="utf-8")
            programs = {
                "python": (sys.executable, "-c", "pass"),
                "import stiffmbs": (sys.executable, "-c", "import stiffmbs"),
                "stiffmbs --help": (*PROGRAM, "--help"),
                "stiffmbs check cart_pendulum": (*PROGRAM, "check", str(scene)),
                "stiffmbs run cart_pendulum": (*PROGRAM, "run", str(scene)),
            }
            for name, program in programs.items():
                times = [process_seconds(*program, cache=folder) for _ in range(rounds + 1)]
                yield Row(name, "from start to end", 0.0, statistics.median(times[1:]), name == "python")


@dataclass(frozen=True)
class LongScene:
    """A car of 1141 lines, read for the first time and again, by processes that have read the cart-pendulum before."""

    name: str

    def measured(self) -> list[Row]:
        """Medians."""
        return list(self._rows(ROUNDS))

    def glanced(self) -> list[Row]:
        """Each once."""
        return list(self._rows(1))

    def _rows(self, rounds: int) -> Iterator[Row]:
        first: list[float] = []
        again: list[float] = []
        for _ in range(rounds):
            with tempfile.TemporaryDirectory() as empty:
                small, long = Path(empty, "cart_pendulum.yaml"), Path(empty, "car.yaml")
                small.write_text(SCENE, encoding="utf-8")
                long.write_text(_car(), encoding="utf-8")
                load = (sys.executable, "-c", LOAD, str(small), str(long))
                for times in (first, again):
                    times.append(float(_told(*load, cache=empty)))
        for setting, times in (("for the first time", first), ("again", again)):
            yield Row("a scene of 1141 lines", f"read {setting}", 0.0, statistics.median(times), False)


@dataclass(frozen=True)
class FirstRun:
    """The first run of that car from an empty cache, for 1 ms: all kinds are derived and compiled; and of one with another tyre force."""

    name: str

    def measured(self) -> list[Row]:
        """Once."""
        with tempfile.TemporaryDirectory() as empty:
            scene = Path(empty, "car.yaml")
            scene.write_text(_car(), encoding="utf-8")
            run = (sys.executable, "-c", INTEGRATE, str(scene))
            times = {name: process_seconds(*run, cache=empty) for name in ("from an empty cache", "again")}
            scene.write_text(_car().replace(TYRE_FORCE, CHANGED), encoding="utf-8")
            times["with a factor more in the tyres' longitudinal force"] = process_seconds(*run, cache=empty)
        return [Row("first run", name, 0.0, seconds, False) for name, seconds in times.items()]

    glanced = measured


def _car() -> str:
    return Path(SCENES, "car_on_bushings.yaml").read_text(encoding="utf-8")


BENCHMARKS = (Start("start"), LongScene("long_scene"), FirstRun("first_run"))
