"""Many runs of one model with other numbers in a force, prepared once."""

from __future__ import annotations

from dataclasses import replace

from ..compile.numbers import write_numbers
from ..errors import InputError
from ..solve.events.restart import restarted
from .run import Job, prepare


def with_numbers(job: Job, name: str, **numbers: float) -> Job:
    """The same job with other numbers in a force: nothing is compiled, examined or presolved again.

    Only where the presolve has merged bodies or solves mechanisms apart, the model is prepared anew.  The compiled system
    is changed in place, so `job` itself must not be integrated again.  Threads may work at once, each with a job of its
    own from `prepare`.

    Parameters
    ----------
    job : Job
    name : str
        Of the force.
    **numbers
        Its fields to change, plain numbers in SI units: ``stiffness=300.0``.

    Raises
    ------
    InputError
        When there is no such force, or a field is unknown, out of bounds, or no plain number.

    Examples
    --------
    >>> job = prepare(scene, rtol=1e-8)
    >>> for k in np.linspace(200, 400, 1000):
    ...     job = with_numbers(job, "spring", stiffness=k)
    ...     ends.append(job.integrate().q[-1])
    """
    force = job.data.forces.get(name)
    if force is None:
        raise InputError(f"found no force '{name}', expected one of {', '.join(job.data.forces) or 'none'}")
    for field, value in numbers.items():
        for found in (getattr(force, field, None), value):
            if isinstance(found, bool) or not isinstance(found, int | float):
                raise InputError(
                    f"{name}.{field}: found {found!r}, expected a field that is a plain number, and a number"
                )
    changed = type(force)(**{**{field: getattr(force, field) for field in force.model_fields_set}, **numbers})
    data = job.data.model_copy(update={"forces": {**job.data.forces, name: changed}})
    if job.subsystems:  # the presolve's mechanisms hold the force in a form of their own
        return prepare(data, job.settings)
    write_numbers(job.dynamics.system, name, changed.at_initial_pose(data), data)
    job.dynamics.forget_pivots()  # so that the start does not depend on earlier runs
    start = restarted(job.dynamics, job.grid.start, job.start.q, job.start.u, project=False)
    return replace(job, data=data, start=start)
