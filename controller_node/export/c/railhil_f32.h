/* Single precision of the C28x floating-point unit for exported control laws: IEEE 754, rounding to nearest even; a
 * denormal result is zero, -0 is +0, NaN is infinity. Same bits as the arithmetic float32 of railhil on every compiler
 * that computes float as float and does not contract a * b + c (gcc and clang: -ffp-contract=off).
 */
#ifndef RAILHIL_F32_H
#define RAILHIL_F32_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "float must be computed as float"
#endif

/* Events of a law since its start, as in railhil_iq.h: in single precision there are none. */
typedef struct {
    uint32_t saturations;
    uint32_t zero_divisions;
} iq_events_t;

static inline float f32_fit(float a)
{
    if (a != a) {
        return HUGE_VALF;
    }
    return a < FLT_MIN && a > -FLT_MIN ? 0.0f : a;
}

static inline float f32_add(float a, float b) { return f32_fit(a + b); }
static inline float f32_sub(float a, float b) { return f32_fit(a - b); }
static inline float f32_neg(float a) { return 0.0f - a; }
static inline float f32_abs(float a) { return a < 0.0f ? -a : a; }
static inline float f32_mul(float a, float b) { return f32_fit(a * b); }
static inline float f32_min(float a, float b) { return a < b ? a : b; }
static inline float f32_max(float a, float b) { return a > b ? a : b; }
static inline float f32_clip(float a, float upper, float lower) { return f32_min(f32_max(a, lower), upper); }
static inline float f32_sqrt(float a) { return a > 0.0f ? f32_fit(sqrtf(a)) : 0.0f; }

/* TI's fast division: an estimate of 1 / b to 8 bits, two Newton steps, one product. */
static inline float f32_div(float a, float b)
{
    float r = 0.0f;
    if (b == 0.0f) {
        r = HUGE_VALF;
    } else if (f32_abs(b) <= FLT_MAX) {
        int exponent;
        const double mantissa = frexp((double)b, &exponent);
        r = f32_fit((float)ldexp(floor(ldexp(1.0 / mantissa, 7) + 0.5), -7 - exponent));
    }
    r = f32_mul(r, f32_sub(2.0f, f32_mul(b, r)));
    r = f32_mul(r, f32_sub(2.0f, f32_mul(b, r)));
    return f32_mul(a, f32_abs(b) > FLT_MAX ? 0.0f : r);
}

/* Nearest multiple of 2^-q, ties upward. */
static inline float f32_quantise(float a, int q)
{
    return f32_abs(a) <= FLT_MAX ? (float)ldexp(floor(ldexp((double)a, q) + 0.5), -q) : a;
}

/* A table of 257 samples over 0..1, interpolated. */
static inline float f32_curve(const float *samples, float a)
{
    const float scaled = a * 256.0f;
    const int32_t index = (int32_t)f32_min(scaled, 255.0f);
    return f32_add(samples[index], f32_mul(f32_sub(samples[index + 1], samples[index]), scaled - (float)index));
}

/* Number of a control period as an index of a table. */
static inline int32_t f32_index(int32_t k, int32_t last) { return k < 0 ? 0 : k > last ? last : k; }

/* Index of the last entry <= a of an increasing table, at least 0 and at most count - 2. */
static inline int32_t f32_locate(const float *table, int32_t count, float a)
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

/* Integers of the wire with q fraction bits, and back; the conversion to an integer saturates. */
static inline float f32_from(int32_t raw, int q) { return f32_fit((float)ldexp((double)raw, -q)); }

static inline int32_t f32_raw(float a, int q)
{
    const double scaled = ldexp((double)a, q) + 0.5;
    return (int32_t)floor(scaled > 2147483647.0 ? 2147483647.0 : scaled < -2147483648.0 ? -2147483648.0 : scaled);
}

/* Such an integer without its last bits, limited to the range of its signal. */
static inline int32_t f32_note(int32_t a, int bits, int32_t low, int32_t high)
{
    const int32_t note = a >> bits;
    return note < low ? low : note > high ? high : note;
}

#endif
