"""The two skins of FMI 2.0 over one instance in C, called without a host between: the slave of the
FMU in Python, and the functions of the native FMU."""

import ctypes
import importlib.util
import sys
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path

import fmpy

from rotor_fmu.fmi.log import read_message

WARNING, DISCARD, ERROR = 1, 2, 3
ARRAYS = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}
LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)


def called(kind):
    """The type by whose calls FMI 2.0 sets and reads a variable."""
    return "Integer" if kind == "Enumeration" else kind


def as_c(kind, value):
    """A value as a host of C would hold it."""
    return {"Real": float, "String": lambda _: b""}.get(kind, int)(value)


class Refused(Exception):
    """A call that was refused, and why."""


class Discarded(Exception):
    """A step that ended early, and why."""


class Extracted:
    """An FMU in a folder, with its variables."""

    def __init__(self, fmu):
        self.folder = Path(fmpy.extract(str(fmu)))
        self.description = fmpy.read_model_description(str(self.folder))
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}
        self.kinds = {v.name: v.type for v in self.description.modelVariables}


class Skin:
    """What goes alike with either: of the FMU `of`, what was `heard` of its instance."""

    @property
    def warnings(self):
        return [read_message(text.encode()) for status, text in self.heard if status == WARNING]

    def put(self, values):
        """Set variables by their names."""
        for name, value in values.items():
            self.set(self.of.kinds[name], [self.of.refs[name]], [value])
        return self

    def initialize(self, **options):
        self.setup(**options)
        self.enter()
        self.exit()
        return self


class Native(Skin):
    """An instance by the C functions of the native FMU."""

    def __init__(self, of):
        self.of = of
        name = of.description.coSimulation.modelIdentifier
        self._c = ctypes.CDLL(str(of.folder / "binaries" / "linux64" / f"{name}.so"))
        self._c.fmi2Instantiate.restype = c_void_p
        self.heard = []
        # the logger's last argument is the first of those that its format speaks of
        self._logger = LOGGER(lambda _e, _n, status, _c, _f, text: self._hear(status, text))
        self._callbacks = (c_void_p * 5)(ctypes.cast(self._logger, c_void_p).value)
        self._instance = c_void_p(
            self._c.fmi2Instantiate(
                b"native",
                1,
                of.description.guid.encode(),
                f"file://{of.folder}/resources".encode(),
                self._callbacks,
                0,
                1,
            )
        )
        assert self._instance

    def _hear(self, status, text):
        self.heard.append((status, text.decode()))

    def _call(self, name, *arguments):
        status = getattr(self._c, f"fmi2{name}")(self._instance, *arguments)
        if status == DISCARD:
            raise Discarded(self.heard[-1][1])
        if status > WARNING:
            raise Refused(self.heard[-1][1])

    def setup(self, start=0.0, stop=None, tolerance=None):
        self._call(
            "SetupExperiment",
            *(c_int(tolerance is not None), c_double(tolerance or 0.0), c_double(start)),
            *(c_int(stop is not None), c_double(stop or 0.0)),
        )

    def enter(self):
        self._call("EnterInitializationMode")

    def exit(self):
        self._call("ExitInitializationMode")

    def terminate(self):
        self._call("Terminate")

    def step(self, t, h):
        self._call("DoStep", c_double(t), c_double(h), c_int(0))

    def slopes(self, references, values, orders=None):
        """Set derivatives of inputs, of order 1."""
        count = len(references)
        self._call(
            "SetRealInputDerivatives",
            *((c_uint * count)(*references), c_size_t(count)),
            *((c_int * count)(*(orders or [1] * count)), (c_double * count)(*values)),
        )

    def directional(self, unknown, known, along):
        """Directional derivatives of unknowns by inputs."""
        values = (c_double * len(unknown))()
        self._call(
            "GetDirectionalDerivative",
            *((c_uint * len(unknown))(*unknown), c_size_t(len(unknown))),
            *((c_uint * len(known))(*known), c_size_t(len(known))),
            *((c_double * len(known))(*along), values),
        )
        return list(values)

    @property
    def last_successful_time(self):
        value = c_double()
        self._call("GetRealStatus", 2, byref(value))
        return value.value

    def get(self, kind, references):
        kind = called(kind)
        count = len(references)
        values = (ARRAYS[kind] * count)()
        self._call(f"Get{kind}", (c_uint * count)(*references), c_size_t(count), values)
        return list(values)

    def set(self, kind, references, values):
        kind = called(kind)
        count = len(references)
        given = (ARRAYS[kind] * count)(*(as_c(kind, value) for value in values))
        self._call(f"Set{kind}", (c_uint * count)(*references), c_size_t(count), given)

    def state(self):
        state, size = c_void_p(), c_size_t()
        self._call("GetFMUstate", byref(state))
        self._call("SerializedFMUstateSize", state, byref(size))
        content = ctypes.create_string_buffer(size.value)
        self._call("SerializeFMUstate", state, content, size)
        self._call("FreeFMUstate", byref(state))
        return content.raw

    def restore(self, content):
        state = c_void_p()
        self._call("DeSerializeFMUstate", content, c_size_t(len(content)), byref(state))
        self._call("SetFMUstate", state)
        self._call("FreeFMUstate", byref(state))


class Python(Skin):
    """An instance by the class that pythonfmu's wrapper calls."""

    def __init__(self, of):
        self.of = of
        self._module = _slave_of(of)
        resources = str(of.folder / "resources")
        self._slave = self._module.RotorBearing(instance_name="python", resources=resources)
        self.heard = []

    def _call(self, name, *arguments):
        try:
            return getattr(self._slave, name)(*arguments)
        except self._module.CallFailed as error:
            raise Refused(str(error)) from None
        finally:
            self.heard += [(int(m.status), m.msg) for m in self._slave.log_queue]
            self._slave.log_queue.clear()

    def setup(self, start=0.0, stop=None, tolerance=None):
        self._call("setup_experiment", start, stop, tolerance)

    def enter(self):
        self._call("enter_initialization_mode")

    def exit(self):
        self._call("exit_initialization_mode")

    def terminate(self):
        self._call("terminate")

    def step(self, t, h):
        if not self._call("do_step", t, h):
            raise Discarded(self.heard[-1][1])

    def get(self, kind, references):
        kind = called(kind)
        return self._call(f"get_{kind.lower()}", _signed(references))[: len(references)]

    def set(self, kind, references, values):
        kind = called(kind)
        self._call(f"set_{kind.lower()}", _signed(references), [as_c(kind, v) for v in values])

    def state(self):
        return self._call("_get_fmu_state")

    def restore(self, content):
        self._call("_set_fmu_state", content)


def _signed(references):
    """As pythonfmu's wrapper hands them over."""
    return [(reference + 2**31) % 2**32 - 2**31 for reference in references]


def _slave_of(of):
    """The module of an FMU's slave, with what there is against its wrapper left out: under a name
    of its own, since the wrapper itself, in this process, takes the module that is there."""
    (folder,) = (of.folder / "resources").glob("rotorbearing_*/")
    package = f"unwrapped_{folder.name}"
    name = f"{package}.slave"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(
            package, folder / "__init__.py", submodule_search_locations=[str(folder)]
        )
        sys.modules[package] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[package])
        module = importlib.import_module(name)
        module.settle_exit = lambda *_: None
        module.hold = lambda *_: None
    return sys.modules[name]


SKINS = {"python": Python, "native": Native}
