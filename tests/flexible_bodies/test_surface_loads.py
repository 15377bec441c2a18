"""Pressure and traction on surfaces of flexible bodies, against closed forms and static solutions of the whole mesh."""

import json

import meshio
import numpy as np
import pytest
import scipy.sparse.linalg as sparse

import stiffmbs
from stiffmbs import spatial
from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.areas import unit_loads
from stiffmbs.results.flexible_motion import FlexibleMotion

from .bars import DENSITY, HEIGHT, LENGTH, WIDTH, E, mesh_of_bar
from .shells.meshes import surface

KINDS = ("tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27", "wedge", "wedge15", "pyramid")
FACES = {
    "left": ([0, 0, 0], [1, 0, 0]), "right": ([LENGTH, 0, 0], [1, 0, 0]), "front": ([0, 0, 0], [0, 1, 0]),
    "back": ([0, WIDTH, 0], [0, 1, 0]), "bottom": ([0, 0, 0], [0, 0, 1]), "top": ([0, 0, HEIGHT], [0, 0, 1]),
}  # fmt: skip
PLANES = {name: {"plane": {"point": point, "normal": normal}} for name, (point, normal) in FACES.items()}


def scene(folder, mesh, loads, interfaces, joints, more=None, **body):
    described = {
        "type": "flexible", "mesh": mesh, "units": {"length": "1 mm"}, "material": {"E": E, "nu": 0.3, "density": DENSITY},
        "modes": 2, "surfaces": PLANES, "interfaces": interfaces, **body,
    }  # fmt: skip
    forces = {
        name: {"type": "surface_load", "body": "bar", "surface": name.rstrip("0123456789"), **load}
        for name, load in loads.items()
    }
    whole = {"dimensions": 3, "bodies": {"bar": described}, "joints": joints, "forces": forces, **(more or {})}
    (folder / "scene.json").write_text(json.dumps(whole))
    return stiffmbs.load_scene(folder / "scene.json")


CLAMPED = {"foot": {"type": "fixed", "i": "bar.root", "j": {"body": "ground", "point": [0, WIDTH / 2, HEIGHT / 2]}}}
PLATE = {"foot": {"type": "fixed", "i": "bar.root", "j": {"body": "ground", "point": [0.5, 0.5, 0]}}}
ROOT = {"root": PLANES["left"], "tip": PLANES["right"] | {"type": "average"}}


def model_of(scene, folder):
    return scene.bodies["bar.frame"].source[0].model(folder)


def whole_mesh(model, loads, held):
    """Return the displacements of all nodes under loads with some nodes held."""
    free = np.setdiff1d(np.arange(model.size), model.entries(held))
    found = np.zeros(model.size)
    found[free] = sparse.spsolve(model.stiffness[free][:, free].tocsc(), loads[free])
    return found.reshape(len(model.nodes), -1)


@pytest.mark.parametrize("kind", KINDS)
def test_nodal_forces_are_consistent(tmp_path, kind):
    """Of a face of a distorted bar: resultant and moments of polynomial fields are the integrals over the face."""
    mesh = mesh_of_bar(kind, 3, 2)
    mesh.points[:, 1] += 0.1 * mesh.points[:, 0]  # a sheared bar, whose top stays plane
    mesh.write(tmp_path / "bar.vtu")
    model = model_of(scene(tmp_path, "bar.vtu", {}, ROOT, CLAMPED, surfaces={"top": PLANES["top"]}), tmp_path)
    top = np.flatnonzero(np.abs(model.nodes[:, 2] - HEIGHT) < 1e-9)
    loads = unit_loads(model, top, None, 1.0).reshape(len(model.nodes), 3, 4)
    area = LENGTH * WIDTH
    assert not loads[np.setdiff1d(np.arange(len(model.nodes)), top)].any()
    np.testing.assert_allclose(loads.sum(axis=0), area * np.column_stack([[0, 0, -1], *np.eye(3)]), atol=1e-12 * area)
    x, y = model.nodes[:, 0], model.nodes[:, 1]
    assert x @ loads[:, 2, 0] == pytest.approx(-area * LENGTH / 2)
    assert y @ loads[:, 2, 0] == pytest.approx(-area * (WIDTH / 2 + 0.1 * LENGTH / 2))
    if kind.endswith(("10", "15", "20", "27")):  # of second order
        assert x**2 @ loads[:, 2, 0] == pytest.approx(-area * LENGTH**2 / 3)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron20", "hexahedron"])
