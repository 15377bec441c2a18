"""Beam problems with reference values that two independent methods agree on."""

import math

import stiffmbs

STRIP = (
    "section: {type: rectangle, width: 3.2024e-3, height: 12.377e-3}, material: {E: 71.7e9, nu: 0.31, density: 2700}"
)
RUBBER = "section: {type: circle, diameter: 20 mm}, material: {E: 5 MPa, nu: 0.3, density: 1100 kg/m^3}"


def at_rest(text, **changes):
    """The channels in the static equilibrium of a scene."""
    return stiffmbs.equilibrium(stiffmbs.read_scene(text), **changes).channels


def cantilever(n, force="[0, 0]", torque=0.0, stiffness="[1e4, 1e4, 1]"):
    """A clamped beam of unit length and bending stiffness in the plane, with loads at its end."""
    return f"""
bodies:
  strip:
    {{type: beam, start: [0, 0], end: [1, 0], elements: {n}, stiffness: {stiffness}, mass_per_length: 1, inertia_per_length: 0.01}}
joints: {{clamp: {{type: fixed, i: strip.start, j: ground}}}}
forces:
  P: {{type: force, i: strip.end, force: {force}}}
  M: {{type: torque, i: strip.end, torque: {torque!r}}}
"""


def bend(n, load, GJ):
    """The 45 degree bend of Bathe and Bolourchi (1979)."""
    middle, end = math.pi / 8, math.pi / 4
    return f"""
dimensions: 3
bodies:
  bend:
    type: beam
    start: [0, 0, 0]
    through: [{100 * math.sin(middle)!r}, {100 * (1 - math.cos(middle))!r}, 0]
    end: [{100 * math.sin(end)!r}, {100 * (1 - math.cos(end))!r}, 0]
    elements: {n}
    stiffness: [1e7, 5e6, 5e6, {GJ!r}, {1e7 / 12!r}, {1e7 / 12!r}]
    mass_per_length: 1
    inertia_per_length: [1, 1, 1]
joints: {{clamp: {{type: fixed, i: bend.start, j: ground}}}}
forces: {{P: {{type: force, i: bend.end, force: [0, 0, {load}]}}}}
"""


def princeton(n, load, degrees):
    """The Princeton beam: a clamped strip whose dead load is inclined against the height of its section."""
    angle = math.radians(degrees)
    return f"""
dimensions: 3
bodies: {{strip: {{type: beam, start: [0, 0, 0], end: [0.508, 0, 0], elements: {n}, {STRIP}}}}}
joints: {{clamp: {{type: fixed, i: strip.start, j: ground}}}}
forces: {{P: {{type: force, i: strip.end, force: [0, {load * math.sin(angle)!r}, {load * math.cos(angle)!r}]}}}}
"""


def pendulum(n, dimensions=2):
    """A rod of soft rubber, pinned at one end, that falls from the horizontal."""
    joint, zero = ("revolute", "") if dimensions == 2 else ("spherical", ", 0")
    gravity, turning = ("[0, -9.81]", "") if dimensions == 2 else ("[0, 0, -9.81]", "omega: [0, 0, 2], ")
    return f"""
dimensions: {dimensions}
gravity: {gravity}
bodies: {{rod: {{type: beam, start: [0, 0{zero}], end: [1, 0{zero}], elements: {n}, {turning}{RUBBER}}}}}
joints: {{pin: {{type: {joint}, i: rod.start, j: ground}}}}
run: {{duration: 0.4 s, points: 3, rtol: 1e-8}}
"""


def spin_up(n):
    """A beam on a hub that is brought to 6 rad/s in 15 s (Kane, Ryan, Banerjee 1987)."""
    angle = "6/15*(t^2/2 + (15/(2*pi))^2*(cos(2*pi*t/15) - 1))"
    return f"""
bodies:
  arm:
    {{type: beam, start: [0, 0], end: [10, 0], elements: {n}, stiffness: [2.8e7, 1e7, 1.4e4], mass_per_length: 1.2,
     inertia_per_length: 6e-4}}
joints:
  hub: {{type: revolute, i: arm.start, j: ground}}
  motor: {{type: drive, joint: hub, position: "{angle}"}}
requests:
  lag: arm.end.y*cos(arm.start.angle) - arm.end.x*sin(arm.start.angle)
run: {{duration: 8 s, points: 9, rtol: 1e-7, solver: radau}}
"""


def flying(n, duration=2.5):
    """Flying spaghetti in the plane (Simo, Vu-Quoc 1986)."""
    return f"""
bodies:
  rod:
    {{type: beam, start: [6, 0], end: [0, 8], elements: {n}, stiffness: [1e4, 1e4, 500], mass_per_length: 1,
     inertia_per_length: 10}}
forces:
  F: {{type: force, i: rod.start, force: ["branch(t - 2.5, 8, 0, 0)", 0]}}
  M: {{type: torque, i: rod.start, torque: "branch(t - 2.5, -80, 0, 0)"}}
run: {{duration: {duration} s, points: 11, rtol: 1e-8, solver: projected}}
"""


def flying_in_space(n, duration=5.0):
    """Flying spaghetti in space (Simo, Vu-Quoc 1988)."""
    p = "branch(t - 2.5, 80*t, 200, branch(t - 5, 200 - 80*(t - 2.5), 0, 0))"
    return f"""
dimensions: 3
bodies:
  rod:
    {{type: beam, start: [6, 0, 0], end: [0, 8, 0], elements: {n}, stiffness: [1e4, 1e4, 1e4, 500, 500, 500],
     mass_per_length: 1, inertia_per_length: [20, 10, 10]}}
forces:
  F: {{type: force, i: rod.start, force: ["{p}/10", 0, 0]}}
  M: {{type: torque, i: rod.start, torque: [0, "-{p}/2", "-{p}"]}}
run: {{duration: {duration} s, points: 11, rtol: 1e-8, solver: projected}}
"""


def right_angle(n, duration=4.0):
    """The frame of two legs at a right angle, loaded at its elbow (Simo, Vu-Quoc 1988)."""
    return f"""
dimensions: 3
bodies:
  frame:
    {{type: beam, points: [[0, 0, 0], [10, 0, 0], [10, 10, 0]], elements: {2 * n}, stations: {{elbow: 10}},
     stiffness: [1e6, 1e6, 1e6, 1e3, 1e3, 1e3], mass_per_length: 1, inertia_per_length: [20, 10, 10]}}
joints: {{clamp: {{type: fixed, i: frame.start, j: ground}}}}
forces: {{F: {{type: force, i: frame.elbow, force: [0, 0, "branch(t - 1, 50*t, 50, branch(t - 2, 50*(2 - t), 0, 0))"]}}}}
run: {{duration: {duration} s, points: 3, rtol: 1e-8, solver: projected}}
"""
