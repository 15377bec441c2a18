"""Settings of the INTEGRATOR statement and command that affect a run.  MSC Adams/Solver, INTEGRATOR."""

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
"""Default relative tolerance of a run; a looser ERROR, such as Adams' default 1e-3, does not change it."""


def integrator_settings(statement: Statement) -> dict[str, float]:
    """Return run settings: ``rtol`` if ERROR is below the default, ``max_step`` from HMAX in the dataset's units.

    The integration method and the formulation are ignored.

    Raises
    ------
    DatasetFault
        If the statement cannot be read.
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
