"""Decisions on Adams datasets: expressions, curves, racks, axes, lines of a written dataset."""

from __future__ import annotations

import ast
from unittest.mock import patch

import numpy as np

from stiffmbs.adams.commands import commands
from stiffmbs.adams.export import numbering
from stiffmbs.adams.functions import motion_law
from stiffmbs.adams.scene import curves, racks
from stiffmbs.adams.statements import geometry, sensor
from stiffmbs.errors import InputError
from tests.decisions.common import BELOW, Record, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def most_parts_of_a_variable():
    def accepts(count):
        tree = ast.Tuple([ast.Constant(0)] * round(count), ast.Load())
        law = Record(
            mechanism=Record(dataset=Record(variables={1: Record(function=None)})), implicit_variables=(), translated=lambda _: tree
        )  # fmt: skip
        return not refused(lambda: motion_law._InPlace.variable(law, 1, Record(fault=InputError)))

    return count_while(lambda count: accepts(100 * count), DOUBLES)


def patience():
    law = Record(_formula=lambda: "t", _motion=Record(order=1))
    with patch.object(motion_law, "time_limit", reach):
        return reached(lambda: motion_law.Law._integrated(law))


def largest_exponent():
    return count_while(
        lambda power: not refused(lambda: motion_law._check_exponents(ast.parse(f"t**{power}"))), range(1, 200)
    )


def farthest_contact():
    def accepts(apart):
        place = Record(initial=Record(point=np.zeros(3)), reference="i")
        one = Record(i=1, axes=2, curve=3, start=None, fault=InputError)
        with patch.multiple(
            curves, fitted_curve=lambda *_: Record(size=1.0, marker="j", law={}), _ground_point=lambda *_: np.array([apart, 0, 0])
        ):  # fmt: skip
            return not refused(lambda: curves._on_curve(one, Record(place=lambda *_: place)))

    return count_while(lambda apart: accepts(1e-4 * apart), DOUBLES)


def samples_of_a_curve():
    curve = Record(arguments=np.arange(5.0), values=np.arange(5.0), ends="natural")
    with patch.object(curves._Sampled, "__call__", lambda _, at: np.zeros((1, len(at), 3))):
        return len(curves._Sampled(curve).parameters)


def largest_lean_of_a_pinion():
    upright = Record(initial=Record(axes=np.eye(3)))

    def is_its_axis(cosine):
        leaning = np.eye(3)
        leaning[:, 2] = [np.sqrt(1 - cosine**2), 0.0, cosine]
        return racks._axis(Record(initial=Record(axes=leaning)), upright) is not None

    return count_while(lambda cosine: is_its_axis(1e-3 * cosine), DOUBLES[:36])


DECISIONS = {
    "adams.commands.commands:NAMED_FIRST": lambda: count_while(
        lambda line: commands._is_name_of_file(Record(line=line, ident="", pieces=[])), range(1, 20)
    ),
    "adams.export.numbering:WIDTH": lambda: max(map(len, numbering._lines(", ".join(["1"] * 500)))),
    "adams.functions.motion_law:MOST_PARTS": most_parts_of_a_variable,
    "adams.functions.motion_law:PATIENCE": patience,
    "adams.functions.motion_law:LARGEST_EXPONENT": largest_exponent,
    "adams.scene.curves:ELSEWHERE": farthest_contact,
    "adams.scene.curves:SAMPLES": samples_of_a_curve,
    "adams.scene.racks:ACROSS": lambda: count_while(
        lambda gap: not racks._crosses(Record(diameter=2.0), np.array([gap])), BELOW
    ),
    "adams.scene.racks:SKEWED": largest_lean_of_a_pinion,
    "adams.statements.geometry:ROUNDING": lambda: count_while(
        lambda sine: geometry._from_x(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, sine])) is not None, BELOW
    ),
    "adams.statements.geometry:PRECISION": lambda: count_while(
        lambda sine: not racks._alike(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, sine])), BELOW
    ),
    "adams.statements.sensor:USUAL_ERROR": lambda: sensor._error(Record(number=lambda _: None), None),
}  # fmt: skip
EXPECTED = {
    "adams.commands.commands:NAMED_FIRST": 2, "adams.export.numbering:WIDTH": 76, "adams.functions.motion_law:MOST_PARTS": 27,
    "adams.functions.motion_law:PATIENCE": 10.0, "adams.functions.motion_law:LARGEST_EXPONENT": 32, "adams.scene.curves:ELSEWHERE": 27,
    "adams.scene.curves:SAMPLES": 400, "adams.scene.racks:ACROSS": 40, "adams.scene.racks:SKEWED": 27, "adams.statements.geometry:ROUNDING": 119,
    "adams.statements.geometry:PRECISION": 80, "adams.statements.sensor:USUAL_ERROR": 0.001,
}  # fmt: skip
