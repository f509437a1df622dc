/* An instance of the chart: what both versions of FMI have in common.
 *
 * Scans are due at 0, 1, 2 … periods after the start. A step from t to t + h makes those that are
 * due from t on and before t + h, with the inputs as they stand. */

typedef enum { FMU_CREATED, FMU_INITIALIZING, FMU_STEPPING, FMU_TERMINATED } fmu_phase;

/* What a saved state holds. There are no pointers in it. */
typedef struct {
    fmu_chart chart;
    double start; /* the time of the first scan, in seconds */
    int64_t period; /* nanoseconds; so are the next two, from the start on */
    int64_t next; /* when the next scan is due */
    int64_t end; /* where the last step ended */
    fmu_phase phase;
} fmu_memory;

typedef struct fmu_instance {
    fmu_memory m;
    char texts[FMU_TEXTS + 1];
    char *name;
    void *environment;
    void (*log)(const struct fmu_instance *f, const char *message);
    void (*callback)(void);
} fmu_instance;

static void fmu_say(const fmu_instance *f, const char *format, ...)
{
    char message[400];
    va_list rest;
    va_start(rest, format);
    (void)vsnprintf(message, sizeof message, format, rest);
    va_end(rest);
    f->log(f, message);
}

static void fmu_reset(fmu_instance *f)
{
    memset(&f->m, 0, sizeof f->m);
    fmu_chart_init(&f->m.chart);
    f->m.period = FMU_PERIOD_NS;
    f->m.phase = FMU_CREATED;
}

static fmu_instance *fmu_new(const char *name)
{
    const size_t size = name == NULL ? 0 : strlen(name);
    fmu_instance *f = (fmu_instance *)calloc(1, sizeof *f);
    if (f == NULL) {
        return NULL;
    }
    f->name = (char *)calloc(size + 1, 1);
    if (f->name == NULL) {
        free(f);
        return NULL;
    }
    if (size > 0) {
        memcpy(f->name, name, size);
    }
    fmu_reset(f);
    return f;
}

static void fmu_free(fmu_instance *f)
{
    if (f != NULL) {
        free(f->name);
        free(f);
    }
}

