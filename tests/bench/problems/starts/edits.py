"""Processor time of first runs from an empty cache, and of the run after each kind of edit that follows.

No process finishes drafts during a measurement. An edit follows at once, or after the process that finishes drafts has ended.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from stiffmbs.cache.contents import FINISHING
from stiffmbs.compile.machine.finish import alone

from ...benchmark import Row
from .start_up import PROGRAM, process_seconds

ROUNDS = 5
EXAMPLES = Path(__file__).parents[4] / "examples"
CART, CAR, CRANK = "cart_pendulum", "car", "flexible/flexible_slider_crank"
SPRING = "    stiffness: 270 N/m\n"
FORCES = "forces:\n"
RACK = 'joint: steering.guide, position: "step5(t, 1, 0, 1.2, 5 mm)"'
Edit = tuple[str, tuple[str, ...], tuple[tuple[str, str], ...]]
"""Words for an edit, options of the command, and replacements in the text of the scene."""


def _solvers(*names: str) -> tuple[Edit, ...]:
    return tuple((f"solver {name}", ("--solver", name), ()) for name in names)


def _formulations(*names: str) -> tuple[Edit, ...]:
    options = ((name, ("--solver", "bdf", "--set", f"run.formulation={name}")) for name in names)
    return tuple((f"formulation {name}", option, ()) for name, option in options)


def _force(words: str, text: str) -> Edit:
    return words, (), ((FORCES, f"{FORCES}  added: {text}\n"),)


def _manoeuvre(name: str) -> Edit:
    return f"manoeuvre {name}", ("--set", f"choose.manoeuvre={name}"), ()


def _tyre(kind: str, words: str) -> Edit:
    fields = "radius: 0.3135, stiffness: 2e5, damping: 500, slip_stiffness: 8e4, cornering_stiffness: 6e4, mu_static: 1, mu_sliding: 0.8"
    kinds = ("type: magic_formula_tyre, ", f"type: {kind}, {fields}, ")
    return words, (), (kinds, ("properties: car.tir, ", ""), (", hand: -1", ""))


EDITS: dict[str, tuple[Edit, ...]] = {
    CART: (
        ("a number", (), ((SPRING, "    stiffness: 271 N/m\n"),)),
        ("a spring law", (), ((SPRING, f"{SPRING}    spring_law: 90*s + 300*s^3\n"),)),
        ("a damper law", (), ((SPRING, f"{SPRING}    damper_law: 2*tanh(v/0.01) + v\n"),)),
        ("a table as spring law", (), ((SPRING, "    spring_law: {table: [[-1, -250], [0, 0], [1, 290]]}\n"),)),
        _force("a force as formula", '{type: line_force, i: cart, j: bar, force: "-4*(dm(cart, bar) - 0.2) - vr(cart, bar)"}'),
        _force("a bushing", "{type: bushing, i: cart, j: ground, stiffness: [0, 100, 0], damping: [0, 1, 0]}"),
        _force("a torsion spring", "{type: torsion_spring, i: bar, j: cart, stiffness: 1, damping: 0.1}"),
        ("distance instead of revolute", (), (("type: revolute, i: cart, j: bar.end", "type: distance, i: cart, j: bar, length: L/2"),)),
        ("a drive", (), (("joints:\n", "joints:\n  motor: {type: drive, joint: rail, position: 0.1*sin(3*t)}\n"),)),
        *_solvers("bdf", "radau", "projected", "auto"),
        *_formulations("SI1", "I3", "index1"),
    ),
    CAR: (
        ("a number", (), (("mass: 1350 kg", "mass: 1351 kg"),)),
        _force("a force as formula", '{type: line_force, i: chassis, j: front.left.upright, force: "-900*(dm(chassis, front.left.upright) - 1.4)"}'),
        _force("a bushing with other zeros", "{type: bushing, i: chassis, j: front.left.upright, stiffness: [10, 0, 10, 0, 0, 0], damping: [0, 1, 0, 0, 0, 0]}"),
        ("a formula of the rack", ("--set", "choose.manoeuvre=step_steer"), (("step5(t, 1, 0, 1.2, 5 mm)", "step5(t, 1, 0, 1.2, 5 mm) + 1 mm*sin(9*t)*step(t, 2, 0, 3, 1)"),)),
        ("rigid joints", ("--set", "choose.compliance=rigid"), ()),
        *map(_manoeuvre, ("bump", "rough", "step_steer", "circle", "lane_change", "sine_sweep")),
        _tyre("fiala_tyre", "other tyres"),
        ("a road as table", (), (("{type: flat}", "{type: table, profile: {table: [[0, 0], [5, 0], [6, 0.01], [9, 0]]}}"),)),
        *_solvers("bdf", "radau", "projected"),
        *_formulations("SI1", "I3", "index1"),
    ),
    CRANK: (("another number of modes", (), (("modes: 4", "modes: 5"),)), *_solvers("bdf", "projected")),
}  # fmt: skip
FINISH = "from stiffmbs.compile.machine.finish import finish; finish()"
FIRST = (CART, "half_car", "heavy_top", CAR, CRANK)


@dataclass(frozen=True)
class FirstRuns:
    """Examples from an empty cache, and again."""

    name: str
    of: tuple[str, ...]

    def measured(self) -> list[Row]:
        """Medians."""
        return [row for example in self.of for row in _first(example, ROUNDS)]

    def glanced(self) -> list[Row]:
        """The first example, once."""
        return list(_first(self.of[0], 1))


@dataclass(frozen=True)
class Edits:
    """The first run after each edit of an example that has run once from an empty cache."""

    name: str
    example: str
    is_finished: bool

    def measured(self) -> list[Row]:
        """Medians."""
        return list(self._edited(EDITS[self.example], ROUNDS))

    def glanced(self) -> list[Row]:
        """The first edit, once."""
        return list(self._edited(EDITS[self.example][:1], 1))

    def _edited(self, edits: tuple[Edit, ...], rounds: int) -> Iterator[Row]:
        with tempfile.TemporaryDirectory() as folder:
            base = Path(folder)
            with alone(base / FINISHING):
                _run(_scene(base, self.example), base)
            if self.is_finished:
                process_seconds(sys.executable, "-c", FINISH, cache=folder)
            for words, options, changes in edits:
                seconds = [_after(base, self.example, options, changes) for _ in range(rounds)]
                yield Row(self.example, words, 0.0, statistics.median(seconds), False)


def _first(example: str, rounds: int) -> Iterator[Row]:
    first, second, read = [], [], []
    for _ in range(rounds):
        with _folder() as folder:
            scene = _scene(folder, example)
            first.append(_run(scene, folder))
            second.append(_run(scene, folder))
            read.append(process_seconds(*PROGRAM, "check", "--json", str(scene), cache=str(folder)))
    for setting, seconds in (("first run", first), ("second run", second), ("check after it", read)):
        yield Row(example, setting, 0.0, statistics.median(seconds), False)


def _after(base: Path, example: str, options: tuple[str, ...], changes: tuple[tuple[str, str], ...]) -> float:
    with _folder() as folder:
        shutil.copytree(base, folder, dirs_exist_ok=True)
        scene = folder / f"{example}.yaml"
        text = scene.read_text(encoding="utf-8")
        for before, after in changes:
            assert before in text, before
            text = text.replace(before, after)
        scene.write_text(text, encoding="utf-8")
        return _run(scene, folder, *options)


@contextmanager
def _folder() -> Iterator[Path]:
    """Provide a folder for scenes and a cache, in which no process finishes drafts."""
    with tempfile.TemporaryDirectory() as folder, alone(Path(folder, FINISHING)):
        yield Path(folder)


def _scene(folder: Path, example: str) -> Path:
    """Return a copy of an example, with the files next to it."""
    shutil.copytree(EXAMPLES, folder, dirs_exist_ok=True)
    return folder / f"{example}.yaml"


def _run(scene: Path, cache: Path, *options: str) -> float:
    output = scene.with_suffix(".npz")
    return process_seconds(*PROGRAM, "run", str(scene), "-q", "-o", str(output), *options, cache=str(cache))


BENCHMARKS = (
    FirstRuns("first_runs", FIRST),
    Edits("edits_of_cart_pendulum", CART, False),
    Edits("edits_of_car", CAR, False),
    Edits("edits_of_slider_crank", CRANK, False),
    Edits("later_edits_of_cart_pendulum", CART, True),
    Edits("later_edits_of_car", CAR, True),
    Edits("later_edits_of_slider_crank", CRANK, True),
)
