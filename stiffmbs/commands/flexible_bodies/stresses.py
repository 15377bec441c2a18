"""The command ``stiffmbs stresses``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ...analyses.load_scene import load_scene
from ...errors import InputError
from ..process import Status
from ..scene import changes_of, is_written, output_option, refuse_own_input, refusing, solve_scene, solving_options


@click.command(short_help="Deformation and stresses of a flexible body.")
@click.argument("scene")
@click.argument("body")
@click.argument("results", required=False, type=click.Path(path_type=Path))
@output_option("Write the deformed mesh with its stresses over time for ParaView: .xdmf.")
@click.option("--node", "nodes", multiple=True, type=int, help="Report the displacement of a node too, from 0.")
@click.option("--scale", type=float, default=1.0, show_default=True, help="Factor of the deformation in the file.")
@click.option("--every", type=click.IntRange(1), default=1, show_default=True, help="Write every n-th output time.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of text.")
@solving_options
def stresses(
    scene: str, body: str, results: Path | None, output: Path | None, nodes: tuple[int, ...], scale: float, every: int,
    as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Run SCENE, or read its RESULTS (.npz), and report stresses and strain energy of its flexible BODY.

    Exit status: 0 done, 1 stopped early or not written, 2 the input is wrong.
    """
    from ...results.flexible_motion import FlexibleMotion
    from ...results.solution import Solution
    from ...show.flexible_body import flexible_motion_as_dict, flexible_motion_text

    with refusing(scene, as_json, output):
        if output is not None:
            if output.suffix.lower() != ".xdmf":
                raise InputError(f"-o {output}: found the type '{output.suffix}', expected .xdmf")
            refuse_own_input("-o", scene, output)
        loaded = load_scene(scene, changes_of(options))
        FlexibleMotion.check(loaded, body)
        solution = Solution.load(results) if results is not None else solve_scene(scene, loaded, as_json)
        try:
            motion = FlexibleMotion(loaded, solution, body)
            motion.displacement(nodes, slice(0, 0))
        except InputError as error:
            raise InputError(f"{scene}: bodies.{body}: {error}") from None
        report = flexible_motion_as_dict(scene, motion, nodes)
    written = output is None or is_written(output, lambda: motion.write(output, slice(None, None, every), scale))
    click.echo(json.dumps(report) if as_json else flexible_motion_text(report))
    sys.exit(Status.DONE if written and solution.success else Status.FAILED)
