"""`python -m papers.integrators schemes`: what each time integrator does to an oscillation."""

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.console import Console
from rich.table import Table

from papers.integrators import members, spectral
from papers.integrators.members import Scheme, SchemeError
from papers.integrators.spectral import Method, Survey
from rotor_fmu.cells import cell
from rotor_fmu.errors import InputError, check_one_of, writable_folder
from rotor_fmu.files import unfinished
from rotor_fmu.output_options import with_output_options

from . import classical

# dt/T at which the spectral radius is tabled.
RATIOS = (0.1, 0.3, 1.0, 10.0)
# Those of paper B's Figure 1.
FIGURE_1 = (
    "central-difference",
    "linear-acceleration",
    "newmark",
    "houbolt",
    "wilson=1.4",
    "transient-fidelity",
    "moderate-dissipation",
    "hht=0.5",
)
# Paper B's and Abaqus' symbols: the parameter here, and the factor that makes it one.
_SYMBOLS = {"alpha_h": ("alpha_f", 1.0), "alpha_b": ("alpha_m", 1.0), "alpha": ("alpha_f", -1.0)}
_PARAMETERS = ("alpha_f", "alpha_m", "beta", "gamma")
_TINY = 1e-12
_RATIOS_ALLOWED = (1e-9, 1e4)
_LIMITS = {0.0: "never", math.inf: "always"}


@dataclass(frozen=True)
class Kind:
    """A name for `--scheme`: its parameters in order, of which the first `needed` must be given."""

    build: Callable[..., Method]
    parameters: tuple[str, ...] = ()
    needed: int = 0


def _family(
    alpha_f: float = 0.0,
    alpha_m: float = 0.0,
    beta: float | None = None,
    gamma: float | None = None,
) -> Scheme:
    """Generalized-alpha with its own beta and gamma (paper B, eqs 8 and 9) where none is given."""
    if beta is None or gamma is None:
        own = members.generalized_alpha(alpha_f, alpha_m)
        beta = own.beta if beta is None else beta
        gamma = own.gamma if gamma is None else gamma
    return members.general(alpha_f, alpha_m, beta, gamma)


KINDS = {
    "newmark": Kind(members.newmark, ("beta", "gamma")),
    "hht": Kind(_family, ("alpha_f", "beta", "gamma"), 1),
    "wbz": Kind(_family, ("alpha_m", "beta", "gamma"), 1),
    "generalized-alpha": Kind(_family, ("alpha_f", "alpha_m", "beta", "gamma"), 2),
    "chung-hulbert": Kind(members.chung_hulbert, ("rho",), 1),
    "moderate-dissipation": Kind(lambda: members.MODERATE_DISSIPATION),
    "transient-fidelity": Kind(lambda: members.TRANSIENT_FIDELITY),
    "average-acceleration": Kind(members.newmark),
    "linear-acceleration": Kind(lambda: members.newmark(1 / 6)),
    "central-difference": Kind(classical.CentralDifference),
    "houbolt": Kind(classical.Houbolt),
    "wilson": Kind(classical.WilsonTheta, ("theta",)),
}


def parse_scheme(text: str) -> tuple[str, Method]:
    """Label and method of NAME or NAME=VALUE,VALUE or NAME=PARAMETER=VALUE,...

    Raises `InputError` for an unknown name or parameter, a missing or surplus one, a value that is
    no number or that the method cannot have.
    """
    label = "".join(text.lower().split())
    name, equals, given = label.partition("=")
    check_one_of(f"--scheme {text}: {name!r}", name, KINDS)
    kind = KINDS[name]
    values: dict[str, float] = {}
    for position, item in enumerate(given.split(",") if equals else ()):
        parameter, value = _parameter(text, kind, position, item)
        if parameter in values:
            raise InputError(f"--scheme {text}: {parameter} is given twice")
        values[parameter] = value
    missing = [parameter for parameter in kind.parameters[: kind.needed] if parameter not in values]
    if missing:
        example = ",".join(kind.parameters[: kind.needed]).upper()
        raise InputError(f"--scheme {text}: needs {' and '.join(missing)}: {name}={example}")
    try:
        return label, kind.build(**values)
    except SchemeError as error:
        raise InputError(f"--scheme {text}: {error}") from error


def _parameter(text: str, kind: Kind, position: int, item: str) -> tuple[str, float]:
    symbol, equals, number = item.rpartition("=")
    parameter, factor = _SYMBOLS.get(symbol, (symbol, 1.0))
    if not equals and position < len(kind.parameters):
        parameter = kind.parameters[position]
    if parameter not in kind.parameters:
        takes = ", ".join(kind.parameters) or "no parameters"
        raise InputError(f"--scheme {text}: cannot take {item!r}; it takes {takes}")
    try:
        return parameter, factor * float(number)
    except ValueError:
        raise InputError(f"--scheme {text}: {parameter} = {number!r}: must be a number") from None


