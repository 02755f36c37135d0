/* Plausibility of the speed, and monitors of its channel: see railhil_motion.h. */
#include "railhil_motion.h"

#include "@LAW@_node.h"

#define NS_PER_S INT64_C(1000000000)
#define NS_PER_MS INT64_C(1000000)
#define LONG_NS INT64_C(100000000000)
#define Q16 INT64_C(65536)
#define Q20 INT64_C(1048576)
#define Q40 INT64_C(1099511627776)

enum { LIFE_TURN = 16 };

int railhil_speed_fits(int64_t change_01mmps, int64_t elapsed_ns)
{
    const int64_t time_ns = railhil_lesser(railhil_greater(elapsed_ns, RAILHIL_BASE_TICK_NS), LONG_NS);
    const int64_t change = railhil_greater(change_01mmps, -change_01mmps);
    return change <= RAILHIL_JUMP_01MMPS + RAILHIL_SPEED_CHANGE_01MMPS2 * time_ns / NS_PER_S;
}

static void judge_stuck(railhil_motion_t *motion, int64_t force, int64_t against, int64_t step_ms, int unchanged)
{
    if (!unchanged || motion->speed == 0) {
        motion->due = 0;
    } else {
        const int64_t accel = railhil_greater(force, -RAILHIL_BRAKE_01MMPS2) - against;
        if (railhil_greater(accel, -accel) >= RAILHIL_DUE_MIN) {
            motion->due += accel * step_ms;
        }
    }
    motion->stuck = railhil_greater(motion->due, -motion->due) > RAILHIL_STUCK_01MMPS * 1000;
}

static void judge_force(railhil_motion_t *motion, int64_t wanted, int64_t against, int64_t step_ms, int64_t change)
{
    const int64_t force = railhil_greater(wanted, -RAILHIL_BRAKE_01MMPS2);
    const int64_t accel = force - against;
    const int64_t missing = railhil_floored(-force * (1000 - RAILHIL_BRAKE_SHARE_PERMIL), 1000) + RAILHIL_SHORTFALL;
    motion->off -= railhil_floored(motion->off * step_ms, 1000);
    motion->off += change * 1000 - accel * step_ms;
    /* The excess over 1 s is the unexplained acceleration. */
    motion->runaway = motion->off > RAILHIL_RUNAWAY_01MMPS * 1000 && accel * 1000 + motion->off > 0;
    motion->weak_ms = force < -RAILHIL_DEMAND_MIN && motion->off > missing * 1000 ? motion->weak_ms + step_ms : 0;
}

static void judge_scale(railhil_motion_t *motion, int has_position, int64_t position)
{
    uint32_t entry;
    int64_t by_speed;
    int64_t by_odometer;
    int64_t off;
    int64_t allowed;
    if (!has_position) {
        motion->count = 0;
        motion->off_scale = 0;
        return;
    }
    motion->count++;
    if (motion->count % RAILHIL_RING_EVERY != 0) {
        return;
    }
    entry = motion->count / RAILHIL_RING_EVERY;
    by_speed = railhil_floored(motion->way - motion->ring_way[entry % RAILHIL_RING], 2000);
    by_odometer = position - motion->ring_place[entry % RAILHIL_RING];
    motion->ring_way[entry % RAILHIL_RING] = motion->way;
    motion->ring_place[entry % RAILHIL_RING] = position;
    if (entry <= RAILHIL_RING) {
        return;
    }
    off = by_speed - by_odometer;
    allowed = railhil_floored(railhil_greater(by_speed, by_odometer) * RAILHIL_SCALE_ERROR_PERMIL, 1000);
    motion->off_scale = railhil_greater(off, -off) > allowed + RAILHIL_DISAGREEMENT_01MM;
}

void railhil_sample(railhil_motion_t *motion, int64_t now_ns, int64_t speed, int64_t code, int has_grade, int64_t grade,
                    int64_t changed_ns, int has_position, int64_t position)
{
    /* Both ends are rounded, so that over many samples no time is lost. */
    const int64_t step_ms = railhil_floored(now_ns, NS_PER_MS) - railhil_floored(motion->at_ns, NS_PER_MS);
    const int64_t before_ns = motion->at_ns;
    const int64_t before = motion->speed;
    int64_t share_q16;
    int64_t wanted;
    int64_t against;
    motion->at_ns = now_ns;
    motion->speed = speed;
    if (!motion->begun || step_ms <= 0 || step_ms > RAILHIL_PAUSE_MAX_MS) {
        motion->begun = 1;
        motion->off = motion->due = motion->weak_ms = 0;
        motion->count = 0;
        motion->stuck = motion->off_scale = motion->runaway = 0;
        return;
    }
    share_q16 = railhil_lesser(RAILHIL_DECAY_Q16 * step_ms / RAILHIL_SAMPLE_MS, Q16);
    motion->force += railhil_floored((code * 256 - motion->force) * share_q16, Q16);
    wanted = railhil_floored(motion->force * RAILHIL_NOTCH_01MMPS2, Q16);
    against = RAILHIL_DAVIS_A + railhil_floored(RAILHIL_DAVIS_B_Q20 * speed, Q20) +
              railhil_floored(RAILHIL_DAVIS_C_Q40 * speed * speed, Q40);
    if (has_grade) {
        against += railhil_floored(grade * RAILHIL_GRADE_Q16, Q16);
    }
    judge_stuck(motion, railhil_lesser(wanted, RAILHIL_WEAK_TRACTION_01MMPS2), against, step_ms,
                changed_ns <= before_ns);
    if (code > 0 || speed < RAILHIL_SLOW || !has_grade) {
        motion->off = motion->weak_ms = 0;
        motion->runaway = 0;
    } else {
        judge_force(motion, railhil_lesser(wanted, RAILHIL_TRACTION_01MMPS2), against, step_ms, speed - before);
    }
    motion->way += (speed + before) * step_ms;
    judge_scale(motion, has_position, position);
}

void railhil_latency_received(railhil_latency_t *latency, int life)
{
    latency->lag -= ((life - latency->life) & 0xF) * RAILHIL_CLOCK_TICKS;
    latency->life = life;
    latency->old = 0;
}

int railhil_latency_polled(railhil_latency_t *latency)
{
    int64_t late;
    latency->lag += RAILHIL_NOTCH_TICKS;
    late = latency->lag - latency->base;
    if (latency->doubt || late < 0) {
        latency->base = latency->lag;
        latency->doubt = 0;
        return 0;
    }
    if (late >= LIFE_TURN * RAILHIL_CLOCK_TICKS) {
        latency->lag -= LIFE_TURN * RAILHIL_CLOCK_TICKS;
        late -= LIFE_TURN * RAILHIL_CLOCK_TICKS;
    }
    return late > RAILHIL_LATENCY_MAX_TICKS;
}

int railhil_debt_add(railhil_debt_t *debt, int64_t now_ms, int64_t cost, int64_t limit, int64_t paid_per_ms)
{
    const int64_t paid = railhil_greater(now_ms - debt->at_ms, 0) * paid_per_ms;
    debt->at_ms = now_ms;
    debt->debt = railhil_lesser(railhil_greater(debt->debt - paid, 0) + cost, 2 * limit);
    return debt->debt > limit;
}
