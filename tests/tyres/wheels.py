"""A wheel on a road at a state that is wanted, and what its tyre reports there."""

import math

from stiffmbs import compile_model
from stiffmbs.compile.reactions import reactions
from stiffmbs.compile.state import State
from stiffmbs.spatial import Body, Model

SAMPLE = {
    "FNOMIN": 1.0, "UNLOADED_RADIUS": 1.0, "VERTICAL_STIFFNESS": 1.0, "PCX1": 1.6, "PDX1": 1.1, "PKX1": 2.0, "PCY1": 1.4,
    "PDY1": 1.0, "PKY1": -1.3, "PKY2": 1.5, "RBX1": 1.3, "RCX1": 1.1, "RBY1": 0.7, "RCY1": 1.05, "QBZ1": 1.0, "QCZ1": 1.1,
    "QDZ1": 0.1, "QSX3": 0.1, "QSY1": 0.01, "PHY1": 0.01, "PVX1": 0.02, "RVY1": 0.1, "RVY4": 1.0, "RVY5": 2.0, "RVY6": 1.0,
    "SSZ2": 0.1, "QDZ6": 0.1, "QBZ10": 1.0,
}  # fmt: skip
"""A plausible tyre of unit size."""


def wheel(tyre, radius, deflection=0.0, slip_angle=0.0, camber=0.0, speed=10.0, spin=0.0, z=0.0):
    """A model of one wheel that is pressed on a level road at a height by a deflection, turned and moved as asked."""
    height = (radius - deflection) * math.cos(camber) + z
    across = (0.0, math.cos(camber), math.sin(camber))
    model = Model("wheel", gravity=(0, 0, -9.81))
    velocity = (speed, abs(speed) * math.tan(slip_angle), 0.0)
    axes = {"y": across, "x": (1, 0, 0)}
    body = Body(
        mass=20,
        inertia=(0.7, 1.2, 0.7),
        position=(0, 0, height),
        orientation=axes,
        velocity=velocity,
        omega=(0, spin, 0),
    )
    model.add("wheel", body)
    model.add("tyre", tyre)
    return model


def reported(model, name="tyre"):
    """The channels of a tyre at the start, in the state that the model describes."""
    system = compile_model(model.data())
    state = State(system)
    state.evaluate("output", 0.0)
    found = reactions(system, state.values["output"][None, :])
    return {channel.removeprefix(f"{name}."): float(x[0]) for channel, x in found.items() if channel.startswith(name)}
