/* Position for the law, and balises: see railhil_position.h.
 *
 * A position is dead-reckoned from the accepted speeds and corrected towards the odometer with a time constant of 1 s.
 * A TRN_POS telegram is accepted if it fits, that is, if it differs from the reckoned position by no more than the
 * tolerance of both.
 */
#include "railhil_position.h"

#include "@LAW@_node.h"

#define NS_PER_S INT64_C(1000000000)
#define NS_PER_MS INT64_C(1000000)
/* Longer pauses are limited to this, so that no product below exceeds 64 bits. */
#define PAUSE_MAX_NS INT64_C(100000000000)
#define PLACE_MAX INT64_C(4600000000000000000)

/* a * share / whole, floored, without a product of more than 64 bits; 0 <= share <= whole <= 1e9. */
static int64_t share_of(int64_t a, int64_t share, int64_t whole)
{
    const int64_t quotient = railhil_floored(a, whole);
    return quotient * share + (a - quotient * whole) * share / whole;
}

static int64_t elapsed(int64_t since_ns, int64_t now_ns)
{
    return railhil_lesser(railhil_greater(now_ns - since_ns, 0), PAUSE_MAX_NS);
}

static int64_t tolerance(const railhil_odometer_t *odometer)
{
    if (!odometer->heard) {
        /* Nobody knows where the train is before the first telegram. */
        return RAILHIL_POSITION_MAX_01MM * NS_PER_S;
    }
    return RAILHIL_ODOMETER_EXACT + odometer->speed_01mmps * RAILHIL_HOLD_MS * NS_PER_MS + odometer->slack;
}

/* Integrates the last speed up to at_ns. If the clock was set back, it waits until the clock has caught up. */
static void reckon(railhil_odometer_t *odometer, int64_t at_ns)
{
    const int64_t step_ns = elapsed(odometer->at_ns, at_ns);
    if (step_ns == 0 || !odometer->begun) {
        return;
    }
    odometer->at_ns = at_ns;
    odometer->place = railhil_within(odometer->place + odometer->speed_01mmps * step_ns, PLACE_MAX);
    if (odometer->speed_01mmps != 0) {
        const int64_t changed_01mmps = RAILHIL_ACCEL_MAX_01MMPS2 * elapsed(odometer->speed_ns, at_ns) / NS_PER_S;
        const int64_t error_01mmps = RAILHIL_SPEED_ERROR_01MMPS + changed_01mmps;
        odometer->slack = railhil_lesser(odometer->slack + error_01mmps * step_ns, PLACE_MAX);
    }
}

void railhil_odometer_speed(railhil_odometer_t *odometer, int32_t speed_01mmps, int64_t at_ns)
{
    int64_t missing;
    if (!odometer->begun) {
        odometer->begun = 1;
        odometer->at_ns = odometer->speed_ns = odometer->fitted_ns = odometer->trusted_ns = at_ns;
        odometer->speed_01mmps = speed_01mmps;
    }
    reckon(odometer, at_ns);
    /* The speed is assumed to change linearly between two readings: half of the difference is still missing. */
    missing = railhil_floored((speed_01mmps - odometer->speed_01mmps) * elapsed(odometer->speed_ns, at_ns), 2);
    odometer->place = railhil_within(odometer->place + missing, PLACE_MAX);
    odometer->speed_01mmps = speed_01mmps;
    odometer->speed_ns = at_ns;
}

static int32_t limited_01mm(int64_t position_mm)
{
    return (int32_t)railhil_within(10 * position_mm, RAILHIL_POSITION_MAX_01MM);
}

