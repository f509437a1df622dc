//! Writes a recording as a value change dump (IEEE 1364-2005, clause 18), with the extension for
//! strings that GTKWave reads.

use std::collections::BTreeSet;
use std::io::{self, Write};

use g7_model::Nanos;

use super::{Kind, Recording, Value};

/// Writes the whole dump. The time unit is 1 us; it is 1 ns if an instant needs it.
///
/// # Errors
///
/// The writer fails.
pub fn write_vcd(recording: &Recording, out: &mut dyn Write) -> io::Result<()> {
    let instants = recording.instants();
    let micros = instants.iter().chain([&recording.end()]).all(|t| t.whole(Nanos::MICROSECOND).is_some());
    let (unit, name) = if micros { (Nanos::MICROSECOND, "1 us") } else { (Nanos::new(1), "1 ns") };
    writeln!(out, "$version g7 $end\n$timescale {name} $end")?;
    write_scopes(recording, out)?;
    writeln!(out, "$enddefinitions $end")?;
    let mut next: Vec<_> = (0..recording.signals().len()).map(|i| recording.changes(i).peekable()).collect();
    let mut first = true;
    for instant in &instants {
        writeln!(out, "#{}", instant.count_of(unit))?;
        if first {
            writeln!(out, "$dumpvars")?;
        }
        for (i, (changes, signal)) in next.iter_mut().zip(recording.signals()).enumerate() {
            if let Some((_, value)) = changes.next_if(|(at, _)| at == instant) {
                writeln!(out, "{}", change(&value, signal.kind, &identifier(i)))?;
            }
        }
        if first {
            writeln!(out, "$end")?;
            first = false;
        }
    }
    if instants.last().is_some_and(|last| *last < recording.end()) {
        writeln!(out, "#{}", recording.end().count_of(unit))?;
    }
    Ok(())
}

/// Writes the declarations: a scope for each group, and one for each part of a dotted name.
fn write_scopes(recording: &Recording, out: &mut dyn Write) -> io::Result<()> {
    let mut open: Vec<String> = Vec::new();
    let mut used = BTreeSet::new();
    for (i, signal) in recording.signals().iter().enumerate() {
        let mut path = vec![signal.group.to_owned()];
        path.extend(signal.name.split('.').map(word));
        let mut name = path.pop().unwrap_or_default();
        let plain = name.clone();
        let mut copies = 1;
        while !used.insert((path.clone(), name.clone())) {
            copies += 1;
            name = format!("{plain}_{copies}");
        }
        let same = open.iter().zip(&path).take_while(|(a, b)| a == b).count();
        for _ in same..open.len() {
            writeln!(out, "$upscope $end")?;
        }
        for scope in path.iter().skip(same) {
            writeln!(out, "$scope module {scope} $end")?;
        }
        open = path;
        let (sort, bits) = match signal.kind {
            Kind::Bool => ("wire", 1),
            Kind::Int { bits, signed: false } => ("wire", bits),
            Kind::Int { bits, signed: true } => ("integer", bits),
            Kind::Time | Kind::Moment(_) => ("integer", 64),
            Kind::Real | Kind::Lreal => ("real", 64),
            Kind::Text => ("string", 1),
        };
        writeln!(out, "$var {sort} {bits} {} {name} $end", identifier(i))?;
    }
    for _ in &open {
        writeln!(out, "$upscope $end")?;
    }
    Ok(())
}

/// The identifier code of a signal: its number to the base 94, with the digits `!` to `~`.
fn identifier(mut number: usize) -> String {
    let mut out = String::new();
    loop {
        out.push(char::from(b'!' + (number % 94) as u8));
        number /= 94;
        if number == 0 {
            return out;
        }
        number -= 1;
    }
}

/// A name as a single word: a reader splits at white space, `[` begins a bit range, and `$` begins
/// a keyword.
fn word(part: &str) -> String {
    let clean = |c: char| {
        if c.is_whitespace() || c.is_control() || matches!(c, '[' | ']' | '$' | '\\') { '_' } else { c }
    };
    if part.is_empty() { "_".to_owned() } else { part.chars().map(clean).collect() }
}

fn change(value: &Value, kind: Kind, id: &str) -> String {
    let w = value.word();
    match kind {
        Kind::Bool => format!("{}{id}", w & 1),
        Kind::Int { bits, .. } => {
            let mask = if bits >= 64 { u64::MAX } else { (1u64 << bits) - 1 };
            format!("b{:b} {id}", w & mask)
        }
        Kind::Time | Kind::Moment(_) => format!("b{w:b} {id}"),
        Kind::Real | Kind::Lreal => format!("r{} {id}", real(value.number(kind))),
        Kind::Text => format!("s{} {id}", escape(&value.show(kind))),
    }
}

/// A number that `strtod` reads. An f32 is widened first, because its own shortest text would name
/// another f64.
fn real(x: f64) -> String {
    if x.is_nan() {
        "nan".to_owned()
    } else if x.is_infinite() {
        if x > 0.0 { "inf" } else { "-inf" }.to_owned()
    } else {
        x.to_string()
    }
}

