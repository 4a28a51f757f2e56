"""What SIMD lanes would give a core: python -m benchmarks.lanes

The implicit step (band, contacts) written for 1, 2, 4 and 8 machines at once (`lanes.cpp`), each
with its own step length, clearance, friction and unbalance, against the same source with one;
beside it how uneven machines are, for which lanes wait. Needs `pip install ziglang`; CPU time.
"""

import ctypes
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.recorder import Record

from rotor_fmu.fmi.binding import build_simulation
from rotor_fmu.fmi.interface import interface

SOURCE = Path(__file__).with_suffix(".cpp")
FLAGS = "-O3 -march=native -mprefer-vector-width=512 -fno-exceptions -fno-math-errno -fPIC -shared"
WIDTHS = (1, 2, 4, 8)
MACHINES = 16
SPEEDS = (350.0, 240.0, 190.0, 120.0)  # along the run-down, at which lanes are timed [rad/s]
STEPS, REPETITIONS = 20_000, 5
MOST, CONTACTS, UNBALANCES = 64, 2, 8  # of lanes.cpp
_POINTER = ctypes.POINTER(ctypes.c_double)
_INTEGERS = ctypes.POINTER(ctypes.c_longlong)


class Machine(ctypes.Structure):
    """What all lanes share, as in lanes.cpp."""

    _fields_ = [
        *((name, ctypes.c_longlong) for name in ("n", "width", "unbalances")),
        *((name, _POINTER) for name in ("M", "C", "K", "G", "weight")),
        *((name, _INTEGERS) for name in ("unbalance_dof", "contact_dof")),
        ("housing", ctypes.c_double * 5),
        ("contact", ctypes.c_double * 5),
        ("scheme", ctypes.c_double * 4),
        ("g", ctypes.c_double),
    ]


def lanes_type(width: int) -> np.dtype:
    """`Lanes` of lanes.cpp: every number once a lane."""
    real, cx = ("f8", (width,)), ("f8", (2, width))
    fields: list[tuple[str, str, tuple[int, ...]]]
    fields = [(name, *real) for name in ("h", "omega", "clearance", "mu")]
    fields += [("turned", *cx), ("turn", *cx), ("unbalance", "f8", (UNBALANCES, 2, width))]
    fields += [(name, "f8", (MOST, 2, width)) for name in ("q", "v", "a", "v_dot")]
    fields += [("force", "f8", (CONTACTS, 2, width))]
    return np.dtype([*fields, ("iterations", *real), ("failed", *real)])


def built(folder: Path, width: int) -> ctypes.CDLL:
    """The step for so many machines."""
    path = folder / f"lanes{width}.so"
    command = [sys.executable, "-m", "ziglang", "c++", *FLAGS.split(), f"-DLANES={width}"]
    subprocess.run([*command, "-o", str(path), str(SOURCE)], check=True)
    library = ctypes.CDLL(str(path))
    assert library.lanes_bytes() == lanes_type(width).itemsize
    return library


def varied(rng: np.random.Generator) -> Simulation:
    """The rig at 400 rad/s with clearance, friction and unbalance drawn."""
    rotor = rig()
    table = interface(rotor)
    values = {v.name: v.start for v in table if v.start is not None}
    values |= {"speed": 400.0, "speed_rate": -10.0, "solver.tolerance": 1e-2}
    clearance, mu, e = rng.uniform(30e-6, 70e-6), rng.uniform(0.02, 0.2), rng.uniform(50e-6, 110e-6)
    values |= {f"bearing[{k}].clearance": clearance for k in (1, 2)}
    values |= {f"bearing[{k}].mu": mu for k in (1, 2)} | {f"disc[{k}].e": e for k in (1, 2, 3)}
    taped = Record(("solver.newton",), 0.0, 16384)
    return build_simulation(rotor, table, values, lambda _: None, record=taped)


