"""The page of results as numbers names and describes every key that commands print."""

import re
import runpy
from pathlib import Path

import pytest

from rotor_fmu.cli import COMMANDS
from rotor_fmu.linear.displayed import Displayed
from rotor_fmu.linear.linear_tables import names_of

ROOT = Path(__file__).parents[2]
PAGE = runpy.run_path(str(ROOT / "docs" / "site" / "results.py"))
KINDS = {kind for top in PAGE["ANSWERS"].values() for kind in top}
HELD = sorted({k for top in KINDS for k in (top, *PAGE["within"](top))}, key=lambda k: k.__name__)


def test_every_linear_answer_is_of_a_command_that_there_is():
    assert set(Displayed.__subclasses__()) <= KINDS
    assert set(PAGE["ANSWERS"]) <= {name for places in COMMANDS.values() for name in places}


@pytest.mark.parametrize("kind", HELD)
def test_every_key_of_an_answer_is_described(kind):
    told, text = PAGE["derived"](kind), " ".join(PAGE["described"](kind))
    for key in names_of(kind):
        spoken = key.replace("_", "[-_ ]")
        assert key in told or re.search(rf"\b{spoken}\b", text), key
