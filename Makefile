# railhil: `make run` and `make test` need Python 3.11+, git and make.

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
COMMA  := ,
# Arguments that `make run` passes on, e.g. make run ARGS="yizhuang_01_songjiazhuang_xiaocun --seed 7"
ARGS   ?=
# Set as in every railhil command (railhil/common/exit_codes.py): the tests start hundreds of processes.
export OPENBLAS_NUM_THREADS ?= 1
# make test-long SAMPLE=4: one long test of 4 only, and make test-builds SAMPLE=8 one run of 8: those of the day.
SAMPLE ?=
DAY    ?= $(shell date -u +%F)
SAMPLED = $(if $(SAMPLE),--sample $(SAMPLE) --day $(DAY))
UV_EXPORT    = $(BIN)/uv export -q --frozen --no-emit-project --no-annotate
PART         = $(BIN)/python -m hil_tests.part
COUNTS       = build/test_counts
# JUnit reports of the tests that run here, for `railhil dossier --validation build/validation`.
VALIDATION   = build/validation
REPORTED     = --junitxml=$(VALIDATION)/$@.xml
COUNTED      = $(PART) --counts $(COUNTS)
HERE         = not needs_socketcan and not needs_docker
# A file at a time, so that the fixtures of a module are made once; hil_tests/conftest.py puts the long ones first.
# WORKERS more than there are cores, because some tests wait; each takes 5 s of processor time to find all tests.
SIDE_BY_SIDE = $(BIN)/pytest -q -n $$(($$(nproc) + $(WORKERS))) --dist loadfile --no-loadscope-reorder
WORKERS      = 1
# The half of the tests on kernel SocketCAN that runs on a kernel of its own, by file.
VCAN_FIRST   = test_faults or test_can_utils or test_outage or test_slcan or test_gateway
# Files of tests that keep real time: collecting all the others takes as long as some of these tests.
REAL_TIME    = $$(grep -rlw --include='test_*.py' wall_clock hil_tests)

# `make help` lists what people use. The others are parts of it, which hosted CI calls one by one.
PEOPLE = run test test-fast test-long lint docs figures release dbc lock install clean help
.PHONY: $(PEOPLE) test-here test-builds test-side-by-side test-long-side-by-side test-real-time test-vcan test-vcan-first test-vcan-second test-vcan-long test-docker test-docker-vcan test-compiled test-arm64 locked

# A run that misses the limits of its scenario (exit code 1) is a result, not an error of make.
run: RUN_ARGS = $(strip $(or $(ARGS),--controller ipfc_plus))
run: $(VENV)/.installed  ## a run of the published scenario, or of ARGS
	@echo "railhil run $(RUN_ARGS): plant, controller and supervisor, three processes on a bus"
	@$(BIN)/railhil run $(RUN_ARGS) || [ $$? -eq 1 ]

# Lint and all tests but the long ones, with the capabilities (compilers, Chromium, kernel SocketCAN, Docker) brought up
# where this machine permits. Packages, kernels and images of the last parts are fetched and built from the beginning
# on, beside installation and lint. Docker waits most of the time, so it has its part beside the tests side by
# side. The tests in real time leave the processors idle most of the time: two virtual machines take that time, and only
# that (--behind). Parts that run beside others are printed whole at their end; the last line is the sum.
test: | $(VENV)/bin/pip  ## lint and all tests but the long ones, with what they need
	@rm -rf $(COUNTS) $(VALIDATION) && mkdir -p $(VALIDATION)
	@$(BIN)/python -m hil_tests.prepared machines & \
	  $(MAKE) --no-print-directory $(VENV)/.installed-dev && \
	  { $(BIN)/python -m hil_tests.prepared batches bytecode & prepared=$$!; \
	    $(MAKE) --no-print-directory lint && wait $$prepared; } && \
	  $(MAKE) --no-print-directory PART="$(COUNTED)" DOCKER_OUT=">build/docker.txt 2>&1" -j2 test-side-by-side test-docker; \
	  code=$$?; wait; exit $$code
	@cat build/docker.txt
	@$(BIN)/railhil doctor --quick --json >$(VALIDATION)/doctor.json
	@$(MAKE) --no-print-directory PART="$(COUNTED)" BEHIND=--behind -j3 -Otarget test-vcan-first test-vcan-second test-real-time
	@$(PART) --counts $(COUNTS) --total 5

