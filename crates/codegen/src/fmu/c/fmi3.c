/* The functions of FMI 3.0 for Co-Simulation. */

typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;
typedef uint32_t fmi3ValueReference;
typedef void *fmi3Instance;
typedef void *fmi3FMUState;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum {
    fmi3IntervalNotYetKnown,
    fmi3IntervalUnchanged,
    fmi3IntervalChanged
} fmi3IntervalQualifier;

typedef void (*fmi3LogMessage)(void *environment, fmi3Status status, fmi3String category, fmi3String message);
typedef void (*fmi3IntermediateUpdate)(void *environment, fmi3Float64 time, fmi3Boolean sets, fmi3Boolean gets,
                                       fmi3Boolean finished, fmi3Boolean may_return, fmi3Boolean *early,
                                       fmi3Float64 *early_time);
typedef void (*fmi3ClockUpdate)(void *environment);
typedef void (*fmi3Preemption)(void);

#define FMI3(type) FMU_EXPORT type
#define INSTANCE fmu_instance *f = (fmu_instance *)instance
#define KIND(k) (1U << (unsigned)(k))

static void tell(const fmu_instance *f, const char *message)
{
    const fmi3LogMessage logger = (fmi3LogMessage)f->callback;
    if (logger != NULL) {
        logger(f->environment, fmi3Error, "logStatusError", message);
    }
}

static fmi3Status ok(bool fine)
{
    return fine ? fmi3OK : fmi3Error;
}

static fmi3Status refused(fmi3Instance instance, const char *function)
{
    INSTANCE;
    if (f != NULL) {
        fmu_say(f, "%s is not supported", function);
    }
    return fmi3Error;
}

FMI3(const char *) FMU_FULL(fmi3GetVersion)(void)
{
    return "3.0";
}

/* Errors are always told, and nothing else is. */
FMI3(fmi3Status)
FMU_FULL(fmi3SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t count, const fmi3String names[])
{
    INSTANCE;
    (void)on;
    for (size_t i = 0; i < count; i++) {
        if (names == NULL || names[i] == NULL || strcmp(names[i], "logStatusError") != 0) {
            if (f != NULL) {
                fmu_say(f, "the only category of messages is logStatusError");
            }
            return fmi3Error;
        }
    }
    return ok(f != NULL);
}

FMI3(fmi3Instance)
FMU_FULL(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                      fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                      const fmi3ValueReference between[], size_t count, void *environment,
                                      fmi3LogMessage logger, fmi3IntermediateUpdate update)
{
    const char *wrong = NULL;
    fmu_instance *f;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)early;
    (void)between;
    (void)update;
    if (token == NULL || strcmp(token, FMU_TOKEN) != 0) {
        wrong = "the token is that of another FMU";
    } else if (events) {
        wrong = "the chart has no event mode";
    } else if (count > 0) {
        wrong = "the chart has no values between two scans";
    }
    if (wrong != NULL) {
        if (logger != NULL) {
            logger(environment, fmi3Error, "logStatusError", wrong);
        }
        return NULL;
    }
    f = fmu_new(name);
    if (f != NULL) {
        f->log = tell;
        f->environment = environment;
        f->callback = (void (*)(void))logger;
    }
    return f;
}

FMI3(fmi3Instance)
FMU_FULL(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                       fmi3Boolean visible, fmi3Boolean logging, void *environment,
                                       fmi3LogMessage logger)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    if (logger != NULL) {
        logger(environment, fmi3Error, "logStatusError", "the chart is for Co-Simulation alone");
    }
    return NULL;
}

FMI3(fmi3Instance)
FMU_FULL(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                            fmi3Boolean visible, fmi3Boolean logging, void *environment,
                                            fmi3LogMessage logger, fmi3ClockUpdate update, fmi3Preemption lock,
                                            fmi3Preemption unlock)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)update;
    (void)lock;
    (void)unlock;
    if (logger != NULL) {
        logger(environment, fmi3Error, "logStatusError", "the chart is for Co-Simulation alone");
    }
    return NULL;
}

