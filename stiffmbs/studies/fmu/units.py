"""Definitions of units in FMUs."""

from __future__ import annotations

from collections.abc import Collection
from xml.etree.ElementTree import Element, SubElement

from ...reading.units.quantity import quantity
from ...reading.units.units import BASE


def unit_definitions(used: Collection[str]) -> Element:
    """Return the element of a model description that defines units as powers of SI units."""
    section = Element("UnitDefinitions")
    for unit in sorted(used):
        powers = zip(BASE, quantity(f"1 {unit}").dimension or (), strict=False)
        exponents = {base: f"{power:.0f}" for base, power in powers if power}
        if unit.startswith("rad"):
            exponents["rad"] = "1"
        SubElement(SubElement(section, "Unit", name=unit), "BaseUnit", exponents)
    return section
