//! The helpers of printed C compile without a warning, and do what those of Rust do.
#![allow(clippy::disallowed_methods, reason = "the test starts compilers on files")]

use std::path::{Path, PathBuf};
use std::process::Command;

use g7_runtime::{arithmetic, numbers, source};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("c")
}

#[test]
fn every_warning_is_an_error() {
    for compiler in ["gcc", "clang"].into_iter().filter(|c| g7_peers::tool(c)) {
        // Each function is printed alone, so in one file some are not used.
        let out = Command::new(compiler)
            .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"])
            .args(["-Wno-unused-function", "-fsyntax-only", "helpers.c"])
            .current_dir(folder())
            .output()
            .expect("the compiler starts");
        assert!(out.status.success(), "{compiler}: {}", String::from_utf8_lossy(&out.stderr));
    }
}

#[test]
fn the_faults_have_the_same_numbers() {
    let header = source::ALL.c.iter().find(|f| f.path == "c/faults.h").expect("it is there").text;
    let in_c: Vec<String> = header
        .lines()
        .filter_map(|l| l.trim().strip_prefix("FAULT_"))
        .map(|l| format!("FAULT_{}", l.trim_end_matches(',').replace(" = ", ": ")))
        .collect();
    let in_rust: Vec<String> = source::ALL
        .faults
        .text
        .lines()
        .filter_map(|l| l.strip_prefix("pub const "))
        .map(|l| l.trim_end_matches(';').replace(": u8 = ", ": "))
        .collect();
    assert_eq!(in_c, in_rust);
    assert!(in_c.len() > 5);
}

/// Lines of C that print a result and its fault, and what Rust has for each.
#[derive(Default)]
struct Both {
    c: String,
    rust: Vec<String>,
}

impl Both {
    fn add(&mut self, call: &str, unsigned: bool, value: impl std::fmt::Display, fault: u8) {
        let (format, wide) = if unsigned { ("%llu", "unsigned long long") } else { ("%lld", "long long") };
        self.c +=
            &format!("    fault = 0; printf(\"{format} \", ({wide}){call}); printf(\"%u\\n\", fault);\n");
        self.rust.push(format!("{value} {fault}"));
    }
}

/// A number as C writes it.
fn written(v: i128) -> String {
    match v {
        _ if v == i128::from(i64::MIN) => "INT64_MIN".to_owned(),
        _ if v > i128::from(i64::MAX) => format!("UINT64_C({v})"),
        _ => format!("INT64_C({v})"),
    }
}

macro_rules! whole {
    ($both:ident, $($t:ident)*) => {$({
        let unsigned = <$t>::MIN == 0;
        let ends = [<$t>::MIN, <$t>::MIN + 1, 0, 1, 7, <$t>::MAX / 2, <$t>::MAX - 1, <$t>::MAX, <$t>::MAX / 3];
        let name = |op: &str| format!("{op}_{}", stringify!($t));
        let c = |v: $t| format!("(T_{}){}", stringify!($t), written(v.into()));
        for a in ends.into_iter().chain([(0 as $t).wrapping_sub(1)]) {
            for b in ends.into_iter().chain([(0 as $t).wrapping_sub(1)]) {
                let mut one = |op: &str, f: fn($t, $t, &mut u8) -> $t| {
                    let mut fault = 0;
                    let value = f(a, b, &mut fault);
                    $both.add(&format!("{}({}, {}, &fault)", name(op), c(a), c(b)), unsigned, value, fault);
                };
                one("add", arithmetic::add);
                one("sub", arithmetic::sub);
                one("mul", arithmetic::mul);
                one("div", arithmetic::div);
                one("rem", arithmetic::rem);
            }
            let mut fault = 0;
            let value = arithmetic::neg(a, &mut fault);
            $both.add(&format!("{}({}, &fault)", name("neg"), c(a)), unsigned, value, fault);
        }
        for v in [0.0, 0.5, 1.5, 2.5, -0.5, -1.5, 127.5, 255.5, -128.5, 32767.4, 4294967295.6, 1e18, 1e19, -1e19] {
            for (op, f) in [("round", arithmetic::round as fn(f64, &mut u8) -> $t), ("trunc", arithmetic::trunc)] {
                let mut fault = 0;
                let value = f(v, &mut fault);
                $both.add(&format!("{}({v:?}, &fault)", name(op)), unsigned, value, fault);
            }
        }
        for letters in ["0", "-0", " 12 ", "+5", "-1", "128", "256", "-128", "65536", "9223372036854775808", "1x", ""] {
            let mut text = [0u8; 32];
            text[0] = letters.len() as u8;
            text[2..2 + letters.len()].copy_from_slice(letters.as_bytes());
            let bytes: Vec<String> = text.iter().map(u8::to_string).collect();
            let mut fault = 0;
            let value: $t = to_number(&text, &mut fault);
            $both.add(&format!("{}((const uint8_t[]){{{}}}, &fault)", name("text_to"), bytes.join(", ")), unsigned, value, fault);
        }
    })*};
}