def machine_of(simulation: Simulation) -> tuple[Machine, list[np.ndarray]]:
    """What the lanes share, and the arrays that it points to."""
    s = simulation.structure
    contact, housing = s.laws[0][0], s.housings[0]
    arrays = s.M, s.C, s.K, s.G, s.static_load.imag
    references = [np.ascontiguousarray(x, dtype=float) for x in arrays]
    references += [
        np.ascontiguousarray(x, dtype=np.int64) for x in (s.unbalances.dof, s.interfaces.dof)
    ]
    numbers = [*s.M.shape, len(s.unbalance)]
    pointers = [a.ctypes.data_as(_POINTER if a.dtype == float else _INTEGERS) for a in references]
    of_housing = [housing[name] for name in ("mass", "kx", "ky", "cx", "cy")]
    of_contact = [contact[name] for name in ("k", "c", "delta_c", "v_s", "journal_radius")]
    scheme = simulation.settings.numbers
    machine = Machine(*numbers, *pointers)
    machine.housing[:], machine.contact[:] = of_housing, of_contact
    machine.scheme[:] = [scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma]
    machine.g = float(s.numbers[0]["gravity"])
    return machine, references


class State(NamedTuple):
    """A machine where lanes take it up: its own numbers, and its motion by the names of `Lanes`."""

    numbers: dict[str, float]
    motion: dict[str, np.ndarray]


def state_of(own: Simulation, h: float = 0.0) -> State:
    """The present state of a simulation, to go on in steps of h [s], or as long as its last."""
    contact, omega = own.structure.laws[0][0], own.read("w")
    h = h or own.read("solver.h_last")
    numbers = {"h": h, "omega": omega, "clearance": contact["clearance"], "mu": contact["mu"]}
    turned = np.exp(1j * np.array([own.read("phi"), omega * h]))
    motion = {name: getattr(own.motion, name).copy() for name in ("q", "v", "a", "v_dot", "force")}
    motion |= {"turned": turned[:1], "turn": turned[1:], "unbalance": own.structure.unbalance}
    return State(numbers, motion)


def lanes_of(states: Sequence[State]) -> np.ndarray:
    """Machines as lanes of a `Lanes`."""
    kind = lanes_type(len(states))
    room = np.zeros(kind.itemsize + 64, dtype=np.uint8)  # vectors lie at multiples of their size
    lanes = room[-room.ctypes.data % 64 :][: kind.itemsize].view(kind)
    for lane, state in enumerate(states):
        for name, value in state.numbers.items():
            lanes[name][0, lane] = value
        for name, values in state.motion.items():
            into = lanes[name][0].reshape(-1, 2, len(states))[: len(values)]
            into[:, 0, lane], into[:, 1, lane] = values[: len(into)].real, values[: len(into)].imag
    return lanes


def march(library: ctypes.CDLL, machine: Machine, lanes: np.ndarray, steps: int) -> float:
    """Take lanes further; returns the CPU time a machine and step [s]."""
    begun = time.process_time()
    library.lanes_march(
        ctypes.byref(machine), lanes.ctypes.data_as(ctypes.c_void_p), ctypes.c_longlong(steps)
    )
    return (time.process_time() - begun) / steps / lanes["h"].size


def apart(library: ctypes.CDLL, width: int) -> float:
    """Largest distance after 1000 steps of 0.1 ms between a lane and the project's own step [m]."""
    own = Simulation(rig(), choose("robust", h=1e-4), speed=190.0)
    own.advance(0.5, 190.0)
    machine, _kept = machine_of(own)
    lanes = lanes_of([state_of(own, 1e-4)] * width)
    own.advance(0.6, 190.0)
    march(library, machine, lanes, 1000)
    exact = own.motion.q[:-1, None]
    result = lanes["q"][0, : len(exact), 0] + 1j * lanes["q"][0, : len(exact), 1]
    return float(np.abs(result - exact).max())


class Whole(NamedTuple):
    """A run-down at the tolerance 1e-2: states at `SPEEDS`; Newton's iterations of each step, shape
    (steps,); steps repeated; CPU time of a step, those repeated included [s]; what lanes share."""

    states: list[State]
    newton: np.ndarray
    repeated: float
    cpu: float
    machine: tuple[Machine, list[np.ndarray]]


