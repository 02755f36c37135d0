/* Acceptance of speeds, and the reaction ladder that supervises speed and position. Integers only; the constants of the
 * scenario are in @LAW@_node.h.
 */
#ifndef RAILHIL_GUARD_H
#define RAILHIL_GUARD_H

#include "railhil_position.h"
#include "railhil_safe.h"

/* Counters of refusals and losses, after those of positions and balises. */
enum {
    RAILHIL_SPEED_DUPLICATE = RAILHIL_POSITION_OUTCOMES, /* TRN_SPEED: life sign repeated */
    RAILHIL_SPEED_OUT_OF_ORDER,                          /* older than the last telegram */
    RAILHIL_SPEED_GAP,                                   /* used, but telegrams before it are missing */
    RAILHIL_SPEED_CHECK,                                 /* check variable not correct */
    RAILHIL_SPEED_OUT_OF_RANGE,
#if RAILHIL_SAFE
    RAILHIL_SAFE_FIRST, /* causes of the safe channel from here on */
    RAILHIL_COUNTS = RAILHIL_SAFE_FIRST + RAILHIL_SAFE_CAUSES
#else
    RAILHIL_COUNTS
#endif
};

/* Reaction ladder; a higher level is a stronger reaction. */
enum { RAILHIL_NORMAL, RAILHIL_HOLD, RAILHIL_TRACTION_CUT, RAILHIL_SERVICE_BRAKE, RAILHIL_EMERGENCY };

/* Why the level was entered (CtlCause of NOTCH_CMD). */
enum {
    RAILHIL_CAUSE_NONE = 0,
    RAILHIL_CAUSE_SPEED_AGE = 1,
    RAILHIL_CAUSE_BAD_TELEGRAMS = 2,
    RAILHIL_CAUSE_POSITION_LOST = 3,
    RAILHIL_CAUSE_OVERSPEED = 4,
    RAILHIL_CAUSE_SAFETY_CODE = 14
};

typedef struct {
    int64_t accepted_ns; /* time of the last accepted TRN_SPEED */
    int64_t sent_ns;     /* time of the last notch sent */
    int32_t speed_01mmps;
    int32_t limit_01mmps;
    int32_t code;      /* last notch sent, 1/256 */
    int32_t kept_code; /* braking to keep during TRACTION_CUT */
    unsigned recent;   /* last telegrams, newest in bit 0, 1: bad */
    int level;
    int cause; /* why the level was entered */
    int good_run;
    int returning; /* the notch is returning to the law's on the ramp */
    int speed_known;
    int limit_known;
    int life;
} railhil_watch_t;

typedef struct {
    railhil_odometer_t odometer;
    railhil_balise_t balise;
    railhil_watch_t watch;
#if RAILHIL_SAFE
    railhil_safe_t safe;
#endif
} railhil_guard_t;

void railhil_guard_init(railhil_guard_t *guard);

/* Take the process data of TRN_SPEED and TRK_INFO telegrams. counts: counters of refusals, by outcome. */
void railhil_speed(railhil_guard_t *guard, int64_t now_ns, const unsigned char *process, uint32_t *counts);
void railhil_track(railhil_guard_t *guard, const unsigned char *process);

/* The notch (1/256) to send now instead of the law's. */
int32_t railhil_watched_notch(railhil_guard_t *guard, int64_t now_ns, int32_t law_code);

#endif
