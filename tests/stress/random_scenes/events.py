"""Random scenes with a few forms of events.  Numbers are parameters, so that each form is compiled once."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

Content = dict[str, Any]
LAWS = (
    "-K*abs(X - A)", "-K*max(X - A, 0) - C*max(A - X, 0)", "branch(X - A, K, 0, -K/2)*(1 - C*V)",
    "branch(V - A, -K/2, 0, -K)", "K*ramp(T)", "K*ramp(X + A)", "K*step(t, A2, 0, A2 + 0.1, 1)", "K*branch(t - A2, 1, 0, -1)",
    "-K*sign(X - A)*(X - A)^2", "K*min(max(X - A, 0), 0.02)", "-K*tanh(V/0.2)", "K*max(sin(9*t + A), 0.3)", "K*abs(p - A)",
    "branch(p - A, K, 0, K/3)", "-K*p*max(V, 0)", "K*ramp(t + z)", "K*branch(z - A, 1, 0, 0.2)", "-K*max(X - A, 0)*max(1 + C*V, 0)",
)  # fmt: skip
"""Force laws: X and V are a coordinate and its rate, T is a shifted time, ``ramp`` is a table."""
STATES: tuple[tuple[str, Content], ...] = (
    ("p", {"zero": "p - X - C*V", "start": 0.0}), ("p", {"zero": "p + p^3 - K*X/10 - z", "start": 0.0}),
    ("p", {"zero": "p - abs(X - A) - t", "start": 0.0}), ("p", {"zero": "2*p - max(X, A)*C - z", "start": 0.0}),
)  # fmt: skip
RATES = ("X - z/5", "abs(X - A) + p", "branch(V - A, 1, 0, -1)", "-p*z + V", "max(p, A)")
JOINTS = {2: ("prismatic", "revolute", "free"), 3: ("prismatic", "revolute", "spherical", "cylindrical", "free")}


def random_events(rng: np.random.Generator, dimensions: int) -> Content:
    """Return the content of a scene of one to three bodies with states, under forces with breakpoints."""
    return _Maker(rng, dimensions).content()


class _Maker:
    """Generator of one scene."""

    def __init__(self, rng: np.random.Generator, dimensions: int) -> None:
        self._rng, self._dimensions = rng, dimensions
        self._parameters: dict[str, float] = {}
        self._bodies: dict[str, Any] = {}
        self._joints: dict[str, Any] = {}

    def content(self) -> Content:
        """Return the scene."""
        rng, n = self._rng, int(self._rng.integers(1, 4))
        for k in range(n):
            self._add_body(k)
        p = STATES[int(rng.integers(len(STATES)))]
        states = {p[0]: {name: self._written(text) for name, text in p[1].items()}}
        states["z"] = {"rate": self._written(str(rng.choice(RATES))), "start": self._number(rng.uniform(-0.2, 0.2))}
        forces = {f"f{k}": self._force(k) for k in range(int(rng.integers(1, 4)))}
        forces["held"] = self._spring()
        return {
            **({"dimensions": 3} if self._dimensions == 3 else {}),
            "gravity": [0.0] * (self._dimensions - 1) + [self._number(-9.81 * rng.integers(2))],
            "parameters": self._parameters, "tables": {"ramp": {"table": self._table(), "lines": bool(rng.integers(2))}},
            "bodies": self._bodies, "joints": self._joints, "forces": forces, "states": states,
            "run": {"duration": 0.5, "points": int(rng.choice([11, 17, 26])), "rtol": 1e-6},
        }  # fmt: skip

    def _number(self, value: float) -> str:
        name = f"n{len(self._parameters)}"
        self._parameters[name] = float(value)
        return name

    def _add_body(self, k: int) -> None:
        rng, d = self._rng, self._dimensions
        name, parent = f"b{k}", str(rng.choice(["ground", *self._bodies]))
        mass = self._number(rng.uniform(0.5, 2))
        moments: Any = [self._number(value) for value in rng.uniform(0.1, 0.19, 3)] if d == 3 else self._number(0.1)
        self._bodies[name] = {"mass": mass, "inertia": moments, "position": [float(k)] + [0.0] * (d - 1)}
        kind = str(rng.choice(JOINTS[d]))
        if kind == "free":
            return
        at = 0.0 if parent == "ground" else float(parent[1:])
        own, there = rng.uniform(-0.3, 0.3, d), np.array([k - at] + [0.0] * (d - 1))
        i = {"body": name, "point": own.tolist()}
        j = {"body": parent, "point": (there + own).tolist()}
        if d == 3:
            turn = rng.standard_normal(4)
            i["orientation"] = j["orientation"] = (turn / np.linalg.norm(turn)).tolist()
        else:
            i["angle"] = j["angle"] = float(rng.uniform(-3, 3))
        self._joints[f"j{k}"] = {"type": kind, "i": i, "j": j}

    def _written(self, text: Any) -> Any:
        """Return a text with a random coordinate and random numbers."""
        if not isinstance(text, str):
            return text
        rng, body = self._rng, str(self._rng.choice(list(self._bodies)))
        axis = str(rng.choice(["y", "z"] if self._dimensions == 3 else ["y"]))
        made = {
            "A2": lambda: self._number(rng.uniform(0.05, 0.35)), "A": lambda: self._number(rng.uniform(-0.05, 0.05)),
            "K": lambda: self._number(rng.uniform(2, 30)), "C": lambda: self._number(rng.uniform(0.1, 1)),
            "T": lambda: f"(t - {self._number(rng.uniform(-0.2, 0.2))})",
            "X": lambda: f"{body}.{axis}", "V": lambda: f"{body}.v{axis}",
        }  # fmt: skip
        return re.sub(r"\b(A2|[AKCTXV])\b", lambda found: made[found[1]](), text)

    def _force(self, k: int) -> Content:
        law = self._written(str(self._rng.choice(LAWS)))
        components: list[Any] = [0] * self._dimensions
        components[int(self._rng.integers(1, self._dimensions))] = law
        return {"type": "force", "i": str(self._rng.choice(list(self._bodies))), "force": components}

    def _spring(self) -> Content:
        body = str(self._rng.choice(list(self._bodies)))
        point = self._rng.uniform(-1, 1, self._dimensions).tolist()
        return {
            "type": "spring_damper", "i": body, "j": {"body": "ground", "point": point},
            "stiffness": self._number(self._rng.uniform(5, 100)), "damping": self._number(self._rng.uniform(0, 2)),
            "free_length": self._number(0.3),
        }  # fmt: skip

    def _table(self) -> list[list[float]]:
        """Return points, some of them at output times."""
        places = [-3.0, -0.1, 0.0, 0.05, 0.1, 0.2, 0.27, 0.4, 4.0]
        return [
            [place, float(value)] for place, value in zip(places, self._rng.uniform(-1, 1, len(places)), strict=True)
        ]
