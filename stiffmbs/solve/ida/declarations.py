"""Declarations of the SUNDIALS functions in use (version 7)."""

from __future__ import annotations

import ctypes
import re
from typing import Any

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
SUNMatrix SUNSparseMatrix(sunindextype, sunindextype, sunindextype, int, SUNContext)
SUNMatrix SUNSparseFromDenseMatrix(SUNMatrix, double, int)
double* SUNSparseMatrix_Data(SUNMatrix)
void* SUNSparseMatrix_IndexValues(SUNMatrix)
void* SUNSparseMatrix_IndexPointers(SUNMatrix)
int SUNMatZero(SUNMatrix)
void SUNMatDestroy(SUNMatrix)

SUNLinearSolver SUNLinSol_Dense(N_Vector, SUNMatrix, SUNContext)
SUNLinearSolver SUNLinSol_Band(N_Vector, SUNMatrix, SUNContext)
SUNLinearSolver SUNLinSol_SuperLUMT(N_Vector, SUNMatrix, int, SUNContext)
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
int IDASetInitStep(void*, double)
int IDASetMaxNumSteps(void*, long)
int IDASetNonlinearSolver(void*, SUNNonlinearSolver)
int IDASetNonlinConvCoef(void*, double)
int IDASetDeltaCjLSetup(void*, double)
int IDASetStopTime(void*, double)
int IDARootInit(void*, int, IDARootFn)
int IDASetNoInactiveRootWarn(void*)
int IDASolve(void*, double, double*, N_Vector, N_Vector, int)
int IDAGetDky(void*, double, int, N_Vector)
int IDAGetRootInfo(void*, int*)
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
_NUMBERS: dict[str, Any] = {"int": ctypes.c_int, "long": ctypes.c_long, "double": ctypes.c_double, "void": None}


def declared(index: type[Any]) -> dict[str, tuple[Any, list[Any]]]:
    """Return the result and argument types of each function; pointers are passed as addresses.

    Parameters
    ----------
    index : ctypes type
        Type of `sunindextype`: ``c_int32`` or ``c_int64``.
    """
    numbers = _NUMBERS | {"sunindextype": index}
    return {
        name: (numbers.get(result, ctypes.c_void_p), [numbers.get(a.strip(), ctypes.c_void_p) for a in rest.split(",")])
        for result, name, rest in _DECLARATION.findall(DECLARATIONS)
    }
