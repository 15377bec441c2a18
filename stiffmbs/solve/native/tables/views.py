"""Views of the tables of integrators and of the dynamics for compiled code."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import view_of
from stiffmbs.solve.native.tables.linear import DYNAMICS, ELIMINATED
from stiffmbs.solve.native.tables.steps import EXPLICIT, IDA, SCHEME

dynamics_view = view_of("Dynamics", DYNAMICS)
eliminated_view = view_of("Eliminated", ELIMINATED)
explicit_view = view_of("Explicit", EXPLICIT)
ida_view = view_of("Ida", IDA)
scheme_view = view_of("Scheme", SCHEME)