# Tests that take minutes together and seldom fail: benchmarks, long comparisons of batch, bench and exported C, search
# and training, emulated boards and containers on a kernel with CAN. `.ci/run` does a sample of it after `make test`.
test-long: $(VENV)/.installed-dev  ## the long tests; SAMPLE=8: one of eight, those of the day
	@rm -f $(COUNTS)
	@$(MAKE) --no-print-directory PART="$(COUNTED)" BEHIND=--behind -j2 -Otarget test-long-side-by-side test-docker-vcan test-vcan-long
	@$(PART) --counts $(COUNTS) --total 3

# The tests that a developer runs all day: a file at a time on each core, without tests that are slow or need a machine.
test-fast: WORKERS = 0
test-fast: $(VENV)/.installed-dev  ## the quick tests
	$(SIDE_BY_SIDE) -m "$(HERE) and not slow and not long and not wall_clock"

# All tests that need no machine. Tests in real time run after the rest.
test-here: $(VENV)/.installed-dev
	@$(MAKE) --no-print-directory test-side-by-side
	@$(MAKE) --no-print-directory test-real-time

test-side-by-side: $(VENV)/.installed-dev
	@$(PART) --tool compilers --tool emulation --tool browser --tool ssh "tests side by side" $(SIDE_BY_SIDE) $(REPORTED) -m "$(HERE) and not long and not wall_clock"

test-long-side-by-side test-vcan-long: export RAILHIL_SAMPLE = $(if $(SAMPLE),$(SAMPLE) $(DAY))
test-long-side-by-side test-vcan-long: OF_DAY = $(if $(SAMPLE), (one of $(SAMPLE): those of $(DAY)))
test-long-side-by-side: $(VENV)/.installed-dev
	@$(PART) --tool compilers --tool emulation --tool browser --tool ssh "long tests$(OF_DAY)" $(SIDE_BY_SIDE) $(REPORTED) -m "$(HERE) and long"

test-real-time: $(VENV)/.installed-dev
	@$(PART) "tests in real time" $(BIN)/pytest -q $(REPORTED) -m "$(HERE) and wall_clock" $(REAL_TIME)

# On kernel SocketCAN: the host's, else that of a throw-away virtual machine (Debian), where the long tests are left out.
test-vcan test-vcan-first test-vcan-second test-vcan-long: $(VENV)/.installed-dev
	@$(PART) $(BEHIND) --tool can-utils --tool compilers --tool emulation "kernel SocketCAN$(HALF)" $(BIN)/python -m hil_tests.transport.vcan $(VCAN)

test-vcan-first: HALF = , first half
test-vcan-first: VCAN = -k "$(VCAN_FIRST)"
test-vcan-second: HALF = , second half
test-vcan-second: VCAN = -k "not ($(VCAN_FIRST))"
test-vcan-long: HALF = , long tests$(OF_DAY)
test-vcan-long: VCAN = --long

# docker-compose.yml on a real engine: the host's, else a private one (root on Debian).
test-docker: $(VENV)/.installed-dev
	@$(PART) Docker $(BIN)/python -m hil_tests.machines.docker_engine --timeout 1500 -- \
	  $(BIN)/pytest -q -m needs_docker hil_tests/transport/compose $(DOCKER_OUT)

# The same on a kernel with CAN.
test-docker-vcan: $(VENV)/.installed-dev
	@$(PART) $(BEHIND) "Docker on kernel CAN" $(BIN)/python -m hil_tests.transport.compose.vcan_runs

# The hashes of every law and every fault of the catalogue with the compiled build and without it: ten minutes.
test-compiled: $(VENV)/.installed-dev
	@$(BIN)/python -m hil_tests.compiled_build $(SAMPLED) $(ARGS)

# The hashes of ipfc in every arithmetic on aarch64, emulated and cross-compiled; of every law: python -m hil_tests.arm64.
test-arm64: $(VENV)/.installed-dev
	@$(BIN)/python -m hil_tests.arm64 --compiled --law ipfc $(SAMPLED)

# One hash for each seed with every build, here and on aarch64. `.ci/run` does a sample of it last.
test-builds: $(VENV)/.installed-dev
	@$(MAKE) --no-print-directory -j2 -Otarget test-compiled test-arm64

