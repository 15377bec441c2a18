"""Types of the module; written by .ci/stubs.py."""

from collections.abc import Mapping, Sequence
from typing import Literal

from stiffmbs.elements.joints.constraint_equation import ConstraintEquation as _ConstraintEquation
from stiffmbs.elements.joints.coupler import Coupler as _Coupler
from stiffmbs.elements.joints.drive import Drive as _Drive
from stiffmbs.elements.joints.gear import Gear as _Gear
from stiffmbs.elements.joints.rack_and_pinion import RackAndPinion as _RackAndPinion
from stiffmbs.elements.joints.velocity_equation import VelocityEquation as _VelocityEquation
from stiffmbs.elements.spatial.body import Body as _Body
from stiffmbs.elements.spatial.forces.applied import AppliedForce as _AppliedForce
from stiffmbs.elements.spatial.forces.applied import AppliedTorque as _AppliedTorque
from stiffmbs.elements.spatial.forces.beam import Beam as _Beam
from stiffmbs.elements.spatial.forces.brake import Brake as _Brake
from stiffmbs.elements.spatial.forces.bushing import Bushing as _Bushing
from stiffmbs.elements.spatial.forces.capsule_impact import CapsuleImpact as _CapsuleImpact
from stiffmbs.elements.spatial.forces.exact_beam import BeamSection as _BeamSection
from stiffmbs.elements.spatial.forces.exact_beam import ExactBeam as _ExactBeam
from stiffmbs.elements.spatial.forces.fiala_tyre import FialaTyre as _FialaTyre
from stiffmbs.elements.spatial.forces.field import FieldForce as _FieldForce
from stiffmbs.elements.spatial.forces.joint_friction import JointFriction as _JointFriction
from stiffmbs.elements.spatial.forces.line_force import LineForce as _LineForce
from stiffmbs.elements.spatial.forces.magic_formula_tyre import MagicFormulaTyre as _MagicFormulaTyre
from stiffmbs.elements.spatial.forces.plane_impact import BoxPlaneImpact as _BoxPlaneImpact
from stiffmbs.elements.spatial.forces.plane_impact import CylinderPlaneImpact as _CylinderPlaneImpact
from stiffmbs.elements.spatial.forces.plane_impact import EllipsoidPlaneImpact as _EllipsoidPlaneImpact
from stiffmbs.elements.spatial.forces.python_force import PythonForce as _PythonForce
from stiffmbs.elements.spatial.forces.road_contact import RoadContact as _RoadContact
from stiffmbs.elements.spatial.forces.solid_impact import SolidImpact as _SolidImpact
from stiffmbs.elements.spatial.forces.sphere_contact import SphereContact as _SphereContact
from stiffmbs.elements.spatial.forces.sphere_impact import SphereBoxImpact as _SphereBoxImpact
from stiffmbs.elements.spatial.forces.sphere_impact import SphereCylinderImpact as _SphereCylinderImpact
from stiffmbs.elements.spatial.forces.sphere_impact import SphereSphereImpact as _SphereSphereImpact
from stiffmbs.elements.spatial.forces.spring_damper import SpringDamper as _SpringDamper
from stiffmbs.elements.spatial.forces.torsion_spring import TorsionSpring as _TorsionSpring
from stiffmbs.elements.spatial.forces.vertical_tyre import VerticalTyre as _VerticalTyre
from stiffmbs.elements.spatial.forces.wheel_torque import WheelTorque as _WheelTorque
from stiffmbs.elements.spatial.joints.constant_velocity import ConstantVelocity as _ConstantVelocity
from stiffmbs.elements.spatial.joints.cylindrical import Cylindrical as _Cylindrical
from stiffmbs.elements.spatial.joints.fixed import Fixed as _Fixed
from stiffmbs.elements.spatial.joints.orientation import Orientation as _Orientation
from stiffmbs.elements.spatial.joints.parallel import Parallel as _Parallel
from stiffmbs.elements.spatial.joints.perpendicular import Perpendicular as _Perpendicular
from stiffmbs.elements.spatial.joints.planar import Planar as _Planar
from stiffmbs.elements.spatial.joints.point_on_curve import PointOnCurve as _PointOnCurve
from stiffmbs.elements.spatial.joints.point_on_line import PointOnLine as _PointOnLine
from stiffmbs.elements.spatial.joints.point_on_plane import PointOnPlane as _PointOnPlane
from stiffmbs.elements.spatial.joints.prismatic import Prismatic as _Prismatic
from stiffmbs.elements.spatial.joints.revolute import Revolute as _Revolute
from stiffmbs.elements.spatial.joints.revolute_spherical import RevoluteSpherical as _RevoluteSpherical
from stiffmbs.elements.spatial.joints.screw import Screw as _Screw
from stiffmbs.elements.spatial.joints.shared import Distance as _Distance
from stiffmbs.elements.spatial.joints.spherical import Spherical as _Spherical
from stiffmbs.elements.spatial.joints.tangent_to_curve import TangentToCurve as _TangentToCurve
from stiffmbs.elements.spatial.joints.thread import Thread as _Thread
from stiffmbs.elements.spatial.joints.universal import Universal as _Universal
from stiffmbs.elements.spatial.marker import Marker as _Marker
from stiffmbs.model.beams.spatial import BeamBody as _BeamBody
from stiffmbs.model.flexible import FlexibleBody as _FlexibleBody
from stiffmbs.model.surface_loads import SurfaceLoad as _SurfaceLoad

