"""What is no signal, or what one cannot be asked for, is refused by its argument's name; what was
not recorded is left out."""

import math

import numpy as np
import pytest

from rotor_fmu import vibration
from rotor_fmu.errors import InputError

T = np.linspace(0.0, 1.0, 2000)
PHI = 100.0 * T
Z = 1e-5 * np.exp(1j * PHI)
FORCE = np.where(np.mod(PHI, 2 * np.pi) < 1.0, 5.0, 0.0)
PEAK = 1e-5 / np.abs(2500 - PHI**2 + 20j * PHI)


def losses(t, phi, friction):
    return vibration.power_by_sink(t, phi, {"friction": friction})[2]["friction"]


FUNCTIONS = {
    "turns_of": (vibration.turns_of, {"t": T, "phi": PHI}),
    "rows_per_turn": (vibration.rows_per_turn, {"phi": PHI}),
    "synchronous": (vibration.synchronous, {"t": T, "phi": PHI, "z": Z}),
    "contact": (vibration.contact, {"t": T, "phi": PHI, "psi": PHI, "fn": FORCE}),
    "power_by_sink": (losses, {"t": T, "phi": PHI, "friction": T}),
    "time_share": (vibration.time_share, {"t": T, "w": 100.0 + T, "z": Z}),
    "spectrum": (vibration.spectrum, {"t": T, "values": Z.real}),
    "second_half": (vibration.second_half, {"t": T, "phi": PHI}),
    "resonances": (vibration.resonances, {"speed": PHI, "amplitude": PEAK, "t": T}),
}


def numbers_of(answer):
    """All numbers of an answer in a row."""
    if isinstance(answer, slice):
        return np.ravel(answer.start)
    if isinstance(answer, (tuple, list)):
        return np.concatenate([numbers_of(part) for part in answer])
    return (
        np.ravel(answer)
        if np.ndim(answer) or np.isscalar(answer)
        else numbers_of(list(vars(answer).values()))
    )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_is_no_signal_is_refused_by_its_name(name):
    function, given = FUNCTIONS[name]
    for argument, values in given.items():
        called = rf"(losses\[)?\b{argument}\b\]?"
        others = (
            [values.reshape(2, -1)] if len(given) == 1 else [values[:-1], values.reshape(2, -1)]
        )
        for other in others:
            shape = rf"{called} \({', '.join(map(str, other.shape))},?\)"
            with pytest.raises(InputError, match=rf"{shape}.*: must be alike, \(n,\)$"):
                function(**given | {argument: other})
        with pytest.raises(InputError, match=rf"^{called} = .*: must be an array of numbers$"):
            function(**given | {argument: ["0.1", *values[1:]]})
    if "t" in given:
        with pytest.raises(InputError, match=r"^t = 0\.0 s after 1\.0 s: times must not fall$"):
            function(**given | {"t": np.append(T[1:], 0.0)})


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if name != "turns_of"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_is_left_out(name, value):
    function, given = FUNCTIONS[name]
    right = numbers_of(function(**given))
    for argument in set(given) - {"friction"}:
        gone = np.insert(given[argument], 10, value)
        more = {key: np.insert(values, 10, values[10]) for key, values in given.items()}
        answer = numbers_of(function(**more | {argument: gone}))
        assert answer == pytest.approx(right + (name == "second_half"), nan_ok=True), argument


def test_turns_of_what_is_not_finite_are_refused_by_the_row():
    phi = PHI.copy()
    phi[7] = np.nan
    with pytest.raises(InputError, match=r"^phi\[7\] = nan: must be finite$"):
        vibration.turns_of(T, phi)


def test_the_power_next_to_an_energy_that_is_not_known_is_not_known():
    energy = 3.0 * T
    energy[1000] = np.nan
    power = losses(T, PHI, energy)
    assert np.isnan(power).sum() <= 2
    assert power[np.isfinite(power)] == pytest.approx(3.0)


def test_where_nothing_touches_a_contact_needs_no_angle():
    right = vibration.contact(T, PHI, PHI, FORCE)
    known = vibration.contact(T, PHI, np.where(FORCE > 0, PHI, np.nan), FORCE)
    assert known.share == pytest.approx(right.share)
    assert known.angle == pytest.approx(right.angle)


def test_a_turn_that_takes_no_time_is_refused():
    for function in (vibration.turns_of, lambda t, phi: vibration.synchronous(t, phi, phi)):
        with pytest.raises(InputError, match=r"^t = 0 s: a whole turn takes no time"):
            function(np.zeros(len(PHI)), PHI)


