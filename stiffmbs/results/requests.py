"""Requested quantities along a motion."""

from __future__ import annotations

import numpy as np

from ..compile.system import System
from ..compile.terms import TERM_SETS


def requests(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """The requested formulas at each instant.

    Parameters
    ----------
    values : ndarray, shape (n, values)
        Values of the output terms, one row per instant.

    Returns
    -------
    dict of str to ndarray
        By request, shape (n,).
    """
    at = 1 + TERM_SETS["output"].index("request")
    return {
        name: values[:, system.places["output"][g, at] + e]
        for g, group in enumerate(system.groups)
        if group.record.patterns.get("request")
        for e, name in enumerate(group.names)
    }
