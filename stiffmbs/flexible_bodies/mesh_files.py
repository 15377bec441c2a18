"""Statements of Nastran and Abaqus files that the reader of meshes ignores or refuses."""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..errors import InputError

NASTRAN, ABAQUS = {".bdf", ".fem", ".nas"}, ".inp"
"""Suffixes of Nastran and Abaqus files."""
MASSES = {"CONM1", "CONM2", "CMASS1", "CMASS2", "CMASS3", "CMASS4"}
SURFACES = {"CTRIA3": 3, "CTRIAR": 3, "CQUAD4": 4, "CQUADR": 4}
"""Corners of the shells of Nastran of first order."""
BULK = "BEGIN BULK"
BULK_LINE = re.compile(r"^\s*BEGIN BULK", re.MULTILINE)
GMSH = ".msh"
ENDLESS = {".dat", ".tec", ".ele", ".node", ".off", ".ply", ".mdpa"}
"""Suffixes of formats (Tecplot, TetGen, OFF, PLY, Kratos) whose readers in meshio do not end at the end of an incomplete
file."""
SETS = re.compile(r"\*(NSET|ELSET)\b", re.IGNORECASE)
SAME_SURFACE = {"CPS6": "CPE6", "CPS8": "S8R", "M3D9": "S9R5"}
CURVED = {"CTRIA6": (6, 1), "CQUAD8": (8, 5)}
"""Nodes of the shells of Nastran of second order, and the place of their offset among the following fields."""
GMSH_SURFACES = re.compile(rf"^(\*ELEMENT\s*,\s*TYPE\s*=\s*)({'|'.join(SAME_SURFACE)})\b", re.IGNORECASE)
USED_OF_ABAQUS = {
    "*NODE", "*ELEMENT", "*NSET", "*ELSET", "*HEADING", "*INCLUDE", "*PART", "*END PART", "*ASSEMBLY", "*END ASSEMBLY", "*INSTANCE",
    "*END INSTANCE", "*PREPRINT",
}  # fmt: skip
"""Keywords of Abaqus that state the mesh, or nothing about it."""
LINES_OF_ABAQUS = ("B2", "B3", "T2D", "T3D", "PIPE", "FRAME")
"""Beginnings of the types of elements along lines."""
USED_OF_NASTRAN = (
    "GRID", "CTETRA", "CHEXA", "CPENTA", "CPYRA", "CTRIA", "CQUAD", "ENDDATA", "PARAM", "INCLUDE", "CEND", "BEGIN", "SOL", "SET",
)  # fmt: skip
"""Beginnings of the entries of Nastran that state the mesh, or nothing about it."""
NOT_ZERO = re.compile(r"[^EeDd]*[1-9]")


def refuse_ignored(path: Path) -> None:
    """Refuse local coordinate systems, several or moved instances, and files without an end. Raises InputError."""
    suffix = path.suffix.lower()
    if suffix in ENDLESS:
        raise InputError(
            f"found '{suffix}', expected another format; 'meshio convert {path.name} mesh.vtu' converts the mesh"
        )
    if suffix in NASTRAN:
        _check_nastran(path.read_text(encoding="utf-8", errors="replace"))
    elif suffix == ABAQUS:
        _check_abaqus(path)


def for_reader(path: Path) -> tuple[Path | io.StringIO, str | None]:
    """Return a mesh file, or what Gmsh writes with the words that meshio expects, and the format of that.

    These are bulk data of Nastran without the line before them, and Abaqus' elements of surfaces, which form groups only.
    """
    suffix = path.suffix.lower()
    if suffix not in {*NASTRAN, ABAQUS}:
        return path, "gmsh" if suffix == GMSH else None  # not of Ansys Fluent: that reader may not end
    text = path.read_text(encoding="utf-8", errors="replace")
    if suffix in NASTRAN:
        lines = "\n".join(_without_angles(text.splitlines())) + "\n"
        return io.StringIO(lines if BULK_LINE.search(text) else f"{BULK}\n{lines}"), "nastran"
    if suffix == ABAQUS:
        found = io.StringIO("\n".join(_without_sets(_lines(path))) + "\n")
        found.name = str(path)
        return found, "abaqus"
    return path, None


