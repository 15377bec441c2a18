"""Forces and torques of joints and force elements, from the multipliers of the block system."""

from __future__ import annotations

import numpy as np

from .system import System
from .terms import TERM_SETS


def reactions(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """What each joint and force element does to its first body.

    Force in ground axes, N, and torque about the element's point, N m; for a joint the generalised force -J^T lam.

    Parameters
    ----------
    values : ndarray, shape (n, values)
        Values of the output terms, one row per instant.

    Returns
    -------
    dict of str to ndarray
        Channels such as ``"rail.fy"``, shape (n,), for elements that have a kind of their own (weights have none).
    """
    at = 1 + TERM_SETS["output"].index("reaction")
    found: dict[str, np.ndarray] = {}
    components = system.of_body.reactions
    for g, group in enumerate(system.groups):
        if not group.kind.element.kind:
            continue
        pattern = group.record.patterns["reaction"]
        first = system.places["output"][g, at]
        for e, name in enumerate(group.names):
            for component in components:
                found[f"{name}.{component}"] = np.zeros(len(values))
            for k, (row, _) in enumerate(pattern):
                found[f"{name}.{components[row]}"] = values[:, first + e * len(pattern) + k]
    return found
