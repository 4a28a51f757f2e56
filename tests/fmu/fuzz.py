"""Random calls of the FMU's C interface: python fuzz.py FMU SEED CALLS

Whatever FMI 2.0 lets a host hand over, and much that it does not: variables of wrong types, value
references that are not there, values that are no numbers, strings that are NULL or no text, NULL
states, in any order. Each call is printed before it is made, so that the last line names the one
that crashed. Left out is what pythonfmu's wrapper dereferences or hands to Python by itself: a NULL
component, NULL arrays that are to hold something, a NULL state that is to be serialized.

Exits with status 0 if every call had a status of FMI's, and a well-behaved run on a new instance
then gives the bits that it gave before.
"""

import faulthandler
import random
import sys
from ctypes import (
    byref,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint,
    c_void_p,
    create_string_buffer,
)

import fmpy

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
H = 1e-3
REAL_VALUES = (0.0, 1e-3, 0.5, 1.0, 100.0, -1.0, 1e300, -1e300, float("nan"), float("inf"))
INTEGER_VALUES = (0, 1, 2, 3, 4, 5, -1, 2**31 - 1, -(2**31))
TEXTS = (None, b"", b"text", b"100 %s %n", b"\xff\xfe", "\N{SNOWMAN}".encode())
REFERENCES = (9999, 2**31 - 1, 2**31, 2**32 - 1)
STEPS = (H, 0.0, -H, 1e-30, float("nan"), float("inf"), -float("inf"))
TIMES = (0.0, H, -H, 1e15, float("nan"), float("inf"), -float("inf"))
ARRAYS = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}
# Bad calls of these are many; good ones are few, and what comes after them is worth seeing.
WEIGHTS = {
    "setup": 4,
    "enter": 6,
    "exit": 8,
    "step": 20,
    "wild step": 4,
    "get": 20,
    "set": 20,
    "state": 4,
    "restore": 6,
    "free state": 3,
    "serialize": 2,
    "reset": 5,
    "terminate": 2,
    "renew": 1,
    "not supported": 2,
}


_kept = []


def quiet(environment, name, status, category, message):
    """A logger that reads what it is given."""
    assert message.decode("utf-8")


class Component:
    """An instance and how to call it: every argument a C value, every answer a status."""

    def __init__(self, folder, description):
        self.fmu = fmpy.instantiate_fmu(
            folder, description, "CoSimulation", debug_logging=True, logger=quiet
        )
        self.states = []
        self.t = 0.0
        # FMPy hands the messages of every instance to the logger made last, freed or not
        _kept.append(self.fmu.callbacks)

    def __call__(self, name, *arguments):
        function = self.fmu.dll[f"fmi2{name}"]  # fetched by item: without FMPy's types
        function.restype = c_int
        status = function(c_void_p(self.fmu.component), *arguments)
        if status not in range(PENDING):
            raise SystemExit(f"fmi2{name} returned {status}")
        return status

    def free(self):
        for state in self.states:
            self("FreeFMUstate", byref(state))
        self.fmu.freeInstance()


