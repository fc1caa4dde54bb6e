/* The shortest decimal text that reads back as the same number and, of several as short, the nearest to it.

   The method is Raffaele Giulietti's Schubfach ("The Schubfach way to render doubles", 2020): one product with a power
   of ten of 126 bits decides between the decimals at both sides of the number. */
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    least_k = -324, most_k = 293, /* the table has 10^-k */
    n_limbs = 40, /* of 32 bits: 10^324 has fewer, and of 2^1279 / 10^293 more than 126 bits are left */
    mantissa_bits = 52,
    exponent_bias = 1075,
    least_plain = -4, most_plain = 14 /* powers of ten of a first digit that need no exponent */
};

__extension__ typedef unsigned __int128 wide;

/* floor(10^-k 2^-r) + 1 with the r that makes it a number of 126 bits: the upper and the lower 63 bits. */
static struct { uint64_t upper, lower; } powers[most_k - least_k + 1];
static pthread_once_t is_filled = PTHREAD_ONCE_INIT;

static int64_t floor_log10_power_of_2(int64_t e) { return e * 661971961083 >> 41; }
static int64_t floor_log10_three_quarters_power_of_2(int64_t e) { return (e * 661971961083 - 274743187321) >> 41; }
static int64_t floor_log2_power_of_10(int64_t e) { return e * 913124641741 >> 38; }

/* Notes the leading 126 bits of a long number, the highest limb last. */
static void note_power(int k, const uint32_t limbs[n_limbs])
{
    int last = n_limbs - 1;
    while (limbs[last] == 0)
        last--;
    wide leading = 0;
    for (int i = last; i > last - 4; i--)
        leading = leading << 32 | (i < 0 ? 0 : limbs[i]);
    int zeros = 0;
    while (!(leading >> (127 - zeros) & 1))
        zeros++;
    /* A fifth limb fills what the zeros leave. */
    leading = leading << zeros | (last < 4 ? 0 : (uint64_t)limbs[last - 4] << zeros >> 32);
    leading = (leading >> 2) + 1;
    powers[k - least_k].upper = (uint64_t)(leading >> 63);
    powers[k - least_k].lower = (uint64_t)leading & INT64_MAX;
}

static void fill_powers(void)
{
    uint32_t limbs[n_limbs] = {1};
    for (int k = 0; k >= least_k; k--) {
        note_power(k, limbs);
        uint64_t carry = 0;
        for (int i = 0; i < n_limbs; i++) {
            carry += limbs[i] * 10ull;
            limbs[i] = (uint32_t)carry;
            carry >>= 32;
        }
    }
    /* Divided step by step and cut, 2^x 10^-k is what it would be if divided at once and cut. */
    memset(limbs, 0, sizeof limbs);
    limbs[n_limbs - 1] = 1u << 31;
    for (int k = 1; k <= most_k; k++) {
        uint64_t rest = 0;
        for (int i = n_limbs - 1; i >= 0; i--) {
            rest = rest << 32 | limbs[i];
            limbs[i] = (uint32_t)(rest / 10);
            rest %= 10;
        }
        note_power(k, limbs);
    }
}

/* The upper bits of a product with a power, the last one set if anything lies below. */
static uint64_t round_to_odd(uint64_t upper, uint64_t lower, uint64_t factor)
{
    uint64_t below = (uint64_t)((wide)lower * factor >> 64);
    wide product = (wide)upper * factor;
    uint64_t middle = ((uint64_t)product >> 1) + below;
    uint64_t result = (uint64_t)(product >> 64) + (middle >> 63);
    return result | ((middle & INT64_MAX) != 0);
}

