"""Operating speeds of a machine in the terms of API 684, and its run-up and run-down rates."""

from dataclasses import dataclass
from itertools import pairwise

from ..quantities import NOT_NEGATIVE, POSITIVE, QuantityError, check, quantities, quantity

# Speeds of which none may lie below the one before.
_ASCENDING = ("minimum_speed", "rated_speed", "maximum_continuous_speed", "trip_speed")


@dataclass(frozen=True)
class Operation:
    """The table `[operation]` of a machine file; None: not given.

    Raises `QuantityError` for an impossible value, and for speeds that do not ascend.
    """

    rated_speed: float | None = quantity(
        "rad/s", "rated speed, at which its FMU starts", POSITIVE, None
    )
    minimum_speed: float | None = quantity(
        "rad/s", "lowest speed of the operating range", NOT_NEGATIVE, None
    )
    maximum_continuous_speed: float | None = quantity(
        "rad/s", "highest speed of the operating range, where a run-up ends", POSITIVE, None
    )
    trip_speed: float | None = quantity(
        "rad/s", "speed at which it is shut down, where a run-down begins", POSITIVE, None
    )
    run_up_rate: float | None = quantity("rad/s2", "rate of the speed in a run-up", POSITIVE, None)
    run_down_rate: float | None = quantity(
        "rad/s2", "rate of the speed in a run-down, without sign", POSITIVE, None
    )

    def __post_init__(self) -> None:
        for name, declared in quantities(self).items():
            if getattr(self, name) is not None:
                check(f"operation.{name}", declared, getattr(self, name))
        given = [(name, value) for name in _ASCENDING if (value := getattr(self, name)) is not None]
        for (below, low), (above, high) in pairwise(given):
            if not low <= high:
                raise QuantityError(
                    f"operation.{above} = {high:g} rad/s: must be at least operation.{below} = "
                    f"{low:g} rad/s"
                )

    @property
    def continuous_speeds(self) -> list[float]:
        """The given speeds at which the machine may run continuously [rad/s], ascending."""
        return [speed for name, speed in self.speeds.items() if name != "trip_speed"]

    @property
    def service_speed(self) -> float | None:
        """The highest given speed at which the machine runs continuously [rad/s], its maximum
        continuous or its rated speed, if there is one."""
        return self.maximum_continuous_speed or self.rated_speed

    @property
    def speeds(self) -> dict[str, float]:
        """The given speeds [rad/s], by their names, ascending."""
        return {n: value for n in _ASCENDING if (value := getattr(self, n)) is not None}
