import numpy as np
import pytest

from rotor_fmu.errors import InputError
from rotor_fmu.runs.recording import Recording, load_recording


def test_a_recording_comes_back_from_its_file_as_it_was(tmp_path):
    t = np.linspace(0.0, 1.0, 7)
    given = Recording(t, {"phi": t**2, "w": 2 * t}, {"phi": "rad", "w": "rad/s"}, {"status": "ok"})
    given.save(tmp_path / "recording.npz")
    found = load_recording(tmp_path / "recording.npz")
    assert np.array_equal(found.t, t)
    assert list(found.columns) == ["phi", "w"]
    assert np.array_equal(found.columns["phi"], t**2)
    assert (found.units, found.about) == (given.units, given.about)
    assert [path.name for path in tmp_path.iterdir()] == ["recording.npz"]


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04 cut short"])
def test_another_file_is_refused_by_its_name(tmp_path, content):
    path = tmp_path / "summary.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"summary\.npz: is no recording"):
        load_recording(path)