from .analyses.in_space import in_space as in_space
from .elements.element import Force as Force
from .elements.element import Joint as Joint
from .model.spatial_model import Model as Model
from .reading import given
from .reading.handle import Handle as _Handle

class AppliedForce(_AppliedForce):
    """Force at a point of a body: constant, or a formula of time and of any measured quantity."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        axes: Literal["ground", "body"] = ...,
        frame: given.Marker | None = ...,
        force: given.Laws,
        type: Literal["force"] = ...,
    ) -> None: ...

class AppliedTorque(_AppliedTorque):
    """Torque on a body: constant, or a formula of time and of any measured quantity."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        axes: Literal["ground", "body"] = ...,
        frame: given.Marker | None = ...,
        torque: given.Laws,
        type: Literal["torque"] = ...,
    ) -> None: ...

class Beam(_Beam):
    """Massless straight beam of uniform cross section along the x axis of marker j, from j to i."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        length: given.Number,
        young: given.Number,
        shear_modulus: given.Number,
        area: given.Number,
        torsion: given.Number,
        iyy: given.Number,
        izz: given.Number,
        asy: given.Number = ...,
        asz: given.Number = ...,
        damping_ratio: given.Number | None = ...,
        damping: given.Matrix = ...,
        type: Literal["beam"] = ...,
    ) -> None: ...

class BeamBody(_BeamBody):
    """Geometrically exact beam in space: rigid nodes with lumped mass, joined by elements `exact_beam`."""
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
        up: given.Numbers | None = ...,
        stiffness: given.Numbers | None = ...,
        inertia_per_length: given.Numbers | None = ...,
        velocity: given.Numbers = ...,
        omega: given.Numbers = ...,
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
        stretch: given.Number = ...,
        type: Literal["beam_section"] = ...,
    ) -> None: ...

class Body(_Body):
    """Spatial rigid body, with its own origin and axes for everything on it."""
    def __init__(
        self,
        *,
        mass: given.Number,
        any_moments: bool = ...,
        inertia: given.Matrix,
        center_of_mass: given.Numbers = ...,
        position: given.Numbers = ...,
        orientation: given.Orientation = ...,
        velocity: given.Numbers = ...,
        omega: given.Numbers = ...,
        open: Sequence[Literal["velocity", "omega"]] = ...,
        markers: given.Markers = ...,
        geometry: given.Geometry = ...,
    ) -> None: ...

class BoxPlaneImpact(_BoxPlaneImpact):
    """Contact of the eight corners of a solid box with a plane."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        x: given.Number,
        y: given.Number,
        z: given.Number,
        type: Literal["box_plane_impact"] = ...,
    ) -> None: ...

