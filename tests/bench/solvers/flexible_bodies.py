"""Cost of flexible bodies: ``python -m tests.bench.solvers.flexible_bodies [residual] [car]``.

`residual`: time of one residual of a half car in space whose trailing arms are flexible, over that with rigid arms.
`car`: time of a step steer of 10 s of `examples/car.yaml` with a flexible shell of 30 modes and a flexible anti-roll bar.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import meshio
import numpy as np
from skfem import MeshHex
from skfem.io.meshio import to_meshio

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.analyses.run import run
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.solve.formulations import FORMULATIONS

EXAMPLES = Path(__file__).parents[3] / "examples"
HALF_CAR = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  chassis: {mass: 1200, inertia: [500, 1800, 1800], position: [0, 0, 0.6]}
FRONT
REAR
joints:
  heave: {type: prismatic, i: {body: chassis}, j: {body: ground, point: [0, 0, 0.6]}}
forces:
  front_bushing: &bushing
    {type: bushing, i: front.pivot, j: {body: chassis, point: [1.8, 0, -0.25]}, stiffness: [2e7, 2e7, 2e7, 1e5, 1e3, 1e5], damping: [800, 800, 800, 100, 10, 100]}
  rear_bushing: {<<: *bushing, i: rear.pivot, j: {body: chassis, point: [-0.9, 0, -0.25]}}
  front_spring: &spring
    {type: spring_damper, i: front.seat, j: {body: chassis, point: [1.5, 0, 0.2]}, stiffness: 60e3, damping: 5e3, free_length: 0.45}
  rear_spring: {<<: *spring, i: rear.seat, j: {body: chassis, point: [-1.2, 0, 0.2]}}
  front_tyre: {type: force, i: front.wheel, force: [0, 0, 200e3*(0.3 - dz(front.wheel)) - 500*vz(front.wheel)]}
  rear_tyre: {type: force, i: rear.wheel, force: [0, 0, 200e3*(0.3 - dz(rear.wheel)) - 500*vz(rear.wheel)]}
run: {duration: 5 s, output: 5 ms, rtol: 1e-6}
"""
RIGID = """  {name}: {{mass: 40, inertia: [0.1, 1.5, 1.5], position: [{x}, 0, 0.31], markers: {{
    pivot: {{point: [0.45, 0, 0.04]}}, seat: {{point: [0.15, 0, 0.04]}}, wheel: {{point: [0, 0, -0.01]}}}}}}"""
FLEXIBLE = """  {name}:
    type: flexible
    mesh: arm.vtu
    units: {{length: 1 m}}
    material: {{E: 2.1e11, nu: 0.3, density: 7850}}
    interfaces:
      pivot: {{plane: {{point: [0.5, 0, 0], normal: [1, 0, 0]}}}}
      seat: {{sphere: {{center: [0.2, 0, 0.03], radius: 0.06}}, type: average}}
      wheel: {{plane: {{point: [0, 0, 0], normal: [1, 0, 0]}}}}
    modes: {modes}
    damping: 0.02
    position: [{x}, 0, 0.31]"""
MODES = 20
"""Modal coordinates of an arm: the static ones of three interfaces and normal modes."""
STATIC = 12


def half_car(folder: Path, arm: str) -> Scene:
    """Return the half car with arms of a kind."""
    text = HALF_CAR
    for name, x in (("front", 1.3), ("rear", -1.4)):
        text = text.replace(name.upper(), arm.format(name=name, x=x, modes=MODES - STATIC))
    path = folder / "half_car.yaml"
    path.write_text(text)
    return read_scene(text, file=path)


def box(path: Path, *axes: tuple[float, float, int]) -> None:
    """Write a mesh of hexahedra: first and last coordinate and number of elements along each axis."""
    mesh = MeshHex.init_tensor(*(np.linspace(first, last, n + 1) for first, last, n in axes))
    found = to_meshio(mesh)
    meshio.Mesh(found.points, found.cells).write(path)


def seconds_of_residual(job: Job, count: int = 300) -> float:
    """Return the time of the terms of one residual, s, the least of several."""
    state, formulation = job.dynamics.state, FORMULATIONS[job.settings.formulation](job.settings)
    state.q[:], state.u[:] = job.start.q, job.start.u
    times = []
    for _ in range(7):
        begin = time.perf_counter()
        for _ in range(count):
            state.evaluate(formulation.residual_set, 0.0)
        times.append((time.perf_counter() - begin) / count)
    return min(times)


def residual(folder: Path) -> None:
    """Print the cost of a residual."""
    box(folder / "arm.vtu", (0, 0.5, 10), (-0.05, 0.05, 2), (-0.03, 0.03, 2))
    rigid, flexible = (seconds_of_residual(prepare(half_car(folder, arm))) for arm in (RIGID, FLEXIBLE))
    print(
        f"residual of a half car: rigid {1e6 * rigid:.1f} us, with two bodies of {MODES} modes {1e6 * flexible:.1f} us: {flexible / rigid:.1f} times"
    )


