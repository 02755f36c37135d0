/* Acceptance of speeds, and the reaction ladder: see railhil_guard.h. */
#include "railhil_guard.h"

#include "@LAW@_node.h"

#define NS_PER_MS INT64_C(1000000)
/* A higher raw speed is not plausible for a train (0.1 mm/s). */
#define SPEED_MAX_01MMPS INT32_C(1500000)

enum { GOOD_AFTER_TRACTION_CUT = 5, GOOD_AFTER_SERVICE_BRAKE = 10, BAD_FOR_TRACTION_CUT = 3, RECENT_MASK = 0x3FF };

typedef enum { NO_TELEGRAM, GOOD_TELEGRAM, BAD_TELEGRAM } seen_t;

void railhil_guard_init(railhil_guard_t *guard)
{
    memset(guard, 0, sizeof *guard);
    guard->odometer.life = guard->watch.life = -1;
    guard->odometer.run = RAILHIL_GOOD_POSITIONS;
#if RAILHIL_SAFE
    railhil_safe_init(&guard->safe);
#endif
}

/* Age of the last confirmation of the speed by the safe channel; 0 without such a channel. */
static int64_t unconfirmed_ns(const railhil_guard_t *guard, int64_t now_ns)
{
#if RAILHIL_SAFE
    return railhil_safe_age_ns(&guard->safe, now_ns);
#else
    (void)guard;
    (void)now_ns;
    return 0;
#endif
}

static int may_leave(int level, int good_run, int standstill)
{
    switch (level) {
    case RAILHIL_EMERGENCY:
        return 0; /* never in a run */
    case RAILHIL_SERVICE_BRAKE:
        return standstill || good_run >= GOOD_AFTER_SERVICE_BRAKE;
    case RAILHIL_TRACTION_CUT:
        return good_run >= GOOD_AFTER_TRACTION_CUT;
    default:
        return good_run >= 1;
    }
}

/* Evaluates the ladder: after every telegram, and before every notch. */
static void look(railhil_guard_t *guard, int64_t now_ns, seen_t seen)
{
    railhil_watch_t *watch = &guard->watch;
    const int64_t heard_ns = railhil_greater(now_ns - watch->accepted_ns, 0);
    const int64_t confirmed_ns = unconfirmed_ns(guard, now_ns);
    const int64_t age_ms = railhil_greater(heard_ns, confirmed_ns) / NS_PER_MS;
    const int standstill = watch->speed_known && watch->speed_01mmps == 0;
    const int before = watch->level;
    int demanded = RAILHIL_NORMAL;
    int cause = RAILHIL_CAUSE_NONE;
    int bad_count = 0;
    unsigned recent;
    if (seen != NO_TELEGRAM) {
        watch->recent = ((watch->recent << 1) | (seen == BAD_TELEGRAM ? 1u : 0u)) & RECENT_MASK;
    }
    for (recent = watch->recent; recent != 0; recent &= recent - 1u) {
        bad_count++;
    }
    if (seen == BAD_TELEGRAM || age_ms > RAILHIL_HOLD_MS) {
        watch->good_run = 0;
    } else if (seen == GOOD_TELEGRAM && watch->good_run < GOOD_AFTER_SERVICE_BRAKE) {
        watch->good_run++;
    }
    if (watch->speed_known && watch->limit_known &&
        watch->speed_01mmps > watch->limit_01mmps + RAILHIL_OVERSPEED_MARGIN_01MMPS) {
        demanded = RAILHIL_EMERGENCY;
        cause = RAILHIL_CAUSE_OVERSPEED;
    } else if (age_ms > RAILHIL_EMERGENCY_MS && !standstill) {
        demanded = RAILHIL_EMERGENCY;
        cause = RAILHIL_CAUSE_SPEED_AGE;
    } else if (age_ms > RAILHIL_SERVICE_BRAKE_MS) {
        demanded = RAILHIL_SERVICE_BRAKE;
        cause = RAILHIL_CAUSE_SPEED_AGE;
    } else if (railhil_position_lost(&guard->odometer, now_ns)) {
        demanded = RAILHIL_SERVICE_BRAKE;
        cause = RAILHIL_CAUSE_POSITION_LOST;
    } else if (age_ms > RAILHIL_TRACTION_CUT_MS) {
        demanded = RAILHIL_TRACTION_CUT;
        cause = RAILHIL_CAUSE_SPEED_AGE;
    } else if (seen == BAD_TELEGRAM && bad_count >= BAD_FOR_TRACTION_CUT) {
        demanded = RAILHIL_TRACTION_CUT;
        cause = RAILHIL_CAUSE_BAD_TELEGRAMS;
    } else if (age_ms > RAILHIL_HOLD_MS) {
        demanded = RAILHIL_HOLD;
        cause = RAILHIL_CAUSE_SPEED_AGE;
    } else if (seen == BAD_TELEGRAM) {
        demanded = RAILHIL_HOLD;
        cause = RAILHIL_CAUSE_BAD_TELEGRAMS;
    }
    if (may_leave(before, watch->good_run, standstill)) {
        watch->level = RAILHIL_NORMAL;
    }
    if (demanded > watch->level) {
        watch->level = demanded;
    }
    if (watch->level != before) {
        watch->cause = cause == RAILHIL_CAUSE_SPEED_AGE && confirmed_ns > heard_ns ? RAILHIL_CAUSE_SAFETY_CODE : cause;
    }
    if (watch->level == RAILHIL_TRACTION_CUT && before != RAILHIL_TRACTION_CUT) {
        watch->kept_code = watch->code < 0 ? watch->code : 0;
    }
}

