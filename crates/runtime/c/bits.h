/* Shifts of the bits of T, which has no sign. */

static T OF(shl)(T a, int64_t by, uint8_t *fault)
{
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    if (by >= (int64_t)(8U * sizeof(T))) {
        return 0;
    }
    return (T)((uint64_t)a << by);
}

static T OF(shr)(T a, int64_t by, uint8_t *fault)
{
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    if (by >= (int64_t)(8U * sizeof(T))) {
        return 0;
    }
    return (T)((uint64_t)a >> by);
}

static T OF(rol)(T a, int64_t by, uint8_t *fault)
{
    const int64_t bits = (int64_t)(8U * sizeof(T));
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    const int64_t n = by % bits;
    if (n == 0) {
        return a;
    }
    return (T)(((uint64_t)a << n) | ((uint64_t)a >> (bits - n)));
}

static T OF(ror)(T a, int64_t by, uint8_t *fault)
{
    const int64_t bits = (int64_t)(8U * sizeof(T));
    if (by < 0) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    const int64_t n = by % bits;
    if (n == 0) {
        return a;
    }
    return (T)(((uint64_t)a >> n) | ((uint64_t)a << (bits - n)));
}
