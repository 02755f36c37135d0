/* Acceptance of speeds, and the reaction ladder: see railhil_guard.h. */
#include "railhil_guard.h"

#include "@LAW@_node.h"

#define NS_PER_MS INT64_C(1000000)
#define NS_PER_S INT64_C(1000000000)
#define POLL_NS (RAILHIL_NOTCH_TICKS * RAILHIL_BASE_TICK_NS)
/* The last telegrams, a bit each. */
#define RECENT_MASK ((1u << RAILHIL_RECENT) - 1u)

/* What a check other than the telegrams' demands. */
typedef struct {
    int level;
    int cause;
} finding_t;

static const finding_t no_finding = {RAILHIL_WATCH_LEVEL_NORMAL, RAILHIL_CTL_CAUSE_NONE};

typedef enum { NO_TELEGRAM, GOOD_TELEGRAM, BAD_TELEGRAM, IMPLAUSIBLE_TELEGRAM } seen_t;

void railhil_guard_init(railhil_guard_t *guard)
{
    memset(guard, 0, sizeof *guard);
    guard->odometer.life = guard->watch.life = guard->watch.track_life = -1;
    guard->odometer.run = RAILHIL_GOOD_POSITIONS;
    guard->latency.doubt = 1;
    guard->watch.sample_ns = -RAILHIL_SAMPLE_MS * NS_PER_MS;
    guard->watch.emergency = RAILHIL_FLAG_FALSE;
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

/* Age of the last accepted speed, in ms; before the first it counts from the beginning. */
static int64_t speed_age_ms(const railhil_guard_t *guard, int64_t now_ns)
{
    const int64_t heard_ns = railhil_greater(now_ns - guard->watch.accepted_ns, 0);
    return railhil_greater(heard_ns, unconfirmed_ns(guard, now_ns)) / NS_PER_MS;
}

int railhil_may_move(const railhil_guard_t *guard, int64_t now_ns)
{
    return guard->watch.speed_01mmps != 0 || speed_age_ms(guard, now_ns) > RAILHIL_SERVICE_BRAKE_MS;
}

static int may_leave(int level, int good_run, int standstill)
{
    switch (level) {
    case RAILHIL_WATCH_LEVEL_EMERGENCY:
        return 0; /* never in a run */
    case RAILHIL_WATCH_LEVEL_SERVICE_BRAKE:
        return standstill || good_run >= RAILHIL_GOOD_AFTER_SERVICE_BRAKE;
    case RAILHIL_WATCH_LEVEL_TRACTION_CUT:
        return good_run >= RAILHIL_GOOD_AFTER_TRACTION_CUT;
    default:
        return good_run >= 1;
    }
}

/* The level that applies the service brake, or the emergency brake. */
static int brake_level(int is_emergency)
{
    return is_emergency ? RAILHIL_WATCH_LEVEL_EMERGENCY : RAILHIL_WATCH_LEVEL_SERVICE_BRAKE;
}

/* The finding of the higher level, of equal ones that with the smaller cause. */
static finding_t stronger(finding_t one, int level, int cause)
{
    finding_t other;
    other.level = level;
    other.cause = cause;
    if (level > one.level || (level == one.level && cause < one.cause)) {
        return other;
    }
    return one;
}

/* 1 if the limit, and the grade, have not been told for so long. */
static int track_older(const railhil_guard_t *guard, int64_t now_ns, int64_t age_ns)
{
    return now_ns - guard->watch.track_ns > age_ns;
}

/* What the checks find now, and with them a finding of this telegram alone. */
static finding_t find(const railhil_guard_t *guard, int64_t now_ns, finding_t finding)
{
    const railhil_watch_t *watch = &guard->watch;
    const railhil_motion_t *motion = &guard->motion;
    const int lost = railhil_position_lost(&guard->odometer, now_ns);
    if (watch->stale) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_TRACTION_CUT, RAILHIL_CTL_CAUSE_SPEED_LATENCY);
    }
    if (watch->late > RAILHIL_OVERRUNS_MAX) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_TRACTION_CUT, RAILHIL_CTL_CAUSE_OVERRUNS);
    }
    if (watch->waits) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_SERVICE_BRAKE, RAILHIL_CTL_CAUSE_CLOCK);
    }
    if (watch->beyond) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_SERVICE_BRAKE, RAILHIL_CTL_CAUSE_POSITION_IMPLAUSIBLE);
    }
    if (motion->runaway) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_EMERGENCY, RAILHIL_CTL_CAUSE_RUNAWAY);
    } else if (motion->weak_ms != 0) {
        finding = stronger(finding, brake_level(motion->weak_ms > RAILHIL_MORE_BRAKE_MS),
                           RAILHIL_CTL_CAUSE_BRAKE_NOT_ANSWERING);
    } else if (motion->stuck || motion->off_scale) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_TRACTION_CUT, RAILHIL_CTL_CAUSE_SPEED_IMPLAUSIBLE);
    }
    if (track_older(guard, now_ns, RAILHIL_TRACK_BRAKE_NS)) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_SERVICE_BRAKE, RAILHIL_CTL_CAUSE_TRACK_AGE);
    } else if (track_older(guard, now_ns, RAILHIL_TRACK_CUT_NS)) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_TRACTION_CUT, RAILHIL_CTL_CAUSE_TRACK_AGE);
    }
    if (lost != RAILHIL_NOT_LOST) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_SERVICE_BRAKE,
                           lost == RAILHIL_LOST ? RAILHIL_CTL_CAUSE_POSITION_LOST
                                                : RAILHIL_CTL_CAUSE_POSITION_IMPLAUSIBLE);
    }
    return finding;
}

