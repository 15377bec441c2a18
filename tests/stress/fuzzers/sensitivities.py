"""Compare sensitivities of random scenes with differences of runs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.errors import InputError, StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.settings import changed as changed_settings
from stiffmbs.solve.trajectory import Outcome as Ending
from stiffmbs.studies.outputs import Output, outputs_of
from stiffmbs.studies.sensitivities.parameters import Scenes
from stiffmbs.studies.sensitivities.sensitivities import differentiated

from ..case import Outcome, Verdict, measured, told
from ..random_scenes.events import random_events
from ..random_scenes.scene import random_scene

WHAT = "sensitivities of random channels and functionals by random numbers of random scenes against differences of runs"
ALL_KINDS = 0.1
"""Fraction of scenes with all kinds of elements, which take longest to compile."""
FUNCTIONALS = (
    "final(?)",
    "?",
    "peak(?)",
    "max(?)",
    "min(?)",
    "integral(?)",
    "mean(?)",
    "rms(?)",
    "final(?^2)",
    "integral(abs(?))",
)
OUTPUTS = 12
STEP, RTOL = 5e-4, 1e-11
"""Step of differences, relative to the number, and tolerance of their runs."""
AGAIN: tuple[tuple[float, dict[str, Any]], ...] = (
    (1 / 300, {"solver": "bdf"}),
    (1.0, {"solver": "projected", "scheme": "dop853"}),
)
"""Fraction of the step, and solver, with which differences are repeated that do not agree: an event or a kink may be as near as the
step, and bdf's rounding may be as large as a channel that is zero."""
OFF, NOISE = 1e-4, 1e-10
"""Allowed relative error of a derivative; and error of runs, relative to the peak of the output."""
SMALL = 1e-4
"""Size, SI units, of outputs that may be zero up to rounding."""
UNSETTLED = 0.02
"""Difference between two step sizes, relative to the derivative, above which differences are not used as a reference."""
SOLVERS = "bdf", "bdf", "radau"
"""Solvers of the runs along which sensitivities are integrated, by the seed."""
SECTIONS = ("parameters", "bodies", "joints", "forces", "states", "gravity")
Path = tuple[str | int, ...]


def trial(seed: int) -> Verdict:
    """Test one number of a scene, planar for even seeds."""
    rng = np.random.default_rng(seed)
    dimensions = 2 + seed % 2
    content = random_scene(rng, dimensions) if rng.random() < ALL_KINDS else random_events(rng, dimensions)
    try:
        known = run(_read(content))
    except StiffmbsError as refusal:
        return told(f"the scene: {refusal}", ())
    outputs = _outputs(rng, known)
    scenes, paths = Scenes.of_model(_read(content)), list(numbers_of(content))
    rng.shuffle(paths)
    for path in map(tuple, paths[:8]):
        name = ".".join(map(str, path[1:] if path[0] == "parameters" else path))
        try:
            run_with = differentiated(scenes, [name], changed_settings(scenes.known.run, {"solver": SOLVERS[seed % 3]}))
            found = run_with.sensitivities([output.text for output in outputs])
        except InputError:
            continue  # a number that changes the structure, or none that the scene keeps
        except StiffmbsError as refusal:
            return told(f"{name}: {refusal}", ())
        slopes = {each.of: each.to[name] for each in found}
        return _judged(content, path, name, slopes, outputs)
    return told("no number of the scene can be changed", ())


def _read(content: Any) -> Any:
    return read_scene(json.dumps(content))


def _outputs(rng: np.random.Generator, solution: Solution) -> tuple[Output, ...]:
    """Return functionals of random channels."""
    channels = [name for name in solution if not name.startswith("constraint.")]
    texts = {
        str(rng.choice(FUNCTIONALS)).replace("?", name)
        for name in rng.choice(channels, min(OUTPUTS, len(channels)), replace=False)
    }
    return outputs_of(sorted(texts))


def numbers_of(content: Any, path: Path = ()) -> Iterator[Path]:
    """Yield the paths of the numbers of a scene."""
    items = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, part in items:
        if not path and key not in SECTIONS:
            continue
        if isinstance(part, float):
            yield (*path, key)
        yield from numbers_of(part, (*path, key))


def changed(content: Any, path: Path, value: float) -> Any:
    """Return a scene with another number."""
    found = json.loads(json.dumps(content))  # no part is shared
    at = found
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return found


def _judged(content: Any, path: Path, name: str, slopes: dict[str, Any], outputs: tuple[Output, ...]) -> Verdict:
    value = content
    for key in path:
        value = value[key]
    step = STEP * (abs(value) or 1.0)
    compared = _compared(content, path, value, step, slopes, outputs, AGAIN[0][1])
    if isinstance(compared, str):
        return told(f"{name} {compared}", ())
    for part, how in AGAIN:
        off = tuple(output for output in outputs if output.text in compared and compared[output.text][0] > 1.0)
        other = _compared(content, path, value, part * step, slopes, off, how) if off else {}
        if isinstance(other, str):
            return told(f"{name} {other}", ())
        compared |= {text: min(found, compared[text]) for text, found in other.items()}
    if not compared:
        return Verdict(Outcome.TOLD, detail=f"differences by {name} do not settle")
    text, (worst, detail) = max(compared.items(), key=lambda item: item[1])
    return measured(worst, 1.0, f"{text} by {name} = {value:g}: {detail}")


def _compared(
    content: Any,
    path: Path,
    value: float,
    step: float,
    slopes: dict[str, Any],
    outputs: tuple[Output, ...],
    how: dict[str, Any],
) -> dict[str, tuple[float, str]] | str:
    """Return the errors over what is allowed, by output with differences that settle; or why a run was not made."""
    runs = {}
    for shift in (-2, -1, 1, 2):
        try:
            found = run(_read(changed(content, path, value + shift * step)), rtol=RTOL, **how)
        except StiffmbsError as refusal:
            return f"{shift * step:+g}: {refusal}"
        if found.outcome is not Ending.DONE:
            return f"{shift * step:+g}: {found.message}"
        runs[shift] = found
    errors = {}
    for output in outputs:
        values = {shift: np.asarray(output.value(found)) for shift, found in runs.items()}
        near, far = (values[1] - values[-1]) / (2 * step), (values[2] - values[-2]) / (4 * step)
        expected, spread = (4 * near - far) / 3, np.abs(near - far)
        size = float(np.max(np.abs(expected)))
        noise = NOISE * max(float(np.max(np.abs(values[1]))), SMALL) / step
        if np.max(spread) > UNSETTLED * size + noise:
            continue
        allowed = OFF * size + np.max(spread) + noise
        error = float(np.max(np.abs(slopes[output.text] - expected)))
        detail = f"{np.ravel(slopes[output.text])[-1]:.8g} of {np.ravel(expected)[-1]:.8g}"
        ratio = error / allowed if allowed else 0.0
        errors[output.text] = (ratio if np.isfinite(ratio) else np.inf, detail)
    return errors
