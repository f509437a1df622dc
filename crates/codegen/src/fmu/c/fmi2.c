/* The functions of FMI 2.0 for Co-Simulation. */

typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef unsigned int fmi2ValueReference;
typedef void *fmi2Component;
typedef void *fmi2FMUstate;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef void (*fmi2Logger)(void *environment, fmi2String name, fmi2Status status, fmi2String category,
                           fmi2String message, ...);

/* What the simulator offers. Memory comes from the C library, and no step is asynchronous. */
typedef struct {
    fmi2Logger logger;
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *memory);
    void (*stepFinished)(void *environment, fmi2Status status);
    void *componentEnvironment;
} fmi2CallbackFunctions;

#define FMI2(type) FMU_EXPORT type
#define INSTANCE fmu_instance *f = (fmu_instance *)component
#define KIND(k) (1U << (unsigned)(k))
#define INTEGERS (KIND(FMU_I8) | KIND(FMU_I16) | KIND(FMU_I32) | KIND(FMU_U8) | KIND(FMU_U16))
#define REALS                                                                                                  \
    (KIND(FMU_F32) | KIND(FMU_F64) | KIND(FMU_TIME) | KIND(FMU_PERIOD) | KIND(FMU_U32) | KIND(FMU_I64) |       \
     KIND(FMU_U64))

static void tell(const fmu_instance *f, const char *message)
{
    const fmi2Logger logger = (fmi2Logger)f->callback;
    if (logger != NULL) {
        logger(f->environment, f->name, fmi2Error, "logStatusError", "%s", message);
    }
}

static fmi2Status ok(bool fine)
{
    return fine ? fmi2OK : fmi2Error;
}

static fmi2Status refused(fmi2Component component, const char *function)
{
    INSTANCE;
    if (f != NULL) {
        fmu_say(f, "%s is not supported", function);
    }
    return fmi2Error;
}

FMI2(const char *) FMU_FULL(fmi2GetTypesPlatform)(void)
{
    return "default";
}

FMI2(const char *) FMU_FULL(fmi2GetVersion)(void)
{
    return "2.0";
}

/* Errors are always told, and nothing else is. */
FMI2(fmi2Status)
FMU_FULL(fmi2SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t count, const fmi2String names[])
{
    (void)on;
    for (size_t i = 0; i < count; i++) {
        if (names == NULL || names[i] == NULL || strcmp(names[i], "logStatusError") != 0) {
            INSTANCE;
            if (f != NULL) {
                fmu_say(f, "the only category of messages is logStatusError");
            }
            return fmi2Error;
        }
    }
    return ok(component != NULL);
}

FMI2(fmi2Component)
FMU_FULL(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                          const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    const char *wrong = NULL;
    fmu_instance *f;
    (void)resources;
    (void)visible;
    (void)logging;
    if (type != fmi2CoSimulation) {
        wrong = "the chart is for Co-Simulation alone";
    } else if (guid == NULL || strcmp(guid, FMU_TOKEN) != 0) {
        wrong = "the GUID is that of another FMU";
    } else if (name == NULL || name[0] == 0) {
        wrong = "an instance needs a name";
    }
    if (wrong != NULL) {
        if (functions != NULL && functions->logger != NULL) {
            functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError", "%s", wrong);
        }
        return NULL;
    }
    f = fmu_new(name);
    if (f != NULL) {
        f->log = tell;
        if (functions != NULL) {
            f->environment = functions->componentEnvironment;
            f->callback = (void (*)(void))functions->logger;
        }
    }
    return f;
}

FMI2(void) FMU_FULL(fmi2FreeInstance)(fmi2Component component)
{
    fmu_free((fmu_instance *)component);
}

