"""Machines of the tests of `rotor-fmu bearing`."""

from pathlib import Path

from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing

EXAMPLES = Path(__file__).parents[2] / "examples"
OIL, ROLLING, SQUEEZE = (
    EXAMPLES / folder / "rotor.toml" for folder in ("oil_film", "rolling_bearing", "squeeze_film")
)
PNG = b"\x89PNG"


def with_part(part):
    """The rotor of the oil film's example with one bearing in the place of its films."""
    rotor = parse_rotor(OIL.read_text(encoding="utf-8")).with_parts(JournalBearing)
    return rotor.with_parts(type(part), part)
