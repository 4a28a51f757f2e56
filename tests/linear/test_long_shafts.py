"""Shafts of many elements: sparse matrices give what dense ones do, and pictures can be read."""

from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import product, to_band, to_dense
from rotor_fmu.model.linear import critical_map, undamped
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.structure import assembly, lowest_frequency, reduction, sparse_modes

from rotor_fmu.linear.answers import modes
from rotor_fmu.linear.linear_plots import dotted
from rotor_fmu.linear.mode_answers import shapes_for_page
from rotor_fmu.plotting.machine_drawing import machine_figure

SHAFT = "gravity = 9.81\n[material]\nyoung = 2.1e11\ndensity = 7800.0\n[shaft]\neta_v = 1e-5\n"
BEARING = "[[linear_bearing]]\nnode = {}\nkxx = 1e7\nkyy = 1e7\ncxx = 100.0\ncyy = 100.0\n"
CONTACT = (
    "[[contact]]\nnode = {}\njournal_radius = 0.01\nclearance = 1e-4\nmu = 0.1\nk = 1e7\nc = 10.0\n"
)


def shaft(count, *parts):
    """A shaft of 1 m of so many elements with a disc and these parts."""
    sections = f"[[section]]\nlength = {1 / count!r}\nouter = 0.02\n" * count
    disc = f"[[disc]]\nnode = {count // 3}\ndiameter = 0.15\nwidth = 0.02\ne = 1e-5\n"
    return parse_rotor(SHAFT + sections + disc + "".join(parts))


HELD = {
    "soft": [BEARING.format(1), BEARING.format(40)],
    "pinned": [CONTACT.format(1), CONTACT.format(40)],
    "free": [CONTACT.format(20)],
}


@pytest.fixture
def sparse_from_ten(monkeypatch):
    """Every shaft counts as long."""
    for module in (lowest_frequency, reduction):
        monkeypatch.setattr(module, "LONG", 10)


@pytest.mark.parametrize("held", HELD)
def test_the_lowest_frequency_is_that_of_dense_matrices(held, sparse_from_ten, monkeypatch):
    rotor = shaft(40, *HELD[held])
    by_sparse = assembly.assemble(rotor).numbers[0].lowest_omega
    monkeypatch.setattr(lowest_frequency, "LONG", sparse_modes.LONG)
    by_dense = assembly.assemble(rotor).numbers[0].lowest_omega
    assert by_sparse == pytest.approx(by_dense, rel=1e-6)


@pytest.mark.usefixtures("sparse_from_ten")
def test_component_modes_span_what_those_of_dense_matrices_do(monkeypatch):
    structure = assembly.assemble(shaft(40, *HELD["pinned"]))
    retained, basis = reduction.component_modes(structure, 8)
    monkeypatch.setattr(reduction, "LONG", sparse_modes.LONG)
    same, expected = reduction.component_modes(structure, 8)
    assert np.array_equal(retained, same)
    apart = basis - expected @ np.linalg.lstsq(expected, basis, rcond=None)[0]
    assert np.abs(apart).max() < 1e-6 * np.abs(basis).max()


