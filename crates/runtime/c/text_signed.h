/* A text as a whole number with a sign; -0 has nothing to be taken from. */

static T OF(text_to)(const uint8_t *a, uint8_t *fault)
{
    bool negative = false;
    uint64_t v = 0;
    if (!text_number(a, &v, &negative) || (negative ? (v > (uint64_t)T_MAX + 1U) : (v > (uint64_t)T_MAX))) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    if (v == 0U) {
        return 0;
    }
    if (negative) {
        v -= 1U;
        return (T)(-(int64_t)v - 1);
    }
    return (T)v;
}
