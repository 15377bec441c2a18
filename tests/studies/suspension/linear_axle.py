"""Axles as rigid bodies with small motions in NumPy, which share no code with the package: joints, springs and bushings in one pose.

A motion of a body is the velocity of its point at the origin and its angular velocity, ground axes. Joints are rows of A x = c; springs and
bushings are rows b of the energy k (b x)^2/2. Without preloads the equilibrium of small motions is K x + A^T lam = f, A x = c.
"""

from dataclasses import dataclass, field

import numpy as np

SIGN = {"left": 1.0, "right": -1.0}


def skew(p):
    x, y, z = p
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def unit(a):
    return np.asarray(a, dtype=float) / np.linalg.norm(a)


def across(axis):
    """Two unit vectors normal to an axis."""
    axis = unit(axis)
    first = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]))
    return np.array([first, np.cross(axis, first)])


def contact_of(centre, axis, height):
    """Lowest point of a disc whose centre is `height` above the road as drawn, the radius in its plane being kept."""
    down = np.array([0, 0, -1.0]) + axis[2] * axis
    return centre + height * down / np.linalg.norm(down)


@dataclass
class Linear:
    """Bodies that move a little; ground (the clamped body) is None."""

    bodies: list = field(default_factory=list)
    joints: list = field(default_factory=list)  # rows as functions of the number of bodies
    springs: list = field(default_factory=list)  # (row, stiffness, locked in steering)

    def body(self, name):
        self.bodies.append(name)
        return name

    def motion(self, body, point):
        """Matrices of the velocity of a point and of the angular velocity of a body, (3, size)."""
        size = 6 * len(self.bodies)
        v, w = np.zeros((3, size)), np.zeros((3, size))
        if body is not None:
            k = 6 * self.bodies.index(body)
            v[:, k : k + 3], v[:, k + 3 : k + 6], w[:, k + 3 : k + 6] = np.eye(3), -skew(point), np.eye(3)
        return v, w

    def between(self, i, j, point):
        (v, w), (u, r) = self.motion(i, point), self.motion(j, point)
        return v - u, w - r

    def spherical(self, i, j, p):
        self.joints.append(lambda: self.between(i, j, p)[0])

    def revolute(self, i, j, p, axis):
        self.spherical(i, j, p)
        self.joints.append(lambda: across(axis) @ self.between(i, j, p)[1])

    def universal(self, i, j, p, axis):
        """Ball without rotation about the axis normal to both pins."""
        self.spherical(i, j, p)
        self.joints.append(lambda: (unit(axis) @ self.between(i, j, p)[1])[None])

    def cylindrical(self, i, j, p, axis):
        self.joints += [
            lambda: across(axis) @ self.between(i, j, p)[0],
            lambda: across(axis) @ self.between(i, j, p)[1],
        ]

    def on_line(self, i, j, p, axis):
        self.joints.append(lambda: across(axis) @ self.between(i, j, p)[0])

    def rod(self, i, p, j, q):
        self.joints.append(lambda: (unit(np.subtract(p, q)) @ (self.motion(i, p)[0] - self.motion(j, q)[0]))[None])

    def prismatic(self, i, j, p, axis):
        self.joints += [lambda: across(axis) @ self.between(i, j, p)[0], lambda: self.between(i, j, p)[1]]

    def spring(self, i, p, j, q, k):
        self.springs.append((lambda: unit(np.subtract(p, q)) @ (self.motion(i, p)[0] - self.motion(j, q)[0]), k, True))

    def torsion(self, i, j, axis, k):
        self.springs.append((lambda: unit(axis) @ self.between(i, j, (0, 0, 0))[1], k, True))

    def bushing(self, i, j, p, axes, k):
        """`axes`: rows x, y, z; `k` of shape (6,)."""
        for n in range(3):
            self.springs.append((lambda n=n: axes[n] @ self.between(i, j, p)[0], k[n], False))
            self.springs.append((lambda n=n: axes[n] @ self.between(i, j, p)[1], k[3 + n], False))

    def solved(self, rows, values, force=None, locked=False):
        """Return the motion, and the forces along the rows, for rows A x = c besides the joints."""
        size = 6 * len(self.bodies)
        a = np.vstack([np.zeros((0, size)), *(each() for each in self.joints), *(np.atleast_2d(row) for row in rows)])
        c = np.concatenate([np.zeros(len(a) - len(values)), values])
        held = [row() for row, _, line in self.springs if line and locked]
        if held:
            a, c = np.vstack([np.array(held), a]), np.concatenate([np.zeros(len(held)), c])
        k = sum((s * np.outer(row(), row()) for row, s, _ in self.springs), np.zeros((size, size)))
        scale = 1e6  # of rows, as the stiffnesses are large
        system = np.block([[k, scale * a.T], [scale * a, np.zeros((len(a), len(a)))]])
        right = np.concatenate([np.zeros(size) if force is None else force, scale * c])
        found, *_ = np.linalg.lstsq(system, right, rcond=1e-13)
        assert np.max(np.abs(system @ found - right)) < 1e-6 * max(1, np.max(np.abs(right)))
        return found[:size], scale * found[size + len(a) - len(values) :]


