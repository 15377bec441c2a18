"""The numbers that compiling takes from a model: where markers sit, and its bodies at the start."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

from .element import Element
from .marker import MarkerReference


class Carries(Protocol):
    """What knows where markers sit: a model, or one whose bodies are merged."""

    def carried(self, marker: Any) -> tuple[str, Any]:
        """The body that carries a marker, and where it sits on it."""


class PlacedMarkers(dict[MarkerReference, tuple[str, tuple[float, ...]]]):
    """For each marker the body that carries it, and the numbers that kernels take for its place.

    A marker that was not listed, such as a body's own axes in a formula, is added when it is asked for.

    Parameters
    ----------
    model : Carries
    elements : iterable of Element
        Whose markers are listed from the start.
    """

    def __init__(self, model: Carries, elements: Iterable[Element] = ()) -> None:
        super().__init__()
        self._model = model
        for element in elements:
            for _, marker in element.markers():
                self[marker]

    def __missing__(self, marker: MarkerReference) -> tuple[str, tuple[float, ...]]:
        body, placed = self._model.carried(marker)
        self[marker] = found = body, placed.numbers()
        return found


@dataclass(frozen=True)
class BodyNumbers:
    """What bodies bring into a system, body after body.

    Attributes
    ----------
    coordinates, rates : tuples of float
        At the start, as described.
    open_rates : tuple of bool
        Which rates are not given.
    masses : tuple of float
        The diagonal of the mass matrix.
    """

    coordinates: tuple[float, ...]
    rates: tuple[float, ...]
    open_rates: tuple[bool, ...]
    masses: tuple[float, ...]


def body_numbers(bodies: Iterable[Any]) -> BodyNumbers:
    """The numbers of some bodies."""
    coordinates: list[float] = []
    rates: list[float] = []
    open_rates: list[bool] = []
    masses: list[float] = []
    for body in bodies:
        coordinates += body.coordinates()
        rates += body.rates()
        open_rates += body.open_rates()
        masses += body.masses()
    return BodyNumbers(tuple(coordinates), tuple(rates), tuple(open_rates), tuple(masses))
