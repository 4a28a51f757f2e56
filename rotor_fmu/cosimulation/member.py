"""One FMU of a coupled system, driven through FMPy."""

import shutil
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, chdir, suppress
from ctypes import byref
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import fmpy
from fmpy import fmi2, fmi3
from fmpy.logging import addLoggerProxy

from ..errors import InputError, RunFailed, is_one_of, known_name, number, shown_value
from ..files import named
from ..fmi.log import read_message
from ..fmi.plain_path import check_plain_path
from ..model.message_templates import Message

_NO_NUMBERS = ("String", "Binary", "Clock")
_Groups = list[tuple[str, list[str], list[int]]]
_REALS = ("Real", "Float64", "Float32")
# Beyond these ctypes would let an integer wrap around.
_LEAST = {"Integer": -(2**31)} | {f"Int{n}": -(2 ** (n - 1)) for n in (8, 16, 32, 64)}
_MOST = {name: -least - 1 for name, least in _LEAST.items()}
_MOST |= {f"UInt{n}": 2**n - 1 for n in (8, 16, 32, 64)}
# What FMI says of a unit: exponents of the SI base units, factor and offset.
_OF_UNIT = ("kg", "m", "s", "A", "K", "mol", "cd", "rad", "factor", "offset")

_BOOLEAN = {0: "false", 1: "true"}


class EndedEarly(RunFailed):
    """A step that an FMU did not do whole, though it has not failed."""


