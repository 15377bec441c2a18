"""Writing of every channel over time to a file: .csv, .npz, .nc, .mat, .xlsx, .parquet, .tab, .res."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO
from zipfile import ZipFile, ZipInfo

import numpy as np

from ..dynamics.storage import blocks, release
from ..errors import InputError, refuse_missing
from ..reading.ascii import in_ascii
from ..reading.files.quoted import quoted
from .other_programs import write_excel, write_matlab, write_parquet
from .provenance import Provenance, metadata_file
from .saved import record
from .solution import Solution

NAMESPACE = "http://www.mscsoftware.com/:xrf10"


def _write_columns(path: Path, heads: Sequence[str], columns: Sequence[np.ndarray], delimiter: str, form: str) -> None:
    """Write columns of numbers below a line of heads, one block of rows after the other to save memory."""
    with path.open("w", encoding="utf-8") as file:
        print(delimiter.join(heads), file=file)
        for block in blocks(len(columns[0])):
            np.savetxt(file, np.column_stack([each[block] for each in columns]), fmt=form, delimiter=delimiter)
            release(*columns)


def _write_csv(path: Path, solution: Solution) -> None:
    # Columns of ones mark channels without a unique value, so that the names of channels stay unchanged.
    marks = {f"{name}.not_unique": np.broadcast_to(1.0, len(solution.time)) for name in solution.not_unique}
    heads = [f"{name} ({unit})" if (unit := solution.unit(name)) else name for name in ("time", *solution.channels)]
    columns = (solution.time, *solution.channels.values(), *marks.values())
    _write_columns(path, [*heads, *marks], columns, ",", "%.17g")


class WithoutSeeking:
    """Binary file without seeking, so that zipfile does not return to the header of each array."""

    def __init__(self, file: BinaryIO) -> None:
        self.write, self.flush = file.write, file.flush


def write_archive(path: Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Write an archive that `numpy.load` reads, one array after the other to save memory; `path` may be a pipe."""
    with path.open("wb", buffering=2**20) as file, ZipFile(WithoutSeeking(file), "w") as archive:  # type: ignore[call-overload]
        for name, values in arrays.items():
            with archive.open(ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
                if values.ndim == 1:
                    member.write(_head_of_channel(values.dtype, len(values)))
                    member.write(np.ascontiguousarray(values).data)
                else:
                    np.lib.format.write_array(member, values, allow_pickle=False)
            release(values)


@lru_cache
def _head_of_channel(dtype: np.dtype, count: int) -> bytes:
    """Return the head of an array in NumPy's format; a thousand channels have the same, and it is slow to write."""
    head = io.BytesIO()
    described = {"descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False, "shape": (count,)}
    np.lib.format.write_array_header_1_0(head, described)
    return head.getvalue()


def _write_npz(path: Path, solution: Solution) -> None:
    marked = {"not_unique": np.array(solution.not_unique)} if solution.not_unique else {}
    write_archive(path, {"time": solution.time, **solution.channels, **marked, **record(solution)})


def _write_netcdf(path: Path, solution: Solution) -> None:
    names: dict[str, str] = {}
    for channel in solution.channels:
        name = in_ascii(channel).replace(".", "_")  # the attribute `channel` is its name
        while name in names.values():  # front.left_arm.x and front_left.arm.x, or a request called like a channel
            name += "_"
        names[channel] = name
    solution.to_xarray().rename(names).to_netcdf(path, engine="scipy")


def _write_table(path: Path, solution: Solution) -> None:
    """Write tab-separated columns with names in double quotes, as Adams/PostProcessor exports tables."""
    heads = [f'"{name}"' for name in ("time", *solution.channels)]
    _write_columns(path, heads, (solution.time, *solution.channels.values()), "\t", "%.16e")


def _write_adams(path: Path, solution: Solution) -> None:
    """Write Adams' XML for Adams/PostProcessor (MSC Adams/Solver, RESULTS statement, XRF).

    A map that names the numbers of a step is followed by the steps.  The entity is the part of a channel's name before
    its last dot, the component the part after it.
    """
    from xml.sax.saxutils import quoteattr

    with path.open("w", encoding="utf-8") as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        file.write(f'<Results xmlns="{NAMESPACE}">\n<Analysis name={quoteattr(solution.name or "run")}>\n')
        file.write('<StepMap name="map_001">\n<Entity name="time">\n<Component name="TIME" id="1"/>\n</Entity>\n')
        for number, channel in enumerate(solution.channels, start=2):
            entity, _, component = channel.rpartition(".")
            file.write(
                f"<Entity name={quoteattr(entity or channel)}>\n"
                f'<Component name={quoteattr(component if entity else "")} id="{number}"/>\n</Entity>\n'
            )
        file.write('</StepMap>\n<Data name="dynamic_001">\n')
        columns = (solution.time, *solution.channels.values())
        for k in range(len(solution.time)):
            numbers = "\n".join(f"{column[k]:.16e}" for column in columns)
            file.write(f'<Step type="dynamic">\n{numbers}\n</Step>\n')
        file.write("</Data>\n</Analysis>\n</Results>\n")


WRITERS: dict[str, Callable[[Path, Solution], None]] = {
    ".csv": _write_csv, ".npz": _write_npz, ".nc": _write_netcdf, ".mat": write_matlab, ".xlsx": write_excel,
    ".parquet": write_parquet, ".tab": _write_table, ".res": _write_adams,
}  # fmt: skip
WITH_ORIGIN = ".npz", ".nc", ".mat", ".xlsx", ".parquet"
"""Endings of files that hold the origin of the results themselves."""
JINJA, MATPLOTLIB, MESHIO, XARRAY = (
    {"jinja2": "report"}, {"matplotlib": "plot"}, {"meshio": "flexible"}, {"xarray": "netcdf"},
)  # fmt: skip
OF_RESULTS = {".nc": XARRAY, ".xlsx": {"openpyxl": "tables"}, ".parquet": {"pyarrow": "tables"}}
KINDS: dict[str, dict[str, dict[str, str]]] = {
    "results": {ending: OF_RESULTS.get(ending, {}) for ending in WRITERS},
    "cases": {".nc": XARRAY, ".csv": XARRAY, ".html": {**XARRAY, **JINJA}},
    "curves": {".csv": {}},
    "curves of an axle": {".csv": {}, ".html": JINJA},
    "tyre": {".tir": {}},
    "mode shapes": {".vtu": MESHIO, ".vtk": MESHIO},
    "deformation": {".xdmf": {}},
    "fmu": {".fmu": {}},
    "figure": {".png": MATPLOTLIB, ".svg": MATPLOTLIB, ".pdf": MATPLOTLIB},
    "Campbell diagram": {".csv": {}, ".png": MATPLOTLIB, ".svg": MATPLOTLIB, ".pdf": MATPLOTLIB},
    "drawing": {".svg": MATPLOTLIB, ".png": MATPLOTLIB, ".pdf": MATPLOTLIB, ".json": {}},
    "animation": {".gif": MATPLOTLIB, ".mp4": MATPLOTLIB, ".html": JINJA},
    "modes in motion": {".html": JINJA},
    "report": {".html": {**JINJA, "matplotlib": "report"}},
}
"""Endings of the files that are written, by what they contain, with the packages needed and the extra of each."""


def refuse_path(option: str, path: Path, kind: str) -> None:
    """Reject the path of an option where no file of a kind of `KINDS` can be written, before anything is solved.

    Raises InputError if its suffix is another one, its folder is missing or not writable, or a package is missing.
    """
    endings = KINDS[kind]
    if path.suffix not in endings:
        expected = f"one of {', '.join(endings)}" if len(endings) > 2 else " or ".join(endings)
        raise InputError(f"{option} {path}: found the ending '{path.suffix}', expected {expected}")
    try:
        path.exists()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{option} {quoted(str(path))}: found a name that no file has ({reason})") from None
    if not path.parent.is_dir():
        raise InputError(f"{option} {path}: found no folder '{path.parent}', expected one that exists")
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise InputError(
            f"{option} {path}: found a place that cannot be written to, expected a file in a writable folder"
        )
    for package, extra in endings[path.suffix].items():
        refuse_missing(package, f"'stiffmbs[{extra}]'", f"{option} {path}: ")


def write(path: Path, solution: Solution) -> None:
    """Write all channels to a file, completely or not at all.

    The suffix selects the format (`WRITERS`). Channels without a unique value are marked: by a column
    ``rail.fy.not_unique`` of ones, an array ``not_unique`` of names, or the attribute ``unique`` of each variable. The
    origin of the results is in the file, or next to a table in ``NAME.csv-metadata.json``.
    """
    written_whole(path, lambda part: WRITERS[path.suffix](part, solution))
    if path.suffix not in WITH_ORIGIN:
        write_metadata(path, solution.provenance)


def write_table(path: Path, text: str, provenance: Provenance | None) -> None:
    """Write a table as text, and the origin of its results next to it."""
    write_text(path, text)
    write_metadata(path, provenance)


def write_metadata(path: Path, provenance: Provenance | None) -> None:
    """Write the origin of results to the file that accompanies a table; nothing next to a pipe or device."""
    if provenance is not None and path.is_file():
        write_text(metadata_file(path), provenance.as_json() + "\n")


def write_text(path: Path, text: str) -> None:
    """Write a text atomically: the file is complete or unchanged."""
    written_whole(path, lambda part: part.write_text(text, encoding="utf-8"))


def written_whole(path: Path, write_to: Callable[[Path], object]) -> None:
    """Write a file next to its place, and move it there when it is complete.

    `write_to`: function that writes to a given path.
    """
    if path.exists() and not path.is_file():  # a pipe or device
        write_to(path)
        return
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".part-", suffix=path.suffix)
    os.close(handle)
    try:
        write_to(Path(name))
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)  # mode of an ordinary new file; mkstemp's are private
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
