/* Position of the train for the law, from TRN_POS and the accepted speeds, and the last balise. Integers only; the
 * constants of the scenario are in @LAW@_node.h.
 */
#ifndef RAILHIL_POSITION_H
#define RAILHIL_POSITION_H

#include "railhil_clock.h"

/* Counters of refusals, after those of the clock. */
enum {
    RAILHIL_POSITION_DUPLICATE = RAILHIL_CLOCK_OUTCOMES, /* TRN_POS: life sign repeated */
    RAILHIL_POSITION_OUT_OF_ORDER,                     /* older than the last telegram */
    RAILHIL_POSITION_CHECK,                            /* check variable not correct */
    RAILHIL_POSITION_JUMP,                             /* inconsistent with the speeds */
    RAILHIL_BALISE_CHECK,                              /* BALISE: check variable not correct */
    RAILHIL_BALISE_NUMBER,                             /* number 0: no balise */
    RAILHIL_BALISE_LATE, /* there is not exactly one place where it can have been passed */
    RAILHIL_POSITION_OUTCOMES
};

/* Position in 1e-13 m (0.1 mm/s times ns), dead-reckoned from the speeds, and the odometer's readings. */
typedef struct {
    int64_t place;
    int64_t slack; /* largest error of the reckoned position */
    int64_t at_ns;
    int64_t speed_ns;
    int64_t fitted_ns;  /* time of the last telegram that fitted */
    int64_t trusted_ns; /* last time that the odometer was trusted */
    int64_t jumped_ns;  /* the first telegram since then that was inconsistent with the speeds */
    int64_t jumping_ns; /* and the last one */
    int64_t reading_01mm;
    int32_t speed_01mmps;
    int life;
    int begun;
    int heard;
    int jumped;
    int run; /* consecutive telegrams that fitted */
} railhil_odometer_t;

typedef struct {
    int32_t last[3]; /* for the law: number (0: none yet), surveyed position, odometer when passed, 0.1 mm */
    int64_t heard_mm;
    int64_t sure_surveyed_mm; /* the last balise that a worn wheel explains, and the odometer there; the start */
    int64_t sure_passed_mm;
    int32_t number;
    int heard;
} railhil_balise_t;

/* Take the process data of TRN_POS and BALISE telegrams. counts: counters of refusals, by outcome. */
void railhil_position(railhil_odometer_t *odometer, int64_t now_ns, const unsigned char *process, uint32_t *counts);
void railhil_balise(railhil_balise_t *balise, railhil_odometer_t *odometer, int64_t now_ns,
                    const unsigned char *process, uint32_t *counts);

/* 1 if a train at here_01mm by its odometer is beyond a place on the line, whatever its wheels, by the last balise. */
int railhil_is_beyond(const railhil_balise_t *balise, int32_t here_01mm, int64_t place_01mm);

/* Position for the law: the odometer's while it is trusted, else the reckoned one; 0.1 mm. */
int32_t railhil_position_01mm(railhil_odometer_t *odometer, int64_t now_ns);

/* Why the position is lost: too long a time of dead reckoning for a law that needs a position, or inconsistent
 * telegrams for as long. */
enum { RAILHIL_NOT_LOST, RAILHIL_LOST, RAILHIL_CONTRADICTED };

/* The first takes an accepted speed, the second answers one of the above. */
void railhil_odometer_speed(railhil_odometer_t *odometer, int32_t speed_01mmps, int64_t at_ns);
int railhil_position_lost(const railhil_odometer_t *odometer, int64_t now_ns);

#endif
