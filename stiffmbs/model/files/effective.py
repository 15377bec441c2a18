"""Content of a scene file with its chosen options and its changes."""

from __future__ import annotations

import copy
from collections.abc import Sequence

from ...errors import prefixed
from ...reading.files.yaml_text import Content, read_yaml
from ..parts.changes import set_later, set_now, with_shipped
from ..parts.options import CHOOSE, OPTIONS, choices_of, with_chosen, words_chosen
from ..parts.placing import placed_in_use
from . import expand
from .written_scene import WrittenScene

Changes = Sequence[tuple[str, object]]
"""Values by their paths."""


def effective(written: WrittenScene) -> tuple[Content, dict[str, object]]:
    """Return a scene as in a file, with its changes, and those of entries that it repeats or that parts make, by their paths.

    The latter have no place in a scene file. Options are merged; of the section `options` the chosen words are left.
    """
    content = expand.unshared(copy.deepcopy(dict(written.content)))
    found, chosen, changes = chosen_options(content, written.changes, written.source)
    found, changes = placed_in_use(found, changes)
    in_parts: dict[str, object] = {}
    for path, value in changes:
        if set_later(path, found):
            in_parts[path] = value
        else:
            set_now(found, path, read_yaml(value, f"--set {path}") if isinstance(value, str) else value)
    keep_one_grid(found, {path for path, _ in changes})
    if words := chosen["words"]:
        own: Content = {name: {word: {}} for name, word in words.items() if name in chosen["choices"]}
        found |= {CHOOSE: words} | ({OPTIONS: own} if own else {})
    return found, in_parts


def chosen_options(
    found: dict[str, object], changes: Changes, source: str
) -> tuple[dict[str, object], Content, Changes]:
    """Return a scene with its chosen options merged, the choices for parts, and the other changes."""
    words = {path: value for path, value in changes if path.startswith(f"{CHOOSE}.")}
    for path, word in words.items():
        expand.set_value(found, path, word)
    with prefixed(f"{source}, "):
        chosen = {"words": words_chosen(found.get(CHOOSE)), "choices": tuple(choices_of(found, OPTIONS))}
        merged = with_chosen(found, chosen["words"], OPTIONS)
    merged.pop(CHOOSE, None)
    merged = with_shipped(merged, changes)
    return merged, chosen, [change for change in changes if change[0] not in words]


def keep_one_grid(found: dict[str, object], changed: set[str]) -> None:
    """Remove one of ``run.output`` and ``run.points`` if only the other one is changed."""
    run, grids = found.get("run"), ("output", "points")
    chosen = [name for name in grids if f"run.{name}" in changed]
    if isinstance(run, dict) and len(chosen) == 1:
        for name in grids:
            if name != chosen[0]:
                run.pop(name, None)
