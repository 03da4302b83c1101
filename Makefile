# SPDX-License-Identifier: BSD-3-Clause
# make demo: set up and run the main job.  make test: set up and run all tests.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt
# switch on the long parts: make test PYTEST="--slow --embedded"
PYTEST ?=

.PHONY: demo test lint format bench bench-c generated clean

demo: $(VENV)/installed
	$(BIN)/softimpact design robots/studies/panda_24_poses.toml

test: $(VENV)/installed-test
	$(BIN)/pytest -n auto $(PYTEST)

lint: $(VENV)/installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(VENV)/installed-test
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(VENV)/installed-test
	$(BIN)/python -m benchmarks

# instructions, stack and code size on emulated Cortex-M; needs arm-none-eabi-gcc and QEMU
bench-c: $(VENV)/installed-test
	$(BIN)/python benchmarks/embedded/run.py --out docs/embedded.md

generated: $(VENV)/installed
	for robot in panda rr rmin; do \
		study=$$(ls robots/studies/$${robot}_*.toml 2>/dev/null); \
		$(BIN)/softimpact generate $$robot --out generated/$$robot $${study:+--poses $$study} || exit 1; \
	done

clean:
	rm -rf $(VENV) build dist results

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable .
	touch $@

$(VENV)/installed-test: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable '.[test]'
	touch $@ $(VENV)/installed
