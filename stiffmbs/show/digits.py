"""Numbers with their significant digits."""

from __future__ import annotations

import math

PLENTY = 9
"""Most significant digits of a number."""
LEAST_WITHOUT_EXPONENT = 1e-3
"""Least number that is written without an exponent."""


def with_bar(value: float, half: float, noise: float = 0.0) -> str:
    """Return a value and the half width of its error bar, as ``12.345 ± 0.002``.

    The bar has one digit, rounded up, or two if the first would be 1; the last digit of the value is at the same place.

    Parameters
    ----------
    value, half : float
        The half width is nan if it is unknown.
    noise : float
        Size up to which values and bars are zero.

    Examples
    --------
    >>> with_bar(12.34567, 0.0018)
    '12.3457 ± 0.0018'
    >>> with_bar(12.34567, 0.0071)
    '12.346 ± 0.008'
    >>> with_bar(123456.7, 430.0)
    '123500 ± 500'
    >>> with_bar(12.34567, float("nan"))
    '12.346 (not known how well)'
    """
    if math.isnan(half):
        return f"{value:.5g} (not known how well)"
    if abs(value) <= noise and half <= noise:
        return "0"
    if not math.isfinite(half) or not math.isfinite(value):
        return f"{value:.5g} ± {half:.1g}"
    digit = math.floor(math.log10(half)) if half > 0 else -300
    if half > 0 and half / 10.0**digit <= 1.95:
        digit -= 1
    digit = max(digit, math.floor(math.log10(max(abs(value), half))) + 1 - PLENTY)
    step = 10.0**digit
    known, bar = round(value / step) * step, math.ceil(half / step * (1 - 1e-9)) * step
    if digit >= 0:
        large = max(abs(known), bar) >= 10.0 ** (PLENTY + 1)
        return f"{known:.3e} ± {bar:.0e}" if large else f"{known:.0f} ± {bar:.0f}"
    if max(abs(known), bar) >= LEAST_WITHOUT_EXPONENT:
        return f"{known:.{-digit}f} ± {bar:.{-digit}f}"
    places = max(math.floor(math.log10(abs(known))) - digit, 0) if known else 0
    return f"{known:.{places}e} ± {bar:.0e}"
