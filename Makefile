# SPDX-License-Identifier: BSD-3-Clause
# One command per habit. Each does all of its own set-up; nothing has to be installed by hand before.
#   make demo    the SCARA robot moves, on a virtual board, and leaves a picture; with RTL=1 on the gateware itself,
#                CLASSIC=1 without frames
#   make demo-walker   the 18-DOF walker walks; make demo-pa10: two PA10 arms move hand in hand (RTL=1: on the VHDL)
#   make demo-learn   an arm learns to reach on the twin in MuJoCo, then the policy drives the VHDL, and its line is
#                cut on the way (about four minutes)
#   make demo-tosnet   a SCARA whose joints are nodes of a ring, five twins and then five compiled designs, loses a
#                fibre and goes on
#   make demo-serve   the SCARA moves, and its page in the browser shows it; prints the page's URL (SECONDS=20: so long)
#   make demo-fleet   eight SCARAs on a Zenoh network in one table; one is killed and comes back; ends after a minute
#                (SECONDS=15: sooner)
#   make demo-ros   the SCARA as a ROS 1 node: rostopic echo, hz and pub
#   make page    makes the page of the dashboard anew from web/ (CHECK=1: compares what is there with it)
#   make extras  what some commands need beside: recordings, plots, the terminal, editors, DDS, SystemRDL, tests of your
#                own
#   make test    tries all of it (checks, unit, native, conformance, end to end; TESTS=tests/ros: of the Python tests
#                these only)
#   make develop  what single tests and checks need: pytest and its company, the native tests, Debian packages
#   make check   lint, format, types, C++ warnings as errors, the import rule
#   make format  formats Python, C++ and pages as `make check` wants it
#   make bench   the performance figures, as ratios within one run (QUICK=1: rough numbers; ONLY="import version": these
#                only)
#   make experiments   the paper's measurements, repeated on a model of its USB chip: build/experiments/report.html
#                (QUICK=1: sooner; ONLY=peers: this part)
#   make experiments-json   the quick form of it into docs/experiments.json and docs/experiments.md; on a quiet machine
#   make docs    regenerates what is generated in docs/, checks every link, and builds the site in build/site
#   make coverage  which lines of the gateware its benches execute, at least 95 %, into the record
#                gateware/coverage.json (BENCHES=gpio: only these, and no record)
#   make synth   area and clock of the gateware on two FPGAs, compared with the record (ACCEPT=1: record them;
#                ROWS="core lite": these only; CHANGED=1: those whose netlist has changed)
#   make bitstreams  builds those of docs/robots.md, some minutes each, and records what they take
#                (ONLY="bus_arm icebreaker": this robot and this board; CHANGED=1: those with other sources)
#   make formal  proves the properties of the gateware, and that each proof notices planted faults (BLOCKS="fifo": these
#                only; STALE=1: those whose sources have changed)
#   make boards  what `unitylink build` needs for a bitstream: yosys, nextpnr and what belongs to them
#   make fuzz    the long form of the fuzz loops, with sanitizers (SECONDS=60; STRINGS=10000000: so many hostile
#                strings), and of the histories of programs that get killed (SECONDS=7200 MESSAGES=4000000: so many of
#                their messages)
#   make sanitize  the native tests with the sanitizers of addresses, undefined behaviour and threads (KINDS=thread:
#                with this one)
#   make lerobot works with LeRobot itself, in build/lerobot (5.4 GB, ten minutes the first time)
#   make soak    the long form of the fault simulation (MESSAGES=1000000000, SEED=1: the next shard's is
#                SEED + MESSAGES / 360000). With RTL=1 MESSAGES=1000000 that of the compiled gateware, with both
#                engines: the next shard's SEED is behind the last seed that it prints
#   make mutants what the simulation must catch (SAMPLE=3: three of them)
#   make wheel   a wheel that installs without a compiler and without a checkout, in build/wheels
#   make sbom    the bill of materials, in CycloneDX: build/sbom.cdx.json; make wheel puts it beside the wheel
#   make packages  packages of the wheel for Debian, conda and Homebrew, as far as they can be made here, in
#                build/packages; lintian has to accept the first (URL=https://…: where the formula finds the sdist)
#   make build   the library in .venv only; with PYTHON=python3.12 for another Python
#   make long    the tests that take minutes for what a shorter one of `make test` nearly implies: more bitstreams, a
#                build of the sdist, all examples of the properties (TESTS=tests/ros: of these)
#   make unit    the Python tests that hardly start a program, in about a minute
#   make native-tests   the C++ tests alone
#   make clean   removes build/ and .venv/
#   make fresh   runs each target of this list in its short form, each in a new clone with an empty home and empty
#                caches (TARGETS="bench soak": these only; DOWNLOADS=FOLDER: keep pip's there, so fetching them is not
#                tried again; DEBIAN=1: as root, each on a bare Debian, with apt-get)
# Else each program that a test starts would compile the library again.
unexport PYTHONDONTWRITEBYTECODE
SHELL := /bin/bash
VENV := .venv
BIN := $(VENV)/bin
NATIVE := build/native
SANITIZED := build/sanitized
NATIVE_SOURCES := $(shell find native components CMakeLists.txt pyproject.toml -type f 2>/dev/null)
SECONDS ?= 60
MESSAGES ?= 1000000000
SEED ?= 1
KINDS ?= address,undefined thread
TESTS ?= tests

