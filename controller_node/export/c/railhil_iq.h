/* Fixed-point arithmetic of the TMS320F28335 for exported control laws.
 *
 * The functions iq_* compute in int64_t and give the same 32 bits on every compiler: gcc, clang, cl2000. The names
 * _IQNmpy, _IQNdiv, ... are those of the IQmath library. On the target they come from the library's own header,
 * elsewhere they are macros for the functions here. RAILHIL_USE_TI_IQMATH selects: 1 is the default on the target;
 * 0 uses the functions here on the target too (slower, but bit-equal to the host in divisions and roots as well).
 *
 * Semantics: TI IQmath user's guide V1.70 (C28x). Products are 64 bits wide and floored; nothing saturates unless
 * stated. A division is the exact quotient rounded to nearest, saturated, x / 0 = 0x7FFFFFFF; TI's own routine
 * differs from it by at most 7 LSB of 2^31 at full scale. No floating point, no memory allocation, no recursion.
 *
 * Required of the compiler beyond C99: a right shift of a negative number is arithmetic, and a conversion to int32_t
 * keeps the low 32 bits. gcc, clang and cl2000 document both.
 */
#ifndef RAILHIL_IQ_H
#define RAILHIL_IQ_H

#include <stdint.h>

#ifndef RAILHIL_USE_TI_IQMATH
#ifdef __TMS320C28XX__
#define RAILHIL_USE_TI_IQMATH 1
#else
#define RAILHIL_USE_TI_IQMATH 0
#endif
#endif

/* Counters since the caller zeroed them: saturations of format limits, products and quotients; divisions by 0. */
typedef struct {
    uint32_t saturations;
    uint32_t zero_divisions;
} iq_events_t;

/* Low 32 bits. */
static inline int32_t iq_low(int64_t exact)
{
    return (int32_t)(uint32_t)(uint64_t)exact;
}

static inline int32_t iq_saturated(int64_t exact)
{
    return exact > INT32_MAX ? INT32_MAX : exact < INT32_MIN ? INT32_MIN : (int32_t)exact;
}

/* a + b, a - b, -a and the absolute value of a, wrapping; -INT32_MIN and its absolute value are INT32_MIN. */
static inline int32_t iq_add(int32_t a, int32_t b)
{
    return (int32_t)((uint32_t)a + (uint32_t)b);
}

static inline int32_t iq_sub(int32_t a, int32_t b)
{
    return (int32_t)((uint32_t)a - (uint32_t)b);
}

static inline int32_t iq_neg(int32_t a)
{
    return iq_sub(0, a);
}

static inline int32_t iq_abs(int32_t a)
{
    return a < 0 ? iq_neg(a) : a;
}

/* Conversion to another format: left shifts wrap, right shifts floor; count 0..31. */
static inline int32_t iq_shl(int32_t a, int count)
{
    return (int32_t)((uint32_t)a << count);
}

static inline int32_t iq_shr(int32_t a, int count)
{
    return a >> count;
}

