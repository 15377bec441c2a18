"""Compare FMUs of random scenes, with and without Python, simulated by FMPy with changing inputs, with runs of the scenes."""

from __future__ import annotations

import json
import sys
import tempfile
import warnings
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.errors import InputError, StiffmbsError, needs
from stiffmbs.results.saved_state import SavedState
from stiffmbs.solve.trajectory import Outcome as Ending
from stiffmbs.studies.fmu.build import build_fmu
from stiffmbs.studies.fmu.standalone.library import compiler, own_platform
from stiffmbs.studies.fmu.standalone.model import exported_model

from ..case import Outcome, Verdict, measured, told
from ..random_scenes.features import ALL
from ..random_scenes.scene import random_scene

WHAT = "FMUs of random scenes in FMPy, with and without Python, one or several in a process, with changing inputs, against `run`."
GAIN, GIVEN, PUSH = "fmu_gain", "fmu_given", "fmu_push"
"""Parameter, input and force that are added to each scene."""
STEPS, SEGMENTS = 20, 3
"""Number of communication steps, and number of intervals with constant input."""
COSTLY = 0.1
"""Fractions of scenes with tyres and with parts, which take long to compile."""
RTOL = 1e-8
NATIVE = 0.5
"""Fraction of FMUs without Python."""
EXCHANGE_RTOL = 1e-10
"""Tolerance of the integrator for model exchange, which knows no sizes of coordinates."""
INDISTINCT = 1e-6
"""Part of the duration, and of a step, in which times count as one."""
BOUND = 1e-5
"""Allowed difference relative to the size of a channel: 1000 times the tolerance, because errors grow at events."""
OF_EXCHANGE = 10.0
"""Factor on it for model exchange: CVode has one tolerance for all states, and FMPy locates events less sharply."""
FLOOR = 1e-2
"""Smallest size of a channel, m, rad, and these per second."""
IN_DOUBT = "last digits", "more than one motion may follow"
"""Words of notes on motions that need not agree."""


@dataclass(frozen=True)
class Given:
    """Values of the parameter, and of the input in each interval, for one instance."""

    gain: float
    inputs: tuple[float, ...]


def has_compiler() -> bool:
    """Return True if FMUs without Python can be linked here."""
    try:
        return bool(compiler(own_platform()))
    except InputError:
        return False


def trial(seed: int) -> Verdict:
    """Build one FMU, and simulate one or more instances of it."""
    rng = np.random.default_rng(seed)
    content = _scene(rng)
    given = [
        Given(float(rng.uniform(-1, 1)), tuple(rng.uniform(-2, 2, SEGMENTS))) for _ in range(rng.choice([1, 1, 2, 4]))
    ]
    native = has_compiler() and bool(np.random.default_rng([seed, 1]).random() < NATIVE)
    detail = f"{('exchange' if seed % 2 else 'native') if native else 'Python'}, {content.get('dimensions', 2)}D, {len(given)} instances, {json.dumps(content)[:600]}"
    with tempfile.TemporaryDirectory() as made:
        scene, fmu = Path(made) / "scene.yaml", Path(made) / "scene.fmu"
        scene_text = json.dumps(content)
        scene.write_text(scene_text, encoding="utf-8")
        try:
            channels = _channels(scene)
            if native:
                channels, tunable = _built_without_python(scene, fmu, channels, given[0].gain)
                if not tunable:
                    given = [replace(each, gain=given[0].gain) for each in given]
            else:
                build_fmu(scene, fmu, channels)
            known = [_by_runs(scene, each, channels) for each in given]
        except StiffmbsError as refusal:
            return told(f"{refusal} [{detail}]", ())
        paths = list(sys.path)  # an FMU puts its own copy of PythonFMU before the installed one
        try:
            exchanged = native and seed % 2 == 1
            simulated = by_exchange if exchanged else by_fmpy
            found, faults = simulated(fmu, content["run"]["duration"], given, channels)
        finally:
            sys.path[:] = paths
    if faults:
        return Verdict(Outcome.WRONG, detail=f"{faults} [{detail}]")
    if any(rows is None for rows in found):
        return told(f"a step of the FMU was refused [{detail}]", ())
    errors = {
        name: max(_difference(rows[:, k], of_run[:, k]) for rows, (of_run, _) in zip(found, known, strict=True) if rows is not None)
        for k, name in enumerate(channels)
    }  # fmt: skip
    worst, bound = max(errors, key=lambda name: errors[name]), BOUND * (OF_EXCHANGE if exchanged else 1.0)
    if not errors[worst] <= bound and (own := _own_error(scene_text, given[0], channels, known[0][0], native)) > bound:
        return told(f"the motion itself is uncertain by {own:.1e} at this tolerance [{detail}]", ())
    doubts = [note for _, notes in known for note in notes if any(words in note for words in IN_DOUBT)]
    if doubts and not errors[worst] <= bound:
        return told(f"{doubts[0]} [{detail}]", ())
    return measured(errors[worst], bound, f"{worst}, {detail}")


