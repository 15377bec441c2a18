"""Compare random scenes of beams, flexible bodies, tyres of version 6 and joint coordinates with transformed copies."""

from __future__ import annotations

import numpy as np

from ..case import Verdict
from ..random_scenes.extended import extended_scene
from .invariances import judged, random_settings

WHAT = "random scenes of beams, flexible bodies, tyres of version 6, suspension springs and joint coordinates, as in invariances"


def trial(seed: int) -> Verdict:
    """Test one random scene with three random transformations."""
    rng = np.random.default_rng(seed)
    how = random_settings(rng, driven=False)
    return judged(extended_scene(rng), how, rng)
