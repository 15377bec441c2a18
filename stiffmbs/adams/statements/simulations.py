"""Simulations that a command file asks for, and the run that they are.  MSC Adams/Solver, SIMULATE command."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from .arguments import Arguments
from .fault import DatasetFault
from .text import Statement, Subsystem
from .units import Units

if TYPE_CHECKING:
    from .dataset import Dataset

STATICS = "STATICS"
OVER_TIME = ("DYNAMICS", "KINEMATICS", "TRANSIENT")
KINDS = ("DYNAMICS", "KINEMATICS", "TRANSIENT", STATICS, "INITIAL_CONDITIONS")
SAME = 1e-9
"""Part of an interval of output by which two may differ and be one."""


@dataclass(frozen=True)
class Simulation:
    """One SIMULATE command; times in the dataset's units.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    line : int
    end, duration : float or None
        When it ends, or how long it is.
    steps, interval : float or None
        How many intervals of output it has, or how long each of them is.
    """

    kind: str
    line: int
    end: float | None = None
    duration: float | None = None
    steps: float | None = None
    interval: float | None = None

    @property
    def over_time(self) -> bool:
        return self.kind in OVER_TIME

    def fault(self, reason: str) -> DatasetFault:
        """What to raise where it cannot be followed."""
        return DatasetFault(self.line, "SIMULATE", reason)

    def between_outputs(self, length: float) -> float | None:
        """The time from one output to the next; None where nothing is said."""
        return self.interval or (length / self.steps if self.steps else None)


def read_simulation(command: Statement) -> Simulation:
    """What a SIMULATE command says.

    Raises
    ------
    DatasetFault
        When it cannot be read, has no end, or is a quasi-static one.
    """
    kind = (Subsystem(command.ident, command.line),) if command.ident else ()
    found = Arguments(
        replace(command, ident="", pieces=(*kind, *command.pieces)),
        "SIMULATE",
        (*KINDS, "END", "DURATION", "STEPS", "DTOUT"),
    )
    analysis = found.one_of(*KINDS) or "TRANSIENT"
    limit, sampled = found.one_of("END", "DURATION"), found.one_of("STEPS", "DTOUT")
    numbers = {name: found.number(name) for name in ("END", "DURATION", "STEPS", "DTOUT")}
    for name in ("DURATION", "STEPS", "DTOUT"):
        if name in found and not (numbers[name] or 0.0) > 0:
            raise found.fault(f"found {name} = {found.text(name)}, expected a number above zero", found.line(name))
    if analysis in OVER_TIME and limit is None:
        raise found.fault("found neither END nor DURATION, expected one of them")
    if analysis not in OVER_TIME and (limit or sampled):
        raise found.fault(
            f"found {limit or sampled} with {analysis}, which is not followed over time, expected neither"
        )
    return Simulation(analysis, command.line, numbers["END"], numbers["DURATION"], numbers["STEPS"], numbers["DTOUT"])


def run_settings(simulations: tuple[Simulation, ...], units: Units) -> dict[str, Any]:
    """The settings of the one run that simulations over time make together; none without any.

    Raises
    ------
    DatasetFault
        When one of them ends before it begins, or they differ in kind or in the time between outputs.
    """
    if not simulations:
        return {}
    time, between = 0.0, []
    for simulation in simulations:
        length = simulation.duration if simulation.end is None else simulation.end - time
        if length is None or not length > 0:
            raise simulation.fault(f"found END = {simulation.end}, expected a time after {time:g}, where it begins")
        between.append(simulation.between_outputs(length))
        time += length
    first = simulations[0]
    for simulation, interval in zip(simulations, between, strict=True):
        if (simulation.kind == "KINEMATICS") != (first.kind == "KINEMATICS"):
            raise simulation.fault(f"found {simulation.kind} after {first.kind}, expected runs of one kind")
        if not _same(interval, between[0]):
            raise simulation.fault(
                f"found {_told(interval)} from one output to the next after {_told(between[0])}, expected the same in all runs"
            )
    return {"duration": time * units.time} | _output(time, first, between[0], units) | _solver(first)


def _output(time: float, first: Simulation, interval: float | None, units: Units) -> dict[str, Any]:
    if interval is None:
        return {}
    if first.interval:
        return {"output": first.interval * units.time}
    return {"points": round(time / interval) + 1}


def _solver(first: Simulation) -> dict[str, Any]:
    return {"solver": "kinematic"} if first.kind == "KINEMATICS" else {}


def _same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return math.isclose(one, other, rel_tol=SAME)


def _told(interval: float | None) -> str:
    return "no time" if interval is None else f"{interval:.6g}"


def refuse_velocities(line: int, dataset: Dataset) -> None:
    """Refuse a static simulation of parts that are told to move, which a run from equilibrium does not know.

    Raises
    ------
    DatasetFault
        With the first part or joint that states a velocity other than zero.
    """
    moving = [p.label for p in dataset.parts if any((*(p.velocity or ()), *(p.omega or ())))]
    moving += [joint.label for joint in dataset.joints.values() if any(velocity for *_, velocity in joint.start)]
    if moving:
        raise DatasetFault(
            line,
            "SIMULATE",
            f"found STATICS where {moving[0]} states an initial velocity, expected none before equilibrium",
        )
