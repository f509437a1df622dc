# The commands of the README. Each installs what it needs, and only that.

# A pipe fails if any part of it does.
SHELL := bash
.SHELLFLAGS := -o pipefail -ec
.NOTPARALLEL:

EXAMPLE ?= examples/bead-sorter
FOLDER ?= examples
SEEDS ?= 10000

# What Debian has is installed from there, once, as root or through sudo.
SUDO := $(shell [ "$$(id -u)" = 0 ] || echo sudo)
debian = command -v $(1) >/dev/null || \
	{ $(SUDO) apt-get update -qq && $(SUDO) apt-get install -qq --no-install-recommends $(2); }
# Logs of `make test` with the list of what was skipped; the pages of the book, put together.
BOOK := $(abspath $(or $(CARGO_TARGET_DIR),target))/book
PROVE := $(abspath $(or $(CARGO_TARGET_DIR),target))/prove-bench
CORTEX := $(abspath $(or $(CARGO_TARGET_DIR),target))/cortex-m
TALLY := $(abspath $(or $(CARGO_TARGET_DIR),target))/tally
# The program as the tests have it: libraries get the features that the workspace asks for as a whole, so that
# they are compiled once for all tests.
DEBUG := $(abspath $(or $(CARGO_TARGET_DIR),target))/debug
# With the kinds of devices that the usual build does not have.
WORKSPACE := --workspace --features g7/s7,g7/gpio,g7/opcua,g7-tests/types
BUILD := cargo build --quiet $(WORKSPACE) --bin g7
TESTS := cargo test $(WORKSPACE) --exclude g7-benches --quiet --lib --bins --tests
# They only compute, and have no limits of time (tests/Cargo.toml).
COMPUTED := cargo test $(WORKSPACE) --exclude g7-benches --quiet --test laws --test compiled
CLIPPY := cargo clippy $(WORKSPACE) --all-targets --quiet -- --deny warnings
STORIES = cd web && npm run --silent check && G7=$(DEBUG)/g7 npm test --silent | tee $(TALLY)/page.log
PYTHON := $(abspath $(or $(CARGO_TARGET_DIR),target))/python
NODE := $(PYTHON)/node
PAGE := $(shell find web/src exercises docs/book/src/problems docs/book/fr docs/book/pt crates/model/src/said web/index.html web/public web/*.ts web/*.js web/*.mjs -type f 2>/dev/null)

# The extension for VS Code; its packages are pinned by its lock.
EXTENSION := editors/vscode
EXTENDED := $(EXTENSION)/node_modules/.package-lock.json

.PHONY: grammars types vscode tree-sitter helix zed run view install online-demo deb sbom static test opcua-bench tally-anew peers checkers lint deny wasm web site site-bench pictures page-test page-bench bench bench-check grade-bench prove-bench prove-table oscat interop online-bench soak page-soak faults book blocks fuzz help FORCE

## build G7 and open the editor in the browser on the examples (FOLDER=… for another)
run: WASM := quick-wasm
run: web
	cargo run --profile quick --quiet --package g7 -- serve $(FOLDER) $(if $(filter examples,$(FOLDER)),--start bead-sorter/chart.g7)

## build G7 and run the bead sorter in the terminal (EXAMPLE=… for another)
view:
	cargo run --profile quick --quiet --package g7 -- run $(EXAMPLE)

## the bead sorter on line: machine, controller and broker, and a page that unplugs them
online-demo: WASM := quick-wasm
online-demo: web
	@$(call debian,mosquitto_sub,mosquitto mosquitto-clients) || echo "mosquitto cannot be installed: the bench has no broker"
	cargo build --profile quick --quiet --package g7
	node demo/bench.mjs $${CARGO_TARGET_DIR:-target}/quick/g7

## put g7, with its page, on the PATH
install: web
	cargo install --quiet --locked --path crates/g7

## a Debian package with a program that needs no system library (MACHINE=aarch64 for another machine)
deb: web sbom
	packaging/deb.sh $(MACHINE)

## what the program and its page are built of, as CycloneDX in target/sbom (MACHINE=aarch64 for another machine)
sbom:
	@command -v cargo-cyclonedx >/dev/null || cargo install --quiet --locked cargo-cyclonedx
	packaging/sbom.sh $(MACHINE)

## one program for any Linux, without a system library (MACHINE=aarch64 for another machine)
static: web
	packaging/static.sh $(MACHINE)

## run every test; the last line counts what passed and what was skipped
test: export G7_SKIPS = $(TALLY)/skips
test: export G7_PEERS = $(PYTHON)
test: WASM := quick-wasm
test: tally-anew web $(PYTHON)/bin/pymodbus.simulator $(NODE)/node_modules/.package-lock.json $(EXTENDED)
	cargo fmt --all --check
	@$(call debian,chromium,chromium)
	@$(call debian,mosquitto_sub,mosquitto mosquitto-clients) || echo "mosquitto cannot be installed: its tests are skipped"
	$(BUILD)
	@echo "the stories of the page; meanwhile the tests of the crates are compiled, and those that only compute run"
	@{ nice $(CLIPPY) && nice $(TESTS) --no-run && nice $(COMPUTED); } >$(TALLY)/computed.log 2>&1 & computed=$$!; \
		told=0; { $(STORIES); } || told=$$?; wait $$computed || { cat $(TALLY)/computed.log; exit 1; }; exit $$told
	{ $(TESTS) && cargo test --quiet --doc --package g7-engine; } 2>&1 | tee $(TALLY)/crates.log
	@test -f $(EXTENDED) || printf 'packages of the extension missing\teditors/vscode\n' >>$(G7_SKIPS)
	@test ! -f $(EXTENDED) || { cd $(EXTENSION) && npm run --silent check && npm run --silent build && \
		G7=$(DEBUG)/g7 npm run --silent test | tee $(TALLY)/vscode.log; }
	$(DEBUG)/g7 check examples library course
	$(DEBUG)/g7 test examples library course | tee $(TALLY)/examples.log
	@cargo run --quiet --package g7-peers --bin tally -- $(TALLY)

# Programs in Python that tests talk to. Without a network they are skipped, which the tally counts.
$(PYTHON)/bin/pymodbus.simulator:
	@{ { python3 -c 'import ensurepip' 2>/dev/null || { $(SUDO) apt-get update -qq && \
			$(SUDO) apt-get install -qq --no-install-recommends python3 python3-venv; }; } && \
		python3 -m venv $(PYTHON) && $(PYTHON)/bin/pip install --quiet 'pymodbus[serial]==3.16.*' 'pysparkplug==0.6.*' 'python-snap7==3.3.*' 'asyncua==2.1.*'; } || \
		echo "pymodbus, pysparkplug, python-snap7 and asyncua cannot be installed: their tests are skipped"

# Packages of Node that tests talk to.
$(NODE)/node_modules/.package-lock.json: tests/peers/node/package-lock.json
	@mkdir -p $(NODE) && cp tests/peers/node/package*.json $(NODE)
	@cd $(NODE) && npm ci --silent --no-audit --no-fund && touch node_modules/.package-lock.json || \
		echo "mqtt and sparkplug-payload cannot be installed: their tests are skipped"

$(EXTENDED): $(EXTENSION)/package-lock.json
	@cd $(EXTENSION) && npm ci --silent --no-audit --no-fund --ignore-scripts && touch node_modules/.package-lock.json || \
		echo "the packages of the extension for VS Code cannot be installed: its tests are skipped"

## the grammars of other editors anew, from the table of words
grammars:
	cargo run --quiet --package g7-tests --bin grammars

## the messages between the page and its Rust as TypeScript anew, from the table of `g7-page`
types:
	cargo run --quiet --package g7-tests --features types --bin types

## the extension for VS Code as a file that `code --install-extension` takes
vscode: $(EXTENDED)
	@cd $(EXTENSION) && npm run --silent package

## the parser of tree-sitter from its grammar, for Neovim, Helix and Zed
tree-sitter:
	@command -v tree-sitter >/dev/null || cargo install --quiet --locked tree-sitter-cli@0.25.10
	cd editors/tree-sitter-g7 && tree-sitter generate

## the grammar and its queries for Helix, in its folder of settings
helix: HELIX := $(or $(XDG_CONFIG_HOME),$(HOME)/.config)/helix/runtime
helix: tree-sitter
	mkdir -p $(HELIX)/queries/g7 $(HELIX)/grammars
	cp editors/tree-sitter-g7/queries/*.scm $(HELIX)/queries/g7
	cc -O2 -shared -fPIC -I editors/tree-sitter-g7/src editors/tree-sitter-g7/src/*.c -o $(HELIX)/grammars/g7.so

## the extension for Zed in target/zed, with a repository for its grammar
zed: tree-sitter
	editors/zed/pack.sh $(abspath $(or $(CARGO_TARGET_DIR),target))/zed

tally-anew:
	@rm -rf $(TALLY) && mkdir -p $(TALLY) && touch $(TALLY)/skips

## install what some tests are skipped without: clang with its sanitizers, tcc, g++, strace, faketime, rt-tests, stress-ng, cppcheck, clang-tidy, avr-gcc, the Arduino core, mosquitto, pyarrow, lxml, awlsim, blark, l5x, FMPy, pyecore, Vim, Neovim, tree-sitter, a bare target, the model checkers ABC, Spin and rIC3
peers: checkers
	rustup target add thumbv7em-none-eabi
	@$(call debian,gcc,gcc)
	@$(call debian,g++,g++)
	@$(call debian,strace,strace)
	@$(call debian,faketime,faketime)
	@$(call debian,cyclictest,rt-tests)
	@$(call debian,stress-ng,stress-ng)
	@$(call debian,cppcheck,cppcheck)
	@$(call debian,clang-tidy,clang-tidy)
	@$(call debian,avr-gcc,gcc-avr avr-libc)
	@test -d /usr/share/arduino/hardware/arduino/avr || { $(SUDO) apt-get update -qq && \
		$(SUDO) apt-get install -qq --no-install-recommends arduino-core-avr; }
	@$(call debian,cmake,cmake)
	@$(call debian,nvim,neovim)
	@$(call debian,vim,vim)
	@command -v tree-sitter >/dev/null || cargo install --quiet --locked tree-sitter-cli@0.25.10 || \
		echo "tree-sitter cannot be installed: its test is skipped"
	@cargo run --quiet --package g7 -- gen rust examples/bottle-conveyor --project cargo --force -o $(CORTEX) && \
		cargo fetch --quiet --manifest-path $(CORTEX)/Cargo.toml || echo "the crates of a Cortex-M cannot be had: their test is skipped"
	@$(call debian,mosquitto_sub,mosquitto mosquitto-clients)
	@test ! -x $(PYTHON)/bin/pip || $(PYTHON)/bin/pip install --quiet 'pyarrow>=20' lxml 'awlsim==0.77.*' 'blark==0.8.*' 'l5x==1.7.*' 'fmpy==0.3.*' 'pyecore==0.15.*'
	@$(SUDO) apt-get update -qq && $(SUDO) apt-get install -qq --no-install-recommends clang libclang-rt-dev tcc
	@command -v iec2c >/dev/null || echo "matiec is no package: put iec2c of https://github.com/beremiz/matiec on the PATH, its lib beside it"
	@command -v ironplcc >/dev/null || echo "IronPLC is no package: put ironplcc of https://www.ironplc.com on the PATH"
	@test -d "$(G7_BEREMIZ)" || echo "Beremiz is no package: let G7_BEREMIZ name a checkout of https://github.com/beremiz/beremiz"
	@test -d "$(G7_XML2ST)" || echo "OpenPLC is no package: let G7_XML2ST name a checkout of https://github.com/Autonomy-Logic/xml2st"

# rIC3 is GPL: it is asked, never linked. Its libraries use parts of the language that are not stable yet.
checkers:
	@$(call debian,berkeley-abc,berkeley-abc)
	@$(call debian,spin,spin)
	@$(call debian,cmake,cmake)
	@command -v rIC3 >/dev/null || RUSTC_BOOTSTRAP=1 cargo install --quiet --locked rIC3@1.4.1 || \
		echo "rIC3 cannot be installed: its tests are skipped"

## figures of the server of OPC UA, beside asyncua
opcua-bench: export G7_PEERS = $(PYTHON)
opcua-bench: $(PYTHON)/bin/pymodbus.simulator
	cargo run --release --quiet --package g7-opcua --example figures

## formatting and lints
lint:
	cargo fmt --all --check
	$(CLIPPY)

## licences and sources of what is built in
deny:
	@command -v cargo-deny >/dev/null || cargo install --quiet --locked cargo-deny
	cargo deny check licenses bans sources

# The profile of the page's wasm: `make run` takes the one that is compiled fast.
WASM := wasm
MODULE = $${CARGO_TARGET_DIR:-target}/wasm32-unknown-unknown/$(WASM)/g7_page.wasm

# Two modules of one crate (decision 55): what the page loads at once, and the whole program.
MODULES := web/public/g7.wasm web/public/g7-whole.wasm

## the crates as wasm, for the page
wasm: $(MODULES)

web/public/g7.wasm: PARTS := --no-default-features
$(MODULES): FORCE
	@rustup target list --installed | grep -q wasm32-unknown-unknown || rustup target add wasm32-unknown-unknown
	cargo build --quiet --profile $(WASM) --target wasm32-unknown-unknown --package g7-page $(PARTS)
	@mkdir -p web/public
	@cmp -s $(MODULE) $@ || cp $(MODULE) $@

## the editor's page, built into g7
web: web/dist/index.html

web/dist/index.html: $(MODULES) web/node_modules/.package-lock.json $(PAGE)
	cd web && WASM=$(WASM) npm run --silent build

web/node_modules/.package-lock.json: web/package.json web/package-lock.json
	@$(call debian,npm,nodejs npm)
	cd web && npm ci --silent --no-audit --no-fund
	@touch $@

FORCE:

## the static playground in site/: the page and the examples, for any web server
site: web
	rm -rf site
	cp -r web/dist site
	node web/examples.mjs examples site/examples.json
	node web/pack.mjs site site

## what the static site weighs, and how long it takes to its first picture on a slow CPU
site-bench: site
	@$(call debian,chromium,chromium)
	cd web && npx tsx bench/site.ts

## the pictures of the examples and of the operator's page, for the book and the README
pictures: web
	@$(call debian,chromium,chromium)
	$(BUILD)
	cd web && G7=$(DEBUG)/g7 npx tsx tests/pictures.ts

## the stories of the page in a real browser
page-test: WASM := quick-wasm
page-test: web
	@$(call debian,chromium,chromium)
	$(BUILD)
	@mkdir -p $(TALLY)
	$(STORIES)

## times of the page beside React Flow, as ratios with limits
page-bench: wasm web/node_modules/.package-lock.json
	@$(call debian,chromium,chromium)
	cd web && npm run --silent bench

## time of a scan (beside matiec where an iec2c is on the PATH), of a layout, and of the stages before
bench:
	benches/scan.sh
	benches/layout.sh
	benches/growth.sh

## instructions of a scan in each row, beside those of the table that is kept
bench-check:
	@$(call debian,valgrind,valgrind)
	benches/instructions.sh

## 200 submissions of an exercise, graded, with the time
grade-bench:
	cargo build --release --quiet --package g7
	G7=$(abspath $(or $(CARGO_TARGET_DIR),target))/release/g7 benches/grade.sh

## the prover beside ABC, rIC3, Spin, Stateright and LTSmin: answers, seconds, memory, ratios (ROWS="timers equivalence" for some, LIMIT=… seconds for each answer)
prove-bench: checkers
	cargo run --release --quiet --manifest-path benches/prove/Cargo.toml --target-dir $(PROVE) --features stateright -- \
		$(if $(LIMIT),--limit $(LIMIT)) $(ROWS)

## every question asked of the examples, the litmus charts and the corpus, as a table (LIMIT=… seconds for each chart)
prove-table:
	cargo run --profile soak --quiet --package g7-tests --example prove_table -- $(or $(LIMIT),5) examples tests/spec/litmus \
		$(or $(G7_CORPUS),$(wildcard ../shared/corpus))

## each function and function block of OSCAT Basic beside matiec's C, about ten minutes (G7_OSCAT=… names a checkout of https://github.com/wonka929/OSCAT_OpenPLC, iec2c stands in the PATH; ONLY=… for one of them)
oscat:
	@test -d "$(G7_OSCAT)" || { echo "OSCAT is no package: let G7_OSCAT name a checkout of https://github.com/wonka929/OSCAT_OpenPLC"; exit 1; }
	$(if $(ONLY),G7_ONLY=$(ONLY)) cargo test --quiet --package g7-tests --test foreign oscat:: -- --nocapture

## charts written for Beremiz, OpenPLC, matiec, IronPLC, pyecore and compilers, taken by these and run beside the engine, as a table with each refusal (G7_BEREMIZ=…, G7_XML2ST=… name folders, iec2c and ironplcc stand in the PATH, Python has lxml and pyecore; ON=… for other files; LIMIT=… seconds for each row, 600 if not said)
interop: export G7_PEERS = $(PYTHON)
interop: export G7_LIMIT = $(LIMIT)
interop:
	cargo run --quiet --package g7-tests --example interop -- $(or $(ON),examples tests/spec tests/interchange \
		$(or $(G7_CORPUS),$(wildcard ../shared/corpus)))

## how late scans are beside cyclictest, with no page and with 1000, how long a read of Modbus TCP takes (Linux, as root; rt-tests and stress-ng are installed)
online-bench: export G7_PEERS = $(PYTHON)
online-bench: $(PYTHON)/bin/pymodbus.simulator
	@$(call debian,cyclictest,rt-tests)
	@$(call debian,stress-ng,stress-ng)
	benches/lateness.sh
	cargo run --release --quiet --package g7-benches --bin modbus

## the controller with faulty devices in simulated time, 10,000 courses of faults (SEEDS=… for others)
soak: export G7_SEEDS = $(SEEDS)
soak:
	cargo test --profile soak --package g7-online --test simulation -- --nocapture

## fifty pages that work together at one server, for an hour: its memory as a table, and no more of it at the end (MINUTES=… for another time)
page-soak: export G7_SOAK_MINUTES = $(or $(MINUTES),60)
page-soak:
	cargo test --profile soak --package g7 --test all -- --nocapture a_class_takes

## faults around a controller on line, each hundreds of times: what held, and how long it took
faults: export G7_FAULTS = many
faults: export G7_PEERS = $(PYTHON)
faults: export G7_FAULT_ROWS = $(TALLY)/faults
faults: $(PYTHON)/bin/pymodbus.simulator
	@$(call debian,faketime,faketime)
	@$(call debian,cyclictest,rt-tests)
	@$(call debian,stress-ng,stress-ng)
	@mkdir -p $(TALLY) && rm -f $(G7_FAULT_ROWS) && touch $(G7_FAULT_ROWS)
	done=0; cargo test $(WORKSPACE) --tests --no-fail-fast -- row_ --nocapture --test-threads 1 || done=$$?; \
		cargo run --quiet --package g7-peers --bin faults -- $(G7_FAULT_ROWS) && exit $$done

## the book, as HTML in docs/book/book, with every conformance case as a page
book:
	@command -v mdbook >/dev/null || cargo install --quiet --locked mdbook
	@rm -rf $(BOOK)
	cargo run --quiet --package g7-tests --bin book -- $(BOOK)
	mdbook build $(BOOK) --dest-dir $(CURDIR)/docs/book/book

## the chronograms of the function blocks and of the library, drawn anew for the book
blocks:
	cargo run --quiet --package g7-tests --bin book -- pictures

## every fuzz target for a minute
fuzz: peers
	@command -v cargo-fuzz >/dev/null || cargo install --quiet --locked cargo-fuzz
	fuzz/run.sh 60

help:
	@awk '/^## /{text=substr($$0, 4)} /^[a-z-]+:/ && text {split($$0, name, ":"); printf "  make %-14s %s\n", name[1], text; text=""}' Makefile
