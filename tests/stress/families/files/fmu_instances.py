"""Instances of FMUs in one process, by FMPy: valid descriptions, and each instance moves by its own parameter and inputs."""

from __future__ import annotations

import sys
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from stiffmbs.studies.fmu.build import build_fmu

from ...case import Case, Outcome, Verdict, measured
from ...fuzzers.fmu import SEGMENTS, STEPS, Given, by_fmpy
from ...variants.answers import with_files

MASS, DURATION, ALLOWED = 2.0, 1.0, 1e-6
SCENE = {
    2: """
name: NAME
parameters: {fmu_gain: 0.5}
inputs: {fmu_given: 0}
bodies: {b: {mass: 2, inertia: 1}}
joints: {rail: {type: prismatic, i: b, j: ground}}
forces: {f: {type: force, i: b, force: ["fmu_gain + fmu_given - STIFFNESS*b.x", 0]}}
run: {duration: 1, rtol: 1e-9, points: 21, solver: SOLVER}
""",
    3: """
name: NAME
dimensions: 3
parameters: {fmu_gain: 0.5}
inputs: {fmu_given: 0}
bodies: {b: {mass: 2, inertia: [1, 1, 1]}}
forces: {f: {type: force, i: b, force: ["fmu_gain + fmu_given - STIFFNESS*b.x", 0, 0]}}
run: {duration: 1, rtol: 1e-9, points: 21, solver: SOLVER}
""",
}
GIVEN = tuple(Given(0.3 * k - 1, (0.5 * k, -k, 2.0)) for k in range(6))


def expected(given: Given, stiffness: float) -> np.ndarray:
    """Return x and v after each communication step under forces that are constant within steps."""
    ends = np.linspace(0, STEPS, SEGMENTS + 1).astype(int)
    h, x, v, rows = DURATION / STEPS, 0.0, 0.0, []
    w = np.sqrt(stiffness / MASS)
    for number in range(STEPS):
        force = given.gain + given.inputs[int(np.searchsorted(ends, number, "right")) - 1]
        if stiffness:
            middle, c, s = force / stiffness, np.cos(w * h), np.sin(w * h)
            x, v = middle + (x - middle) * c + v / w * s, v * c - w * (x - middle) * s
        else:
            x, v = x + v * h + force / MASS * h**2 / 2, v + force / MASS * h
        rows.append((x, v))
    return np.array(rows)


def _judged(
    dimensions: int, stiffness: float, solver: str, name: str, counts: tuple[int, ...], folder: Path
) -> Verdict:
    """Judge one set of instances after the other, each with a file of its own of the same name."""
    text = SCENE[dimensions].replace("STIFFNESS", str(stiffness)).replace("SOLVER", solver).replace("NAME", name)
    (folder / "scene.yaml").write_text(text, encoding="utf-8")
    worst = 0.0
    for number, count in enumerate(counts):
        place = folder / str(number)
        place.mkdir()
        build_fmu(folder / "scene.yaml", place / "scene.fmu", ("b.x", "b.vx"))
        paths = list(sys.path)  # an FMU puts its own copy of PythonFMU before the installed one
        try:
            found, faults = by_fmpy(place / "scene.fmu", DURATION, list(GIVEN[:count]), ("b.x", "b.vx"))
        finally:
            sys.path[:] = paths
        if faults or any(rows is None for rows in found):
            return Verdict(Outcome.WRONG, detail=faults or "a step was refused")
        worst = max([worst, *(float(np.abs(rows - expected(each, stiffness)).max()) for rows, each in zip(found, GIVEN, strict=False) if rows is not None)])  # fmt: skip
    return measured(worst, ALLOWED)


VARIANTS = (
    (2, 0.0, "bdf", "one", (1,)), (2, 8.0, "bdf", "two", (2,)), (3, 8.0, "bdf", "three", (3,)), (2, 8.0, "projected", "four", (6,)), (3, 0.0, "auto", "five", (4,)),
    (2, 8.0, "auto", "class", (1, 1)), (3, 8.0, "projected", "a b", (2, 3)), (2, 0.0, "projected", "SceneSlave", (1, 2, 1)), (2, 50.0, "bdf", "same", (2,)), (2, 8.0, "bdf", "same", (2,)),
)  # fmt: skip
"""Dimensions, stiffness, N/m, solver, the scene's name, and how many instances the files have."""

CASES = tuple(
    Case(f"FMU '{name}' in {dimensions}D, {stiffness:g} N/m, {solver}: {' and '.join(map(str, counts))} instances", "closed form of each", partial(with_files, {}, partial(_judged, dimensions, stiffness, solver, name, counts)))
    for dimensions, stiffness, solver, name, counts in VARIANTS
    if find_spec("fmpy") and find_spec("pythonfmu")
)  # fmt: skip
"""None where FMPy or PythonFMU is missing."""
