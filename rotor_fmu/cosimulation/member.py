"""One FMU of a coupled system, driven through FMPy."""

import shutil
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import fmpy

from ..errors import InputError, RunFailed, known_name, number, shown_value
from ..fmi.log import read_message
from ..model.message_templates import Message

_NO_NUMBERS = ("String", "Binary", "Clock")
_REALS = ("Real", "Float64", "Float32")
_LARGEST = {"Integer": 2**31 - 1, "Int32": 2**31 - 1}  # which ctypes would let wrap around


class Member:
    """One FMU of a coupled system, of FMI 2.0 or 3.0, extracted and instantiated; a context that
    initializes, terminates and frees it.

    fmu: its file, or the folder into which it was extracted, which is kept: every new place from
    which its library is loaded costs a process half a megabyte that is never freed. parameters:
    values by name; messages: those of all FMUs, since FMPy hands them to the logger made last.
    Raises `RunFailed` with the FMU's own message when a call fails, and `InputError` for what is no
    FMU for co-simulation, for a variable that it does not have, and for a value that is none of the
    variable's type.
    """

    def __init__(self, fmu: Path, parameters: Mapping[str, Any], messages: list[Message]) -> None:
        self.messages = messages
        self._name = fmu.name
        self._is_extracted = fmu.is_dir()
        try:
            description = fmpy.read_model_description(str(fmu))
        except Exception as error:  # of many kinds, the parser's of XML too
            reason = getattr(error, "strerror", None) or " ".join(str(error).split())
            raise InputError(f"{fmu}: is not an FMU that can be read: {reason}") from error
        version = description.fmiVersion
        self._is_fmi3 = version.startswith("3.")
        if version != "2.0" and not self._is_fmi3:
            raise InputError(f"{fmu}: is of FMI {version}; must be of FMI 2.0 or 3.0")
        if description.coSimulation is None:
            raise InputError(f"{fmu}: must be an FMU for co-simulation")
        self._folder = str(fmu) if self._is_extracted else fmpy.extract(str(fmu))
        self._variables = {v.name: v for v in description.modelVariables}
        search_path = list(sys.path)
        options = {"debug_logging": True, "logger": self._log}
        try:
            self._fmu = self._call(
                fmpy.instantiate_fmu, self._folder, description, "CoSimulation", **options
            )
        except RunFailed:
            self._remove_extracted()
            raise
        finally:
            # without the folder of the FMU's scripts: a process that is started later would import
            # the FMU's copy of pythonfmu instead of the installed one
            sys.path[:] = search_path
        self._parameters = parameters
        self._has_begun = False
        self._groups: dict[tuple[str, ...], list[tuple[str, list[str], list[int]]]] = {}

    def __enter__(self) -> "Member":
        with ExitStack() as refused:
            refused.push(self.__exit__)
            if not self._is_fmi3:
                self._call(self._fmu.setupExperiment, startTime=0.0)
            for name, value in self._parameters.items():
                self.set({name: value})
            self._call(self._fmu.enterInitializationMode)
            refused.pop_all()
        return self

    def __exit__(self, error: object, *_: object) -> None:
        try:
            if self._has_begun and error is None:
                self._call(self._fmu.terminate)
        finally:
            self._fmu.freeInstance()
            self._remove_extracted()

    def variable(self, name: str) -> Any:
        """Return FMPy's description of a variable. Raises `InputError` for an unknown name and for
        an array."""
        variable = self._variables[known_name(f"{self._name}:", name, self._variables)]
        if variable.dimensions:
            raise InputError(f"{self._name}: {name}: is an array; must be a single value")
        return variable

    def begin(self) -> None:
        """Leave the initialization mode."""
        self._call(self._fmu.exitInitializationMode)
        self._has_begun = True

    def get(self, names: Iterable[str]) -> dict[str, float]:
        """Return the values of variables by name, in whatever order; all types are read as
        numbers. Raises `InputError` for a text."""
        values: dict[str, float] = {}
        for kind, group, references in self._grouped(tuple(names)):
            if kind in _NO_NUMBERS:
                raise InputError(f"{self._name}: {group[0]}: is a {kind}; must be a number")
            got = self._call(getattr(self._fmu, f"get{kind}"), references)
            values.update(zip(group, map(float, got), strict=True))
        return values

    def set(self, values: Mapping[str, Any]) -> None:
        """Set variables by name, those of a type in one call."""
        for kind, group, references in self._grouped(tuple(values)):
            given = [self._as_kind(kind, name, values[name]) for name in group]
            self._call(getattr(self._fmu, f"set{kind}"), references, given)

    def step(self, t: float, h: float) -> None:
        """Step from t [s] over h [s]."""
        done = self._call(self._fmu.doStep, t, h)
        if done and done[1]:  # as FMI 3.0 has it, between whether there are events and early ends
            raise RunFailed(f"{self._name}: asks to end the simulation at t = {done[3]:g} s")

    def _grouped(self, names: tuple[str, ...]) -> list[tuple[str, list[str], list[int]]]:
        """Return variables by the kind that the functions to get and set them are called after:
        kind, names and value references."""
        if names not in self._groups:
            groups: dict[str, list[str]] = {}
            for name in names:
                kind = self.variable(name).type
                if kind == "Enumeration":
                    kind = "Int64" if self._is_fmi3 else "Integer"
                groups.setdefault(kind, []).append(name)
            self._groups[names] = [
                (kind, group, [self._variables[name].valueReference for name in group])
                for kind, group in groups.items()
            ]
        return self._groups[names]

    def _as_kind(self, kind: str, name: str, value: Any) -> Any:
        """Return a value as FMPy takes it; `InputError` for one of another kind."""
        where = f"{self._name}: {name}"
        if kind in _NO_NUMBERS:
            if not isinstance(value, str) or kind != "String":
                raise InputError(f"{shown_value(where, value)}: {kind}; must be a text")
            return value
        given = number(where, int(value) if kind == "Boolean" and value in (0, 1) else value)
        if kind in _REALS:
            return given
        if not given.is_integer() or abs(given) > _LARGEST.get(kind, 2**63):
            raise InputError(f"{where} = {given:g}: must be an integer of type {kind}")
        return int(given)

    def _call(self, call: Callable[..., object], *arguments: object, **named: object) -> Any:
        heard = len(self.messages)
        try:
            return call(*arguments, **named)
        except Exception as error:  # FMPy's instantiation raises nothing more specific
            said = self.messages[heard:]
            reason = said[-1] if said else " ".join(str(error).split())
            raise RunFailed(f"{self._name}: {reason}") from error

    def _remove_extracted(self) -> None:
        if not self._is_extracted:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _log(self, *arguments: Any) -> None:
        status, _, text = arguments[-3:]  # FMI 2.0 has the instance's name before
        if status != fmpy.fmi2.fmi2OK:
            self.messages.append(read_message(text))
