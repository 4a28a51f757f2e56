"""The files that every FMU of a machine holds: description, table, documents."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ...library.build import sources_digest
from ...model.machine.rotor import Rotor
from ...model.machine.toml import parse_rotor, rig_toml
from ...model.settings import choose
from ..description import TIME, Described, description, guid
from ..interface import interface
from ..machine_table import FILE, table_bytes
from ..solver_parameters import NO_STARTS, REALTIME, chosen_at_build
from ..variables import Variable
from .archive import DESCRIPTION, ROTOR_FILE, xml_bytes
from .documents import documents

TABLE = f"resources/{FILE}"
NATIVE, SOURCE = "Native", "Source"
_LONGEST = 48  # identifier: some file systems and hosts take no more with what follows it


@dataclass(frozen=True)
class Machine:
    """A machine to be built into an FMU: its TOML text, the rotor, its variables, and whether a
    torque drives it; step: the fixed step length of an FMU for real time [s]."""

    toml: str
    rotor: Rotor
    table: Sequence[Variable]
    is_free: bool
    step: float | None = None

    def identifier(self, kind: str = "") -> str:
        """Return what the FMU and its file are called: what the machine's file says, else its name
        in one word; `Free` behind it where a torque drives it, and its kind, `NATIVE` or `SOURCE`,
        where it needs no Python."""
        words = re.findall(r"[A-Za-z0-9]+", self.rotor.name)
        name = "".join(word[0].upper() + word[1:] for word in words)[:_LONGEST]
        name = name if name and not name[0].isdecimal() else f"Rotor{name}"
        return f"{self.rotor.identifier or name}{'Free' * self.is_free}{kind}"


def machine_of(
    toml: str | None = None,
    is_free: bool = False,
    reduction: int = 0,
    step: float | None = None,
    starts: Mapping[str, float] = NO_STARTS,
) -> Machine:
    """Return the machine of a TOML text, by default the paper's rig, driven by its speed or, where
    is_free, by a torque.

    reduction: component modes kept of the shaft, 0 for all of it; step: fixed step length of an
    FMU for real time [s]; starts: start values of solver parameters and choices by name, as
    numbers. Raises `QuantityError` for an impossible rotor and `SettingsError` for an impossible
    reduction, step or start value."""
    if step is not None:
        choose(REALTIME, h=step)
    toml = rig_toml() if toml is None else toml
    rotor = parse_rotor(toml)
    table = chosen_at_build(interface(rotor, is_free), reduction, step, starts)
    return Machine(toml, rotor, table, is_free, step)


def machine_files(machine: Machine, of: Described, fmi: int) -> dict[str, bytes]:
    """Return the files by their path in an FMU of this version of FMI, with the GUID."""
    sources = sources_digest()
    content = f"{of.identifier} {fmi} {sources} {machine.toml}"
    of = replace(of, guid=guid(machine.table, content), step=machine.step)
    known = machine.table if fmi == 2 else (*machine.table, TIME)
    return {
        **documents(of, machine.table, fmi),
        DESCRIPTION: xml_bytes(description(of, machine.table, fmi)),
        TABLE: table_bytes(machine.rotor, known, machine.is_free, sources, of.guid),
        ROTOR_FILE: machine.toml.encode(),
    }
