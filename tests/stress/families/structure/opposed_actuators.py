"""Controllers that act on what a drive prescribes are reported by name; springs, dampers and forces over time are not."""

from __future__ import annotations

from functools import partial
from typing import Any

from stiffmbs.analyses.check import check
from stiffmbs.analyses.run import run
from stiffmbs.model.read_scene import read_scene
from stiffmbs.reading.files.yaml_text import read_yaml, scene_text

from ...variants.answers import said

PLANE = """
bodies:
  a: {mass: 1, inertia: 1}
  b: {mass: 1, inertia: 1, position: [1, 0]}
joints:
  rail: {type: prismatic, i: a, j: ground}
  pin: {type: revolute, i: {body: b, point: [-1, 0]}, j: a}
  motor: {type: drive, joint: rail, position: "0.1*sin(t)"}
run: {duration: 0.1}
"""
SPACE = """
dimensions: 3
bodies:
  a: {mass: 1, inertia: [1, 1, 1]}
  b: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}
joints:
  rail: {type: prismatic, i: {body: a, orientation: {z: [1, 0, 0]}}, j: {body: ground, orientation: {z: [1, 0, 0]}}}
  pin: {type: revolute, i: {body: b, point: [-1, 0, 0]}, j: a}
  motor: {type: drive, joint: rail, position: "0.1*sin(t)"}
run: {duration: 0.1}
"""
LOOP = """
bodies:
  crank: {mass: 1, inertia: 1}
  rod: {mass: 1, inertia: 1, position: [1, 0]}
  slider: {mass: 1, inertia: 1, position: [2, 0]}
joints:
  p: {type: revolute, i: crank, j: ground}
  q: {type: revolute, i: {body: rod, point: [-0.5, 0]}, j: {body: crank, point: [0.5, 0]}}
  w: {type: revolute, i: {body: rod, point: [1, 0]}, j: slider}
  guide: {type: prismatic, i: slider, j: ground}
  motor: {type: drive, joint: p, position: "0.3 + t"}
run: {duration: 0.1}
"""
HOUSING = """
bodies:
  frame: {mass: 10, inertia: 1}
  housing: {mass: 1, inertia: 1}
  a: {mass: 1, inertia: 1}
joints:
  rail: {type: prismatic, i: a, j: housing}
  motor: {type: drive, joint: rail, position: 0}
forces:
  left: {type: bushing, i: {body: housing, point: [0, 0.1]}, j: {body: frame, point: [0, 0.1]}, stiffness: [1e6, 1e6, 100]}
run: {duration: 0.1}
"""
Actuator = tuple[str, dict[str, Any], dict[str, Any]]
FILTER: dict[str, Any] = {"x": {"rate": "(0.1 - a.x - x)/0.1", "start": 0}}
OPPOSED: dict[str, Actuator] = {
    "to a path": (PLANE, {"type": "force", "i": "a", "force": ["100*(0.2*sin(t) - a.x)", 0]}, {}),
    "of the speed": (PLANE, {"type": "force", "i": "a", "force": ["10*(sin(t) - a.vx)", 0]}, {}),
    "from 50 ms on": (PLANE, {"type": "force", "i": "a", "force": ["step(t, 0.05, 0, 0.06, 1)*(1 - a.x)", 0]}, {}),
    "at another point": (PLANE, {"type": "force", "i": {"body": "a", "point": [0, 1]}, "force": ["t - a.x", 0]}, {}),
    "by a state": (PLANE, {"type": "force", "i": "a", "force": ["100*x", 0]}, FILTER),
    "by a state and the place": (PLANE, {"type": "force", "i": "a", "force": ["100*(x - a.x)", 0]}, FILTER),
    "undefined at some states": (PLANE, {"type": "force", "i": "a", "force": ["sqrt(x + 0.01)*(1 - a.x) + 100*x", 0]}, FILTER),
    "along a line": (PLANE, {"type": "line_force", "i": "a", "j": {"body": "ground", "point": [-2, 0]}, "force": "t - a.x"}, {}),
    "in space": (SPACE, {"type": "force", "i": "a", "force": ["100*(0.2*sin(t) - a.x)", 0, 0]}, {}),
    "in space by a state": (SPACE, {"type": "force", "i": "a", "force": ["100*x", 0, 0]}, FILTER),
    "on the slider of a driven crank": (LOOP, {"type": "force", "i": "slider", "force": ["9*(t - slider.x)", 0]}, {}),
    "on the rod of a driven crank": (LOOP, {"type": "torque", "i": "rod", "torque": "9*(t - rod.angle)"}, {}),
    "past a bushing": (HOUSING, {"type": "force", "i": "a", "j": "frame", "force": ["9*(t - dx(a, frame))", 0]}, {}),
}  # fmt: skip
LEGITIMATE: dict[str, Actuator] = {
    "spring": (PLANE, {"type": "force", "i": "a", "force": ["-100*a.x - a.vx", 0]}, {}),
    "spring element": (PLANE, {"type": "spring_damper", "i": "a", "j": {"body": "ground", "point": [-2, 0]}, "stiffness": 9, "free_length": 1, "damping": 1}, {}),
    "over time": (PLANE, {"type": "force", "i": "a", "force": ["sin(t)", 0]}, {}),
    "on the free pin": (PLANE, {"type": "torque", "i": "b", "j": "a", "torque": "9*(sin(t) - b.angle)"}, {}),
    "on both": (PLANE, {"type": "force", "i": "b", "force": ["9*(t - b.x)", "9*(t - b.y)"]}, {}),
    "on the free pin in space": (SPACE, {"type": "torque", "i": "b", "torque": [0, 0, "9*(t - wz(b))"]}, {}),
    "over what a rail carries": (PLANE, {"type": "force", "i": "a", "force": [0, "9*(t - a.y)"]}, {}),
    "on the frame": (HOUSING, {"type": "force", "i": "frame", "force": ["9*(t - frame.x)", 0]}, {}),
}  # fmt: skip
NOTE = "servo acts on a motion that motor prescribes, so it changes only the reaction"


def notes(actuator: Actuator, ask: str) -> str:
    """Return the notes of a run with or without presolve, or of a check."""
    text, servo, states = actuator
    scene = read_yaml(text, "scene")
    scene["forces"] = scene.get("forces", {}) | {"servo": servo}
    model = read_scene(scene_text(scene | {"states": states}))
    return "; ".join(check(model).messages if ask == "check" else run(model, presolve=ask == "run").notes)


ASKED = ("run", "check", "run without presolve")

CASES = (
    *(
        said(f"controller {name}, {ask}", "a note", partial(notes, actuator, ask), NOTE)
        for name, actuator in OPPOSED.items() for ask in ASKED
    ),
    *(
        said(f"{name}, {ask}", "no note", partial(notes, actuator, ask), without=("acts on a motion",))
        for name, actuator in LEGITIMATE.items() for ask in ASKED
    ),
)  # fmt: skip
