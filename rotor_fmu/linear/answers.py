"""Linear analyses of a machine, for Python: the objects of `model.linear`, which a notebook shows
as a table and a picture.

    from rotor_fmu.linear.answers import campbell, modes

    modes("machine.toml", 300.0).log_dec

A machine is a `Rotor`, or the path of its file.
"""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from matplotlib.figure import Figure

from ..machine_file.loading import load_rotor
from ..model import linear
from ..model.machine.rotor import Rotor
from ..model.one_thread import on_one_thread
from ..model.parts.shaft import Section
from ..model.structure.beam import shaft_element
from ..operating_speeds import operating_speeds
from ..plotting.machine_drawing import machine_figure
from . import bearing_plots, bearing_tables, linear_plots, linear_tables

Machine = Rotor | Path | str


class Displayed(ABC):
    """Something with a table and a picture, of a machine of this name, whose elements have these
    ratios of shear to bending [1]."""

    machine_name: ClassVar[str] = ""
    shear: ClassVar[tuple[float, ...]] = ()

    @abstractmethod
    def table(self) -> linear_tables.Table:
        """Return the numbers in a few columns.

        Returns
        -------
        Table
            Head, rows and title; `text()` and `html()` show it.
        """

    @abstractmethod
    def figure(self) -> Figure:
        """Draw the result.

        Returns
        -------
        matplotlib.figure.Figure
            The picture.
        """

    def __repr__(self) -> str:
        return f"<{self.table().title}>"

    def _repr_html_(self) -> str:
        return self.table().html()

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.figure().savefig(buffer, format="png", metadata={"Software": None})
        return buffer.getvalue()


class Modes(Displayed, linear.Modes):
    """`model.linear.Modes`, shown."""

    table = linear_tables.modes_table

    def figure(self) -> Figure:
        """Draw the result.

        Returns
        -------
        matplotlib.figure.Figure
            The shapes.
        """
        return linear_plots.modes_figure(self, self.machine_name, self.shear)


class Campbell(Displayed, linear.Campbell):
    """`model.linear.Campbell`, shown."""

    table = linear_tables.campbell_table

    def figure(self, operating: tuple[float, float] | None = None) -> Figure:
        """Draw the result.

        Parameters
        ----------
        operating : (float, float), optional
            The operating range [rad/s], which is shaded.

        Returns
        -------
        matplotlib.figure.Figure
            The diagram.
        """
        return linear_plots.campbell_figure(self, self.machine_name, operating)


class BearingCurves(Displayed, linear.BearingCurves):
    """`model.linear.BearingCurves`, shown."""

    table = bearing_tables.bearing_table
    figure = bearing_plots.bearing_figure


class DamperCurves(Displayed, linear.DamperCurves):
    """`model.linear.DamperCurves`, shown."""

    table = bearing_tables.damper_table
    figure = bearing_plots.damper_figure


class RingCurves(Displayed, linear.RingCurves):
    """`model.linear.RingCurves`, shown."""

    table = bearing_tables.ring_table
    figure = bearing_plots.ring_figure


class RollingCurves(Displayed, linear.RollingCurves):
    """`model.linear.RollingCurves`, shown."""

    table = bearing_tables.rolling_table
    figure = bearing_plots.rolling_figure


class UnbalanceResponse(Displayed, linear.UnbalanceResponse):
    """`model.linear.UnbalanceResponse`, shown at the nodes with the largest orbits."""

    def nodes(self) -> list[int]:
        """Return the nodes with the largest orbits.

        Returns
        -------
        list of int
            Up to three nodes (from 1), ascending.
        """
        largest = np.argsort(-self.major.max(axis=0, initial=0.0), kind="stable")[:3]
        return sorted((largest + 1).tolist())

    def table(self, nodes: Sequence[int] | None = None) -> linear_tables.Table:
        """Return the numbers in a few columns.

        Parameters
        ----------
        nodes : sequence of int, optional
            Nodes (from 1). By default those with the largest orbits.

        Returns
        -------
        Table
            Rows of speed and node.
        """
        return linear_tables.unbalance_table(self, nodes or self.nodes())

    def figure(
        self,
        nodes: Sequence[int] | None = None,
        operating: tuple[float, float] | None = None,
    ) -> Figure:
        """Draw the result.

        Parameters
        ----------
        nodes : sequence of int, optional
            Nodes (from 1). By default those with the largest orbits.
        operating : (float, float), optional
            The operating range [rad/s], which is shaded.

        Returns
        -------
        matplotlib.figure.Figure
            Amplitudes and phases.
        """
        nodes = nodes or self.nodes()
        return linear_plots.unbalance_figure(self, nodes, self.machine_name, operating)


