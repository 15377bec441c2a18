"""Messages on stopped or slow explicit integrations."""

from __future__ import annotations

from ...compile.machine.native.statuses import NOT_FINITE, STEP_TOO_SMALL, STIFF
from ...dynamics.failures import FAILURES
from .integration import Integration

_USE_BDF = "the scene is stiff, and solver bdf would be the choice"
REASONS = {
    **FAILURES,
    NOT_FINITE: "the motion has grown beyond all numbers; the step is too long for the stiffness of the scene",
    STEP_TOO_SMALL: "the step that the tolerance asks for has become too small: the motion has a singularity there, or "
    + _USE_BDF,
    STIFF: f"steps as short as stability asks for would take more than ten minutes to the end; {_USE_BDF}",
}
"""Reasons by status."""


def stiff_sentence(work: Integration) -> str:
    """Return a sentence on steps limited by stability."""
    held = work.count("stiff_steps")
    return f"stability, not accuracy, held back {held} of {work.count('steps')} steps: {_USE_BDF}"
