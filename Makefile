# Sets up, tests, packages and shows Turgor. `make help` lists what there is.
# Needs Rust and Python 3.11 (Blender 4.5 LTS); with Python 3.13 also serves Blender 5.2 LTS.
SHELL := /bin/bash
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-builtin-rules

# What `make demo` shows: a scene of blend_fixtures/, or any .blend, .glb, .gltf or .fbx with a rigged character; or
# `fleshing`: bodies bent along a spine, after the paper's experiments; or `weights`: automatic weights beside Blender's own;
# or `refine`: coarse characters before and after their meshes are refined; or `folds`: deep bends before and after repair.
SCENE ?= elephant
FILE  ?= .fixtures/$(SCENE).blend
SHOWN  = $(if $(filter fleshing weights refine folds,$(SCENE)),demo.$(SCENE),demo "$(FILE)")
PYTEST_FLAGS ?= -q

HAS_3.13 := $(shell environment/find_python.sh 3.13 2>/dev/null)
TOOLS    := .venv-3.11/bin
NEWEST   := $(if $(HAS_3.13),.venv-3.13,.venv-3.11)

ENGINE_SOURCES    := $(shell find rust -type f -not -path '*/target/*' -not -name '*.pyc') Cargo.toml Cargo.lock pyproject.toml
EXTENSION_SOURCES := $(shell find addon packaging manual -type f -not -name '*.pyc')
FIXTURE_SOURCES   := $(wildcard blend_fixtures/*.py)

.PHONY: help pictures demo speed test every-test check-fast lint format bench mutants engine-mutants package wheel lock clean
.PHONY: lint-rust lint-python test-rust test-python test-3.11 test-3.13

help: ## this list
	@grep -hE '^[a-z.-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

# ---- environments --------------------------------------------------------------------------------------------------

.venv-%/.ready: environment/requirements-%.txt environment/create.sh
	environment/create.sh $*
	touch $@

lock: ## resolve the pinned versions of all tools anew
	environment/lock.sh 3.11
	environment/lock.sh 3.13

# ---- what is shipped -----------------------------------------------------------------------------------------------

wheel: dist/.wheel ## the engine as a Python wheel, in dist/

dist/.wheel: $(ENGINE_SOURCES) packaging/stamp_wheel.py | .venv-3.11/.ready
	mkdir -p dist && rm -f dist/*.whl
	$(TOOLS)/maturin build --release --locked --out dist
	$(TOOLS)/python packaging/stamp_wheel.py dist/*.whl
	touch $@

# The engine for tests, outside of the environments: there Blender gets it from the extension zip, as artists do.
dist/site-packages: dist/.wheel
	rm -rf $@
	$(TOOLS)/python -m pip install --quiet --disable-pip-version-check --no-index --no-deps --target $@ dist/*.whl

package: dist/.extension ## the extension zip, validated by Blender, in dist/

dist/.extension: dist/.wheel $(EXTENSION_SOURCES)
	rm -f dist/*.zip
	$(TOOLS)/python packaging/build_extension.py --wheels dist/*.whl --output dist
	touch $@

# The window's own Blender; the one in the environments has none.
BLENDER ?= blender

pictures: dist/.extension .fixtures/.ready ## the manual's pictures, for the next `make package`: make pictures BLENDER=path (needs xvfb and ImageMagick)
	rm -rf dist/pictures
	manual/take.sh "$(BLENDER)" .fixtures/elephant.blend dist/turgor-*.zip dist/pictures
	rm dist/.extension

# ---- see it --------------------------------------------------------------------------------------------------------

demo: dist/.extension .fixtures/.ready $(NEWEST)/.ready ## pictures and figures of a character in demo_out/: make demo [SCENE=giraffe | SCENE=fleshing | SCENE=weights | SCENE=refine | SCENE=folds | FILE=path]
	rm -rf demo_out
	$(NEWEST)/bin/python -m $(SHOWN) --extension dist/*.zip --output demo_out

speed: dist/.extension $(NEWEST)/.ready ## times of frames and of the engine beside Blender's Armature modifier
	$(NEWEST)/bin/python -m demo.speed --extension dist/*.zip

# Made by the older Blender, so that both can read them.
.fixtures/.ready: $(FIXTURE_SOURCES) .venv-3.11/.ready
	$(TOOLS)/python -m blend_fixtures .fixtures
	touch $@

# ---- judge it ------------------------------------------------------------------------------------------------------

# Two at a time: most of it runs on one core.
test: ## everything: lint, engine, and the extension in every Blender found
	@$(MAKE) --no-print-directory --jobs=2 --output-sync=line every-test

every-test: lint test-rust test-python test-3.11 test-3.13

# One seed, so that a verdict is the code's and not luck's: other cases with make test-rust SEED=2.
SEED ?= 1

test-rust:
	PROPTEST_RNG_SEED=$(SEED) cargo test --workspace --locked

test-python: dist/site-packages
	PYTHONPATH=$(CURDIR)/dist/site-packages $(TOOLS)/python -m pytest $(PYTEST_FLAGS) tests/architecture tests/packaging tests/engine tests/logic

test-3.11 $(if $(HAS_3.13),test-3.13): test-%: dist/.extension dist/site-packages .fixtures/.ready .venv-%/.ready
	PYTHONPATH=$(CURDIR)/dist/site-packages .venv-$*/bin/python -m pytest $(PYTEST_FLAGS) tests/fixtures tests/blender $(OTHER_TESTS)

# The farms' tools are in one of the environments; demonstrations run in the newest Blender, as in `make demo`.
test-3.11: OTHER_TESTS := tests/farm $(if $(HAS_3.13),,tests/demo)
test-3.13: OTHER_TESTS := tests/demo

ifndef HAS_3.13
test-3.13:
	@echo "SKIPPED: tests in Blender 5.2 LTS, because no Python 3.13 was found"
endif

check-fast: .venv-3.11/.ready ## what takes seconds: rustfmt, ruff, clippy of the core
	cargo fmt --all --check
	$(TOOLS)/ruff check
	$(TOOLS)/ruff format --check
	cargo clippy --package turgor --locked -- -D warnings

lint: lint-rust lint-python ## clippy, rustfmt, rustdoc, ruff, pyright, stubtest

lint-rust:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --package turgor --no-deps --locked --quiet

lint-python: dist/site-packages
	$(TOOLS)/ruff check
	$(TOOLS)/ruff format --check
	$(TOOLS)/pyright
	MYPYPATH=rust/python PYTHONPATH=$(CURDIR)/dist/site-packages $(TOOLS)/python -m mypy.stubtest turgor \
		--ignore-disjoint-bases --allowlist tests/architecture/stubtest_allowed.txt

format: .venv-3.11/.ready ## rustfmt and ruff, in place
	cargo fmt --all
	$(TOOLS)/ruff check --fix
	$(TOOLS)/ruff format

bench: ## criterion benches of the engine
	cargo bench --workspace --locked

mutants: dist/.extension .fixtures/.ready $(NEWEST)/.ready ## break lines on purpose, one at a time: each must be noticed by a test
	$(NEWEST)/bin/python -m tests.mutation

# One of so many equal shares of the mutants, as 0/3.
SHARE ?= 0/1

engine-mutants: $(NEWEST)/.ready ## break what cargo-mutants can break in the engine: hours, or make engine-mutants SHARE=0/6 (needs cargo-mutants)
	PROPTEST_MAX_SHRINK_ITERS=0 cargo mutants --output target-mutants --shard $(SHARE) --sharding round-robin || true
	$(NEWEST)/bin/python -m tests.mutation --missed target-mutants/mutants.out

clean: ## remove everything made here
	rm -rf target target-mutants dist demo_out .fixtures .venv-3.11 .venv-3.13
