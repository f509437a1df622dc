//! What C does in its own words: numbers with their limits, texts.

use std::collections::BTreeSet;
use std::fmt::Write as _;

const INTS: [&str; 8] = ["i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"];

/// Include lines and functions for the names that are called; `prefix` stands
/// before the names of faults.
pub(crate) fn functions(names: &BTreeSet<String>, prefix: &str) -> (String, String) {
    let mut w = Writer { out: String::new(), done: BTreeSet::new(), math: false };
    for name in names {
        w.need(name);
    }
    let includes = if w.math { "#include <math.h>\n" } else { "" };
    let text = w.out.replace("FAULT_", &format!("{}_FAULT_", prefix.to_uppercase()));
    (includes.to_owned(), text)
}

struct Writer {
    out: String,
    done: BTreeSet<String>,
    math: bool,
}

/// `int16_t` of `i16`.
fn ty(t: &str) -> String {
    match t {
        "f32" => "float".into(),
        "f64" => "double".into(),
        "bool" => "bool".into(),
        _ => format!("{}int{}_t", if t.starts_with('u') { "u" } else { "" }, &t[1..]),
    }
}

fn least(t: &str) -> String {
    if t.starts_with('u') { "0".into() } else { format!("INT{}_MIN", &t[1..]) }
}

fn most(t: &str) -> String {
    format!("{}INT{}_MAX", if t.starts_with('u') { "U" } else { "" }, &t[1..])
}

impl Writer {
    fn needs(&mut self, names: &[&str]) {
        names.iter().for_each(|n| self.need(n));
    }

    fn need(&mut self, name: &str) {
        if name == "inv" || name == "zeroed" || !self.done.insert(name.to_owned()) {
            return;
        }
        if let Some(text) = self.fixed(name) {
            let _ = writeln!(self.out, "{}\n", text.trim());
            return;
        }
        if let Some((op, t)) = name.rsplit_once('_').filter(|(_, t)| INTS.contains(t)) {
            match op {
                "add" | "sub" | "mul" | "div" | "rem" | "neg" | "abs" => self.arith(op, t),
                "min" | "max" => self.extreme(op, t),
                "round" | "trunc" => self.whole_of(op, t),
                "text_to" => self.text_to(t),
                _ => {
                    if let Some(to) = op.strip_suffix("_from") {
                        self.narrow(to, t);
                    }
                }
            }
        } else if let Some((op, t)) = name.rsplit_once('_').filter(|(_, t)| *t == "f32" || *t == "f64") {
            match op {
                "min" | "max" => self.extreme(op, t),
                "div" | "rem" => self.divide(op, t),
                "pow" => self.function(name, &ty(t), if t == "f32" { "powf" } else { "pow" }, 2),
                _ => {}
            }
        } else if let Some(f) = name.strip_prefix("real_") {
            let f = match f {
                "ln" => "log",
                "log" => "log10",
                other => other,
            };
            self.function(name, "double", f, 1);
        }
    }

    fn function(&mut self, name: &str, t: &str, f: &str, arguments: usize) {
        self.math = true;
        let (parameters, arguments) =
            if arguments == 1 { (format!("{t} a"), "a") } else { (format!("{t} a, {t} b"), "a, b") };
        let _ = writeln!(self.out, "static {t} {name}({parameters})\n{{\n    return {f}({arguments});\n}}\n");
    }

    fn extreme(&mut self, op: &str, t: &str) {
        let sign = if op == "min" { "b < a" } else { "a < b" };
        let t_ = ty(t);
        let _ = writeln!(
            self.out,
            "static {t_} {op}_{t}({t_} a, {t_} b)\n{{\n    return ({sign}) ? b : a;\n}}\n"
        );
    }

    fn divide(&mut self, op: &str, t: &str) {
        self.needs(&["fail"]);
        let t_ = ty(t);
        let value = if op == "div" {
            "a / b".to_owned()
        } else {
            self.needs(&["remainder_of"]);
            if t == "f32" {
                "(float)remainder_of((double)a, (double)b)".to_owned()
            } else {
                "remainder_of(a, b)".to_owned()
            }
        };
        let zero = if t == "f32" { "0.0f" } else { "0.0" };
        let _ = writeln!(
            self.out,
            "static {t_} {op}_{t}({t_} a, {t_} b, uint8_t *fault)\n{{\n    if (b == {zero}) {{\n        \
             fail(fault, FAULT_DIVISION);\n        return {zero};\n    }}\n    return {value};\n}}\n"
        );
    }

