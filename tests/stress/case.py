"""What a case of stress is, and what can come of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import nan


class Outcome(Enum):
    """What came of a case: right, told in words, right but not finished in the time it is given, or silently wrong."""

    RIGHT = "right"
    TOLD = "told"
    SLOW = "slow"
    WRONG = "WRONG"


@dataclass(frozen=True)
class Verdict:
    """What came of a case, and how that is known.

    Attributes
    ----------
    outcome : Outcome
    error, allowed : floats
        Against a closed form or another computation, and the bound on it; NaN where there is nothing to measure.
    detail : str
        The message, for what was told; else what else there is to say.
    """

    outcome: Outcome
    error: float = nan
    allowed: float = nan
    detail: str = ""


@dataclass(frozen=True)
class Case:
    """A case of stress.

    Attributes
    ----------
    name : str
        In the command and in the table.
    what : str
        What is asked, and what the answer is compared with.
    judge : callable
        Does it and returns a `Verdict`; what it compares with does not come from the code that it judges.
    expected : Outcome
        What comes of it today; `Outcome.WRONG` for none.
    quick : bool
        Whether it belongs to the half that takes a second or two.
    """

    name: str
    what: str
    judge: Callable[[], Verdict]
    expected: Outcome = Outcome.RIGHT
    quick: bool = True


def measured(error: float, allowed: float, detail: str = "") -> Verdict:
    """Right where the error is within its bound; an error that is no number is wrong."""
    return Verdict(Outcome.RIGHT if error <= allowed else Outcome.WRONG, float(error), allowed, detail)


def told(message: str, names: tuple[str, ...], error: float = nan, allowed: float = nan) -> Verdict:
    """Told where the message has all that it is to name; what came before the stop must be right too."""
    missing = [name for name in names if name not in message]
    if missing:
        return Verdict(Outcome.WRONG, error, allowed, f"the message lacks {', '.join(map(repr, missing))}: {message}")
    if error > allowed:
        return Verdict(Outcome.WRONG, error, allowed, f"wrong before it stopped: {message}")
    return Verdict(Outcome.TOLD, error, allowed, message)


def tried(judge: Callable[[], Verdict]) -> Verdict:
    """What comes of a case or trial; an exception is wrong, as no user should have seen it."""
    try:
        return judge()
    except Exception as error:
        return Verdict(Outcome.WRONG, detail=f"{type(error).__name__}: {error}")
