"""Reports and checks of a machine that take a part of their time."""

from importlib import import_module

import numpy as np
import pytest
from rotor_fmu.model import linear

from rotor_fmu.linear.displayed import Displayed

COARSE = {
    "rotor_fmu.machine_report.report_page": {"_SPEEDS": 7, "SPEEDS": 13},
    "rotor_fmu.machine_report.rub_check": {"_TURNS": 100.0, "_SETTLING": 10.0},
    "rotor_fmu.model.linear.unbalance_check": {"SPEEDS": 13},
    "rotor_fmu.model.linear.critical_map": {"_SAMPLES": 10},
}


@pytest.fixture
def coarse_report(monkeypatch):
    """The report of a machine from fewer speeds, with shorter runs and without its pictures, where
    one of its sentences is looked at. Peaks are found between the speeds, however many these are.
    """
    for name, counts in COARSE.items():
        module = import_module(name)
        for constant, count in counts.items():
            monkeypatch.setattr(module, constant, count)
    page = import_module("rotor_fmu.machine_report.report_page")
    monkeypatch.setattr(page, "figure_html", lambda figure, caption: caption)


@pytest.fixture
def conclusions_alone(coarse_report, monkeypatch):
    """The same, whose pictures are not composed either."""
    page = import_module("rotor_fmu.machine_report.report_page")
    for name in ("machine_html", "mode_shapes_figure"):
        monkeypatch.setattr(page, name, lambda *_: "")
    for kind in Displayed.__subclasses__():
        monkeypatch.setattr(kind, "figure", lambda *_: None)


@pytest.fixture
def without_runs(monkeypatch):
    """Checks of clearances that say where these close, and run no machine with its contacts."""
    module = import_module("rotor_fmu.machine_report.rub_check")
    nothing = module.RubRun("run-up", "ok", [], np.zeros(0), np.zeros(0), ())
    monkeypatch.setattr(module, "_up_and_down", lambda *_: (nothing,))


@pytest.fixture
def without_peaks(monkeypatch):
    """The command `unbalance` without its search for critical speeds: it finds none."""
    monkeypatch.setattr(linear, "critical_peaks", lambda *_, **__: ())
