"""Logging of integrator steps."""

from __future__ import annotations

import logging

LOGGER = logging.getLogger(__name__)


def is_logged() -> bool:
    """Return True if steps are logged."""
    return LOGGER.isEnabledFor(logging.DEBUG)


def log_step(t: float, size: float, order: int = 0) -> None:
    """Log the last step. `t`: its end, s. `size`: s. `order`: order of the formula, if variable."""
    of_order = f", order {order}" if order else ""
    LOGGER.debug("t = %.6g s, step %.3g s%s", t, size, of_order, extra={"step": size, "order": order})
