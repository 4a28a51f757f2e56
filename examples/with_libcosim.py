"""A coupled system of FMUs through libcosim, from OspSystemStructure.xml, SystemStructure.ssd or
System.ssp; prints CSV. Needs libcosimpy.

    python with_libcosim.py FILE STOP EVERY SLAVE.VARIABLE...       # times in seconds

EVERY 0 prints every communication step. Steps of libcosim's ECCO end where they end: what is
printed is then of the first that ends at a multiple of EVERY or later, with its time.
"""

import sys
from pathlib import Path

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver


def main(file: str, stop: str, every: str, *shown: str) -> None:
    """Run to `stop` [s] and print what is `shown` at each multiple of `every` [s], or each step."""
    # it writes warnings, of the enumerations that it leaves out, among what is printed here
    log_output_level(CosimLogLevel.ERROR)
    path = Path(file).resolve()
    if path.suffix in (".ssd", ".ssp"):
        execution = CosimExecution.from_ssp_file(
            str(path.parent if path.suffix == ".ssd" else path)
        )
    else:
        execution = CosimExecution.from_osp_config_file(file)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    places = []
    for name in shown:
        slave, _, variable = name.partition(".")
        index = execution.slave_index_from_instance_name(slave)
        known = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        places.append((index, [known[variable]]))
    print("time", *shown, sep=",")
    now, n = 0, 0  # ns
    while now < round(float(stop) * 1e9):
        n += 1
        to = round(n * float(every) * 1e9)
        if not (execution.simulate_until(to) if to else execution.step()):
            sys.exit(f"stopped: {execution.status()}")
        now = execution.status().current_time
        row = [observer.last_real_values(*place)[0] for place in places]
        print(now * 1e-9, *map(repr, row), sep=",")


if __name__ == "__main__":
    main(*sys.argv[1:])