def _without_angles(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a Nastran file, shells with their nodes alone. Raises InputError for offsets and nodal thicknesses.

    The reader takes angles of materials and offsets for nodes.
    """
    shell = ""
    for line in _curved_in_short(lines):
        card = line[:8].partition(",")[0].strip().upper()
        if shell and (line.startswith(("+", ",")) or (line.strip() and not line[:8].strip())):  # the rest of the card
            if NOT_ZERO.search(line[8:] if "," not in line else line.partition(",")[2]):
                raise InputError(f"found {shell} with thicknesses at its nodes, expected one thickness of each element")
            continue
        shell = ""
        if card in SURFACES:
            fields = line.split(",") if "," in line else [line[k : k + 8] for k in range(0, 72, 8)]
            kept, shell = 3 + SURFACES[card], f"{card} {fields[1].strip()}"
            if len(fields) > kept + 1 and NOT_ZERO.match(fields[kept + 1]):
                raise InputError(
                    f"found {shell} with an offset of {fields[kept + 1].strip()}, expected nodes in the middle surface"
                )
            line = ",".join(fields[:kept]) if "," in line else line[: 8 * kept]
        yield line


def _curved_in_short(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a Nastran file, shells of second order with their nodes alone. Raises InputError for offsets and nodal thicknesses."""
    fields: list[str] = []
    for line in (*lines, ""):
        card = line[:8].partition(",")[0].strip().upper()
        own = line.split(",") if "," in line else [line[k : k + 8] for k in range(0, 72, 8)]
        if fields and (line.startswith(("+", ",")) or (line.strip() and not line[:8].strip())):
            fields += own[1:9] + [""] * (9 - len(own))
            continue
        if fields:
            yield from _nodes_of_curved(fields)
        fields = own[:9] + [""] * (9 - len(own)) if card in CURVED else []
        if not fields:
            yield line


def _nodes_of_curved(fields: list[str]) -> Iterator[str]:
    """Yield the lines of a shell of second order with its nodes alone. Raises InputError if it has an offset, or lacks a node."""
    name, number, *more = (field.strip() for field in fields)
    count, offset = CURVED[name.upper()]
    nodes, rest = more[1 : 1 + count], more[1 + count :]
    if not all(nodes) or len(nodes) < count:
        raise InputError(f"found {name} {number} without a node on each edge, expected {count} nodes")
    if len(rest) > offset and NOT_ZERO.match(rest[offset]):
        raise InputError(
            f"found {name} {number} with an offset of {rest[offset]}, expected nodes in the middle surface"
        )
    angle = 0 if offset == 1 else offset - 1
    if any(NOT_ZERO.match(field) for k, field in enumerate(rest) if k not in (angle, offset)):
        raise InputError(f"found {name} {number} with thicknesses at its nodes, expected one thickness of each element")
    written = [name, number, more[0], *nodes]
    yield ",".join(written[:9]) + (",+" if len(written) > 9 else "")
    if len(written) > 9:
        yield "+," + ",".join(written[9:])


def _without_sets(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines of an Abaqus file without its sets, and with the words of meshio for elements of surfaces."""
    left_out = False
    for line in lines:
        if line.startswith("*"):
            left_out = bool(SETS.match(line)) or line.upper().startswith("*INCLUDE")
        if not left_out:
            yield GMSH_SURFACES.sub(lambda found: found[1] + SAME_SURFACE[found[2].upper()], line)


def materials_of_sections(path: Path, what: str) -> list[str]:
    """Return the materials that the sections of an Abaqus or Nastran file have, each once. `what`: solid or shell."""
    suffix, found = path.suffix.lower(), []
    if suffix == ABAQUS:
        for words in (line.replace(" ", "").upper().split(",") for line in _lines(path)):
            if words[0] == f"*{what.upper()}SECTION":
                found += [word.removeprefix("MATERIAL=") for word in words if word.startswith("MATERIAL=")]
    elif suffix in NASTRAN:
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
            if line[:6].upper() == f"P{what.upper()}":
                found.append(f"MAT {_fields(line)[2].strip()}")
    return list(dict.fromkeys(found))


def unused(path: Path) -> str:
    """Return the statements of an Abaqus or Nastran file that are not used, and its beams; empty if there are none."""
    suffix = path.suffix.lower()
    if suffix == ABAQUS:
        words = [line.upper().split(",") for line in _lines(path) if line.startswith("*")]
        found = [first.strip() for first, *_ in words if first.strip() not in USED_OF_ABAQUS]
        types = (
            word.replace(" ", "").removeprefix("TYPE=")
            for first, *rest in words
            if first.strip() == "*ELEMENT"
            for word in rest
        )
        found += [f"elements {kind}" for kind in types if kind.startswith(LINES_OF_ABAQUS)]
    elif suffix in NASTRAN:
        text = path.read_text(encoding="utf-8", errors="replace").rpartition(BULK)[2]
        cards = (line[:8].split(",")[0].strip(" *").upper() for line in text.splitlines())
        found = [card for card in cards if card[:1].isalpha() and not card.startswith(USED_OF_NASTRAN)]
    else:
        return ""
    counts = Counter(found)
    return ", ".join(f"{name} ({count})" if count > 1 else name for name, count in counts.items())


def _fields(line: str) -> list[str]:
    """Return the first three fields of a Nastran card, or more."""
    second, third = (24, 40) if "*" in line[:8] else (16, 24)
    return line.split(",") if "," in line else [line[:8], line[8:second], line[second:third]]


def _check_nastran(text: str) -> None:
    if not any(line.startswith("ENDDATA") for line in text.rpartition(BULK)[2].splitlines()):
        raise InputError("found no line ENDDATA after the bulk data, expected a complete Nastran file")
    for line in text.splitlines():
        if (card := line[:8].split(",")[0].strip(" *").upper()) in MASSES:
            raise InputError(
                f"found {card}, a mass besides the elements, expected none: fix a rigid body to an interface"
            )
        if line[:4].upper() == "GRID" or line[:6].upper() == "GRDSET":
            fields = _fields(line)
            if len(fields) > 2 and fields[2].strip() not in ("", "0"):
                raise InputError(
                    f"found {fields[0].strip()} {fields[1].strip()} in the coordinate system {fields[2].strip()}, "
                    "expected positions in the basic one (CP empty)"
                )


def _check_abaqus(path: Path) -> None:
    instances, moved, numbers = 0, "", "expected one instance of one part without a translation or rotation"
    for line in _lines(path):
        words = line.replace(" ", "").upper().split(",")
        instances += words[0] == "*INSTANCE"
        offset = next((word for word in words if word.startswith("OFFSET=")), "")
        if words[0] == "*SHELLSECTION" and NOT_ZERO.match(
            offset.removeprefix("OFFSET=").replace("SNEG", "1").replace("SPOS", "1")
        ):
            raise InputError(
                f"found '{line.strip()}', expected shells whose nodes are in the middle surface, without an offset"
            )
        if words[0] == "*SYSTEM" or (
            words[0] == "*NODE" and any(word.startswith("SYSTEM=") and word != "SYSTEM=R" for word in words)
        ):
            raise InputError(f"found '{line.strip()}', expected positions in the global rectangular coordinate system")
    for keyword, _, words in data_lines(path):
        if keyword == "*INSTANCE" and any(NOT_ZERO.match(word) for word in words):
            moved = ", ".join(words)
    if instances > 1 or moved:
        raise InputError(f"found {f'an instance moved by {moved}' if moved else f'{instances} instances'}, {numbers}")


def sections(path: Path) -> Iterator[tuple[str, dict[str, str], list[list[str]]]]:
    """Yield each keyword of an Abaqus file, its options, and the words of its lines of data."""
    keyword, options, lines = "", dict[str, str](), list[list[str]]()
    for line in _lines(path):
        words = [word.strip() for word in line.split(",")]
        if not line.startswith("*"):
            lines.append(words)
            continue
        yield keyword, options, lines
        keyword, lines = words[0].upper(), []
        pairs = (word.partition("=") for word in words[1:])
        options = {key.strip().upper(): value.strip() for key, _, value in pairs}
    yield keyword, options, lines


def data_lines(path: Path) -> Iterator[tuple[str, dict[str, str], list[str]]]:
    """Yield the keyword, its options, and the words of each line of data."""
    for keyword, options, lines in sections(path):
        yield from ((keyword, options, words) for words in lines)


def _lines(path: Path, depth: int = 0) -> Iterator[str]:
    """Yield the lines of an Abaqus file and of those that it includes, without comments."""
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        if line.startswith("**") or not line.strip():
            continue
        yield line
        if line.upper().startswith("*INCLUDE") and depth < 10:
            included = path.parent / line.partition("=")[2].strip()
            if included.is_file():
                yield from _lines(included, depth + 1)
