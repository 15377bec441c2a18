"""The command ``stiffmbs sensitivities``."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
from .scene import changes_of, in_file, refusing, solving_options

if TYPE_CHECKING:
    from ..studies.sensitivities.sensitivities import Sensitivity


@click.command(short_help="Derivatives of an output by parameters.")
@click.argument("scene")
@click.option(
    "--to", "to", multiple=True, required=True, metavar="NAME,NAME...",
    help="Parameters, or paths of numbers such as bodies.bar.mass; any number of times.",
)  # fmt: skip
@click.option(
    "--of", required=True, metavar="FORMULA",
    help="The output: peak, max, min, final, first, rms, mean or integral of channels, and formulas of them.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@solving_options
def sensitivities(scene: str, to: tuple[str, ...], of: str, as_json: bool, **options: Any) -> None:
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
    return "\n".join(lines)
