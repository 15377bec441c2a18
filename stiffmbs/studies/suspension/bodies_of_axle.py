"""Bodies and elements that belong to an axle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...elements.element import Element
from ...elements.joints.drive import Drive
from ...elements.spatial.tyre import Tyre
from ...model.model_data import ModelData
from ...reading.formula.formula import Formula
from ...reading.marker import GROUND, MarkerReference


def bodies_of(scene: ModelData, body: str, carriers: Sequence[str]) -> set[str]:
    """Return the bodies connected to the carriers of the wheels other than through the clamped body, and that body."""
    elements = (*scene.joints.values(), *scene.forces.values())
    ends = [set(bodies_at(each)) - {body, GROUND} for each in elements if not depends_on_more(each)]
    found: set[str] = set()
    grown = set(carriers)
    while grown != found:
        found = grown
        grown = found.union(*(each for each in ends if each & found))
    return found | ({body} - {GROUND})


def bodies_at(element: Element) -> Iterator[str]:
    """Yield the bodies that an element names."""
    yield from (marker.body for _, marker in element.parts(MarkerReference))
    yield from (marker.body for _, marker in element.markers())


def depends_on_more(element: Element) -> bool:
    """Return True if an element is a drive, or has a formula with states or inputs, which the rig lacks."""
    return isinstance(element, Drive) or any(formula.states for _, formula in element.parts(Formula))


def stays(element: Element, bodies: frozenset[str]) -> bool:
    """Return True if an element belongs on the rig: no tyre, and attached to bodies of the axle alone."""
    if isinstance(element, Tyre) or depends_on_more(element):
        return False
    return set(bodies_at(element)) <= bodies | {GROUND}
