"""The library's functions as LLVM IR: `python -m rotor_fmu.native.emit FOLDER`.

Run in a process of its own, since numba is told the processor before it is imported.
"""

from __future__ import annotations

import os

if __name__ == "__main__":
    os.environ |= {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}

import re
import sys
from pathlib import Path

import llvmlite.binding as llvm
import numba

from ..model.kernels import dispatching
from .flat import FUNCTIONS


def emit(folder: Path) -> None:
    """Write NAME.ll of every function of `FUNCTIONS`, `NAME_kernel` its one visible symbol."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    dispatching.keep = _forget
    for function, signature in FUNCTIONS.items():
        kernel = numba.njit(error_model="numpy", _nrt=False)(function)
        kernel.compile(signature)
        name = f"{function.__name__}_kernel"
        text = alone(kernel.inspect_llvm(signature), function.__name__, name)
        (folder / f"{name}.ll").write_text(text, encoding="utf-8")


def _forget(dispatcher: object) -> None:
    """Instead of `kept_overloads.keep`: what no process will run is not worth keeping."""


def alone(text: str, function: str, name: str) -> str:
    """The module without numba's wrappers for Python: one function, called `name`."""
    module = llvm.parse_assembly(text)
    entry = next(
        f.name
        for f in module.functions
        if not f.is_declaration
        and re.search(rf"\d{function}B", f.name)
        and not f.name.startswith(("_ZN7cpython", "cfunc."))
    )
    for item in (*module.functions, *module.global_variables):
        if not item.is_declaration and item.name != entry:
            item.linkage = "internal"
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    machine = llvm.Target.from_default_triple().create_target_machine()
    options = llvm.create_pipeline_tuning_options(speed_level=0)
    passes.run(module, llvm.create_pass_builder(machine, options))
    return str(module).replace(entry, name)


if __name__ == "__main__":
    emit(Path(sys.argv[1]))