/* Evaluates the ladder: after every telegram, and before every notch. finding: of this telegram. */
static void look(railhil_guard_t *guard, int64_t now_ns, seen_t seen, finding_t finding)
{
    railhil_watch_t *watch = &guard->watch;
    const int64_t age_ms = speed_age_ms(guard, now_ns);
    const int standstill = watch->speed_known && watch->speed_01mmps == 0;
    const int before = watch->level;
    const int bad = seen == BAD_TELEGRAM || seen == IMPLAUSIBLE_TELEGRAM;
    const int refused =
        seen == IMPLAUSIBLE_TELEGRAM ? RAILHIL_CTL_CAUSE_SPEED_IMPLAUSIBLE : RAILHIL_CTL_CAUSE_BAD_TELEGRAMS;
    /* Where there are too many bad telegrams or two senders, the telegrams that tell of a standstill are doubted. */
    const int stands = standstill && watch->cause != RAILHIL_CTL_CAUSE_CHANNEL_MONITOR &&
                       watch->cause != RAILHIL_CTL_CAUSE_TWO_SOURCES;
    int demanded = RAILHIL_WATCH_LEVEL_NORMAL;
    int cause = RAILHIL_CTL_CAUSE_NONE;
    int bad_count = 0;
    int counts;
    unsigned recent;
    if (seen != NO_TELEGRAM) {
        watch->recent = ((watch->recent << 1) | (bad ? 1u : 0u)) & RECENT_MASK;
    }
    for (recent = watch->recent; recent != 0; recent &= recent - 1u) {
        bad_count++;
    }
    finding = find(guard, now_ns, finding);
    if (bad || finding.level != RAILHIL_WATCH_LEVEL_NORMAL || age_ms > RAILHIL_HOLD_MS) {
        watch->good_run = 0;
    } else if (seen == GOOD_TELEGRAM && watch->good_run < RAILHIL_GOOD_AFTER_SERVICE_BRAKE) {
        watch->good_run++;
    }
    /* A standstill ends the service brake, not the cut for bad telegrams. */
    counts = bad || (before == RAILHIL_WATCH_LEVEL_SERVICE_BRAKE &&
                     watch->good_run < RAILHIL_GOOD_AFTER_TRACTION_CUT);
    if (age_ms > RAILHIL_SERVICE_BRAKE_MS) {
        demanded = brake_level(age_ms > RAILHIL_EMERGENCY_MS && !standstill);
        cause = RAILHIL_CTL_CAUSE_SPEED_AGE;
    } else if (age_ms > RAILHIL_TRACTION_CUT_MS) {
        demanded = RAILHIL_WATCH_LEVEL_TRACTION_CUT;
        cause = RAILHIL_CTL_CAUSE_SPEED_AGE;
    } else if (counts && bad_count >= RAILHIL_BAD_FOR_TRACTION_CUT) {
        demanded = RAILHIL_WATCH_LEVEL_TRACTION_CUT;
        cause = refused;
    } else if (age_ms > RAILHIL_HOLD_MS) {
        demanded = RAILHIL_WATCH_LEVEL_HOLD;
        cause = RAILHIL_CTL_CAUSE_SPEED_AGE;
    } else if (bad) {
        demanded = RAILHIL_WATCH_LEVEL_HOLD;
        cause = refused;
    }
    if (finding.level > demanded) {
        demanded = finding.level;
        cause = finding.cause;
    }
    if (watch->speed_known && watch->limit_known &&
        watch->speed_01mmps > watch->limit_01mmps + RAILHIL_OVERSPEED_MARGIN_01MMPS) {
        demanded = RAILHIL_WATCH_LEVEL_EMERGENCY;
        cause = RAILHIL_CTL_CAUSE_OVERSPEED;
    }
    if (may_leave(before, watch->good_run, stands)) {
        watch->level = RAILHIL_WATCH_LEVEL_NORMAL;
    }
    if (demanded > watch->level) {
        watch->level = demanded;
    }
    if (watch->level != before) {
        const int unconfirmed = unconfirmed_ns(guard, now_ns) > railhil_greater(now_ns - watch->accepted_ns, 0);
        watch->cause = cause == RAILHIL_CTL_CAUSE_SPEED_AGE && unconfirmed ? RAILHIL_CTL_CAUSE_SAFETY_CODE : cause;
    }
    if (watch->level == RAILHIL_WATCH_LEVEL_TRACTION_CUT && before != RAILHIL_WATCH_LEVEL_TRACTION_CUT) {
        watch->kept_code = watch->code < 0 ? watch->code : 0;
    }
}

