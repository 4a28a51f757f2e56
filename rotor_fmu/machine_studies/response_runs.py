"""Periodic responses as the subject of a study: a run is a whole curve with its jumps."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..model.quantities import QuantityError
from ..run_status import FAILED, status_of
from ..studies.study import Result
from .machine_runs import RUN, MachineRuns, machine_of
from .response_metrics import BRANCH, PARAMETER, STABLE, cells
from .run_excitation import Excitation

if TYPE_CHECKING:
    from ..periodic.result import ResponseResult


@dataclass(frozen=True)
class ResponseRuns(MachineRuns):
    """Periodic responses of a machine over its speed or another parameter."""

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a curve by name, with their units."""
        from ..periodic.result import UNITS, probes

        places = probes(machine_of(self.toml, False).rotor)
        of_places = {f"{place}.{q}": unit for place in places for q, unit in UNITS.items()}
        return of_places | {PARAMETER: self.unit, STABLE: "1", BRANCH: "1"}

    @property
    def unit(self) -> str:
        """The unit of what is varied along the curve."""
        rotor = machine_of(self.toml, False).rotor
        known = {str(name): described.unit for name, described, _ in rotor.parameters()}
        return known[self.how.over] if self.how.over else "rad/s"

    @cached_property
    def identity(self) -> str:
        """The machine, the response and what is kept, as text."""
        return json.dumps([super().identity, self.how.over])

    def warm(self) -> None:
        """Load the laws' tangents, by a machine that is condensed to them."""
        from ..model.periodic.linear_structure import Condensed

        Condensed(machine_of(self.toml, False).rotor)

    def run(self, values: Mapping[str, float]) -> Result:
        """Make one response; a failure in it, impossible values included, is its status."""
        try:
            result = self.response(values)
        except (InputError, QuantityError) as error:
            return Result(f"{FAILED}{error}", {})
        row_cells = {metric.name: cells(metric, result) for metric in self.metrics}
        return Result(status_of(result.notes), row_cells)

    def response(self, values: Mapping[str, float]) -> ResponseResult:
        """Return the response of a run. Raises `InputError` for impossible values."""
        from ..periodic.request import answer

        own = {name.removeprefix(RUN): v for name, v in values.items() if name.startswith(RUN)}
        of_machine = {name: v for name, v in values.items() if not name.startswith(RUN)}
        return answer(
            machine_of(self.toml, False).rotor,
            parameters={**self.values, **of_machine},
            **asked(self.how.changed(own)),
        )


def asked(how: Excitation) -> dict[str, Any]:
    """Return the options of `answer` for the numbers of a response."""
    n = how.numbers
    ends = n["from"], n["to"]
    return {
        "speed": n["speed"] if how.over else ends,
        "over": (how.over, *ends) if how.over else None,
        "period": int(n["period"]),
        "harmonics": int(n["harmonics"]),
        "share": n["share"],
        "step": n["length"],
        "branches": n["branches"] != 0,
    }
