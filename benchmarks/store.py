"""Results on disk, kept after every measurement, so that a benchmark can be stopped and resumed."""

import datetime
import hashlib
import importlib.metadata
import json
import platform
from pathlib import Path
from typing import Any

import numpy as np

_ROOT = Path(__file__).parent.parent
_PROGRAMS = ("numpy", "scipy", "numba", "scikit-sundae", "exudyn", "ross-rotordynamics")


class Store:
    """What was measured, by section and name, in one JSON file.

    Results of other sources, another day's or another `kind` of run are not taken up again.
    """

    def __init__(self, folder: Path, kind: str, runs: int, starts_anew: bool = False) -> None:
        self.path = folder / "results.json"
        self.is_resumed = False
        self._data: dict[str, dict] = {"about": _about(kind, runs)}
        if self.path.exists() and not starts_anew:
            before = json.loads(self.path.read_text(encoding="utf-8"))
            if before["about"] == self._data["about"]:
                self._data = before
                self.is_resumed = len(before) > 1

    @classmethod
    def read(cls, folder: Path) -> "Store":
        """What a folder holds, whatever the sources are now; raises `OSError` if nothing."""
        store = cls.__new__(cls)
        store.path = folder / "results.json"
        store.is_resumed = True
        store._data = json.loads(store.path.read_text(encoding="utf-8"))
        return store

    def section(self, name: str) -> dict[str, dict]:
        """Results of one section, by name."""
        return self._data.get(name, {})

    def keep(self, section: str, name: str, result: dict) -> None:
        """Remember one result, and write all of them, whole or not at all."""
        self._data.setdefault(section, {})[name] = result
        self.path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = self.path.with_suffix(".part")
        unfinished.write_text(json.dumps(self._data, indent=1) + "\n", encoding="utf-8")
        unfinished.replace(self.path)

    @property
    def about(self) -> dict[str, Any]:
        """Machine, date, versions and sources."""
        return self._data["about"]


def _about(kind: str, runs: int) -> dict[str, object]:
    return {
        "kind": kind,
        "runs": runs,
        "date": datetime.date.today().isoformat(),
        "machine": machine_name(),
        "python": platform.python_version(),
        "versions": {name: _version(name) for name in _PROGRAMS},
        "sources": _digest(),
    }


def machine_name() -> str:
    """Processor and system."""
    processor = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        processor = names[0].partition(":")[2].strip() if names else processor
    return f"{processor}, {platform.system()} {platform.machine()}"


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def _digest() -> str:
    """Of what a result depends on: the model, the FMU and the benchmark itself."""
    digest = hashlib.sha256()
    for folder in ("model", "rotor_fmu", "benchmarks"):
        for source in sorted((_ROOT / folder).rglob("*.py")):
            if source.name not in ("report.py", "pictures.py"):
                digest.update(source.read_bytes())
    return digest.hexdigest()[:12]


def median(values: list[float]) -> float:
    """The middle one."""
    return float(np.median(values))
