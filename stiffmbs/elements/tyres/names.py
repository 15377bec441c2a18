"""Keys of property files of PAC2002, MF-Tyre 5.2, 6.1 and 6.2, and Fiala."""

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
REQUIRED = ("FNOMIN", "UNLOADED_RADIUS", "PCX1", "PDX1", "PKX1", "PCY1", "PDY1", "PKY1", "PKY2")
LATER = _words(
    """
    PPX1 PPX2 PPX3 PPX4 PPY1 PPY2 PPY3 PPY4 PPY5 PPZ1 PPZ2 PPMX1 PKY4 PKY5 PKY6 PKY7 PEY5 RBX3 RBY4 QDZ10 QDZ11
    QSX4 QSX5 QSX6 QSX7 QSX8 QSX9 QSX10 QSX11 QSX12 QSX13 QSX14 QSY5 QSY6 QSY7 QSY8
    """
)
"""Force coefficients of MF-Tyre 6.0 and later that MF-Tyre 5.2 does not have."""
OF_PRESSURE = _words("PPX1 PPX2 PPX3 PPX4 PPY1 PPY2 PPY3 PPY4 QPZ1 QPZ2 QPX1 QPFZ1 QSY8")
"""Pressure coefficients of PAC2002, zero by default; they need IP_NOM."""
OF_PAC2002 = _words("QSX4 QSX5 QSX6 QSX7 QSX8 QSX9 QSX10 QSX11 QSY5 QSY6 QSY7")
"""Coefficients of the overturning and rolling resistance torque of PAC2002 that MF-Tyre 5.2 does not have, zero by default."""
PRESSURES = {"IP": "pressure", "IP_NOM": "pressure", "LIP": ""}
"""Numbers of the inflation pressure of PAC2002, with their dimensions."""
FIALA = {
    "UNLOADED_RADIUS": "length", "WIDTH": "length", "VERTICAL_STIFFNESS": "stiffness", "VERTICAL_DAMPING": "damping",
    "ROLLING_RESISTANCE": "length", "CSLIP": "force", "CALPHA": "force per angle", "UMIN": "", "UMAX": "",
    "RELAX_LENGTH_X": "length", "RELAX_LENGTH_Y": "length", "FZMAX": "force", "LONGVL": "velocity",
}  # fmt: skip
"""Numbers of a Fiala tyre, with their dimensions."""
FIALA_REQUIRED = ("UNLOADED_RADIUS", "WIDTH", "VERTICAL_STIFFNESS", "CSLIP", "CALPHA", "UMIN", "UMAX")
AS_BEFORE = {**dict.fromkeys(LATER, 0.0), "PKY4": 2.0, "QSY7": 1.0}
"""Values of these coefficients without effect."""
TURN_SLIP = _words(
    """
    PDXP1 PDXP2 PDXP3 PKYP1 PDYP1 PDYP2 PDYP3 PDYP4 PHYP1 PHYP2 PHYP3 PHYP4 PECP1 PECP2
    QDTP1 QCRP1 QCRP2 QBRP1 QDRP1 QDRP2
    """
)
"""Coefficients of turn slip."""
ONLY_BEFORE = _words("PHY3 PTX1 PTX2 PTX3 PTY1 PTY2 LGAX LGAY LGAZ LSGKP LSGAL")
"""Coefficients of MF-Tyre 5.2 that later versions do not have."""
COEFFICIENTS_6 = (
    *(name for name in COEFFICIENTS if name not in ONLY_BEFORE), *LATER, *TURN_SLIP,
    *_words("PCFX1 PCFX2 PCFX3 PCFY1 PCFY2 PCFY3"),
)  # fmt: skip
"""Coefficients of MF-Tyre 6.1 and 6.2."""
SCALES_6 = (*(name for name in SCALES if name not in ONLY_BEFORE), *_words("LKYC LKZC LMP LMUV"))
"""Scale factors of MF-Tyre 6.1 and 6.2."""
DIMENSIONS_6 = {
    **DIMENSIONS, "WIDTH": "length", "ASPECT_RATIO": "", "LONGITUDINAL_STIFFNESS": "stiffness",
    "LATERAL_STIFFNESS": "stiffness", "INFLPRES": "pressure", "NOMPRES": "pressure",
    **dict.fromkeys(_words("Q_RE0 Q_V1 Q_V2 Q_FZ2 Q_FCX Q_FCY PFZ1 Q_RA1 Q_RA2 Q_RB1 Q_RB2 Q_FCY2 Q_CAM3"), ""),
    **dict.fromkeys(_words("ELLIPS_SHIFT ELLIPS_LENGTH ELLIPS_HEIGHT ELLIPS_ORDER ELLIPS_NWIDTH"), ""),
    "Q_CAM1": "", "Q_CAM2": "per length", "Q_FYS1": "force", "Q_FYS2": "force", "Q_FYS3": "force",
}  # fmt: skip
"""Other numbers of MF-Tyre 6.1 and 6.2, with their dimensions."""
RANGES = {
    "slip": ("KPUMIN", "KPUMAX", ""), "slip_angle": ("ALPMIN", "ALPMAX", "angle"),
    "camber": ("CAMMIN", "CAMMAX", "angle"), "load": ("FZMIN", "FZMAX", "force"),
    "pressure": ("PRESMIN", "PRESMAX", "pressure"),
}  # fmt: skip
"""Limits of the valid ranges of a file, by channel, and their dimension."""
POSITIVE = _words("FNOMIN UNLOADED_RADIUS VERTICAL_STIFFNESS NOMPRES IP IP_NOM LIP CSLIP CALPHA UMAX")
"""Numbers above zero."""
OF_THE_FILE = ("FILE_TYPE", "FILE_VERSION", "FILE_FORMAT")
"""Keys that describe the file itself."""
REASONS = {
    "*": {"QTZ1": "of the belt's couple, which needs MBELT too", "MBELT": "of the belt's couple, which needs QTZ1 too"},
    "[INERTIA]": {"*": "the mass properties are those of the wheel's body"},
    "[STRUCTURAL]": {"*": "the rigid ring of MF-Swift is not modelled"},
    "[CONTACT_PATCH]": dict.fromkeys(("ELLIPS_NLENGTH", "ELLIPS_MAX_STEP"), "the cams of each track are a front and a rear one"),
    "[MODEL]": {
        "VXLOW": "the field slow of the tyre has its place", "ROAD_INCREMENT": "of the road", "ROAD_DIRECTION": "of the road",
    },
    "[PARAMETER]": {"CGAMMA": "camber has no effect on Fiala's forces"},
    "[VERTICAL]": dict.fromkeys(("MC_CONTOUR_A", "MC_CONTOUR_B"), "the contact point is in the wheel's plane"),
}  # fmt: skip
"""Reasons why keys have no effect, by section."""
DEFAULT_VALUES = {
    "QTZ1": 0.0, "LGYR": 1.0, "GRAVITY": -9.81, **AS_BEFORE, "MC_CONTOUR_A": 0.0, "MC_CONTOUR_B": 0.0, "Q_CAM": 0.0, "PCMZ1": 0.0,
    "CGAMMA": 0.0, "ENV_C1": 0.0, "ENV_C2": 0.0, "ROAD_DIRECTION": 1.0,
    **dict.fromkeys(("LIP", "LKYC", "LKZC", "LMP", "LMUV", "LAMU", "LCZ", "LFZMAX"), 1.0),
}  # fmt: skip
"""Values of unused keys that have no effect."""


