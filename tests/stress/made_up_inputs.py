"""Random inputs over time: as text for a scene, and as functions of their own with the points where they bend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

END = 10.0
"""Of the time in which inputs do something, s."""
FINE = 400
"""Intervals of the mesh besides those at the points of an input."""
DEPTH = 2
Function = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Made:
    """An input.

    Attributes
    ----------
    text : str
    of : callable
        Of arrays of time.
    points : ndarray
        Where it bends or begins, and some within each of its features, s.
    tables, parameters : dict
        As in a scene.  Numbers are parameters, so that inputs of one form are compiled once.
    """

    text: str
    of: Function
    points: np.ndarray
    tables: dict[str, Any] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)

    def mesh(self) -> np.ndarray:
        """Times that miss no feature."""
        points = np.concatenate([self.points, np.linspace(0.0, END, FINE + 1)])
        return np.unique(np.clip(points, 0.0, END))

    def quadrature(self, points: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Its first and second integral at so many output points, and the integral of its absolute value.

        Gauss's rule with 12 points in each interval of the mesh, and at output points.
        """
        outputs = np.linspace(0.0, END, points) if points else np.array([0.0, END])
        edges = np.union1d(self.mesh(), outputs)
        nodes, weights = np.polynomial.legendre.leggauss(12)
        h = np.diff(edges)
        t = edges[:-1, None] + h[:, None] * (nodes + 1) / 2
        f = self.of(t.ravel()).reshape(t.shape)
        first = np.concatenate([[0.0], np.cumsum(f @ weights * h / 2)])
        moment = np.concatenate([[0.0], np.cumsum((f * t) @ weights * h / 2)])
        way = edges * first - moment  # the integral of (T - t) f
        at = np.searchsorted(edges, outputs)
        return first[at], way[at], float(np.sum(np.abs(f) @ weights * h / 2))


def made_up(rng: np.random.Generator, continuous: bool = False) -> Made:
    """A random input."""
    return _Maker(rng, continuous).sum(DEPTH)


