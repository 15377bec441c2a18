"""Views of the tables of the dynamics for compiled code; apart from the layouts, as they load the translator."""

from stiffmbs.compile.machine.native.access import view_of
from stiffmbs.dynamics.native.layouts import DYNAMICS, ELIMINATED, HELD_INPUTS, JOINT_COORDINATES, JOINT_TREE

dynamics_view = view_of("Dynamics", DYNAMICS)
eliminated_view = view_of("Eliminated", ELIMINATED)
held_inputs_view = view_of("HeldInputs", HELD_INPUTS)
joint_coordinates_view = view_of("JointCoordinates", JOINT_COORDINATES)
joint_tree_view = view_of("JointTree", JOINT_TREE)
