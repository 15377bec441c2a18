"""Light bodies in strong dampers, whose velocities follow the forces: motion and steps beside SciPy's, and closed forms."""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.linalg import expm

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...mechanisms.spring_network import AXES, GROUND, Network, Spring
from ...simulation import simulation

MORE_STEPS = 3
"""Times as many steps as SciPy's BDF takes at the same tolerance are allowed."""
DURATION = 1.0


def node(mass: float, dimensions: int = 2, quadratic: bool = False, drag: float = 0.01) -> Network:
    """0.8 kg on two springs in a row, with a light node between them that a drag slows."""
    aside, up = (0.0,) * (dimensions - 2), (0.3,) * (dimensions - 2)
    return Network(
        (0.8, mass), ((0.5, 0.0, *aside), (0.3, 0.0, *aside)), ((0.0, 0.5, *up), (0.0, 0.0, *aside)),
        (Spring(1, GROUND, 20.0, 0.1), Spring(0, 1, 40.0, 0.1)), (0.0, drag), quadratic,
    )  # fmt: skip


def two_nodes(mass: float) -> Network:
    """The same with two nodes in a row, one ten times as heavy."""
    return Network(
        (0.8, mass, 10 * mass), ((0.6, 0.0), (0.2, 0.0), (0.4, 0.0)), ((0.0, 0.5), (0.0, 0.0), (0.0, 0.0)),
        (Spring(1, GROUND, 20.0, 0.1), Spring(2, 1, 30.0, 0.1), Spring(0, 2, 40.0, 0.1)), (0.0, 0.01, 0.02),
    )  # fmt: skip


def _beside_scipy(solution: Solution, network: Network, rtol: float) -> float:
    """Of the positions at the end; infinite for more steps than are allowed."""
    _, steps = network.solved(DURATION, rtol, "BDF")
    if solution.solver["steps"] > MORE_STEPS * steps:
        return float("inf")
    expected, _ = network.solved(DURATION, 1e-9, "Radau")
    axes = AXES[: network.dimensions]
    found = [[solution[f"m{k}.{axis}"][-1] for axis in axes] for k in range(len(network.masses))]
    return float(np.max(np.abs(np.array(found) - expected)))


def _case(name: str, network: Network, rtol: float = 1e-6, quick: bool = True):
    return simulation(
        f"{name}, rtol {rtol:.0e}", f"positions against SciPy's Radau, at most {MORE_STEPS} times the steps of SciPy's BDF",
        network.model, partial(_beside_scipy, network=network, rtol=rtol), 10 * rtol,
        solver="bdf", duration=DURATION, points=101, rtol=rtol, quick=quick,
    )  # fmt: skip


STIFFNESS, DAMPING, INERTIA = (30.0, 50.0), 0.01, 0.2
"""Of two torsion springs in a row, N m/rad; of the light disc between them, N m s/rad; of the disc at the end, kg m^2."""


def light_disc(inertia: float) -> Model:
    """A disc on two torsion springs in a row, with a light disc between them in a rotational damper."""
    model = Model("Light disc")
    for name, own, angle in (("light", inertia, 0.0), ("disc", INERTIA, 0.5)):
        model.add(name, Body(mass=1, inertia=own, angle=angle))
        model.add(f"{name}_pin", JOINTS["revolute"](i=name, j="ground"))
    first, second = STIFFNESS
    model.add("first", FORCES["torsion_spring"](i="light", j="ground", stiffness=first, damping=DAMPING))
    model.add("second", FORCES["torsion_spring"](i="disc", j="light", stiffness=second))
    return model


def _by_exponential(solution: Solution, inertia: float) -> float:
    """Of both angles, against the matrix exponential of the linear equations."""
    first, second = STIFFNESS
    rates = np.zeros((4, 4))
    rates[:2, 2:] = np.eye(2)
    rates[2] = np.array([-first - second, second, -DAMPING, 0]) / inertia
    rates[3] = np.array([second, -second, 0, 0]) / INERTIA
    step = expm(rates * (solution.t[1] - solution.t[0]))
    states = [np.array([0.0, 0.5, 0.0, 0.0])]
    for _ in solution.t[1:]:
        states.append(step @ states[-1])
    expected = np.array(states)[:, :2]
    found = np.stack([solution["light.angle"], solution["disc.angle"]], axis=1)
    few = float("inf") if solution.solver["steps"] > 2000 else 0.0
    return float(np.max(np.abs(found - expected))) + few


def node_on_bushing(mass: float) -> Model:
    """1 kg on a spring whose other end is a light node on a critically damped bushing."""
    model = Model("Node on a bushing")
    model.add("node", Body(mass=mass, inertia=1))
    model.add("mass", Body(mass=1, inertia=1, position=(0.6, 0), velocity=(0, 0)))
    damping = 2 * np.sqrt(1e5 * mass)
    model.add(
        "bushing", FORCES["bushing"](i="node", j="ground", stiffness=[1e5, 1e5, 0], damping=[damping, damping, 0])
    )
    model.add("spring", FORCES["spring_damper"](i="mass", j="node", stiffness=100, free_length=0.5))
    return model


def _as_a_spring(solution: Solution) -> float:
    """Both springs in a row act as one, as the node is next to massless; infinite for more than 2000 steps."""
    rate = np.sqrt(1 / (1 / 100 + 1 / 1e5))
    few = float("inf") if solution.solver["steps"] > 2000 else 0.0
    return float(np.max(np.abs(solution["mass.x"] - 0.5 - 0.1 * np.cos(rate * solution.t)))) + few


CASES = (
    *(
        _case(f"node of {mass:.0e} kg", node(mass), rtol, quick=mass in (1e-6, 1e-9) and rtol in (1e-4, 1e-6))
        for mass in (1e-6, 1e-7, 1e-8, 1e-9, 1e-10) for rtol in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    ),
    *(_case(f"node of {mass:.0e} kg in space", node(mass, 3), quick=mass == 1e-8) for mass in (1e-6, 1e-8, 1e-10)),
    *(_case(f"two nodes of {mass:.0e} kg and ten times that", two_nodes(mass), quick=False) for mass in (1e-6, 1e-9)),
    *(_case(f"node of {mass:.0e} kg, quadratic drag", node(mass, quadratic=True, drag=1.0), quick=mass == 1e-9) for mass in (1e-6, 1e-9)),
    *(_case(f"node of 1e-08 kg, drag {drag:g}", node(1e-8, drag=drag), quick=drag == 0.1) for drag in (1e-3, 0.1)),
    *(
        simulation(
            f"light disc of {inertia:.0e} kg m^2", "angles against the matrix exponential, at most 2000 steps",
            partial(light_disc, inertia), partial(_by_exponential, inertia=inertia), 1e-5,
            solver="bdf", duration=2.0, points=101, rtol=1e-7,
        )
        for inertia in (1e-6, 1e-8, 1e-10)
    ),
    *(
        simulation(
            f"node of {mass:.0e} kg on a bushing", "two springs in a row as one, at most 2000 steps",
            partial(node_on_bushing, mass), _as_a_spring, 1e-5, solver="bdf", duration=2.0, points=101, rtol=1e-7,
        )
        for mass in (1e-7, 1e-9)
    ),
)  # fmt: skip
