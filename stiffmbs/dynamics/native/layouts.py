"""Memory layouts of the dynamics and of elimination.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import CACHE_LINE, FLOAT_CELL, FLOATS, INDICES, INT, INT_CELL, INTS, Layout

DYNAMICS = Layout({
    "state": INTS, "constraining": INTS, "positions": INTS, "position_factors": INTS, "velocities": INTS, "velocity_factors": INTS,
    "accelerations": INTS, "acceleration_factors": INTS, "status": INT_CELL,
    "n_trailing": INT, "trailing_source": INTS, "trailing_row": INTS, "by_reactions": INT, "switches_by_reactions": INT,
    "n_algebraic": INT, "algebraic": INTS, "algebraic_scale": FLOATS, "algebraic_before": FLOATS,
    "n_turned_for_output": INT, "turned_for_output": INTS,
    "eliminates": INT, "eliminated": INTS, "by_elimination": INT_CELL,
    "n_output": INT, "lines": FLOATS, "mass": FLOATS, "root_q": FLOATS, "root_u": FLOATS,
    "n_potential": INT, "potential": INTS, "n_power": INT, "power": INTS, "n_kinetic": INT, "kinetic": INTS,
})  # fmt: skip
"""Tables of a state and its three block systems.  `constraining` is a table of the same state whose sets ``motion`` and
``acceleration`` have the terms of joints alone.  `status` receives the reason of a failure in output rows, or in a row of steps.  `trailing`
lists the rates of revolution counters and states among the acceleration terms; `by_reactions` is 1 if any depends on
multipliers, `switches_by_reactions` if event functions may.  `algebraic` lists the algebraic states among the coordinates, with their scales and last values, and
`turned_for_output` the first coordinates of bodies whose orientation only output terms need.  `eliminates` is 1 if
elimination is tried first (`stiffmbs.dynamics.native.consistent`), `by_elimination` if it gave the last accelerations.
Output rows need the number of output terms, memory for `LINES` rows, and masses. Roots of inertias by coordinate and
velocity follow, and the places of energies and power among the output terms."""

LINES = CACHE_LINE // 8
"""Output rows that are stored together: one cache line of each column."""
JUDGED = (
    "position_violation", "velocity_violation", "drift", "log_determinant", "changed", "moved", "moved_velocity", "kinetic",
    "potential", "power",
)  # fmt: skip
"""Numbers that judge an output row (`stiffmbs.dynamics.dynamics.OutputRows`), in the order of their storage."""

ELIMINATED = Layout({
    "state": INTS, "n_u": INT, "trees": INT, "by_pins": INT, "lists": INTS,
    "ready": INT_CELL, "kept": FLOAT_CELL, "most_kept": FLOAT_CELL, "n_scales": INT, "pivot_scale": FLOATS, "largest_scale": FLOATS,
    "n_f": INT, "f_source": INDICES, "f_row": INDICES, "scale": FLOATS, "a": FLOATS,
    "attempt": INT_CELL, "factor": INT_CELL, "move": INT_CELL, "q_before": FLOATS, "u_before": FLOATS, "left": FLOATS, "sizes": FLOATS, "least": FLOAT_CELL, "log_mass": FLOAT_CELL,
    "n_j": INT, "j_source": INDICES, "j_row": INDICES, "j_column": INDICES, "n_gamma": INT, "gamma_source": INDICES, "gamma_row": INDICES,
})  # fmt: skip
"""Elimination of J M^-1 J^T (`stiffmbs.dynamics.elimination.eliminated`).  `trees` is 1 if no joint closes a loop; `by_pins`
tells the kind of the table `lists`.  `ready` is 1 if there are factors; `kept` and `most_kept` are the relative
sizes of their pivots now and at most; then the scale of each pivot, its diagonal entry now or, if that is larger, at the
end of a step of the run: an equation may vanish at a pose.  Then follow forces, M^-1/2, accelerations; addresses of routines; memory of a
state; residuals of J u' = gamma, sizes of their terms, the least allowed residual, and log det M; entries of J and gamma in solved
equations among the acceleration terms."""

HELD_INPUTS = Layout({
    "n": INT, "value": FLOATS, "least": FLOATS, "largest": FLOATS,
    "n_numbers": INT, "number": INTS, "input": INTS, "offset": FLOATS, "slope": FLOATS,
})  # fmt: skip
"""Inputs that are constant over a step, with the bounds of their values, and the numbers of forces that are affine in one: *number = offset + slope * value of the input."""

JOINT_COORDINATES = Layout({
    "state": INTS, "n": INT, "place": INTS, "rate_place": INTS, "counter": INTS,
    "t": FLOAT_CELL, "coordinate": FLOATS, "rate": FLOATS,
})  # fmt: skip
"""Coordinates of joints and their rates at a time, and their places among the output terms.  `state` is a table of its own, whose
set ``output`` has the terms of joints alone.  `counter` is the coordinate that counts the turns of an angle, `FOLLOWED` for an angle
without one, and `WITHOUT_TURNS` for other coordinates."""
FOLLOWED, WITHOUT_TURNS = -1, -2

JOINT_TREE = Layout({
    "state": INTS, "n_bodies": INT, "n_v": INT,
    "n_frames": INT, "parent": INTS, "free": INTS, "at_q": INTS, "at_v": INTS, "screw": FLOATS, "reference": FLOATS, "frame": FLOATS, "column": FLOATS,
    "body_frame": INTS, "body_reference": FLOATS, "path_start": INTS, "path": INTS,
    "N": FLOATS, "drift": FLOATS, "mass": FLOATS, "M": FLOATS, "h": FLOATS,
    "n_f": INT, "f_source": INTS, "f_row": INTS,
    "n_inertia": INT, "inertia_source": INTS, "inertia_row": INTS, "inertia_column": INTS,
    "n_loops": INT, "C": FLOATS, "J": FLOATS, "gamma": FLOATS,
    "n_c": INT, "c_source": INTS, "c_row": INTS, "n_j": INT, "j_source": INTS, "j_row": INTS, "j_column": INTS,
    "n_gamma": INT, "gamma_source": INTS, "gamma_row": INTS, "n_ja": INT, "ja_source": INTS, "ja_row": INTS, "ja_column": INTS,
    "n_counters": INT, "counter": INTS, "counter_from": INTS,
})  # fmt: skip
"""Spanning tree of a mechanism (`stiffmbs.dynamics.joint_tree`).

Frames: index of the frame before each, 0 for ground and k + 1 for frame k. Then 1 for a free body, first coordinate and first rate. The screw is
at the reference pose: velocity of the point at the origin and angular velocity. The reference is a screw's coordinate, or position and
quaternion of a free body. `frame` is memory for `FRAME` numbers of each frame from ground on, `column` the screw of each rate at the current pose.
Bodies: frame, `BODY` numbers at the reference pose, and the rates that move each. Results: N of u = N v, N' v, M and the bias of the tree's
rates. Results of the loops' equations: C, J N, and J u' at zero rates of v. Entries of forces and inertia follow, and of C and J in the set ``motion``.
Those of J u' and J in the set ``acceleration`` are next, then counters of turns with the coordinates they count."""

FRAME = 29
"""Numbers of a frame. They begin with quaternion and position of its displacement from the reference pose, and the rotation matrix by rows. Velocity
at the origin and angular velocity follow, their rates at zero rates of v, and the angle of a planar frame with its turns."""
BODY = 8
"""Numbers of a body at the reference pose: position, quaternion, and angle in the plane."""
