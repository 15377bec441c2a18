"""The command ``stiffmbs report``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..describe.files.text_file import STANDARD_INPUT, file_text
from ..errors import StiffmbsError
from ..jobs.load_scene import load_scene
from .scene import (  # fmt: skip
    STOPPED_EARLY,
    changes_of,
    file_beside,
    refuse,
    refuse_own_input,
    solve_scene,
    solving_options,
)

if TYPE_CHECKING:
    from ..describe.scene import Scene
    from ..show.sections import Section


@click.command(short_help="One page on a scene and its run.")
@click.argument("scene")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Where to write the page: .html.")
@click.option("--verify/--no-verify", default=True, show_default=True, help="Whether peaks get error bars.")
@click.option("--equilibrium", is_flag=True, help="With the static equilibrium.")
@click.option("--compare", is_flag=True, help="With run time against error of bdf, dop853 and auto.")
@solving_options
def report(scene: str, output: Path | None, verify: bool, equilibrium: bool, compare: bool, **options: Any) -> None:
    """Check and solve SCENE and write one page on it: findings, settings, peaks with error bars, figures, the solver's steps.

    Where there is no equilibrium or no reference for a comparison, the page says why.
    Exit status: 0 done, 1 stopped early (the page is written all the same), 2 the input is wrong.
    """
    from ..show.report import check_report, write_report

    path = output or file_beside(scene, ".report.html")
    try:
        check_report(path)
        refuse_own_input("-o", scene, path)
        loaded = load_scene(scene, changes_of(options))
        solution = solve_scene(scene, loaded, verify)
        asked = {"equilibrium": equilibrium, "compare": compare}
        sections = [_section(name, loaded) for name, wanted in asked.items() if wanted]
        text = "" if scene == STANDARD_INPUT else file_text(scene)
        write_report(path, loaded, solution, text, sections)
    except StiffmbsError as error:
        refuse(scene, error)
    except OSError as error:
        click.echo(f"stiffmbs: not written: {path}: {error.strerror}", err=True)
        sys.exit(STOPPED_EARLY)
    for note in solution.notes:
        click.echo(f"note: {note}")
    click.echo(f"report: {path}")
    sys.exit(0 if solution.outcome.name == "DONE" else STOPPED_EARLY)


def _section(name: str, scene: Scene) -> Section:
    """What is asked for besides, or why there is none."""
    from ..show.sections import Section

    try:
        return SECTIONS[name](scene)
    except StiffmbsError as error:
        return Section(TITLES[name], (f"none: {error}",))


def _equilibrium(scene: Scene) -> Section:
    from ..jobs.equilibrium import equilibrium
    from ..show.sections import equilibrium_section

    return equilibrium_section(equilibrium(scene), scene)


def _compared(scene: Scene) -> Section:
    from ..comparison.compare import compare
    from ..comparison.report_section import comparison_section

    return comparison_section(compare(scene))


SECTIONS = {"equilibrium": _equilibrium, "compare": _compared}
TITLES = {"equilibrium": "Static equilibrium", "compare": "Solvers compared"}
