"""The command ``stiffmbs fmu``."""

from __future__ import annotations

from pathlib import Path

import click

from ..scene import file_beside, output_option, refuse_own_input, refusing


@click.command(short_help="An FMU for co-simulation.")
@click.argument("scene")
@output_option("The FMU, .fmu; SCENE.fmu in the working folder without it.")
@click.option(
    "--channel",
    "outputs",
    multiple=True,
    help="An output of the FMU; the scene's requests, or all channels, without it.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def fmu(scene: str, output: Path | None, outputs: tuple[str, ...], as_json: bool) -> None:
    """Write SCENE as an FMU (FMI 2.0, co-simulation) with its inputs, parameters and channels.

    The FMU needs this package in the Python of the program that runs it (needs the extra fmu).

    Exit status: 0 done, 1 the FMU could not be written, 2 the input is wrong.
    """
    from ...show.summary import json_line
    from ...studies.fmu.build import build_fmu

    target = output or file_beside(scene, ".fmu")
    with refusing(scene, as_json):
        refuse_own_input("-o", scene, target)
        names = build_fmu(scene, target, outputs)
    told = f"fmu: {target}, {len(names)} outputs"
    click.echo(json_line({"scene": scene, "output": str(target), "outputs": list(names)}) if as_json else told)
