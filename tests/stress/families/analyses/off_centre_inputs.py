"""Forces and torques as inputs of transfer functions where the centre of mass is not the body's origin: Newton and Euler."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs import spatial
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.elements.spatial.orientation import about, matrix, product

from ...case import Case, Verdict, measured

MASS, ALLOWED = 2.0, 1e-7
TENSOR = ((0.3, 0.02, 0.05), (0.02, 0.4, -0.03), (0.05, -0.03, 0.5))
"""Inertia about the centre of mass in body axes, kg m^2."""
TURNED = product(about(2, 0.7), about(0, 0.4))
TIP = (0.1, 0.7, -0.3)
ACCELERATIONS = ("ax", "ay", "az", "wdx", "wdy", "wdz")
LOADS = ("fx", "fy", "fz", "tx", "ty", "tz")


def model(offset: tuple[float, ...], spin: tuple[float, ...], held: str) -> spatial.Model:
    """Return one body, or two bodies fixed to each other, with centres of mass away from their origins."""
    made = spatial.Model("Offset", gravity=(0, 0, -9.81))
    at: dict[str, Any] = {"position": (1, 2, 3), "orientation": TURNED, "omega": spin}
    if held == "hinge":
        at["velocity"] = matrix(TURNED) @ np.cross(spin, offset)
    body = spatial.Body(mass=MASS, inertia=TENSOR, center_of_mass=offset, markers={"tip": {"point": TIP}}, **at)
    made.add("b", body)
    if held == "hinge":
        made.add("hinge", spatial.Spherical(i="b", j=spatial.Marker(body="ground", point=(1, 2, 3))))
    if held == "pair":
        made.add("c", spatial.Body(mass=1, inertia=(0.1, 0.2, 0.15), center_of_mass=(0, 0.3, 0), **at))
        made.add("weld", spatial.Fixed(i="b", j="c"))
    return made


def expected(offset: tuple[float, ...], held: str, at_tip: bool) -> np.ndarray:
    """Return the accelerations of the body for unit loads; angular accelerations in body axes."""
    axes = matrix(TURNED)
    centre, place = axes @ offset, axes @ (TIP if at_tip else offset)
    load = np.block([[np.eye(3), np.zeros((3, 3))], [_cross(place - centre), np.eye(3)]])
    mass = [MASS * np.eye(3), axes @ TENSOR @ axes.T]
    to_origin = np.hstack([np.eye(3), _cross(centre)])  # velocity of the body's origin
    rows = np.zeros((0, 6))
    if held == "hinge":
        rows = to_origin
    if held == "pair":
        mass += [np.eye(3), axes @ np.diag((0.1, 0.2, 0.15)) @ axes.T]
        other = np.hstack([np.eye(3), _cross(axes @ (0, 0.3, 0))])
        rows = np.block([[to_origin, -other], [np.zeros((3, 3)), np.eye(3), np.zeros((3, 3)), -np.eye(3)]])
    whole = np.zeros((3 * len(mass),) * 2)
    for k, block in enumerate(mass):
        whole[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = block
    system = np.block([[whole, rows.T], [rows, np.zeros((len(rows),) * 2)]])
    found = np.linalg.solve(system, np.eye(len(system), 6) @ load)[:6]
    return np.vstack([found[:3], axes.T @ found[3:]])


def _cross(arm: np.ndarray) -> np.ndarray:
    x, y, z = arm
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def _judged(offset: tuple[float, ...], spin: tuple[float, ...], held: str, at_tip: bool) -> Verdict:
    point = "b.tip" if at_tip else "b"
    loads, outputs = [f"{point}.{label}" for label in LOADS], [f"b.{label}" for label in ACCELERATIONS]
    wanted = expected(offset, held, at_tip)
    error = float(np.max(np.abs(transfer(model(offset, spin, held), loads, outputs).d - wanted)))
    return measured(error, ALLOWED * max(1.0, float(np.abs(wanted).max())), f"up to {np.abs(wanted).max():.3g}")


def _case(offset: tuple[float, ...], spin: tuple[float, ...], held: str, at_tip: bool) -> Case:
    name = f"loads at {'a marker' if at_tip else 'the centre'} {offset}, {held}, spin {spin}"
    return Case(name, "accelerations by Newton and Euler", partial(_judged, offset, spin, held, at_tip))


CASES = tuple(
    _case(offset, spin, held, at_tip)
    for offset in ((0.5, 0.0, 0.0), (0.3, -0.2, 0.1))
    for spin, held in (((0, 0, 0), "free"), ((0.5, -2, 3), "free"), ((0, 0, 0), "hinge"), ((1, 2, -1), "hinge"), ((0, 0, 0), "pair"))
    for at_tip in (False, True)
)  # fmt: skip
