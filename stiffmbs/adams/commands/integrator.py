"""What INTEGRATOR says that has an effect on results here.  MSC Adams/Solver, INTEGRATOR statement and command."""

from __future__ import annotations

from ..statements.arguments import Arguments
from ..statements.text import Statement

METHODS = (
    "GSTIFF",
    "WSTIFF",
    "CONSTANT_BDF",
    "HASTIFF",
    "HHT",
    "NEWMARK",
    "ABAM",
    "RKF45",
    "DSTIFF",
    "SI2",
    "SI1",
    "I3",
)
NUMBERS = ("ERROR", "HMAX", "HMIN", "HINIT", "KMAX", "MAXIT", "PATTERN", "ADAPTIVITY", "BETA", "GAMMA", "ALPHA")
OTHERS = ("CORRECTOR", "INTERPOLATE", "FIXIT", "HRATIO", "SCALE", "THREADS")
USUAL_ERROR = 1e-6
"""Relative tolerance of a run that nothing says otherwise of; Adams' own 1e-3 is no reason for a coarser one."""


def integrator_settings(statement: Statement) -> dict[str, float]:
    """Settings of a run: ``rtol`` where ERROR is tighter than the usual one, ``max_step`` by HMAX in the dataset's units.

    The method, the formulation and the rest are left to this package.

    Raises
    ------
    DatasetFault
        When it cannot be read.
    """
    found = Arguments(statement, "INTEGRATOR", (*METHODS, *NUMBERS, *OTHERS))
    error, longest = found.number("ERROR"), found.number("HMAX")
    for name, value in (("ERROR", error), ("HMAX", longest)):
        if value is not None and not value > 0:
            raise found.fault(f"found {name} = {found.text(name)}, expected a number above zero", found.line(name))
    settings = {}
    if error is not None and error < USUAL_ERROR:
        settings["rtol"] = max(error, 1e-14)
    if longest is not None:
        settings["max_step"] = longest
    return settings
