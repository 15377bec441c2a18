"""Runs that a command shows: a scene that is solved, or files of results."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..analyses.load_scene import load_scene
from ..errors import InputError
from .scene import changes_of, solve_scene

if TYPE_CHECKING:
    from ..results.solution import Solution

RESULTS = ".npz"
"""File suffix of results."""


def loaded_runs(paths: Sequence[Path]) -> dict[str, Solution]:
    """Return runs from files of results, by distinct names."""
    from ..results.solution import Solution

    return {_name(path, paths): Solution.load(path) for path in paths}


def _name(path: Path, paths: Sequence[Path]) -> str:
    """Return the file's name without its suffixes, or its path if another file has the same name."""
    stem = path.name.removesuffix(RESULTS).removesuffix(".results")
    return stem if [other.name for other in paths].count(path.name) == 1 else str(path)


def runs_of(source: str, others: Sequence[Path], options: dict[str, Any]) -> dict[str, Solution]:
    """Return the run of a scene, or of a file of results, and other runs from files; a single run has no name."""
    if source.endswith(RESULTS):
        changed = changes_of(options)
        if changed:
            raise InputError(f"{source}: found results with --{changed[0][0]}, expected a scene to solve")
        paths = [Path(source), *others]
        runs = loaded_runs(paths)
        return runs if others else {"": next(iter(runs.values()))}
    solution = solve_scene(source, load_scene(source, changes_of(options)), False)
    return {"solved": solution, **loaded_runs(others)} if others else {"": solution}
