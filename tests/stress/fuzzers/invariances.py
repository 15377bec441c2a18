"""Compare random scenes with transformed copies that must have the same motion."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stiffmbs.errors import StiffmbsError

from ..case import Outcome, Verdict, measured
from ..invariance import bodies, descriptions, galilean, naming, rigid, similarity, time_shift, turns, ways
from ..invariance.balance import balance
from ..invariance.change import Change, Channels
from ..invariance.comparison import Difference, bars_of, compared
from ..invariance.typed import NotLegitimate
from ..invariance.ways import Found
from ..random_scenes.draft import Content, about_z, random_axes
from ..random_scenes.driven import driven_scene
from ..random_scenes.scene import random_scene

WHAT = "random scenes against copies that are rotated, translated, scaled, shifted in time, split, renamed, ..."
CHANGES = 3
"""Number of transformations of each scene."""
FINE, COARSE = 1e-8, 1e-6
"""Relative tolerances whose difference is the error bar."""
MORE = 16
"""Times the output times with which integrals of accelerations are assessed again."""
FAR = 1000.0
"""Translation of a scene, m."""
KINEMATIC = "kinematic"
BALANCE = "momentum of each body"
FEW_DIGITS = {"I3": ("moved by 1 km", "observed from a moving frame")}
"""Transformations after which formulations that divide positions by the step have too few digits for the fine tolerance."""
RARE = "a fixed pair as one body"
"""Transformation that few scenes allow, which is tried first."""
ALIKE = 0.3
"""Fraction of transformed scenes that are run with the settings of the original."""
OF_EXPANDED = (
    "turned", "moved by 1 km", "later", "renamed", "with an idle body", "embedded in space", "in stages", "in two runs", "step by step", "as a study",
)  # fmt: skip
"""Transformations of scenes with line bodies or flexible bodies."""
FREE = ("with an idle body",)
"""Transformations that add undriven degrees of freedom."""
SOLVERS: tuple[dict[str, Any], ...] = (
    {"solver": "bdf"}, {"solver": "bdf", "formulation": "SI1"}, {"solver": "bdf", "formulation": "I3"},
    {"solver": "bdf", "formulation": "index1"}, {"solver": "radau"}, {"solver": "auto"}, {"solver": "projected", "scheme": "dop853"},
    {"solver": "projected", "scheme": "dopri5"}, {"solver": KINEMATIC},
)  # fmt: skip


def trial(seed: int) -> Verdict:
    """Test one random scene with three random transformations."""
    rng = np.random.default_rng(seed)
    how = random_settings(rng)
    return judged(driven_scene(rng) if how["solver"] == KINEMATIC else random_scene(rng), how, rng)


def judged(content: Content, how: dict[str, Any], rng: np.random.Generator) -> Verdict:
    """Compare a scene, run with given settings, with three random transformations."""
    try:
        content = assembled(content)
        fine, coarse = (ways.at_once(content, **how, rtol=rtol) for rtol in (FINE, COARSE))
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=f"{json.dumps(how)}: {refusal}")
    if rubs_without_unique_reactions(content, fine):
        return Verdict(Outcome.TOLD, detail=f"{json.dumps(how)}: the motion is not unique")
    original = Original(content, how, fine, bars_of(fine, coarse))
    plain = not expanded(content)
    found = {BALANCE: _balanced(content, how, fine) if plain else Difference(0.0, "", "")}
    names = [name for name in WAYS if name != RARE] if plain else OF_EXPANDED
    for name in (RARE,) * plain + tuple(rng.permutation(names)):
        other = (
            how
            if rng.random() < ALIKE
            else random_settings(rng, driven=how["solver"] == KINEMATIC and name not in FREE)
        )
        if other["solver"] == KINEMATIC and name in FREE:
            continue
        with suppress(NotLegitimate):
            found[str(name)] = difference_of(original, str(name), rng, other)
        if len(found) == 1 + CHANGES:
            break
    worst = max(found, key=lambda name: found[name].ratio)
    stops = [f"{name}: {each.detail}" for name, each in found.items() if each.detail.startswith("stopped")]
    if stops and found[worst].ratio <= 1:
        return Verdict(Outcome.TOLD, detail=f"{json.dumps(how)}: {'; '.join(stops)}")
    others = ", ".join(name for name in found if name != worst)
    detail = f"{json.dumps(how)}: {worst}: {found[worst].channel} {found[worst].detail} (also {others})"
    return measured(found[worst].ratio, 1.0, detail)


@dataclass(frozen=True)
class Original:
    """Scene with the settings and results of its run.

    Attributes
    ----------
    content : dict
    how : dict
        Settings of the run, without its tolerance.
    fine : Found
    bars : dict of str to ndarray
        Error bars of the channels.
    """

    content: Content
    how: dict[str, Any]
    fine: Found
    bars: Channels


def _balanced(content: Content, how: dict[str, Any], fine: Found) -> Difference:
    """Assess the momentum of each body; where it is missed again at more output times, which integrals need."""
    found = balance(content, fine)
    if found.ratio <= 1:
        return found
    run = {**content["run"], "points": MORE * (content["run"]["points"] - 1) + 1}
    return balance(content, ways.at_once({**content, "run": run}, **how, rtol=FINE))


def random_settings(rng: np.random.Generator, driven: bool = True) -> dict[str, Any]:
    """Return a random solver and presolve setting."""
    solvers = [each for each in SOLVERS if driven or each["solver"] != KINEMATIC]
    return {**solvers[int(rng.integers(len(solvers)))], "presolve": bool(rng.random() < 0.6)}


def assembled(content: Content) -> Content:
    """Return a scene with consistent velocities, so that results do not depend on their projection."""
    found = ways.at_once({**content, "run": {**content["run"], "points": 2}}, rtol=COARSE)
    dimensions = content.get("dimensions", 2)
    described = {}
    for name, body in content["bodies"].items():
        if "type" in body:
            described[name] = body
            continue
        linear, angular = (
            [float(found.channels[f"{name}.{label}"][0]) for label in labels]
            for labels in (("vx", "vy", "vz")[:dimensions], ("wx", "wy", "wz") if dimensions == 3 else ("omega",))
        )
        described[name] = {**body, "velocity": linear, "omega": angular if dimensions == 3 else angular[0]}
    return {**content, "bodies": described}


def expanded(content: Content) -> bool:
    """Return True if a scene has line bodies or flexible bodies, which become several bodies."""
    return any("type" in body for body in content["bodies"].values())


def rubs_without_unique_reactions(content: Content, found: Found) -> bool:
    """Return True if friction depends on reactions without unique values, so that the motion is not unique."""
    rubbing = {force["joint"] for force in content.get("forces", {}).values() if force["type"] == "joint_friction"}
    return any(channel.rpartition(".")[0] in rubbing for channel in found.not_unique)


Way = Callable[[Content, np.random.Generator], tuple[Change, Callable[..., Found]]]
"""Return the transformations by name."""


def _turned(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    dimensions = content.get("dimensions", 2)
    rotation = random_axes(rng) if dimensions == 3 else about_z(float(rng.uniform(-3, 3)))
    return rigid.placed(content, rigid.Placing(rotation, np.zeros(3), dimensions), "turned"), ways.at_once


def _moved(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    dimensions = content.get("dimensions", 2)
    way = rng.standard_normal(3) * (1.0, 1.0, float(dimensions == 3))
    placing = rigid.Placing(np.eye(3), FAR * way / np.linalg.norm(way), dimensions)
    return rigid.placed(content, placing, "moved by 1 km"), ways.at_once


def _observed(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    flat = content.get("dimensions", 2) == 2
    return galilean.moving(content, rng.uniform(-5, 5, 3) * (1.0, 1.0, float(not flat))), ways.at_once


def _scaled(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    mass, length, time = (float(10 ** rng.uniform(-1, 1)) for _ in range(3))
    return similarity.scaled(content, similarity.Units(mass, length, time)), ways.at_once


def _later(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    return time_shift.shifted(content, float(rng.uniform(-10, 100))), ways.at_once


def _renamed(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    return naming.renamed(content, rng), ways.at_once


def _with_idle_body(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    return bodies.with_idle_body(content, rng), ways.at_once


def _in_two(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    return bodies.with_a_body_in_two(content, rng), ways.at_once


def _in_other_axes(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    return descriptions.in_other_axes(content, rng), ways.at_once


def _as_one_body(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    return descriptions.as_one_body(content, rng), ways.at_once


def _run_otherwise(way: Callable[..., Found], what: str) -> Way:
    return lambda content, rng: (Change(what, content), way)


def _embedded(content: Content, rng: np.random.Generator) -> tuple[Change, Callable[..., Found]]:
    if content.get("dimensions", 2) == 3:
        raise NotLegitimate("in space already")
    return Change("embedded in space", content), ways.embedded


IN_SPACE, WINDS_UP = "embedded in space", "rotated by three quarters of a revolution"
WAYS: dict[str, Way] = {
    "turned": _turned,
    "moved by 1 km": _moved,
    "observed from a moving frame": _observed,
    "scaled": _scaled,
    "later": _later,
    "renamed": _renamed,
    "with an idle body": _with_idle_body,
    "one body as two": _in_two,
    "a body in other own axes": _in_other_axes,
    RARE: _as_one_body,
    IN_SPACE: _embedded,
    "with full turns": lambda content, rng: (turns.with_full_turns(content, rng), ways.at_once),
    "with i and j exchanged": lambda content, rng: (turns.with_exchanged_markers(content, rng), ways.at_once),
    "in stages": _run_otherwise(ways.in_stages, "in stages"),
    "in two runs": _run_otherwise(ways.in_two_runs, "in two runs"),
    "step by step": _run_otherwise(ways.step_by_step, "step by step"),
    "as a study": _run_otherwise(ways.as_a_study, "as a study"),
}


def difference_of(
    original: Original, name: str, rng: np.random.Generator, settings: dict[str, Any] | None = None
) -> Difference:
    """Return the difference of a transformed scene, also with respect to its own error bar if it is too large.

    A stop of the transformed run is accepted only if the original stops with the same settings, for `FEW_DIGITS`, or where
    a bushing in space, which counts no turns, refuses the rotation of one in the plane.

    Parameters
    ----------
    original : Original
    name : str
        Name of the transformation.
    rng : Generator
    settings : dict, optional
        Settings of the transformed run; those of the original by default.

    Raises
    ------
    NotLegitimate
        When the transformation does not apply to this scene.
    """
    how = original.how if settings is None else settings
    change, way = WAYS[name](original.content, rng)
    what = f"{change.what} with {json.dumps(how)}"
    try:
        found = _back(change, way(change.content, **how, rtol=FINE))
        gap = compared(original.fine, found, original.bars)
        if gap.ratio <= 1.0:
            return gap
        own = bars_of(found, _back(change, way(change.content, **how, rtol=COARSE)))
    except StiffmbsError as stop:
        too_few = name in FEW_DIGITS.get(how.get("formulation", ""), ())
        beyond = name == IN_SPACE and WINDS_UP in str(stop)
        if too_few or beyond or (how != original.how and stops_too(original.content, how)):
            return Difference(0.0, what, f"stopped: {stop}")
        return Difference(float("inf"), what, str(stop))
    both = {channel: bar + own.get(channel, 0.0) for channel, bar in original.bars.items()}
    gap = compared(original.fine, found, both)
    return replace(gap, detail=f"{what}: {gap.detail}")


def stops_too(content: Content, how: dict[str, Any]) -> bool:
    """Return True if a scene stops or is refused with given settings."""
    try:
        for rtol in (FINE, COARSE):
            ways.at_once(content, **how, rtol=rtol)
    except StiffmbsError:
        return True
    return False


def _back(change: Change, found: Found) -> Found:
    """Return the channels of a run transformed back to those of the original."""
    channels = change.back(found.channels, found.time)
    owners = change.back({name: np.zeros_like(found.time) for name in found.not_unique}, found.time)
    return replace(found, channels=channels, not_unique=frozenset(owners))
