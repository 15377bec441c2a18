"""Export of a spatial scene as an .asmt file for OndselSolver and FreeCAD."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...elements.spatial.orientation import matrix
from ...errors import InputError
from ...model.scene import Scene
from ...model.settings import DEFAULT_POINTS, RunSettings
from ...model.spatial_model import SpatialData
from ...reading.files.quoted import listed
from ...reading.files.written_fields import Recording, written
from ...reading.formula.formula import Formula
from ...reading.formula.text import parse
from ...reading.marker import GROUND
from ..assembly import WORLD, Frame
from .joints import SAME
from .read import COORDINATES, FUNCTIONS, LAW

KINDS = {kind: name for name, kind in SAME.items() if name != "AtPointJoint"} | {
    "planar": "PlanarJoint",
    "thread": "ScrewJoint",
}
"""Joints of the file by the kinds of a scene's joints between the same markers."""
ON_J = {"point_on_line": "PointInLineJoint", "point_on_plane": "PointInPlaneJoint"}
"""Joints whose marker I is the scene's marker j."""
ROD = "SphSphJoint"
WITHOUT = ("forces", "states", "inputs", "requests", "variables")
"""Sections of a scene that the file cannot contain."""
IN_LAWS = ("parameters", "tables", "roads")
"""Sections of a scene of which only what drives, forces and other entries use could be written."""
_IN_VIEW, _SOLVER = "the file has nothing of this kind; the motion is the same", "settings of this package"
LEFT_OUT = {
    "": dict.fromkeys(("name", "figure", "units", "notes", "vehicle", "path"), _IN_VIEW),
    "body": {
        "geometry": _IN_VIEW, "any_moments": _IN_VIEW, "markers": "no joint in the file refers to them",
        "open": "joints and motions change all velocities at the start",
    },
    "joint": {"turns": _IN_VIEW},
    "run": {"*": _SOLVER},
}  # fmt: skip
"""Reasons why fields are left out of the file with a note, by kind of their owner; all others are refused."""
REMEDIES = {
    "at_start": "describe bodies in the pose and with the velocities that it gives, and remove it",
    "stages": "write each stage as a scene of its own",
    "start": "describe the bodies in the pose of the start, and use start: described",
    "offset": "describe the bodies in the pose that the offset gives, and remove it",
}
OF_LAWS = {value: key for key, value in FUNCTIONS.items()} | {"t": "time", "pi": "pi"}
OPERATIONS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.USub)


@dataclass(frozen=True)
class WrittenAssembly:
    """Text of an .asmt file, and notes on what it does not contain."""

    text: str
    notes: tuple[str, ...]


def written_assembly(scene: SpatialData, source: str = "scene") -> WrittenAssembly:
    """Return a spatial scene as an .asmt file in SI units; what it cannot contain is in the notes.

    `source`: name of the scene in messages. Raises InputError for a scene with bodies that are not rigid, or with
    fields on which the motion depends and that the file cannot contain; names all of them.
    """
    if flexible := [name for name, body in scene.bodies.items() if not body.rigid]:
        raise InputError(
            f"{source}: found the flexible bodies {listed(flexible)}, expected rigid ones in an .asmt file"
        )
    recording = Recording(LEFT_OUT)
    sections = {"bodies": recording.section(scene.bodies, "body"), "joints": recording.section(scene.joints, "joint")}
    model = recording.of(scene.model_copy(update=sections), "")
    written(model, "dimensions", "markers", "run", *WITHOUT, *IN_LAWS)
    run = scene.run if isinstance(scene, Scene) else RunSettings(duration=1.0)
    equally_spaced = ("points",) if isinstance(run.points, int) else ()
    written(recording.of(run, "run"), "start", "duration", "output", *equally_spaced)
    writer = _Writer(model, run)
    lines = [*writer.assembly()]
    if refused := recording.refusals(REMEDIES):
        raise InputError(f"{source}: an .asmt file cannot contain {'; '.join(refused)}")
    lost = [
        f"{section[:-1] if section != 'variables' else 'variable'} {listed(list(found))}"
        for section in WITHOUT
        if (found := getattr(scene, section, None))
    ]
    lost += [f"joint {name} ({reason})" for name, reason in writer.lost.items()]
    notes = [f"not written, because an .asmt file cannot contain it: {one}" for one in lost]
    return WrittenAssembly("\n".join(lines) + "\n", (*notes, *recording.notes()))


