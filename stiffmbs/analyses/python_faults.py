"""Errors in Python functions of forces, reported in one sentence."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from ..compile.callbacks import fault_of
from ..compile.system import System
from ..errors import AssemblyError, StiffmbsError
from ..solve.trajectory import Outcome, Trajectory


@contextmanager
def told_faults(system: System) -> Iterator[None]:
    """Replace an error that a faulty function caused by an AssemblyError with the message of that fault."""
    try:
        yield
    except (StiffmbsError, ArithmeticError, ValueError) as error:
        fault = fault_of(system)
        if fault is None:
            raise
        raise AssemblyError(f"the start cannot be computed: {fault.clause}") from error
    fault = fault_of(system) if system.has_functions else None
    if fault and not isinstance(fault.raised, Exception):
        raise fault.raised


def up_to_a_fault(system: System, trajectory: Trajectory) -> Trajectory:
    """Return a trajectory with the message of the fault that ended it, if any."""
    fault = fault_of(system) if system.has_functions else None
    if fault is None or trajectory.outcome is Outcome.DONE:
        return trajectory
    if isinstance(fault.raised, KeyboardInterrupt):
        return replace(trajectory, outcome=Outcome.INTERRUPTED, message=Outcome.INTERRUPTED.value)
    reached = trajectory.t[-1]
    return replace(
        trajectory, outcome=Outcome.STOPPED, message=f"stopped at t = {reached:.9g} s: {fault.clause}"
    )  # fmt: skip
