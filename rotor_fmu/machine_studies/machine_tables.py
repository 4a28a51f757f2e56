"""A machine's runs from the tables of a study's file: machine, parameters, run and metrics."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from itertools import islice, product
from pathlib import Path
from types import NoneType
from typing import Any

import numpy as np

from ..errors import InputError, check_integer, check_one_of, known_name
from ..fmi.binding import load_names
from ..fmi.solver_parameters import OTHER_NAMES, PREFIX, settings_of
from ..machine_file.loading import load_rotor, warn_of_changes
from ..model.contact.wall import ContactQuantities
from ..model.machine.no_parameters import why_no_parameter
from ..model.machine.rotor import Rotor
from ..model.settings import SettingsError
from ..operating_speeds import operating_speeds
from ..runs.input_signals import read_signals
from ..runs.settings_text import exponents_first, known_parameter, value_of
from ..studies.design import MOST, Axis
from ..studies.study import Column, Study, Tables, table_of
from ..studies.study_file import read_study_file
from ..units import number
from .linear_runs import LINEAR, LinearRuns
from .machine_runs import RUN, VERIFICATION, MachineModel, MachineRuns, machine_of
from .metric import VARIANTS, Metric
from .response_runs import RESPONSE, WHICH, ResponseRuns
from .run_excitation import Excitation, Kick
from .run_kinds import IN_TIME, SIGNALS, RunKind
from .run_metrics import DIRECTIONS

# Of a distribution, where its values are tried: irrational, so that these are no whole numbers.
_SHARES = np.array([1.0, 9.0, 18.0]) / (6.0 * np.pi)
_MOST_TRIED = 200  # combinations of values
_CHOICES = {"way": DIRECTIONS, "which": WHICH}  # of options of metrics
# Kinds of runs by name, with the class of their runs.
RunKinds = Mapping[str, tuple[RunKind, type[MachineRuns]]]
KINDS: RunKinds = {
    **{kind.name: (kind, MachineRuns) for kind in IN_TIME},
    RESPONSE.name: (RESPONSE, ResponseRuns),
    LINEAR.name: (LINEAR, LinearRuns),
}


def read_study(path: Path, *, is_quick: bool = False) -> Study:
    """Read the file of a study, of a machine unless it names a module of its own; see
    `studies.study_file`."""
    return read_study_file(path, read_machine, is_quick=is_quick)


def read_machine(tables: Tables, folder: Path, kinds: RunKinds = KINDS) -> "MachineSubject":
    """Return a machine as a study's subject; folder: of the study's file; kinds: of its runs."""
    machine_file = tables.get("machine")
    if machine_file is not None and not isinstance(machine_file, str):
        raise InputError(f"machine = {machine_file!r}: must be the name of a file")
    toml, _ = load_rotor(_machine_path(machine_file, folder), option="machine =")
    run = dict(table_of(tables, "run"))
    name = run.pop("kind", None)
    check_one_of("run kind" if name is None else f"run kind = {name!r}", name, kinds)
    kind, make = kinds[name]
    runs = make(toml, {}, _excitation(kind, run, machine_of(toml, kind.is_free), folder), ())
    for target, value in exponents_first(table_of(tables, "set")):
        rotor, known = runs.machine.rotor, runs.settable
        variable = known[known_parameter("set", target, rotor, known, OTHER_NAMES)]
        values = {**runs.values, target: value_of(f"set {target}", variable, value)}
        runs = replace(runs, values=values)
    warn_of_changes("set", runs.machine.rotor, *_machines(runs, {}))
    if runs.how.over:
        ends = (runs.how.numbers[end] for end in ("from", "to"))
        _ask_about(runs, "run over", runs.how.over, *ends)
    return MachineSubject(runs, tables)


@dataclass(frozen=True)
class MachineSubject:
    """A machine as the subject of a study: its runs without metrics, and the study's tables."""

    runs: MachineRuns
    tables: Tables

    @property
    def units(self) -> Mapping[str, str]:
        """Units of all that can be varied, by name."""
        return self.runs.variable_units

    @property
    def display_units(self) -> str:
        """Units that the machine's file asks to be shown."""
        return machine_of(self.runs.toml, False).rotor.units

    def why_not(self, name: str) -> str:
        """Return why what the machine's file has cannot be varied, empty of any other name."""
        rotor, settable = self.runs.machine.rotor, self.runs.settable
        return why_no_parameter(rotor, name, [n for n in rotor.numbers() if n in settable])

    def value(self, name: str, where: str, given: object) -> float:
        """Return a value of what can be varied; of a choice its name will do, of a truth itself."""
        variable = self.runs.settable.get(name)
        if variable is None:
            return number(where, given, self.units[name])
        return float(value_of(where, variable, given))

    def model(self, axes: tuple[Axis, ...]) -> MachineRuns:
        """Return the runs with their metrics; axes: the varied parameters. Raises `InputError`."""
        runs = _with_metrics(self.runs, self.tables, axes)
        check_values(runs, axes)
        return runs