macro_rules! bits {
    ($both:ident, $($t:ident)*) => {$({
        for a in [0, 1, 0x5a, <$t>::MAX / 3, <$t>::MAX / 2 + 1, <$t>::MAX] {
            for by in [i64::MIN, -1, 0, 1, 7, 8, 9, 31, 32, 33, 63, 64, 65, i64::MAX] {
                let mut one = |op: &str, f: fn($t, i64, &mut u8) -> $t| {
                    let mut fault = 0;
                    let value = f(a, by, &mut fault);
                    let (t, a, by) = (stringify!($t), written(a.into()), written(by.into()));
                    $both.add(&format!("{op}_{t}((T_{t}){a}, {by}, &fault)"), true, value, fault);
                };
                one("shl", arithmetic::shl);
                one("shr", arithmetic::shr);
                one("rol", arithmetic::rol);
                one("ror", arithmetic::ror);
            }
        }
    })*};
}

/// A text as a number, by the function that is printed for its type.
fn to_number<T: arithmetic::Whole + 'static>(text: &[u8], fault: &mut u8) -> T {
    if std::any::TypeId::of::<T>() == std::any::TypeId::of::<u64>() {
        let value = arithmetic::text_to_u64(text, fault);
        return T::try_from(value).unwrap_or(T::ZERO);
    }
    arithmetic::text_to(text, fault)
}

#[test]
fn both_languages_have_the_same_results() {
    if !g7_peers::tool("gcc") {
        return;
    }
    let mut both = Both::default();
    whole!(both, i8 i16 i32 i64 u8 u16 u32 u64);
    bits!(both, u8 u16 u32 u64);
    for v in [0.0, 2.0, 3.0, 1e-310, 1e300, 0.1, 4503599627370497.0] {
        let bits = numbers::real_sqrt(v).to_bits();
        both.add(&format!("bits(real_sqrt({v:?}))"), true, bits, 0);
    }
    for k in 0..32 {
        for word in [1u32 << k, u32::MAX << k] {
            both.add(&format!("low_bit(UINT32_C({word}))"), true, numbers::low_bit(word), 0);
        }
    }
    let mut c = String::from("#include \"helpers.c\"\n#include <stdio.h>\n#include <string.h>\n\n");
    for t in ["i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"] {
        let sign = if t.starts_with('u') { "u" } else { "" };
        c += &format!("typedef {sign}int{}_t T_{t};\n", &t[1..]);
    }
    c += "static uint64_t bits(double v)\n{\n    uint64_t b;\n    memcpy(&b, &v, sizeof b);\n    return b;\n}\n\n";
    c += &format!("int main(void)\n{{\n    uint8_t fault = 0;\n{}    return 0;\n}}\n", both.c);
    let place = std::env::temp_dir().join(format!("g7-runtime-{}", std::process::id()));
    std::fs::create_dir_all(&place).expect("a folder");
    std::fs::write(place.join("main.c"), c).expect("written");
    let with_built_ins = differences(&place, &both, &[]);
    let in_plain_c = differences(&place, &both, &["-DG7_PLAIN_C"]);
    let _ = std::fs::remove_dir_all(&place);
    assert_eq!((with_built_ins, in_plain_c), (String::new(), String::new()));
}

/// Compiles `main.c` with these flags, runs it, and tells where its results differ.
fn differences(place: &Path, both: &Both, flags: &[&str]) -> String {
    let out = Command::new("gcc")
        .args(["-std=c99", "-O1", "-w", "main.c", "-o", "main", "-lm"])
        .args(flags)
        .arg("-I")
        .arg(folder())
        .current_dir(place)
        .output()
        .expect("the compiler starts");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let out = Command::new(place.join("main")).output().expect("it runs");
    let text = String::from_utf8_lossy(&out.stdout);
    let in_c: Vec<&str> = text.lines().collect();
    assert_eq!(in_c.len(), both.rust.len());
    let calls = both.c.lines().zip(in_c.iter().zip(&both.rust));
    let differ: Vec<String> =
        calls.filter(|(_, (c, r))| *c != r).map(|(l, (c, r))| format!("{l}: C {c}, Rust {r}")).collect();
    differ.join("\n")
}
