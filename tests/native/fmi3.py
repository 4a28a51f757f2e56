"""The native FMU of FMI 3.0 by its C functions."""

import ctypes

import fmpy

WARNING, DISCARD, ERROR = 1, 2, 3
ZERO, H = ctypes.c_double(0.0), ctypes.c_double(0.004)
ONE = ctypes.c_size_t(1)
_LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)


class Library:
    """The C functions, and what the FMU logged."""

    def __init__(self, folder):
        file = folder / "binaries" / "x86_64-linux" / "RotorBearingNative.so"
        self.c = ctypes.CDLL(str(file))
        self.c.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
        self.resources = f"{folder}/resources/".encode()
        self.token = fmpy.read_model_description(str(folder)).guid.encode()
        self.heard = []
        self.log = _LOG(lambda _, status, category, text: self._hear(status, category, text))

    def _hear(self, status, category, text):
        self.heard.append((status, category.decode(), text.decode()))

    def instantiate(
        self, is_logging=True, token=None, resources=None, has_events=False, may_return=False
    ):
        result = self.c.fmi3InstantiateCoSimulation(
            b"rotor",
            token or self.token,
            resources or self.resources,
            *(False, is_logging, has_events, may_return),
            *(None, ctypes.c_size_t(0), None, self.log, None),
        )
        return result and ctypes.c_void_p(result)

    def enter(self, m):
        return self.c.fmi3EnterInitializationMode(m, False, ZERO, ZERO, False, ZERO)

    def step(self, m):
        return self.c.fmi3DoStep(m, ZERO, H, True, None, None, None, None)

    def ready(self, **options):
        m = self.instantiate(**options)
        assert self.enter(m) == 0
        assert self.c.fmi3ExitInitializationMode(m) == 0
        self.heard.clear()
        return m
