"""A Campbell diagram beside ROSS' of the same rotor: python -m benchmarks.campbell_beside_ross

A disc in the middle of 24 elements on two bearings, 25 speeds, six modes, in one process and in
turns; medians of CPU time after a first one of each. Needs ROSS.
"""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import ross
from rotor_fmu.model.linear.campbell import campbell
from rotor_fmu.model.machine.ross import parse_ross
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.machine.toml_text import toml_text

from .native_master import medians

REPETITIONS = 5


def rotor_of_ross() -> ross.Rotor:
    """The rotor, of 25 nodes."""
    steel = ross.Material("steel", rho=7800, E=2.1e11, G_s=8e10)
    shaft = [ross.ShaftElement(0.05, 0.0, 0.05, material=steel) for _ in range(24)]
    disc = ross.DiskElement.from_geometry(n=12, material=steel, width=0.05, i_d=0.05, o_d=0.3)
    bearings = [ross.BearingElement(n=n, kxx=1e7, kyy=1e7, cxx=500, cyy=500) for n in (0, 24)]
    return ross.Rotor(shaft, [disc], bearings)


def imported(rotor: ross.Rotor) -> Rotor:
    """The same, as ROSS saves it."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "rotor.toml"
        rotor.save(file)
        return parse_rotor(toml_text(parse_ross(file.read_text(), is_json=False).tables))


def _timed(call: Callable[[np.ndarray], object]) -> Callable[[], float]:
    """CPU time of a call at speeds that it has not had."""
    calls = 0

    def timed() -> float:
        nonlocal calls
        calls += 1
        begun = time.process_time()
        call(np.linspace(0.0, 1000.0 + calls, 25))
        return time.process_time() - begun

    timed()
    return timed


def main() -> None:
    theirs = rotor_of_ross()
    mine = imported(theirs)
    here, there = medians(
        REPETITIONS,
        _timed(lambda speeds: campbell(mine, speeds, count=6)),
        _timed(lambda speeds: theirs.run_campbell(speeds, frequencies=6)),
    )
    print(f"CPU: {here:.2f} s here, {there:.2f} s in ROSS {ross.__version__}")


if __name__ == "__main__":
    main()
