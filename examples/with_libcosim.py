"""A coupled system of FMUs through libcosim, from OspSystemStructure.xml, SystemStructure.ssd or
System.ssp; prints CSV. Needs libcosimpy.

    python with_libcosim.py FILE STOP EVERY SLAVE.VARIABLE...       # times in seconds

EVERY 0 prints every communication step. Steps of libcosim's ECCO end where they end: what is
printed is then of the first that ends at a multiple of EVERY or later, with its time.
"""

import sys
from pathlib import Path
from typing import NoReturn

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

USAGE = "usage: python with_libcosim.py FILE STOP EVERY SLAVE.VARIABLE..., times in seconds"


def main(*arguments: str) -> None:
    """Run to STOP [s] and print what is asked for at each multiple of EVERY [s], or each step."""
    try:
        file, stop, every, *shown = arguments
        end, interval = float(stop), float(every)
    except ValueError:
        refuse(USAGE)
    if not (0 < end < 1e9 and 0 <= interval <= end):
        refuse(f"{stop} {every}: STOP must be > 0 and below 1e9 s, EVERY from 0 to STOP")
    path = Path(file).resolve()
    if not path.is_file():
        refuse(f"{file}: is not a file")
    # it writes warnings, of the enumerations that it leaves out, among what is printed here
    log_output_level(CosimLogLevel.ERROR)
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
        listed = () if index is None else execution.slave_variables(index)
        known = {v.name.decode(): v.reference for v in listed}
        if variable not in known:
            slaves = ", ".join(sorted(info.name.decode() for info in execution.slave_infos()))
            refuse(f"{name}: is no variable of {slave if known else f'the slaves {slaves}'}")
        places.append((index, [known[variable]]))
    print("time", *shown, sep=",")
    now, n = 0, 0  # ns
    while now < round(end * 1e9):
        n += 1
        to = round(n * interval * 1e9)
        if not (execution.simulate_until(to) if to else execution.step()):
            sys.exit(f"stopped: {execution.status()}")
        now = execution.status().current_time
        row = [observer.last_real_values(*place)[0] for place in places]
        print(now * 1e-9, *map(repr, row), sep=",")


def refuse(line: str) -> NoReturn:
    """End with a line on what is wrong, and status 2."""
    print(line, file=sys.stderr)
    sys.exit(2)


if __name__ == "__main__":
    main(*sys.argv[1:])
