"""Car of a scene for handling tests: its body, wheels and steering, and the scene with a manoeuvre attached."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...elements.spatial.forces.wheel_torque import WheelTorque
from ...elements.spatial.marker import Point
from ...elements.spatial.orientation import IDENTITY, conjugate, rotated
from ...errors import InputError
from ...model.files.effective import chosen_options
from ...model.files.expand import unshared
from ...model.parts.changes import set_later, set_now
from ...model.parts.placing import placed_in_use
from ...model.read_scene import made_scene
from ...model.scene import Scene
from ...model.vehicle import Vehicle
from ...model.wheels import Wheel, angular_of_joints, centre_of_mass, corners, wheels_of
from ...reading.did_you_mean import did_you_mean
from ...reading.files.yaml_text import Content, read_yaml

DRIVER = "handling_driver"
STEER = "handling_steer"
ROAD = "handling_road"
SPINNING = "handling_spinning"
OF_A_STEERING_WHEEL = {"per_curvature": "m", "understeer": "s^2/m", "largest": "rad", "fastest": "rad/s"}
"""Units of the driver's parameters that concern a joint with an angle; those of the part are of a rack."""
STEERING_JOINTS = ("steering_wheel", "guide")
"""Last names of joints that steer: a steering wheel, and the rack of a car."""
MISPLACED = 0.01
"""Largest angle of the heading to x, rad, and distance of the wheels' centre from the x axis in wheelbases, at the start."""


@dataclass(frozen=True)
class Car:
    """Car of a scene."""

    body: str  # sprung body
    vehicle: Vehicle | None  # section ``vehicle`` of that body
    wheels: Mapping[str, Wheel]  # by corner: ``front_left`` ... ``rear_right``
    # bodies that spin with the speed of the car: wheels, shafts on which a `wheel_torque` acts, and those of the
    # scene's own start
    rolling: tuple[str, ...]
    steering: str  # joint that steers
    steered: tuple[str, ...]  # that joint, and the steering wheel or rack that turns with it
    angular: bool  # True if its coordinate is an angle
    # wheelbase, track: m; the track is the mean of both axles
    wheelbase: float
    track: float
    radius: float  # mean height of the wheels' centres, m
    # middle, centre, measured: centre of the four wheels, centre of mass of the car, and reference point at which the
    # channels of the vehicle are measured, in the described pose, ground axes, m
    middle: Point
    centre: Point
    measured: Point
    # reference, frame: the reference point, and the origin of the driver's frame, which is at the centre of mass and
    # halfway between left and right wheels, in the axes of the sprung body, m
    reference: Point
    frame: Point
    point_given: bool  # True if the section `vehicle` has a `point`

    def behind(self, place: Point) -> float:
        """Return the distance from a place back to the rear axle, m."""
        return place[0] - self.middle[0] + self.wheelbase / 2


