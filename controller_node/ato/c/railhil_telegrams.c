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

/* The number of the period, speed and position, for a law with track inputs also the last balise. */
int railhil_guard_inputs(railhil_guard_t *guard, const railhil_clock_t *clock, int64_t period, int64_t last,
                         int32_t *given)
{
    railhil_watch_t *watch = &guard->watch;
    const int late = last >= 0 && period > last + 1;
    if (!clock->is_set || !watch->speed_known) {
        return 0;
    }
    watch->waits = 0;
    watch->overruns += (uint32_t)late;
    railhil_period(guard, late);
    given[0] = period < INT32_MAX ? (int32_t)period : INT32_MAX;
    given[1] = watch->speed_01mmps;
    given[2] = railhil_position_01mm(&guard->odometer, railhil_own_ns(clock));
#if RAILHIL_TRACK
    watch->beyond = railhil_is_beyond(&guard->balise, given[2], RAILHIL_END_01MM);
    memcpy(given + 3, guard->balise.last, sizeof guard->balise.last);
#endif
    return 1;
}

/* The notch of the watch. A train that may move before the law can run is braked. */
int railhil_guard_commands(railhil_guard_t *guard, const railhil_clock_t *clock, uint32_t steps, int32_t *commands,
                           uint32_t *counts)
{
    railhil_watch_t *watch = &guard->watch;
    (void)counts;
    if (steps == 0) {
        watch->waits = watch->waits || railhil_may_move(guard, railhil_own_ns(clock));
        commands[0] = 0;
    }
    if (steps != watch->steps) {
        watch->steps = steps;
        watch->told_code = commands[0];
    }
    if (steps != 0 || watch->waits) {
        commands[0] = railhil_watched_notch(guard, railhil_own_ns(clock), commands[0]);
    }
    if (commands[0] == watch->told_code) {
        return 0;
    }
    watch->told_code = commands[0];
    return 1;
}

static void answer_notch(railhil_law_t *law, const railhil_clock_t *clock, unsigned char *process, uint32_t *counts)
{
    const railhil_watch_t *watch = &law->guard.watch;
    railhil_notch_cmd_t telegram = railhil_new_notch_cmd();
    int32_t commands[RAILHIL_COMMAND_COUNT];
    railhil_law_command(law, clock, commands, counts);
    if (law->steps != 0 || watch->waits) {
        telegram.notch_256th = commands[0];
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
    if (port == RAILHIL_NOTCH_CMD) {
        answer_notch(law, clock, process, counts);
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
