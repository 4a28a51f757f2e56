"""What a partner's own code raises is a message, and never the end of the host."""

import pytest

from ..processes import run_python
from .test_coupling import SOURCE
from .test_members import built

FAILING = """
from pathlib import Path
from rotor_fmu.cosimulation.member import Member
for _ in range(20):  # a reference too few and the host would be gone
    with Member(Path({fmu!r}), {{}}, []) as member:
        member.begin()
        for t in (0.0, 1e-3):
            try:
                member.step(t, 1e-3)
                member.get(["w"])
            except Exception as error:
                print(error)
"""


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("raise KeyboardInterrupt", "interrupted by the user"),
        ("raise SystemExit(3)", "SystemExit: 3"),
        ("raise ValueError('5 %s\\nmore')", "ValueError: 5 percents more"),
        ("raise ValueError('x' * 5000)", f"ValueError: {'x' * 688}"),
        ("self.w = 'fast'", "w = 'fast': must be a number"),
    ],
)
def test_what_the_code_of_a_partner_raises_is_its_message_and_the_host_lives(
    tmp_path, code, expected
):
    partner = built(tmp_path, "steady_motor.py", SOURCE.replace("self.w += self.rate * h", code))
    done = run_python(FAILING.format(fmu=str(partner)))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [f"SteadyMotor.fmu: {expected}"] * 40