    fn arith(&mut self, op: &str, t: &str) {
        self.needs(&["fail"]);
        let t_ = ty(t);
        let one = op == "neg" || op == "abs";
        let parameters = if one { format!("{t_} a") } else { format!("{t_} a, {t_} b") };
        let head = format!("static {t_} {op}_{t}({parameters}, uint8_t *fault)\n{{\n");
        let body = match t {
            "i64" => signed(op),
            "u64" => unsigned(op),
            _ => {
                let sign = match op {
                    "add" => "+",
                    "sub" => "-",
                    "mul" => "*",
                    "div" => "/",
                    _ => "%",
                };
                let (least, most) = (least(t), most(t));
                let mut body = String::new();
                if op == "div" || op == "rem" {
                    body +=
                        "    if (b == 0) {\n        fail(fault, FAULT_DIVISION);\n        return 0;\n    }\n";
                }
                body += &match op {
                    "neg" => "    const int64_t v = -(int64_t)a;\n".to_owned(),
                    "abs" => "    const int64_t v = (a < 0) ? -(int64_t)a : (int64_t)a;\n".to_owned(),
                    _ => format!("    const int64_t v = (int64_t)a {sign} (int64_t)b;\n"),
                };
                body += &format!(
                    "    if ((v < {least}) || (v > {most})) {{\n        fail(fault, FAULT_OVERFLOW);\n        \
                     return 0;\n    }}\n    return ({t_})v;\n"
                );
                // The product of two numbers of 32 bits without sign passes that.
                if t == "u32" && op == "mul" {
                    body = "    const uint64_t v = (uint64_t)a * (uint64_t)b;\n    if (v > UINT32_MAX) {\n        \
                            fail(fault, FAULT_OVERFLOW);\n        return 0;\n    }\n    return (uint32_t)v;\n"
                        .to_owned();
                }
                body
            }
        };
        let _ = writeln!(self.out, "{head}{body}}}\n");
    }

    fn narrow(&mut self, to: &str, from: &str) {
        self.needs(&["fail"]);
        let (t, f) = (ty(to), ty(from));
        let condition = if from == "u64" {
            format!("v > (uint64_t){}", most(to))
        } else if to == "u64" {
            "v < 0".to_owned()
        } else {
            format!("(v < {}) || (v > (int64_t){})", least(to), most(to))
        };
        let _ = writeln!(
            self.out,
            "static {t} {to}_from_{from}({f} v, uint8_t *fault)\n{{\n    if ({condition}) {{\n        \
             fail(fault, FAULT_OVERFLOW);\n        return 0;\n    }}\n    return ({t})v;\n}}\n"
        );
    }

    fn whole_of(&mut self, op: &str, t: &str) {
        self.needs(&["fail", if op == "round" { "round_even" } else { "toward_zero" }]);
        let f = if op == "round" { "round_even" } else { "toward_zero" };
        let t_ = ty(t);
        let range = match t {
            "i64" => "(r >= -9223372036854775808.0) && (r < 9223372036854775808.0)".to_owned(),
            "u64" => "(r >= 0.0) && (r < 18446744073709551616.0)".to_owned(),
            _ => format!("(r >= (double){}) && (r <= (double){})", least(t), most(t)),
        };
        let _ = writeln!(
            self.out,
            "static {t_} {op}_{t}(double v, uint8_t *fault)\n{{\n    const double r = {f}(v);\n    \
             if ({range}) {{\n        return ({t_})r;\n    }}\n    fail(fault, FAULT_OVERFLOW);\n    return 0;\n}}\n"
        );
    }

    fn text_to(&mut self, t: &str) {
        self.needs(&["fail", "text_number"]);
        let t_ = ty(t);
        let (limit, low) = if t == "u64" {
            ("(negative && (v != 0))".to_owned(), String::new())
        } else {
            (
                format!(
                    "(negative ? (v > {}) : (v > (uint64_t){}))",
                    if t.starts_with('u') { "0u".to_owned() } else { format!("(uint64_t){} + 1u", most(t)) },
                    most(t)
                ),
                String::new(),
            )
        };
        let value = if t.starts_with('u') {
            format!("({t_})v")
        } else {
            format!("negative ? ({t_})(-(int64_t)(v - 1u) - 1) : ({t_})v")
        };
        // `-0` has nothing to be taken from.
        let zero = if t.starts_with('u') { "" } else { "    if (v == 0u) {\n        return 0;\n    }\n" };
        let _ = writeln!(
            self.out,
            "static {t_} text_to_{t}(const uint8_t *a, uint8_t *fault)\n{{\n    bool negative = false;\n    \
             uint64_t v = 0;\n    if (!text_number(a, &v, &negative) || {limit}) {{\n        \
             fail(fault, FAULT_RANGE);\n        return 0;\n    }}\n{low}{zero}    return {value};\n}}\n"
        );
    }

