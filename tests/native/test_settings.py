"""The solver's parameters in the kernels give the settings that they give in Python, or the same
sentence; in a process without the compiler, since both are Python there."""

import os
import random
import subprocess
import sys
from pathlib import Path

import numpy as np

DRAWS = 4000


def compare():
    """Print how many draws gave settings and how many a refusal; the rest is asserted."""
    from rotor_fmu.model.machine.toml import rig
    from rotor_fmu.model.march.block import LAYOUT, new_block, set_method
    from rotor_fmu.model.settings import SettingsError
    from rotor_fmu.model.structure.assembly import assemble

    from rotor_fmu.fmi.solver_parameters import settings_of, solver_parameters
    from rotor_fmu.library.messages import SENTENCES
    from rotor_fmu.library.resolve_settings import SLOTS, doubt, settle

    draw = random.Random(4)
    block = new_block(assemble(rig()), 1)
    run = LAYOUT.look(block)
    table = [v for v in solver_parameters() if v.name != "solver.reduction"]
    good = refused = warned = 0
    for _ in range(DRAWS):
        values = {v.name: v.start for v in table} | {"solver.reduction": 0}
        for v in draw.sample(table, draw.choice([0, 1, 1, 2, 2, 3, 4])):
            values[v.name] = (
                draw.randint(v.low, v.high)
                if v.kind == "Integer"
                else draw.choice([-2.0, -0.3, 0.0, 0.08, 0.1, 0.5, 1e-3, 1e-5, 0.9, 1.0])
            )
        given = np.full(1 + len(SLOTS), np.nan)
        for v in table:
            name = v.name.removeprefix("solver.").replace("adaptive", "mode")
            at = 0 if name == "preset" else 1 + SLOTS.index(name)
            if at == 0 or values[v.name] != v.start:
                given[at] = values[v.name] - (1 if at and v.choices else 0)
        own, told, expected, reason = given.copy(), np.zeros(8), [], ""
        code = settle(run, given, told)
        try:
            settings = settings_of(values, warn=expected.append)
        except SettingsError as error:
            reason = str(error)
        if reason:
            refused += 1
            assert _spelled(SENTENCES[code], told) == reason, (values, code)
            continue
        good += 1
        assert code == 0, (values, SENTENCES[code])
        seen = run.method.numbers.copy()
        set_method(run, settings.scheme(), settings.control())
        assert seen.tolist() == run.method.numbers.tolist(), values
        codes = [doubt(run, given, own, told, slot) for slot in range(len(SLOTS))]
        warnings = [SENTENCES[code] for code in codes if code]
        assert [w.partition(" = ")[0] for w in warnings] == [
            w.partition(" = ")[0] for w in sorted(expected, key=_slot(SLOTS))
        ], values
        warned += bool(warnings)
    print(good, refused, warned)


def _slot(slots):
    return lambda text: slots.index(text.removeprefix("solver.").partition(" = ")[0])


def _spelled(pattern, numbers):
    for number in numbers:
        pattern = pattern.replace("{g}", f"{number:g}", 1)
    return pattern


def test_random_parameters_are_settled_as_in_python():
    done = subprocess.run(
        [sys.executable, "-c", "from tests.native.test_settings import compare; compare()"],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert all(int(count) > DRAWS / 20 for count in done.stdout.split()), done.stdout
