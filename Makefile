# The commands of the README. Each installs what it needs, and only that.

EXAMPLE ?= examples/bead-sorter

.PHONY: run test lint deny wasm bench book fuzz help

## build G7 and run the bead sorter in the terminal (EXAMPLE=… for another)
run:
	cargo run --release --quiet --package g7 -- run $(EXAMPLE)

## run every test
test: lint
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

## time of a scan, beside matiec where an iec2c is on the PATH
bench:
	benches/scan.sh

## the book, as HTML (needs mdbook)
book:
	mdbook build docs/book

## every fuzz target for a minute (needs cargo-fuzz and clang's runtime)
fuzz:
	fuzz/run.sh 60

help:
	@grep -B1 -E '^[a-z]+:' Makefile | grep -E '^(##|[a-z]+:)' | paste - - | sed -E 's/^## (.*)\t([a-z]+):.*/  make \2\t\1/' | expand -t 18
