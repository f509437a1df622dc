/* Texts in fixed room. */

/* Texts: two bytes of length, then UTF-8; what is not used is zero. */
static uint32_t text_size(const uint8_t *a)
{
    return (uint32_t)a[0] | ((uint32_t)a[1] << 8);
}

static void text_clear(uint8_t *to, uint32_t most)
{
    for (uint32_t i = 0; i < (most + 2U); i++) {
        to[i] = 0;
    }
}

/* Appends bytes, character by character; whether all of them fit. */
static bool text_append(const uint8_t *from, uint32_t first, uint32_t end, uint8_t *to, uint32_t most)
{
    uint32_t size = text_size(to);
    uint32_t i = first;
    while (i < end) {
        uint32_t next = i + 1U;
        while ((next < end) && ((from[next + 2U] & 0xC0U) == 0x80U)) {
            next += 1U;
        }
        if ((size + (next - i)) > most) {
            return false;
        }
        while (i < next) {
            to[size + 2U] = from[i + 2U];
            size += 1U;
            i += 1U;
        }
        to[0] = (uint8_t)(size & 255U);
        to[1] = (uint8_t)(size >> 8);
    }
    return true;
}

/* The byte behind `count` characters from byte `from` on. */
static uint32_t text_skip(const uint8_t *a, uint32_t from, int64_t count)
{
    const uint32_t size = text_size(a);
    uint32_t i = from;
    int64_t left = count;
    while ((left > 0) && (i < size)) {
        i += 1U;
        while ((i < size) && ((a[i + 2U] & 0xC0U) == 0x80U)) {
            i += 1U;
        }
        left -= 1;
    }
    return i;
}

static int64_t text_len(const uint8_t *a)
{
    const uint32_t size = text_size(a);
    int64_t count = 0;
    for (uint32_t i = 0; i < size; i++) {
        if ((a[i + 2U] & 0xC0U) != 0x80U) {
            count += 1;
        }
    }
    return count;
}

static int32_t text_compare(const uint8_t *a, const uint8_t *b)
{
    const uint32_t size_a = text_size(a);
    const uint32_t size_b = text_size(b);
    for (uint32_t i = 0; (i < size_a) && (i < size_b); i++) {
        if (a[i + 2U] != b[i + 2U]) {
            return (a[i + 2U] < b[i + 2U]) ? -1 : 1;
        }
    }
    return (size_a == size_b) ? 0 : ((size_a < size_b) ? -1 : 1);
}

static int64_t text_find(const uint8_t *a, const uint8_t *b)
{
    const uint32_t size_a = text_size(a);
    const uint32_t size_b = text_size(b);
    int64_t character = 0;
    if (size_b == 0U) {
        return 0;
    }
    for (uint32_t i = 0; (i + size_b) <= size_a; i++) {
        uint32_t k = 0;
        if ((a[i + 2U] & 0xC0U) != 0x80U) {
            character += 1;
        }
        while ((k < size_b) && (a[i + k + 2U] == b[k + 2U])) {
            k += 1U;
        }
        if (k == size_b) {
            return character;
        }
    }
    return 0;
}

static void text_copy(const uint8_t *a, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    (void)text_append(a, 0, text_size(a), to, most);
}

static void text_left(const uint8_t *a, int64_t n, uint8_t *to, uint32_t most, uint8_t *fault)
{
    if (n < 0) {
        fail(fault, FAULT_RANGE);
        return;
    }
    text_clear(to, most);
    (void)text_append(a, 0, text_skip(a, 0, n), to, most);
}

static void text_right(const uint8_t *a, int64_t n, uint8_t *to, uint32_t most, uint8_t *fault)
{
    if (n < 0) {
        fail(fault, FAULT_RANGE);
        return;
    }
    text_clear(to, most);
    (void)text_append(a, text_skip(a, 0, text_len(a) - n), text_size(a), to, most);
}

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

static void text_concat(const uint8_t *a, const uint8_t *b, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    if (text_append(a, 0, text_size(a), to, most)) {
        (void)text_append(b, 0, text_size(b), to, most);
    }
}

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

/* Appends plain letters; what does not fit is left away. */
static void text_put(const char *letters, uint8_t *to, uint32_t most)
{
    uint32_t size = text_size(to);
    for (uint32_t i = 0; (letters[i] != '\0') && (size < most); i++) {
        to[size + 2U] = (uint8_t)letters[i];
        size += 1U;
    }
    to[0] = (uint8_t)(size & 255U);
    to[1] = (uint8_t)(size >> 8);
}