def _own_error(text: str, given: Given, channels: tuple[str, ...], known: np.ndarray, native: bool) -> float:
    """Return the difference of a run from one of a smaller tolerance, relative to the channels; errors grow in some motions.

    `native`: True to compare a run by the integrator of FMUs without Python too.
    """
    with tempfile.TemporaryDirectory() as made:
        scene = Path(made) / "scene.yaml"
        content = json.loads(text)
        content["run"]["rtol"] = RTOL / 100
        scene.write_text(json.dumps(content), encoding="utf-8")
        finer, _ = _by_runs(scene, given, channels)
        rows = [known]
        if native:
            content["run"] |= {"rtol": RTOL, "solver": "projected"}
            scene.write_text(json.dumps(content), encoding="utf-8")
            rows.append(_by_runs(scene, given, channels)[0])
    return max(_difference(each[:, k], finer[:, k]) for each in rows for k in range(len(channels)))


def _scene(rng: np.random.Generator) -> dict[str, Any]:
    features = replace(ALL, tyres=bool(rng.random() < COSTLY), parts=bool(rng.random() < COSTLY))
    content = random_scene(rng, features=features)
    body = str(rng.choice(list(content["bodies"])))
    zeros = [0.0] * (content.get("dimensions", 2) - 1)
    content.setdefault("parameters", {})[GAIN] = 0.5
    content.setdefault("inputs", {})[GIVEN] = 0.0
    content.setdefault("forces", {})[PUSH] = {"type": "force", "i": body, "force": [f"{GAIN} + {GIVEN}", *zeros]}
    measures = ("dx", "dm", "az", "vm", "wz") if not zeros[1:] else ("dx", "dz", "ax", "az", "vx", "vm", "wz", "wm")
    chosen = deepcopy(rng).choice(measures, 2, replace=False)  # other draws stay the same
    own = [f"{measure}({body})" for measure in chosen]
    content["requests"] = {"fmu_first": own[0], "fmu_second": f"2*{own[1]} + {GAIN}*{body}.vx"}
    content["run"] |= {"rtol": RTOL, "points": STEPS + 1}
    return content


def _built_without_python(
    scene: Path, fmu: Path, channels: tuple[str, ...], gain: float
) -> tuple[tuple[str, ...], bool]:
    """Build an FMU without Python; return those of some channels that it has, and whether its parameter is tunable."""
    model = exported_model(load_scene(scene))
    tunable = GAIN in model.parameters
    changes = [] if tunable else [(f"parameters.{GAIN}", repr(gain))]
    found = tuple(name for name in channels if name in model.places)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of stiff scenes
        build_fmu(scene, fmu, found, changes, native=True)
    return found, tunable


def _channels(scene: Path) -> tuple[str, ...]:
    """Return the names of the positions and velocities of all bodies, of the states, and of requests; only collisions make them discontinuous."""
    data = load_scene(scene)
    labels = "x y angle vx vy omega" if data.dimensions == 2 else "x y z vx vy vz wx wy wz"
    bodies = [f"{body}.{label}" for body in data.bodies for label in labels.split()]
    return (*bodies, *data.states, *data.outputs())