class Brake(_Brake):
    """Brake between a wheel and its upright, or the car's body, which slips at its torque and holds at rest."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        torque: given.Law,
        windup: given.Number = ...,
        settling: given.Number = ...,
        lag: given.Number = ...,
        type: Literal["brake"] = ...,
    ) -> None: ...

class Bushing(_Bushing):
    """Elastic force and torque between two markers in all six components."""
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
        law_z: given.Curve | None = ...,
        law_about_x: given.Curve | None = ...,
        law_about_y: given.Curve | None = ...,
        law_about_z: given.Curve | None = ...,
        axes: Literal["j", "ground"] = ...,
        type: Literal["bushing"] = ...,
    ) -> None: ...

class CapsuleImpact(_CapsuleImpact):
    """Contact of two capsules at the points of their axes that are nearest to each other."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        radius: given.Number,
        length: given.Number = ...,
        other_radius: given.Number,
        other_length: given.Number = ...,
        type: Literal["capsule_impact"] = ...,
    ) -> None: ...

class ConstantVelocity(_ConstantVelocity):
    """Constant velocity joint: two points coincide, and both shafts rotate about their z axes at the same rate."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        axes: Literal["same", "opposite"] | None = ...,
        type: Literal["constant_velocity"] = ...,
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

class CylinderPlaneImpact(_CylinderPlaneImpact):
    """Contact of a solid cylinder with a plane at the lowest point of the rim of each end."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        radius: given.Number,
        length: given.Number,
        type: Literal["cylinder_plane_impact"] = ...,
    ) -> None: ...

class Cylindrical(_Cylindrical):
    """Sleeve on a shaft: marker i remains on the z axis of marker j, parallel to it, and can slide and rotate."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["cylindrical"] = ...) -> None: ...

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

class EllipsoidPlaneImpact(_EllipsoidPlaneImpact):
    """Contact of a solid ellipsoid with a plane at its lowest point."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        x: given.Number,
        y: given.Number,
        z: given.Number,
        type: Literal["ellipsoid_plane_impact"] = ...,
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
        shear_centre: given.Numbers | None = ...,
        wagner: given.Numbers | None = ...,
        type: Literal["exact_beam"] = ...,
    ) -> None: ...

class FialaTyre(_FialaTyre):
    """Fiala tyre: constant slip stiffnesses, and a friction coefficient that decreases with the total slip."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        road: given.Road = ...,
        envelope: given.Envelope | None = ...,
        slow: given.Number = ...,
        radius: given.Number,
        stiffness: given.Number,
        damping: given.Number = ...,
        slip_stiffness: given.Number,
        cornering_stiffness: given.Number,
        mu_static: given.Number,
        mu_sliding: given.Number,
        width: given.Number = ...,
        rolling_resistance: given.Number = ...,
        relaxation: given.Numbers | None = ...,
        type: Literal["fiala_tyre"] = ...,
    ) -> None: ...

class FieldForce(_FieldForce):
    """Linear elastic connection of two separate markers: preload - K (s - s0) - C (v, w)."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Matrix = ...,
        damping: given.Matrix = ...,
        preload: given.Numbers = ...,
        free: given.Numbers | None = ...,
        type: Literal["field"] = ...,
    ) -> None: ...

class Fixed(_Fixed):
    """Weld: two markers coincide in position and orientation."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["fixed"] = ...) -> None: ...

class FlexibleBody(_FlexibleBody):
    """Flexible body of a scene or a model. Files of a model are relative to the current folder."""
    def __init__(
        self,
        *,
        mesh: str | None = ...,
        matrices: str | Mapping[str, object] | None = ...,
        units: Mapping[str, object],
        material: Mapping[str, object] | None = ...,
        materials: Mapping[str, Mapping[str, object]] | None = ...,
        thickness: given.Number | Mapping[str, object] | None = ...,
        thicknesses: Mapping[str, given.Number] | None = ...,
        interfaces: Mapping[str, Mapping[str, object]] = ...,
        surfaces: Mapping[str, Mapping[str, object]] = ...,
        modes: int | Mapping[str, object] = ...,
        mass: given.Number | None = ...,
        stiffening: bool | Literal["auto"] = ...,
        mirror: Literal["x", "y", "z", "xy", "xz", "yz", "xyz"] | None = ...,
        residual_modes: bool = ...,
        position: given.Numbers = ...,
        orientation: given.Orientation = ...,
        velocity: given.Numbers = ...,
        omega: given.Numbers = ...,
        damping: given.Number | Mapping[str, object] | given.Numbers = ...,
        deformation_scale: given.Number = ...,
        stress_colors: bool = ...,
    ) -> None: ...

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
    """Dry friction in a revolute, cylindrical, prismatic or spherical joint, loaded by the joint's reaction."""
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
        thrust_radius: given.Number | None = ...,
        torsion_radius: given.Number | None = ...,
        type: Literal["joint_friction"] = ...,
    ) -> None: ...

