# The commands of the README. Each installs what it needs, and only that.

EXAMPLE ?= examples/bead-sorter
FOLDER ?= examples

.PHONY: run view test lint deny wasm web site page-test page-bench bench book fuzz help

## build G7 and open the editor in the browser on the examples (FOLDER=… for another)
run: web
	cargo run --release --quiet --package g7 -- serve $(FOLDER)

## build G7 and run the bead sorter in the terminal (EXAMPLE=… for another)
view:
	cargo run --release --quiet --package g7 -- run $(EXAMPLE)

## run every test
test: lint page-test
	cargo test --workspace --quiet
	cargo run --quiet --package g7 -- test examples
	cargo run --quiet --package g7 -- check examples

## formatting and lints
lint:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --quiet -- --deny warnings

## licences and sources of what is built in (needs cargo-deny)
deny:
	cargo deny check licenses bans sources

## the crates as wasm, for the page
wasm:
	@rustup target list --installed | grep -q wasm32-unknown-unknown || rustup target add wasm32-unknown-unknown
	cargo build --quiet --profile wasm --target wasm32-unknown-unknown --package g7-page
	mkdir -p web/public
	cp $${CARGO_TARGET_DIR:-target}/wasm32-unknown-unknown/wasm/g7_page.wasm web/public/g7.wasm

## the editor's page, built into g7
web: wasm
	@command -v npm >/dev/null || { apt-get update -qq && apt-get install -qq nodejs npm; }
	cd web && npm ci --silent --no-audit --no-fund && npm run --silent build

## the static playground in site/: the page and the examples, for any web server
site: web
	rm -rf site
	cp -r web/dist site
	node web/examples.mjs examples site/examples.json

## the stories of the page in a real browser
page-test: web
	@command -v chromium >/dev/null || { apt-get update -qq && apt-get install -qq chromium; }
	cargo build --release --quiet --package g7
	cd web && npm run --silent check && npm test --silent

## main-thread time of the page, beside React Flow
page-bench: wasm
	cd web && npm ci --silent --no-audit --no-fund && npm run --silent bench

## time of a scan (beside matiec where an iec2c is on the PATH) and of a layout
bench:
	benches/scan.sh
	benches/layout.sh

## the book, as HTML (needs mdbook)
book:
	mdbook build docs/book

## every fuzz target for a minute (needs cargo-fuzz and clang's runtime)
fuzz:
	fuzz/run.sh 60

help:
	@grep -B1 -E '^[a-z-]+:' Makefile | grep -E '^(##|[a-z-]+:)' | paste - - | sed -E 's/^## (.*)\t([a-z-]+):.*/  make \2\t\1/' | expand -t 18
