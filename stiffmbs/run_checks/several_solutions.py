"""Check of friction whose loads have several solutions: several motions are possible."""

from __future__ import annotations

from collections.abc import Iterator

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.friction_loads import REMEDY, ambiguous_loads_clause
from ..notes import Note, NoteKind, Severity
from .motion import some_instants

SEVERAL_MOTIONS = NoteKind(
    "several-motions",
    "several motions are possible from t = {t:.6g} s on, where {clause}; the solver follows one of them: {remedy}",
    REMEDY,
    severity=Severity.DOUBT,
)


def several_solutions_note(dynamics: Dynamics, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on the first checked output time at which loads have several solutions; the state is changed."""
    for k in some_instants(len(rows.t)):
        if clause := ambiguous_loads_clause(dynamics, rows.t[k], rows.q[k], rows.u[k], rows.lam[k]):
            yield SEVERAL_MOTIONS(t=rows.t[k], clause=clause)
            return
