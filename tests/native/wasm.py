"""A run as the page plans it, through a library that is called from Python: the native one, or the
page's own in wasmtime."""

import ctypes
import struct

import numpy as np
from rotor_fmu.model.kernels.library import find

from rotor_fmu.library.build import library, sources_digest
from rotor_fmu.library.platforms import WASM

SETTERS = {
    "Real": "fmi2SetReal",
    "Integer": "fmi2SetInteger",
    "Boolean": "fmi2SetBoolean",
    "Enumeration": "fmi2SetInteger",
}


class Native:
    """This machine's library, or another for this machine."""

    def __init__(self, table, file=None):
        self._library = ctypes.CDLL(str(file or find("linux64", sources_digest())))
        self._rooms = []
        receive = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p)
        self._receive = receive(lambda environment, status, message: None)
        instantiate = self._library.rotor_instantiate
        instantiate.restype = ctypes.c_void_p
        self.handle = instantiate(
            b"rotor", self.room(table), ctypes.c_size_t(len(table)), self._receive, None
        )
        assert self.handle

    def room(self, content):
        self._rooms.append(ctypes.create_string_buffer(content, len(content)))
        return ctypes.c_void_p(ctypes.addressof(self._rooms[-1]))

    def write(self, at, content):
        ctypes.memmove(at, content, len(content))

    def read(self, at, size):
        return ctypes.string_at(at, size)

    def call(self, name, *arguments):
        convert = {int: ctypes.c_ulong, float: ctypes.c_double, ctypes.c_void_p: lambda at: at}
        given = [convert[type(each)](each) for each in arguments]
        return getattr(self._library, name)(ctypes.c_void_p(self.handle), *given)


class Wasmtime:
    """The page's library in wasmtime."""

    def __init__(self, table):
        import wasmtime

        self._store = wasmtime.Store()
        module = wasmtime.Module(self._store.engine, library(WASM).read_bytes())
        linker = wasmtime.Linker(self._store.engine)
        linker.define_wasi()
        self._store.set_wasi(wasmtime.WasiConfig())
        kinds = [wasmtime.ValType.i32()] * 3
        linker.define_func(
            "page", "log_message", wasmtime.FuncType(kinds, []), lambda *message: None
        )
        self._exports = linker.instantiate(self._store, module).exports(self._store)
        self._exports["_initialize"](self._store)
        at = self.room(table)
        self.handle = self._exports["page_instantiate"](self._store, at, len(table))
        assert self.handle

    def room(self, content):
        at = self._exports["malloc"](self._store, len(content))
        self.write(at, content)
        return at

    def write(self, at, content):
        self._exports["memory"].write(self._store, content, at)

    def read(self, at, size):
        return bytes(self._exports["memory"].read(self._store, at, at + size))

    def call(self, name, *arguments):
        return self._exports[name](self._store, self.handle, *arguments)


def rows_of(solver, plan):
    """Rows of time and what is recorded, shape (n, 1 + recorded)."""
    for each in plan["values"]:
        is_real = each["kind"] == "Real"
        value = struct.pack("<d" if is_real else "<i", each["value"])
        reference = solver.room(struct.pack("<I", each["reference"]))
        assert solver.call(SETTERS[each["kind"]], reference, 1, solver.room(value)) == 0
    assert solver.call("fmi2SetupExperiment", 0, 0.0, 0.0, 0, 0.0) == 0
    assert solver.call("fmi2EnterInitializationMode") == 0
    assert solver.call("fmi2ExitInitializationMode") == 0
    count = len(plan["record"])
    references = solver.room(struct.pack(f"<{count}I", *plan["record"]))
    values = solver.room(bytes(8 * count))
    drive = solver.room(struct.pack("<I", plan["drive"]))
    speed, slope, order = solver.room(bytes(8)), solver.room(bytes(8)), solver.room(b"\1\0\0\0")
    rows = []

    def record(t):
        assert solver.call("fmi2GetReal", references, count, values) == 0
        rows.append(np.frombuffer(struct.pack("<d", t) + solver.read(values, 8 * count)))

    record(0.0)
    begin = 0.0
    for leg in plan["legs"]:
        for i in range(leg["steps"]):
            t = begin + i * leg["step"]
            solver.write(speed, struct.pack("<d", leg["from"] + leg["rate"] * i * leg["step"]))
            solver.write(slope, struct.pack("<d", leg["rate"]))
            assert solver.call("fmi2SetReal", drive, 1, speed) == 0
            assert solver.call("fmi2SetRealInputDerivatives", drive, 1, order, slope) == 0
            assert solver.call("fmi2DoStep", t, float(leg["step"]), 1) <= 1
            record(t + leg["step"])
        begin += leg["steps"] * leg["step"]
    return np.array(rows)
