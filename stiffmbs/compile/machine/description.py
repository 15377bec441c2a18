"""Log description of a compilation."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Description:
    """Text that compares equal to any other, so that cached functions ignore it."""

    words: str = field(default="", compare=False)
