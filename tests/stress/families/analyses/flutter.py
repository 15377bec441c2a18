"""Equilibria that are statically stable and dynamically unstable: negative damping and follower forces."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene

from ...case import Case, Outcome, Verdict, measured, told

SLIDER = """
bodies: {{b: {{mass: 1, inertia: 1, position: [0.1, 0]}}}}
joints: {{rail: {{type: prismatic, i: b, j: ground}}}}
forces: {{f: {{type: force, i: b, force: ["{law}", 0]}}}}
"""
COLUMN = """
bodies:
  a: {{mass: 2, inertia: 1e-6, position: [0, 1], markers: {{foot: {{point: [0, -1]}}}}}}
  b: {{mass: 1, inertia: 1e-6, position: [0, 2], markers: {{foot: {{point: [0, -1]}}}}}}
joints:
  lower: {{type: revolute, i: a.foot, j: ground}}
  upper: {{type: revolute, i: b.foot, j: a}}
forces:
  foot: {{type: torque, i: a, torque: "-a.angle - {damping}*a.omega"}}
  knee: {{type: torque, i: b, j: a, torque: "-(b.angle - a.angle) - {damping}*(b.omega - a.omega)"}}
  follower: {{type: force, i: b, axes: body, force: [0, -{load}]}}
"""
"""Ziegler's column: critical loads 2.086 k/l without damping and 1.464 k/l with a little (Ziegler, Ing.-Arch. 20, 1952)."""


def slider(law: str) -> Scene:
    """Return a slider under a force along its rail."""
    return read_scene(SLIDER.format(law=law))


def column(load: float, damping: float) -> Scene:
    """Return Ziegler's column under a follower force, N."""
    return read_scene(COLUMN.format(load=load, damping=damping))


def _judged(made: Callable[[], Scene], unstable: bool) -> Verdict:
    notes = "; ".join(equilibrium(made()).notes)
    if unstable:
        return told(notes, ("the equilibrium is unstable: disturbances grow at",))
    return measured(float("unstable" in notes), 0.0, notes)


def _case(name: str, made: Callable[[], Scene], unstable: bool) -> Case:
    expected = Outcome.TOLD if unstable else Outcome.RIGHT
    return Case(f"{name} is {'un' if unstable else ''}stable", "a note", partial(_judged, made, unstable), expected)


LAWS = {
    "-100*b.x + 2*b.vx": True, "-100*b.x + 0.001*b.vx": True, "-0.001*b.x + 1e-4*b.vx": True, "-100*b.x": False,
    "-100*b.x - 2*b.vx": False, "-b.x^3 - b.vx": False, "-1e9*b.x": False,
}  # fmt: skip
LOADS = {
    (1.4, 0.01): False,
    (1.6, 0.01): True,
    (2.0, 0.01): True,
    (4.0, 0.01): True,
    (2.0, 0.0): False,
    (2.2, 0.0): True,
}
CASES = (
    *(_case(f"slider under {law}", partial(slider, law), unstable) for law, unstable in LAWS.items()),
    *(
        _case(f"Ziegler's column at {load:g} k/l, damping {damping:g},", partial(column, load, damping), unstable)
        for (load, damping), unstable in LOADS.items()
    ),
)
