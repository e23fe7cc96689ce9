# Everything a working copy needs, from a machine that has Python 3.11 or newer and make.
# The first target that needs it builds .venv; later runs find it ready.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.DEFAULT_GOAL := help
.PHONY: chaos foreign help demo test lowest lint types coverage flips mistakes invariants sound real-arm peers bench quoted steady figures picture stops studio-pictures reference docs golden studio studio-test vscode vscode-test dap-test dist lock clean

help:
	@echo "make demo        install, then run an example program"
	@echo "make test        install, then every check that a change must pass"
	@echo "make lowest      the tests of each extra with the lowest versions it promises, each in an environment of its own"
	@echo "make lint        style, format and import rules"
	@echo "make types       mypy"
	@echo "make coverage    the tests with branch coverage: a table by package, and what no test reaches"
	@echo "make steady      the tests ten times beside busy cores and twice on one core; TESTS=tests/services for a folder"
	@echo "make flips       change random constants of tables; prints the changes that no test notices (an hour)"
	@echo "make mistakes    plant 500 mistakes into sound programs, see which are told; writes docs/explanation/mistakes.md"
	@echo "make foreign     the tests of this Python as programs, beside Python itself; writes docs/explanation/as-python-is.md"
	@echo "make sound       the tests; every value of every program must be as the checker describes it"
	@echo "make invariants  the long random sweeps; writes their result into docs/explanation/motion.md"
	@echo "make chaos       random sessions for SECONDS=600, from SEED on: programs, devices, faults, people and clients"
	@echo "make stops       endless programs on a served robot, and how soon a stop acts: SHARD=1/8, an hour in all"
	@echo "make real-arm    record and fit 200 arms with hidden parameters; writes the tables of docs/explanation/real-arm.md"
	@echo "make peers       install other people's packages and compare with them; writes the result there too"
	@echo "make dap-test    the debug adapter with the test kit of VS Code's makers (needs Node)"
	@echo "make bench       the table of measured times; python -m benchmarks --against CHECKOUT compares two working copies"
	@echo "make quoted      every measured figure that README and docs quote, beside what is measured now"
	@echo "make figures     write the figures and measured tables of docs/explanation"
	@echo "make picture     take the picture of a plot page in docs/how-to/run.md again (needs Chromium)"
	@echo "make studio-pictures  take the pictures of the studio's tutorial again (needs Chromium)"
	@echo "make reference   write docs/reference from the code"
	@echo "make docs        build the site from docs and examples: build/site/html"
	@echo "make golden      record the event traces of the examples again"
	@echo "make studio      build the pages of the studio from web/ into the package"
	@echo "make vscode      pack the extension for VS Code: dist/elitescript-*.vsix"
	@echo "make vscode-test its types, and its tests without an editor"
	@echo "make dist        build wheel and sdist into dist/, check them, install and try the wheel in an environment of its own"
	@echo "make lock        resolve the requirements-*.lock again (needs uv)"
	@echo "make clean       remove .venv and caches"

# The named interpreter if it is new enough, else the newest python3.x on the path.
$(READY): requirements-dev.lock pyproject.toml
	@found=""; \
	for candidate in "$(PYTHON)" python3.13 python3.12 python3.11; do \
	    if "$$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then found="$$candidate"; break; fi; \
	done; \
	if [ -z "$$found" ]; then \
	    echo "elitescript needs Python 3.11 or newer; '$(PYTHON)' is $$("$(PYTHON)" --version 2>&1)." >&2; \
	    echo "Install one, or name it: make PYTHON=/path/to/python3.11 $(MAKECMDGOALS)" >&2; \
	    exit 1; \
	fi; \
	echo "Building $(CURDIR)/$(VENV) with $$("$$found" --version) ($$(command -v "$$found"))."; \
	echo "It downloads about $$(grep -c '==' requirements-dev.lock) Python packages (requirements-dev.lock) and installs elitescript from this folder,"; \
	echo "all into $(VENV): nothing outside of it changes. That takes 15 s to a minute ..."; \
	"$$found" -m venv --clear $(VENV)
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --require-hashes -r requirements-dev.lock
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --no-deps --no-build-isolation -e .
	@# pip compiles what it copies; an editable install is compiled at its first start, unless PYTHONDONTWRITEBYTECODE is set.
	@$(BIN)/python -m compileall -q src
	@touch $@

# Node comes from a Python package, in an environment of its own; packages from their locks, without their install scripts.
NODE := build/node
NODE_READY := $(NODE)/.ready
NODE_PATH := PATH="$(CURDIR)/$(NODE)/bin:$$PATH"
NPM_CI := npm ci --ignore-scripts --no-audit --no-fund --silent

$(NODE_READY): requirements-node.lock | $(READY)
	$(BIN)/python -m venv --clear $(NODE)
	$(NODE)/bin/python -m pip install -qq --disable-pip-version-check --require-hashes -r requirements-node.lock
	@touch $@