# mypy and import-linter see the packages as they lie in a wheel, by links in build/tree.
lint: $(VENV)/.installed-dev  ## ruff, mypy, import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@$(BIN)/python setup.py tree
	$(BIN)/mypy
	cd build/tree && $(abspath $(BIN))/lint-imports ../../pyproject.toml --cache-dir ../../.import_linter_cache

# The checks of a release (docs/howto/release.md): all tests, every mutant of the code that judges, moves and protects
# (hil_tests/mutation/targets.toml), then wheel and source archive; hours.
release: test  ## all tests, mutants, wheel and source archive; hours
	@$(MAKE) --no-print-directory test-long
	@$(MAKE) --no-print-directory test-builds
	@$(BIN)/python -m hil_tests.mutation
	@$(BIN)/python -m hil_tests.wheels

# The pages of docs and those made from the code, to be opened without a network: build/site/index.html.
docs: $(VENV)/.installed-dev  ## the site of the documentation, in build/site
	@$(BIN)/python -m hil_tests.documents.site $(ARGS)

# Outputs of commands, and the figures in tables and text, into README.md and the pages of docs (hil_tests/documents); long.
# ARGS="docs/reference/laws.md", ARGS=--quick: a page, or without what `make test-long` checks.
figures: $(VENV)/.installed-dev  ## what commands print, and figures, into the pages
	@$(BIN)/python -m hil_tests.documents $(ARGS)

dbc: $(VENV)/.installed  ## dbc/railhil.dbc from the port table
	$(BIN)/python -m railhil.dbc.generate

install: $(VENV)/.installed  ## railhil and its libraries into .venv

$(VENV)/bin/pip:
	@echo "making the virtual environment $(VENV) with $$($(PYTHON) --version 2>&1)"
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "railhil needs Python 3.11 or newer")'
	@$(PYTHON) -m venv $(VENV) || { [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null \
	  && apt-get update -q && apt-get install -y -q python3-venv && $(PYTHON) -m venv $(VENV); }

# One line for each step of pip: on a slow machine all of them take minutes. Its complaints go to standard error.
# (awk and grep may keep lines back until they have many.) A module's bytecode is made at its first import: for
# all libraries it would take as long as fetching them.
PIP_STEPS = while read -r word rest; do set -- $$rest; case "$$word $$rest" in \
  Collecting*) echo "  fetching $$1";; \
  "Building wheel"*started) echo "  building $$3";; \
  "Installing collected"*) echo "  unpacking $$(($$\# - 2)) packages";; esac; done
pip-install = { $(BIN)/pip install --no-compile --disable-pip-version-check --progress-bar off $(1); echo $$? >$(VENV)/.pip-exit; } \
  | $(PIP_STEPS); exit $$(cat $(VENV)/.pip-exit)

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/pip
	@echo "installing railhil and its libraries into $(VENV) (once):"
	@$(call pip-install,-e '.[report]')
	@touch $@

$(VENV)/.installed-dev: pyproject.toml | $(VENV)/bin/pip
	@echo "installing railhil with the libraries of tests, reports and campaigns into $(VENV) (once):"
	@$(call pip-install,-e '.[dev$(COMMA)report$(COMMA)campaign$(COMMA)dask]')
	@touch $@ $(VENV)/.installed

# The locks of hosted CI anew: the newest versions that pyproject.toml permits, one file for all Pythons, every wheel with
# its hash. requirements/bench.txt is the part that a run with its report needs.
lock: | $(VENV)/bin/pip  ## the lock of hosted CI anew
	@$(BIN)/pip install -q uv
	@rm -f uv.lock && $(BIN)/uv lock -q --python $(BIN)/python
	@$(UV_EXPORT) --all-extras -o requirements/ci.txt
	@$(UV_EXPORT) --extra report --group build -o requirements/bench.txt
	@rm uv.lock

# Installs what the lock names, as hosted CI does before any other target; then railhil itself.
# antlr4-python3-runtime (of rtamt) has no wheel: it is built, with the setuptools of the smaller lock.
locked: | $(VENV)/bin/pip
	@$(call pip-install,--require-hashes --only-binary=:all: -r requirements/bench.txt)
	@$(call pip-install,--require-hashes --only-binary=:all: --no-binary=antlr4-python3-runtime --no-build-isolation -r requirements/ci.txt)
	@$(call pip-install,--no-deps --no-build-isolation -e .)
	@touch $(VENV)/.installed-dev $(VENV)/.installed

clean:  ## without .venv, build and caches
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache

help:
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12
