"""What assembly moves: `check` names every body with its move, the largest first, and takes large ones for problems."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from stiffmbs import spatial
from stiffmbs.analyses.check import check
from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.model.model_builder import ModelBuilder
from stiffmbs.reading.marker import Marker

from ...case import Case, Outcome, Verdict, measured, told

SHIFTS = (0.02, 3.0, 0.5, 1e-6, 0.1, 0.004, 0.9)
"""Of bodies from the places where fixed joints hold them, m."""
ROUNDED = 2e-12
"""Error of a move: assembly ends where gaps are below 1e-12."""


def held(shifts: Mapping[str, float], turns: Mapping[str, float]) -> Model:
    """Bodies of the plane that fixed joints hold to the ground, drawn off by shifts along y and by turns."""
    model = Model("Held")
    for k, name in enumerate(shifts):
        model.add(name, Body(mass=1, inertia=1, position=(k, -shifts[name]), angle=-turns.get(name, 0.0)))
        model.add(f"weld_{name}", JOINTS["fixed"](i=name, j=Marker(body="ground", point=(k, 0))))
    return model


def held_in_space(shifts: Mapping[str, float], turns: Mapping[str, float]) -> spatial.Model:
    """The same in space, turned about the y axis."""
    model = spatial.Model("Held in space")
    for k, name in enumerate(shifts):
        half = turns.get(name, 0.0) / 2
        turned = (math.cos(half), 0.0, -math.sin(half), 0.0)
        body = spatial.Body(mass=1, inertia=(1, 1, 1), position=(k, 0, -shifts[name]), orientation=turned)
        model.add(name, body)
        model.add(f"weld_{name}", spatial.Fixed(i=name, j=spatial.Marker(body="ground", point=(k, 0, 0))))
    return model


def slider_crank(wrong: float) -> Model:
    """A slider-crank drawn stretched out, a marker of whose rod is off by a length."""
    model = Model("Slider-crank", gravity=(0, -9.81))
    crank = model.add("crank", Body(mass=1, inertia=0.1, position=(0.1, 0)))
    rod = model.add("rod", Body(mass=1, inertia=0.1, position=(0.45, 0)))
    slider = model.add("slider", Body(mass=1, inertia=0.1, position=(0.7, 0)))
    model.add("shaft", JOINTS["revolute"](i=crank.at(-0.1, 0), j="ground"))
    model.add("big_end", JOINTS["revolute"](i=rod.at(-0.25, 0), j=crank.at(0.1, 0)))
    model.add("small_end", JOINTS["revolute"](i=slider.at(0, 0), j=rod.at(0.25 + wrong, 0)))
    model.add("bore", JOINTS["prismatic"](i="slider", j="ground"))
    return model


Build = Callable[[Mapping[str, float], Mapping[str, float]], ModelBuilder]


def _all_named(build: Build, shifts: Mapping[str, float], turns: Mapping[str, float], problem: bool) -> Verdict:
    """Every body's move against what it was drawn off by, and the message's order."""
    report = check(build(shifts, turns))
    found = {move.body: (move.distance, abs(move.turn)) for move in report.moved}
    expected = {name: (abs(shifts[name]), abs(turns.get(name, 0.0))) for name in shifts}
    expected = {name: much for name, much in expected.items() if max(much) > 1e-9}
    if found.keys() != expected.keys():
        return Verdict(Outcome.WRONG, detail=f"found moves of {sorted(found)}, expected {sorted(expected)}")
    error = max((float(np.max(np.abs(np.subtract(found[n], expected[n])))) for n in expected), default=0.0)
    sentence = next((message for message in report.messages if "assembly changed" in message), "")
    order = sorted(expected, key=lambda name: sentence.find(f"{name}."))
    if len(turns) == 0 and order != sorted(expected, key=lambda name: -expected[name][0]):
        return Verdict(Outcome.WRONG, detail=f"not the largest first: {sentence}")
    if report.sound == problem:
        return Verdict(Outcome.WRONG, detail=f"{'sound' if problem else 'a problem'}: {sentence}")
    return told(sentence, tuple(expected), error, ROUNDED) if expected else measured(0.0, 0.0)


def _rod(wrong: float, problem: bool) -> Verdict:
    """Stretched out, a rod longer by a length moves the slider by it, or back by it."""
    model = slider_crank(wrong)
    report = check(model)
    move = max(report.moved, key=lambda part: part.distance)
    notes = "; ".join(run(model, duration=1e-3, points=2).notes)
    if report.sound == problem:
        return Verdict(Outcome.WRONG, detail=f"{'sound' if problem else 'a problem'}: {report.messages}")
    error = abs(move.distance - abs(wrong)) / abs(wrong)
    return told("; ".join((*report.messages, notes)), (f"slider.x by {wrong:.3g} m", "assembly changed"), error, 1e-6)


def _some(many: int) -> dict[str, float]:
    return {f"part{k}": SHIFTS[k % len(SHIFTS)] * (1 + k // len(SHIFTS)) for k in range(many)}


def _case(name: str, build: Build, shifts: Mapping[str, float], turns: Mapping[str, float], problem: bool, expected: Outcome = Outcome.TOLD) -> Case:  # fmt: skip
    judge = partial(_all_named, build, shifts, turns, problem)
    return Case(name, "the moves of all bodies against what they are drawn off by", judge, expected)


RIGHT_ANGLE = math.pi / 2

CASES = (
    *(
        Case(f"marker of a rod off by {wrong:g} m", "the slider's move", partial(_rod, wrong, wrong > 0.3), Outcome.TOLD)
        for wrong in (500.0, 5.0, 0.5, 0.05, 1e-4)
    ),
    *(_case(f"{many} bodies off in the plane", held, _some(many), {}, True) for many in (2, 7, 30)),
    *(_case(f"{many} bodies off in space", held_in_space, _some(many), {}, True) for many in (2, 7, 30)),
    _case("one body turned by 90 deg in the plane", held, {"a": 0.0, "b": 0.0}, {"b": RIGHT_ANGLE}, True),
    _case("one body turned by 50 deg in space", held_in_space, {"a": 0.0, "b": 0.0}, {"b": 0.873}, True),
    _case("bodies turned by 60, 5 and 0.1 deg", held, dict.fromkeys("abcd", 0.0), {"a": 1.047, "b": 0.087, "c": 0.0017}, True),
    _case("a body turned by 20 deg corrects a drawing", held, {"a": 0.0, "b": 0.1}, {"b": 0.35}, False),
    _case("off by 1e-6 m is told and sound", held, {"a": 1e-6, "b": 0.0, "c": -2e-6}, {}, False),
    _case("drawn to the last digit", held_in_space, {"a": 0.0, "b": 1e-14}, {}, False, Outcome.RIGHT),
)  # fmt: skip
