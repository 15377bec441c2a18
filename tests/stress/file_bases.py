"""Scenes, datasets and assemblies that a fuzzer changes: small, and of all kinds of sections that files have."""

from __future__ import annotations

from ..cad.asmt_files import CRANK as HINGED
from ..cad.asmt_files import MOTION
from ..cad.simscape_files import BASE, CART, constraint, document, instance, joint, part, shape

PENDULUM = """\
name: Pendulum with a spring
gravity: [0, -9.81]
parameters: {L: 0.6, k: 270 N/m}
bodies:
  cart: {mass: 10 kg, inertia: 1, markers: {end: {point: [L/2, 0]}}}
  bar: {mass: 1, inertia: 0.03, position: [0, -L/2], angle: 5 deg, velocity: [0.1, 0], omega: 0.2}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: cart, j: {body: bar, point: [0, L/2]}}
forces:
  spring: {type: spring_damper, i: cart.end, j: {body: ground, point: [2, 0]}, stiffness: k, damping: 3, free_length: 1}
  push: {type: force, i: bar, force: ["step(t, 0, 0, 0.1, 1)*sin(3*t) - 0.1*bar.vx", 0]}
requests: {reach: "dm(bar, cart.end)", speed: bar.vx^2}
run: {duration: 0.05 s, points: 6, rtol: 1e-6}
figure: {title: how it swings, y: [bar.x, hinge.fy]}
notes: [a trial]
"""

CRANK = """\
gravity: [0, -9.81]
tables:
  lift: {table: [[0, 0], [0.5, 0.1], [1, 0.3], [1.5, 0.1], [2, 0]], ends: natural}
bodies:
  crank: {mass: 1, inertia: 0.01, position: [0.05, 0], markers: {pin: {point: [0.05, 0]}}}
  rod: {mass: 1, inertia: 0.02, position: [0.25, 0]}
  slider: {mass: 2, inertia: 0.01, position: [0.4, 0]}
joints:
  axle: {type: revolute, i: {body: crank, point: [-0.05, 0]}, j: ground}
  big_end: {type: revolute, i: crank.pin, j: {body: rod, point: [-0.15, 0]}}
  small_end: {type: revolute, i: {body: rod, point: [0.15, 0]}, j: slider}
  guide: {type: prismatic, i: slider, j: ground}
  motor: {type: drive, joint: axle, position: 2*t + lift(t)}
forces:
  load: {type: force, i: slider, force: ["max(0, 10 - slider.vx)", -abs(slider.x)]}
run: {duration: 0.05, output: 0.01, solver: bdf}
"""

CHAIN = """\
parameters: {N: 3, L: 0.2}
gravity: [0, -9.81]
bodies:
  link{k}: {for: k in 1..N, mass: 0.5, inertia: 1e-3, position: [(k - 0.5)*L, 0]}
joints:
  pin1: {type: revolute, i: {body: link1, point: [-L/2, 0]}, j: ground}
  pin{k}: {for: k in 2..N, type: revolute, i: {body: "link{k-1}", point: [L/2, 0]}, j: {body: "link{k}", point: [-L/2, 0]}}
forces:
  floor: {type: contact, i: link3, j: {body: ground, point: [0, -0.3]}, radius: 0.02, stiffness: 1e5}
run: {duration: 0.05, points: 5, solver: projected, scheme: dopri5}
"""

SPACE = """\
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  top: {mass: 1, inertia: [0.01, 0.01, 0.02], position: [0, 0, 0.1], omega: [0, 1, 50]}
  block: {mass: 2, inertia: [0.1, 0.1, 0.1], position: [1, 0, 0], velocity: [0, 0.1, 0]}
joints:
  foot: {type: spherical, i: {body: top, point: [0, 0, -0.1]}, j: ground}
forces:
  mount: {type: bushing, i: block, j: {body: ground, point: [1, 0, 0]}, stiffness: [1e4, 1e4, 1e4, 10, 10, 10], damping: [10, 10, 10, 1, 1, 1]}
requests: {height: top.z, tilt: "az(top, ground)"}
run: {duration: 0.02, points: 5}
"""

