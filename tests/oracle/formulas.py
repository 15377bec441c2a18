"""Formulas and states of scene files, evaluated by Python."""

from __future__ import annotations

import re

import numpy as np

MEASURE = re.compile(r"\b(dm|vr|[dv][xyz])\(([^()]*)\)")
CHANNEL = re.compile(r"\b([A-Za-z_]\w*)\.([A-Za-z_]\w*)\b")
FUNCTIONS = {name: getattr(np, name) for name in ("sin", "cos", "tanh", "exp", "sqrt", "abs")} | {"pi": np.pi}


def compiled(law):
    """Return a number, or the code of a formula."""
    if not isinstance(law, str):
        return float(law)
    quoted = CHANNEL.sub(r"channel('\1', '\2')", MEASURE.sub(_measure, law))
    return compile(quoted.replace("^", "**"), law, "eval")


def _measure(found):
    names = ", ".join(repr(part.strip()) for part in found[2].split(","))
    return f"measure({found[1]!r}, {names})"


class Values(dict):
    """Names in formulas: functions and parameters, and states by their formulas."""

    def __init__(self, known, states):
        super().__init__(known)
        self._states = states

    def __missing__(self, name):
        if name not in self._states:
            raise KeyError(name)
        self[name] = self._states[name](self)
        return self[name]


def value(law, values):
    """Evaluate a number or compiled formula."""
    return law if isinstance(law, float) else eval(law, {"__builtins__": {}}, values)


def _step(t, t0, a, t1, b):
    s = min(max((t - t0) / (t1 - t0), 0.0), 1.0)
    return a + (b - a) * s * s * (3 - 2 * s)


def _step5(t, t0, a, t1, b):
    s = min(max((t - t0) / (t1 - t0), 0.0), 1.0)
    return a + (b - a) * s**3 * (10 - 15 * s + 6 * s * s)


FUNCTIONS |= {"step": _step, "step5": _step5}


class LinearStates:
    """A linear system x' = a x + b input, y = c x + d input, and how its output is named."""

    def __init__(self, name, entry):
        self.name = name
        if "rate" in entry:
            self.law, self.a, self.b, self.c, self.d = (
                compiled(entry["rate"]),
                np.zeros((1, 1)),
                np.ones(1),
                np.ones(1),
                0.0,
            )
        elif "denominator" in entry:
            self.law = compiled(entry["input"])
            lead, *den = entry["denominator"]
            num = [0.0] * (len(den) + 1 - len(entry["numerator"])) + list(entry["numerator"])
            den, num = np.array(den, float) / lead, np.array(num, float) / lead
            n = len(den)
            self.a = np.vstack([-den, np.eye(n)[:-1]])
            self.b, self.c, self.d = np.eye(n)[0], num[1:] - num[0] * den, num[0]
        elif "pid" in entry:
            pid = {key: compiled(part) for key, part in entry["pid"].items()}
            self.law = lambda values: value(pid["setpoint"], values) - value(pid["input"], values)
            lag = value(pid["filter"], {})
            kp, ki, kd = (value(pid[key], {}) for key in ("kp", "ki", "kd"))
            self.a, self.b = np.array([[0.0, 0.0], [0.0, -1 / lag]]), np.array([1.0, 1 / lag])
            self.c, self.d = np.array([ki, -kd / lag]), kp + kd / lag
        else:
            self.law = compiled(entry["input"])
            self.a, self.b = np.array(entry["a"], float), np.array(entry["b"], float)[:, 0]
            self.c, self.d = np.array(entry["c"], float)[0], 0.0
        self.labels = ("",) if "rate" in entry else ("integral", "filtered") if "pid" in entry else ("x1", "x2")
        self.start = np.zeros(len(self.a))
        if "rate" in entry:
            self.start[:] = entry.get("start", 0.0)

    def input(self, values):
        """Return the input of the system."""
        return self.law(values) if callable(self.law) else value(self.law, values)

    def rates(self, x, values):
        """Return x'."""
        return self.a @ x + self.b * self.input(values)

    def output(self, x, values):
        """Return y."""
        return self.c @ x + (self.d * self.input(values) if self.d else 0.0)
