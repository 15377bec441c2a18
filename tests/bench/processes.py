"""Memory and processor time of processes."""

from __future__ import annotations

import sys


def largest_memory() -> float:
    """The most memory that this process has had so far, MB."""
    import resource  # which Windows does not have

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (2**20 if sys.platform == "darwin" else 2**10)


def seconds_of_children() -> float:
    """Processor time of all processes that have been waited for so far, s."""
    import resource

    of_children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return of_children.ru_utime + of_children.ru_stime