@pytest.mark.parametrize("stiffening", [False, "auto"])
def test_a_clamped_bar_under_pressure_deflects_as_its_mesh(tmp_path, kind, stiffening):
    """The static displacements under the load are among the modes. Bernoulli: q L^4/(8 E I), with shear."""
    mesh_of_bar(kind, 6, 2).write(tmp_path / "bar.vtu")
    pressure = 1e3
    found = scene(tmp_path, "bar.vtu", {"top": {"pressure": pressure}}, ROOT, CLAMPED, stiffening=stiffening)
    channels = stiffmbs.equilibrium(found).channels
    model = model_of(found, tmp_path)
    top, end = (np.flatnonzero(np.abs(model.nodes[:, a] - at) < 1e-9) for a, at in ((2, HEIGHT), (0, LENGTH)))
    expected = whole_mesh(
        model, pressure * unit_loads(model, top, None, 1.0)[:, 0], np.flatnonzero(model.nodes[:, 0] < 1e-9)
    )
    at_rest = model.nodes[end, 2].mean()
    assert channels["bar.tip.z"] - at_rest == pytest.approx(expected[end, 2].mean(), rel=1e-6)
    if kind != "hexahedron":
        bernoulli = pressure * WIDTH * LENGTH**4 / (8 * E * WIDTH * HEIGHT**3 / 12)
        assert at_rest - channels["bar.tip.z"] == pytest.approx(bernoulli, rel=0.04)
    assert channels["foot.fz"] == pytest.approx(pressure * LENGTH * WIDTH, rel=1e-6)
    assert channels["foot.ty"] == pytest.approx(-pressure * LENGTH * WIDTH * LENGTH / 2, rel=1e-5)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron"])
def test_a_body_under_pressure_on_all_sides_is_compressed(tmp_path, kind):
    """Uniformly by p (1 - 2 nu)/E along each axis, without a force on its support; its stress is -p."""
    mesh_of_bar(kind, 3, 2).write(tmp_path / "bar.vtu")
    pressure = 1e6
    held = {"root": {"nodes": [0], "type": "point"}}
    joint = {"ball": {"type": "spherical", "i": "bar.root", "j": "ground"}}
    more = {"start": "settled", "run": {"duration": 0.01, "points": 2}}
    found = scene(
        tmp_path, "bar.vtu", {name: {"pressure": pressure} for name in FACES}, held, joint, more, stiffening=False
    )
    motion = FlexibleMotion(found, stiffmbs.run(found), "bar")
    displacement = motion.displacement()[-1]
    strain = np.linalg.lstsq(np.column_stack([motion.model.nodes, np.ones(len(motion.model.nodes))]), displacement)[0][
        :3
    ]
    np.testing.assert_allclose((strain + strain.T) / 2, -pressure * 0.4 / E * np.eye(3), atol=1e-5 * pressure * 0.4 / E)
    np.testing.assert_allclose(motion.stress()[-1, :, :3], -pressure, rtol=1e-4)


def test_traction_stretches_a_bar_and_a_free_bar_accelerates(tmp_path):
    mesh_of_bar("hexahedron20", 4, 2).write(tmp_path / "bar.vtu")
    traction = {"right": {"traction": [3e6, 0, 0]}}
    of_area = {"type": "average", "weights": "area"}
    ends = {"root": PLANES["left"] | of_area, "tip": PLANES["right"] | of_area}
    found = stiffmbs.equilibrium(scene(tmp_path, "bar.vtu", traction, ends, CLAMPED, stiffening=False)).channels
    assert found["bar.tip.x"] - LENGTH == pytest.approx(3e6 * LENGTH / E, rel=1e-6)
    free = scene(
        tmp_path,
        "bar.vtu",
        {"right": {"pressure": "2 MPa"}},
        ends,
        {},
        {"run": {"duration": 1e-3, "points": 11, "rtol": 1e-9}},
        damping=0.02,
    )
    motion = stiffmbs.run(free)
    acceleration = -2e6 / (DENSITY * LENGTH)
    ended = motion["bar.frame.vx"][-1] * motion.time[-1] / 2
    assert motion["bar.frame.vx"][-1] == pytest.approx(acceleration * 1e-3, rel=1e-3)
    assert motion["bar.frame.x"][-1] - motion["bar.frame.x"][0] == pytest.approx(ended, rel=1e-3)


