"""Base of tyres: contact of a wheel with a road, load, and wrench on the wheel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, model_validator

from ...reading.units import si
from ..element import Expr, Force, Matrix, Symbolic, sp
from ..roads.envelope import Envelope
from ..roads.field import ROAD
from ..roads.road import FlatRoad, Road, above_zero
from .contact_point import ContactPoint, contact_point, slips
from .marker import Marker
from .relaxation import lagged
from .wrench import Pairs, along_axes, velocity

CHANNELS = (
    "longitudinal", "lateral", "load", "overturning", "rolling", "aligning", "slip", "slip_angle", "camber", "deflection",
)  # fmt: skip


@dataclass(frozen=True)
class Rolling:
    """Arguments of the force law of a tyre, one symbol each.

    Attributes
    ----------
    load : Symbol
        Normal force of the road on the tyre, N, zero or positive.
    slip : Symbol
        kappa, positive when driving.
    slip_angle : Symbol
        alpha, rad; positive if the tyre moves to its left, with a negative lateral force.
    camber : Symbol
        gamma, rad; positive if the top leans to the right.
    speed : Symbol
        abs(Vx), m/s, the reference speed of slips: never zero.
    direction : Symbol
        Vx over `speed`: 1 forward, -1 backward, with a smooth transition near zero speed.
    friction : Symbol
        Friction factor of the road.
    turn, rolling : Symbol, optional
        Yaw rate and spin over the speed of the contact point, 1/m, of a tyre with turn slip.
    """

    load: Expr
    slip: Expr
    slip_angle: Expr
    camber: Expr
    speed: Expr
    direction: Matrix
    friction: Expr
    turn: Expr = None
    rolling: Expr = None


@dataclass(frozen=True)
class Touch:
    """Contact, deflection (m), load (N), slip, tangent of slip angle, reference speed (m/s), state rates, turn slip."""

    contact: ContactPoint
    deflection: Expr
    load: Expr
    slip: Expr
    tangent: Matrix
    speed: Expr
    rates: tuple[Expr, ...] = ()
    turn: tuple[Expr, ...] = ()


class Tyre(Force):
    """Base of tyres in space; a subclass defines its fields, its `law`, and optionally its load.

    Marker i is the centre of the wheel on the spinning body, its y axis the spin axis, to the left of its heading. The
    road meets the wheel in one point (`stiffmbs.elements.spatial.contact_point`). The wrench on the wheel is reported.
    Further channels are resolved in the ISO axes at that point, x forward, y to the left, z out of the road. They are
    the forces ``longitudinal``, ``lateral`` and ``load`` (N), the torques ``overturning``, ``rolling`` and ``aligning``
    (N m), ``slip``, ``slip_angle`` and ``camber`` (rad), and ``deflection`` (m). energy.total does not include the
    elastic energy of a tyre.
    """

    symbol = "tyre"
    channels = CHANNELS
    may_keep_energy = False
    reflected = {"j": "z"}
    spin_conditions = {"i": "y"}

    i: Marker = Field(description="centre of the wheel, its y axis the spin axis, to the left of the heading")
    j: Marker | None = Field(
        None, description="whose axes the road's x, y and z are, on a body that carries it; ground by default"
    )
    road: Annotated[Road, ROAD] = Field(
        FlatRoad.model_construct(type=FlatRoad.kind),
        description="the name of a road of the scene, or a road; level at z = 0 by default",
    )
    envelope: Envelope | None = Field(
        None,
        description="elliptical cams on which the tyre rolls over short obstacles; one point of contact by default",
    )
    slow: si.PositiveVelocity = Field(
        1.0, description="speed below which slips are modified, m/s: see the guide on tyres"
    )

    @model_validator(mode="after")
    def _on_cams(self) -> Tyre:
        if (cams := self.cams()) is not None:
            self.__dict__.update(envelope=cams, road=self.road.under_cams(cams.cam))  # the model is frozen
        return self

    def cams(self) -> Envelope | None:
        """Return the cams of the enveloping contact, or None."""
        return self.envelope

    def mounted_side(self) -> tuple[object, float, tuple[str, ...]]:
        """Return the data of the tyre, 1 or -1 for a mirrored one, and what differs between left and right tyres."""
        return None, 1.0, ()

    @staticmethod
    def law(e: Symbolic, rolling: Rolling) -> tuple[Expr, Expr, Expr, Expr, Expr]:
        """Return Fx, Fy, Mx, My, Mz on the tyre at the contact point, along the ISO axes, N and N m."""
        raise NotImplementedError

    @classmethod
    def relaxation_lengths(cls, e: Symbolic, load: Expr, camber: Expr) -> tuple[Expr, Expr]:
        """Return the longitudinal and lateral relaxation length, m, of a tyre with the `own_states` `DEFLECTIONS`."""
        raise NotImplementedError

    @staticmethod
    def unloaded_radius(e: Symbolic) -> Expr:
        """Return the unloaded radius, m."""
        return e.radius

    @staticmethod
    def carried(e: Symbolic, deflection: Expr, rate: Expr) -> Expr:
        """Return the load at a positive deflection, N; negative values are replaced by zero."""
        return e.stiffness * deflection + e.damping * rate

    @staticmethod
    def rim_contact(e: Symbolic, deflection: Expr, contact: ContactPoint) -> tuple[Expr, Expr] | None:
        """Return the rim's normal force on the road, N, and its overturning torque, N m, or None."""
        return None

    @classmethod
    def belt_couple(cls, e: Symbolic, touch: Touch) -> Expr:
        """Return the gyroscopic couple of the belt about the road's normal, N m; zero by default."""
        return 0

    @classmethod
    def rolling_radius(cls, e: Symbolic, deflection: Expr) -> Expr:
        """Return the effective rolling radius, m: the unloaded radius less a third of the deflection."""
        return cls.unloaded_radius(e) - deflection * sp.Rational(1, 3)

    @classmethod
    def touching(cls, e: Symbolic) -> Touch:
        """Return the contact with its load and slips."""
        contact = contact_point(e)
        closed = e.named(cls.unloaded_radius(e) - contact.radius)
        deflection = e.named(above_zero(closed))
        load = e.read(sp.Piecewise((sp.Max(cls.carried(e, deflection, -contact.vz), 0), closed > 0), (0, True)))
        sliding = e.named(contact.vx - e.named(cls.rolling_radius(e, deflection)) * contact.spin)
        slip, tangent, speed = slips(e, contact, sliding, e.slow)
        if not e.own:
            return Touch(contact, deflection, load, slip, tangent, speed)
        slip, tangent, rates = lagged(e, contact, sliding, cls.relaxation_lengths(e, e.named(load), contact.camber))
        return Touch(contact, deflection, load, slip, tangent, speed, rates)

    @classmethod
    def _acting(cls, e: Symbolic) -> tuple[Expr, Rolling, Expr, Expr]:
        """Return the contact, the arguments of the law, the deflection, and forces and torques with the rim."""
        touch = cls.touching(e)
        contact, angle = touch.contact, e.named(sp.atan(touch.tangent))
        direction = contact.vx / touch.speed
        of = (touch.load, touch.slip, angle, contact.camber, touch.speed, direction, contact.friction, *touch.turn)
        rolling = Rolling(*(e.variable(x) if e.in_state(x) else x for x in map(e.read, of)))
        variables = [x for x in vars(rolling).values() if x is not None and e.in_state(x)]
        fx, fy, mx, my, mz = e.composed(cls.law(e, rolling), variables)
        mz += cls.belt_couple(e, touch)
        rim = cls.rim_contact(e, touch.deflection, contact)
        normal = rolling.load if rim is None else e.read(touch.load + rim[0])
        return contact, rolling, touch.deflection, (fx, fy, normal, mx if rim is None else mx + rim[1], my, mz)

    @classmethod
    def rates(cls, e: Symbolic) -> Sequence[Expr]:
        return cls.touching(e).rates

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the wrench at the contact point on the wheel, and the opposite on the road's body."""
        contact, _, _, (fx, fy, normal, mx, my, mz) = cls._acting(e)
        axes = contact.forward, contact.left, contact.normal
        force = e.named(along_axes((fx, fy, normal), axes))
        torque = e.named(along_axes((mx, my, mz), axes))
        v, w = velocity(e, e.i, contact.point), e.i.omega
        if e.j is not None:
            v, w = v - velocity(e, e.j, contact.point), w - e.j.omega
        return [*zip(force, v, strict=True), *zip(torque, w, strict=True)]

    @classmethod
    def measured(cls, e: Symbolic) -> list[Expr]:
        _, rolling, deflection, (fx, fy, normal, mx, my, mz) = cls._acting(e)
        return [fx, fy, normal, mx, my, mz, rolling.slip, rolling.slip_angle, rolling.camber, deflection]
