"""A dataset with numbers changed at random and spelt in all ways of Adams, against equations that are made of the same numbers."""

from random import Random

import numpy as np
import pytest

import stiffmbs
from stiffmbs.adams.load import read_adams

from .adams_joints import revolute, translational
from .adams_oracle import Marker, Mechanism, Part, tensor

DATASET = """mutated
UNITS/FORCE = NEWTON, MASS = KILOGRAM, LENGTH = {unit}, TIME = SECOND
PART/1, GROUND
MARKER/11, PART = 1
MARKER/12, PART = 1, QP = 0, 0, {height}
PART/2, QG = {x}, {y}, 0
, VX = {vx}, VY = {vy}, WZ = {spin}
, MASS = {mass}, CM = 21, IP = {ixx}, {iyy}, {izz}
MARKER/21, PART = 2
MARKER/22, PART = 2, QP = {back_x}, {back_y}, 0
PART/3, QG = 0, 0, {slide}
, VZ = {vz}
, MASS = {weight}, CM = 31, IP = 1E4, 1E4, 1E4
MARKER/31, PART = 3
JOINT/1, REVOLUTE, I = 22, J = 11
JOINT/2, TRANSLATIONAL, I = 31, J = 12
SPRINGDAMPER/1, TRANSLATIONAL, I = 21, J = 31
, K = {k}, C = {c}, LENGTH = {length}, FORCE = {preload}
SFORCE/1, ROTATIONAL, I = 22, J = 11
, FUNCTION = {size}*SIN({rate}*TIME)
, -{drag}*WZ(22, 11, 11)
SFORCE/2, TRANSLATIONAL, ACTIONONLY, I = 31, J = 12
, FUNCTION = STEP(TIME, 0, {low}, {until}, {high})
ACCGRAV/IGRAV = {gx}, JGRAV = {gy}, KGRAV = {gz}
END
"""
USUAL = {
    "height": -200.0, "x": 300.0, "y": 100.0, "spin": 2.0, "mass": 2.0, "ixx": 2e4, "iyy": 3e4, "izz": 4e4, "slide": 450.0,
    "vz": 500.0, "weight": 1.5, "k": 0.4, "c": 0.01, "length": 350.0, "preload": 3.0, "size": 800.0, "rate": 5.0, "drag": 40.0,
    "low": 2.0, "until": 0.3, "high": -4.0, "gx": 500.0, "gy": -9000.0, "gz": -3000.0,
}  # fmt: skip
UNITS = {"MILLIMETER": 1e-3, "CENTIMETER": 1e-2, "METER": 1.0, "INCH": 0.0254}
POSITIVE = ("mass", "ixx", "iyy", "izz", "weight", "k", "c", "until", "drag", "length")
TIMES = np.linspace(0, 0.4, 9)


def mutated(random):
    """Numbers of which one or some are others, and the unit of length in which all are meant."""
    n = dict(USUAL)
    for name in random.sample(sorted(n), random.choice((1, 1, 2, 5))):
        n[name] *= random.choice((0.5, 2.0, 1.1, random.uniform(0.2, 3), *(() if name in POSITIVE else (-1.0, 0.0))))
    n["slide"] = np.sign(n["slide"] or 1) * max(abs(n["slide"]), 300)
    if abs(n["x"]) + abs(n["y"]) < 50:
        n["x"] = 150.0
    # the hinge is at the origin: the bar turns about it
    n |= {"back_x": -n["x"], "back_y": -n["y"], "vx": -n["spin"] * n["y"], "vy": n["spin"] * n["x"]}
    return n, random.choice(sorted(UNITS))


def spelt(value, random):
    """A number as people write it."""
    exact = repr(float(value))
    digits, _, power = f"{value:.16e}".partition("e")
    return random.choice((
        exact, exact, f"{value:.17g}", f"{digits}D{int(power)}" if abs(int(power)) < 90 else exact, f"{value:.16E}",
        f"{value:+.17g}".lstrip("+") if value < 0 else f"{value:.17g}",
    ))  # fmt: skip


def mechanism(n, unit):
    """The same by equations, in SI."""
    L = UNITS[unit]
    hinge, rail, bar, load = (
        Marker(-1),
        Marker(-1, (0, 0, n["height"] * L)),
        Marker(0),
        Marker(1, (0, 0, n["slide"] * L)),
    )
    center = np.array([n["x"], n["y"], 0]) * L
    parts = [
        Part(n["mass"], tensor(*(n[name] * L**2 for name in ("ixx", "iyy", "izz"))), tuple(center),
             velocity=tuple(np.array([n["vx"], n["vy"], 0]) * L), spin=(0, 0, n["spin"])),
        Part(n["weight"], tensor(*(1e4 * L**2,) * 3), (0, 0, n["slide"] * L), velocity=(0, 0, n["vz"] * L)),
    ]  # fmt: skip
    middle = Marker(0, tuple(center))

    def spring(view):
        gap = view.point(middle) - view.point(load)
        way = gap.length()
        pull = -n["k"] / L * (way.value - n["length"] * L) - n["c"] / L * way.rate + n["preload"]
        force = pull * gap.value / way.value
        view.push(middle, view.point(middle).value, force)
        view.push(load, view.point(load).value, -force)

    def others(view):
        turn = n["size"] * np.sin(n["rate"] * view.t) - n["drag"] * view.w[0][2]
        view.push(bar, view.r[0], np.zeros(3), (0, 0, turn * L))
        z = min(max(view.t / n["until"], 0), 1)
        push = n["low"] + (n["high"] - n["low"]) * z * z * (3 - 2 * z)
        view.push(load, view.r[1], np.array([0, 0, push]))

    joints = {"JOINT_1": revolute(bar, hinge), "JOINT_2": translational(load, rail)}
    return Mechanism(parts, joints, [spring, others], tuple(np.array([n["gx"], n["gy"], n["gz"]]) * L))


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.long) for k in range(1, 200))])
@pytest.mark.sampled(92)
def test_changed_numbers_change_both_alike(seed):
    random = Random(seed)
    n, unit = mutated(random)
    text = DATASET.format(unit=unit, **{name: spelt(value, random) for name, value in n.items()})
    found = stiffmbs.run(read_adams(text), duration=0.4, points=9, rtol=1e-9)
    history = mechanism(n, unit).run(TIMES)
    for k, part in enumerate(("PART_2", "PART_3")):
        wanted = history.part(k)
        for names in (("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz")):
            expected = np.array([wanted[name] for name in names])
            np.testing.assert_allclose(
                [found[f"{part}.{name}"] for name in names],
                expected,
                rtol=0,
                atol=2e-6 * max(np.abs(expected).max(), 1e-3),
            )
    reaction = history.reaction("JOINT_1", Marker(0, (0, 0, 0)))
    np.testing.assert_allclose(
        np.array([found[f"JOINT_1.{name}"] for name in ("fx", "fy", "fz", "tx", "ty")]).T, reaction[:, :5], rtol=0,
        atol=2e-5 * np.abs(reaction).max(),
    )  # fmt: skip
