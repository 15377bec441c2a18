"""Cross sections of beams.

Axis 1 of a section is the tangent. The height is measured along axis 3, in the plane of motion of a planar model. I2 is
the second moment of area for bending about axis 2, that is in the direction of the height, and shear3 the shear factor
of that direction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ...elements.shape import one_of
from ...reading.fields import Described, Measured
from ...reading.units import si

Area = Annotated[float, Measured("area", above=0)]
SecondMoment = Annotated[float, Measured("second moment of area", above=0)]
Factor = Annotated[float, Measured("number", above=0)]


@dataclass(frozen=True)
class Properties:
    """Constants of a cross section.

    Attributes
    ----------
    A : float
        Area, m^2.
    I2, I3 : float
        Second moments of area about axes 2 and 3, m^4.
    J : float
        Torsion constant, m^4.
    shear2, shear3 : float
        Shear factors: GA2 = shear2 G A.
    """

    A: float
    I2: float
    I3: float
    J: float
    shear2: float
    shear3: float


class Section(Described):
    """Base of cross sections. `type`: name of the kind in scenes."""

    type: str

    def properties(self, nu: float) -> Properties:
        """Return the constants for a Poisson ratio."""
        raise NotImplementedError

    def radius(self, planar: bool) -> float:
        """Return the distance of the surface from the axis, m; 0 if it depends on the direction or is unknown."""
        if "diameter" in type(self).model_fields:
            return float(self.diameter / 2)  # type: ignore[attr-defined]
        return float(self.height / 2) if planar and "height" in type(self).model_fields else 0.0  # type: ignore[attr-defined]


class Circle(Section):
    """Solid circle."""

    type: Literal["circle"] = "circle"
    diameter: si.PositiveLength = Field(description="m")

    def properties(self, nu: float) -> Properties:
        """Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33 (1966) 335-340."""
        A, second, shear = math.pi * self.diameter**2 / 4, math.pi * self.diameter**4 / 64, 6 * (1 + nu) / (7 + 6 * nu)
        return Properties(A, second, second, 2 * second, shear, shear)


class Tube(Section):
    """Circular tube."""

    type: Literal["tube"] = "tube"
    diameter: si.PositiveLength = Field(description="outer diameter, m")
    thickness: si.PositiveLength = Field(description="of the wall, m")

    @model_validator(mode="after")
    def _hollow(self) -> Tube:
        if 2 * self.thickness >= self.diameter:
            raise ValueError(
                f"thickness: found {self.thickness:g} m, expected less than half the diameter of {self.diameter:g} m; "
                "a solid bar is {type: circle}"
            )
        return self

    def properties(self, nu: float) -> Properties:
        """Cowper (1966), as for the circle; m is the ratio of inner to outer diameter."""
        outer, inner = self.diameter, self.diameter - 2 * self.thickness
        A, second = math.pi * (outer**2 - inner**2) / 4, math.pi * (outer**4 - inner**4) / 64
        m = (inner / outer) ** 2
        shear = 6 * (1 + nu) * (1 + m) ** 2 / ((7 + 6 * nu) * (1 + m) ** 2 + (20 + 12 * nu) * m)
        return Properties(A, second, second, 2 * second, shear, shear)


class Rectangle(Section):
    """Solid rectangle."""

    type: Literal["rectangle"] = "rectangle"
    width: si.PositiveLength = Field(description="along axis 2, across a planar model, m")
    height: si.PositiveLength = Field(description="along axis 3, in the plane of a planar model, m")

    def properties(self, nu: float) -> Properties:
        """Shear factor 5/6 (Reissner); torsion constant by Saint-Venant's series (Timoshenko, Goodier, sec. 109)."""
        b, h = self.width, self.height
        long, short = max(b, h), min(b, h)
        series = sum(math.tanh(n * math.pi * long / (2 * short)) / n**5 for n in range(1, 100, 2))
        J = long * short**3 / 3 * (1 - 192 / math.pi**5 * short / long * series)
        return Properties(b * h, b * h**3 / 12, h * b**3 / 12, J, 5 / 6, 5 / 6)