def _by_runs(scene: Path, given: Given, channels: tuple[str, ...]) -> tuple[np.ndarray, list[str]]:
    """Return the channels after each communication step, by a run for each value of the input, shape (steps, channels); and notes."""
    whole = load_scene(scene)
    ends = np.linspace(0, STEPS, SEGMENTS + 1).astype(int)
    step, state, rows = whole.run.duration / STEPS, None, []
    notes: list[str] = []
    for value, first, last in zip(given.inputs, ends[:-1], ends[1:], strict=True):
        changes = [(f"parameters.{GAIN}", repr(given.gain)), (f"inputs.{GIVEN}", repr(float(value)))]
        part: SavedState | None = state
        solution = run(
            load_scene(scene, changes), start_from=part, start=first * step, duration=(last - first) * step, points=int(last - first) + 1
        )  # fmt: skip
        if solution.outcome is not Ending.DONE:
            raise StiffmbsError(solution.message)
        state = solution.state()
        notes += solution.notes
        rows.append(np.column_stack([solution[name][1:] for name in channels]))
    return np.vstack(rows), notes


def by_fmpy(
    fmu: Path, duration: float, given: list[Given], channels: tuple[str, ...]
) -> tuple[list[np.ndarray | None], str]:
    """Return the same from FMU instances that step in turn, or None if a step is refused; and the faults that FMPy finds."""
    with needs("fmpy", "test"):
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.validation import validate_fmu
    if faults := validate_fmu(str(fmu)):
        return [], f"the validation finds {faults}"
    about, folder = read_model_description(str(fmu)), extract(str(fmu), fmu.parent / "extracted")
    refs = {variable.name: variable.valueReference for variable in about.modelVariables}
    instances = []
    for k, each in enumerate(given):
        instance = FMU2Slave(
            guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier, instanceName=f"{fmu.stem}{k}"
        )  # fmt: skip
        instance.instantiate()
        instance.setupExperiment(startTime=0.0)
        instance.enterInitializationMode()
        values = {GAIN: each.gain, GIVEN: each.inputs[0]}
        instance.setReal(*zip(*[(refs[name], value) for name, value in values.items() if name in refs], strict=True))
        instance.exitInitializationMode()
        instances.append(instance)
    rows: list[Any] = [[] for _ in given]
    step, ends = duration / STEPS, np.linspace(0, STEPS, SEGMENTS + 1).astype(int)
    for number in range(STEPS):
        for k, (instance, each) in enumerate(zip(instances, given, strict=True)):
            if rows[k] is None:
                continue
            instance.setReal([refs[GIVEN]], [each.inputs[int(np.searchsorted(ends, number, "right")) - 1]])
            try:
                instance.doStep(number * step, step)
            except Exception:  # FMPy's own, for a status other than OK
                rows[k] = None
                continue
            rows[k].append(instance.getReal([refs[name] for name in channels]))
    for instance in instances:
        instance.terminate()
        instance.freeInstance()
    return [None if found is None else np.array(found) for found in rows], ""


def by_exchange(
    fmu: Path, duration: float, given: list[Given], channels: tuple[str, ...]
) -> tuple[list[np.ndarray | None], str]:
    """Return the same as `by_fmpy` from model exchange with the integrator CVode of FMPy."""
    with needs("fmpy", "test"):
        from fmpy import read_model_description, simulate_fmu
        from fmpy.validation import validate_fmu
    if faults := validate_fmu(str(fmu)):
        return [], f"the validation finds {faults}"
    names = {variable.name for variable in read_model_description(str(fmu)).modelVariables}
    rows: list[np.ndarray | None] = []
    ends = np.linspace(0, STEPS, SEGMENTS + 1).astype(int) * duration / STEPS
    for each in given:
        points = [(time, value) for value, *both in zip(each.inputs, ends[:-1], ends[1:], strict=True) for time in both]
        try:
            found = simulate_fmu(
                str(fmu), fmi_type="ModelExchange", start_values={GAIN: each.gain} if GAIN in names else {}, solver="CVode", relative_tolerance=EXCHANGE_RTOL, stop_time=duration,
                output_interval=duration / STEPS, output=list(channels), input=np.array(points, dtype=[("time", float), (GIVEN, float)]),
            )  # fmt: skip
        except Exception:  # FMPy's own, for a status other than OK
            rows.append(None)
            continue
        last = np.r_[np.diff(found["time"]) > INDISTINCT * duration, True]
        at = np.searchsorted(found["time"][last], (np.arange(STEPS) + 1 - INDISTINCT) * duration / STEPS)
        rows.append(np.column_stack([found[name][last][at] for name in channels]))
    return rows, ""


def _difference(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.max(np.abs(found - expected)) / max(float(np.max(np.abs(expected))), FLOOR))
