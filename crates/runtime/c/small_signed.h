/* The magnitude of whole numbers of T. */

static T OF(abs)(T a, uint8_t *fault)
{
    const int64_t v = (a < 0) ? -(int64_t)a : (int64_t)a;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}