.PHONY: experiments experiments-json develop sbom wheel packages demo extras demo-walker demo-pa10 demo-learn \
	demo-tosnet demo-ros demo-fleet test \
	check format long bench boards bitstreams coverage synth formal docs fuzz soak mutants sanitize build native-tests \
	unit clean fresh page demo-serve lerobot help
help:
	@sed -n '2,/^[^#]/s/^# //p' Makefile

demo: $(VENV)/.built
	@tools/setup.sh group demo
ifdef RTL
	@tools/setup.sh rtl
	$(BIN)/python examples/scara/run.py --rtl $(if $(CLASSIC),--classic) --picture build/scara-rtl.png
else
	$(BIN)/python examples/scara/run.py $(if $(CLASSIC),--classic) --picture build/scara.png
endif

	@printf '\n%s %s\n' "Next: source $(BIN)/activate, and README.md." \
	  "Recordings, plots, the terminal and editors need more packages: make extras"

extras: $(VENV)/.built
	@tools/setup.sh group all
	@echo "what all commands need is in $(VENV)"

demo-walker: $(VENV)/.built
	@tools/setup.sh group demo
	@$(if $(RTL),tools/setup.sh rtl)
	$(BIN)/python examples/walker18/run.py $(if $(RTL),--rtl) --picture build/walker18.png

demo-pa10: $(VENV)/.built
	@tools/setup.sh group demo
	@$(if $(RTL),tools/setup.sh rtl)
	$(BIN)/python examples/pa10/run.py $(if $(RTL),--rtl) --picture build/pa10.png

demo-learn: $(VENV)/.built
	@tools/setup.sh group all
	@tools/setup.sh rtl
	$(BIN)/python examples/reach/run.py --rtl --picture build/reach.png

demo-tosnet: $(VENV)/.built
	@tools/setup.sh group demo
	@tools/setup.sh rtl
	$(BIN)/python examples/scara_ring/run.py --twin
	$(BIN)/python examples/scara_ring/run.py --picture build/scara_ring.png

demo-serve: $(VENV)/.built
	@tools/setup.sh group all
	$(BIN)/python examples/dashboard/run.py $(if $(filter-out file,$(origin SECONDS)),--seconds $(SECONDS))

demo-fleet: $(VENV)/.built
	@tools/setup.sh group all
	$(BIN)/python examples/fleet/run.py $(if $(filter-out file,$(origin SECONDS)),--seconds $(SECONDS))

demo-ros: $(VENV)/.built
	@tools/setup.sh ros
	@tools/demo_ros.sh

page:
	@tools/setup.sh page
	@cd web && npm run --silent check && npm run --silent build -- $(if $(CHECK),--check)

test:
	@tools/test.sh $(TESTS)

unit: $(VENV)/.built $(NATIVE)/.built
	@tools/setup.sh group test
	@tools/setup.sh boards
	$(BIN)/python -m pytest tests/unit -q -n 5 --dist loadgroup

develop: $(VENV)/.built $(NATIVE)/.built
	@tools/setup.sh group test
	@tools/setup.sh group browser
	@tools/setup.sh system
	@tools/setup.sh page

long: $(VENV)/.built $(NATIVE)/.built
	@for name in test demo wheel boards browser; do tools/setup.sh group $$name || exit 1; done
	@tools/setup.sh system
	@tools/setup.sh page
	UNITYLINK_EXAMPLES=all $(BIN)/python -m pytest $(TESTS) -q -m "long or many or hypothesis"

check: $(VENV)/.built
	@tools/setup.sh group test
	@tools/check.sh

format: $(VENV)/.built
	@tools/setup.sh group test
	@tools/format.sh

bench: $(VENV)/.built $(NATIVE)/.built
	@tools/setup.sh group all
	@tools/setup.sh rtl
	@tools/setup.sh ros
	@tools/setup.sh rust
	$(BIN)/unitylink bench $(if $(QUICK),--quick) $(ONLY:%=--only %)

experiments: $(VENV)/.built $(NATIVE)/.built
	@tools/setup.sh rtl
	@tools/setup.sh group ros2
	@tools/setup.sh ros
	$(BIN)/unitylink experiments $(if $(QUICK),--quick) $(ONLY:%=--only %) --out build/experiments

experiments-json:
	@$(MAKE) --no-print-directory experiments QUICK=1
	@tools/setup.sh group test
	$(BIN)/python tools/docs/experiments.py --from build/experiments/results.json

coverage: $(VENV)/.built
	@tools/setup.sh group test
	@tools/setup.sh coverage
	$(BIN)/python tools/coverage.py $(if $(BENCHES),--benches $(BENCHES))

synth: $(VENV)/.built
	@tools/setup.sh group boards
	@tools/setup.sh boards
	$(BIN)/python tools/synth/run.py $(if $(ACCEPT),--accept) $(if $(CHANGED),--changed) $(if $(ROWS),--rows $(ROWS))

