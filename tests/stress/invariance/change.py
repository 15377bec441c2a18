"""Transformation of a scene, and the inverse transformation of its channels."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..random_scenes.draft import Content

Channels = dict[str, np.ndarray]


def unchanged(channels: Channels, time: np.ndarray) -> Channels:
    """Return channels unchanged."""
    return channels


@dataclass(frozen=True)
class Change:
    """Scene that must have the same motion as another one.

    Attributes
    ----------
    what : str
        Name in messages.
    content : dict
        Content of the transformed scene.
    back : callable
        Transforms the channels of its run, at the output times, back to those of the original; omitted channels are not
        compared.
    start : float
        Start time of the run, s.
    """

    what: str
    content: Content
    back: Callable[[Channels, np.ndarray], Channels] = field(default=unchanged)
    start: float = 0.0


VECTORS: Mapping[str, tuple[str, ...]] = {
    name: tuple(name.format(axis) for axis in "xyz") for name in ("{}", "v{}", "a{}", "f{}", "t{}")
}
"""Channels along the ground's axes, by vector."""
MODAL = re.compile(r"\.modes\d+$")
"""End of the names of modal coordinates."""


def vector(channels: Channels, owner: str, labels: tuple[str, ...]) -> np.ndarray | None:
    """Return a vector over time, shape (3, n), with z = 0 for planar scenes, or None if it does not exist.

    Modal coordinates of flexible bodies are three numbers, but no vector.
    """
    if MODAL.search(owner):
        return None
    found = [channels.get(f"{owner}.{label}") for label in labels]
    if found[0] is None or found[1] is None:
        return None
    third: Any = found[2] if found[2] is not None else np.zeros_like(found[0])
    return np.array([found[0], found[1], third])


def with_vector(channels: Channels, owner: str, labels: tuple[str, ...], values: np.ndarray) -> None:
    """Replace the existing channels of a vector."""
    for label, series in zip(labels, values, strict=True):
        if f"{owner}.{label}" in channels:
            channels[f"{owner}.{label}"] = series
