"""Scenes and datasets that are hostile or broken: told in a sentence, or read as their standards say."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from stiffmbs.adams.load import ENCODING, read_adams
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.reading.files.text_file import decoded
from stiffmbs.results.solution import Solution

from ...case import Case
from ...simulation import refusal, simulation

BODY = "bodies: {b: {mass: 1, inertia: 1}}\n"
HEAD = """falls
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
PART/2, MASS=1, CM=3, IP=1,1,1
MARKER/3, PART=2
"""
FALL = "ACCGRAV/KGRAV=-10\nEND\n"
MOTION = HEAD + "JOINT/1, REVOLUTE, I=3, J=1\nMOTION/1, JOINT=1, ROTATION, %s\nEND\n"
LAUGHS = "bodies:\n  a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"  a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 10)
)
VARIABLES = "".join(f"VARIABLE/{k}, FUNCTION=VARVAL({k + 1})*VARVAL({k + 1})\n" for k in range(1, 40))


def _scene(name: str, text: str, *names: str) -> Case:
    return refusal(f"scene: {name}", "told where and what", partial(read_scene, text), names)


def _dataset(name: str, text: str, *names: str) -> Case:
    return refusal(f"dataset: {name}", "told where and what", partial(read_adams, text), names)


def _decoded_scene(content: bytes) -> Scene:
    return read_scene(decoded(content, "file"))


def _decoded_dataset(content: bytes) -> Scene:
    return read_adams(decoded(content, "file", ENCODING))


def _fallen(solution: Solution) -> float:
    """z = -10 t^2/2."""
    return float(np.max(np.abs(solution["PART_2.z"] + 5 * solution.t**2)))


def _pushed(solution: Solution) -> float:
    """x = t^2/2."""
    return float(np.max(np.abs(solution["b.x"] - solution.t**2 / 2)))


def _falls(name: str, content: bytes) -> Case:
    return simulation(
        f"dataset: {name}", "a free fall of 1 s against -g t^2/2", partial(_decoded_dataset, content), _fallen, 1e-6,
        duration=1.0, points=11,
    )  # fmt: skip


def _push(name: str, content: bytes) -> Case:
    return simulation(
        f"scene: {name}", "1 kg under 1 N for 1 s against t^2/2", partial(_decoded_scene, content), _pushed, 1e-6,
        duration=1.0, points=11,
    )  # fmt: skip


def _nested(function: str, value: Callable[[float], float], depth: int = 14) -> Case:
    """A force of the place that is a function within itself: constant, as the place is held by a drive."""
    text, at = "b.x", 0.25
    for _ in range(depth):
        text, at = function.format(text), value(at)
    scene = (
        "bodies: {b: {mass: 1, inertia: 1, position: [0.25, 0]}, c: {mass: 1, inertia: 1}}\njoints: {w: {type: fixed, i: b, j: {body: ground, "
        f"point: [0.25, 0]}}}}}}\nforces: {{f: {{type: force, i: c, force: ['{text}', 0]}}}}\n"
    )
    return simulation(
        f"{function.format('x')} {depth} times within itself", "a constant force, of which 1 kg gets its speed",
        partial(read_scene, scene), lambda solution: float(abs(solution["c.vx"][-1] - at)), 1e-9, duration=1.0, points=3,
    )  # fmt: skip


PUSH = BODY + "forces: {f: {type: force, i: b, force: [1, 0]}}\n"
OLD = "forces: {f: {type: force, i: b, force: [5, 0]}}"

CASES = (
    _scene("aliases nine deep", LAUGHS, "aliases that stand for"),
    _scene("mapping within itself", "bodies: &b {b: {mass: 1, x: *b}}\n", "alias within"),
    _scene("list within itself", BODY + "notes: &n [*n]\n", "alias within"),
    _scene("merge of no mapping", "bodies: {b: {mass: 1, <<: 3}}\n", "line 1"),
    _scene("300 nested maps", "bodies: " + "{a: " * 300 + "1" + "}" * 300, "nested"),
    _scene("3000 nested lists", "bodies: " + "[" * 3000 + "]" * 3000, "nested"),
    _scene("half of a surrogate pair", 'name: "x \\ud800"\n' + BODY, "U+D800"),
    _scene("a truth value that is none", "bodies: !!bool abc\n", "does not fit its tag"),
    _scene("a date that is none", "bodies: {b: {mass: 2001-99-99, inertia: 1}}\n", "does not fit its tag"),
    _scene("an integer of 400 digits", "bodies: {b: {mass: " + "9" * 400 + ", inertia: 1}}\n", "1e308"),
    _scene("an integer of 5000 digits", "bodies: {b: {mass: " + "9" * 5000 + ", inertia: 1}}\n", "4300 digits"),
    _scene("a tower of powers", "bodies: {b: {mass: 9**9**9, inertia: 1}}\n", "bodies.b.mass", "overflows"),
    _scene("a tower of powers of time", PUSH.replace("[1, 0]", "['t**9**9**9', 0]"), "f:", "no finite real value"),
    _scene("hinge 1e12 m away", "bodies: {b: {mass: 1, inertia: 1, position: [1e12, 0]}}\njoints: {h: {type: revolute, i: {body: b, point: [-1, 0]}, j: {body: ground, point: [1e12 - 1, 0]}}}\n", "bodies.b", "1e+12 m"),
    *(_push(f"a comment with {sign!a}", f"# was: {sign}{OLD}\n{PUSH}".encode()) for sign in ("\x85", "\u2028", "\u2029")),
    *(_push(f"in {encoding}", PUSH.encode(encoding)) for encoding in ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32")),
    *(_falls(f"a comment with {sign!a}", (HEAD + f"! was: {sign}ACCGRAV/KGRAV=-5\n" + FALL).encode()) for sign in "\x85\x0b\x0c\x1c\u2028"),
    _falls("a comment with the byte 0x85", (HEAD + "! was: \x85ACCGRAV/KGRAV=-5\n" + FALL).encode(ENCODING)),
    *(_falls(f"in {encoding}", (HEAD + FALL).encode(encoding)) for encoding in ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32")),
    *(_falls(f"lines end with {end!a}", (HEAD + FALL).replace("\n", end).encode()) for end in ("\r", "\r\n")),
    _dataset("a zero byte", HEAD.replace("MASS=1,", "MASS=1\0") + FALL, "line 5", "zero byte"),
    _dataset("a tower of powers", MOTION % "FUNCTION=9**9**9", "line 8", "no finite real value"),
    _dataset("a tower of powers to integrate", MOTION % "ACCEL, FUNCTION=TIME**9**9**9", "line 8"),
    _dataset("a tower of powers as a speed", MOTION % "VELOCITY, ICDISP=1, FUNCTION=9**9**9", "line 8"),
    _dataset("a high power to integrate", MOTION % "ACCEL, FUNCTION=(1+TIME)**100000", "line 8", "integral"),
    _dataset("a number beyond all", MOTION % "FUNCTION=1E400*TIME", "line 8", "1E400"),
    _dataset("variables that double each other", HEAD + VARIABLES + "VARIABLE/40, FUNCTION=TIME\nSFORCE/1, I=3, J=1, TRANSLATIONAL, FUNCTION=VARVAL(1)\n" + FALL, "variables.VARIABLE_", "at most 2000"),
    _nested("step({}, 0, 0, 1, 1)", lambda x: x * x * (3 - 2 * x)),
    _nested("step5({}, 0, 0, 1, 1)", lambda x: x**3 * (10 - 15 * x + 6 * x * x)),
    _nested("max({}, 0.5)", lambda x: max(x, 0.5)),
    _nested("abs({} - 1)", lambda x: abs(x - 1)),
    _nested("branch({} - 0.5, 0.75, 0.5, 0.25)", lambda x: 0.75 if x < 0.5 else 0.5 if x == 0.5 else 0.25),
    _nested("sin({})", lambda x: float(np.sin(x))),
)  # fmt: skip
