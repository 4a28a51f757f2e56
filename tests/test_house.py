"""Rooms small enough to know, and arrows that run one way."""

import pytest

from . import house


@pytest.mark.parametrize(("folder", "count"), sorted(house.sizes().items()))
def test_no_folder_holds_more_than_a_dozen_modules(folder, count):
    assert count <= house.MOST, folder


def test_no_arrows_between_rooms_go_round():
    rooms = house.order()
    assert rooms.index("rotor_fmu.model.kernels") < rooms.index("rotor_fmu.model.simulation")


def test_the_model_knows_nothing_of_fmi_files_or_screens():
    outside = {
        (above, below)
        for above, below in house.arrows()
        if above.startswith("rotor_fmu.model.") and not below.startswith("rotor_fmu.model.")
    }
    assert not outside
    for word in ("pythonfmu", "fmpy", "matplotlib", "fmi2"):
        assert not [f for f in house.mentions(word) if f.startswith("model/")], word
