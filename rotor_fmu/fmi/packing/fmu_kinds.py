"""Which FMU is built of a machine: in Python, of libraries or of C source."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...errors import InputError, is_one_of
from ...library.platforms import COMPONENT, PLATFORMS
from .machine_files import Machine
from .native_fmu import build_native, build_source
from .python_fmu import SYSTEMS, build


@dataclass(frozen=True)
class FmuKind:
    """An FMU as it was asked for: whether it carries libraries, or C source, and needs no Python;
    the version of FMI, 2 or 3."""

    is_native: bool
    is_source: bool
    fmi: int

    @property
    def platforms(self) -> tuple[str, ...]:
        """Platforms that it may carry a library or a component for."""
        return (*PLATFORMS, COMPONENT.name) if self.is_native else SYSTEMS

    def check(
        self, fmi: str, step: str | None, chosen: Sequence[str], options: Sequence[str]
    ) -> None:
        """Raise `InputError` where the choices do not go together.

        fmi, step: the choices of the version and, if there is one, of a step for real time, in the
        words of who asked, such as `fmi = 3`; chosen: platforms; options: what the choices of
        native, source and platforms are called.
        """
        native, source, platforms = options
        needs_no_python = self.is_native or self.is_source
        if not is_one_of(self.fmi, (2, 3)):
            raise InputError(f"{fmi}: must be 2 or 3")
        for choice in (fmi if self.fmi == 3 else None, step):
            if choice is not None and not needs_no_python:
                raise InputError(f"{choice}: only with {native} or {source}")
        if self.is_source and (self.is_native or chosen):
            raise InputError(
                f"{source}: an FMU without libraries; leave out {native} and {platforms}"
            )
        if self.is_native and self.fmi == 2 and COMPONENT.name in chosen:
            raise InputError(f"{platforms} {COMPONENT.name}: needs FMI 3.0, not {fmi}")

    def build(self, folder: Path, machine: Machine, platforms: Sequence[str] | None) -> Path:
        """Build it of a machine in a folder and return its path; platforms and errors are those of
        `rotor_fmu.build_fmu`."""
        if self.is_source:
            return build_source(folder, machine, self.fmi)
        if self.is_native:
            return build_native(folder, machine, self.fmi, platforms or tuple(PLATFORMS))
        return build(folder, machine, platforms or None)
