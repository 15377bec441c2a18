"""Checks of a property file for wrong units and signs, which the equations would evaluate to wrong forces."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from ...errors import InputError
from .names import AS_BEFORE, RANGES, home
from .property_file import PropertyFile, Version

PLAUSIBLE = {
    "UNLOADED_RADIUS": (0.01, 5.0), "FNOMIN": (10.0, 2e6), "INFLPRES": (1e4, 5e6), "NOMPRES": (1e4, 5e6),
    "LONGVL": (0.1, 200.0), "VERTICAL_DAMPING": (0.0, math.inf),
}  # fmt: skip
"""Ranges of numbers in SI units, from tyres of models to those of aircraft and mine trucks; other numbers have wrong units."""
PRESSED = (1e-3, 1.0)
"""Range of the deflection by FNOMIN, unloaded radii: a rim that is nearly rigid, and one that lies on the road."""
NARROW = math.radians(2)
"""Slip angle, rad, that valid ranges of tyres exceed; radians read as degrees lie within it."""
UNIT_OF = {"": "", "length": "m", "force": "N", "pressure": "Pa", "velocity": "m/s", "damping": "N s/m"}


def check_numbers(file: PropertyFile, formula: Version, found: Mapping[str, float]) -> None:
    """Refuse numbers of a file in wrong units, and with the signs of other axes.

    Parameters
    ----------
    file : PropertyFile
    formula : Version
    found : mapping of str to float
        Numbers of the file, SI units.

    Raises
    ------
    InputError
        The message contains the line.
    """

    def fault(name: str, sentence: str) -> InputError:
        entry = file.entry(name, home(name))
        assert entry is not None
        return InputError(f"{file.source}, line {entry.line}: found {name} = {entry.text}{sentence}")

    for name, (least, most) in PLAUSIBLE.items():
        value, unit = found.get(name), UNIT_OF[formula.dimensions.get(name, "")]
        if value is None or (name == "INFLPRES" and value == 0):  # 0 stands for NOMPRES
            continue
        if not least <= value <= most:
            limits = f"{least:g} to {most:g} {unit}" if math.isfinite(most) else f"{least:g} {unit} or more"
            raise fault(name, f", {value:g} {unit} by [UNITS], expected {limits}")
    deflection = found["FNOMIN"] / found["VERTICAL_STIFFNESS"]
    least, most = (ratio * found["UNLOADED_RADIUS"] for ratio in PRESSED)
    if not least <= deflection <= most:
        raise fault(
            "VERTICAL_STIFFNESS",
            f", by which FNOMIN deflects the tyre by {deflection:.3g} m, expected {least:.3g} to {most:.3g} m",
        )
    if found["PKX1"] < 0:
        raise fault("PKX1", ", expected a slip stiffness above zero")
    peak = found.get("PKY4", AS_BEFORE["PKY4"]) * math.atan(1 / found["PKY2"])
    if found["PKY1"] * math.sin(peak) > 0:
        raise fault("PKY1", ", the cornering stiffness of SAE axes, expected the sign of ISO axes, below zero")


def doubts(file: PropertyFile, found: Mapping[str, Any]) -> Iterator[str]:
    """Yield notes on sections that the file does not have, and on valid slip angles that may have another unit."""
    for name in RANGES["slip_angle"][:2]:
        entry, angle = file.entry(name), file.number(name, "angle") if file.entry(name) else math.inf
        if entry and abs(angle) < NARROW:
            yield (
                f"line {entry.line}: {name} = {entry.text} is {math.degrees(angle):.3g} deg by [UNITS], a narrow range of slip "
                "angles: its unit may be another one"
            )
    if "UNITS" not in file.sections:
        yield "there is no [UNITS]: numbers are taken as SI units"
    if "ALIGNING_COEFFICIENTS" not in {home(name) for name in found}:
        yield "there are no [ALIGNING_COEFFICIENTS]: the aligning torque is zero"
