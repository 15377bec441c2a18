"""Warnings on inputs with features shorter than fixed steps or than the output spacing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...compile.inputs.features import InputFeatures
from ...compile.inputs.of_time import Input
from ...tuning import tuned


@dataclass(frozen=True)
class NarrowInputParameters:
    """Parameters of the warnings on narrow features of inputs."""

    hidden: float = 0.05
    """Height of a peak between output times, relative to the input's change, above which it is reported."""
    samples: int = 8
    """Samples of an input between two output times."""
    most_samples: int = 5000
    """Samples in all of its narrow features."""
    stands: float = 1e-9
    """Change of an input, relative to its values, that may be rounding."""


NARROW_INPUTS = tuned("narrow_inputs", NarrowInputParameters())


def narrower_than_output(features: InputFeatures, spacing: float) -> str:
    """Return a sentence on features shorter than the output spacing; empty if there are none."""
    length, t = features.narrowest()
    if length >= spacing:
        return ""
    return (
        f"a prescribed motion or force has a feature of {length:.2g} s at t = {t:.6g} s, shorter than the {spacing:.2g} s "
        "between output points: peaks there may be missing; shorter output spacing or --verify shows them"
    )


def hidden_peak(inputs: Sequence[Input], features: InputFeatures, times: np.ndarray) -> str:
    """Return a sentence on an input with a peak between output times; empty if there is none."""
    parts = times[:-1, None] + np.diff(times)[:, None] * np.arange(NARROW_INPUTS.samples) / NARROW_INPUTS.samples
    narrow = features.instants(
        times[0], times[-1], float(np.max(np.diff(times), initial=0.0)), NARROW_INPUTS.most_samples
    )
    between = np.concatenate([parts.ravel(), narrow, features.breakpoints])
    for given in inputs if len(between) else ():
        with np.errstate(all="ignore"):
            shown, values = given.at(times), given.at(between)
        if not (np.isfinite(shown).all() and np.isfinite(values).all()):
            continue
        low, high = np.min(shown), np.max(shown)
        change, size = max(high, np.max(values)) - min(low, np.min(values)), np.max(np.abs(values))
        beyond = np.maximum(values - high, low - values)
        k = int(np.argmax(beyond))
        if beyond[k] > NARROW_INPUTS.hidden * change and change > NARROW_INPUTS.stands * size:
            return (
                f"'{given.text}' has a peak of {values[k]:.3g} at t = {between[k]:.6g} s, between output points, which show "
                f"it from {low:.3g} to {high:.3g}: shorter output spacing or --verify shows it"
            )
    return ""


def narrower_than_steps(features: InputFeatures, step: float, scheme: str) -> str:
    """Return a sentence on features shorter than the fixed steps; empty if there are none."""
    length, t = features.narrowest()
    if length >= step:
        return ""
    return (
        f"a prescribed motion or force has a feature of {length:.2g} s at t = {t:.6g} s, shorter than the steps of "
        f"{step:.2g} s that {scheme} takes: it may be followed badly or missed; take shorter steps, or dopri5, dop853 or bdf"
    )
