"""The compiled routines of this room, by name and signature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .machine import compiled_routine


@dataclass(frozen=True)
class Routine:
    """A function of a ``native`` module: compiled, or loaded from the cache, when first asked for."""

    module: str
    name: str
    signature: str

    def load(self) -> Callable[..., Any]:
        """The function, for calls from Python; pointers are passed as addresses."""
        return compiled_routine(self.module, self.name, self.signature).call

    def address(self) -> int:
        """The function's address, for calls from compiled code."""
        return compiled_routine(self.module, self.name, self.signature).address


TERMS = Routine("stiffmbs.compile.native.evaluate", "terms", "void(float64, int64, int64*)")