class Member:
    """One FMU of a coupled system, of FMI 2.0 or 3.0; a context that extracts, instantiates and
    initializes it, then terminates and frees it.

    fmu: its file, or the folder into which it was extracted, which is kept: every new place from
    which its library is loaded costs a process half a megabyte that is never freed. parameters:
    values by name; messages: those of all FMUs, since FMPy hands them to the logger made last;
    stop, tolerance: end of the run [s] and relative tolerance [1] that it gets, if any; name: what
    the system calls it, which is its instance's name and which messages begin with, since several
    of its FMUs may be of one file.
    Raises `RunFailed` with the FMU's own message when a call fails, and, before anything of the FMU
    is loaded, `InputError` for what is no FMU for co-simulation, for a parameter that it does not
    have, and for a value that is none of the parameter's type.
    """

    def __init__(
        self,
        fmu: Path,
        parameters: Mapping[str, Any],
        messages: list[Message],
        stop: float | None = None,
        tolerance: float | None = None,
        name: str = "",
    ) -> None:
        self.messages = messages
        self._file = fmu
        self._name = f"{name}: {fmu.name}" if name else fmu.name
        self._instance_name = name or None
        self._is_extracted = fmu.is_dir()
        try:
            description = fmpy.read_model_description(str(fmu))
        except Exception as error:  # of many kinds, the parser's of XML too
            raise self._unreadable(error) from error
        version = description.fmiVersion
        self._is_fmi3 = version.startswith("3.")
        if version != "2.0" and not self._is_fmi3:
            raise InputError(f"{fmu}: is of FMI {version}; must be of FMI 2.0 or 3.0")
        if description.coSimulation is None:
            raise InputError(f"{fmu}: must be an FMU for co-simulation")
        self._description = description
        self.takes_any_step = description.coSimulation.canHandleVariableCommunicationStepSize
        is_single = description.coSimulation.canBeInstantiatedOnlyOncePerProcess
        self.single = description.guid if is_single else None  # of which there may be one instance
        self._variables = {v.name: v for v in description.modelVariables}
        self._units = {
            of.name: tuple(float(getattr(of.baseUnit, name)) for name in _OF_UNIT)
            for of in description.unitDefinitions
            if of.baseUnit is not None
        }
        self._grouped = cache(self._in_groups)
        for name, value in parameters.items():
            self._typed(name, value)
        self._parameters = parameters
        self._experiment = {"startTime": 0.0, "stopTime": stop, "tolerance": tolerance}
        self._has_begun = False

    def __enter__(self) -> "Member":
        self._instantiate()
        with ExitStack() as refused:
            refused.push(self.__exit__)
            if not self._is_fmi3:
                self._call(self._fmu.setupExperiment, **self._experiment)
            for name, value in self._parameters.items():
                self.set({name: value})
            of_fmi3 = self._experiment if self._is_fmi3 else {}
            self._call(self._fmu.enterInitializationMode, **of_fmi3)
            refused.pop_all()
        return self

    def _instantiate(self) -> None:
        self._folder = str(self._file.absolute()) if self._is_extracted else mkdtemp()
        search_path = list(sys.path)
        try:
            if not self._is_extracted:
                self._extract()
            check_plain_path(Path(self._folder))
            with chdir("."):  # FMPy stays at a library that cannot be loaded
                self._fmu = self._call(self._new_instance)
        except BaseException:
            self._remove_extracted()
            raise
        finally:
            # without the folder of the FMU's scripts: a process that is started later would import
            # the FMU's copy of pythonfmu instead of the installed one
            sys.path[:] = search_path

    def _new_instance(self) -> Any:
        """Return an instance as FMPy's `instantiate_fmu` makes it, which lets none have a name."""
        given = {
            "guid": self._description.guid,
            "unzipDirectory": self._folder,
            "modelIdentifier": self._description.coSimulation.modelIdentifier,
            "instanceName": self._instance_name,
        }
        if self._is_fmi3:
            fmu = fmi3.FMU3Slave(**given)
            fmu.instantiate(loggingOn=True, logMessage=self._log)
            return fmu
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        addLoggerProxy(byref(callbacks))
        fmu = fmi2.FMU2Slave(**given)
        fmu.instantiate(callbacks=callbacks, loggingOn=True)
        return fmu

    def __exit__(self, error: object, *_: object) -> None:
        try:
            if self._has_begun and error is None:
                self._call(self._fmu.terminate)
        finally:
            self._fmu.freeInstance()
            self._remove_extracted()

    @property
    def instance(self) -> Any:
        """FMPy's instance of it, for what the master does not ask for: states, derivatives."""
        return self._fmu

    def variable(self, name: str) -> Any:
        """Return FMPy's description of a variable. Raises `InputError` for an unknown name and for
        an array."""
        variable = self._variables[known_name(f"{self._name}:", name, self._variables)]
        if variable.dimensions:
            raise InputError(f"{self._name}: {name}: is an array; must be a single value")
        return variable

    def readable(self, name: str) -> Any:
        """Return FMPy's description of a variable that can be read as a number. Raises `InputError`
        for another."""
        variable = self.variable(name)
        if variable.type in _NO_NUMBERS:
            raise InputError(f"{self._name}: {name}: is a {variable.type}; must be a number")
        return variable

    def unit(self, variable: Any) -> tuple[str, tuple[float, ...] | None]:
        """Return the unit of a variable, its own or its type's: the name, empty if it has none, and
        what the FMU says that it is, if it does."""
        unit = variable.unit or getattr(variable.declaredType, "unit", None) or ""
        return unit, self._units.get(unit)

    def begin(self) -> None:
        """Leave the initialization mode."""
        self._call(self._fmu.exitInitializationMode)
        self._has_begun = True

    def get(self, names: Iterable[str]) -> dict[str, float]:
        """Return the values of variables by name, in whatever order; those of all types that are
        `readable`, as numbers."""
        values: dict[str, float] = {}
        for kind, group, references in self._grouped(tuple(names)):
            self.readable(group[0])  # as are all of its type
            got = self._call(getattr(self._fmu, f"get{kind}"), references)
            values.update(zip(group, map(float, got), strict=True))
        return values

    def set(self, values: Mapping[str, Any]) -> None:
        """Set variables by name, those of a type in one call."""
        for kind, group, references in self._grouped(tuple(values)):
            given = [self._typed(name, values[name]) for name in group]
            self._call(getattr(self._fmu, f"set{kind}"), references, given)

    def step(self, t: float, h: float) -> None:
        """Step from t [s] over h [s]. Raises `EndedEarly` where the FMU discards the step, or asks
        to end the simulation."""
        try:
            done = self._call(self._fmu.doStep, t, h)
        except RunFailed as error:
            if getattr(error.__cause__, "status", None) == fmi2.fmi2Discard:
                raise EndedEarly(str(error)) from error
            raise
        # of FMI 3.0, between whether there are events and an early end, which it is not allowed
        if done and done[1]:
            raise EndedEarly(f"{self._name}: asks to end the simulation at t = {done[3]:g} s")

    def _kind(self, variable: Any) -> str:
        """Return what the functions to get and set a variable are called after."""
        if variable.type != "Enumeration":
            return str(variable.type)
        return "Int64" if self._is_fmi3 else "Integer"

    def _in_groups(self, names: tuple[str, ...]) -> _Groups:
        """Return variables by their kinds: kind, names and value references."""
        groups: dict[str, list[str]] = {}
        for name in names:
            groups.setdefault(self._kind(self.variable(name)), []).append(name)
        return [
            (kind, group, [self._variables[name].valueReference for name in group])
            for kind, group in groups.items()
        ]

    def _typed(self, name: str, value: Any) -> Any:
        """Return the value of a variable as FMPy takes it; `InputError` for one of another type."""
        variable = self.variable(name)
        kind, where = self._kind(variable), f"{self._name}: {name}"
        if kind in _REALS:
            return number(where, value)
        if kind in _NO_NUMBERS:
            if not isinstance(value, str) or kind != "String":
                raise InputError(f"{shown_value(where, value)}: {kind}; must be a text")
            return value
        choices = _BOOLEAN if kind == "Boolean" else _choices(variable)
        if choices:
            is_bool = kind == "Boolean" and is_one_of(value, choices)  # which is no number
            with suppress(InputError):
                if (given := number(where, int(value) if is_bool else value)) in choices:
                    return int(given)
            allowed = ", ".join(f"{of} {called}" for of, called in choices.items())
            raise InputError(f"{shown_value(where, value)}: must be one of {allowed}")
        given = number(where, value)
        if not given.is_integer() or not _LEAST.get(kind, 0) <= given <= _MOST[kind]:
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
        finally:
            self.messages[heard:] = [
                Message(f"{self._name}: {said}", said.code) for said in self.messages[heard:]
            ]

    def _extract(self) -> None:
        try:
            with named(Path(self._folder)):
                fmpy.extract(str(self._file), self._folder)
        except OSError:  # of the disk
            raise
        except Exception as error:
            raise self._unreadable(error) from error

    def _unreadable(self, error: Exception) -> InputError:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        return InputError(f"{self._file}: is not an FMU that can be read: {reason}")

    def _remove_extracted(self) -> None:
        if not self._is_extracted:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _log(self, *arguments: Any) -> None:
        status, _, text = arguments[-3:]  # FMI 2.0 has the instance's name before
        if status != fmi2.fmi2OK:
            self.messages.append(read_message(text))


def _choices(variable: Any) -> dict[int, str]:
    """Return the values of an Enumeration with their names; none of another variable."""
    return {int(of.value): of.name for of in getattr(variable.declaredType, "items", ())}
