"""The commands ``stiffmbs sensitivities``, ``fit`` and ``optimise``."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
from ..notes import note_lines
from .process import Status
from .scene import assigned, changes_of, in_file, option, refusing, several, solving_options

if TYPE_CHECKING:
    from ..studies.fit import Fit
    from ..studies.optimise import Optimum
    from ..studies.sensitivities.sensitivities import Sensitivity


@click.command(short_help="Derivatives of an output by parameters.")
@click.argument("scene")
@option("--to NAME,NAME... ...", "Parameters, or paths of numbers such as bodies.bar.mass", required=True)
@option(
    "--of FORMULA",
    "The output: peak, max, min, final, first, rms, mean or integral of channels, and formulas of them.",
    required=True,
)
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@solving_options
def sensitivities(scene: str, to: tuple[str, ...], of: str, as_json: bool, **options: object) -> None:
    """Compute derivatives of an output of SCENE by parameters, by forward sensitivity analysis along the steps of bdf
    or radau.

    Exit status: 0 done, 1 the run stopped early or is not differentiable there, 2 the input is wrong.
    """
    from ..studies.outputs import outputs_of
    from ..studies.sensitivities.sensitivities import sensitivities as found_sensitivities

    with refusing(scene, as_json):
        names = [name.strip() for part in to for name in part.split(",") if name.strip()]
        (output,) = outputs_of(of)
        if output.is_series:
            raise InputError(f"--of {of}: found a channel over time, expected a number such as peak({of})")
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            found = found_sensitivities(loaded, names, of)
    click.echo(json.dumps(found.as_dict(scene)) if as_json else _text(found))


def _text(found: Sensitivity) -> str:
    lines = [f"{found.of} = {found.value:.8g}"]
    width = max(map(len, found.to))
    lines += [f"  d/d {name:{width}s}  {slope: .8g}" for name, slope in found.to.items()]
    return "\n".join([*lines, *note_lines(found.notes)])


_search_options = several(
    option("--parameter NAME=FROM:TO[:log] ...", "Parameter or path to determine, with its bounds", "parameters", required=True),
    option("--start NAME=VALUE ...", "Initial value of the search"),
    option("--json", "Print one JSON object on one line instead of a table.", "as_json"),
)  # fmt: skip


@click.command(short_help="Fit parameters to measured channels.")
@click.argument("scene")
@option("--data FILE", "Measured channels over time: .csv, .npz or .nc.", required=True)
@_search_options
@solving_options
def fit(
    scene: str, data: str, parameters: tuple[str, ...], start: tuple[str, ...], as_json: bool, **options: object
) -> None:
    """Fit parameters of SCENE to the channels in FILE, with 95 % confidence intervals.

    Exit status: 0 done, 1 the search did not converge, 2 the input is wrong.
    """
    from ..studies.fit import fit as fitted

    with refusing(scene, as_json):
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            found = fitted(loaded, data, _ranges(parameters), start=_values(start))
    click.echo(json.dumps({"scene": scene, **found.as_dict()}) if as_json else _fit_text(found))
    sys.exit(0 if found.success else Status.FAILED)


@click.command(short_help="Find the parameters that minimise an output.")
@click.argument("scene")
@option("--minimise FORMULA", "Objective: 'rms(chassis.ay)'.", required=True)
@option("--keep 'FORMULA <= VALUE' ...", "A constraint, with <= or >=")
@_search_options
@solving_options
def optimise(
    scene: str, minimise: str, keep: tuple[str, ...], parameters: tuple[str, ...], start: tuple[str, ...], as_json: bool,
    **options: object,
) -> None:  # fmt: skip
    """Find the parameters of SCENE that minimise an output, within bounds and under constraints.

    Exit status: 0 done, 1 the search did not converge, 2 the input is wrong.
    """
    from ..studies.optimise import optimise as optimised

    with refusing(scene, as_json):
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            found = optimised(loaded, minimise, _ranges(parameters), _limits(keep), start=_values(start))
    click.echo(json.dumps({"scene": scene, **found.as_dict()}) if as_json else _optimum_text(minimise, found))
    sys.exit(0 if found.success else Status.FAILED)


def _ranges(parameters: tuple[str, ...]) -> dict[str, object]:
    from ..reading.variation import read_variation

    return {one.name: one for one in (read_variation(text, "--parameter") for text in parameters)}


def _values(pairs: tuple[str, ...]) -> dict[str, float]:
    from ..reading.variation import number

    return assigned("--start NAME=VALUE", pairs, number)


def _limits(keep: tuple[str, ...]) -> dict[str, tuple[float | None, float | None]]:
    from ..reading.variation import number

    found: dict[str, tuple[float | None, float | None]] = {}
    for text in keep:
        sign = "<=" if "<=" in text else ">="
        formula, between, bound = (part.strip() for part in text.partition(sign))
        if not between or not formula or not bound:
            raise InputError(f"--keep {text}: found no bound, expected such as 'peak(rail.fy) <= 100'")
        low, high = found.get(formula, (None, None))
        found[formula] = (low, number(bound)) if sign == "<=" else (number(bound), high)
    return found


def _fit_text(found: Fit) -> str:
    lines = [f"{found.message} ({found.runs} runs)"]
    for name, value in found.values.items():
        low, high = found.intervals[name]
        lines.append(f"  {name} = {value:.6g}, 95 % confidence interval {low:.6g} to {high:.6g}")
    lines += [f"  {name}: rms of model - data {rms:.4g}" for name, rms in found.residuals.items()]
    return "\n".join(lines)


def _optimum_text(minimise: str, found: Optimum) -> str:
    lines = [f"{found.message} ({found.runs} runs)", f"  {minimise}: {found.before:.6g} -> {found.objective:.6g}"]
    lines += [f"  {name} = {value:.6g}" for name, value in found.values.items()]
    lines += [f"  {name}: {value:.6g}" for name, value in found.constraints.items()]
    return "\n".join(lines)
