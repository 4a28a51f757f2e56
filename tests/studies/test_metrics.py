"""What is kept of runs against integrals of our own: a Jeffcott rotor in ramps and at held speeds,
integrated by SciPy, whatever the communication step or the samples a turn are."""

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotor_fmu import studies
from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.machine_studies.metric import Metric
from rotor_fmu.machine_studies.run_excitation import Samples, Window
from rotor_fmu.machine_studies.run_metrics import KINDS
from rotor_fmu.studies.runner import run_study

from .functions import here, quiet

# of the example: 1 kg on 1e4 N/m and 20 N s/m, 0.5 g m of unbalance
K, C, UNBALANCE = 1e4, 20.0, 0.5e-3


def read(
    folder,
    run,
    metric,
    vary='"contact[1].mu" = { values = [0.0] }',
    tolerance=1e-3,
    is_verified=False,
):
    """A study of the example's rotor, its contact out of reach; run: KEY = VALUE by lines."""
    path = folder / "study.toml"
    path.write_text(
        f"verify = {str(is_verified).lower()}\n"
        'machine = "jeffcott_rub/jeffcott.toml"\n'
        f'[set]\n"solver.tolerance" = {tolerance}\n"contact[1].clearance" = 0.01\n'
        f"[run]\n{run}\n[vary]\n{vary}\n[keep]\n{metric}\n"
    )
    return read_study(path)


def row(folder, *study, **options):
    """The only run of a study."""
    run_study(read(folder, *study, **options), folder / "out", here, quiet)
    return studies.open(folder / "out").isel(run=0)


@lru_cache
def jeffcott(speed, rate, stop):
    """Times, speeds and x + i y of the rotor whose speed is `speed` + `rate` t, from rest."""

    def slope(t, y):
        w = speed + rate * t
        turned = np.exp(1j * (speed * t + rate * t**2 / 2))
        force = UNBALANCE * (w**2 - 1j * rate) * turned
        return [y[1], force - C * y[1] - K * y[0]]

    t = np.linspace(0, stop, int(stop * 5000) + 1)
    result = solve_ivp(slope, (0, stop), [0j, 0j], "DOP853", t_eval=t, rtol=1e-6, atol=1e-10)
    return t, speed + rate * t, result.y[0]


@pytest.mark.parametrize(("way", "step"), [(1, 0.5), (-1, 0.04)])
def test_quantities_of_a_ramp_are_those_of_the_motion_whatever_the_step(tmp_path, way, step):
    low, high = sorted((20 * way, 200 * way))
    data = row(
        tmp_path,
        f'kind = "run-up"\nfrom = {20 * way}\nto = {200 * way}\nrate = 20\nstep = {step}',
        f"""
peak = {{ peak = "disc.x" }}
late = {{ peak = "disc.r", after = 5 }}
never = {{ peak = "disc.r", after = 500 }}
rms = {{ rms = "disc.y" }}
mean = {{ mean = "disc.r" }}
whirl = {{ whirl = "disc" }}
end = {{ last = "disc.x" }}
passed = {{ value = "disc.r", speed = {130 * way} }}
curve = {{ amplitude = "disc.r", bins = {{ from = {low}, to = {high}, count = 18 }} }}
once = {{ order = 1, speed = {130 * way}, of = "disc.x" }}
twice = {{ order = 2, speed = {130 * way}, of = "disc.x" }}
""",
        tolerance=1e-4,
    )
    t, w, z = jeffcott(20.0, 20.0, 9.0)
    w, z = way * w, z if way > 0 else z.conj()  # backward is forward seen from behind
    r = np.abs(z)
    within = {"rel": 2e-3}
    assert float(data.peak) == pytest.approx(np.abs(z.real).max(), **within)
    assert float(data.late) == pytest.approx(r[t >= 5].max(), **within)
    assert math.isnan(float(data.never))
    assert float(data.rms) == pytest.approx(math.sqrt(np.trapezoid(z.imag**2, t) / 9), **within)
    assert float(data["mean"]) == pytest.approx(np.trapezoid(r, t) / 9, **within)
    turned = np.unwrap(np.angle(z[1:]))
    assert float(data.whirl) == pytest.approx((turned[-1] - turned[0]) / 9, rel=0.01)
    assert np.sign(float(data.whirl)) == way
    assert float(data.end) == pytest.approx(z.real[-1], abs=5e-3 * r.max())
    assert float(data.passed) == pytest.approx(np.interp(5.5, t, r), rel=5e-3)
    edges = np.linspace(20, 200, 19)
    right = [r[(np.abs(w) >= a) & (np.abs(w) <= b)].max() for a, b in pairwise(edges)]
    assert data.curve.values[::way] == pytest.approx(right, abs=2e-3 * r.max())
    # the resonance is passed slowly: 1x is the radius
    assert float(data.once) == pytest.approx(np.interp(5.5, t, r), rel=0.02)
    assert float(data.twice) < 0.02 * float(data.once)


