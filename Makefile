# Two commands matter: `make mission` runs the main job, `make test` runs all tests. Each sets up what is missing.
# ARGS is handed on: make mission ARGS="--seed 3 --record", make test ARGS="tests/geometry".

VENV := .venv
BIN := $(VENV)/bin
SYSTEM_LIBRARIES := libegl1 libgl1 libusb-1.0-0 libgomp1
IS_NEW_ENOUGH := 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))'
# The first that answers; a name on the path may be a shim with nothing behind it.
PYTHON ?= $(shell for p in python3.11 python3.12 python3.13 python3; do \
	$$p -c $(IS_NEW_ENOUGH) 2>/dev/null && { echo $$p; break; }; done)

export PIP_DISABLE_PIP_VERSION_CHECK := 1
# The heavy libraries start a thread for each core, which spin between their calls and wait for one another.
export OMP_NUM_THREADS ?= 1

.PHONY: mission test docs test-fast benchmark check lint setup clean
.DEFAULT_GOAL := mission

mission: setup
	$(BIN)/executive run pick_and_place $(ARGS)

# A file of tests to a core, so that what is slow to set up is set up once; tests/conftest.py orders them.
ON_ALL_CORES = --numprocesses auto --dist loadfile --no-loadscope-reorder

test: export OMP_NUM_THREADS = 1
test: setup
	$(BIN)/python -m pytest $(ON_ALL_CORES) $(ARGS)

# All but missions and slow tests.
test-fast: export OMP_NUM_THREADS = 1
test-fast: setup
	$(BIN)/python -m pytest -m "not mission and not slow" $(ON_ALL_CORES) $(ARGS)

# One of docs/benchmarks.md: make benchmark NAME=neighbours
benchmark: setup
	OMP_NUM_THREADS=1 $(BIN)/python tests/benchmarks/$(or $(NAME),lidar_speed).py $(ARGS)

# The pages as a site in build/site; fails if a link or a page is missing.
docs: setup
	$(BIN)/mkdocs build --strict

check: lint test

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@mkdir -p build/typing && ln -sfn ../../plugins build/typing/executive_plugins
	$(BIN)/mypy
	$(BIN)/lint-imports

setup: $(VENV)/.packages $(VENV)/.system

# torch by itself first: pip then takes the CPU build from wherever one is configured (PIP_EXTRA_INDEX_URL, find-links),
# and no other package can pull in another one.
$(VENV)/.packages: pyproject.toml
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer with venv is needed, such as: apt-get install python3-venv"; exit 2; }
	@test -x $(BIN)/python || { echo "Setting up $(VENV) with $(PYTHON) (minutes, once)"; $(PYTHON) -m venv $(VENV); }
	@$(BIN)/pip install --quiet "torch==2.13.0"
	@$(BIN)/pip install --quiet --editable ".[dev]"
	@touch $@

$(VENV)/.system: $(VENV)/.packages
	@missing=""; \
	for name in $(SYSTEM_LIBRARIES); do dpkg -s $$name >/dev/null 2>&1 || missing="$$missing $$name"; done; \
	say() { echo "System libraries are missing. Install them: sudo apt-get install$$missing"; exit 2; }; \
	as_root=""; test "$$(id -u)" = 0 || as_root="sudo -n"; \
	if [ -z "$$missing" ]; then :; \
	elif ! command -v apt-get >/dev/null; then echo "No Debian: see that these are installed:$$missing"; \
	elif ! $$as_root true 2>/dev/null; then say; \
	else $$as_root apt-get update -qq && $$as_root apt-get install -y -qq --no-install-recommends $$missing >/dev/null || say; fi
	@touch $@

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
