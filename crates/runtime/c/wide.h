/* Arithmetic of whole numbers of 64 bits, and what passes them. */

static int64_t add_i64(int64_t a, int64_t b, uint8_t *fault)
{
    if (((b > 0) && (a > (INT64_MAX - b))) || ((b < 0) && (a < (INT64_MIN - b)))) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a + b;
}

static int64_t sub_i64(int64_t a, int64_t b, uint8_t *fault)
{
    if (((b < 0) && (a > (INT64_MAX + b))) || ((b > 0) && (a < (INT64_MIN + b)))) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a - b;
}

static int64_t mul_i64(int64_t a, int64_t b, uint8_t *fault)
{
    bool over = false;
    if ((a > 0) && (b > 0)) {
        over = a > (INT64_MAX / b);
    } else if ((a > 0) && (b < 0)) {
        over = b < (INT64_MIN / a);
    } else if ((a < 0) && (b > 0)) {
        over = a < (INT64_MIN / b);
    } else if ((a < 0) && (b < 0)) {
        over = b < (INT64_MAX / a);
    } else {
        /* the product of zero is zero */
    }
    if (over) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a * b;
}

static int64_t div_i64(int64_t a, int64_t b, uint8_t *fault)
{
    if (b == 0) {
        fail(fault, FAULT_DIVISION);
        return 0;
    }
    if ((a == INT64_MIN) && (b == -1)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a / b;
}

static int64_t rem_i64(int64_t a, int64_t b, uint8_t *fault)
{
    if (b == 0) {
        fail(fault, FAULT_DIVISION);
        return 0;
    }
    return (b == -1) ? 0 : (a % b);
}

static int64_t neg_i64(int64_t a, uint8_t *fault)
{
    if (a == INT64_MIN) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return -a;
}

static int64_t abs_i64(int64_t a, uint8_t *fault)
{
    if (a == INT64_MIN) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (a < 0) ? -a : a;
}

static uint64_t add_u64(uint64_t a, uint64_t b, uint8_t *fault)
{
    if (a > (UINT64_MAX - b)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a + b;
}

static uint64_t sub_u64(uint64_t a, uint64_t b, uint8_t *fault)
{
    if (a < b) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a - b;
}

static uint64_t mul_u64(uint64_t a, uint64_t b, uint8_t *fault)
{
    if ((a != 0U) && (b > (UINT64_MAX / a))) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a * b;
}

static uint64_t div_u64(uint64_t a, uint64_t b, uint8_t *fault)
{
    if (b == 0U) {
        fail(fault, FAULT_DIVISION);
        return 0;
    }
    return a / b;
}

static uint64_t rem_u64(uint64_t a, uint64_t b, uint8_t *fault)
{
    if (b == 0U) {
        fail(fault, FAULT_DIVISION);
        return 0;
    }
    return a % b;
}

static uint64_t neg_u64(uint64_t a, uint8_t *fault)
{
    if (a != 0U) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return a;
}

static uint32_t mul_u32(uint32_t a, uint32_t b, uint8_t *fault)
{
    const uint64_t v = (uint64_t)a * (uint64_t)b;
    if (v > UINT32_MAX) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (uint32_t)v;
}

static int64_t i64_from_u64(uint64_t v, uint8_t *fault)
{
    if (v > (uint64_t)INT64_MAX) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (int64_t)v;
}

static uint64_t u64_from_i64(int64_t v, uint8_t *fault)
{
    if (v < 0) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (uint64_t)v;
}

static int64_t round_i64(double v, uint8_t *fault)
{
    const double r = round_even(v);
    if ((r >= -9223372036854775808.0) && (r < 9223372036854775808.0)) {
        return (int64_t)r;
    }
    fail(fault, FAULT_OVERFLOW);
    return 0;
}

static uint64_t round_u64(double v, uint8_t *fault)
{
    const double r = round_even(v);
    if ((r >= 0.0) && (r < 18446744073709551616.0)) {
        return (uint64_t)r;
    }
    fail(fault, FAULT_OVERFLOW);
    return 0;
}

static int64_t trunc_i64(double v, uint8_t *fault)
{
    const double r = toward_zero(v);
    if ((r >= -9223372036854775808.0) && (r < 9223372036854775808.0)) {
        return (int64_t)r;
    }
    fail(fault, FAULT_OVERFLOW);
    return 0;
}

static uint64_t trunc_u64(double v, uint8_t *fault)
{
    const double r = toward_zero(v);
    if ((r >= 0.0) && (r < 18446744073709551616.0)) {
        return (uint64_t)r;
    }
    fail(fault, FAULT_OVERFLOW);
    return 0;
}
