"""A run-down or a run-up as a user gives it, completed by how the machine is run."""

from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import InputError
from ..model.machine.rotor import Rotor
from ..operating_speeds import operating_speeds
from ..units import in_si
from .input_signals import Ramp

_UNITS = {"--from": "rad/s", "--to": "rad/s", "--rate": "rad/s2", "--hold": "s"}


@dataclass(frozen=True)
class RampGiven:
    """What a user gave of a ramp: whether it goes up, and texts with units, None where nothing was
    given."""

    is_up: bool = False
    first: str | None = None
    last: str | None = None
    rate: str | None = None
    hold: str | None = None

    @property
    def options(self) -> Mapping[str, str]:
        """The options that were given, with their texts."""
        texts = (self.first, self.last, self.rate, self.hold)
        return {o: text for o, text in zip(_UNITS, texts, strict=True) if text is not None}

    def on(self, rotor: Rotor) -> Ramp:
        """Return the ramp of this machine; `InputError` for one that cannot be."""
        usual = operating_speeds(rotor)
        given = {
            option: in_si(option, text, _UNITS[option]) for option, text in self.options.items()
        }
        first = given.get("--from", 0.0 if self.is_up else usual.trip)
        last = given.get("--to", usual.highest if self.is_up else 0.0)
        rate = given.get("--rate", usual.run_up_rate if self.is_up else usual.run_down_rate)
        hold = given.get("--hold", 0.0)
        if not rate > 0:
            raise InputError(f"--rate {self.rate}: must be > 0; the speeds say whether up or down")
        if not hold >= 0:
            raise InputError(f"--hold {self.hold}: must be >= 0")
        if first == last:
            raise InputError(f"--from {first:g} rad/s: must differ from --to {last:g} rad/s")
        if (abs(last) > abs(first)) != self.is_up:
            way, other = ("larger", "run-down") if self.is_up else ("smaller", "run-up")
            raise InputError(
                f"--to {last:g} rad/s: must be {way} in size than --from = {first:g} rad/s; the "
                f"other way is {other}"
            )
        return Ramp(first, last, rate, *((0.0, hold) if self.is_up else (hold, 0.0)))
