"""Names of the reactions and other channels of joints and forces; `symbolic/derive.py` has the equations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .group import Group
from .terms import TERM_SETS

if TYPE_CHECKING:
    from .system import System


def reactions(system: System, values: np.ndarray) -> dict[str, np.ndarray]:
    """Return the reaction of each joint and force element on its first body, and the other channels of its kind.

    Force in ground axes, N, and torque about the element's point, N m; for a joint the generalised force -J^T lam.
    `values` of shape (n, values): values of the output terms, one row per time. The result: channels such as
    ``"rail.fy"``, shape (n,), for elements with a kind (weights have none).
    """
    return {name: values[:, at] if at >= 0 else np.zeros(len(values)) for name, at in system.reported.items()}


def reported_terms(system: System) -> Iterator[tuple[str, int]]:
    """Yield the channels of `reactions` with their index in the values of the output terms; -1 for zero."""
    for g, group in enumerate(system.groups):
        if group.kind.element.kind:
            if getattr(group.kind.element, "has_reaction", True):
                yield from _of_term(system, g, group, "reaction", system.of_body.reactions)
            yield from _of_term(system, g, group, "measured", getattr(group.kind.element, "channels", ()))


def _of_term(system: System, g: int, group: Group, term: str, labels: Sequence[str]) -> Iterator[tuple[str, int]]:
    """Yield the rows of one term of a group's elements by name; -1 for rows without an entry."""
    pattern = group.record.patterns.get(term, [])
    first = int(system.places["output"][g, 1 + TERM_SETS["output"].index(term)])
    found = {f"{name}.{label}": -1 for name in group.names for label in labels}
    for e, name in enumerate(group.names):
        for k, (row, _) in enumerate(pattern):
            found[f"{name}.{labels[row]}"] = first + e * len(pattern) + k
    yield from found.items()
