"""Steps, by Python's logging."""

from __future__ import annotations

import logging

LOGGER = logging.getLogger(__name__)


def is_logged() -> bool:
    """Whether steps are logged; asked before one is looked up."""
    return LOGGER.isEnabledFor(logging.DEBUG)


def log_step(t: float, size: float, order: int = 0) -> None:
    """Log the last step.

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