static void text_put_number(uint64_t v, uint8_t *to, uint32_t most)
{
    static const char digits[11] = "0123456789";
    char letters[21];
    uint32_t at = 20;
    uint64_t left = v;
    letters[at] = '\0';
    do {
        at -= 1U;
        letters[at] = digits[left % 10U];
        left /= 10U;
    } while (left != 0U);
    text_put(&letters[at], to, most);
}

static void text_from_u64(uint64_t v, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    text_put_number(v, to, most);
}

static void text_from_i64(int64_t v, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    if (v < 0) {
        text_put("-", to, most);
        text_put_number(~(uint64_t)v + 1U, to, most);
    } else {
        text_put_number((uint64_t)v, to, most);
    }
}

static void text_from_bool(bool v, uint8_t *to, uint32_t most)
{
    text_clear(to, most);
    text_put(v ? "TRUE" : "FALSE", to, most);
}

static void text_from_time(int64_t v, uint8_t *to, uint32_t most)
{
    static const uint64_t unit[7] = {
        UINT64_C(86400000000000), UINT64_C(3600000000000), UINT64_C(60000000000), UINT64_C(1000000000),
        UINT64_C(1000000), UINT64_C(1000), UINT64_C(1)
    };
    static const char *const name[7] = { "d", "h", "m", "s", "ms", "us", "ns" };
    uint64_t left = (v < 0) ? (~(uint64_t)v + 1U) : (uint64_t)v;
    text_clear(to, most);
    text_put((v < 0) ? "T#-" : "T#", to, most);
    if (left == 0U) {
        text_put("0s", to, most);
    }
    for (uint32_t i = 0; i < 7U; i++) {
        if (left >= unit[i]) {
            text_put_number(left / unit[i], to, most);
            text_put(name[i], to, most);
            left %= unit[i];
        }
    }
}

static bool text_is_blank(uint8_t c)
{
    return (c == 0x20U) || ((c >= 0x09U) && (c <= 0x0DU));
}

/* A whole number with its sign; blanks round it do not count. */
static bool text_number(const uint8_t *a, uint64_t *v, bool *negative)
{
    uint32_t i = 0;
    uint32_t end = text_size(a);
    *v = 0;
    *negative = false;
    while ((i < end) && text_is_blank(a[i + 2U])) {
        i += 1U;
    }
    while ((end > i) && text_is_blank(a[end + 1U])) {
        end -= 1U;
    }
    if ((i < end) && ((a[i + 2U] == (uint8_t)'-') || (a[i + 2U] == (uint8_t)'+'))) {
        *negative = a[i + 2U] == (uint8_t)'-';
        i += 1U;
    }
    if (i >= end) {
        return false;
    }
    while (i < end) {
        const uint8_t c = a[i + 2U];
        uint64_t digit;
        if ((c < (uint8_t)'0') || (c > (uint8_t)'9')) {
            return false;
        }
        digit = (uint64_t)c - (uint64_t)'0';
        if (*v > ((UINT64_MAX - digit) / 10U)) {
            return false;
        }
        *v = (*v * 10U) + digit;
        i += 1U;
    }
    return true;
}

static bool text_to_bool(const uint8_t *a, uint8_t *fault)
{
    static const char *const word[4] = { "TRUE", "1", "FALSE", "0" };
    uint32_t first = 0;
    uint32_t end = text_size(a);
    while ((first < end) && text_is_blank(a[first + 2U])) {
        first += 1U;
    }
    while ((end > first) && text_is_blank(a[end + 1U])) {
        end -= 1U;
    }
    for (uint32_t i = 0; i < 4U; i++) {
        uint32_t k = 0;
        while (((first + k) < end) && (word[i][k] != '\0') && (a[first + k + 2U] == (uint8_t)word[i][k])) {
            k += 1U;
        }
        if (((first + k) == end) && (word[i][k] == '\0')) {
            return i < 2U;
        }
    }
    fail(fault, FAULT_RANGE);
    return false;
}

static uint64_t text_to_u64(const uint8_t *a, uint8_t *fault)
{
    bool negative = false;
    uint64_t v = 0;
    if (!text_number(a, &v, &negative) || (negative && (v > 0U))) {
        fail(fault, FAULT_RANGE);
        return 0;
    }
    return (uint64_t)v;
}
