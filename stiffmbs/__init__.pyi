"""Types of the module; written by .ci/stubs.py."""

from collections.abc import Mapping, Sequence
from typing import Literal

from stiffmbs.elements.body import Body as _Body
from stiffmbs.elements.forces.applied import AppliedForce as _AppliedForce
from stiffmbs.elements.forces.applied import AppliedTorque as _AppliedTorque
from stiffmbs.elements.forces.bushing import Bushing as _Bushing
from stiffmbs.elements.forces.contact import Contact as _Contact
from stiffmbs.elements.forces.exact_beam import BeamSection as _BeamSection
from stiffmbs.elements.forces.exact_beam import ExactBeam as _ExactBeam
from stiffmbs.elements.forces.joint_friction import JointFriction as _JointFriction
from stiffmbs.elements.forces.line_force import LineForce as _LineForce
from stiffmbs.elements.forces.python_force import PythonForce as _PythonForce
from stiffmbs.elements.forces.spring_damper import SpringDamper as _SpringDamper
from stiffmbs.elements.forces.torsion_spring import TorsionSpring as _TorsionSpring
from stiffmbs.elements.joints.constraint_equation import ConstraintEquation as _ConstraintEquation
from stiffmbs.elements.joints.coupler import Coupler as _Coupler
from stiffmbs.elements.joints.distance import Distance as _Distance
from stiffmbs.elements.joints.drive import Drive as _Drive
from stiffmbs.elements.joints.fixed import Fixed as _Fixed
from stiffmbs.elements.joints.gear import Gear as _Gear
from stiffmbs.elements.joints.point_on_curve import PointOnCurve as _PointOnCurve
from stiffmbs.elements.joints.point_on_line import PointOnLine as _PointOnLine
from stiffmbs.elements.joints.prismatic import Prismatic as _Prismatic
from stiffmbs.elements.joints.rack_and_pinion import RackAndPinion as _RackAndPinion
from stiffmbs.elements.joints.revolute import Revolute as _Revolute
from stiffmbs.elements.joints.velocity_equation import VelocityEquation as _VelocityEquation
from stiffmbs.elements.states.linear_system import PID as _PID
from stiffmbs.elements.states.linear_system import LinearSystem as _LinearSystem
from stiffmbs.elements.states.linear_system import TransferFunction as _TransferFunction
from stiffmbs.elements.states.state import AlgebraicState as _AlgebraicState
from stiffmbs.elements.states.state import SampledState as _SampledState
from stiffmbs.elements.states.state import State as _State
from stiffmbs.model.beams.planar import BeamBody as _BeamBody
from stiffmbs.reading.marker import Marker as _Marker
from stiffmbs.reading.table import Table as _Table

