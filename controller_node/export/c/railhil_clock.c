/* Simulation time: see railhil_clock.h. */
#include "railhil_clock.h"

#include "@LAW@_node.h"

#define NS_PER_S INT64_C(1000000000)

void railhil_clock_init(railhil_clock_t *clock)
{
    memset(clock, 0, sizeof *clock);
    clock->life = clock->expected = clock->sync_life = clock->ahead_life = -1;
    clock->slow_life = clock->slow_ahead_life = -1;
    clock->known_tick = -1;
}

int64_t railhil_now_ns(const railhil_clock_t *clock)
{
    return clock->tick * RAILHIL_BASE_TICK_NS;
}

int64_t railhil_own_ns(const railhil_clock_t *clock)
{
    return (clock->tick - clock->began) * RAILHIL_BASE_TICK_NS;
}

static void open_tick(railhil_clock_t *clock, int64_t tick, int life)
{
    clock->running = 1;
    clock->life = life;
    clock->frame_tick = tick;
    clock->expected = -1;
    clock->polls = 0;
    clock->tick = railhil_greater(clock->tick, tick);
}

void railhil_clock_frame(railhil_clock_t *clock, unsigned length, const unsigned char *data)
{
    const railhil_port_t *port = &railhil_ports[RAILHIL_CLOCK_PORT];
    int64_t step;
    int64_t behind;
    int life;
    if (length != RAILHIL_BLOCK || railhil_check_sequence(data, port->bytes) != data[4] ||
        !railhil_has_tail(data + 5, port->word)) {
        return;
    }
    life = railhil_clock_life(data);
    if (!clock->running) {
        open_tick(clock, 0, life);
        return;
    }
    if (clock->life < 0) {
        open_tick(clock, clock->tick + RAILHIL_CLOCK_TICKS, life);
        return;
    }
    step = (life - clock->life) & 0xF;
    if (step == 0) {
        return;
    }
    /* Of the ticks with this life sign, take the one nearest to the time derived from the polls. */
    behind = railhil_floored(clock->tick - clock->frame_tick, RAILHIL_CLOCK_TICKS) - step;
    step += 16 * railhil_floored(behind + RAILHIL_LIFE_STEP_MAX, 16);
    if (step < 0) {
        /* Either an old frame, or the whole bus was silent: a second such frame in a row decides for the latter. */
        const int confirmed = life == clock->expected;
        clock->expected = (life + 1) & 0xF;
        if (!confirmed) {
            return;
        }
        step += 16;
    }
    open_tick(clock, clock->frame_tick + step * RAILHIL_CLOCK_TICKS, life);
}

void railhil_clock_poll(railhil_clock_t *clock, int64_t period_ticks)
{
    if (!clock->running) {
        if (!RAILHIL_PACE_BEGINS) {
            return;
        }
        if (clock->polls == 0) {
            clock->polls = 1;
            return;
        }
        clock->running = 1;
    }
    if (clock->polls == 0) {
        clock->poll_tick = (clock->frame_tick + period_ticks - 1) / period_ticks * period_ticks;
    }
    clock->tick = railhil_greater(clock->tick, clock->poll_tick + clock->polls * period_ticks);
    clock->polls++;
}

void railhil_clock_elapsed(railhil_clock_t *clock, int64_t elapsed_ns)
{
    int64_t ticks;
    if (!clock->running) {
        return;
    }
    if (clock->known_tick < 0) {
        clock->known_tick = clock->tick;
        clock->spare_ns = 0;
    }
    clock->spare_ns += elapsed_ns;
    ticks = railhil_floored(clock->spare_ns, RAILHIL_BASE_TICK_NS);
    clock->spare_ns -= ticks * RAILHIL_BASE_TICK_NS;
    clock->tick += ticks;
}

