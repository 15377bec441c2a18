"""Sentences on the verification of a run, and what follows from them."""

from __future__ import annotations

from collections.abc import Collection

INTERRUPTED = "verification interrupted by the user"
"""Sentence of a run that was completed, but whose verification was not: commands end with a failure."""
RERUN = "rerun with"
"""Beginning of the sentence on completed reruns."""
KINEMATIC = "kinematic: positions are exact up to rounding; the error bars are those of sampling"
"""Sentence of a run whose positions need no rerun."""


def has_reruns(verification: Collection[str]) -> bool:
    """Return True if a rerun was completed, or none was needed."""
    return any(sentence.startswith((RERUN, KINEMATIC)) for sentence in verification)


def verification_outcome(verification: Collection[str]) -> str:
    """Return the outcome of a verification as a phrase."""
    if INTERRUPTED in verification:
        return INTERRUPTED
    return "reruns agree within the error bars" if has_reruns(verification) else "not verified"