/* The decimal digits * 10^power of mantissa * 2^exponent. */
static void shortest(uint64_t mantissa, int exponent, uint64_t *digits, int *power)
{
    const uint64_t is_odd = mantissa & 1;
    const bool is_even_spaced = mantissa != 1ull << mantissa_bits || exponent == 1 - exponent_bias;
    const int64_t k = is_even_spaced ? floor_log10_power_of_2(exponent)
                                     : floor_log10_three_quarters_power_of_2(exponent);
    const int shift = (int)(exponent + floor_log2_power_of_10(-k) + 2);
    const uint64_t upper = powers[k - least_k].upper, lower = powers[k - least_k].lower;
    /* Four times the number and the ends of the interval that reads back as it. */
    const uint64_t center = 4*mantissa;
    const uint64_t value = round_to_odd(upper, lower, center << shift);
    const uint64_t first = round_to_odd(upper, lower, (center - (is_even_spaced ? 2 : 1)) << shift) + is_odd;
    const uint64_t last = round_to_odd(upper, lower, (center + 2) << shift) - is_odd;
    const uint64_t below = value >> 2;
    *power = (int)k;
    if (below >= 10) {
        const uint64_t tens = below / 10 * 10;
        const bool is_down = first <= 4*tens, is_up = 4*tens + 40 <= last;
        if (is_down != is_up) {
            *digits = is_down ? tens : tens + 10;
            return;
        }
    }
    const bool is_down = first <= 4*below, is_up = 4*below + 4 <= last;
    if (is_down != is_up)
        *digits = is_down ? below : below + 1;
    else
        *digits = below + (value - 4*below > 2 || (value - 4*below == 2 && below % 2 == 1));
}

static char *put_digits(char *at, const char *digits, int n)
{
    memcpy(at, digits, (size_t)n);
    return at + n;
}

static char *put_zeros(char *at, int n)
{
    memset(at, '0', n > 0 ? (size_t)n : 0);
    return at + (n > 0 ? n : 0);
}

/* Writes an integer, and returns where it ends. */
static char *put_integer(char *at, int value)
{
    char digits[12];
    int n = 0;
    if (value < 0)
        *at++ = '-';
    for (unsigned rest = value < 0 ? 0u - (unsigned)value : (unsigned)value; n == 0 || rest > 0; rest /= 10)
        digits[n++] = (char)('0' + rest % 10);
    while (n > 0)
        *at++ = digits[--n];
    return at;
}

/* Writes digits * 10^power as 0.1, 1250.0 or 1.25e-11, and returns where it ends. */
static char *put_number(char *at, uint64_t decimal, int power)
{
    for (; decimal > 0 && decimal % 10 == 0; decimal /= 10)
        power++;
    char reversed[20], digits[20];
    int n = 0;
    for (; n == 0 || decimal > 0; decimal /= 10)
        reversed[n++] = (char)('0' + decimal % 10);
    for (int i = 0; i < n; i++)
        digits[i] = reversed[n - 1 - i];
    const int magnitude = n - 1 + power; /* the power of ten of the first digit */
    if (magnitude >= 0 && magnitude <= most_plain) {
        const int n_before = n < magnitude + 1 ? n : magnitude + 1;
        at = put_digits(at, digits, n_before);
        at = put_zeros(at, magnitude + 1 - n_before);
        *at++ = '.';
        return n > n_before ? put_digits(at, digits + n_before, n - n_before) : put_zeros(at, 1);
    }
    if (magnitude < 0 && magnitude >= least_plain) {
        at = put_digits(at, "0.", 2);
        at = put_zeros(at, -magnitude - 1);
        return put_digits(at, digits, n);
    }
    at = put_digits(at, digits, 1);
    *at++ = '.';
    at = n > 1 ? put_digits(at, digits + 1, n - 1) : put_zeros(at, 1);
    *at++ = 'e';
    return put_integer(at, magnitude);
}

/* Writes a number into a text of at least 24 characters, without a zero byte behind it. */
void amontons_write_decimal(double value, char *text, int *length)
{
    pthread_once(&is_filled, fill_powers);
    char *at = text;
    uint64_t bits, decimal = 0;
    int power = 0;
    memcpy(&bits, &value, sizeof bits);
    const uint64_t fraction = bits & ((1ull << mantissa_bits) - 1);
    const int exponent = (int)(bits >> mantissa_bits & 0x7ff);
    if (signbit(value) && !isnan(value))
        *at++ = '-';
    if (isnan(value)) {
        at = put_digits(at, "NaN", 3);
    } else if (isinf(value)) {
        at = put_digits(at, "Infinity", 8);
    } else {
        if (exponent > 0)
            shortest(fraction | 1ull << mantissa_bits, exponent - exponent_bias, &decimal, &power);
        else if (fraction > 0)
            shortest(fraction, 1 - exponent_bias, &decimal, &power);
        at = put_number(at, decimal, power);
    }
    *length = (int)(at - text);
}

/* A number rounded to so many significant decimal digits; the number itself where that is beyond the largest. */
double amontons_rounded_decimal(double value, int n_digits)
{
    char text[32];
    snprintf(text, sizeof text, "%.*e", n_digits - 1, value);
    double rounded = strtod(text, NULL);
    return isfinite(rounded) ? rounded : value;
}
