"""The command ``stiffmbs``: its subcommands have a file each."""

from __future__ import annotations

import click

from .animate import animate
from .bench import bench
from .cache import cache
from .check import check
from .compare import compare
from .convert import convert
from .draw import draw
from .equilibrium import equilibrium
from .fit import fit, optimise
from .modes import modes
from .plot import plot
from .process import Process
from .report import report
from .response import response
from .run import run
from .schema import schema
from .stress import stress
from .study import study


@click.group(cls=Process, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="stiffmbs")
def main() -> None:
    """Stiff multibody dynamics: motion and joint forces of mechanisms described in scenes."""


for command in (
    run, check, equilibrium, modes, response, study, compare, fit, optimise, convert, schema, bench, cache, draw, animate, plot, report, stress,
):  # fmt: skip
    main.add_command(command)