def test_the_spectrum_of_rows_that_stand_twice_is_theirs():
    right = vibration.spectrum(T, Z.real)
    twice = vibration.spectrum(np.repeat(T, 2), np.repeat(Z.real, 2))
    assert np.array_equal(right, twice)
    with pytest.raises(vibration.TooFewRows, match="has 1 recorded rows; needed: at least 3"):
        vibration.spectrum(np.zeros(9), np.zeros(9))


def test_a_share_of_time_needs_two_rows():
    with pytest.raises(vibration.TooFewRows, match="has 1 recorded rows; needed: at least 2"):
        vibration.time_share(T[:1], PHI[:1], Z[:1])


@pytest.mark.parametrize("per_turn", [1, 2, 15])
@pytest.mark.parametrize("function", [vibration.whirl, vibration.displacement])
def test_samples_too_few_for_a_path_are_refused(function, per_turn):
    with pytest.raises(InputError, match=rf"^per_turn = {per_turn}: must be an integer, at least"):
        function(T, PHI, Z, per_turn=per_turn)
    assert np.allclose(vibration.whirl(T, PHI, Z, per_turn=16).order, 1.0, rtol=1e-3)


def test_resonances_of_a_speed_that_rises_and_falls_are_refused():
    speed, amplitude = (np.append(values, values[::-1]) for values in (PHI, PEAK))
    with pytest.raises(InputError, match=r"^speed: 0 to 100 rad/s, up and down; must go one way$"):
        vibration.resonances(speed, amplitude)


def test_a_transient_at_one_speed_is_no_resonance():
    """Such as of a rotor that is dropped at its speed, which is held: its factor was infinite."""
    t = np.linspace(0.0, 30.0, 301)
    amplitude = np.exp(-(((t - 10.0) / 2.0) ** 2))
    (found,) = vibration.resonances(np.minimum(300.0, 315.0 - t), amplitude, t=t)
    assert math.isnan(found.amplification)


@pytest.mark.parametrize(("back", "one_way"), [(5.0, True), (20.0, False)])
def test_a_speed_goes_one_way_though_it_goes_back_a_little(back, one_way):
    speed = np.append(np.linspace(0.0, 60.0, 999), [60.0 - back, 100.0])
    assert vibration.goes_one_way(speed) == vibration.goes_one_way(-speed) == one_way


@pytest.mark.parametrize("function", ["order_track", "cascade", "poincare", "whirl"])
def test_a_signal_of_too_few_turns_is_refused_with_its_length(function):
    t = np.linspace(0, 0.01, 50)
    with pytest.raises(vibration.TooFewTurns, match="holds 0 whole turns"):
        getattr(vibration, function)(t, 300.0 * t, t + 0j)


def test_contacts_and_powers_of_less_than_a_turn_are_refused():
    t = np.linspace(0, 0.01, 50)
    with pytest.raises(vibration.TooFewTurns, match="holds 0 whole turns"):
        vibration.contact(t, 300.0 * t, t, t)
    with pytest.raises(vibration.TooFewTurns, match="holds 0 whole turns"):
        vibration.power_by_sink(t, 300.0 * t, {"friction": t})


@pytest.mark.parametrize("turns", [0, True, 1.5, "4"])
@pytest.mark.parametrize(
    ("function", "more"),
    [
        ("order_track", ()),
        ("cascade", ()),
        ("whirl", ()),
        ("displacement", ()),
        ("orbit", (300.0,)),
        ("full_spectrum", (300.0,)),
    ],
)
def test_a_number_of_turns_that_cannot_be_is_refused_by_its_name(function, more, turns):
    t = np.linspace(0, 1, 5000)
    with pytest.raises(InputError, match=rf"^turns = {turns!r}: must be an integer, at least 1"):
        getattr(vibration, function)(t, 300.0 * t, t + 0j, *more, turns=turns)


def test_what_else_a_signal_cannot_be_asked_for_is_refused_by_its_name():
    t = np.linspace(0, 1, 5000)
    signal = t, 300.0 * t, t + 0j
    with pytest.raises(InputError, match=r"^lines = 0: must be"):
        vibration.cascade(*signal, lines=0)
    with pytest.raises(InputError, match=r"^orders: at least one"):
        vibration.order_track(*signal, [])
    with pytest.raises(InputError, match=r"^speed = nan rad/s: must be finite"):
        vibration.orbit(*signal, np.nan)
    with pytest.raises(InputError, match=r"^per_turn = 0: must be"):
        vibration.poincare(*signal, per_turn=0)
    with pytest.raises(InputError, match=r"^most_order = -1: must be"):
        vibration.cascade(*signal, most_order=-1)
    with pytest.raises(InputError, match=r"^least = 0: must be"):
        vibration.resonances(t, t, 0)
    with pytest.raises(InputError, match=r"^pieces = 0: must be"):
        vibration.time_share(*signal, pieces=0)
