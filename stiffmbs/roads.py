"""Roads for tyres, and the base class of user-defined roads.

Examples
--------
>>> from stiffmbs.roads import CosineBump
>>> road = CosineBump(start=5, length="600 mm", crest="80 mm")
"""

from .describe.roads.cosine_bump import CosineBump
from .describe.roads.crg import CrgRoad
from .describe.roads.flat import FlatRoad
from .describe.roads.formula import FormulaRoad
from .describe.roads.grid import GridRoad
from .describe.roads.iso8608 import Iso8608Road
from .describe.roads.profile import TableRoad
from .describe.roads.road import Road
from .describe.roads.sine_sweep import SineSweep
from .describe.roads.step import StepRoad

__all__ = [
    "CosineBump",
    "CrgRoad",
    "FlatRoad",
    "FormulaRoad",
    "GridRoad",
    "Iso8608Road",
    "Road",
    "SineSweep",
    "StepRoad",
    "TableRoad",
]
