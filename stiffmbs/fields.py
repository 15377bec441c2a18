"""Field types of user-defined elements, in addition to `stiffmbs.Marker` and numbers with units (`stiffmbs.si`).

Examples
--------
>>> import stiffmbs
>>> from stiffmbs.fields import JointReference, OfMotion, OfTime
>>> class Push(stiffmbs.Force):
...     kind = "push"
...     i: stiffmbs.Marker
...     force: OfMotion  # a formula of coordinates, velocities, measures and time
...
...     @staticmethod
...     def efforts(e):
...         return [(e.force, e.i.point[0])]
"""

from .elements.loads import Loads
from .reading.formula.field import (
    ForceOfDeflection,
    ForceOfMotion,
    ForceOfRate,
    OfMotion,
    OfPosition,
    OfTime,
    TorqueOfDeflection,
    TorqueOfMotion,
    TorqueOfRate,
)
from .reading.joint_name import JointReference
from .reading.python_function import PythonFunction

__all__ = [
    "ForceOfDeflection",
    "ForceOfMotion",
    "ForceOfRate",
    "JointReference",
    "Loads",
    "OfMotion",
    "OfPosition",
    "OfTime",
    "PythonFunction",
    "TorqueOfDeflection",
    "TorqueOfMotion",
    "TorqueOfRate",
]
