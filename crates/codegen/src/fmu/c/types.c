/* The types of what a value of the chart is, and how it may be set. */

typedef enum {
    FMU_BOOL,
    FMU_I8,
    FMU_I16,
    FMU_I32,
    FMU_I64,
    FMU_U8,
    FMU_U16,
    FMU_U32,
    FMU_U64,
    FMU_F32,
    FMU_F64,
    FMU_TIME, /* 64 bits of nanoseconds, told in seconds */
    FMU_TEXT, /* its length in two bytes, then its bytes */
    FMU_STEP, /* whether a step is active */
    FMU_PERIOD, /* the time between two scans */
    FMU_CLOCK /* the time of the simulation */
} fmu_kind;

typedef enum {
    FMU_INPUT,
    FMU_START, /* set before the first scan alone: outputs, variables, parameters */
    FMU_READ /* read alone */
} fmu_use;

typedef struct {
    fmu_kind kind;
    fmu_use use;
    size_t at; /* where it stands in the state of the chart; the number of a step */
    size_t room; /* the most bytes of a text */
    size_t copy; /* where the copy of a text for readers stands */
} fmu_variable;
