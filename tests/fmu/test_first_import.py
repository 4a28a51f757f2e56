"""How an FMU's package comes into a process: from its own folder, and from nowhere else."""

import pytest

from rotor_fmu.packing.bundle import package_name

from .test_hosting import in_a_process

# where the code is compiled is of no matter here
INTERPRETED = {"NUMBA_DISABLE_JIT": "1"}


def test_the_search_path_does_not_grow_with_instances_or_folders(fmu):
    in_a_process(
        fmu,
        """
lengths = []
for i in range(3):
    folder = fmpy.extract(path)
    for j in range(3):
        start(new()).freeInstance()
        lengths.append(len(sys.path))
    assert sum("resources" in entry for entry in sys.path) == 1
assert len(set(lengths)) == 1, lengths
""",
        INTERPRETED,
    )


def test_nothing_that_lies_in_the_cache_folder_is_imported_or_taken_away(fmu, tmp_path):
    planted = "raise SystemExit('planted')\n"
    places = [
        *(tmp_path / f"{name}.py" for name in ("numpy", "scipy", "pythonfmu", package_name())),
        tmp_path / "packages" / package_name() / "numpy" / "__init__.py",
        tmp_path / "packages" / package_name() / package_name() / "__init__.py",
        tmp_path / "packages" / package_name() / package_name() / "fmu" / "__init__.py",
    ]
    for place in places:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(planted)
    in_a_process(
        fmu,
        """
start(new()).freeInstance()
ours = [m for name, m in sys.modules.items() if name.startswith("rotorbearing_")]
assert len(ours) > 20
assert all(m.__file__.startswith(str(folder)) for m in ours)
""",
        {"ROTOR_FMU_CACHE": str(tmp_path), **INTERPRETED},
    )
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert sorted(files) == sorted(places)
    assert all(place.read_text() == planted for place in places)


def test_an_fmu_knows_the_users_folder(fmu, tmp_path):
    done = in_a_process(
        fmu,
        """
new()
(name,) = (n for n in sys.modules if n.endswith(".kernels.user_cache"))
print(sys.modules[name].user_cache())
""",
        {"ROTOR_FMU_CACHE": str(tmp_path), **INTERPRETED},
    )
    assert done.stdout.split() == [str(tmp_path)]


@pytest.mark.slow
def test_an_fmu_whose_kept_code_is_damaged_compiles_it_again(fmu, tmp_path):
    step = "i = start(new())\ni.doStep(0.0, 0.02)\nprint(i.getReal([refs['disc[3].y']]))"
    environment = {"ROTOR_FMU_CACHE": str(tmp_path), "ROTOR_FMU_KERNELS": "numba"}
    first = in_a_process(fmu, step, environment)
    (folder,) = (tmp_path / "code").iterdir()
    # what is called from Python: the code of these holds that of all that they call
    kept = sorted(folder.glob("*.march.entries.*"))
    assert len(kept) > 2
    damaged = {}
    for i, file in enumerate(kept):
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 255
        damaged[file] = b"" if i % 2 else bytes(content)
        file.write_bytes(damaged[file])
    assert in_a_process(fmu, step, environment).stdout == first.stdout
    assert all(file.read_bytes() not in (b"", content) for file, content in damaged.items())
    third = in_a_process(fmu, step, environment)
    assert third.stdout == first.stdout
    assert third.stderr == ""


@pytest.mark.slow
def test_an_fmu_compiles_after_its_folder_is_deleted(fmu, tmp_path):
    script = """
instance = new()
shutil.rmtree(folder)
start(instance)
instance.doStep(0.0, 0.02)
"""
    environment = {"ROTOR_FMU_CACHE": str(tmp_path), "ROTOR_FMU_KERNELS": "numba"}
    in_a_process(fmu, script, environment)
