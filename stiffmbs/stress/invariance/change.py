"""A change of a scene and how its channels are taken back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..random_scenes.draft import Content

Channels = dict[str, np.ndarray]


def unchanged(channels: Channels, time: np.ndarray) -> Channels:
    """Return channels as they are."""
    return channels


@dataclass(frozen=True)
class Change:
    """A scene that must move as another one.

    Attributes
    ----------
    what : str
        In messages.
    content : dict
        Of the changed scene.
    back : callable
        From the channels of its run, and the output instants, to those of the original; channels that it leaves out are not
        compared.
    start : float
        Of the run, s.
    """

    what: str
    content: Content
    back: Callable[[Channels, np.ndarray], Channels] = field(default=unchanged)
    start: float = 0.0


VECTORS: Mapping[str, tuple[str, ...]] = {
    name: tuple(name.format(axis) for axis in "xyz") for name in ("{}", "v{}", "a{}", "f{}", "t{}")
}
"""The channels along the ground's axes, by vectors."""


def vector(channels: Channels, owner: str, labels: tuple[str, ...]) -> np.ndarray | None:
    """Return a vector over time, shape (3, n), with zero for a component along z that the plane lacks; None where there is none."""
    found = [channels.get(f"{owner}.{label}") for label in labels]
    if found[0] is None or found[1] is None:
        return None
    third: Any = found[2] if found[2] is not None else np.zeros_like(found[0])
    return np.array([found[0], found[1], third])


def with_vector(channels: Channels, owner: str, labels: tuple[str, ...], values: np.ndarray) -> None:
    """Put a vector in place of the channels that there are."""
    for label, series in zip(labels, values, strict=True):
        if f"{owner}.{label}" in channels:
            channels[f"{owner}.{label}"] = series