FMI2(fmi2Status)
FMU_FULL(fmi2SetupExperiment)(fmi2Component component, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start,
                              fmi2Boolean ends, fmi2Real stop)
{
    INSTANCE;
    (void)tolerant;
    (void)tolerance;
    if (!fmu_in(f, FMU_CREATED, "fmi2SetupExperiment")) {
        return fmi2Error;
    }
    if (ends && !(stop > start)) {
        fmu_say(f, "the simulation ends at %g s, before it starts", stop);
        return fmi2Error;
    }
    f->m.start = start;
    return fmi2OK;
}

FMI2(fmi2Status) FMU_FULL(fmi2EnterInitializationMode)(fmi2Component component)
{
    INSTANCE;
    return ok(fmu_in(f, FMU_CREATED, "fmi2EnterInitializationMode") && fmu_initialize(f, f->m.start));
}

FMI2(fmi2Status) FMU_FULL(fmi2ExitInitializationMode)(fmi2Component component)
{
    INSTANCE;
    if (!fmu_in(f, FMU_INITIALIZING, "fmi2ExitInitializationMode")) {
        return fmi2Error;
    }
    f->m.phase = FMU_STEPPING;
    return fmi2OK;
}

FMI2(fmi2Status) FMU_FULL(fmi2Terminate)(fmi2Component component)
{
    INSTANCE;
    if (!fmu_in(f, FMU_STEPPING, "fmi2Terminate")) {
        return fmi2Error;
    }
    f->m.phase = FMU_TERMINATED;
    return fmi2OK;
}

FMI2(fmi2Status) FMU_FULL(fmi2Reset)(fmi2Component component)
{
    INSTANCE;
    if (f != NULL) {
        fmu_reset(f);
    }
    return ok(f != NULL);
}

static double real_of(const fmu_instance *f, const fmu_variable *v)
{
    double d;
    float s;
    uint32_t u;
    int64_t i;
    uint64_t l;
    switch (v->kind) {
    case FMU_F64: fmu_read(f, v, &d, sizeof d); return d;
    case FMU_F32: fmu_read(f, v, &s, sizeof s); return (double)s;
    case FMU_U32: fmu_read(f, v, &u, sizeof u); return (double)u;
    case FMU_I64: fmu_read(f, v, &i, sizeof i); return (double)i;
    case FMU_U64: fmu_read(f, v, &l, sizeof l); return (double)l;
    default: return fmu_time(f, v);
    }
}

static bool set_real(fmu_instance *f, const fmu_variable *v, double value)
{
    const float s = (float)value;
    const bool whole = value >= -9.2e18 && value <= 1.84e19 && (value >= 9e15 || (double)(int64_t)value == value);
    bool fits = true;
    if (v->kind == FMU_F64) {
        fmu_write(f, v, &value, sizeof value);
    } else if (v->kind == FMU_F32) {
        fmu_write(f, v, &s, sizeof s);
    } else if (v->kind == FMU_TIME || v->kind == FMU_PERIOD) {
        return fmu_set_time(f, v, value);
    } else if (v->kind == FMU_U32 && whole && value >= 0 && value <= 4294967295.0) {
        const uint32_t u = (uint32_t)value;
        fmu_write(f, v, &u, sizeof u);
    } else if (v->kind == FMU_I64 && whole && value <= 9.2e18) {
        const int64_t i = (int64_t)value;
        fmu_write(f, v, &i, sizeof i);
    } else if (v->kind == FMU_U64 && whole && value >= 0) {
        const uint64_t l = (uint64_t)value;
        fmu_write(f, v, &l, sizeof l);
    } else {
        fits = false;
        fmu_say(f, "variable %lu cannot hold %g", (unsigned long)(v - fmu_variables), value);
    }
    return fits;
}

static int32_t integer_of(const fmu_instance *f, const fmu_variable *v)
{
    int8_t i8;
    int16_t i16;
    int32_t i32;
    uint8_t u8;
    uint16_t u16;
    switch (v->kind) {
    case FMU_I8: fmu_read(f, v, &i8, sizeof i8); return i8;
    case FMU_I16: fmu_read(f, v, &i16, sizeof i16); return i16;
    case FMU_U8: fmu_read(f, v, &u8, sizeof u8); return u8;
    case FMU_U16: fmu_read(f, v, &u16, sizeof u16); return u16;
    default: fmu_read(f, v, &i32, sizeof i32); return i32;
    }
}

