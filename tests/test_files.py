"""What ends a program while it writes leaves what was there before, and nothing else."""

import pytest

from rotor_fmu.files import unfinished


def test_a_file_takes_its_place_when_it_is_whole(tmp_path):
    target = tmp_path / "summary.json"
    with unfinished(target) as part:
        part.write_text("whole")
        assert part.suffix == ".json"  # writers choose a format by it
        assert not target.exists()
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [
        (target.name, "whole")
    ]


@pytest.mark.parametrize("end", [KeyboardInterrupt, OSError])
def test_what_stops_the_writing_leaves_the_old_file_alone(tmp_path, end):
    target = tmp_path / "summary.json"
    target.write_text("old")

    def write():
        with unfinished(target) as part:
            part.write_text("half")
            raise end

    with pytest.raises(end):
        write()
    (left,) = tmp_path.iterdir()
    assert (left, left.read_text()) == (target, "old")
