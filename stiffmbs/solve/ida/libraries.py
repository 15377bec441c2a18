"""The SUNDIALS libraries that scikit-sundae was built with: found, loaded, and tried before they are used."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .declarations import declared

VERSION = 7
"""The major version of SUNDIALS that the declarations and the loop are written for."""
IDA_LIBRARIES = ("core", "ida")
SPARSE_LIBRARIES = ("core", "sunmatrixsparse", "sunlinsolsuperlumt")
COMPRESSED_COLUMNS = 0
"""CSC_MAT of sunmatrix_sparse.h."""


class Unavailable(Exception):
    """The libraries are not there or not those that this package knows; the text says which, in one sentence."""


@dataclass(frozen=True)
class Libraries:
    """Functions of SUNDIALS, as attributes by their names in C.

    Attributes
    ----------
    index : ctypes type
        What `sunindextype` is.
    """

    loaded: tuple[ctypes.PyDLL, ...]
    index: type[Any]

    def __getattr__(self, name: str) -> Any:
        function = self._found(name)
        function.restype, function.argtypes = self._declared[name]
        object.__setattr__(self, name, function)
        return function

    @cached_property
    def _declared(self) -> dict[str, tuple[Any, list[Any]]]:
        """What the headers say of all functions."""
        return declared(self.index)

    def _found(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        for library in self.loaded:
            if hasattr(library, name):
                return library[name]  # a new object, so that two index types never share a prototype
        raise Unavailable(f"the SUNDIALS libraries have no function {name}")

    def address(self, name: str) -> int:
        """A function's address, for compiled code."""
        if name not in self._addresses:
            address = ctypes.cast(self._found(name), ctypes.c_void_p).value
            assert address is not None
            self._addresses[name] = address
        return self._addresses[name]

    @cached_property
    def _addresses(self) -> dict[str, int]:
        """Those asked for so far."""
        return {}

    @cached_property
    def _with_threads(self) -> ctypes.PyDLL | None:
        """The library that works with OpenMP."""
        return next((lib for lib in self.loaded if hasattr(lib, "omp_set_num_threads")), None)

    @property
    def may_start_threads(self) -> bool:
        """Whether one of the libraries works with OpenMP."""
        return self._with_threads is not None

    @contextmanager
    def on_one_thread(self) -> Iterator[None]:
        """Keep OpenMP, which SuperLU_MT uses, from starting threads of its own that only wait for one another.

        Measured: on a machine with other work to do they make one small factorization last 15 ms instead of 0.03.
        """
        chosen = self._with_threads
        if chosen is None:
            yield
            return
        before = chosen.omp_get_max_threads()
        chosen.omp_set_num_threads(1)  # of the calling thread alone
        try:
            yield
        finally:
            chosen.omp_set_num_threads(before)

    @property
    def index_dtype(self) -> np.dtype[Any]:
        """`sunindextype` in numpy's words."""
        return np.dtype(self.index)


def available() -> tuple[bool, str]:
    """Whether IDA can be driven through the libraries, and if not, why: one sentence."""
    try:
        ida_libraries()
    except Unavailable as reason:
        return False, str(reason)
    return True, ""


@cache
def ida_libraries() -> Libraries:
    """IDA with vectors, dense and banded matrices.

    Raises
    ------
    Unavailable
        When they are not found, cannot be loaded, or are of another version or other types of numbers.
    """
    return _tried(_loaded(IDA_LIBRARIES))


@cache
def sparse_libraries() -> Libraries:
    """IDA together with sparse matrices and SuperLU_MT (and the large libraries that it needs in its turn).

    Raises
    ------
    Unavailable
        When scikit-sundae was built without SuperLU_MT.
    """
    return _tried((*_loaded(IDA_LIBRARIES), *_loaded(SPARSE_LIBRARIES)))


def _loaded(names: tuple[str, ...]) -> tuple[ctypes.PyDLL, ...]:
    folder = _folder()
    if hasattr(os, "add_dll_directory"):
        os.add_dll_directory(str(folder))  # Windows looks for what a library needs in declared folders alone
    try:
        return tuple(ctypes.PyDLL(str(_file(folder, name))) for name in names)  # Python makes short calls alone
    except OSError as error:
        raise Unavailable(f"the SUNDIALS libraries in {folder} cannot be loaded: {error}") from None


