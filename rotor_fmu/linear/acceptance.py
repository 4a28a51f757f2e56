"""The checks of API 617 and 684, for Python and the command line: the objects of `model.linear`,
which a notebook shows as a table and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..model import linear
from ..model.linear.unbalance_check import ProbeCritical
from ..model.one_thread import on_one_thread
from . import acceptance_plots, acceptance_tables
from .answers import Displayed, Machine, displayed, rotor_of
from .linear_tables import Table


class CriticalMap(Displayed, linear.CriticalMap):
    """`model.linear.CriticalMap`, shown."""

    table = acceptance_tables.critical_map_table
    figure = acceptance_plots.critical_map_figure


class UnbalanceCheck(Displayed, linear.UnbalanceCheck):
    """`model.linear.UnbalanceCheck`, shown."""

    table = acceptance_tables.unbalance_check_table
    figure = acceptance_plots.unbalance_check_figure


@dataclass(frozen=True)
class CriticalPeaks(Displayed):
    """Critical speeds of nodes with their amplification factors, shown.

    Attributes
    ----------
    criticals : tuple of ProbeCritical
        The peaks by ascending speed.
    """

    criticals: tuple[ProbeCritical, ...]

    def table(self) -> Table:
        """Return the numbers in a few columns.

        Returns
        -------
        Table
            A row for each peak of a node.
        """
        return acceptance_tables.peaks_table(self.criticals)

    def figure(self) -> Figure:
        """Draw the result.

        Returns
        -------
        matplotlib.figure.Figure
            The amplification factors.
        """
        return acceptance_plots.peaks_figure(self.criticals, self.machine_name)


class StabilityLevel1(Displayed, linear.StabilityLevel1):
    """`model.linear.StabilityLevel1`, shown."""

    table = acceptance_tables.level_1_table
    figure = acceptance_plots.level_1_figure


class StabilityLevel2(Displayed, linear.StabilityLevel2):
    """`model.linear.StabilityLevel2`, shown."""

    table = acceptance_tables.level_2_table
    figure = acceptance_plots.level_2_figure


@on_one_thread
def critical_map(
    machine: Machine, stiffness: Sequence[float] | np.ndarray | None = None, **options: Any
) -> CriticalMap:
    """Return `model.linear.critical_map` of a machine; by default over two decades on either side
    of the bearings' own stiffness."""
    rotor = rotor_of(machine)
    if stiffness is None:
        stiffness = default_stiffness(linear.mean_stiffness(rotor, options.get("contacts")))
    return displayed(CriticalMap, linear.critical_map, rotor, stiffness, **options)


def default_stiffness(mean: float) -> np.ndarray:
    """Return stiffnesses of two decades on either side of one [N/m], eight in each."""
    return mean * np.logspace(-2.0, 2.0, 33)


@on_one_thread
def unbalance_check(
    machine: Machine, low: float, high: float, probes: Sequence[int], **options: Any
) -> UnbalanceCheck:
    """Return `model.linear.unbalance_check` of a machine."""
    return displayed(UnbalanceCheck, linear.unbalance_check, machine, low, high, probes, **options)


@on_one_thread
def critical_peaks(
    machine: Machine, top: float, nodes: Sequence[int], **options: Any
) -> CriticalPeaks:
    """Return `model.linear.critical_peaks` of a machine."""
    rotor = rotor_of(machine)
    result = CriticalPeaks(linear.critical_peaks(rotor, top, nodes, **options))
    object.__setattr__(result, "machine_name", rotor.name)
    return result


@on_one_thread
def level_1(machine: Machine, speed: float, **options: Any) -> StabilityLevel1:
    """Return `model.linear.level_1` of a machine."""
    return displayed(StabilityLevel1, linear.level_1, machine, speed, **options)


@on_one_thread
def level_2(machine: Machine, speed: float, **options: Any) -> StabilityLevel2:
    """Return `model.linear.level_2` of a machine."""
    return displayed(StabilityLevel2, linear.level_2, machine, speed, **options)