/* A telegram that is not used; too many of them brake. */
static void refuse(railhil_guard_t *guard, int64_t now_ns, seen_t seen)
{
    finding_t finding = no_finding;
    const int64_t now_ms = railhil_floored(now_ns, NS_PER_MS);
    const int64_t limit = RAILHIL_CHANNEL_WINDOW_MS * RAILHIL_CHANNEL_BAD_MAX;
    if (railhil_debt_add(&guard->channel, now_ms, RAILHIL_CHANNEL_WINDOW_MS, limit, RAILHIL_CHANNEL_BAD_MAX)) {
        finding = stronger(finding, RAILHIL_WATCH_LEVEL_SERVICE_BRAKE, RAILHIL_CTL_CAUSE_CHANNEL_MONITOR);
    }
    look(guard, now_ns, seen, finding);
}

/* The checks of the motion. */
static void sample(railhil_guard_t *guard, int64_t now_ns)
{
    railhil_watch_t *watch = &guard->watch;
    const railhil_odometer_t *odometer = &guard->odometer;
    const int64_t speed = watch->speed_01mmps;
    const int64_t age_ms = railhil_floored(now_ns - odometer->fitted_ns, NS_PER_MS);
    const int has_position = age_ms >= 0 && age_ms <= RAILHIL_POSITION_AGE_MAX_MS;
    const int has_grade = watch->grade_known && !track_older(guard, now_ns, RAILHIL_TRACK_CUT_NS) &&
                          !track_older(guard, now_ns, RAILHIL_TRACK_BRAKE_NS);
    const int64_t position = has_position ? odometer->reading_01mm + speed * age_ms / 1000 : 0;
    watch->sample_ns = now_ns;
    watch->sample_01mmps = watch->speed_01mmps;
    railhil_sample(&guard->motion, now_ns, speed, watch->code, has_grade, watch->grade_001permil,
                   watch->changed_ns, has_position, position);
}