TURNS = ((80.0, 4), (-80.0, 8), (80.0, 32))  # and each the other way with the slow tests


@pytest.mark.parametrize(
    ("speed", "per_turn"),
    [*TURNS, *(pytest.param(-speed, n, marks=pytest.mark.slow) for speed, n in TURNS)],
)
def test_quantities_over_whole_turns_are_those_of_the_circle(tmp_path, speed, per_turn):
    """rms and mean integrate every interval of the turns; backward is forward seen from behind."""
    data = row(
        tmp_path,
        f'kind = "constant"\nspeed = {speed}\nsettle = 2\nturns = 4\nper_turn = {per_turn}',
        """
rms = { rms = "disc.x" }
mean = { mean = "disc.x" }
radius = { mean = "disc.r" }
peak = { peak = "disc.y" }
whirl = { whirl = "disc" }
once = { order = 1, of = "disc.y" }
lines = { spectrum = "disc", orders = 1.5 }
mark = { poincare = "disc.x" }
""",
        tolerance=1e-5,
    )
    vector = UNBALANCE * speed**2 / (K - speed**2 + 1j * C * speed)
    radius = abs(vector)
    assert float(data.rms) == pytest.approx(radius / math.sqrt(2), rel=2e-3)
    assert abs(float(data["mean"])) < 2e-3 * radius
    assert float(data.radius) == pytest.approx(radius, rel=2e-3)
    assert float(data.peak) == pytest.approx(radius, rel=5e-3)
    assert float(data.whirl) == pytest.approx(speed, rel=1e-3)
    assert float(data.once) == pytest.approx(radius, rel=2e-3)
    orders = data["lines order"].values
    assert orders[int(np.argmax(data.lines.values))] == 1.0
    assert data.lines.values.max() == pytest.approx(radius, rel=2e-3)
    # at the mark the shaft's angle is 0
    assert data.mark.values == pytest.approx(vector.real, abs=5e-3 * radius)


def test_speeds_are_held_on_both_sides_of_standstill(tmp_path):
    data = row(
        tmp_path,
        'kind = "steps"\nfrom = -80\nto = 80\ncount = 4\nsettle = 1\nturns = 2',
        'radius = { mean = "disc.r" }\nwhirl = { whirl = "disc" }',
        tolerance=1e-5,
    )
    held = data["held speed"].values
    right = np.abs(UNBALANCE * held**2 / (K - held**2 + 1j * C * held))
    assert data.radius.values == pytest.approx(right, rel=5e-3)
    assert data.whirl.values == pytest.approx(held, rel=5e-3)


def test_the_speed_of_a_run_up_and_down_does_not_jump_at_its_top(tmp_path):
    """The top lies between two communication steps; before, it was overshot and fell back."""
    study = (
        'kind = "up-and-down"\nfrom = 50\nto = 61\nrate = 20\nstep = 0.1',
        'fastest = { peak = "w" }\nturned = { last = "phi" }',
    )
    seen = read(tmp_path, *study).model.record({})
    assert seen.columns["w"] == pytest.approx(61 - 20 * np.abs(seen.t - 0.55), abs=1e-9)
    data = row(tmp_path, *study)
    assert float(data.fastest) == pytest.approx(61.0, abs=1e-9)
    assert float(data.turned) == pytest.approx(1.1 * (50 + 61) / 2)


def test_a_selected_run_holds_what_lies_between_the_speeds_held(tmp_path):
    run = 'kind = "steps"\nfrom = 30\nto = 40\ncount = 2\nsettle = 1\nturns = 2'
    seen = read(tmp_path, run, 'radius = { mean = "disc.r" }').model.record({})
    assert np.diff(seen.t).max() < 0.1
    assert np.diff(seen.t).min() > 0
    turned = np.trapezoid(seen.columns["w"], seen.t)
    assert seen.columns["phi"][-1] == pytest.approx(turned, rel=1e-3)


def test_a_run_that_fails_is_recorded_as_far_as_it_came(tmp_path):
    kick = '{ port = "disc", force = 1e6, rate = 0, duration = 0.5 }'
    path = tmp_path / "study.toml"
    path.write_text(
        'machine = "studies/whip.toml"\n[run]\nkind = "constant"\nspeed = 10\nturns = 1\n'
        f'kick = {kick}\n[vary]\n"contact[1].mu" = {{ values = [0.0] }}\n'
        '[keep]\nradius = { mean = "disc.r" }\n'
    )
    model = read_study(path).model
    status = model.run({}).status
    assert status.startswith("failed: ")
    seen = model.record({})
    assert seen.about["status"] == status
    assert len(seen.t) > 5
    assert np.abs(seen.columns["disc.x"]).max() > 1e-3


