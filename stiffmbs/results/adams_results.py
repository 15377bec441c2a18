"""Results as Adams .res files in XML, for Adams/PostProcessor (MSC Adams/Solver, RESULTS statement, XRF)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from .solution import Solution

NAMESPACE = "http://www.mscsoftware.com/:xrf10"


def write_adams_results(path: Path, solution: Solution) -> None:
    """Write all channels over time: a map that names the numbers of a step, then the steps.

    The entity is the part of a channel's name before its last dot, the component the part after it.
    """
    from xml.sax.saxutils import quoteattr

    with path.open("w", encoding="utf-8") as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        file.write(f'<Results xmlns="{NAMESPACE}">\n<Analysis name={quoteattr(solution.name or "run")}>\n')
        file.write('<StepMap name="map_001">\n<Entity name="time">\n<Component name="TIME" id="1"/>\n</Entity>\n')
        file.writelines(_entities(solution))
        file.write('</StepMap>\n<Data name="dynamic_001">\n')
        columns = (solution.time, *solution.channels.values())
        for k in range(len(solution.time)):
            numbers = "\n".join(f"{column[k]:.16e}" for column in columns)
            file.write(f'<Step type="dynamic">\n{numbers}\n</Step>\n')
        file.write("</Data>\n</Analysis>\n</Results>\n")


def _entities(solution: Solution) -> Iterator[str]:
    from xml.sax.saxutils import quoteattr

    for number, channel in enumerate(solution.channels, start=2):
        entity, _, component = channel.rpartition(".")
        yield (
            f"<Entity name={quoteattr(entity or channel)}>\n"
            f'<Component name={quoteattr(component if entity else "")} id="{number}"/>\n</Entity>\n'
        )