void railhil_speed(railhil_guard_t *guard, int64_t now_ns, const unsigned char *process, uint32_t *counts)
{
    railhil_watch_t *watch = &guard->watch;
    const railhil_trn_speed_t telegram = railhil_unpack_trn_speed(process);
    const int life = (int)telegram.life;
    const railhil_life_t judged = railhil_life(watch->life, life);
    const int32_t speed_01mmps = telegram.speed_01mmps;
    finding_t finding = no_finding;
    if (judged == RAILHIL_REPEATED || judged == RAILHIL_OLD) {
        /* Nothing new: the age of the speed keeps growing. */
        counts[judged == RAILHIL_OLD ? RAILHIL_SPEED_OUT_OF_ORDER : RAILHIL_SPEED_DUPLICATE]++;
        if (judged == RAILHIL_OLD) {
            const int64_t now_ms = railhil_floored(now_ns, NS_PER_MS);
            /* Two senders alternate; after a loss there are old ones in a row. */
            if (!guard->latency.old &&
                railhil_debt_add(&guard->disorder, now_ms, RAILHIL_DISORDER_MS, RAILHIL_DISORDER_MAX_MS, 1)) {
                finding = stronger(finding, RAILHIL_WATCH_LEVEL_SERVICE_BRAKE, RAILHIL_CTL_CAUSE_TWO_SOURCES);
            }
            guard->latency.doubt = guard->latency.old = 1;
        }
        look(guard, now_ns, NO_TELEGRAM, finding);
        return;
    }
    if (judged == RAILHIL_GAP) {
        counts[RAILHIL_SPEED_GAP]++;
    }
    watch->life = life;
    railhil_latency_received(&guard->latency, life);
    if (telegram.check != RAILHIL_CHECK_CORRECT) {
        counts[RAILHIL_SPEED_CHECK]++;
        refuse(guard, now_ns, BAD_TELEGRAM);
    } else if (speed_01mmps < 0 || speed_01mmps > RAILHIL_SPEED_MAX_01MMPS) {
        counts[RAILHIL_SPEED_OUT_OF_RANGE]++;
        refuse(guard, now_ns, BAD_TELEGRAM);
    } else if (watch->speed_known &&
               !railhil_speed_fits(speed_01mmps - watch->sample_01mmps, now_ns - watch->sample_ns)) {
        counts[RAILHIL_SPEED_JUMP]++;
        refuse(guard, now_ns, IMPLAUSIBLE_TELEGRAM);
    } else {
        if (now_ns - watch->accepted_ns >= (RAILHIL_HOLD_MS + 1) * NS_PER_MS) {
            /* A silence ends a row of good telegrams, also one between two polls. */
            watch->good_run = 0;
        }
        if (watch->speed_known && speed_01mmps != watch->speed_01mmps) {
            watch->changed_ns = now_ns;
        }
        watch->speed_known = 1;
        watch->speed_01mmps = speed_01mmps;
        watch->accepted_ns = now_ns;
        railhil_odometer_speed(&guard->odometer, speed_01mmps, now_ns);
        if (now_ns < watch->sample_ns || now_ns - watch->sample_ns >= RAILHIL_SAMPLE_MS * NS_PER_MS) {
            sample(guard, now_ns);
        }
        look(guard, now_ns, GOOD_TELEGRAM, no_finding);
    }
}