ONE_SIDED = {
    **dict.fromkeys(("PHY1", "PHY2"), "LHY"), **dict.fromkeys(("PVY1", "PVY2"), "LVY"), "PEY3": "LEY", "RHX1": "", "RBY3": "",
    **dict.fromkeys(("RVY1", "RVY2"), "LVYKA"), **dict.fromkeys(("QHZ1", "QHZ2", "QBZ4", "QDZ3", "QEZ4"), ""),
    **dict.fromkeys(("QDZ6", "QDZ7"), "LRES"), "SSZ1": "LS", "QSX1": "LVMX",
}  # fmt: skip
"""Coefficients of ply steer, conicity and other forces that a mirrored tyre has reversed, with their scale factors."""


_HOMES = {
    "DIMENSION": _words("UNLOADED_RADIUS WIDTH ASPECT_RATIO RIM_RADIUS BOTTOMING_RADIUS"),
    "MODEL": _words("LONGVL FITTYP USE_MODE VXLOW"),
    "OPERATING_CONDITIONS": _words("INFLPRES NOMPRES"),
    "VERTICAL_FORCE_RANGE": _words("FZMIN FZMAX"),
    "STRUCTURAL": _words("LONGITUDINAL_STIFFNESS LATERAL_STIFFNESS PCFX1 PCFX2 PCFX3 PCFY1 PCFY2 PCFY3"),
    "CONTACT_PATCH": _words(
        "Q_RA1 Q_RA2 Q_RB1 Q_RB2 ELLIPS_SHIFT ELLIPS_LENGTH ELLIPS_HEIGHT ELLIPS_ORDER ELLIPS_NWIDTH"
    ),
    "TIRE_CONDITIONS": ("IP", "IP_NOM"),
    "VERTICAL": (*DIMENSIONS_6, "QPFZ1"),
    "SCALING_COEFFICIENTS": (*SCALES, *SCALES_6, "LGYR", "LIP"),
    "PARAMETER": tuple(FIALA),
    "ALIGNING_COEFFICIENTS": ("QTZ1", "MBELT"),
    "OVERTURNING_COEFFICIENTS": ("PPMX1",),
    "TURNSLIP_COEFFICIENTS": TURN_SLIP,
}
_HOME = {name: section for section, names in reversed(_HOMES.items()) for name in names}


def home(name: str) -> str:
    """Return the section of a property file that a key belongs to."""
    of_torque = {"X": "OVERTURNING_COEFFICIENTS", "Y": "ROLLING_COEFFICIENTS", "Z": "ALIGNING_COEFFICIENTS"}
    of_force = {"X": "LONGITUDINAL_COEFFICIENTS", "Y": "LATERAL_COEFFICIENTS", "Z": "ALIGNING_COEFFICIENTS"}
    return _HOME.get(name) or (of_torque if name[0] == "Q" else of_force).get(name[2:3], "")


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
SAMPLE_6 = {
    **SAMPLE, **dict.fromkeys(_words("LONGITUDINAL_STIFFNESS LATERAL_STIFFNESS NOMPRES Q_RE0 WIDTH"), 1.0),
    "VERTICAL_STIFFNESS": 3.0, "PPX1": 0.1, "PPY1": 0.1, "QSY7": 0.9, "Q_V1": 0.01, "Q_V2": 0.1, "Q_FZ2": 0.5, "Q_FCY2": -0.4,
    "Q_CAM1": 1.0, "Q_CAM2": 1.0, "Q_FYS1": 0.1, "Q_FCX": 4e-3, "Q_FCY": 2e-3,
}  # fmt: skip
"""Coefficients of a tyre of 6.2, for compilation in advance."""
SAMPLE_FIALA = {**dict.fromkeys(FIALA_REQUIRED, 1.0), "UMIN": 0.8}
"""Numbers of a Fiala tyre, for compilation in advance."""
