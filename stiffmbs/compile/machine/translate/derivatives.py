"""Partial derivatives of the functions of LLVM and of the C library, written in the language of compiled code.

They differentiate a function in forward mode: Griewank and Walther, Evaluating Derivatives, 2nd ed. 2008, ch. 3.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import copysign, cos, cosh, exp, log, sin, sinh, sqrt, tanh


def _of_sin(x: float) -> float:
    return cos(x)


def _of_cos(x: float) -> float:
    return -sin(x)


def _of_tan(x: float) -> float:
    return 1.0 / (cos(x) * cos(x))


def _of_asin(x: float) -> float:
    return 1.0 / sqrt(1.0 - x * x)


def _of_acos(x: float) -> float:
    return -(1.0 / sqrt(1.0 - x * x))


def _of_atan(x: float) -> float:
    return 1.0 / (1.0 + x * x)


def _of_sinh(x: float) -> float:
    return cosh(x)


def _of_cosh(x: float) -> float:
    return sinh(x)


def _of_tanh(x: float) -> float:
    return 1.0 - tanh(x) * tanh(x)


def _of_asinh(x: float) -> float:
    return 1.0 / sqrt(1.0 + x * x)


def _of_exp(x: float) -> float:
    return exp(x)


def _of_log(x: float) -> float:
    return 1.0 / x


def _of_sqrt(x: float) -> float:
    return 0.5 / sqrt(x)


def _of_magnitude(x: float) -> float:
    return 1.0 if x >= 0.0 else -1.0


def _of_atan2_by_y(y: float, x: float) -> float:
    return x / (x * x + y * y)


def _of_atan2_by_x(y: float, x: float) -> float:
    return -y / (x * x + y * y)


def _of_pow_by_base(x: float, y: float) -> float:
    return y * x ** (y - 1.0)


def _of_pow_by_exponent(x: float, y: float) -> float:
    return x**y * log(x) if x != 0.0 else 0.0


def _of_copysign(x: float, y: float) -> float:
    return copysign(1.0, x) * copysign(1.0, y)


Partials = Sequence[Callable[..., float] | None]
"""Derivative by each argument; None where it is zero."""
PARTIAL_DERIVATIVES: Mapping[str, Partials] = {
    "llvm.sin.f64": (_of_sin,), "llvm.cos.f64": (_of_cos,), "tan": (_of_tan,), "asin": (_of_asin,), "acos": (_of_acos,),
    "atan": (_of_atan,), "sinh": (_of_sinh,), "cosh": (_of_cosh,), "tanh": (_of_tanh,), "asinh": (_of_asinh,), "llvm.exp.f64": (_of_exp,),
    "llvm.log.f64": (_of_log,), "llvm.sqrt.f64": (_of_sqrt,), "llvm.fabs.f64": (_of_magnitude,),
    "atan2": (_of_atan2_by_y, _of_atan2_by_x), "llvm.pow.f64": (_of_pow_by_base, _of_pow_by_exponent),
    "llvm.floor.f64": (None,), "llvm.copysign.f64": (_of_copysign, None),
}  # fmt: skip
"""Partial derivatives by the symbols of the functions."""