    fn fixed(&mut self, name: &str) -> Option<&'static str> {
        let (needs, text): (&[&str], &str) = match name {
            "text_copy" | "text_left" | "text_right" | "text_mid" | "text_concat" | "text_insert"
            | "text_delete" | "text_replace" => {
                let text = piece(name);
                let needs: &[&str] = match name {
                    "text_copy" | "text_concat" => &["text_size", "text_clear", "text_append"],
                    "text_right" => {
                        &["fail", "text_size", "text_clear", "text_append", "text_skip", "text_len"]
                    }
                    _ => &["fail", "text_size", "text_clear", "text_append", "text_skip"],
                };
                (needs, text)
            }
            "text_len" | "text_compare" | "text_find" | "text_append" | "text_skip" => {
                (&["text_size"], piece(name))
            }
            "text_number" => (&["text_size", "text_trim"], piece(name)),
            "text_trim" => (&[], piece(name)),
            "text_to_bool" => (&["text_size", "text_trim", "fail"], piece(name)),
            "text_from_u64" => (&["text_clear", "text_put_number"], piece(name)),
            "text_from_i64" => (&["text_clear", "text_put", "text_put_number"], piece(name)),
            "text_from_bool" => (&["text_clear", "text_put"], piece(name)),
            "text_from_time" => (&["text_clear", "text_put", "text_put_number"], piece(name)),
            "text_put_number" => (&["text_put"], piece(name)),
            "text_put" => (&["text_size"], piece(name)),
            "real_sqrt" | "real_abs" | "low_bit" | "since" | "is_due_after" | "fail" | "round_even"
            | "toward_zero" | "remainder_of" | "text_size" | "text_clear" => (&[], piece(name)),
            "place" => (&["fail"], piece(name)),
            _ => return None,
        };
        self.needs(needs);
        Some(text)
    }
}

/// A function of `runtime/native.c`.
fn piece(name: &str) -> &'static str {
    let all = include_str!("runtime/native.c");
    let start = format!("/*: {name} */\n");
    let Some(at) = all.find(&start) else { return "" };
    let rest = &all[at + start.len()..];
    rest.find("/*: ").map_or(rest, |end| &rest[..end])
}

fn signed(op: &str) -> String {
    let over = "fail(fault, FAULT_OVERFLOW);\n        return 0;\n    }\n";
    let zero = "    if (b == 0) {\n        fail(fault, FAULT_DIVISION);\n        return 0;\n    }\n";
    match op {
        "add" => format!(
            "    if (((b > 0) && (a > (INT64_MAX - b))) || ((b < 0) && (a < (INT64_MIN - b)))) {{\n        {over}    return a + b;\n"
        ),
        "sub" => format!(
            "    if (((b < 0) && (a > (INT64_MAX + b))) || ((b > 0) && (a < (INT64_MIN + b)))) {{\n        {over}    return a - b;\n"
        ),
        "mul" => format!(
            "    bool over = false;\n    if ((a > 0) && (b > 0)) {{\n        over = a > (INT64_MAX / b);\n    \
             }} else if ((a > 0) && (b < 0)) {{\n        over = b < (INT64_MIN / a);\n    \
             }} else if ((a < 0) && (b > 0)) {{\n        over = a < (INT64_MIN / b);\n    \
             }} else if ((a < 0) && (b < 0)) {{\n        over = b < (INT64_MAX / a);\n    }}\n    \
             if (over) {{\n        {over}    return a * b;\n"
        ),
        "div" => {
            format!("{zero}    if ((a == INT64_MIN) && (b == -1)) {{\n        {over}    return a / b;\n")
        }
        "rem" => format!("{zero}    return (b == -1) ? 0 : (a % b);\n"),
        "neg" => format!("    if (a == INT64_MIN) {{\n        {over}    return -a;\n"),
        _ => format!("    if (a == INT64_MIN) {{\n        {over}    return (a < 0) ? -a : a;\n"),
    }
}

fn unsigned(op: &str) -> String {
    let over = "fail(fault, FAULT_OVERFLOW);\n        return 0;\n    }\n";
    let zero = "    if (b == 0u) {\n        fail(fault, FAULT_DIVISION);\n        return 0;\n    }\n";
    match op {
        "add" => format!("    if (a > (UINT64_MAX - b)) {{\n        {over}    return a + b;\n"),
        "sub" => format!("    if (a < b) {{\n        {over}    return a - b;\n"),
        "mul" => {
            format!("    if ((a != 0u) && (b > (UINT64_MAX / a))) {{\n        {over}    return a * b;\n")
        }
        "div" => format!("{zero}    return a / b;\n"),
        "rem" => format!("{zero}    return a % b;\n"),
        _ => format!("    if (a != 0u) {{\n        {over}    return a;\n"),
    }
}
