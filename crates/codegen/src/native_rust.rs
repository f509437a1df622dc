//! What Rust does in its own words: numbers with their limits, texts.

use std::collections::BTreeSet;
use std::fmt::Write as _;

const KINDS: [&str; 10] = ["i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64", "f32", "f64"];

/// Functions for the names that are called.
pub(crate) fn functions(names: &BTreeSet<String>) -> String {
    let mut w = Writer { out: String::new(), done: BTreeSet::new() };
    for name in names {
        w.need(name);
    }
    w.out
}

struct Writer {
    out: String,
    done: BTreeSet<String>,
}

impl Writer {
    fn needs(&mut self, names: &[&str]) {
        names.iter().for_each(|n| self.need(n));
    }

    fn need(&mut self, name: &str) {
        if name == "inv" || name == "zeroed" || !self.done.insert(name.to_owned()) {
            return;
        }
        let text = piece(name);
        if !text.is_empty() {
            // What a piece names, it needs.
            for other in names() {
                if other != name && (calls(text, other) || text.contains(&format!("{other}::"))) {
                    self.need(other);
                }
            }
            let _ = writeln!(self.out, "{}\n", text.trim_end());
            return;
        }
        if let Some((op, t)) = name.rsplit_once('_').filter(|(_, t)| KINDS.contains(t)) {
            self.of_kind(op, t);
        } else if let Some(f) = name.strip_prefix("real_") {
            let f = match f {
                "ln" => "log",
                "log" => "log10",
                other => other,
            };
            let _ = writeln!(self.out, "fn {name}(a: f64) -> f64 {{\n    libm::{f}(a)\n}}\n");
        }
    }

    fn of_kind(&mut self, op: &str, t: &str) {
        let real = t.starts_with('f');
        let over =
            "None => {\n            fail(fault, FAULT_OVERFLOW);\n            0\n        }\n    }\n}\n";
        let text = match op {
            "add" | "sub" | "mul" => format!(
                "fn {op}_{t}(a: {t}, b: {t}, fault: &mut u8) -> {t} {{\n    match a.checked_{op}(b) {{\n        Some(v) => v,\n        {over}"
            ),
            "neg" | "abs" => format!(
                "fn {op}_{t}(a: {t}, fault: &mut u8) -> {t} {{\n    match a.checked_{op}() {{\n        Some(v) => v,\n        {over}"
            ),
            "div" if real => format!(
                "fn div_{t}(a: {t}, b: {t}, fault: &mut u8) -> {t} {{\n    if b == 0.0 {{\n        \
                 fail(fault, FAULT_DIVISION);\n        return 0.0;\n    }}\n    a / b\n}}\n"
            ),
            "rem" if real => format!(
                "fn rem_{t}(a: {t}, b: {t}, fault: &mut u8) -> {t} {{\n    if b == 0.0 {{\n        \
                 fail(fault, FAULT_DIVISION);\n        return 0.0;\n    }}\n    a % b\n}}\n"
            ),
            "div" => format!(
                "fn div_{t}(a: {t}, b: {t}, fault: &mut u8) -> {t} {{\n    if b == 0 {{\n        \
                 fail(fault, FAULT_DIVISION);\n        return 0;\n    }}\n    match a.checked_div(b) {{\n        Some(v) => v,\n        {over}"
            ),
            "rem" => format!(
                "fn rem_{t}(a: {t}, b: {t}, fault: &mut u8) -> {t} {{\n    if b == 0 {{\n        \
                 fail(fault, FAULT_DIVISION);\n        return 0;\n    }}\n    a.wrapping_rem(b)\n}}\n"
            ),
            "pow" => format!(
                "fn pow_{t}(a: {t}, b: {t}) -> {t} {{\n    libm::{}(a, b)\n}}\n",
                if t == "f32" { "powf" } else { "pow" }
            ),
            "min" => format!("fn min_{t}(a: {t}, b: {t}) -> {t} {{\n    if b < a {{ b }} else {{ a }}\n}}\n"),
            "max" => format!("fn max_{t}(a: {t}, b: {t}) -> {t} {{\n    if a < b {{ b }} else {{ a }}\n}}\n"),
            "round" | "trunc" => {
                self.needs(&["whole_of"]);
                let first = if op == "round" {
                    self.needs(&["round_even"]);
                    "round_even(v)"
                } else {
                    self.needs(&["toward_zero"]);
                    "toward_zero(v)"
                };
                format!(
                    "fn {op}_{t}(v: f64, fault: &mut u8) -> {t} {{\n    match {t}::try_from(whole_of({first})) {{\n        \
                     Ok(v) => v,\n        Err(_) => {{\n            fail(fault, FAULT_OVERFLOW);\n            0\n        }}\n    }}\n}}\n"
                )
            }
            "text_to" => {
                self.needs(&["text_str"]);
                let parsed = match t {
                    "f32" | "f64" | "u64" => format!("text_str(a).trim().parse::<{t}>().ok()"),
                    _ => {
                        format!("text_str(a).trim().parse::<i64>().ok().and_then(|v| {t}::try_from(v).ok())")
                    }
                };
                let zero = if real { "0.0" } else { "0" };
                format!(
                    "fn text_to_{t}(a: &[u8], fault: &mut u8) -> {t} {{\n    match {parsed} {{\n        Some(v) => v,\n        \
                     None => {{\n            fail(fault, FAULT_RANGE);\n            {zero}\n        }}\n    }}\n}}\n"
                )
            }
            "text_from" => {
                self.needs(&["Text"]);
                format!(
                    "fn text_from_{t}(v: {t}, to: &mut [u8], most: usize) {{\n    let mut text = Text::new(to, most);\n    \
                     let _ = write!(text, \"{}\", v);\n}}\n",
                    if real { "{:?}" } else { "{}" }
                )
            }
            _ => match op.strip_suffix("_from") {
                Some(to) => format!(
                    "fn {to}_from_{t}(v: {t}, fault: &mut u8) -> {to} {{\n    match {to}::try_from(v) {{\n        \
                     Ok(v) => v,\n        Err(_) => {{\n            fail(fault, FAULT_OVERFLOW);\n            0\n        }}\n    }}\n}}\n"
                ),
                None => return,
            },
        };
        if text.contains("fail(") {
            self.needs(&["fail"]);
        }
        self.out.push_str(&text);
        self.out.push('\n');
    }
}

/// Whether a function is called in a text.
fn calls(text: &str, f: &str) -> bool {
    let behind = |(at, _): (usize, &str)| {
        let before = text.get(..at).and_then(|t| t.chars().next_back());
        !before.is_some_and(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    text.match_indices(&format!("{f}(")).any(behind)
}

const PIECES: &str = include_str!("runtime/native.rs.txt");

fn names() -> impl Iterator<Item = &'static str> {
    PIECES.lines().filter_map(|l| l.strip_prefix("//: "))
}

/// A piece of `runtime/native.rs.txt`.
fn piece(name: &str) -> &'static str {
    let start = format!("//: {name}\n");
    let Some(at) = PIECES.find(&start) else { return "" };
    let rest = &PIECES[at + start.len()..];
    rest.find("//: ").map_or(rest, |end| &rest[..end])
}
