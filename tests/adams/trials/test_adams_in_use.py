"""Datasets as users write them, in several styles, run through the command line and compared with closed forms."""

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.adams.load import load_adams
from stiffmbs.commands.main import main

BEAM = """beam cantilever
UNITS/FORCE=NEWTON,MASS=KILOGRAM,LENGTH=MILLIMETER,TIME=SECOND
PART/1,GROUND
MARKER/1,PART=1
PART/2,MASS=0.1,CM=20,IP=10,10,10,QG=500,0,0
MARKER/20,PART=2
BEAM/1,I=20,J=1,LENGTH=500,IXX=100,IYY=50,IZZ=50,AREA=20,ASY=0,ASZ=0,EMOD=2.07E5,GMOD=8E4,CRATIO=0.01
SFORCE/2,TRANS,ACTION,I=20,J=1,FUNC=5
END
"""
SYSTEMS = """states of several kinds
units/force=newton,mass=kilogram,length=meter,time=second
part/1,ground
marker/1,part=1
part/2,mass=1,cm=20,ip=1,1,1
marker/20,part=2
joint/1,trans,i=20,j=1
diff/1,ic=1,function=-2*dif(1)
diff/2,ic=0,function=dif(1)
, -dif(2)
diff/3,implicit,ic=1,-1,function=dif1(3)+dif(3)**2
var/1,func=sin(3*time)
array/1,u,variables=1,size=1
array/2,x,size=2
array/3,y,size=1
array/4,ic,num=0.1,0
matrix/1,full=rorder,m=2,n=2,values=0,1,-4,-0.4
matrix/2,full=corder,m=2,n=1,values=0,1
matrix/3,sparse,m=1,n=2,values=1,i=1,j=1
lse/1,x=2,u=1,y=3,ic=4,a=1,b=2,c=3
req/1,f2=dif(1)\\f3=dif(2)\\f4=dif(3)\\f5=aryval(3,1)\\
sensor/1,func=time,value=0.8,ge,halt
end
"""
FORMULAS = """formulas over several lines
UNITS/SYSTEM=MKS
PART/1,GROUND
MARKER/1,PART=1
PART/2,MASS=1,CM=20,IP=1,1,1
MARKER/20,PART=2
JOINT/1,TRANSLATIONAL,I=20,J=1
! one term a line
SFORCE/1,TRANSLATIONAL,ACTIONONLY,I=20,J=1
,FUNCTION=IF(TIME-0.25:1,1,IF(TIME-0.5:2,2,0))
,+POLY(TIME,0,1,2,3)+CHEBY(TIME,1,1,2,3)+FORSIN(TIME,0,PI,0.5,1)
! a comment between
,+MAX(1,MIN(TIME,3)) + EXP(-TIME)*DIM(TIME,0.5)
, + ATAN2(1,1) + 10**2/100 + LOG10(100.)+ABS(-1)
,*2
SPLINE/7, X=-10, 0, 10, 20, 30, Y=0,0,1,4,9
REQ/1,F2=SFORCE(1,0,4,1)\\F3=HAVSIN(TIME,0,0,1,1)\\F4=SHF(TIME,0,2,6.28,0,1)\\F5=CUBSPL(12.3,0,7)\\F6=MOD(7.5,2)\\
END
"""
MODES = """bushing and field in milliseconds
UNITS/FORCE=KNEWTON,MASS=KILOGRAM,LENGTH=MILLIMETER,TIME=MILLISECOND
PART/1,GROUND
MARKER/1,PART=1
PART/2,MASS=10,CM=20,IP=1E4,1E4,1E4
MARKER/20,PART=2
BUSHING/1,I=20,J=1,K=1,2,3,KT=100,100,100,C=0.1,0.1,0.1,CT=1,1,1
PART/3,MASS=10,CM=30,IP=1E4,1E4,1E4
MARKER/30,PART=3
FIELD/1,I=30,J=1
,CRATIO=0.0
,KMATRIX=1,0,0,0,0,0
,0,2,0,0,0,0
,0,0,3,0,0,0
,0,0,0,100,0,0
,0,0,0,0,100,0
,0,0,0,0,0,100
END
"""


def _model(folder, dataset, commands=""):
    (folder / "model.adm").write_text(dataset)
    if commands:
        (folder / "model.acf").write_text(commands)
    return folder / "model.adm"


