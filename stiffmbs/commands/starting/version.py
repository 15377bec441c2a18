"""The command ``stiffmbs version``."""

from __future__ import annotations

import json
import platform
import string

import click

from ...comparison.machine import installed

PACKAGE = "stiffmbs"
LETTERS = f"{string.ascii_letters}{string.digits}-_."
"""Characters of a package name, with which a requirement begins."""


@click.command("version", short_help="Show the versions of stiffmbs and of what it depends on.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def show_version(as_json: bool) -> None:
    """Show the versions of stiffmbs, Python, and every package it depends on, for bug reports."""
    found = {
        PACKAGE: installed(PACKAGE),
        "python": platform.python_version(),
        "platform": platform.platform(),
        **{name: installed(name) for name in dependencies()},
    }
    if as_json:
        click.echo(json.dumps(found))
        return
    for name, value in found.items():
        click.echo(f"{name:20} {value or 'not installed'}")


def dependencies() -> list[str]:
    """Return the packages that a plain run needs, without those of the extras."""
    from importlib.metadata import requires

    plain = [text for text in requires(PACKAGE) or () if "extra ==" not in text]
    return [text[: len(text) - len(text.lstrip(LETTERS))] for text in plain]
