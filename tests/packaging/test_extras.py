"""What has to be installed: what every run imports; one line that names the extra for the rest."""

import ast
import re
import sys
import tomllib

import pytest

from rotor_fmu.errors import InputError, optional
from tools.checkout import ROOT, names

from ..processes import run_anew

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
INTERNAL = {"rotor_fmu", "rotor_fmu_slave", "rotor_fmu_wrapper"}
# What lies in an FMU or makes the library runs where the rest is not.
OF_EXTRAS = {
    "model/kernels/dispatching.py": "kernels",
    "rotor_fmu/library/emit.py": "kernels",
    "rotor_fmu/library/entry_points.py": "kernels",
    "rotor_fmu/library/objects.py": "kernels",
}
# A module of another name than its package, and what comes with one.
PACKAGES = {"llvmlite": "numba", "dask": "distributed"}


def packages(requirements):
    """Names of requirements, and of those of the project's own extras."""
    result = set()
    for requirement in requirements:
        own = re.fullmatch(r"rotor-fmu\[(.*)\]", requirement)
        if own:
            for extra in own[1].split(","):
                result |= packages(PROJECT["optional-dependencies"][extra])
        else:
            result.add(re.match(r"[A-Za-z0-9_-]+", requirement)[0].lower())
    return result


REQUIRED = packages(PROJECT["dependencies"])
EXTRAS = {name: packages(of) for name, of in PROJECT["optional-dependencies"].items()}
SOURCES = sorted(
    name for name in names() if name.endswith(".py") and name.startswith(("model/", "rotor_fmu/"))
)


def imported(nodes):
    """Packages from outside that these nodes import, none for checkers of types alone."""
    for node in nodes:
        if isinstance(node, ast.If) and ast.unparse(node.test) in (
            "TYPE_CHECKING",
            "_TYPE_CHECKING",
        ):
            continue
        if isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            modules = [node.module]
        else:
            modules = []
        tops = {module.partition(".")[0] for module in modules}
        yield from tops - set(sys.stdlib_module_names) - INTERNAL


def walked(tree):
    """All nodes but those for checkers of types alone."""
    nodes = [tree]
    for node in nodes:
        if isinstance(node, ast.expr):  # which imports nothing
            continue
        yield node
        if not (isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")):
            nodes += ast.iter_child_nodes(node)


def test_what_is_required_are_seven_packages_in_ranges():
    assert len(PROJECT["dependencies"]) == 7
    for requirement in PROJECT["dependencies"]:
        assert re.fullmatch(r"[\w-]+>=[\d.]+,<[\d.]+", requirement)


@pytest.mark.parametrize("name", SOURCES)
def test_a_module_imports_what_is_required_or_what_its_extra_brings(name):
    tree = ast.parse((ROOT / name).read_text())
    allowed = REQUIRED | EXTRAS.get(OF_EXTRAS.get(name), set())
    at_once = {PACKAGES.get(top, top).lower() for top in imported(tree.body)}
    assert not at_once - allowed
    later = {PACKAGES.get(top, top).lower() for top in imported(walked(tree))}
    users = ("kernels", "build", "report", "study", "cluster", "units", "threads")
    assert not later - REQUIRED - set().union(*(EXTRAS[extra] for extra in users))


def test_what_is_not_installed_is_one_sentence_that_names_its_extra():
    assert optional("math", "study", "anything").pi
    with pytest.raises(InputError) as caught:
        optional("no_such.module", "study", "--analyse")
    said = "--analyse: no_such is not installed: pip install 'rotor-fmu[study]'"
    assert str(caught.value) == said


def without(module, *arguments):
    """The command, in a process in which a module is not installed."""
    script = (
        f"import sys; sys.modules[{module!r}] = None\n"
        f"sys.argv = ['rotor-fmu', *{[str(a) for a in arguments]!r}]\n"
        "from rotor_fmu.cli import main; main()"
    )
    return run_anew(script)


def test_a_study_names_its_extra(tmp_path):
    (tmp_path / "study.toml").write_text("")
    done = without("pyarrow", "study", tmp_path / "study.toml", "--out", tmp_path / "out")
    said = "rotor-fmu: study: pyarrow is not installed: pip install 'rotor-fmu[study]'\n"
    assert (done.returncode, done.stderr) == (2, said)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_without_what_draws_the_page_a_run_leaves_the_rest_and_says_so(tmp_path):
    """The page alone, asked for, is refused."""
    run = ("run-down", "--direct", "--set", "speed=100", "--stop", 0.1)
    done = without("bokeh", *run, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    said = [line for line in done.stderr.splitlines() if "report.html" in line]
    assert said == [
        "warning: report.html is not written: a page of a run: bokeh is not installed: "
        "pip install 'rotor-fmu[report]'"
    ]
    assert done.stdout.endswith(f"; open {tmp_path}.\n")
    left = {file.name for file in tmp_path.iterdir()}
    assert "recording.npz" in left
    assert "report.html" not in left
    asked = without("bokeh", "report", tmp_path)
    assert asked.returncode == 2
    assert "pip install 'rotor-fmu[report]'" in asked.stderr
    assert len(asked.stderr.splitlines()) == 1


@pytest.mark.slow
def test_without_what_limits_threads_the_linear_answers_are_there(tmp_path):
    done = without("threadpoolctl", "modes", "--speed", "100", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "modes.png").exists()


def test_the_recipe_of_conda_asks_for_the_same_packages():
    recipe = (ROOT / "packaging" / "conda-forge" / "recipe.yaml").read_text()
    run, constraints = re.search(
        r"  run:\n(.*?)  run_constraints:\n(.*?)\n\n", recipe, re.DOTALL
    ).groups()
    ranges = [
        dict(re.findall(r"- ([a-z0-9]+)(?:-base)? (>=\S+)", lines)) for lines in (run, constraints)
    ]
    ours = [
        dict(re.findall(r"([a-z0-9]+)(>=\S+)", " ".join(of)))
        for of in (
            [f"python{PROJECT['requires-python']}", *PROJECT["dependencies"]],
            [
                *PROJECT["optional-dependencies"]["units"],
                *PROJECT["optional-dependencies"]["report"],
            ],
        )
    ]
    assert ranges == ours