@dataclass(frozen=True)
class Row:
    """A method under the name that the user gave it, and what is found about it; xi: damping."""

    name: str
    method: Method
    xi: float
    analysis: Survey

    @property
    def limit(self) -> float:
        """Largest stable dt/T [1]."""
        return self.analysis.limit / math.tau

    @property
    def rebound(self) -> float | None:
        """See `schemes.rebound`; None outside the members."""
        return members.rebound(self.method) if isinstance(self.method, Scheme) else None

    def rho(self, ratio: float) -> float:
        """Spectral radius [1] at dt/T = ratio."""
        return spectral.spectral_radius(self.method, math.tau * ratio, self.xi)


def remarks(row: Row) -> list[str]:
    """What a user should know before choosing this method, in a few words each."""
    result = []
    if row.limit == 0:
        result.append("unstable at any step")
    elif math.isfinite(row.limit):
        result.append(f"unstable above dt/T = {row.limit:.6g}")
    elif row.method.rho_infinity > 1 - _TINY:
        result.append("does not damp the fastest oscillations")
    w, least = row.analysis.least
    if least < min(row.method.rho_infinity, 1) - 0.01:
        result.append(f"least spectral radius {least:.5f} at dt/T = {w / math.tau:.4g}")
    scheme = row.method
    if isinstance(scheme, Scheme):
        if scheme.alpha_f < 0:
            result.append("alpha_f has the opposite sign of Abaqus' ALPHA")
        if abs(scheme.gamma - 0.5 + scheme.alpha_m - scheme.alpha_f) > 1e-9:
            result.append("first order: gamma is not 1/2 - alpha_m + alpha_f")
        if abs(members.rebound(scheme) - 1) < 1e-4:
            result.append("meets the energy-momentum criterion, paper B (12)")
    return result


def answer(row: Row, frequency: float, step: float) -> str:
    """What a method does to an oscillation of `frequency` [Hz] with steps of `step` [s]."""
    w = math.tau * frequency * step
    root = spectral.principal_root(row.method, w, row.xi)
    parts = [f"{row.name}: {_stability(row, frequency, step, root)}"]
    if math.isnan(root.real):
        return f"{parts[0]} Nothing oscillates any more: all its roots are real."
    added = 100 * spectral.numerical_damping(row.method, w, row.xi)
    if abs(added) < 100 * _TINY:
        parts.append("It adds no damping.")
    else:
        verb = "adds" if added > 0 else "takes away"
        parts.append(f"It {verb} {abs(added):.5g} % of critical damping.")
    retained = math.exp(math.tau * root.real / root.imag)
    right = math.exp(-math.tau * row.xi / math.sqrt(1 - row.xi**2))
    if abs(retained - 1) > _TINY:
        verb = "loses" if retained < 1 else "gains"
        change = f"{verb} {100 * abs(1 - retained):.4g} % of its amplitude a period"
        compared = f", where {100 * (1 - right):.4g} % is right" if row.xi else ""
        parts.append(f"A free vibration {change}{compared}.")
    longer = 100 * spectral.period_elongation(row.method, w, row.xi)
    if abs(longer) > 1e-9:
        parts.append(f"The period is {abs(longer):.4g} % too {'long' if longer > 0 else 'short'}.")
    return " ".join(parts)


def _stability(row: Row, frequency: float, step: float, root: complex) -> str:
    ratio = frequency * step
    rho = row.rho(ratio)
    if spectral.is_stable(row.method, math.tau * ratio, row.xi):
        return f"stable, spectral radius {rho:.6g}."
    text = f"UNSTABLE, spectral radius {rho:.6g}"
    if row.limit > 0:
        text += f" (stable up to a step of {row.limit / frequency:.4g} s)"
    if rho > math.exp(root.real) + 1e-6:
        text += "; a root other than the oscillation's own grows"
    return text + "."


def tables(rows: Sequence[Row]) -> list[Table]:
    """Parameters, stability and order; spectral radius; accuracy and impact."""
    slow = f"{spectral.SLOW_W / math.tau:g}"
    three = [
        _table("Parameters", *_PARAMETERS, "stable to\ndt/T", "order"),
        _table("Spectral radius at dt/T =", *(f"{r:g}" for r in RATIOS), "infinity"),
        _table(
            f"Accuracy at dt/T = {slow}, and impact",
            "numerical damping\n[% of critical]",
            "period\nelongation [%]",
            "rebound\nfrom a wall [1]",
        ),
    ]
    for row in rows:
        lines = (
            (
                *(_cell(getattr(row.method, name, None)) for name in _PARAMETERS),
                _LIMITS.get(row.limit, f"{row.limit:.6f}"),
                f"{row.analysis.order:.2f}",
            ),
            map(_cell, (*map(row.rho, RATIOS), row.method.rho_infinity)),
            map(_cell, (100 * row.analysis.damping, 100 * row.analysis.elongation, row.rebound)),
        )
        for table, cells in zip(three, lines, strict=True):
            table.add_row(row.name, *cells)
    return three


def _table(title: str, *columns: str) -> Table:
    table = Table(
        title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False
    )
    table.add_column("scheme", overflow="fold")
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    return table


