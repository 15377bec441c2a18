"""Functions of Radau methods under the names of IDA's."""

from __future__ import annotations

from typing import Any

from ...compile.machine.object_code import FULL
from ...compile.machine.routines import together
from ..ida.libraries import Libraries

_SET = "int32(int64, float64)"
_SIGNATURES = {
    "solve": ("IDASolve", "int32(int64, float64, float64*, int64, int64, int32)"),
    "interpolate": ("IDAGetDky", "int32(int64, float64, int32, int64)"),
    "reinitialise": ("IDAReInit", "int32(int64, float64, int64, int64)"),
    "set_stop_time": ("IDASetStopTime", _SET),
    "set_first_step": ("IDASetInitStep", _SET),
    "set_longest_step": ("IDASetMaxStep", _SET),
    "set_newton": ("IDASetNonlinConvCoef", _SET),
    "set_growth": ("IDASetEtaFixedStepBounds", "int32(int64, float64, float64)"),
    "set_order": ("IDASetMaxOrd", "int32(int64, int32)"),
    "set_tolerances": ("IDASVtolerances", "int32(int64, float64, int64)"),
    "time_of": ("IDAGetCurrentTime", "int32(int64, float64*)"),
    "step_of": ("IDAGetLastStep", "int32(int64, float64*)"),
    "next_step_of": ("IDAGetCurrentStep", "int32(int64, float64*)"),
    "errors_of": ("IDAGetEstLocalErrors", "int32(int64, int64)"),
    "weights_of": ("IDAGetErrWeights", "int32(int64, int64)"),
    "order_of": ("IDAGetLastOrder", "int32(int64, int32*)"),
    "counter_of": ("counter", "int32(int64*, int64*)"),
    "repeat": ("repeat", "int32(int64, float64, float64)"),
    "resolves": ("resolves", "int32(int64)"),
}
"""Names of IDA's functions, which has none for `repeat` and `resolves`, and one for each counter, and signatures of those in `stiffmbs.solve.radau.native.interface`."""
_ROUTINES = dict(
    zip(
        (name for name, _ in _SIGNATURES.values()),
        together(
            "stiffmbs.solve.radau.native.interface",
            FULL,
            **{name: signature for name, (_, signature) in _SIGNATURES.items()},
        ),
        strict=True,
    )
)
REPEAT, RESOLVES, COUNTER = (_ROUTINES[name] for name in ("repeat", "resolves", "counter"))


class RadauFunctions(Libraries):
    """SUNDIALS functions, with those of IDA replaced by Radau methods."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("IDA"):
            return _ROUTINES[name].short_call
        return super().__getattr__(name)

    def address(self, name: str) -> int:
        """Return the address of a function, for compiled code."""
        return _ROUTINES[name].address if name.startswith("IDA") else super().address(name)
