/* Inputs, notch and status of the law: see railhil_law.h. */
#include "railhil_law.h"


static const char *const outcome_names[RAILHIL_COUNTS - RAILHIL_CLOCK_OUTCOMES] = {
    "position_duplicate",
    "position_out_of_order",
    "position_check",
    "position_jump",
    "balise_check",
    "balise_number",
    "balise_late",
    "duplicate",
    "out_of_order",
    "gap",
    "check_variable",
    "out_of_range",
    "speed_jump",
#if RAILHIL_SAFE
    "safe_crc",
    "safe_version",
    "safe_duplicate",
    "safe_out_of_sequence",
    "safe_channel",
    "safe_time",
    "safe_differs",
#endif
};

const char *railhil_law_outcome(unsigned index)
{
    return outcome_names[index - RAILHIL_CLOCK_OUTCOMES];
}

void railhil_law_init(railhil_law_t *law)
{
    memset(law, 0, sizeof *law);
    railhil_guard_init(&law->guard);
    law->period = -1;
}

/* Runs the law if a control period has begun since its last step; it needs the time of the run. */
static void step(railhil_law_t *law, const railhil_clock_t *clock)
{
    const int64_t period = railhil_now_ns(clock) / @PREFIX@_PERIOD_NS;
    const int32_t k = period < INT32_MAX ? (int32_t)period : INT32_MAX;
    const int32_t speed_01mmps = law->guard.watch.speed_01mmps;
    const int32_t *balise = law->guard.balise.last;
    int32_t position_01mm;
    int late;
    (void)balise; /* not every law uses it */
    if (!clock->is_set || period == law->period || !law->guard.watch.speed_known) {
        return;
    }
    law->guard.watch.waits = 0;
    late = law->period >= 0 && period > law->period + 1;
    law->guard.watch.overruns += (uint32_t)late;
    railhil_period(&law->guard, late);
    position_01mm = railhil_position_01mm(&law->guard.odometer, railhil_own_ns(clock));
#if RAILHIL_TRACK
    law->guard.watch.beyond = railhil_is_beyond(&law->guard.balise, position_01mm, RAILHIL_END_01MM);
#endif
    @LAW@_inputs(k, speed_01mmps, position_01mm@BALISE@, &law->in, &law->events);
    if (law->steps == 0) {
        @LAW@_start(&law->in, &law->state);
    }
    @LAW@_step(&law->state, &law->in, &law->out, &law->events);
    law->guard.watch.told_code = law->out.notch;
    law->period = period;
    law->steps++;
}

static void answer_notch(railhil_law_t *law, const railhil_clock_t *clock, unsigned char *process)
{
    const railhil_watch_t *watch = &law->guard.watch;
    railhil_notch_cmd_t telegram = railhil_new_notch_cmd();
    step(law, clock);
    if (law->steps == 0 && watch->speed_known && watch->speed_01mmps != 0) {
        law->guard.watch.waits = 1;
    }
    if (law->steps != 0 || watch->waits) {
        const int32_t law_code = law->steps != 0 ? law->out.notch : 0;
        const int32_t code = railhil_watched_notch(&law->guard, railhil_own_ns(clock), law_code);
        if (law->steps != 0 && code != law->guard.watch.told_code) {
            law->guard.watch.told_code = code;
            @LAW@_sent(&law->state, code);
        }
        telegram.notch_256th = code;
        telegram.mode = RAILHIL_CTL_MODE_RUNNING + watch->level;
        telegram.cause = watch->cause;
        telegram.emergency =
            watch->level == RAILHIL_WATCH_LEVEL_EMERGENCY ? RAILHIL_FLAG_TRUE : RAILHIL_FLAG_FALSE;
    }
    telegram.life = railhil_law_life(law, RAILHIL_NOTCH_CMD);
    railhil_pack_notch_cmd(&telegram, process);
    law->guard.watch.emergency = telegram.emergency;
}

#if RAILHIL_SAFE
/* The last command once more. */
static void answer_safe_notch(railhil_law_t *law, const railhil_clock_t *clock, unsigned char *process)
{
    railhil_notch_sdt_t telegram = railhil_new_notch_sdt();
    telegram.notch_256th = law->guard.watch.code;
    telegram.emergency = law->guard.watch.emergency;
    /* Before the time of the run is known, that of the train itself. */
    railhil_safe_secure(&law->guard.safe, &telegram, clock->is_set ? clock->tick : law->guard.safe.told_tick, process);
}
#endif

static void answer_status(railhil_law_t *law, unsigned char *process)
{
    const railhil_watch_t *watch = &law->guard.watch;
    railhil_ctl_stat_t telegram = railhil_new_ctl_stat();
    telegram.life = railhil_law_life(law, RAILHIL_CTL_STAT);
    telegram.ready = RAILHIL_FLAG_FALSE;
    if (law->steps != 0) {
        telegram.note1 = @PREFIX@_NOTE1(law->out);
        telegram.note2 = @PREFIX@_NOTE2(law->out);
        telegram.note3 = @PREFIX@_NOTE3(law->out);
        telegram.ladder_level = watch->level;
        telegram.overflow_flags = railhil_law_flags(law);
        telegram.step_count = (int32_t)(law->steps & 0xFFFFu);
        telegram.step_cycles = RAILHIL_STEP_CYCLES;
        telegram.overruns = (int32_t)railhil_lesser(watch->overruns, RAILHIL_OVERRUN_COUNT_MAX);
        telegram.ready = RAILHIL_FLAG_TRUE;
    }
    railhil_pack_ctl_stat(&telegram, process);
}

void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts)
{
    (void)counts;
    if (port == RAILHIL_NOTCH_CMD) {
        answer_notch(law, clock, process);
#if RAILHIL_SAFE
    } else if (port == RAILHIL_NOTCH_SDT) {
        answer_safe_notch(law, clock, process);
#endif
    } else {
        answer_status(law, process);
    }
}

void railhil_law_look(railhil_law_t *law, const railhil_clock_t *clock)
{
    railhil_look(&law->guard, railhil_own_ns(clock));
}

void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts)
{
    railhil_guard_t *guard = &law->guard;
    const int64_t now_ns = railhil_own_ns(clock);
    switch (port) {
    case RAILHIL_TRN_SPEED:
        railhil_speed(guard, now_ns, process, counts);
        break;
    case RAILHIL_TRN_POS:
        railhil_position(&guard->odometer, now_ns, process, counts);
        break;
    case RAILHIL_BALISE:
        railhil_balise(&guard->balise, &guard->odometer, now_ns, process, counts);
        break;
    case RAILHIL_TRK_INFO:
        railhil_track(guard, now_ns, process);
        break;
#if RAILHIL_SAFE
    case RAILHIL_SPEED_SDT:
        railhil_safe_speed(&guard->safe, clock, process,
                           guard->watch.speed_known && guard->watch.accepted_ns == now_ns, guard->watch.speed_01mmps,
                           counts + RAILHIL_SAFE_FIRST);
        break;
#endif
    case RAILHIL_TIME_SYNC:
    case RAILHIL_PLT_STAT:
        /* The time may have gone on by more than the telegrams since the last poll tell. */
        railhil_law_look(law, clock);
        break;
    default: /* checked and counted like the others, not used by the law */
        break;
    }
}
