"""The command ``stiffmbs tyre``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from ...errors import InputError
from ..process import Status
from ..scene import is_written, output_option, refuse_own_input, refusing


@click.command(short_help="Curves of a tyre; conversion of property files.")
@click.argument("file")
@click.option("--load", "loads", multiple=True, help="N, or with a unit; any number of times.")
@click.option("--pressure", "pressures", multiple=True, help="Pa, or with a unit, of 6.1 and 6.2; any number of times.")
@click.option("--camber", default="0", help="rad, or with a unit.")
@click.option("--speed", help="m/s, or with a unit; LONGVL by default.")
@click.option("--points", type=int, default=61, show_default=True, help="Of each curve.")
@click.option(
    "--at", "states", multiple=True, metavar="Fz,kappa,...",
    help="Evaluate one state of Fz, kappa, alpha, gamma, p, Vx, phit in SI units; any number of times.",
)  # fmt: skip
@output_option("Draw Fx, Fy, Mz and the friction ellipse: .png, .svg or .pdf.")
@click.option("--write", "copy", type=click.Path(path_type=Path), help="Write the properties that are used: .tir.")
@click.option("--unit", "units", multiple=True, metavar="LENGTH=mm", help="Unit of --write; any number of times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def tyre(
    file: str, loads: tuple[str, ...], pressures: tuple[str, ...], camber: str, speed: str | None, points: int,
    states: tuple[str, ...], output: Path | None, copy: Path | None, units: tuple[str, ...], as_json: bool,
) -> None:  # fmt: skip
    """Evaluate the tyre of FILE (.tir): forces over slip and slip angle, and the friction ellipse, in ISO axes.

    --load 2000 --load "4 kN" --pressure "220 kPa" draws the curves at two loads.  --write OTHER.tir --unit LENGTH=mm
    writes a file of the same evaluation in other units.

    Exit status: 0 done, 1 a file could not be written, 2 the input is wrong.
    """
    from ...elements.tyres.coefficients import TyreProperties
    from ...elements.tyres.written_file import property_text
    from ...results.files import refuse_path, write_text
    from ...show.figure import check_figure
    from ...show.tyre import draw_tyre, tyre_text
    from ...studies.tyre_curves import TyreSweep, tyre_curves, tyre_states

    with refusing(file, as_json):
        if output is not None:
            check_figure("-o", output)
        if copy is not None:
            refuse_path("--write", copy, (".tir",))
            refuse_own_input("--write", file, copy)
        properties = TyreProperties.from_file(file)
        sweep = TyreSweep(**{
            "load": loads, "pressure": pressures, "camber": camber, "points": points, **({} if speed is None else {"speed": speed}),
        })  # fmt: skip
        curves = tyre_curves(properties, sweep)
        found = tyre_states(properties, [_state(text) for text in states])
        text = property_text(properties, dict(map(_unit, units))) if copy is not None else ""
    title = f"{file}: Magic Formula {properties.version}, camber {sweep.camber:.4g} rad"
    written = copy is None or is_written(copy, lambda: write_text(copy, text))
    if output is not None:
        written = is_written(output, lambda: draw_tyre(output, title, curves)) and written
    notes = list(properties.notes())
    told = {
        "file": file, "version": properties.version, "camber": sweep.camber,
        "curves": [curve.as_dict() for curve in curves], "states": found, "notes": notes,
    }  # fmt: skip
    click.echo(json.dumps(told) if as_json else tyre_text(title, curves, found, notes))
    sys.exit(0 if written else Status.FAILED)


def _state(text: str) -> tuple[float, ...]:
    from ...studies.tyre_curves import STATE

    try:
        row = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--at {text}: found no numbers, expected up to {len(STATE)}: {','.join(STATE)}") from None
    if len(row) > len(STATE):
        raise InputError(f"--at {text}: found {len(row)} numbers, expected up to {len(STATE)}: {','.join(STATE)}")
    return row


def _unit(text: str) -> tuple[str, str]:
    kind, equals, unit = text.partition("=")
    if not equals:
        raise InputError(f"--unit {text}: found no unit, expected DIMENSION=UNIT such as LENGTH=mm")
    return kind.strip().upper(), unit.strip()
