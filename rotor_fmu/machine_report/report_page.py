"""The report of a machine as one page: what it is, its linear analyses against API 617 and 684, and
what it does where its response closes a clearance."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, NamedTuple

import numpy as np

from ..display import current, range_with_unit, shown_speed, speed_with_unit
from ..linear import acceptance, answers, stability_answers
from ..linear.displayed import Displayed
from ..linear.inventory import inventory
from ..linear.linear_plots import grouped
from ..linear.linear_tables import clean_damping, numbers
from ..linear.mode_answers import mode_shapes_figure, shapes_for_page
from ..linear.where_linearized import where_films_are_left, where_linearized, which_bows_act
from ..model.linear import lowest_speed, placed_unbalances
from ..model.linear.linear_machine import shared_machine
from ..model.linear.modes import DEFAULT_COUNT, count_up_to
from ..model.linear.places import Place, PlacedAmount, as_place
from ..model.linear.subsynchronous import SubsynchronousWhirl, subsynchronous_whirl
from ..model.linear.unbalance import steady_whirl
from ..model.linear.unbalance_check import SPEEDS, highest_of_interest
from ..model.machine.rotor import Rotor
from ..report.report_tables import notice_html, table
from ..report.run_page import figure_html, machine_html, page, template
from ..run_status import first_of_each
from ..tables import Table
from .rub_check import RubCheck, rub_check
from .rub_shown import closings_table, rub_figure, runs_table

_SPEEDS = 41
_MODES = 6
_ONE_PEAK = 0.03


class Conclusion(NamedTuple):
    """What the report says of a check, and whether it is met; None where nothing was checked, or
    what it is checked by is not reached."""

    text: str
    is_met: bool | None


@dataclass(frozen=True)
class Report:
    """The report of a machine: its page as HTML, its numbers for JSON, its conclusions."""

    html: str
    numbers: Mapping[str, Any]
    conclusions: tuple[Conclusion, ...]


@dataclass(frozen=True)
class ReportOptions:
    """The speeds and places that a report is about.

    low, high: minimum and maximum continuous speed [rad/s]; probes: nodes (from 1), None: those
    that move most; mode: whose placed unbalances act, None: the machine's own, or those of the
    first mode if it has none; clearances: radial, by node [m]; couplings: cross-coupled stiffness
    by node [N/m].
    """

    low: float
    high: float
    probes: Sequence[int] | None = None
    mode: int | None = None
    clearances: Mapping[int, float] | None = None
    couplings: Mapping[int, float] | None = None


def machine_report(
    rotor: Rotor, options: ReportOptions, say: Callable[[str], None] = lambda text: None
) -> Report:
    """Return the report of a machine; say: is given what takes long. Raises `LinearError` for
    impossible options."""
    low, high = options.low, options.high
    at_rest = answers.static(rotor, afloat=high)  # first, since it refuses what is not held
    top = highest_of_interest(rotor, high)
    first = lowest_speed(rotor, top)
    speeds = np.linspace(first, top, _SPEEDS)
    listed = inventory(rotor)
    unbalances, mode = None, options.mode
    if mode is None and not steady_whirl(rotor).is_driven:
        mode = 1
    if mode is not None:
        placed = placed_unbalances(rotor, mode, high)
        unbalances = [p.acting for p in placed]
    at_speed = answers.modes(rotor, high, count=_MODES)
    count = count_up_to(rotor, top, DEFAULT_COUNT)
    diagram = answers.campbell(rotor, speeds, count=count)
    over_stiffness = acceptance.critical_map(rotor)
    curve = np.linspace(first, top, SPEEDS)
    nodes = options.probes or ()
    response = answers.response_with_peaks(rotor, curve, nodes=nodes, unbalances=unbalances)
    probes = list(nodes or response.nodes())
    check = acceptance.unbalance_check(
        rotor, low, high, probes, unbalances=unbalances, clearances=options.clearances
    )
    scale = check.scale if unbalances is not None and math.isfinite(check.scale) else 1.0
    level_1 = stability_answers.level_1(rotor, high, anticipated=options.couplings or 0.0)
    level_2 = stability_answers.level_2(rotor, high, cross_couplings=options.couplings)
    couplings = tuple((options.couplings or {}).items())
    whirl = subsynchronous_whirl(rotor, high, None, couplings)
    is_stable = not any(_unstable(diagram, high)) and all(c.is_met for c in _slower(whirl))
    rub = rub_check(rotor, low, high, unbalances, max(scale, 1.0), say, is_stable)
    left = where_films_are_left(rotor, response)
    conclusions = _conclusions(diagram, left, check, level_1, level_2, whirl, rub)
    sections = {
        "Machine": [machine_html(rotor), _html(listed.table())],
        "At rest": _at_rest(at_rest),
        "Critical speeds": [
            *(f"<p>{escape(sentence)}</p>" for sentence in where_linearized(rotor, speeds)),
            _html(diagram.table()),
            figure_html(diagram.figure((low, high)), "Campbell diagram"),
            *_shown(over_stiffness, "Undamped critical speed map"),
        ],
        "Mode shapes": [
            _html(at_speed.table()),
            _TURNING,
            figure_html(mode_shapes_figure(at_speed), "The same at one instant, with whirl orbits"),
        ],
        "Response to unbalance": [
            *(f"<p>{escape(sentence)}</p>" for sentence in _acting(rotor, unbalances, mode)),
            figure_html(response.figure(probes, (low, high)), "Steady response at the probes"),
            *_shown(check, "Amplification factors and separation margins"),
        ],
        "Stability": [
            *_shown(level_1, "Level 1: log dec over the cross coupling"),
            *_shown(level_2, "Level 2: what acts on the rotor"),
        ],
        "Into contact": _contact(rub),
    }
    about = f"by API 617 and 684 {range_with_unit(low, high)}, continued into contact"
    html = page(
        title=rotor.name,
        about=f"Rotor dynamics {about}",
        body=_body(conclusions, sections),
        data={"shapes": shapes_for_page(at_speed)},
        scripts=("modes.js",),
        with_charts=False,
    )
    said = {"machine": listed, "static": at_rest, "modes": at_speed, "campbell": diagram}
    said |= {"critical_map": over_stiffness, "response": response, "unbalance": check}
    said |= {"stability_level_1": level_1, "stability_level_2": level_2, "contact": rub}
    data = {name: numbers(answer) for name, answer in said.items()}
    return Report(html, data | {"conclusions": [c.text for c in conclusions]}, conclusions)


_TURNING = """<div class="controls"><label>mode <select id="mode"></select></label>
<label><input type="checkbox" id="running"> turning</label></div>
<figure><canvas id="shape" aria-label="mode shape in three dimensions"></canvas>
<figcaption>Drag to look from elsewhere; slowed down, and all modes alike</figcaption></figure>"""


_MET = {True: "met", False: "", None: "unchecked"}


def _body(conclusions: Iterable[Conclusion], sections: Mapping[str, Sequence[str]]) -> str:
    """Return the page's own part: the conclusions, then sections of HTML by their headings."""
    ids = {heading: heading.lower().replace(" ", "-") for heading in sections}
    return template("machine.html").substitute(
        notices="\n".join(notice_html(c.text, _MET[c.is_met]) for c in conclusions),
        contents=" | ".join(f'<a href="#{ids[heading]}">{heading}</a>' for heading in sections),
        sections="\n".join(
            "\n".join([f'<section id="{ids[heading]}"><h2>{heading}</h2>', *parts, "</section>"])
            for heading, parts in sections.items()
        ),
    )