def test_loads_are_formulas_of_parameters_time_and_channels(tmp_path):
    mesh_of_bar("hexahedron", 3, 1).write(tmp_path / "bar.vtu")
    load = {"pressure": "p0*sin(20 rad/s*t)", "traction": [0, "p0/2", "-300 Pa*bar.tip.z/1 m"]}
    more = {"parameters": {"p0": "2 kPa"}, "run": {"duration": 0.1, "points": 5, "solver": "radau"}}
    found = scene(tmp_path, "bar.vtu", {"top": load}, ROOT, CLAMPED, more)
    motion = stiffmbs.run(found)
    area = LENGTH * WIDTH
    np.testing.assert_allclose(
        motion["bar.top.frame.fz"],
        area * (-2e3 * np.sin(20 * motion.time) - 300 * motion["bar.tip.z"]),
        rtol=1e-4,
        atol=1e-4,
    )
    np.testing.assert_allclose(motion["bar.top.frame.fy"], 1e3 * area, rtol=1e-4)


def test_moments_are_about_the_deformed_body(tmp_path):
    """A bar that one load bends: another load along it, on its bent end, has a moment about its foot by the deflection."""
    mesh_of_bar("hexahedron20", 4, 2).write(tmp_path / "bar.vtu")
    bend = {"top": {"pressure": 2e5}}
    before, after = (
        stiffmbs.equilibrium(
            scene(tmp_path, "bar.vtu", bend | {"right": {"traction": [pull, 0, 0]}}, ROOT, CLAMPED, stiffening=False)
        ).channels
        for pull in (0.0, 1e5)
    )
    turned = 2 * np.arcsin(after["bar.frame.q2"])  # about y
    arm = (after["bar.tip.z"] - HEIGHT / 2) * np.cos(turned) + after["bar.tip.x"] * np.sin(turned)
    of_pressure = (
        2e5 * LENGTH * WIDTH * (after["bar.tip.x"] - before["bar.tip.x"]) / 2
    )  # which the stretched bar has farther out
    expected = -1e5 * WIDTH * HEIGHT * arm - of_pressure
    assert after["foot.ty"] - before["foot.ty"] == pytest.approx(expected, rel=2e-3)
    assert abs(arm) > 2e-4


@pytest.mark.parametrize(("n", "error"), [(8, 0.03), (16, 0.008)])
def test_a_clamped_plate_of_shells_under_pressure(tmp_path, n, error):
    """0.001265 q a^4/D in the middle (Timoshenko and Woinowsky-Krieger, Theory of plates and shells, table 35)."""
    nodes, cells, _ = surface(n, n, lambda a, b: (a, b, 0.0 * a))
    meshio.Mesh(nodes, list(cells.items())).write(tmp_path / "plate.vtu")
    rim = np.flatnonzero((np.abs(nodes[:, :2] - 0.5) > 0.5 - 1e-9).any(axis=1)).tolist()
    middle = int(np.argmin(np.linalg.norm(nodes - [0.5, 0.5, 0], axis=1)))
    body = {
        "units": {"length": "1 m"}, "thickness": 0.005, "surfaces": {"skin": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}, "outside": [0, 0, 1]}},
        "interfaces": {"root": {"nodes": rim}, "middle": {"nodes": [middle], "type": "point"}}, "stiffening": False,
    }  # fmt: skip
    load = {"type": "surface_load", "body": "bar", "surface": "skin", "pressure": 100}
    found = scene(tmp_path, "plate.vtu", {}, body.pop("interfaces"), PLATE, {"forces": {"air": load}}, **body)
    channels = stiffmbs.equilibrium(found).channels
    stiffness = E * 0.005**3 / (12 * (1 - 0.3**2))
    assert channels["bar.middle.z"] == pytest.approx(-0.001265 * 100 / stiffness, rel=error)
    assert channels["foot.fz"] == pytest.approx(100, rel=1e-9)


