# Every target sets the environment up first, where that is still to be done.
.PHONY: help set-up environment demo test lint bench docs notebooks clean-environment

# These take an hour or more, or want another version beside this one.
STUDIES = compile everyday in_turns peers random_conserving random_scenes

help:
	@echo 'make demo               set up and run the flexible double pendulum (ARGS="--help")'
	@echo 'make test               set up and run the tests (ARGS="-k lie"; all: SLOW=yes)'
	@echo 'make lint               ruff and mypy'
	@echo 'make bench              the benchmarks, but for long studies'
	@echo 'make docs               the documentation site, results/site/index.html'
	@echo 'make notebooks          six lessons in JupyterLab (ARGS="--no-browser")'
	@echo 'make clean-environment  remove the private Debian root and all else in its cache folder'
	@echo 'tools/run CMD...        run any command in the environment'

set-up:
	@tools/setup

environment:
	@tools/setup --only

demo: set-up
	tools/run python3 demos/double_pendulum.py --case 1 $(ARGS)

# Tests that take half a minute each, a third of the time of all, wait for .ci/run.
SLOW =
QUICK = $(if $(SLOW),,-m "not slow")

# The tests start hundreds of interpreters: Python keeps their bytecode, also if the shell forbids it.
test: environment
	env --unset=PYTHONDONTWRITEBYTECODE tools/run python3 -m pytest --numprocesses=auto --maxprocesses=8 --dist=worksteal $(QUICK) $(ARGS)

lint: environment
	tools/lint

bench: environment
	@set -e; for script in $(filter-out $(STUDIES:%=benchmarks/%.py),$(wildcard benchmarks/*.py)); do echo "$$script"; tools/run python3 "$$script"; done

docs:
	tools/docs

notebooks:
	tools/notebooks $(ARGS)

clean-environment:
	tools/setup --remove