def _html(of: Table) -> str:
    return table(of.title, of.heads, of.rows)


def _shown(answer: Displayed, caption: str) -> list[str]:
    return [_html(answer.table()), figure_html(answer.figure(), caption)]


def _at_rest(at_rest: answers.Static) -> list[str]:
    """Return the deflection at rest, or that there is none, as of a vertical machine."""
    if any(np.any(values) for values in (at_rest.x, at_rest.y, at_rest.load_x, at_rest.load_y)):
        return _shown(at_rest, "Deflection at rest")
    return ["<p>Nothing pulls across the shaft: nothing bends it, and no bearing is loaded.</p>"]


def _acting(rotor: Rotor, unbalances: Sequence[PlacedAmount] | None, mode: int | None) -> list[str]:
    bows = which_bows_act(rotor, unbalances)
    if unbalances is None:
        has_own = shared_machine(rotor).structure.unbalance.any()
        return ["The machine's own unbalances act.", *bows] if has_own else bows
    d = current()
    listed = ", ".join(
        f"{amount * d.unbalance:.4g} {d.unbalance_unit} {_where(as_place(at))} "
        f"({math.degrees(phase):.4g} deg)"
        for at, amount, phase in unbalances
    )
    return [f"Unbalances placed by API 617 for mode {mode}: {listed}.", *bows]


def _where(place: Place) -> str:
    if not place.offset:
        return f"at node {place.node}"
    d = current()
    return f"{place.offset * d.length:.4g} {d.length_unit} beyond node {place.node}"


def _contact(rub: RubCheck) -> list[str]:
    result = [f'<p class="verdict">{escape(rub.conclusion)}</p>']
    if rub.scale != 1.0:
        result.append(
            f"<p>The unbalance is {rub.scale:.4g} times the placed one, with which the probes "
            "reach their limit in the operating range.</p>"
        )
    if rub.runs:
        result += [
            *([_html(closings_table(rub))] if rub.closings else []),
            _html(runs_table(rub)),
            figure_html(rub_figure(rub), "Linear response beside the runs with contacts"),
        ]
    return result