ARM = """\
a driven arm
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
! adams_view_name='ground'
PART/1, GROUND
MARKER/1, PART=1
MARKER/10, PART=1, QP=500,0,0
PART/2, MASS=2, CM=20, IP=1E4,1E4,2E4, QG=100,0,0
MARKER/20, PART=2
MARKER/21, PART=2, QP=-100,0,0
PART/3, MASS=1, CM=30, IP=1E4,1E4,1E4, QG=500,10,0
MARKER/30, PART=3
JOINT/1, REVOLUTE, I=21, J=1
MOTION/1, JOINT=1, ROTATION, FUNCTION=30D*SIN(2*TIME)
SFORCE/1, TRANSLATIONAL, I=30, J=20, FUNCTION=-0.5*(DM(30,20)-400)-0.01*VR(30,20)
SPRINGDAMPER/1, I=30, J=10, TRANSLATION, K=1, C=0.01, LENGTH=5
REQUEST/1, DISPLACEMENT, I=20, J=1
ACCGRAV/JGRAV=-9806.65
END
"""

ELASTIC = """\
a mass in bushings
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
MARKER/2, PART=1, QP=1,0,0, REULER=90D,90D,0
PART/2, MASS=3, CM=20, IP=0.1,0.1,0.2, QG=1,0,0, VX=0.1,
, WZ=1
MARKER/20, PART=2 ! at its centre of mass
MARKER/21, PART=2, QP=0,0.1,0
BUSHING/1, I=20, J=2, K=1E4,1E4,1E4, KT=10,10,10, C=10,10,10, CT=1,1,1
SPLINE/1, X=0,1,2,3, Y=0,1,4,9
VARIABLE/1, FUNCTION=STEP(TIME,0,0,0.1,5)
SFORCE/2, TRANSLATIONAL, ACTIONONLY, I=21, J=1, FUNCTION=VARVAL(1)*AKISPL(TIME,0,1,0)+IF(TIME-1:0,1,2)
REQUEST/1, F2=DX(20,1), F3=VX(20)
ACCGRAV/KGRAV=-9.81
END
"""

MATED = document(
    BASE + instance("sub", "assembly", "0.1 0 0.5", below=instance("arm", "arm", grounded="true") + instance("tip", "arm", "0.2 0 0"))
    + instance("bob", "arm", "0.4 0.1 0", rigidGroup="g") + instance("cap", "arm", "0.4 0.3 0", rigidGroup="g"),
    constraint("Distance", "d", shape("plane", "base", "0 0 0", "0 0 1"), shape("plane", "bob", "0 0 0.1", "0 0 1"))
    + constraint("Angle", "a", shape("line", "base", "0 0 0", "1 0 0"), shape("line", "bob", "0 0 0", "0.6 0.8 0"))
    + constraint("Tangent", "t", shape("plane", "base", "0 0 0", "0 1 0"), shape("cylinder", "bob", "0 0 0", "1 0 0")),
    joint("Revolute", "hinge", "base", "sub arm", "0.1 0 0.5", "0 0 0") + joint("Weld", "weld", "base", "cap", "0.4 0.3 0"),
    part("block") + part("arm"),
    '<Assembly name="assembly" uid="assembly"><Joints>' + joint("PinSlot", "slot", "arm", "tip", "0.2 0 0") + "</Joints></Assembly>",
).replace("><", ">\n<")  # fmt: skip
ASSEMBLIES = (
    (".xml", CART.replace("><", ">\n<")), (".xml", MATED), (".asmt", HINGED), (".asmt", HINGED.replace("\t\tMotions\n", MOTION)),
    *((".asmt", HINGED.replace("RevoluteJoint", kind).replace("\t\tMotions\n", f"\t\t\t\t{field}\n\t\t\t\t\t0.1\n\t\tMotions\n"))
      for kind, field in (("CylSphJoint", "distanceIJ"), ("PlanarJoint", "offset"), ("ScrewJoint", "pitch"), ("RackPinionJoint", "pitchRadius"))),
)  # fmt: skip
"""Assemblies with the suffixes of their files."""

SCENES = (PENDULUM, CRANK, CHAIN, SPACE)
DATASETS = (ARM, ELASTIC)
