/*: low_bit */
/* The place of the lowest bit that is set (de Bruijn). */
static uint32_t low_bit(uint32_t word)
{
    static const uint8_t place_of[32] = {
        0, 1, 28, 2, 29, 14, 24, 3, 30, 22, 20, 15, 25, 17, 4, 8,
        31, 27, 13, 23, 21, 19, 16, 7, 26, 12, 18, 6, 11, 5, 10, 9
    };
    const uint32_t lowest = word & (~word + UINT32_C(1));
    return place_of[(uint32_t)(lowest * UINT32_C(0x077CB531)) >> 27];
}

/*: since */
/* Time gone by; the clock may pass its end. */
static int64_t since(int64_t now, int64_t then)
{
    return (int64_t)((uint64_t)now - (uint64_t)then);
}

/*: is_due_after */
static bool is_due_after(int64_t now, int64_t start, int64_t time)
{
    return (start > (INT64_MAX - time)) ? (now == INT64_MAX) : (now >= (start + time));
}

/*: fail */
/* The first fault is the one that is told. */
static void fail(uint8_t *fault, uint8_t kind)
{
    if (*fault == 0) {
        *fault = kind;
    }
}

/*: place */
static uint32_t place(int64_t i, uint32_t length, uint8_t *fault)
{
    if ((i < 0) || (i >= (int64_t)length)) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    return (uint32_t)i;
}

/*: round_even */
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
    }
    return whole;
}

/*: toward_zero */
static double toward_zero(double v)
{
    if (!((v > -4503599627370496.0) && (v < 4503599627370496.0))) {
        return v;
    }
    return (double)(int64_t)v;
}

