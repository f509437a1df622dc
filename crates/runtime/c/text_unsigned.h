/* A text as a whole number without a sign. */

static T OF(text_to)(const uint8_t *a, uint8_t *fault)
{
    bool negative = false;
    uint64_t v = 0;
    if (!text_number(a, &v, &negative) || (negative ? (v > 0U) : (v > (uint64_t)T_MAX))) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    return (T)v;
}
