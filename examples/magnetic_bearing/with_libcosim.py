"""The magnetic bearings and the compressor through libcosim, from OspSystemStructure.xml or from
SystemStructure.ssd in this folder; prints CSV. Needs libcosimpy.

    python with_libcosim.py [osp|ssp] [STOP in seconds]
"""

import sys
from pathlib import Path

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

FOLDER = str(Path(__file__).resolve().parent)
SHOWN = {
    "control": ("left_fy", "tau"),
    "rotor": ("w", "left_sensor.y", "touchdown_bearing[1].fn", "touchdown_bearing[1].race"),
}


def main(kind: str = "osp", stop: str = "4") -> None:
    """Run to `stop` [s] and print every hundredth of a second."""
    log_output_level(CosimLogLevel.WARNING)
    make = {"osp": CosimExecution.from_osp_config_file, "ssp": CosimExecution.from_ssp_file}[kind]
    execution = make(FOLDER)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    slaves = {}
    for name, variables in SHOWN.items():
        index = execution.slave_index_from_instance_name(name)
        known = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        slaves[index] = [known[variable] for variable in variables]
    print("time", *(f"{name}.{v}" for name in SHOWN for v in SHOWN[name]), sep=",")
    for n in range(1, round(float(stop) * 100) + 1):
        if not execution.simulate_until(n * 10_000_000):  # ns
            sys.exit(f"stopped: {execution.status()}")
        row = [v for i, refs in slaves.items() for v in observer.last_real_values(i, refs)]
        print(n / 100, *map(repr, row), sep=",")


main(*sys.argv[1:])
