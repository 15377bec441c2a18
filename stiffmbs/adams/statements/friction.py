"""Joint friction.  MSC Adams/Solver, FRICTION statement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from .arguments import Arguments
from .declared import Numbered, ident, named_words, read_by
from .units import Units

Meaning = TypeVar("Meaning")
INPUTS = ("PRELOAD", "REACTION_FORCE", "BENDING_MOMENT", "TORSIONAL_MOMENT")
YOKES = {"BOTH": "IJ", "I_YOKE": "I", "J_YOKE": "J"}
OVERLAP = {"CONSTANT": 0, "INCREASE": 1, "DECREASE": -1}
_NOT_READ = ("MAX_FRICTION_FORCE", "MAX_FRICTION_TORQUE", "BRISTLE_STIFFNESS", "BRISTLE_DAMPING", "VISCOUS_DAMPING")
_SLOW, _FACTOR = ("STICTION_TRANSITION_VELOCITY", 0.1), ("TRANSITION_VELOCITY_COEFFICIENT", 1.5)


def _from_zero(found: Arguments, name: str) -> float:
    value = found.number(name)
    if value is None and name.startswith("MU"):
        raise found.fault(f"found no {name}, expected a coefficient of friction")
    if value is not None and value < 0:
        raise found.fault(f"found {name} = {found.text(name)}, expected a number of zero or more", name)
    return value or 0.0


def _zero_or_more(name: str) -> float:
    return read_by(lambda found, _: _from_zero(found, name), name)


def _size(name: str, usual: float) -> float:
    """Declare a positive number with Adams' default."""
    return read_by(lambda found, _: found.positive(name) or usual, name)


def _one_word(found: Arguments, name: str, words: tuple[str, ...]) -> str:
    """Return the one of the given words that the argument abbreviates; the first word if it is missing."""
    text = (found.text(name) or words[0]).strip(" ()").upper()
    for word in words:
        if text and word.startswith(text):
            return word
    raise found.fault(f"found {name} = {found.text(name)}, expected {' or '.join(words)}", name)


def _word_of(name: str, meanings: dict[str, Meaning]) -> Meaning:
    return read_by(lambda found, _: meanings[_one_word(found, name, tuple(meanings))], name)


def _static(found: Arguments, _: Units) -> float:
    """Return the static coefficient: the dynamic one if sliding is the only effect."""
    words = {*named_words(found, "EFFECT")}
    both = len(words) == 2 and all(
        any(word and name.startswith(word) for word in words) for name in ("STICTION", "SLIDING")
    )
    effect = "ALL" if both else _one_word(found, "EFFECT", ("ALL", "SLIDING"))
    return _from_zero(found, "MU_DYNAMIC" if effect == "SLIDING" else "MU_STATIC")


def _friction_velocity(found: Arguments, _: Units) -> float:
    slow, factor = (found.positive(name) or usual for name, usual in (_SLOW, _FACTOR))
    if factor <= 1:
        raise found.fault(f"found TRANSITION_VELOCITY_COEFFICIENT = {factor:g}, expected a number above 1")
    return slow * factor


def _inputs(found: Arguments, _: Units) -> frozenset[str]:
    asked: set[str] = set()
    for word in named_words(found, "INPUTS"):
        if word == "ALL":
            asked |= {*INPUTS}
        elif word != "NONE":
            named = [name for name in INPUTS if word and name.startswith(word)]
            if not named:
                raise found.fault(
                    f"found INPUTS = {found.text('INPUTS')}, expected ALL, NONE or {', '.join(INPUTS)} between colons",
                    "INPUTS",
                )
            asked.add(named[0])
    return frozenset(asked)


@dataclass(frozen=True)
class JointFriction(Numbered):
    """Friction of one joint by Adams' ORIGINAL formulation, with stiction, in the dataset's units."""

    static: float = read_by(_static, "MU_STATIC", "EFFECT")
    dynamic: float = _zero_or_more("MU_DYNAMIC")
    force: float = _zero_or_more("FRICTION_FORCE_PRELOAD")  # without load, like `torque`
    torque: float = _zero_or_more("FRICTION_TORQUE_PRELOAD")
    # Sliding speeds at which the static coefficient is reached, and the dynamic one.
    stiction_velocity: float = _size(*_SLOW)
    friction_velocity: float = read_by(_friction_velocity, _FACTOR[0])
    pin: float = _size("PIN_RADIUS", 1.0)
    ball: float = _size("BALL_RADIUS", 1.0)
    collar: float = _size("FRICTION_ARM", 1.0)
    bending_arm: float = _size("BENDING_REACTION_ARM", 1.0)
    torsion_arm: float = _size("REACTION_ARM", 1.0)
    overlap: float = _size("INITIAL_OVERLAP", 1000.0)
    joint: int = ident("JOINT")
    growth: int = _word_of("OVERLAP_DELTA", OVERLAP)  # derivative of the overlap with respect to the displacement
    inputs: frozenset[str] = read_by(_inputs, "INPUTS")  # those of `INPUTS` that contribute to the normal force
    yokes: str = _word_of("YOKE", YOKES)  # parts with friction in the arms of a universal joint's cross
    others = ("FORMULATION",)
    ignored = {
        "MAX_STICTION_DEFORMATION": "the joint slides slowly below STICTION_TRANSITION_VELOCITY",
        **dict.fromkeys(("INACTIVE", "INACTIVE_DURING"), "friction is zero in statics"),
    }
    refused = dict.fromkeys(_NOT_READ, "friction without it")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse other formulations, and friction that is inactive in a dynamic simulation."""
        _one_word(found, "FORMULATION", ("ORIGINAL",))
        for name in ("INACTIVE", "INACTIVE_DURING"):
            _one_word(found, name, ("STATICS",))
        _from_zero(found, "MU_STATIC")
