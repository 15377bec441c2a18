"""What is said of inputs whose features are narrower than fixed steps, or than the time between output points."""

from __future__ import annotations

from ...compile.inputs.features import InputFeatures


def narrower_than_output(features: InputFeatures, spacing: float) -> str:
    """A sentence where peaks may lie between output points; empty for nothing."""
    length, t = features.narrowest()
    if length >= spacing:
        return ""
    return (
        f"a prescribed motion or force has a feature of {length:.2g} s at t = {t:.6g} s, shorter than the {spacing:.2g} s "
        "between output points: peaks there may be missing; shorter output spacing or --verify shows them"
    )


def narrower_than_steps(features: InputFeatures, step: float, scheme: str) -> str:
    """A sentence where steps of one length may jump over features; empty for nothing."""
    length, t = features.narrowest()
    if length >= step:
        return ""
    return (
        f"a prescribed motion or force has a feature of {length:.2g} s at t = {t:.6g} s, shorter than the steps of "
        f"{step:.2g} s that {scheme} takes: it may be followed badly or missed; take shorter steps, or dopri5, dop853 or bdf"
    )