class Static(Displayed, linear.Static):
    """`model.linear.Static`, shown."""

    table = linear_tables.static_table

    def figure(self) -> Figure:
        """Draw the result.

        Returns
        -------
        matplotlib.figure.Figure
            The deflection.
        """
        return linear_plots.static_figure(self, self.machine_name, self.shear)


@on_one_thread
def modes(machine: Machine, speed: float = 0.0, **options: Any) -> Modes:
    """Return `model.linear.modes` of a machine."""
    return displayed(Modes, linear.modes, machine, speed, **options)


@on_one_thread
def campbell(machine: Machine, speeds: Sequence[float] | np.ndarray, **options: Any) -> Campbell:
    """Return `model.linear.campbell` of a machine."""
    return displayed(Campbell, linear.campbell, machine, speeds, **options)


@on_one_thread
def unbalance_response(
    machine: Machine, speeds: Sequence[float] | np.ndarray, **options: Any
) -> UnbalanceResponse:
    """Return `model.linear.unbalance_response` of a machine."""
    return displayed(UnbalanceResponse, linear.unbalance_response, machine, speeds, **options)


@on_one_thread
def bearing(
    machine: Machine, speeds: Sequence[float] | np.ndarray, **options: Any
) -> BearingCurves:
    """Return `model.linear.bearing_curves` of a machine."""
    return displayed(BearingCurves, linear.bearing_curves, machine, speeds, **options)


@on_one_thread
def damper(machine: Machine, frequency: float, **options: Any) -> DamperCurves:
    """Return `model.linear.damper_curves` of a machine."""
    return displayed(DamperCurves, linear.damper_curves, machine, frequency, **options)


@on_one_thread
def floating_ring(
    machine: Machine, speeds: Sequence[float] | np.ndarray, **options: Any
) -> RingCurves:
    """Return `model.linear.ring_curves` of a machine."""
    return displayed(RingCurves, linear.ring_curves, machine, speeds, **options)


@on_one_thread
def rolling(
    machine: Machine, speeds: Sequence[float] | np.ndarray = (0.0,), **options: Any
) -> RollingCurves:
    """Return `model.linear.rolling_curves` of a machine."""
    return displayed(RollingCurves, linear.rolling_curves, machine, speeds, **options)


@on_one_thread
def static(machine: Machine, speed: float | None = None, **options: Any) -> Static:
    """Return `model.linear.static` of a machine; by default it stands still, or, if oil films hold
    it, turns at its rated speed."""
    rotor = rotor_of(machine)
    if speed is None:
        held = linear.LinearMachine(rotor, options.get("contacts"))
        is_afloat = held.is_held and not held.holds_at(0.0)
        speed = operating_speeds(rotor).rated if is_afloat else 0.0
    return displayed(Static, linear.static, rotor, speed, **options)


def show(machine: Machine) -> Figure:
    """Return the picture of a machine."""
    return machine_figure(rotor_of(machine))


def rotor_of(machine: Machine) -> Rotor:
    """Return the machine, read if need be; raises `InputError`."""
    return machine if isinstance(machine, Rotor) else load_rotor(Path(machine))[1]


def displayed(
    kind: type, analyse: Callable[..., Any], machine: Machine, *given: Any, **options: Any
) -> Any:
    """Return what `analyse`, of `model.linear`, says of a machine, as the class that shows it."""
    rotor = rotor_of(machine)
    result = analyse(rotor, *given, **options)
    shown = kind(**{field.name: getattr(result, field.name) for field in fields(result)})
    object.__setattr__(shown, "machine_name", rotor.name)
    object.__setattr__(shown, "shear", tuple(map(_shear, rotor.sections)))
    return shown


def _shear(section: Section) -> float:
    """Return the deflection by shear over that by bending of an element [1], from its matrix."""
    stiffness = shaft_element(section).stiffness
    return max(0.0, float(12 * stiffness[1, 1] / (stiffness[0, 0] * section.length**2) - 4))
