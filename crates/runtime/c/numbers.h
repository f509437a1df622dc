/* Time, places in tables, reals. */

/* The place of the lowest bit that is set: an instruction of many machines, else as de Bruijn. */
static uint32_t low_bit(uint32_t word)
{
    #if defined(__GNUC__) && !defined(G7_PLAIN_C)
    return (uint32_t)__builtin_ctzl(word);
    #else
    static const uint8_t place_of[32] = {
        0, 1, 28, 2, 29, 14, 24, 3, 30, 22, 20, 15, 25, 17, 4, 8,
        31, 27, 13, 23, 21, 19, 16, 7, 26, 12, 18, 6, 11, 5, 10, 9
    };
    const uint32_t lowest = word & (~word + UINT32_C(1));
    return place_of[(uint32_t)(lowest * UINT32_C(0x077CB531)) >> 27];
    #endif
}

/* Time gone by; the clock may pass its end. */
static int64_t since(int64_t now, int64_t then)
{
    const uint64_t gone = (uint64_t)now - (uint64_t)then;
    return (int64_t)gone;
}

/* Ticks gone by; the clock may pass its end. */
static uint32_t ticks_gone(uint32_t now, uint32_t then)
{
    return now - then;
}

/* Ticks from an event to now, as far as they tell. */
static uint32_t ticks_since(uint32_t now, uint32_t then)
{
    const uint32_t gone = now - then;
    return (gone > 0x80000000U) ? 0x80000000U : gone;
}

/* The event, or the latest that is as long ago as ticks can tell. */
static uint32_t ticks_held(uint32_t now, uint32_t then)
{
    return now - ticks_since(now, then);
}

/* True if the clock came into another quarter of its range. */
static bool has_turned(uint32_t now, uint32_t then)
{
    return (now >> 30) != (then >> 30);
}

static bool is_due_after(int64_t now, int64_t start, int64_t time)
{
    return (start > (INT64_MAX - time)) ? (now == INT64_MAX) : (now >= (start + time));
}

/* The first fault is the one that is told. */
static void fail(uint8_t *fault, uint8_t kind)
{
    if (*fault == 0) {
        *fault = kind;
    }
}

/* To a whole number, halves to the even one. */
static double round_even(double v)
{
    double whole;
    double rest;
    if (!((v > -4503599627370496.0) && (v < 4503599627370496.0))) {
        return v;
    }
    whole = (double)(int64_t)v;
    rest = v - whole;
    if ((rest > 0.5) || ((rest == 0.5) && (((int64_t)v % 2) != 0))) {
        whole += 1.0;
    } else if ((rest < -0.5) || ((rest == -0.5) && (((int64_t)v % 2) != 0))) {
        whole -= 1.0;
    } else {
        /* it is the nearest */
    }
    return whole;
}

static double toward_zero(double v)
{
    if (!((v > -4503599627370496.0) && (v < 4503599627370496.0))) {
        return v;
    }
    return (double)(int64_t)v;
}

/* What a division leaves, exact, with the sign of the dividend. Without a finite dividend there is none. */
static double remainder_of(double a, double b)
{
    double rest = (a < 0.0) ? -a : a;
    const double divisor = (b < 0.0) ? -b : b;
    double part = divisor;
    if (((rest - rest) != 0.0) || (divisor != divisor)) {
        return (a - a) / (b - b);
    }
    if (rest < divisor) {
        return a;
    }
    while (part <= (rest - part)) {
        part += part;
    }
    while (part >= divisor) {
        if (rest >= part) {
            rest -= part;
        }
        part /= 2.0;
    }
    return (a < 0.0) ? -rest : rest;
}

static double real_abs(double v)
{
    return (v < 0.0) ? -v : ((v == 0.0) ? 0.0 : v);
}

/* The square root, rounded as IEEE 754 has it, digit by digit. */
static double real_sqrt(double v)
{
    double scale = 1.0;
    double part = v;
    uint64_t number;
    uint64_t root = 0;
    uint64_t rest = 0;
    if ((v != v) || (v == 0.0) || ((v > 0.0) && ((v - v) != 0.0))) {
        return v;
    }
    if (v < 0.0) {
        return (v - v) / (v - v);
    }
    while (part >= 4.0) {
        part /= 4.0;
        scale *= 2.0;
    }
    while (part < 1.0) {
        part *= 4.0;
        scale /= 2.0;
    }
    number = (uint64_t)(part * 4503599627370496.0);
    for (uint32_t i = 0; i < 53U; i++) {
        uint64_t two = 0;
        if (i < 27U) {
            const uint32_t by = 52U - (2U * i);
            two = number >> by;
            two &= UINT64_C(3);
        }
        rest = (rest << 2) | two;
        root <<= 1;
        if (rest >= ((root << 1) + 1U)) {
            rest -= (root << 1) + 1U;
            root += 1U;
        }
    }
    if (rest > root) {
        root += 1U;
    }
    return ((double)root / 4503599627370496.0) * scale;
}

static float div_f32(float a, float b, uint8_t *fault)
{
    if (b == 0.0F) {
        fail(fault, FAULT_DIVISION);
        return 0.0F;
    }
    return a / b;
}

static float rem_f32(float a, float b, uint8_t *fault)
{
    if (b == 0.0F) {
        fail(fault, FAULT_DIVISION);
        return 0.0F;
    }
    return (float)remainder_of((double)a, (double)b);
}

static double div_f64(double a, double b, uint8_t *fault)
{
    if (b == 0.0) {
        fail(fault, FAULT_DIVISION);
        return 0.0;
    }
    return a / b;
}

static double rem_f64(double a, double b, uint8_t *fault)
{
    if (b == 0.0) {
        fail(fault, FAULT_DIVISION);
        return 0.0;
    }
    return remainder_of(a, b);
}
