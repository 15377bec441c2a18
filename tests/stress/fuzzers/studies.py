"""Compare studies and simulations of random scenes with single runs."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome as Ending
from stiffmbs.studies.simulation import simulation
from stiffmbs.studies.sweep import sweep

from ..case import Outcome, Verdict, measured, told
from ..random_scenes.events import random_events
from ..random_scenes.scene import random_scene
from .sensitivities import Path, changed, numbers_of

WHAT = "cases of studies and stepwise simulations of random scenes against single runs, also with zeros that change the structure"
ALL_KINDS, SIMULATED = 0.1, 0.3
"""Fractions of scenes with all kinds of elements, and of scenes that are simulated."""
FACTORS = (0.0, 0.5, 1.0, 1.01, 2.0, -1.0)
OUTPUTS, RTOL = 8, 1e-8
GLOBAL, SMALL = 3e-5, 1e-3
"""Allowed error of outputs, relative to their peak, and the smallest peak, SI units."""

TIGHT, AS_FAR = 0.01, 30.0
"""Tolerance of the reference run of a simulation, relative to RTOL, and factor of its allowed error."""


def trial(seed: int) -> Verdict:
    """Test one scene, planar for even seeds."""
    rng = np.random.default_rng(seed)
    dimensions = 2 + seed % 2
    content = random_scene(rng, dimensions) if rng.random() < ALL_KINDS else random_events(rng, dimensions)
    how: dict[str, Any] = {"rtol": RTOL, "solver": str(rng.choice(["bdf", "auto", "projected"]))}
    return _simulated(rng, content, how) if rng.random() < SIMULATED else _studied(rng, content, how)


def _studied(rng: np.random.Generator, content: Any, how: dict[str, Any]) -> Verdict:
    """Vary one or two numbers, and compare each case with a run of the scene with these numbers."""
    paths = list(numbers_of(content))
    chosen = [paths[k] for k in rng.choice(len(paths), min(len(paths), int(rng.integers(1, 3))), replace=False)]
    chosen = [path for k, path in enumerate(chosen) if not k or _vector(path) != _vector(chosen[0])]
    grids = [
        [float(factor * _at(content, path)) for factor in rng.choice(FACTORS, 3, replace=False)] for path in chosen
    ]
    vary = {
        _name(path): [_at(changed(content, path, value), _vector(path)) for value in grid]
        for path, grid in zip(chosen, grids, strict=True)
    }
    detail = f"{how['solver']}: {vary}"
    try:
        known = run(_read(content), **how)
        channels = [name for name in known if not name.startswith("constraint.")]
        outputs = [f"final({name})" for name in rng.choice(channels, min(OUTPUTS, len(channels)), replace=False)]
        study = sweep(_read(content), vary, outputs=outputs, workers=int(rng.integers(1, 3)), **how)
    except StiffmbsError as refusal:
        return told(f"{refusal} [{detail}]", ())
    worst, worst_detail = 0.0, detail
    for place in np.ndindex(*(len(grid) for grid in grids)):
        values = [grid[k] for grid, k in zip(grids, place, strict=True)]
        names = (name if name in study.dims else f"{name}.number" for name in vary)  # vectors are numbered
        row = study.isel(dict(zip(names, place, strict=True)))
        error, found = _off(content, chosen, values, row, outputs, how)
        if not error <= worst:
            worst, worst_detail = error, f"{found} at {values}, {detail}"
    return measured(worst, GLOBAL, worst_detail)


def _off(
    content: Any, paths: list[Path], values: list[float], row: Any, outputs: list[str], how: Any
) -> tuple[float, str]:
    """Return by how much a case differs from a single run, relative to the peaks of the outputs."""
    for path, value in zip(paths, values, strict=True):
        content = changed(content, path, value)
    try:
        single = run(_read(content), **how)
    except StiffmbsError as refusal:
        return (0.0, "") if str(row["status"].item()) == "error" else (np.inf, f"a single run is refused: {refusal}")
    status = "done" if single.outcome is Ending.DONE else "stopped"
    if str(row["status"].item()) != status:
        return np.inf, f"{row['status'].item()} ({row['message'].item()}) of {status} ({single.message})"
    worst, found = 0.0, ""
    for text in outputs if status == "done" else ():
        series = single[text[len("final(") : -1]]
        error = abs(float(row[text]) - float(series[-1])) / max(float(np.max(np.abs(series))), SMALL)
        if not error <= worst:
            worst, found = error, f"{text} = {float(row[text]):.9g} of {float(series[-1]):.9g}"
    return worst, found


def _simulated(rng: np.random.Generator, content: Any, how: dict[str, Any]) -> Verdict:
    """Step to the end of the run, and compare all channels there."""
    scene = _read(content)
    how = {**how, "solver": "bdf"}
    try:
        single, coarser = (run(scene, **{**how, "rtol": rtol}) for rtol in (TIGHT * RTOL, RTOL))
    except StiffmbsError as refusal:
        return told(str(refusal), ())
    for each in (single, coarser):
        if each.outcome is not Ending.DONE:
            return told(each.message, ())
    steps, begin, end = int(rng.integers(1, 30)), float(single.time[0]), float(single.time[-1])
    try:
        stepped = simulation(scene, **how)
        for at in np.linspace(begin, end, steps + 1)[1:]:
            stepped.step(float(at - stepped.t))
        channels = stepped.channels
    except StiffmbsError as refusal:
        return Verdict(Outcome.WRONG, detail=f"a run is done, its simulation in {steps} steps is not: {refusal}")
    worst, detail = 0.0, ""
    for name in (name for name in single if not name.startswith("constraint.")):
        last, peak = float(single[name][-1]), float(np.max(np.abs(single[name])))
        allowed = GLOBAL * max(peak, SMALL) + AS_FAR * abs(float(coarser[name][-1]) - last)
        error = abs(channels[name] - last) / allowed
        if not error <= worst:
            worst, detail = error, f"{name} = {channels[name]:.9g} of {last:.9g} in {steps} steps"
    return measured(worst, 1.0, detail)


def _read(content: Any) -> Any:
    return read_scene(json.dumps(content))


def _at(content: Any, path: Path) -> Any:
    for key in path:
        content = content[key]
    return content


def _vector(path: Path) -> Path:
    """Return the path of the whole vector or matrix that a number is in."""
    whole = [k for k, key in enumerate(path) if isinstance(key, int)]
    return path[: whole[0]] if whole else path


def _name(path: Path) -> str:
    return ".".join(map(str, _vector(path)))
