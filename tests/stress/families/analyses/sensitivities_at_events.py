"""Sensitivities after events, at breakpoints on output instants, and where a breakpoint is only touched.

Judges: Richardson-extrapolated differences of converged runs, and closed forms of the vibration of a cart on a spring.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.studies.outputs import outputs_of
from stiffmbs.studies.sensitivities.sensitivities import sensitivities

from ...case import Case
from ...variants.answers import compared, refused

NUMBERS = {"k": 40.0, "c": 1.0, "m": 2.0, "F": 20.0, "A": 0.1, "s": 0.0}
SPRING, PLAIN = "-k*cart.x - c*cart.vx", "-k*cart.x"
FOLLOWS = {"p": {"zero": "p - 5*cart.x - 1", "start": 1.5}}
TABLE = {"lines": True, "table": [[-1, 0], [0.1, 1], [0.2, -1], [0.5, 2], [0.6, 0], [0.85, 1], [3, 1]]}
ALLOWED = 1e-4
STEP = 1e-3


def cart(force: str, space: bool, values: dict[str, float], more: dict[str, Any]) -> Scene:
    """Return a cart on a spring under a further force, in the plane or in space."""
    zeros = [0.0] * (2 if space else 1)
    along = {"orientation": {"z": [1, 0, 0], "x": [0, 1, 0]}} if space else {}
    return read_scene(json.dumps({
        "dimensions": 3 if space else 2, "parameters": NUMBERS | values, "tables": {"tab": TABLE},
        "bodies": {"cart": {"mass": "m", "inertia": [1, 1, 1] if space else 1, "position": [0.1, *zeros]}},
        "joints": {"rail": {"type": "prismatic", "i": {"body": "cart", **along}, "j": {"body": "ground", **along}}},
        "forces": {"push": {"type": "force", "i": "cart", "force": [force, *zeros]}},
        "run": {"duration": 1, "rtol": 1e-7, "points": 11}, **more,
    }))  # fmt: skip


def difference(force: str, space: bool, more: dict[str, Any], name: str, of: str, step: float) -> float:
    """Return the relative difference between a sensitivity and the extrapolated difference of runs."""
    (output,), value = outputs_of(of), NUMBERS[name]
    slope = sensitivities(cart(force, space, {}, more), [name], of).to[name]

    def quotient(h: float) -> float:
        """Return the central difference of the output of runs."""
        above, below = (
            float(output.value(run(cart(force, space, {name: value + shift}, more), rtol=1e-11, solver="bdf")))
            for shift in (h, -h)
        )
        return (above - below) / (2 * h)

    expected = (4 * quotient(step) - quotient(2 * step)) / 3
    return abs(float(slope) - expected) / max(abs(expected), 1e-3)


def identity(force: str, space: bool) -> float:
    """Return the relative difference between the slopes of 5 x + 1 and those of the algebraic state that equals it."""
    scene, names = cart(force, space, {}, {"states": FOLLOWS}), ["k", "c", "m", "F"]
    state, place = (sensitivities(scene, names, f"final({of})").to for of in ("p", "cart.x"))
    return max(abs(float(state[name]) / (5 * float(place[name])) - 1) for name in names)


def past_a_bound(over: float) -> float:
    """Return the error of d x(1 s)/dk where a constant force acts beyond x = -A + over, by closed-form vibrations."""
    scene = cart(f"{PLAIN} + branch(-cart.x - A + ({over!r}), 0, 0, F)", False, {}, {})

    def end(k: float) -> float:
        """Return x(1 s) of the closed form."""
        w = np.sqrt(k / 2)
        first = np.arccos(-1 + over / 0.1) / w
        x, v, middle = -0.1 + over, -0.1 * w * np.sin(w * first), 20 / k
        phase = np.arctan2(-v / w, x - middle)
        stays = 2 * (np.pi - phase) / w  # until it is back at the same place with the opposite velocity
        rest = 1.0 - first - stays
        return float(x * np.cos(w * rest) - v / w * np.sin(w * rest))

    h = 1e-3
    expected = (8 * (end(40 + h) - end(40 - h)) - end(40 + 2 * h) + end(40 - 2 * h)) / (12 * h)
    return abs(float(sensitivities(scene, ["k"], "final(cart.x)").to["k"]) / expected - 1)


def _compared(name: str, judge: Callable[[], float], allowed: float = ALLOWED) -> Case:
    return compared(name, "extrapolated differences of runs, or a closed form", judge, allowed)


EVENTS = (
    f"{SPRING} - F*abs(cart.x - 0.03)",
    f"{SPRING} - F*max(0.02 - cart.x, 0) - branch(cart.x - 0.02, -c*cart.vx, 0, 0)",
    f"{SPRING} + branch(p - 1.2, F/4, 0, 0)",
    f"{SPRING} + branch(cart.vx + 0.1, -F/4, 0, 0)",
    f"{SPRING} - F*p*max(p - 1.1, 0)/10",
)
TWO = {"p": {"zero": "p - 5*cart.x", "start": 0.5}, "w": {"zero": "w*(1 + w*w) - p", "start": 0.5}}
TOUCHING = ("branch(-cart.x - A + OVER, 0, 0, F)", "branch(-cart.vx - A*sqrt(k/m) + OVER, 0, 0, F)")

CASES = (
    *(_compared(f"{law}: the state 5 x + 1", partial(identity, law, False), 1e-8) for law in EVENTS),
    *(
        _compared(f"{law} in space: the final state", partial(difference, law, True, {"states": FOLLOWS}, "F", "final(p)", STEP))
        for law in EVENTS
    ),
    _compared("kink of a state that follows a state", partial(difference, f"{SPRING} - F*abs(w - 0.1)", False, {"states": TWO}, "F", "final(w)", STEP)),
    _compared("kink of a state, its final value", partial(difference, EVENTS[0], True, {"states": FOLLOWS}, "k", "final(p)", STEP)),
    *(
        refused(f"{law.split(' - A')[0]}: touched but for {over:g}{' in space' if space else ''}", "the motion turns at its breakpoint",
                partial(lambda law, over, space: sensitivities(cart(f"{PLAIN} + {law.replace('OVER', f'({over!r})')}", space, {}, {}), ["k"], "final(cart.x)").to, law, over, space),
                "grazes its breakpoint")
        for law in TOUCHING for over, space in ((0.0, False), (1e-15, True), (-1e-13, False), (-1e-11, True))
    ),
    *(_compared(f"a bound that is passed by {over:g} m", partial(past_a_bound, over), 1e-3) for over in (1e-3, 1e-4)),
    *(
        _compared(f"table with breakpoints on output instants{' in space' if space else ''}, {of} by {name}",
                  partial(difference, f"{SPRING} + F*tab(t - s)", space, {}, name, of, 1e-6 if name == "s" else 1e-2), 1e-3)
        for of, name, space in (
            ("integral(cart.x)", "s", False), ("integral(cart.ax)", "s", False), ("rms(cart.vx)", "s", True), ("mean(push.fx)", "s", False),
            ("final(cart.x)", "s", True), ("integral(cart.ax)", "F", False), ("rms(cart.vx)", "k", False), ("mean(push.fx)", "F", True),
            ("integral(cart.x)", "m", True), ("max(cart.vx)", "F", False),
        )
    ),
)  # fmt: skip
