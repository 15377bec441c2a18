"""Transport of errors along steps, against dense equations of all stages, and against neighbouring motions."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.error_estimate.coordinates import typical
from stiffmbs.error_estimate.evaluated import evaluated
from stiffmbs.error_estimate.transport import Transport
from stiffmbs.model.read_scene import read_scene
from stiffmbs.sensitivity_equations.stages import Stages
from stiffmbs.solve.radau.collocation import radau
from tests.conftest import EXAMPLES

G, INERTIA = 9.81, 1.1
PENDULUM = """
gravity: [0, -9.81]
bodies: {bob: {mass: 1, inertia: 0.1, position: [1, 0]}}
joints: {pin: {type: revolute, i: {body: bob, point: [-1, 0]}, j: ground}}
"""


def states_of(angle, rate):
    """Return q and u of the bob at some angles and rates."""
    q = np.stack([np.cos(angle), np.sin(angle), angle], axis=1)
    return q, rate[:, None] * np.stack([-np.sin(angle), np.cos(angle), np.ones_like(angle)], axis=1)


@pytest.mark.parametrize("points", [3, 5])
def test_a_displacement_is_transported_as_that_of_a_neighbouring_motion(points):
    """By the minimal equation of a pendulum, integrated from two starts."""
    ends = np.linspace(0.0, 2.0, 81)
    inner = (ends[:-1, None] + np.diff(ends)[:, None] * radau(points).nodes).ravel()
    t = np.append(0.0, inner)

    def motion(start):
        given = (0.0, 2.0), start, "DOP853", t
        return solve_ivp(lambda _, y: [y[1], -G * np.cos(y[0]) / INERTIA], *given, rtol=1e-12, atol=1e-13).y

    dynamics, move = prepare(read_scene(PENDULUM)).dynamics, np.array([1e-5, -2e-5])
    below, at, above = (np.hstack(states_of(*motion(np.array([0.3, 0.1]) + k * move))) for k in (-1, 0, 1))
    states = evaluated(dynamics, t, at[:, :3].copy(), at[:, 3:].copy())
    transport, exact = Transport(dynamics, states), 0.5 * (above - below)
    rows = transport.rows(states)[1:].reshape(80, points, -1)
    found, slopes = transport.along(rows, np.diff(ends), np.zeros((80, points, 6)), exact[0])
    np.testing.assert_allclose(found.reshape(-1, 6), exact[1:], rtol=0.0, atol=1e-5 * np.abs(exact).max())
    np.testing.assert_allclose(slopes[..., 2], found[..., 5], rtol=0.0, atol=1e-4 * np.abs(exact).max())


@pytest.mark.parametrize("tolerance", [1e-10, -1.0], ids=["iterated", "together"])
@pytest.mark.parametrize("points", [1, 3, 9])
@pytest.mark.parametrize("name", ["governor", "half_car"])
def test_stages_solve_the_equations_of_all_points(name, points, tolerance):
    """No correction is below a negative tolerance: the matrix of all stages then replaces the iteration."""
    dynamics, start = (lambda job: (job.dynamics, job.start))(prepare(load_scene(EXAMPLES / f"{name}.yaml")))
    h, steps, rng = 1e-3, 3, np.random.default_rng(0)
    t = np.append(0.0, (h * (np.arange(steps)[:, None] + radau(points).nodes)).ravel())
    q, u = (np.tile(each, (len(t), 1)) for each in (start.q, start.u))
    at = evaluated(dynamics, t, q + t[:, None] * 0.1 * rng.normal(size=q.shape[1]), u)
    transport = Transport(dynamics, at)
    equations = transport._equations
    unknowns = transport._unknowns(typical(dynamics.system, at.q, at.u)[None])[0]
    stages = Stages(equations, dynamics.state, transport._matrix, radau(points), transport._weight, tolerance)
    rows = transport.rows(at)[1:].reshape(steps, points, -1)
    s, d = (unknowns * rng.normal(size=(*shape, equations.n)) for shape in ((), (steps, points)))
    found, _ = stages.advance(rows, np.full(steps, h), d, s)
    given, n = stages._kept[0], equations.n
    for k in range(steps):
        stages.apart(rows[k : k + 1], np.full(1, h), d[k : k + 1])
        parts = np.zeros((2, points, n, n))
        for part, values in zip(parts, (given["constant"], given["rate"]), strict=True):
            part[:, given["row"], given["column"]] = values.reshape(points, -1)
        a, b = parts
        blocks = np.einsum("ij,iab->iajb", radau(points).derivative / h, b)
        for i in range(points):
            blocks[i, :, i] += a[i]
        right = np.einsum("iab,ib->ia", b, d[k]) - a @ s
        exact = np.linalg.solve(blocks.reshape(points * n, -1), right.ravel()).reshape(points, n)
        close = np.abs((found[k] - exact) * transport._weight).max()
        assert close < 1e-6 * np.abs(exact * transport._weight).max(), k
        s = s + exact[-1]
