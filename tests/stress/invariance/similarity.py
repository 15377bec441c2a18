"""Scale a scene to other units of mass, length and time."""

from __future__ import annotations

import ast
import copy
from dataclasses import dataclass
from typing import Any

from stiffmbs.reading.fields import Measured
from stiffmbs.reading.formula.field import FormulaOf
from stiffmbs.reading.units.units import ANY, DIMENSIONS, Dimension

from ..random_scenes.draft import Content
from .change import Change, Channels
from .formulas import call_of, coordinate_of, is_time, replaced, with_other_formulas
from .typed import Mapper, NotLegitimate, mapped_scene

FORCE, TORQUE, ENERGY = (1.0, 1.0, -2.0), (1.0, 2.0, -2.0), (1.0, 2.0, -2.0)
LENGTH, VELOCITY, ACCELERATION = (0.0, 1.0, 0.0), (0.0, 1.0, -1.0), (0.0, 1.0, -2.0)
NUMBER, RATE, RATE_OF_RATE = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.0, -2.0)
LABELS: dict[str, Dimension] = {
    **dict.fromkeys(("x", "y", "z", "deflection", "dx", "dy", "dz", "dm", "displacement"), LENGTH),
    **dict.fromkeys(("vx", "vy", "vz", "vm", "vr", "displacement_rate"), VELOCITY),
    **dict.fromkeys(("ax", "ay", "az", "accx", "accy", "accz"), ACCELERATION),
    **dict.fromkeys(("angle", "q0", "q1", "q2", "q3", "slip", "slip_angle", "camber"), NUMBER),
    **dict.fromkeys(("omega", "wx", "wy", "wz", "wm", "angle_rate"), RATE),
    **dict.fromkeys(("alpha", "wdx", "wdy", "wdz"), RATE_OF_RATE),
    **dict.fromkeys(("fx", "fy", "fz", "longitudinal", "lateral", "load"), FORCE),
    **dict.fromkeys(("torque", "tx", "ty", "tz", "overturning", "rolling", "aligning", "braking"), TORQUE),
    **dict.fromkeys(("kinetic", "potential", "total"), ENERGY),
}
"""Dimensions of channels, coordinates and measures by the last part of their names."""


@dataclass(frozen=True)
class Units:
    """Factors of mass, length and time between a scene and its scaled copy."""

    mass: float
    length: float
    time: float

    def factor(self, dimension: Dimension) -> float:
        """Return the factor of a quantity of a dimension."""
        kg, m, s = dimension
        return float(self.mass**kg * self.length**m * self.time**s)


def scaled(content: Content, units: Units) -> Change:
    """Return a scene in other units.

    Raises
    ------
    NotLegitimate
        When numbers have a unit that is not declared, or a tyre has relaxation lengths: its damping at rest has a time of its own
        (`stiffmbs.elements.spatial.relaxation`).
    """
    if "use" in content:
        raise NotLegitimate("parts have numbers of their own")
    if any("relaxation" in force for force in content.get("forces", {}).values()):
        raise NotLegitimate("tyres at rest have a time of their own")
    replace = _replace(units, set(content.get("states", ())) | set(content.get("inputs", ())))
    mapper = _Scaled(content, units, replace)
    found = mapped_scene(with_other_formulas(copy.deepcopy(content), replace), mapper, defaults=True)
    if "gravity" in content:
        found["gravity"] = [part * units.factor(ACCELERATION) for part in content["gravity"]]
    found["states"] = {name: _state(state, units) for name, state in found.get("states", {}).items()}
    found["requests"] = {
        name: f"{units.factor(ACCELERATION if text.startswith('acc') else LENGTH)!r}*({text})"
        for name, text in found.get("requests", {}).items()
    }
    found["run"] = {**content["run"], "duration": content["run"]["duration"] * units.time}
    what = f"in units of {units.mass:.3g} kg, {units.length:.3g} m and {units.time:.3g} s"
    return Change(what, found, lambda channels, _: _back(channels, content, units))


