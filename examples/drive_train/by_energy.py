"""A motor on a stiff shaft and the rotor through libcosim: its ECCO, which chooses communication
steps by the energy that a power bond loses, and its fixed steps."""

import csv
import io
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rotor_fmu.examples import example_folder
from rotor_fmu.model.kernels.library import here
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.system import OSP_NAME, Bond, Component, System
from rotor_fmu.errors import RunFailed
from rotor_fmu.fmi.packing.archive import xml_bytes
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

FIRST = 5e-5  # ECCO's first step [s]


@dataclass(frozen=True)
class Stepped:
    """A run of libcosim: ends of its steps [s], speed of the rotor there [rad/s], energy lost at
    the joint relative to what passed [1], and seconds that its process took."""

    t: np.ndarray
    w: np.ndarray
    lost: float
    seconds: float

    @property
    def steps(self) -> tuple[float, float]:
        """The shortest and the longest step [s]."""
        lengths = np.diff(self.t, prepend=0.0)
        return float(lengths.min()), float(lengths.max())

    def error(self, expected: np.ndarray, every: float) -> float:
        """Return the largest error of the speed, relative; expected: the speed [rad/s] at every
        multiple of `every` [s]."""
        t = every * np.arange(1, 1 + len(expected))
        return float(np.max(np.abs(np.interp(t, self.t, self.w) / expected - 1.0)))


def motor_and_rotor(out: Path, motor: Mapping[str, float]) -> System:
    """Build `motor_on_shaft.py` with these parameters and the rotor that a torque drives in the
    folder `out`, and return them as a system with a power bond."""
    source = Coupling(example_folder("drive_train") / "motor_on_shaft.py")
    start = motor["w_start"]
    one = Component("motor", source.build(out), source.variables, {**motor, "w": start})
    machine = machine_of(rig_toml(), True, 0)
    fmu = build_native(out, machine_of(rig_toml(), is_free=True), platforms=[str(here())])
    other = Component("rotor", fmu, machine.table, {"w_start": start})
    bond = Bond("shaft", ("motor", "tau", "rotor", "tau_drive"), ("rotor", "w", "motor", "w"))
    return System("motor on a stiff shaft", (one, other), (bond,), FIRST, 1.0)


def through_libcosim(system: System, stop: float) -> Stepped:
    """Run a system of `motor_and_rotor` to `stop` [s]. Raises `RunFailed` if libcosim does."""
    file = system.components[0].fmu.with_name(OSP_NAME)
    file.write_bytes(xml_bytes(system.osp()))
    script = example_folder() / "with_libcosim.py"
    shown = ("rotor.w", "motor.work_out", "rotor.energy.drive_work")
    begin = time.perf_counter()
    done = subprocess.run(
        [sys.executable, str(script), str(file), repr(stop), "0", *shown],
        capture_output=True,
        text=True,
        check=False,
    )
    seconds = time.perf_counter() - begin
    if done.returncode != 0:
        raise RunFailed(f"libcosim: {(done.stderr.splitlines() or ['no reason given'])[-1]}")
    _, *rows = csv.reader(io.StringIO(done.stdout))
    t, w, out, entered = np.array(rows, dtype=float).T
    return Stepped(t, w, float(abs(out[-1] - entered[-1]) / abs(entered[-1])), seconds)


def by_energy(system: System, tolerance: float, stop: float) -> tuple[Stepped, Stepped]:
    """Run with ECCO, and with as many fixed steps; tolerance: the energy that a step of ECCO may
    lose [J]."""
    ecco = through_libcosim(replace(system, algorithm="ecco", tolerance=tolerance), stop)
    step = round(1e9 * stop / len(ecco.t)) * 1e-9  # libcosim counts in ns
    return ecco, through_libcosim(replace(system, algorithm="fixedStep", step=step), stop)
