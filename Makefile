# From a fresh Debian 12 machine to pictures: make run.  To green tests: make test.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.PHONY: help setup setup-tests build run install uninstall dist deb test test-all test-newer sanitize fuzz soak
.PHONY: fmt lint docs clean

OUT ?= out
TARGET := $(if $(CARGO_TARGET_DIR),$(CARGO_TARGET_DIR),target)
FETIFETI := $(TARGET)/release/fetifeti

# rustup's toolchain comes first where there is one.
export PATH := $(if $(wildcard $(HOME)/.cargo/bin),$(HOME)/.cargo/bin:)$(PATH)

# Open MPI: more ranks than cores are wanted (PCBDDC takes one subdomain per rank), so idle ranks must yield and none
# may be pinned to a core. Copies through the kernel are forbidden in most containers and only cost messages there.
export OMPI_MCA_rmaps_base_oversubscribe = 1
export OMPI_MCA_mpi_yield_when_idle = 1
export OMPI_MCA_hwloc_base_binding_policy = none
export OMPI_MCA_btl_vader_single_copy_mechanism = none
ifeq ($(shell id -u),0)
export OMPI_ALLOW_RUN_AS_ROOT = 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM = 1
endif

# The parallelism is over subdomains and ranks: BLAS gets one thread.
export OMP_NUM_THREADS ?= 1
export OMP_THREAD_LIMIT ?= 1
export OPENBLAS_NUM_THREADS ?= 1

help: ## Say what can be made
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s%s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))

setup: ## Install the Debian packages that the program needs and that are missing
	@scripts/setup.sh

setup-tests: ## Install what the tests need, too
	@scripts/setup.sh --tests

build: setup ## Build the program in release mode
	cargo build --release

run: build ## Solve the model problems with contact and without, compare with PETSc's solvers, redo Table 1
	@mkdir -p "$(OUT)"
	$(FETIFETI) solve examples/scenes/model_contact.toml --out "$(OUT)/model_contact"
	$(FETIFETI) solve examples/scenes/press_ramp.toml --out "$(OUT)/press_ramp"
	$(FETIFETI) solve examples/scenes/hertz_cylinder.toml --out "$(OUT)/hertz_cylinder"
	$(FETIFETI) solve examples/scenes/blocks_3d.toml --out "$(OUT)/blocks_3d"
	$(FETIFETI) compare examples/scenes/model_contact.toml --json "$(OUT)/compare_contact.json"
	$(FETIFETI) solve examples/scenes/poisson_2x2.toml --out "$(OUT)/poisson"
	$(FETIFETI) compare examples/scenes/poisson_2x2.toml --json "$(OUT)/compare.json"
	$(FETIFETI) table1 --out "$(OUT)/table1" --json "$(OUT)/table1/table1.json"
	@echo
	@echo "The model contact problem (report, pictures, ParaView): $(abspath $(OUT))/model_contact"
	@echo "Load steps (report, pictures, ParaView series):         $(abspath $(OUT))/press_ramp"
	@echo "An elastic cylinder on a rigid plane (Hertz):           $(abspath $(OUT))/hertz_cylinder"
	@echo "Elastic blocks pressed together, in space:              $(abspath $(OUT))/blocks_3d"
	@echo "Contact compared with PETSc's solvers:                  $(abspath $(OUT))/compare_contact.json"
	@echo "Solution of the 2x2 scene (report, picture, ParaView):  $(abspath $(OUT))/poisson"
	@echo "Comparison with PETSc's solvers:                        $(abspath $(OUT))/compare.json"
	@echo "Table 1 and Figure 3 (CSV, JSON, PNG, SVG):             $(abspath $(OUT))/table1"

# Where things go. DESTDIR is put in front of all paths, for packagers; LIBDIR is PREFIX/lib.
PREFIX ?= /usr/local

install: build ## Install program, libraries, headers, manual pages and examples below PREFIX (make install PREFIX=...)
	scripts/install.sh "$(TARGET)/release" "$(PREFIX)" "$(DESTDIR)"

uninstall: ## Remove what was installed below PREFIX
	@cd "$(DESTDIR)$(PREFIX)" && xargs -d '\n' rm -f <share/fetifeti/installed && \
	find share/fetifeti share/doc/fetifeti lib*/cmake/FetiFeti -depth -type d -empty -delete 2>/dev/null; true

dist: ## Write target/dist/fetifeti-VERSION.tar.xz, sources that build without a registry
	scripts/dist.sh "$(TARGET)/dist"

deb: setup-tests ## Make a Debian source package and its binary packages in target/deb
	scripts/deb.sh "$(TARGET)/deb"

test: setup ## Check format, lints and documentation, then run every test; some with a sample of their cases
	cargo fmt --all -- --check
	scripts/test.sh

test-all: export FETIFETI_TEST_ALL = 1
test-all: test ## As test, with all cases of every test (half an hour)

# A newer PETSc than Debian's, from the source packages of the Python registry: the newest, or of this version.
NEWER_DIR ?= $(TARGET)/newer
NEWER_PETSC ?=
NEWER_SLEPC ?=
INDICES ?= 32

test-newer: setup-tests ## Build the newest PETSc and SLEPc, and test the plug-in, the C API and the solver with them
	INDICES=$(INDICES) scripts/newer_petsc.sh "$(NEWER_DIR)" "$(NEWER_PETSC)" "$(NEWER_SLEPC)"
	scripts/test_newer.sh "$(NEWER_DIR)" $(INDICES) all

# Some of malloc, valgrind, address, thread and miri; all without.
PARTS ?=

sanitize: setup-tests ## Run the program, the plug-in and the C API under sanitizers (an hour; PARTS="address miri")
	scripts/sanitize.sh "$(TARGET)/sanitize" $(PARTS)

# Seconds of each target of fuzz, and of soak together. Nightly Rust is needed for fuzz only.
SECONDS ?= 60

fuzz: setup ## Feed the readers with made-up bytes, SECONDS for each (make fuzz SECONDS=60)
	scripts/fuzz.sh "$(SECONDS)" "$(or $(RUNS),0)" $(READERS)

soak: setup ## Solve random scenes for SECONDS and compare each with the direct solution (make soak SECONDS=60)
	scripts/soak.sh "$(SECONDS)" "$(or $(FIRST),0)"

fmt: ## Format the sources
	cargo fmt --all

lint: setup ## Check format and lints only
	cargo fmt --all -- --check
	cargo clippy --workspace --all-targets -- -D warnings

docs: setup ## Build the documentation of the crates
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

clean: ## Remove everything that was built or written
	cargo clean
	rm -rf "$(OUT)"
