"""Profiles of stretched symbols: the fraction of the distance, and two distances across it, m."""

from __future__ import annotations

import numpy as np

TURNS = 6


def straight() -> list[tuple[float, float, float]]:
    """A straight line."""
    return [(0, 0, 0), (1, 0, 0)]


def zigzag(width: float, shift: float = 0.0) -> list[tuple[float, float, float]]:
    """A planar spring."""
    teeth = [(0.2 + 0.6 * (k + 0.5) / (2 * TURNS), shift + width * (-1) ** k, 0.0) for k in range(2 * TURNS)]
    return [(0, shift, 0), (0.2, shift, 0), *teeth, (0.8, shift, 0), (1, shift, 0)]


def coil(radius: float) -> list[tuple[float, float, float]]:
    """A spatial spring."""
    turns = np.linspace(0, TURNS, TURNS * 14 + 1)
    around = [(0.15 + 0.7 * t / TURNS, radius * np.cos(2 * np.pi * t), radius * np.sin(2 * np.pi * t)) for t in turns]
    return [(0, 0, 0), (0.15, 0, 0), *around, (0.85, 0, 0), (1, 0, 0)]


def damper(width: float, shift: float = 0.0) -> list[list[tuple[float, float, float]]]:
    """A dashpot: a cup, open towards j, and a piston in it."""
    a, b = shift - width, shift + width
    return [
        [(0, shift, 0), (0.38, shift, 0)],
        [(0.62, a, 0), (0.38, a, 0), (0.38, b, 0), (0.62, b, 0)],
        [(0.52, shift - 0.75 * width, 0), (0.52, shift + 0.75 * width, 0)],
        [(0.52, shift, 0), (1, shift, 0)],
    ]


def bar(width: float) -> list[list[tuple[float, float, float]]]:
    """A rod: two parallel lines, closed at both ends."""
    return [[(0, -width, 0), (1, -width, 0), (1, width, 0), (0, width, 0), (0, -width, 0)]]


def arrows(width: float) -> list[list[tuple[float, float, float]]]:
    """A line with a head at each end that points outwards."""
    return [
        straight(),
        [(0.12, width, 0), (0, 0, 0), (0.12, -width, 0)],
        [(0.88, width, 0), (1, 0, 0), (0.88, -width, 0)],
    ]