FMI3(void) FMU_FULL(fmi3FreeInstance)(fmi3Instance instance)
{
    fmu_free((fmu_instance *)instance);
}

FMI3(fmi3Status)
FMU_FULL(fmi3EnterInitializationMode)(fmi3Instance instance, fmi3Boolean tolerant, fmi3Float64 tolerance,
                                      fmi3Float64 start, fmi3Boolean ends, fmi3Float64 stop)
{
    INSTANCE;
    (void)tolerant;
    (void)tolerance;
    if (!fmu_in(f, FMU_CREATED, "fmi3EnterInitializationMode")) {
        return fmi3Error;
    }
    if (ends && !(stop > start)) {
        fmu_say(f, "the simulation ends at %g s, before it starts", stop);
        return fmi3Error;
    }
    return ok(fmu_initialize(f, start));
}

FMI3(fmi3Status) FMU_FULL(fmi3ExitInitializationMode)(fmi3Instance instance)
{
    INSTANCE;
    if (!fmu_in(f, FMU_INITIALIZING, "fmi3ExitInitializationMode")) {
        return fmi3Error;
    }
    f->m.phase = FMU_STEPPING;
    return fmi3OK;
}

FMI3(fmi3Status) FMU_FULL(fmi3Terminate)(fmi3Instance instance)
{
    INSTANCE;
    if (!fmu_in(f, FMU_STEPPING, "fmi3Terminate")) {
        return fmi3Error;
    }
    f->m.phase = FMU_TERMINATED;
    return fmi3OK;
}

FMI3(fmi3Status) FMU_FULL(fmi3Reset)(fmi3Instance instance)
{
    INSTANCE;
    if (f != NULL) {
        fmu_reset(f);
    }
    return ok(f != NULL);
}

FMI3(fmi3Status)
FMU_FULL(fmi3DoStep)(fmi3Instance instance, fmi3Float64 from, fmi3Float64 size, fmi3Boolean forward,
                     fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    INSTANCE;
    bool fine;
    (void)forward;
    if (!fmu_in(f, FMU_STEPPING, "fmi3DoStep")) {
        return fmi3Error;
    }
    fine = fmu_step(f, from, size);
    if (event != NULL) {
        *event = false;
    }
    if (terminate != NULL) {
        *terminate = false;
    }
    if (early != NULL) {
        *early = false;
    }
    if (reached != NULL) {
        *reached = fine ? from + size : f->m.start + fmu_seconds(f->m.end);
    }
    return ok(fine);
}

#define GETTER(name, type, kinds, take)                                                                        \
    FMI3(fmi3Status)                                                                                           \
    FMU_FULL(fmi3Get##name)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,             \
                            type values[], size_t room)                                                        \
    {                                                                                                          \
        INSTANCE;                                                                                              \
        if (f == NULL || room < count || (count > 0 && (which == NULL || values == NULL))) {                   \
            return fmi3Error;                                                                                  \
        }                                                                                                      \
        for (size_t i = 0; i < count; i++) {                                                                   \
            const fmu_variable *v = fmu_find(f, which[i], kinds);                                              \
            if (v == NULL) {                                                                                   \
                return fmi3Error;                                                                              \
            }                                                                                                  \
            take;                                                                                              \
        }                                                                                                      \
        return fmi3OK;                                                                                         \
    }

#define SETTER(name, type, kinds, give)                                                                        \
    FMI3(fmi3Status)                                                                                           \
    FMU_FULL(fmi3Set##name)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,             \
                            const type values[], size_t room)                                                  \
    {                                                                                                          \
        INSTANCE;                                                                                              \
        if (f == NULL || room < count || (count > 0 && (which == NULL || values == NULL))) {                   \
            return fmi3Error;                                                                                  \
        }                                                                                                      \
        for (size_t i = 0; i < count; i++) {                                                                   \
            const fmu_variable *v = fmu_find(f, which[i], kinds);                                              \
            if (v == NULL || !fmu_may_set(f, v) || !give(f, v, values[i])) {                                   \
                return fmi3Error;                                                                              \
            }                                                                                                  \
        }                                                                                                      \
        return fmi3OK;                                                                                         \
    }

