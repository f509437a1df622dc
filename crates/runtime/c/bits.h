/* Shifts of the bits of T, which has no sign. */

static T OF(shl)(T a, int64_t by, uint8_t *fault)
{
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    if (by >= (8 * (int64_t)sizeof(T))) {
        return 0;
    }
    return (T)((uint64_t)a << (uint32_t)by);
}

static T OF(shr)(T a, int64_t by, uint8_t *fault)
{
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    if (by >= (8 * (int64_t)sizeof(T))) {
        return 0;
    }
    return (T)((uint64_t)a >> (uint32_t)by);
}

static T OF(rol)(T a, int64_t by, uint8_t *fault)
{
    const uint32_t bits = 8U * (uint32_t)sizeof(T);
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    const int64_t rest = by % (int64_t)bits;
    const uint32_t n = (uint32_t)rest;
    if (n == 0U) {
        return a;
    }
    const uint32_t back = bits - n;
    return (T)(((uint64_t)a << n) | ((uint64_t)a >> back));
}

static T OF(ror)(T a, int64_t by, uint8_t *fault)
{
    const uint32_t bits = 8U * (uint32_t)sizeof(T);
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    const int64_t rest = by % (int64_t)bits;
    const uint32_t n = (uint32_t)rest;
    if (n == 0U) {
        return a;
    }
    const uint32_t back = bits - n;
    return (T)(((uint64_t)a >> n) | ((uint64_t)a << back));
}
