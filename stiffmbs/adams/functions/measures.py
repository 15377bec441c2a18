"""Angles between markers, joint reactions and splines as formulas.  MSC Adams/Solver, function expressions.

YAW, PITCH, ROLL, PSI, THETA, PHI and INCANG: the tip of an axis is a marker 1 m along it. A component of one axis along
another is then a distance between markers.

JOINT(id, jflag, comp, rm), and JPRIM alike: scene formulas know the reaction on marker I in ground axes. Its component
along an axis of another marker is the dot product with that axis.
"""

from __future__ import annotations

import ast
from collections.abc import Callable

from ..scene.mechanism import ORIGIN, Mechanism, Place
from ..statements.constraints import Primitive
from .function import Function
from .trees import call, components, cross, difference, magnitude, measured, number, product, quotient, total

ANGLES_OF_AXES = ("YAW", "PITCH", "ROLL", "PSI", "THETA", "PHI")


def angle(name: str, mechanism: Mechanism, i: Place, j: Place) -> ast.expr:
    """Return an angle of marker i relative to marker j: z-y-x (PITCH with opposite sign) or z-x-z angles."""

    def along(axis_of_i: str, axis_of_j: str) -> ast.expr:
        return measured(f"d{axis_of_j}", mechanism.tip(i, axis_of_i), i.reference, j.reference)

    makers: dict[str, Callable[[], ast.expr]] = {
        "YAW": lambda: call("atan2", along("x", "y"), along("x", "x")),
        "PITCH": lambda: call("asin", bounded(along("x", "z"))),
        "ROLL": lambda: call("atan2", along("y", "z"), along("z", "z")),
        "PSI": lambda: call("atan2", along("z", "x"), ast.UnaryOp(ast.USub(), along("z", "y"))),
        "THETA": lambda: call("acos", bounded(along("z", "z"))),
        "PHI": lambda: call("atan2", along("x", "z"), along("y", "z")),
    }
    return makers[name]()


def included_angle(first: str, vertex: str, second: str) -> ast.expr:
    """Return the angle at a marker between the directions to two others, 0 to pi."""
    rays = [components("d", end, vertex, "") for end in (first, second)]
    lengths = product(measured("dm", first, vertex, ""), measured("dm", second, vertex, ""))
    return call("acos", bounded(quotient(total([product(a, b) for a, b in zip(*rays, strict=True)]), lengths)))


def bounded(cosine: ast.expr) -> ast.expr:
    """Clip a cosine to [-1, 1] against rounding."""
    return call("min", call("max", cosine, number(-1.0)), number(1.0))


def on_ground() -> Place:
    """Return the origin of ground, the default second marker of an angle."""
    return Place("ground", "", ORIGIN, ORIGIN)


REACTIONS = ("JOINT", "JPRIM")
COMPONENTS = ("FM", "FX", "FY", "FZ", "TM", "TX", "TY", "TZ")
"""Components in the order of their numbers, from 1."""
BY_ITS_PLACE = ("RACKPIN",)
"""Joints that become equations in the scene; formulas cannot use their reactions."""


def reaction(joint: Primitive, component: str, on_j: bool, axes: Place | None, mechanism: Mechanism) -> ast.expr:
    """Return a component of the reaction on marker I or J of a joint, N or N m, in ground axes or those of a marker."""
    vector = _vector(joint, component[0].lower(), on_j, mechanism)
    if component[1] == "M":
        return magnitude(vector)
    along = component[1].lower()
    if axes is None or (axes.body == "ground" and not axes.name):
        return vector["xyz".index(along)]
    tip = mechanism.tip(axes, along)
    direction = components("d", tip, axes.reference, "")
    return total([product(part, part_of_axis) for part, part_of_axis in zip(vector, direction, strict=True)])


def _vector(joint: Primitive, letter: str, on_j: bool, mechanism: Mechanism) -> list[ast.expr]:
    """Return force ('f') on marker I or J, or torque ('t') about it, in ground axes."""
    on_i = [call(f"{letter}{axis}", ast.Name(joint.name)) for axis in "xyz"]
    if not on_j:
        return on_i
    if letter == "f":
        return [ast.UnaryOp(ast.USub(), part) for part in on_i]
    i, j = (mechanism.place(ident, joint).reference for ident in (joint.i, joint.j))
    force = [call(f"f{axis}", ast.Name(joint.name)) for axis in "xyz"]
    moments = cross(components("d", i, j, ""), force)
    return [difference(number(0.0), total([part, moment])) for part, moment in zip(on_i, moments, strict=True)]


def component_of(name: str, number_of_it: int, function: Function) -> str:
    """Return the component with a given number. Raises DatasetFault if there is no such component."""
    if not 1 <= number_of_it <= len(COMPONENTS):
        raise function.fault(f"found the component {number_of_it} of {name}, expected 1 to {len(COMPONENTS)}")
    return COMPONENTS[number_of_it - 1]
