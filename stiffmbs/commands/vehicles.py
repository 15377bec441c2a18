"""The commands ``stiffmbs kc``, ``loads``, ``handling`` and ``tyre``."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
from .process import Status
from .scene import CHANGES, assigned, in_file, is_written, option, output_option, pairs, refuse_file, refusing

if TYPE_CHECKING:
    from ..model.scene import Scene
    from ..studies.targets import Target

Result = TypeVar("Result")
BASE = "base"
"""Name of the scene itself among its variants."""
VARIANT = "A variant, and a change of SCENE for it"
TARGET = "Range of a metric, such as bump.toe=-0.005:0 or step_steer.yaw_rate_overshoot=:15"
_COMMA = re.compile(r",(?![^\[\]]*\])")
"""Comma between changes, not within a list."""
UNIT = "--unit DIMENSION=UNIT such as LENGTH=mm"


@click.command(short_help="Kinematics and compliance of an axle.")
@click.argument("scene")
@option("--axle TEXT", "Name of the axle: the part of names before .left and .right; '' for none.", default="front")
@option("--points INTEGER", "Number of points of each curve: odd, 5 or more.", default=11)
@option("--body TEXT", "Body that the rig clamps; by default chassis, or the body that carries the axle.")
@option("--steering TEXT", "Prismatic or revolute joint that steers; by default the guide of the axle.")
@option("--wheel BODY", "Body of a wheel, for scenes with other names; once or twice.", "wheels", multiple=True)
@option("--radius FLOAT", "Distance from the wheel centres to the road, m; by default the radius of the tyres.")
@option("--wheelbase FLOAT", "Wheelbase, m; by default from the scene.")
@option("--cg-height FLOAT", "Height of the centre of mass, m; by default from the scene.")
@option("--brake-share FLOAT", "Share of this axle in braking, 0 to 1; by default 0.6 in front and 0.4 at the rear.")
@option("--drive-share FLOAT", "Share of this axle in traction, 0 to 1; by default 1.")
@option("--inboard-brakes", "The brakes are mounted on the body.")
@option(
    "--outboard-drive/--inboard-drive",
    "Whether the carriers react the driving torque; a solid axle does.",
    default=None,
)
@option("--case NAME=SIZE ...", "Size of a load case; 0 omits it", "cases")
@option("--variant NAME=PATH=VALUE[,...] ...", VARIANT, "variants")
@option("--target NAME=LOW:HIGH ...", TARGET, "targets", callback=pairs)
@option("--figure PATH", "Draw the curves: .png, .svg or .pdf.")
@output_option("Write a page, or the curves: .html or .csv.")
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@CHANGES
def kc(
    scene: str, axle: str, points: int, body: str | None, steering: str | None, wheels: tuple[str, ...],
    radius: float | None, cases: tuple[str, ...], variants: tuple[str, ...], targets: list[tuple[str, str]], figure: Path | None, output: Path | None,
    as_json: bool, changes: list[tuple[str, str]], **vehicle: Any,
) -> None:  # fmt: skip
    """Sweep an axle of SCENE on a test rig by equilibria, and print its kinematics and compliance.

    Toe, camber, caster, kingpin, scrub radius, trail, roll centre, wheel and roll rates, anti-dive, Ackermann, swing arms
    and compliance matrices follow from the motion of any suspension; cases that do not apply are left out.

    Load cases with their default sizes: bump=50 and roll=30 (mm), steer=30 (mm of the rack), lateral=2,
    lateral_parallel=2, brake=2 and traction=2 (kN), aligning=100 and aligning_parallel=100 (N m).  The suspensions have
    a body upright with the markers spindle and patch, as shipped parts have, or tyres on wheels with a revolute joint.

    --variant NAME=PATH=VALUE compares SCENE, as base, with a changed one: a page has the curves of both.

    --target camber=-1:0 is a range of a measure, --target bump.toe=-0.005:0 one of the slope of a curve, for both sides.

    Exit status: 0 done, 1 no equilibrium was found, a target is missed or a file could not be written, 2 the input is wrong.
    """
    from ..results.files import write_table
    from ..results.provenance import provenance_of
    from ..show.page.kc import write_kc
    from ..show.style import write_sheet
    from ..show.suspension import kc_csv, kc_figure, kc_metrics, kc_text
    from ..studies.suspension.kinematics_and_compliance import kinematics_and_compliance
    from ..studies.suspension.vehicle import VehicleOptions
    from ..studies.targets import checked_targets

    with refusing(scene, as_json):
        refuse_file("--figure", figure, scene, "figure")
        refuse_file("-o", output, scene, "curves of an axle")
        _refuse_several(variants, output, figure)
        asked = checked_targets(dict(targets))
        scenes = _variants(scene, changes, variants)
        with in_file(scene):
            given = VehicleOptions(**vehicle)
            sizes = assigned("--case NAME=SIZE such as bump=40", cases, float)
            every = {
                name: kinematics_and_compliance(loaded, axle, points, body, steering, wheels, radius, given, **sizes)
                for name, loaded in scenes.items()
            }
    wanted = _Judged.of(every, asked)
    origins = {name: provenance_of(loaded) for name, loaded in scenes.items()}
    found, origin = next(iter(every.values())), next(iter(origins.values()))

    def write_curves(path: Path) -> None:
        """Write the page, or the table."""
        if path.suffix == ".html":
            write_kc(path, every, origins, wanted.found)
        else:
            write_table(path, kc_csv(found), origin)

    written = is_written(output, write_curves)
    written = is_written(figure, lambda path: write_sheet(path, kc_figure(found), origin=origin)) and written
    _print(every, wanted, as_json, lambda one: one.as_dict(scene), lambda one: kc_text(scene, one), kc_metrics)
    sys.exit(wanted.status(written))


@click.command(short_help="Peaks of all bushings' loads over load cases.")
@click.argument("scene")
@option("--case NAME=PATH=VALUE[,...] ...", "A load case, and a change of SCENE for it", "cases")
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@CHANGES
def loads(scene: str, cases: tuple[str, ...], as_json: bool, changes: list[tuple[str, str]]) -> None:
    """Run SCENE in each load case, and print the largest force and torque of every bushing in its own axes.

    --case kerb=choose.manoeuvre=bump --case fast=V=30,run.duration=5 runs two cases; by default SCENE runs unchanged.
    stiffmbs report SCENE --loads writes a page with them.

    Exit status: 0 done, 1 a run stopped early, 2 the input is wrong.
    """
    from ..analyses.run import run
    from ..show.suspension import road_loads_text
    from ..studies.suspension.road_loads import road_loads

    with refusing(scene, as_json):
        runs = {}
        for name, own in [_case(text) for text in cases] or [("run", [])]:
            loaded = load_scene(scene, [*changes, *own])
            with in_file(scene):
                runs[name] = run(loaded)
        with in_file(scene):
            found = road_loads(loaded, runs)
    stopped = {name: each.message for name, each in runs.items() if not each.success}
    printed = {"scene": scene, "status": "stopped" if stopped else "done", "message": "; ".join(stopped.values())}
    click.echo(json.dumps({**printed, "loads": found.as_dict()}) if as_json else road_loads_text(scene, found))
    for name, message in stopped.items():
        click.echo(f"stiffmbs: {name}: {message}", err=True)
    if stopped:
        raise SystemExit(1)


def _case(text: str, option: str = "--case") -> tuple[str, list[tuple[str, str]]]:
    name, _, rest = text.partition("=")
    changes = [tuple(change.split("=", 1)) for change in _COMMA.split(rest) if change]
    if not name or not changes or any(len(change) != 2 for change in changes):
        raise InputError(f"{option} {text}: found no changes, expected NAME=PATH=VALUE")
    return name, [(path, value) for path, value in changes]  # type: ignore[misc]


@click.command(short_help="Handling and ride tests of the standards on a car.")
@click.argument("scene")
@option("--test NAME ...", "One of the tests, all by default", "tests")
@option("--body TEXT", "Sprung body; by default that of the section vehicle, or chassis.")
@option("--steering TEXT", "Joint that steers; by default steering_wheel, or the only joint named guide.")
@option("--width FLOAT", "Width of the vehicle, m; by default the track plus 0.2 m.")
@option("--length FLOAT", "Length of the vehicle, m; by default 1.6 wheelbases.")
@option("--workers INTEGER RANGE", "Number of processes; by default one for each core.")
@option("--variant NAME=PATH=VALUE[,...] ...", VARIANT, "variants")
@option("--target NAME=LOW:HIGH ...", TARGET, "targets", callback=pairs)
@option(
    "--set-test NAME=VALUE ...",
    "Change a parameter of a test, such as step_steer.speed='100 km/h', or of each test that has it, speed=30",
    "parameters",
    callback=pairs,
)
@output_option("Write a page: .html.")
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@CHANGES
def handling(
    scene: str, tests: tuple[str, ...], body: str | None, steering: str | None, width: float | None,
    length: float | None, workers: int | None, variants: tuple[str, ...], targets: list[tuple[str, str]], parameters: list[tuple[str, str]],
    output: Path | None, as_json: bool, changes: list[tuple[str, str]],
) -> None:  # fmt: skip
    """Drive the car of SCENE through tests of the standards, and print their metrics.

    Tests: constant_speed and constant_radius (ISO 4138), step_steer and frequency_response (ISO 7401), sine_with_dwell
    (ISO 19365), lane_change (ISO 3888-1), obstacle_avoidance (ISO 3888-2), braking_in_a_turn (ISO 7975), straight_braking
    (ISO 21994), ride (ISO 2631-1). The scene's own driver, roads and start are left out.

    --variant stiffer=parts.bar.k=2100 compares SCENE, as base, with a changed one: the page has both in its tables and charts.

    --target step_steer.yaw_rate_overshoot=:15 is a range of a metric, in its unit or with another one.

    Exit status: 0 done, 1 a test was not done, a target is missed or the page could not be written, 2 the input is wrong.
    """
    from ..results.provenance import provenance_of
    from ..show.handling import handling_metrics, handling_text, write_handling
    from ..studies.handling.standards import TESTS
    from ..studies.handling.study import handling as handled
    from ..studies.targets import checked_targets

    chosen: dict[str, Any] = {"body": body, "steering": steering, "width": width, "length": length, "workers": workers}
    with refusing(scene, as_json):
        refuse_file("-o", output, scene, "report")
        asked = checked_targets(dict(targets), tests or TESTS)
        scenes = _variants(scene, changes, variants)
        with in_file(scene):
            found = {
                name: handled(loaded, tests or None, parameters=dict(parameters), **chosen)
                for name, loaded in scenes.items()
            }
    wanted = _Judged.of(found, asked)
    origins = {name: provenance_of(loaded) for name, loaded in scenes.items()}
    units = next(iter(scenes.values())).units
    written = is_written(output, lambda path: write_handling(path, found, origins, units, wanted.found))
    _print(
        found, wanted, as_json, lambda one: one.as_dict(scene), lambda one: handling_text(scene, one), handling_metrics
    )
    done = not any(test.message for one in found.values() for test in one.tests.values())
    sys.exit(wanted.status(written and done))


@dataclass(frozen=True)
class _Judged:
    """Targets of all variants, or why a target cannot be judged."""

    found: dict[str, Sequence[Target]]
    trouble: str = ""

    @classmethod
    def of(cls, results: Mapping[str, Any], asked: Mapping[str, str]) -> _Judged:
        """Return the targets with the values of results; the results remain if a target cannot be judged."""
        try:
            return cls({name: one.judged(asked) for name, one in results.items()})
        except InputError as error:
            return cls({}, str(error))

    def status(self, done: bool) -> int:
        """Return the exit status of a command that is otherwise done, and print what is wrong with a target."""
        if self.trouble:
            click.echo(f"stiffmbs: {self.trouble}", err=True)
            return Status.WRONG_INPUT
        met = all(target.met for targets in self.found.values() for target in targets)
        return Status.DONE if done and met else Status.FAILED


def _refuse_several(variants: tuple[str, ...], output: Path | None, figure: Path | None) -> None:
    """Refuse variants with a table or a figure, which hold one axle."""
    if variants and (figure or (output and output.suffix != ".html")):
        raise InputError(
            "--variant: found a table or a figure to write, expected a page, such as -o kc.html, which shows all variants"
        )


def _print(
    found: Mapping[str, Result], judged: _Judged, as_json: bool, content: Callable[[Result], dict[str, object]],
    text: Callable[[Result], str], metrics: Callable[[Result], Sequence[tuple[str, str, str]]],
) -> None:  # fmt: skip
    """Print the results of all variants, as JSON by their names, or as text with a table of the metrics that differ.

    A single result has no name.
    """
    from ..show.page.page_of_tests import compared_lines
    from ..show.page.targets import target_lines, targets_as_dict

    if as_json:
        contents = {
            name: content(one) | ({"targets": targets_as_dict(of)} if (of := judged.found.get(name)) else {})
            for name, one in found.items()
        }
        click.echo(json.dumps(contents.get("", contents)))
        return
    for name, one in found.items():
        lines = [text(one), *target_lines(judged.found.get(name, ()))]
        click.echo("\n".join([f"variant {name}", *lines] if name else lines))
    if len(found) > 1:
        click.echo("\n".join(compared_lines({name: metrics(one) for name, one in found.items()})))


def _variants(scene: str, changes: list[tuple[str, str]], variants: tuple[str, ...]) -> dict[str, Scene]:
    """Return the scene with the changes of each variant by name; the scene itself, without a name, if there is none."""
    if not variants:
        return {"": load_scene(scene, changes)}
    own = [_case(text, "--variant") for text in variants]
    names = [BASE, *(name for name, _ in own)]
    for k, name in enumerate(names):
        if name in names[:k]:
            raise InputError(
                f"--variant: found the name '{name}' twice, expected different ones ({BASE} is SCENE itself)"
            )
    return {BASE: load_scene(scene, changes), **{name: load_scene(scene, [*changes, *of]) for name, of in own}}


@click.command(short_help="Curves of a tyre; conversion of property files.")
@click.argument("file")
@option("--load TEXT ...", "N, or with a unit", "loads")
@option("--pressure TEXT ...", "Pa, or with a unit, of 6.1, 6.2 and PAC2002", "pressures")
@option("--camber TEXT", "rad, or with a unit.", default="0")
@option("--speed TEXT", "m/s, or with a unit; LONGVL by default.")
@option("--points INTEGER", "Number of points of each curve.", default=61)
@option(
    "--at Fz,kappa,... ...",
    "Evaluate one state of Fz, kappa, alpha, gamma, p, Vx, phit in SI units, each empty for its default",
    "states",
)
@output_option("Draw Fx, Fy, Mz and the friction ellipse: .png, .svg or .pdf.")
@option("--write PATH", "Write the properties that are used: .tir.", "copy")
@option("--unit LENGTH=mm ...", "Unit of --write", "units")
@option("--json", "Print one JSON object on one line.", "as_json")
def tyre(
    file: str, loads: tuple[str, ...], pressures: tuple[str, ...], camber: str, speed: str | None, points: int,
    states: tuple[str, ...], output: Path | None, copy: Path | None, units: tuple[str, ...], as_json: bool,
) -> None:  # fmt: skip
    """Evaluate the tyre of FILE (.tir): forces over slip and slip angle, and the friction ellipse, in ISO axes.

    --load 2000 --load "4 kN" --pressure "220 kPa" draws the curves at two loads.  --write OTHER.tir --unit LENGTH=mm
    writes a file of the same evaluation in other units.

    Exit status: 0 done, 1 a file could not be written, 2 the input is wrong.
    """
    from ..elements.tyres.coefficients import TyreProperties
    from ..elements.tyres.written_file import property_text
    from ..results.files import write_text
    from ..show.style import write_sheet
    from ..show.tyre import tyre_figure, tyre_text
    from ..studies.tyre_curves import TyreSweep, finite, tyre_curves, tyre_states

    with refusing(file, as_json):
        refuse_file("-o", output, file, "figure")
        refuse_file("--write", copy, file, "tyre")
        properties = TyreProperties.from_file(file)
        sweep = TyreSweep(**{
            "load": loads, "pressure": pressures, "camber": camber, "points": points, **({} if speed is None else {"speed": speed}),
        })  # fmt: skip
        curves = tyre_curves(properties, sweep)
        found = tyre_states(properties, [_state(text) for text in states])
        of_copy = {kind.upper(): unit for kind, unit in assigned(UNIT, units, str).items()}
        text = property_text(properties, of_copy) if copy is not None else ""
    kind = "Magic Formula " * properties.formula.is_magic + properties.version
    title = f"{file}: {kind}, camber {sweep.camber:.4g} rad"
    written = is_written(copy, lambda path: write_text(path, text))
    written = is_written(output, lambda path: write_sheet(path, tyre_figure(title, curves))) and written
    notes = list(properties.notes())
    printed = {
        "file": file, "version": properties.version, "camber": sweep.camber,
        "curves": [curve.as_dict() for curve in curves], "states": [finite(state) for state in found], "notes": notes,
    }  # fmt: skip
    click.echo(json.dumps(printed) if as_json else tyre_text(title, curves, found, notes))
    sys.exit(0 if written else Status.FAILED)


def _state(text: str) -> tuple[float | None, ...]:
    from ..studies.tyre_curves import STATE

    try:
        first, *others = text.split(",")
        row = (float(first), *(float(part) if part.strip() else None for part in others))
    except ValueError:
        raise InputError(f"--at {text}: found no numbers, expected up to {len(STATE)}: {','.join(STATE)}") from None
    if len(row) > len(STATE):
        raise InputError(f"--at {text}: found {len(row)} numbers, expected up to {len(STATE)}: {','.join(STATE)}")
    return row
