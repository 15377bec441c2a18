"""The directional derivatives of all terms, by numbers, state and time together, against high-order differences: any element."""

import numpy as np
import pytest

from stiffmbs.compile.directional.direction import Direction, Numbers
from stiffmbs.compile.kind import sorted_out
from stiffmbs.errors import InputError

from ..random_parts import CASES
from .test_element_derivatives import WEIGHTS, T, case_name, state_with

SETS = ("motion", "acceleration", "output", "event_function")
STEP = 2e-5  # tyres have terms that change within 1e-3


def random_numbers(state, rng, model):
    """Changes of all numbers but places, lengths and ends of tables, and addresses of functions."""
    changes = []
    for group in state.system.groups:
        change = np.where(np.abs(group.numbers) < 1e6, rng.uniform(-1, 1, len(group.numbers)), 0.0)
        for e, (name, element) in enumerate(zip(group.names, group.elements, strict=True)):
            _, data = sorted_out(name, element, model)
            first, flat = int(group.index[e, 2 * group.kind.n_bodies]), data.flat()
            for at, _ in data.tables:
                begin = first + int(flat[at])
                change[first + at] = 0.0
                change[begin : begin + 2] = 0.0
        changes.append(change)
    return changes


@pytest.mark.long
@pytest.mark.parametrize("case", CASES, ids=case_name)
@pytest.mark.sampled(25)
def test_all_terms_in_a_random_direction(case):
    state, model = state_with(*case, with_model=True)
    rng = np.random.default_rng(3)
    changes = random_numbers(state, rng, model)
    masses = np.zeros(state.system.n_u)
    numbers = Numbers(tuple(changes), frozenset(range(len(changes))), masses)
    state.a[:] = rng.uniform(-1, 1, len(state.a))
    arrays = {name: getattr(state, name) for name in ("q", "u", "a", "lam", "mu")}
    kept = {name: array.copy() for name, array in arrays.items()}
    kept_numbers = [group.numbers.copy() for group in state.system.groups]
    moves = {name: rng.uniform(-1, 1, len(array)) for name, array in arrays.items()}
    for term_set in SETS:
        try:
            direction = Direction(state, term_set, numbers)
        except InputError as error:
            assert "Python function" in str(error)
            continue
        for name, move in moves.items():
            getattr(direction, name)[:] = move

        def values(shift, term_set=term_set):
            for name, array in arrays.items():
                array[:] = kept[name] + shift * moves[name]
            for group, base, change in zip(state.system.groups, kept_numbers, changes, strict=True):
                group.numbers[:] = base + shift * change
            state.evaluate(term_set, T + 0.7 * shift)
            return state.values[term_set][: state.system.n_values(term_set)].copy()

        expected = sum(
            sign * weight * values(sign * offset * STEP) / STEP
            for offset, weight in WEIGHTS.items()
            for sign in (1, -1)
        )
        values(0.0)
        direction.evaluate(T, 0.7)
        found = direction.values[: len(expected)]
        assert np.max(np.abs(found - expected), initial=0) <= 1e-6 * max(1, np.max(np.abs(expected), initial=0)), (
            term_set
        )
