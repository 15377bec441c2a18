"""The command ``stiffmbs``: its subcommands have a file each."""

from __future__ import annotations

import click

from .terminal.subcommands import Subcommands

FILES = {
    "animate": "animate",
    "bench": "bench",
    "cache": "cache",
    "check": "check",
    "compare": "compare",
    "convert": "convert",
    "diff": "exchange.diff",
    "draw": "draw",
    "equilibrium": "equilibrium",
    "examples": "starting.examples",
    "fit": "fit",
    "fmu": "exchange.fmu",
    "init": "starting.init",
    "kc": "suspension.kc",
    "loads": "suspension.loads",
    "modes": "modes",
    "optimise": "fit",
    "parts": "starting.parts",
    "plot": "plot",
    "report": "report",
    "response": "response",
    "run": "run",
    "schema": "schema",
    "sensitivities": "sensitivities",
    "study": "study",
    "version": "starting.version:show_version",
}
"""The subcommands, and where they stand."""

COMPLETION = """\b
Completion of commands and options by the Tab key, from the next shell on:
  bash  echo 'eval "$(_STIFFMBS_COMPLETE=bash_source stiffmbs)"' >> ~/.bashrc
  zsh   echo 'eval "$(_STIFFMBS_COMPLETE=zsh_source stiffmbs)"' >> ~/.zshrc
  fish  echo '_STIFFMBS_COMPLETE=fish_source stiffmbs | source' >> ~/.config/fish/config.fish
"""


@click.group(cls=Subcommands, files=FILES, context_settings={"help_option_names": ["-h", "--help"]}, epilog=COMPLETION)
@click.version_option(package_name="stiffmbs")
def main() -> None:
    """Stiff multibody dynamics: motion and joint forces of mechanisms described in scenes.

    Begin with: stiffmbs init, stiffmbs run scene.yaml, stiffmbs examples list.
    """
