"""Elements of a user whose fields have the names of symbols: refused, or the field is meant and nothing else changes."""

from __future__ import annotations

from functools import partial
from typing import Any, cast

import numpy as np
import sympy

from stiffmbs import spatial
from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.element import Force, Joint
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.reading.units.si import Number

from ...variants.answers import compared, refused

STIFFNESS, RATE = 9.0, 0.5
DURATION, ALLOWED = 2.0, 1e-6


def own(kind: str, dimensions: int, names: tuple[str, ...]) -> Any:
    """Define a spring or a moving pin; its number is in the last field."""
    marker = Marker if dimensions == 2 else spatial.Marker
    given: dict[str, Any] = {
        "__annotations__": dict.fromkeys(names, Number) | {"i": marker},
        "__module__": __name__,
        "kind": "own_of_stress",
    }
    number = names[-1]

    def efforts(e: Any) -> list[Any]:
        x = e.i.point[0]
        return [(-getattr(e, number) * x, x)]

    def position(e: Any) -> list[Any]:
        return [e.i.point[1] - getattr(e, number) * sympy.sin(e.t)]

    if kind == "spring":
        return type("Own", (Force,), given | {"efforts": staticmethod(efforts)})
    return type("Own", (Joint,), given | {"equations": ("y",), "position": staticmethod(position)})


def error(kind: str, dimensions: int, names: tuple[str, ...], solver: Any) -> float:
    """Return the error of a vibration with sqrt(k) rad/s, or of the motion of a pin by rate sin t."""
    short, family = slice(None, dimensions), {2: (Model, Body, 1), 3: (spatial.Model, spatial.Body, (1, 2, 3))}
    made, body, inertia = cast(Any, family[dimensions])
    model = made(gravity=(0, 0, 0)[short])
    speed = (0, 0 if kind == "spring" else RATE, 0)[short]
    model.add("b", body(mass=1, inertia=inertia, position=(1, 0, 0)[short], velocity=speed))
    number = STIFFNESS if kind == "spring" else RATE
    values = dict.fromkeys(names[:-1], 5.0) | {names[-1]: number}
    model.add("own", own(kind, dimensions, names)(i="b", **values))
    found = run(model, duration=DURATION, points=21, rtol=1e-9, solver=solver)
    if kind == "spring":
        return float(np.max(np.abs(found["b.x"] - np.cos(np.sqrt(STIFFNESS) * found.t))))
    return float(np.max(np.abs(found["b.y"] - RATE * np.sin(found.t))))


REFUSED = (
    ("spring", 2, "t"), ("spring", 3, "a"), ("pin", 2, "t"), ("pin", 3, "u"), ("spring", 2, "q"), ("pin", 3, "angle"),
    ("pin", 2, "by_q"), ("spring", 3, "angles"),
)  # fmt: skip
ALLOWED_NAMES = (
    ("spring", 2, ("x", "y", "e", "stiffness"), "bdf"), ("pin", 3, ("q0", "time", "self", "speed"), "bdf"),
    ("spring", 3, ("vx", "ax", "wz"), "projected"), ("pin", 2, ("turn0", "phi0", "name", "time"), "projected"),
    ("spring", 2, ("mass", "number", "s"), "bdf"), ("pin", 3, ("size", "n", "e0"), "auto"),
)  # fmt: skip

CASES = (
    *(
        refused(f"{kind} in {dimensions}D with the field '{name}'", "names that stand for something else",
                partial(own, kind, dimensions, (name,)), f"Own: found the field '{name}', expected names other than a, ")
        for kind, dimensions, name in REFUSED
    ),
    *(
        compared(f"{kind} in {dimensions}D with the fields {', '.join(names)}", "cos(3 t), sin(t)/2",
                 partial(error, kind, dimensions, names, solver), ALLOWED)
        for kind, dimensions, names, solver in ALLOWED_NAMES
    ),
)  # fmt: skip