def _machine_path(name: str | None, folder: Path) -> Path | None:
    """Return the machine's file, beside the study or among the examples; None for the rig."""
    if name in (None, "rig"):
        return None
    path = folder / str(name)
    packaged = Path(str(files("rotor_fmu.examples"))) / str(name)
    return packaged if packaged.is_file() and not path.is_file() else path


def _excitation(
    kind: RunKind, run: dict[str, Any], machine: MachineModel, folder: Path
) -> Excitation:
    """Return the excitation that the table [run] describes."""
    kick, file, over = run.pop("kick", None), run.pop("file", None), run.pop("over", None)
    if over is not None:
        if kind is not RESPONSE or not isinstance(over, str):
            raise InputError(
                f"run {kind.name}: over = {over!r}: the name of a quantity, of a response"
            )
        known_parameter("run response: over", over, machine.rotor)
    abscissa_unit = machine.units[over] if over else "rad/s"
    speeds = operating_speeds(machine.rotor)
    numbers = {
        name: getattr(speeds, of.default) if isinstance(of.default, str) else of.default
        for name, of in kind.numbers.items()
    }
    for name, value in run.items():
        known_name(f"run {kind.name}:", name, numbers)
        unit = kind.numbers[name].unit or abscissa_unit
        numbers[name] = number(f"run.{name}", value, unit)
    for name, value in numbers.items():
        if value is None:
            raise InputError(f"run {kind.name}: needs {name} [{kind.numbers[name].unit}]")
    given = {name: float(value) for name, value in numbers.items() if value is not None}
    kind.check(given)
    for name, why in kind.idle(given).items():
        if name in run:
            raise InputError(f"run.{name} = {given[name]:g}: has no effect {why}")
    if kind is RESPONSE and (over is None) != (given["speed"] == 0):
        raise InputError("run response: speed is given with over, and only then")
    if not isinstance(file, str if kind is SIGNALS else NoneType):
        raise InputError(f"run {kind.name}: file: only of signals, which need it")
    loads = load_names(machine.rotor)
    signals = read_signals(folder / file, machine.table) if isinstance(file, str) else None
    if signals is not None:
        if "speed" not in signals.values:
            raise InputError(f"run signals: {file}: has no column speed")
        zeros = {name: 0.0 * signals.t for pair in loads for name in pair}
        signals = replace(signals, values=zeros | dict(signals.values))
    return Excitation(kind, given, signals, _kick(kick, loads), loads, over or "", abscissa_unit)


def _kick(table: object, loads: Iterable[tuple[str, str]]) -> Kick | None:
    if table is None:
        return None
    names = ("port", "force", "rate", "duration")
    if not isinstance(table, dict) or set(table) != set(names):
        raise InputError(f"run kick: must be {{ {', '.join(names)} }}")
    ports = [x.removesuffix(".fx") for x, _ in loads if x.endswith(".fx")]
    port = known_name("run kick: port", str(table["port"]), ports)
    force, rate, duration = (
        number(f"run kick {name}", table[name], unit)
        for name, unit in zip(names[1:], ("N", "rad/s", "s"), strict=True)
    )
    if not duration > 0:
        raise InputError(f"run kick duration = {duration:g} s: must be > 0")
    return Kick(port, force, rate, duration)


