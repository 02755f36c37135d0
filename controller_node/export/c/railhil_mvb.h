/* MVB telegrams on CAN frames: check sequences, parts of a telegram, life signs. Independent of the CAN driver.
 *
 * A telegram of 2 or 4 bytes is one CAN frame on its address (CS: check sequence, of the data and of the master word):
 *
 *     0   1   2   3    4     5    6     7
 *   +---------------+-----+---------+-------+
 *   |     data      | CS  | master  | CS of |      2 bytes of data: bytes 2 and 3 are 0
 *   |               |     |  word   | master|
 *   +---------------+-----+---------+-------+
 *
 * A longer one is sent as its 64-bit blocks on address + 0, 1, ... followed by the trailer on address + 4:
 *
 *     0     1     2     3      4         5    6     7
 *   +-----+-----+-----+-----+--------+---------+-------+
 *   | CS0 | CS1 | CS2 | CS3 | seq |n | master  | CS of |      n: number of blocks, seq: counts telegrams;
 *   |     |     |     |     |  4  |4 |  word   | master|      unused check sequences are 0
 *   +-----+-----+-----+-----+--------+---------+-------+
 *
 * Check sequence: remainder of x^7 + x^6 + x^5 + x^2 + 1, even parity over data and remainder, all of it inverted
 * (IEC 61375-3-1). An octet is an unsigned char with a value of 0..255, also on a chip without an 8-bit type.
 */
#ifndef RAILHIL_MVB_H
#define RAILHIL_MVB_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { RAILHIL_BLOCK = 8, RAILHIL_BLOCKS_MAX = 4, RAILHIL_FRAMES_MAX = RAILHIL_BLOCKS_MAX + 1, RAILHIL_TRAILER = 4 };

/* One CAN data frame with a standard identifier. */
typedef struct {
    uint32_t can_id;
    unsigned length; /* 0..8 */
    unsigned char data[RAILHIL_BLOCK];
} railhil_frame_t;

/* One port: address (its first CAN identifier), master word (F_code << 12 | address), bytes of process data. */
typedef struct {
    uint32_t address;
    uint32_t word;
    unsigned bytes;
} railhil_port_t;

/* Receiving side of a port. */
typedef struct {
    unsigned char data[RAILHIL_BLOCKS_MAX * RAILHIL_BLOCK]; /* newest accepted telegram */
    unsigned char staged[RAILHIL_BLOCKS_MAX][RAILHIL_BLOCK];
    unsigned present; /* bit k: block k has arrived since the last trailer */
    int64_t arrived_ns[RAILHIL_BLOCKS_MAX]; /* arrival time of each block */
} railhil_sink_t;

/* Outcome of a received frame or telegram; those from RAILHIL_WRONG_LENGTH on are refusals, counted and reported. */
typedef enum {
    RAILHIL_PART,     /* a block; the telegram is not complete yet */
    RAILHIL_COMPLETE, /* the telegram is in the sink */
    RAILHIL_WRONG_LENGTH,
    RAILHIL_WRONG_CHECK_SEQUENCE,
    RAILHIL_WRONG_MASTER_WORD,
    RAILHIL_WRONG_BLOCK_COUNT,
    RAILHIL_MISSING_BLOCK,
    RAILHIL_ASSEMBLY_TIMEOUT,
    RAILHIL_MVB_OUTCOMES
} railhil_outcome_t;

static inline unsigned railhil_check_sequence(const unsigned char *data, unsigned count)
{
    unsigned remainder = 0;
    unsigned parity = 0;
    unsigned i;
    unsigned bit;
    for (i = 0; i < count; i++) {
        for (bit = 8; bit-- > 0;) {
            const unsigned one = ((unsigned)data[i] >> bit) & 1u;
            parity ^= one;
            remainder = ((remainder << 1) & 0x7Fu) ^ ((((remainder >> 6) ^ one) & 1u) != 0 ? 0x65u : 0u);
        }
    }
    for (bit = 0; bit < 7; bit++) {
        parity ^= (remainder >> bit) & 1u;
    }
    return ((remainder << 1) | parity) ^ 0xFFu;
}

/* Big-endian numbers. */
static inline void railhil_put16(unsigned char *at, uint32_t value)
{
    at[0] = (unsigned char)((value >> 8) & 0xFFu);
    at[1] = (unsigned char)(value & 0xFFu);
}

static inline uint32_t railhil_get16(const unsigned char *at)
{
    return ((uint32_t)at[0] << 8) | at[1];
}

/* Numbers of so many bits in two's complement. */
static inline int32_t railhil_signed(uint32_t raw, unsigned bits)
{
    const uint32_t sign = UINT32_C(1) << (bits - 1u);
    return (int32_t)((raw ^ sign) - sign);
}

static inline int64_t railhil_signed_wide(uint64_t raw, unsigned bits)
{
    const uint64_t sign = UINT64_C(1) << (bits - 1u);
    return (int64_t)((raw ^ sign) - sign);
}

/* Master word and its check sequence: the last three bytes of every telegram. */
static inline void railhil_put_tail(unsigned char *at, uint32_t word)
{
    railhil_put16(at, word);
    at[2] = (unsigned char)railhil_check_sequence(at, 2);
}

static inline int railhil_has_tail(const unsigned char *at, uint32_t word)
{
    unsigned char expected[3];
    railhil_put_tail(expected, word);
    return memcmp(at, expected, sizeof expected) == 0;
}

