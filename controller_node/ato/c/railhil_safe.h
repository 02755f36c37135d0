/* Safe channel (SDTv2, IEC 61375-2-3 annex B): SPEED_SDT must confirm every speed, NOTCH_SDT repeats every command. Only
 * in scenarios with safety.sdt; the constants are in @LAW@_node.h. Integers only.
 *
 * A safe telegram has 16 octets: data (10), version of the data, sequence counter, CRC-32 seeded with the identity of the
 * source. One source per port, so there is no guard time of a switch-over.
 */
#ifndef RAILHIL_SAFE_H
#define RAILHIL_SAFE_H

#include "railhil_clock.h"

#include "@LAW@_node.h"

#if RAILHIL_SAFE

/* Octets of both safe telegrams, and those before the code. */
enum { RAILHIL_SAFE_BYTES = RAILHIL_SPEED_SDT_BYTES, RAILHIL_SAFE_BODY = RAILHIL_SAFE_BYTES - 4 };

/* Verdicts on a cycle, the worst first. */
enum { RAILHIL_SAFE_ERROR, RAILHIL_SAFE_INVALID, RAILHIL_SAFE_FRESH };

/* Telegrams that confirmed nothing, by cause; counted from the first of them on, which is passed to the functions. */
enum {
    RAILHIL_SAFE_CRC,             /* damaged, or of another source */
    RAILHIL_SAFE_VERSION,         /* of the user data */
    RAILHIL_SAFE_DUPLICATE,       /* sequence counter unchanged */
    RAILHIL_SAFE_OUT_OF_SEQUENCE, /* sequence counter too far ahead, or behind */
    RAILHIL_SAFE_CHANNEL,         /* a second CRC error too soon */
    RAILHIL_SAFE_TIME,            /* not of the present */
    RAILHIL_SAFE_DIFFERS,         /* another speed than TRN_SPEED */
    RAILHIL_SAFE_CAUSES
};

typedef struct {
    int64_t cycle_ns;     /* time of the last telegram */
    int64_t confirmed_ns; /* time of the last one that confirmed a speed */
    int64_t told_tick;    /* time of the train at that moment */
    unsigned char stuck[RAILHIL_SAFE_BYTES];   /* the last duplicate: it does not initialise the channel */
    unsigned char damaged[RAILHIL_SAFE_BYTES]; /* telegram with which the monitored interval began */
    int32_t monitored;                         /* telegrams left of that interval */
    int32_t cycles;                            /* since the last fresh telegram */
    int is_stuck;
    int initial;
    int failed; /* the channel has failed within the interval */
    int verdict;
    unsigned ssc;
    unsigned sent_ssc; /* of the next NOTCH_SDT */
} railhil_safe_t;

static inline void railhil_safe_init(railhil_safe_t *safe)
{
    memset(safe, 0, sizeof *safe);
    safe->initial = 1;
    safe->cycles = RAILHIL_SAFE_RXSAFE;
}

static inline uint32_t railhil_safe_code(const unsigned char *data, unsigned count, uint32_t seed)
{
    uint32_t code = seed;
    unsigned i;
    int bit;
    for (i = 0; i < count; i++) {
        code ^= (uint32_t)data[i] << 24;
        for (bit = 0; bit < 8; bit++) {
            code = (code << 1) ^ ((code & UINT32_C(0x80000000)) != 0 ? UINT32_C(0xF4ACFB13) : 0);
        }
    }
    return code;
}

/* Writes a telegram with time, version, counter and code. */
static inline void railhil_safe_secure(railhil_safe_t *safe, railhil_notch_sdt_t *telegram, int64_t tick,
                                       unsigned char *process)
{
    telegram->tick_high = (int32_t)(((uint64_t)tick & RAILHIL_SAFE_TICK_MASK) >> RAILHIL_SAFE_TICK_LOW_BITS);
    telegram->tick_low = (int32_t)((uint64_t)tick & RAILHIL_SAFE_TICK_LOW_MASK);
    telegram->version = RAILHIL_SAFE_DATA_VERSION << 4;
    telegram->ssc = (int32_t)safe->sent_ssc;
    safe->sent_ssc = (safe->sent_ssc + 1u) & 0xFFu;
    railhil_pack_notch_sdt(telegram, process);
    telegram->code = railhil_safe_code(process, RAILHIL_SAFE_BODY, RAILHIL_SAFE_NOTCH_SID);
    railhil_pack_notch_sdt(telegram, process);
}