/// A text as a single word: C escapes replace the characters that would end it.
fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\\\"),
            c if c.is_whitespace() || c.is_control() => {
                let mut bytes = [0; 4];
                for b in c.encode_utf8(&mut bytes).bytes() {
                    out.push_str(&format!("\\x{b:02x}"));
                }
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sample, Signal, write_text};
    use std::collections::BTreeMap;

    #[test]
    fn identifiers_are_printable_and_distinct() {
        let all: BTreeSet<String> = (0..20_000).map(identifier).collect();
        assert_eq!(all.len(), 20_000);
        assert!(all.iter().all(|id| id.bytes().all(|b| (33..=126).contains(&b))));
        assert_eq!(
            (identifier(0).as_str(), identifier(93).as_str(), identifier(94).as_str()),
            ("!", "~", "!!")
        );
    }

    /// Reads a dump back: its time unit, and for each signal (path, kind, number of bits, changes).
    #[allow(clippy::type_complexity, reason = "a table in a test")]
    fn parse(text: &str) -> (String, BTreeMap<String, (String, u32, Vec<(i64, String)>)>) {
        let (mut scale, mut scopes, mut ids) = (String::new(), Vec::new(), BTreeMap::new());
        let mut signals: BTreeMap<String, (String, u32, Vec<(i64, String)>)> = BTreeMap::new();
        let mut now = 0;
        for line in text.lines() {
            let w: Vec<&str> = line.split(' ').collect();
            match w[0] {
                "$timescale" => scale = format!("{} {}", w[1], w[2]),
                "$scope" => scopes.push(w[2].to_owned()),
                "$upscope" => drop(scopes.pop().expect("a scope is open")),
                "$var" => {
                    let path = format!("{}.{}", scopes.join("."), w[4]);
                    assert!(ids.insert(w[3].to_owned(), path.clone()).is_none(), "identifier twice");
                    signals.insert(path, (w[1].to_owned(), w[2].parse().unwrap(), Vec::new()));
                }
                "$version" | "$enddefinitions" | "$dumpvars" | "$end" => {}
                t if t.starts_with('#') => now = t[1..].parse().unwrap(),
                t => {
                    let (value, id) = match t.as_bytes()[0] {
                        b'0' | b'1' => (&t[..1], &t[1..]),
                        _ => (t, w[1]),
                    };
                    signals.get_mut(&ids[id]).expect("declared").2.push((now, value.to_owned()));
                }
            }
        }
        assert!(scopes.is_empty(), "every scope is closed");
        (scale, signals)
    }

    fn signal(group: &'static str, name: &str, kind: Kind) -> Signal {
        Signal { group, name: name.to_owned(), kind }
    }

    #[test]
    fn what_is_read_back_is_what_was_recorded() {
        let mut r = Recording::new(vec![
            signal("inputs", "a", Kind::Bool),
            signal("variables", "n", Kind::Int { bits: 16, signed: true }),
            signal("variables", "G.u", Kind::Int { bits: 8, signed: false }),
            signal("plant", "level", Kind::Lreal),
            signal("variables", "say", Kind::Text),
            signal("steps", "Vent på start", Kind::Bool),
            signal("steps", "Vent_på start", Kind::Bool),
        ]);
        let mut sample = |at: i64, a: u64, n: i64, u: u64, l: f64, s: &str| {
            let (w, text) = (Sample::Word, write_text(s, 3));
            let all = [w(a), w(n as u64), w(u), w(l.to_bits()), Sample::Text(&text), w(1), w(0)];
            r.sample(Nanos::new(at), all);
        };
        sample(0, 0, -1, 200, 0.5, "a b");
        sample(10_000, 1, -1, 200, 0.25, "\\");
        sample(30_000, 1, 5, 200, 0.25, "\\");
        let mut out = Vec::new();
        write_vcd(&r, &mut out).unwrap();
        let (scale, signals) = parse(&String::from_utf8(out).unwrap());
        assert_eq!(scale, "1 us");
        let of = |name: &str| {
            let (sort, bits, changes) = &signals[name];
            let changes: Vec<(i64, &str)> = changes.iter().map(|(t, v)| (*t, v.as_str())).collect();
            (sort.as_str(), *bits, changes)
        };
        assert_eq!(of("inputs.a"), ("wire", 1, vec![(0, "0"), (10, "1")]));
        assert_eq!(of("variables.n"), ("integer", 16, vec![(0, "b1111111111111111"), (30, "b101")]));
        assert_eq!(of("variables.G.u"), ("wire", 8, vec![(0, "b11001000")]));
        assert_eq!(of("plant.level"), ("real", 64, vec![(0, "r0.5"), (10, "r0.25")]));
        assert_eq!(of("variables.say"), ("string", 1, vec![(0, "sa\\x20b"), (10, "s\\\\")]));
        assert_eq!(of("steps.Vent_på_start").2, vec![(0, "1")]);
        assert_eq!(of("steps.Vent_på_start_2").2, vec![(0, "0")]);
    }

    #[test]
    fn an_instant_off_the_microsecond_brings_nanoseconds() {
        let mut r = Recording::new(vec![signal("inputs", "a", Kind::Bool)]);
        r.sample(Nanos::new(0), [Sample::Word(0)]);
        r.sample(Nanos::new(1_500), [Sample::Word(1)]);
        let mut out = Vec::new();
        write_vcd(&r, &mut out).unwrap();
        let (scale, signals) = parse(&String::from_utf8(out).unwrap());
        assert_eq!(scale, "1 ns");
        assert_eq!(signals["inputs.a"].2, [(0, "0".to_owned()), (1500, "1".to_owned())]);
    }
}
