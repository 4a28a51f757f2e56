"""Answers of `model.linear` as objects with a table and a picture, which a notebook shows."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from inspect import cleandoc
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from matplotlib.figure import Figure

from ..display import in_its_units
from ..errors import InputError, shown_value
from ..machine_file.loading import load_rotor
from ..model.machine.rotor import Rotor
from ..model.one_thread import on_one_thread
from ..model.parts.shaft import Section
from ..model.structure.beam import shaft_element
from ..plotting.notebook import png
from ..tables import Table
from .linear_plots import titled

Machine = Rotor | Path | str
Answer = TypeVar("Answer")


class Displayed(ABC):
    """Something with a table and a picture, of a machine of this name, whose elements have these
    ratios of shear to bending [1], in the units of its file; its docstring begins with that of what
    it shows."""

    machine_name: ClassVar[str] = ""
    shear: ClassVar[tuple[float, ...]] = ()
    shown_units: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        for name in {"table", "figure"} & vars(cls).keys():
            setattr(cls, name, in_its_units(vars(cls)[name]))
        texts = [base.__doc__ or "" for base in cls.__bases__ if is_dataclass(base)]
        cls.__doc__ = "\n\n".join(map(cleandoc, [*texts, cls.__doc__ or ""]))

    @abstractmethod
    def table(self) -> Table:
        """Return the numbers in a few columns."""

    @abstractmethod
    def figure(self) -> Figure:
        """Draw the result."""

    def titled(self, text: str) -> str:
        """Return the title of a picture, with the name of the machine."""
        return titled(self.machine_name, text)

    def __repr__(self) -> str:
        return f"<{self.table().title}>"

    def _repr_html_(self) -> str:
        return self.table().html()

    def _repr_png_(self) -> bytes:
        return png(self.figure())


def answer_of(kind: type[Answer], analyse: Callable[..., Any]) -> Callable[..., Answer]:
    """Return a function that asks `analyse`, of `model.linear`, about a machine or its file, with
    the same further arguments, and returns its result as the class that shows it."""

    @on_one_thread
    def answer(machine: Machine, *arguments: Any, **options: Any) -> Answer:
        return displayed(kind, analyse, machine, *arguments, **options)

    return answer


def rotor_of(machine: Machine) -> Rotor:
    """Return the machine, read if need be; raises `InputError`."""
    if isinstance(machine, Rotor):
        return machine
    if not isinstance(machine, (Path, str)):
        raise InputError(f"{shown_value('machine', machine)}: must be a machine or its file")
    return load_rotor(Path(machine), option="")[1]


def displayed(
    kind: Callable[..., Any],
    analyse: Callable[..., Any],
    machine: Machine,
    *given: Any,
    **options: Any,
) -> Any:
    """Return what `analyse`, of `model.linear`, says of a machine, as the class that shows it."""
    rotor = rotor_of(machine)
    result = analyse(rotor, *given, **options)
    return of_machine(kind(**{f.name: getattr(result, f.name) for f in fields(result)}), rotor)


def of_machine(shown: Any, rotor: Rotor) -> Any:
    """Return an answer, which takes its machine's name, shear and units."""
    object.__setattr__(shown, "machine_name", rotor.name)
    object.__setattr__(shown, "shown_units", rotor.units)
    object.__setattr__(shown, "shear", tuple(map(_shear, rotor.sections)))
    return shown


def _shear(section: Section) -> float:
    """Return the deflection by shear over that by bending of an element [1], from its matrix."""
    stiffness = shaft_element(section).stiffness
    return max(0.0, float(12 * stiffness[1, 1] / (stiffness[0, 0] * section.length**2) - 4))