class _Writer:
    """Lines of one scene and its run; `lost`: reasons why joints are not written."""

    def __init__(self, scene: Any, run: RunSettings) -> None:
        self.scene, self.run = scene, run
        self.lost: dict[str, str] = {}
        self.frames = {
            name: Frame(np.array(body.position), matrix(body.orientation)) for name, body in scene.bodies.items()
        }
        self.markers: dict[str, list[tuple[str, Frame]]] = {name: [] for name in (GROUND, *scene.bodies)}
        self.name = "Assembly1"

    def assembly(self) -> Iterator[str]:
        """Yield the lines of the file."""
        drives = {name: joint for name, joint in self.scene.joints.items() if joint.kind == "drive"}
        joints = [
            line for name, joint in self.scene.joints.items() if name not in drives for line in self._joint(name, joint)
        ]
        motions = [line for name, drive in drives.items() for line in self._motion(name, drive)]
        yield from ("OndselSolver", "Assembly")
        yield from _entry(1, "Notes", "(Text string: '' runs: (Core.RunArray runs: #() values: #()))")
        yield from _entry(1, "Name", self.name)
        yield from _pose(1, WORLD)
        yield from (*_row(1, "Velocity3D", (0, 0, 0)), *_row(1, "Omega3D", (0, 0, 0)))
        yield from self._points(1, GROUND)
        yield "\tParts"
        for name, body in self.scene.bodies.items():
            yield from self._part(name, body)
        yield from ("\tKinematicIJs", "\tConstraintSets", "\t\tJoints", *joints, "\t\tMotions", *motions)
        yield from ("\t\tGeneralConstraintSets", "\tForceTorques")
        yield from _row(1, "ConstantGravity", self.scene.gravity)
        yield "\tSimulationParameters"
        run = self.run
        points = run.points if isinstance(run.points, int) else DEFAULT_POINTS
        for key, value in (
            ("tstart", run.start),
            ("tend", run.start + run.duration),
            ("hmin", 1e-9),
            ("hmax", run.duration),
            ("hout", run.output or run.duration / (points - 1)),
            ("errorTol", 1e-6),
        ):
            yield from _entry(2, key, repr(float(value)))
        yield "\tAnimationParameters"
        for key, word in (
            ("nframe", "2"),
            ("icurrent", "1"),
            ("istart", "1"),
            ("iend", "2"),
            ("isForward", "true"),
            ("framesPerSecond", "30"),
        ):
            yield from _entry(2, key, word)

    def _part(self, name: str, body: Any) -> Iterator[str]:
        written(body, "inertia")
        frame = self.frames[name]
        omega = frame.axes @ np.array(body.omega)
        centre = np.array(body.center_of_mass)
        velocity = np.array(body.velocity) - np.cross(omega, frame.axes @ centre)
        yield "\t\tPart"
        yield from _entry(3, "Name", name)
        yield from _pose(3, frame)
        yield from (
            *_row(3, "Velocity3D", velocity),
            *_row(3, "Omega3D", omega),
            "\t\t\tFeatureOrder",
            "\t\t\tPrincipalMassMarker",
        )
        yield from _entry(4, "Name", "MassMarker")
        yield from _pose(4, Frame(centre, matrix(body.principal_axes())))
        yield from _entry(4, "Mass", repr(float(body.mass)))
        yield from _row(4, "MomentOfInertias", body.principal_moments())
        yield from _entry(4, "Density", "1")
        yield from self._points(3, name)

    def _points(self, level: int, name: str) -> Iterator[str]:
        tabs = "\t" * level
        yield f"{tabs}RefPoints"
        for marker, frame in self.markers[name]:
            yield f"{tabs}\tRefPoint"
            yield from _pose(level + 2, WORLD)
            yield from (
                f"{tabs}\t\tMarkers",
                f"{tabs}\t\t\tMarker",
                *_entry(level + 4, "Name", marker),
                *_pose(level + 4, frame),
            )
        yield from (f"{tabs}RefCurves", f"{tabs}RefSurfaces")

    def _joint(self, name: str, joint: Any) -> Iterator[str]:
        kind = joint.kind
        if kind in KINDS and not (kind == "constant_velocity" and joint.at_initial_pose(self.scene).axes == "same"):
            written(joint, "axes")
            fields = {"offset": 0.0} if kind == "planar" else {"pitch": joint.pitch} if kind == "thread" else {}
            yield from self._between(name, KINDS[kind], joint.i, joint.j, fields)
        elif kind in ON_J:
            yield from self._between(
                name, ON_J[kind], joint.j, joint.i, {"offset": 0.0} if kind == "point_on_plane" else {}
            )
        elif kind == "distance":
            yield from self._between(name, ROD, joint.i, joint.j, {"distanceIJ": joint.length})
        elif kind == "screw":
            yield from self._between(name, "CylindricalJoint", joint.i, joint.j, {})
            yield from self._between(f"{name}_thread", "ScrewJoint", joint.i, joint.j, {"pitch": joint.pitch})
        else:
            self.lost[name] = f"kind {kind}"
            written(joint)

    def _between(self, name: str, kind: str, i: Any, j: Any, fields: dict[str, float]) -> Iterator[str]:
        yield f"\t\t\t{kind}"
        yield from _entry(4, "Name", name)
        for letter, marker in (("I", i), ("J", j)):
            yield from _entry(4, f"Marker{letter}", self._marked(f"{name}_{letter}", marker))
        for key, value in fields.items():
            yield from _entry(4, key, repr(float(value)))

    def _marked(self, name: str, marker: Any) -> str:
        """Add a marker at its initial pose; return its path."""
        drawn = self.scene.initial_marker(marker)
        frame = Frame(
            np.array(drawn.point, dtype=float).ravel(),
            np.column_stack([np.ravel(drawn.x), np.ravel(drawn.y), np.ravel(drawn.z)]).astype(float),
        )
        body = marker.body
        self.markers[body].append((name, frame.within(self.frames.get(body, WORLD))))
        return f"/{self.name}/{name}" if body == GROUND else f"/{self.name}/{body}/{name}"

    def _motion(self, name: str, drive: Any) -> Iterator[str]:
        """Yield a motion of marker J relative to I, which is minus the coordinate of I relative to J."""
        of = drive.joint
        joint = None if of is None else self.scene.joints[of.joint]
        coordinate = "" if joint is None else of.coordinate_of(joint)
        motion = {"angle": "RotationalMotion", "displacement": "TranslationalMotion"}.get(coordinate or "", "")
        law = self._law(drive.prescribed_position)
        if joint is None or not motion or law is None or KINDS.get(joint.kind, "") not in COORDINATES[motion]:
            self.lost[name] = "its coordinate or its law"
            written(drive)
            return
        yield f"\t\t\t{motion}"
        yield from _entry(4, "Name", name)
        yield from _entry(4, "MotionJoint", f"/{self.name}/{of.joint}")
        yield from _entry(4, LAW[motion], law)

    def _law(self, law: object) -> str | None:
        """Return minus a formula of time as OndselSolver reads it; None for others."""
        if not isinstance(law, Formula):
            return None
        parameters = getattr(self.scene, "parameters", None) or {}
        tree = parse(law.text)
        for node in ast.walk(tree):
            if isinstance(node, ast.Name):
                node.id = OF_LAWS.get(node.id, repr(float(parameters[node.id])) if node.id in parameters else "")
                if not node.id:
                    return None
            elif (isinstance(node, ast.operator | ast.unaryop) and not isinstance(node, OPERATIONS)) or not isinstance(
                node, ast.expr | ast.expr_context | ast.operator | ast.unaryop
            ):
                return None
        return f"-1.0*({ast.unparse(tree)})"


def _entry(level: int, label: str, text: str) -> Iterator[str]:
    yield "\t" * level + label
    yield "\t" * (level + 1) + text


def _row(level: int, label: str, values: Sequence[float] | np.ndarray) -> Iterator[str]:
    yield from _entry(level, label, _numbers(values))


def _pose(level: int, frame: Frame) -> Iterator[str]:
    yield from _row(level, "Position3D", frame.position)
    yield "\t" * level + "RotationMatrix"
    yield from ("\t" * (level + 1) + _numbers(row) for row in frame.axes)


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    return "".join(f"{float(value)!r}\t" for value in values)
