"""Notes of all examples: ``python -m tests.stress.notes``.

    python -m tests.stress.notes [--solver NAME]... [--longer X]... [--finer X]... [--limit S] [--out FILE] [EXAMPLE...]

Runs examples with every solver, durations of 1 and 10 times their own, and 1/2, 1, 2 and 10 times their output points, and lists
their notes and what they say on their errors; at the end a table of notes by kind. EXAMPLEs are names of files without
``.yaml``; all by default, light ones first. ``--out`` appends the runs to a file as JSON lines and skips those in it.
``python -m tests.stress.self_assessment`` compares estimated errors with true ones.
"""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.settings import DEFAULT_POINTS

from .simulation import patience

EXAMPLES = Path(__file__).parents[2] / "examples"
SOLVERS = ("bdf", "radau", "auto", "projected")
LONGER = (1.0, 10.0)
FINER = (0.5, 1.0, 2.0, 10.0)
LIGHT = (
    "simple_pendulum", "cart_pendulum", "bar_pendulum", "crank_slider", "four_bar", "dead_centres",
    "bouncing_ball", "stick_slip", "cam_follower", "door", "heavy_top", "dzhanibekov", "rolling_disc",
    "spatial_slider_crank", "bricard", "andrews", "four_bars", "elastic_bearing", "quarter_car",
    "front_axle", "governor", "leaf_spring", "rotor", "cable", "chain", "spatial_chain", "half_car",
    "half_car_at_rest",
)  # fmt: skip
"""Examples that take little time, first."""


def paths(names: list[str]) -> Iterator[Path]:
    """Yield the files of examples, light ones first."""
    found = {path.stem: path for path in sorted(EXAMPLES.rglob("*.yaml")) if path.parent.name != "parts"}
    for name in names or [*LIGHT, *(other for other in found if other not in LIGHT)]:
        yield found[name]


def runs(asked: argparse.Namespace) -> Iterator[tuple[str, Path, dict[str, Any]]]:
    """Yield the names, files and settings of all runs."""
    for path in paths(asked.examples):
        for longer, finer, solver in product(asked.longer or LONGER, asked.finer or FINER, asked.solver or SOLVERS):
            yield (
                f"{path.stem} {solver} x{longer:g} points x{finer:g}",
                path,
                {"solver": solver, "longer": longer, "finer": finer},
            )


def outcome(path: Path, solver: str, longer: float, finer: float, limit: float) -> dict[str, Any]:
    """Return the notes of a run, what it says on its errors, and its true errors."""
    scene = load_scene(path)
    settings = scene.run
    points = settings.points
    if settings.output:
        points = int(settings.duration / settings.output) + 1
    if points == "steps":
        points = None
    duration = longer * settings.duration
    how: dict[str, Any] = {
        "solver": solver,
        "duration": duration,
        "points": max(2, int(finer * ((points or DEFAULT_POINTS) - 1)) + 1),
        "output": None,
    }
    try:
        found = run(scene, watch=patience(limit), **how)
    except StiffmbsError as refusal:
        return {"outcome": "refused", "message": str(refusal), "notes": []}
    estimate = getattr(found, "estimate", None)
    return {
        "outcome": found.outcome.value, "message": found.message, "notes": list(found.notes), "steps": found.solver.get("steps"),
        "seconds": found.solver.get("seconds"), "errors": estimate.sentence if estimate else "",
    }  # fmt: skip


def kind(note: str) -> str:
    """Return a note with names and numbers left out."""
    plain = re.sub(r"'[^']*'", "'*'", note)
    plain = re.sub(r"\b[\w]+(\.[\w]+)+\b(?<!\d)", "*", plain)
    return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", plain)[:110]


def main() -> None:
    """Run, list and count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE")
    parser.add_argument("--solver", action="append", choices=SOLVERS)
    parser.add_argument("--longer", action="append", type=float, help="durations, in those of the examples")
    parser.add_argument(
        "--finer", action="append", type=float, help="numbers of output points, in those of the examples"
    )
    parser.add_argument("--limit", type=float, default=20.0, help="processor time, s, after which a run is given up")
    parser.add_argument("--out", type=Path, help="file of JSON lines")
    asked = parser.parse_args()
    known = {}
    if asked.out and asked.out.exists():
        known = {found["run"]: found for found in map(json.loads, asked.out.read_text().splitlines())}
    counted: dict[str, list[str]] = {}
    for name, path, how in runs(asked):
        if name not in known:
            known[name] = {"run": name, **outcome(path, **how, limit=asked.limit)}
            if asked.out:
                with asked.out.open("a") as file:
                    file.write(json.dumps(known[name]) + "\n")
        found = known[name]
        print(f"{name}: {found['outcome']}; {found.get('errors', '')}", flush=True)
        for note in found["notes"]:
            print("    " + note, flush=True)
            counted.setdefault(kind(note), []).append(name)
    print()
    for one, where in sorted(counted.items(), key=lambda item: -len(item[1])):
        print(f"{len(where):5} {one}: {', '.join(dict.fromkeys(name.split()[0] for name in where))}")


if __name__ == "__main__":
    main()