def car_of(scene: Scene, body: str | None = None, steering: str | None = None) -> Car:
    """Return the car of a scene.

    `scene`: with four tyres, each on a wheel that a revolute joint holds. `body`: sprung body; by default that of the
    section ``vehicle``, or ``chassis``. `steering`: joint that steers; by default the revolute joint
    ``steering_wheel``, or the prismatic joint ``guide``. Raises InputError if a part is missing.
    """
    if scene.dimensions != 3:
        raise InputError("found a scene in the plane, expected a car in space")
    vehicle = getattr(scene, "vehicle", None)
    body = body or (vehicle.body if vehicle else "chassis")
    vehicle = vehicle if vehicle and vehicle.body == body else None
    if body not in scene.bodies:
        near = did_you_mean(body, scene.bodies)
        raise InputError(
            f"found no body '{body}'{near}, expected the sprung body: vehicle: {{body: NAME}}, or --body NAME"
        )
    wheels = corners(wheels_of(scene))
    for wheel in wheels.values():
        if not wheel.hubs:
            raise InputError(f"found no revolute joint of the wheel '{wheel.body}', expected one as its bearing")
    _check_place(body, [*wheels.values()])
    at = {corner: wheel.centre for corner, wheel in wheels.items()}
    middle, centre, own = np.mean([*at.values()], axis=0), centre_of_mass(scene, body), scene.bodies[body]

    def on_body(place: np.ndarray) -> Point:
        """Return a place in ground axes as a point in the axes of the sprung body."""
        return _point(rotated(conjugate(own.orientation), place - np.array(own.position)))

    point_given = vehicle is not None and "point" in vehicle.model_fields_set
    reference = vehicle.point if vehicle is not None and point_given else on_body(centre)
    measured = np.array(own.position) + rotated(own.orientation, reference)
    joint = _steering(scene, steering)
    return Car(
        body, vehicle, wheels, _rolling(scene, (wheel.body for wheel in wheels.values())), joint,
        tuple(dict.fromkeys([joint, *_steering_joints(scene)])), angular_of_joints(scene)[joint],
        float((at["front_left"] + at["front_right"] - at["rear_left"] - at["rear_right"])[0] / 2),
        float((at["front_left"] - at["front_right"] + at["rear_left"] - at["rear_right"])[1] / 2),
        float(middle[2]), _point(middle), _point(centre), _point(measured), reference,
        on_body(np.array([centre[0], middle[1], centre[2]])), point_given,
    )  # fmt: skip


def _point(place: np.ndarray) -> Point:
    x, y, z = map(float, place)
    return x, y, z


def _check_place(body: str, wheels: Sequence[Wheel]) -> None:
    """Refuse a car that does not stand where courses begin: at the origin, with its heading along x."""
    places = [wheel.centre for wheel in wheels]
    left = np.mean([wheel.axis for wheel in wheels], axis=0)
    x, y, _ = np.mean(places, axis=0)
    length = np.ptp(places, axis=0).max()
    heading = float(np.arctan2(-left[0], left[1])) + 0.0
    if abs(heading) > MISPLACED or abs(y) > MISPLACED * length or abs(x) > length:
        raise InputError(
            f"found the wheels of '{body}' about x = {x:.3g} m, y = {y:.3g} m, with a heading of {np.degrees(heading):.3g} deg from x, "
            "expected them about the origin, within a wheelbase along x, and a heading along x: courses begin there"
        )


def _rolling(scene: Scene, wheels: Iterable[str]) -> tuple[str, ...]:
    """Return wheels, shafts of a driveline and the scene's own rolling bodies, each once."""
    shafts = (force.i.body for force in scene.forces.values() if isinstance(force, WheelTorque))
    return tuple(dict.fromkeys([*wheels, *shafts, *getattr(scene.start, "rolling", ())]))


def _steering_joints(scene: Scene) -> Iterator[str]:
    """Yield the steering wheel and the rack by their names, if a scene has one of each name only."""
    for last in STEERING_JOINTS:
        found = [name for name in angular_of_joints(scene) if name.rpartition(".")[2] == last]
        if len(found) == 1:
            yield found[0]


def _steering(scene: Scene, given: str | None) -> str:
    known = angular_of_joints(scene)
    if given is not None:
        if given not in known:
            near = did_you_mean(given, known)
            raise InputError(f"found no prismatic or revolute joint '{given}'{near}, expected the joint that steers")
        return given
    for name in _steering_joints(scene):
        return name
    raise InputError(
        "found no single joint named steering_wheel or guide, expected the joint that steers: --steering JOINT"
    )


@dataclass(frozen=True)
class Manoeuvre:
    """Manoeuvre that a test attaches to a car."""

    speed: float  # at the start, m/s
    duration: float  # s
    steer: str = ""  # formula of time for the steering joint; empty if the driver keeps a path
    driver: Mapping[str, object] | None = None  # parameters of the driver
    path: Content | None = None  # section ``path``, which the driver keeps
    road: Mapping[str, object] | None = None
    # sideslip of the rear axle and roll, root of the sum of squares, at which the run ends, rad
    spun: float | None = None
    output: float = 0.01  # s