class IProfile(Section):
    """I profile with two equal flanges; its web stands along the height."""

    type: Literal["i"] = "i"
    width: si.PositiveLength = Field(description="of the flanges, along axis 2, m")
    height: si.PositiveLength = Field(description="overall, along axis 3, m")
    flange: si.PositiveLength = Field(description="thickness of each flange, m")
    web: si.PositiveLength = Field(description="thickness of the web, m")

    @model_validator(mode="after")
    def _fits(self) -> IProfile:
        if 2 * self.flange >= self.height:
            raise ValueError(
                f"flange: found {self.flange:g} m, expected less than half the height of {self.height:g} m"
            )
        if self.web >= self.width:
            raise ValueError(f"web: found {self.web:g} m, expected less than the width of {self.width:g} m")
        return self

    def properties(self, nu: float) -> Properties:
        """Thin-walled values: shear is carried by the web along axis 3 and by the flanges along axis 2."""
        b, h, t, w = self.width, self.height, self.flange, self.web
        inside = h - 2 * t
        A = 2 * b * t + inside * w
        I2 = (b * h**3 - (b - w) * inside**3) / 12
        I3 = (2 * t * b**3 + inside * w**3) / 12
        J = (2 * b * t**3 + (h - t) * w**3) / 3
        return Properties(A, I2, I3, J, 5 / 6 * 2 * b * t / A, h * w / A)


class Numbers(Section):
    """Section of any form, by its constants; in the plane I2 and shear3 are those of the plane."""

    type: Literal["numbers"] = "numbers"
    A: Area = Field(description="area, m^2")
    I2: SecondMoment = Field(description="about axis 2, for bending along the height or in the plane, m^4")
    I3: SecondMoment | None = Field(None, description="about axis 3, m^4; I2 by default")
    J: SecondMoment | None = Field(None, description="torsion constant, m^4; I2 + I3 by default, as for a circle")
    shear2: Factor = Field(1.0, description="shear factor along axis 2")
    shear3: Factor = Field(1.0, description="shear factor along axis 3, or in the plane")

    def properties(self, nu: float) -> Properties:
        I3 = self.I2 if self.I3 is None else self.I3
        return Properties(self.A, self.I2, I3, self.I2 + I3 if self.J is None else self.J, self.shear2, self.shear3)


_Point = tuple[si.Length, si.Length]


class Drawn(Section):
    """Section drawn by its outline and holes, whose constants follow from finite elements."""

    type: Literal["points"] = "points"
    points: tuple[_Point, ...] = Field(min_length=3, description="outline, along axes 2 and 3 (the height), m")
    holes: tuple[tuple[_Point, ...], ...] = Field((), description="outlines of holes, m")

    def properties(self, nu: float) -> Properties:
        """See `stiffmbs.model.beams.drawn_section`; the shear factors are those of a Poisson ratio of zero."""
        from .drawn_section import constants_of

        try:
            return Properties(*constants_of(self.points, self.holes))
        except ValueError as error:
            raise ValueError(f"section: {error}") from None


SECTIONS = (Circle, Tube, Rectangle, IProfile, Numbers, Drawn)


AnySection = Annotated[Any, one_of("a section such as {type: circle, diameter: 10 mm}", *SECTIONS)]


class Material(Described):
    """Linear elastic, isotropic material."""

    E: Annotated[float, Measured("pressure", above=0)] = Field(description="Young's modulus, N/m^2")
    nu: Annotated[float, Measured("number", at_least=0, at_most=0.5)] = Field(0.3, description="Poisson's ratio")
    density: Annotated[float, Measured("density", above=0)] = Field(description="kg/m^3")

    @property
    def G(self) -> float:
        """Shear modulus, N/m^2."""
        return self.E / (2 * (1 + self.nu))
