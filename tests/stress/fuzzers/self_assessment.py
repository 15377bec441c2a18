"""Estimated errors of random scenes, against the differences from runs of other integrators with far smaller tolerances."""

from __future__ import annotations

from stiffmbs.errors import StiffmbsError

from ..case import Outcome, Verdict, told
from ..self_assessment import assess, drawn

WHAT = "estimated errors of random scenes: errors five times too small without a note, and false notes, against smaller tolerances"
TOO_SMALL = 0.2
"""Estimate in the true error below which it is wrong unless the errors are noted."""


def trial(seed: int) -> Verdict:
    """Judge the estimate of one run of bdf or radau; runs whose references differ are told."""
    scene, how = drawn(seed, "bdf" if seed % 3 else "radau")
    try:
        found = assess(scene, how)
    except StiffmbsError as refusal:
        return told(f"{refusal} [{how}]", ())
    ratios = found.ratios()
    detail = f"{how}: {found.status}, {ratios}"
    if not ratios:
        return Verdict(Outcome.TOLD, detail=detail)
    least = min(ratios.values())
    if found.is_false or found.is_silent or (least < TOO_SMALL and not found.noted):
        return Verdict(Outcome.WRONG, least, TOO_SMALL, detail)
    return Verdict(Outcome.RIGHT, least, TOO_SMALL, detail)
