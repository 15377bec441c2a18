"""Controllers that act on what a drive prescribes are reported by name; springs, dampers, forces over time are not."""

import pytest
import yaml

import stiffmbs
from stiffmbs.describe.reading import read_scene

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
FILTER = {"x": {"rate": "(0.1 - a.x - x)/0.1", "start": 0}}
OPPOSED = {
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
LEGITIMATE = {
    "spring": (PLANE, {"type": "force", "i": "a", "force": ["-100*a.x - a.vx", 0]}, {}),
    "spring element": (PLANE, {"type": "spring_damper", "i": "a", "j": {"body": "ground", "point": [-2, 0]}, "stiffness": 9, "free_length": 1, "damping": 1}, {}),
    "over time": (PLANE, {"type": "force", "i": "a", "force": ["sin(t)", 0]}, {}),
    "on the free pin": (PLANE, {"type": "torque", "i": "b", "j": "a", "torque": "9*(sin(t) - b.angle)"}, {}),
    "on both": (PLANE, {"type": "force", "i": "b", "force": ["9*(t - b.x)", "9*(t - b.y)"]}, {}),
    "on the free pin in space": (SPACE, {"type": "torque", "i": "b", "torque": [0, 0, "9*(t - wz(b))"]}, {}),
    "over what a rail carries": (PLANE, {"type": "force", "i": "a", "force": [0, "9*(t - a.y)"]}, {}),
    "on the frame": (HOUSING, {"type": "force", "i": "frame", "force": ["9*(t - frame.x)", 0]}, {}),
}  # fmt: skip


def notes_of(text, servo, states):
    scene = yaml.safe_load(text)
    scene["forces"] = scene.get("forces", {}) | {"servo": servo}
    scene["states"] = states
    model = read_scene(yaml.safe_dump(scene))
    for presolve in (True, False):
        run = stiffmbs.run(model, presolve=presolve)
        yield [note for note in run.notes if "acts on a motion" in note]
    yield [message for message in stiffmbs.check(model).messages if "acts on a motion" in message]


@pytest.mark.parametrize("case", OPPOSED)
def test_a_controller_that_acts_on_a_prescribed_motion_is_reported(case):
    for (note,) in notes_of(*OPPOSED[case]):
        assert note.startswith("servo acts on a motion that motor prescribes: it changes only the reaction")


@pytest.mark.parametrize("case", LEGITIMATE)
def test_others_are_not(case):
    assert [*notes_of(*LEGITIMATE[case])] == [[], [], []]
