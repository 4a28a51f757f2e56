"""The figures of paper A, drawn again from what was run again."""

from pathlib import Path

from matplotlib.figure import Figure

from rotor_fmu.plotting.colors import ORANGE
from rotor_fmu.plotting.figure_style import legend_below, new_figure, save
from rotor_fmu.run_pictures import run_folder
from rotor_fmu.run_pictures.signal_plots import orbit
from rotor_fmu.run_pictures.view import View
from rotor_fmu.runs.run_down import Run

from .reproduce import PLACE, Result


def write_figures(results: list[Result], out: Path) -> list[Path]:
    """Write the paper's figures 3 to 6 and 9 to 15, its runs with the converged one behind, and the
    default run with the paper's behind; return their paths."""
    by_name = {result.case.name: result for result in results}
    fixed, damped, adaptive, default, converged = (
        by_name[name] for name in ("paper", "damped", "adaptive", "controlled", "converged")
    )
    coarse = "steps of 4 ms, generalized-alpha 0.1 / 0.08"
    lower = "steps of 4 ms, generalized-alpha 0.15 / 0.1"
    variable = "steps of 4 to 20 ms, generalized-alpha 0.1 / 0.08"
    truth = converged.run, "converged, steps of 0.1 ms"
    pictures = {
        "run_down": compared_amplitude(
            "The test rig runs down from 64 Hz in 40 s",
            "x",
            (default.run, "this FMU's default"),
            (fixed.run, "paper A's integrator, 4 ms"),
        ),
        "figure_14_error": run_folder.error_indicator(
            adaptive.steps, "Paper A, Fig. 14: error indicator of Zienkiewicz and Xie"
        ),
        "figure_15_h": run_folder.step_length(adaptive.steps, "Paper A, Fig. 15: step length"),
    }
    for number, axis, result, text in (
        ("03", "x", fixed, coarse),
        ("04", "y", fixed, coarse),
        ("09", "x", damped, lower),
        ("10", "y", damped, lower),
        ("11", "x", adaptive, variable),
        ("12", "y", adaptive, variable),
    ):
        caption = f"Paper A, Fig. {int(number)}: {text}"
        pictures[f"figure_{number}_{axis}"] = compared_amplitude(
            caption, axis, (result.run, "the paper's run"), truth
        )
    for key, result, caption in (
        ("figure_05_psi", fixed, f"Paper A, Fig. 5: {coarse}"),
        ("figure_13_psi", adaptive, f"Paper A, Fig. 13: {variable}"),
        ("converged_psi", converged, "Where the journal lies: converged, steps of 0.1 ms"),
    ):
        pictures[key] = run_folder.journal_angle(result.steps, caption)
    for key, result, text in (
        ("figure_06_orbit", fixed, "Paper A, Fig. 6"),
        ("converged_orbit", converged, "Converged, steps of 0.1 ms"),
    ):
        at_s, at_hz = result.figures["x_peak_s"], result.figures["x_peak_hz"]
        view = View(result.steps, PLACE, time=at_s, heading=text)
        pictures[key] = orbit(view, f"orbit at the horizontal peak, {at_hz:.1f} Hz")
    return [save(figure, out / f"{name}.png") for name, figure in pictures.items()]


def compared_amplitude(
    caption: str, axis: str, run: tuple[Run, str], other: tuple[Run, str]
) -> Figure:
    """Draw the amplitude of a run over its speed with another run's thinner behind; each with its
    name."""
    figure, axes = new_figure()
    run_folder.draw_distance(axes, other[0], PLACE, axis, other[1], ORANGE, 0.8, False)
    run_folder.draw_distance(axes, run[0], PLACE, axis, run[1])
    run_folder.distance_axes(axes, run[0], PLACE, axis)
    legend_below(figure, 2)
    axes.set_title(caption, loc="left", fontsize=10)
    return figure
