"""What the page of integrators says of work and precision follows from the rows."""

import pytest

from papers.integrators.order_five import METHODS, Row, cost, in_words, ratio, rows, table


def curve(machine, method, order, factor):
    """Rows whose error is (factor / CPU time)^order."""
    return [
        Row(machine, method, 10.0**-i, 10.0**-i, factor * 10.0 ** (i / order), 100)
        for i in range(1, 8)
    ]


def test_the_ratio_of_two_power_laws_is_their_quotient():
    both = [*curve("a", METHODS[0], 2, 1.0), *curve("a", METHODS[1], 5, 3.0)]
    for error in (1e-3, 3e-5):
        assert ratio(both, "a", error) == pytest.approx(3.0 * error ** (1 / 2 - 1 / 5))
    assert table(both)[0][0] == "a"
    assert in_words(both)["five_from"] == "1e-2"
    # 3 10^(2/5) < 10^(2/2), and 4 10^(2/5) is not
    dear = [*curve("a", METHODS[0], 2, 1.0), *curve("a", METHODS[1], 5, 4.0)]
    assert in_words(dear)["five_from"] == "1e-3"


def test_beyond_its_ends_a_curve_costs_its_least_or_is_not_there():
    points = curve("a", METHODS[0], 2, 1.0)
    assert cost(points, 0.5) == points[0].cpu
    assert cost(points, 1e-9) is None
    # a point that costs more and is worse counts for nothing
    worse = Row("a", METHODS[0], 1e-3, 0.5, 30.0, 100)
    assert cost([*points, worse], 1e-4) == cost(points, 1e-4)


def test_the_rows_that_were_kept_show_both_methods_on_five_machines():
    kept = rows()
    assert len({row.machine for row in kept}) == 5
    assert {row.method for row in kept} == set(METHODS)
