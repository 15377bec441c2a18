"""FMUs of scenes (FMI 2.0): with Python, built by PythonFMU, or without."""

from __future__ import annotations

import copy
import json
import keyword
import re
import shutil
import sys
import tempfile
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...analyses.load_scene import load_scene
from ...errors import InputError, needs, refuse_text
from ...model.scene import Scene
from ...reading.did_you_mean import did_you_mean
from ...reading.files.yaml_text import scene_text
from ...results.files import refuse_path, written_whole
from ...results.requests import units_of
from ..simulation import simulation
from .standalone.build import Written, write_standalone_fmu
from .standalone.description import VERSIONS

ABOUT, SCENE = "model.json", "scene.yaml"
"""Files among the FMU's resources: its variables, and the scene."""
BUILT = "built.fmu"
_NOT_IN_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
USED = ("SceneSlave", "hold")
"""Names that the script of the FMU already uses."""
SCRIPT = '''"""The model of the FMU; it needs the package stiffmbs in the Python that runs it."""

from stiffmbs.studies.fmu.slave import SceneSlave, hold

hold(globals())


class {name}(SceneSlave):
    pass
'''
LONGEST_NAME = 60
"""Largest length of a model name, which is used for file names."""


def build_fmu(
    path: str | Path, output: str | Path, outputs: Sequence[str] = (), changes: Sequence[tuple[str, str]] = (), native: bool = False, version: str = "2.0"
) -> tuple[str, ...]:  # fmt: skip
    """Write an FMU: the scene's inputs, parameters, and channels as outputs.

    By default, the FMU is for co-simulation, and needs this package in the Python of the program that runs it.  A native
    FMU has machine code instead of Python, for co-simulation and model exchange.  Its parameters are fixed when it is
    written.  Inputs are constant over a communication step of co-simulation.

    Parameters
    ----------
    path : str or Path
        A scene's file, or an Adams/Solver dataset.
    output : str or Path
        Name that ends in .fmu.
    outputs : sequence of str, optional
        Channels; by default the requests of the scene, or all channels if it has none.
    changes : sequence of (path, text)
        Values that replace those of the file.
    native : bool, optional
        True for an FMU without Python; warnings tell what it does less well than a run.
    version : {'2.0', '3.0'}, optional
        Version of FMI; an FMU with Python is of version 2.0.

    Returns
    -------
    tuple of str
        Names of the outputs.

    Raises
    ------
    InputError
        If the scene is invalid, or has stages, or there is no such channel.  With Python, also if it needs files of other folders, or
        PythonFMU is missing; without, if only an FMU with Python can solve the scene, or there is no C compiler.
    """
    found = written_fmu(path, output, outputs, changes, native, version)
    for note in found.notes:
        warnings.warn(note, RuntimeWarning, stacklevel=2)
    return found.outputs


def written_fmu(
    path: str | Path, output: str | Path, outputs: Sequence[str], changes: Sequence[tuple[str, str]], native: bool, version: str
) -> Written:  # fmt: skip
    """Write an FMU, and return its outputs and notes; parameters and errors as for `build_fmu`."""
    refuse_text("outputs", outputs, "channels")
    target = Path(output)
    refuse_path("-o", target, "fmu")
    if version not in VERSIONS[: 1 + native]:
        others = " or ".join(VERSIONS) if native else f"{VERSIONS[0]}, or an FMU without Python"
        raise InputError(f"version: found '{version}', expected {others}")
    if native:
        scene = load_scene(path, changes)
        return write_standalone_fmu(scene, target, model_name(path), outputs, _NOT_IN_XML.sub("?", scene.name), version)
    return Written(_written_with_python(path, target, outputs, changes))