class LineForce(_LineForce):
    """Force along the line between two points in space: constant, or a formula of any measured quantity."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker, force: given.Law, type: Literal["line_force"] = ...
    ) -> None: ...

class MagicFormulaTyre(_MagicFormulaTyre):
    """Magic Formula tyre (Pacejka) or Fiala tyre with the coefficients of a property file (.tir)."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        road: given.Road = ...,
        envelope: given.Envelope | Literal["file"] | None = ...,
        slow: given.Number = ...,
        properties: given.TyreProperties,
        hand: given.Number = ...,
        side: Literal["left", "right"] | None = ...,
        transient: bool | None = ...,
        pressure: given.Number | None = ...,
        turn_slip: bool | None = ...,
        type: Literal["magic_formula_tyre"] = ...,
    ) -> None: ...

class Marker(_Marker):
    """Marker used by an element: a named marker of a body, or an explicit one."""
    def __init__(
        self,
        *,
        body: str | _Handle,
        marker: str | None = ...,
        point: given.Numbers = ...,
        orientation: given.Orientation = ...,
    ) -> None: ...

class Orientation(_Orientation):
    """Joint that keeps the axes of two markers parallel, at any positions."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["orientation"] = ...) -> None: ...

class Parallel(_Parallel):
    """Joint that keeps the z axes of two markers parallel or opposite, at any positions."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["parallel"] = ...) -> None: ...

class Perpendicular(_Perpendicular):
    """Joint that keeps the z axes of two markers perpendicular, at any positions."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["perpendicular"] = ...) -> None: ...

class Planar(_Planar):
    """Sliding and rotation in a plane: the point of marker i remains in the xy plane of marker j, with parallel z axes."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["planar"] = ...) -> None: ...

class PointOnCurve(_PointOnCurve):
    """Point follower: the point of marker i remains on a curve in the axes of marker j, in any orientation."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        y: given.Curve | None = ...,
        radius: given.Curve | None = ...,
        z: given.Curve | None = ...,
        height: given.Curve | None = ...,
        type: Literal["point_on_curve"] = ...,
    ) -> None: ...

class PointOnLine(_PointOnLine):
    """Bead on a wire: the point of marker i remains on the z axis of marker j, in any orientation."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["point_on_line"] = ...) -> None: ...

class PointOnPlane(_PointOnPlane):
    """Point on a plane: the point of marker i remains in the xy plane of marker j, in any orientation."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["point_on_plane"] = ...) -> None: ...

class Prismatic(_Prismatic):
    """Slider: marker i remains on the z axis of marker j and keeps j's orientation."""
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
    """Hinge: two points coincide, with the z axes of both markers parallel."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker, turns: int | None = ..., type: Literal["revolute"] = ...
    ) -> None: ...

class RevoluteSpherical(_RevoluteSpherical):
    """Massless rod with a hinge at marker j and a ball at marker i."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker, length: given.Number, type: Literal["revolute_spherical"] = ...
    ) -> None: ...

class RoadContact(_RoadContact):
    """Contact of a sphere or point about marker i with a road, such as of a corner of a car that rolls over."""
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
        j: given.Marker | None = ...,
        road: given.Road = ...,
        radius: given.Number = ...,
        type: Literal["road_contact"] = ...,
    ) -> None: ...

class Screw(_Screw):
    """Nut on a spindle: marker i remains on the z axis of marker j, parallel to it, and advances by the pitch per turn."""
    def __init__(
        self,
        *,
        offset: given.Number | None = ...,
        i: given.Marker,
        j: given.Marker,
        pitch: given.Number,
        type: Literal["screw"] = ...,
    ) -> None: ...

