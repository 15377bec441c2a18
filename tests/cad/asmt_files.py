"""Texts of .asmt files."""

CRANK = """\
OndselSolver
Assembly
	Name
		Rig
	RefPoints
		RefPoint
			Position3D
				0.1	0	0
			Markers
				Marker
					Name
						pivot
	Parts
		Part
			Name
				arm
			Position3D
				0.1	0	0
			Omega3D
				0	0	2
			PrincipalMassMarker
				Position3D
					0.5	0	0
				Mass
					2
				MomentOfInertias
					0.01	0.2	0.2
			RefPoints
				RefPoint
					Markers
						Marker
							Name
								hub
	ConstraintSets
		Joints
			RevoluteJoint
				Name
					hinge
				MarkerI
					/Rig/arm/hub
				MarkerJ
					/Rig/pivot
		Motions
	ConstantGravity
		0	-9.81	0
	SimulationParameters
		tend
			0.5
		hout
			0.1
"""
"""An arm on a hinge in the ground."""
MOTION = """\
		Motions
			RotationalMotion
				Name
					motor
				MotionJoint
					/Rig/hinge
				RotationZ
					-2.0d*time
"""
"""A motor at the hinge, in place of the line Motions."""
