"""A film that is not laminar at a speed is warned of: ISO 7902-1, Re = rho w R c / mu above 41.3
sqrt(R / c), where vortices may form (the square of Re sqrt(c / R) is 1708 there: Taylor 1923)."""

import math
import warnings

import pytest
from rotor_fmu.model.laws_at_rest.oil import machine_with_oil
from rotor_fmu.model.machine.speed_ranges import speed_ranges

import rotor_fmu as rf

from ..toml_text import table

RADIUS, CLEARANCE, DENSITY, VISCOSITY = 0.2, 2e-4, 870.0, 0.02
CRITICAL = 41.3 * math.sqrt(RADIUS / CLEARANCE)
# speed at which a film of a viscosity of 1 Pa.s is critical
PER_VISCOSITY = CRITICAL / (DENSITY * RADIUS * CLEARANCE)
FILM = {"journal_radius": RADIUS, "length": 0.1, "clearance": CLEARANCE, "density": DENSITY}


def machine_in(**oil):
    text = table("material", young=2e11, density=7800.0) + table("[section]", length=1.0, outer=0.3)
    text += table("[unbalance]", node=1, amount=1e-3)
    return rf.parse(
        text
        + "".join(
            table("[journal_bearing]", node=node, short=True, **FILM | oil) for node in (1, 2)
        )
    )


def said_of_first(answer, *arguments, **options):
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        result = answer(*arguments, **options)
    said = [str(w.message) for w in issued]
    return result, [s for s in said if s.startswith("journal_bearing[1]: speed")]


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_modes_and_runs_of_a_film_above_the_critical_reynolds_number_say_so(sense):
    machine, speed = machine_in(viscosity=VISCOSITY), sense * PER_VISCOSITY * VISCOSITY
    for run in (False, True):
        for ratio, count in ((0.999, 0), (1.001, 1)):
            if run:
                result, said = said_of_first(
                    rf.simulate,
                    machine,
                    speed=ratio * speed,
                    stop=1e-4,
                    record=["journal_bearing[1].fx"],
                )
                assert ("not-laminar" in result.status) == bool(count)
            else:
                _, said = said_of_first(machine.modes, ratio * speed)
            assert len(said) == count
            assert all(f"its film exceeds {CRITICAL:.4g} (ISO 7902-1)" in s for s in said)


def test_a_viscosity_over_the_speed_is_that_of_the_critical_speed():
    """mu = a - b w between two speeds: w = p (a - b w)."""
    ends = PER_VISCOSITY * VISCOSITY, 2.0 * PER_VISCOSITY * VISCOSITY
    listed = machine_in(viscosity=[1.5 * VISCOSITY, 0.5 * VISCOSITY], speed=list(ends))
    b = VISCOSITY / (ends[1] - ends[0])
    a = 1.5 * VISCOSITY + b * ends[0]
    (first, _) = (r for r in speed_ranges(listed.rotor) if r.code == "not-laminar")
    assert first.high == pytest.approx(PER_VISCOSITY * a / (1.0 + PER_VISCOSITY * b), rel=1e-6)


def test_a_film_with_a_heat_balance_has_its_own_density():
    oil = {"viscosity": [VISCOSITY, 0.999 * VISCOSITY], "temperature": [40.0, 200.0]}
    balanced = machine_in(**oil, speed=[10.0, 20.0], static_load=5e3)
    (first, _) = (
        r for r in speed_ranges(machine_with_oil(balanced.rotor)) if r.code == "not-laminar"
    )
    assert first.high == pytest.approx(PER_VISCOSITY * VISCOSITY, rel=2e-3)


def test_a_periodic_response_is_computed_and_says_so():
    machine, speed = machine_in(viscosity=VISCOSITY), 1.001 * PER_VISCOSITY * VISCOSITY
    found = rf.response(machine, speed=(0.99 * speed, speed), stability=False)
    assert [note.code for note in found.notes].count("not-laminar") == 2