def with_manoeuvre(scene: Scene, car: Car, manoeuvre: Manoeuvre) -> Scene:
    """Return the scene of a car with a manoeuvre in place of its own driver, steering, roads, start and stages.

    Raises InputError if the scene was built in Python, or the manoeuvre does not fit it.
    """
    kept = scene.written
    if kept is None:
        raise InputError("found a scene built in Python, expected one that was read from a file or a text")
    content, chosen, changes = chosen_options(unshared(kept.content), kept.changes, kept.source)
    content, changes = placed_in_use(content, changes)
    others = list(_set_parts_and_run(content, changes))
    removed = _strip(content, car)
    left = [(path, value) for path, value in others if not f"{path}.".startswith(removed)]
    _attach(content, car, manoeuvre)
    words = {name: word for name, word in chosen["words"].items() if word is not None}
    content |= {"choose": words, "options": {name: {word: {}} for name, word in words.items()}} if words else {}
    return made_scene(content, left, kept.source, lambda _: None, kept.folder)


def _set_parts_and_run(content: Content, changes: Iterable[tuple[str, object]]) -> Iterator[tuple[str, object]]:
    """Set changed values of parts and of the run, which a manoeuvre changes further; yield the other changes.

    Parameters that changes add are set, too: they may be of parts alone.
    """
    for path, value in changes:
        section, _, name = path.partition(".")
        added = section == "parameters" and name not in (content.get("parameters") or {})
        if added or (section in ("use", "run") and not set_later(path, content)):
            set_now(content, path, read_yaml(value, f"--set {path}") if isinstance(value, str) else value)
        else:
            yield path, value


def _strip(content: Content, car: Car) -> tuple[str, ...]:
    """Remove what a manoeuvre replaces; return the beginnings of the paths of changes that concern it."""
    replaced = ["figure", "stages", "at_start", "path", "start", "requests", *(() if car.vehicle else ("vehicle",))]
    gone = [f"{section}." for section in replaced]
    for section in replaced:
        content.pop(section, None)
    use = content.get("use") or {}
    for name in [name for name, entry in use.items() if isinstance(entry, dict) and entry.get("part") == "driver"]:
        content.setdefault("_driver", {**use.pop(name), "name": name})
    joints = content.get("joints") or {}
    for name in [
        name for name, entry in joints.items() if isinstance(entry, dict) and entry.get("joint") in car.steered
    ]:
        del joints[name]
        gone.append(f"joints.{name}.")
    held = [str(entry.get("joint")) for entry in joints.values() if isinstance(entry, dict)]
    if car.angular and (racks := [joint for joint in held if joint.rpartition(".")[2] in STEERING_JOINTS]):
        raise InputError(
            f"found drives of {', '.join(racks)} in a car that is steered by {car.steering}, and several joints of these "
            "names, expected none that holds its rack"
        )
    _set_roads(content)
    return tuple(gone)


def _set_roads(content: object) -> None:
    """Replace the roads of all tyres, also in definitions of parts."""
    if isinstance(content, dict):
        if str(content.get("type", "")).endswith("tyre"):
            content["road"] = ROAD
        for value in content.values():
            _set_roads(value)
    elif isinstance(content, list):
        for value in content:
            _set_roads(value)


OF_ANOTHER_MANOEUVRE = ("acceleration", "accelerates", "steers", "releases", "brakes", "holds", "path_start")
"""Parameters of the scene's own driver that belong to its own manoeuvre."""
OF_A_PRESSED_PEDAL = ("presses", "pressing", "force")


