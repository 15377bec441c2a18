"""How the compiled routines of the mechanics end: zero or a count, or one of these failures.

Python reads them too, so nothing of the compiler is imported here; `stiffmbs.solve.failures` puts them into words.
"""

SINGULAR = -1
"""The block system has no unique solution."""
NO_CONVERGENCE = -2
"""Newton's moves do not come to the position constraints."""
NOT_FINITE = -3
"""An equation or a solution is not a finite number."""
NO_BALANCE = -6
"""Friction and the reactions that press it have no unique common solution, or the iteration does not find it."""
NO_ROOM = -7
"""There is too little memory for the factors of a block system."""