static inline unsigned railhil_blocks(const railhil_port_t *port)
{
    return port->bytes < RAILHIL_BLOCK ? 1u : port->bytes / RAILHIL_BLOCK;
}

/* Part of the telegram with this identifier: number of the block, RAILHIL_TRAILER, or -1 for another port. */
static inline int railhil_part(const railhil_port_t *port, uint32_t can_id)
{
    const uint32_t offset = can_id - port->address;
    if (offset < railhil_blocks(port)) {
        return (int)offset;
    }
    return offset == RAILHIL_TRAILER && port->bytes >= RAILHIL_BLOCK ? RAILHIL_TRAILER : -1;
}

/* Takes one frame of a port. A telegram is accepted as a whole or not at all: all blocks must have arrived since the
 * last trailer, blocks and trailer within assembly_ns, and their number, the master word and every check sequence must
 * be correct. A repeated block replaces the earlier one and its time, so blocks left over from one telegram do not
 * spoil the next. */
static inline railhil_outcome_t railhil_take(const railhil_port_t *port, railhil_sink_t *sink, int part,
                                             unsigned length, const unsigned char *data, int64_t now_ns,
                                             int64_t assembly_ns)
{
    const unsigned blocks = railhil_blocks(port);
    const unsigned present = sink->present;
    int64_t first_ns = now_ns;
    int64_t last_ns = now_ns;
    unsigned k;
    if (length != RAILHIL_BLOCK) {
        return RAILHIL_WRONG_LENGTH;
    }
    if (port->bytes < RAILHIL_BLOCK) {
        if (railhil_check_sequence(data, port->bytes) != data[4]) {
            return RAILHIL_WRONG_CHECK_SEQUENCE;
        }
        if (!railhil_has_tail(data + 5, port->word)) {
            return RAILHIL_WRONG_MASTER_WORD;
        }
        memcpy(sink->data, data, port->bytes);
        return RAILHIL_COMPLETE;
    }
    if (part != RAILHIL_TRAILER) {
        memcpy(sink->staged[part], data, RAILHIL_BLOCK);
        sink->arrived_ns[part] = now_ns;
        sink->present |= 1u << part;
        return RAILHIL_PART;
    }
    sink->present = 0;
    if (present != (1u << blocks) - 1u) {
        return RAILHIL_MISSING_BLOCK;
    }
    for (k = 0; k < blocks; k++) {
        first_ns = sink->arrived_ns[k] < first_ns ? sink->arrived_ns[k] : first_ns;
        last_ns = sink->arrived_ns[k] > last_ns ? sink->arrived_ns[k] : last_ns;
    }
    if (last_ns - first_ns > assembly_ns) {
        return RAILHIL_ASSEMBLY_TIMEOUT;
    }
    if ((data[4] & 0xFu) != blocks) {
        return RAILHIL_WRONG_BLOCK_COUNT;
    }
    if (!railhil_has_tail(data + 5, port->word)) {
        return RAILHIL_WRONG_MASTER_WORD;
    }
    for (k = 0; k < blocks; k++) {
        if (railhil_check_sequence(sink->staged[k], RAILHIL_BLOCK) != data[k]) {
            return RAILHIL_WRONG_CHECK_SEQUENCE;
        }
    }
    memcpy(sink->data, sink->staged, port->bytes);
    return RAILHIL_COMPLETE;
}

/* Writes the frames of one telegram; returns their number. sequence: 4-bit counter of the port, incremented. */
static inline unsigned railhil_frames(const railhil_port_t *port, const unsigned char *process, unsigned *sequence,
                                      railhil_frame_t *frames)
{
    const unsigned blocks = railhil_blocks(port);
    railhil_frame_t *last = &frames[port->bytes < RAILHIL_BLOCK ? 0 : blocks];
    unsigned k;
    memset(last->data, 0, sizeof last->data);
    if (port->bytes < RAILHIL_BLOCK) {
        last->can_id = port->address;
        memcpy(last->data, process, port->bytes);
        last->data[4] = (unsigned char)railhil_check_sequence(process, port->bytes);
    } else {
        for (k = 0; k < blocks; k++) {
            frames[k].can_id = port->address + k;
            frames[k].length = RAILHIL_BLOCK;
            memcpy(frames[k].data, process + RAILHIL_BLOCK * k, RAILHIL_BLOCK);
            last->data[k] = (unsigned char)railhil_check_sequence(frames[k].data, RAILHIL_BLOCK);
        }
        last->can_id = port->address + RAILHIL_TRAILER;
        last->data[4] = (unsigned char)((*sequence << 4) | blocks);
        *sequence = (*sequence + 1u) & 0xFu;
    }
    last->length = RAILHIL_BLOCK;
    railhil_put_tail(last->data + 5, port->word);
    return (unsigned)(last - frames) + 1u;
}

/* Life sign: the 4-bit counter by which a sink distinguishes fresh, repeated and old telegrams. last: -1 before the
 * first. */
typedef enum { RAILHIL_FRESH, RAILHIL_GAP, RAILHIL_REPEATED, RAILHIL_OLD } railhil_life_t;

enum { RAILHIL_LIFE_STEP_MAX = 7 };

static inline railhil_life_t railhil_life(int last, int life)
{
    const unsigned step = (unsigned)(life - last) & 0xFu;
    if (last < 0 || step == 1) {
        return RAILHIL_FRESH;
    }
    if (step == 0) {
        return RAILHIL_REPEATED;
    }
    return step <= RAILHIL_LIFE_STEP_MAX ? RAILHIL_GAP : RAILHIL_OLD;
}

#endif