void railhil_position(railhil_odometer_t *odometer, int64_t now_ns, const unsigned char *process, uint32_t *counts)
{
    const railhil_trn_pos_t telegram = railhil_unpack_trn_pos(process);
    const int life = (int)telegram.life;
    const railhil_life_t judged = railhil_life(odometer->life, life);
    int64_t reading_01mm;
    int64_t off;
    int64_t since_ns;
    int64_t share_ns;
    if (judged == RAILHIL_REPEATED || judged == RAILHIL_OLD) {
        counts[judged == RAILHIL_OLD ? RAILHIL_POSITION_OUT_OF_ORDER : RAILHIL_POSITION_DUPLICATE]++;
        return;
    }
    odometer->life = life;
    if (telegram.check != RAILHIL_CHECK_CORRECT) {
        counts[RAILHIL_POSITION_CHECK]++;
        odometer->run = 0;
        return;
    }
    reckon(odometer, now_ns);
    reading_01mm = railhil_within(RAILHIL_ODOMETER_01MM * telegram.odometer_mm, RAILHIL_READING_MAX_01MM);
    if (!odometer->heard || !odometer->begun) {
        /* The first telegram, or no speed was told yet: there is nothing to compare it with. */
        odometer->heard = 1;
        odometer->place = reading_01mm * NS_PER_S;
        odometer->fitted_ns = now_ns;
    }
    off = reading_01mm * NS_PER_S - odometer->place;
    if (railhil_greater(off, -off) > tolerance(odometer)) {
        counts[RAILHIL_POSITION_JUMP]++;
        odometer->run = 0;
        if (!odometer->jumped || now_ns - odometer->jumping_ns > RAILHIL_RECKONING_MAX_NS) {
            odometer->jumped = 1;
            odometer->jumped_ns = now_ns;
        }
        odometer->jumping_ns = now_ns;
        return;
    }
    since_ns = railhil_greater(now_ns - odometer->fitted_ns, 0);
    share_ns = railhil_lesser(since_ns, RAILHIL_FOLLOWING_NS);
    odometer->place += share_of(off, share_ns, RAILHIL_FOLLOWING_NS);
    odometer->slack -= share_of(odometer->slack, share_ns, RAILHIL_FOLLOWING_NS);
    if (since_ns > RAILHIL_POSITION_IN_TIME_NS + RAILHIL_HOLD_MS * NS_PER_MS) {
        /* Less may be due to the time of the node, which it tells by TRN_SPEED. */
        odometer->run = 0;
    }
    odometer->run = odometer->run < RAILHIL_GOOD_POSITIONS ? odometer->run + 1 : RAILHIL_GOOD_POSITIONS;
    odometer->reading_01mm = reading_01mm;
    odometer->fitted_ns = now_ns;
    if (odometer->run == RAILHIL_GOOD_POSITIONS) {
        odometer->trusted_ns = now_ns;
        odometer->jumped = 0;
    }
}

static int64_t reckoned_01mm(railhil_odometer_t *odometer, int64_t now_ns)
{
    reckon(odometer, now_ns);
    return railhil_within(railhil_floored(odometer->place, NS_PER_S), RAILHIL_POSITION_MAX_01MM);
}

int32_t railhil_position_01mm(railhil_odometer_t *odometer, int64_t now_ns)
{
    if (odometer->heard && odometer->run == RAILHIL_GOOD_POSITIONS &&
        now_ns - odometer->fitted_ns <= RAILHIL_POSITION_IN_TIME_NS) {
        return (int32_t)railhil_within(odometer->reading_01mm, RAILHIL_POSITION_MAX_01MM);
    }
    return (int32_t)reckoned_01mm(odometer, now_ns);
}

int railhil_position_lost(const railhil_odometer_t *odometer, int64_t now_ns)
{
    if (odometer->jumped) {
        /* To a law that needs no position a silent port says nothing, also after an inconsistent telegram. */
        const int speaks = RAILHIL_NEEDS_POSITION || now_ns - odometer->jumping_ns <= RAILHIL_POSITION_IN_TIME_NS;
        const int64_t since_ns = RAILHIL_NEEDS_POSITION ? odometer->trusted_ns : odometer->jumped_ns;
        return speaks && now_ns - since_ns > RAILHIL_RECKONING_MAX_NS ? RAILHIL_CONTRADICTED : RAILHIL_NOT_LOST;
    }
    if (RAILHIL_NEEDS_POSITION && odometer->begun && now_ns - odometer->trusted_ns > RAILHIL_RECKONING_MAX_NS) {
        return RAILHIL_LOST;
    }
    return RAILHIL_NOT_LOST;
}

