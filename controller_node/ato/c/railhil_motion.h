/* Plausibility of the measured speed against the train, the odometer and the notch sent, and monitors of the channel.
 * Integers only; the constants of the scenario are in @LAW@_node.h. Speeds in 0.1 mm/s, accelerations in 0.1 mm/s2,
 * positions in 0.1 mm.
 */
#ifndef RAILHIL_MOTION_H
#define RAILHIL_MOTION_H

#include "@LAW@_node.h"
#include "railhil_clock.h"

typedef struct {
    int64_t at_ns;
    int64_t force; /* of the actuator in the model, notch codes (1/256 notch) times 256 */
    int64_t off;   /* excess of the speed over the model, with a time constant of 1 s, 1e-7 m/s */
    int64_t due;   /* change of speed that is due since the reading has changed, 1e-7 m/s */
    int64_t way;   /* by the speeds, 0.5e-7 m */
    int64_t ring_way[RAILHIL_RING];
    int64_t ring_place[RAILHIL_RING];
    int64_t speed;
    int64_t weak_ms; /* for how long the brake has not answered */
    uint32_t count;
    int begun;
    int stuck;
    int off_scale;
    int runaway;
} railhil_motion_t;

typedef struct {
    int64_t lag;  /* polls minus telegrams, base ticks */
    int64_t base; /* its normal value */
    int life;
    int doubt; /* the next poll shows the normal value */
    int old;   /* the last telegram was older than the one before */
} railhil_latency_t;

/* Events against time: each adds its cost, each ms pays some of it back. */
typedef struct {
    int64_t at_ms;
    int64_t debt;
} railhil_debt_t;

/* 1 if a train can have changed its speed by so much in this time. */
int railhil_speed_fits(int64_t change_01mmps, int64_t elapsed_ns);

/* Takes the speed of now, at least 100 ms after the last one: code is the notch sent (1/256), changed_ns when the
 * reading has last changed; has_grade, has_position: 0 if grade (0.01 permil) or position are not known. */
void railhil_sample(railhil_motion_t *motion, int64_t now_ns, int64_t speed, int64_t code, int has_grade, int64_t grade,
                    int64_t changed_ns, int has_position, int64_t position);

/* Take a new telegram's life sign, and a poll; the latter returns 1 if the telegrams are stale. */
void railhil_latency_received(railhil_latency_t *latency, int life);
int railhil_latency_polled(railhil_latency_t *latency);

/* Counts an event; 1 if there were too many. */
int railhil_debt_add(railhil_debt_t *debt, int64_t now_ms, int64_t cost, int64_t limit, int64_t paid_per_ms);

#endif