from . import gym as gym
from . import spatial as spatial
from .adams.listing import listed_statements as listed_statements
from .analyses.check import Report as Report
from .analyses.check import check as check
from .analyses.equilibrium import equilibrium as equilibrium
from .analyses.equilibrium import quasi_static as quasi_static
from .analyses.linearised.campbell import campbell as campbell
from .analyses.linearised.modes import modes as modes
from .analyses.linearised.transfer import transfer as transfer
from .analyses.load_scene import load_scene as load_scene
from .analyses.run import run as run
from .comparison.compare import compare as compare
from .comparison.over import compare_over as compare_over
from .compile.compile_model import compile_model as compile_model
from .elements.element import Force as Force
from .elements.element import Joint as Joint
from .elements.own_elements import register as register
from .errors import AssemblyError as AssemblyError
from .errors import InputError as InputError
from .errors import SolverError as SolverError
from .errors import StiffmbsError as StiffmbsError
from .evaluation.bearing_loads import DrivingAngle as DrivingAngle
from .evaluation.bearing_loads import driving_angle as driving_angle
from .evaluation.bearing_loads import in_body_axes as in_body_axes
from .evaluation.cycle import Cycle as Cycle
from .evaluation.cycle import cycle as cycle
from .evaluation.loads import Load as Load
from .evaluation.loads import loads as loads
from .evaluation.peaks import Peak as Peak
from .evaluation.peaks import peaks as peaks
from .live.page import open as open
from .model.model import Model as Model
from .model.read_scene import read_scene as read_scene
from .model.scene import Scene as Scene
from .model.schema import scene_schema as scene_schema
from .model.settings import RunSettings as RunSettings
from .model.settings import SteadyMotion as SteadyMotion
from .reading import given
from .reading.handle import Handle as _Handle
from .reading.python_function import PythonFunction as PythonFunction
from .reading.units import si as si
from .reading.variation import Range as Range
from .real_time.realtime import realtime as realtime
from .real_time.report import RealTime as RealTime
from .results.listings import differences as differences
from .results.saved_state import SavedState as SavedState
from .results.saved_state import read_state as read_state
from .results.solution import Solution as Solution
from .show.drawing.animate import animate as animate
from .show.drawing.draw import draw as draw
from .show.figure import plot as plot
from .show.html import html as html
from .show.summary import summary as summary
from .studies.fit import Fit as Fit
from .studies.fit import fit as fit
from .studies.fmu.build import build_fmu as build_fmu
from .studies.follow import follow as follow
from .studies.handling.study import Handling as Handling
from .studies.handling.study import handling as handling
from .studies.joint_space.space import JointSpace as JointSpace
from .studies.joint_space.space import joint_space as joint_space
from .studies.optimise import Optimum as Optimum
from .studies.optimise import optimise as optimise
from .studies.sensitivities.sensitivities import Sensitivity as Sensitivity
from .studies.sensitivities.sensitivities import sensitivities as sensitivities
from .studies.simulation import Simulation as Simulation
from .studies.simulation import simulation as simulation
from .studies.simulations import Simulations as Simulations
from .studies.simulations import simulations as simulations
from .studies.suspension.kinematics_and_compliance import KinematicsAndCompliance as KinematicsAndCompliance
from .studies.suspension.kinematics_and_compliance import kinematics_and_compliance as kinematics_and_compliance
from .studies.suspension.road_loads import RoadLoads as RoadLoads
from .studies.suspension.road_loads import road_loads as road_loads
from .studies.suspension.vehicle import VehicleOptions as VehicleOptions
from .studies.sweep import sweep as sweep
from .verification.verify import verify as verify

__version__: str
ground: str

class AlgebraicState(_AlgebraicState):
    """Variable x with zero(x) = 0 at every time; formulas use it by its name."""
    def __init__(self, *, zero: given.Law, start: given.Number = ..., scale: given.Number = ...) -> None: ...

class AppliedForce(_AppliedForce):
    """Force at a point of a body: constant, or a formula of time and of any measured quantity."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        force: given.Laws,
        axes: Literal["ground", "body"] = ...,
        type: Literal["force"] = ...,
    ) -> None: ...

class AppliedTorque(_AppliedTorque):
    """Torque on a body: constant, or a formula of time and of any measured quantity."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker | None = ..., torque: given.Law, type: Literal["torque"] = ...
    ) -> None: ...

class BeamBody(_BeamBody):
    """Geometrically exact beam in the plane: rigid nodes with lumped mass, joined by elements `exact_beam`."""
    def __init__(
        self,
        *,
        elements: given.Number | Sequence[int] | Mapping[str, given.Number],
        interpolation: Literal["pairs", "spectral"] = ...,
        section: Mapping[str, object] | None = ...,
        section_end: Mapping[str, object] | None = ...,
        material: Mapping[str, object] | None = ...,
        mass_per_length: given.Number | None = ...,
        damping: given.Number = ...,
        stations: Mapping[str, given.Number] = ...,
        start: given.Numbers | None = ...,
        end: given.Numbers | None = ...,
        through: given.Numbers | None = ...,
        points: given.Matrix | None = ...,
        stiffness: given.Numbers | None = ...,
        inertia_per_length: given.Number | None = ...,
        velocity: given.Numbers = ...,
        omega: given.Number = ...,
    ) -> None: ...

class BeamSection(_BeamSection):
    """Elastic cross section at an inner point of a beam with 3 to 5 nodes, for any displacement and rotation."""
    def __init__(
        self,
        *,
        nodes: given.MarkerSequence,
        reference: int,
        shapes: given.Numbers,
        slopes: given.Numbers,
        length: given.Number,
        unloaded: given.Numbers = ...,
        stiffness: given.Matrix,
        damping_ratio: given.Number | None = ...,
        type: Literal["beam_section"] = ...,
    ) -> None: ...

class Body(_Body):
    """Planar rigid body with the coordinates x, y of its centre of mass and its angle phi."""
    def __init__(
        self,
        *,
        mass: given.Number,
        inertia: given.Number,
        position: given.Numbers = ...,
        angle: given.Number = ...,
        velocity: given.Numbers = ...,
        omega: given.Number = ...,
        markers: given.Markers = ...,
        geometry: given.Geometry = ...,
    ) -> None: ...