bitstreams: $(VENV)/.built
	@tools/setup.sh group boards
	@tools/setup.sh boards
	$(BIN)/python tools/synth/bitstreams.py $(if $(CHANGED),--changed) $(if $(ONLY),--only $(ONLY))

formal: $(VENV)/.built
	@tools/setup.sh formal
	$(BIN)/python tools/formal/prove.py $(if $(BLOCKS),--blocks $(BLOCKS)) $(if $(STALE),--stale)

boards: $(VENV)/.built
	@tools/setup.sh group boards
	@tools/setup.sh boards

docs: $(VENV)/.built
	@tools/setup.sh group test
	$(BIN)/python protocol/generate.py
	$(BIN)/python tests/unit/spec/test_docs.py
	$(BIN)/python -c "from unitylink.ports.findings import page; print(page(), end='')" > docs/troubleshooting.md
	$(BIN)/python -m pytest tests/unit/docs -q
	@tools/setup.sh group docs
	$(BIN)/python tools/docs/pictures.py
	$(BIN)/python tools/docs/terminal.py
	$(BIN)/python tools/docs/gallery.py
	$(BIN)/python tools/docs/robots.py
	$(BIN)/python tools/docs/framed_program.py
	$(BIN)/python tools/docs/goodput.py
	$(BIN)/python tools/docs/experiments.py
	$(BIN)/python tools/docs/build_site.py

fuzz: $(VENV)/.built
	@tools/setup.sh rtl
	@tools/setup.sh sanitized address,undefined
	@for fuzzer in $(SANITIZED)-address,undefined/fuzz_*; do \
	  $$fuzzer $(if $(STRINGS),--strings $(STRINGS),--seconds $(SECONDS)) || exit 1; done
	UNITYLINK_FAIL_EACH=1 $(SANITIZED)-address,undefined/unitylink_tests -tc="the n-th*,the clock jumps*"
	@tools/setup.sh group test
	$(BIN)/python tests/unit/spec/fuzz_specs.py --seconds $(SECONDS)
	$(BIN)/python tests/unit/generate/quoting/hostile.py --seconds $(SECONDS)
	$(BIN)/python tests/unit/hostile/fuzz_inputs.py --seconds $(SECONDS)
	$(BIN)/python tests/apart/histories.py --board $(SANITIZED)-address,undefined/journal_board \
	  --seconds $(SECONDS) --messages $(MESSAGES)
	$(BIN)/python tests/gateware/fuzz_rtl_faults.py --seconds $(SECONDS)

sanitize: $(VENV)/.built
	@for kind in $(KINDS); do \
	  tools/setup.sh sanitized $$kind && $(SANITIZED)-$$kind/unitylink_tests || exit 1; done

mutants: $(NATIVE)/.built
	$(BIN)/python tools/mutants.py $(if $(SAMPLE),--sample $(SAMPLE))

soak: $(VENV)/.built
	@$(if $(RTL),tools/setup.sh rtl)
	$(if $(RTL),$(BIN)/python tests/gateware/fuzz_rtl_faults.py,$(BIN)/unitylink faults --jobs 2) \
	  --messages $(MESSAGES) --seed $(SEED)

lerobot: $(VENV)/.built
	@tools/setup.sh group test
	@tools/lerobot.sh

sbom: $(VENV)/.built
	$(BIN)/python tools/sbom.py > build/sbom.cdx.json

wheel: $(VENV)/.built
	@tools/setup.sh group wheel
	@tools/wheel.sh

packages: $(VENV)/.built
	@for name in wheel packages; do tools/setup.sh group $$name || exit 1; done
	@tools/setup.sh packages
	URL='$(URL)' tools/packages.sh

build: $(VENV)/.built
native-tests: $(NATIVE)/.built
	$(NATIVE)/unitylink_tests

# The editable install lists the modules it knows and where they are, so a module that comes or goes, or a
# checkout that moves, needs a new install.
build/.modules: .FORCE
	@mkdir -p build && { pwd -P; find src -type f ! -name '*.pyc' | sort; } > $@.new && \
	if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi
.FORCE:
.PHONY: .FORCE

# Another PYTHON than last time needs another environment; without PYTHON the one that is there stays.
ifdef PYTHON
build/.python: .FORCE
	@mkdir -p build && echo '$(PYTHON)' | cmp -s - $@ || echo '$(PYTHON)' > $@
$(VENV)/.built: build/.python
endif

$(VENV)/.built: $(NATIVE_SOURCES) build/.modules tools/setup.sh
	@PYTHON='$(PYTHON)' tools/setup.sh build

$(NATIVE)/.built: $(NATIVE_SOURCES) $(wildcard bench/native/*) $(VENV)/.built
	@tools/setup.sh native

fresh:
	@$(or $(PYTHON),python3) tools/fresh/every_target.py $(if $(DOWNLOADS),--downloads '$(DOWNLOADS)') \
	  $(if $(DEBIAN),--debian) $(TARGETS)

clean:
	rm -rf build $(VENV)
