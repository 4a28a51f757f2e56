"""The library's functions as LLVM IR: `python -m rotor_fmu.library.emit FILE FUNCTION ...`.

Run in a process of its own, since numba's target processor is set before it is imported, and since
numba is prevented from making what is not needed here: wrappers for callers in Python and in C, and
machine code. That uses numba's internals; `emit` checks that the result is complete.
"""

import os

if __name__ == "__main__":
    os.environ |= {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}

import gc
import re
import sys
from collections.abc import Container, Sequence
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from numba.core import callconv, codegen, cpu, event

from ..model.kernels import dispatching
from .entry_points import FUNCTIONS

# Of the IR that is emitted together, as text [bytes]: functions whose callees numba left out are
# stubs of a few kilobytes, ones with their passes left out several times as long.
_LEAST, _MOST = 5_000_000, 40_000_000
_PROJECT = "rotor_fmu"  # in the names of its functions
# What takes a run's time.
_HOT = "rotor_advance"
_NO_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def emit(target: Path, names: Sequence[str]) -> None:
    """Write the IR of these functions of `FUNCTIONS` to a file: `NAME_kernel` are its visible
    symbols, what several of them call is in it once.

    Raises `RuntimeError` where numba left a function without its body, or left it as no numba
    that is known does.
    """
    gc.set_threshold(200_000, 10_000, 10_000)  # what numba makes lives to the end
    _measure_nothing()
    _name_no_places()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    _make_no_machine_code()
    if _HOT not in names:
        numba.config.LOOP_VECTORIZE = 0
    modules = _optimise_once()
    entries = {}
    for name in names:
        function, signature = FUNCTIONS[name]
        kernel = numba.njit(error_model="numpy", _nrt=False, **_NO_WRAPPERS)(function)
        kernel.compile(signature)
        entries[_entry(modules[-1], function.__name__)] = f"{name}_kernel"
    whole = llvm.parse_assembly("")
    for module in modules:
        whole.link_in(module, preserve=True)
    text = _without_the_unused(whole, entries, is_small=_HOT not in names)
    check_size(names[0], len(text))
    for entry, name in entries.items():
        text = text.replace(entry, name)
    target.write_text(text, encoding="utf-8")


def check_size(name: str, size: int) -> None:
    """Raise `RuntimeError` unless the IR of a function, with what is emitted beside it, is about as
    long as it has to be."""
    if not _LEAST <= size <= _MOST:
        raise RuntimeError(
            f"{name}: {size} bytes of IR, not {_LEAST} to {_MOST}: another numba than this is known"
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


def _measure_nothing() -> None:
    """Keep numba from timing every call of LLVM, of which there are hundreds of thousands."""
    event.start_event = event.end_event = lambda *_, **__: None


def _name_no_places() -> None:
    """Keep numba from writing where in its own files an exception is raised: the path is that of
    this machine, and equal sources give equal libraries everywhere."""
    convention = callconv.CPUCallConv
    with_place = convention.build_excinfo_struct
    convention.build_excinfo_struct = lambda own, kind, arguments, place, name: with_place(
        own, kind, arguments, None, name
    )


def _finalized(context: Any, library: Any, description: Any, environment: Any) -> Any:
    """Replace `CPUContext.get_executable`, which would optimise and link a library: return a
    callable that is never called."""
    library._ensure_finalized()
    return [].append


def _optimise_once() -> list[llvm.ModuleRef]:
    """Let numba optimise a function that is called, with all that becomes part of it, once and
    alone; return the list into which these modules will come, callees first.

    As numba would have it a function is optimised again in every one that calls it.
    """
    modules: list[llvm.ModuleRef] = []
    library_class = codegen.CPUCodeLibrary
    optimise_functions = library_class._optimize_functions
    optimise, linked = library_class._optimize_final_module, library_class._get_module_for_linking
    nothing = llvm.parse_assembly("")
    builder = _builder()
    combine = llvm.create_new_module_pass_manager()
    combine.add_instruction_combine_pass()

    def combine_first(library: Any, module: llvm.ModuleRef) -> None:
        # tuples of hundreds of arrays, of which one is read, are read as this one before they are
        # taken apart: the other way round that alone takes a minute
        combine.run(module, builder)
        optimise_functions(library, module)

    def optimise_if_called(library: Any) -> None:
        if _is_called(library):
            optimise(library)
            modules.append(library._final_module)

    def linked_if_not_called(library: Any) -> llvm.ModuleRef:
        library._ensure_finalized()
        return nothing.clone() if _is_called(library) else linked(library)

    library_class._optimize_functions = combine_first
    library_class._optimize_final_module = optimise_if_called
    library_class._get_module_for_linking = linked_if_not_called
    return modules


def _builder() -> llvm.PassBuilder:
    machine = llvm.Target.from_default_triple().create_target_machine()
    return llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))


def _is_called(library: Any) -> bool:
    """Return whether a library's function of the project is called, not made part of its callers,
    which all others are that are linked into it."""
    return any(
        not any(b"alwaysinline" in attributes for attributes in function.attributes)
        for function in library._final_module.functions
        if not function.is_declaration and _PROJECT in function.name
    )


def _entry(module: llvm.ModuleRef, function: str) -> str:
    return next(
        f.name
        for f in module.functions
        if not f.is_declaration
        and re.search(rf"\d{function}B", f.name)
        and not f.name.startswith(("_ZN7cpython", "cfunc."))
    )


def _without_the_unused(module: llvm.ModuleRef, entries: Container[str], *, is_small: bool) -> str:
    """Return a module's text with the entries its only visible functions; is_small: whether its
    machine code is to be rather small than fast.

    Raises `RuntimeError` if what they call of the project's is missing.
    """
    for item in (*module.functions, *module.global_variables):
        if not item.is_declaration and item.name not in entries:
            item.linkage = "internal"
    passes = llvm.create_new_module_pass_manager()
    # what is handed over though no one asks for it, which no module alone can know
    passes.add_ipsccp_pass()
    passes.add_dead_arg_elimination_pass()
    passes.add_post_order_function_attributes_pass()
    passes.add_instruction_combine_pass()
    passes.add_new_gvn_pass()
    passes.add_simplify_cfg_pass()
    passes.add_instruction_combine_pass()
    passes.add_aggressive_dce_pass()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, _builder())
    for function in module.functions:
        if is_small and not function.is_declaration:
            function.add_function_attribute("optsize")
    missing = [f.name for f in module.functions if f.is_declaration and _PROJECT in f.name]
    if missing:
        raise RuntimeError(f"{missing[0]} is missing: another numba than this is known")
    return str(module)


if __name__ == "__main__":
    emit(Path(sys.argv[1]), sys.argv[2:])
