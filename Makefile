# make demo     set up what is missing, run the pipeline on the simulated rig
# make test     set up what is missing, run the tests
# make test-all the same with the long ones: more measured rigs and seeds
# make docs     the documentation, into site/
# make setup    only set up
# make picture  draw the pictures in the README again: the verdict, and the live view (with ROS 2 and Chromium)
# make bench    speed of solver and fit
# make bench-live  processor time and memory of the live view, ten minutes
# make blind    the long study with hidden causes; ARGS="--variants" foreign laws, ARGS="--mujoco --rounds 20" MuJoCo's rigs
# make real     measured rigs beside the repository (../shared/data), and what is true of them; without the data it says so
# make bench-export  exported models replayed in MuJoCo, wrong models, measured rigs (long)
# make blind-design  designed experiments on rigs with a hidden cause, and for µ (long); writes docs/blind-design.md
# make sensitivity  halve and double each tuned constant on blind cases (long, resumes); writes docs/tuning.md
# make study    are all effects recovered, do the intervals cover the truth (long); writes docs/accuracy.md
# make soak     half an hour of random faults to the nodes; writes its table into docs/reliability.md
# make load     1 kHz for ten minutes and 10 kHz for five while the cores burn; writes its table there too
# make fuzz     kills, cuts, damage and bad data, many of each; writes docs/reliability.md (long)
# make audit    known weaknesses of the locked dependencies (asks the package registry about each)
# make clean    remove what these made

SHELL := /bin/bash
.DEFAULT_GOAL := help
PY := .venv/bin/python
# Tests at once; many wait for nodes, so one more than two cores.
JOBS ?= 3

# A sourced ROS installation and the wheels in .venv do not mix.
unexport AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH PYTHONPATH PYTHONHOME RMW_IMPLEMENTATION

# Every process that a command or a test starts would compile the package's bytecode anew.
unexport PYTHONDONTWRITEBYTECODE

# Matrices of ten by ten: threads of BLAS would only compete with the threads that fit.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: help setup demo test test-all lint docs docs-output picture bench bench-batch bench-compare bench-watch bench-export bench-live \
        blind blind-design real sensitivity study soak load fuzz audit clean

help:
	@sed -n 's/^# \(make .*\)/\1/p' Makefile

setup:
	@tools/setup.sh

demo: setup
	@.venv/bin/msd demo $(ARGS)

lint: setup
	@.venv/bin/ruff check .
	@.venv/bin/mypy

# The types are checked meanwhile: by one process, which would leave the other cores with nothing to do. A test process that
# dies ends the run, with the test's name: another in its place would wait for ever at the end (pytest-xdist's issue 1327).
test: CHOSEN = -m 'not long'
test test-all: setup
	@.venv/bin/ruff check .
	@.venv/bin/mypy >build/types.txt 2>&1 & types=$$!; trap 'kill $$types 2>/dev/null' EXIT; \
	$(PY) -m pytest -n $(JOBS) --max-worker-restart 0 --dist loadgroup --no-loadscope-reorder $(CHOSEN) $(ARGS) && \
	{ wait $$types; found=$$?; cat build/types.txt; exit $$found; }

# Not --quiet: it would swallow the warnings that --strict makes errors.
docs: setup
	@NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --strict $(ARGS)

# The output that the pages show, from today's commands.
docs-output: setup
	@$(PY) docs/generate/transcript.py docs/tutorial.md docs/paper.md

bench-live: setup
	@$(PY) -m bench.live $(ARGS)

picture: setup
	@.venv/bin/msd diagnose bags/drag_steps --figures out/picture --overwrite
	@cp out/picture/drag_steps/verdict.png docs/images/verdict.png
	@.venv/bin/msd diagnose bags/drag_steps --quiet --json out/picture/drag.json --overwrite
	@.venv/bin/msd export out/picture/drag.json --to mujoco --out out/picture/drag.xml --figures out/picture --overwrite
	@cp out/picture/drag_steps_in_mujoco/fit.png docs/images/export.png
	@$(PY) -m bench.live --rate 200 --picture docs/images/live.png

bench: setup
	@$(PY) -m bench $(ARGS)

# On a quiet machine: ARGS='--only speed --records 1000'; bench-compare ARGS='--pairs 300'; bench-watch ARGS='--years 200'.
bench-batch: setup
	@$(PY) -m bench.batch $(ARGS)

bench-compare: setup
	@$(PY) -m bench.compare $(ARGS)

bench-watch: setup
	@$(PY) -m bench.watch $(ARGS)

bench-export: setup
	@$(PY) -m bench.export $(ARGS)

blind-design: setup
	@$(PY) -m bench.blind_design --docs docs $(ARGS)
	@$(PY) -m bench.sharpening --docs docs

blind: setup
	@$(PY) -m bench.blind --docs docs $(ARGS)

real: setup
	@$(PY) -m bench.real $(ARGS)

sensitivity: setup
	@$(PY) -m bench.sensitivity --docs docs $(ARGS)

study: setup
	@mkdir -p out/study
	@for seed in 0 1000; do $(PY) bench/study_coverage.py --seed $$seed --json out/study/coverage_$$seed.json || true; done
	@$(PY) bench/study_recovery.py $(ARGS) --verbose --json out/study/recovery.json || true
	@$(PY) bench/study_table.py --recovery out/study/recovery.json --coverage out/study/coverage_*.json --out docs/accuracy.md

soak: setup
	@ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST $(PY) -m bench.reliability.nodes --write $(ARGS)

load: setup
	@$(PY) -m bench.reliability.load --write $(ARGS)

fuzz: setup
	@$(PY) -m bench.reliability $(ARGS)

audit:
	@python3 -m venv build/audit && build/audit/bin/pip -q install pip-audit
	@build/audit/bin/pip-audit --strict --no-deps --disable-pip -r requirements/lock.txt $(ARGS)

# The compiled solver lies in the user's cache, for all checkouts.
clean:
	@rm -rf "$${XDG_CACHE_HOME:-$$HOME/.cache}/msd_ident"
	@rm -rf .venv build install log dist out site *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	@find . -name __pycache__ -type d -not -path './.git/*' -prune -exec rm -rf {} +
