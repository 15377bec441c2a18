"""Values of parts as described: in the frames of the parts, before they are placed and mirrored."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .vectors import COMPONENTS

if TYPE_CHECKING:
    from .instances import Instance

PARAMETERS = "parameters"


@dataclass(frozen=True)
class AsDescribed:
    """Instances of the parts of a scene by name, each with its validated sections; comparisons of scenes ignore it."""

    instances: Mapping[str, tuple[Instance, Mapping[str, Any]]] = field(compare=False)

    def __reduce__(self) -> tuple[type[AsDescribed], tuple[dict[str, object]]]:
        """Copy without values, as `Unchanged`: a scene from the cache is read again before its values are varied."""
        return AsDescribed, ({},)

    def at(self, path: str) -> Iterator[tuple[object, str]]:
        """Yield the mapping in which each instance has the value at a path of a scene, and the path in this mapping.

        A path that begins with ``parts`` is in all instances of that part. Paths of other values have none.
        """
        section, _, rest = path.partition(".")
        if section == "parts":
            yield from self._in_definitions(rest)
            return
        names = [name for name in self.instances if rest.startswith(f"{name}.")]
        if not names:
            return
        name = max(names, key=len)  # the innermost one of nested parts
        instance, sections = self.instances[name]
        found = _of_use(instance) if section == "use" else sections.get(section)
        if found is not None:
            yield found, rest[len(name) + 1 :]

    def _in_definitions(self, path: str) -> Iterator[tuple[object, str]]:
        for instance, sections in self.instances.values():
            inside, _, below = path.removeprefix(f"{instance.part}.").partition(".")
            given = inside == PARAMETERS and _is_given(instance, below.partition(".")[0])
            if path.startswith(f"{instance.part}.") and not given:
                yield self._definition(instance, sections), f"{inside}.{below}"

    def _definition(self, instance: Instance, sections: Mapping[str, Any]) -> Mapping[str, Any]:
        inner = {each: self.instances[f"{instance.name}.{each}"][0] for each in instance.inner}
        uses = {name: _of_use(one) for name, one in inner.items()}
        return {**sections, PARAMETERS: _parameters(instance), "use": uses}


def _of_use(instance: Instance) -> Mapping[str, Any]:
    """Return the values of a use by their keys."""
    placement = {name: getattr(instance.use, name) for name in type(instance.use).model_fields}
    return {**placement, PARAMETERS: _parameters(instance)}


def _is_given(instance: Instance, parameter: str) -> bool:
    """Return True if the use gives a parameter, or a component of a vector."""
    components = (f"{parameter}_{axis}" for axis in COMPONENTS[: instance.vectors.get(parameter, 0)])
    return any(name in instance.use.parameters for name in (parameter, *components))


def _parameters(instance: Instance) -> dict[str, object]:
    """Return the parameters of an instance; of vectors, also all components together."""
    found: dict[str, Any] = {name: value.value for name, value in instance.parameters.items() if name in instance.own}
    vectors = {
        name: tuple(found[f"{name}_{axis}"] for axis in COMPONENTS[:count]) for name, count in instance.vectors.items()
    }
    return {**found, **vectors}
