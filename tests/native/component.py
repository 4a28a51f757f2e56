"""The component of an FMU in wasmtime, and a run through it as `wasm.rows_of` makes one."""

import shutil
import struct
import zipfile

import fmpy
import numpy as np
import pytest
import wasmtime
from wasmtime import component

from rotor_fmu.fmi.machine_table import FILE
from rotor_fmu.library.component import _jco
from rotor_fmu.library.platforms import COMPONENT

NODE, JCO = shutil.which("node"), _jco()
NEEDED = pytest.mark.skipif(
    not (NODE and JCO), reason="needs Node.js and jco (npm install -g @bytecodealliance/jco)"
)
BINARY = "binaries/wasm32-wasip2/RotorBearingNative.wasm"
CO_SIMULATION = "fmi:fmi3/co-simulation@3.0.0"
RESOURCE = "co-simulation-instance"


def table_of(fmu):
    """The file of an FMU that holds its machine."""
    with zipfile.ZipFile(fmu) as archive:
        return archive.read(f"resources/{FILE}")


class Component:
    """A component that no WASI is given, with the messages that it had for its host."""

    def __init__(self, fmu, most_memory=-1):
        description = fmpy.read_model_description(str(fmu))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.token = description.instantiationToken
        with zipfile.ZipFile(fmu) as archive:
            (name,) = (name for name in archive.namelist() if COMPONENT.name in name)
            self._load(archive.read(name), most_memory)

    def _load(self, content, most_memory=-1):
        engine = wasmtime.Engine()
        self.type = component.Component(engine, content)
        self.store = wasmtime.Store(engine)
        self.store.set_limits(memory_size=most_memory)
        self.heard = []
        linker = component.Linker(engine)
        with linker.root() as root, root.add_instance("fmi:fmi3/callbacks@3.0.0") as callbacks:
            callbacks.add_func("log-message", lambda _, *message: self.heard.append(message))
        self._instance = linker.instantiate(self.store, self.type)
        self._functions = {}

    def function(self, name, interface=CO_SIMULATION):
        if name not in self._functions:
            folder = self._instance.get_export_index(self.store, interface)
            index = self._instance.get_export_index(self.store, name, folder)
            self._functions[name] = self._instance.get_func(self.store, index)
        return self._functions[name]

    def version(self):
        return self.function("get-version", "fmi:fmi3/common@3.0.0")(self.store)

    def instantiate(self, token=None, is_logging=True, has_events=False, may_return=False):
        flags = (False, is_logging, has_events, may_return)
        create = self.function(
            f"[static]{RESOURCE}.instantiate-{RESOURCE.removesuffix('-instance')}"
        )
        handle = create(self.store, "rotor", token or self.token, "", *flags, [])
        return handle and Instance(self, handle)


class Instance:
    """One instance: its methods by their names in the interface."""

    def __init__(self, owner, handle):
        self.owner, self._handle = owner, handle

    def call(self, name, *arguments):
        method = self.owner.function(f"[method]{RESOURCE}.{name}")
        return method(self.owner.store, self._handle, *arguments)

    def start(self):
        assert self.call("enter-initialization-mode", None, 0.0, None) == "ok"
        assert self.call("exit-initialization-mode") == "ok"
        self.owner.heard.clear()
        return self

    def drop(self):
        self._handle.drop(self.owner.store)


def rows_through(instance, plan):
    """Rows of time and what is recorded, shape (n, 1 + recorded)."""
    kinds = {"Real": ("float64", float), "Integer": ("int32", int), "Boolean": ("boolean", bool)}
    for each in plan["values"]:
        name, convert = kinds[each["kind"]]
        values = [convert(each["value"])]
        assert instance.call(f"set-{name}", [each["reference"]], values) == "ok"
    instance.start()
    rows = []

    def record(t):
        values = instance.call("get-float64", plan["record"])
        rows.append(np.frombuffer(struct.pack(f"<{1 + len(values)}d", t, *values)))

    record(0.0)
    begin = 0.0
    for leg in plan["legs"]:
        for i in range(leg["steps"]):
            t = begin + i * leg["step"]
            speed = leg["from"] + leg["rate"] * i * leg["step"]
            assert instance.call("set-float64", [plan["drive"]], [speed]) == "ok"
            slope = [(plan["drive"], 1)], [leg["rate"]]
            assert instance.call("set-input-derivatives", *slope) == "ok"
            assert instance.call("do-step", t, leg["step"], True) not in ("discard", "error")
            record(t + leg["step"])
        begin += leg["steps"] * leg["step"]
    return np.array(rows)