/* Seconds as whole nanoseconds; false where 64 bits have no room for them. */
static bool fmu_nanoseconds(double seconds, int64_t *to)
{
    if (!(seconds > -9.2e9 && seconds < 9.2e9)) {
        return false;
    }
    *to = (int64_t)(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
    return true;
}

static double fmu_seconds(int64_t nanoseconds)
{
    return (double)nanoseconds / 1e9;
}

/* True in the phase; otherwise the caller has come at a wrong time. */
static bool fmu_in(const fmu_instance *f, fmu_phase phase, const char *function)
{
    if (f == NULL) {
        return false;
    }
    if (f->m.phase == phase) {
        return true;
    }
    fmu_say(f, "%s is not allowed now", function);
    return false;
}

static bool fmu_initialize(fmu_instance *f, double start)
{
    int64_t unused;
    if (!fmu_nanoseconds(start, &unused)) {
        fmu_say(f, "the start time is no time");
        return false;
    }
    f->m.start = start;
    f->m.phase = FMU_INITIALIZING;
    return true;
}

/* The scans of a step. */
static bool fmu_step(fmu_instance *f, double from, double size)
{
    int64_t begin;
    int64_t end;
    /* The sums of a simulator's steps are not quite whole periods. */
    const int64_t near = f->m.period / 1000 > 0 ? f->m.period / 1000 : 1;
    if (!(size > 0) || !fmu_nanoseconds(from - f->m.start, &begin) ||
        !fmu_nanoseconds(from - f->m.start + size, &end)) {
        fmu_say(f, "a step of %g s from %g s on cannot be made", size, from);
        return false;
    }
    if (begin > f->m.end + near || begin < f->m.end - near) {
        fmu_say(f, "a step begins at %g s, but the last one ended at %g s", from,
                f->m.start + fmu_seconds(f->m.end));
        return false;
    }
    while (f->m.next < end - (near > 1 ? near : 0)) {
        const uint8_t fault = fmu_chart_scan(&f->m.chart, f->m.next);
        if (fault != 0) {
            const size_t known = sizeof fmu_faults / sizeof fmu_faults[0];
            fmu_say(f, "fault in the scan at %g s: %s", f->m.start + fmu_seconds(f->m.next),
                    fault < known ? fmu_faults[fault] : "unknown");
            return false;
        }
        f->m.next += f->m.period;
    }
    f->m.end = end;
    return true;
}

static bool fmu_is_one_of(fmu_kind kind, uint32_t kinds)
{
    return ((kinds >> (unsigned)kind) & 1U) != 0;
}

/* The variable with this reference, if it is of one of the kinds. */
static const fmu_variable *fmu_find(const fmu_instance *f, uint32_t reference, uint32_t kinds)
{
    if (reference >= FMU_COUNT) {
        fmu_say(f, "there is no variable with the reference %lu", (unsigned long)reference);
        return NULL;
    }
    if (!fmu_is_one_of(fmu_variables[reference].kind, kinds)) {
        fmu_say(f, "variable %lu has another type", (unsigned long)reference);
        return NULL;
    }
    return &fmu_variables[reference];
}

static bool fmu_may_set(const fmu_instance *f, const fmu_variable *v)
{
    const bool early = f->m.phase == FMU_CREATED || f->m.phase == FMU_INITIALIZING;
    if (f->m.phase != FMU_TERMINATED && (v->use == FMU_INPUT || (v->use == FMU_START && early))) {
        return true;
    }
    fmu_say(f, "variable %lu cannot be set now", (unsigned long)(v - fmu_variables));
    return false;
}

static void fmu_read(const fmu_instance *f, const fmu_variable *v, void *to, size_t size)
{
    memcpy(to, (const char *)&f->m.chart + v->at, size);
}

static void fmu_write(fmu_instance *f, const fmu_variable *v, const void *from, size_t size)
{
    memcpy((char *)&f->m.chart + v->at, from, size);
}

/* A Boolean or a step. */
static bool fmu_truth(const fmu_instance *f, const fmu_variable *v)
{
    bool value;
    if (v->kind == FMU_STEP) {
        return fmu_chart_is_active(&f->m.chart, (uint32_t)v->at);
    }
    fmu_read(f, v, &value, sizeof value);
    return value;
}

/* A time in seconds. */
static double fmu_time(const fmu_instance *f, const fmu_variable *v)
{
    int64_t value;
    if (v->kind == FMU_PERIOD) {
        return fmu_seconds(f->m.period);
    }
    if (v->kind == FMU_CLOCK) {
        return f->m.start + fmu_seconds(f->m.end);
    }
    fmu_read(f, v, &value, sizeof value);
    return fmu_seconds(value);
}

static bool fmu_set_time(fmu_instance *f, const fmu_variable *v, double seconds)
{
    int64_t value;
    if (!fmu_nanoseconds(seconds, &value)) {
        fmu_say(f, "%g s is no time that variable %lu can hold", seconds, (unsigned long)(v - fmu_variables));
        return false;
    }
    if (v->kind != FMU_PERIOD) {
        fmu_write(f, v, &value, sizeof value);
        return true;
    }
    if (value < 1) {
        fmu_say(f, "the period of scans is at least 1 ns");
        return false;
    }
    f->m.period = value;
    return true;
}

/* A text for readers: it stays until it is read again. */
static const char *fmu_text(fmu_instance *f, const fmu_variable *v)
{
    const uint8_t *from = (const uint8_t *)&f->m.chart + v->at;
    const size_t said = (size_t)from[0] | (size_t)from[1] << 8;
    const size_t size = said < v->room ? said : v->room;
    char *to = f->texts + v->copy;
    memcpy(to, from + 2, size);
    to[size] = 0;
    return to;
}

static bool fmu_set_text(fmu_instance *f, const fmu_variable *v, const char *text)
{
    uint8_t *to = (uint8_t *)&f->m.chart + v->at;
    const size_t size = text == NULL ? 0 : strlen(text);
    if (text == NULL || size > v->room) {
        fmu_say(f, "variable %lu holds a text of at most %lu bytes", (unsigned long)(v - fmu_variables),
                (unsigned long)v->room);
        return false;
    }
    memset(to, 0, v->room + 2);
    to[0] = (uint8_t)(size & 255U);
    to[1] = (uint8_t)(size >> 8);
    memcpy(to + 2, text, size);
    return true;
}

/* A saved state; where there is one already, it is written anew. */
static bool fmu_save(const fmu_instance *f, void **state)
{
    if (*state == NULL) {
        *state = malloc(sizeof f->m);
    }
    if (*state == NULL) {
        fmu_say(f, "no memory is left for a state");
        return false;
    }
    memcpy(*state, &f->m, sizeof f->m);
    return true;
}

/* A serialized state begins with the token, because another program has other states. */
#define FMU_TOKEN_SIZE (sizeof FMU_TOKEN - 1)
#define FMU_SERIALIZED (FMU_TOKEN_SIZE + sizeof(fmu_memory))

static bool fmu_serialize(const fmu_instance *f, const void *state, void *to, size_t size)
{
    if (state == NULL || to == NULL || size < FMU_SERIALIZED) {
        fmu_say(f, "a state takes %lu bytes", (unsigned long)FMU_SERIALIZED);
        return false;
    }
    memcpy(to, FMU_TOKEN, FMU_TOKEN_SIZE);
    memcpy((char *)to + FMU_TOKEN_SIZE, state, sizeof(fmu_memory));
    return true;
}

static bool fmu_deserialize(const fmu_instance *f, const void *from, size_t size, void **state)
{
    if (from == NULL || size != FMU_SERIALIZED || memcmp(from, FMU_TOKEN, FMU_TOKEN_SIZE) != 0) {
        fmu_say(f, "these bytes are no state of this chart");
        return false;
    }
    if (*state == NULL) {
        *state = malloc(sizeof(fmu_memory));
    }
    if (*state == NULL) {
        fmu_say(f, "no memory is left for a state");
        return false;
    }
    memcpy(*state, (const char *)from + FMU_TOKEN_SIZE, sizeof(fmu_memory));
    return true;
}
