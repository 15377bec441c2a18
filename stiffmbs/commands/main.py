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
from .exchange.diff import diff
from .exchange.fmu import fmu
from .fit import fit, optimise
from .modes import modes
from .plot import plot
from .process import Process
from .report import report
from .response import response
from .run import run
from .schema import schema
from .sensitivities import sensitivities
from .starting.examples import examples
from .starting.init import init
from .starting.parts import parts
from .starting.version import show_version
from .stress import stress
from .study import study
from .suspension.kc import kc
from .suspension.loads import loads
from .terminal.logging_options import with_logging_options

COMPLETION = """\b
Completion of commands and options by the Tab key, from the next shell on:
  bash  echo 'eval "$(_STIFFMBS_COMPLETE=bash_source stiffmbs)"' >> ~/.bashrc
  zsh   echo 'eval "$(_STIFFMBS_COMPLETE=zsh_source stiffmbs)"' >> ~/.zshrc
  fish  echo '_STIFFMBS_COMPLETE=fish_source stiffmbs | source' >> ~/.config/fish/config.fish
"""


@click.group(cls=Process, context_settings={"help_option_names": ["-h", "--help"]}, epilog=COMPLETION)
@click.version_option(package_name="stiffmbs")
def main() -> None:
    """Stiff multibody dynamics: motion and joint forces of mechanisms described in scenes.

    Begin with: stiffmbs init, stiffmbs run scene.yaml, stiffmbs examples list.
    """


for command in (
    run, check, equilibrium, modes, response, kc, loads, study, sensitivities, compare, fit, optimise, convert, diff, fmu, schema, bench, cache, draw, animate, plot, report, stress, init, examples, parts, show_version,
):  # fmt: skip
    main.add_command(with_logging_options(command))
