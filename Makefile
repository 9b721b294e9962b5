# The only build file. `make help` lists the targets.
#
# Variables a caller may set:
#   CC=gcc|clang  OPT=-O2  WERROR=1  SANITIZE=address,undefined  CFLAGS=... LDFLAGS=...
#   CONFIG=release         objects and programs go to build/$(CONFIG)
#   OPENMP=0  PNG=0  VALGRIND=0  EMBREE=0   build without what was found on this machine
#   PREFIX=/usr/local      where `make install` puts things, below DESTDIR

ifeq ($(origin CC),default)
CC := gcc
endif
CONFIG ?= release
OPT    ?= -O2
PREFIX ?= /usr/local
B      := build/$(CONFIG)

# What this compiler can do: $(call works,FLAGS,HEADER) prints 1 or 0.
works = $(shell printf '\043include <%s>\nint main(void) { return 0; }\n' $(2) | \
          $(CC) -x c - -o /dev/null $(1) >/dev/null 2>&1 && echo 1 || echo 0)
ifndef OPENMP
OPENMP := $(call works,-fopenmp,omp.h)
endif
ifndef PNG
PNG := $(call works,-lpng,png.h)
endif
ifndef VALGRIND
VALGRIND := $(call works,,valgrind/callgrind.h)
endif

ifndef EMBREE
EMBREE := $(if $(findstring x86_64,$(shell $(CC) -dumpmachine)),$(call works,-lembree3,embree3/rtcore.h),0)
endif

WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion \
            -Wstrict-prototypes -Wmissing-prototypes -Wvla -Wundef
# Exactness: no contraction into FMA. No errno, so that sqrtf is the instruction.
EXACT    := -ffp-contract=off -fno-math-errno
INCLUDE  := -Isrc -I. -DRB_PNG=$(PNG) -DRB_VALGRIND=$(VALGRIND) -DRB_EMBREE=$(EMBREE) -MMD -MP
NEEDED   := -std=c11 -g $(OPT) $(WARNINGS) $(if $(WERROR),-Werror) \
            $(if $(SANITIZE),-fsanitize=$(SANITIZE) -fno-sanitize-recover=all)
LINK     := $(if $(SANITIZE),-fsanitize=$(SANITIZE))
LIBS     := $(if $(filter 1,$(PNG)),-lpng) $(if $(filter 1,$(EMBREE)),-lembree3) -lm
ifeq ($(OPENMP),1)
NEEDED += -fopenmp
LINK   += -fopenmp
else
NEEDED += -Wno-unknown-pragmas
endif

# One word per step, none under make -s.
say      := $(if $(findstring s,$(firstword -$(MAKEFLAGS))),@:,@echo)

# Kernel files that are compiled again for wider vectors, FILE.ISA; never with FMA: exactness.
ifneq ($(findstring x86_64,$(shell $(CC) -dumpmachine)),)
WIDE     := packet.avx2 packet.avx512 wide.avx2 stream.avx2 frustum.avx2 frustum.avx512
endif
%packet.avx2.o %packet.avx2.counted.o: ISA := -mavx2 -DRB_PACKET=rb_kernels_packet_avx2
%packet.avx512.o %packet.avx512.counted.o: ISA := -mavx512f -DRB_PACKET=rb_kernels_packet_avx512
%wide.avx2.o %wide.avx2.counted.o: ISA := -mavx2 -DRB_WIDE_SET=rb_kernels_wide_avx2
%stream.avx2.o %stream.avx2.counted.o: ISA := -mavx2 -mbmi2 -DRB_STREAM=rb_kernels_stream_avx2
%frustum.avx2.o %frustum.avx2.counted.o: ISA := -mavx2 -DRB_FRUSTUM=rb_kernels_frustum_avx2 \
  -DRB_FRUSTUM_ELSE=rb_kernels_stream_avx2
%frustum.avx512.o %frustum.avx512.counted.o: ISA := -mavx512f \
  -DRB_FRUSTUM=rb_kernels_frustum_avx512 -DRB_FRUSTUM_ELSE=rb_kernels_stream_avx2

# Embree has none of the norm to keep, but the same flags; its objects are not linked without it.
ifeq ($(EMBREE),1)
EMBREE_OBJ := build.o callbacks.avx2.o trace.avx2.o trace.avx512.o
else
EMBREE_OBJ := none.o
endif
%embree/callbacks.avx2.o %embree/trace.avx2.o: ISA := -mavx2
%embree/trace.avx512.o: ISA := -mavx512f

LIB_SRC  := $(filter-out src/embree/%,$(sort $(wildcard src/*/*.c bench/*/*.c)))
KERNELS  := $(patsubst src/kernels/%.c,%,$(filter src/kernels/%,$(LIB_SRC))) $(WIDE)
LIB_OBJ  := $(LIB_SRC:%.c=$(B)/%.o) $(WIDE:%=$(B)/src/kernels/%.o) \
            $(patsubst %,$(B)/src/kernels/%.counted.o,$(filter-out count,$(KERNELS))) \
            $(EMBREE_OBJ:%=$(B)/src/embree/%)
