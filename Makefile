# What there is to do here. The environment is made once, in .venv, from pyproject.toml.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: help demo test bench lint docs clean

help:
	@echo "make demo   install, and run the default cyclic test into ./demo"
	@echo "make test   all tests"
	@echo "make bench  speed, accuracy and memory, each beside its target"
	@echo "make lint   ruff, mypy, import contracts"
	@echo "make docs   regenerate every number and figure in README and docs"
	@echo "make clean  forget the environment and all results"

$(STAMP): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e ".[test,lint]"
	touch $(STAMP)

demo: $(STAMP)
	$(BIN)/thermobearing cyclic -o demo --force

test: $(STAMP)
	$(BIN)/python -m pytest

bench: $(STAMP)
	$(BIN)/python -m benchmarks

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(STAMP)
	$(BIN)/python docs/generate.py

clean:
	rm -rf $(VENV) demo build dist
