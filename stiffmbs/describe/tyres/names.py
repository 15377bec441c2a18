"""The names of property files of PAC2002 and MF-Tyre 5.2."""

from __future__ import annotations


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split())


COEFFICIENTS = _words(
    """
    PCX1 PDX1 PDX2 PDX3 PEX1 PEX2 PEX3 PEX4 PKX1 PKX2 PKX3 PHX1 PHX2 PVX1 PVX2
    RBX1 RBX2 RCX1 REX1 REX2 RHX1
    PCY1 PDY1 PDY2 PDY3 PEY1 PEY2 PEY3 PEY4 PKY1 PKY2 PKY3 PHY1 PHY2 PHY3 PVY1 PVY2 PVY3 PVY4
    RBY1 RBY2 RBY3 RCY1 REY1 REY2 RHY1 RHY2 RVY1 RVY2 RVY3 RVY4 RVY5 RVY6
    QBZ1 QBZ2 QBZ3 QBZ4 QBZ5 QBZ9 QBZ10 QCZ1 QDZ1 QDZ2 QDZ3 QDZ4 QDZ6 QDZ7 QDZ8 QDZ9
    QEZ1 QEZ2 QEZ3 QEZ4 QEZ5 QHZ1 QHZ2 QHZ3 QHZ4
    PTX1 PTX2 PTX3 PTY1 PTY2 SSZ1 SSZ2 SSZ3 SSZ4 QSX1 QSX2 QSX3 QSY1 QSY2 QSY3 QSY4
    """
)
"""Zero where a file has none."""
SCALES = _words(
    """
    LFZO LCX LMUX LEX LKX LHX LVX LGAX LCY LMUY LEY LKY LHY LVY LGAY LTR LRES LGAZ LXAL LYKA LVYKA LS LMX LVMX LMY LSGKP LSGAL
    """
)
"""One where a file has none."""
COMBINED = ("RBX1", "RCX1", "RBY1", "RCY1")
"""Without these combined slip has no weights."""
DIMENSIONS = {
    "FNOMIN": "force", "UNLOADED_RADIUS": "length", "VERTICAL_STIFFNESS": "stiffness", "VERTICAL_DAMPING": "damping",
    "BREFF": "", "DREFF": "", "FREFF": "", "LONGVL": "velocity", "FZMAX": "force",
}  # fmt: skip
"""Other numbers that are used, and what they measure."""
REQUIRED = ("FNOMIN", "UNLOADED_RADIUS", "VERTICAL_STIFFNESS", "PCX1", "PDX1", "PKX1", "PCY1", "PDY1", "PKY1", "PKY2")
KNOWN_UNUSED = _words(
    """
    VXLOW WIDTH ASPECT_RATIO RIM_RADIUS RIM_WIDTH KPUMIN KPUMAX ALPMIN ALPMAX CAMMIN CAMMAX FZMIN
    LGYR QTZ1 MBELT PROPERTY_FILE_FORMAT FILE_TYPE FILE_VERSION FILE_FORMAT
    LENGTH FORCE ANGLE MASS TIME FITTYP MFSAFE1 MFSAFE2 MFSAFE3 TYPE_OF_DYNAMICS
    """
)
"""What files have that is not used, and no note is made of."""
TEXTS = ("USE_MODE", "TYRESIDE")
"""What else files have that is used."""
SAMPLE = {
    "FNOMIN": 1.0, "UNLOADED_RADIUS": 1.0, "VERTICAL_STIFFNESS": 1.0, "PCX1": 1.6, "PDX1": 1.1, "PKX1": 2.0, "PCY1": 1.4,
    "PDY1": 1.0, "PKY1": -1.3, "PKY2": 1.5, "RBX1": 1.3, "RCX1": 1.1, "RBY1": 0.7, "RCY1": 1.05, "QBZ1": 1.0, "QCZ1": 1.1,
    "QDZ1": 0.1, "QSX3": 0.1, "QSY1": 0.01, "PHY1": 0.01, "PVX1": 0.02, "RVY1": 0.1, "RVY4": 1.0, "RVY5": 2.0, "RVY6": 1.0,
    "SSZ2": 0.1, "QDZ6": 0.1, "QBZ10": 1.0,
}  # fmt: skip
"""A tyre of unit size, for models that are compiled ahead."""
