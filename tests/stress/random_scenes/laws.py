"""Random formulas of motion, of few structures, so that few kernels are derived for many scenes."""

from __future__ import annotations

from .draft import Draft

DRAG = 2.0
"""Largest drag coefficient, N s/m."""


def law_of_motion(draft: Draft, body: str, size: float, name: str | None = None) -> str:
    """Return a formula of the motion of a body, time, states, inputs or tables, with values of a given size.

    Parameters
    ----------
    draft : Draft
    body : str
        Body whose coordinates the formula uses.
    size : float
        Size in SI units.
    name : str, optional
        State that contains the formula, and that the formula must not use.
    """
    sorts = ["spring", "drag", "measured"]
    features = draft.features
    states = [state for state in draft.content.get("states", ()) if state != name]
    sorts += ["wave", "rise", "table"] if features.time else []
    sorts += ["stop", "clipped"] if features.events else []
    sorts += ["state"] * 2 if states else []
    sorts += ["input"] if draft.content.get("inputs") else []
    A, place = draft.uniform(0.3, 1) * size, _coordinate(draft, body)
    match draft.choice(sorts):
        case "spring":
            return f"-{A!r}*({place} - ({draft.uniform(-0.5, 0.5)!r}))"
        case "drag":
            return f"-{A!r}*tanh({_velocity(draft, body)}/{draft.uniform(0.5, 1)!r})"
        case "measured":
            other = draft.choice(name for name in draft.poses if name != body)
            return (
                f"-{A!r}*(dm({body}, {other}) - {draft.uniform(0.2, 1)!r}) - {A / 10!r}*vr({body}, {other})"
                if (_apart(draft, body, other))
                else f"-{A!r}*{place}"
            )
        case "wave":
            return f"{A!r}*sin({draft.uniform(2, 12)!r}*t + {draft.uniform(0, 3)!r})"
        case "rise":
            begin = draft.uniform(0.02, 0.1)
            return f"{A!r}*step(t, {begin!r}, 0, {begin + draft.uniform(0.02, 0.2)!r}, 1)"
        case "table":
            return f"{A!r}*{table(draft)}(t)"
        case "stop":
            return f"-{10 * A!r}*max({place} - ({draft.uniform(-0.2, 0.2)!r}), 0)"
        case "clipped":
            return f"{A!r}*min(max({place}, {draft.uniform(-0.2, 0)!r}), {draft.uniform(0, 0.2)!r})"
        case "input":
            return f"{A!r}*{draft.choice(draft.content['inputs'])}"
    return f"{A!r}*tanh({draft.choice(states)})"


def law_of_time(draft: Draft, size: float) -> str:
    """Return a smooth formula of time that is zero at t = 0, with values of a given size."""
    A = draft.uniform(0.3, 1) * size
    sort = draft.choice(["wave", "rise", "constant rate"])
    if sort == "wave":
        return f"{A!r}*sin({draft.uniform(1, 6)!r}*t)"
    if sort == "rise":
        return f"{A!r}*step5(t, {draft.uniform(0.02, 0.1)!r}, 0, {draft.uniform(0.3, 0.6)!r}, 1)"
    return f"{A!r}*t"


def table(draft: Draft) -> str:
    """Add a linear or smooth table over time, and return its name."""
    name = f"curve{len(draft.section('tables'))}"
    points = [[round(0.1 * k, 3), draft.uniform(-1, 1)] for k in range(int(draft.rng.integers(3, 7)))]
    draft.section("tables")[name] = {"table": points, **draft.choice([{"lines": True}, {"akima": True}, {}])}
    return name


def _apart(draft: Draft, i: str, j: str) -> bool:
    """Return True if the origins of two bodies are distinct, so that their distance has a direction."""
    return float(abs(draft.poses[i].point - draft.poses[j].point).max()) > 0.3


def _coordinate(draft: Draft, body: str) -> str:
    """Return a coordinate of a body, or a measure relative to another, with the dimension of length."""
    axis = draft.choice("xyz"[: draft.dimensions])
    other = draft.choice(draft.poses)
    if draft.chance(0.5) or other == body:
        return f"{body}.{axis}"
    return f"d{axis}({body}, {other}, {other})" if draft.chance(0.5) else f"d{axis}({body}, {other})"


def _velocity(draft: Draft, body: str) -> str:
    axis = draft.choice("xyz"[: draft.dimensions])
    other = draft.choice(draft.poses)
    if draft.chance(0.5) or other == body:
        return f"{body}.v{axis}"
    return f"v{axis}({body}, {other}, {other})" if draft.chance(0.5) else f"v{axis}({body}, {other})"
