"""The library's functions as LLVM IR: `python -m rotor_fmu.library.emit FILE FUNCTION ...`.

Run in a process of its own, since numba's target processor is set before it is imported, and since
numba is prevented from making what is not needed here: wrappers for callers in Python and in C, and
machine code. That uses numba's internals; `emit` checks that the result is complete.
"""

from __future__ import annotations

import os

if __name__ == "__main__":
    os.environ |= {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}

import re
import sys
from collections.abc import Container, Sequence
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from numba.core import codegen, cpu

from ..model.kernels import dispatching
from .entry_points import FUNCTIONS

# Of the IR of what carries out a run, as text [bytes]: a function whose callees numba left out is a
# stub of a few kilobytes, one with its passes left out is several times as long.
_SIZES = dict.fromkeys(("rotor_start", "rotor_advance", "rotor_survey"), (500_000, 25_000_000))
# What takes a run's time.
_HOT = "rotor_advance"
_NO_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def emit(target: Path, names: Sequence[str]) -> None:
    """Write the IR of these functions of `FUNCTIONS` to a file: `NAME_kernel` are its visible
    symbols, what several of them call is in it once.

    Raises `RuntimeError` where numba left a function without its body, or left it as no numba
    that is known does.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    _make_no_machine_code()
    if _HOT not in names:
        _optimise_last({FUNCTIONS[name][0].__name__ for name in names})
    whole = llvm.parse_assembly("")
    entries = {}
    for name in names:
        function, signature = FUNCTIONS[name]
        kernel = numba.njit(error_model="numpy", _nrt=False, **_NO_WRAPPERS)(function)
        kernel.compile(signature)
        text = kernel.inspect_llvm(signature)
        check_size(name, len(text))
        module = llvm.parse_assembly(text)
        entries[_entry(module, function.__name__)] = f"{name}_kernel"
        whole.link_in(module)
    text = _without_the_unused(whole, entries)
    for entry, name in entries.items():
        text = text.replace(entry, name)
    target.write_text(text, encoding="utf-8")


def check_size(name: str, size: int) -> None:
    """Raise `RuntimeError` unless the IR of a function is about as long as it has to be."""
    least, most = _SIZES.get(name, (0, 20_000_000))
    if not least <= size <= most:
        raise RuntimeError(
            f"{name}: {size} bytes of IR, not {least} to {most}: another numba than this is known"
        )


def _make_no_machine_code() -> None:
    """Keep numba from compiling what it has optimised, and from wrapping functions that kernels
    alone call."""
    codegen.JITCodeLibrary._finalize_specific = lambda library: None
    codegen.JITCodeLibrary.get_pointer_to_function = lambda library, name: 0
    codegen.JITCPUCodegen._add_module = lambda generator, module: None
    cpu.CPUContext.get_executable = _finalized
    dispatching.CACHES = False
    dispatching.EXTRA.update(_NO_WRAPPERS)


def _finalized(context: Any, library: Any, description: Any, environment: Any) -> Any:
    """Replace `CPUContext.get_executable`, which would optimise and link a library: return a
    callable that is never called."""
    library._ensure_finalized()
    return [].append


def _optimise_last(entries: Container[str]) -> None:
    """Let numba optimise the entries alone with what they call, and unroll no loops for vectors:
    each function of a long chain would be optimised again in the next, for steps that are faster by
    a fifth where they matter."""
    numba.config.LOOP_VECTORIZE = 0
    optimise = codegen.CPUCodeLibrary._optimize_final_module
    codegen.CPUCodeLibrary._optimize_final_module = lambda library: (
        optimise(library) if library.name in entries else None
    )


def _entry(module: llvm.ModuleRef, function: str) -> str:
    return next(
        f.name
        for f in module.functions
        if not f.is_declaration
        and re.search(rf"\d{function}B", f.name)
        and not f.name.startswith(("_ZN7cpython", "cfunc."))
    )


def _without_the_unused(module: llvm.ModuleRef, entries: Container[str]) -> str:
    """Return a module's text with the entries its only visible functions.

    Raises `RuntimeError` if what they call of the project's is missing.
    """
    for item in (*module.functions, *module.global_variables):
        if not item.is_declaration and item.name not in entries:
            item.linkage = "internal"
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    machine = llvm.Target.from_default_triple().create_target_machine()
    options = llvm.create_pipeline_tuning_options(speed_level=0)
    passes.run(module, llvm.create_pass_builder(machine, options))
    missing = [f.name for f in module.functions if f.is_declaration and "rotor_fmu" in f.name]
    if missing:
        raise RuntimeError(f"{missing[0]} is missing: another numba than this is known")
    return str(module)


if __name__ == "__main__":
    emit(Path(sys.argv[1]), sys.argv[2:])