static bool set_integer(fmu_instance *f, const fmu_variable *v, int32_t value)
{
    const int8_t i8 = (int8_t)value;
    const int16_t i16 = (int16_t)value;
    const uint8_t u8 = (uint8_t)value;
    const uint16_t u16 = (uint16_t)value;
    if (v->kind == FMU_I8 && i8 == value) {
        fmu_write(f, v, &i8, sizeof i8);
    } else if (v->kind == FMU_I16 && i16 == value) {
        fmu_write(f, v, &i16, sizeof i16);
    } else if (v->kind == FMU_U8 && u8 == value) {
        fmu_write(f, v, &u8, sizeof u8);
    } else if (v->kind == FMU_U16 && u16 == value) {
        fmu_write(f, v, &u16, sizeof u16);
    } else if (v->kind == FMU_I32) {
        fmu_write(f, v, &value, sizeof value);
    } else {
        fmu_say(f, "variable %lu cannot hold %ld", (unsigned long)(v - fmu_variables), (long)value);
        return false;
    }
    return true;
}

static bool set_truth(fmu_instance *f, const fmu_variable *v, fmi2Boolean value)
{
    const bool truth = value != 0;
    fmu_write(f, v, &truth, sizeof truth);
    return true;
}

#define GETTER(name, type, kinds, of)                                                                          \
    FMI2(fmi2Status)                                                                                           \
    FMU_FULL(name)(fmi2Component component, const fmi2ValueReference which[], size_t count, type values[])     \
    {                                                                                                          \
        INSTANCE;                                                                                              \
        if (f == NULL || (count > 0 && (which == NULL || values == NULL))) {                                   \
            return fmi2Error;                                                                                  \
        }                                                                                                      \
        for (size_t i = 0; i < count; i++) {                                                                   \
            const fmu_variable *v = fmu_find(f, which[i], kinds);                                  \
            if (v == NULL) {                                                                                   \
                return fmi2Error;                                                                              \
            }                                                                                                  \
            values[i] = of(f, v);                                                                              \
        }                                                                                                      \
        return fmi2OK;                                                                                         \
    }

#define SETTER(name, type, kinds, set)                                                                         \
    FMI2(fmi2Status)                                                                                           \
    FMU_FULL(name)(fmi2Component component, const fmi2ValueReference which[], size_t count, const type values[]) \
    {                                                                                                          \
        INSTANCE;                                                                                              \
        if (f == NULL || (count > 0 && (which == NULL || values == NULL))) {                                   \
            return fmi2Error;                                                                                  \
        }                                                                                                      \
        for (size_t i = 0; i < count; i++) {                                                                   \
            const fmu_variable *v = fmu_find(f, which[i], kinds);                                  \
            if (v == NULL || !fmu_may_set(f, v) || !set(f, v, values[i])) {                                    \
                return fmi2Error;                                                                              \
            }                                                                                                  \
        }                                                                                                      \
        return fmi2OK;                                                                                         \
    }

GETTER(fmi2GetReal, fmi2Real, REALS, real_of)
GETTER(fmi2GetInteger, fmi2Integer, INTEGERS, integer_of)
GETTER(fmi2GetBoolean, fmi2Boolean, KIND(FMU_BOOL) | KIND(FMU_STEP), fmu_truth)
GETTER(fmi2GetString, fmi2String, KIND(FMU_TEXT), fmu_text)
SETTER(fmi2SetReal, fmi2Real, REALS, set_real)
SETTER(fmi2SetInteger, fmi2Integer, INTEGERS, set_integer)
SETTER(fmi2SetBoolean, fmi2Boolean, KIND(FMU_BOOL) | KIND(FMU_STEP), set_truth)
SETTER(fmi2SetString, fmi2String, KIND(FMU_TEXT), fmu_set_text)

