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
show(grown=grown, y=seen)
"""
WRAPPER = 4.0  # kB that pythonfmu's wrapper keeps of an instance: lists of the script's names
linux = pytest.mark.skipif(not Path("/proc/self/statm").is_file(), reason="needs Linux's /proc")


def soak(fmu, folder, counts):
    """The script's `grown` [kB] by instances, steps and states, its last `y` [m], and the files
    `left` in the temporary folder."""
    folder.mkdir()
    script = SOAK.replace("{counts}", repr(counts))
    seen = in_a_process(fmu, script, {"TMPDIR": str(folder)}, seconds=7200)
    seen.left = [path.name for path in folder.iterdir()]
    return seen


@linux
@pytest.mark.parametrize(
    "counts", [(10, 500, 100), pytest.param((10_000, 1_000_000, 10_000), marks=pytest.mark.slow)]
)
def test_instances_steps_and_states_leave_nothing_behind(fmu, tmp_path, counts):
    seen = soak(fmu, tmp_path / "temporary", counts)
    of_instances, *of_others = seen.grown
    assert of_instances < 4000 + WRAPPER * counts[0]
    assert max(of_others) < 1000  # the memory's own rounding
    assert -1e-3 < seen.y < 0.0
    assert seen.left == []
