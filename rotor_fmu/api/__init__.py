"""The Python interface, whose names `rotor_fmu.__all__` lists: `import rotor_fmu as rf`."""

from ..errors import InputError as InputError
from ..errors import RunFailed as RunFailed
from .fmus import build_fmu as build_fmu
from .fmus import simulate_fmu as simulate_fmu
from .machine import Machine as Machine
from .machine import load as load
from .machine import parse as parse
from .machine import response as response
from .peaks import Peak as Peak
from .result import Result as Result
from .result import read_run as read_run
from .simulate import simulate as simulate
