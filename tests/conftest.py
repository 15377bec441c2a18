"""What many tests share: the example scenes and the converged cart-pendulum."""

import os

os.environ.setdefault("SYMPY_CACHE_SIZE", "None")  # as in the command: derivations take a quarter less time
os.environ.setdefault("STIFFMBS_DRAFTS", "0")  # the process that finishes drafts would get no time beside the tests
os.environ.setdefault("SOURCE_DATE_EPOCH", "86400")  # two runs are equal in their dates too
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as in the command; waiting threads of two workers treble the time

import gc
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from scipy.integrate import solve_ivp

from stiffmbs.cache.entries import DIRECTORY_VARIABLE, cache_directory
from stiffmbs.commands.starting import scene_files
from stiffmbs.compile.machine import drafts, object_code
from stiffmbs.error_estimate.parameters import ESTIMATE
from stiffmbs.interrupts import NEW_OBJECTS
from stiffmbs.tuning import parameters_of

TESTS = Path(__file__).parent
EXAMPLES = TESTS.parent / "examples"
WITHOUT_ESTIMATES = frozenset(
    (
        "adams", "beams", "compile", "dynamics", "elements", "equilibria", "events", "flexible_bodies", "linear_analysis", "mechanisms",
        "model", "oracle", "presolve", "redundancy", "roads", "robots", "run_checks", "solve", "tyres",
    )
)  # fmt: skip
"""Folders of tests whose runs have no estimate of errors unless they ask for it."""
EXAMPLE_SCENES = scene_files()
"""All example scenes by name, those in folders by theme too."""
G, CART, BAR, HALF, STIFFNESS = 9.81, 10.0, 1.0, 0.3, 270.0

settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("untimed")  # no test depends on the speed of a machine
gc.set_threshold(NEW_OBJECTS)  # as the command has it: 3 % of a run


def quickly_compiled(assembly: str, level: int, unrolled: bool) -> bytes:
    """Kernels and routines serve a few short runs each; results of all levels are equal to the last bit."""
    less = {object_code.FULL: object_code.SHORT, object_code.SHORT: object_code.DRAFT}
    return object_code.object_code(assembly, less.get(level, level), unrolled)


drafts.object_code = quickly_compiled
if (
    "PYTEST_XDIST_WORKER" not in os.environ
):  # workers have that of their session; runs would take code of lower levels for their own
    os.environ[DIRECTORY_VARIABLE] = str(cache_directory() / "tests")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="run every test that is marked as sampled")
    parser.addoption(
        "--share", default="0/1", metavar="K/N", help="of the tests chosen otherwise, run every N-th from number K on"
    )


@pytest.hookimpl(trylast=True)  # of what -k and -m leave
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not sampled, unless all are asked for, and begin with the longest tests."""
    if not config.getoption("all"):
        _sample(config, items)
    first, every_nth = map(int, config.getoption("share").split("/"))
    config.hook.pytest_deselected(items=[item for number, item in enumerate(items) if number % every_nth != first])
    items[:] = items[first::every_nth]
    items.sort(key=_seconds, reverse=True)  # the others keep their order


def _sample(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Of the tests of a file that are marked sampled(n), keep every n-th."""
    seen: Counter[tuple[Path, int]] = Counter()
    kept, left = [], []
    for item in items:
        mark = item.get_closest_marker("sampled")
        sort = (item.path, mark.args[0]) if mark else None
        (left if sort and seen[sort] % sort[1] else kept).append(item)
        seen.update([sort] if sort else [])
    config.hook.pytest_deselected(items=left)
    items[:] = kept


def _seconds(item: pytest.Item) -> float:
    """Return about how long a test that is marked long(seconds) takes, s: one that runs last would keep one processor busy."""
    mark = item.get_closest_marker("long")
    return mark.args[0] if mark and mark.args else 0.0


def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """To look through millions of expressions of earlier files again and again takes a tenth of a run; SymPy's own go."""
    if nextitem is None or nextitem.path != item.path:
        if "sympy.core.cache" in sys.modules:
            sys.modules["sympy.core.cache"].clear_cache()
        gc.freeze()


def pytest_sessionfinish() -> None:
    """Nor is it worth the time to look through all of them at the end."""
    gc.freeze()


@pytest.fixture(autouse=True)
def estimates_where_they_are_asked_for(request: pytest.FixtureRequest) -> Iterator[None]:
    """Estimates of errors take a third of the time of all tests: tests of solvers and elements have them with `errors=True`."""
    if request.path.relative_to(TESTS).parts[0] not in WITHOUT_ESTIMATES:
        yield
        return
    defaults, usual = parameters_of(ESTIMATE), ESTIMATE.work
    object.__setattr__(defaults, "work", 0.0)
    yield
    object.__setattr__(defaults, "work", usual)


@pytest.fixture(scope="session")
def every(pytestconfig: pytest.Config) -> Callable[[Sequence[int], int], Sequence[int]]:
    """Of the seeds of one test, take every n-th, unless all tests are asked for."""
    return lambda seeds, n: seeds if pytestconfig.getoption("all") else seeds[::n]


@pytest.fixture(scope="session")
def examples() -> Path:
    return EXAMPLES


@pytest.fixture(scope="session")
def cart_pendulum_reference():
    """x and theta (from hanging) of the cart-pendulum at given times, from its two Euler-Lagrange equations."""

    def rates(t, y):
        x, theta, v, w = y
        inertia = BAR * HALF**2 + BAR * (2 * HALF) ** 2 / 12
        mass = np.array([[CART + BAR, BAR * HALF * np.cos(theta)], [BAR * HALF * np.cos(theta), inertia]])
        force = [-STIFFNESS * x + BAR * HALF * np.sin(theta) * w**2, -BAR * G * HALF * np.sin(theta)]
        return [v, w, *np.linalg.solve(mass, force)]

    dense = solve_ivp(
        rates, (0, 10), [0, np.radians(20), 0, 0], "DOP853", rtol=3e-14, atol=1e-15, dense_output=True
    ).sol
    return lambda t: dense(t)[:2]