/* Why a telegram is not used; RAILHIL_SAFE_CAUSES: it is. */
static inline int railhil_safe_refused(railhil_safe_t *safe, const unsigned char *process, uint32_t *counts)
{
    const railhil_speed_sdt_t telegram = railhil_unpack_speed_sdt(process);
    const unsigned ssc = (unsigned)telegram.ssc;
    if (railhil_safe_code(process, RAILHIL_SAFE_BODY, RAILHIL_SAFE_SPEED_SID) != telegram.code) {
        const int other = safe->monitored != 0 && memcmp(process, safe->damaged, RAILHIL_SAFE_BYTES) != 0;
        if (other) {
            safe->failed = 1;
            counts[RAILHIL_SAFE_CHANNEL]++;
        }
        if (other || (safe->monitored == 0 && !safe->initial)) {
            safe->monitored = RAILHIL_SAFE_CMTHR;
            memcpy(safe->damaged, process, RAILHIL_SAFE_BYTES);
        }
        return RAILHIL_SAFE_CRC;
    }
    if (telegram.version >> 4 != RAILHIL_SAFE_DATA_VERSION) {
        return RAILHIL_SAFE_VERSION;
    }
    if (safe->initial) {
        if (safe->is_stuck && memcmp(process, safe->stuck, RAILHIL_SAFE_BYTES) == 0) {
            return RAILHIL_SAFE_DUPLICATE;
        }
    } else if (ssc == safe->ssc) {
        safe->is_stuck = 1;
        memcpy(safe->stuck, process, RAILHIL_SAFE_BYTES);
        return RAILHIL_SAFE_DUPLICATE;
    } else if (((ssc - safe->ssc) & 0xFFu) > RAILHIL_SAFE_RXSAFE + 1) {
        return RAILHIL_SAFE_OUT_OF_SEQUENCE;
    }
    safe->ssc = ssc;
    return RAILHIL_SAFE_CAUSES;
}

/* The sink's verdict on one cycle; process: NULL if no telegram has come. */
static inline int railhil_safe_judge(railhil_safe_t *safe, const unsigned char *process, uint32_t *counts)
{
    int cause = RAILHIL_SAFE_CAUSES;
    if (safe->cycles < RAILHIL_SAFE_RXSAFE) {
        safe->cycles++;
    }
    if (process != NULL) {
        cause = railhil_safe_refused(safe, process, counts);
    }
    if (process == NULL || cause != RAILHIL_SAFE_CAUSES) {
        if (cause != RAILHIL_SAFE_CAUSES) {
            counts[cause]++;
        }
        if (safe->cycles >= RAILHIL_SAFE_RXSAFE) {
            safe->initial = 1;
        }
        safe->verdict = safe->initial || safe->failed || safe->verdict == RAILHIL_SAFE_ERROR ? RAILHIL_SAFE_ERROR
                                                                                             : RAILHIL_SAFE_INVALID;
    } else if (safe->initial) {
        safe->initial = 0;
        safe->cycles = 1;
        safe->verdict = safe->verdict == RAILHIL_SAFE_ERROR ? RAILHIL_SAFE_ERROR : RAILHIL_SAFE_INVALID;
    } else {
        safe->cycles = 0;
        safe->is_stuck = 0;
        if (safe->monitored != 0) {
            safe->monitored--;
        } else {
            safe->failed = 0;
        }
        safe->verdict = safe->failed ? RAILHIL_SAFE_ERROR : RAILHIL_SAFE_FRESH;
    }
    return safe->verdict;
}

/* Takes a SPEED_SDT. speed_01mmps: accepted from TRN_SPEED at the same instant, if speed_known. */
static inline void railhil_safe_speed(railhil_safe_t *safe, const railhil_clock_t *clock, const unsigned char *process,
                                      int speed_known, int32_t speed_01mmps, uint32_t *counts)
{
    const int64_t now_ns = railhil_own_ns(clock);
    const int64_t cycles = railhil_floored(now_ns - safe->cycle_ns, RAILHIL_SAFE_PERIOD_NS);
    int64_t missed;
    const railhil_speed_sdt_t telegram = railhil_unpack_speed_sdt(process);
    const uint32_t tick = (uint32_t)telegram.tick_high << RAILHIL_SAFE_TICK_LOW_BITS | (uint32_t)telegram.tick_low;
    const uint32_t off = (tick - (uint32_t)((uint64_t)clock->tick & RAILHIL_SAFE_TICK_MASK)) & RAILHIL_SAFE_TICK_MASK;
    /* A telegram that comes late does not take the time of the next one. */
    safe->cycle_ns = cycles > 0 ? safe->cycle_ns + cycles * RAILHIL_SAFE_PERIOD_NS : now_ns;
    for (missed = railhil_lesser(cycles - 1, RAILHIL_SAFE_RXSAFE); missed > 0; missed--) {
        (void)railhil_safe_judge(safe, NULL, counts);
    }
    if (railhil_safe_judge(safe, process, counts) != RAILHIL_SAFE_FRESH) {
        return;
    }
    if (clock->is_set && off > RAILHIL_SAFE_LATE_TICKS && RAILHIL_SAFE_TICK_MASK + 1u - off > RAILHIL_SAFE_LATE_TICKS) {
        counts[RAILHIL_SAFE_TIME]++;
    } else if (speed_known && speed_01mmps != telegram.speed_01mmps) {
        counts[RAILHIL_SAFE_DIFFERS]++;
    } else {
        safe->confirmed_ns = now_ns;
        safe->told_tick = tick;
    }
}

/* Time without confirmation, beyond what the channel tolerates. */
static inline int64_t railhil_safe_age_ns(const railhil_safe_t *safe, int64_t now_ns)
{
    return railhil_greater(now_ns - safe->confirmed_ns - RAILHIL_SAFE_RXSAFE * RAILHIL_SAFE_PERIOD_NS, 0);
}

#endif

#endif
