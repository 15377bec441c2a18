"""Random mechanisms twice: as the text of a dataset as Adams/View writes it, and as parts of `adams_oracle`.

A tree of parts, each hung on one before it or on ground by a joint of a random kind, crooked in every way that the
format allows: own axes of parts, a turned centre marker, inertia about another marker with products, velocities in
the axes of markers, joint markers that are displaced and turned as far as the joint is free, I and J swapped, units.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...minimal_coordinates import turned
from . import adams_joints as joints
from .adams_oracle import Marker, Mechanism, Part

GROUND = 1
SYSTEMS = [  # text, and units of length, mass, force in SI
    ("FORCE = NEWTON\n, MASS = KILOGRAM\n, LENGTH = METER\n, TIME = SECOND", 1.0, 1.0, 1.0),
    ("FORCE = NEWTON\n, MASS = KILOGRAM\n, LENGTH = MILLIMETER\n, TIME = SECOND", 1e-3, 1.0, 1.0),
    ("FORCE = POUND_FORCE\n, MASS = POUND_MASS\n, LENGTH = INCH\n, TIME = SECOND", 0.0254, 0.45359237, 4.4482216152605),
    ("FORCE = NEWTON\n, MASS = TONNE\n, LENGTH = MILLIMETER\n, TIME = SECOND", 1e-3, 1e3, 1.0),
    ("FORCE = DYNE\n, MASS = GRAM\n, LENGTH = CENTIMETER\n, TIME = SECOND", 1e-2, 1e-3, 1e-5),
]
KINDS = {  # equations between I and J; whether the pair may slide along z, in z's plane, anywhere; turn about z, any way
    "REVOLUTE": (joints.revolute, "", "z"),
    "TRANSLATIONAL": (joints.translational, "z", ""),
    "CYLINDRICAL": (joints.cylindrical, "z", "z"),
    "SPHERICAL": (joints.atpoint, "", "any"),
    "PLANAR": (joints.planar, "xy", "z"),
    "UNIVERSAL": (joints.universal, "", "universal"),
    "HOOKE": (joints.hooke, "", "hooke"),
    "CONVEL": (joints.convel, "", "convel"),
    "FIXED": (joints.fixed, "", ""),
    "ATPOINT": (joints.atpoint, "", "any"),
    "INLINE": (joints.inline, "z", "any"),
    "INPLANE": (joints.inplane, "xy", "any"),
    "ORIENTATION": (joints.orientation, "xyz", ""),
    "PARALLEL_AXES": (joints.parallel, "xyz", "z"),
    "PERPENDICULAR": (joints.perpendicular, "xyz", "universal"),
}
PRIMITIVES = ("ATPOINT", "INLINE", "INPLANE", "ORIENTATION", "PARALLEL_AXES", "PERPENDICULAR")


@dataclass
class Body:
    """A part as drawn: its own frame, its centre marker and inertia, velocities of its centre, all in ground axes."""

    origin: np.ndarray
    axes: np.ndarray
    center: np.ndarray
    own: np.ndarray
    mass: float
    inertia: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


@dataclass
class Trial:
    """A dataset's text, the mechanism, and what to compare.

    Attributes
    ----------
    reactions : dict of str to Marker
        Marker I of every joint by its channels' name.
    markers : dict of int to Marker
    """

    seed: int
    rng: np.random.Generator = field(init=False)
    lines: list = field(default_factory=list)
    bodies: list = field(default_factory=list)
    equations: dict = field(default_factory=dict)
    reactions: dict = field(default_factory=dict)
    forces: list = field(default_factory=list)
    markers: dict = field(default_factory=dict)
    kinds: list = field(default_factory=list)
    asked: dict = field(default_factory=dict)

    def __post_init__(self):
        self.rng = np.random.default_rng(self.seed)
        self.units, self.length, self.mass, self.force = SYSTEMS[self.rng.integers(len(SYSTEMS))]

    # how it is written

    def statement(self, head, *arguments):
        self.lines.append("\n, ".join([head, *arguments]) + "\n!")

    def numbers(self, values, unit=1.0):
        return ", ".join(f"{value / unit:.16g}" for value in np.atleast_1d(values))

    def angles(self, axes):
        """REULER of axes: degrees or radians."""
        theta = np.arccos(np.clip(axes[2, 2], -1, 1))
        psi, phi = np.arctan2(axes[0, 2], -axes[1, 2]), np.arctan2(axes[2, 0], axes[2, 1])
        if self.rng.random() < 0.5:
            return ", ".join(f"{np.degrees(angle):.16g}D" for angle in (psi, theta, phi))
        return self.numbers([psi, theta, phi])

    def marker(self, part, place, axes):
        """A new marker at a place with axes, both in ground axes; its number."""
        ident = len(self.markers) + 11
        self.markers[ident] = Marker(part, place, axes)
        origin, frame = (np.zeros(3), np.eye(3)) if part < 0 else (self.bodies[part].origin, self.bodies[part].axes)
        at, turn = frame.T @ (place - origin), frame.T @ axes
        written = [f"PART = {part + 2}", f"QP = {self.numbers(at, self.length)}"]
        if self.rng.random() < 0.5:
            written.append(f"REULER = {self.angles(turn)}")
        else:
            far = self.length * 3
            written += [
                f"ZP = {self.numbers(at + far * turn[:, 2], self.length)}",
                f"XP = {self.numbers(at + far * turn[:, 0] + 0.7 * far * turn[:, 2], self.length)}",
            ]
        self.lines.append(f"!                        adams_view_name='MARKER_{ident}'")
        self.statement(f"MARKER/{ident}", *written)
        return ident

    def turn(self):
        q = self.rng.normal(size=4)
        q /= np.linalg.norm(q)
        angle = 2 * np.arccos(q[0])
        return turned(q[1:] / np.sin(angle / 2), angle)

    # what it is

    def moving(self, part, place):
        """Velocity of a part's point and its spin, in ground axes."""
        if part < 0:
            return np.zeros(3), np.zeros(3)
        body = self.bodies[part]
        return body.velocity + np.cross(body.spin, place - body.center), body.spin

    def body(self, kind, on):
        """A further part, hung on part `on` by a joint of a kind."""
        rng = self.rng
        equations, slides, turns = KINDS[kind]
        swapped = rng.random() < 0.5
        place, seat = rng.uniform(-0.6, 0.6, 3), self.turn()
        gap = np.array([rng.uniform(-0.3, 0.3) * (name in slides) for name in "xyz"])
        relative = self.relative(turns)
        own_place, own = place + seat @ gap, seat @ relative  # what is I in the equations is at the end of the gap
        # the new part carries the far end, or the near one
        new_place, new = (place, seat) if swapped else (own_place, own)
        old_place, old = (own_place, own) if swapped else (place, seat)
        rate, spin = self.rates(slides, turns, seat, own)
        if swapped:
            base, turning = self.moving(on, old_place)
            w = turning - spin
            v = base - rate - np.cross(w, old_place - new_place)
        else:
            base, turning = self.moving(on, old_place)
            w = turning + spin
            v = base + rate + np.cross(turning, new_place - old_place)
        center = new_place + rng.uniform(-0.4, 0.4, 3)
        velocity = v + np.cross(w, center - new_place)
        k = len(self.bodies)
        self.bodies.append(self.random_part(center, velocity, w))
        self.written_part(k)
        i, j = (self.marker(on, old_place, old), self.marker(k, new_place, new)) if swapped else (
            self.marker(k, new_place, new), self.marker(on, old_place, old))  # fmt: skip
        keyword = "JPRIM" if kind in PRIMITIVES else "JOINT"
        number = k + 1
        self.lines.append(f"!                        adams_view_name='{kind.lower()}_{number}'")
        self.statement(f"{keyword}/{number}", kind, f"I = {i}", f"J = {j}")
        self.equations[f"{keyword}_{number}"] = equations(self.markers[i], self.markers[j])
        self.reactions[f"{keyword}_{number}"] = self.markers[i]
        self.kinds.append((kind, number, i, j))
        if kind in ("REVOLUTE", "TRANSLATIONAL") and rng.random() < 0.5:
            self.motor(number, kind, i, j, float(seat[:, 2] @ (spin if kind == "REVOLUTE" else rate)))

    def motor(self, number, kind, i, j, speed):
        """A joint's motion by its velocity or acceleration, from the speed that its parts start with."""
        unit, measure = (1.0, joints.twist) if kind == "REVOLUTE" else (self.length, joints.slide)
        size, rate = self.rng.uniform(0.2, 1.0), self.rng.uniform(2, 6)
        if self.rng.random() < 0.5:
            law = ("VELOCITY", f"FUNCTION = {speed / unit:.16g}", f"+ {size / unit:.16g}*SIN({rate:.16g}*TIME)")
        else:
            law = (
                "ACCELERATION",
                f"ICVEL = {speed / unit:.16g}",
                f"FUNCTION = {size * rate / unit:.16g}*COS({rate:.16g}*TIME)",
            )
        law = law if law[0] == "ACCELERATION" else (law[0], f"{law[1]} {law[2]}")
        self.statement(f"MOTION/{number}", f"JOINT = {number}", *law)
        ends = self.markers[i], self.markers[j]
        self.equations[f"MOTION_{number}"] = joints.driven(measure, *ends, lambda t: size * rate * np.cos(rate * t))
        self.reactions[f"MOTION_{number}"] = ends[0]

    def relative(self, turns):
        """Axes of I in those of J, as far as the joint leaves them free."""
        rng = self.rng
        about = turned((0, 0, 1), rng.uniform(-3, 3))
        if turns == "z":
            return about
        if turns == "any":
            return self.turn()
        if turns == "universal":  # z axes across each other
            return about @ turned((1, 0, 0), np.pi / 2) @ turned((0, 0, 1), rng.uniform(-3, 3))
        if turns == "hooke":  # x of I across y of J
            return turned((0, 1, 0), rng.uniform(-0.8, 0.8)) @ turned((1, 0, 0), rng.uniform(-0.8, 0.8))
        if turns == "convel":  # z axes away from the centre, x axes parallel
            return turned((1, 0, 0), np.pi - rng.uniform(0.2, 0.7))
        return np.eye(3)

    def rates(self, slides, turns, seat, own):
        """Relative velocity and spin of I against J that the joint leaves free, in ground axes."""
        rng = self.rng
        rate = seat @ [rng.uniform(-1, 1) * (name in slides) for name in "xyz"]
        spin = np.zeros(3)
        if turns == "z":
            spin = rng.uniform(-3, 3) * seat[:, 2]
        elif turns == "any":
            spin = rng.uniform(-2, 2, 3)
        elif turns == "universal":
            spin = rng.uniform(-2, 2) * seat[:, 2] + rng.uniform(-2, 2) * own[:, 2]
        elif turns == "hooke":
            spin = rng.uniform(-2, 2) * seat[:, 1] + rng.uniform(-2, 2) * own[:, 0]
        return rate, spin

    def random_part(self, center, velocity, spin):
        rng = self.rng
        axes, own = self.turn(), self.turn()
        moments = rng.uniform(0.02, 0.1) * (1 + rng.uniform(0, 0.4, 3))
        principal = self.turn()
        return Body(center + rng.uniform(-0.5, 0.5, 3), axes, center, own, rng.uniform(0.5, 3),
                    principal @ np.diag(moments) @ principal.T, velocity, spin)  # fmt: skip

    def written_part(self, k):
        body, rng, number = self.bodies[k], self.rng, k + 2
        cm = len(self.markers) + 11
        im, other = cm + 1, cm + 2
        about = cm if rng.random() < 0.4 else im
        wm = rng.choice([0, cm, other])
        vm = rng.choice([0, other])
        frames = {cm: (body.center, body.own), im: (body.center + rng.uniform(-0.2, 0.2, 3), self.turn()),
                  other: (body.center + rng.uniform(-0.2, 0.2, 3), self.turn())}  # fmt: skip
        at, turn = frames[about]
        d = at - body.center
        tensor = turn.T @ (body.inertia + body.mass * (d @ d * np.eye(3) - np.outer(d, d))) @ turn
        moments = [*np.diag(tensor), -tensor[0, 1], -tensor[0, 2], -tensor[1, 2]]
        spin = (body.own if not wm else frames[wm][1]).T @ body.spin
        velocity = (np.eye(3) if not vm else frames[vm][1]).T @ body.velocity
        written = [f"QG = {self.numbers(body.origin, self.length)}"]
        if rng.random() < 0.6:
            written.append(f"REULER = {self.angles(body.axes)}")
        else:
            far = 5 * self.length
            written += [f"ZG = {self.numbers(body.origin + far * body.axes[:, 2], self.length)}",
                        f"XG = {self.numbers(body.origin + far * body.axes[:, 0], self.length)}"]  # fmt: skip
        for name, value in zip(("VX", "VY", "VZ"), velocity, strict=True):
            written.append(f"{name} = {self.numbers(value, self.length)}")
        written += [f"VM = {vm}"] if vm else []
        for name, value in zip(("WX", "WY", "WZ"), spin, strict=True):
            written.append(f"{name} = {np.degrees(value):.16g}D" if rng.random() < 0.5 else f"{name} = {value:.16g}")
        written += [f"WM = {wm}"] if wm else []
        written += [f"MASS = {self.numbers(body.mass, self.mass)}", f"CM = {cm}"]
        written += [f"IM = {im}"] if about == im else []
        written.append(f"IP = {self.numbers(moments[:3], self.mass * self.length**2)}")
        written.append(f"{self.numbers(moments[3:], self.mass * self.length**2)}\n, MATERIAL = .MODEL_1.steel")
        self.lines.append(f"!                        adams_view_name='PART_{number}'")
        self.statement(f"PART/{number}", *written)
        for place, frame in frames.values():
            self.marker(k, place, frame)

    # what acts

    def pick(self, *others):
        """A marker on another part than those of others, and apart from them."""
        taken = [self.markers[other] for other in others]
        free = [
            ident
            for ident, marker in self.markers.items()
            if all(marker.part != m.part and np.linalg.norm(marker.place - m.place) > 0.2 for m in taken)
        ]
        return int(self.rng.choice(free))

    def any_force(self, number):
        """A strut, a torque about z of J, or a vector force in the axes of RM."""
        i = self.pick(next(k for k, m in self.markers.items() if m.part < 0))
        j = self.pick(i)
        I, J = self.markers[i], self.markers[j]
        sort = self.rng.integers(3)
        if sort == 0:
            stiffness, rest, damping = self.rng.uniform(5, 40), self.rng.uniform(0.2, 0.6), self.rng.uniform(0, 2)
            k, c, x = stiffness * self.length / self.force, damping * self.length / self.force, rest / self.length
            self.statement(f"SFORCE/{number}", "TRANSLATIONAL", f"I = {i}", f"J = {j}",
                           f"FUNCTION = -{k:.16g}*(DM({i}, {j}) - {x:.16g})", f"-{c:.16g}*VR({i}, {j})")  # fmt: skip

            def act(view):
                gap = view.point(I) - view.point(J)
                long = gap.length()
                force = (-stiffness * (long.value - rest) - damping * long.rate) * gap.value / long.value
                view.push(I, view.point(I).value, force)
                view.push(J, view.point(J).value, -force)
        elif sort == 1:
            size, rate = self.rng.uniform(0.1, 0.6), self.rng.uniform(2, 6)
            damping = self.rng.uniform(0, 0.1)
            unit = self.force * self.length
            self.statement(f"SFORCE/{number}", "ROTATIONAL", f"I = {i}", f"J = {j}",
                           f"FUNCTION = {size / unit:.16g}*SIN({rate:.16g}*TIME)", f"-{damping / unit:.16g}*WZ({i}, {j}, {j})")  # fmt: skip

            def act(view):
                z = view.axis(J, "z").value
                spin = view.spin(I).rate - view.spin(J).rate
                torque = (size * np.sin(rate * view.t) - damping * (spin @ z)) * z
                view.push(I, view.point(I).value, np.zeros(3), torque)
                view.push(J, view.point(J).value, np.zeros(3), -torque)
        else:
            rm = int(self.rng.choice(list(self.markers)))
            R = self.markers[rm]
            a, b, c = self.rng.uniform(0.5, 3, 3)
            float_ident = 900 + number
            self.statement(f"MARKER/{float_ident}", f"PART = {J.part + 2}", "FLOATING")
            f, x = self.force, self.length
            self.statement(f"VFORCE/{number}", f"I = {i}", f"JFLOAT = {float_ident}", f"RM = {rm}",
                           f"FX = -{a * x / f:.16g}*VX({i}, {j}, {rm})\\", f"FY = {b / f:.16g}*COS(3*TIME)\\",
                           f"FZ = -{c * x / f:.16g}*DZ({i}, {j}, {rm})")  # fmt: skip

            def act(view):
                axes = view.axes(R)
                gap = view.point(I) - view.point(J)
                along, rate = axes.T @ gap.value, axes.T @ gap.rate
                force = axes @ [-a * rate[0], b * np.cos(3 * view.t), -c * along[2]]
                at = view.point(I).value
                view.push(I, at, force)
                view.push(J, at, -force)

        self.forces.append(act)

    # what is asked

    def requests(self):
        """A request of every sort between two random markers in the axes of a third, and one of a joint's functions."""
        free = list(self.markers)
        for number, sort in enumerate(("DISPLACEMENT", "VELOCITY", "ACCELERATION"), start=1):
            i, j, rm = (int(self.rng.choice(free)) for _ in range(3))
            self.statement(f"REQUEST/{number}", sort, f"I = {i}", f"J = {j}", f"RM = {rm}", "COMMENT = a, few: words")
            self.asked[number] = sort, i, j, rm
        _, joint, i, j = self.kinds[self.rng.integers(len(self.kinds))]
        rm = int(self.rng.choice(free))
        keyword = "JPRIM" if f"JPRIM_{joint}" in self.equations else "JOINT"
        self.statement("REQUEST/4", "FORCE", f"I = {i}", f"J = {j}", f"RM = {rm}")
        flag = int(self.rng.integers(2))
        columns = zip((2, 3, 4, 6, 7, 8), (2, 3, 4, 6, 7, 8), strict=True)
        self.statement("REQUEST/5", *(f"F{f} = {keyword}({joint}, {flag}, {c}, {rm})\\" for f, c in columns))
        self.asked[4] = f"{keyword}_{joint}", i, j, rm, flag

    def text(self):
        gravity = np.array([1.0, -2.0, -9.0])
        self.gravity = gravity
        x = self.length
        head = f"""ADAMS/View model name: MODEL_{self.seed}
!
!-------------------------------- SYSTEM UNITS ---------------------------------
!
UNITS/
, {self.units}
!
!----------------------------------- PARTS -------------------------------------
!
PART/1
, GROUND
!
"""
        tail = f"""!-------------------------- GRAVITATIONAL ACCELERATION --------------------------
!
ACCGRAV/
, IGRAV = {gravity[0] / x:.16g}
, JGRAV = {gravity[1] / x:.16g}
, KGRAV = {gravity[2] / x:.16g}
!
!----------------------------- ANALYSIS SETTINGS -------------------------------
!
OUTPUT/
, REQSAVE
, GRSAVE
!
RESULTS/
, XRF
!
INTEGRATOR/GSTIFF, ERROR=1.0E-4
!
END
"""
        return head + "\n".join(self.lines) + "\n" + tail

    def mechanism(self):
        parts = [Part(b.mass, b.own.T @ b.inertia @ b.own, b.center, b.own, b.velocity, b.spin) for b in self.bodies]
        return Mechanism(parts, self.equations, self.forces, gravity=self.gravity)


def random_trial(seed):
    """A mechanism of two to four parts with some forces."""
    trial = Trial(seed)
    rng = trial.rng
    trial.marker(-1, rng.uniform(-1, 1, 3), trial.turn())
    for k in range(rng.integers(2, 5)):
        trial.body(str(rng.choice(list(KINDS))), int(rng.integers(-1, k)))
    for number in range(1, rng.integers(1, 4)):
        trial.any_force(number)
    trial.requests()
    return trial
