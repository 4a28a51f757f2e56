"""How an FMU's package comes into a process: from its own folder, and from nowhere else."""

from .test_hosting import in_a_process


def test_the_search_path_does_not_grow_with_instances_or_folders(fmu):
    seen = in_a_process(
        fmu,
        """
lengths, entries = [], []
for i in range(3):
    folder = fmpy.extract(path)
    for j in range(3):
        start(new()).freeInstance()
        lengths.append(len(sys.path))
    entries.append(sum("resources" in entry for entry in sys.path))
show(lengths=lengths, entries=entries)
""",
        is_anew=True,
    )
    assert seen.entries == [1] * 3
    assert seen.lengths == [seen.lengths[0]] * 9


def test_its_modules_come_from_its_own_folder_and_are_few(fmu):
    seen = in_a_process(
        fmu,
        """
before = set(sys.modules)
start(new()).freeInstance()
ours = [m.__file__ for name, m in sys.modules.items() if name.startswith("rotorbearing_")]
new_packages = {name.partition(".")[0] for name in set(sys.modules) - before}
show(folder=str(folder), ours=ours, new_packages=sorted(new_packages))
""",
        is_anew=True,
    )
    assert len(seen.ours) == 4
    assert all(file.startswith(seen.folder) for file in seen.ours), seen
    assert not {"numpy", "scipy", "numba", "rotor_fmu", "model"} & {*seen.new_packages}


def test_its_folder_may_be_gone_when_a_run_begins_and_nothing_is_kept_anywhere(fmu, tmp_path):
    seen = in_a_process(
        fmu,
        """
instance = new()
shutil.rmtree(folder)
start(instance)
instance.doStep(0.0, 0.02)
instance.reset()
start(instance)
instance.doStep(0.0, 0.02)
show(log=log)
""",
        {"ROTOR_FMU_CACHE": str(tmp_path), "HOME": str(tmp_path)},
    )
    assert seen.log == []
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