/*: remainder_of */
/* What a division leaves, exact, with the sign of the dividend. */
static double remainder_of(double a, double b)
{
    double rest = (a < 0.0) ? -a : a;
    const double divisor = (b < 0.0) ? -b : b;
    double part = divisor;
    if (!(rest <= 1.7976931348623157e308) || (divisor != divisor)) {
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

/*: real_abs */
static double real_abs(double v)
{
    return (v < 0.0) ? -v : ((v == 0.0) ? 0.0 : v);
}

/*: real_sqrt */
/* The square root, rounded as IEEE 754 has it, digit by digit. */
static double real_sqrt(double v)
{
    double scale = 1.0;
    uint64_t number;
    uint64_t root = 0;
    uint64_t rest = 0;
    if ((v != v) || (v == 0.0) || (v > 1.7976931348623157e308)) {
        return v;
    }
    if (v < 0.0) {
        return (v - v) / (v - v);
    }
    while (v >= 4.0) {
        v /= 4.0;
        scale *= 2.0;
    }
    while (v < 1.0) {
        v *= 4.0;
        scale /= 2.0;
    }
    number = (uint64_t)(v * 4503599627370496.0);
    for (uint32_t i = 0; i < 53u; i++) {
        const uint64_t two = (i < 27u) ? ((number >> (52u - (2u * i))) & 3u) : 0u;
        rest = (rest << 2) | two;
        root <<= 1;
        if (rest >= ((root << 1) + 1u)) {
            rest -= (root << 1) + 1u;
            root += 1u;
        }
    }
    if (rest > root) {
        root += 1u;
    }
    return ((double)root / 4503599627370496.0) * scale;
}

/*: text_size */
/* Texts: two bytes of length, then UTF-8; what is not used is zero. */
static uint32_t text_size(const uint8_t *a)
{
    return (uint32_t)a[0] | ((uint32_t)a[1] << 8);
}

/*: text_clear */
static void text_clear(uint8_t *to, uint32_t most)
{
    for (uint32_t i = 0; i < (most + 2u); i++) {
        to[i] = 0;
    }
}

/*: text_append */
/* Appends bytes, character by character; whether all of them fit. */
static bool text_append(const uint8_t *from, uint32_t first, uint32_t end, uint8_t *to, uint32_t most)
{
    uint32_t size = text_size(to);
    uint32_t i = first;
    while (i < end) {
        uint32_t next = i + 1u;
        while ((next < end) && ((from[next + 2u] & 0xC0u) == 0x80u)) {
            next += 1u;
        }
        if ((size + (next - i)) > most) {
            return false;
        }
        while (i < next) {
            to[size + 2u] = from[i + 2u];
            size += 1u;
            i += 1u;
        }
        to[0] = (uint8_t)(size & 255u);
        to[1] = (uint8_t)(size >> 8);
    }
    return true;
}

/*: text_skip */
/* The byte behind `count` characters from byte `from` on. */
static uint32_t text_skip(const uint8_t *a, uint32_t from, int64_t count)
{
    const uint32_t size = text_size(a);
    uint32_t i = from;
    int64_t left = count;
    while ((left > 0) && (i < size)) {
        i += 1u;
        while ((i < size) && ((a[i + 2u] & 0xC0u) == 0x80u)) {
            i += 1u;
        }
        left -= 1;
    }
    return i;
}

/*: text_len */
static int64_t text_len(const uint8_t *a)
{
    const uint32_t size = text_size(a);
    int64_t count = 0;
    for (uint32_t i = 0; i < size; i++) {
        if ((a[i + 2u] & 0xC0u) != 0x80u) {
            count += 1;
        }
    }
    return count;
}

/*: text_compare */
static int32_t text_compare(const uint8_t *a, const uint8_t *b)
{
    const uint32_t size_a = text_size(a);
    const uint32_t size_b = text_size(b);
    for (uint32_t i = 0; (i < size_a) && (i < size_b); i++) {
        if (a[i + 2u] != b[i + 2u]) {
            return (a[i + 2u] < b[i + 2u]) ? -1 : 1;
        }
    }
    return (size_a == size_b) ? 0 : ((size_a < size_b) ? -1 : 1);
}

/*: text_find */
static int64_t text_find(const uint8_t *a, const uint8_t *b)
{
    const uint32_t size_a = text_size(a);
    const uint32_t size_b = text_size(b);
    int64_t character = 0;
    if (size_b == 0u) {
        return 0;
    }
    for (uint32_t i = 0; (i + size_b) <= size_a; i++) {
        uint32_t k = 0;
        if ((a[i + 2u] & 0xC0u) != 0x80u) {
            character += 1;
        }
        while ((k < size_b) && (a[i + k + 2u] == b[k + 2u])) {
            k += 1u;
        }
        if (k == size_b) {
            return character;
        }
    }
    return 0;
}

/*: text_copy */
static void text_copy(const uint8_t *a, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    (void)text_append(a, 0, text_size(a), to, most);
}

/*: text_left */
static void text_left(const uint8_t *a, int64_t n, uint8_t *to, uint32_t most, uint8_t *fault)
{
    if (n < 0) {
        fail(fault, FAULT_RANGE);
        return;
    }
    text_clear(to, most);
    (void)text_append(a, 0, text_skip(a, 0, n), to, most);
}

/*: text_right */
static void text_right(const uint8_t *a, int64_t n, uint8_t *to, uint32_t most, uint8_t *fault)
{
    if (n < 0) {
        fail(fault, FAULT_RANGE);
        return;
    }
    text_clear(to, most);
    (void)text_append(a, text_skip(a, 0, text_len(a) - n), text_size(a), to, most);
}

/*: text_mid */
static void text_mid(const uint8_t *a, int64_t n, int64_t at, uint8_t *to, uint32_t most, uint8_t *fault)
{
    uint32_t first;
    if ((n < 0) || (at < 0)) {
        fail(fault, FAULT_RANGE);
        return;
    }
    first = text_skip(a, 0, at - 1);
    text_clear(to, most);
    (void)text_append(a, first, text_skip(a, first, n), to, most);
}

/*: text_concat */
static void text_concat(const uint8_t *a, const uint8_t *b, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    if (text_append(a, 0, text_size(a), to, most)) {
        (void)text_append(b, 0, text_size(b), to, most);
    }
}

/*: text_insert */
static void text_insert(const uint8_t *a, const uint8_t *b, int64_t at, uint8_t *to, uint32_t most, uint8_t *fault)
{
    uint32_t first;
    if (at < 0) {
        fail(fault, FAULT_RANGE);
        return;
    }
    first = text_skip(a, 0, at);
    text_clear(to, most);
    if (text_append(a, 0, first, to, most) && text_append(b, 0, text_size(b), to, most)) {
        (void)text_append(a, first, text_size(a), to, most);
    }
}

/*: text_delete */
static void text_delete(const uint8_t *a, int64_t n, int64_t at, uint8_t *to, uint32_t most, uint8_t *fault)
{
    uint32_t first;
    if ((n < 0) || (at < 0)) {
        fail(fault, FAULT_RANGE);
        return;
    }
    first = text_skip(a, 0, at - 1);
    text_clear(to, most);
    if (text_append(a, 0, first, to, most)) {
        (void)text_append(a, text_skip(a, first, n), text_size(a), to, most);
    }
}

/*: text_replace */
static void text_replace(const uint8_t *a, const uint8_t *b, int64_t n, int64_t at, uint8_t *to, uint32_t most,
                         uint8_t *fault)
{
    uint32_t first;
    if ((n < 0) || (at < 0)) {
        fail(fault, FAULT_RANGE);
        return;
    }
    first = text_skip(a, 0, at - 1);
    text_clear(to, most);
    if (text_append(a, 0, first, to, most) && text_append(b, 0, text_size(b), to, most)) {
        (void)text_append(a, text_skip(a, first, n), text_size(a), to, most);
    }
}

/*: text_put */
/* Appends plain letters; what does not fit is left away. */
static void text_put(const char *letters, uint8_t *to, uint32_t most)
{
    uint32_t size = text_size(to);
    for (uint32_t i = 0; (letters[i] != '\0') && (size < most); i++) {
        to[size + 2u] = (uint8_t)letters[i];
        size += 1u;
    }
    to[0] = (uint8_t)(size & 255u);
    to[1] = (uint8_t)(size >> 8);
}

/*: text_put_number */
static void text_put_number(uint64_t v, uint8_t *to, uint32_t most)
{
    char letters[21];
    uint32_t at = 20;
    uint64_t left = v;
    letters[at] = '\0';
    do {
        at -= 1u;
        letters[at] = (char)('0' + (int)(left % 10u));
        left /= 10u;
    } while (left != 0u);
    text_put(&letters[at], to, most);
}

/*: text_from_u64 */
static void text_from_u64(uint64_t v, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    text_put_number(v, to, most);
}

/*: text_from_i64 */
static void text_from_i64(int64_t v, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    if (v < 0) {
        text_put("-", to, most);
        text_put_number(~(uint64_t)v + 1u, to, most);
    } else {
        text_put_number((uint64_t)v, to, most);
    }
}

/*: text_from_bool */
static void text_from_bool(bool v, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    text_put(v ? "TRUE" : "FALSE", to, most);
}

/*: text_from_time */
static void text_from_time(int64_t v, uint8_t *to, uint32_t most)
{
    static const uint64_t unit[7] = {
        UINT64_C(86400000000000), UINT64_C(3600000000000), UINT64_C(60000000000), UINT64_C(1000000000),
        UINT64_C(1000000), UINT64_C(1000), UINT64_C(1)
    };
    static const char *const name[7] = { "d", "h", "m", "s", "ms", "us", "ns" };
    uint64_t left = (v < 0) ? (~(uint64_t)v + 1u) : (uint64_t)v;
    text_clear(to, most);
    text_put((v < 0) ? "T#-" : "T#", to, most);
    if (left == 0u) {
        text_put("0s", to, most);
    }
    for (uint32_t i = 0; i < 7u; i++) {
        if (left >= unit[i]) {
            text_put_number(left / unit[i], to, most);
            text_put(name[i], to, most);
            left %= unit[i];
        }
    }
}

/*: text_trim */
static bool text_is_blank(uint8_t c)
{
    return (c == 0x20u) || ((c >= 0x09u) && (c <= 0x0Du));
}

/*: text_number */
/* A whole number with its sign; blanks round it do not count. */
static bool text_number(const uint8_t *a, uint64_t *v, bool *negative)
{
    uint32_t i = 0;
    uint32_t end = text_size(a);
    *v = 0;
    *negative = false;
    while ((i < end) && text_is_blank(a[i + 2u])) {
        i += 1u;
    }
    while ((end > i) && text_is_blank(a[end + 1u])) {
        end -= 1u;
    }
    if ((i < end) && ((a[i + 2u] == (uint8_t)'-') || (a[i + 2u] == (uint8_t)'+'))) {
        *negative = a[i + 2u] == (uint8_t)'-';
        i += 1u;
    }
    if (i >= end) {
        return false;
    }
    while (i < end) {
        const uint8_t c = a[i + 2u];
        uint64_t digit;
        if ((c < (uint8_t)'0') || (c > (uint8_t)'9')) {
            return false;
        }
        digit = (uint64_t)c - (uint64_t)'0';
        if (*v > ((UINT64_MAX - digit) / 10u)) {
            return false;
        }
        *v = (*v * 10u) + digit;
        i += 1u;
    }
    return true;
}

/*: text_to_bool */
static bool text_to_bool(const uint8_t *a, uint8_t *fault)
{
    static const char *const word[4] = { "TRUE", "1", "FALSE", "0" };
    uint32_t first = 0;
    uint32_t end = text_size(a);
    while ((first < end) && text_is_blank(a[first + 2u])) {
        first += 1u;
    }
    while ((end > first) && text_is_blank(a[end + 1u])) {
        end -= 1u;
    }
    for (uint32_t i = 0; i < 4u; i++) {
        uint32_t k = 0;
        while (((first + k) < end) && (word[i][k] != '\0') && (a[first + k + 2u] == (uint8_t)word[i][k])) {
            k += 1u;
        }
        if (((first + k) == end) && (word[i][k] == '\0')) {
            return i < 2u;
        }
    }
    fail(fault, FAULT_RANGE);
    return false;
}
