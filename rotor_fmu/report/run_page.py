"""The page of a run or of two, one file that needs no network."""

import base64
import io
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

from ..about import __version__
from ..display import current
from ..errors import InputError, optional
from ..files import write_text
from ..model.machine.rotor import Rotor
from ..output_options import as_json_value
from ..runs.recording import Recording
from .criticals import criticals_of
from .report_tables import notices, tables
from .run_data import ROOM, run_data, signal_data

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ALWAYS = ("unpack.js", "chart.js")
_OF_RUNS = ("signals.js", "curves.js", "cascade.js", "bode.js", "over_speed.js", "run.js")


def write_report(recording: Recording, summary: Mapping[str, Any], path: Path) -> None:
    """Write the page of a run, as `write_page` does; summary: its figures by name."""

    def made() -> str:
        recording.check_rotation()
        return runs_page([recording.named(path.parent.resolve().name)], [summary])

    write_page(made, path)


def write_page(make: Callable[[], str], path: Path) -> None:
    """Write the page that `make` returns, whole or not at all; where what draws it is not installed
    a warning says so instead."""
    try:
        text = make()
    except InputError as error:
        print(f"warning: {path.name} is not written: {error}", file=sys.stderr)
    else:
        write_text(text, path)


def runs_page(runs: Sequence[Recording], summaries: Sequence[Mapping[str, Any]]) -> str:
    """Return the page of one or two runs as HTML."""
    found = [criticals_of(run) for run in runs]  # by linear analyses, which take a while
    data = [run_data(*both) for both in zip(runs, found, strict=True)]
    criticals = found[0].sentence  # those that are drawn
    if criticals and any(of_run != found[0] for of_run in found):
        criticals = f"{runs[0].name}: {criticals}"
    body = template("run.html").substitute(
        notices="\n".join(
            notices(run, d["why"], len(d["places"])) for run, d in zip(runs, data, strict=True)
        ),
        tables="\n".join(tables(*pair, len(runs)) for pair in zip(runs, summaries, strict=True)),
        machine=_machines(runs),
        criticals=f'<p class="about">{escape(criticals)}</p>\n' if criticals else "",
        **{word: " selected" * is_shown for word, is_shown in _chosen().items()},
        hidden=" hidden" if all(d["why"] for d in data) else "",
        single=" hidden" if len(runs) == 1 else "",
    )
    room = ROOM // len(runs)
    return page(
        title=" and ".join(dict.fromkeys(run.machine for run in runs)),
        about=" | ".join(run.name for run in runs),
        body=body,
        data={"runs": data},
        signals=[{"name": run.name, **signal_data(run, room)} for run in runs],
        scripts=_OF_RUNS,
    )


def _machines(runs: Sequence[Recording]) -> str:
    """Return the pictures of the machines that ran as HTML, one for runs of the same machine."""
    if len({run.about.get("toml") for run in runs}) == 1:
        return "" if runs[0].rotor is None else machine_html(runs[0].rotor)
    pictures = [machine_html(run.rotor, f"{run.name}: ") for run in runs if run.rotor is not None]
    return "\n".join(pictures)


def _chosen() -> dict[str, bool]:
    """The units that the page shows at first."""
    shown = current()
    is_mil = shown.small_unit == "mil"
    return {
        "rpm": shown.speed_unit == "rpm",
        "pp": shown.is_pp and not is_mil,
        "mil": is_mil and not shown.is_pp,
        "milpp": is_mil and shown.is_pp,
    }


def page(
    *,
    title: str,
    about: str,
    body: str,
    data: object,
    scripts: Sequence[str],
    signals: object = None,
    with_charts: bool = True,
) -> str:
    """Return a whole page; title and about are text, body is HTML; with_charts: whether its scripts
    draw charts, which need Bokeh."""
    library = _bokeh() if with_charts else ()
    always = _ALWAYS if with_charts else ()
    return template("page.html").substitute(
        head=head(title, template("page.css").template),
        about=escape(about),
        body=body,
        footer=f"rotor-fmu {__version__}",
        data=json_in_script(data),
        signals=json_in_script(signals),
        library="\n".join(f"<script>{script}</script>" for script in library),
        script="\n".join(template(name).template for name in (*always, *scripts)),
    )


def head(title: str, css: str, policy: str = "") -> str:
    """Return the beginning of a page with its title, which is text, as HTML; policy: what a browser
    lets it do, its Content-Security-Policy."""
    meta = f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n' if policy else ""
    filled = template("head.html").substitute(title=escape(title), css=css, policy=meta)
    return filled.removesuffix("\n")


def _bokeh() -> Sequence[str]:
    resources = optional("bokeh.resources", "report", "a page of a run")
    # the third is what Bokeh's own Python pages set up
    inline = resources.Resources(mode="inline", components=["bokeh", "bokeh-api"])
    scripts: list[str] = inline.js_raw[:2]
    return scripts


def template(name: str, package: str = __package__) -> Template:
    """Return a file of the folder `template` of a package."""
    return Template(files(package).joinpath("template", name).read_text(encoding="utf-8"))


def json_in_script(data: object) -> str:
    """Return data as JSON that can stand within a script of a page."""
    text = json.dumps(as_json_value(data), separators=(",", ":"), allow_nan=False)
    # "</script", "<!--" and "<script" mean something within a script, whatever holds them
    return text.replace("<", "\\u003c")


def machine_html(rotor: Rotor, of: str = "") -> str:
    """Return the machine's picture as HTML; of: the words before its caption."""
    from ..plotting.machine_drawing import machine_figure

    parts = ", ".join(name for name, part in rotor.named_parts() if hasattr(part, "node"))
    alt = f"{rotor.name} along its shaft of {rotor.length:.4g} m: {parts}"
    return figure_html(machine_figure(rotor), f"{of}The machine to scale", alt)


def figure_html(figure: "Figure", caption: str, alt: str = "") -> str:
    """Return a picture as HTML, drawn as SVG; alt: what it shows, by default its caption."""
    import matplotlib

    from ..plotting.figure_style import placed

    buffer = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "rotor-fmu"}), placed(figure):
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    picture = base64.b64encode(buffer.getvalue()).decode("ascii")
    return (
        f'<figure class="machine"><img alt="{escape(alt or caption, True)}" '
        f'src="data:image/svg+xml;base64,{picture}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )
