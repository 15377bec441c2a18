"""Environments of Gymnasium, for learning controllers of scenes (the extra ``gym``).

Examples
--------
>>> import stiffmbs.gym
>>> environment = stiffmbs.gym.Environment("cart.yaml", actions={"F": (-10, 10)}, observations=["cart.x"], reward="-cart.x^2")
"""

from .errors import refuse_missing

refuse_missing("gymnasium", "'stiffmbs[gym]'", "stiffmbs.gym: ")

from .studies.environments.environment import Environment  # noqa: E402
from .studies.environments.vector import VectorEnvironment  # noqa: E402

__all__ = ["Environment", "VectorEnvironment"]