void railhil_clock_slow(railhil_clock_t *clock, int life)
{
    const int64_t own_tick = clock->tick - clock->began;
    const int64_t turn = 16 * RAILHIL_CLOCK_TICKS;
    const int64_t slow_turn = 16 * RAILHIL_SLOW_TICKS;
    /* A period before the silence and two after it, and what the clock port tells of it. */
    const int64_t soon = 3 * RAILHIL_SLOW_TICKS + turn;
    const int64_t since = own_tick - clock->slow_tick;
    const int before_life = clock->slow_ahead_life;
    int64_t ahead;
    if (clock->slow_life < 0) {
        clock->slow_life = life;
        clock->slow_tick = own_tick;
        return;
    }
    ahead = (life - clock->slow_life) * RAILHIL_SLOW_TICKS - since;
    ahead -= railhil_floored(ahead, slow_turn) * slow_turn;
    clock->slow_ahead_life = -1;
    if (ahead == 0) {
        clock->slow_life = life;
        clock->slow_tick = own_tick;
    } else if (since <= soon && ahead < slow_turn - soon && ahead % turn == 0) {
        if (before_life >= 0 && ahead == clock->slow_ahead && life == ((before_life + 1) & 0xF)) {
            railhil_clock_elapsed(clock, ahead * RAILHIL_BASE_TICK_NS);
            clock->slow_life = life;
            clock->slow_tick = own_tick + ahead;
        } else {
            clock->slow_ahead_life = life;
            clock->slow_ahead = ahead;
        }
    }
}

/* Why a TIME_SYNC is refused; 0: it is not. */
static unsigned implausible(railhil_clock_t *clock, const railhil_time_sync_t *telegram, int64_t off)
{
    const int64_t near_ticks = RAILHIL_LIFE_STEP_MAX * RAILHIL_CLOCK_TICKS;
    const int life = (int)telegram->life;
    const railhil_life_t judged = railhil_life(clock->sync_life, life);
    const int confirming = clock->ahead_life >= 0 && life == ((clock->ahead_life + 1) & 0xF) &&
                           off - clock->ahead_ticks <= near_ticks && off - clock->ahead_ticks >= -near_ticks;
    if (telegram->check != RAILHIL_CHECK_CORRECT) {
        return RAILHIL_TIME_CHECK;
    }
    if (off > near_ticks) {
        /* Nothing is repeated from the future: after a long silence the order of the life signs says nothing. */
        clock->ahead_life = confirming ? -1 : life;
        clock->ahead_ticks = off;
        return confirming ? 0 : RAILHIL_TIME_AHEAD;
    }
    if (judged == RAILHIL_REPEATED || judged == RAILHIL_OLD) {
        return judged == RAILHIL_OLD ? RAILHIL_TIME_OUT_OF_ORDER : RAILHIL_TIME_DUPLICATE;
    }
    clock->ahead_life = -1;
    if (off < 0) {
        /* Only an estimate is taken back, and never to before the silence. */
        return clock->known_tick >= 0 && clock->known_tick < clock->tick + off ? 0 : RAILHIL_TIME_BACKWARD;
    }
    return 0;
}

int railhil_time_sync(railhil_clock_t *clock, const unsigned char *process, uint32_t *counts)
{
    const railhil_time_sync_t telegram = railhil_unpack_time_sync(process);
    const int64_t fraction_ns = telegram.fraction_65536th_s * NS_PER_S / RAILHIL_FRACTIONS_PER_S;
    const int64_t now_ns = (int64_t)telegram.seconds_s * NS_PER_S + fraction_ns;
    const int64_t tick = (now_ns + RAILHIL_BASE_TICK_NS / 2) / RAILHIL_BASE_TICK_NS;
    const int64_t off = tick - clock->tick;
    const unsigned cause = implausible(clock, &telegram, off);
    /* If only clock frames have been missing, since before the last poll, their count continues. */
    const int known = clock->life >= 0 && clock->polls > 0 &&
                      railhil_greater(off, -off) <= RAILHIL_LIFE_STEP_MAX * RAILHIL_CLOCK_TICKS;
    if (cause != 0) {
        counts[cause]++;
        return 0;
    }
    clock->sync_life = (int)telegram.life;
    clock->known_tick = -1;
    if (!clock->is_set && off > RAILHIL_LIFE_STEP_MAX * RAILHIL_CLOCK_TICKS) {
        clock->began = off;
    }
    clock->is_set = 1;
    if (off == 0 && clock->running) {
        return 1;
    }
    clock->running = 1;
    clock->tick = tick;
    if (!known) {
        clock->frame_tick = tick;
        clock->life = clock->expected = -1;
        clock->polls = 0;
    }
    return 1;
}
