"""Loading of scenes from Adams datasets."""

from __future__ import annotations

import copy
import os
import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ..elements.spatial.massless import BEYOND
from ..errors import InputError, prefixed
from ..model.read_scene import made_scene
from ..model.scene import Scene
from ..reading.files.text_file import STANDARD_INPUT, checked, file_text, source_name
from ..reading.files.yaml_text import Content, scene_text
from .commands.commands import Segment, read_commands
from .scene.scene import scene
from .stages import followed
from .statements.changes import SWITCHED, Changes, key_of
from .statements.dataset import NO_CHANGES, Dataset, all_statements, read_dataset
from .statements.keywords import REFUSED
from .statements.text import ZERO_BYTE, CommandFault, DatasetFault

COMMANDS = ".acf"
"""Extension of a command file."""
_LABEL = re.compile(r"\b([A-Z_]+)/(\d+)\b(?=((?:(?!\bline \d).)*))")
"""Statement with its number in a message, and the text up to the next line number."""
ENCODING = "latin-1"
"""Encoding of a dataset that is not UTF-8."""


def read_adams(text: str, changes: Sequence[tuple[str, str]] = (), source: str = "dataset") -> Scene:
    """Read a scene from the text of a dataset.

    `changes`: values that replace those of the dataset, such as ``("bodies.PART_2.mass", "12 kg")``. `source`: name of
    the dataset in messages. Raises InputError if a statement cannot be read, or the dataset is not a valid model; names
    the line and the statement.
    """
    dataset, found = _scene(text, source)
    return made_scene(found, changes, source, lambda path: _line(dataset, path))


def load_adams(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> Scene:
    """Load a scene from a dataset file and the command file of the same name, if any; errors as `read_adams`."""
    dataset, found = _commanded(path)
    return made_scene(found, changes, source_name(path), lambda path: _line(dataset, path))


def convert_file(path: str | Path) -> str:
    """Return the scene of a dataset file as the text of a scene file, with Adams/View names as comments.

    Errors are those of `read_adams`.
    """
    dataset, found = _commanded(path)
    made_scene(copy.deepcopy(found), (), source_name(path), lambda path: _line(dataset, path))
    return scene_text(_with_aliases(dataset, found))


def command_file(path: str | Path) -> Path | None:
    """Return the command file of a dataset file; None if there is none."""
    commands_file = Path(path).with_suffix(COMMANDS)
    return None if commands_file.stem == STANDARD_INPUT or not os.path.isfile(commands_file) else commands_file


def other_commands(commands_file: Path, name: str) -> str:
    """Read the command file named by FILE/COMMAND, relative to the folder of the file `commands_file`."""
    path = commands_file.parent / name
    return file_text(path if path.suffix else path.with_suffix(COMMANDS), ENCODING)


def _with_aliases(dataset: Dataset, found: Content) -> dict[str, object]:
    """Return the scene with the Adams/View names of its elements as comments."""
    from ruamel.yaml.comments import CommentedMap

    aliases = {f"{x.label.replace('/', '_')}": x.alias for kind in dataset.statements.values() for x in kind.values()}
    for section in ("bodies", "joints", "forces", "variables", "requests"):
        if section in found:
            found[section] = CommentedMap(found[section])
            for name in found[section]:
                if aliases.get(name, "") not in ("", name):
                    found[section].yaml_add_eol_comment(aliases[name], name)
    return found


def _scene(text: str, source: str, changes: Changes = NO_CHANGES) -> tuple[Dataset, Content]:
    text = checked(text, source, ZERO_BYTE)
    try:
        dataset = read_dataset(text, changes)
        return dataset, scene(dataset)
    except CommandFault:
        raise
    except DatasetFault as fault:
        raise InputError(f"{source}, {fault}{_without(str(fault))}") from None
    except np.linalg.LinAlgError:
        raise InputError(f"{source}: {BEYOND}") from None
    except InputError as error:
        raise InputError(f"{source}: {error}{_without(str(error))}") from None


def _without(message: str) -> str:
    """Return how to run a dataset without the statements that a message names as unsupported; empty if it names none."""
    idents: dict[str, list[str]] = {}
    for name, ident, reason in _LABEL.findall(message):
        if name in SWITCHED and (name in ("CONTACT", *REFUSED) or "USER" in reason.upper()):
            idents.setdefault(name, []).append(ident)
    if not idents:
        return ""
    commands = "; ".join(f"DEACTIVATE/{name}, ID={', '.join(dict.fromkeys(found))}" for name, found in idents.items())
    return f". To run the dataset without them, write in a command file of the same name ({COMMANDS}): {commands}"


def _commanded(path: str | Path) -> tuple[Dataset, dict[str, object]]:
    """Load a dataset file with the changes and simulations of its command file, if any."""
    text, source = file_text(path, ENCODING, ZERO_BYTE), source_name(path)
    commands_file = command_file(path)
    if commands_file is None:
        return _scene(text, source)
    with prefixed(f"{commands_file}, ", DatasetFault):
        known = {key_of(statement) for statement in all_statements(checked(text, source, ZERO_BYTE))[1]}
        asked = read_commands(file_text(commands_file, ENCODING), known, partial(other_commands, commands_file))
    first = asked.segments[0].changes if asked.segments else asked.changes
    with prefixed(f"{commands_file}, ", CommandFault):
        dataset, found = _scene(text, source, first)
    reported = [*first.notes(commands_file.name), *asked.notes]
    if asked.segments:

        def read(segment: Segment) -> tuple[Dataset, dict[str, object]]:
            return _scene(text, source, segment.changes)

        with prefixed(f"{commands_file}, ", DatasetFault):
            added = followed(asked.segments, (dataset, found), read, commands_file.name)
        reported = [*added.pop("notes"), *reported]
        found |= added
    notes = [*found.get("notes", ()), *reported]
    return dataset, found | ({"notes": notes} if notes else {})


def _line(dataset: Dataset, path: Sequence[object]) -> int | None:
    """Return the line of the statement from which the scene element at a path was made."""
    for name in path[1:2]:
        keyword, _, rest = str(name).rpartition("_")
        number = re.match(r"\d+", rest)
        if number and (found := dataset.statements.get(keyword, {}).get(int(number[0]))):
            line: int = found.line
            return line
    return None
