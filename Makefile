# Everything that a person or a machine does with this project. `make help` lists it.

# OPENCV=small links the small OpenCV that `make opencv` builds, in place of the system's.
OPENCV ?= system
TARGET = $(or $(CARGO_TARGET_DIR),target)
ifeq ($(OPENCV),small)
OPENCV_CONFIG = --config $(TARGET)/opencv/cargo.toml
endif
CARGO = cargo $(OPENCV_CONFIG)

# Debian's names; on other systems install the like of them (assets/guide/installing.md).
BUILD_PACKAGES = build-essential pkg-config clang libclang-dev $(if $(OPENCV_CONFIG),,libopencv-dev)
OPENCV_PACKAGES = build-essential cmake ninja-build curl ca-certificates
DIST_PACKAGES = $(OPENCV_PACKAGES) pkg-config clang libclang-dev python3-venv librsvg2-bin desktop-file-utils appstream \
                lintian xz-utils
DIST_TEST_PACKAGES = debootstrap debian-archive-keyring xvfb xdotool ffmpeg xxd
RUN_PACKAGES   = libvulkan1 mesa-vulkan-drivers libegl1 libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 \
                 libxkbcommon-x11-0 libwayland-client0 libwayland-egl1 libdbus-1-3 libfontconfig1
# Reads videos; tests make them with it.
VIDEO_PACKAGES = ffmpeg
# File dialogs; without them paths are typed.
DIALOG_PACKAGES = zenity xdg-desktop-portal

.DEFAULT_GOAL := help
.PHONY: help run test test-cli test-formats python check schema dist dist-test opencv bench no-click reliability season-test fuzz demo film pictures laboratory experiments experiments-real build-packages run-packages

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 24

run: run-packages $(if $(OPENCV_CONFIG),opencv) ## build and open the demo match (a copy of it in target/demo); OPENCV=small: on the small OpenCV
	$(CARGO) build --release
	@mkdir -p target
	@test -e target/demo || cp -r projects/demo target/demo
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ] || [ "$$(uname -s)" != Linux ]; then \
	    $(CARGO) run --release --quiet -- target/demo; \
	else \
	    echo "There is no display (DISPLAY and WAYLAND_DISPLAY are empty), so the window cannot open."; \
	    $(CARGO) run --release --quiet -- render target/demo --frame 3 -o target/demo-overlay.png --force && \
	    echo "The demo's overlay is drawn into target/demo-overlay.png instead."; \
	fi

test: run-packages ## run every test; those that miss a part of the machine are ignored and say why
	@.ci/test

test-cli: run-packages ## the tests of the command line without window and OpenCV (nightly; macOS and Windows run them on each change)
	@.ci/test -p touchline -p touchline-calibration --no-default-features --features touchline/cli --test suite --test calibration

test-formats: build-packages ## exports read by each consumer's own reader, each in a Python environment of its own
	@.ci/formats

python: build-packages ## the Python module, tested with PYTHONS="python3" (several: "python3.9 python3.13")
	@.ci/python

check: build-packages ## formatting, lints and documentation, warnings refused
	cargo fmt --all --check
	cargo clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

schema: build-packages ## make the JSON Schema of documents from their types again
	cargo run --quiet --no-default-features --features schema --bin document-schema > target/touchline.schema.json
	mv target/touchline.schema.json assets/touchline.schema.json

bench: build-packages ## run the benchmarks (tests/benches/README.md has the figures)
	cargo bench --workspace --benches

dist: ## every package of this version: tarball, Debian package, wheel, sums, into target/packages
	@.ci/packages $(DIST_PACKAGES)
	@.ci/dist/all

dist-test: ## each of these tried in fresh roots: SYSTEMS="bookworm trixie noble" (wants root)
	@.ci/packages $(DIST_TEST_PACKAGES)
	@.ci/dist/test

opencv: ## build the small OpenCV into target/opencv, from its sources (any Linux)
	@.ci/packages $(OPENCV_PACKAGES)
	@.ci/opencv

no-click: build-packages ## the camera without a click: all drawn matches and inputs that must fail, not below their stated rates
	cargo bench --bench no_click -- drawn refused --gate