@pytest.mark.parametrize("outside", [None, [0, 0, 1], [0, 0, -1], [0.1, 0.2, 1]])
def test_the_outer_side_of_shells(tmp_path, outside):
    """By the order of the nodes, or by a direction, of any mixture of normals."""
    nodes, cells, _ = surface(2, 2, lambda a, b: (a, b, 0.0 * a))
    edge = {"root": {"nodes": [0, 1, 2]}}
    quads = cells["quad"].copy()
    flipped = quads.copy()
    flipped[1] = flipped[1, ::-1]
    up = np.cross(nodes[quads[0, 1]] - nodes[quads[0, 0]], nodes[quads[0, 2]] - nodes[quads[0, 0]])[2] > 0
    for own, mixed in ((quads, False), (flipped, True)):
        meshio.Mesh(nodes, [("quad", own)]).write(tmp_path / "plate.vtu")
        skin = {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}} | ({"outside": outside} if outside else {})
        body = {"units": {"length": 1}, "thickness": 0.01, "surfaces": {"skin": skin}}
        load = {"forces": {"air": {"type": "surface_load", "body": "bar", "surface": "skin", "pressure": 5}}}
        if mixed and outside is None:
            with pytest.raises(
                InputError, match=r"surfaces\.skin: found neighbouring shells with opposite normals, .* 'outside'"
            ):
                scene(tmp_path, "plate.vtu", {}, edge, PLATE, load, **body)
            continue
        found = stiffmbs.run(scene(tmp_path, "plate.vtu", {}, edge, PLATE, load, **body), duration=1e-4, points=2)
        sign = (1 if up else -1) if outside is None else np.sign(outside[2])
        assert found["bar.air.frame.fz"][0] == pytest.approx(-5 * sign)


@pytest.mark.parametrize(("outside", "refused"), [(None, False), ([0.1, 1, 0], False), ([1, 0.01, 0], True)])
def test_a_direction_that_changes_the_side_of_a_curved_shell_is_refused(tmp_path, outside, refused):
    """Half a tube: the direction x is outside at one end and inside at the other, where the pressure had the other sign."""
    nodes, cells, _ = surface(9, 2, lambda a, b: (np.cos(np.pi * (0.1 + 0.8 * a)), np.sin(np.pi * (0.1 + 0.8 * a)), b))
    meshio.Mesh(nodes, list(cells.items())).write(tmp_path / "plate.vtu")
    skin = {"nodes": list(range(len(nodes)))} | ({"outside": outside} if outside else {})
    body = {"units": {"length": 1}, "thickness": 0.01, "surfaces": {"skin": skin}, "stiffening": False}
    load = {"forces": {"air": {"type": "surface_load", "body": "bar", "surface": "skin", "pressure": 5}}}
    if refused:
        with pytest.raises(InputError, match=r"surfaces\.skin: found neighbouring shells with opposite sides"):
            scene(tmp_path, "plate.vtu", {}, {"root": {"nodes": [0, 1, 2]}}, {}, load, **body)
        return
    found = stiffmbs.run(
        scene(tmp_path, "plate.vtu", {}, {"root": {"nodes": [0, 1, 2]}}, {}, load, **body), duration=1e-5, points=2
    )
    assert abs(found["bar.air.frame.fy"][0]) == pytest.approx(5 * 2 * np.cos(0.1 * np.pi))


