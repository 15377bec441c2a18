"""Kinematics and compliance of an axle: quasi-static sweeps on a test rig."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...analyses.job import Runnable, data_of
from ...analyses.quasi_static import quasi_static
from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.table import Table
from .characteristics import characteristics
from .rig import INPUTS, SIDES, Axle, axle_of, design_height, on_rig


@dataclass(frozen=True)
class LoadCase:
    """Sweep of the rig's inputs from minus to plus their amplitudes.

    Attributes
    ----------
    name, swept : str
        Names of the case and of its abscissa.
    unit : str
    scale : float
        SI value of one unit of the abscissa.
    inputs : mapping of str to float
        Value of each input for an abscissa of 1 in SI units.
    amplitude : float
        Default amplitude, in the unit of the abscissa.
    opposite : bool
        True if the right wheel follows the left one with opposite sign.
    """

    name: str
    swept: str
    unit: str
    scale: float
    inputs: dict[str, float]
    amplitude: float
    opposite: bool = False


CASES = (
    LoadCase("bump", "travel of both wheels", "mm", 1e-3, {"kc_left": 1.0, "kc_right": 1.0}, 50.0),
    LoadCase("roll", "travel, left up and right down", "mm", 1e-3, {"kc_left": 1.0, "kc_right": -1.0}, 30.0, True),
    LoadCase("steer", "travel of the rack to the left", "mm", 1e-3, {"kc_rack": 1.0}, 30.0, True),
    LoadCase("lateral", "force outwards at both patches", "kN", 1e3, {"kc_lateral": 1.0}, 2.0),
    LoadCase("lateral_parallel", "force to the left at both patches", "kN", 1e3, {"kc_parallel": 1.0}, 2.0, True),
    LoadCase("brake", "braking force at both patches", "kN", 1e3, {"kc_brake": 1.0}, 2.0),
    LoadCase("traction", "driving force at both wheels' centres", "kN", 1e3, {"kc_traction": 1.0}, 2.0),
    LoadCase("aligning", "torque that turns both wheels inwards", "N m", 1.0, {"kc_torque": 1.0}, 100.0),
    LoadCase(
        "aligning_parallel", "torque that turns both wheels to the left", "N m", 1.0, {"kc_turn": 1.0}, 100.0, True
    ),
)
AMPLITUDES = {case.name: case.amplitude for case in CASES}


@dataclass(frozen=True)
class Sweep:
    """Curves of one load case.

    Attributes
    ----------
    case : LoadCase
    abscissa : ndarray, shape (n,)
        Values in the unit of the case.
    channels : dict of str to ndarray
        Characteristics of both wheels, as `stiffmbs.studies.suspension.characteristics` names them.
    """

    case: LoadCase
    abscissa: np.ndarray
    channels: dict[str, np.ndarray]

    def slope(self, channel: str) -> float:
        """Return the slope of a curve at its middle, by a parabola through three points; per unit of the case."""
        middle = len(self.abscissa) // 2
        x, y = self.abscissa, self.channels[channel]
        return float((y[middle + 1] - y[middle - 1]) / (x[middle + 1] - x[middle - 1]))


@dataclass(frozen=True)
class KinematicsAndCompliance:
    """Curves of all load cases of an axle.

    Attributes
    ----------
    name : str
    axle : Axle
    sweeps : dict of str to Sweep
        Curves by load case.
    message : str
    """

    name: str
    axle: Axle
    sweeps: dict[str, Sweep] = field(default_factory=dict)
    message: str = ""

    def asymmetry(self) -> float:
        """Return the largest difference between left and right, relative to the largest value of the curve or 1.

        In cases of opposite signs the order of the right curve is reversed.
        """
        worst = 0.0
        for sweep in self.sweeps.values():
            order = slice(None, None, -1) if sweep.case.opposite else slice(None)
            for left in (each for each in sweep.channels if each.startswith("left.")):
                a, b = sweep.channels[left], sweep.channels[f"right.{left.removeprefix('left.')}"][order]
                worst = max(worst, float(np.max(np.abs(a - b)) / max(1.0, np.max(np.abs(a)))))
        return worst

    def as_dict(self, scene: str) -> dict[str, Any]:
        """Return the content of ``stiffmbs kc --json``."""
        cases = {
            name: {
                "input": sweep.case.swept, "unit": sweep.case.unit, "values": sweep.abscissa.tolist(),
                "channels": {channel: values.tolist() for channel, values in sweep.channels.items()},
                "slopes": {channel: sweep.slope(channel) for channel in sweep.channels},
            }
            for name, sweep in self.sweeps.items()
        }  # fmt: skip
        return {
            "scene": scene,
            "status": "done",
            "message": self.message,
            "asymmetry": self.asymmetry(),
            "cases": cases,
        }


def kinematics_and_compliance(
    model: Runnable, axle: str = "front", points: int = 11, body: str | None = None, steering: str | None = None,
    **amplitudes: float,
) -> KinematicsAndCompliance:  # fmt: skip
    """Sweep an axle on a test rig by equilibria: wheel travel, roll, steering, and forces and torques on the wheels.

    The body is clamped as described, pads hold the patches at their heights, and tyres, drivers and other axles are
    left out. All sweeps start at the heights of the described scene.

    Parameters
    ----------
    model : Scene, str or Path
        Scene with suspensions ``front.left`` and ``front.right``, each with a body ``upright`` that has the markers
        ``spindle`` and ``patch``, or with a body ``front.axle`` that has those of both sides, as in the shipped parts.
    axle : str
        Prefix of ``.left`` and ``.right``; empty for suspensions ``left`` and ``right``.
    points : int
        Number of points of each curve, odd and at least 5.
    body, steering : str, optional
        Body to clamp, by default ``chassis`` or the one that carries the axle.  Prismatic joint that steers, by default
        the only ``guide``.
    **amplitudes
        Amplitudes of the load cases, such as ``bump=40`` (mm) or ``lateral=3`` (kN); 0 omits a case.

    Returns
    -------
    KinematicsAndCompliance

    Raises
    ------
    InputError
        If the scene lacks a required part, or a case is unknown.
    SolverError
        If the axle has no equilibrium on the rig.
    """
    if points < 5 or points % 2 == 0:
        raise InputError(f"points: found {points}, expected an odd number, 5 or more")
    for name, amplitude in amplitudes.items():
        if name not in AMPLITUDES or not np.isfinite(amplitude) or amplitude < 0:
            near = did_you_mean(name, AMPLITUDES)
            raise InputError(
                f"{name}={amplitude!r}: found no such case or amplitude{near}, expected {', '.join(AMPLITUDES)}"
            )
    data = data_of(model)
    if data.dimensions != 3:
        raise InputError("found a scene in the plane, expected one in space")
    found = axle_of(data, axle, body, steering)
    sizes = {**AMPLITUDES, **amplitudes}
    cases = [case for case in CASES if sizes[case.name] and (case.name != "steer" or found.steering)]
    half = points // 2
    schedule = _schedule(cases, sizes, half)
    heights = {f"kc_{side}": design_height(data, found, side) for side in SIDES}
    rig = on_rig(data, found, _tables(schedule, heights))
    solution = quasi_static(rig, start=0.0, duration=float(len(schedule) - 1), output=1.0)
    sweeps = {}
    for k, case in enumerate(cases):
        first = k * (2 * half + 2)
        order = [*range(first + 2 * half + 1, first + half + 1, -1), *range(first, first + half + 1)]
        part = {name: values[order] for name, values in solution.items()}
        abscissa = sizes[case.name] * np.linspace(-1, 1, points)
        sweeps[case.name] = Sweep(case, abscissa, characteristics(rig, found, part, half, "kc_left" in case.inputs))
    return KinematicsAndCompliance(data.name, found, sweeps, solution.message)


def _schedule(cases: list[LoadCase], sizes: dict[str, float], half: int) -> list[dict[str, float]]:
    """Return the inputs at all instants: each case from zero to plus its amplitude, back, and to minus it."""
    parts = [*np.linspace(0, 1, half + 1), 0.0, *np.linspace(-1 / half, -1, half)]
    return [
        {name: part * sizes[case.name] * case.scale * each for name, each in case.inputs.items()}
        for case in cases
        for part in parts
    ]


def _tables(schedule: list[dict[str, float]], heights: dict[str, float]) -> dict[str, Table]:
    return {
        name: Table(
            table=[(float(t), heights.get(name, 0.0) + inputs.get(name, 0.0)) for t, inputs in enumerate(schedule)],
            lines=True,
        )
        for name in INPUTS
    }
