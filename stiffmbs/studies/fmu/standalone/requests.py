"""Requests of a scene as outputs of states, which compiled code computes: an FMU then reports them without Python."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from ....errors import InputError
from ....model.files.written_scene import WrittenScene
from ....model.read_scene import read_changed
from ....model.scene import Scene

OF_REQUEST = "of_request_{}"
"""Name of the output of a request, by its number."""


def with_requests(scene: Scene, written: WrittenScene, outputs: Collection[str]) -> tuple[WrittenScene, dict[str, str]]:
    """Return the source of a scene with a transfer function of 1 for each request among `outputs`, and its channel by request.

    It is not possible for formulas of reactions, accelerations, energies or other requests, and for those of parts. A formula of time
    bounds the steps, so that only those of outputs have one.
    """
    section, found = written.content.get("requests"), {}
    for number, (name, output) in enumerate(scene.outputs().items()):
        if not isinstance(section, dict) or name.partition(".")[0] not in section or name not in outputs:
            continue
        channel = OF_REQUEST.format(number)
        change = f"states.{channel}", {"numerator": [1], "denominator": [1], "input": output.text}
        extended = replace(written, changes=(*written.changes, change))
        try:
            read_changed(extended, ())
        except InputError:
            continue
        written, found[name] = extended, channel
    return written, found