/* 1 if a worn wheel explains the odometer at a balise. */
static int is_explained(int64_t surveyed_mm, int64_t passed_mm, int64_t within_mm)
{
    const int64_t off_mm = surveyed_mm - passed_mm;
    const int64_t unexplained_mm = railhil_greater(off_mm, -off_mm) - RAILHIL_BALISE_ERROR_MM - within_mm;
    return unexplained_mm * RAILHIL_WHEEL_PARTS <= railhil_greater(passed_mm, -passed_mm);
}

/* 1 if the passing may have been a multiple of 65.536 m before, but after the start of the run. */
static int may_be_earlier(int64_t surveyed_mm, int64_t passed_mm, int64_t within_mm)
{
    int64_t place_mm;
    for (place_mm = passed_mm - RAILHIL_BALISE_WORD_MM; place_mm >= -within_mm; place_mm -= RAILHIL_BALISE_WORD_MM) {
        if (is_explained(surveyed_mm, place_mm, within_mm)) {
            return 1;
        }
    }
    return 0;
}

int railhil_is_beyond(const railhil_balise_t *balise, int32_t here_01mm, int64_t place_01mm)
{
    const int64_t since_mm = railhil_floored(here_01mm, 10) - balise->sure_passed_mm;
    const int64_t least_mm = since_mm - railhil_floored(since_mm, RAILHIL_WHEEL_PARTS) - RAILHIL_BALISE_ERROR_MM;
    return balise->sure_surveyed_mm + least_mm > railhil_floored(place_01mm, 10);
}

void railhil_balise(railhil_balise_t *balise, railhil_odometer_t *odometer, int64_t now_ns,
                    const unsigned char *process, uint32_t *counts)
{
    const railhil_balise_passed_t telegram = railhil_unpack_balise_passed(process);
    const int32_t number = telegram.balise_id;
    const int32_t number_before = balise->number;
    const int64_t here_mm = railhil_floored(reckoned_01mm(odometer, now_ns), 10);
    const int64_t within_mm = tolerance(odometer) / NS_PER_S / 10 + 1;
    const int64_t surveyed_mm = telegram.surveyed_mm;
    const int first = !balise->heard;
    int64_t furthest_mm = RAILHIL_BALISE_WORD_MM - 1 - within_mm;
    int64_t behind_mm;
    if (telegram.check != RAILHIL_CHECK_CORRECT) {
        counts[RAILHIL_BALISE_CHECK]++;
        return;
    }
    if (number == 0) {
        counts[RAILHIL_BALISE_NUMBER]++;
        return;
    }
    /* The balise is behind the present position, but not behind the position at the last telegram of the port. A balise
     * under a train that has not moved was read when the train arrived. */
    if (!first && here_mm > within_mm) {
        furthest_mm = here_mm - balise->heard_mm;
    }
    balise->heard = 1;
    balise->heard_mm = here_mm - within_mm;
    balise->number = number;
    if (number == number_before || number == balise->last[0]) {
        return;
    }
    behind_mm = here_mm + within_mm - telegram.odometer_low_mm;
    behind_mm -= railhil_floored(behind_mm, RAILHIL_BALISE_WORD_MM) * RAILHIL_BALISE_WORD_MM + within_mm;
    /* The first telegram may be of a balise passed long ago: the last place is taken if it is the only one. */
    if (furthest_mm + within_mm >= RAILHIL_BALISE_WORD_MM || behind_mm > furthest_mm ||
        (first && may_be_earlier(surveyed_mm, here_mm - behind_mm, within_mm))) {
        counts[RAILHIL_BALISE_LATE]++;
        return;
    }
    balise->last[0] = number;
    balise->last[1] = limited_01mm(surveyed_mm);
    balise->last[2] = limited_01mm(here_mm - behind_mm);
    if (is_explained(surveyed_mm, here_mm - behind_mm, 0)) {
        balise->sure_surveyed_mm = surveyed_mm;
        balise->sure_passed_mm = here_mm - behind_mm;
    }
}
