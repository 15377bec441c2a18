"""Parameters of the loop over IDA's steps."""

from __future__ import annotations

from dataclasses import dataclass

from ....tuning import tuned


@dataclass(frozen=True)
class LoopParameters:
    """Parameters of the loop over IDA's steps, and of its memory."""

    most_steps: int = 2048
    """Largest number of steps of a call."""
    samples: int = 16
    """Number of stored samples of time and reported unknowns."""
    steps_apart: int = 4
    """Steps between two samples."""
    most_tiny: int = 100
    """Number of successive tiny steps at which the run stops: IDA would continue forever. A step below as many roundings
    of the time is tiny."""
    first_part: float = 0.01
    """Part of the way to the next stop of which IDA's first step is at most a thousandth: that to the next of 100 output
    times, on which IDA's own choice depends."""
    most_passed: int = 64
    """Largest number of breakpoints, or of samples that change nothing that acts, in a call."""
    most_items: int = 1_000_000
    """Largest number of items that are stored (steps, which are only counted afterwards, or numbers in states) or computed
    in a call (steps times unknowns). A call takes about 0.1 s, for progress and interruption. A clock would make results depend on the
    load of the machine, because calls affect Newton's iteration."""


LOOP = tuned("loop", LoopParameters())