void railhil_track(railhil_guard_t *guard, int64_t now_ns, const unsigned char *process)
{
    const railhil_trk_info_t telegram = railhil_unpack_trk_info(process);
    const int has_limit = telegram.limit_check == RAILHIL_CHECK_CORRECT;
    const int has_grade = telegram.grade_check == RAILHIL_CHECK_CORRECT;
    const int life = (int)telegram.life;
    if (life == guard->watch.track_life) {
        return; /* Nothing new: its age keeps growing. */
    }
    guard->watch.track_life = life;
    if (has_limit && has_grade) {
        guard->watch.track_ns = now_ns;
    }
    if (has_limit) {
        guard->watch.limit_known = 1;
        guard->watch.limit_01mmps = telegram.speed_limit_4mmps * RAILHIL_LIMIT_01MMPS;
    }
    if (has_grade) {
        guard->watch.grade_known = 1;
        guard->watch.grade_001permil = telegram.grade_001permil;
    }
}

void railhil_look(railhil_guard_t *guard, int64_t now_ns)
{
    look(guard, now_ns, NO_TELEGRAM, no_finding);
}

void railhil_period(railhil_guard_t *guard, int late)
{
    guard->watch.late = late ? guard->watch.late + 1 : 0;
}

/* How far the ramp goes up to a time. Both ends of an interval are rounded, so that many short ones lose nothing. */
static int64_t ramp_codes(int64_t at_ns)
{
    const int64_t at_s = railhil_floored(at_ns, NS_PER_S);
    return RAILHIL_RAMP_CODE_PER_S * at_s + RAILHIL_RAMP_CODE_PER_S * (at_ns - at_s * NS_PER_S) / NS_PER_S;
}

int32_t railhil_watched_notch(railhil_guard_t *guard, int64_t now_ns, int32_t law_code)
{
    railhil_watch_t *watch = &guard->watch;
    /* The next poll is a period later at the earliest: a clock that was behind does not make the ramp steeper. */
    const int64_t ramp_ns = railhil_greater(now_ns, watch->ramp_ns != 0 ? watch->ramp_ns + POLL_NS : now_ns);
    const int64_t ramp = ramp_codes(ramp_ns) - ramp_codes(watch->ramp_ns);
    const int64_t last = watch->code;
    int returning;
    int64_t code;
    /* Before the first speed there is no life sign to compare the polls with. */
    watch->stale = watch->speed_known && railhil_latency_polled(&guard->latency);
    railhil_look(guard, now_ns);
    returning = watch->returning || watch->level >= RAILHIL_WATCH_LEVEL_TRACTION_CUT;
    switch (watch->level) {
    case RAILHIL_WATCH_LEVEL_EMERGENCY:
        code = -RAILHIL_FULL_CODE;
        break;
    case RAILHIL_WATCH_LEVEL_SERVICE_BRAKE:
        /* A notch of the law, or one kept from before, that brakes harder than the service brake is not released.
         * Traction is cut before the ramp starts, since this level may follow any other directly. */
        code = railhil_lesser(last, 0);
        code = railhil_lesser(railhil_lesser(law_code, railhil_greater(-RAILHIL_SERVICE_CODE, code - ramp)), code);
        break;
    case RAILHIL_WATCH_LEVEL_TRACTION_CUT:
        code = railhil_lesser(law_code, watch->kept_code);
        break;
    case RAILHIL_WATCH_LEVEL_HOLD:
        code = last < 0 ? last : railhil_lesser(railhil_greater(law_code, 0), last);
        break;
    default:
        /* After a level above HOLD the notch returns on the ramp, so that the brake release never jumps to traction. */
        code = returning ? railhil_lesser(law_code, last + ramp) : law_code;
        returning = code < law_code;
        break;
    }
    watch->returning = returning;
    watch->ramp_ns = ramp_ns;
    watch->code = (int32_t)railhil_within(code, RAILHIL_FULL_CODE);
    return watch->code;
}
