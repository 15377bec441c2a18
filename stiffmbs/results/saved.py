"""Data of a run in an .npz file in addition to its channels, from which the run can be restored.

These names have a slash, which no channel has: ``run/about`` and ``run/provenance`` are JSON texts; the others are
arrays.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import astuple, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..model.scene import Figure
from ..notes import Note
from ..reading.units.display import DisplayUnits
from ..solve.trajectory import History, Outcome
from .energy_balance import Balance, ElementEnergy
from .error_bars import ErrorBar, ErrorEstimate
from .provenance import PROVENANCE, from_json
from .saved_state import TURNS, reading

if TYPE_CHECKING:
    from .solution import Solution

ABOUT, HISTORY, BALANCE = "run/about", "run/history/", "run/balance/"
OF_BALANCE = tuple(part.name for part in fields(Balance) if part.name != "elements")
TEXTS = ("notes", "not_unique", "presolve", "verification")


def record(solution: Solution) -> dict[str, np.ndarray]:
    """Return the arrays to save in addition to the channels."""
    about: dict[str, object] = {
        "name": solution.name,
        "outcome": solution.outcome.name,
        "message": solution.message,
        "ended": solution.ended.as_dict(),
        **{name: list(getattr(solution, name)) for name in TEXTS},
        "note_details": [note.as_dict() for note in solution.notes],
        "requested": dict(solution.requested),
        "solver": solution.solver,
        "errors": {channel: astuple(bar) for channel, bar in solution.errors.items()},
        "estimate": solution.estimate and astuple(solution.estimate),
        "figure": solution.figure and dict(solution.figure),
        "display": dict(solution.display.chosen),
        "element_energies": {name: astuple(energy) for name, energy in solution.balance.elements.items()},
    }
    return {
        ABOUT: np.array(json.dumps(about, default=lambda number: number.item())),
        **({PROVENANCE: np.array(solution.provenance.as_json())} if solution.provenance else {}),
        **{HISTORY + part.name: getattr(solution.history, part.name) for part in fields(History)},
        **{TURNS + name: values for name, values in solution.turns.items()},
        **{BALANCE + name: np.asarray(getattr(solution.balance, name)) for name in OF_BALANCE},
    }


def loaded(path: Path) -> Solution:
    """Read a solution; see `Solution.load`."""
    if path.suffix != ".npz":
        raise InputError(
            f"load {path}: found the ending '{path.suffix}', expected .npz: other files hold the channels alone"
        )
    saved = "a file that Solution.save wrote"
    with reading(path, f"load {path}", "archive of arrays", saved), np.load(path, allow_pickle=False) as archive:
        return _restored(path, dict(archive))


def _restored(path: Path, arrays: Mapping[str, Any]) -> Solution:
    from .solution import Solution

    if ABOUT not in arrays:
        raise InputError(
            f"load {path}: found no record of a run, expected a file that Solution.save or stiffmbs run wrote"
        )
    about = json.loads(str(arrays[ABOUT]))
    channels = {name: array for name, array in arrays.items() if "/" not in name and name not in ("time", "not_unique")}
    message = Note.restored(about["message"], about["ended"]) if "ended" in about else about["message"]
    balance = {name: arrays[BALANCE + name] for name in OF_BALANCE if BALANCE + name in arrays}
    elements = {name: ElementEnergy(*energy) for name, energy in about.get("element_energies", {}).items()}
    texts: dict[str, Any] = {name: tuple(about[name]) for name in TEXTS}
    if "note_details" in about:  # files of earlier versions have the sentences alone
        texts["notes"] = tuple(map(Note.restored, about["notes"], about["note_details"]))
    return Solution(
        name=about["name"], time=arrays["time"], channels=channels, outcome=Outcome[about["outcome"]], message=message,
        **texts, requested=about["requested"], solver=about["solver"],
        errors={channel: ErrorBar(*bar) for channel, bar in about["errors"].items()},
        estimate=ErrorEstimate(*about["estimate"]) if about.get("estimate") else None,
        history=History(*(arrays[HISTORY + part.name] for part in fields(History))),
        balance=Balance(**{name: array if array.ndim else array.item() for name, array in balance.items()}, elements=elements),
        figure=Figure(**about["figure"]) if about["figure"] else None,
        display=DisplayUnits(about.get("display", {})),
        turns={name.removeprefix(TURNS): array for name, array in arrays.items() if name.startswith(TURNS)},
        provenance=from_json(str(arrays[PROVENANCE])) if PROVENANCE in arrays else None,
    )  # fmt: skip
