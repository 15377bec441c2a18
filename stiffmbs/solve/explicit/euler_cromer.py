"""Semi-implicit Euler scheme (Euler-Cromer), with fixed steps."""

from __future__ import annotations

from .scheme import Scheme

EULER_CROMER = Scheme(name="euler_cromer", order=1, stages=1, c=(0, 1), a=({}, {0: 1}), semi_implicit=True)
"""u_{n+1} = u_n + h u'(q_n, u_n), q_{n+1} = q_n + h u_{n+1}. Cromer, American Journal of Physics 49 (1981) 455."""
