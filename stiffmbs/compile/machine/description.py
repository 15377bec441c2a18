"""What is logged of a compilation, which has no part in what is compiled."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Description:
    """Words that equal all others, so that functions that keep their results by their arguments don't mind them."""

    words: str = field(default="", compare=False)
