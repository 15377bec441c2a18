"""Packets of inputs and outputs: a time and values, each a little-endian float64 of eight bytes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

NUMBER = np.dtype("<f8")


@dataclass(frozen=True)
class Packet:
    """Layout of a packet: a time, s, and the values of some names in their order, SI units."""

    names: tuple[str, ...]

    @property
    def size(self) -> int:
        """Return the length of a packet, bytes."""
        return NUMBER.itemsize * (1 + len(self.names))

    def empty(self) -> np.ndarray:
        """Return memory of a packet: the time and the values, of shape (1 + names,)."""
        return np.zeros(1 + len(self.names), NUMBER)

    def __str__(self) -> str:
        """Return the layout as a clause for messages."""
        return f"{self.size} bytes: {', '.join(('time', *self.names))}"
