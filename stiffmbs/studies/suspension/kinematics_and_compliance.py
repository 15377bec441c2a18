"""Kinematics and compliance of an axle: quasi-static sweeps on a test rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from numbers import Integral, Real

import numpy as np

from ...analyses.equilibrium import equilibria_over_time
from ...analyses.job import Runnable, data_of, prepare
from ...errors import InputError, refuse_text
from ...reading.did_you_mean import did_you_mean
from ...reading.table import Table
from ..targets import Metric, Target, judged
from .axle import Axle, axle_of
from .characteristics import UNITS, Hub, Pose, Setup, displacements, of_axle, of_steering_axis, of_travel, setup_of
from .rig import centre, inputs_of, on_rig, pad
from .vehicle import Vehicle, VehicleOptions, vehicle_of


@dataclass(frozen=True)
class LoadCase:
    """Sweep of the rig's inputs from minus to plus their amplitudes."""

    # name, swept: names of the case and of its abscissa
    name: str
    swept: str
    unit: str
    scale: float  # SI value of one unit of the abscissa
    inputs: dict[str, float]  # value of each input for an abscissa of 1 in SI units
    amplitude: float  # default amplitude, in the unit of the abscissa
    opposite: bool = False  # True if the right wheel follows the left one with opposite sign


CASES = (
    LoadCase("bump", "travel of both wheels", "mm", 1e-3, {"kc_left": 1.0, "kc_right": 1.0, "kc_wheel": 1.0}, 50.0),
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
OF_TWO_WHEELS = ("roll", "lateral_parallel", "aligning_parallel")
"""Cases that a single wheel does not have: it has no roll, and its parallel loads are those of the other cases."""
STEER_ANGLE = 10.0
"""Default amplitude of a steering joint that rotates, deg."""
NEARLY_STRAIGHT = 1e5
"""Length of a swing arm, mm, and value of any measure, above which rounding governs the comparison of both sides."""
DISPLACEMENTS = ("x", "y", "z", "rx", "ry", "rz")
LOADS = ("fx", "fy", "fz", "mx", "my", "mz")


@dataclass(frozen=True)
class Compliance:
    """Compliance of the carriers with the springs free and the steering joint held."""

    sides: tuple[str, ...]  # sides of the wheels
    # centre, contact: shape (6 n, 6 n): displacements (m) and rotations (rad) along the ground axes, x forward, y to
    # the left, z up, by forces (N) and torques (N m), for the n wheels in turn: at their centres and at their contacts
    centre: np.ndarray
    contact: np.ndarray

    def as_dict(self) -> dict[str, object]:
        """Return the matrices for JSON with the names of their rows and columns."""
        return {
            "displacements": [f"{side}.{name}" for side in self.sides for name in DISPLACEMENTS],
            "loads": [f"{side}.{name}" for side in self.sides for name in LOADS],
            "unit": "m or rad per N or N m",
            "wheel_centre": self.centre.tolist(),
            "contact": self.contact.tolist(),
        }


def compliance_of(pose: Pose) -> Compliance:
    """Return the compliance matrices at a pose: the body is clamped and the pads are replaced by their forces."""
    changes = pose.tangent.released([pad(hub.wheel) for hub in pose.hubs])
    matrices = []
    for at_contact in (False, True):
        arms = [hub.contact - hub.centre if at_contact else np.zeros(3) for hub in pose.hubs]
        columns = []
        for hub, arm in zip(pose.hubs, arms, strict=True):
            for load in np.eye(6):
                force = pose.tangent.wrench(centre(hub.wheel), load[:3], load[3:], arm)
                x = changes.pushed(force)
                twists = [pose.twist(each, x) for each in pose.hubs]
                columns.append(
                    np.concatenate([[*twist.at(a), *twist.omega] for twist, a in zip(twists, arms, strict=True)])
                )
        matrices.append(np.array(columns).T)
    return Compliance(tuple(hub.wheel.side for hub in pose.hubs), *matrices)


@dataclass(frozen=True)
class Sweep:
    """Curves of one load case."""

    case: LoadCase
    abscissa: np.ndarray  # shape (n,): values in the unit of the case
    # characteristics of both wheels, as `stiffmbs.studies.suspension.characteristics` names them
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
    vehicle : Vehicle
        Numbers of the vehicle that anti-dive, anti-lift, anti-squat and Ackermann refer to.
    measures : dict of str to float
        Measures at the described heights, in the units of `UNITS`: of bump motion and steering, and those of roll.
    compliance : Compliance
        Compliance matrices at the described heights.
    sweeps : dict of str to Sweep
        Curves by load case.
    message : str
    angular : bool
        True if the steering joint rotates.
    """

    name: str
    axle: Axle
    vehicle: Vehicle
    measures: dict[str, float]
    compliance: Compliance
    sweeps: dict[str, Sweep] = field(default_factory=dict)
    message: str = ""
    angular: bool = False

    def unit(self, channel: str) -> str:
        """Return the unit of a measure such as ``left.toe``."""
        name = channel.split(".")[1]
        if name == "steering_ratio":
            return "" if self.angular else "mm/deg"
        return UNITS[name]

    def judged(self, targets: Mapping[str, str]) -> tuple[Target, ...]:
        """Return targets with the values of their measures (`stiffmbs.studies.targets`).

        ``toe`` is a measure at the described heights, ``bump.toe`` the slope of a curve there, of both sides of the axle.
        Raises InputError if there is no such measure, or the text of a target is no range.
        """
        found: dict[str, Metric] = {}
        for channel, value in self.measures.items():
            side, _, name = channel.partition(".")
            found.setdefault(name, Metric({}, self.unit(channel))).values[side] = value
        for case, sweep in self.sweeps.items():
            for channel in sweep.channels:
                side, _, name = channel.partition(".")
                unit = f"{self.unit(channel) or '1'}/{sweep.case.unit}"
                found.setdefault(f"{case}.{name}", Metric({}, unit)).values[side] = sweep.slope(channel)
        return judged(targets, found)

    def asymmetry(self) -> float:
        """Return the largest difference between left and right, relative to the largest value of the curve or 1.

        In cases of opposite signs the order of the right curve is reversed.
        """
        worst = 0.0
        for sweep in self.sweeps.values():
            order = slice(None, None, -1) if sweep.case.opposite else slice(None)
            for left in (each for each in sweep.channels if each.startswith("left.")):
                right = f"right.{left.removeprefix('left.')}"
                if right not in sweep.channels:
                    continue
                a, b = sweep.channels[left], sweep.channels[right][order]
                finite = np.isfinite(a) & np.isfinite(b) & (np.abs(a) < NEARLY_STRAIGHT)
                a, b = a[finite], b[finite]
                largest = max(1.0, float(np.max(np.abs(a), initial=0.0)))
                worst = max(worst, float(np.max(np.abs(a - b), initial=0.0)) / largest)
        return worst

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs kc --json``."""
        cases = {
            name: {
                "input": sweep.case.swept, "unit": sweep.case.unit, "values": sweep.abscissa.tolist(),
                "channels": {channel: _numbers(values) for channel, values in sweep.channels.items()},
                "slopes": {channel: _numbers(np.array([sweep.slope(channel)]))[0] for channel in sweep.channels},
            }
            for name, sweep in self.sweeps.items()
        }  # fmt: skip
        return {
            "scene": scene,
            "status": "done",
            "message": self.message,
            "asymmetry": self.asymmetry(),
            "vehicle": {
                "wheelbase": self.vehicle.wheelbase,
                "cg_height": self.vehicle.height,
                "brake_share": self.vehicle.brake_share,
                "drive_share": self.vehicle.drive_share,
                "assumed": list(self.vehicle.assumed),
            },
            "measures": {
                name: {"value": _numbers(np.array([value]))[0], "unit": self.unit(name)}
                for name, value in self.measures.items()
            },
            "compliance": self.compliance.as_dict(),
            "cases": cases,
        }


def kinematics_and_compliance(
    model: Runnable, axle: str = "front", points: int = 11, body: str | None = None, steering: str | None = None,
    wheels: Sequence[str] = (), radius: float | None = None, vehicle: VehicleOptions | None = None, **amplitudes: float,
) -> KinematicsAndCompliance:  # fmt: skip
    """Sweep an axle on a test rig by equilibria: wheel travel, roll, steering, and forces and torques on the wheels.

    The body is clamped as described, pads hold the contacts at their heights, and tyres, drivers and other axles are
    left out. All sweeps start at the heights of the described scene. The wheels roll on their pads. Measures follow from
    the velocities of the carriers at each equilibrium, for any kind of suspension.

    Parameters
    ----------
    model : Scene, str or Path
        Scene with suspensions ``front.left`` and ``front.right``, each with a body ``upright`` that has the markers
        ``spindle`` and ``patch``, or with a body ``front.axle`` that has those of both sides, as in the shipped parts;
        or with tyres on wheels that rotate in revolute joints.
    axle : str
        Prefix of ``.left`` and ``.right``; empty for suspensions ``left`` and ``right``. In scenes with other names,
        ``front`` or ``rear`` for the foremost or last tyres, or the beginning of the names of tyres or wheels.
    points : int
        Number of points of each curve, odd and at least 5.
    body, steering : str, optional
        Body to clamp, by default ``chassis`` or the one that carries the axle.  Prismatic or revolute joint that
        steers, by default the only prismatic ``guide`` of the axle.
    wheels : sequence of str
        Bodies of the wheels, instead of the search by `axle`.
    radius : float, optional
        Distance from the centres of the wheels to the road, m, where no marker ``patch`` gives it; by default the
        unloaded radius of the tyres.
    vehicle : VehicleOptions, optional
        Wheelbase, height of the centre of mass, and shares of braking and driving force.
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
    _check(points, amplitudes)
    refuse_text("wheels", wheels, "bodies")
    data = data_of(model)
    if data.dimensions != 3:
        raise InputError("found a scene in the plane, expected one in space")
    found = axle_of(data, axle, body, steering, wheels, radius)
    cases = [_case(case, found.angular) for case in CASES if _applies(case, found)]
    sizes = {case.name: amplitudes.get(case.name, case.amplitude) for case in cases}
    cases = [case for case in cases if sizes[case.name]]
    half = points // 2
    schedule = _schedule(cases, sizes, half) or [{}, {}]
    heights = {f"kc_{wheel.side}": float(wheel.contact[2]) for wheel in found.wheels}
    rig = on_rig(data, found, _tables(inputs_of(found), schedule, heights))
    setup = setup_of(rig, found, vehicle_of(data, found, vehicle or VehicleOptions()))
    points_of = [(case, k) for case in cases for k in range(2 * half + 2)]
    job = prepare(rig, start=0.0, duration=float(len(schedule) - 1), output=1.0)
    start: list[Hub] = []
    rows: list[dict[str, float]] = []
    moves, compliance, measures = 0, None, {}
    for t, rest in enumerate(equilibria_over_time(job, np.arange(float(len(schedule))))):
        case = points_of[t][0] if points_of else CASES[0]
        pose = Pose(setup, job.dynamics, float(t), _mode(case, found))
        moves += rest.moves
        if not t:
            start, compliance = pose.hubs, compliance_of(pose)
            measures = _at_start(pose, setup)
        rows.append(_measured(pose, start, case))
    assert compliance is not None
    message = f"{len(rows)} equilibria after {moves} moves"
    return KinematicsAndCompliance(
        data.name, found, setup.vehicle, measures, compliance, _sweeps(cases, sizes, half, rows), message, setup.angular
    )


def _check(points: object, amplitudes: Mapping[str, float]) -> None:
    """Refuse a number of points without a middle one, unknown load cases, and amplitudes that are not numbers."""
    if not isinstance(points, Integral) or points < 5 or points % 2 == 0:
        raise InputError(f"points: found {points}, expected an odd number, 5 or more")
    for name, amplitude in amplitudes.items():
        if name not in AMPLITUDES:
            near = did_you_mean(name, AMPLITUDES)
            raise InputError(f"{name}={amplitude!r}: found no such case{near}, expected {', '.join(AMPLITUDES)}")
        if not isinstance(amplitude, Real) or not 0 <= amplitude < np.inf:
            raise InputError(f"{name}: found {amplitude!r}, expected a number, zero or more, in the unit of the case")


def _sweeps(
    cases: Sequence[LoadCase], sizes: Mapping[str, float], half: int, rows: Sequence[Mapping[str, float]]
) -> dict[str, Sweep]:
    """Return the curves of the load cases; the equilibria of each go from its middle to the upper, then to the lower end."""
    found = {}
    for number, case in enumerate(cases):
        first = number * (2 * half + 2)
        order = [*range(first + 2 * half + 1, first + half + 1, -1), *range(first, first + half + 1)]
        channels = {name: np.array([rows[k].get(name, np.nan) for k in order]) for name in rows[first]}
        found[case.name] = Sweep(case, sizes[case.name] * np.linspace(-1, 1, 2 * half + 1), channels)
    return found


def _applies(case: LoadCase, axle: Axle) -> bool:
    """Return True if an axle has a load case."""
    if case.name == "steer":
        return axle.steering is not None
    return len(axle.wheels) == 2 or case.name not in OF_TWO_WHEELS


def _case(case: LoadCase, angular: bool) -> LoadCase:
    """Return a load case, with the unit of a steering joint that rotates."""
    if case.name != "steer" or not angular:
        return case
    return replace(case, swept="angle of the steering joint", unit="deg", scale=np.pi / 180, amplitude=STEER_ANGLE)


def _mode(case: LoadCase, axle: Axle) -> tuple[float, ...]:
    """Return the factors of the pads in the motion that a case measures."""
    return (1.0, -1.0) if case.name == "roll" else (1.0,) * len(axle.wheels)


def _measured(pose: Pose, start: list[Hub], case: LoadCase) -> dict[str, float]:
    """Return the measures of one equilibrium of a load case, by wheel and of the axle."""
    lifted = case.name in ("bump", "roll")
    found: dict[str, float] = {}
    for hub, first, load in zip(pose.hubs, start, pose.loads, strict=True):
        of_wheel = displacements(hub, first, load)
        if lifted:
            of_wheel |= of_travel(pose, hub)
        if pose.steered is not None and (lifted or case.name == "steer"):
            of_wheel |= of_steering_axis(pose, hub)
        found |= {f"{hub.wheel.side}.{name}": value for name, value in of_wheel.items()}
    if len(pose.hubs) == 2 and (lifted or case.name == "steer"):
        found |= {f"axle.{name}": value for name, value in of_axle(pose, lifted).items()}
    return found


def _at_start(pose: Pose, setup: Setup) -> dict[str, float]:
    """Return all measures of the first pose: of bump, of steering, and of the axle in roll."""
    bump, steer = (next(case for case in CASES if case.name == name) for name in ("bump", "steer"))
    bumped = pose if pose.mode == _mode(bump, setup.axle) else pose.with_mode(_mode(bump, setup.axle))
    found = _measured(bumped, bumped.hubs, bump)
    if pose.steered is not None:
        found = {**_measured(bumped, bumped.hubs, steer), **found}
    left_out = ("travel", "spin", "lateral", "longitudinal", "turning_radius", "ackermann", "roll_angle", "steer")
    return {name: value for name, value in found.items() if name.split(".")[1] not in left_out}


def _numbers(values: np.ndarray) -> list[float | None]:
    """Return numbers for JSON: None for those that are not finite."""
    return [float(value) if np.isfinite(value) else None for value in values]


def _schedule(cases: list[LoadCase], sizes: dict[str, float], half: int) -> list[dict[str, float]]:
    """Return the inputs at all instants: each case from zero to plus its amplitude, back, and to minus it."""
    parts = [*np.linspace(0, 1, half + 1), 0.0, *np.linspace(-1 / half, -1, half)]
    return [
        {name: part * sizes[case.name] * case.scale * each for name, each in case.inputs.items()}
        for case in cases
        for part in parts
    ]


def _tables(names: Sequence[str], schedule: list[dict[str, float]], heights: dict[str, float]) -> dict[str, Table]:
    return {
        name: Table(
            table=[(float(t), heights.get(name, 0.0) + inputs.get(name, 0.0)) for t, inputs in enumerate(schedule)],
            lines=True,
        )
        for name in names
    }
