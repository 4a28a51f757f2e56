"""The reference result that the FMU carries: `python -m rotor_fmu.fmi.packing.reference` makes it
anew after a change of the model."""

import csv
import io
import tempfile
from pathlib import Path

import fmpy

from .documents import stored
from .machine_files import machine_of
from .python_fmu import build


def default_experiment(fmu: Path) -> bytes:
    """Return the CSV of the FMU's default experiment through FMPy: time [s] and every output in SI
    units."""
    result = fmpy.simulate_fmu(str(fmu))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(result.dtype.names)
    writer.writerows([f"{float(value) + 0.0:.8g}" for value in row] for row in result)
    return text.getvalue().encode()


def main() -> None:
    """Run the default experiment and store its result."""
    with tempfile.TemporaryDirectory() as folder:
        fmu = build(Path(folder), machine_of())
        target = stored(fmu.stem)
        target.write_bytes(default_experiment(fmu))
    print(target)


if __name__ == "__main__":
    main()
