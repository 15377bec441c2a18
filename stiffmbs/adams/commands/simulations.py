"""Simulations that a command file asks for, and the run that they are.  MSC Adams/Solver, SIMULATE command."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..statements.arguments import Arguments
from ..statements.fault import DatasetFault
from ..statements.text import Statement, Subsystem
from ..statements.units import Units

if TYPE_CHECKING:
    from ..statements.dataset import Dataset

STATICS = "STATICS"
OVER_TIME = ("DYNAMICS", "KINEMATICS", "TRANSIENT")
KINDS = ("DYNAMICS", "KINEMATICS", "TRANSIENT", STATICS, "INITIAL_CONDITIONS")
SAME_INTERVAL = 1e-9
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
    def takes_time(self) -> bool:
        """Whether it has an end; STATICS with one is a sequence of equilibria."""
        return self.end is not None or self.duration is not None

    def length(self, start: float) -> float:
        """How long it is, in the dataset's units, where it starts at some time.

        Raises
        ------
        DatasetFault
            When it ends before.
        """
        length = self.duration if self.end is None else self.end - start
        if length is None or not length > 0:
            raise self.fault(f"found END = {self.end}, expected a time after {start:g}, where it begins")
        return length

    def settings(self, start: float, units: Units) -> dict[str, Any]:
        """Duration, output and solver of its run."""
        if not self.takes_time:
            return {}
        length = self.length(start)
        solver = {"solver": "kinematic"} if self.kind == "KINEMATICS" else {}
        return {"duration": length * units.time, **self._output(length, self.between_outputs(length), units), **solver}

    def settings_up_to_its_end(self, units: Units) -> dict[str, Any]:
        """Output and solver of its run, wherever that starts."""
        steps = {"points": round(self.steps) + 1} if self.steps else {}
        output = {"output": self.interval * units.time} if self.interval else steps
        return output | ({"solver": "kinematic"} if self.kind == "KINEMATICS" else {})

    def _output(self, length: float, interval: float | None, units: Units) -> dict[str, Any]:
        if interval is None:
            return {}
        if self.interval:
            return {"output": self.interval * units.time}
        return {"points": round(length / interval) + 1}

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
        When it cannot be read, or has no end.
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
    if analysis not in (*OVER_TIME, STATICS) and (limit or sampled):
        raise found.fault(
            f"found {limit or sampled} with {analysis}, which is not followed over time, expected neither"
        )
    return Simulation(analysis, command.line, numbers["END"], numbers["DURATION"], numbers["STEPS"], numbers["DTOUT"])


def one_run(simulations: Sequence[Simulation], units: Units) -> dict[str, Any] | None:
    """The settings of the one run over time that simulations make together; None where they make more than one.

    Raises
    ------
    DatasetFault
        When one of them ends before it begins.
    """
    first, time, between = simulations[0], 0.0, []
    for simulation in simulations:
        if not simulation.takes_time or simulation.kind == STATICS:
            return None
        length = simulation.length(time)
        between.append(simulation.between_outputs(length))
        time += length
    alike = all(
        (simulation.kind == "KINEMATICS") == (first.kind == "KINEMATICS") and _same(interval, between[0])
        for simulation, interval in zip(simulations, between, strict=True)
    )
    whole = replace(first, end=None, duration=time, steps=time / between[0] if between[0] else None)
    return whole.settings(0.0, units) if alike else None


def _same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return math.isclose(one, other, rel_tol=SAME_INTERVAL)


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
