"""Another FMU, the partner, coupled with the rotor's: its source lists the exchanged variables."""

import reprlib
import runpy
import shutil
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from ..about import RELEASED
from ..errors import InputError, check_one_of, read_text
from ..files import scratch_folder, unfinished
from ..fmi.description import complete
from ..fmi.packing.archive import repack, wrap
from ..fmi.python import wrapper
from ..fmi.variables import Variable, are_alike, unit
from ..model.message_templates import Message
from . import partner_slave
from .master import Connection, Side, run_jacobi
from .member import Member

PARTNER, ROTOR = "partner", "rotor"
_SLAVE = partner_slave.TableSlave.__name__
_LISTED = ("name", "causality", "unit", "start", "minimum", "description")
CAUSALITIES = ("input", "output", "parameter", "local")


@dataclass(frozen=True)
class CoupledRun:
    """A coupled run at its communication points t [s]: the recorded variables of the partner and of
    the rotor by name; each of shape (n,)."""

    t: np.ndarray
    partner: Mapping[str, np.ndarray]
    rotor: Mapping[str, np.ndarray]

    def save(self, path: Path) -> None:
        """Write the run to a .npz file, whole or not at all."""
        columns: dict[str, Any] = {
            f"{side} {name}": column
            for side, recorded in ((PARTNER, self.partner), (ROTOR, self.rotor))
            for name, column in recorded.items()
        }
        with unfinished(path) as part:
            np.savez_compressed(part, t=self.t, **columns)

    @classmethod
    def load(cls, path: Path) -> "CoupledRun":
        """Read a run that `save` wrote."""
        sides: dict[str, dict[str, np.ndarray]] = {PARTNER: {}, ROTOR: {}}
        with np.load(path) as data:
            for key in data.files:
                side, _, name = key.partition(" ")
                if name:
                    sides[side][name] = data[key]
            return cls(data["t"], sides[PARTNER], sides[ROTOR])


