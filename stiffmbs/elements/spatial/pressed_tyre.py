"""Contact of a Magic Formula tyre of 6.1 and 6.2, whose load depends on its forces along the road.

The load N satisfies N = Z(rho, Omega, gamma, p, Fx(N), Fy(N)) + c rho'. It is found by a fixed number of iterations,
which need the formula of Fx and Fy alone, and differentiated by the implicit function theorem.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..element import Expr, Symbolic, sp
from ..roads.road import above_zero
from .contact_point import ContactPoint, contact_point, slips, yaw_rate
from .relaxation import lagged
from .tyre import Touch

if TYPE_CHECKING:
    from ..tyres.deflection_6 import Stiffening

VARIABLES = ("radius", "camber", "vx", "vy", "vz", "spin", "friction")
"""Quantities of the contact through which load and forces depend on the state."""


def pressure_increment(e: Symbolic) -> Expr:
    """Return dpi, the relative deviation from the nominal pressure; 0 for a tyre without one."""
    p = e.properties
    if p.NOMPRES is None:
        return sp.Rational(0)
    return e.named((p.INFLPRES if e.pressure is None else e.pressure) / p.NOMPRES - 1)


@dataclass(frozen=True)
class _Pressed:
    """Tyre on its contact, in the axes of its property file: a hand of -1 mirrors it."""

    e: Symbolic
    contact: ContactPoint
    hand: Expr
    dpi: Expr
    free: Expr
    yaw: Expr
    """Yaw rate, rad/s, or None without turn slip."""

    @property
    def gamma(self) -> Expr:
        """Camber angle in the axes of the property file, rad."""
        return self.e.named(self.hand * self.contact.camber)

    def slip(self, load: Expr) -> tuple[Expr, Expr, Expr, tuple[Expr, ...]]:
        """Return the slip, the tangent of the slip angle, the reference speed, and the rates of own states."""
        from ..tyres.deflection_6 import effective_radius
        from ..tyres.magic_formula_6 import relaxation_lengths

        e, contact = self.e, self.contact
        rolling = e.named(effective_radius(e.properties, load, self.dpi, self.free))
        sliding = e.named(contact.vx - rolling * contact.spin)
        slip, tangent, speed = slips(e, contact, sliding, e.slow)
        if not e.own:
            return slip, tangent, speed, ()
        lengths = relaxation_lengths(e.properties, load, self.dpi, self.gamma, e.named)
        slip, tangent, rates = lagged(e, contact, sliding, lengths)
        return slip, tangent, speed, rates

    def turn(self, angle: Expr, speed: Expr) -> tuple[Expr, ...]:
        """Return phi_t and Omega/V, 1/m, of a tyre with turn slip."""
        if self.yaw is None:
            return ()
        path = self.e.named(sp.cos(angle) / speed)
        return self.e.named(self.yaw * path), self.e.named(self.contact.spin * path)

    def forces(self, load: Expr) -> tuple[Expr, Expr]:
        """Return Fx and Fy at a load, in the axes of the file; the load in the formula is limited to FZMAX."""
        from ..tyres.magic_formula_6 import PressedSlip, slip_forces

        e, p = self.e, self.e.properties
        slip, tangent, speed, _ = self.slip(load)
        angle = e.named(sp.atan(tangent))
        limited = e.named(load - e.named(above_zero(e.named(load - p.FZMAX))))
        turn = self.turn(angle, speed)
        state = PressedSlip(
            limited, slip, e.named(self.hand * angle), self.gamma, e.named(speed / p.LONGVL),
            e.named(self.contact.vx / speed), self.contact.friction, self.dpi,
            *((e.named(self.hand * turn[0]), turn[1]) if turn else ()),
        )  # fmt: skip
        return slip_forces(p, state, e.named, p.mode, p.ellipse)

    def load(self) -> Expr:
        """Return the load without the limit at zero, N."""
        from ..tyres.deflection_6 import stiffening

        e, contact = self.e, self.contact
        z = stiffening(e.properties, contact.radius, self.free, contact.spin, self.dpi, self.gamma)
        z = type(z)(*(e.named(x) for x in vars(z).values()))
        damping = e.named(-e.properties.VERTICAL_DAMPING * contact.vz)
        variables = [x for x in (*(getattr(contact, name) for name in VARIABLES), self.yaw, *e.own) if x is not None]

        def excess(load: Expr) -> Expr:
            return load - z.load(*self.forces(e.named(above_zero(load)))) - damping

        return e.at_root(excess, self.estimated(z, damping), [x for x in variables if e.in_state(x)])

    def estimated(self, z: Stiffening, damping: Expr) -> Expr:
        """Return the load after two iterations, an extrapolation (Aitken), and one more.

        Each iteration keeps the ratios of the forces to the load, which depend little on it.
        """
        e, least = self.e, sp.Float("1e-12")

        def improved(load: Expr) -> Expr:
            pressing = e.named(above_zero(load) + least)
            fx, fy = self.forces(pressing)
            return e.named(z.load_at_ratios(e.named(fx / pressing), e.named(fy / pressing), damping))

        first = e.named(z.load_at_ratios(0, 0, damping))
        second = improved(first)
        third = improved(second)
        change, bend = e.named(third - second), e.named(third - 2 * second + first)
        return improved(e.named(third - change**2 * bend / (bend**2 + least**2)))


def pressed(e: Symbolic, hand: Expr, turns: bool) -> Touch:
    """Return the contact with its load and slips.

    `hand`: -1 for a tyre that is mirrored. `turns`: whether the yaw rate acts on the forces.
    """
    from ..tyres.deflection_6 import deflection, free_radius

    p, contact = e.properties, contact_point(e)
    variables = {name: x for name in VARIABLES if e.in_state(x := getattr(contact, name))}
    contact = replace(contact, **{name: e.variable(x) for name, x in variables.items()})
    free = e.named(free_radius(p, contact.spin))
    closed = e.named(deflection(p, contact.radius, free, contact.camber))
    yaw = e.variable(yaw_rate(e, contact)) if turns else None
    tyre = _Pressed(e, contact, hand, pressure_increment(e), free, yaw)
    load = e.read(sp.Piecewise((sp.Max(tyre.load(), 0), closed > 0), (0, True)))
    slip, tangent, speed, rates = tyre.slip(e.named(load))
    above = e.named(above_zero(closed))
    turn = tyre.turn(e.named(sp.atan(tangent)), speed)
    return Touch(contact, above, load, slip, tangent, speed, rates, turn)