class Bushing(_Bushing):
    """Elastic force and torque between two markers."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Matrix = ...,
        damping: given.Matrix = ...,
        preload: given.Numbers = ...,
        law_x: given.Curve | None = ...,
        law_y: given.Curve | None = ...,
        law_angle: given.Curve | None = ...,
        axes: Literal["j", "ground"] = ...,
        type: Literal["bushing"] = ...,
    ) -> None: ...

class ConstraintEquation(_ConstraintEquation):
    """Formulas of body coordinates and time that remain zero: ``cart.y - 0.1*sin(cart.x)``."""
    def __init__(
        self,
        *,
        i: given.Marker | None = ...,
        j: given.Marker | None = ...,
        zero: given.Laws,
        type: Literal["equation"] = ...,
    ) -> None: ...

class Contact(_Contact):
    """Contact of a point or circle about marker i with a line or circle of marker j, with friction."""
    def __init__(
        self,
        *,
        friction: given.Number | None = ...,
        static_friction: given.Number | None = ...,
        friction_velocity: given.Number = ...,
        stiction_velocity: given.Number = ...,
        stiffness: given.Number,
        exponent: given.Number = ...,
        dissipation: given.Number = ...,
        i: given.Marker,
        j: given.Marker,
        radius: given.Number = ...,
        surface: Literal["line", "circle", "hole"] = ...,
        surface_radius: given.Number = ...,
        type: Literal["contact"] = ...,
    ) -> None: ...

class Coupler(_Coupler):
    """Linear relation between two joint coordinates: s_1 - scale s_2 - offset = 0."""
    def __init__(
        self,
        *,
        offset: given.Number | None = ...,
        joint_1: str,
        joint_2: str,
        scale: given.Number,
        type: Literal["coupler"] = ...,
    ) -> None: ...

class Distance(_Distance):
    """Rod with constant distance between a point of body i and a point of body j, (d . d - L^2)/(2 L) = 0."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker, length: given.Number, type: Literal["distance"] = ...
    ) -> None: ...

class Drive(_Drive):
    """Motor that prescribes a joint's coordinate, or a formula of body coordinates, as a function of time or of states."""
    def __init__(
        self,
        *,
        i: given.Marker | None = ...,
        j: given.Marker | None = ...,
        joint: str | None = ...,
        coordinate: given.Law | None = ...,
        position: given.Curve | None = ...,
        velocity: given.Curve | None = ...,
        type: Literal["drive"] = ...,
    ) -> None: ...

class ExactBeam(_ExactBeam):
    """Massless beam from marker j to marker i with constant strain, for any displacement and rotation."""
    def __init__(
        self,
        *,
        length: given.Number,
        damping_ratio: given.Number | None = ...,
        bowing: given.Numbers | None = ...,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Matrix,
        unloaded: given.Numbers = ...,
        type: Literal["exact_beam"] = ...,
    ) -> None: ...

class Fixed(_Fixed):
    """Weld: two markers coincide in position and direction."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["fixed"] = ...) -> None: ...

class Gear(_Gear):
    """Gear pair with both wheels on one carrier: theta_1 + ratio theta_2 - offset = 0."""
    def __init__(
        self,
        *,
        offset: given.Number | None = ...,
        joint_1: str,
        joint_2: str,
        ratio: given.Number,
        type: Literal["gear"] = ...,
    ) -> None: ...

class JointFriction(_JointFriction):
    """Dry friction in a revolute or prismatic joint, loaded by the joint's reaction."""
    def __init__(
        self,
        *,
        friction: given.Number,
        static_friction: given.Number | None = ...,
        friction_velocity: given.Number = ...,
        stiction_velocity: given.Number = ...,
        joint: str,
        radius: given.Number = ...,
        length: given.Number | None = ...,
        type: Literal["joint_friction"] = ...,
    ) -> None: ...

class LineForce(_LineForce):
    """Force along the line between two points: constant, or a formula of any measured quantity."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker, force: given.Law, type: Literal["line_force"] = ...
    ) -> None: ...

class LinearSystem(_LinearSystem):
    """State space x' = A x + B u, y = C x + D u with formulas u; outputs are used by its name, or as ``name.output``."""
    def __init__(
        self,
        *,
        a: given.Matrix,
        b: given.Matrix,
        c: given.Matrix,
        d: given.Matrix | None = ...,
        input: given.Laws,
        outputs: Sequence[str] = ...,
        start: given.Numbers | None = ...,
    ) -> None: ...

