"""Cross sections of beams.

Axis 1 of a section is the tangent. The height is measured along axis 3, in the plane of motion of a planar model. I2 is
the second moment of area for bending about axis 2, that is in the direction of the height, and shear3 the shear factor
of that direction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, Self, cast

import numpy as np
from pydantic import Field, model_validator

from ...elements.geometry import one_of
from ...errors import prefixed
from ...reading.fields import Described, Measured
from ...reading.units import si
from .open_section import of_rectangles, of_walls

Bounds = tuple[float, float, float, float]
"""Bounds of a rectangle along axis 2, then along axis 3, m."""
PRINCIPAL = 1e-6
"""Largest product of inertia of principal axes, relative to the larger second moment."""
CENTRED = 0.01
"""Largest distance of the shear centre from the plane of motion, relative to the root of the area."""


@dataclass(frozen=True)
class Properties:
    """Constants of a cross section."""

    A: float  # area, m^2
    # I2, I3: second moments of area about axes 2 and 3, m^4
    I2: float
    I3: float
    J: float  # torsion constant, m^4
    # shear2, shear3: shear factors: GA2 = shear2 G A
    shear2: float
    shear3: float
    I23: float = 0.0  # product of inertia, the integral of the product of the coordinates along axes 2 and 3, m^4
    shear_centre: tuple[float, float] = (0.0, 0.0)  # from the centroid along axes 2 and 3, m
    # inverse of a shear factor: the shear strain along axis 2 by a force along axis 3 is shear23 V/(G A)
    shear23: float = 0.0
    # curvatures about axes 2 and 3 by torsion, per kappa_1^2/2, m (`wagner_coefficients`)
    wagner: tuple[float, float] = (0.0, 0.0)

    def stiffness(self, E: float, G: float) -> np.ndarray:
        """Return the matrix of the strains (Gamma, kappa) of the centroid, shape (6, 6).

        Its shear block belongs to the strains of the shear centre, Gamma_2 - z kappa_1 and Gamma_3 + y kappa_1.
        """
        y, z = self.shear_centre
        K = np.diag([E * self.A, 0.0, 0.0, G * self.J, E * self.I2, E * self.I3])
        K[4, 5] = K[5, 4] = -E * self.I23
        K[1:3, 1:3] = G * self.A * np.linalg.inv([[1 / self.shear2, self.shear23], [self.shear23, 1 / self.shear3]])
        at_shear_centre = np.eye(6)
        at_shear_centre[1:3, 3] = -z, y
        return cast(np.ndarray, at_shear_centre.T @ K @ at_shear_centre)

    def inertia(self, density: float) -> np.ndarray:
        """Return the inertia per length about the centroid, shape (3, 3), kg m."""
        J = density * np.diag([self.I2 + self.I3, self.I2, self.I3])
        J[1, 2] = J[2, 1] = -density * self.I23
        return cast(np.ndarray, J)

    def leaves_plane(self) -> str:
        """Return why a force along axis 3 moves the section out of the plane of axes 1 and 3; nothing if it does not."""
        y, _ = self.shear_centre
        if abs(self.I23) > PRINCIPAL * max(self.I2, self.I3):
            angle = math.degrees(math.atan2(-2 * self.I23, self.I2 - self.I3) / 2)
            return f"found principal axes at {angle:.4g} deg from axes 2 and 3, expected none in the plane: the beam would bend out of it"
        if abs(y) > CENTRED * math.sqrt(self.A):
            return f"found a shear centre {abs(y):.3g} m from the plane, expected it in the plane: bending would twist the beam"
        return ""


class Section(Described):
    """Base of cross sections. `type`: name of the kind in scenes."""

    type: str

    def properties(self, nu: float) -> Properties:
        """Return the constants for a Poisson ratio."""
        raise NotImplementedError

    def rectangles(self) -> list[Bounds]:
        """Return rectangles that fill the section, in any axes parallel to axes 2 and 3; none for round or unknown sections."""
        return []

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

    def rectangles(self) -> list[Bounds]:
        """See `Section`."""
        return [(0, self.width, 0, self.height)]


class Flanged(Section):
    """Profile of a web and two equal flanges; the web stands along the height."""

    width: si.PositiveLength = Field(description="of the flanges with the web, along axis 2, m")
    height: si.PositiveLength = Field(description="overall, along axis 3, m")
    flange: si.PositiveLength = Field(description="thickness of each flange, m")
    web: si.PositiveLength = Field(description="thickness of the web, m")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if 2 * self.flange >= self.height:
            raise ValueError(
                f"flange: found {self.flange:g} m, expected less than half the height of {self.height:g} m"
            )
        if self.web >= self.width:
            raise ValueError(f"web: found {self.web:g} m, expected less than the width of {self.width:g} m")
        return self


class IProfile(Flanged):
    """I profile with two equal flanges; its web stands along the height."""

    type: Literal["i"] = "i"

    def properties(self, nu: float) -> Properties:
        """Thin-walled values: shear is carried by the web along axis 3 and by the flanges along axis 2."""
        b, h, t, w = self.width, self.height, self.flange, self.web
        inside = h - 2 * t
        A = 2 * b * t + inside * w
        I2 = (b * h**3 - (b - w) * inside**3) / 12
        I3 = (2 * t * b**3 + inside * w**3) / 12
        J = (2 * b * t**3 + (h - t) * w**3) / 3
        return Properties(A, I2, I3, J, 5 / 6 * 2 * b * t / A, h * w / A)

    def rectangles(self) -> list[Bounds]:
        """See `Section`."""
        b, h, t, w = self.width, self.height, self.flange, self.web
        return [(0, b, 0, t), ((b - w) / 2, (b + w) / 2, t, h - t), (0, b, h - t, h)]


class Angle(Section):
    """L profile; its legs extend from the corner along axes 2 and 3."""

    type: Literal["l"] = "l"
    width: si.PositiveLength = Field(description="length of the leg along axis 2, m")
    height: si.PositiveLength = Field(description="length of the leg along axis 3, m")
    thickness: si.PositiveLength = Field(description="thickness of both legs, m")

    @model_validator(mode="after")
    def _fits(self) -> Angle:
        if self.thickness >= min(self.width, self.height):
            raise ValueError(
                f"thickness: found {self.thickness:g} m, expected less than the legs of {self.width:g} and {self.height:g} m"
            )
        return self

    def properties(self, nu: float) -> Properties:
        """Exact moments of area, and the shear flow and torsion of thin walls."""
        b, h, t = self.width, self.height, self.thickness
        walls = ((b, t / 2), (t / 2, t / 2), (t / 2, h))
        return _thin(self.rectangles(), walls, (t, t))

    def rectangles(self) -> list[Bounds]:
        """See `Section`."""
        b, h, t = self.width, self.height, self.thickness
        return [(0, b, 0, t), (0, t, t, h)]


class Channel(Flanged):
    """U profile with two equal flanges; its web stands along the height, and the flanges extend along axis 2."""

    type: Literal["u"] = "u"

    def properties(self, nu: float) -> Properties:
        """Exact moments of area, and the shear flow and torsion of thin walls."""
        b, h, t, w = self.width, self.height, self.flange, self.web
        walls = ((b, t / 2), (w / 2, t / 2), (w / 2, h - t / 2), (b, h - t / 2))
        return _thin(self.rectangles(), walls, (t, w, t))

    def rectangles(self) -> list[Bounds]:
        """See `Section`."""
        b, h, t, w = self.width, self.height, self.flange, self.web
        return [(0, b, 0, t), (0, w, t, h - t), (0, b, h - t, h)]


def _thin(rectangles: list[Bounds], walls: tuple[tuple[float, float], ...], t: tuple[float, ...]) -> Properties:
    A, centroid, moments, third = of_rectangles(rectangles)
    centre, compliance = of_walls(walls, t)
    J = sum(math.dist(a, b) * each**3 for (a, b), each in zip(pairwise(walls), t, strict=True)) / 3
    (I3, I23), (_, I2) = moments.tolist()
    (shear2, shear23), (_, shear3) = (A * compliance).tolist()
    y, z = (centre - centroid).tolist()
    wagner = wagner_coefficients((I2, I3, I23), third.tolist(), (y, z))
    return Properties(A, I2, I3, J, 1 / shear2, 1 / shear3, I23, (y, z), shear23, wagner)


def wagner_coefficients(
    second: tuple[float, float, float], third: Sequence[float], shear_centre: tuple[float, float]
) -> tuple[float, float]:
    """Return Wagner's coefficients for both axes, m.

    Torsion about the shear centre stretches a fibre at the distance r from it by r^2 kappa_1^2/2. The part of this strain
    that is linear in the coordinates of the section is a curvature. For bending in a plane of symmetry its coefficient
    is the beta of lateral buckling (Trahair, Flexural-Torsional Buckling of Structures, 1993, sec. 17.4).

    `second`: I2, I3 and I23, m^4. `third`: integrals of the coordinates along axes 2 and 3 times the square of the
    distance from the centroid, m^5. `shear_centre`: from the centroid along axes 2 and 3, m.
    """
    (I2, I3, I23), (y, z) = second, shear_centre
    about_2, about_3 = np.linalg.solve([[I2, -I23], [-I23, I3]], [third[1], -third[0]]).tolist()
    return about_2 - 2 * z, about_3 + 2 * y


class Numbers(Section):
    """Section of any form, by its constants; in the plane I2 and shear3 are those of the plane."""

    type: Literal["numbers"] = "numbers"
    A: si.PositiveArea = Field(description="area, m^2")
    I2: si.PositiveSecondMoment = Field(description="about axis 2, for bending along the height or in the plane, m^4")
    I3: si.PositiveSecondMoment | None = Field(None, description="about axis 3, m^4; I2 by default")
    J: si.PositiveSecondMoment | None = Field(
        None, description="torsion constant, m^4; I2 + I3 by default, as for a circle"
    )
    shear2: si.PositiveNumber = Field(1.0, description="shear factor along axis 2")
    shear3: si.PositiveNumber = Field(1.0, description="shear factor along axis 3, or in the plane")
    I23: Annotated[float, Measured("second moment of area")] = Field(
        0.0, description="product of inertia, positive where the area is in the first and third quadrant, m^4"
    )
    shear_centre: si.Point2 = Field((0.0, 0.0), description="from the centroid along axes 2 and 3, m")
    wagner: si.Point2 = Field(
        (0.0, 0.0), description="curvature about axes 2 and 3 by torsion over half of its square (Wagner), m"
    )

    @model_validator(mode="after")
    def _positive(self) -> Numbers:
        limit = math.sqrt(self.I2 * (self.I2 if self.I3 is None else self.I3))
        if abs(self.I23) >= limit:
            raise ValueError(f"I23: found {self.I23:g} m^4, expected less than the root of I2 I3, {limit:g} m^4")
        return self

    def complete(self) -> Numbers:
        """Return the section with the constants that follow from others by default."""
        I3 = self.I2 if self.I3 is None else self.I3
        return self.model_copy(update={"I3": I3, "J": self.I2 + I3 if self.J is None else self.J})

    def properties(self, nu: float) -> Properties:
        """Return the given constants, completed; `nu` is not used."""
        of: Any = self.complete()
        return Properties(
            of.A, of.I2, of.I3, of.J, of.shear2, of.shear3, of.I23, of.shear_centre, wagner=of.wagner
        )  # fmt: skip


class Drawn(Section):
    """Section drawn by its outline and holes, whose constants follow from finite elements."""

    type: Literal["points"] = "points"
    points: tuple[si.Point2, ...] = Field(min_length=3, description="outline, along axes 2 and 3 (the height), m")
    holes: tuple[tuple[si.Point2, ...], ...] = Field((), description="outlines of holes, m")

    def properties(self, nu: float) -> Properties:
        """See `stiffmbs.model.beams.drawn_section`; the shear factors are those of a Poisson ratio of zero."""
        from .drawn_section import constants_of

        with prefixed("section: ", ValueError, ValueError):
            return constants_of(self.points, self.holes)


SECTIONS = (Circle, Tube, Rectangle, IProfile, Angle, Channel, Numbers, Drawn)


AnySection = Annotated[Any, one_of("a section such as {type: circle, diameter: 10 mm}", lambda: SECTIONS)]


class Material(Described):
    """Linear elastic, isotropic material."""

    E: si.PositivePressure = Field(description="Young's modulus, N/m^2")
    nu: Annotated[float, Measured("number", at_least=0, at_most=0.5)] = Field(0.3, description="Poisson's ratio")
    density: si.PositiveDensity = Field(description="density, kg/m^3")

    @property
    def G(self) -> float:
        """Shear modulus, N/m^2."""
        return self.E / (2 * (1 + self.nu))
