"""Handling tests as text and as a page (needs jinja2 and matplotlib, the extra ``report``)."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..reading.units.units import DIMENSIONS
from ..results.files import write_text
from ..studies.handling.standards import TESTS
from ..studies.handling.study import Handling, Tested
from .handling_figure import handling_figure
from .origin import page_with_origin
from .page.data import environment
from .style import data_url

if TYPE_CHECKING:
    from ..results.provenance import Provenance

YES_OR_NO = " (1 yes, 0 no)"
"""End of the names of metrics that are answers."""
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>{{ name }}: handling</title><style>
body { font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }
img { max-width: 100%; height: auto; } pre { overflow-x: auto; }
table { border-collapse: collapse; } td, th { padding: 0.2em 0.8em; border-bottom: 1px solid #ccc; text-align: left; }
</style></head><body><h1>{{ name }}: handling</h1>
<p>Wheelbase {{ wheelbase }} m, track {{ track }} m; {{ steered }}; {{ measured }}.</p>
{% for title, message, rows, figure in sections %}<h2>{{ title }}</h2>
{% if message %}<p>Not done: {{ message }}</p>{% endif %}{% if rows %}
<table><tr><th>metric</th><th>value</th><th>unit</th></tr>
{% for row in rows %}<tr>{% for cell in row %}<td>{{ cell }}</td>{% endfor %}</tr>
{% endfor %}</table><p><img src="{{ figure }}" alt="{{ title }}"></p>{% endif %}
{% endfor %}</body></html>
"""


def handling_text(scene: str, found: Handling) -> str:
    """Return a line for each metric of each test."""
    car = found.car
    lines = [
        f"{scene}: wheelbase {car.wheelbase:.4g} m, track {car.track:.4g} m, steered by {car.steering}",
        _measured(found),
    ]
    for name, one in found.tests.items():
        lines.append(f"{name}: {_title(name, one)}" + (f": not done: {one.message}" if one.message else ""))
        lines += [f"  {metric:52} {value:>10} {unit}" for metric, value, unit in _rows(one)]
    return "\n".join(lines)


def _steered(found: Handling) -> str:
    """Return a clause on the steer angle of the front wheels; the travel of the rack or the angle of the steering wheel is the joint's."""
    if found.car.angular:
        return f"the front wheels steer by {10 * found.ratio:.3g} deg for 10 deg of {found.car.steering}"
    return f"the front wheels steer by {math.degrees(0.01 * found.ratio):.3g} deg for 10 mm of {found.car.steering}"


def _measured(found: Handling) -> str:
    """Return a sentence on the point at which channels of the vehicle are measured."""
    car = found.car
    name = "point of the section vehicle" if car.stated else "centre of mass as described"
    ahead, height = car.behind(car.measured), car.measured[2]
    return f"measured at the {name}, {ahead:.4g} m ahead of the rear axle, {height:.4g} m above the road"


def write_handling(path: Path, found: Handling, origin: Provenance | None = None) -> None:
    """Write the page of all tests with the origin of its results, completely or not at all.

    Raises OSError if the file cannot be written.
    """
    sections = [
        (
            _title(name, one),
            one.message,
            _rows(one),
            data_url(handling_figure(found, name, one), "svg", 100) if one.runs else "",
        )
        for name, one in found.tests.items()
    ]
    template = environment().from_string(PAGE)
    page = template.render(
        name=found.name, wheelbase=f"{found.car.wheelbase:.4g}", track=f"{found.car.track:.4g}", steered=_steered(found),
        measured=_measured(found), sections=sections,
    )  # fmt: skip
    write_text(path, page_with_origin(page, origin))


def _title(name: str, one: Tested) -> str:
    """Return the title of a test with its parameters in SI units."""
    units = {
        each.name: DIMENSIONS.get(each.metadata["dimension"], ("", ""))[1] for each in fields(TESTS[name].parameters)
    }
    values = [
        f"{key.replace('_', ' ')} {_number(value)} {units[key] if units[key] != '1' else ''}".rstrip()
        for key, value in one.parameters.items()
        if value is not None
    ]
    return f"{TESTS[name].title} ({', '.join(values)})"


def _number(value: object) -> str:
    if isinstance(value, tuple):
        return " ".join(map(_number, value))
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _rows(one: Tested) -> list[tuple[str, str, str]]:
    """Return the metrics as cells; a value without a number was not reached, and some are answers."""
    return [
        _row(name, value, unit) if np.isfinite(value) else (name, "not reached", "")
        for name, (value, unit) in one.metrics.items()
    ]


def _row(name: str, value: float, unit: str) -> tuple[str, str, str]:
    answer = name.endswith(YES_OR_NO)
    return (name.removesuffix(YES_OR_NO), "yes" if value else "no", "") if answer else (name, f"{value:.5g}", unit)