SHELL = """  chassis:
    mass: 450 kg
    inertia: [160, 700, 760]
    position: [0, 0, height]
    velocity: [V, 0, 0]
  shell:
    type: flexible
    mesh: shell.vtu
    units: {length: 1 m}
    material: {E: 1e8, nu: 0.3, density: 555}
    interfaces:
      front: {plane: {point: [1.25, 0, 0], normal: [1, 0, 0]}}
      seat: {sphere: {center: [-0.1, 0, 0], radius: 0.45}, type: average, point: [0, 0, 0]}
      rear: {plane: {point: [-1.45, 0, 0], normal: [1, 0, 0]}}
    modes: 18
    damping: 0.03
    position: [0, 0, height]
    velocity: [V, 0, 0]
  bar:
    type: flexible
    mesh: bar.vtu
    units: {length: 1 m}
    material: {E: 2.1e11, nu: 0.3, density: 7850}
    interfaces:
      left: {plane: {point: [0, 0.3, 0], normal: [0, 1, 0]}}
      right: {plane: {point: [0, -0.3, 0], normal: [0, 1, 0]}}
    modes: 6
    damping: 0.03
    stiffening: false
    position: [a - 0.25 m, 0, 0.24 m]
    velocity: [V, 0, 0]
"""
"""A shell of 30 modal coordinates that carries the suspensions, and a bar of 12 between rigid arms, which twists beyond the theory of second order."""
LINKS = """mounts: {left: mount, right: mount, bar_left: mount, bar_right: mount}
parameters: {pivot: [-0.25 m, 0.30 m, 0.24 m], end: [-0.02 m, 0.52 m, 0.32 m], link: [0 m, 0.56 m, 0.19 m],
  pivot_right: [pivot_x, -pivot_y, pivot_z], end_right: [end_x, -end_y, end_z], link_right: [link_x, -link_y, link_z],
  drop: sqrt((link_x - end_x)^2 + (link_y - end_y)^2 + (link_z - end_z)^2)}
forces:
  left_bush: &bush
    {type: bushing, i: {body: bar_left, point: pivot, orientation: {z: [0, 1, 0]}}, j: {body: mount, point: pivot, orientation: {z: [0, 1, 0]}},
    stiffness: [5e6, 5e6, 1e6, 500, 500, 0], damping: [700, 700, 300, 1, 1, 1]}
  right_bush: {<<: *bush, i: {body: bar_right, point: pivot_right, orientation: {z: [0, 1, 0]}}, j: {body: mount, point: pivot_right, orientation: {z: [0, 1, 0]}}}
  left_link: &link {type: spring_damper, i: {body: bar_left, point: end}, j: {body: left, point: link}, stiffness: 1e6, damping: 200, free_length: drop}
  right_link: {<<: *link, i: {body: bar_right, point: end_right}, j: {body: right, point: link_right}}
"""


def car(folder: Path) -> None:
    """Print the time of a step steer of the car with a flexible shell and a flexible anti-roll bar, and with rigid ones."""
    text = (EXAMPLES / "car.yaml").read_text()
    (folder / "car.tir").write_bytes((EXAMPLES / "car.tir").read_bytes())
    (folder / "links.yaml").write_text(LINKS)
    box(folder / "shell.vtu", (-1.45, 1.25, 9), (-0.6, 0.6, 4), (-0.25, 0.25, 2))
    box(folder / "bar.vtu", (-0.007, 0.007, 1), (-0.3, 0.3, 12), (-0.007, 0.007, 1))
    bodies, others = text.index("  chassis:\n"), text.index("parts:\n")
    flexible = text[:bodies] + SHELL + text[others:]
    for place in ("on: chassis, position: [a, 0, -height]", "on: chassis\n    position: [a, 0, -height]"):
        flexible = flexible.replace(place, place.replace("chassis", "shell.front").replace("[a,", "[0,"))
    flexible = flexible.replace("on: chassis, position: [-b, 0, -height]", "on: shell.rear, position: [0, 0, -height]")
    flexible = flexible.replace("parts:\n", "parts:\n  links: {include: links.yaml}\n", 1)
    begin, end = flexible.index("  front.bar:"), flexible.index("  air:")
    flexible = (
        flexible[:begin]
        + "  front.bar: {use: links, on: shell.front, position: [0, 0, -height], mounts: {left: front.left.lower.arm, "
        + "right: front.right.lower.arm, bar_left: bar.left, bar_right: bar.right}}\n"
        + flexible[end:]
    ).replace("forces:\n", "joints: {seat: {type: fixed, i: chassis, j: shell.seat}}\nforces:\n", 1)
    for name, content in (("rigid", text), ("flexible", flexible)):
        start = content.index("start: {")  # left out, as equilibria in steady motion refuse flexible bodies
        content = content[:start] + content[content.index("\n", start) :]
        path = folder / f"{name}.yaml"
        path.write_text(content)
        scene = read_scene(content, [("choose.manoeuvre", "step_steer")], file=path)
        solution, seconds = run(scene), []
        for _ in range(3):
            started = time.process_time()
            solution = run(scene)
            seconds.append(time.process_time() - started)
        how = f"{min(seconds):.2f} s of processor time by {solution.solver['name']}, {solution.solver['steps']} steps"
        print(f"step steer of 10 s, {name}: {how}, {solution.message}", flush=True)


COMMANDS = {"residual": residual, "car": car}


def main(names: list[str]) -> None:
    """Measure what is asked for, or everything."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names or COMMANDS:
            COMMANDS[name](Path(folder))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure the cost of flexible bodies.")
    parser.add_argument(
        "names", nargs="*", choices=[[], *COMMANDS], metavar="NAME", help=f"{', '.join(COMMANDS)}; by default all"
    )
    main(parser.parse_args().names)
