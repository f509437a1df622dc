/* Arithmetic of whole numbers that 64 bits hold: of T, from T_MIN to T_MAX. */

static T OF(add)(T a, T b, uint8_t *fault)
{
    const int64_t v = (int64_t)a + (int64_t)b;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T OF(sub)(T a, T b, uint8_t *fault)
{
    const int64_t v = (int64_t)a - (int64_t)b;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T OF(div)(T a, T b, uint8_t *fault)
{
    if ((int64_t)b == 0) {
        fail(fault, FAULT_DIVISION);
        return 0;
    }
    const int64_t v = (int64_t)a / (int64_t)b;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T OF(rem)(T a, T b, uint8_t *fault)
{
    if ((int64_t)b == 0) {
        fail(fault, FAULT_DIVISION);
        return 0;
    }
    const int64_t v = (int64_t)a % (int64_t)b;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T OF(neg)(T a, uint8_t *fault)
{
    const int64_t v = -(int64_t)a;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T FROM(i64)(int64_t v, uint8_t *fault)
{
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T FROM(u64)(uint64_t v, uint8_t *fault)
{
    if (v > (uint64_t)T_MAX) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}

static T OF(round)(double v, uint8_t *fault)
{
    const double r = round_even(v);
    if ((r >= (double)T_MIN) && (r <= (double)T_MAX)) {
        return (T)r;
    }
    fail(fault, FAULT_OVERFLOW);
    return 0;
}

static T OF(trunc)(double v, uint8_t *fault)
{
    const double r = toward_zero(v);
    if ((r >= (double)T_MIN) && (r <= (double)T_MAX)) {
        return (T)r;
    }
    fail(fault, FAULT_OVERFLOW);
    return 0;
}
