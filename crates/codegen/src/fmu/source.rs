//! The C file that gives a chart the functions of FMI: what is named after the chart, the table of its
//! variables, and the texts of `c/`, which are the same for all charts.

use std::fmt::Write as _;

use super::variables::{Kind, Role, Variable};
use super::version::Version;
use crate::runtime::FAULTS;

/// Stands for the token until all else is known.
pub(super) const TOKEN: &str = "@token@";

const TYPES: &str = include_str!("c/types.c");
const CORE: &str = include_str!("c/core.c");
const FMI2: &str = include_str!("c/fmi2.c");
const FMI3: &str = concat!(include_str!("c/fmi3.c"), "\n", include_str!("c/fmi3_rest.c"));

/// Its name and its text.
pub(super) fn source(all: &[Variable], version: Version, name: &str, period: i64) -> (String, String) {
    let (number, functions) = match version {
        Version::V2 => ("2", FMI2),
        Version::V3 => ("3", FMI3),
    };
    let mut text = format!(
        "/* The chart {name} as an FMU (FMI {number}.0, Co-Simulation), printed by G7.\n *\n \
         * The functions have the names of the standard. To link several FMUs into one program, define a prefix for\n \
         * each: FMI{number}_FUNCTION_PREFIX={name}_ */\n\
         #include \"{name}.h\"\n#include <stdarg.h>\n#include <stddef.h>\n#include <stdio.h>\n#include <stdlib.h>\n\
         #include <string.h>\n\n\
         typedef {name}_state fmu_chart;\n#define fmu_chart_init {name}_init\n#define fmu_chart_scan {name}_scan_in_place\n\
         #define fmu_chart_is_active {name}_is_active\n\n\
         #if defined(FMI{number}_FUNCTION_PREFIX) && !defined(FMI{number}_OVERRIDE_FUNCTION_PREFIX)\n\
         #define FMU_JOINED(prefix, name) prefix##name\n#define FMU_JOIN(prefix, name) FMU_JOINED(prefix, name)\n\
         #define FMU_FULL(name) FMU_JOIN(FMI{number}_FUNCTION_PREFIX, name)\n#else\n\
         #define FMU_FULL(name) name\n#endif\n\n\
         #if defined(_WIN32)\n#define FMU_EXPORT __declspec(dllexport)\n#elif defined(__GNUC__)\n\
         #define FMU_EXPORT __attribute__((visibility(\"default\")))\n#else\n#define FMU_EXPORT\n#endif\n\n\
         #define FMU_TOKEN \"{TOKEN}\"\n#define FMU_PERIOD_NS INT64_C({period})\n\n"
    );
    text += TYPES;
    text += &table(all);
    for part in [CORE, functions] {
        text.push('\n');
        text += part;
    }
    (format!("{name}_fmi{number}.c"), text)
}

fn table(all: &[Variable]) -> String {
    let mut text = String::from(
        "\n/* The variables; their references count from 0. */\nstatic const fmu_variable fmu_variables[] = {\n",
    );
    let mut copy = 0;
    for (i, v) in all.iter().enumerate() {
        let place = match v.kind {
            Kind::Step | Kind::Period | Kind::Clock => v.place.clone(),
            _ => format!("offsetof(fmu_chart, {})", v.place),
        };
        let room = if let Kind::Text(room) = v.kind { usize::from(room) } else { 0 };
        let _ = writeln!(
            text,
            "    {{FMU_{}, {}, {place}, {room}, {copy}}}, /* {i} */",
            word(v.kind),
            usage(v.role)
        );
        copy += if matches!(v.kind, Kind::Text(_)) { room + 1 } else { 0 };
    }
    let _ = writeln!(
        text,
        "}};\n#define FMU_COUNT (sizeof fmu_variables / sizeof fmu_variables[0])\n\
         /* Bytes of all copies of texts. */\n#define FMU_TEXTS {copy}\n\n\
         /* The faults that stop a scan. */\nstatic const char *const fmu_faults[] = {{"
    );
    for (_, note) in FAULTS {
        let _ = writeln!(text, "    \"{note}\",");
    }
    text + "};\n"
}

fn word(kind: Kind) -> &'static str {
    match kind {
        Kind::Bool => "BOOL",
        Kind::I8 => "I8",
        Kind::I16 => "I16",
        Kind::I32 => "I32",
        Kind::I64 => "I64",
        Kind::U8 => "U8",
        Kind::U16 => "U16",
        Kind::U32 => "U32",
        Kind::U64 => "U64",
        Kind::F32 => "F32",
        Kind::F64 => "F64",
        Kind::Time => "TIME",
        Kind::Text(_) => "TEXT",
        Kind::Step => "STEP",
        Kind::Period => "PERIOD",
        Kind::Clock => "CLOCK",
    }
}

fn usage(role: Role) -> &'static str {
    match role {
        Role::Input => "FMU_INPUT",
        Role::Output | Role::Local | Role::Parameter => "FMU_START",
        Role::Step | Role::Time => "FMU_READ",
    }
}
