"""Designs of a study: values drawn by law, and the points of a grid."""

from statistics import NormalDist

import numpy as np
import pytest

from rotor_fmu.errors import InputError
from rotor_fmu.studies.design import Axis, Design, Distribution, axis_of

LAWS = {
    "uniform": ({"low": 2.0, "high": 4.0}, 3.0),
    "log-uniform": ({"low": 1.0, "high": 100.0}, 10.0),
    "normal": ({"mean": 3.0, "std": 0.5}, 3.0),
    "truncated-normal": ({"mean": 3.0, "std": 0.5, "low": 2.0, "high": 4.0}, 3.0),
}


@pytest.mark.parametrize("kind", ["random", "latin-hypercube", "sobol", "saltelli"])
@pytest.mark.parametrize("law", LAWS)
def test_every_design_draws_every_distribution_about_its_median(kind, law):
    parameters, median = LAWS[law]
    axes = tuple(Axis(n, (n,), distribution=Distribution(law, parameters)) for n in "ab")
    design = Design(axes, kind, 256, 7)
    drawn = np.array([list(design.point(i).values()) for i in range(len(design))])
    below = (drawn < median).mean(axis=0)
    assert below == pytest.approx([0.5, 0.5], abs=0.07 if kind == "random" else 0.02)
    assert drawn.min() >= parameters.get("low", -np.inf)
    assert drawn.max() <= parameters.get("high", np.inf)
    again = Design(axes, kind, 256, 7)
    assert again.identity == design.identity != Design(axes, kind, 256, 8).identity


@pytest.mark.parametrize("law", ["uniform", "log-uniform", "truncated-normal"])
def test_the_ends_of_a_distribution_are_not_passed(law):
    for low, high in ((0.1, 0.3), (0.01, 1.0), (0.7, 0.9), (3e-5, 7e-5)):
        parameters = {"low": low, "high": high} | (
            {"mean": 0.2, "std": 0.37} if law == "truncated-normal" else {}
        )
        ends = Distribution(law, parameters).at(np.array([0.0, 1.0]))
        assert ends == pytest.approx([low, high])
        assert low <= ends[0]
        assert ends[1] <= high


@pytest.mark.filterwarnings("error")
def test_a_base_sample_of_any_size_is_the_beginning_of_a_larger_one():
    axes = tuple(
        Axis(n, (n,), distribution=Distribution("uniform", {"low": 0.0, "high": 1.0})) for n in "ab"
    )
    few, more = (Design(axes, "saltelli", size, 7).sample for size in (5, 8))
    assert len(few) == 5 * 4
    assert (few == more[: 5 * 4]).all()


def test_a_normal_distribution_has_its_standard_deviation():
    law = Distribution("normal", {"mean": 3.0, "std": 0.5})
    # of a normal distribution 84.134474606854 % lie below one standard deviation
    assert law.at(np.array([0.84134474606854]))[0] == pytest.approx(3.5)


def test_a_truncated_normal_distribution_has_the_shares_within_its_ends():
    law, plain = {"mean": 3.0, "std": 0.5, "low": 2.5, "high": 4.0}, NormalDist(3.0, 0.5)
    u = np.array([0.1, 0.5, 0.9])
    low, high = plain.cdf(2.5), plain.cdf(4.0)
    expected = [plain.inv_cdf(low + share * (high - low)) for share in u]
    assert Distribution("truncated-normal", law).at(u) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("spacing", "values"), [("linear", (1.0, 50.5, 100.0)), ("log", (1.0, 10.0, 100.0))]
)
def test_a_grid_is_evenly_spaced_in_its_values_or_their_logarithms(spacing, values):
    grid = {"from": 1, "to": 100, "count": 3, "spacing": spacing}
    assert axis_of("a", ["a"], {"grid": grid}).values == pytest.approx(values)


def test_samples_are_taken_at_every_point_of_a_grid():
    drawn = Axis("a", ("a",), distribution=Distribution("uniform", {"low": 0.0, "high": 1.0}))
    design = Design((Axis("n", ("n",), (1.0, 2.0, 3.0)), drawn), "latin-hypercube", 4)
    points = [design.point(i) for i in range(len(design))]
    assert len(points) == 12
    assert [p["n"] for p in points[:4]] == [1.0, 2.0, 3.0, 1.0]
    assert points[0]["a"] == points[2]["a"] != points[3]["a"]


def test_morris_refuses_a_distribution_without_ends():
    axis = Axis("a", ("a",), distribution=Distribution("normal", {"mean": 0.0, "std": 1.0}))
    with pytest.raises(InputError, match="vary a: is normal; morris reaches the ends"):
        Design((axis,), "morris", 4)
