"""FMUs of scenes without Python, for model exchange and co-simulation by FMI 2.0 or 3.0."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from uuid import NAMESPACE_URL, uuid5

from ....compile.machine.routines import fully_compiled
from ....model.scene import Scene
from ....notes import NoteKind, Severity
from ....results.files import written_whole
from ....tuning import in_use
from .description import description
from .header import header
from .library import C_CODE, linkable, linked_library, own_platform
from .model import ENTRIES, exported_model

NOTICES = C_CODE / "notices.txt"
"""Licences of parts of the library."""


LEFT_OUT = NoteKind(
    "fmu-requests",
    "requests of reactions, accelerations, energies, parts or other requests are computed by Python, and no outputs: {requests}",
    "request channels of the FMU by --channel, or write it without --native",
    Severity.REMARK,
)


class Written(NamedTuple):
    """Outputs of an FMU, and notes for the user."""

    outputs: tuple[str, ...]
    notes: tuple[str, ...] = ()


@fully_compiled()
def write_standalone_fmu(
    scene: Scene, target: Path, identifier: str, outputs: Sequence[str], text: str, version: str
) -> Written:
    """Write the FMU of a scene.

    `identifier`: name of the model. `outputs`: channels; by default the requests of the scene, or all channels that the FMU can
    compute. `text`: description. `version`: of FMI. Raises InputError if only an FMU with Python is possible, or there is no C compiler.
    """
    with in_use(scene.run.tuning):
        return _written(scene, target, identifier, outputs, text, version)


def _written(scene: Scene, target: Path, identifier: str, outputs: Sequence[str], text: str, version: str) -> Written:
    """Write the FMU with the parameters in use; see `write_standalone_fmu`."""
    of = own_platform()
    model = exported_model(scene, outputs)
    chosen, notes = tuple(outputs), model.notes
    if not chosen:
        requests = tuple(scene.outputs())
        chosen = tuple(name for name in requests if name in model.places) or requests or tuple(model.places)
        if left := [name for name in requests if name not in chosen]:
            notes = (*notes, LEFT_OUT(requests=", ".join(left)))
    places = model.chosen(chosen)
    found = linkable([*ENTRIES.values(), *model.image.functions], of)
    symbols = dict(zip(ENTRIES, found.names, strict=False))
    functions = found.names[len(ENTRIES) :]
    token = f"{{{uuid5(NAMESPACE_URL, header(model, '', symbols, functions) + repr(places))}}}"
    described = description(model, identifier, token, places, text, version)
    with tempfile.TemporaryDirectory() as made:
        library = linked_library(Path(made), found.code, {"model.h": header(model, token, symbols, functions)}, of)

    def write(part: Path) -> None:
        with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in (
                ("modelDescription.xml", described),
                (f"binaries/{of.folders[version]}/{identifier}{of.suffix}", library),
                ("documentation/licenses/notices.txt", NOTICES.read_bytes()),
            ):
                archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)  # without the date

    written_whole(target, write)
    return Written(tuple(places), notes)