/* A type that the chart keeps as it is. */
#define PLAIN(name, type, kind)                                                                                \
    static bool put_##name(fmu_instance *f, const fmu_variable *v, type value)                                 \
    {                                                                                                          \
        fmu_write(f, v, &value, sizeof value);                                                                 \
        return true;                                                                                           \
    }                                                                                                          \
    GETTER(name, type, KIND(kind), fmu_read(f, v, &values[i], sizeof values[i]))                               \
    SETTER(name, type, KIND(kind), put_##name)

PLAIN(Float32, fmi3Float32, FMU_F32)
PLAIN(Int8, fmi3Int8, FMU_I8)
PLAIN(UInt8, fmi3UInt8, FMU_U8)
PLAIN(Int16, fmi3Int16, FMU_I16)
PLAIN(UInt16, fmi3UInt16, FMU_U16)
PLAIN(Int32, fmi3Int32, FMU_I32)
PLAIN(UInt32, fmi3UInt32, FMU_U32)
PLAIN(Int64, fmi3Int64, FMU_I64)
PLAIN(UInt64, fmi3UInt64, FMU_U64)

#define DOUBLES (KIND(FMU_F64) | KIND(FMU_TIME) | KIND(FMU_PERIOD) | KIND(FMU_CLOCK))

static double double_of(const fmu_instance *f, const fmu_variable *v)
{
    double value;
    if (v->kind != FMU_F64) {
        return fmu_time(f, v);
    }
    fmu_read(f, v, &value, sizeof value);
    return value;
}

static bool put_double(fmu_instance *f, const fmu_variable *v, double value)
{
    if (v->kind != FMU_F64) {
        return fmu_set_time(f, v, value);
    }
    fmu_write(f, v, &value, sizeof value);
    return true;
}

static bool put_truth(fmu_instance *f, const fmu_variable *v, fmi3Boolean value)
{
    fmu_write(f, v, &value, sizeof value);
    return true;
}

GETTER(Float64, fmi3Float64, DOUBLES, values[i] = double_of(f, v))
SETTER(Float64, fmi3Float64, DOUBLES, put_double)
GETTER(Boolean, fmi3Boolean, KIND(FMU_BOOL) | KIND(FMU_STEP), values[i] = fmu_truth(f, v))
SETTER(Boolean, fmi3Boolean, KIND(FMU_BOOL) | KIND(FMU_STEP), put_truth)
GETTER(String, fmi3String, KIND(FMU_TEXT), values[i] = fmu_text(f, v))
SETTER(String, fmi3String, KIND(FMU_TEXT), fmu_set_text)

FMI3(fmi3Status) FMU_FULL(fmi3GetFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    INSTANCE;
    return ok(f != NULL && state != NULL && fmu_save(f, state));
}

FMI3(fmi3Status) FMU_FULL(fmi3SetFMUState)(fmi3Instance instance, fmi3FMUState state)
{
    INSTANCE;
    if (f == NULL || state == NULL) {
        return fmi3Error;
    }
    memcpy(&f->m, state, sizeof f->m);
    return fmi3OK;
}

FMI3(fmi3Status) FMU_FULL(fmi3FreeFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

FMI3(fmi3Status)
FMU_FULL(fmi3SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    if (instance == NULL || state == NULL || size == NULL) {
        return fmi3Error;
    }
    *size = FMU_SERIALIZED;
    return fmi3OK;
}

FMI3(fmi3Status)
FMU_FULL(fmi3SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    INSTANCE;
    return ok(f != NULL && fmu_serialize(f, state, bytes, size));
}

FMI3(fmi3Status)
FMU_FULL(fmi3DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    INSTANCE;
    return ok(f != NULL && state != NULL && fmu_deserialize(f, bytes, size, state));
}