def _unstable(diagram: answers.Campbell, high: float) -> Iterator[Conclusion]:
    """Yield what a threshold of stability below the highest speed means for all else."""
    if diagram.threshold is not None and diagram.threshold <= high:
        yield Conclusion(
            f"The machine is {diagram.stability}: there it does not come to its steady response, "
            "by which critical speeds, probes, clearances and contacts are judged.",
            False,
        )


def _stability(
    level_1: stability_answers.StabilityLevel1, level_2: stability_answers.StabilityLevel2
) -> Conclusion:
    log_dec = clean_damping(level_2.cases[-1].log_dec)
    if not math.isfinite(log_dec):
        text = "Stability: with all that acts a motion grows without oscillating."
    else:
        verdict = ", which is enough." if level_2.is_met else "; at least 0.1 is required."
        text = f"Stability: least log dec {log_dec:.3g} with all that acts{verdict}"
    asks = " Level 1 asks for level 2." if level_1.is_level_2_required else ""
    if level_1.depends_on_density:
        asks = " Level 1 asks for level 2 if the gas density lies in region B of API 617."
    return Conclusion(text + asks, level_2.is_met)


def _slower(whirl: SubsynchronousWhirl | None) -> Iterator[Conclusion]:
    """Yield what it means that pads follow a whirl at its own frequency, not that of rotation;
    nothing of whirls that are critically damped."""
    if whirl and not whirl.is_critically_damped:
        yield Conclusion(
            "Whirls slower than the rotation, with tilting pads that follow each at its own "
            f"frequency: least log dec {whirl.log_dec:.3g}, of {speed_with_unit(whirl.frequency)}.",
            whirl.log_dec > 0.0,
        )


def as_ranges(speeds: Iterable[float]) -> Iterator[str]:
    """Yield speeds [rad/s] in ascending order, as ranges those that differ by less than _ONE_PEAK:
    probes and directions have the peak of one critical speed at slightly different ones."""
    for group in grouped(sorted(speeds), lambda speed, first: speed < (1 + _ONE_PEAK) * first):
        yield " to ".join(dict.fromkeys(shown_speed(end) for end in (group[0], group[-1])))


def _critical_speeds(check: acceptance.UnbalanceCheck) -> Conclusion:
    near = [c for c in check.criticals if c.margin is not None and not c.margin.is_met]
    if near:
        speeds = f"{', '.join(as_ranges(c.peak.speed for c in near))} {current().speed_unit}"
        return Conclusion(f"Critical speeds too near to the operating range: {speeds}.", False)
    if check.criticals:
        return Conclusion("All critical speeds have their separation margins.", True)
    highest = speed_with_unit(check.top)
    share = f"{100 * check.top / check.high:.4g} % of the highest one of the operating range"
    return Conclusion(f"The response shows no critical speed up to {highest}, {share}.", True)


def _probes(check: acceptance.UnbalanceCheck) -> Conclusion:
    limit = f"{check.limit * current().small:.3g} {current().small_word} peak-to-peak"
    loud = ", ".join(f"node {p.node}" for p in check.probes if p.peak_to_peak > check.limit)
    if loud:
        return Conclusion(f"Probes above {limit}: {loud}.", False)
    return Conclusion(f"All probes stay below {limit}.", True)


def _clearances(check: acceptance.UnbalanceCheck, are_films: bool) -> Iterator[Conclusion]:
    """Yield what is said of clearances; are_films: whether something is said of those of films."""
    if tight := ", ".join(c.name for c in check.clearances if not c.is_met):
        yield Conclusion(f"More than 75 % of a clearance is taken: {tight}.", False)
    elif check.clearances:
        yield Conclusion("No clearance is taken by more than 75 %.", True)
    elif not are_films:
        yield Conclusion(
            "No clearance was checked: no open contact and no --clearance is there.", None
        )


def _conclusions(
    diagram: answers.Campbell,
    left: Sequence[str],
    check: acceptance.UnbalanceCheck,
    level_1: stability_answers.StabilityLevel1,
    level_2: stability_answers.StabilityLevel2,
    whirl: SubsynchronousWhirl | None,
    rub: RubCheck,
) -> tuple[Conclusion, ...]:
    messages = first_of_each(message for run in rub.runs for message in run.messages)
    unstable = tuple(_unstable(diagram, check.high))
    steady = [
        _critical_speeds(check),
        _probes(check),
        *_clearances(check, bool(left or rub.closings)),
    ]
    contact = Conclusion(rub.conclusion, not (rub.closings or rub.touched))
    if unstable:  # what is kept by a response that is not reached says nothing
        *steady, contact = (c._replace(is_met=None) if c.is_met else c for c in (*steady, contact))
    return (
        *unstable,
        *(Conclusion(f"{sentence[0].upper()}{sentence[1:]}.", False) for sentence in left),
        *steady,
        _stability(level_1, level_2),
        *_slower(whirl),
        contact,
        *(Conclusion(message, False) for message in messages),
    )
