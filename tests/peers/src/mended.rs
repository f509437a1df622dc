//! The C library of matiec as tests use it: with its known faults mended.

use std::path::Path;

/// Copies matiec's C library and changes it where it contradicts IEC 61131-3:2003, or has another unit than G7:
///
/// - Counters count to PVmin and PVmax (table 36), not to 0 and PV.
/// - The sum of two TIMEs is right where the parts of a second make exactly one; the product of a TIME is computed in a
///   type that holds its nanoseconds.
/// - A TIME or TOD is converted to a number, and a number to it, in milliseconds, as in CODESYS, TwinCAT and G7. matiec
///   has seconds; the standard leaves the unit open.
/// - A shift by as many bits as the type has, or more, gives 0. C leaves the result open.
/// - LIMIT is MIN(MAX(IN, MN), MX) (table 27), also where MN is greater than MX.
///
/// # Errors
///
/// A file cannot be read or written.
pub fn mended(from: &Path, to: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let text = std::fs::read_to_string(entry.path())?;
        let text = match entry.file_name().to_str() {
            Some("iec_std_FB.h") => counters(&text),
            Some("iec_std_lib.h") => {
                let text = text.replace("tv_nsec > 1000000000", "tv_nsec >= 1000000000");
                let text = text.replace(
                    "static inline TIME __time_add(",
                    &format!("{OF_NANOSECONDS}static inline TIME __time_add("),
                );
                let product = "  LREAL s_f = IN1.tv_sec * IN2;";
                let text = text.replace(product, &format!("  return __of_ns(__ns(IN1) * IN2);\n{product}"));
                text.replace(
                    "static inline TIME    __int_to_time(LINT IN)",
                    &format!("{MILLISECONDS}\nstatic inline TIME    __int_to_time(LINT IN)"),
                )
            }
            Some("iec_std_functions.h") => limits(&shifts(&milliseconds(&text))),
            _ => text,
        };
        std::fs::write(to.join(entry.file_name()), text)?;
    }
    Ok(())
}

/// Changes the C that matiec made of a program: a FOR loop from a value to the same value runs once (IEC 61131-3:2003,
/// 3.3.2.4). In the C of matiec it does not run.
pub fn loops(text: &str) -> String {
    let mut mended = String::new();
    let mut counts = false;
    for line in text.lines() {
        match line.trim().strip_prefix("while(").and_then(|l| l.strip_suffix(") {")).filter(|_| counts) {
            Some(less) => {
                let most = less.replace(" < ", " <= ").replace(" > ", " >= ");
                mended += &format!("while( __do_increment ? ({less}) : ({most}) ) {{");
            }
            None => mended += line,
        }
        mended.push('\n');
        counts = line.contains("int __do_increment = 0;");
    }
    mended
}

/// A TIME as a number of nanoseconds.
const OF_NANOSECONDS: &str = "\
static inline LREAL __ns(TIME t) { return (LREAL)((LINT)t.tv_sec * 1000000000 + t.tv_nsec); }
static inline TIME __of_ns(LREAL n) { TIME t; t.tv_sec = (LINT)n / 1000000000; t.tv_nsec = (LINT)n % 1000000000; return t; }
";

/// The conversions between numbers and times, with the unit by the name of the type.
const MILLISECONDS: &str = "\
static inline TIME __int_to_TIME(LINT n) { TIME t; t.tv_sec = n / 1000; t.tv_nsec = n % 1000 * 1000000; return t; }
static inline TOD __int_to_TOD(LINT n) { return __int_to_TIME(n); }
static inline DATE __int_to_DATE(LINT n) { DATE t; t.tv_sec = n; t.tv_nsec = 0; return t; }
static inline DT __int_to_DT(LINT n) { return __int_to_DATE(n); }
static inline LINT __TIME_to_int(TIME t) { return (LINT)t.tv_sec * 1000 + t.tv_nsec / 1000000; }
static inline LINT __TOD_to_int(TOD t) { return __TIME_to_int(t); }
static inline LINT __DATE_to_int(DATE t) { return t.tv_sec; }
static inline LINT __DT_to_int(DT t) { return t.tv_sec; }
static inline LREAL __TIME_to_real(TIME t) { return (LREAL)t.tv_sec * 1000 + (LREAL)t.tv_nsec / 1000000; }
static inline LREAL __TOD_to_real(TOD t) { return __TIME_to_real(t); }
static inline LREAL __DATE_to_real(DATE t) { return t.tv_sec; }
static inline LREAL __DT_to_real(DT t) { return t.tv_sec; }
static inline TIME __real_to_TIME(LREAL x) { LINT n = (LINT)(x * 1000000); TIME t; t.tv_sec = n / 1000000000; \
t.tv_nsec = n % 1000000000; return t; }
";

fn milliseconds(text: &str) -> String {
    text.replace("from_TYPENAME, TIME, __int_to_time)", "from_TYPENAME, TIME, __int_to_TIME)")
        .replace("to_TYPENAME, __int_to_time)", "to_TYPENAME, __int_to_##to_TYPENAME)")
        .replace("to_TYPENAME, __time_to_int)", "to_TYPENAME, __##from_TYPENAME##_to_int)")
        .replace("to_TYPENAME, __time_to_real)", "to_TYPENAME, __##from_TYPENAME##_to_real)")
        .replace("from_TYPENAME, TIME, __real_to_time)", "from_TYPENAME, TIME, __real_to_TIME)")
}

fn shifts(text: &str) -> String {
    let count = "N = N % (8*sizeof(in1_TYPENAME)); if (N == 0) return IN;\\\n  ";
    let rotated = ["return (IN >> N) | (IN << (8*", "return (IN << N) | (IN >> (8*"];
    let text = text.replace(
        "return IN OP N;",
        "return (ULINT)N >= 8*sizeof(in1_TYPENAME) ? 0 : (in1_TYPENAME)(IN OP N);",
    );
    rotated.iter().fold(text, |text, r| text.replace(r, &format!("{count}{r}")))
}

fn limits(text: &str) -> String {
    text.replace("return IN > MN ? IN < MX ? IN : MX : MN;", "if (IN < MN) IN = MN; return IN > MX ? MX : IN;").replace(
        "return __time_cmp(IN, MN) > 0 ?",
        "if (__time_cmp(IN, MN) < 0) IN = MN; return __time_cmp(IN, MX) > 0 ? MX : IN; return __time_cmp(IN, MN) > 0 ?",
    )
}

/// The counters of INT with the limits of INT.
fn counters(text: &str) -> String {
    let mut of_int = false;
    let mut mended = String::new();
    for line in text.lines() {
        if line.starts_with("static void ") {
            of_int = ["CTU_body__(", "CTD_body__(", "CTUD_body__("].iter().any(|name| line.contains(name));
        }
        if of_int && line.contains("_T.Q,) && ") {
            let line = line.replace("CV,) < __GET_VAR(data__->PV,)", "CV,) < 32767");
            mended += &line.replace("CV,) > 0", "CV,) > -32768");
        } else {
            mended += line;
        }
        mended.push('\n');
    }
    mended
}
