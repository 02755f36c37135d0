/* Acceptance of speeds, and the reaction ladder that supervises speed and position. Integers only; the constants of the
 * scenario, and the levels (a higher one is the stronger reaction) and causes of the watch are in @LAW@_node.h.
 */
#ifndef RAILHIL_GUARD_H
#define RAILHIL_GUARD_H

#include "railhil_motion.h"
#include "railhil_position.h"
#include "railhil_safe.h"

/* Counters of refusals and losses, after those of positions and balises. */
enum {
    RAILHIL_SPEED_DUPLICATE = RAILHIL_POSITION_OUTCOMES, /* TRN_SPEED: life sign repeated */
    RAILHIL_SPEED_OUT_OF_ORDER,                          /* older than the last telegram */
    RAILHIL_SPEED_GAP,                                   /* used, but telegrams before it are missing */
    RAILHIL_SPEED_CHECK,                                 /* check variable not correct */
    RAILHIL_SPEED_OUT_OF_RANGE,
    RAILHIL_SPEED_JUMP, /* no train can have changed its speed so fast */
#if RAILHIL_SAFE
    RAILHIL_SAFE_FIRST, /* causes of the safe channel from here on */
    RAILHIL_COUNTS = RAILHIL_SAFE_FIRST + RAILHIL_SAFE_CAUSES
#else
    RAILHIL_COUNTS
#endif
};

typedef struct {
    int64_t accepted_ns; /* time of the last accepted TRN_SPEED */
    int64_t ramp_ns;     /* up to when the ramp has gone; 0: no notch was sent yet */
    int64_t changed_ns;  /* when the speed has last changed */
    int64_t sample_ns;   /* last sample of the motion */
    int64_t track_ns;    /* time of the last TRK_INFO with limit and grade */
    int32_t speed_01mmps;
    int32_t sample_01mmps;
    int32_t limit_01mmps;
    int32_t grade_001permil;
    int32_t code;      /* last notch sent, 1/256 */
    int32_t told_code; /* the same, as known to the law */
    uint32_t steps;    /* control periods computed up to then */
    int32_t emergency; /* flag of the last NOTCH_CMD, which NOTCH_SDT repeats */
    int32_t kept_code; /* braking to keep during TRACTION_CUT */
    unsigned recent;   /* last telegrams, newest in bit 0, 1: bad */
    int level;
    int cause; /* why the level was entered */
    int good_run;
    int returning; /* the notch is returning to the law's on the ramp */
    int speed_known;
    int limit_known;
    int grade_known;
    int life;
    int track_life;
    int late; /* late control periods in a row */
    uint32_t overruns; /* how often control periods were skipped */
    int stale; /* the telegrams are delayed */
    int beyond; /* the train is beyond its end of authority by the balises: the law's position is wrong */
    int waits; /* the train may move, and speed or time of the run are not known yet: the law cannot run */
} railhil_watch_t;

typedef struct {
    railhil_odometer_t odometer;
    railhil_balise_t balise;
    railhil_motion_t motion;
    railhil_latency_t latency;
    railhil_debt_t channel;  /* bad telegrams */
    railhil_debt_t disorder; /* old telegrams */
    railhil_watch_t watch;
#if RAILHIL_SAFE
    railhil_safe_t safe;
#endif
} railhil_guard_t;

/* Take the process data of TRN_SPEED and TRK_INFO telegrams. counts: counters of refusals, by outcome. */
void railhil_speed(railhil_guard_t *guard, int64_t now_ns, const unsigned char *process, uint32_t *counts);
void railhil_track(railhil_guard_t *guard, int64_t now_ns, const unsigned char *process);

/* 1 if the train moves by its last speed, or this is too old. */
int railhil_may_move(const railhil_guard_t *guard, int64_t now_ns);

/* Check the age of the last speed. */
void railhil_look(railhil_guard_t *guard, int64_t now_ns);

/* A control period is computed; late: periods before it were left out. */
void railhil_period(railhil_guard_t *guard, int late);

/* The notch (1/256) to send now, at a poll, instead of the law's. */
int32_t railhil_watched_notch(railhil_guard_t *guard, int64_t now_ns, int32_t law_code);

#endif
