"""Exceptions of the package; each message names the element, the value found and the value expected."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec


class StiffmbsError(Exception):
    """Base class of the errors that the package raises."""


class InputError(StiffmbsError):
    """Invalid scene, model or setting (exit status 2)."""


class ChannelError(InputError, KeyError):
    """Unknown channel name of a solution; also a `KeyError`, as for every mapping."""

    __str__ = InputError.__str__


class AssemblyError(StiffmbsError):
    """No pose, velocity or acceleration satisfies all joints (exit status 1)."""


class SolverError(StiffmbsError):
    """Early stop of an integrator (exit status 1); results up to there are kept."""


class ChatteringError(SolverError):
    """Chattering of a force: no solution exists beyond this time, with any solver or tolerance."""


@contextmanager
def prefixed(
    place: str, caught: type[Exception] | tuple[type[Exception], ...] = InputError, raised: type[Exception] = InputError
) -> Iterator[None]:
    """Raise an error with a place, such as ``bodies.bar: ``, in front of the message of the one that was caught."""
    try:
        yield
    except caught as error:
        raise raised(f"{place}{error}") from None


@contextmanager
def needs(package: str, extra: str) -> Iterator[None]:
    """Raise an error that names the extra to install if an optional package is missing.

    Raises
    ------
    InputError
        In place of the `ModuleNotFoundError` of that package.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != package:
            raise
        raise InputError(not_installed(package, f"'stiffmbs[{extra}]'")) from None


def not_installed(package: str, source: str) -> str:
    """Return the message on a missing package; `source` is the argument of ``pip install`` that installs it."""
    return f"this needs {package}, which is not installed: pip install {source}"


def refuse_missing(package: str, source: str, where: str = "") -> None:
    """Raise an error if an optional package is not installed.

    Parameters
    ----------
    source : str
        Argument of ``pip install`` that installs it.
    where : str
        Beginning of the message.

    Raises
    ------
    InputError
    """
    if find_spec(package) is None:
        raise InputError(where + not_installed(package, source))


def refuse_text(name: str, found: object, entries: str) -> None:
    """Raise an InputError if a text is given for a list of texts, as it would be a list of letters."""
    if isinstance(found, str):
        raise InputError(f"{name}: found '{found}', expected a list of {entries}")
