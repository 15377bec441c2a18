"""Forces and torques of joints and force elements, from the multipliers of the block system; and what they report besides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .group import Group
from .system import System
from .terms import TERM_SETS


def reactions(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """What each joint and force element does to its first body, and the channels that its kind has besides.

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
    found: dict[str, np.ndarray] = {}
    for g, group in enumerate(system.groups):
        if not group.kind.element.kind:
            continue
        found |= _of_term(system, g, group, values, "reaction", system.of_body.reactions)
        found |= _of_term(system, g, group, values, "measured", getattr(group.kind.element, "channels", ()))
    return found


def _of_term(
    system: System, g: int, group: Group, values: np.ndarray, term: str, labels: Sequence[str]
) -> dict[str, np.ndarray]:
    """The rows of one term of a group's elements by name; what has no entry is zero."""
    pattern = group.record.patterns.get(term, [])
    first = system.places["output"][g, 1 + TERM_SETS["output"].index(term)]
    found = {f"{name}.{label}": np.zeros(len(values)) for name in group.names for label in labels}
    for e, name in enumerate(group.names):
        for k, (row, _) in enumerate(pattern):
            found[f"{name}.{labels[row]}"] = values[:, first + e * len(pattern) + k]
    return found