@pytest.mark.parametrize("columns", [(), (3,)])
def test_a_band_matrix_times_vectors_is_the_dense_product(columns):
    rng = np.random.default_rng(1)
    dense = rng.normal(size=(9, 9))
    dense = to_dense(to_band(dense + dense.T, 3))
    x = rng.normal(size=(9, *columns))
    np.testing.assert_allclose(product(to_band(dense, 3), x), dense @ x, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(sparse_modes.sparse(to_band(dense, 3)).toarray(), dense)


def test_six_hundred_elements_have_the_frequency_of_forty():
    """They converge to the same shaft."""
    coarse, fine = (
        assembly.assemble(shaft(count, BEARING.format(1), BEARING.format(count + 1)))
        for count in (60, 600)
    )
    near = fine.numbers[0].lowest_omega
    assert near == pytest.approx(coarse.numbers[0].lowest_omega, rel=0.02)


def in_housings(ky):
    """A shaft with a bearing in a housing, and a housing that nothing shakes."""
    housing = f"[[housing]]\nname = '{{}}'\nmass = 2.0\nkx = 1e6\nky = {ky}\ncx = 0.0\ncy = 0.0\n"
    on = [BEARING.format(1) + "housing = 'a'\n", BEARING.format(41)]
    return shaft(40, *on, housing.format("a"), housing.format("alone"))


def with_thin_discs():
    """A train of five discs, whose gyroscopic moments outweigh their inertia, on six bearings."""
    disc = "[[body]]\nnode = {}\nmass = 400.0\nI_p = 10.0\nI_d = 6.0\n"
    shaft = SHAFT + "[[section]]\nlength = 3.0\nelements = 200\nouter = 0.2\n"
    discs = [disc.format(21 + 40 * i) for i in range(5)]
    return parse_rotor("".join([shaft, *discs, *(BEARING.format(1 + 40 * i) for i in range(6))]))


@pytest.mark.parametrize("synchronous", [True, False])
@pytest.mark.parametrize(
    ("rotor", "count"), [(in_housings(1e6), 1), (in_housings(2e6), 1), (with_thin_discs(), 4)]
)
def test_the_critical_speed_map_is_that_of_dense_eigenvalues(
    rotor, count, synchronous, monkeypatch
):
    """Though only the lowest are computed; what moves alone has no critical speed."""
    stiffness = np.array([1e6, 2e6])
    monkeypatch.setattr(undamped, "_DENSE", 1000)
    by_dense = critical_map(rotor, stiffness, count=count, synchronous=synchronous)
    monkeypatch.setattr(undamped, "_DENSE", 10)
    monkeypatch.setattr(undamped, "_solve", None)  # which computes all
    by_sparse = critical_map(rotor, stiffness, count=count, synchronous=synchronous)
    np.testing.assert_allclose(by_sparse.speeds, by_dense.speeds, rtol=1e-9)
    assert by_sparse.rigid == pytest.approx(by_dense.rigid, rel=1e-9)


def test_whether_modes_are_circles_is_seen_by_sparse_matrices(monkeypatch):
    monkeypatch.setattr(undamped, "_DENSE", 10)
    alike, unlike = (undamped.UndampedMachine(in_housings(k), None, False) for k in (1e6, 1.001e6))
    assert (alike.is_circular, unlike.is_circular) == (True, False)


def test_pictures_mark_no_more_nodes_than_can_be_told_apart():
    assert dotted(1).tolist() == [0]
    assert dotted(41).tolist() == list(range(41))
    many = dotted(1001)
    assert (many[0], many[-1], len(many)) == (0, 1000, 60)
    assert np.ptp(np.diff(many)) <= 1
    shown = shapes_for_page(modes(shaft(100, *(BEARING.format(n) for n in (1, 101))), count=2))
    assert shown["marked"] == dotted(101).tolist()
    assert len(shown["z"]) == len(shown["modes"][0]["x"][0]) == 101


def test_the_page_of_modes_shows_no_rounding_as_a_decrement():
    held = [BEARING.format(n).replace("100.0", "0.0") for n in (1, 11)]
    undamped = replace(shaft(10, *held), eta_v=0.0)
    shown = shapes_for_page(modes(undamped, 300.0))["modes"]
    assert shown
    assert all(mode["caption"].endswith(", log dec 0") for mode in shown)


def test_of_very_many_nodes_those_of_parts_the_ends_and_round_ones_are_numbered():
    figure = machine_figure(shaft(600, BEARING.format(1), BEARING.format(599)))
    numbers = {int(text.get_text()) for text in figure.axes[0].texts if text.get_text().isdecimal()}
    assert numbers == {1, 200, 599, 601, *range(5, 601, 5)}