def run_down(own: Simulation) -> Whole:
    """Run a machine down as a study does, given its speed every 0.04 s."""
    states: list[State] = []
    recordings, used = [own.drain()], 0.0
    for k in range(1, 1001):
        if len(states) < len(SPEEDS) and own.read("w") <= SPEEDS[len(states)]:
            states.append(state_of(own))
        begun = time.process_time()
        own.advance(0.04 * k, 400.0 - 0.4 * (k - 1))
        used += time.process_time() - begun
        recordings.append(own.drain())
    newton = np.diff(np.concatenate(recordings)[:, 1])
    repeated = own.read("solver.rejected")
    return Whole(states, newton, repeated, used / (len(newton) + repeated), machine_of(own))


def timed(library: ctypes.CDLL, runs: Sequence[Whole], width: int) -> tuple[float, float]:
    """CPU time a machine and step of all runs, taken in lanes [s], and the share of steps that are
    not solved without damping, which are left as they are."""
    costs, unsolved = [], []
    for at in range(len(SPEEDS)):
        for first in range(0, len(runs), width):
            lanes = lanes_of([run.states[at] for run in runs[first : first + width]])
            costs.append(march(library, runs[0].machine[0], lanes, STEPS))
            unsolved.append(lanes["failed"].mean() / STEPS)
    return float(np.mean(costs)), float(np.mean(unsolved))


def waited(runs: Sequence[Whole], width: int) -> tuple[float, float]:
    """What lanes in step do over what their machines need: Newton's iterations, and steps of whole
    runs where a lane that has ended stays empty [1]."""
    newton, steps = [], []
    for first in range(0, len(runs), width):
        group = [run.newton for run in runs[first : first + width]]
        least = min(map(len, group))
        together = np.array([iterations[:least] for iterations in group])
        newton.append(together.max(axis=0).mean() / together.mean())
        lengths = np.array([len(iterations) for iterations in group])
        steps.append(lengths.max() / lengths.mean())
    return float(np.mean(newton)), float(np.mean(steps))


def main() -> None:
    """Print both tables."""
    rng = np.random.default_rng(1)
    runs = [run_down(varied(rng)) for _ in range(MACHINES)]
    whole = statistics.median(run.cpu for run in runs)
    newton = np.concatenate([run.newton for run in runs])
    lengths = sorted(len(run.newton) for run in runs)
    print(
        f"{MACHINES} run-downs, tolerance 1e-2: {lengths[0]} to {lengths[-1]} steps each, "
        f"{sum(run.repeated for run in runs) / sum(lengths):.1%} repeated"
    )
    shares = [f"{k}: {np.mean(newton == k):.1%}" for k in (1, 2, 3, 4)]
    print(
        f"Newton's iterations a step: {newton.mean():.2f}; {', '.join(shares)}, "
        f"more: {np.mean(newton > 4):.1%}, at most {newton.max():.0f}"
    )
    print(f"the project's whole step, ledger and step control included: {1e6 * whole:.2f} us\n")
    print("| machines | us a machine and step | to one | Newton's lanes | steps' lanes |")
    print("| ---: | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as name:
        libraries = {width: built(Path(name), width) for width in WIDTHS}
        distance = max(apart(library, width) for width, library in libraries.items())
        rows: dict[int, list[tuple[float, float]]] = {width: [] for width in WIDTHS}
        for _ in range(REPETITIONS):  # in turns, so that a busy machine slows all alike
            for width, library in libraries.items():
                rows[width].append(timed(library, runs, width))
    costs = {width: statistics.median(cost for cost, _ in result) for width, result in rows.items()}
    for width, cost in costs.items():
        by_newton, by_steps = waited(runs, width)
        print(
            f"| {width} | {1e6 * cost:.2f} | {costs[1] / cost:.2f} | {by_newton:.2f} | "
            f"{by_steps:.2f} |"
        )
    share = costs[1] / whole
    most = 1 / (1 - share + share * costs[8] / costs[1])
    print(
        f"\none lane is {share:.0%} of the whole step: with this part in lanes alone {most:.2f} x"
    )
    print(f"{rows[1][0][1]:.2%} of the lanes' steps were left unsolved")
    print(f"a lane and the project's step differ by {distance:.1e} m after 1000 steps")


if __name__ == "__main__":
    main()
