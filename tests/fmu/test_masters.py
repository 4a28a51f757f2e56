"""Whatever master drives the FMU: communication steps of any length, start times, speeds, jumps."""

import fmpy
import numpy as np
import pytest


def simulate(fmu, stop, step, speed, start=0.0, **parameters):
    """Disc 3 and the angle at the communication points; speed: pairs of time and value."""
    loads = [f"disc[{i}].f{axis}" for i in (1, 2, 3) for axis in "xy"]
    names = ["time", "speed", *loads, "coupling.fx", "coupling.fy"]
    rows = [(*pair, *(0.0 for _ in names[2:])) for pair in speed]
    signal = np.array(rows, dtype=[(name, float) for name in names])
    return fmpy.simulate_fmu(
        str(fmu),
        start_time=start,
        stop_time=stop,
        output_interval=step,
        input=signal,
        start_values={name.replace("__", "."): value for name, value in parameters.items()},
        output=["disc[3].x", "disc[3].y", "phi", "w", "bearing[1].contact", "energy.residual"],
    )


FIXED = 1


@pytest.fixture(scope="module")
def reference(fmu):
    return simulate(fmu, 0.7, 0.05, [(0, 200.0)], solver__adaptive=FIXED, solver__h=1e-4)


@pytest.mark.parametrize(
    "step", [pytest.param(2e-4, marks=pytest.mark.slow), 1e-3, 7e-3, 0.02, 0.1]
)
def test_at_constant_speed_the_communication_step_does_not_matter(fmu, reference, step):
    result = simulate(fmu, 0.7, step, [(0, 200.0)], solver__adaptive=FIXED, solver__h=1e-4)
    assert result["time"][-1] == pytest.approx(0.7)
    for axis in "xy":
        name = f"disc[3].{axis}"
        assert result[name][-1] == pytest.approx(reference[name][-1], abs=1e-9)


@pytest.mark.parametrize("step", [pytest.param(1e-5, marks=pytest.mark.slow), 4e-5])
def test_a_communication_step_below_the_solvers_is_a_solver_step_that_short(fmu, step):
    """So what it changes is the solver's own error, which it makes smaller."""
    fixed = {"solver__adaptive": 1}
    cut = simulate(fmu, 0.2, step, [(0, 200.0)], solver__h=1e-4, **fixed)
    short = simulate(fmu, 0.2, 0.05, [(0, 200.0)], solver__h=step, **fixed)
    coarse = simulate(fmu, 0.2, 0.05, [(0, 200.0)], solver__h=1e-4, **fixed)
    for axis in "xy":
        name = f"disc[3].{axis}"
        assert cut[name][-1] == pytest.approx(short[name][-1], abs=1e-10)
        assert cut[name][-1] == pytest.approx(coarse[name][-1], abs=1e-6)
        assert cut[name][-1] != pytest.approx(coarse[name][-1], abs=1e-10)


def test_unequal_steps_are_followed_exactly_in_angle(fmu):
    folder = fmpy.extract(str(fmu))
    description = fmpy.read_model_description(folder)
    refs = {v.name: v.valueReference for v in description.modelVariables}
    instance = fmpy.instantiate_fmu(folder, description, "CoSimulation")
    instance.setupExperiment(startTime=0.0)
    instance.setReal([refs["speed_rate"]], [-10.0])
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    t = 0.0
    for step in (1e-5, 0.1, 3e-4, 0.02, 1e-5, 0.05):
        instance.setReal([refs["speed"]], [400 - 10 * t])
        instance.doStep(t, step)
        t += step
    assert instance.getReal([refs["phi"]])[0] == pytest.approx(400 * t - 5 * t**2, rel=1e-12)
    instance.terminate()
    instance.freeInstance()


def test_a_later_start_time_gives_the_same_motion(fmu):
    """With steps that do not hang on the rounding of the time, as those of error control do."""
    fixed = {"solver__adaptive": FIXED, "solver__h": 1e-4}
    now = simulate(fmu, 0.4, 0.02, [(0, 250.0)], **fixed)
    later = simulate(fmu, 7.4, 0.02, [(0, 250.0)], start=7.0, **fixed)
    assert later["time"][0] == 7.0
    np.testing.assert_allclose(later["phi"], now["phi"], rtol=1e-9)
    np.testing.assert_allclose(later["disc[3].y"], now["disc[3].y"], atol=1e-8)


def test_the_speed_may_pass_through_zero(fmu):
    result = simulate(fmu, 2.0, 0.01, [(0, 50.0), (2, -50.0)], speed_rate=-50.0)
    assert result["w"][-1] == pytest.approx(-50.0)
    assert result["phi"][-1] == pytest.approx(0.0, abs=1e-9)
    assert np.isfinite(result["disc[3].y"]).all()
    # the start, when friction sets in at once, is behind by then
    after_start = result["energy.residual"][10:]
    assert np.ptp(after_start) < 1e-4


def test_turning_backwards_is_the_mirror_image(fmu):
    forward = simulate(fmu, 0.3, 0.01, [(0, 200.0)])
    # mirrored at the vertical: phase 0 points to the right, so it becomes pi
    phases = {f"disc[{i}].phase": np.pi for i in (1, 2, 3)}
    backward = simulate(fmu, 0.3, 0.01, [(0, -200.0)], **phases)
    np.testing.assert_allclose(backward["disc[3].x"], -forward["disc[3].x"], atol=1e-9)
    np.testing.assert_allclose(backward["disc[3].y"], forward["disc[3].y"], atol=1e-9)


def test_a_jumping_speed_is_held_where_asked(fmu):
    jump = [(0, 300.0), (0.5, 300.0), (0.5, 200.0), (1.0, 200.0)]
    held = simulate(fmu, 1.0, 0.05, jump, speed_continuation=1)
    assert set(np.round(held["w"], 9)) == {300.0, 200.0}
    assert held["phi"][-1] == pytest.approx(0.5 * 300 + 0.5 * 200)
    linear = simulate(fmu, 1.0, 0.05, jump)
    assert linear["w"].min() == pytest.approx(100.0)  # continues the jump for one step


def test_the_tolerance_of_the_experiment_is_that_of_the_solver(fmu):
    def steps(tolerance, **parameters):
        result = fmpy.simulate_fmu(
            str(fmu),
            stop_time=0.5,
            output_interval=0.1,
            relative_tolerance=tolerance,
            start_values={name.replace("__", "."): value for name, value in parameters.items()},
            output=["solver.steps"],
        )
        return result["solver.steps"][-1]

    coarse, fine = steps(1e-2), steps(1e-4)
    assert fine > 5 * coarse
    assert steps(1e-2, solver__tolerance=1e-4) == fine
    assert steps(1e-2, solver__preset=0) == steps(1e-4, solver__preset=0)  # robust: fixed steps
