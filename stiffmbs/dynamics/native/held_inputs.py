"""Inputs that are constant over a step, as numbers of forces."""

from typing import Final

from stiffmbs.compile.machine.native.access import compiled, floats
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.native.views import held_inputs_view

OUT_OF_BOUNDS: Final = -1


@compiled
def take_inputs(i, values):
    """Set all inputs; return 1 if any has changed, 0 if none, and OUT_OF_BOUNDS, with nothing changed, if one is out of its bounds."""
    changed = 0
    for k in range(i.n):
        if not i.least[k] <= values[k] <= i.largest[k]:
            return OUT_OF_BOUNDS
        if values[k] != i.value[k]:
            changed = 1
    if changed:
        for k in range(i.n_numbers):
            value = values[i.input[k]]
            if value != i.value[i.input[k]]:
                number = floats(i.number[k])
                number[0] = i.offset[k] + i.slope[k] * value
        copied(i.value, values, i.n)
    return changed


def hold(values, held):
    """Call `take_inputs` from Python."""
    return take_inputs(held_inputs_view(held), values)