def turned_to(z):
    """Axes of a bushing that is alike along both axes normal to z."""
    return np.vstack([across(z), unit(z)])


@dataclass
class Wheel:
    side: str
    carrier: str
    centre: np.ndarray
    axis: np.ndarray
    contact: np.ndarray

    def velocity(self, model, x):
        """Velocity of centre and contact (of the wheel that rolls), and angular velocity of the carrier."""
        v, w = (m @ x for m in model.motion(self.carrier, self.centre))
        height = np.linalg.norm(self.contact - self.centre)
        h = 1e-6
        ends = [contact_of(self.centre, self.axis + s * h * np.cross(w, self.axis), height) for s in (1, -1)]
        return v, v + (ends[0] - ends[1]) / (2 * h), w

    def lift(self, model):
        """Row of the rise of the contact."""
        return np.array([self.velocity(model, x)[1][2] for x in np.eye(6 * len(model.bodies))])


def wheel_of(side, carrier, centre, toe=0.0, camber=0.0):
    axis = unit([np.tan(toe), 1, -np.tan(camber)]) * [SIGN[side], 1, SIGN[side]]
    down = np.array([0, 0, -1.0]) + axis[2] * axis
    return Wheel(side, carrier, np.asarray(centre), axis, np.asarray(centre) + centre[2] * down / -down[2])


def wishbone(m, name, upright, front, rear, ball, rigid, k_b):
    arm = m.body(name)
    m.spherical(arm, upright, ball)
    line = front - rear
    if rigid:
        m.revolute(arm, None, front, line)
    else:
        for p in (front, rear):
            m.bushing(arm, None, p, turned_to(line), [k_b, k_b, k_b / 10, 1000, 1000, 100])
    return arm


def link(m, name, inside, upright, inner, outer, rigid, k_b=1e7):
    rod = m.body(name)
    m.spherical(rod, upright, outer)
    way = unit(outer - inner)
    across_link = unit(np.cross(way, [0, 0, 1]))  # the bolt
    up = np.cross(across_link, way)
    if rigid:
        m.universal(rod, inside, inner, way)
    else:
        m.bushing(rod, inside, inner, [across_link, way, up], [k_b / 10, k_b, k_b, 50, 500, 500])


def corner(m, part, side, at, rack, rigid, k_b, spring):
    """Add a suspension with its points `at` on its own side; return its wheel."""
    upright = m.body(f"{side}.upright")
    below = upright
    if part in ("double_wishbone", "pushrod_wishbone", "macpherson"):
        lower = wishbone(m, f"{side}.lower", upright, at["lower_front"], at["lower_rear"], at["lower_ball"], rigid, k_b)
        link(m, f"{side}.tie", rack, upright, at["tie_inner"], at["tie_outer"], True)
    if part in ("double_wishbone", "pushrod_wishbone"):
        wishbone(m, f"{side}.upper", upright, at["upper_front"], at["upper_rear"], at["upper_ball"], rigid, k_b)
        below = lower
    if part == "pushrod_wishbone":
        below = m.body(f"{side}.rocker")
        m.revolute(below, None, at["rocker_pivot"], at["rocker_axis"])
        m.rod(lower, at["pushrod_outer"], below, at["pushrod_inner"])
    above = None
    if part == "macpherson":
        line, above = at["strut_tower"] - at["strut_seat"], m.body(f"{side}.rod")
        m.cylindrical(above, upright, at["strut_tower"], line)
        if rigid:  # pins along the strut's normal in the plane of y, and along y
            m.universal(above, None, at["strut_tower"], line)
        else:
            k = 2e6
            m.bushing(above, None, at["strut_tower"], turned_to(line), [2 * k, 2 * k, k, 200, 200, 200])
    if part == "multi_link":
        for name in ("lower_front", "lower_rear", "upper_front", "upper_rear", "toe"):
            inside = rack if name == "toe" else None
            link(m, f"{side}.{name}", inside, upright, at[f"{name}_inner"], at[f"{name}_outer"], rigid, k_b)
    if part == "trailing_arm":
        line = at["pivot_outer"] - at["pivot_inner"]
        if rigid:
            m.revolute(upright, None, at["pivot_outer"], line)
        else:
            for name in ("pivot_outer", "pivot_inner"):
                m.bushing(upright, None, at[name], turned_to(line), [k_b, k_b, k_b / 10, 2000, 2000, 100])
    m.spring(below, at["strut_seat"], above, at["strut_tower"], spring)
    return upright


