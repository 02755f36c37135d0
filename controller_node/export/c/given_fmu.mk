# The controller as an FMU (FMI 2.0, co-simulation): do not edit.
#   make fmu     railhil run --controller build/@NAME@.fmu
PYTHON ?= python3
FMU := $(BUILD)/fmu
FMU_C := $(patsubst %,$(BUILD)/railhil/%.o,railhil_fmi2.c railhil_fmu.c)
FMU_LIBRARY := $(FMU)/binaries/@PLATFORM@/@NAME@.so

ifneq ($(filter fmu,$(MAKECMDGOALS)),)
ifeq ($(shell command -v $(firstword $(CC)) 2>/dev/null),)
$(error no C compiler: $(CC) is not installed)
endif
endif

.PHONY: fmu
fmu: $(BUILD)/@NAME@.fmu

# The functions have the parameters of the standard, used or not.
$(FMU_C): RAILHIL_CFLAGS += -Wno-unused-parameter

$(FMU_LIBRARY): $(OWN) $(FMU_C)
	@mkdir -p $(@D)
	$(LINK) -shared -Wl,-z,defs -o $@ $^ $(LDLIBS) -lm

# All entries have one time: the same files give the same bytes.
$(BUILD)/@NAME@.fmu: $(RAILHIL)/modelDescription.xml $(FMU_LIBRARY)
	@cp $< $(FMU)
	@find $(FMU) -exec touch -d '1980-01-02 00:00' {} +
	@rm -f $@
	cd $(FMU) && $(PYTHON) -m zipfile -c ../$(@F) modelDescription.xml binaries