def test_a_surface_in_a_mirrored_part(tmp_path):
    """The scene loads it by the name of the body there; pressure acts against the outer normal of the mirrored body."""
    mesh_of_bar("hexahedron20", 3, 1).write(tmp_path / "bar.vtu")
    body = {
        "type": "flexible", "mesh": "bar.vtu", "units": {"length": "1 mm"}, "material": {"E": E, "nu": 0.3, "density": DENSITY}, "modes": 1,
        "surfaces": PLANES, "interfaces": ROOT,
    }  # fmt: skip
    part = {"bodies": {"bar": body}, "joints": {"foot": {"type": "fixed", "i": "bar.root", "j": "mount"}}}
    loads = {
        side: {"type": "surface_load", "body": f"{side}.bar", "surface": "back", "pressure": 7e3}
        for side in ("left", "right")
    }
    whole = {
        "dimensions": 3,
        "parts": {"wing": part},
        "use": {"left": {"part": "wing"}, "right": {"part": "wing", "mirror": "y"}},
    }
    (tmp_path / "scene.json").write_text(json.dumps(whole | {"forces": loads}))
    found = stiffmbs.equilibrium(stiffmbs.load_scene(tmp_path / "scene.json")).channels
    assert found["left.foot.fy"] == pytest.approx(7e3 * LENGTH * HEIGHT, rel=1e-5)
    for name, sign in (("foot.fy", -1), ("foot.tz", -1), ("foot.fx", 1)):
        assert found[f"right.{name}"] == pytest.approx(sign * found[f"left.{name}"], rel=1e-6, abs=1e-6)
    part["forces"] = {"air": loads["left"] | {"body": "bar"}}
    (tmp_path / "scene.json").write_text(json.dumps(whole))
    with pytest.raises(InputError, match=r"parts\.wing\.forces\.air: found a surface load in a part, .*: left\.bar"):
        stiffmbs.load_scene(tmp_path / "scene.json")


@pytest.mark.parametrize(("load", "body", "reason"), [
    ({}, {}, "forces.top: found neither pressure nor traction"),
    ({"pressure": 1, "body": "baz"}, {}, r"forces.top.body: found the unknown flexible body 'baz' \(did you mean 'bar'"),
    ({"pressure": 1, "surface": "tip"}, {}, r"forces.top.surface: found the unknown surface 'tip'.*left, right, front"),
    ({"pressure": True}, {}, "forces.top.pressure: found True"),
    ({"traction": [0, True, 0]}, {}, "forces.top.traction.1: found True"),
    ({"pressure": "1 N"}, {}, "found N and N/m\\^2"),
    ({"pressure": 1}, {"surfaces": {"top": {"nodes": [0, 1]}}}, r"bodies.bar: surfaces.top: found no face of an element"),
    ({"pressure": 1}, {"surfaces": {"top": {"group": "skin"}}}, r"surfaces.top: .*found no group 'skin'"),
    ({"pressure": 1}, {"surfaces": {"top": {}}}, "found none of nodes, group, sphere and plane"),
])  # fmt: skip
def test_wrong_loads_are_refused(tmp_path, load, body, reason):
    mesh_of_bar("hexahedron", 2, 1).write(tmp_path / "bar.vtu")
    with pytest.raises(InputError, match=reason):
        scene(tmp_path, "bar.vtu", {"top": load}, ROOT, CLAMPED, **body)


def test_a_load_in_a_model_built_in_python(tmp_path, monkeypatch):
    """Moves as that of the scene; it is removed and replaced as a whole, and keeps its body from being replaced."""
    mesh_of_bar("hexahedron", 3, 1).write(tmp_path / "bar.vtu")
    monkeypatch.chdir(tmp_path)
    of_scene = scene(tmp_path, "bar.vtu", {"top": {"pressure": "3 kPa"}}, ROOT, CLAMPED)
    described = {
        "mesh": "bar.vtu", "units": {"length": "1 mm"}, "material": {"E": E, "nu": 0.3, "density": DENSITY}, "modes": 2,
        "interfaces": ROOT, "surfaces": PLANES,
    }  # fmt: skip
    model = spatial.Model()
    bar = model.add("bar", spatial.FlexibleBody(**described))
    model.add("foot", spatial.Fixed(i=bar.root, j={"body": "ground", "point": [0, WIDTH / 2, HEIGHT / 2]}))
    load = spatial.SurfaceLoad(body=bar, surface="top", pressure="3 kPa")
    model.add("top", load)
    found, expected = (stiffmbs.run(each, duration=1e-3, points=3) for each in (model, of_scene))
    np.testing.assert_allclose(found["bar.tip.z"], expected["bar.tip.z"], rtol=1e-9)
    for change, words in [
        (lambda: model.replace("bar", spatial.FlexibleBody(**described)), "bar: found the load 'top' on it"),
        (lambda: model.remove("bar"), "bar: found the load 'top' on it"),
        (lambda: model.remove("bar.top.torque"), "found a part of 'top', which can only be changed as a whole"),
        (lambda: model.add("top", load), "top: found a name that is taken"),
        (lambda: model.add("side", spatial.SurfaceLoad(body="bar", surface="none", pressure=1)), "side.surface: found the unknown surface 'none'"),
        (lambda: model.add("tip", load), "tip.body: found 'bar', which has a part 'tip' too"),
        (lambda: model.add("push", spatial.AppliedForce(i={"body": "bar.frame"}, force=(1, 0, 0))), "would not deform"),
    ]:  # fmt: skip
        with pytest.raises(InputError, match=words):
            change()
    model.replace("top", spatial.SurfaceLoad(body="bar", surface="top", pressure="6 kPa"))
    twice = stiffmbs.run(model, duration=1e-3, points=3)
    rise = [each["bar.tip.z"][1:] - each["bar.tip.z"][0] for each in (twice, found)]
    np.testing.assert_allclose(rise[0], 2 * rise[1], rtol=1e-3)
    model.remove("top")
    assert not model.forces
    model.remove("foot")
    model.remove("bar")
    assert not model.bodies


