/* The numbers of src/faults.rs. */

enum {
    FAULT_NONE = 0,
    FAULT_UNSTABLE = 1,
    FAULT_BOUND = 2,
    FAULT_OVERFLOW = 3,
    FAULT_DIVISION = 4,
    FAULT_RANGE = 5,
    FAULT_FORCING = 6,
    FAULT_TABLE = 7,
    FAULT_INPUTS = 8,
    FAULT_STOPPED = 9
};