def _folder() -> Path:
    """Where the libraries of the installed scikit-sundae are; it is not imported for that (0.25 s)."""
    found = importlib.util.find_spec("sksundae")
    if found is None or not found.submodule_search_locations:
        raise Unavailable("scikit-sundae is not installed")
    package = Path(found.submodule_search_locations[0])
    folders = (
        package.parent / "scikit_sundae.libs",  # wheels for Linux and Windows
        package / ".dylibs",  # wheels for macOS
        Path(sys.prefix) / "lib",  # conda
        Path(sys.prefix) / "Library" / "bin",  # conda on Windows
    )
    for folder in folders:
        if _matching(folder, "ida"):
            return folder
    raise Unavailable(f"no SUNDIALS libraries found with scikit-sundae in {package.parent}")


def _file(folder: Path, name: str) -> Path:
    files = _matching(folder, name)
    if not files:
        raise Unavailable(f"no library sundials_{name} found in {folder}")
    return files[0]


def _matching(folder: Path, name: str) -> list[Path]:
    """Files such as libsundials_ida-16d992eb.so.7.9.0, libsundials_ida.7.dylib, sundials_ida-7.dll."""
    pattern = re.compile(rf"^(lib)?sundials_{name}(-[\w.-]+)?\.(so|dylib|dll|[\d.]+\.dylib)(\.[\d.]+)?$")
    return sorted(path for path in folder.glob(f"*sundials_{name}*") if pattern.match(path.name))


def _tried(loaded: tuple[ctypes.PyDLL, ...]) -> Libraries:
    """The libraries, after a trial of their version and of the types of their numbers."""
    try:
        trial = Libraries(loaded, ctypes.c_int64)  # small positive numbers pass alike, whatever the type is
        _check_version(trial)
        return Libraries(loaded, _index_type(trial))
    except AttributeError as error:
        raise Unavailable(f"the SUNDIALS libraries lack a function: {error}") from None


def _check_version(libraries: Libraries) -> None:
    parts = [ctypes.c_int() for _ in range(3)]
    label = ctypes.create_string_buffer(32)
    libraries.SUNDIALSGetVersionNumber(*(ctypes.byref(part) for part in parts), label, len(label))
    found = ".".join(str(part.value) for part in parts)
    if parts[0].value != VERSION:
        raise Unavailable(f"scikit-sundae carries SUNDIALS {found}, the native driver is made for version {VERSION}")


def _index_type(libraries: Libraries) -> type[Any]:
    """What `sunindextype` is, seen from the column starts 0 2 4 of a full matrix made sparse."""
    context = ctypes.c_void_p()
    libraries.SUNContext_Create(0, ctypes.byref(context))
    ones = np.ones(4)
    vector = libraries.N_VMake_Serial(4, ones.ctypes.data, context)
    dense = libraries.SUNDenseMatrix(2, 2, context)
    try:
        if libraries.N_VL1Norm_Serial(vector) != 4.0:
            raise Unavailable("the SUNDIALS libraries do not work in double precision")
        ctypes.memmove(libraries.SUNDenseMatrix_Data(dense), ones.ctypes.data, ones.nbytes)
        sparse = libraries.SUNSparseFromDenseMatrix(dense, 0.0, COMPRESSED_COLUMNS)
        starts = ctypes.string_at(libraries.SUNSparseMatrix_IndexPointers(sparse), 12)
        libraries.SUNMatDestroy(sparse)
    finally:
        libraries.SUNMatDestroy(dense)
        libraries.N_VDestroy(vector)
        libraries.SUNContext_Free(ctypes.byref(context))
    match tuple(np.frombuffer(starts, dtype=np.int32)):
        case (0, 2, 4):
            return ctypes.c_int32
        case (0, 0, 2):
            return ctypes.c_int64
    raise Unavailable("the SUNDIALS libraries count with integers that are neither of 32 nor of 64 bits")