class Marker(_Marker):
    """Marker used by an element: a named marker of a body, or an explicit one."""
    def __init__(
        self, *, body: str | _Handle, marker: str | None = ..., point: given.Numbers = ..., angle: given.Number = ...
    ) -> None: ...

class PID(_PID):
    """Controller kp e + ki (integral of e) + kd (filtered derivative of e) with e = setpoint - input, used by name."""
    def __init__(
        self,
        *,
        input: given.Law,
        setpoint: given.Law | None = ...,
        kp: given.Number = ...,
        ki: given.Number = ...,
        kd: given.Number = ...,
        filter: given.Number | None = ...,
    ) -> None: ...

class PointOnCurve(_PointOnCurve):
    """Point follower: the point of marker i remains on a curve fixed to marker j."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        y: given.Curve | None = ...,
        radius: given.Curve | None = ...,
        type: Literal["point_on_curve"] = ...,
    ) -> None: ...

class PointOnLine(_PointOnLine):
    """Pin in a slot: the point of marker i remains on the line through marker j along j's axis, d . n_j = 0."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["point_on_line"] = ...) -> None: ...

class Prismatic(_Prismatic):
    """Slider: marker i remains on the line through marker j along j's axis, and keeps j's direction."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["prismatic"] = ...) -> None: ...

class PythonForce(_PythonForce):
    """Force and torque by a Python function, for laws that no formula can express."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        of: given.Laws,
        function: given.Function,
        type: Literal["python_force"] = ...,
    ) -> None: ...

class RackAndPinion(_RackAndPinion):
    """Pinion that rolls on a rack, both on one housing: s - R theta - offset = 0."""
    def __init__(
        self,
        *,
        offset: given.Number | None = ...,
        rack: str,
        pinion: str,
        pitch_radius: given.Number,
        type: Literal["rack_and_pinion"] = ...,
    ) -> None: ...

class Revolute(_Revolute):
    """Pin: a point of body i and a point of body j coincide."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["revolute"] = ...) -> None: ...

class SampledState(_SampledState):
    """Variable x that takes the value of a formula at the times offset + k period and keeps it in between."""
    def __init__(
        self, *, update: given.Law, period: given.Number, offset: given.Number = ..., start: given.Number = ...
    ) -> None: ...

class SpringDamper(_SpringDamper):
    """Spring and damper along the line between two points, linear or nonlinear."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number = ...,
        damping: given.Number = ...,
        free_length: given.Number = ...,
        preload: given.Number = ...,
        spring_law: given.Curve | None = ...,
        damper_law: given.Curve | None = ...,
        type: Literal["spring_damper"] = ...,
    ) -> None: ...

class State(_State):
    """Variable x with x' = rate and the initial value start; formulas use it by its name."""
    def __init__(self, *, rate: given.Law, start: given.Number = ..., scale: given.Number = ...) -> None: ...

class Table(_Table):
    """Function through points, by default a monotone piecewise cubic with continuous slope (PCHIP)."""
    def __init__(
        self,
        *,
        table: given.Matrix,
        ends: Literal["natural", "clamped", "periodic", "not-a-knot"] | None = ...,
        beyond: Literal["extend", "hold", "error", "repeat"] | None = ...,
        lines: bool = ...,
        akima: bool = ...,
        spline: bool = ...,
        smoothing: given.Number | None = ...,
    ) -> None: ...

class TorsionSpring(_TorsionSpring):
    """Rotational spring and damper on the angle of marker i relative to marker j, linear or nonlinear."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number = ...,
        damping: given.Number = ...,
        free_angle: given.Number = ...,
        preload: given.Number = ...,
        spring_law: given.Curve | None = ...,
        damper_law: given.Curve | None = ...,
        type: Literal["torsion_spring"] = ...,
    ) -> None: ...

class TransferFunction(_TransferFunction):
    """Output y of G(s) = numerator(s)/denominator(s) with a formula as input; formulas use y by the name of the entry."""
    def __init__(self, *, numerator: given.Numbers, denominator: given.Numbers, input: given.Law) -> None: ...

class VelocityEquation(_VelocityEquation):
    """Formulas linear in velocities that remain zero, J(q) u - b(q, t) = 0, also nonholonomic ones."""
    def __init__(
        self,
        *,
        i: given.Marker | None = ...,
        j: given.Marker | None = ...,
        zero: given.Laws,
        type: Literal["velocity_equation"] = ...,
    ) -> None: ...