class _Maker:
    """Makes parts of one input."""

    def __init__(self, rng: np.random.Generator, continuous: bool) -> None:
        self.rng, self.continuous = rng, continuous
        self.tables: dict[str, Any] = {}
        self.parameters: dict[str, float] = {}

    def number(self, value: float) -> str:
        """The name of a parameter with this value."""
        name = f"n{len(self.parameters)}"
        self.parameters[name] = float(value)
        return name

    def made(self, text: str, of: Function, points: np.ndarray) -> Made:
        """An input that uses the maker's tables and parameters."""
        return Made(text, of, points, self.tables, self.parameters)

    def sum(self, depth: int) -> Made:
        """One feature, or two put together, and perhaps something slow."""
        first = self.feature()
        how = self.rng.choice(["one", "sum", "product", "max", "min", "branch", "slow"])
        if how == "one" or depth == 0:
            return first
        if how == "slow":
            return self.together(f"({first.text}) + {{}}", lambda a, b: a + b, first, self.slow())
        second = self.sum(depth - 1) if how != "product" else self.slow()
        if how == "sum":
            part = 10.0 ** self.rng.uniform(-1, 0)
            return self.together(
                f"({first.text}) + {self.number(part)}*({{}})", lambda a, b: a + part * b, first, second
            )
        if how == "product":
            return self.together(f"({first.text})*({{}})", lambda a, b: a * b, first, second)
        if how == "branch" and not self.continuous:
            c = self.rng.uniform(0, END)
            joined = self.together(
                f"branch(t - {self.number(c)}, {first.text}, 0, {{}})", lambda a, b: a, first, second
            )
            return self.made(
                joined.text, lambda t: np.where(t < c, first.of(t), second.of(t)), np.append(joined.points, c)
            )
        choose = np.minimum if how == "min" else np.maximum
        joined = self.together(f"{'min' if how == 'min' else 'max'}({first.text}, {{}})", choose, first, second)
        return self.made(joined.text, joined.of, np.append(joined.points, _crossings(first, second)))

    def together(self, text: str, how: Callable[..., np.ndarray], first: Made, second: Made) -> Made:
        points = np.concatenate([first.points, second.points])
        return self.made(text.replace("{}", second.text), lambda t: how(first.of(t), second.of(t)), points)

    def slow(self) -> Made:
        """Something smooth that does not vanish."""
        w, phase = self.rng.uniform(0.2, 6.0), self.rng.uniform(0, 6)
        kind = self.rng.choice(["sine", "ramp", "decay", "growth", "rectified"])
        if kind == "ramp":
            return self.simple(f"(0.2 + t/{END})", lambda t: 0.2 + t / END)
        if kind == "decay":
            return self.simple(f"exp(-{self.number(w)}*t)", lambda t: np.exp(-w * t))
        if kind == "growth":
            return self.simple(f"exp({self.number(w)}*(t - {END}))", lambda t: np.exp(w * (t - END)))
        if kind == "rectified":
            zeros = (np.arange(0, 30) * np.pi - phase) / w
            return self.made(
                f"abs(sin({self.number(w)}*t + {self.number(phase)}))", lambda t: np.abs(np.sin(w * t + phase)), zeros
            )
        return self.simple(f"(1 + 0.5*sin({self.number(w)}*t))", lambda t: 1 + 0.5 * np.sin(w * t))

    def simple(self, text: str, of: Function) -> Made:
        return self.made(text, of, np.empty(0))

    def feature(self) -> Made:
        """A pulse somewhere, or a table under some argument."""
        if self.rng.uniform() < 0.4:
            return self.table()
        c = self.rng.uniform(0.05, 0.95) * END
        w = 10.0 ** self.rng.uniform(-5, 0)
        sign = self.rng.choice([-1.0, 1.0])
        z = f"((t - {self.number(c)})/{self.number(w)})"
        ramp = f"t, {self.number(c)}, 0, {self.number(c + w)}, 1"
        back = f"t, {self.number(c + 2 * w)}, 0, {self.number(c + 3 * w)}, 1"
        rise, fall = lambda t: np.clip((t - c) / w, 0, 1), lambda t: np.clip((t - c) / w - 2, 0, 1)
        cubic, quintic = lambda x: x * x * (3 - 2 * x), lambda x: x**3 * (10 - 15 * x + 6 * x * x)
        kinds: dict[str, tuple[str, Function]] = {
            "gauss": (f"exp(-{z}^2)", lambda t: np.exp(-(((t - c) / w) ** 2))),
            "tanh": (f"(tanh({z}) - tanh({z} - 3))", lambda t: np.tanh((t - c) / w) - np.tanh((t - c) / w - 3)),
            "lorentz": (f"1/(1 + {z}^2)", lambda t: 1 / (1 + ((t - c) / w) ** 2)),
            "sech": (f"1/cosh({z})", lambda t: 1 / np.cosh(np.clip((t - c) / w, -700, 700))),
            "triangle": (f"max(0, 1 - abs{z})", lambda t: np.maximum(0, 1 - np.abs((t - c) / w))),
            "dome": (f"max(0, 1 - {z}^2)", lambda t: np.maximum(0, 1 - ((t - c) / w) ** 2)),
            "step": (f"(step({ramp}) - step({back}))", lambda t: cubic(rise(t)) - cubic(fall(t))),
            "step5": (f"(step5({ramp}) - step5({back}))", lambda t: quintic(rise(t)) - quintic(fall(t))),
            "root": (
                f"(sqrt({z}^2) - sqrt(({z} - 1)^2) + 1)",
                lambda t: np.abs((t - c) / w) - np.abs((t - c) / w - 1) + 1,
            ),
            "comb": (f"sin(pi*t/{self.number(4 * w + 0.1)})^200", lambda t: np.sin(np.pi * t / (4 * w + 0.1)) ** 200),
        }
        kind = str(self.rng.choice(list(kinds)))
        text, of = kinds[kind]
        if kind == "comb":
            period = 4 * w + 0.1
            centres = (np.arange(0, END / period + 2) + 0.5) * period
            points = (centres[:, None] + period * np.linspace(-0.3, 0.3, 31)).ravel()
        else:
            points = c + w * np.concatenate(
                [np.linspace(-8, 10, 145), *(s * np.geomspace(10, 1e7, 61) for s in (-1, 1))]
            )
        return self.made(f"({sign:g}*{text})", lambda t: sign * of(t), points)

    def table(self) -> Made:
        """A table with a pulse, called with something that rises with time."""
        name = f"p{len(self.tables)}"
        c, w = self.rng.uniform(0.1, 0.8) * END, 10.0 ** self.rng.uniform(-3, -0.5)
        count = int(self.rng.integers(1, 8))
        inner = c + w * np.arange(0, count + 2)
        y = np.concatenate([[0.0], self.rng.uniform(0.2, 1, count), [0.0]])
        kind = str(self.rng.choice(["lines", "spline", "akima", "monotone"]))
        rest = w * np.arange(1, 4)
        x = np.concatenate([[0.0], inner[0] - rest[::-1], inner, inner[-1] + rest, [END + 5]])
        y = np.concatenate([[0.0] * 4, y, [0.0] * 4])
        keep = np.concatenate([[True], np.diff(x) > 1e-9])
        x, y = x[keep], y[keep]
        how = {} if kind == "monotone" else {kind: True}
        self.tables[name] = {"table": np.column_stack([x, y]).tolist(), **how}
        text, argument, bends = self.argument()
        knots = np.concatenate([bends, *(_passed(argument, knot) for knot in x[1:-1])])
        around = (knots[:, None] + w * np.linspace(-1, 1, 9)).ravel()
        values = _curve(kind, x, y)
        return self.made(f"{name}({text})", lambda t: values(argument(t)), np.concatenate([knots, around]))

    def argument(self) -> tuple[str, Function, list[float]]:
        """Something that does not fall with time, and when it bends or jumps."""
        c = self.rng.uniform(0.3, 0.95) * END
        kinds: list[tuple[str, Function, list[float]]] = [
            ("t", lambda t: t, []),
            (f"min(t, {self.number(c)})", lambda t: np.minimum(t, c), [c]),
            (f"max(t - {self.number(c / 10)}, 0)", lambda t: np.maximum(t - c / 10, 0), [c / 10]),
            (f"t^2/{self.number(c)}", lambda t: t**2 / c, []),
            (f"{END}*step(t, 1, 0, {self.number(c)}, 1)", lambda t: END * _ramp((t - 1) / (c - 1)), [1.0, c]),
            (f"{END}*(1 - exp(-t/2))", lambda t: END * (1 - np.exp(-t / 2)), []),
            ("(t + 0.9*sin(t))", lambda t: t + 0.9 * np.sin(t), []),
        ]
        if not self.continuous:
            half = self.number(c / 2)
            kinds.append((f"branch(t - {half}, 0, {half}, t)", lambda t: np.where(t < c / 2, 0.0, t), [c / 2]))
        return kinds[int(self.rng.integers(len(kinds)))]


