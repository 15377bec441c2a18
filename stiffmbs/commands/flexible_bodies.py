"""Commands on flexible bodies: ``stiffmbs flexible`` and ``stiffmbs stresses``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError, prefixed
from .process import Status
from .scene import (
    CHANGES,
    changes_of,
    is_written,
    option,
    output_option,
    refuse_file,
    refusing,
    solve_scene,
    solving_options,
)


@click.command(short_help="Reduction of a flexible body.")
@click.argument("body")
@option("--hold NAME,... ...", "Also list the frequencies with these interfaces fixed", "held")
@option("-o, --output PATH", "Write the nodes and the mode shapes for ParaView: .vtu.")
@option("--json", "Print one JSON object on one line instead of text.", "as_json")
@CHANGES
def flexible(
    body: str, held: tuple[str, ...], output: Path | None, as_json: bool, changes: list[tuple[str, str]]
) -> None:
    """Reduce a flexible BODY, described in a YAML file, and report mass, frequencies and quality of the reduction.

    BODY has mesh and material, or matrices, and units, interfaces and modes.

    Exit status: 0 done, 1 a file could not be written, 2 the input is wrong.
    """
    from ..flexible_bodies.read import read_flexible_body
    from ..flexible_bodies.reduced import reduced_body
    from ..show.flexible_body import flexible_body_as_dict, flexible_body_text, write_shapes
    from .progress import ProgressBar

    with refusing(body, as_json):
        refuse_file("-o", output, body, "mode shapes")
        described = read_flexible_body(body, changes)
        names, folder = list(described.interfaces), Path(body).parent
        sets = {text: [_number(name, names) for name in text.split(",")] for text in held}
        with prefixed(f"{body}: "), ProgressBar(0.0, 0.0):
            found = reduced_body(described, folder)
        frequencies = {f"{text} held": found.held_frequencies(numbers) for text, numbers in sets.items()}
    written = is_written(output, lambda path: write_shapes(path, described.model(folder), found))
    report = body, found, names, frequencies
    click.echo(json.dumps(flexible_body_as_dict(*report)) if as_json else flexible_body_text(*report))
    sys.exit(Status.DONE if written else Status.FAILED)


def _number(name: str, names: list[str]) -> int:
    if name.strip() not in names:
        raise InputError(
            f"--hold {name.strip()}: found no such interface, expected one of {', '.join(names) or 'none'}"
        )
    return names.index(name.strip())


@click.command(short_help="Deformation and stresses of a flexible body.")
@click.argument("scene")
@click.argument("body")
@click.argument("results", required=False, type=click.Path(path_type=Path))
@output_option("Write the deformed mesh with its stresses over time for ParaView: .xdmf.")
@option("--node INTEGER ...", "Also report the displacement of this node (numbers from 0)", "nodes")
@option("--scale FLOAT", "Factor of the deformation in the file.", default=1.0)
@option("--every INTEGER RANGE", "Write every n-th output time.", default=1)
@option("--json", "Print one JSON object on one line instead of text.", "as_json")
@solving_options
def stresses(
    scene: str, body: str, results: Path | None, output: Path | None, nodes: tuple[int, ...], scale: float, every: int,
    as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Run SCENE, or read its RESULTS (.npz), and report stresses and strain energy of its flexible BODY.

    Exit status: 0 done, 1 stopped early or not written, 2 the input is wrong.
    """
    from ..results.flexible_motion import FlexibleMotion
    from ..results.solution import Solution
    from ..show.flexible_body import flexible_motion_as_dict, flexible_motion_text

    with refusing(scene, as_json, output):
        refuse_file("-o", output, scene, "deformation")
        loaded = load_scene(scene, changes_of(options))
        FlexibleMotion.check(loaded, body)
        solution = Solution.load(results) if results is not None else solve_scene(scene, loaded, as_json)
        with prefixed(f"{scene}: bodies.{body}: "):
            motion = FlexibleMotion(loaded, solution, body)
            motion.displacement(nodes, slice(0, 0))
        report = flexible_motion_as_dict(scene, motion, nodes)
    written = is_written(output, lambda path: motion.write(path, slice(None, None, every), scale))
    click.echo(json.dumps(report) if as_json else flexible_motion_text(report))
    sys.exit(Status.DONE if written and solution.success else Status.FAILED)
