# The few commands people type. Everything is built by CMake; see CMakePresets.json.
PRESET ?= release
BUILD  := build/$(PRESET)
BIN    := $(BUILD)/bin/inktrace
SAMPLE := samples/acetaminophen.xyz
# WERROR=ON makes warnings errors; empty leaves it to the preset.
WERROR ?=

.PHONY: all figure gallery test bench install format packages build clean

all: build

build: packages
	@cmake --preset $(PRESET) $(if $(WERROR),-DINKTRACE_WERROR=$(WERROR)) > $(BUILD).log 2>&1 || (cat $(BUILD).log; exit 1)
	cmake --build --preset $(PRESET)

# The paper's Figure 1: shaded, lines alone, both.
figure: build
	@mkdir -p out
	@set -e; for compose in shaded lines both; do \
	    $(BIN) render $(SAMPLE) --compose $$compose -o out/acetaminophen-$$compose.png --quiet; \
	    echo "wrote out/acetaminophen-$$compose.png"; \
	done

# All figures of the paper, as out/gallery/index.html. Figure 7 shows the Stanford bunny where npm
# can fetch it, else a mesh that Inktrace makes; MESH= names any other. TABLES=1 measures the tables.
MESH ?= $(shell sh cmake/fetch-bunny.sh build/bunny.obj && echo build/bunny.obj)
gallery: build
	@mkdir -p out
	$(BIN) gallery -o out/gallery $(if $(MESH),--mesh $(MESH)) $(if $(TABLES),--tables)

test: build
	ctest --preset $(PRESET)

bench: build
	$(BUILD)/bin/inktrace-bench

# The program, its viewer, and the library for find_package(inktrace).
PREFIX ?= /usr/local
install: build
	cmake --install $(BUILD) --prefix $(PREFIX)

format:
	git ls-files '*.h' '*.cpp' | xargs clang-format -i

# Installs what packages.txt names and is missing; asks for root only then.
packages:
	@mkdir -p build
	@sh cmake/install-packages.sh packages.txt

clean:
	rm -rf build out
