"""The command ``stiffmbs report``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import load_scene
from ..errors import StiffmbsError
from ..notes import note_lines
from ..reading.files.text_file import STANDARD_INPUT, file_text
from ..results.verification_words import INTERRUPTED
from .pictures import runs_of
from .process import Status
from .scene import changes_of, file_beside, option, output_option, refuse_file, refusing, solve_scene, solving_options

if TYPE_CHECKING:
    from ..model.scene import Scene
    from ..results.solution import Solution
    from ..show.sections import Section


@click.command(short_help="One page on a scene and its run.")
@click.argument("scene")
@click.argument("other", required=False)
@output_option("Where to write the page: .html.")
@option("--verify/--no-verify", "Whether peaks get error bars.", default=True)
@option("--equilibrium", "With the static equilibrium.")
@option("--compare", "Add run time against error of bdf, dop853 and auto.")
@option("--kc AXLE ...", "Add kinematics and compliance of an axle, such as front")
@option("--loads", "With the largest loads of all bushings.")
@solving_options
def report(
    scene: str, other: str | None, output: Path | None, verify: bool, equilibrium: bool, compare: bool, kc: tuple[str, ...], loads: bool,
    **options: object,
) -> None:  # fmt: skip
    """Check and solve SCENE and write a report: findings, settings, peaks with error bars, figures, solver steps.

    With OTHER, a scene or a file of results (.npz), the page begins with the differences of SCENE from OTHER, and shows both
    motions. Options such as --set apply to SCENE.

    If there is no equilibrium, no such axle or no reference for a comparison, the page states the reason.

    Exit status: 0 done, 1 stopped early (the page is written all the same), 2 the input is wrong.
    """
    from ..analyses.equilibrium import equilibrium as found_equilibrium
    from ..comparison.compare import compare as compared
    from ..comparison.table import comparison_section
    from ..show.modes import equilibrium_section
    from ..show.report import write_report
    from ..show.suspension import road_loads_section
    from ..studies.suspension.road_loads import road_loads

    path = output or file_beside(scene, ".report.html")
    with refusing(scene, output=path):
        refuse_file("-o", path, scene, "report")
        loaded = load_scene(scene, changes_of(options))
        compared_with = _run_of(other) if other else None
        solution = solve_scene(scene, loaded, verify)
        asked: list[tuple[bool, str, Callable[[], Section]]] = [
            (equilibrium, "Static equilibrium", lambda: equilibrium_section(found_equilibrium(loaded), loaded)),
            *((True, f"Kinematics and compliance: {axle}", partial(_of_axle, loaded, axle)) for axle in kc),
            (loads, "Road loads", lambda: road_loads_section(road_loads(loaded, {"run": solution}))),
            (compare, "Solvers compared", lambda: comparison_section(compared(loaded))),
        ]
        sections, complete = _sections([(title, made) for wanted, title, made in asked if wanted])
        text = "" if scene == STANDARD_INPUT else file_text(scene)
        write_report(path, loaded, solution, text, sections, compared_with)
    click.echo("\n".join([*note_lines(solution.notes), f"report: {path}"]))
    complete = complete and INTERRUPTED not in solution.verification
    sys.exit(0 if solution.outcome.name == "DONE" and complete else Status.FAILED)


def _of_axle(loaded: Scene, axle: str) -> Section:
    from ..show.suspension import kc_section
    from ..studies.suspension.kinematics_and_compliance import kinematics_and_compliance

    return kc_section(kinematics_and_compliance(loaded, axle))


def _run_of(other: str) -> tuple[str, Solution]:
    """Return the name and the run of another scene, or of a file of results."""
    solution = next(
        iter(runs_of(other, (), {"changes": [], **dict.fromkeys(("rtol", "duration", "solver", "scheme"))}).values())
    )
    return Path(other).name, solution


def _sections(asked: Sequence[tuple[str, Callable[[], Section]]]) -> tuple[list[Section], bool]:
    """Return requested sections, or the reasons why there is none, and False if the user interrupted one."""
    from ..show.sections import Section

    found: list[Section] = []
    for title, made in asked:
        try:
            found.append(made())
        except StiffmbsError as error:
            found.append(Section(title, (f"none: {error}",)))
        except KeyboardInterrupt:
            left = [title, *(other for other, _ in asked[len(found) + 1 :])]
            found += [Section(other, ("not computed: interrupted by the user",)) for other in left]
            return found, False
    return found, True