reliability: run-packages ## kills, failing and full disks, damaged files (tests/reliability/README.md)
	@.ci/reliability

season-test: run-packages ## a season by a loop, xargs, Snakemake and Ray, with kills, each to the same bytes (Ray's part wants root)
	@.ci/season/test

SECONDS ?= 60
fuzz: build-packages ## every reader fuzzed with coverage, SECONDS=60 each (tests/fuzz/README.md)
	@.ci/fuzz $(SECONDS)

demo: build-packages ## draw projects/demo again
	cargo build --release
	rm -rf target/demo-new
	cargo run --release --quiet -- synth --demo -o target/demo-new
	rm -rf projects/demo && mv target/demo-new projects/demo

film: build-packages ## film the window at work, the picture at the top of README (wants Xvfb, openbox, xdotool, ffmpeg)
	cargo build --release
	assets/readme/film $(TARGET)/release/touchline

pictures: build-packages ## take the pictures of the user guide and of README in the window (wants the same)
	cargo build --release
	assets/guide/take-pictures $(TARGET)/release/touchline

# What the reports say they were built from.
experiments experiments-real: export TOUCHLINE_COMMIT = $(shell git describe --always --dirty 2>/dev/null)

# Into the folder of the program, which hands `touchline experiment` over to it.
LABORATORY = --manifest-path tests/laboratory/Cargo.toml --target-dir $(TARGET)

laboratory: build-packages ## lint and test the laboratory, which measures the paper's tables and figures (tests/laboratory/README.md)
	cargo fmt --manifest-path tests/laboratory/Cargo.toml --check
	cargo clippy $(LABORATORY) --all-targets -- -D warnings
	cargo test $(LABORATORY) $(if $(TOUCHLINE_DATA),-- --include-ignored)
	tests/experiments/recompute.py

experiments: build-packages ## measure the paper's tables and figures again, into tests/experiments
	cargo build --release
	cargo build --release $(LABORATORY)
	rm -rf target/experiments
	cargo run --release --quiet -- experiment all -o target/experiments
	mkdir -p tests/experiments && cd tests/experiments && rm -f *.md *.csv *.csv.gz *.svg *.png
	cd target/experiments && gzip -9 -n *-frames.csv *-cameras.csv *-pictures.csv
	cd target/experiments && cp README.md README-times.md *-sheet.png *.svg *.csv *.csv.gz ../../tests/experiments/
	printf '\n%s\n' 'Real frames and real cameras, measured: [real/README.md](real/README.md).' >> tests/experiments/README.md
	tests/experiments/recompute.py

# DATA holds folders with a clicks.json each (frames of one fixed camera, clicked, in clips) and the published data that
# `touchline experiment --help` names. No picture of it is kept.
experiments-real: build-packages ## the same on real data, into tests/experiments/real: make experiments-real DATA=DIR
	@test -n "$(DATA)" || { echo "give the folder of the data: make experiments-real DATA=DIR"; exit 2; }
	cargo build --release
	cargo build --release $(LABORATORY)
	rm -rf target/real && mkdir -p target/real
	for clicks in $(DATA)/*/clicks.json; do \
	    cargo run --release --quiet -- refine-base $$clicks -o target/real/$$(basename $$(dirname $$clicks)).json || exit 1; \
	done
	cargo run --release --quiet -- experiment all --data $(DATA) -o target/real/report \
	    $$(for document in target/real/*.json; do echo --train $$document; done)
	rm -rf tests/experiments/real && mkdir -p tests/experiments/real
	cd target/real/report && gzip -9 -n *-frames.csv
	cd target/real/report && cp *.svg README-times.md *.csv *.csv.gz ../../../tests/experiments/real/
	sed '/-sheet\.png/,+2d' target/real/report/README.md > tests/experiments/real/README.md

build-packages:
	@.ci/packages $(BUILD_PACKAGES)

run-packages: build-packages
	@.ci/packages $(RUN_PACKAGES)
	@.ci/packages --optional $(VIDEO_PACKAGES) $(DIALOG_PACKAGES)
