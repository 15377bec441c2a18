"""Each failure of IDA's, provoked once: its flag, and a sentence with cause and remedy."""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Callable
from functools import partial

import numpy as np

from stiffmbs.solve.ida.libraries import ida_libraries
from stiffmbs.solve.ida.statistics import FAILURES, failure_sentence

from ...case import Case, Outcome, Verdict
from ...made_up import ONE_STEP, MadeUp

_REAL = ctypes.c_double


def _made_up(**parts) -> MadeUp:
    return MadeUp(ida_libraries(), **parts)


def _begun(begin: dict | None = None, **parts) -> MadeUp:
    problem = _made_up(**parts)
    _succeeded(problem.begin(**(begin or {})))
    return problem


def _succeeded(flag: int) -> None:
    """What leads up to a failure must not fail itself."""
    if flag < 0:
        raise RuntimeError(f"the problem could not be made up: {failure_sentence(flag)}")


def _after(problem: MadeUp, function: str, *arguments) -> int:
    """Change a setting, then solve."""
    _succeeded(problem.call(function, *arguments))
    return problem.solve()


def _broken_solver() -> int:
    problem = _begun()
    problem.break_linear_solver()
    return problem.solve()


def _bound() -> int:
    problem = _begun(rate=lambda t, y: -1.0, slope=0.0)
    constraint = np.full(1, 2.0)  # y > 0, which ends at t = 1
    bound = problem.session.vector(constraint)
    _succeeded(problem.call("IDASetMinStep", _REAL(0.01)))
    return _after(problem, "IDASetConstraints", ctypes.c_void_p(bound))


def _interpolated(order: int, t: float, vector: bool = True) -> int:
    problem = _begun()
    _succeeded(problem.solve(1.0, ONE_STEP))
    into = ctypes.c_void_p(problem.vectors[0] if vector else None)
    return problem.call("IDAGetDky", _REAL(t), order, into)


def _initial(**parts) -> int:
    """IDA's own search for initial values, which this package does not use."""
    problem = _begun(parts.pop("begin", None), **parts)
    return problem.call("IDACalcIC", 2, _REAL(1.0))


def _of_nothing() -> int:
    problem = _made_up()
    problem.memory = None
    return problem.solve()


def _without_jacobian() -> int:
    """A sparse matrix whose Jacobian nobody gives."""
    problem = _made_up()
    _succeeded(problem.begin(sparse=True))
    return problem.solve()


def _failing_after(calls: int) -> Callable[[float], int]:
    """A residual's flag that is zero for so many calls."""
    count = itertools.count(1)
    return lambda t: int(next(count) > calls)


def _jump(t: float, y: float) -> float:
    return -y if t < 0.5 else 1e9


PROVOKED: dict[int, Callable[[], int]] = {
    -1: lambda: _after(_begun(), "IDASetMaxNumSteps", ctypes.c_long(1)),
    -2: lambda: _begun({"rtol": 0.0, "atol": 1e-30}).solve(),
    -3: lambda: _after(_begun(rate=_jump, slope=0.0), "IDASetMaxErrTestFails", 1),
    -4: lambda: _after(_begun(rate=lambda t, y: -1e3 * y, slope=-1e3), "IDASetMaxConvFails", 1),
    -5: _without_jacobian,
    -6: lambda: _begun(jacobian_flag=lambda t: -1).solve(),
    -7: _broken_solver,
    -8: lambda: _begun(residual_flag=lambda t: -1 if t > 0.5 else 0).solve(),
    -9: lambda: _begun(residual_flag=lambda t: 1 if t > 0.5 else 0).solve(),
    -10: lambda: _begun({"roots": True}, root_flag=lambda t: -1 if t > 0.5 else 0).solve(),
    -11: _bound,
    -12: lambda: _initial(residual_flag=lambda t: 1),
    -13: lambda: _initial(rate=lambda t, y: -1 - y * y + 0.5 * (y > 0.999), slope=1e-9),
    -14: lambda: _initial(rate=lambda t, y: -1 - y, residual_flag=_failing_after(1)),
    -20: _of_nothing,
    -22: lambda: _made_up().begin(rtol=-1.0),
    -23: lambda: _made_up().solve(),
    -24: lambda: _initial(rate=lambda t, y: -1 - y, begin={"atol": 0.0}),
    -25: lambda: _interpolated(9, 0.0),
    -26: lambda: _interpolated(0, -100.0),
    -27: lambda: _interpolated(0, 0.0, vector=False),
}
"""How each flag is come by; not -21 (SUNDIALS 7.9 crashes without memory before it can tell), -16 and -17 (of another
nonlinear solver than its own)."""


def _judged(flag: int, provoke: Callable[[], int]) -> Verdict:
    found = provoke()
    sentence = failure_sentence(found)
    if found != flag:
        return Verdict(Outcome.WRONG, detail=f"provoked {found} in place of {flag}: {sentence}")
    if ";" not in sentence and ":" not in sentence:
        return Verdict(Outcome.WRONG, detail=f"neither cause nor remedy: {sentence}")
    return Verdict(Outcome.TOLD, detail=sentence)


def _every_flag() -> Verdict:
    """Every flag that the library itself has a name for has a sentence here."""
    name_of = next(
        lib["IDAGetReturnFlagName"] for lib in ida_libraries().loaded if hasattr(lib, "IDAGetReturnFlagName")
    )
    name_of.restype = ctypes.c_char_p
    named = {flag for flag in range(-999, 0) if name_of(ctypes.c_long(flag)) != b"NONE"}
    missing = named - FAILURES.keys()
    return Verdict(Outcome.WRONG if missing else Outcome.RIGHT, len(missing), 0, f"{len(named)} flags")


CASES = (
    *(
        Case(f"flag {flag}", "provoked with a made-up problem", partial(_judged, flag, provoke), Outcome.TOLD)
        for flag, provoke in PROVOKED.items()
    ),
    Case("every flag has its sentence", "those that the library names", _every_flag),
)