@pytest.mark.long
def test_a_command_file_of_one_static_simulation_runs_and_is_summarised(tmp_path):
    """The tip of the beam moves by F L^3/(3 E I), less by the shortening of its chord (of second order)."""
    path = _model(tmp_path, BEAM, "sim/stat\n")
    printed = CliRunner().invoke(main, ["run", str(path)])
    assert printed.exit_code == 0, printed.output
    assert "at rest in equilibrium" in printed.output
    assert printed.output.count("model.acf runs one simulation") == 1
    solution = stiffmbs.run(load_adams(path))
    assert abs(solution["PART_2.z"][-1] - 5 * 0.5**3 / (3 * 2.07e11 * 50e-12)) < 1e-6
    assert "equilibrium" in stiffmbs.summary(solution)


def test_states_written_in_lower_case_follow_their_closed_forms(tmp_path):
    solution = stiffmbs.run(load_adams(_model(tmp_path, SYSTEMS, "sim/dyn,end=1,steps=100\n")), rtol=1e-9)
    t = solution.time
    assert abs(t[-1] - 0.8) < 1e-9
    for column, exact in (("f2", np.exp(-2 * t)), ("f3", np.exp(-t) - np.exp(-2 * t)), ("f4", 1 / (1 + t))):
        assert np.max(np.abs(solution[f"REQUEST_1.{column}"] - exact)) < 1e-6
    # y'' + 0.4 y' + 4 y = sin 3t from y = 0.1, y' = 0
    a, w = -0.2 + 1j * np.sqrt(3.96), 1 / (4 - 9 + 1.2j)
    forced, rate = (w * np.exp(3j * t)).imag, (3j * w * np.exp(3j * t)).imag
    real, other = 0.1 - forced[0], (-rate[0] - a.real * (0.1 - forced[0])) / a.imag
    free = np.exp(a.real * t) * (real * np.cos(a.imag * t) + other * np.sin(a.imag * t))
    assert np.max(np.abs(solution["REQUEST_1.f5"] - free - forced)) < 1e-6


def test_a_formula_over_several_lines_has_each_of_its_terms(tmp_path):
    solution = stiffmbs.run(load_adams(_model(tmp_path, FORMULAS, "sim/dyn,end=1,steps=100\n")))
    t = solution.time
    exact = np.where(t <= 0.25, 1.0, np.where(t <= 0.5, 2.0, 0.0)) + 1 + 2 * t + 3 * t**2
    exact += 1 + 2 * (t - 1) + 3 * (2 * (t - 1) ** 2 - 1) + 0.5 + np.sin(np.pi * t)
    exact += 1 + np.exp(-t) * np.maximum(t - 0.5, 0) + np.pi / 4 + 1 + 2 + 2
    smooth = (np.abs(t - 0.25) > 0.005) & (np.abs(t - 0.5) > 0.005)
    assert np.max(np.abs(solution["REQUEST_1.f2"] - exact)[smooth]) < 1e-12
    assert np.max(np.abs(solution["REQUEST_1.f3"] - (1 - np.cos(np.pi * t)) / 2)) < 1e-12
    assert np.max(np.abs(solution["REQUEST_1.f4"] - 2 * np.sin(6.28 * t) - 1)) < 1e-12
    assert abs(solution["REQUEST_1.f5"][0] - 1.499838875) < 1e-9
    assert solution["REQUEST_1.f6"][0] == 1.5


@pytest.mark.long
def test_a_bushing_and_a_field_have_the_same_frequencies_in_milliseconds(tmp_path):
    modes = stiffmbs.modes(load_adams(_model(tmp_path, MODES)))
    exact = np.repeat(np.sqrt([1e4, 1e4, 1e4, 1e5, 2e5, 3e5]), 2) / (2 * np.pi)
    assert np.allclose(sorted(mode.frequency for mode in modes.modes), exact, rtol=2e-4)
    assert not modes.notes  # the field has no damping, whose rounding is no breakpoint
    decays = sorted(-mode.eigenvalues[0].real for mode in modes.modes)
    assert np.allclose(decays, [0.0] * 6 + [0.05] * 3 + [5.0] * 3, rtol=1e-3, atol=1e-3)
