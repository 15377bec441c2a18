"""The package's own exceptions: each is one sentence that names the element, what was found and what was expected."""


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
