"""Random states, algebraic states, filters and linear systems."""

from __future__ import annotations

from .draft import Draft
from .laws import law_of_motion


def add_state(draft: Draft) -> str:
    """Add a state that follows a formula with a lag."""
    name = draft.add("states", "lag", start=draft.uniform(-0.5, 0.5))
    lag = draft.uniform(0.05, 0.3)
    draft.content["states"][name]["rate"] = (
        f"({law_of_motion(draft, draft.choice(draft.bodies), 1.0, name)} - {name})/{lag!r}"
    )
    return name


def add_sampled_state(draft: Draft) -> str:
    """Add a state that steps towards a formula at the times of a clock."""
    name = draft.add("states", "sampled", start=draft.uniform(-0.5, 0.5), period=draft.uniform(0.01, 0.2))
    draft.content["states"][name]["offset"] = draft.uniform(0, 0.1)
    law = law_of_motion(draft, draft.choice(draft.bodies), 1.0, name)
    draft.content["states"][name]["update"] = f"{name} + {draft.uniform(0.1, 0.9)!r}*(({law}) - {name})"
    return name


def add_algebraic_state(draft: Draft) -> str:
    """Add an algebraic state with a monotone equation."""
    name = draft.add("states", "solved", start=0.0)
    A, law = draft.uniform(0.2, 1), law_of_motion(draft, draft.choice(draft.bodies), 1.0, name)
    draft.content["states"][name]["zero"] = f"{name} + {A!r}*{name}^3 - ({law})"
    return name


def add_filter(draft: Draft) -> str:
    """Add a low-pass filter of second order."""
    w, law = draft.uniform(5, 20), law_of_motion(draft, draft.choice(draft.bodies), 1.0)
    return draft.add("states", "smooth", numerator=[w**2], denominator=[1, 1.4 * w, w**2], input=law)


def add_linear_system(draft: Draft) -> str:
    """Add a linear system of two states."""
    law = law_of_motion(draft, draft.choice(draft.bodies), 1.0)
    a = [[-draft.uniform(1, 5), draft.uniform(-1, 1)], [draft.uniform(-1, 1), -draft.uniform(1, 5)]]
    return draft.add("states", "system", a=a, b=[[0.0], [1.0]], c=[[1.0, draft.uniform(-1, 1)]], input=law)


def add_controller(draft: Draft) -> str:
    """Add a PID controller of a coordinate."""
    pid = {
        "input": f"{draft.choice(draft.bodies)}.x", "setpoint": draft.uniform(-0.5, 0.5), "kp": draft.uniform(1, 3),
        "ki": draft.uniform(0.5, 2), "kd": draft.uniform(0.05, 0.2), "filter": draft.uniform(0.05, 0.1),
    }  # fmt: skip
    return draft.add("states", "control", pid=pid)
