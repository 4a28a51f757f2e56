"""Another FMU, the partner, coupled with the rotor's: its source lists the exchanged variables."""

import math
import runpy
import shutil
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

from ..about import RELEASED
from ..errors import InputError, check_one_of, number, read_text
from ..files import scratch_folder
from ..fmi.description import complete
from ..fmi.packing.archive import repack, wrap
from ..fmi.python import wrapper
from ..fmi.variables import Variable, unit
from . import partner_slave
from .master import NONE, CoupledFmus, CoupledRun, check_rows, coupled

_SLAVE = partner_slave.TableSlave.__name__
_LISTED = ("name", "causality", "unit", "start", "minimum", "description")
CAUSALITIES = ("input", "output", "parameter", "local")


@dataclass(frozen=True)
class Coupling:
    """A partner's FMU and its connections with the rotor's, or with several FMUs.

    The source is a Python script with a slave of `rotor_fmu.cosimulation.partner_slave`, its table
    `VARIABLES`, and two lists of pairs (output, input), each `FMU.VARIABLE`, such as `partner.w`
    and `rotor.speed`: `CONNECTIONS` are those at every communication point, `INITIAL` are made one
    after another while all FMUs are in the initialization mode.
    """

    source: Path

    @cached_property
    def _declared(self) -> dict[str, Any]:
        read_text("", self.source)  # says why it cannot be read
        try:
            return runpy.run_path(str(self.source))
        except (Exception, SystemExit) as error:
            raise InputError(f"{self.source.name}: cannot be run: {_reason(error)}") from error

    @property
    def fmu_name(self) -> str:
        """File name of the partner's FMU: that of its source in camel case."""
        return "".join(word.title() for word in self.source.stem.split("_")) + ".fmu"

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Variables of the partner, in the order of their value references. Raises `InputError` for
        a unit or a causality that no FMU has, and where `BEGUN` is missing."""
        table = f"{self.source.name}: VARIABLES"
        rows = check_rows(table, self._table("VARIABLES"), *_LISTED)
        variables = tuple(
            Variable(name, "Real", causality, text, unit, start, low=low)
            for name, causality, unit, start, low, text in rows
        )
        for name, count in Counter(v.name for v in variables).items():
            if count > 1:
                raise InputError(f"{table}: {name}: is listed {count} times")
        for v in variables:
            _check_variable(f"{table}: {v.name}", v)
        if partner_slave.BEGUN not in self._declared["VARIABLES"]:
            raise InputError(f"{table}: has no BEGUN")
        return variables

    def _check_slave(self) -> None:
        """Raise `InputError` unless the source has one slave, with the source's table and all that
        it must do, of which an instance can be made."""
        slaves = {  # by name: the copy in an FMU that has run in this process is another class
            slave
            for slave in self._declared.values()
            if _SLAVE in [base.__name__ for base in getattr(slave, "__mro__", ())[1:]]
        }
        if len(slaves) != 1:
            names = ", ".join(sorted(slave.__name__ for slave in slaves)) or "none"
            raise InputError(f"{self.source.name}: {names}: must have one subclass of {_SLAVE}")
        (slave,) = slaves
        where = f"{self.source.name}: {slave.__name__}"
        if lacks := sorted(slave.__abstractmethods__):
            raise InputError(f"{where}: has no {' and no '.join(lacks)}")
        if getattr(slave, "VARIABLES", None) != self._declared["VARIABLES"]:
            raise InputError(f"{where}: must have the line VARIABLES = VARIABLES")
        try:
            slave(instance_name=slave.__name__)
        except Exception as error:
            raise InputError(f"{where}: {_reason(error)}") from error

    def build(self, out: Path) -> Path:
        """Build the partner's FMU in the folder `out` and return its path; equal sources give equal
        bytes. Raises `OSError` if `out` cannot be written, `InputError` for a source without a
        slave that can run."""
        variables = self.variables
        self._check_slave()
        text = self.source.read_text(encoding="utf-8")
        with scratch_folder() as folder:
            # named after its content, so that two versions can be loaded in one process
            digest = sha256(text.encode()).hexdigest()[:12]
            script = folder / f"{self.source.stem}_{digest}.py"
            script.write_text(text, encoding="utf-8")
            beside = {"rotor_fmu_wrapper.py": wrapper, "rotor_fmu_slave.py": partner_slave}
            for name, module in beside.items():
                shutil.copyfile(str(module.__file__), folder / name)
            raw = folder / "raw.fmu"
            wrap(script, [folder / name for name in beside], raw)
            return repack(raw, out / self.fmu_name, lambda of: complete(of, variables, RELEASED))

    def open(
        self,
        fmus: Mapping[str, Path],
        stop: float,
        parameters: Mapping[str, Mapping[str, Any]] = NONE,
        recorded: Mapping[str, Sequence[str]] = NONE,
        tolerance: float | None = None,
    ) -> AbstractContextManager[CoupledFmus]:
        """Return the FMUs by the names that the source's pairs have for them as a context in which
        they are connected; arguments and errors are those of `master.coupled`."""
        connections, initial = (self._table(name) for name in ("CONNECTIONS", "INITIAL"))
        of_source = f"{self.source.name}: CONNECTIONS", f"{self.source.name}: INITIAL"
        given = fmus, connections, initial, parameters, recorded, of_source
        return coupled(*given, stop=stop, tolerance=tolerance)

    def run(
        self,
        fmus: Mapping[str, Path],
        stop: float,
        step: float,
        parameters: Mapping[str, Mapping[str, Any]] = NONE,
        recorded: Mapping[str, Sequence[str]] = NONE,
        progress: Callable[[float], None] = lambda t: None,
        tolerance: float | None = None,
    ) -> CoupledRun:
        """Run the FMUs and return the recorded variables; arguments and errors are those of `open`
        and of `CoupledFmus.run`."""
        with self.open(fmus, stop, parameters, recorded, tolerance) as opened:
            return opened.run(step, progress)

    def _table(self, name: str) -> Any:
        if name not in self._declared:
            raise InputError(f"{self.source.name}: has no table {name}")
        return self._declared[name]


def _reason(error: BaseException) -> str:
    """Return what an exception of a source's code says, in one line."""
    is_refused = type(error).__name__ == wrapper.CallFailed.__name__  # of whichever copy
    return " ".join((f"{error}" if is_refused else f"{type(error).__name__}: {error}").split())


def _check_variable(where: str, v: Variable) -> None:
    """Raise `InputError` for a variable that no FMU has; where: its place in the source."""
    if not v.name.isidentifier():
        raise InputError(f"{where}: must be the name of an attribute of the slave")
    check_one_of(f"{where}: {v.causality!r}", v.causality, CAUSALITIES)
    if not (isinstance(v.unit, str) and isinstance(v.text, str)):
        raise InputError(f"{where}: {v.unit!r}, {v.text!r}: unit and description must be texts")
    try:
        unit(v.unit)
    except (KeyError, ValueError):
        raise InputError(
            f"{where}: the unit {v.unit!r} is unknown; must be SI units such as N.m, kg/m3"
        ) from None
    for name, value in (("start", v.start), ("minimum", v.low)):
        if value is not None and not math.isfinite(number(f"{where}: {name}", value)):
            raise InputError(f"{where}: {name} = {value:g}: must be a finite number")
    start = v.start or 0.0  # as of a slave's attribute that has none
    if v.causality in ("input", "parameter") and v.low is not None and start < v.low:
        raise InputError(f"{where}: start = {start:g}: must be >= its minimum, {v.low:g}")