# The pages of the studio: web/ into src/elitescript/page/built/, which is part of wheel and sdist, not of the repository.
WEB_READY := web/node_modules/.ready
PAGE := src/elitescript/page/built/studio.html
WEB_SOURCES := $(shell find web/src -type f) web/build.mjs web/package.json tools/third_party.mjs

$(WEB_READY): $(NODE_READY) web/package-lock.json
	cd web && $(NODE_PATH) $(NPM_CI)
	@touch $@

$(PAGE): $(WEB_READY) $(WEB_SOURCES)
	cd web && $(NODE_PATH) node build.mjs

# What drives a browser in tests goes into .venv, where a browser is found; without one those tests are skipped.
BROWSER := $(shell command -v chromium || command -v chromium-browser || command -v google-chrome)
BROWSER_READY := $(if $(BROWSER),$(VENV)/.browser-ready)

$(VENV)/.browser-ready: $(READY) requirements-browser.lock
	$(BIN)/python -m pip install -qq --disable-pip-version-check --require-hashes -r requirements-browser.lock
	@touch $@

# Without a network for Node's packages, everything but the studio is there.
demo: $(READY)
	$(BIN)/elitescript run examples/pick_and_place.script
	@mkdir -p build
	@echo
	@echo "Building the page of the studio; that takes about 15 s more, and downloads 61 MB for Node ..."
	@npm_config_fetch_retries=0 $(MAKE) --no-print-directory studio >build/studio.log 2>&1 || \
	    echo "It was not built (build/studio.log says why); all other commands work. Try again with: make studio"
	@echo
	@echo "What to try next:"
	@echo "  $(BIN)/elitescript studio examples/pick_and_place.script      the program and the arm in a page: edit it, drag time"
	@echo "  $(BIN)/elitescript plot examples/pick_and_place.script        a page that shows this run"
	@echo "  $(BIN)/elitescript run examples/camera_picking.script --world examples/camera_picking.toml --log channels"
	@echo "  $(BIN)/elitescript check examples/*.script                    what is wrong in programs, without running them"
	@echo "  $(BIN)/elitescript serve                                      a controller with its network ports"
	@echo "  $(BIN)/elitescript --help                                     everything else"

test: lint types studio-test $(PAGE) $(BROWSER_READY)
	$(BIN)/python -m pytest

# EXTRAS names some of them, and `all` for all together. Downloads each package anew; about ten minutes.
EXTRAS ?=

lowest: $(READY) $(PAGE)
	$(BIN)/python -m tools.lowest $(EXTRAS)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-cache --no-logo

types: $(READY)
	$(BIN)/mypy

# Children of the program are measured too, except those with an environment of their own (`serve --untrusted`).
# Timing under measurement says nothing, so tests have longer; the table is printed even if one fails.
coverage: $(READY)
	rm -rf build/coverage
	mkdir -p build/coverage
	$(BIN)/python -m coverage run -m pytest --timeout 600; status=$$?; \
	$(BIN)/python -m coverage combine --quiet && \
	$(BIN)/python -m coverage json --quiet -o build/coverage/report.json && \
	$(BIN)/python -m tools.coverage_table build/coverage/report.json && exit $$status

# TESTS names files and folders; TIMES is the number of runs beside busy cores, ONE_CORE that on one core.
TESTS ?= tests
TIMES ?= 10
ONE_CORE ?= 2

steady: $(READY) $(PAGE) $(BROWSER_READY)
	$(BIN)/python -m tools.steady $(TESTS) --times $(TIMES) --one-core $(ONE_CORE)

# Which constants are changed follows SEED alone.
SEED ?= 1
COUNT ?= 100

flips: $(READY)
	$(BIN)/python -m tools.flip_constants --seed $(SEED) --count $(COUNT)

# Cases of each sweep; the round trips of the kinematics take ten times as many for each arm.
CASES ?= 10000

invariants: $(READY)
	ELITESCRIPT_INVARIANTS=$(CASES) ELITESCRIPT_RECORD=docs/explanation/invariants.json \
	    $(BIN)/python -m pytest -m "invariants or slow" --timeout 7200
	$(BIN)/python -m tools.draw_motion

# Other mistakes: python -m tests.mistakes --seed 2
mistakes: $(READY)
	$(BIN)/python -m tests.mistakes

# Needs the package `test` of the interpreter; a part: python -m tests.foreign --only test_list
PYPERFORMANCE := build/pyperformance-1.14.0

foreign: $(READY)
	@$(BIN)/python -m tests.foreign --installed
	$(BIN)/python -m pip install -qq --disable-pip-version-check --no-deps --upgrade --target $(PYPERFORMANCE) pyperformance==1.14.0
	$(BIN)/python -m tests.foreign --programs $(PYPERFORMANCE) --write

# An ordinary session looks at the values of one program in sixteen, this one at all of them; TESTS as above.
sound: $(READY)
	ELITESCRIPT_SOUND=all $(BIN)/python -m pytest $(TESTS) --timeout 1800

# Random sessions, each in leaps and tick by tick; what breaks is made short and written to build/chaos/.
SECONDS ?= 600
chaos: $(READY)
	$(BIN)/python -m tests.chaos --seconds $(SECONDS) $(if $(SEED),--seed $(SEED))

