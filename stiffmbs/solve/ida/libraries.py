"""SUNDIALS libraries of scikit-sundae: search, loading and validation."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import re
import sys
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...errors import SolverError

VERSION: Final = 7
"""Major version of SUNDIALS that the declarations and the loop are written for."""
IDA_LIBRARIES = ("core", "ida")


class Unavailable(SolverError):
    """Error if the libraries are missing or unknown."""

    def __init__(self, reason: str) -> None:
        super().__init__(
            f"solvers bdf and radau: {reason}; expected the libraries of a wheel of scikit-sundae 1.2 or later with SUNDIALS {VERSION}; "
            "use solver projected"
        )


@dataclass(frozen=True)
class Libraries:
    """SUNDIALS functions, as attributes by their C names."""

    loaded: tuple[ctypes.PyDLL, ...]

    def __getattr__(self, name: str) -> Any:
        function = self._found(name)
        function.restype, function.argtypes = declared()[name]
        object.__setattr__(self, name, function)
        return function

    def _found(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        for library in self.loaded:
            if hasattr(library, name):
                return library[name]
        raise Unavailable(f"the SUNDIALS libraries have no function {name}")

    def address(self, name: str) -> int:
        """Return the address of a function, for compiled code."""
        if name not in self._addresses:
            address = ctypes.cast(self._found(name), ctypes.c_void_p).value
            assert address is not None
            self._addresses[name] = address
        return self._addresses[name]

    @cached_property
    def _addresses(self) -> dict[str, int]:
        return {}


@cache
def ida_libraries() -> Libraries:
    """Load IDA with its vectors, matrices and solvers.

    Raises Unavailable if they are not found, cannot be loaded, or have another version or precision.
    """
    libraries = Libraries(_loaded())
    try:
        _check_version(libraries)
        _check_precision(libraries)
    except AttributeError as error:
        raise Unavailable(f"the SUNDIALS libraries lack a function: {error}") from None
    return libraries


def _loaded() -> tuple[ctypes.PyDLL, ...]:
    folder = _folder()
    if hasattr(os, "add_dll_directory"):
        os.add_dll_directory(str(folder))  # Windows searches dependencies in declared folders only
    try:
        return tuple(ctypes.PyDLL(str(_file(folder, name))) for name in IDA_LIBRARIES)  # keeps the GIL in short calls
    except OSError as error:
        raise Unavailable(f"the SUNDIALS libraries in {folder} cannot be loaded: {error}") from None


def _folder() -> Path:
    """Return the folder of the libraries of scikit-sundae, without the cost of its import."""
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
    """Return files such as libsundials_ida-16d992eb.so.7.9.0, libsundials_ida.7.dylib, sundials_ida-7.dll."""
    pattern = re.compile(rf"^(lib)?sundials_{name}(-[\w.-]+)?\.(so|dylib|dll|[\d.]+\.dylib)(\.[\d.]+)?$")
    return sorted(path for path in folder.glob(f"*sundials_{name}*") if pattern.match(path.name))


def _check_version(libraries: Libraries) -> None:
    parts = [ctypes.c_int() for _ in range(3)]
    label = ctypes.create_string_buffer(32)
    libraries.SUNDIALSGetVersionNumber(*(ctypes.byref(part) for part in parts), label, len(label))
    found = ".".join(str(part.value) for part in parts)
    if parts[0].value != VERSION:
        raise Unavailable(f"scikit-sundae carries SUNDIALS {found}, the native driver is made for version {VERSION}")


def _check_precision(libraries: Libraries) -> None:
    context, ones = ctypes.c_void_p(), np.ones(4)
    libraries.SUNContext_Create(0, ctypes.byref(context))
    vector = libraries.N_VMake_Serial(len(ones), ones.ctypes.data, context)
    norm = libraries.N_VL1Norm_Serial(vector)
    libraries.N_VDestroy(vector)
    libraries.SUNContext_Free(ctypes.byref(context))
    if norm != np.sum(ones):
        raise Unavailable("the SUNDIALS libraries do not work in double precision")


DECLARATIONS = """
int SUNDIALSGetVersionNumber(int*, int*, int*, char*, int)
int SUNContext_Create(int, SUNContext*)
int SUNContext_ClearErrHandlers(SUNContext)
int SUNContext_Free(SUNContext*)

N_Vector N_VMake_Serial(sunindextype, double*, SUNContext)
double* N_VGetArrayPointer(N_Vector)
double N_VL1Norm_Serial(N_Vector)
void N_VDestroy(N_Vector)

