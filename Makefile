# Needs Python 3.11+ with pip; everything else goes into .venv.
PYTHON ?= python3
VENV := .venv
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
else
BIN := $(VENV)/bin
endif
# most of what is installed is never imported: what is, Python compiles once then
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile

# the tests start many processes, each of which would compile every module that it imports
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run-down reproduce survey reference test test-native test-all test-processors test-lowest docs pages dist lint types coverage mutants bench clean

$(VENV)/made: pyproject.toml
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Python 3.11 or newer is needed: make PYTHON=...')"
	$(PYTHON) -m venv $(VENV)
	$(INSTALL) --editable ".[report,units,threads]"
	touch $(VENV)/made

# what the papers need beside what running needs
$(VENV)/made-papers: $(VENV)/made
	$(INSTALL) --editable ".[papers]"
	touch $(VENV)/made-papers

# what testing needs beside what running needs
$(VENV)/made-test: $(VENV)/made
	$(INSTALL) --editable ".[test,lint,coverage,docs,build]"
	$(INSTALL) --no-deps cofmupy==1.0.0
	touch $(VENV)/made-test

# the solver as machine code, made anew after a change of it; what makes it is installed where there is
# none, and the linker zig where a C compiler cannot do what it does
KERNELS := $(wildcard model/*.py model/*/*.py rotor_fmu/library/*.py rotor_fmu/fmi/machine_table.py rotor_fmu/fmi/c/*)
$(VENV)/library: $(VENV)/made $(KERNELS)
	extra=$$($(BIN)/python -c "from rotor_fmu.library.build import missing_here as m; print(m())"); \
		test -z "$$extra" || $(INSTALL) --editable ".[$$extra]"
	$(BIN)/rotor-fmu library --platform here \
		|| { $(INSTALL) --editable ".[build]" && $(BIN)/rotor-fmu library --platform here; } \
		|| echo "no FMU can be built, and runs are slow"
	touch $(VENV)/library

run-down: $(VENV)/library
	$(BIN)/rotor-fmu run-down --out out/run_down

reproduce: $(VENV)/library $(VENV)/made-papers
	$(BIN)/python -m papers.zigulic2003 --out out/reproduce

survey: $(VENV)/library $(VENV)/made-papers
	$(BIN)/python -m papers.integrators survey --out out/survey

# after a change of the model's numbers: the result that the FMU carries
reference: $(VENV)/library
	$(BIN)/python -m rotor_fmu.fmi.packing.reference

test: $(VENV)/made-test $(VENV)/library
	$(BIN)/python -m pytest -n auto --dist loadfile

test-native: $(VENV)/made-test $(VENV)/library
	$(BIN)/python -m pytest -n auto --dist loadfile -m "native and not slow"

test-all: $(VENV)/made-test $(VENV)/library
	$(BIN)/python -m pytest -n auto --dist loadfile -m "slow or not slow"

# all tests as on other processors, and on loaded cores: hours; stopped with Ctrl-C it goes on from there
test-processors: $(VENV)/made-test $(VENV)/library
	$(BIN)/python -m tools.processors

# the quick tests with the lowest versions that pyproject.toml allows
test-lowest: $(VENV)/library
	$(INSTALL) uv
	$(BIN)/uv venv --quiet --clear --seed --python $(BIN)/python build/lowest
	$(BIN)/uv pip install --quiet --python build/lowest --resolution lowest-direct --editable ".[test,docs,build]"
	$(BIN)/uv pip install --quiet --python build/lowest --no-deps cofmupy==1.0.0
	$(subst $(VENV),build/lowest,$(BIN))/python -m pytest -n auto --dist loadfile

# the documentation as a site that works from disk: build/site/index.html
docs: $(VENV)/made-test
	$(BIN)/python docs/site/build.py

# what is made from the code: pages of commands, machine files, variables, integrators; the packages' picture
pages: $(VENV)/made
	$(BIN)/python -m docs.site.made

lint: $(VENV)/made-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(MAKE) types

# `rotor_fmu.model` lies in model/, `rotor_fmu.examples` in examples/: links make one tree of them
types: $(VENV)/made-test
	rm -rf build/types
	mkdir -p build/types/rotor_fmu
	ln -s $(CURDIR)/rotor_fmu/* $(CURDIR)/model $(CURDIR)/examples build/types/rotor_fmu
	$(BIN)/python -m mypy

# wrong versions of description, documents, FMU and ledger that the tests must see
mutants: $(VENV)/made-test $(VENV)/library
	$(BIN)/python -m tools.mutants

# lines of Python that the tests run; kernels are machine code and not among them
coverage: $(VENV)/made-test $(VENV)/library
	$(BIN)/python -m pytest -n auto --dist loadfile --cov --cov-report=term:skip-covered

# what a run costs beside other programs; stopped with Ctrl-C it goes on from there
bench: $(VENV)/library
	for peers in scikit-sundae exudyn "ross-rotordynamics plotly<7"; do \
		$(INSTALL) $$peers \
			|| echo "$$peers: cannot be installed; the report will say so"; \
	done
	$(INSTALL) --editable ".[study,cluster]"
	$(BIN)/python -m benchmarks
	$(BIN)/python -m benchmarks.throughput

# source archive and wheel, which holds the solver for all platforms, in dist/, checked, installed and
# used; HOME_URL=address of the files for an index page's pictures
dist: $(VENV)/made-test
	$(INSTALL) build twine
	$(BIN)/rotor-fmu library
	$(BIN)/python tools/release.py "$(HOME_URL)"

clean:
	rm -rf $(VENV) model/library out build dist *.egg-info .pytest_cache .ruff_cache RotorBearing.fmu RotorBearingFree.fmu
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
