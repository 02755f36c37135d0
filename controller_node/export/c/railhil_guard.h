/* What a controller on the bus knows besides its law: the time, which speeds and positions count, the last balise, and
 * the reaction ladder that watches them. Whole numbers only; the numbers of the scenario stand in @LAW@_node.h.
 */
#ifndef RAILHIL_GUARD_H
#define RAILHIL_GUARD_H

#include "railhil_mvb.h"

/* Refusals and losses that are counted, after those of railhil_outcome_t. */
enum {
    RAILHIL_SPEED_DUPLICATE = RAILHIL_MVB_OUTCOMES, /* TRN_SPEED: life sign repeated */
    RAILHIL_SPEED_OUT_OF_ORDER,                     /* from the past */
    RAILHIL_SPEED_GAP,                              /* used, but telegrams are missing before it */
    RAILHIL_SPEED_CHECK,                            /* check variable not correct */
    RAILHIL_SPEED_OUT_OF_RANGE,
    RAILHIL_POSITION_DUPLICATE, /* TRN_POS */
    RAILHIL_POSITION_OUT_OF_ORDER,
    RAILHIL_POSITION_CHECK,
    RAILHIL_POSITION_JUMP, /* does not fit the speeds */
    RAILHIL_BALISE_CHECK,  /* BALISE */
    RAILHIL_BALISE_NUMBER, /* 0 is none */
    RAILHIL_BALISE_LATE,   /* the passing is not between the last telegram and here */
    RAILHIL_COUNTS
};

enum { RAILHIL_CHECK_CORRECT = 1, RAILHIL_GOOD_POSITIONS = 10 };

/* Reaction ladder; a higher level is the stronger reaction. */
enum { RAILHIL_NORMAL, RAILHIL_HOLD, RAILHIL_TRACTION_CUT, RAILHIL_SERVICE_BRAKE, RAILHIL_EMERGENCY };

/* Simulation time in base ticks, counted from the life sign of TRN_SPEED. */
typedef struct {
    int64_t tick;
    int64_t frame_tick; /* tick of the last clock frame */
    int64_t poll_tick;  /* of the first poll since */
    int64_t polls;
    int life;     /* of the last clock frame, -1: not known */
    int expected; /* life sign that confirms that frames which look old are not */
    int running;
} railhil_clock_t;

/* Position in 1e-13 m (0.1 mm/s times ns), reckoned from the speeds, beside the odometer. */
typedef struct {
    int64_t place;
    int64_t slack; /* what the reckoning may be off by */
    int64_t at_ns;
    int64_t speed_ns;
    int64_t fitted_ns;  /* last telegram that fitted */
    int64_t trusted_ns; /* last time that the odometer was believed */
    int32_t speed_01mmps;
    int32_t reading_01mm;
    int life;
    int begun;
    int heard;
    int run; /* telegrams in a row that fitted */
} railhil_odometer_t;

typedef struct {
    int32_t last[3]; /* for the law: number (0: none yet), surveyed position and odometer at its passing, 0.1 mm */
    int64_t heard_mm;
    int32_t number;
    int heard;
} railhil_balise_t;

typedef struct {
    int64_t accepted_ns; /* last accepted TRN_SPEED */
    int64_t sent_ns;     /* last notch sent */
    int32_t speed_01mmps;
    int32_t limit_01mmps;
    int32_t code;      /* notch last sent, 1/256 */
    int32_t kept_code; /* braking to keep during TRACTION_CUT */
    unsigned recent;   /* last telegrams, newest in bit 0, 1: bad */
    int level;
    int good_run;
    int returning; /* the notch comes back on the ramp */
    int speed_known;
    int limit_known;
    int life;
} railhil_watch_t;

typedef struct {
    railhil_clock_t clock;
    railhil_odometer_t odometer;
    railhil_balise_t balise;
    railhil_watch_t watch;
    uint32_t counts[RAILHIL_COUNTS]; /* by outcome */
} railhil_guard_t;

/* Arithmetic in 64 bits. */
static inline int64_t railhil_lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static inline int64_t railhil_greater(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static inline int64_t railhil_within(int64_t a, int64_t limit)
{
    return railhil_lesser(railhil_greater(a, -limit), limit);
}

static inline int64_t railhil_floored(int64_t a, int64_t divisor)
{
    return a / divisor - (a % divisor < 0 ? 1 : 0);
}

void railhil_guard_init(railhil_guard_t *guard);

/* Simulation time of the current tick. */
int64_t railhil_now_ns(const railhil_guard_t *guard);

/* A frame of the clock port, before it is taken as a telegram; a poll that comes every period_ticks; a TIME_SYNC. */
void railhil_clock_frame(railhil_guard_t *guard, unsigned length, const unsigned char *data);
void railhil_clock_poll(railhil_guard_t *guard, int64_t period_ticks);
void railhil_time_sync(railhil_guard_t *guard, const unsigned char *process);

/* Process data of telegrams that were accepted: TRN_SPEED, TRN_POS, TRK_INFO, BALISE. */
void railhil_speed(railhil_guard_t *guard, const unsigned char *process);
void railhil_position(railhil_guard_t *guard, const unsigned char *process);
void railhil_track(railhil_guard_t *guard, const unsigned char *process);
void railhil_balise(railhil_guard_t *guard, const unsigned char *process);

/* Position for the law: the odometer while it is believed, else what is reckoned; 0.1 mm. */
int32_t railhil_position_01mm(railhil_guard_t *guard);

/* Takes an accepted speed; tells whether a law that needs a position has had none but a reckoned one for too long. */
void railhil_odometer_speed(railhil_odometer_t *odometer, int32_t speed_01mmps, int64_t at_ns);
int railhil_position_lost(const railhil_odometer_t *odometer, int64_t now_ns);

/* The notch (1/256) to send now instead of the law's. */
int32_t railhil_watched_notch(railhil_guard_t *guard, int32_t law_code);

#endif
