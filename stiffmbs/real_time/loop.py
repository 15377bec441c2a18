"""Loop of steps in real time, which records the time of each."""

from __future__ import annotations

import gc
import sys
import time
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..errors import AssemblyError, InputError, SolverError
from ..interrupts import uncollected
from ..solve.stiff_rows import States
from ..solve.trajectory import Ending
from .exchange import Exchange
from .parameters import REAL_TIME
from .recorded import RecordedSimulation

NANO: Final = 1e-9
PROCESSOR, ELAPSED = "processor time", "elapsed time"
CLOCK, MEASURED = (time.perf_counter_ns, ELAPSED) if sys.platform == "win32" else (time.thread_time_ns, PROCESSOR)
"""Clock of the times of steps, and its name: Windows counts processor time in units longer than a step."""


@dataclass(frozen=True)
class Loop:
    """Steps to take.

    `dt`: time step, s. `channels`: outputs that are read after each step. `paced`: steps begin at multiples of dt of the
    clock; otherwise one begins when the last one ends.
    """

    dt: float
    steps: int
    channels: Sequence[str]
    paced: bool


class Record:
    """Memory for times and states of steps, which is allocated before the first one.

    `every`: number of steps between recorded states.

    - `spent`: times that steps took, ns.
    - `late`: times by which steps ended after the next one was due, ns.
    - `t`, `q`, `u`, `lengths`: recorded times, s, states and lengths of implicit steps, s; the first are those of the start.
    - `done`: number of steps so far.
    """

    def __init__(self, sim: RecordedSimulation, steps: int, every: int) -> None:
        rows = 1 + steps // every
        self.spent, self.late = np.zeros(steps, np.int64), np.zeros(steps, np.int64)
        self.t, self.lengths = np.zeros(rows), np.zeros(rows)
        self.q, self.u = np.zeros((rows, len(sim.q))), np.zeros((rows, len(sim.u)))
        self.done, self._every = 0, every
        self._put(0, sim)

    def step(self, sim: RecordedSimulation, spent: int, late: int) -> None:
        """Record a step."""
        self.spent[self.done], self.late[self.done] = spent, late
        self.done += 1
        if self.done % self._every == 0:
            self._put(self.done // self._every, sim)

    def _put(self, row: int, sim: RecordedSimulation) -> None:
        self.t[row], self.q[row], self.u[row], self.lengths[row] = sim.t, sim.q, sim.u, sim.length

    def solved(self) -> tuple[np.ndarray, States, np.ndarray]:
        """Return the recorded times, positions and velocities, and lengths of implicit steps."""
        rows = 1 + self.done // self._every
        return self.t[:rows], (self.q[:rows], self.u[:rows]), self.lengths[:rows]


def warm_up(sim: RecordedSimulation, loop: Loop) -> None:
    """Take some steps and return to the start, so that all code is loaded; steps that fail do so again in the loop."""
    with warnings.catch_warnings(), suppress(SolverError, AssemblyError):
        warnings.simplefilter("ignore", RuntimeWarning)
        for _ in range(REAL_TIME.warming):
            sim.step(loop.dt)
            for name in loop.channels:
                sim[name]
        sim.warm_up(loop.dt)
    sim.reset()


def take_steps(sim: RecordedSimulation, loop: Loop, exchange: Exchange, record: Record) -> Ending:
    """Take the steps of a loop; return how it ended."""
    outputs = np.zeros(len(loop.channels))
    period = round(loop.dt / NANO)
    gc.collect()
    with uncollected(), Ending() as ending:  # a collection takes longer than a step
        begun = time.perf_counter_ns()
        try:
            for k in range(loop.steps):
                due = begun + k * period
                if loop.paced:
                    _wait_until(due)
                inputs = exchange.receive()
                start = CLOCK()
                if inputs is not None:
                    _set(sim, inputs, exchange)
                sim.step(loop.dt)
                for number, name in enumerate(loop.channels):
                    outputs[number] = sim[name]
                exchange.send(sim.t, outputs)
                record.step(sim, CLOCK() - start, time.perf_counter_ns() - due - period)
        except AssemblyError as error:
            ending.stop(str(error))
    return ending


def _set(sim: RecordedSimulation, inputs: np.ndarray, exchange: Exchange) -> None:
    """Set inputs; those that the scene refuses are ignored."""
    try:
        sim.set_inputs(inputs)
    except InputError as error:
        exchange.refuse(str(error))


def _wait_until(due: int) -> None:
    """Wait until a time of the clock, ns: sleep first, then poll the clock, as a sleep ends late."""
    left = (due - time.perf_counter_ns()) * NANO
    if left > REAL_TIME.polled:
        time.sleep(left - REAL_TIME.polled)
    while time.perf_counter_ns() < due:
        pass
