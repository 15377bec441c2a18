"""Uncertainty of fitted parameters, by the linearised model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

ROUNDS = 4
"""Number of estimates of the channels' noise, each with the leverages of the previous one."""


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of p parameters.

    `covariance` of shape (p, p). `freedom` of shape (p,): degrees of freedom of each parameter's variance, for
    Student's distribution.
    """

    covariance: np.ndarray
    freedom: np.ndarray


def of_common_noise(J: np.ndarray, r: np.ndarray) -> Uncertainty:
    """Return the uncertainty for residuals r with derivatives J and noise that is known up to a common factor.

    Seber and Wild, Nonlinear Regression (1989), sec. 5.1.
    """
    count, p = J.shape
    return Uncertainty(np.linalg.inv(J.T @ J) * float(r @ r) / (count - p), np.full(p, float(count - p)))


def of_separate_noise(J: Sequence[np.ndarray], r: Sequence[np.ndarray]) -> Uncertainty:
    """Return the uncertainty for channels with separate noise, estimated from their residuals.

    A channel loses as many degrees of freedom to the parameters as the sum of its leverages.  The variance of a
    parameter is a sum over channels, whose degrees of freedom are those of Satterthwaite, Biometrics Bulletin 2 (1946)
    110-114.  If a channel has none left, common noise is assumed. `J`: derivatives of each channel's residuals,
    weighted so that all have about the same noise.
    """
    information = np.array([part.T @ part for part in J])
    squares, counts = np.array([part @ part for part in r]), np.array([float(len(part)) for part in r])
    variance = np.full(len(r), squares.sum() / counts.sum())
    for _ in range(ROUNDS):
        parts = information / variance[:, None, None]
        covariance = np.linalg.inv(parts.sum(axis=0))
        freedom = counts - np.einsum("ij,kji->k", covariance, parts)
        if np.any(freedom < 1) or not np.all(squares > 0):
            return of_common_noise(np.concatenate(J), np.concatenate(r))
        variance = squares / freedom
    parts = information / variance[:, None, None]
    covariance = np.linalg.inv(parts.sum(axis=0))
    shares = np.einsum("ij,kjl,li->ki", covariance, parts, covariance) / np.diag(covariance)
    return Uncertainty(covariance, 1.0 / (shares**2 / freedom[:, None]).sum(axis=0))
