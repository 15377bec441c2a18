"""Exchange of inputs and outputs with another program between steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True)
class Exchanged:
    """Numbers of packets of a simulation.

    - `received`, `sent`: packets whose inputs were taken, and packets of outputs.
    - `ignored`: packets that were not taken.
    - `reasons`: a sentence for each kind of ignored packets, with the number of these.
    - `held`: steps without a new packet.
    """

    address: str
    received: int
    sent: int
    ignored: int
    reasons: tuple[str, ...]
    held: int

    def sentences(self) -> list[str]:
        """Return sentences on the packets."""
        counted = f"{self.address}: {self.received} packets received, {self.sent} sent; {self.held} steps without a new packet"
        return [counted, *self.reasons]


class Exchange(Protocol):
    """Exchange of inputs and outputs, called before and after each step."""

    def receive(self) -> np.ndarray | None:
        """Return the inputs of the newest packet, or None if none has come."""

    def refuse(self, reason: str) -> None:
        """Count the inputs that `receive` has returned as ignored."""

    def send(self, t: float, values: np.ndarray) -> None:
        """Send the outputs at a time, s."""


class Alone:
    """Exchange with nobody."""

    def receive(self) -> np.ndarray | None:
        """See `Exchange`."""
        return None

    def refuse(self, reason: str) -> None:
        """See `Exchange`."""

    def send(self, t: float, values: np.ndarray) -> None:
        """See `Exchange`."""