static inline int32_t iq_min(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t iq_max(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static inline int32_t iq_sat(int32_t a, int32_t upper, int32_t lower)
{
    /* Same order as on the chip: if upper < lower, the result is lower. */
    return iq_max(iq_min(a, upper), lower);
}

/* Products, shifted right by q: floored, or rounded with ties upward (q >= 1). */
static inline int32_t iq_mpy(int32_t a, int32_t b, int q)
{
    return iq_low(((int64_t)a * b) >> q);
}

static inline int64_t iq_rounded_product(int32_t a, int32_t b, int q)
{
    return ((int64_t)a * b + ((int64_t)1 << (q - 1))) >> q;
}

static inline int32_t iq_rmpy(int32_t a, int32_t b, int q)
{
    return iq_low(iq_rounded_product(a, b, q));
}

static inline int32_t iq_rsmpy(int32_t a, int32_t b, int q)
{
    return iq_saturated(iq_rounded_product(a, b, q));
}

/* Product of a number in Q q_a and one in Q q_b, in Q q; |q_a + q_b - q| <= 63. */
static inline int32_t iq_mpy_iqx(int32_t a, int q_a, int32_t b, int q_b, int q)
{
    const int64_t product = (int64_t)a * b;
    const int shift = q_a + q_b - q;
    return shift >= 0 ? iq_low(product >> shift) : iq_low((int64_t)((uint64_t)product << -shift));
}

/* a / b in Q q, q <= 30. */
static inline int32_t iq_div(int32_t a, int32_t b, int q)
{
    int64_t numerator = (int64_t)a * ((int64_t)1 << (q + 1));
    int64_t denominator = b;
    int64_t quotient;
    if (b == 0) {
        return INT32_MAX;
    }
    if (b < 0) {
        numerator = -numerator;
        denominator = -denominator;
    }
    numerator += denominator;
    denominator *= 2;
    quotient = numerator / denominator;
    if (numerator % denominator < 0) {
        quotient--;
    }
    return iq_saturated(quotient);
}

/* Square root of a number in Q q, in Q q, rounded; 0 for a <= 0; q <= 30. */
static inline int32_t iq_sqrt(int32_t a, int q)
{
    uint64_t rest = a > 0 ? (uint64_t)a << (q + 2) : 0;
    uint64_t root = 0;
    uint64_t bit = (uint64_t)1 << 62;
    while (bit != 0) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    /* The root of four times the number is twice the result: its last bit decides the rounding. */
    return (int32_t)((root + 1) >> 1);
}

/* Count the events of the product and of the division with the same arguments, without dividing. */
static inline void iq_note_product(int32_t a, int32_t b, int q, iq_events_t *events)
{
    const int64_t exact = iq_rounded_product(a, b, q);
    if (exact != iq_saturated(exact)) {
        events->saturations++;
    }
}

static inline void iq_note_division(int32_t a, int32_t b, int q, iq_events_t *events)
{
    const int64_t numerator = (int64_t)a * ((int64_t)1 << (q + 1));
    const int64_t size = b < 0 ? -(int64_t)b : b;
    const int64_t rounded = (b < 0 ? -numerator : numerator) + size;
    if (b == 0) {
        events->zero_divisions++;
    } else if (b != INT32_MIN) {
        /* Divided by INT32_MIN the quotient is at most 2^q: it cannot saturate, and its bound would not fit 64 bits. */
        const int64_t bound = size * ((int64_t)1 << 32);
        if (rounded >= bound || rounded < -bound) {
            events->saturations++;
        }
    }
}

/* Table index from an integer, limited to 0..last. */
static inline int32_t iq_index(int32_t k, int32_t last)
{
    return iq_sat(k, last, 0);
}

/* Index of the last entry <= a of an increasing table, at least 0 and at most count - 2. */
static inline int32_t iq_locate(const int32_t *table, int32_t count, int32_t a)
{
    int32_t low = 0;
    int32_t high = count - 1;
    while (high - low > 1) {
        const int32_t middle = low + ((high - low) >> 1);
        if (table[middle] <= a) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Curve of 257 samples over 0..1, linear between them; a in Q (8 + bits), a cell is 2^bits wide. */
static inline int32_t iq_curve(const int32_t *samples, int32_t a, int bits)
{
    const int32_t cell = iq_sat(a >> bits, 255, 0);
    const int64_t rise = (int64_t)samples[cell + 1] - samples[cell];
    return iq_low(samples[cell] + ((rise * ((int64_t)a - (int64_t)cell * ((int64_t)1 << bits))) >> bits));
}

#if RAILHIL_USE_TI_IQMATH

#include "IQmathLib.h"
#if MATH_TYPE == FLOAT_MATH
#error "this law is fixed point: MATH_TYPE must be IQ_MATH"
#endif

#else

#define _IQsat(a, upper, lower) iq_sat((a), (upper), (lower))
@NAMES@
#endif

/* A format limit; counted when it limits. */
static inline int32_t iq_limit(int32_t a, int32_t upper, int32_t lower, iq_events_t *events)
{
    const int32_t limited = _IQsat(a, upper, lower);
    if (limited != a) {
        events->saturations++;
    }
    return limited;
}

#endif