# Each command and each function of a module in a loop without end; one serve for all of a shard.
SHARD ?= 1/1
stops: $(READY)
	$(BIN)/python -m tests.stops --shard $(SHARD)

# Served arms run by the wall clock, so few at once; the rest is recorded in memory.
real-arm: $(READY)
	$(BIN)/python -m tools.real_arm

# Other people's packages go into .venv too, where `make test` and `make bench` find them from then on.
PEERS := eaik mcap-protobuf-support pin pymodbus roboticstoolbox-python ruckig scipy

peers: $(READY)
	$(BIN)/python -m pip install -qq --disable-pip-version-check $(PEERS)
	ELITESCRIPT_RECORD=docs/explanation/peers.json $(BIN)/python -m pytest -m peers
	$(BIN)/python -m tools.draw_motion

# The kit is installed as its lock file says, into build/; nothing else needs Node.
dap-test: $(READY)
	@if ! command -v npm >/dev/null; then echo "make dap-test needs Node; nothing was tested."; exit 0; fi; \
	rm -rf build/dap-kit && mkdir -p build && cp -r tests/dap/kit build/dap-kit && cd build/dap-kit && \
	npm ci --silent --no-audit --no-fund && \
	ELITESCRIPT=$(CURDIR)/$(BIN)/elitescript PROGRAMS=$(CURDIR)/build/dap-kit npx --no-install mocha session.test.js

figures: $(READY)
	$(BIN)/python -m tools.draw_motion

picture: $(PAGE) $(BROWSER_READY)
	$(BIN)/python -m tools.plot_picture

studio-pictures: $(PAGE) $(BROWSER_READY)
	$(BIN)/python -m tools.studio_tutorial

bench: $(READY)
	$(BIN)/python -m benchmarks

quoted: $(READY)
	$(BIN)/python -m benchmarks --quoted

reference: $(READY)
	$(BIN)/python tools/write_reference.py

# What builds the site goes into .venv too; `make test` does without it.
DOCS_READY := $(VENV)/.docs-ready

$(DOCS_READY): $(READY) requirements-docs.lock
	$(BIN)/python -m pip install -qq --disable-pip-version-check --require-hashes -r requirements-docs.lock
	@touch $@

docs: $(DOCS_READY)
	$(BIN)/python -m tools.build_site
	@echo "The site: build/site/html/index.html"

golden: $(READY)
	$(BIN)/python tools/record_golden.py

studio: $(PAGE)
	@echo "The studio is built. Start it: $(BIN)/elitescript studio examples/pick_and_place.script"

studio-test: $(WEB_READY)
	cd web && $(NODE_PATH) npm run --silent types
	cd web && $(NODE_PATH) npm run --silent test

EXTENSION := editors/vscode
EXTENSION_READY := $(EXTENSION)/node_modules/.ready
WITH_NODE := cd $(EXTENSION) && $(NODE_PATH)

$(EXTENSION_READY): $(NODE_READY) $(EXTENSION)/package-lock.json
	$(WITH_NODE) $(NPM_CI)
	@touch $@

vscode: $(EXTENSION_READY)
	@mkdir -p dist
	$(WITH_NODE) npm run --silent types
	$(WITH_NODE) npm run --silent build
	$(WITH_NODE) npx --no-install vsce package --no-dependencies --out $(CURDIR)/dist

vscode-test: $(EXTENSION_READY)
	$(WITH_NODE) npm run --silent types
	$(WITH_NODE) ELITESCRIPT=$(CURDIR)/$(BIN)/elitescript npm run --silent test

# The tools have an environment of their own; the wheel is built from the sdist.
dist: $(READY) $(PAGE)
	rm -rf dist build/dist
	$(BIN)/python -m venv build/dist/tools
	build/dist/tools/bin/python -m pip install -qq --disable-pip-version-check --require-hashes -r requirements-dist.lock
	build/dist/tools/bin/python -m build --no-isolation --outdir dist .
	build/dist/tools/bin/python -m twine check --strict dist/*
	$(BIN)/python -m tools.try_dist dist build/dist

COMPILE := uv pip compile pyproject.toml --universal --python-version 3.11 --generate-hashes \
    --no-emit-index-url --no-emit-find-links --custom-compile-command "make lock" --quiet

lock:
	$(COMPILE) --extra dev --output-file requirements-dev.lock $(LOCK_FLAGS)
	$(COMPILE) --extra docs --constraint requirements-dev.lock --output-file requirements-docs.lock $(LOCK_FLAGS)
	$(COMPILE) --extra dist --output-file requirements-dist.lock $(LOCK_FLAGS)
	$(COMPILE) --extra node --output-file requirements-node.lock $(LOCK_FLAGS)
	$(COMPILE) --extra browser --constraint requirements-dev.lock --output-file requirements-browser.lock $(LOCK_FLAGS)

clean:
	rm -rf $(VENV) src/elitescript/page/built web/node_modules .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis build dist $(EXTENSION)/node_modules $(EXTENSION)/build $(EXTENSION)/dist