@pytest.mark.parametrize(
    ("run", "metric", "expected"),
    [
        ("speed = 0", '{ mean = "disc.r" }', "run.speed = 0 rad/s: held speeds must not be 0"),
        ("speed = 5\nper_turn = 2", '{ order = 1, of = "disc.x" }', "half of run.per_turn = 2"),
        ("speed = 5\nper_turn = 16", '{ order = 15, of = "disc.x" }', "half of run.per_turn = 16"),
        ("speed = 5\nper_turn = 16", '{ order = 8, of = "disc.x" }', "half of run.per_turn = 16"),
        (
            "speed = 5",
            '{ order = 1, speed = 3, of = "disc.x" }',
            "order with speed needs runs whose",
        ),
        ("speed = 5", '{ order = 0, of = "disc.x" }', "order = 0: must be > 0"),
    ],
)
def test_what_a_held_speed_cannot_tell_is_refused(tmp_path, run, metric, expected):
    with pytest.raises(InputError, match=expected):
        read(tmp_path, f'kind = "constant"\n{run}\nturns = 10', f"q = {metric}")


def test_samples_that_are_varied_are_checked_against_the_orders_too(tmp_path):
    run = 'kind = "constant"\nspeed = 50\nturns = 10'
    metric = 'q = { order = 0.7, of = "disc.x" }\np = { order = 3, of = "disc.x" }'
    with pytest.raises(InputError, match=r"keep p: order = 3: .* half of run\.per_turn = 6"):
        read(tmp_path, run, metric, '"run.per_turn" = { values = [32, 6] }')
    read(tmp_path, run, metric, '"run.per_turn" = { values = [32, 7] }')


@pytest.mark.parametrize(("orders", "highest"), [(2.6, 2.5), (15.9, 15.75), (0.3, 0.25), (3, 3)])
def test_a_spectrum_ends_at_the_highest_order_asked_for(tmp_path, orders, highest):
    keep = f'q = {{ spectrum = "disc", orders = {orders} }}'
    (column,) = read(tmp_path, 'kind = "constant"\nspeed = 50\nturns = 4', keep).model.columns
    assert column.coordinate[-1] == -column.coordinate[0] == highest


def test_a_jump_needs_two_speeds(tmp_path):
    run = 'kind = "steps"\nfrom = 100\nto = 100\ncount = 1'
    with pytest.raises(InputError, match="keep q: jump needs runs in steps of the speed, two at"):
        read(tmp_path, run, 'q = { jump = "disc.r", way = "up" }')


def test_speeds_beyond_what_memory_holds_are_refused(tmp_path):
    run = 'kind = "steps"\nfrom = 100\nto = 200\ncount = 1000000000000'
    with pytest.raises(
        InputError, match=r"run.count = 1e\+12: must be an integer, at most 1000000"
    ):
        read(tmp_path, run, 'q = { mean = "disc.r" }')


@pytest.mark.parametrize("measure", [0.002, 0.0505])
def test_the_time_evaluated_is_the_one_asked_for_whatever_the_step(tmp_path, measure):
    run = f'kind = "constant"\nspeed = 50\nsettle = 0.1\nmeasure = {measure}\nstep = 0.01'
    seen = read(tmp_path, run, 'x = { last = "disc.x" }').model.record({})
    assert seen.t[-1] == pytest.approx(0.1 + measure)


def test_the_speed_at_which_a_run_ends_is_passed(tmp_path):
    """Here the last speed is short of it by rounding."""
    run = 'kind = "run-up"\nfrom = -20\nto = -100\nrate = 33\nstep = 0.05'
    data = row(tmp_path, run, 'x = { value = "disc.x", speed = -100 }\nlast = { last = "disc.x" }')
    assert float(data.x) == pytest.approx(float(data["last"]))


def test_what_is_taken_after_the_end_of_a_run_is_nan(tmp_path):
    kept = [f'{kind} = {{ {kind} = "disc.r", after = 9 }}' for kind in ("peak", "rms", "mean")]
    contact = 'contact = { contact = "contact[1]", after = 9 }'
    data = row(tmp_path, 'kind = "constant"\nspeed = 50\nturns = 1', "\n".join([*kept, contact]))
    assert all(np.isnan(data[name]) for name in ("peak", "rms", "mean", "contact"))


