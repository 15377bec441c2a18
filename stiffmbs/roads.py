"""Roads for tyres, and the base class of user-defined roads.

Examples
--------
>>> from stiffmbs.roads import CosineBump
>>> road = CosineBump(start=5, length="600 mm", crest="80 mm")
"""

from .elements.roads.crg import CrgRoad
from .elements.roads.formula import FormulaRoad
from .elements.roads.grid import GridRoad
from .elements.roads.iso8608 import Iso8608Road
from .elements.roads.obstacles import CosineBump, SineSweep, StepRoad
from .elements.roads.profile import TableRoad
from .elements.roads.road import FlatRoad, Road

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
