"""Conversion of forces."""

from __future__ import annotations

from functools import singledispatchmethod
from operator import mul

from ...elements.spatial.number_format import plain, vector
from ..functions.expression import parse
from ..functions.function import Function
from ..functions.translate import Translation
from ..statements.constraints import TRANSLATIONAL
from ..statements.elastic import Beam, Elastic, SpringDamper
from ..statements.forces import SingleForce, VectorForce
from ..statements.text import of_each
from .mechanism import Mechanism

TORQUE = "_torque"
"""Name suffix for the torque of a GFORCE, a separate element of the scene."""


class Forces:
    """Builder of the scene's forces."""

    def __init__(self, mechanism: Mechanism, translation: Translation) -> None:
        self._mechanism, self._translation = mechanism, translation
        self._units = mechanism.dataset.units

    def all(self) -> dict[str, object]:
        """Return the forces by name, ordered by kind of statement."""
        return of_each(self._mechanism.dataset.forces, self._made)

    @singledispatchmethod
    def _made(self, force: object) -> dict[str, object]:
        raise TypeError(f"no force of the scene for {force!r}")

    @_made.register
    def _single(self, force: SingleForce) -> dict[str, object]:
        """Return a line force that pushes the markers apart, a torque about z of J, or an action-only force on I."""
        i, j = self._mechanism.ends(force)
        linear = force.sort == TRANSLATIONAL
        unit = self._units.of(force=1, length=0 if linear else 1)
        law = self._translation.formula(force.function, unit)
        if linear and not force.action_only:
            return {force.name: {"type": "line_force", "i": i.reference, "j": j.reference, "force": law}}
        kind = "force" if linear else "torque"
        made: dict[str, object] = {"type": kind, "i": i.reference}
        if not force.action_only:
            made["j"] = j.reference
        return {force.name: made | {kind: [0, 0, law], "frame": j.reference}}

    @_made.register
    def _vector(self, force: VectorForce) -> dict[str, object]:
        """Return force and torque at I in the axes of RM, with the reaction on the part of JFLOAT."""
        i = self._mechanism.place(force.i, force, "I")
        other = self._mechanism.place(force.floating, force, "JFLOAT")
        frame = {} if force.axes is None else {"frame": self._mechanism.place(force.axes, force, "RM").reference}
        made: dict[str, object] = {}
        for kind, functions, length in (("force", force.force, 0), ("torque", force.torque, 1)):
            if not any(functions):
                continue
            law = [self._component(function, self._units.of(force=1, length=length)) for function in functions]
            name = force.name + (TORQUE if made else "")
            made[name] = {"type": kind, "i": i.reference, "j": other.body, kind: law, **frame}
        return made

    def _component(self, function: Function | None, unit: float) -> str | int:
        return 0 if function is None else self._translation.formula(function, unit)

    @_made.register
    def _spring(self, spring: SpringDamper) -> dict[str, object]:
        """Return a spring-damper. Adams' preload pushes the markers apart; here it is a tension."""
        i, j = self._mechanism.ends(spring)
        linear = spring.sort == TRANSLATIONAL
        free, kind = ("free_length", "spring_damper") if linear else ("free_angle", "torsion_spring")
        numbers = {
            "stiffness": spring.stiffness, "damping": spring.damping, free: spring.length, "preload": -spring.preload,
        }  # fmt: skip
        made = {"type": kind, "i": i.reference, "j": j.reference}
        return {spring.name: made | {name: plain(value) for name, value in numbers.items() if value}}

    @_made.register
    def _elastic(self, force: Elastic) -> dict[str, object]:
        if not force.has_potential:
            return self._without_potential(force)
        i, j = self._mechanism.ends(force)
        kind = force.keyword.lower()
        made: dict[str, object] = {"type": kind, "i": i.reference, "j": j.reference}
        for name, rows in (("stiffness", force.stiffness), ("damping", force.damping)):
            diagonal = [row[k] for k, row in enumerate(rows)]
            coupled = any(part for k, row in enumerate(rows) for column, part in enumerate(row) if column != k)
            if coupled:
                made[name] = [vector(row) for row in rows]
            elif any(diagonal):
                made[name] = vector(diagonal)
        if any(force.length):
            made["free"] = vector(force.length)
        if any(force.preload):
            made["preload"] = vector(force.preload)
        return {force.name: made}

    def _without_potential(self, force: Elastic) -> dict[str, object]:
        """Return a field with unsymmetric matrices as formula components at marker I, in the axes of J."""
        i, j = self._mechanism.ends(force)
        ends = f"({force.i},{force.j},{force.j})"
        length, time = self._units.length, self._units.time
        displacements = [(f"D{axis}{ends}", length) for axis in "XYZ"] + [
            (f"A{axis}({force.i},{force.j})", 1.0) for axis in "XYZ"
        ]
        rates = [(f"V{axis}{ends[:-1]},{force.j})", length / time) for axis in "XYZ"]
        rates += [(f"W{axis}{ends}", 1 / time) for axis in "XYZ"]
        laws = []
        for row in range(6):
            terms = [repr(plain(force.preload[row] + sum(map(mul, force.stiffness[row], force.length))))]
            terms += [
                f"{-factor!r} * ({self._measured(force, text, unit)})"
                for factors, measures in ((force.stiffness[row], displacements), (force.damping[row], rates))
                for factor, (text, unit) in zip(factors, measures, strict=True)
                if factor
            ]
            laws.append(" + ".join(terms))
        made = {"i": i.reference, "j": j.reference, "frame": j.reference}
        return {
            force.name: {"type": "force", **made, "force": laws[:3]},
            force.name + TORQUE: {"type": "torque", **made, "torque": laws[3:]},
        }

    def _measured(self, force: Elastic, text: str, unit: float) -> str:
        return self._translation.formula(Function(text, parse(text), force.line, force.label), unit)

    @_made.register
    def _beam(self, beam: Beam) -> dict[str, object]:
        i, j = self._mechanism.ends(beam)
        section = {
            "length": beam.length, "young": beam.young, "shear_modulus": beam.shear_modulus, "area": beam.area,
            "torsion": beam.torsion, "iyy": beam.iyy, "izz": beam.izz, "asy": beam.asy, "asz": beam.asz,
        }  # fmt: skip
        made: dict[str, object] = {"type": "beam", "i": i.reference, "j": j.reference}
        made |= {name: plain(value) for name, value in section.items() if value}
        if isinstance(beam.damping, tuple):
            made["damping"] = [vector(row) for row in beam.damping]
        elif beam.damping:
            made["damping_ratio"] = plain(beam.damping)
        return {beam.name: made}