HELD = 'kind = "constant"\nspeed = 60\nsettle = 2\nturns = 4'
CRITICAL = 'kind = "constant"\nspeed = 100\nsettle = 2\nturns = 4'  # x lags by a quarter turn
RAMP = 'kind = "run-up"\nfrom = 20\nto = 49.7962\nrate = 20'  # at its end the disc passes x = 0


@pytest.mark.parametrize(
    ("run", "metric"),
    [
        (HELD, "mean = 'disc.x'"),
        (HELD, "order = 2, of = 'disc.x'"),
        (CRITICAL, "poincare = 'disc.x'"),
        (RAMP, "last = 'disc.x'"),
        (RAMP, "value = 'disc.x', speed = 39.98273"),
        (RAMP, "order = 10, speed = 40, of = 'disc.x'"),
    ],
)
def test_what_may_be_0_is_confirmed_relative_to_the_motion(tmp_path, run, metric):
    kept = f"q = {{ {metric} }}\nsize = {{ rms = 'disc.x' }}"
    data = row(tmp_path, run, kept, is_verified=True)
    assert np.abs(data.q).max() < 0.01 * data["size"]
    assert data.status == "ok"


def test_the_mean_of_a_motion_that_is_none_is_confirmed_as_its_peak_is():
    at_rest = Window(
        Samples(np.arange(3.0), {"disc.x": np.zeros(3)}), Samples(np.zeros(0), {}), 0, 0
    )
    for kind in ("mean", "peak"):
        assert Metric("q", KINDS[kind], "disc.x").least_size([at_rest], "m", 1e-9) == 1e-9


@pytest.mark.parametrize(
    ("kind", "options", "expected"),
    [
        ("value", {"speed": 1.5}, -20.0),
        ("value", {"speed": 3.0}, 0.0),  # at which the run begins, and stays for a step
        ("value", {"speed": 9.0}, math.nan),
        ("amplitude", {"bins": {"from": 1.0, "to": 3.0, "count": 2}}, [30.0, 10.0]),
        ("amplitude", {"bins": {"from": 2.5, "to": 3.0, "count": 1}}, [5.0]),  # with both its ends
        ("amplitude", {"bins": {"from": 3.5, "to": 4.5, "count": 2}}, [math.nan, math.nan]),
        ("peak", {"after": 9.0}, math.nan),
        ("mean", {"after": 3.0}, math.nan),
    ],
)
def test_metrics_of_a_speed_end_with_the_speeds_that_were_passed(kind, options, expected):
    columns = {"x": [0.0, 5.0, -10.0, -30.0], "w": [3.0, 3.0, 2.0, 1.0], "phi": [0, 3, 5, 6.5]}
    steps = Samples(np.arange(4.0), {name: np.array(of) for name, of in columns.items()})
    metric = Metric("q", KINDS[kind], "x", tuple(options.items()))
    made = KINDS[kind].make(metric, Window(steps, steps, math.nan, 0))
    assert made == pytest.approx(expected, nan_ok=True)


def test_the_coordinates_of_bins_are_their_middles():
    bins = {"from": 1.0, "to": 3.0, "count": 2}
    metric = Metric("q", KINDS["amplitude"], "x", (("bins", bins),))
    assert metric.kind.axis(metric, None) == ("q speed", (1.5, 2.5), "rad/s")


@pytest.mark.parametrize("speed", [50.0, -50.0])
def test_a_spectrum_has_no_mean_and_keeps_forward_ahead(speed):
    turned = math.copysign(1.0, speed) * math.tau * np.arange(16) / 8
    z = 3.0 - 4.0j + 2.0 * np.exp(1j * turned) + np.exp(-1j * turned)
    turns = Samples(np.arange(16.0), {"disc.x": z.real, "disc.y": z.imag})
    metric = Metric("q", KINDS["spectrum"], "disc", (("orders", 1.0),))
    found = metric.kind.make(metric, Window(turns, turns, speed, 8))
    assert found == pytest.approx([1.0, 0.0, 0.0, 0.0, 2.0], abs=1e-12)


@pytest.mark.parametrize("order", [0, -1, 0.3, 0.25, 40])
def test_an_order_that_cannot_be_passed_is_refused_before_the_first_run(tmp_path, order):
    metric = f'q = {{ order = {order}, speed = 100, of = "disc.x" }}'
    with pytest.raises(InputError, match=f"order = {order}: must be a multiple of 0.5 from 0.5"):
        read(tmp_path, 'kind = "run-up"', metric)


def test_a_communication_step_that_holds_more_than_is_recorded_is_a_failed_row(tmp_path):
    run = 'kind = "run-up"\nfrom = 100\nto = 180\nrate = 1\nstep = 80'
    status = str(row(tmp_path, run, 'q = { peak = "disc.x" }').status.values)
    assert "more than 16384 steps of the solver in a communication step" in status
