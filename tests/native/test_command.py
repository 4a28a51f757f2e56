"""`rotor-fmu build --native` and `rotor-fmu library` on the command line."""

import pytest

from ..processes import ROTOR_FMU, run_anew


def test_a_build_says_where_the_fmu_is_and_takes_no_compiler_once_the_library_is_there(
    fmu, tmp_path
):
    done = run_anew(
        ROTOR_FMU, "build", "--native", "--free", "--platform", "linux64", "--out", tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.strip() == str(tmp_path / "RotorBearingFreeNative.fmu")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("build", "--native", "--fmi", 4), "--fmi 4: must be 2 or 3"),
        (("build", "--fmi", 3), "--fmi 3: only with --native"),
        (("build", "--platform", "darwin64"), "--platform darwin64: must be one of linux64, win64"),
        (
            ("build", "--native", "--platform", "vax"),
            "--platform vax: must be one of linux64, win64",
        ),
        (("library", "--platform", "vax"), "--platform vax: must be one of linux64, win64"),
        (("library", "--platform", "her"), "wasm32, here; did you mean here?"),
    ],
)
def test_what_cannot_be_built_is_refused_in_one_line(arguments, sentence):
    done = run_anew(ROTOR_FMU, *arguments)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert sentence in done.stderr


def test_without_the_linker_it_says_what_to_install(tmp_path, monkeypatch):
    """With no library anywhere and a Python that does not find ziglang."""
    monkeypatch.setenv("ROTOR_FMU_CACHE", str(tmp_path))
    script = (
        "from pathlib import Path; from rotor_fmu.model.kernels import digest\n"
        f"digest.CARRIED = Path({str(tmp_path)!r})\n"
        "import sys; sys.modules['ziglang'] = None\n"
        "import importlib.util as u; find = u.find_spec\n"
        "u.find_spec = lambda name, *a: None if name == 'ziglang' else find(name, *a)\n"
        "from rotor_fmu.cli import main; sys.argv = ['rotor-fmu', 'library']; main()"
    )
    done = run_anew(script)
    assert done.returncode == 1
    assert "ziglang is not installed: pip install 'rotor-fmu[build]'" in done.stderr
