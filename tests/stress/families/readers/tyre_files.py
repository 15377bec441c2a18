"""Tyre property files: curves, sections, ranges and versions, by the load of a wheel that stands and by notes."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Any

from stiffmbs import spatial
from stiffmbs.analyses.run import run
from stiffmbs.elements.tyres.coefficients import TyreProperties

from ...variants.answers import compared, refused, said, with_files

TYRE = """[UNITS]
LENGTH = 'mm'
FORCE = 'kN'
ANGLE = 'degree'
MASS = 'kg'
TIME = 'second'
[MODEL]
PROPERTY_FILE_FORMAT = 'PAC2002'
LONGVL = 16700
[DIMENSION]
UNLOADED_RADIUS = 320
[VERTICAL]
VERTICAL_STIFFNESS = 0.2
FNOMIN = 4
[LONGITUDINAL_COEFFICIENTS]
PCX1 = 1.6
PDX1 = 1.1
PKX1 = 21
[LATERAL_COEFFICIENTS]
PCY1 = 1.3
PDY1 = 1.0
PKY1 = -14
PKY2 = 1.8
"""
CURVE = "[DEFLECTION_LOAD_CURVE]\n{pen fz}\n0 0.0\n10 3.0\n20 5.0\n30 8.0\n"
LINE = "[DEFLECTION_LOAD_CURVE]\n0 0\n10 3\n40 12\n"
RIM = "[DIMENSION]\nBOTTOMING_RADIUS = 280\n[BOTTOMING_CURVE]\n{pen fz}\n0 0\n10 20\n"
LOADS: dict[str, tuple[str, float, float]] = {
    "stiffness alone": ("", 0.01, 2000), "curve at a point": (CURVE, 0.01, 3000), "curve between points": (CURVE, 0.015, 4000), "curve beyond its end": (LINE, 0.045, 13_500),
    "curve in the air": (CURVE, -0.01, 0), "rim above the road": (RIM, 0.03, 6000), "rim on the road": (RIM, 0.045, 19_000), "rim and curve": (LINE + RIM, 0.045, 23_500),
    "MASS in two sections": ("[INERTIA]\nMASS = 11\n", 0.01, 2000), "LENGTH in two sections": ("[SHAPE_OF_BELT]\nLENGTH = 3\n", 0.01, 2000),
    "a format of its own units": ("[MODEL_2]\nFORCE = 5\n", 0.01, 2000),
}  # fmt: skip
"""What is added, a deflection, m, and the load, N, on a level road."""
RANGES: dict[str, tuple[str, str]] = {
    "none": ("", ""), "load within": ("[VERTICAL_FORCE_RANGE]\nFZMIN = 0.1\nFZMAX = 10\n", ""),
    "load": ("[VERTICAL_FORCE_RANGE]\nFZMAX = 1\n", "load reaches 2000"),
    "slip": ("[LONG_SLIP_RANGE]\nKPUMAX = 0.0001\nKPUMIN = -0.0001\n", "slip reaches"), "slip angle": ("[SLIP_ANGLE_RANGE]\nALPMAX = 2\nALPMIN = -2\n", "slip_angle reaches"),
    "camber": ("[INCLINATION_ANGLE_RANGE]\nCAMMAX = 1\nCAMMIN = -1\n", "camber reaches 0.05"), "camber within": ("[INCLINATION_ANGLE_RANGE]\nCAMMAX = 3\nCAMMIN = -3\n", ""),
}  # fmt: skip
REFUSED: dict[str, tuple[tuple[str, str], str]] = {
    "an unknown FITTYP": (("LONGVL = 16700", "FITTYP = 63"), "line 9: found FITTYP = 63"), "FITTYP in words": (("LONGVL = 16700", "FITTYP = 'MF6'"), "line 9: found FITTYP = MF6"),
    "a coefficient of 6.1 without FITTYP": (("PCX1 = 1.6", "PCX1 = 1.6\nPPX1 = -0.4"), "line 17: found PPX1"),
    "a key twice in a section": (("PCX1 = 1.6", "PCX1 = 1.6\nPCX1 = 1.7"), "line 17"), "a curve of three columns": (("[VERTICAL]", "[DEFLECTION_LOAD_CURVE]\n0 0\n10 2 3\n[VERTICAL]"), "line 13: [DEFLECTION_LOAD_CURVE]: found"),
    "a curve that turns back": (("[VERTICAL]", "[DEFLECTION_LOAD_CURVE]\n10 0\n0 2\n[VERTICAL]"), "expected increasing arguments"),
}  # fmt: skip
UNUSED = {
    "[CONTACT_COEFFICIENTS]\nQTZ1 = 0.2\n": "QTZ1",
    "[INERTIA]\nMBELT = 5\n": "MBELT",
    "[LATERAL_COEFFICIENTS_2]\nOWN1 = 3\n": "OWN1",
}
"""Entries that no equation uses, and the names in the notes."""


def wheel(folder: Path, added: str, deflection: float, slip_angle: float = 0.0, camber: float = 0.0) -> Any:
    """Return a wheel that is pressed on a level road, rolling at 10 m/s."""
    (folder / "front.tir").write_text(TYRE + added, encoding="utf-8")
    model = spatial.Model("Wheel", gravity=(0, 0, 0))
    height = (0.32 - deflection) * math.cos(camber)
    model.add("wheel", spatial.Body(
        mass=20, inertia=(0.7, 1.2, 0.7), position=(0, 0, height), omega=(0, 10 / 0.31, 0), velocity=(10, 10 * math.tan(slip_angle), 0),
        orientation={"y": (0, math.cos(camber), math.sin(camber)), "x": (1, 0, 0)},
    ))  # fmt: skip
    model.add("tyre", spatial.MagicFormulaTyre(i="wheel", properties=TyreProperties.from_file(folder / "front.tir")))
    return model


def _load(name: str, folder: Path) -> float:
    added, deflection, expected = LOADS[name]
    return abs(float(run(wheel(folder, added, deflection), duration=1e-6, points=2)["tyre.load"][0]) - expected)


def _range_notes(added: str, folder: Path) -> str:
    return "; ".join(run(wheel(folder, added, 0.01, 0.05, 0.05), duration=0.002, points=3).notes)


def _reader_notes(added: str, folder: Path) -> str:
    (folder / "front.tir").write_text(TYRE + added, encoding="utf-8")
    return "; ".join(TyreProperties.from_file(folder / "front.tir").notes())


CASES = (
    *(compared(f"load: {name}", "stiffness, or the curves at their points and along their lines", partial(with_files, {}, partial(_load, name)), 1e-6) for name in LOADS),
    *(
        said(f"range: {name}", "a note where it is left", partial(with_files, {}, partial(_range_notes, added)), *filter(None, (word,)), without=("leaves the ranges",) * (not word))
        for name, (added, word) in RANGES.items()
    ),
    *(
        refused(f"refused: {name}", "the line", partial(with_files, {"front.tir": TYRE.replace(*change)}, lambda folder: TyreProperties.from_file(folder / "front.tir")), "front.tir", words)
        for name, (change, words) in REFUSED.items()
    ),
    *(said(f"not used: {name}", "a note", partial(with_files, {}, partial(_reader_notes, added)), name) for added, name in UNUSED.items()),
)  # fmt: skip
