"""Types of fields with dimensions: ``si.Length`` is a finite number in metres, or text with a unit of length."""

from __future__ import annotations

from typing import Annotated

from ..fields import Measured

Anything = Annotated[float, Measured("value")]
Number = Annotated[float, Measured("number")]
Angle = Annotated[float, Measured("angle")]
Length = Annotated[float, Measured("length")]
Time = Annotated[float, Measured("time")]
Mass = Annotated[float, Measured("mass")]
Inertia = Annotated[float, Measured("moment of inertia")]
Velocity = Annotated[float, Measured("velocity")]
AngularVelocity = Annotated[float, Measured("angular velocity")]
Acceleration = Annotated[float, Measured("acceleration")]
Force = Annotated[float, Measured("force")]
Torque = Annotated[float, Measured("torque")]
Stiffness = Annotated[float, Measured("stiffness")]
Damping = Annotated[float, Measured("damping")]
TorsionalStiffness = Annotated[float, Measured("torsional stiffness")]
TorsionalDamping = Annotated[float, Measured("torsional damping")]
CouplingStiffness = Annotated[float, Measured("coupling stiffness")]
CouplingDamping = Annotated[float, Measured("coupling damping")]

PositiveTime = Annotated[float, Measured("time", above=0)]
PositiveMass = Annotated[float, Measured("mass", above=0)]
PositiveInertia = Annotated[float, Measured("moment of inertia", above=0)]
LengthOrZero = Annotated[float, Measured("length", at_least=0)]
TimeOrZero = Annotated[float, Measured("time", at_least=0)]
PositiveDensity = Annotated[float, Measured("density", above=0)]
PositivePressure = Annotated[float, Measured("pressure", above=0)]
PositiveFrequency = Annotated[float, Measured("frequency", above=0)]
PositiveForce = Annotated[float, Measured("force", above=0)]
PositiveVelocity = Annotated[float, Measured("velocity", above=0)]
PositiveLength = Annotated[float, Measured("length", above=0)]
NumberOrZero = Annotated[float, Measured("number", at_least=0)]
LengthNotZero = Annotated[float, Measured("length", other_than=0)]
NumberNotZero = Annotated[float, Measured("number", other_than=0)]
PositiveValue = Annotated[float, Measured("value", above=0)]
ValueNotZero = Annotated[float, Measured("value", other_than=0)]
PositiveNumber = Annotated[float, Measured("number", above=0)]