def _with_metrics(runs: MachineRuns, tables: Tables, axes: tuple[Axis, ...]) -> MachineRuns:
    """Return the runs with the metrics of the table [keep] and their columns."""
    varied = {target for axis in axes for target in axis.targets}
    table = table_of(tables, "keep")
    if not table:
        raise InputError("[keep] is empty: at least one result must be kept")
    for name in ("turns", "count", "back", "measure"):
        if f"{RUN}{name}" in varied:
            raise InputError(f"vary {RUN}{name}: changes the number of results; cannot be varied")
    for name, why in runs.how.kind.idle(runs.how.numbers).items():
        if f"{RUN}{name}" in varied:
            raise InputError(f"vary {RUN}{name}: has no effect {why}")
    metrics = tuple(_metric(name, given, runs) for name, given in table.items())
    columns = [runs.column_of(metric, varied) for metric in metrics]
    is_verified = tables.get("verify", False)
    if not isinstance(is_verified, bool):
        raise InputError(f"verify = {is_verified!r}: must be true or false")
    if is_verified:
        if not runs.can_be_verified:
            raise InputError(f"verify: not of runs of the kind {runs.how.kind.name}")
        text = "largest difference of the metrics from the same run, solved more finely"
        columns.append(Column(VERIFICATION, "1", text))
    return replace(runs, metrics=metrics, columns=tuple(columns), is_verified=is_verified)


def _metric(name: str, given: object, runs: MachineRuns) -> Metric:
    """Return the metric that an entry of the table [keep] describes."""
    where, known = f"keep {name}", runs.metric_kinds
    if not isinstance(given, dict):
        raise InputError(f"{where} = {given!r}: must be a table such as {{ peak = OUTPUT }}")
    words = [key for key in known if key not in VARIANTS]
    named = [key for key in given if key in words]
    if not named and given:
        known_name(where + ":", next(iter(given)), words)
    if not named:
        raise InputError(f"{where}: must have one of {', '.join(words)}")
    kind = known[named[0]]
    # `order = 1, of = OUTPUT`, and likewise for others whose own word is a number or a list
    of = given["of"] if "of" in given else given[kind.name]
    options = {key: value for key, value in given.items() if key not in (kind.name, "of")}
    if kind.name in kind.needed:
        options[kind.name] = given[kind.name]
    if kind.name == "order" and "speed" in given:  # the order where a speed is passed
        kind = known["passing"]
    if kind.name == "dissipated" and f"{of}.sliding" in runs.units:  # a race turns
        kind = known["slid"]
    for key in options:
        known_name(where + ":", key, (*kind.needed, *kind.optional))
    for key in kind.needed:
        if key not in options:
            raise InputError(f"{where}: {kind.said} needs {key}")
    if not isinstance(of, str):
        raise InputError(f"{where}: of = {of!r}: must be the name of an output")
    unit = runs.how.abscissa_unit
    checked = {key: _option(where, key, value, unit) for key, value in options.items()}
    part = dict(runs.machine.rotor.named_parts()).get(of) if kind.name == "dissipated" else None
    contact = part if isinstance(part, ContactQuantities) else None
    metric = Metric(name, kind, of, tuple(checked.items()), contact)
    runs.check_metric(metric, runs.how)
    return metric


def _option(where: str, key: str, value: object, abscissa_unit: str) -> Any:
    """Return a checked option of a metric; abscissa_unit: of the speed or a curve's parameter."""
    if key in _CHOICES:
        check_one_of(f"{where}: {key} = {value!r}", value, _CHOICES[key])
        return value
    if key == "bins":
        if not isinstance(value, dict) or set(value) != {"from", "to", "count"}:
            raise InputError(f"{where}: bins must be {{ from, to, count }}")
        low, high = (
            number(f"{where}: bins {end}", value[end], abscissa_unit) for end in ("from", "to")
        )
        if not low < high:
            raise InputError(f"{where}: bins from = {low:g}: must be below to = {high:g}")
        check_integer(f"{where}: bins count", value["count"], 1, MOST)
        return {"from": low, "to": high, "count": value["count"]}
    units = {"speed": abscissa_unit, "at": abscissa_unit, "after": "s"}
    return number(f"{where}: {key}", value, units.get(key, ""))


