# Rules for a controller of the user, made with the C around it: do not edit. SOURCES lists the files of the user.
#   make         the controller as a program: build/@NAME@_node can vcan0 | hub PATH | slcan DEVICE
#   make lib     a shared library: railhil run --controller build/@NAME@.so
#   make check   test_@NAME@.c on this host
ifeq ($(origin CC),default)
CC := gcc
endif
ifeq ($(origin CXX),default)
CXX := g++
endif
BUILD ?= build
RAILHIL_C := @AROUND@
# The user's files are compiled without contraction of products and sums, too: the same bits on every processor.
RAILHIL_FLAGS := @FLAGS@ -fPIC -I$(RAILHIL) -I.
RAILHIL_CFLAGS := -std=c99 -O2 -Wall -Wextra -fwrapv
OWN := $(SOURCES:%=$(BUILD)/%.o)
AROUND := $(RAILHIL_C:%=$(BUILD)/railhil/%.o)
HOST := $(patsubst %,$(BUILD)/railhil/%.o,@HOST@)
LINK := $(if $(filter-out %.c,$(SOURCES)),$(CXX),$(CC))
HEADERS := $(wildcard *.h *.hpp $(RAILHIL)/*.h) $(MAKEFILE_LIST)

.PHONY: node lib check sources clean
.DEFAULT_GOAL := node

node: $(BUILD)/@NAME@_node
lib: $(BUILD)/@NAME@.so
check: $(BUILD)/test_@NAME@
	$<

$(BUILD)/@NAME@_node: $(OWN) $(AROUND) $(HOST)
	$(LINK) -o $@ $^ $(LDLIBS) -lm

$(BUILD)/@NAME@.so: $(OWN) $(BUILD)/railhil/given_interface.c.o
	$(LINK) -shared -Wl,-z,defs -o $@ $^ $(LDLIBS) -lm

$(BUILD)/test_@NAME@: $(OWN) $(BUILD)/test_@NAME@.c.o
	$(LINK) -o $@ $^ $(LDLIBS) -lm

$(BUILD)/railhil/%.c.o: $(RAILHIL)/%.c $(HEADERS)
	@mkdir -p $(@D)
	$(CC) $(RAILHIL_CFLAGS) $(RAILHIL_FLAGS) -c -o $@ $<

$(BUILD)/%.c.o: %.c $(HEADERS)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(RAILHIL_FLAGS) -c -o $@ $<

$(BUILD)/%.cpp.o: %.cpp $(HEADERS)
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS) $(RAILHIL_FLAGS) -c -o $@ $<

# For the build for a board: all files without those of the host.
sources:
	@echo $(SOURCES) $(RAILHIL_C:%=$(RAILHIL)/%) $(RAILHIL)/railhil_pipe.c

clean:
	rm -rf $(BUILD)

# By railhil new c-controller --fmu.
-include $(RAILHIL)/fmu.mk
