"""Repeated runs of a prepared model with changed parameters of a force."""

from __future__ import annotations

from typing import Any

from ..errors import InputError
from ..reading.did_you_mean import did_you_mean
from .job import Job, prepare
from .renumber import renumbered


def with_numbers(job: Job, name: str, **numbers: Any) -> Job:
    """Return a job with changed parameters of a force, without a new compilation, examination or presolve.

    The model is prepared again only if its equations change, or if the presolve solves mechanisms separately.  The
    compiled system is changed in place, so `job` itself must not be integrated again.  Threads may run concurrently,
    each with its own job from `prepare`.

    Parameters
    ----------
    name : str
        Name of the force.
    **numbers
        Fields to change, in SI units: ``stiffness=300.0``, ``stiffness=[1e6, 1e6, 500.0]``.

    Raises
    ------
    InputError
        If there is no such force, or a field is unknown or out of bounds.
    AssemblyError
        If there is no consistent start with these numbers.

    Examples
    --------
    >>> job = prepare(scene, rtol=1e-8)
    >>> for k in np.linspace(200, 400, 1000):
    ...     job = with_numbers(job, "spring", stiffness=k)
    ...     ends.append(job.integrate().q[-1])
    """
    force = job.data.forces.get(name)
    if force is None:
        near = did_you_mean(name, job.data.forces)
        raise InputError(f"found no force '{name}'{near}, expected one of {', '.join(job.data.forces) or 'none'}")
    try:
        changed = type(force)(**{**{field: getattr(force, field) for field in force.model_fields_set}, **numbers})
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    data = job.data.model_copy(update={"forces": {**job.data.forces, name: changed}})
    return renumbered(job, data) or prepare(data, job.settings, job.start_from)