class _Scaled(Mapper):
    def __init__(self, content: Content, units: Units, replace: Any) -> None:
        self._content, self._units, self._replace = content, units, replace

    def number(self, value: Any, measured: Measured, owner: Content) -> Any:
        """Return a number in the new units."""
        if value is None:
            return None
        dimension = DIMENSIONS[measured.dimension][0]
        if measured.dimension == ANY:
            dimension = _of_value(owner, measured, self._content)
        return value * self._units.factor(dimension)

    def formula(self, value: Any, kind: FormulaOf, owner: Content) -> Any:
        """Return a formula or a table in the new units, of arguments in the new units."""
        dimension = DIMENSIONS[kind.dimension][0] if kind.dimension != ANY else self._of_formula(value, owner)
        factor = self._units.factor(dimension)
        own = {
            name: self._units.factor(DIMENSIONS[each][0])
            for name, each in zip(kind.variables, kind.measured_in, strict=True)
        }
        if isinstance(value, dict):
            of_argument = next(iter(own.values()))
            points = [[x * of_argument, y * factor] for x, y in value["table"]]
            return {**value, "table": points}

        def with_own(node: ast.expr) -> str | None:
            if isinstance(node, ast.Name) and node.id in own:
                return f"({node.id}/{own[node.id]!r})"
            return self._replace(node)

        return f"{factor!r}*({replaced(value, with_own)})"

    def _of_formula(self, value: Any, owner: Content) -> Dimension:
        """Return the dimension of a formula whose field does not declare it."""
        match owner["type"]:
            case "drive" if value == owner.get("coordinate"):
                return LENGTH
            case "equation" | "velocity_equation":
                return NUMBER
            case "drive":
                sort = _sort(owner["joint"], self._content) if "joint" in owner else LENGTH
                kg, m, s = sort
                return (kg, m, s - 1) if "velocity" in owner else sort
        return NUMBER

    def marker(self, value: Any) -> Any:
        if isinstance(value, dict) and "point" in value:
            return {**value, "point": [part * self._units.length for part in value["point"]]}
        return value

    def opaque(self, name: str, value: Any) -> Any:
        raise NotLegitimate(f"{name} in a file")


def _of_value(owner: Content, measured: Measured, content: Content) -> Dimension:
    """Return the dimension of a number whose field accepts any dimension."""
    kind = owner["type"]
    if kind == "coupler":
        (_, first, _), (_, second, _) = (_sort(owner[f"joint_{k}"], content) for k in (1, 2))
        return 0.0, first - second, 0.0
    if "stiffness" in owner and measured.above == 0:
        return 1.0, 1.0 - owner.get("exponent", 1.5), -2.0  # k of a contact, N/m^e
    if "dissipation" in owner:
        return 0.0, -1.0, 1.0
    raise NotLegitimate(f"a value of a {kind} of any dimension")


def _sort(joint: str, content: Content) -> Dimension:
    """Return the dimension of a joint's coordinate."""
    name, _, sort = joint.partition(".")
    if not sort:
        sort = "angle" if content["joints"][name]["type"] == "revolute" else "displacement"
    return NUMBER if sort == "angle" else LENGTH


def _state(state: Content, units: Units) -> Content:
    """Return a state with an unchanged value and a rate in the new unit of time."""
    T = units.time
    match state:
        case {"rate": rate}:
            return {**state, "rate": f"{1 / T!r}*({rate})"}
        case {"period": period, "offset": offset}:
            return {**state, "period": period * T, "offset": offset * T}
        case {"a": a, "b": b}:
            return {
                **state,
                **{key: [[part / T for part in row] for row in rows] for key, rows in (("a", a), ("b", b))},
            }
        case {"denominator": bottom, "numerator": top}:
            return {**state, **{key: _powers(row, T) for key, row in (("denominator", bottom), ("numerator", top))}}
        case {"pid": pid}:
            times = {"ki": 1 / T, "kd": T, "filter": T}
            return {"pid": {key: value * times[key] if key in times else value for key, value in pid.items()}}
    return state


def _powers(row: list[float], T: float) -> list[float]:
    """Return the coefficients of a polynomial in s, in the new unit of time."""
    return [part * T ** (len(row) - 1 - k) for k, part in enumerate(row)]


def _replace(units: Units, states: set[str]) -> Any:
    """Return the substitution for quantities with units."""

    def replace(node: ast.expr) -> str | None:
        """Return the text of a quantity in the old units; None to keep it."""
        coordinate, call = coordinate_of(node), call_of(node)
        label = coordinate[1] if coordinate else call[0] if call else ""
        if is_time(node):
            return f"(t/{units.time!r})"
        if call and label in ("ax", "ay", "az"):
            return None
        if not label or label not in LABELS:
            return None
        return f"({ast.unparse(node)}/{units.factor(LABELS[label])!r})"

    return replace


def _back(channels: Channels, content: Content, units: Units) -> Channels:
    """Return channels in the original units."""
    found = {}
    states = content.get("states", {})
    requests = {
        name: ACCELERATION if text.startswith("acc") else LENGTH for name, text in content.get("requests", {}).items()
    }
    for name, series in channels.items():
        owner, _, label = name.rpartition(".")
        if name in requests or name in states:
            found[name] = series / units.factor(requests.get(name, NUMBER))
        elif owner in states and label == "rate":
            found[name] = series * units.time
        elif owner and owner not in states and label in LABELS:
            found[name] = series / units.factor(LABELS[label])
    return found
