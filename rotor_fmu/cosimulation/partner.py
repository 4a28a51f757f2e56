"""FMUs that are coupled with the rotor's: each built from one script, which lists its variables."""

import shutil
import tempfile
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from ..about import RELEASED
from ..fmi.description import complete
from ..fmi.packing.archive import repack, wrap
from ..fmi.python import wrapper
from ..fmi.variables import Variable
from . import partner_slave


def listed_variables(table: Sequence[partner_slave.Listed]) -> tuple[Variable, ...]:
    """Return the variables of a partner's FMU from its table `VARIABLES`."""
    return tuple(
        Variable(name, "Real", causality, text, unit, start, low=low)
        for name, causality, unit, start, low, text in table
    )


def build_partner(source: Path, table: tuple[Variable, ...], target: Path) -> Path:
    """Build the FMU `target` of a partner's source and return its path; equal sources give equal
    bytes. Raises `OSError` if its folder cannot be written.
    """
    text = source.read_text(encoding="utf-8")
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="rotor_fmu_") as scratch:
        folder = Path(scratch)
        # named after its content, so that two versions can be loaded in one process
        script = folder / f"{source.stem}_{sha256(text.encode()).hexdigest()[:12]}.py"
        script.write_text(text, encoding="utf-8")
        beside = {"rotor_fmu_wrapper.py": wrapper, "rotor_fmu_slave.py": partner_slave}
        for name, module in beside.items():
            shutil.copyfile(str(module.__file__), folder / name)
        wrap(script, [folder / name for name in beside], folder / "raw.fmu")
        return repack(folder / "raw.fmu", target, lambda root: complete(root, table, RELEASED))
