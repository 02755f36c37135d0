/* Where the train is: a position for the law from TRN_POS and the accepted speeds, and the last balise. Whole numbers
 * only; the numbers of the scenario stand in @LAW@_node.h.
 */
#ifndef RAILHIL_POSITION_H
#define RAILHIL_POSITION_H

#include "railhil_clock.h"

/* Refusals that are counted, after those of railhil_outcome_t. */
enum {
    RAILHIL_POSITION_DUPLICATE = RAILHIL_MVB_OUTCOMES, /* TRN_POS: life sign repeated */
    RAILHIL_POSITION_OUT_OF_ORDER,                     /* from the past */
    RAILHIL_POSITION_CHECK,                            /* check variable not correct */
    RAILHIL_POSITION_JUMP,                             /* does not fit the speeds */
    RAILHIL_BALISE_CHECK,                              /* BALISE */
    RAILHIL_BALISE_NUMBER,                             /* 0 is none */
    RAILHIL_BALISE_LATE, /* the passing is not between the last telegram and here */
    RAILHIL_POSITION_OUTCOMES
};

enum { RAILHIL_GOOD_POSITIONS = 10 };

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

/* Process data of telegrams that were accepted: TRN_POS, BALISE. counts: of refusals, by outcome. */
void railhil_position(railhil_odometer_t *odometer, int64_t now_ns, const unsigned char *process, uint32_t *counts);
void railhil_balise(railhil_balise_t *balise, railhil_odometer_t *odometer, int64_t now_ns,
                    const unsigned char *process, uint32_t *counts);

/* Position for the law: the odometer while it is believed, else what is reckoned; 0.1 mm. */
int32_t railhil_position_01mm(railhil_odometer_t *odometer, int64_t now_ns);

/* Takes an accepted speed; tells whether a law that needs a position has had none but a reckoned one for too long. */
void railhil_odometer_speed(railhil_odometer_t *odometer, int32_t speed_01mmps, int64_t at_ns);
int railhil_position_lost(const railhil_odometer_t *odometer, int64_t now_ns);

#endif