def _ramp(z: np.ndarray) -> np.ndarray:
    z = np.clip(z, 0, 1)
    return z * z * (3 - 2 * z)


def _curve(kind: str, x: np.ndarray, y: np.ndarray) -> Function:
    """The table by SciPy; beyond its points it goes on straight."""
    from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator

    if kind == "lines":
        return lambda s: np.interp(s, x, y)  # both of its ends are flat
    local = {"akima": Akima1DInterpolator, "monotone": PchipInterpolator}.get(kind)
    curve = local(x, y) if local else CubicSpline(x, y, bc_type="natural")
    slopes = curve.derivative()

    def values(s: np.ndarray) -> np.ndarray:
        inside = np.clip(s, x[0], x[-1])
        return np.asarray(curve(inside) + slopes(inside) * (s - inside))

    return values


def _passed(function: Function, value: float) -> np.ndarray:
    """When something that does not fall with time reaches a value, and when it leaves it."""
    found = []
    for beyond in (np.greater_equal, np.greater):
        low, high = 0.0, END
        if not beyond(function(np.array(high)), value):
            continue
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if beyond(function(np.array(middle)), value) else (middle, high)
        found.append(high)
    return np.array(found)


def _crossings(first: Made, second: Made) -> np.ndarray:
    """Where two inputs are alike."""
    t = np.union1d(first.mesh(), second.mesh())
    t = np.union1d(t, (t[1:] + t[:-1]) / 2)
    difference = first.of(t) - second.of(t)
    k = np.flatnonzero(np.sign(difference[1:]) != np.sign(difference[:-1]))
    low, high, rising = t[k], t[k + 1], difference[k + 1] > difference[k]
    for _ in range(60):
        middle = (low + high) / 2
        beyond = (first.of(middle) - second.of(middle) > 0) == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return np.asarray(high)
