# What there is to do here. The environment is made once, in .venv, from pyproject.toml; what
# only the tests or the lint need is added to it when they are first run.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PROGRAM := $(VENV)/.installed
TESTS := $(VENV)/.tests
TOOLS := $(VENV)/.lint
WORKERS ?= auto

.PHONY: help demo test bench lint docs clean

help:
	@echo "make demo   install, and run the default cyclic test into ./demo"
	@echo "make test   all tests, on all cores (WORKERS=0: in one process)"
	@echo "make bench  speed, accuracy and memory, each beside its target"
	@echo "make lint   ruff, mypy, import contracts"
	@echo "make docs   regenerate every number and figure in README and docs"
	@echo "make clean  forget the environment and all results"

$(PROGRAM): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e .
	touch $@

$(TESTS): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[test]"
	touch $@

$(TOOLS): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[lint]"
	touch $@

demo: $(PROGRAM)
	$(BIN)/thermobearing cyclic -o demo --force

test: $(TESTS)
	$(BIN)/python -m pytest --numprocesses $(WORKERS)

bench: $(TESTS)
	$(BIN)/python -m benchmarks

lint: $(TOOLS)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(TESTS)
	$(BIN)/python docs/generate.py

clean:
	rm -rf $(VENV) demo build dist
