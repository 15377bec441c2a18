"""Entries of a matrix in the order in which compiled code adds them up."""

import numpy as np
import pytest

from stiffmbs.compile.equations import entry_lists


def added_up(lists, values, cj, n_slots):
    """As `stiffmbs.compile.machine.native.evaluate.add_entries`, in memory that holds no numbers at first."""
    a = np.full(n_slots, np.nan)
    a[: lists["n_cleared"]] = 0.0
    a[lists["m_bare"]] = 0.0
    for k in range(lists["n_entries"]):
        late, slot = k >= lists["n_constant"], lists["m_slot"][k]
        term = values[lists["m_source"][k]] * (lists["m_constant"][k] + (lists["m_cj"][k] * cj if late else 0.0))
        a[slot] = term if k < lists["n_first"] else a[slot] + term
    return a


@pytest.mark.parametrize(("n_slots", "count"), [(40, 150), (40, 30), (300, 60), (5, 0)])
def test_each_slot_holds_the_sum_of_its_entries_in_the_order_given(n_slots, count):
    """To the last digit, so that no run changes."""
    rng = np.random.default_rng(n_slots + count)
    slot, source, values = rng.integers(0, n_slots, count), rng.permutation(count), rng.normal(size=count)
    constant, cj = rng.choice([-1.0, 0.3, 1.0], count), np.where(rng.random(count) < 0.1, 1.0, 0.0)
    expected = np.zeros(n_slots)
    np.add.at(expected, slot, values[source] * (constant + 7.0 * cj))
    assert np.array_equal(added_up(entry_lists(slot, source, constant, cj, n_slots), values, 7.0, n_slots), expected)


def lists_of(slot, cj, n_slots):
    found = entry_lists(np.array(slot), np.arange(len(slot)), np.ones(len(slot)), np.array(cj, dtype=float), n_slots)
    return (
        [found[name] for name in ("n_first", "n_constant", "n_cleared")],
        found["m_source"].tolist(),
        found["m_bare"].tolist(),
    )


def test_a_slot_begins_with_its_first_entry_and_those_with_cj_come_last():
    assert lists_of([2, 0, 2, 1, 0], [0, 0, 0, 1, 0], 3) == ([2, 4, 0], [1, 0, 2, 4, 3], [1])


def test_a_matrix_of_mostly_empty_slots_is_cleared_as_a_whole():
    assert lists_of([7, 3], [0, 0], 10) == ([0, 2, 10], [0, 1], [])
