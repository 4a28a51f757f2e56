"""The metrics of a run in time that are made of whole turns at a held speed, a function a kind."""

import math
from functools import partial

import numpy as np

from .metric import ROUNDING, ListAxis, Metric, MetricKind, declared, is_whole
from .run_excitation import LEAST_TURNS, Excitation, Window
from .run_kinds import CONSTANT, STEPS

KINDS: dict[str, MetricKind] = {}
_kind = partial(declared, KINDS)
_LARGEST = "largest"  # what a Lyapunov exponent is of: the whole machine
_LEVELS = (CONSTANT.name, STEPS.name)


def _turns(metric: Metric, how: Excitation) -> ListAxis:
    return ListAxis("turn")


def _spread(metric: Metric, window: Window) -> float:
    return float(window.turns.quantity(metric.of).std())


@_kind(
    "value once a turn, at the keyphasor's mark of {of}", axis=_turns, least=_spread, held=_LEVELS
)
def _poincare(metric: Metric, window: Window) -> np.ndarray:
    return window.turns.quantity(metric.of)[window.per_turn - 1 :: window.per_turn]


def _check_resolved(metric: Metric, option: str, how: Excitation) -> None:
    """Raise `InputError` for an order that the samples of a turn do not resolve."""
    order, per_turn = metric.option(option), how.numbers["per_turn"]
    if not 0 < order < per_turn / 2:
        raise metric.error(
            f"{option} = {order:g}: must be > 0 and below half of run.per_turn = {per_turn:g}"
        )


def _check_order(metric: Metric, how: Excitation) -> None:
    _check_resolved(metric, "order", how)
    order, turns = metric.option("order"), how.numbers["turns"]
    if not is_whole(order * turns):
        raise metric.error(f"order = {order:g}: must make whole periods in run.turns = {turns:g}")


@_kind(
    "amplitude of order {order:g} of the speed, 0-p, of {of}",
    "order",
    check=_check_order,
    least=_spread,
    held=_LEVELS,
)
def _order(metric: Metric, window: Window) -> float:
    """Return twice the modulus of the mean of x exp(-i order phi), over whole turns."""
    values = window.turns.quantity(metric.of)
    angle = math.tau * np.arange(1, len(values) + 1) / window.per_turn
    return float(2 * abs(np.mean(values * np.exp(-1j * metric.option("order") * angle))))


def _check_lyapunov(metric: Metric, how: Excitation) -> None:
    if metric.of != _LARGEST:
        raise metric.error(f"lyapunov = {metric.of!r}: must be {_LARGEST!r}")
    turns = how.numbers["turns"]
    if turns < LEAST_TURNS:
        raise metric.error(f"lyapunov needs run.turns >= {LEAST_TURNS}, not {turns:g}")


def _turns_per_second(metric: Metric, window: Window) -> float:
    return abs(window.speed) / math.tau


@_kind(
    "largest Lyapunov exponent",
    unit="1/s",
    check=_check_lyapunov,
    least=_turns_per_second,
    outputs=None,
    held=_LEVELS,
)
def _lyapunov(metric: Metric, window: Window) -> float:
    return window.exponent


def _spectrum_orders(highest: float, turns: int) -> np.ndarray:
    """Return the orders of a full spectrum over so many turns, from -highest to highest."""
    most = math.floor(highest * turns + ROUNDING)
    return np.arange(-most, most + 1) / turns


def _check_spectrum(metric: Metric, how: Excitation) -> None:
    _check_resolved(metric, "orders", how)


def _spectrum_axis(metric: Metric, how: Excitation) -> ListAxis:
    orders = _spectrum_orders(metric.option("orders"), int(how.numbers["turns"]))
    return ListAxis(f"{metric.name} order", tuple(orders.tolist()))


@_kind(
    "full spectrum, 0-p, negative orders backward, of {of}",
    "orders",
    unit="m",
    axis=_spectrum_axis,
    check=_check_spectrum,
    outputs=("x", "y"),
    held=(CONSTANT.name,),
)
def _spectrum(metric: Metric, window: Window) -> np.ndarray:
    """Return the amplitudes of the orders of x + i y; the mean is subtracted."""
    columns = window.turns.columns
    z = columns[f"{metric.of}.x"] + 1j * columns[f"{metric.of}.y"]
    if window.speed < 0:  # seen from behind, forward stays forward
        z = z.conj()
    turns = len(z) // window.per_turn
    result = np.abs(np.fft.fft(z - z.mean())) / len(z)
    lines = np.rint(_spectrum_orders(metric.option("orders"), turns) * turns).astype(int)
    return result[lines]
