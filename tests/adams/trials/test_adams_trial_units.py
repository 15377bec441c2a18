"""One mechanism in many systems of units and many ways of writing: the numbers in SI stay."""

import numpy as np
import pytest

import stiffmbs

pytestmark = pytest.mark.long

INCH, POUND, POUND_FORCE = 0.0254, 0.45359237, 0.45359237 * 9.80665

SYSTEMS = {  # units in SI: force, mass, length, time
    "UNITS/SYSTEM=MKS": (1, 1, 1, 1),
    "UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND": (1, 1, 1e-3, 1),
    "UNITS/FORCE=KNEWTON, MASS=GRAM, LENGTH=MILLIMETER, TIME=MILLISECONDS": (1e3, 1e-3, 1e-3, 1e-3),
    "UNITS/TIME=MINUTE, FORCE=DYNE, LENGTH=FOOT, MASS=SLUG": (1e-5, POUND_FORCE / 0.3048, 0.3048, 60),
    "UNITS/SYSTEM=IPS": (POUND_FORCE, POUND, INCH, 1),
    "UNITS/SYSTEM=CGS": (1e-5, 1e-3, 1e-2, 1),
    "UNITS/FORCE=POUND_FORCE, MASS=SLINCH, LENGTH=INCH, TIME=SECOND": (POUND_FORCE, POUND_FORCE / INCH, INCH, 1),
    "UNITS/FORCE=NEWTON, MASS=TONNE, LENGTH=MILLIMETER, TIME=SECOND": (1, 1e3, 1e-3, 1),
    "unit/force = kilogram_force\n, mass = ounce_mass\n, length = centimeter\n, time = sec": (
        9.80665,
        POUND / 16,
        1e-2,
        1,
    ),
}


