"""Decisions on results: scales of channels, energy balances, error bars, joined runs."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from unittest.mock import patch

import numpy as np

from stiffmbs.dynamics.dynamics import OutputRows
from stiffmbs.errors import InputError
from stiffmbs.model.settings import RunSettings
from stiffmbs.results import (
    digits,
    energy_balance,
    energy_balance_notes,
    error_bars,
    joined,
    marker_motion,
    other_programs,
    saved_state,
    scales,
)
from stiffmbs.results.joint_angles import JointAngles
from tests.decisions.common import Record
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while

BDF = RunSettings(solver="bdf", rtol=1e-6)


def scale_of(channel, unit="", size=1.0, gravity=0.0, **channels):
    """Return the scale of a channel, from the end values of motions that begin at 0; dots are underscores."""
    motions = {name.replace("_", "."): np.array([0.0, value]) for name, value in channels.items()}
    return scales.scales(motions, size, {channel: unit} if unit else {}, gravity)[channel]


def balance(change):
    """Return a balance of 1 J exchanged in one interval."""
    return energy_balance.Balance(np.arange(2.0), np.array([0.0, change]), np.zeros(2), 1.0, False)


def instants_of_a_balance():
    """Return the number of instants, in thousands, that a balance uses of a million."""
    energies = {"t": np.arange(1e6)} | {name: np.zeros(10**6) for name in ("kinetic", "potential", "power")}
    rows = OutputRows(**dict.fromkeys((each.name for each in fields(OutputRows)), np.empty((10**6, 0))) | energies)
    return len(energy_balance.energy_balance(Record(keeps_energy=True, groups=()), rows).t) // 1000


def largest_energy_without_a_check():
    with patch.object(energy_balance_notes, "may_be_missing", lambda *_: 0.0):
        return count_while(
            lambda energy: not energy_balance_notes.is_broken(None, balance(1e-4 * energy), None, BDF), DOUBLES
        )


def blocks_of_instants():
    """Return the blocks in which 1000 instants of a channel are examined, 800 at once."""
    found = []

    def values(block):
        found.append(block)
        return np.arange(1000.0)[block], np.zeros((1, 1000))[:, block]

    error_bars._both_ends(1000, values, np.zeros((1, 2)), np.empty(0), 800)
    return found


def accepted(rtol):
    """Return the part of the exchanged energy that may be missing."""
    return energy_balance_notes._accepted(RunSettings(solver="bdf", rtol=rtol))


def largest_sheet(axis):
    """Return the rows or columns of a sheet that are expected at most."""
    too_large = Record(time=np.broadcast_to(0.0, 10**7), channels={})
    try:
        other_programs.write_excel(Path("a.xlsx"), too_large)
    except InputError as error:
        return int(re.findall(r"\d+", str(error).partition("expected at most")[2])[axis])
    return 0


def ignored_energy(reaction, potential):
    """Return the energy below tolerance and rounding of a mechanism of 1 m, J."""
    places = {"reaction": Record(source=[0]), "potential": Record(source=[1])}
    system = Record(term=lambda _, name: places[name], mass=np.zeros(1), size=1.0, n_q=0)
    rows = Record(values=np.array([[reaction, potential]]), acceleration=np.zeros((1, 1)))
    with patch.object(energy_balance_notes, "absolute_tolerances", lambda *_: np.zeros(1)):
        return energy_balance_notes._negligible(system, rows, BDF)


def largest_step_between_joined_runs():
    """Return the step of a position, in quarter octaves of 1e-9 of its size, that continues a motion."""

    def continues(step):
        before, after = (Record(channels={"a.x": np.array([value])}) for value in (0.0, step))
        return joined._goes_on(before, after, {"position": 1.0})

    return count_while(lambda step: continues(1e-9 * step), DOUBLES)


def largest_difference_of_turns():
    rows = Record(t=np.arange(2.0))

    def is_silent(apart):
        angles = Record(
            followed=["j.angle"], _changes=lambda _: (np.zeros((1, 1)), np.full((1, 1), apart), np.zeros((1, 1)))
        )
        return not [*JointAngles.uncertain(angles, rows)]

    return count_while(lambda apart: is_silent(0.1 * apart), DOUBLES[:20])


def smallest_angle_of_axes():
    """Return the angle between z axes, in quarter octaves of 1 rad, up to which an Euler angle is defined."""

    def is_defined(angle):
        axes = np.eye(3)
        leaning = Record(axes=[axes[0], axes[1], (np.sin(angle), 0.0, np.cos(angle))])
        return marker_motion._phi(Record(axes=axes), leaning, np) != 0.0

    return count_while(is_defined, HALVES)


def farthest_saved_row():
    """Return the distance from a saved instant, in quarter octaves of 1e-12 s, that finds its row."""

    def finds(apart):
        try:
            saved_state._number_of_row("saved", np.arange(2.0), apart)
        except InputError:
            return False
        return True

    return count_while(lambda apart: finds(1e-12 * apart), DOUBLES)


def most_reliable_digits():
    run = Record(channels={}, requested={}, not_unique=(), estimate=None, errors={"a.x": Record(over_time=1e-300)})
    with patch.object(digits, "scales", lambda *_: {"a.x": 1.0}):
        return digits.KnownErrors(run).digits(digits.over_time).popitem()[1]


DECISIONS = {
    "results.error_bars:ARRAYS": lambda: len(blocks_of_instants()),
    "results.digits:MOST_DIGITS": most_reliable_digits,
    "results.energy_balance:MOST_INSTANTS": instants_of_a_balance,
    "results.energy_balance_notes:BROKEN": largest_energy_without_a_check,
    "results.energy_balance_notes:PER_TOLERANCE": lambda: accepted(1e-3),
    "results.energy_balance_notes:OF_TOLERANCE": lambda: ignored_energy(1.0, 0.0),
    "results.energy_balance_notes:OF_POTENTIAL": lambda: ignored_energy(0.0, 1.0),
    "results.error_bars:SAFETY": lambda: error_bars.error_bar(np.zeros(2), [np.ones(2)], None, 0.0).over_time,
    "results.error_bars:FINER": lambda: error_bars.between(np.arange(3.0), np.array([[0.0, 1.0, 0.0]]), np.array([0, 2]))[0],
    "results.joined:SAME_VALUE": largest_step_between_joined_runs,
    "results.joint_angles:UNCERTAIN_TURN": largest_difference_of_turns,
    "results.marker_motion:ALIGNED": smallest_angle_of_axes,
    "results.other_programs:Limits.name": lambda: len(other_programs.variable_names(["a" * 1000])[0]),
    "results.other_programs:Limits.rows": lambda: largest_sheet(0),
    "results.other_programs:Limits.columns": lambda: largest_sheet(1),
    "results.other_programs:Limits.cell": lambda: len(other_programs._cells("a" * 10**6)[0]),
    "results.scales:LITTLE": lambda: scale_of("a.x", a_x=0.0, b_x=1.0),
    "results.scales:LITTLE_FORCE": lambda: scale_of("j.fx", j_fx=0.0, k_fx=1.0),
    "results.scales:ROUNDING": farthest_saved_row,
    "results.scales:FIXED": lambda: scale_of("a.x", a_x=0.0),
    "results.scales:CROSSED": lambda: scale_of("j.torque", j_torque=0.0, j_fx=1.0),
    "results.scales:OF_GRAVITY": lambda: scale_of("a.wdx", size=2.0, gravity=9.81, a_wdx=1e-9),
    "results.scales:REQUEST_ROUNDING": lambda: count_while(
        lambda value: scale_of("r", unit="?", r=value, a_x=1.0) > 0.0, HALVES
    ),
}  # fmt: skip
EXPECTED = {
    "results.error_bars:ARRAYS": 10,
    "results.digits:MOST_DIGITS": 12,
    "results.energy_balance:MOST_INSTANTS": 90, "results.energy_balance_notes:BROKEN": 27, "results.energy_balance_notes:PER_TOLERANCE": 0.1,
    "results.energy_balance_notes:OF_TOLERANCE": 1e-5,
    "results.energy_balance_notes:OF_POTENTIAL": 1e-10, "results.error_bars:SAFETY": 2.0, "results.error_bars:FINER": 1.1,
    "results.joined:SAME_VALUE": 40, "results.joint_angles:UNCERTAIN_TURN": 14,
    "results.marker_motion:ALIGNED": 160, "results.other_programs:Limits.name": 63, "results.other_programs:Limits.rows": 1_048_576,
    "results.other_programs:Limits.columns": 16_384, "results.other_programs:Limits.cell": 32_767, "results.scales:LITTLE": 0.1, "results.scales:LITTLE_FORCE": 0.01, "results.scales:ROUNDING": 40,
    "results.scales:FIXED": 1e-9, "results.scales:CROSSED": 1e-5, "results.scales:OF_GRAVITY": 4.905e-3, "results.scales:REQUEST_ROUNDING": 187,
}  # fmt: skip
