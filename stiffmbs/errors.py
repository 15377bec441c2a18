"""The package's own exceptions: each is one sentence that names the element, what was found and what was expected."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class StiffmbsError(Exception):
    """Base of every error that the package raises on purpose."""


class InputError(StiffmbsError):
    """The description is wrong: a scene, a model, or a setting (exit status 2)."""


class ChannelError(InputError, KeyError):
    """A solution has no channel of that name; a `KeyError` too, as of every mapping."""

    __str__ = InputError.__str__


class AssemblyError(StiffmbsError):
    """The bodies cannot be moved or accelerated so that every joint holds (exit status 1)."""


class SolverError(StiffmbsError):
    """An integrator stopped early (exit status 1); what was computed up to there is kept."""


class ChatteringError(SolverError):
    """A force chatters: no solution exists beyond this time, with any solver or tolerance."""


@contextmanager
def needs(package: str, extra: str) -> Iterator[None]:
    """Tell what to install where a package is missing that few parts need.

    Raises
    ------
    InputError
        In place of the error that an import of the package raises.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != package:
            raise
        raise InputError(f"found no {package}, expected it installed: pip install 'stiffmbs[{extra}]'") from None