SUNMatrix SUNDenseMatrix(sunindextype, sunindextype, SUNContext)
double* SUNDenseMatrix_Data(SUNMatrix)
SUNMatrix SUNBandMatrix(sunindextype, sunindextype, sunindextype, SUNContext)
double* SUNBandMatrix_Data(SUNMatrix)
sunindextype SUNBandMatrix_LDim(SUNMatrix)
sunindextype SUNBandMatrix_StoredUpperBandwidth(SUNMatrix)
void SUNMatDestroy(SUNMatrix)

SUNLinearSolver SUNLinSol_Dense(N_Vector, SUNMatrix, SUNContext)
SUNLinearSolver SUNLinSol_Band(N_Vector, SUNMatrix, SUNContext)
int SUNLinSolInitialize(SUNLinearSolver)
int SUNLinSolSetup(SUNLinearSolver, SUNMatrix)
int SUNLinSolSolve(SUNLinearSolver, SUNMatrix, N_Vector, N_Vector, double)
int SUNLinSolFree(SUNLinearSolver)

SUNNonlinearSolver SUNNonlinSol_Newton(N_Vector, SUNContext)
int SUNNonlinSolSetConvTestFn(SUNNonlinearSolver, SUNNonlinSolConvTestFn, void*)
int SUNNonlinSolGetCurIter(SUNNonlinearSolver, int*)
int SUNNonlinSolFree(SUNNonlinearSolver)

void* IDACreate(SUNContext)
int IDAInit(void*, IDAResFn, double, N_Vector, N_Vector)
int IDAReInit(void*, double, N_Vector, N_Vector)
int IDASVtolerances(void*, double, N_Vector)
int IDASetUserData(void*, void*)
int IDASetLinearSolver(void*, SUNLinearSolver, SUNMatrix)
int IDASetJacFn(void*, IDALsJacFn)
int IDASetMaxOrd(void*, int)
int IDASetId(void*, N_Vector)
int IDASetSuppressAlg(void*, int)
int IDASetMaxStep(void*, double)
int IDASetEtaFixedStepBounds(void*, double, double)
int IDASetEtaLow(void*, double)
int IDASetEtaMinErrFail(void*, double)
int IDASetInitStep(void*, double)
int IDASetMaxNumSteps(void*, long)
int IDASetNonlinearSolver(void*, SUNNonlinearSolver)
int IDASetNonlinConvCoef(void*, double)
int IDASetDeltaCjLSetup(void*, double)
int IDASetStopTime(void*, double)
int IDASolve(void*, double, double*, N_Vector, N_Vector, int)
int IDAGetDky(void*, double, int, N_Vector)
int IDAComputeY(void*, N_Vector, N_Vector)
int IDAComputeYp(void*, N_Vector, N_Vector)
int IDAGetCurrentTime(void*, double*)
int IDAGetCurrentCj(void*, double*)
int IDAGetLastOrder(void*, int*)
int IDAGetLastStep(void*, double*)
int IDAGetEstLocalErrors(void*, N_Vector)
int IDAGetErrWeights(void*, N_Vector)
int IDAGetNumSteps(void*, long*)
int IDAGetNumResEvals(void*, long*)
int IDAGetNumJacEvals(void*, long*)
int IDAGetNumLinSolvSetups(void*, long*)
int IDAGetNumErrTestFails(void*, long*)
int IDAGetNumNonlinSolvIters(void*, long*)
int IDAGetNumNonlinSolvConvFails(void*, long*)
int IDAGetNumStepSolveFails(void*, long*)
void IDAFree(void**)
"""

_DECLARATION = re.compile(r"^([\w ]+?\**) (\w+)\((.*)\)$", re.MULTILINE)
_NUMBERS: dict[str, Any] = {
    "int": ctypes.c_int, "long": ctypes.c_long, "double": ctypes.c_double, "void": None,
    "sunindextype": ctypes.c_int64,  # small positive numbers are also valid arguments of 32 bits
}  # fmt: skip


@cache
def declared() -> dict[str, tuple[Any, list[Any]]]:
    """Return the result and argument types of each function; pointers are passed as addresses."""

    def of(name: str) -> Any:
        return _NUMBERS.get(name.strip(), ctypes.c_void_p)

    return {
        name: (of(result), list(map(of, rest.split(",")))) for result, name, rest in _DECLARATION.findall(DECLARATIONS)
    }
