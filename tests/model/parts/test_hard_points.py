"""Hard points of a suspension: those in wrong units or on the wrong side are refused."""

import json

import pytest

import stiffmbs


def corner(parameters, part="double_wishbone", **words):
    use = {"use": part, "parameters": parameters, **words}
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "parts": {"left": use}}))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (
            {"lower_ball": [5, 715, 175]},
            "left.parameters.lower_ball: found (5, 715, 175) m, which is 735 m from wheel_centre (0, 0.76, 0.3) m",
        ),
        ({"wheel_centre": [0, 760, 300]}, "m from wheel_centre (0, 760, 300) m, expected 5 m or less"),
        (
            {"upper_ball_y": -0.66},
            "left.parameters.upper_ball: found (-0.02, -0.66, 0.5) m, on the other side of the car",
        ),
        (
            {"lower_ball": ["0 m", "-700 mm", "170 mm"]},
            "on the other side of the car from wheel_centre (0, 0.76, 0.3) m",
        ),
        ({"lower_ball_z": 5.5}, "m from wheel_centre"),
        (
            {"upper_ball": [0, 0.70, 0.17]},
            "left.parameters.upper_ball: found (0, 0.7, 0.17) m, in the place of lower_ball, expected two points apart",
        ),
        (
            {"tie_outer": [0.12, 0.3701, 0.287]},
            "left.parameters.tie_outer: found (0.12, 0.3701, 0.287) m, in the place of tie_inner",
        ),
        (
            {"strut_tower": [0, 0.56, 0.185]},
            "left.parameters.strut_tower: found (0, 0.56, 0.185) m, in the place of strut_seat",
        ),
        ({"lower_bal": [0, 0, 0]}, "(did you mean 'lower_ball'?)"),
        ({"camber": -0.5}, "left.parameters.camber: found -0.5 rad, which is -28.6 deg, expected 20 deg or less"),
        (
            {"spring": 75},
            "left.parameters.spring: found 75 N/m, by which strut_load = 6050 N compresses the spring by 80.7 m, expected 5 m",
        ),
        ({"spring": 6050 / 5.1}, "compresses the spring by 5.1 m"),
        ({"toe": "21 deg"}, "left.parameters.toe: found 0.366519 rad, which is 21 deg"),
    ],
)
def test_hard_points_that_are_no_car_are_refused(parameters, message):
    with pytest.raises(stiffmbs.InputError) as error:
        corner(parameters)
    assert message in str(error.value)


def test_points_near_the_middle_and_far_below_the_limit_are_read():
    corner({"lower_front_y": -0.3, "lower_rear_z": 5.1})
    corner({"toe": "-19 deg", "camber": "19 deg"})
    corner({"spring": 6050 / 4.9})
    corner({"spring": 75, "strut_load": 0})
    corner({"strut_seat": [0, 0.70, 0.17]})  # at the lower ball joint
    corner({"lower_front_outer": [-0.02, 0.68, 0.17]}, "multi_link")  # two links that meet
    corner({"wheel_centre": [0, "0.8 m", "0.3 m"]}, "twist_beam")
    corner({}, mirror="y")
