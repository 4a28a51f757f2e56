"""What a partner's own code raises is a message, and never the end of the host."""

import pytest

from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import RunFailed

from ..processes import run_python
from .test_coupling import SOURCE
from .test_members import built

FAILING = """
import sys
from pathlib import Path
from rotor_fmu.cosimulation.member import Member
for fmu in sys.argv[1:]:
    for _ in range(4):  # a reference too few and the host would be gone
        with Member(Path(fmu), {}, []) as member:
            member.begin()
            for k in range(10):
                try:
                    member.step(1e-3 * k, 1e-3)
                    member.get(["w"])
                except Exception as error:
                    print(error)
"""
RAISED = {
    "1 / 0": "ZeroDivisionError: division by zero",
    "raise KeyboardInterrupt": "interrupted by the user",
    "raise SystemExit(3)": "SystemExit: 3",
    "raise ValueError('5 %s\\nmore')": "ValueError: 5 percents more",
    "raise ValueError('disc #3, ##')": "ValueError: disc #3, ##",
    "raise ValueError('x' * 5000)": f"ValueError: {'x' * 688}",
    "self.w = 'fast'": "w = 'fast': must be a number",
}


def test_what_the_code_of_a_partner_raises_is_its_message_and_the_host_lives(tmp_path):
    partners = [
        built(tmp_path / str(i), "steady_motor.py", SOURCE.replace("self.w += self.rate * h", code))
        for i, code in enumerate(RAISED)
    ]
    done = run_python(FAILING, *partners)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        f"SteadyMotor.fmu: {expected}" for expected in RAISED.values() for _ in range(40)
    ]


STATES = """
import ctypes
from pathlib import Path
from rotor_fmu.cosimulation.member import Member
messages = []
with Member(Path({other!r}), {{}}, messages) as other:
    of_other = other._fmu.serializeFMUstate(other._fmu.getFMUState())
with Member(Path({fmu!r}), {{"rate": 7.0}}, messages) as member:
    fmu = member._fmu
    member.begin()
    whole = fmu.serializeFMUstate(fmu.getFMUState())
    for _ in range(20):
        for bytes_of in (b"", b"garbage", whole[:-8], whole + whole[-8:], of_other):
            try:
                fmu.setFMUState(fmu.deSerializeFMUstate(bytes_of))
            except Exception:
                print(messages[-1])
        try:
            fmu.setFMUState(ctypes.c_void_p(0))
        except Exception:
            print("NULL")
    print(fmu.serializeFMUstate(fmu.getFMUState()) == whole, member.get(["rate"]))
"""


def test_a_state_that_is_none_is_refused_and_changes_nothing(tmp_path):
    partner = built(tmp_path, "steady_motor.py", SOURCE)
    other = built(tmp_path / "other", "steady_motor.py", f"{SOURCE}\n# another")
    done = run_python(STATES.format(fmu=str(partner), other=str(other)))
    assert done.returncode == 0, done.stderr
    *said, last = done.stdout.splitlines()
    assert said == [*["the FMU state is damaged, or of another FMU"] * 5, "NULL"] * 20
    assert last == "True {'rate': 7.0}"


def test_a_beginning_that_is_refused_can_be_made_with_other_parameters(tmp_path):
    begin = "if self.w_start > 120: raise ValueError('too fast')\n        self.w = self.w_start"
    text = SOURCE.replace("self.w = self.w_start", begin)
    with Member(built(tmp_path, "steady_motor.py", text), {"w_start": 130.0}, []) as member:
        with pytest.raises(RunFailed, match=r"ValueError: too fast$"):
            member.begin()
        member.set({"w_start": 110.0})
        member.begin()
        assert member.get(["w"]) == {"w": 110.0}
