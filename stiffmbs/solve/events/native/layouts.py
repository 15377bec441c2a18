"""Memory layouts of the event search within a step, and of the limits of a step."""

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

STEP_BOUND = Layout({
    "n": INT, "place": INT_CELL, "starts": FLOATS, "longest": FLOATS, "n_bends": INT, "bend": INT_CELL, "bends": FLOATS,
})  # fmt: skip
"""Longest steps that resolve inputs (`stiffmbs.solve.events.event_functions`); n is 0 if nothing limits a step.

Bends are the times at which steps of a one-step method end, and `bend` is the next one."""

WHOLE_STEPS = Layout({
    "n_nodes": INT, "node": FLOATS, "width": INT, "room": INT, "count": INT_CELL, "row": FLOATS,
})  # fmt: skip
"""Storage of steps (`stiffmbs.solve.events.native.step_bound`): one row for both ends of a step and its states, of
`width` numbers, at the nodes; space for rows (0 for none), and stored rows."""

ALWAYS, IN_THIS_STEP = range(1, 3)
"""Values of the cell `at_kinks`: kinks of tables end all steps, or this step of a method whose error estimate does not hold."""

NO_EVENT, EVENT, PASSED_INTERVAL, RETRIED = range(4)
"""Results for a step: no event, one at which integrators restart, or a passed breakpoint of a law, where they may go on; or
an explicit step to an event that is rejected."""

EVENT_SEARCH = Layout({
    "n": INT, "n_event_functions": INT, "band": FLOATS, "farthest": FLOATS, "first_breakpoint": INTS, "breakpoints": FLOATS, "overlap": FLOATS, "period": FLOATS,
    "value_before": FLOATS, "rate_before": FLOATS, "value_after": FLOATS, "rate_after": FLOATS,
    "a": FLOATS, "a_rate": FLOATS, "b": FLOATS, "b_rate": FLOATS, "m": FLOATS, "m2": FLOATS, "left_low": FLOATS, "left_high": FLOATS, "noise": FLOATS, "found": INTS,
    "interval_low": FLOATS, "interval_high": FLOATS, "apart": FLOATS, "n_calls": INT, "call": INTS, "near": INTS,
    "n_state": INT, "n_lam": INT, "lam": FLOATS, "by_accelerations": INT, "dynamics": INT_CELL, "n_nodes": INT, "node": FLOATS, "weight": FLOATS, "row": FLOATS, "n_angles": INT, "angle": INTS, "n_turns": INT, "turn": INTS, "radians": FLOATS, "lowest": FLOATS, "highest": FLOATS, "outside": FLOATS, "left": FLOATS, "tables": INTS, "kinked": INTS, "at_kinks": INT_CELL, "n_with_intervals": INT, "n_jumping": INT, "jumping": INTS,
    "begun": FLOAT_CELL, "depth": FLOAT_CELL,
    "least": FLOAT_CELL, "duration": FLOAT_CELL, "longest": FLOAT_CELL, "target": FLOAT_CELL, "passage": FLOAT_CELL, "first": FLOAT_CELL, "under_way": INT_CELL, "begins": FLOAT_CELL, "narrow": INT_CELL, "passed": FLOAT_CELL, "unresolved": INT_CELL, "fastest": INT_CELL, "first_unresolved": FLOAT_CELL, "noted": FLOAT_CELL,
})  # fmt: skip
"""Search for events within a step (`stiffmbs.solve.events.native.within_step`): event functions, bands about zero that some
have to leave (0 for none), the largest values since the start, breakpoints; their values and rates at both ends of the step and of a part of it; the kernel of each, and kernels with a
function near a breakpoint; states of the step at nodes, of `n_state` numbers and `n_lam` multipliers; 1 if these or algebraic states follow from accelerations, by the dynamics; arguments of sines or of periodic tables with few intervals,
and their unit in radians; the range of arguments of tables in steps near their ends, the time outside, and that of the
first departure; tables that end; arguments of tables with a kink; number of functions with breakpoints; arguments that jump by periods of their tables.

Cells: 0 if kinks of tables do not end steps; start of the step, infinite if its values are not known, least depth of an event below zero; shortest
and longest step for the arguments of sines; longest step until the motion leaves its initial law, longest first step
there; 1 after the beginning of the run, time of the beginning, number of steps limited by features, end of the passage;
number of steps with unresolved arguments, first such argument, and its time; time up to which ranges are noted."""
