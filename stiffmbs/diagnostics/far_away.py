"""Mechanisms so far from the origin that the rounding of their coordinates is as large as what joints hold."""

from __future__ import annotations

import sys

from ..describe.model_data import ModelData
from ..errors import InputError

COARSE = 1e-6
"""Part of a mechanism's size up to which its coordinates may be rounded."""


def refuse_far_away(model: ModelData) -> None:
    """Refuse joints whose equations are rounding: no solver can satisfy them, however short its steps.

    Parameters
    ----------
    model : ModelData

    Raises
    ------
    InputError
        Names the body.
    """
    if not model.joints:
        return
    farthest = {name: max(map(abs, body.coordinates()[: model.dimensions])) for name, body in model.bodies.items()}
    name = max(farthest, key=lambda body: farthest[body])
    rounding, size = farthest[name] * sys.float_info.epsilon, model.size()
    if rounding > COARSE * size:
        raise InputError(
            f"bodies.{name}.position: found {farthest[name]:.3g} m in a mechanism of {size:.3g} m, where neighbouring "
            f"numbers are {rounding:.1g} m apart, expected it nearer to the origin"
        )