void railhil_speed(railhil_guard_t *guard, int64_t now_ns, const unsigned char *process, uint32_t *counts)
{
    railhil_watch_t *watch = &guard->watch;
    const int life = process[3] & 0xF;
    const railhil_life_t judged = railhil_life(watch->life, life);
    const uint32_t raw = (railhil_get16(process) << 8) | process[2];
    const int32_t speed_01mmps = (int32_t)(raw ^ UINT32_C(0x800000)) - INT32_C(0x800000);
    if (judged == RAILHIL_REPEATED || judged == RAILHIL_OLD) {
        /* Nothing new: the age of the speed keeps growing. */
        counts[judged == RAILHIL_OLD ? RAILHIL_SPEED_OUT_OF_ORDER : RAILHIL_SPEED_DUPLICATE]++;
        look(guard, now_ns, NO_TELEGRAM);
        return;
    }
    if (judged == RAILHIL_GAP) {
        counts[RAILHIL_SPEED_GAP]++;
    }
    watch->life = life;
    if (process[3] >> 6 != RAILHIL_CHECK_CORRECT) {
        counts[RAILHIL_SPEED_CHECK]++;
        look(guard, now_ns, BAD_TELEGRAM);
    } else if (speed_01mmps < 0 || speed_01mmps > SPEED_MAX_01MMPS) {
        counts[RAILHIL_SPEED_OUT_OF_RANGE]++;
        look(guard, now_ns, BAD_TELEGRAM);
    } else {
        watch->speed_known = 1;
        watch->speed_01mmps = speed_01mmps;
        watch->accepted_ns = now_ns;
        railhil_odometer_speed(&guard->odometer, speed_01mmps, now_ns);
        look(guard, now_ns, GOOD_TELEGRAM);
    }
}

void railhil_track(railhil_guard_t *guard, const unsigned char *process)
{
    if (((process[15] >> 4) & 3) == RAILHIL_CHECK_CORRECT) {
        guard->watch.limit_known = 1;
        guard->watch.limit_01mmps = (int32_t)railhil_get16(process + 6) * 40; /* 4 mm/s */
    }
}

int32_t railhil_watched_notch(railhil_guard_t *guard, int64_t now_ns, int32_t law_code)
{
    railhil_watch_t *watch = &guard->watch;
    const int64_t elapsed_ms = railhil_floored(now_ns - watch->sent_ns, NS_PER_MS);
    const int64_t ramp = railhil_floored(RAILHIL_RAMP_CODE_PER_S * elapsed_ms, 1000);
    const int64_t last = watch->code;
    int returning;
    int64_t code;
    look(guard, now_ns, NO_TELEGRAM);
    returning = watch->returning || watch->level >= RAILHIL_TRACTION_CUT;
    switch (watch->level) {
    case RAILHIL_EMERGENCY:
        code = -RAILHIL_FULL_CODE;
        break;
    case RAILHIL_SERVICE_BRAKE:
        /* A notch of the law, or one kept from before, that brakes harder than the service brake is not released.
         * Traction is cut before the ramp starts, since this level may follow any other directly. */
        code = railhil_lesser(last, 0);
        code = railhil_lesser(railhil_lesser(law_code, railhil_greater(-RAILHIL_SERVICE_CODE, code - ramp)), code);
        break;
    case RAILHIL_TRACTION_CUT:
        code = railhil_lesser(law_code, watch->kept_code);
        break;
    case RAILHIL_HOLD:
        code = last < 0 ? last : railhil_lesser(railhil_greater(law_code, 0), last);
        break;
    default:
        /* After a level above HOLD the notch returns on the ramp, so that the brake release never jumps to traction. */
        code = returning ? railhil_lesser(law_code, last + ramp) : law_code;
        returning = code < law_code;
        break;
    }
    watch->returning = returning;
    watch->sent_ns = now_ns;
    watch->code = (int32_t)railhil_within(code, RAILHIL_FULL_CODE);
    return watch->code;
}
