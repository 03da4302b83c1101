# SPDX-License-Identifier: BSD-3-Clause
# make demo: set up and run the main job.  make test: set up and run all tests.

PYTHON ?= python3
VENV := .venv
OTHERS := .venv-others
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt
# switch on the long parts: make test PYTEST="--slow --embedded"
PYTEST ?=
# robots whose packages are in the repository
ROBOTS := $(notdir $(wildcard generated/*))
# of make fuzz, all builds together: some 15 minutes of one core, 8 of two
EXECUTIONS ?= 10000000
# of make adversarial, inputs in all
N ?= 1000000
# faults that make mutants puts into the sources, one at a time
SAMPLE ?= 200
# which of them: a fault stays in the sample of its seed as long as its line stays
SEED ?= 0

.PHONY: demo install test coverage mutants mutants-sample lint format bench bench-c bench-opt fuzz adversarial \
	generated docs clean

demo: $(VENV)/installed
	$(BIN)/softimpact design robots/studies/panda_24_poses.toml
	$(BIN)/softimpact design robots/studies/panda_24_poses.toml --motors free \
		--out results/panda_24_poses_free_motors

install: $(VENV)/installed-test

test: $(VENV)/installed-test
	$(BIN)/pytest -n auto --dist worksteal $(PYTEST)

# as test, with the lines that no test passes through, and which tests pass through the others
coverage: $(VENV)/installed-test
	$(BIN)/pytest -n auto --dist worksteal --cov --cov-context=test --cov-report=term:skip-covered $(PYTEST)

# small faults in symbolic and codegen that no test notices; first make coverage
mutants: $(VENV)/installed-test
	$(BIN)/python tests/mutation/run.py symbolic codegen --sample $(SAMPLE) --seed $(SEED)

# some where the limits that protect people are, each of which must be noticed; half a minute
mutants-sample: $(VENV)/installed-test
	$(BIN)/pytest -q tests/symbolic/body --cov --cov-context=test --cov-report=
	$(BIN)/python tests/mutation/run.py symbolic/body --sample 32 --seed $(SEED) --strict

lint: $(VENV)/installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/mypy tests benchmarks examples

format: $(VENV)/installed-test
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(VENV)/installed-test
	$(BIN)/python -m benchmarks

# instructions, stack and code size on emulated Cortex-M, written to codegen/record/costs, docs/embedded.md
# and the packages themselves, which needs arm-none-eabi-gcc and QEMU;
# then the same numbers by Pinocchio, CasADi, adam and urdf2casadi
bench-c: $(VENV)/installed-test $(OTHERS)/installed
	$(BIN)/python benchmarks/embedded/run.py
	$(MAKE) generated
	$(BIN)/python benchmarks/cost/run.py --others $(OTHERS)/bin/python --out docs/benchmarks.md

# one robust design by us and by general optimisers, some ten minutes
bench-opt: $(VENV)/installed-test
	$(BIN)/python benchmarks/design/run.py --budget 1500 --out docs/benchmarks-design.md

# libFuzzer on packages of seven robots, float and double; needs clang
fuzz: $(VENV)/installed-test
	FUZZ_EXECUTIONS=$(EXECUTIONS) $(BIN)/pytest -n 2 --slow tests/codegen/test_fuzzing.py $(PYTEST)

# safe speeds of nine robots, float and double, against the tests' own integrator: a ms an input; goes on
# from where it was stopped
adversarial: $(VENV)/installed-test
	PYTHONPATH=tests $(BIN)/python -m adversarial --inputs $(N)

generated: $(VENV)/installed
	for robot in $(ROBOTS); do \
		study=$$(ls robots/studies/$${robot}_*.toml 2>/dev/null); \
		$(BIN)/softimpact generate $$robot --out generated/$$robot $${study:+--poses $$study} || exit 1; \
	done

# the site, build/site/html/index.html; needs no network once its tools are installed
docs: $(VENV)/installed-docs
	$(BIN)/python docs/site/build.py

clean:
	rm -rf $(VENV) $(OTHERS) build dist results

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable .
	touch $@

$(VENV)/installed-test: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable '.[test]'
	touch $@ $(VENV)/installed

$(VENV)/installed-docs: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable '.[docs]'
	touch $@ $(VENV)/installed

# other generators want other versions of what we use
$(OTHERS)/installed: benchmarks/cost/requirements.txt
	$(PYTHON) -m venv $(OTHERS)
	$(OTHERS)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --requirement $<
	touch $@
