"""What the settings of a run ask of its solver in vain, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..compile.system import System
from ..describe.settings import RunSettings
from ..solve import traits_of
from ..solve.solver import Traits


def settings_notes(settings: RunSettings, system: System) -> Iterator[str]:
    """Settings that were given and have no effect, and events that the steps may pass over."""
    traits = traits_of(settings)
    yield from _ignored(settings, traits)
    if not traits.locates_events and system.n_values("event_function"):
        yield (
            f"{traits.name} does not locate the breakpoints that forces have in the state (contacts, step, abs, tables), and a step of "
            f"{settings.step:g} s may pass over them; dopri5, dop853 and bdf see them"
        )


def _ignored(settings: RunSettings, traits: Traits) -> Iterator[str]:
    ignored = traits.ignored(settings)
    if ignored:
        given = [f"{name} = {f'{value:g}' if isinstance(value, float) else value}" for name, value in ignored.items()]
        reads = f"reads {_listed(traits.reads)}" if traits.reads else "follows the drives alone"
        yield f"{_listed(given)} {'has' if len(given) == 1 else 'have'} no effect: {traits.name} {reads}"


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
