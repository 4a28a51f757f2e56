"""LLVM IR as an object file: `python -m rotor_fmu.library.objects TRIPLE PROCESSOR FEATURES IR
OBJECT`. A process each, since llvmlite lets one thread of a process in at a time."""

import re
import sys
from pathlib import Path

import llvmlite.binding as llvm


def put_object(triple: str, processor: str, features: str, source: Path, target: Path) -> None:
    """Write the functions of a file of IR as an object file; what it shows of them is hidden in the
    library that it becomes part of."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=processor,
        features=features,
        opt=3,
        reloc="static" if triple.startswith("wasm") else "pic",
        codemodel="default",
    )
    text = source.read_text(encoding="utf-8")
    layout = f'target datalayout = "{machine.target_data}"'
    text = re.sub(r"(?m)^target datalayout = .*$", layout, text)
    text = re.sub(r"(?m)^target triple = .*$", f'target triple = "{triple}"', text)
    module = llvm.parse_assembly(text)
    module.verify()
    for function in module.functions:
        if not function.is_declaration and function.linkage == llvm.Linkage.external:
            function.visibility = "hidden"
    target.write_bytes(machine.emit_object(module))


if __name__ == "__main__":
    _triple, _processor, _features, _source, _target = sys.argv[1:]
    put_object(_triple, _processor, _features, Path(_source), Path(_target))