def dataset(units, force, mass, length, time):
    """A screw, a rack, a coupler, a bushing, springs, forces and a drive by numbers in the given units."""

    def of(value, f=0, m=0, x=0, s=0):
        return f"{value / (force**f * mass**m * length**x * time**s):.17g}"

    def at(*place):
        return ",".join(of(x, x=1) for x in place)

    def ip(*moments):
        return ",".join(of(i, m=1, x=2) for i in moments)

    return rf"""units of all sorts
{units}
ACCGRAV/IGRAV={of(3, x=1, s=-2)}, KGRAV={of(-9, x=1, s=-2)}
PART/1, GROUND
MARKER/1, PART=1, QP={at(0, 0, 0.1)}, REULER=0,30D,0
MARKER/2, PART=1, QP={at(1, 0, 0)}
PART/2, MASS={of(2, m=1)}, CM=20, IP={ip(0.2, 0.3, 0.2, 0.01, 0, 0.02)}, QG={at(0, 0, 0.1)}, REULER=0,30D,0
, VZ={of(0.3 * np.cos(np.pi / 6), x=1, s=-1)}, VY={of(-0.15, x=1, s=-1)}, WZ={of(0.3 / 0.05 * 2 * np.pi, s=-1)}
MARKER/20, PART=2
MARKER/21, PART=2
JOINT/1, CYLINDRICAL, I=21, J=1
JOINT/2, SCREW, I=21, J=1, PITCH={of(0.05, x=1)}
PART/3, MASS={of(1, m=1)}, CM=30, IP={ip(0.02, 0.03, 0.01)}, QG={at(1, 0, 0)}
MARKER/30, PART=3, QP={at(0.1, 0.05, 0)}
MARKER/31, PART=3
JOINT/3, REVOLUTE, I=31, J=2
MOTION/3, JOINT=3, FUNCTION=STEP(TIME,{of(0.1, s=1)},0,{of(0.4, s=1)},45D)
PART/4, MASS={of(1, m=1)}, CM=40, IP={ip(0.02, 0.03, 0.01)}, QG={at(1, 1, 0)}, VX={of(0.4, x=1, s=-1)}, WY={of(0.3, s=-1)}
MARKER/40, PART=4, QP={at(0.1, 0.05, 0)}
MARKER/41, PART=4
MARKER/32, PART=3, QP={at(0, 1, 0)}
MARKER/49, PART=3, FLOATING
BUSHING/1, I=41, J=32, K={of(100, 1, x=-1)},{of(150, 1, x=-1)},{of(200, 1, x=-1)}
, C={of(1, 1, x=-1, s=1)},{of(2, 1, x=-1, s=1)},{of(3, 1, x=-1, s=1)}
, KT={of(10, 1, x=1)},{of(11, 1, x=1)},{of(12, 1, x=1)}, CT={of(0.1, 1, x=1, s=1)},{of(0.2, 1, x=1, s=1)},0
, FORCE={of(1, 1)},0,{of(2, 1)}, TORQUE=0,{of(0.3, 1, x=1)},0
SPRINGDAMPER/1, TRANSLATION, I=40, J=1, K={of(30, 1, x=-1)}, C={of(0.5, 1, x=-1, s=1)}, LENGTH={of(0.9, x=1)}, FORCE={of(3, 1)}
VFORCE/1, I=40, JFLOAT=49, RM=32, FX={of(2, 1, x=-1)}*DX(40,1,32)\FY={of(-0.4, 1, x=-1, s=1)}*VM(40)\FZ={of(1, 1)}*SIN({of(9, s=-1)}*TIME)
SFORCE/2, ROTATION, I=21, J=1, FUNCTION={of(-0.02, 1, x=1, s=1)}*WZ(21,1,1)
VARIABLE/1, FUNCTION=VX(40)*{of(1, f=1, x=-1, s=1)}+VARVAL(2)
VARIABLE/2, FUNCTION=ACCX(40)*{of(0.1, f=1, x=-1, s=2)}
REQUEST/1, DISPLACEMENT, I=40, J=32, RM=32
REQUEST/2, VELOCITY, I=40, J=32, RM=31
REQUEST/3, ACCELERATION, I=40, J=32
REQUEST/4, FORCE, I=41, J=32, RM=31
REQUEST/5, F2=DX(40)\F3=VX(40)\F4=ACCZ(40)\F6=BUSH(1,0,2,0)\F7=BUSH(1,0,7,31)\F8=WZ(21,1,1)
END
"""


DIMENSIONS = {"f2": (0, 1, 0), "f3": (0, 1, -1), "f4": (0, 1, -2), "f6": (1, 0, 0), "f7": (1, 1, 0), "f8": (0, 0, -1)}


def solved(folder, text):
    path = folder / "units.adm"
    path.write_text(text)
    return stiffmbs.run(stiffmbs.load_scene(path), duration=0.6, output=0.02, rtol=1e-9)


@pytest.fixture(scope="module")
def in_si(tmp_path_factory):
    first = next(iter(SYSTEMS))
    return solved(tmp_path_factory.mktemp("si"), dataset(first, *SYSTEMS[first]))


@pytest.mark.sampled(9)
@pytest.mark.parametrize("units", list(SYSTEMS)[1:])
def test_channels_are_in_si_and_functions_in_units_of_the_dataset(tmp_path, in_si, units):
    force, mass, length, time = SYSTEMS[units]
    found = solved(tmp_path, dataset(units, force, mass, length, time))
    assert set(found.channels) == set(in_si.channels)
    for name, wanted in in_si.channels.items():
        if name.startswith(("energy", "constraint")):
            continue
        unit = 1.0
        if name.startswith("REQUEST_5"):
            f, x, s = DIMENSIONS[name[-2:]]
            unit = force**f * length**x * time**s
        if name.startswith("VARIABLE"):
            unit = force
        scale = max(np.abs(wanted).max(), 1e-2)
        assert np.abs(found.channels[name] * unit - wanted).max() < 1e-5 * scale, name
