"""One FMU of a coupled system, driven through FMPy."""

import shutil
import sys
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import fmpy

from ..errors import InputError, RunFailed, known_name, number
from ..fmi.log import read_message
from ..model.message_templates import Message


class Member:
    """One FMU of a coupled system, extracted and instantiated; a context that frees it.

    fmu: its file, or the folder into which it was extracted, which is kept: every new place from
    which its library is loaded costs a process half a megabyte that is never freed. parameters:
    values by name; messages: those of all FMUs, since FMPy hands them to the logger made last.
    Raises `RunFailed` with the FMU's own message when a call fails, and `InputError` for what is no
    FMU, for one of another version than FMI 2.0 and for a variable that it does not have.
    """

    def __init__(self, fmu: Path, parameters: Mapping[str, float], messages: list[Message]) -> None:
        self.messages = messages
        self._name = fmu.name
        self._is_extracted = fmu.is_dir()
        try:
            description = fmpy.read_model_description(str(fmu))
        except Exception as error:  # of many kinds, the parser's of XML too
            reason = getattr(error, "strerror", None) or " ".join(str(error).split())
            raise InputError(f"{fmu}: is not an FMU that can be read: {reason}") from error
        if description.fmiVersion != "2.0":
            raise InputError(f"{fmu}: is of FMI {description.fmiVersion}; must be of FMI 2.0")
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

    def __enter__(self) -> "Member":
        with ExitStack() as refused:
            refused.push(self.__exit__)
            self._call(self._fmu.setupExperiment, startTime=0.0)
            for name, value in self._parameters.items():
                references = self.references(name)
                kind = self._variables[name].type
                kind = "Integer" if kind == "Enumeration" else kind  # as FMI 2.0 sets it
                setter = getattr(self._fmu, f"set{kind}")
                if kind != "Boolean":
                    value = number(f"{self._name}: {name}", value)
                self._call(setter, references, [int(value) if kind != "Real" else value])
            self._call(self._fmu.enterInitializationMode)
            refused.pop_all()
        return self

    def __exit__(self, *reason: object) -> None:
        self._fmu.freeInstance()
        self._remove_extracted()

    def references(self, *names: str) -> list[int]:
        """Return the value references of variables."""
        known = self._variables
        return [known[known_name(f"{self._name}:", name, known)].valueReference for name in names]

    def unit(self, name: str) -> str:
        """Return the unit of a variable, empty where it has none."""
        self.references(name)  # refuses an unknown name
        return self._variables[name].unit or ""

    def begin(self) -> None:
        """Leave the initialization mode."""
        self._call(self._fmu.exitInitializationMode)

    def get(self, references: list[int]) -> list[float]:
        """Return the values of Reals."""
        return self._call(self._fmu.getReal, references)

    def read(self, name: str) -> float:
        """Return the value of a variable, whatever its type."""
        references = self.references(name)
        getter = getattr(self._fmu, f"get{self._variables[name].type}")
        return float(self._call(getter, references)[0])

    def set(self, references: list[int], values: list[float]) -> None:
        """Set Reals."""
        self._call(self._fmu.setReal, references, values)

    def slopes(self, references: list[int], values: list[float]) -> None:
        """Set the first derivatives of inputs for the next step."""
        self._call(self._fmu.setRealInputDerivatives, references, [1] * len(references), values)

    def step(self, t: float, h: float) -> None:
        """Step from t [s] over h [s]."""
        self._call(self._fmu.doStep, t, h)

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

    def _log(self, environment: object, name: bytes, status: int, category: bytes, text: bytes):
        if status != fmpy.fmi2.fmi2OK:
            self.messages.append(read_message(text))
