"""Joint friction.  MSC Adams/Solver, FRICTION statement."""

from __future__ import annotations

from dataclasses import dataclass

from .arguments import Arguments, Numbered
from .text import Statement
from .units import Units

INPUTS = ("PRELOAD", "REACTION_FORCE", "BENDING_MOMENT", "TORSIONAL_MOMENT")
YOKES = {"BOTH": "IJ", "I_YOKE": "I", "J_YOKE": "J"}
OVERLAP = {"CONSTANT": 0, "INCREASE": 1, "DECREASE": -1}


@dataclass(frozen=True)
class JointFriction(Numbered):
    """Friction of one joint, in the dataset's units.

    Attributes
    ----------
    static, dynamic : float
        Coefficients.
    stiction_velocity, friction_velocity : float
        Sliding speeds at which the static coefficient is reached, and the dynamic one.
    inputs : frozenset of str
        Those of `INPUTS` that contribute to the normal force.
    pin, ball, collar, bending_arm, torsion_arm, overlap : float
        PIN_RADIUS, BALL_RADIUS, FRICTION_ARM, BENDING_REACTION_ARM, REACTION_ARM, INITIAL_OVERLAP.
    growth : int
        Derivative of the overlap with respect to the displacement: 0, 1 or -1.
    force, torque : float
        Friction without load.
    yokes : str
        Parts with friction in the arms of a universal joint's cross: ``I``, ``J`` or ``IJ``.
    """

    joint: int
    static: float
    dynamic: float
    stiction_velocity: float
    friction_velocity: float
    inputs: frozenset[str]
    pin: float
    ball: float
    collar: float
    bending_arm: float
    torsion_arm: float
    overlap: float
    growth: int
    force: float
    torque: float
    yokes: str


_ABOVE_ZERO = {
    "STICTION_TRANSITION_VELOCITY": 0.1, "TRANSITION_VELOCITY_COEFFICIENT": 1.5, "PIN_RADIUS": 1.0, "BALL_RADIUS": 1.0,
    "FRICTION_ARM": 1.0, "BENDING_REACTION_ARM": 1.0, "REACTION_ARM": 1.0, "INITIAL_OVERLAP": 1000.0,
}  # fmt: skip
"""Positive numbers with Adams' defaults."""
FROM_ZERO = ("MU_STATIC", "MU_DYNAMIC", "FRICTION_FORCE_PRELOAD", "FRICTION_TORQUE_PRELOAD")
LEFT_OUT = ("MAX_STICTION_DEFORMATION", "INACTIVE", "INACTIVE_DURING")
_NOT_READ = ("MAX_FRICTION_FORCE", "MAX_FRICTION_TORQUE", "BRISTLE_STIFFNESS", "BRISTLE_DAMPING", "VISCOUS_DAMPING")
_WORDS = ("JOINT", "FORMULATION", "OVERLAP_DELTA", "EFFECT", "INPUTS", "YOKE")
ARGUMENTS = (*FROM_ZERO, *_ABOVE_ZERO, *_WORDS, *LEFT_OUT, *_NOT_READ)


def read_friction(statement: Statement, units: Units) -> JointFriction:
    """Read joint friction of Adams' ORIGINAL formulation, with stiction."""
    found = Arguments(statement, "FRICTION", ARGUMENTS)
    found.refuse(_NOT_READ, "friction without it")
    _one_word(found, "FORMULATION", ("ORIGINAL",))
    for name in ("INACTIVE", "INACTIVE_DURING"):
        _one_word(found, name, ("STATICS",))
    effect = _effect(found)
    numbers = {name: found.positive(name) or usual for name, usual in _ABOVE_ZERO.items()}
    static, dynamic, force, torque = (_from_zero(found, name) for name in FROM_ZERO)
    if numbers["TRANSITION_VELOCITY_COEFFICIENT"] <= 1:
        raise found.fault("found TRANSITION_VELOCITY_COEFFICIENT up to 1, expected a larger number")
    slow = numbers["STICTION_TRANSITION_VELOCITY"]
    return JointFriction(
        *found.head(), found.required("JOINT"),
        dynamic if effect == "SLIDING" else static, dynamic, slow, slow * numbers["TRANSITION_VELOCITY_COEFFICIENT"],
        _inputs(found), numbers["PIN_RADIUS"], numbers["BALL_RADIUS"], numbers["FRICTION_ARM"],
        numbers["BENDING_REACTION_ARM"], numbers["REACTION_ARM"], numbers["INITIAL_OVERLAP"],
        OVERLAP[_one_word(found, "OVERLAP_DELTA", tuple(OVERLAP))], force, torque,
        YOKES[_one_word(found, "YOKE", tuple(YOKES))],
    )  # fmt: skip


def _from_zero(found: Arguments, name: str) -> float:
    value = found.number(name)
    if value is None and name.startswith("MU"):
        raise found.fault(f"found no {name}, expected a coefficient of friction")
    if value is not None and value < 0:
        raise found.fault(f"found {name} = {found.text(name)}, expected no number below zero", found.line(name))
    return value or 0.0


def _one_word(found: Arguments, name: str, words: tuple[str, ...]) -> str:
    """Return the one of the given words that the argument abbreviates; the first word if it is missing."""
    text = (found.text(name) or words[0]).strip(" ()").upper()
    for word in words:
        if text and word.startswith(text):
            return word
    raise found.fault(f"found {name} = {found.text(name)}, expected {' or '.join(words)}", found.line(name))


def _effect(found: Arguments) -> str:
    """Return ``ALL``, also if both effects are named, or ``SLIDING``."""
    words = {word.strip() for word in (found.text("EFFECT") or "ALL").strip(" ()").upper().replace(",", ":").split(":")}
    if (
        len(words) == 2
        and any(w and "STICTION".startswith(w) for w in words)
        and any(w and "SLIDING".startswith(w) for w in words)
    ):
        return "ALL"
    return _one_word(found, "EFFECT", ("ALL", "SLIDING"))


def _inputs(found: Arguments) -> frozenset[str]:
    text = (found.text("INPUTS") or "ALL").strip().strip("()").upper()
    asked: set[str] = set()
    for word in (word.strip() for word in text.replace(",", ":").split(":")):
        if word == "ALL":
            asked |= {*INPUTS}
        elif word != "NONE":
            named = [name for name in INPUTS if word and name.startswith(word)]
            if not named:
                raise found.fault(
                    f"found INPUTS = {found.text('INPUTS')}, expected ALL, NONE or {', '.join(INPUTS)} between colons",
                    found.line("INPUTS"),
                )
            asked.add(named[0])
    return frozenset(asked)
