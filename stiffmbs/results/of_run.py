"""Results of a run: channels, energy balance, and notes on these."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compile.system import System
from ..describe.model_data import ModelData
from ..describe.settings import RunSettings
from ..solve.dynamics import OutputRows
from ..solve.storage import with_gaps
from .channels import channels_of, turns_of
from .energy_balance import Balance, energy_balance, may_be_broken
from .energy_balance_notes import balance_notes
from .undefined_values import no_number_sentences


class RunResults(NamedTuple):
    """Results of a run.

    Attributes
    ----------
    channels : dict of str to ndarray, shape (n,)
    balance : Balance
    turns : dict of str to ndarray, shape (n,)
        Revolution counters of angles, rad.
    broken_balance, undefined : tuples of str
        Sentences on the energy balance, and on channels without a number at some instants.
    """

    channels: dict[str, np.ndarray]
    balance: Balance
    turns: dict[str, np.ndarray]
    broken_balance: tuple[str, ...]
    undefined: tuple[str, ...]


def results_of_run(
    model: ModelData, system: System, rows: OutputRows, settings: RunSettings, steps: np.ndarray
) -> RunResults:
    """Return the results of a computed run.

    Parameters
    ----------
    model : ModelData
    system : System
    rows : OutputRows
    settings : RunSettings
    steps : ndarray
        Ends of the solver's own steps, s; empty if unknown.
    """
    channels, balance = channels_of(model, system, rows), energy_balance(system, rows, steps)
    solved_there = ~np.isnan(rows.position_violation)  # the other instants are reported as left out
    gaps = with_gaps(channels) if model.requests or not rows.finite else {}
    known = {name: values[solved_there] for name, values in gaps.items()}
    return RunResults(
        channels, balance, turns_of(system, rows.q),
        tuple(balance_notes(system, balance, rows, settings, steps)) if may_be_broken(balance.furthest, balance.scale) else (),
        tuple(no_number_sentences(rows.t[solved_there], known)) if known else (),
    )  # fmt: skip