def twist_beam(m, at, mirrored, rigid, k_b, spring, torsion):
    """Two trailing arms with a pin along the shear centre. `mirrored`: the points on the right."""
    arms = [m.body("left.upright"), m.body("right.upright")]
    for arm, points in zip(arms, (at, mirrored), strict=True):
        m.spring(arm, points["strut_seat"], None, points["strut_tower"], spring)
        middle = (points["pivot_outer"] + points["pivot_inner"]) / 2
        if not rigid:
            k = [k_b, k_b, k_b / 2, 500, 500, 50]
            m.bushing(arm, None, middle, turned_to(points["pivot_outer"] - points["pivot_inner"]), k)
        elif arm == "left.upright":
            m.spherical(arm, None, middle)
        else:
            m.on_line(arm, None, middle, [0, 1, 0])
    m.revolute(*arms, at["beam"], [0, 1, 0])
    m.torsion(*arms, [0, 1, 0], torsion)
    return arms


def leaf(m, side, axle, at, rigid, k_b, spring):
    """A leaf spring as two halves, which torsion springs clamp on the axle."""
    front, rear = m.body(f"{side}.front_half"), m.body(f"{side}.rear_half")
    y = [0, 1, 0]
    for half, eye in ((front, "front_eye"), (rear, "rear_eye")):
        m.revolute(half, axle, at["clamp"], y)
        m.torsion(half, axle, y, spring / 2 * (at[eye] - at["clamp"])[0] ** 2)
    if rigid:
        m.on_line(front, None, at["front_eye"], y)
        m.rod(rear, at["rear_eye"], None, at["shackle_top"])
        m.bushing(front, None, at["front_eye"], turned_to(y), [0, 0, k_b / 5, 0, 0, 0])
        return
    shackle, k = m.body(f"{side}.shackle"), [k_b, k_b, k_b / 5, 2000, 2000, 50]
    for i, j, place in ((front, None, "front_eye"), (rear, shackle, "rear_eye"), (shackle, None, "shackle_top")):
        m.bushing(i, j, at[place], turned_to(y), k)


