"""Units of the variables of FMUs."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from xml.etree.ElementTree import Element, SubElement

from ...elements.requests.order import units
from ...model.model_data import ModelData
from ...reading.units.quantity import quantity
from ...reading.units.units import BASE
from ...results.scales import UNITS, kind_of


def units_of(data: ModelData, names: Collection[str]) -> Mapping[str, str]:
    """Return the SI units of channels and requests by name, without those of plain numbers and unknown ones."""
    requested = units(data.outputs())
    found = {name: requested[name] if name in requested else UNITS.get(kind_of(name), "") for name in names}
    return {name: unit for name, unit in found.items() if unit}


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
