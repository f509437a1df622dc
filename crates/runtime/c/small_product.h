/* The product of whole numbers of T; that of uint32_t passes 63 bits. */

static T OF(mul)(T a, T b, uint8_t *fault)
{
    const int64_t v = (int64_t)a * (int64_t)b;
    if ((v < (int64_t)T_MIN) || (v > (int64_t)T_MAX)) {
        fail(fault, FAULT_OVERFLOW);
        return 0;
    }
    return (T)v;
}