def _brake_by(driver: dict[str, object], use: Mapping[str, object], content: Content) -> None:
    """Let the driver press the pedal of a part `brakes`, if the car has one."""
    for entry in use.values():
        if isinstance(entry, dict) and entry.get("part") == "brakes":
            kept = {
                key: value for key, value in (entry.get("parameters") or {}).items() if key not in OF_A_PRESSED_PEDAL
            }
            entry.update(pedal="formula", parameters=kept)
            driver["braking"] = "system"
            content["variables"] = {**(content.get("variables") or {}), "braking": f"{DRIVER}.braking_force"}


def _renamed(formula: object, old: str) -> object:
    """Return a formula that reads channels of the manoeuvre's driver in place of those of the scene's own."""
    return re.sub(rf"(?<![\w.]){re.escape(old)}\.", f"{DRIVER}.", formula) if isinstance(formula, str) else formula


def _attach(content: Content, car: Car, manoeuvre: Manoeuvre) -> None:
    own = content.pop("_driver", None) or {}
    if own:
        formulas = content.get("variables") or {}
        content["variables"] = {name: _renamed(formula, own["name"]) for name, formula in formulas.items()}
    mounts = {
        **(own.get("mounts") or {}), **{corner: wheel.body for corner, wheel in car.wheels.items()},
        **{f"{corner}_upright": wheel.carrier for corner, wheel in car.wheels.items()},
    }  # fmt: skip
    parameters = {
        **{name: x for name, x in (own.get("parameters") or {}).items() if name not in OF_ANOTHER_MANOEUVRE},
        "target": manoeuvre.speed, "begins": -1, "radius": car.radius, "rear": car.behind(car.centre),
        "largest": 10.0 if car.angular else 0.12, "fastest": 20.0 if car.angular else 0.6, **(manoeuvre.driver or {}),
    }  # fmt: skip
    if car.angular:
        parameters |= {
            name: f"{float(parameters[name])!r} {unit}"
            for name, unit in OF_A_STEERING_WHEEL.items()
            if isinstance(parameters.get(name), int | float)
        }
    driver = {
        "part": "driver", "on": car.body, "position": list(car.frame),
        "orientation": list(car.vehicle.orientation if car.vehicle else IDENTITY),
        "drive": own.get("drive", "rear"), "mounts": {**mounts, "steering": car.steering}, "parameters": parameters,
        "path": "course" if manoeuvre.path else "none", "pace": "given",
    }  # fmt: skip
    use = content.get("use") or {}
    _brake_by(driver, use, content)
    content["use"] = {**use, DRIVER: driver}
    content["roads"] = {**(content.get("roads") or {}), ROAD: dict(manoeuvre.road or {"type": "flat"})}
    vehicle = {key: value for key, value in (content.get("vehicle") or {}).items() if key != "steering"}
    content["vehicle"] = {"body": car.body, **vehicle, "point": list(car.reference)}
    content["requests"] = {STEER + "_seen": f"{car.steering}.{'angle' if car.angular else 'displacement'}"}
    if manoeuvre.spun:
        at_rear = f"vehicle.sideslip - ({car.behind(car.measured)!r})*vehicle.yaw_rate/vehicle.speed"
        content["requests"] |= {SPINNING: f"sqrt(({at_rear})^2 + vehicle.roll^2)"}
        content["stages"] = [{"until": {"spun": {"request": SPINNING, "at_least": manoeuvre.spun}}}]
    if manoeuvre.path:
        content["path"] = dict(manoeuvre.path)
    else:
        drive = {"type": "drive", "joint": car.steering, "position": manoeuvre.steer or "0"}
        content["joints"] = {**(content.get("joints") or {}), STEER: drive}
    content["start"] = {"velocity": [manoeuvre.speed, 0, 0], "speed": "found", "rolling": list(car.rolling)}
    kept = {key: value for key, value in (content.get("run") or {}).items() if key in ("solver", "rtol", "atol")}
    content["run"] = {
        "rtol": 1e-4,
        "solver": "auto",
        **kept,
        "duration": manoeuvre.duration,
        "output": manoeuvre.output,
    }
