"""`docs/explanation/integrators.md`: a template, and the numbers of a survey's table."""

import posixpath
import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from string import Template

from rotor_fmu.cells import markdown_table
from rotor_fmu.plotting.figure_style import save

from .. import order_five, tolerances
from . import false_state_figures, survey_plots
from .false_state_numbers import of_its_power, of_the_false_state
from .findings import Findings
from .grid import Row
from .hidden import hidden_head, hidden_rows
from .impact_numbers import of_the_impacts
from .run_down_numbers import of_the_run_downs

PAGE, _TEMPLATE = "explanation/integrators.md", "integrators.md"
_OF_TEMPLATE, _OF_PAGE = "papers/integrators/survey", "docs/explanation"  # where links start from


def write_page(rows: Sequence[Row], out: Path) -> Path:
    """Write the page and its pictures to `out`, laid out as docs/ is; returns the page's path."""
    findings = Findings(rows)
    folder = out / "figures"
    folder.mkdir(exist_ok=True)
    pictures = {
        "error": survey_plots.error(findings),
        "false_state": survey_plots.false_states(findings),
        "bars": survey_plots.bars(findings),
        "ratchet": survey_plots.ratchet(findings),
        "orbit": false_state_figures.orbits(),
        "power": false_state_figures.power(findings),
        "lasting": false_state_figures.lasting(findings),
        "phase": false_state_figures.phases(),
        "bounce": false_state_figures.impacts(findings),
    }
    for name, figure in pictures.items():
        save(figure, folder / f"integrators_{name}.png")
    page = out / PAGE
    page.parent.mkdir(exist_ok=True)
    page.write_text(page_text(findings), encoding="utf-8")
    return page


def page_text(findings: Findings) -> str:
    """The page: the template beside this module, and the numbers of the table."""
    template = files(__package__).joinpath(_TEMPLATE).read_text(encoding="utf-8")
    numbers = {
        **of_the_run_downs(findings),
        **of_the_false_state(findings),
        **of_its_power(findings),
        **of_the_impacts(findings),
        "hidden_table": markdown_table(hidden_head(), hidden_rows()),
        "tolerance_table": markdown_table(tolerances.head(), tolerances.table(tolerances.rows())),
        "worst_table": markdown_table(tolerances.worst_head(), tolerances.worst(tolerances.rows())),
        **tolerances.in_words(tolerances.rows()),
        "five_table": markdown_table(order_five.head(), order_five.table(order_five.rows())),
        "five_tolerance_table": markdown_table(
            order_five.tolerance_head(order_five.rows()),
            order_five.tolerance_table(order_five.rows()),
        ),
        **order_five.in_words(order_five.rows()),
    }
    return re.sub(r"(?<=\]\()[^)#:]+", _relinked, Template(template).substitute(numbers))


def _relinked(link: re.Match[str]) -> str:
    """The link to a file as it is from the page, of a link that holds from the template."""
    target = posixpath.normpath(posixpath.join(_OF_TEMPLATE, link[0]))
    return posixpath.relpath(target, _OF_PAGE)
