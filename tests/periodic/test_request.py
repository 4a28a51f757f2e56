"""What Python may ask of a response, and what is refused in one line."""

from dataclasses import replace

import numpy as np
import pytest

import rotor_fmu as rf

from .machines import FAINT_RUB


@pytest.mark.parametrize(
    ("options", "refusal"),
    [
        ({"speed": 100.0}, "speed = 100.0: must be FROM and TO"),
        ({"period": 2.5}, "period = 2.5: must be an integer from 1 to 16"),
        ({"period": 2, "whirl": True}, "^period = 2: must be 1 with whirl, "),
        ({"branches": True, "whirl": True}, "^branches: not with whirl, "),
        ({"harmonics": 5.5}, "harmonics = 5.5: must be an integer from 1 to 500"),
        ({"harmonics": "few"}, "harmonics = 'few': must be an integer from 1 to 500"),
        ({"period": True}, "period = True: must be an integer from 1 to 16"),
        ({"seeds": 5}, "^seeds = 5: must be a list of numbers$"),
        ({"parameters": {"contact[1].mu": "a"}}, r"contact\[1\].mu = a: must be a number$"),
        ({"share": "a"}, "^share = 'a': must be a number$"),
        ({"speed": ("a", 65.0)}, r"^speed = \('a', 65.0\): must be a list of numbers$"),
        ({"start": 3}, "^start = 3: must be a motion of `at` or `points` of an earlier result$"),
        ({"speed": 60.0, "over": ("contact[1].mu", 0.1)}, "over = .*: must be a name, FROM and TO"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_one_line(options, refusal):
    with pytest.raises(rf.InputError, match=refusal) as refused:
        rf.response(FAINT_RUB, **{"speed": (60.0, 65.0), **options})
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("speed", [[60.0, 65.0], np.array([60.0, 65.0])])
def test_a_range_is_any_pair_of_numbers(speed):
    points = rf.response(FAINT_RUB, speed=speed, harmonics=np.int64(3)).points
    assert (points[0].value, points[-1].value) == (60.0, 65.0)


SLOWLY = {"speed": (20.0, 25.0), "harmonics": 3, "step": 3.0, "stability": False}


@pytest.fixture(scope="module")
def switched():
    """The radii of the rig whose damping turns with it."""
    rotor = replace(rf.load().rotor, rotating_damping=True)
    return rf.response(rotor, **SLOWLY).curve("disc[3].r_amp").value.tolist()


@pytest.mark.parametrize(
    "value", [*(pytest.param(value, marks=pytest.mark.slow) for value in (True, 1)), "true"]
)
def test_a_switch_of_the_machine_may_be_given(switched, value):
    given = rf.response(rf.load(), parameters={"shaft.rotating_damping": value}, **SLOWLY)
    assert given.points[0].value == 20.0
    assert given.curve("disc[3].r_amp").value.tolist() == switched


@pytest.mark.parametrize("speed", [np.int64(60), np.array(60.0)])
def test_one_speed_is_any_number(speed):
    result = rf.response(FAINT_RUB, speed=speed, over=("contact[1].mu", 0.0, 0.1))
    assert result.parameter == "contact[1].mu"
