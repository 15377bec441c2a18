"""Handling tests as text and as a page (needs jinja2, of the extra ``report``)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..reading.units.display import DisplayUnits
from ..reading.units.units import DIMENSIONS
from ..results.files import write_text
from ..studies.handling.known import Metrics
from ..studies.handling.standards import TESTS
from ..studies.handling.steering_inputs import BAR_OF
from ..studies.handling.study import Handling, Tested
from ..studies.targets import YES_OR_NO
from .force_table import with_bar
from .handling_charts import handling_charts
from .page.page_of_tests import MINUS, Judgement, change, heads, page_of_tests, written_unit
from .page.targets import Targets, target_sections, with_targets
from .sections import MISSING, Section, Table

if TYPE_CHECKING:
    from ..results.provenance import Provenance

NOT_REACHED = "not reached"
UNITS = {"angle": "deg", "velocity": "km/h"}
"""Units of the page, unless the scene chooses others."""


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


def handling_metrics(found: Handling) -> list[tuple[str, str, str]]:
    """Return name, value and unit of the metrics of all tests."""
    return [
        (f"{name}: {metric}", value, unit) for name, one in found.tests.items() for metric, value, unit in _rows(one)
    ]


def _steered(found: Handling) -> str:
    """Return a clause on the steer angle of the front wheels; the travel of the rack or the angle of the steering wheel is the joint's."""
    if found.car.angular:
        return f"the front wheels steer by {10 * found.ratio:.3g} deg for 10 deg of {found.car.steering}"
    return f"the front wheels steer by {math.degrees(0.01 * found.ratio):.3g} deg for 10 mm of {found.car.steering}"


def _measured(found: Handling) -> str:
    """Return a sentence on the point at which channels of the vehicle are measured."""
    car = found.car
    name = "point of the section vehicle" if car.point_given else "centre of mass as described"
    ahead, height = car.behind(car.measured), car.measured[2]
    return f"measured at the {name}, {ahead:.4g} m ahead of the rear axle, {height:.4g} m above the road"


def write_handling(
    path: Path, variants: Mapping[str, Handling], origins: Mapping[str, Provenance | None], units: Mapping[str, str],
    targets: Targets | None = None,
) -> None:  # fmt: skip
    """Write the page of all tests of one or several variants of a car, completely or not at all.

    `variants`: by name; a single one may have no name. `origins`: those of their results. `units`: units by dimension that
    the scene chooses. `targets`: those of the variants. Raises OSError if the file cannot be written.
    """
    display = DisplayUnits({**UNITS, **units})
    found = next(iter(variants.values()))
    facts = (
        ("Wheelbase", f"{found.car.wheelbase:.4g} m"),
        ("Track", f"{found.car.track:.4g} m"),
        ("Steering", _steered(found)),
    )
    wanted = targets or {}
    sections = [*target_sections(wanted), *(_section(variants, name, display) for name in found.tests)]
    judged = with_targets(_judged(variants), wanted)
    write_text(path, page_of_tests("Handling tests", found.name, facts, judged, sections, origins))


def _judged(variants: Mapping[str, Handling]) -> Judgement:
    """Return how many tests were done, and which answers were no."""
    count = len(next(iter(variants.values())).tests)
    failed, answers = [], []
    for variant, found in variants.items():
        of = f" ({variant})" if len(variants) > 1 else ""
        for name, one in found.tests.items():
            title = TESTS[name].title.partition(",")[0]
            failed += [f"{title}{of} was not done: {one.message}."] if one.message else []
            answers += [
                (f"{title}{of}: {'' if value else 'not '}{metric.removesuffix(YES_OR_NO)}", bool(value))
                for metric, (value, _) in one.metrics.items()
                if metric.endswith(YES_OR_NO)
            ]
    denied, passed = ([name for name, yes in answers if yes is kind] for kind in (False, True))
    further = (*failed, f"M{_measured(next(iter(variants.values())))[1:]}.")
    done = f"{count} test{'s' if count > 1 else ''}" + (f" of {len(variants)} variants" if len(variants) > 1 else "")
    if denied:
        return Judgement("doubt", "! Not passed", f"{'; '.join(denied)}.", further)
    if failed:
        return Judgement("doubt", "! Incomplete", f"{len(failed)} of {done} could not be done.", further)
    return Judgement("done", "\N{CHECK MARK} Completed", f"{'; '.join([done, *passed])}.", further)


def _section(variants: Mapping[str, Handling], name: str, display: DisplayUnits) -> Section:
    """Return the section of a test: its parameters, the metrics of all variants, and its charts."""
    tested = {variant: found.tests[name] for variant, found in variants.items()}
    first = next(iter(tested.values()))
    missing = [
        f"{variant} was not done: {one.message}" if variant else f"Not done: {one.message}"
        for variant, one in tested.items()
        if one.message
    ]
    rows = tuple(_compared([one.metrics for one in tested.values()], display))
    tables = (Table(heads(list(variants)), rows),) if rows else ()
    parameters = [f"Parameters: {', '.join(_parameters(name, first, display))}."] if first.parameters else []
    return Section(
        TESTS[name].title, (*missing, *parameters), tables, drawings=tuple(handling_charts(variants, name, display))
    )


def _compared(found: list[Metrics], display: DisplayUnits) -> Iterator[tuple[str, ...]]:
    """Yield a row for each metric: its name, a value of each variant, the change between two, and the unit."""
    for name in dict.fromkeys(name for metrics in found for name in metrics if not name.endswith(BAR_OF)):
        unit = next(metrics[name][1] for metrics in found if name in metrics)
        shown, factor = display.of(unit)
        values = [metrics.get(name, (math.nan, ""))[0] for metrics in found]
        cells = (_cell(metrics, name, factor) for metrics in found)
        yield (
            name.removesuffix(YES_OR_NO),
            *cells,
            *([MISSING] if name.endswith(YES_OR_NO) and len(found) == 2 else change(values)),
            written_unit(shown),
        )


def _cell(metrics: Metrics, name: str, factor: float) -> str:
    """Return a value with its error bar, an answer in words, or that it was not reached."""
    if name not in metrics:
        return MISSING
    value = metrics[name][0]
    if not np.isfinite(value):
        return NOT_REACHED
    if name.endswith(YES_OR_NO):
        return "yes" if value else "no"
    bar = metrics.get(name + BAR_OF, (math.nan, ""))[0]
    return with_bar(value * factor, bar * factor) if bar > 0 else f"{value * factor:.4g}".replace("-", MINUS)


def _parameters(name: str, one: Tested, display: DisplayUnits) -> Iterator[str]:
    """Yield the parameters of a test with their units."""
    for each in fields(TESTS[name].parameters):
        value, unit = one.parameters.get(each.name), DIMENSIONS.get(each.metadata["dimension"], ("", ""))[1]
        if value is not None:
            shown, factor = display.of("" if unit == "1" else unit)
            number = value * factor if isinstance(value, float) and factor != 1.0 else value
            yield f"{each.name.replace('_', ' ')} {_number(number)} {written_unit(shown)}".rstrip()


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
        _row(name, value, unit) if np.isfinite(value) else (name, NOT_REACHED, "")
        for name, (value, unit) in one.metrics.items()
    ]


def _row(name: str, value: float, unit: str) -> tuple[str, str, str]:
    answer = name.endswith(YES_OR_NO)
    return (name.removesuffix(YES_OR_NO), "yes" if value else "no", "") if answer else (name, f"{value:.5g}", unit)
