"""Adams' joints for `adams_oracle`: each as the equations its manual states, as second derivatives (rows, b)."""

import numpy as np


def rows(*jets):
    """Second derivatives of scalars and vectors, one row an equation."""
    return np.vstack([np.atleast_2d(jet.second.T) for jet in jets])


def atpoint(i, j):
    return lambda view: rows(view.point(i) - view.point(j))


def inline(i, j):
    def equations(view):
        gap = view.point(i) - view.point(j)
        return rows(gap @ view.axis(j, "x"), gap @ view.axis(j, "y"))

    return equations


def inplane(i, j):
    return lambda view: rows((view.point(i) - view.point(j)) @ view.axis(j, "z"))


def parallel(i, j):
    return lambda view: rows(*(view.axis(i, "z") @ view.axis(j, name) for name in "xy"))


def perpendicular(i, j, a="z", b="z"):
    return lambda view: rows(view.axis(i, a) @ view.axis(j, b))


def orientation(i, j):
    return lambda view: rows(*(view.axis(i, a) @ view.axis(j, b) for a, b in ("xy", "yz", "zx")))


def together(*joints):
    return lambda view: np.vstack([np.atleast_2d(joint(view)) for joint in joints])


def revolute(i, j):
    return together(atpoint(i, j), parallel(i, j))


def cylindrical(i, j):
    return together(inline(i, j), parallel(i, j))


def translational(i, j):
    return together(inline(i, j), orientation(i, j))


def planar(i, j):
    return together(inplane(i, j), parallel(i, j))


def fixed(i, j):
    return together(atpoint(i, j), orientation(i, j))


def universal(i, j):
    return together(atpoint(i, j), perpendicular(i, j))


def hooke(i, j):
    return together(atpoint(i, j), perpendicular(i, j, "x", "y"))


def convel(i, j):
    """Turns about both z axes, which point away from the centre, are equal and opposite.

    x of either leans as much to the plane between the shafts as that of the other: for straight shafts, where y are
    opposite, the sum is twice the sine of the angle between the x axes.
    """

    def alike(view):
        return rows(view.axis(i, "x") @ view.axis(j, "y") + view.axis(i, "y") @ view.axis(j, "x"))

    return together(atpoint(i, j), alike)


def slide(view, i, j):
    """Displacement of marker i along the z of j."""
    return (view.point(i) - view.point(j)) @ view.axis(j, "z")


def twist(view, i, j):
    """Angle of marker i about the z of j as a jet; only its derivatives count. z axes are parallel."""
    z = view.axis(j, "z")
    spin = view.spin(i) - view.spin(j)
    second = spin.second @ z.value + spin.rate @ z.rate
    return type(z)(np.array(0.0), spin.rate @ z.value, second)


def coupled(*terms):
    """Sum of factor * displacement, for terms (factor, measure, i, j), with measures `slide` and `twist`."""

    def equation(view):
        return sum(factor * measure(view, i, j).second for factor, measure, i, j in terms)[None]

    return equation


def driven(measure, i, j, second):
    """A displacement with a given second derivative in time; its start is the parts' own."""
    return lambda view: (measure(view, i, j).second - second(view.t))[None]


def meshed(one, other, contact):
    """Two parts move alike at the contact, a marker of their carrier, along its z axis: what teeth do."""

    def equation(view):
        at, along = view.point(contact), view.axis(contact, "z")
        speeds, gains = [], []
        for own in (one, other):
            hub, spin = view.point(own), view.spin(own)
            arm = at - hub
            speeds.append(hub.rate + np.cross(spin.rate, arm.value))
            gains.append(hub.second + np.cross(spin.second, arm.value) + np.cross(spin.rate, arm.rate))
        return ((gains[0] - gains[1]) @ along.value + (speeds[0] - speeds[1]) @ along.rate)[None]

    return equation
