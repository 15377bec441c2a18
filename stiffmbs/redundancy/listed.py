"""Lists of names in sentences."""

from __future__ import annotations

from collections.abc import Sequence

from .parameters import REDUNDANCY


def listed(names: Sequence[str]) -> str:
    """Join names with commas and 'and'; a long list is shortened."""
    if len(names) > REDUNDANCY.most_names:
        names = [*names[: REDUNDANCY.most_names - 1], f"{len(names) - REDUNDANCY.most_names + 1} more"]
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else "".join(names)
