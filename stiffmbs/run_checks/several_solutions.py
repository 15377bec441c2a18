"""Check of friction whose loads have several solutions: several motions are possible."""

from __future__ import annotations

from collections.abc import Iterator

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.friction_loads import REMEDY, ambiguous_loads_clause
from .motion import some_instants


def several_solutions_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """Yield a sentence on the first checked output time at which loads have several solutions; the state is changed."""
    for k in some_instants(len(rows.t)):
        if clause := ambiguous_loads_clause(dynamics, rows.t[k], rows.q[k], rows.u[k], rows.lam[k]):
            yield (
                f"several motions are possible from t = {rows.t[k]:.6g} s on, where {clause}; the solver follows "
                f"one of them: {REMEDY}"
            )
            return
