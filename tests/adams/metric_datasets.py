"""Datasets of Adams in metres and kilograms, and their runs."""

import stiffmbs
from stiffmbs.adams.load import read_adams

HEAD = """title
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
"""
G = 9.80665
GRAVITY = f"ACCGRAV/KGRAV=-{G}\n"


def run(text, duration=1.0, rtol=1e-9, **settings):
    return stiffmbs.run(read_adams(HEAD + text + "\nEND\n"), duration=duration, rtol=rtol, **settings)


TWO = """PART/2, MASS=2, CM=20, IP=0.1,0.1,0.2
MARKER/20, PART=2
MARKER/21, PART=2
PART/3, MASS=3, CM=30, IP=0.3,0.2,0.4, QG=1,0,0
MARKER/30, PART=3
MARKER/31, PART=3
MARKER/13, PART=1, QP=1,0,0
"""
