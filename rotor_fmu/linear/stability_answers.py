"""Stability by API 617, levels 1 and 2, for Python and the command line: the objects of
`model.linear`, which a notebook shows as a table and a picture."""

import math

import numpy as np
from matplotlib.figure import Figure

from ..display import current, speed_with_unit
from ..model import linear
from ..model.linear.stability_levels import LEAST_LOG_DEC, LEAST_RATIO
from ..plotting.colors import BLUE, GREEN, GREY, LIMIT, ORANGE, PURPLE
from ..plotting.figure_style import entitle, new_figure
from ..tables import Table
from .displayed import Displayed, answer_of
from .linear_tables import clean_damping


def _grows(log_dec: float) -> str:
    """Return what is said of a logarithmic decrement that a motion without oscillation has."""
    return "; UNSTABLE: a motion grows without oscillating" if log_dec == -math.inf else ""


class StabilityLevel1(Displayed, linear.StabilityLevel1):
    """`model.linear.StabilityLevel1`, shown."""

    def table(self) -> Table:
        """Return a table of the figures that level 1 asks for."""
        conclusion = f"level 2 is {'' if self.is_level_2_required else 'not '}required"
        if self.depends_on_density:
            conclusion += " unless gas density and critical speed ratio lie in region B of API 617"
        title = (
            f"Stability level 1 at {speed_with_unit(self.speed)}, cross coupling at node "
            f"{self.node}: {conclusion}{_grows(self.log_dec_alone)}"
        )
        if not self.anticipated:
            title += (
                "; no stage and no cross coupling was given: QA is 0, and the rotor alone is judged"
            )
        q, unit = current().stiffness, current().stiffness_unit
        threshold = "unstable nowhere" if self.threshold is None else self.threshold * q
        ratio = self.ratio if math.isfinite(self.ratio) else "-"
        rows: list[tuple[object, ...]] = [
            ("least log dec without cross coupling [1]", clean_damping(self.log_dec_alone), ""),
            ("that of the first forward mode [1]", clean_damping(self.first_alone), ""),
            (f"QA, anticipated cross coupling [{unit}]", self.anticipated * q, ""),
            (
                "least log dec with QA [1]",
                clean_damping(self.log_dec_anticipated),
                f">= {LEAST_LOG_DEC:g}",
            ),
            ("that of the first forward mode [1]", clean_damping(self.first_anticipated), ""),
            (f"Q0, where the rotor becomes unstable [{unit}]", threshold, ""),
            ("Q0 / QA [1]", ratio, f">= {LEAST_RATIO:g}"),
            (f"sensitivity of the least log dec [1/({unit})]", self.sensitivity / q, ""),
            ("critical speed ratio [1]", self.critical_speed_ratio, ""),
        ]
        return Table(title, ("", "value", "API 617"), rows)

    def figure(self) -> Figure:
        """Draw the logarithmic decrement over the cross coupling, with QA and Q0."""
        figure, axes = new_figure(6.8, 4.0)
        d = current()
        over = self.stiffness * d.stiffness
        if not np.allclose(self.log_dec, self.first_log_dec, rtol=1e-6):
            axes.plot(over, self.first_log_dec, color=GREY, lw=1.2, label="first forward mode")
        axes.plot(over, self.log_dec, color=BLUE, lw=1.8)
        axes.axhline(0, color="black", lw=1.0)
        label = f"required, {LEAST_LOG_DEC:g}"
        axes.axhline(LEAST_LOG_DEC, color=GREY, lw=1.0, ls=LIMIT, label=label)
        if self.anticipated:
            at = self.anticipated * d.stiffness
            axes.axvline(at, color=GREEN, lw=1.3, label="QA, anticipated")
        if self.threshold is not None:
            at = self.threshold * d.stiffness
            axes.axvline(at, color=ORANGE, lw=1.3, ls=":", label="Q0, unstable above")
        axes.set(xlim=over[[0, -1]], ylabel="Logarithmic decrement [1]")
        axes.set_xlabel(f"Cross-coupled stiffness at node {self.node} [{d.stiffness_unit}]")
        entitle(axes, self.titled(f"Least of the forward modes at {speed_with_unit(self.speed)}"))
        axes.legend(framealpha=0.9, edgecolor="none", fontsize=8)
        return figure


class StabilityLevel2(Displayed, linear.StabilityLevel2):
    """`model.linear.StabilityLevel2`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each case."""
        d = current()
        rows = [
            (
                *(c.name, clean_damping(c.log_dec), c.frequency * d.speed),
                *(clean_damping(c.first_log_dec), c.first_frequency * d.speed),
            )
            for c in self.cases
        ]
        unit = f"f_d [{d.frequency_unit}]"
        title = (
            f"Stability level 2 at {speed_with_unit(self.speed)}: least log dec of the forward "
            f"modes >= {LEAST_LOG_DEC:g} {'met' if self.is_met else 'NOT met'}"
            f"{_grows(self.cases[-1].log_dec)}"
        )
        return Table(title, ("what acts", "least log dec", unit, "first forward", unit), rows)

    def figure(self) -> Figure:
        """Draw the logarithmic decrement of each case."""
        figure, axes = new_figure(6.8, 1.4 + 0.35 * len(self.cases))
        values = [case.log_dec for case in self.cases]
        colors = [GREEN if value >= LEAST_LOG_DEC else PURPLE for value in values]
        sizes = [value if np.isfinite(value) else 0.0 for value in values]
        shown = [
            f"{value:.3g}" if np.isfinite(value) else "grows without oscillating"
            for value in values
        ]
        names = [f"{case.name}: {text}" for case, text in zip(self.cases, shown, strict=True)]
        axes.barh(names, sizes, color=colors, height=0.6)
        axes.axvline(LEAST_LOG_DEC, color="black", lw=1.0, ls=LIMIT)
        axes.axvline(0, color="black", lw=1.0)
        axes.invert_yaxis()
        axes.margins(x=0.12)
        what = "Least logarithmic decrement of the forward modes [1]"
        axes.set_xlabel(f"{what}; dashed: {LEAST_LOG_DEC:g}")
        entitle(axes, self.titled(f"Stability level 2 at {speed_with_unit(self.speed)}"))
        return figure


level_1 = answer_of(StabilityLevel1, linear.level_1)
level_2 = answer_of(StabilityLevel2, linear.level_2)