def measures(m, wheels, springs, wheelbase, height, front, brake=0.6, drive=1.0, solid=False, rack=None, angular=False):
    """Measures of an axle as docs/guide/kinematics_and_compliance.md defines them, in its units. `rack`: row of the steering joint,
    which rotates if it is `angular`."""
    deg, found = np.degrees, {}
    lifts = [wheel.lift(m) for wheel in wheels]
    held = [] if rack is None else [rack]
    rows, still = [*lifts, *held], [0.0] * len(held)
    bump, push = m.solved(rows, [1.0] * len(wheels) + still)
    for k, wheel in enumerate(wheels):
        s = SIGN[wheel.side]
        v, contact, w = wheel.velocity(m, bump)
        locked = v + np.cross(w, wheel.contact - wheel.centre)
        on_body, on_carrier = v[0] / contact[2], locked[0] / contact[2]
        drives = on_carrier if solid else on_body
        own = {
            "toe": deg(s * np.arctan2(wheel.axis[0], wheel.axis[1])), "camber": deg(-s * np.arcsin(wheel.axis[2])), "wheel_rate": -1e-3 * push[k] / v[2],
            "fvsa_angle": deg(np.arctan(s * v[1] / v[2])), "svsa_angle": deg(np.arctan(v[0] / v[2])),
            "brake_angle": deg(np.arctan(on_carrier)), "drive_angle": deg(np.arctan(drives)),
        }  # fmt: skip
        if abs(w[0]) > 1e-9:
            own["fvsa_length"] = 1e3 * s * np.hypot(v[1], v[2]) / w[0]
        if abs(w[1]) > 1e-9:
            own["svsa_length"] = -1e3 * np.hypot(v[0], v[2]) / w[1]
        ratio = 100 * wheelbase / height
        own |= (
            {"anti_dive": ratio * brake * on_carrier, "anti_lift": ratio * drive * drives}
            if front
            else {"anti_lift": -ratio * brake * on_carrier, "anti_squat": -ratio * drive * drives}
        )
        for name, row in springs[k].items():
            own[f"motion_ratio.{name}"] = -row() @ bump / v[2]
        found |= {f"{wheel.side}.{name}": value for name, value in own.items()}
    if len(wheels) == 2:
        found |= _together(m, wheels, rows, still)
    if rack is not None:
        found |= _steered(m, wheels, rows, rack, angular)
    return found


def _together(m, wheels, rows, still):
    (left, right), deg = wheels, np.degrees
    roll, push = m.solved(rows, [1.0, -1.0, *still])
    paths = np.array([wheel.velocity(m, roll)[1][1:] for wheel in wheels])
    centre = np.linalg.solve(paths, [path @ wheel.contact[1:] for path, wheel in zip(paths, wheels, strict=True)])
    middle, across_axle = (left.contact + right.contact) / 2, left.contact - right.contact
    angle = (2 * across_axle[1] - (paths[0] - paths[1])[0] * across_axle[2]) / (across_axle[1:] @ across_axle[1:])
    moment = -(push[0] - push[1]) * across_axle[1] / 2
    return {
        "axle.track": 1e3 * np.linalg.norm(across_axle[1:]),
        "axle.roll_centre_lateral": 1e3 * (centre[0] - middle[1]),
        "axle.roll_centre_height": 1e3 * (centre[1] - middle[2]),
        "axle.roll_rate": moment / deg(angle),
    }


def _steered(m, wheels, rows, rack, angular):
    found, deg = {}, np.degrees
    held, _ = m.solved(rows, [0.0] * len(wheels) + [1.0])
    free, _ = m.solved([rack], [1.0], locked=True)
    rates = []
    for wheel in wheels:
        s, a = SIGN[wheel.side], wheel.axis
        _, _, w = wheel.velocity(m, held)
        turn = np.cross(w, a)
        rates.append((a[0] * turn[1] - a[1] * turn[0]) / (a[0] ** 2 + a[1] ** 2))
        v, _, w = wheel.velocity(m, free)
        direction = unit(w) * np.sign(w[2])
        point = wheel.centre + np.cross(w, v) / (w @ w)
        heading, out = unit([a[1], -a[0], 0]), s * unit([a[0], a[1], 0])
        road, hub = (point + direction * (at[2] - point[2]) / direction[2] - at for at in (wheel.contact, wheel.centre))
        found |= {
            f"{wheel.side}.{name}": value
            for name, value in {
                "caster": deg(np.arctan(-direction[0] / direction[2])),
                "kingpin_inclination": deg(np.arctan(-s * direction[1] / direction[2])),
                "scrub_radius": -1e3 * road @ out, "caster_trail": 1e3 * road @ heading,
                "spindle_offset": -1e3 * hub @ out, "caster_offset": 1e3 * hub @ heading,
            }.items()
        }  # fmt: skip
    return found | {"axle.steering_ratio": 1 / np.mean(rates) if angular else 1e3 / deg(np.mean(rates))}


def compliance(m, wheels, rack=None):
    """Matrices at the centres and at the contacts: displacements (x, y, z, rx, ry, rz) of the carriers by unit loads."""
    held = [] if rack is None else [rack]
    both = []
    for at in ("centre", "contact"):
        ports = [np.vstack(m.motion(wheel.carrier, getattr(wheel, at))) for wheel in wheels]
        port = np.vstack(ports)
        both.append(np.array([port @ m.solved(held, [0.0] * len(held), row)[0] for row in port]).T)
    return both
