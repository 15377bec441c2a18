"""Command ``stiffmbs`` with its subcommands, which are loaded on first use."""

from __future__ import annotations

import click

from .subcommands import Subcommands

SECTIONS = {
    "Start": {"init": "starting", "examples": "starting", "parts": "starting", "schema": "starting"},
    "Analyses of a scene": {
        "check": "check",
        "run": "run",
        "equilibrium": "equilibrium",
        "modes": "linearised",
        "response": "linearised",
    },
    "Flexible bodies": {"flexible": "flexible_bodies", "stresses": "flexible_bodies"},
    "Many runs": {
        "study": "study",
        "sensitivities": "fit",
        "fit": "fit",
        "optimise": "fit",
        "compare": "compare",
        "bench": "compare",
    },
    "Real time": {"realtime": "realtime"},
    "Suspensions and vehicles": {"kc": "vehicles", "loads": "vehicles", "handling": "vehicles"},
    "Tyres": {"tyre": "vehicles"},
    "Pictures and reports": {
        "draw": "pictures",
        "animate": "pictures",
        "plot": "pictures",
        "report": "report",
        "open": "starting:open_scene",
    },
    "Other programs": {"convert": "exchange", "diff": "exchange", "fmu": "exchange"},
    "Installation": {"cache": "cache", "version": "starting:show_version"},
}
"""Subcommands and their modules, by section of the help."""

COMPLETION = """\b
Completion of commands and options by the Tab key, from the next shell on:
  bash  echo 'eval "$(_STIFFMBS_COMPLETE=bash_source stiffmbs)"' >> ~/.bashrc
  zsh   echo 'eval "$(_STIFFMBS_COMPLETE=zsh_source stiffmbs)"' >> ~/.zshrc
  fish  echo '_STIFFMBS_COMPLETE=fish_source stiffmbs | source' >> ~/.config/fish/config.fish
"""


@click.group(
    cls=Subcommands, sections=SECTIONS, context_settings={"help_option_names": ["-h", "--help"]}, epilog=COMPLETION
)
@click.version_option(package_name="stiffmbs")
def main() -> None:
    """Stiff multibody dynamics: motion and joint forces of mechanisms described in scenes.

    Begin with: stiffmbs init, stiffmbs run scene.yaml, stiffmbs examples list.
    """
