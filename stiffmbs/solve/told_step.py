"""Steps, told by Python's logging to whoever listens."""

from __future__ import annotations

import logging

LOGGER = logging.getLogger(__name__)


def is_heard() -> bool:
    """Whether anyone listens; asked before a step is looked up."""
    return LOGGER.isEnabledFor(logging.DEBUG)


def tell_step(t: float, size: float, order: int = 0) -> None:
    """Tell of the last step.

    Parameters
    ----------
    t : float
        Its end, s.
    size : float
        s.
    order : int, optional
        Of its formula, where that varies.
    """
    of_order = f", order {order}" if order else ""
    LOGGER.debug("t = %.6g s, step %.3g s%s", t, size, of_order, extra={"step": size, "order": order})
