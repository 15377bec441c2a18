"""Times of a complex factorisation and solution of radau, relative to real ones.

    python -m tests.bench.solvers.complex_factors [SCENE...]

A complex product has four real ones. Two lines of numbers at a time make better use of four-lane vectors than one.
"""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from stiffmbs.analyses.job import prepare
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve.ida.native_engine import NativeEngine
from stiffmbs.solve.radau.memory import Radau
from stiffmbs.solve.radau.radau import radau_integrator

from ..costs import SCENES

CHOSEN = ("half_car", "axle", "reference_car_bushings", "chain_100", "governor", "chain_in_space_100")
DURATION, RTOL, CALLS = 0.5, 1e-4, 300
"""Seconds of motion, after which the matrices of the last step are factored again."""
OF_SETUP = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_int64)
OF_SOLUTION = ctypes.CFUNCTYPE(ctypes.c_int, *[ctypes.c_int64] * 4, ctypes.c_double)
OF_TYPE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64)


def least(call: Callable[..., Any], *arguments: Any) -> float:
    """Return the shortest time of a call, us; each is short in comparison with a turn of the processor."""
    times = []
    for _ in range(CALLS):
        begun = time.perf_counter()
        call(*arguments)
        times.append(time.perf_counter() - begun)
    return 1e6 * min(times)


def factors_of(dynamics: Dynamics, settings: RunSettings) -> tuple[Radau, list[list[float]]]:
    """Return the formula after a run, and the times of factorisations and of solutions, real and complex, us."""
    engine = radau_integrator(dynamics, settings).engine
    assert isinstance(engine, NativeEngine)
    ida = engine.ida
    formula: Any = ida._formula
    values, solvers = formula._kept
    nothing = least(OF_TYPE(ida._session.libraries.address("SUNLinSolGetType")), solvers[0].solver)
    times: list[list[float]] = [[], []]
    for solver, vectors in zip(solvers, (("at_x", "at_b"), ("at_pair_x", "at_pair_b")), strict=False):
        given = solver.solver, solver.matrix
        times[0].append(least(OF_SETUP(values["setup"]), *given) - nothing)
        times[1].append(least(OF_SOLUTION(values["solve"]), *given, *(values[at] for at in vectors), 0.0) - nothing)
    return formula, times


def rows(name: str) -> Iterator[str]:
    """Yield a line of the table."""
    whole = prepare(SCENES[name](), solver="radau", rtol=RTOL, duration=DURATION)
    whole.integrate()
    formula, (factors, solutions) = factors_of((whole.subsystems or [whole])[0].dynamics, whole.settings)
    ratios = [pair / real for real, pair in (factors, solutions)]
    yield f"{name:24} {formula._equations.n:8d} {factors[0]:8.2f} {factors[1]:8.2f} {ratios[0]:8.2f} {solutions[0]:8.2f} {solutions[1]:8.2f} {ratios[1]:8.2f} {formula.pair_cost:8.2f}"


def main() -> None:
    """Print the table; the last column is what the cost model takes for a complex factorisation."""
    print(f"{'scene':24} unknowns factors, us: real, complex, ratio; solution, us: real, complex, ratio; cost model")
    for name in sys.argv[1:] or CHOSEN:
        for row in rows(name):
            print(row, flush=True)


if __name__ == "__main__":
    main()