def _written_with_python(
    path: str | Path, target: Path, outputs: Sequence[str], changes: Sequence[tuple[str, str]]
) -> tuple[str, ...]:
    """Write an FMU that needs Python, and return its outputs."""
    with needs("pythonfmu", "fmu"):
        from pythonfmu.builder import FmuBuilder
    scene = load_scene(path, changes)
    name = model_name(path)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        (folder / SCENE).write_text(_content(scene), encoding="utf-8")
        others = _copied_files(scene, folder)
        about = _about(scene, folder / SCENE, outputs)
        (folder / ABOUT).write_text(json.dumps(about), encoding="utf-8")
        script = folder / f"{name}_fmu.py"
        script.write_text(SCRIPT.format(name=name), encoding="utf-8")
        before = list(sys.path)
        try:
            built = FmuBuilder.build_FMU(
                script, folder / BUILT, project_files=[folder / SCENE, folder / ABOUT, *others], canGetAndSetFMUstate=True, canSerializeFMUstate=True
            )  # fmt: skip
            written_whole(target, lambda part: shutil.copyfile(built, part))
        finally:
            sys.path[:] = before
            sys.modules.pop(script.stem, None)
    return tuple(about["outputs"])


def model_name(path: str | Path) -> str:
    """Return the model name of an FMU from the name of a scene file: an identifier of C and Python."""
    name = re.sub(r"\W+", "_", Path(path).stem, flags=re.ASCII).strip("_")[:LONGEST_NAME]
    fits = name[:1].isalpha() and not keyword.iskeyword(name) and name not in USED
    return name if fits else f"model_{name}".rstrip("_")


def _content(scene: Scene) -> str:
    """Return the scene as text, with everything that its file includes."""
    written = scene.written
    if written is None:
        raise InputError("found a scene that was not read from a file, expected a scene file")
    if written.changes:
        raise InputError("found --set, expected the unchanged scene of a file: its parameters can be set in the FMU")
    return scene_text(copy.deepcopy(dict(written.content)))


def _copied_files(scene: Scene, target: Path) -> tuple[Path, ...]:
    """Copy the files that a scene names in its own folder, such as meshes; return the copies, or folders with them."""
    written = scene.written
    if written is None:
        return ()
    folder = Path(written.folder or "").resolve()
    found = [Path(name).resolve() for name in written.files]
    own = [file.relative_to(folder) for file in found if file.is_file() and file.is_relative_to(folder)]
    kept = [file for file in own if str(file) not in (SCENE, ABOUT)]  # included scenes are in the text
    for file in kept:
        (target / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(folder / file, target / file)
    return tuple(dict.fromkeys(target / file.parts[0] for file in kept))


def _about(scene: Scene, copied: Path, outputs: Sequence[str]) -> dict[str, Any]:
    """Return the variables of the FMU, with their start values."""
    from ... import __version__

    try:
        alone = load_scene(copied)
        if alone.stages:
            raise InputError("found a scene with stages, expected a scene of one run")
    except InputError as error:
        raise InputError(
            f"scene within the FMU, with files of its own folder only: {str(error).replace(f'{copied.parent}/', '')}"
        ) from None
    inputs = {name: value for name, value in scene.inputs.items() if isinstance(value, float | int)}
    tables = [name for name in scene.inputs if name not in inputs]
    if tables:
        raise InputError(f"found a table for the input '{tables[0]}', expected a number")
    values = simulation(alone).channels
    parameters = {name: value for name, value in scene.parameters.items() if isinstance(value, float | int)}
    given = {**inputs, **parameters}
    free = tuple(name for name in values if name not in given)
    chosen = tuple(outputs) or tuple(name for name in free if name in scene.outputs()) or free
    if taken := [name for name in chosen if name in given]:
        raise InputError(f"found the output '{taken[0]}', which is an input or parameter of the FMU, expected another")
    unknown = [name for name in chosen if name not in values]
    if unknown:
        near = did_you_mean(unknown[0], values)
        raise InputError(f"found no channel '{unknown[0]}'{near}, expected one such as {', '.join(list(values)[:12])}")
    run = scene.run
    return {
        "description": _NOT_IN_XML.sub("?", scene.name), "version": __version__, "start": run.start, "stop": run.start + run.duration,
        "step": run.output or run.duration / 1000, "tolerance": run.rtol,
        "inputs": {name: float(value) for name, value in inputs.items()},
        "parameters": {name: float(value) for name, value in parameters.items()},
        "outputs": {name: values[name] for name in chosen}, "units": dict(units_of(scene, chosen)),
    }  # fmt: skip
