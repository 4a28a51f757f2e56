"""Used for long an FMU keeps its memory flat and leaves nothing in temporary folders."""

from pathlib import Path

import pytest

from .test_hosting import in_a_process

SOAK = """
CYCLES, STEPS, STATES = {counts}
H = 1e-4
def cycle():
    instance = start(new(), speed=300.0)
    instance.doStep(0.0, H)
    instance.terminate()
    instance.freeInstance()
instance, done = start(new(), speed=300.0), 0
def step():
    global done
    instance.doStep(done * H, H)
    done += 1
def state():
    kept = instance.getFMUstate()
    data = instance.serializeFMUstate(kept)
    instance.setFMUstate(kept)
    instance.freeFMUstate(kept)
    again = instance.deSerializeFMUstate(data)
    instance.freeFMUstate(again)
grown = []
for call, count in ((cycle, CYCLES), (step, STEPS), (state, STATES)):
    for _ in range(count // 10):
        call()
    before = resident()
    for _ in range(count):
        call()
    grown.append(resident() - before)
instance.doStep(done * H, H)
seen = instance.getReal([refs["disc[3].y"]])[0]
instance.freeInstance()
shutil.rmtree(folder)
print(*grown, seen)
"""
WRAPPER = 4.0  # kB that pythonfmu's wrapper keeps of an instance: lists of the script's names
linux = pytest.mark.skipif(not Path("/proc/self/statm").is_file(), reason="needs Linux's /proc")


def soak(fmu, folder, counts, an_instance):
    """Run the script; an_instance: what each may leave behind [kB], steps and states nothing but
    what the memory's own rounding does."""
    folder.mkdir()
    script = SOAK.replace("{counts}", repr(counts))
    done = in_a_process(fmu, script, {"TMPDIR": str(folder)}, seconds=7200)
    *grown, seen = map(float, done.stdout.split())
    assert grown[0] < 4000 + an_instance * counts[0], grown
    assert max(grown[1:]) < 1000, grown
    assert -1e-3 < seen < 0.0
    assert list(folder.iterdir()) == []


@linux
def test_some_hundred_instances_steps_and_states_leave_nothing_behind(fmu, tmp_path):
    soak(fmu, tmp_path / "temporary", (20, 500, 100), WRAPPER)


@linux
@pytest.mark.slow
def test_ten_thousand_instances_a_million_steps_and_ten_thousand_states_leave_nothing_behind(
    fmu, tmp_path
):
    soak(fmu, tmp_path / "temporary", (10_000, 1_000_000, 10_000), WRAPPER)