class SolidImpact(_SolidImpact):
    """Contact of two ellipsoids, boxes or cylinders at one point."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        i_shape: Literal["ellipsoid", "box", "cylinder"],
        i_size: given.Numbers,
        j_shape: Literal["ellipsoid", "box", "cylinder"],
        j_size: given.Numbers,
        type: Literal["solid_impact"] = ...,
    ) -> None: ...

class SphereBoxImpact(_SphereBoxImpact):
    """Contact of a sphere about marker i with a face, an edge or a corner of a solid box."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        radius: given.Number,
        x: given.Number,
        y: given.Number,
        z: given.Number,
        type: Literal["sphere_box_impact"] = ...,
    ) -> None: ...

class SphereContact(_SphereContact):
    """Contact of a sphere or point about marker i with a plane, a sphere, or the inside of a hollow sphere."""
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
        surface: Literal["plane", "sphere", "hollow"] = ...,
        surface_radius: given.Number = ...,
        type: Literal["sphere_contact"] = ...,
    ) -> None: ...

class SphereCylinderImpact(_SphereCylinderImpact):
    """Contact of a sphere about marker i with the lateral surface, an end or an edge of a solid cylinder."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        radius: given.Number,
        cylinder_radius: given.Number,
        cylinder_length: given.Number,
        type: Literal["sphere_cylinder_impact"] = ...,
    ) -> None: ...

class SphereSphereImpact(_SphereSphereImpact):
    """Contact of a sphere about marker i with a sphere about marker j."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        stiffness: given.Number,
        exponent: given.Number = ...,
        damping: given.Number = ...,
        depth: given.Number = ...,
        static_friction: given.Number | None = ...,
        friction: given.Number | None = ...,
        stiction_velocity: given.Number = ...,
        friction_velocity: given.Number = ...,
        radius: given.Number,
        other_radius: given.Number,
        type: Literal["sphere_sphere_impact"] = ...,
    ) -> None: ...

class Spherical(_Spherical):
    """Ball joint: a point of body i and a point of body j coincide."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["spherical"] = ...) -> None: ...

class SpringDamper(_SpringDamper):
    """Spring and damper along the line between two points in space, linear or nonlinear."""
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

class SurfaceLoad(_SurfaceLoad):
    """Pressure or traction on a surface of a flexible body: an entry of the forces of a scene."""
    def __init__(
        self, *, body: str | _Handle, surface: str, pressure: given.Law | None = ..., traction: given.Laws | None = ...
    ) -> None: ...

class TangentToCurve(_TangentToCurve):
    """Follower with a direction: the point of marker i remains on a curve, with its x axis along the tangent."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker,
        y: given.Curve | None = ...,
        radius: given.Curve | None = ...,
        type: Literal["tangent_to_curve"] = ...,
    ) -> None: ...

class Thread(_Thread):
    """Relation of displacement along the z axis of marker j to the angle about it: s - pitch theta/(2 pi) - offset = 0."""
    def __init__(
        self,
        *,
        offset: given.Number | None = ...,
        i: given.Marker,
        j: given.Marker,
        pitch: given.Number,
        type: Literal["thread"] = ...,
    ) -> None: ...

class TorsionSpring(_TorsionSpring):
    """Rotational spring and damper about the common z axis of two markers, linear or nonlinear."""
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

class Universal(_Universal):
    """Cardan joint: two points coincide, and the z axes of both markers, the arms of its cross, are perpendicular."""
    def __init__(self, *, i: given.Marker, j: given.Marker, type: Literal["universal"] = ...) -> None: ...

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

class VerticalTyre(_VerticalTyre):
    """Spring and damper between a wheel and a road, with lift-off and without forces along the road."""
    def __init__(
        self,
        *,
        i: given.Marker,
        j: given.Marker | None = ...,
        road: given.Road = ...,
        envelope: given.Envelope | None = ...,
        slow: given.Number = ...,
        radius: given.Number,
        stiffness: given.Number,
        damping: given.Number = ...,
        type: Literal["vertical_tyre"] = ...,
    ) -> None: ...

class WheelTorque(_WheelTorque):
    """Torque on a wheel about its axle: constant, or a formula of time and of any measured quantity."""
    def __init__(
        self, *, i: given.Marker, j: given.Marker, torque: given.Law, type: Literal["wheel_torque"] = ...
    ) -> None: ...