UNIT_SRC := $(sort $(wildcard tests/unit/*.c))
UNIT     := $(UNIT_SRC:%.c=$(B)/%)
TEST_OBJ := $(patsubst %.c,$(B)/%.o,$(sort $(wildcard tests/support/*.c)))

PLANS    := $(sort $(wildcard bench/plans/*.plan))
EVENTS   := $(sort $(wildcard bench/events/*.events))
ENERGIES := $(sort $(wildcard bench/energy/*.energy))

FUZZ_REPLAY := $(B)/tests/fuzz/replay_nff

.DEFAULT_GOAL := all
.PHONY: all bench explain table simulate versus report report-data perf perf-stat asm selftest \
  overhead gate baseline regress selftest-gate test unit docs-check exact check fuzz setup install \
  clean help force

## all: build the program (build/raybench)
all: $(B)/raybench $(if $(filter release,$(CONFIG)),build/raybench)

## bench: naive, bvh, packets on the six scenes, two minutes (PLAN=table: another plan)
bench: all
	$(B)/raybench bench $(PLAN)

## explain: why kernels cost what they cost: time, counts, simulation (SCENE=balls_high)
explain: all
	$(B)/raybench explain $(or $(SCENE),balls_high) $(if $(VARIANT),--variants $(VARIANT))

## table: the render times of Table 1, about 15 minutes (CHECK=1: are the committed files stale?)
table: all
	$(B)/raybench table $(if $(CHECK),--check) $(TABLE)

## simulate: instructions and misses per ray from a simulator (SCENE=mount_high VARIANT=bvh)
SCENE    ?= balls_high
simulate: all
	$(B)/raybench simulate $(SCENE) $(if $(VARIANT),--variant $(VARIANT)) $(SIMULATE)

## versus: our best rows against Embree's best modes, an hour (VERSUS="balls_high --budget 1m")
versus: all
	$(B)/raybench versus $(VERSUS)

## report: report/report.html and report.md of results (RESULTS="results/latest results/other")
RESULTS  ?= results/latest
REPORT   ?= report
report: all
	@command -v /usr/bin/python3 >/dev/null || { echo 'make report needs python3: make setup' >&2; exit 1; }
	@/usr/bin/python3 scripts/report -o $(REPORT) --raybench $(B)/raybench $(RESULTS)

## report-data: measure all that a report shows, into results/report; 40 minutes
report-data: all
	@RAYBENCH=$(B)/raybench scripts/report-data

## perf: hottest functions and lines of a kernel, flame graph (SCENE= VARIANT=bvh KERNEL=trace)
perf: all
	@RAYBENCH=$(B)/raybench SCENE=$(SCENE) VARIANT=$(VARIANT) KERNEL=$(KERNEL) BOUNCE=$(BOUNCE) scripts/perf

## perf-stat: what perf counts of a kernel of each row, beside our times (VARIANT="bvh packet")
perf-stat: all
	@RAYBENCH=$(B)/raybench SCENE=$(SCENE) VARIANT="$(VARIANT)" KERNEL=$(KERNEL) BOUNCE=$(BOUNCE) scripts/perf-stat

## asm: the machine code of one kernel (VARIANT=bvh KERNEL=trace)
asm: all
	@RAYBENCH=$(B)/raybench VARIANT=$(VARIANT) KERNEL=$(KERNEL) scripts/asm

## selftest: verdicts on the program against itself, and on known slow-downs; three minutes
selftest: all
	@RAYBENCH=$(B)/raybench scripts/selftest

## overhead: what probes cost, against a build without them; three minutes
overhead: all
	@RAYBENCH=$(B)/raybench scripts/overhead

## gate: has the work of any kernel grown? exact, a minute (BASE=REV: simulate that commit, too)
base = base=$$(scripts/base $(BASE)) || exit 2;
gate: all
	@$(if $(BASE),$(base)) $(B)/raybench gate $(if $(BASE),--against "$$base") $(GATE)

## baseline: write results/baseline anew, for `make gate`; commit what it changes
baseline: all
	@$(B)/raybench gate --update

## regress: is any kernel slower than in BASE=REV? inconclusive passes, but with STRICT=1
regress: all
	@$(if $(BASE),$(base),echo 'make regress needs BASE=REV' >&2; exit 2;) \
	  $(B)/raybench regress --against "$$base" $(if $(STRICT),--strict) $(REGRESS) || \
	  { code=$$?; $(if $(STRICT),,[ $$code = 3 ] ||) exit $$code; }

## selftest-gate: can the gate be trusted? an hour; tests/cli/gate.t is its short form
selftest-gate: all
	@RAYBENCH=$(B)/raybench scripts/selftest-gate

## test: build and run every test (TAP, through perl's prove)
test: all unit $(FUZZ_REPLAY)
	@command -v prove >/dev/null || { echo 'make test needs prove: apt-get install perl' >&2; exit 1; }
	@RAYBENCH=$(B)/raybench BUILD=$(B) prove -j $(shell nproc 2>/dev/null || echo 1) -e '' \
	  $(UNIT) $(sort $(wildcard tests/cli/*.t))

## docs-check: do the commands, names, paths and links of the documents exist? are blocks fresh?
docs-check: all
	@RAYBENCH=$(B)/raybench scripts/docs-check

## exact: every row, tile size, thread count, instruction set, compiler and -O level, bit for bit
exact: all unit
	@RAYBENCH=$(B)/raybench scripts/exact

## check: everything CI runs, by name (CHECKS="style build ..." for some of it)
check:
	scripts/check $(CHECKS)

## fuzz: fuzz the NFF reader with clang's libFuzzer for FUZZ_S seconds (default 60)
FUZZ_S ?= 60
fuzz:
	scripts/fuzz $(FUZZ_S)

## setup: install what checks and measuring use beyond a compiler (Debian packages, needs root)
setup:
	scripts/setup

## install: install the program, its manual page, completions and plans in PREFIX (DESTDIR)
SHARE = $(DESTDIR)$(PREFIX)/share
install: all
	@$(B)/raybench man >$(B)/raybench.1
	@for shell in bash zsh fish; do \
	  $(B)/raybench completions $$shell >$(B)/completions.$$shell || exit 1; done
	install -D $(B)/raybench "$(DESTDIR)$(PREFIX)/bin/raybench"
	install -D -m 644 $(B)/raybench.1 "$(SHARE)/man/man1/raybench.1"
	install -D -m 644 $(B)/completions.bash "$(SHARE)/bash-completion/completions/raybench"
	install -D -m 644 $(B)/completions.zsh "$(SHARE)/zsh/site-functions/_raybench"
	install -D -m 644 $(B)/completions.fish "$(SHARE)/fish/vendor_completions.d/raybench.fish"
	$(if $(PLANS),install -D -m 644 -t "$(SHARE)/raybench/plans" $(PLANS))
	install -D -m 644 -t "$(SHARE)/raybench/events" $(EVENTS)
	install -D -m 644 -t "$(SHARE)/raybench/energy" $(ENERGIES)

## clean: remove build/
clean:
	rm -rf build

## help: this list
help:
	@echo 'usage: make [target] [CC=clang] [OPT=-O3] [CONFIG=name] [SANITIZE=address,undefined]'
	@sed -n 's/^## \([a-z-]*\): /\1\t/p' $(MAKEFILE_LIST) | expand -t 15

build/raybench: $(B)/raybench
	@ln -sf release/raybench $@

$(B)/raybench: $(B)/src/main.o $(B)/libraybench.a
	$(say) "  link $@"
	@$(CC) $(LINK) $(LDFLAGS) -o $@ $^ $(LIBS)

$(B)/libraybench.a: $(LIB_OBJ)
	@rm -f $@
	@$(AR) rcs $@ $^

unit: $(UNIT)
$(B)/tests/unit/%: $(B)/tests/unit/%.o $(TEST_OBJ) $(B)/libraybench.a
	$(say) "  link $@"
	@$(CC) $(LINK) $(LDFLAGS) -o $@ $^ $(LIBS)

$(FUZZ_REPLAY): $(B)/tests/fuzz/fuzz_nff.o $(B)/tests/fuzz/replay.o $(B)/libraybench.a
	$(say) "  link $@"
	@$(CC) $(LINK) $(LDFLAGS) -o $@ $^ $(LIBS)

define compile
@mkdir -p $(@D)
$(say) "  cc   $< $(ISA) $(COUNTING)"
@$(CC) $(INCLUDE) $(NEEDED) $(CPPFLAGS) $(CFLAGS) $(EXACT) $(ISA) $(COUNTING) -c -o $@ $<
endef
$(B)/%.avx2.o: %.c $(B)/flags
	$(compile)
$(B)/%.avx512.o: %.c $(B)/flags
	$(compile)
$(B)/%.o: %.c $(B)/flags
	$(compile)

# Kernels are compiled again with counting, as FILE.counted or FILE.ISA.counted (kernels/count.h).
%.counted.o: COUNTING := -DRB_COUNTING
$(B)/%.avx2.counted.o: %.c $(B)/flags
	$(compile)
$(B)/%.avx512.counted.o: %.c $(B)/flags
	$(compile)
$(B)/%.counted.o: %.c $(B)/flags
	$(compile)

# Rewritten only when compiler or flags change, so that they rebuild everything. Passed through the
# environment: the flags may hold quotes. env.json has them from flags.h, as a C string.
$(B)/flags: export FLAGS = $(CC) $(INCLUDE) $(NEEDED) $(CPPFLAGS) $(CFLAGS) $(EXACT) $(LINK) \
  $(LDFLAGS) $(LIBS)
$(B)/flags: force
	@mkdir -p $(@D)
	@printf '%s\n' "$$FLAGS" | cmp -s - $@ || printf '%s\n' "$$FLAGS" >$@
$(B)/flags.h: $(B)/flags
	@sed 's/["\\?]/\\&/g; s/.*/#define RB_FLAGS "&"/' $< >$@
$(B)/bench/machine/env_build.o: ISA := -I$(B)
$(B)/bench/machine/env_build.o: $(B)/flags.h
.SECONDARY:

-include $(shell find $(B) -name '*.d' 2>/dev/null)
