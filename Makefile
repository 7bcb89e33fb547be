# prime's commands. Whatever needs the virtual environment makes it first.
#
#   make quick    run the main job on little data
#   make test     run the tests that take seconds
#   make check    all that a change must pass

VENV := .venv
PYTHON ?= $(firstword $(shell for name in python3.12 python3 python; do \
	$$name -c 'import sys; sys.exit(sys.version_info < (3, 12))' 2>/dev/null && echo $$name; done))
DISTRIBUTIONS := . $(patsubst %/pyproject.toml,%,$(wildcard plugins/*/pyproject.toml))
PACKAGES := $(addprefix --editable ,$(DISTRIBUTIONS)) --group dev 'lerobot[dataset,diffusion]' pip
INSTALLED := $(VENV)/.installed

# uv resolves and unpacks in a minute what takes pip ten. It need not be there: it comes first.
# It trusts the certificates that the system trusts, as pip is set up to.
INSTALL = $(VENV)/bin/uv pip install --system-certs --python $(VENV)/bin/python

.PHONY: install quick format lint type test test-slow build check clean

install: $(INSTALLED)

$(INSTALLED): constraints.txt $(addsuffix /pyproject.toml,$(DISTRIBUTIONS)) | $(VENV)/bin/python
	@# robosuite asks for evdev, which comes as source.
	@command -v cc >/dev/null || { test "$$(id -u)" = 0 && apt-get update -qq \
	&& apt-get install -y -qq --no-install-recommends gcc libc6-dev >/dev/null; } || { echo "prime: \
	evdev is built here and needs a C compiler and Linux's headers. Debian: apt-get install gcc \
	libc6-dev" >&2; exit 1; }
	$(VENV)/bin/python -m pip install --quiet --constraint constraints.txt uv
	$(INSTALL) --constraint constraints.txt $(PACKAGES)
	@# Two distributions write the folder cv2. The last one stays: the one without a screen.
	$(INSTALL) --quiet --no-deps --force-reinstall --constraint constraints.txt opencv-python-headless
	touch $@

$(VENV)/bin/python:
	@$(or $(PYTHON),false) -c 'import sys; sys.exit(sys.version_info < (3, 12))' || { echo "prime \
	needs Python 3.12 or later, here is $$($(or $(PYTHON),python3) --version 2>&1 | head -n 1). Install one ('pyenv install 3.12' does), or say where it is: \
	make PYTHON=/path/to/python3.12" >&2; exit 1; }
	@# Debian keeps ensurepip in a package of its own; a pip that is there does as well.
	$(PYTHON) -m venv $(VENV) 2>/dev/null || { $(PYTHON) -m venv --clear --without-pip $(VENV) \
	&& $(PYTHON) -m pip --python $(VENV)/bin/python install --quiet pip; } || { rm -rf $(VENV); \
	echo "prime: $(PYTHON) has neither ensurepip nor pip. Debian: apt-get install \
	$(notdir $(PYTHON))-venv" >&2; exit 1; }

quick: install
	$(VENV)/bin/prime run experiments/lift_quick.yaml

format: install
	$(VENV)/bin/ruff check --fix-only .
	$(VENV)/bin/ruff format .

lint: install
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .

type: install
	$(VENV)/bin/mypy --strict prime_core

# A file's tests share what they set up, so they stay in one process; the longest file goes first.
PARALLEL := -n 2 --dist loadfile --no-loadscope-reorder --durations 15

test: install
	$(VENV)/bin/pytest $(PARALLEL) -m "not slow"

# Whole experiments: killed, with other workers, and on Slurm where one answers (tests/start_slurm.sh);
# installs from wheels; LeRobot's own classes. SLOW="slow and not campaign" leaves out the longest.
SLOW := slow

test-slow: install
	$(VENV)/bin/pytest $(PARALLEL) -m "$(SLOW)"

# The wheels, and the tests against them: an environment that takes prime from the wheels and
# all else from the development environment, whose editable prime it does not see.
build: install
	rm -rf build dist
	$(VENV)/bin/python -m pip wheel --quiet --no-deps --wheel-dir dist $(DISTRIBUTIONS)
	$(VENV)/bin/python -m venv --without-pip build/wheels
	$(VENV)/bin/python -m pip --python build/wheels/bin/python install --quiet --no-deps dist/*.whl
	$(VENV)/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))' \
	> "$$(build/wheels/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/base.pth"
	build/wheels/bin/python -P -c 'import prime_core; assert "build/wheels" in prime_core.__file__'
	PATH="$$PWD/build/wheels/bin:$$PATH" build/wheels/bin/python -P -m pytest $(PARALLEL) -m "not slow"

check: lint type test build

clean:
	rm -rf build dist