@dataclass(frozen=True)
class Coupling:
    """A partner's FMU and its connections with the rotor's.

    The source is a Python script with a slave of `rotor_fmu.cosimulation.partner_slave`, its table
    `VARIABLES`, and two lists of pairs (output, input), each named `partner.NAME` or `rotor.NAME`:
    `CONNECTIONS` are those at every communication point, `INITIAL` are made one after another while
    both FMUs are in the initialization mode.
    """

    source: Path

    @cached_property
    def _declared(self) -> dict[str, Any]:
        read_text("", self.source)  # says why it cannot be read
        try:
            return runpy.run_path(str(self.source))
        except (Exception, SystemExit) as error:
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise InputError(f"{self.source.name}: cannot be run: {reason}") from error

    @property
    def fmu_name(self) -> str:
        """File name of the partner's FMU: that of its source in camel case."""
        return "".join(word.title() for word in self.source.stem.split("_")) + ".fmu"

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Variables of the partner, in the order of their value references. Raises `InputError` for
        a unit or a causality that no FMU has, and where `BEGUN` is missing."""
        variables = listed_variables(self._table("VARIABLES", *_LISTED))
        for v in variables:
            where = f"{self.source.name}: VARIABLES: {v.name}"
            check_one_of(f"{where}: {v.causality!r}", v.causality, CAUSALITIES)
            try:
                unit(v.unit)
            except (KeyError, ValueError):
                raise InputError(
                    f"{where}: the unit {v.unit!r} is unknown; must be SI units such as N.m, kg/m3"
                ) from None
        if partner_slave.BEGUN[0] not in [v.name for v in variables]:
            raise InputError(f"{self.source.name}: VARIABLES: has no BEGUN")
        return variables

    def _check_slave(self) -> None:
        """Raise `InputError` unless the source has a slave with a table and all that it must do."""
        for slave in self._declared.values():
            # by name: the copy in an FMU that has run in this process is another class
            if _SLAVE in [base.__name__ for base in getattr(slave, "__mro__", ())[1:]]:
                lacks = [] if hasattr(slave, "VARIABLES") else ["VARIABLES"]
                lacks += sorted(slave.__abstractmethods__)
                if lacks:
                    said = f"{self.source.name}: {slave.__name__}: has no "
                    raise InputError(said + " and no ".join(lacks))
                return
        raise InputError(f"{self.source.name}: has no subclass of {_SLAVE}")

    def build(self, out: Path) -> Path:
        """Build the partner's FMU in the folder `out` and return its path; equal sources give equal
        bytes. Raises `OSError` if `out` cannot be written, `InputError` for a source without a
        slave that can run."""
        variables = self.variables
        self._check_slave()
        return build_partner(self.source, variables, out / self.fmu_name)

    @contextmanager
    def open(
        self,
        partner_fmu: Path,
        rotor_fmu: Path,
        partner_parameters: Mapping[str, float],
        rotor_parameters: Mapping[str, float],
        of_partner: Sequence[str],
        of_rotor: Sequence[str],
    ) -> Iterator[tuple[Side, Side]]:
        """Yield partner and rotor in the initialization mode, with their initial values exchanged.

        partner_fmu, rotor_fmu: files, or the folders into which they were extracted; parameters by
        name, set before the initialization; of_partner, of_rotor: variables to record beside those
        that are exchanged. Raises `RunFailed` where a call of one of the FMUs fails, and
        `InputError` for a pair of the source that does not connect the partner with the rotor, or
        connects other units or an input that has its value from another pair.
        """
        initial, messages = self._pairs("INITIAL"), list[Message]()
        with (
            Member(partner_fmu, partner_parameters, messages) as partner,
            Member(rotor_fmu, rotor_parameters, messages) as rotor,
        ):
            members = {PARTNER: partner, ROTOR: rotor}
            for table in ("INITIAL", "CONNECTIONS"):
                self._check_pairs(table, members)
            for from_side, given, to_side, taken in initial:
                receiver = members[to_side]
                receiver.set(receiver.references(taken), [members[from_side].read(given)])
            yield (
                Side(partner, self._connections(PARTNER), of_partner),
                Side(rotor, self._connections(ROTOR), of_rotor),
            )

    def run(
        self,
        partner_fmu: Path,
        rotor_fmu: Path,
        stop: float,
        step: float,
        partner_parameters: Mapping[str, float],
        rotor_parameters: Mapping[str, float],
        of_partner: Sequence[str],
        of_rotor: Sequence[str],
        progress: Callable[[float], None] = lambda t: None,
    ) -> CoupledRun:
        """Run both FMUs with a Jacobi master and return the recorded variables.

        stop: end of the run [s]; step: communication step [s]; progress: called with the time at
        each communication point, ends the run by raising; all else as in `open`, errors too.
        """
        with self.open(
            partner_fmu, rotor_fmu, partner_parameters, rotor_parameters, of_partner, of_rotor
        ) as sides:
            return CoupledRun(*run_jacobi(*sides, stop, step, progress))

    def _table(self, name: str, *columns: str) -> list[Any]:
        """Return the rows of a table of the source, which begin with two words."""
        if name not in self._declared:
            raise InputError(f"{self.source.name}: has no table {name}")
        rows = self._declared[name]
        for row in rows if isinstance(rows, (list, tuple)) else [rows]:
            is_row = isinstance(row, (list, tuple)) and len(row) == len(columns)
            if not is_row or not all(isinstance(word, str) for word in row[:2]):
                said = f"{self.source.name}: {name}: {reprlib.repr(row)}"
                raise InputError(f"{said}: each must be ({', '.join(columns)})")
        return list(rows)

    def _connections(self, side: str) -> tuple[Connection, ...]:
        """Return the outputs of one side, each with the connected input of the other."""
        pairs = self._pairs("CONNECTIONS")
        return tuple((given, taken) for from_side, given, _, taken in pairs if from_side == side)

    def _check_pairs(self, table: str, members: Mapping[str, Member]) -> None:
        """Raise `InputError` for a pair of a list of the source whose units differ, and for an
        input of several outputs; an initial value may be passed on anew."""
        pairs = self._pairs(table)
        counts = Counter(f"{to_side}.{taken}" for _, _, to_side, taken in pairs)
        for taken, count in counts.items():
            if count > 1 and table == "CONNECTIONS":
                raise InputError(
                    f"{self.source.name}: {table}: {taken}: has {count} outputs; must have one"
                )
        for from_side, given, to_side, taken in pairs:
            one, other = members[from_side].unit(given), members[to_side].unit(taken)
            if one and other and not are_alike(one, other):
                raise InputError(
                    f"{self.source.name}: {table}: {from_side}.{given} [{one}], {to_side}.{taken} "
                    f"[{other}]: must have the same unit"
                )

    def _pairs(self, table: str) -> list[tuple[str, str, str, str]]:
        """Return the pairs of a list of the source: side and name of the output, then of the
        input. Raises `InputError`."""
        result = []
        for output, variable in self._table(table, "output", "input"):
            from_side, _, given = output.partition(".")
            to_side, _, taken = variable.partition(".")
            if {from_side, to_side} != {PARTNER, ROTOR}:
                raise InputError(
                    f"{self.source.name}: {table}: {output!r}, {variable!r}: one must be "
                    f"{PARTNER}.NAME and the other {ROTOR}.NAME"
                )
            result.append((from_side, given, to_side, taken))
        return result


def listed_variables(table: Sequence[partner_slave.Listed]) -> tuple[Variable, ...]:
    """Return the variables of a partner's FMU from its table `VARIABLES`."""
    return tuple(
        Variable(name, "Real", causality, text, unit, start, low=low)
        for name, causality, unit, start, low, text in table
    )


def build_partner(source: Path, table: tuple[Variable, ...], target: Path) -> Path:
    """Build the FMU `target` of a partner's source and return its path; equal sources give equal
    bytes. Raises `OSError` if its folder cannot be written.
    """
    text = source.read_text(encoding="utf-8")
    with scratch_folder() as folder:
        # named after its content, so that two versions can be loaded in one process
        script = folder / f"{source.stem}_{sha256(text.encode()).hexdigest()[:12]}.py"
        script.write_text(text, encoding="utf-8")
        beside = {"rotor_fmu_wrapper.py": wrapper, "rotor_fmu_slave.py": partner_slave}
        for name, module in beside.items():
            shutil.copyfile(str(module.__file__), folder / name)
        wrap(script, [folder / name for name in beside], folder / "raw.fmu")
        return repack(folder / "raw.fmu", target, lambda root: complete(root, table, RELEASED))
