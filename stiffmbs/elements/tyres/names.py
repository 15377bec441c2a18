"""Keys of property files of PAC2002 and MF-Tyre 5.2."""

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
"""Coefficients, zero by default."""
SCALES = _words(
    """
    LFZO LCX LMUX LEX LKX LHX LVX LGAX LCY LMUY LEY LKY LHY LVY LGAY LTR LRES LGAZ LXAL LYKA LVYKA LS LMX LVMX LMY LSGKP LSGAL
    """
)
"""Scale factors, one by default."""
COMBINED = ("RBX1", "RCX1", "RBY1", "RCY1")
"""Coefficients without which there is no weight of combined slip."""
DIMENSIONS = {
    "FNOMIN": "force", "UNLOADED_RADIUS": "length", "VERTICAL_STIFFNESS": "stiffness", "VERTICAL_DAMPING": "damping",
    "BREFF": "", "DREFF": "", "FREFF": "", "LONGVL": "velocity", "FZMAX": "force",
}  # fmt: skip
"""Other numbers that are used, with their dimensions."""
REQUIRED = ("FNOMIN", "UNLOADED_RADIUS", "VERTICAL_STIFFNESS", "PCX1", "PDX1", "PKX1", "PCY1", "PDY1", "PKY1", "PKY2")
LATER = _words(
    """
    PPX1 PPX2 PPX3 PPX4 PPY1 PPY2 PPY3 PPY4 PPY5 PPZ1 PPZ2 PPMX1 PKY4 PKY5 PKY6 PKY7 PEY5 RBX3 RBY4 QDZ10 QDZ11
    QSX4 QSX5 QSX6 QSX7 QSX8 QSX9 QSX10 QSX11 QSX12 QSX13 QSX14 QSY5 QSY6 QSY7 QSY8
    """
)
"""Force coefficients of MF-Tyre 6.0 and later that MF-Tyre 5.2 does not have."""
AS_BEFORE = {**dict.fromkeys(LATER, 0.0), "PKY4": 2.0, "QSY7": 1.0}
"""Values of these coefficients without effect."""
RANGES = {
    "slip": ("KPUMIN", "KPUMAX", ""), "slip_angle": ("ALPMIN", "ALPMAX", "angle"),
    "camber": ("CAMMIN", "CAMMAX", "angle"), "load": ("FZMIN", "FZMAX", "force"),
}  # fmt: skip
"""Limits of the valid ranges of a file, by channel, and their dimension."""
OF_THE_FILE = ("FILE_TYPE", "FILE_VERSION", "FILE_FORMAT")
"""Keys that describe the file itself."""
REASONS = {
    "*": {
        "QTZ1": "the gyroscopic couple of the belt is left out", "MBELT": "the gyroscopic couple of the belt is left out",
        "BELT_MASS": "the gyroscopic couple of the belt is left out", "LGYR": "the gyroscopic couple of the belt is left out",
    },
    "[INERTIA]": {"*": "the mass properties are those of the wheel's body"},
}  # fmt: skip
"""Reasons why keys have no effect, by section."""
DEFAULT_VALUES = {
    "QTZ1": 0.0, "LGYR": 1.0, "GRAVITY": -9.81, **AS_BEFORE,
    **dict.fromkeys(("LIP", "LKYC", "LKZC", "LMP", "LMUV", "LAMU", "LCZ", "LFZMAX"), 1.0),
}  # fmt: skip
"""Values of unused keys that have no effect."""


def home(name: str) -> str:
    """Return the section of a property file that a key belongs to."""
    if name in DIMENSIONS:
        return {"UNLOADED_RADIUS": "DIMENSION", "LONGVL": "MODEL", "FZMAX": "VERTICAL_FORCE_RANGE"}.get(
            name, "VERTICAL"
        )
    if name in SCALES:
        return "SCALING_COEFFICIENTS"
    of_torque = {"X": "OVERTURNING_COEFFICIENTS", "Y": "ROLLING_COEFFICIENTS", "Z": "ALIGNING_COEFFICIENTS"}
    of_force = {"X": "LONGITUDINAL_COEFFICIENTS", "Y": "LATERAL_COEFFICIENTS", "Z": "ALIGNING_COEFFICIENTS"}
    return (of_torque if name[0] == "Q" else of_force).get(name[2:3], "")


SAMPLE = dict.fromkeys(
    _words(
        """
        FNOMIN UNLOADED_RADIUS VERTICAL_STIFFNESS PCX1 PDX1 PKX1 PCY1 PDY1 PKY1 PKY2 RBX1 RCX1 RBY1 RCY1
        QBZ1 QCZ1 QDZ1 QSX3 QSY1 PHY1 PVX1 RVY1 RVY4 RVY5 RVY6 SSZ2 QDZ6 QBZ10
        """
    ),
    1.0,
)
"""Coefficients of the usual tyre, for compilation in advance."""
