"""A dataset of two parts with markers, as the scene that it stands for."""

from stiffmbs.adams.scene.scene import scene
from stiffmbs.adams.statements.dataset import read_dataset

HEAD = """ADAMS/View model name: thing
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH={length}, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
MARKER/2, PART=1, QP=0,0,1, REULER=0,90D,0
PART/2, MASS=1, CM=21, IP=1,2,2
MARKER/21, PART=2, QP=1,0,0
MARKER/22, PART=2
MARKER/23, PART=2, QP=0,0,1, REULER=0,90D,0
PART/3, MASS=1, CM=31, IP=1,1,1
MARKER/31, PART=3, QP=0,2,0
MARKER/32, PART=3, FLOATING
MARKER/33, PART=3
"""


def made(text, length="METER"):
    return scene(read_dataset(HEAD.format(length=length) + text + "\nEND"))