class Fuzzer:
    """Draws calls and makes them, on two instances in turn."""

    def __init__(self, fmu, seed):
        self.folder = fmpy.extract(fmu)
        self.description = fmpy.read_model_description(self.folder)
        self.random = random.Random(seed)
        self.kinds = {
            v.valueReference: "Integer" if v.type == "Enumeration" else v.type
            for v in self.description.modelVariables
        }
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}
        self.components = [self.new(), self.new()]
        self.counts = {}

    def new(self):
        return Component(self.folder, self.description)

    def run(self, calls):
        """Make random calls; how many there were of each status."""
        for _ in range(calls):
            component = self.random.choice(self.components)
            (name,) = self.random.choices(tuple(WEIGHTS), tuple(WEIGHTS.values()))
            status = getattr(self, name.replace(" ", "_"))(component)
            self.counts[status] = self.counts.get(status, 0) + 1
        for component in self.components:
            component.free()

    def say(self, *words):
        print(*words, flush=True)

    def setup(self, component):
        start, stop = self.random.choice((0.0, *TIMES)), self.random.choice((100.0, *TIMES))
        tolerance = self.random.choice((1e-3, 1e-2, 0.0, 5.0, float("nan")))
        has = self.random.randrange(2), self.random.randrange(2)
        self.say("setup", start, stop, tolerance, has)
        status = component(
            "SetupExperiment", has[0], c_double(tolerance), c_double(start), has[1], c_double(stop)
        )
        if status == OK:
            component.t = start
        return status

    def enter(self, component):
        self.say("enter")
        return component("EnterInitializationMode")

    def exit(self, component):
        self.say("exit")
        return component("ExitInitializationMode")

    def step(self, component):
        self.say("step", component.t, H)
        status = component("DoStep", c_double(component.t), c_double(H), 1)
        if status == OK:
            component.t += H
        return status

    def wild_step(self, component):
        # none that is long: it may take as long as it likes
        t, h = self.random.choice((component.t, *TIMES)), self.random.choice(STEPS)
        self.say("step", t, h)
        status = component("DoStep", c_double(t), c_double(h), 1)
        if status == OK:
            component.t = t + h
        return status

    def drawn(self):
        """A type and references, most of them of that type."""
        kind = self.random.choice(tuple(ARRAYS))
        ours = [r for r, k in self.kinds.items() if k == kind] or [0]
        count = self.random.choice((0, 1, 1, 2, 5))
        pool = self.random.choice((ours, ours, tuple(self.kinds), REFERENCES))
        return kind, [self.random.choice(pool) for _ in range(count)]

    def get(self, component):
        kind, refs = self.drawn()
        self.say("get", kind, refs)
        values = (ARRAYS[kind] * len(refs))() if refs else None
        given = (c_uint * len(refs))(*refs) if refs else None
        return component(f"Get{kind}", given, c_size_t(len(refs)), values)

    def set(self, component):
        kind, refs = self.drawn()
        pool = {"Real": REAL_VALUES, "String": TEXTS}.get(kind, INTEGER_VALUES)
        values = [self.random.choice(pool) for _ in refs]
        if kind == "Real" and self.random.random() < 0.5:
            refs, values = [self.refs["speed"]], [self.random.uniform(0, 400)]
        self.say("set", kind, refs, values)
        array = (ARRAYS[kind] * len(refs))(*values) if refs else None
        given = (c_uint * len(refs))(*refs) if refs else None
        return component(f"Set{kind}", given, c_size_t(len(refs)), array)

    def state(self, component):
        self.say("get state")
        state = c_void_p()
        status = component("GetFMUstate", byref(state))
        if status == OK:
            component.states.append(state)
        return status

    def restore(self, component):
        states = [s for c in self.components for s in c.states]
        state = self.random.choice((c_void_p(), *states))
        self.say("set state", state)
        return component("SetFMUstate", state)

    def free_state(self, component):
        state = component.states.pop() if component.states else c_void_p()
        self.say("free state", state)
        return component("FreeFMUstate", byref(state))

    def serialize(self, component):
        """A state to bytes and back, the bytes damaged now and then."""
        if not component.states:
            return component("FreeFMUstate", byref(c_void_p()))
        self.say("serialize")
        state, size = self.random.choice(component.states), c_size_t()
        component("SerializedFMUstateSize", state, byref(size))
        data = create_string_buffer(size.value)
        component("SerializeFMUstate", state, data, size)
        if self.random.random() < 0.5:
            data[self.random.randrange(size.value)] = b"x"
        if self.random.random() < 0.3:
            size = c_size_t(self.random.randrange(size.value))
        back = c_void_p()
        status = component("DeSerializeFMUstate", data, size, byref(back))
        if status == OK:
            component.states.append(back)
        return status

    def reset(self, component):
        self.say("reset")
        status = component("Reset")
        component.t = 0.0
        return status

    def terminate(self, component):
        self.say("terminate")
        return component("Terminate")

    def renew(self, component):
        self.say("free and instantiate")
        component.free()
        self.components[self.components.index(component)] = self.new()
        return OK

    def not_supported(self, component):
        name = self.random.choice(("CancelStep", "GetStatus", "GetBooleanStatus"))
        self.say(name)
        answer = c_int()
        arguments = () if name == "CancelStep" else (self.random.randrange(4), byref(answer))
        return component(name, *arguments)

    def well_behaved(self):
        """What a plain run gives, as bytes."""
        component = self.new()
        component("SetupExperiment", 0, c_double(), c_double(0.0), 0, c_double())
        component("EnterInitializationMode")
        component("ExitInitializationMode")
        for i in range(20):
            assert component("DoStep", c_double(i * H), c_double(H), 1) == OK
        refs = [r for r, kind in self.kinds.items() if kind == "Real"]
        values = (c_double * len(refs))()
        assert component("GetReal", (c_uint * len(refs))(*refs), c_size_t(len(refs)), values) == OK
        component.free()
        return bytes(values)


def wrong_calls(fuzzer, name):
    """The same wrong call 300 times, then a step of a run that goes on."""
    component = fuzzer.new()
    if name.startswith("early "):
        name = name.removeprefix("early ")
    else:
        component("EnterInitializationMode")
        component("ExitInitializationMode")
    one, out = (c_uint * 1)(9999), (c_double * 1)()
    for _ in range(300):
        if name == "NULL state":
            status = component("SetFMUstate", c_void_p())
        else:
            status = component(name, one, c_size_t(1), out)
        assert status in (ERROR, FATAL), status
    component("EnterInitializationMode")
    component("ExitInitializationMode")
    assert component("DoStep", c_double(0.0), c_double(H), 1) == OK
    component.free()
    print("refused 300 times, then stepped")


if __name__ == "__main__":
    faulthandler.enable()
    fuzzer = Fuzzer(sys.argv[1], 0)
    if len(sys.argv) == 3:
        wrong_calls(fuzzer, sys.argv[2])
        raise SystemExit(0)
    before = fuzzer.well_behaved()
    fuzzer.random.seed(int(sys.argv[2]))
    fuzzer.run(int(sys.argv[3]))
    assert fuzzer.well_behaved() == before, "a run is not what it was before"
    print("statuses", fuzzer.counts)
