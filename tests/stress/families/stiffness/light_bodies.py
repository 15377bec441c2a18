"""Bodies that hardly resist, on hinges: angles against the equation of motion, with steps for the motion alone."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import GRAVITY
from ...simulation import simulation

MOST_STEPS = 5000
"""Explicit steps that no tolerance asked for here needs, with those up to a few looks at rounding; more are those of rounding."""


def sprung(inertia: float, angle: float = 1.0) -> Model:
    """2 kg without size on a hinge, 0.5 m from it, with a torsion spring of 100 N m/rad, at an angle from the vertical."""
    model = Model("Sprung mass", gravity=(0, -GRAVITY))
    at = 0.5 * np.sin(angle), -0.5 * np.cos(angle)
    mass = model.add("mass", Body(mass=2, inertia=inertia, position=at, angle=angle))
    model.add("hinge", JOINTS["revolute"](i=mass.at(0, 0.5), j="ground"))
    model.add("spring", FORCES["torsion_spring"](i="mass", j="ground", stiffness=100))
    return model


def _sprung(t: np.ndarray, inertia: float, angle: float = 1.0) -> np.ndarray:
    """(2*0.25 + I) phi'' = -100 phi - 2 g 0.5 sin(phi)."""
    return solve_ivp(
        lambda t, y: (y[1], -(100 * y[0] + GRAVITY * np.sin(y[0])) / (0.5 + inertia)), (0, t[-1]), (angle, 0.0), "DOP853", t,
        rtol=1e-12, atol=1e-12,
    ).y[0]  # fmt: skip


def links(mass: float, count: int) -> Model:
    """Masses of 1 kg without size, one hanging from the other by links of 0.5 m that have next to no mass."""
    model = Model("Massless links", gravity=(0, -GRAVITY))
    before: Any = "ground"
    for k in range(count):
        link = model.add(f"link{k}", Body(mass=mass, inertia=mass, position=(0.5 * k + 0.25, 0)))
        body = model.add(f"mass{k}", Body(mass=1, inertia=mass, position=(0.5 * k + 0.5, 0)))
        model.add(f"upper{k}", JOINTS["revolute"](i=link.at(-0.25, 0), j=before))
        model.add(f"lower{k}", JOINTS["fixed"](i=body.at(0, 0), j=link.at(0.25, 0)))
        before = body.at(0, 0)
    return model


def _hanging(t: np.ndarray, count: int) -> np.ndarray:
    """The first link's angle: M(phi) phi'' + ... = 0 of a pendulum of `count` equal masses, phi from the horizontal."""
    share = count - np.maximum.outer(np.arange(count), np.arange(count))

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        """The rates of all angles and of their speeds."""
        phi, w = y[:count], y[count:]
        apart = np.subtract.outer(phi, phi)
        mass = 0.25 * share * np.cos(apart)
        force = -0.25 * (share * np.sin(apart)) @ w**2 - 0.5 * GRAVITY * np.diag(share) * np.cos(phi)
        return np.concatenate([w, np.linalg.solve(mass, force)])

    return solve_ivp(rates, (0, t[-1]), np.zeros(2 * count), "DOP853", t, rtol=1e-12, atol=1e-12).y[0]


def _error(solution: Solution, channel: str, expected: Any) -> float:
    """Of an angle, rad; infinite where steps are those of noise."""
    if solution.solver["name"] == "projected" and solution.solver["steps"] > MOST_STEPS:
        return float("inf")
    return float(np.max(np.abs(solution[channel] - expected(solution.t))))


def _case(name: str, scene: Any, channel: str, expected: Any, rtol: float, **how: Any):
    solver = how.get("scheme", how["solver"])
    return simulation(
        f"{name}, {solver} at {rtol:.0e}", "angle against the Euler-Lagrange equations", scene,
        partial(_error, channel=channel, expected=expected), 1e3 * rtol, duration=1.0, points=11, rtol=rtol, **how,
    )  # fmt: skip


WAYS: tuple[dict[str, Any], ...] = (
    {"solver": "auto"}, {"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "projected", "scheme": "dopri5"},
)  # fmt: skip
CASES = (
    *(
        _case(f"sprung mass of {inertia:.0e} kg m^2", partial(sprung, inertia), "mass.angle", partial(_sprung, inertia=inertia), rtol, **how)
        for inertia in (1e-6, 1e-9, 1e-12, 1e-15) for rtol in (1e-4, 1e-6, 1e-8) for how in WAYS
    ),
    *(
        _case(
            f"sprung mass of {inertia:.0e} kg m^2 let go beside its hinge", partial(sprung, inertia, np.pi / 2), "mass.angle",
            partial(_sprung, inertia=inertia, angle=np.pi / 2), rtol, **how,
        )
        for inertia in (1e-10, 1e-12, 1e-14) for rtol in (1e-7, 1e-10) for how in WAYS[:3]
    ),
    *(
        _case(f"{count} links of {mass:.0e} kg", partial(links, mass, count), "link0.angle", partial(_hanging, count=count), 1e-7, **how)
        for count in (1, 2, 4) for mass in (1e-8, 1e-12) for how in WAYS
    ),
)  # fmt: skip
