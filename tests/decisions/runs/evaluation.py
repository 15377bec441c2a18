"""Decisions on the evaluation of runs: loads, driving angles, cycles and peaks."""

from __future__ import annotations

from types import MappingProxyType
from unittest.mock import patch

import numpy as np

from stiffmbs.evaluation import bearing_loads, cycle, loads, peaks
from stiffmbs.reading.units.display import SI_UNITS
from tests.decisions.common import BELOW, Record
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def smallest_torque():
    """Return the torque, in quarter octaves of the largest, up to which it is shown."""

    def is_shown(torque):
        channels = {
            f"{name}.{part}": np.array([size])
            for name, size in (("a", 1.0), ("b", torque))
            for part in ("fx", "fy", "torque")
        }
        found = Record(channels=channels, requested={}, errors={}, not_unique=(), time=np.zeros(1), display=SI_UNITS)
        return ("b", "N m") in [(load.element, load.unit) for load in loads.loads(found)]

    return count_while(is_shown, BELOW)


def missing_part_of_a_revolution():
    """Return the quarter octaves below a revolution up to which the rest of one is too much."""

    def is_too_short(missing):
        drive = Record(kind="drive", joint=Record(joint="pin"))
        turned = Record(channels={"pin.angle": 2 * np.pi * np.array([0.0, 1.0 - missing])})
        with patch.object(bearing_loads, "data_of", lambda model: model):
            return bearing_loads.driving_angle(Record(joints={"motor": drive}, forces={}), turned) is None

    return count_while(is_too_short, BELOW)


def periodic(noise):
    """Return a channel of which each period differs from the one before by a part of its amplitude."""
    time = np.linspace(0.0, 8.0, 801)
    signs = np.where(np.floor(time) % 2, 1.0, -1.0)
    values = np.sin(2.0 * np.pi * time) + noise * signs * np.sin(6.0 * np.pi * time)
    return Record(time=time, channels={"x": values})


def largest_change_of_a_cycle():
    """Return the change of the third harmonic, in quarter octaves of a hundredth, with which a cycle is found."""

    def is_found(noise):
        found = cycle.cycle(periodic(0.01 * noise), "x")
        return found is not None and abs(found.period - 1.0) < 0.1

    return count_while(is_found, DOUBLES)


def samples_of_an_interval():
    """Return the number of samples in an interval of output instants."""
    found = []
    with patch.object(cycle, "_first_lag", lambda x: found.append(len(x))):
        cycle.cycle(periodic(0.0), "x")
    return found[0] / 801


class Run:
    """Run of one channel, a tent whose top is between two of eleven output times."""

    time = np.linspace(0.0, 1.0, 11)
    channels = MappingProxyType({"x": -np.abs(time - 0.51)})

    def __getitem__(self, name):
        return self.channels[name]


def instants_around_a_peak():
    """Return the parts of the two intervals around the largest value."""
    found = peaks._around_extremes(np.array([0.0, 1.0]), Run(), ["x"])
    return int(np.sum((found > 0.4 + 1e-9) & (found < 0.6 - 1e-9))) + 1


def runs_of_a_search():
    """Return how often a run is repeated around its peaks."""
    job = Record(varied=lambda times: len(times))
    runs = []

    def solve(of):
        runs.append(of)
        return Run()

    with (
        patch.multiple(peaks, data_of=lambda _: Record(requests={}), with_elements=lambda data, _: data),
        patch.multiple(peaks, prepare=lambda *_, **__: job, _solved=solve, more_instants=lambda *_: np.zeros(3)),
    ):
        job.dynamics = Record(input_features=lambda *_: None)
        peaks.peaks("", ["x"])
    return len(runs) - 2


DECISIONS = {
    "evaluation.parameters:Evaluation.zero": smallest_torque,
    "evaluation.parameters:Evaluation.missing_turn": missing_part_of_a_revolution,
    "evaluation.parameters:Evaluation.alike": largest_change_of_a_cycle,
    "evaluation.parameters:Evaluation.samples": samples_of_an_interval,
    "evaluation.parameters:Evaluation.parts": instants_around_a_peak,
    "evaluation.parameters:Evaluation.rounds": runs_of_a_search,
}
EXPECTED = {
    "evaluation.parameters:Evaluation.zero": 144, "evaluation.parameters:Evaluation.missing_turn": 80, "evaluation.parameters:Evaluation.alike": 19, "evaluation.parameters:Evaluation.samples": 4,
    "evaluation.parameters:Evaluation.parts": 32, "evaluation.parameters:Evaluation.rounds": 2,
}  # fmt: skip