def _cell(value: float | None) -> str:
    return cell(0.0 if value is not None and abs(value) < _TINY else value, ".6g")


def _record(row: Row, ratio: float | None) -> dict[str, Any]:
    """A method's line of the CSV file; ratio: the user's own dt/T, or None."""
    slow = f"at_{spectral.SLOW_W / math.tau:g}"
    at, least = row.analysis.least
    line: dict[str, Any] = {"scheme": row.name}
    line |= {name: getattr(row.method, name, "") for name in (*_PARAMETERS, "theta")}
    line |= {"physical_damping": row.xi, "stable_to": row.limit, "order": row.analysis.order}
    line |= {f"rho_at_{r:g}": row.rho(r) for r in RATIOS}
    line |= {"rho_infinity": row.method.rho_infinity, "least_rho": least, "least_at": at / math.tau}
    line |= {f"damping_{slow}": row.analysis.damping, f"elongation_{slow}": row.analysis.elongation}
    line |= {"rebound": row.rebound, "remarks": "; ".join(remarks(row))}
    if ratio is not None:
        case = (row.method, math.tau * ratio, row.xi)
        line |= {"dt_over_T": ratio, "is_stable": spectral.is_stable(*case), "rho": row.rho(ratio)}
        line |= {"damping": spectral.numerical_damping(*case)}
        line |= {"elongation": spectral.period_elongation(*case)}
    return line


def write_csv(rows: Sequence[Row], ratio: float | None, path: Path) -> None:
    """All numbers of the tables, one line a method, step lengths as dt/T; ratio: the user's own."""
    lines = [_record(row, ratio) for row in rows]
    with unfinished(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(lines[0]))
        writer.writeheader()
        writer.writerows(lines)


def present(
    names: Sequence[str], frequency: float | None, step: float | None, damping: float, out: Path
) -> dict[str, Any]:
    """Check everything, print the tables and the answers, write the pictures and the CSV file, of
    which the rows are returned.

    Raises `InputError` for what cannot be, before anything is written.
    """
    for option, value in (("--frequency", frequency), ("--step", step)):
        if value is not None and not 0 < value < math.inf:
            raise InputError(f"{option} {value:g}: must be > 0 and finite")
    if (frequency is None) != (step is None):
        given, other = ("--frequency", "--step") if step is None else ("--step", "--frequency")
        raise InputError(f"{given}: needs {other} too")
    ratio = None if frequency is None or step is None else frequency * step
    if ratio is not None and not _RATIOS_ALLOWED[0] <= ratio <= _RATIOS_ALLOWED[1]:
        low, high = _RATIOS_ALLOWED
        raise InputError(f"--frequency x --step = {ratio:g}: must lie between {low:g} and {high:g}")
    if not 0 <= damping < 1:
        raise InputError(f"--damping {damping:g}: must be at least 0 and below 1")
    methods = dict(map(parse_scheme, names))
    writable_folder(out)
    rows = [Row(n, m, damping, spectral.survey(m, damping)) for n, m in methods.items()]
    console = Console(highlight=False, markup=False)
    console.print(*tables(rows), f"With a physical damping ratio of {damping:g}:", sep="\n")
    for row in rows:
        if result := remarks(row):
            console.print(f"{row.name}: {'; '.join(result)}.", soft_wrap=True)
    if ratio is not None and frequency is not None and step is not None:
        head = f"An oscillation of {frequency:g} Hz with steps of {step:g} s: dt/T = {ratio:.4g}"
        console.print(f"\n{head}, {1 / ratio:.3g} steps a period.", soft_wrap=True)
        if ratio > 0.5:
            console.print("Fewer than two steps a period cannot show this frequency.")
        for row in rows:
            console.print(answer(row, frequency, step), soft_wrap=True)
    # matplotlib loads slowly, and a user with bad input should not wait for it
    from .schemes_figures import write_figures

    write_csv(rows, ratio, out / "schemes.csv")
    write_figures(methods, damping, ratio, out)
    console.print(f"written to {out}", soft_wrap=True)
    return {"rows": [_record(row, ratio) for row in rows], "out": str(out)}


@with_output_options
def schemes(
    scheme: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME=PARAMETERS, repeatable; default: those of paper B's Figure 1. "
            f"Names: {', '.join(KINDS)}."
        ),
    ] = None,
    frequency: Annotated[
        float | None, typer.Option(help="Your oscillation's frequency in Hz, with --step.")
    ] = None,
    step: Annotated[
        float | None, typer.Option(help="Your step length in seconds, with --frequency.")
    ] = None,
    damping: Annotated[float, typer.Option(help="Physical damping ratio.")] = 0.0,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/schemes"),
) -> dict[str, Any]:
    """What each time integrator does to an oscillation: tables and paper B's Figure 1."""
    try:
        return present(scheme or FIGURE_1, frequency, step, damping, out)
    except InputError as error:
        raise typer.BadParameter(str(error)) from error