FMI2(fmi2Status) FMU_FULL(fmi2GetFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    INSTANCE;
    return ok(f != NULL && state != NULL && fmu_save(f, state));
}

FMI2(fmi2Status) FMU_FULL(fmi2SetFMUstate)(fmi2Component component, fmi2FMUstate state)
{
    INSTANCE;
    if (f == NULL || state == NULL) {
        return fmi2Error;
    }
    memcpy(&f->m, state, sizeof f->m);
    return fmi2OK;
}

FMI2(fmi2Status) FMU_FULL(fmi2FreeFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    (void)component;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

FMI2(fmi2Status)
FMU_FULL(fmi2SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    if (component == NULL || state == NULL || size == NULL) {
        return fmi2Error;
    }
    *size = FMU_SERIALIZED;
    return fmi2OK;
}

FMI2(fmi2Status)
FMU_FULL(fmi2SerializeFMUstate)(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    INSTANCE;
    return ok(f != NULL && fmu_serialize(f, state, bytes, size));
}

FMI2(fmi2Status)
FMU_FULL(fmi2DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                  fmi2FMUstate *state)
{
    INSTANCE;
    return ok(f != NULL && state != NULL && fmu_deserialize(f, bytes, size, state));
}

FMI2(fmi2Status)
FMU_FULL(fmi2GetDirectionalDerivative)(fmi2Component component, const fmi2ValueReference unknowns[], size_t many,
                                       const fmi2ValueReference knowns[], size_t count, const fmi2Real known[],
                                       fmi2Real unknown[])
{
    (void)unknowns;
    (void)many;
    (void)knowns;
    (void)count;
    (void)known;
    (void)unknown;
    return refused(component, "fmi2GetDirectionalDerivative");
}

FMI2(fmi2Status)
FMU_FULL(fmi2SetRealInputDerivatives)(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                      const fmi2Integer order[], const fmi2Real values[])
{
    (void)which;
    (void)count;
    (void)order;
    (void)values;
    return refused(component, "fmi2SetRealInputDerivatives");
}

FMI2(fmi2Status)
FMU_FULL(fmi2GetRealOutputDerivatives)(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                       const fmi2Integer order[], fmi2Real values[])
{
    (void)which;
    (void)count;
    (void)order;
    (void)values;
    return refused(component, "fmi2GetRealOutputDerivatives");
}

FMI2(fmi2Status)
FMU_FULL(fmi2DoStep)(fmi2Component component, fmi2Real from, fmi2Real size, fmi2Boolean forward)
{
    INSTANCE;
    (void)forward;
    return ok(fmu_in(f, FMU_STEPPING, "fmi2DoStep") && fmu_step(f, from, size));
}

FMI2(fmi2Status) FMU_FULL(fmi2CancelStep)(fmi2Component component)
{
    return refused(component, "fmi2CancelStep");
}

/* No step is ever pending, so only two kinds have an answer. */
FMI2(fmi2Status) FMU_FULL(fmi2GetStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Status *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}

FMI2(fmi2Status) FMU_FULL(fmi2GetRealStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Real *value)
{
    INSTANCE;
    if (f == NULL || value == NULL || kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = f->m.start + fmu_seconds(f->m.end);
    return fmi2OK;
}

FMI2(fmi2Status) FMU_FULL(fmi2GetIntegerStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Integer *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}

FMI2(fmi2Status) FMU_FULL(fmi2GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Boolean *value)
{
    if (component == NULL || value == NULL || kind != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = 0;
    return fmi2OK;
}

FMI2(fmi2Status) FMU_FULL(fmi2GetStringStatus)(fmi2Component component, fmi2StatusKind kind, fmi2String *value)
{
    (void)component;
    (void)kind;
    (void)value;
    return fmi2Discard;
}