def test_sensitivities_to_a_load_and_to_the_material(tmp_path):
    """The forces of the load belong to modes; those of another Young's modulus have the same shapes, of another Poisson's ratio not."""
    mesh_of_bar("hexahedron", 3, 1).write(tmp_path / "bar.vtu")
    more = {
        "parameters": {"p": "2 kPa", "modulus": f"{E} Pa"},
        "run": {"duration": 1e-3, "points": 3, "rtol": 1e-7, "solver": "radau"},
    }
    material = {"E": "modulus", "nu": 0.3, "density": DENSITY}

    def made(**values):
        own = more | {"parameters": more["parameters"] | values}
        return scene(
            tmp_path,
            "bar.vtu",
            {"top": {"pressure": "p"}},
            ROOT,
            CLAMPED,
            own,
            material=material,
            surfaces={"top": PLANES["top"]},
            modes=1,
            damping=0.05,
        )

    of = "final(bar.tip.z)"
    found = stiffmbs.sensitivities(made(), ["p", "modulus"], of)
    start = stiffmbs.run(made())["bar.tip.z"][0]
    assert found.to["p"] == pytest.approx((found.value - start) / 2e3, rel=1e-3)
    ends = [stiffmbs.run(made(modulus=f"{E * (1 + h)} Pa"), rtol=1e-10)["bar.tip.z"][-1] for h in (1e-3, -1e-3)]
    assert found.to["modulus"] == pytest.approx((ends[0] - ends[1]) / (2e-3 * E), rel=1e-3)
    with pytest.raises(InputError, match=r"bodies\.bar: found a surface load on modes that change with the value"):
        stiffmbs.sensitivities(made(), ["bodies.bar.material.nu"], of)


@pytest.mark.parametrize("name", ["bar.push", "bar.wind.other", "push"])
def test_other_forces_on_the_frame_stay_refused(tmp_path, name):
    mesh_of_bar("hexahedron", 2, 1).write(tmp_path / "bar.vtu")
    push = {"type": "force", "i": "bar.frame", "force": [0, 0, 1]}
    with pytest.raises(InputError, match=r"found 'bar\.frame', where a force would not deform"):
        scene(tmp_path, "bar.vtu", {}, ROOT, CLAMPED, {"forces": {name: push}})


def test_the_schema_describes_surface_loads():
    import jsonschema

    schema = jsonschema.Draft202012Validator(stiffmbs.scene_schema())
    load = {"type": "surface_load", "body": "bar", "surface": "top", "pressure": "2 kPa"}
    whole = {"dimensions": 3, "bodies": {"a": {"mass": 1, "inertia": [1, 1, 1]}}, "forces": {"air": load}}
    assert not list(schema.iter_errors(whole))
    assert list(schema.iter_errors(whole | {"forces": {"air": load | {"presure": 1}}}))
