"""Certainty of fitted parameters: linear models, whose intervals are known."""

import numpy as np
import pytest
from scipy.stats import t as student

from stiffmbs.studies.measured import of_common_noise, of_separate_noise

RANDOM = np.random.default_rng(5)


def test_one_channel_has_the_noise_of_all():
    J, r = RANDOM.normal(size=(20, 3)), RANDOM.normal(size=20)
    one, common = of_separate_noise([J], [r]), of_common_noise(J, r)
    np.testing.assert_allclose(one.covariance, common.covariance, rtol=1e-12)
    np.testing.assert_allclose(one.freedom, 17.0, rtol=1e-12)


def test_channels_that_tell_a_parameter_each_are_fits_of_their_own():
    J = [np.column_stack([RANDOM.normal(size=9), np.zeros(9)]), np.column_stack([np.zeros(30), RANDOM.normal(size=30)])]
    r = [RANDOM.normal(size=9), 1.5 * RANDOM.normal(size=30)]
    found = of_separate_noise(J, r)
    for k, count in enumerate((9, 30)):
        alone = of_common_noise(J[k][:, k : k + 1], r[k])
        np.testing.assert_allclose(found.covariance[k, k], alone.covariance[0, 0], rtol=1e-10)
        np.testing.assert_allclose(found.freedom[k], count - 1.0, rtol=1e-10)


@pytest.mark.long
def test_intervals_of_a_mean_from_two_instruments_hold_it_about_as_often_as_they_say():
    """Means of two samples of eight, weighted by what they scatter: with a common noise and all its freedom 92 % hold."""
    held, trials, chance = np.zeros(2), 800, np.random.default_rng(1)
    for _ in range(trials):
        samples, weights = np.stack([chance.normal(0.0, 1.0, 8), chance.normal(0.0, 3.0, 8)]), np.array([1.0, 1 / 3])
        for _ in range(3):
            mean = weights**2 @ samples.mean(axis=1) / (weights @ weights)
            weights = 1.0 / np.sqrt(np.mean((samples - mean) ** 2, axis=1))
        J, r = [np.full((8, 1), w) for w in weights], list(weights[:, None] * (mean - samples))
        for k, found in enumerate((of_separate_noise(J, r), of_common_noise(np.concatenate(J), np.concatenate(r)))):
            held[k] += abs(mean) < student.ppf(0.975, found.freedom[0]) * np.sqrt(found.covariance[0, 0])
    separate, common = held / trials
    assert 0.925 < separate < 0.97
    assert separate > common + 0.01
