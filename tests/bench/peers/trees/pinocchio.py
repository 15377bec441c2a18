"""Pinocchio's articulated-body algorithm in SciPy's integrators."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ...contestant import Contestant, Failed, Solve
from .tree import GROUND, Tree

MOST_STEPS = 10**7


def contestants(tree: Tree) -> Iterator[Contestant]:
    """DOP853, and LSODA through its Fortran loop."""
    yield Contestant("Pinocchio, SciPy DOP853", True, lambda rtol: marching(tree, explicit, rtol))
    yield Contestant("Pinocchio, SciPy LSODA", True, lambda rtol: marching(tree, lsoda, rtol))


def rates_of(tree: Tree) -> Callable[[float, np.ndarray], np.ndarray]:
    """``rates(t, y)`` for y = (hinge angles, their rates)."""
    import pinocchio as pin

    model, n, damping = model_of(tree), len(tree.links), tree.damping
    data = model.createData()

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        v = y[n:]
        return np.concatenate((v, pin.aba(model, data, y[:n], v, -damping * v)))

    return rates


def at_start(tree: Tree) -> Callable[[], np.ndarray]:
    """The accelerations of the hinges by `aba`, at the start."""
    import pinocchio as pin

    model, v = model_of(tree), tree.rates
    data, still, torques = model.createData(), np.zeros(len(v)), -tree.damping * v
    return lambda: np.asarray(pin.aba(model, data, still, v, torques))


def model_of(tree: Tree) -> Any:
    """Pinocchio's model."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = tree.gravity
    for k, link in enumerate(tree.links):
        place = pin.SE3(np.eye(3), tree.from_parent(k))
        parent = 0 if link.parent == GROUND else link.parent + 1
        joint = model.addJoint(parent, pin.JointModelRevoluteUnaligned(link.axis), place, f"hinge{k}")
        inertia = pin.Inertia(link.mass, link.centre - link.hinge, link.inertia)
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    return model


def marching(tree: Tree, method: Callable[..., np.ndarray], rtol: float) -> Solve:
    """Centres of mass at the output times; their computation from hinge angles is timed."""
    rates, n = rates_of(tree), len(tree.links)
    start = np.concatenate([np.zeros(n), tree.rates])
    return lambda: tree.places(method(rates, start, tree.times, rtol)[:, :n])


def explicit(rates: Callable[..., Any], start: np.ndarray, times: np.ndarray, rtol: float) -> np.ndarray:
    """Dormand and Prince's method of order 8."""
    from scipy.integrate import solve_ivp

    found = solve_ivp(rates, (times[0], times[-1]), start, method="DOP853", t_eval=times, rtol=rtol, atol=rtol)
    if not found.success:
        raise Failed(found.message)
    return np.asarray(found.y.T)


def lsoda(rates: Callable[..., Any], start: np.ndarray, times: np.ndarray, rtol: float) -> np.ndarray:
    """Adams or BDF as the method itself chooses."""
    from scipy.integrate import odeint

    found, report = odeint(rates, start, times, tfirst=True, rtol=rtol, atol=rtol, mxstep=MOST_STEPS, full_output=True)
    if report["message"] != "Integration successful.":
        raise Failed(report["message"])
    return np.asarray(found)
