"""SIMULATE commands of Adams/Solver and the settings of the equivalent runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..statements.arguments import Arguments
from ..statements.text import DatasetFault, Statement
from ..statements.units import Units
from .command_files import with_first_argument

if TYPE_CHECKING:
    from ..statements.dataset import Dataset

STATICS, KINEMATICS = "STATICS", "KINEMATICS"
OVER_TIME = ("DYNAMICS", KINEMATICS, "TRANSIENT")
KINDS = (*OVER_TIME, STATICS, "INITIAL_CONDITIONS")


@dataclass(frozen=True)
class Simulation:
    """SIMULATE command; times are in the dataset's units."""

    kind: str  # one of `KINDS`
    line: int
    end: float | None = None
    duration: float | None = None
    steps: float | None = None  # number of output intervals
    interval: float | None = None  # length of each

    @property
    def takes_time(self) -> bool:
        """True if the simulation has an end or a duration; STATICS with one is a sequence of equilibria."""
        return self.end is not None or self.duration is not None

    def length(self, start: float) -> float:
        """Return the length of the simulation from a given start, in the dataset's units.

        Raises DatasetFault if it ends before it starts.
        """
        length = self.duration if self.end is None else self.end - start
        if length is None or not length > 0:
            raise self.fault(f"found END = {self.end}, expected a time after {start:g}, where it begins")
        return length

    def settings(self, start: float, units: Units) -> dict[str, object]:
        """Return duration, output and solver of the run."""
        if not self.takes_time:
            return {}
        return {"duration": self.length(start) * units.time, **self.settings_up_to_its_end(units)}

    def settings_up_to_its_end(self, units: Units) -> dict[str, object]:
        """Return output and solver of the run, independent of its start."""
        steps = {"points": round(self.steps) + 1} if self.steps else {}
        output = {"output": self.interval * units.time} if self.interval else steps
        return output | ({"solver": "kinematic"} if self.kind == KINEMATICS else {})

    def fault(self, reason: str) -> DatasetFault:
        """Return the error for a simulation that is not supported."""
        return DatasetFault(self.line, "SIMULATE", reason)


def read_simulation(command: Statement) -> Simulation:
    """Read a SIMULATE command. Raises DatasetFault if it cannot be read, or has no end."""
    found = Arguments(with_first_argument(command), "SIMULATE", (*KINDS, "END", "DURATION", "STEPS", "DTOUT"))
    analysis = found.one_of(*KINDS) or "TRANSIENT"
    limit, sampled = found.one_of("END", "DURATION"), found.one_of("STEPS", "DTOUT")
    times = found.number("END"), *(found.positive(name) for name in ("DURATION", "STEPS", "DTOUT"))
    if analysis in OVER_TIME and limit is None:
        raise found.fault("found neither END nor DURATION, expected one of them")
    if analysis not in (*OVER_TIME, STATICS) and (limit or sampled):
        raise found.fault(
            f"found {limit or sampled} with {analysis}, an analysis at one time, expected none of END, DURATION, STEPS and DTOUT"
        )
    return Simulation(analysis, command.line, *times)


def one_run(simulations: Sequence[Simulation], units: Units) -> dict[str, object] | None:
    """Return the settings of one run equivalent to consecutive simulations; None if they need several runs.

    Raises DatasetFault if a simulation ends before it starts.
    """
    first, time, between = simulations[0], 0.0, []
    for simulation in simulations:
        if not simulation.takes_time or simulation.kind == STATICS:
            return None
        length = simulation.length(time)
        between.append(simulation.interval or (length / simulation.steps if simulation.steps else None))
        time += length
    alike = all(
        (simulation.kind == KINEMATICS) == (first.kind == KINEMATICS) and _same(interval, between[0])
        for simulation, interval in zip(simulations, between, strict=True)
    )
    whole = replace(first, end=None, duration=time, steps=time / between[0] if between[0] else None)
    return whole.settings(0.0, units) if alike else None


def _same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return math.isclose(one, other)


def refuse_velocities(line: int, dataset: Dataset) -> None:
    """Refuse a static simulation of a dataset with initial velocities: a run from equilibrium starts at rest.

    Raises DatasetFault with the first part or joint that has an initial velocity other than zero.
    """
    moving = [p.label for p in dataset.parts if any((*(p.velocity or ()), *(p.omega or ())))]
    moving += [joint.label for joint in dataset.joints.values() if any(velocity for *_, velocity in joint.start)]
    if moving:
        raise DatasetFault(
            line,
            "SIMULATE",
            f"found STATICS and an initial velocity of {moving[0]}, expected none: a run from equilibrium starts at rest",
        )
