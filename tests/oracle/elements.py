"""Elements of a scene's content as functions of poses and velocities, in ground axes; nothing is shared with the package."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from . import forces, joints
from .formulas import FUNCTIONS, LinearStates, compiled, value
from .geometry import Point, Poses, about_z, of_quaternion


class Unknown(Exception):
    """The scene has an element that is not here."""


@dataclass(frozen=True)
class State:
    """Poses, velocities of shape (bodies, 6) with those of the ground, and differential states."""

    poses: Poses
    u: np.ndarray
    s: np.ndarray


class Elements:
    """Bodies, states, joints and forces of a scene's content.  Raises `Unknown` if it has others."""

    def __init__(self, content):
        self.in_space = content.get("dimensions", 2) == 3
        self.names = [*content["bodies"], "ground"]
        self.index = {name: k for k, name in enumerate(self.names)}
        self.n = len(self.names) - 1
        own = range(6) if self.in_space else (0, 1, 5)
        self.columns = np.array([6 * k + c for k in range(self.n) for c in own])
        self.gravity = np.array([*content.get("gravity", ()), 0.0, 0.0, 0.0][:3], float)
        self._content = content
        self._bodies()
        self.parameters = {name: float(part) for name, part in content.get("parameters", {}).items()}
        self.inputs = {name: float(part) for name, part in content.get("inputs", {}).items()}
        self._states()
        self._joints()
        self._forces()

    def _bodies(self):
        bodies = [*self._content["bodies"].values(), {}]
        r, A, u, self.mass, self.inertia, self.centre = [], [], [], [], [], []
        for body in bodies:
            turn = np.eye(3)
            if "orientation" in body:
                turn = np.array(body["orientation"], float)
            elif "angle" in body:
                turn = about_z(body["angle"])
            centre = np.array(body.get("center_of_mass", np.zeros(3)), float)
            place = np.array([*body.get("position", ()), 0.0, 0.0, 0.0][:3], float)
            speed = np.array([*body.get("velocity", ()), 0.0, 0.0, 0.0][:3], float)
            omega = np.array(body.get("omega", np.zeros(3)), float)
            spin = turn @ omega if omega.ndim else np.array([0.0, 0.0, omega])
            moments = np.array(body.get("inertia", 1.0), float)
            r.append(place + turn @ centre)
            A.append(turn)
            u.append([*speed, *spin])
            self.centre.append(centre)
            self.mass.append(body.get("mass", 1.0))
            self.inertia.append(
                moments if moments.ndim == 2 else np.diag(moments) if moments.ndim else np.eye(3) * moments
            )
        self.start = State(Poses(np.array(r), np.array(A)), np.array(u), np.zeros(0))
        self.angles = [body.get("angle", 0.0) for body in bodies]

    def marker(self, given):
        """Return a marker of the scene; a body's name is its origin."""
        entry = {"body": given} if isinstance(given, str) else given
        body = self.index[entry["body"]]
        axes = np.eye(3)
        if "orientation" in entry:
            axes = of_quaternion(entry["orientation"])
        elif "angle" in entry:
            axes = about_z(entry["angle"])
        point = np.array([*entry.get("point", ()), 0.0, 0.0, 0.0][:3], float)
        return Point(body, point - self.centre[body], axes)

    def _states(self):
        self.linear, self.algebraic = [], {}
        for name, entry in self._content.get("states", {}).items():
            if "zero" in entry:
                self.algebraic[name] = compiled(entry["zero"])
            elif "update" in entry:
                raise Unknown("update")
            else:
                self.linear.append(LinearStates(name, entry))
        self.places = np.cumsum([0, *(len(each.a) for each in self.linear)])
        self.start = replace(self.start, s=np.concatenate([np.zeros(0), *(each.start for each in self.linear)]))

    def _joints(self):
        """Collect the rows: each joint's residual functions of (poses, t), its kinds of levels, and the drives of velocities."""
        self.rows: list[Any] = []
        self.joint_rows: dict[str, tuple[int, int]] = {}
        self.pairs: dict[str, Any] = {}
        coordinates: dict[str, Any] = {}
        self.driven_velocities = []
        for name, joint in self._content.get("joints", {}).items():
            kind, first = joint["type"], len(self.rows)
            if kind == "drive":
                self._drive(name, joint, coordinates)
            elif kind == "coupler":
                one, two = coordinates[joint["joint_1"]], coordinates[joint["joint_2"]]
                ratio = joint["scale"]
                offset = one[0](self.start.poses) - ratio * two[0](self.start.poses)
                self.rows.append(
                    lambda poses, t, one=one[0], two=two[0], ratio=ratio, offset=offset: [
                        one(poses) - ratio * two(poses) - offset
                    ]
                )
                self.pairs[name] = one[1], one[2]
            else:
                i, j = self.marker(joint["i"]), self.marker(joint["j"])
                try:
                    parts = joints.equations(kind, self.in_space, joint.get("length"))
                except KeyError:
                    raise Unknown(kind) from None
                self.rows += [lambda poses, t, part=part, i=i, j=j: part(i, j, poses) for part in parts]
                self.pairs[name] = i, j
                coordinates |= self._coordinates(name, kind, i, j)
            self.joint_rows[name] = (first, len(self.rows))

    def _coordinates(self, name, kind, i, j):
        sliding = 2 if self.in_space else 0
        begin = joints.angle(i, j, self.start.poses)
        turn = Point(j.body, j.point, j.axes @ about_z(begin))
        known = {
            "angle": lambda poses: begin + joints.angle(i, turn, poses),  # within half a turn of the start
            "displacement": lambda poses: joints.displacement(sliding, i, j, poses),
        }
        sorts = {"revolute": ("angle",), "prismatic": ("displacement",), "point_on_line": ("displacement",),
                 "cylindrical": ("displacement", "angle")}.get(kind, ())  # fmt: skip
        return {f"{name}.{sort}" if len(sorts) > 1 else name: (known[sort], i, j) for sort in sorts}

    def _drive(self, name, joint, coordinates):
        if "joint" in joint:
            coordinate, i, j = coordinates[joint["joint"]]
        else:
            body, axis = joint["coordinate"].split(".")
            k, component = self.index[body], "xyz".index(axis)
            i = j = Point(k, np.zeros(3), np.eye(3))
            coordinate = lambda poses, k=k, component=component: poses.r[k, component]  # noqa: E731
        self.pairs[name] = i, j
        if "position" in joint:
            law = compiled(joint["position"])
            self.rows.append(lambda poses, t: [coordinate(poses) - self._of_time(law, t)])
        else:
            law = compiled(joint["velocity"])
            self.driven_velocities.append((len(self.rows), law))
            self.rows.append(lambda poses, t: [coordinate(poses)])

    def _of_time(self, law, t):
        return value(law, {**FUNCTIONS, **self.parameters, **self.inputs, "t": t})

    def _forces(self):
        self.wrenches = []
        for force in self._content.get("forces", {}).values():
            i = self.marker(force["i"])
            j = self.marker(force["j"]) if "j" in force else None
            made = getattr(self, f"_{force['type']}", None)
            if made is None:
                raise Unknown(force["type"])
            self.wrenches.append(made(force, i, j))

    def _force(self, force, i, j):
        laws = [compiled(law) for law in force["force"]]
        frame = self.marker(force["frame"]) if "frame" in force else i if force.get("axes") == "body" else None

        def wrench(poses, u, values):
            vector = np.array([*(value(law, values) for law in laws), 0.0][:3])
            vector = vector if frame is None else frame.turned(poses) @ vector
            return forces.at_one_place(i, j, vector, np.zeros(3), poses)

        return wrench

    def _torque(self, force, i, j):
        given = force["torque"]
        laws = [compiled(law) for law in (given if self.in_space else [0.0, 0.0, given])]
        frame = self.marker(force["frame"]) if "frame" in force else i if force.get("axes") == "body" else None

        def wrench(poses, u, values):
            vector = np.array([value(law, values) for law in laws])
            vector = vector if frame is None else frame.turned(poses) @ vector
            return forces.at_one_place(i, j, np.zeros(3), vector, poses)

        return wrench

    def _line_force(self, force, i, j):
        law = compiled(force["force"])
        return lambda poses, u, values: forces.line(i, j, lambda *_: -value(law, values), poses, u)

    def _spring_damper(self, force, i, j):
        k, c, free, preload = (force.get(key, 0.0) for key in ("stiffness", "damping", "free_length", "preload"))
        laws = {key: _law(force.get(key)) for key in ("spring_law", "damper_law")}

        def pull(length, rate):
            s = length - free
            return k * s + c * rate + preload + laws["spring_law"](s) + laws["damper_law"](rate)

        return lambda poses, u, values: forces.line(i, j, pull, poses, u)

    def _torsion_spring(self, force, i, j):
        k, c, free = (force.get(key, 0.0) for key in ("stiffness", "damping", "free_angle"))
        laws = {key: _law(force.get(key)) for key in ("spring_law", "damper_law")}
        begin = joints.angle(i, j, self.start.poses)
        if not self.in_space:
            begin = self._drawn_angles(force)
        turn = Point(j.body, j.point, j.axes @ about_z(begin))

        def wrench(poses, u, values):
            z = j.turned(poses)[:, 2]
            angle, rate = begin + joints.angle(i, turn, poses), z @ (u[i.body, 3:] - u[j.body, 3:])
            s = angle - free
            moment = -(k * s + c * rate + laws["spring_law"](s) + laws["damper_law"](rate))
            return forces.at_one_place(i, j, np.zeros(3), moment * z, poses)

        return wrench

    def _drawn_angles(self, force):
        def angle(given):
            entry = {"body": given} if isinstance(given, str) else given
            return self.angles[self.index[entry["body"]]] + entry.get("angle", 0.0)

        return angle(force["i"]) - angle(force["j"])

    def _bushing(self, force, i, j):
        six = list(range(6)) if self.in_space else [0, 1, 5]
        if {"law_x", "law_y"} & force.keys():
            raise Unknown("law of a bushing")
        matrices = []
        for key in ("stiffness", "damping"):
            given = np.array(force[key], float)
            matrix = np.zeros((6, 6))
            matrix[np.ix_(six, six)] = given if given.ndim == 2 else np.diag(given)
            matrices.append(matrix)
        preload = np.zeros(6)
        preload[six] = force.get("preload", 0.0)
        in_ground = force.get("axes") == "ground"
        return lambda poses, u, values: forces.bushing(
            i, j, matrices[0], matrices[1], preload, in_ground, self.in_space, poses, u
        )


def _law(law):
    """Return the function of a law of deflection s or rate v."""
    if law is None:
        return lambda x: 0.0
    if not isinstance(law, str):
        raise Unknown("table")
    code = compiled(law)
    return lambda x: value(code, {**FUNCTIONS, "s": x, "v": x})