def check_values(runs: MachineRuns, axes: tuple[Axis, ...]) -> None:
    """Raise `InputError` for listed values, or ends of a distribution, that no run could have; in
    the tail of a normal distribution they fail run by run."""
    check: Callable[[float], object]
    for axis, target in [(each, target) for each in axes for target in each.targets]:
        if target in runs.values:
            raise InputError(f"vary {axis.name}: {target} is also fixed in [set]")
        if target.startswith(RUN):
            of_run = target.removeprefix(RUN)
            is_whole = runs.how.kind.numbers[of_run].is_whole
            check = partial(runs.how.kind.numbers[of_run].check, of_run)
        else:
            is_whole = runs.settable[target].kind != "Real"
            check = partial(value_of, f"vary {axis.name}", runs.settable[target])
        if axis.distribution is not None and is_whole:
            raise InputError(f"vary {axis.name}: is an integer; list its values")
        for value in axis.stated:
            check(value)
        if axis.stated and target in runs.machine.units:
            _ask_about(runs, f"vary {axis.name}:", target, min(axis.stated), max(axis.stated))
    _check_possible(runs, axes)
    # numbers of a run suit one another, or not
    for point in _points((axis for axis in axes if axis.values), RUN):
        how, _ = runs.split(point)
        for metric in runs.metrics:
            runs.check_metric(metric, how)
    # settings that never suit one another fail here, those that sometimes do not run by run
    first_error = None
    for point in _points(axes, PREFIX):
        try:
            settings_of({**runs.machine.start, **runs.values, **point})
            return
        except SettingsError as error:
            first_error = first_error or error
    if first_error is not None:
        raise first_error


def _check_possible(runs: MachineRuns, axes: tuple[Axis, ...]) -> None:
    """Raise `InputError` where none of the combinations of values, as far as they are tried, makes
    a machine that can be: of what is counted, say, a distribution has none. Those of a normal
    distribution fail run by run."""
    own, error = runs.machine.units, None
    chosen = tuple(axis for axis in axes if not own.keys().isdisjoint(axis.targets))
    tried = [*islice(_points(chosen, ""), _MOST_TRIED)] if all(a.stated for a in chosen) else []
    for point in tried:
        try:
            runs.machine.rotor.with_values(runs.own_numbers(point))
            return
        except InputError as failure:
            error = error or failure
    if error is not None and len(tried) < _MOST_TRIED:
        raise InputError(f"vary {', '.join(axis.name for axis in chosen)}: {error}") from error


def _ask_about(runs: MachineRuns, where: str, name: str, *values: float) -> None:
    """Warn of implausible values of a parameter that is varied."""
    changed = (machine for value in values for machine in _machines(runs, {name: value}))
    for machine in _machines(runs, {}):
        warn_of_changes(where, machine, *changed)


def _machines(runs: MachineRuns, values: Mapping[str, float]) -> list[Rotor]:
    """Return the machine with the values of all runs and others; nothing where it cannot be, which
    is said elsewhere."""
    try:
        return [runs.machine.rotor.with_values(runs.own_numbers(values))]
    except InputError:
        return []


def _points(axes: Iterable[Axis], prefix: str) -> Iterable[dict[str, float]]:
    """Return the combinations of values, of the axes that set names with a prefix: listed ones, or
    some that a distribution may give."""
    chosen = [axis for axis in axes if any(t.startswith(prefix) for t in axis.targets)]
    drawn = [a.distribution.at(_SHARES).tolist() if a.distribution else () for a in chosen]
    for point in product(*(a.values or some for a, some in zip(chosen, drawn, strict=True))):
        yield {t: v for a, v in zip(chosen, point, strict=True) for t in a.targets}
