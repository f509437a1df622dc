//! The head of an action as typed: its qualifier and its time, apart from what it does; and the text that was
//! probably meant where one cannot be read. The fields of the page show the one and offer the other.
//!
//! # What must hold
//!
//! A text that is taken apart and put together again with its own head is the same action. A meant text reads
//! without a problem.

use g7_model::{FileId, Fix, Problem, Qualifier};
use g7_syntax::UNITS;

use crate::gesture::Gesture;
use crate::gestures::actions;

/// The time that an action has until the user gives another.
const USUAL: &str = "5s";

/// The parts of an action as typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// Absent if the text begins with none.
    pub qualifier: Option<Qualifier>,
    /// The time behind it, as typed.
    pub time: Option<String>,
    /// All behind the two.
    pub rest: String,
}

impl Head {
    /// Takes the text of an action apart.
    pub fn of(text: &str) -> Head {
        let text = text.trim();
        let (word, behind) = split_word(text);
        let named = Qualifier::named(word);
        // A variable can have the name of a qualifier: `S := 1`, `L.x`.
        let free = behind.is_empty() || behind.starts_with(char::is_whitespace);
        let Some(qualifier) = named.filter(|_| free && !behind.trim_start().starts_with(":=")) else {
            return Head { rest: text.to_owned(), ..Head::default() };
        };
        let behind = behind.trim_start();
        let time = if qualifier.timed() { time_before(behind) } else { None };
        let rest = behind.get(time.map_or(0, str::len)..).unwrap_or_default().trim_start();
        Head { qualifier: Some(qualifier), time: time.map(str::to_owned), rest: rest.to_owned() }
    }

    /// The text of an action with this head; a qualifier that needs a time gets one.
    pub fn written(&self) -> String {
        let name = self.qualifier.map(Qualifier::name);
        let timed = self.qualifier.is_some_and(Qualifier::timed);
        let time = timed.then(|| self.time.as_deref().filter(|t| !t.trim().is_empty()).unwrap_or(USUAL));
        let parts = [name, time.map(str::trim), Some(self.rest.trim())];
        parts.into_iter().flatten().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" ")
    }

    /// The number and the unit of its time, if it has just one of each.
    pub fn amount(&self) -> Option<(&str, &'static str)> {
        let time = self.time.as_deref()?;
        let digits = time.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let (number, unit) = time.split_at(digits);
        let unit = UNITS.into_iter().find(|u| *u == unit)?;
        number.parse::<f64>().is_ok().then_some((number, unit))
    }
}

/// The text that was probably meant by the one of a gesture that cannot be read.
pub fn meant(gesture: &Gesture) -> Option<String> {
    match gesture {
        Gesture::Action { text, .. } => {
            let text = text.trim();
            let mut forms = vec![mended(text, &actions(text).err()?)];
            forms.extend(action_forms(text));
            forms.into_iter().find(|form| actions(form).is_ok_and(|read| !read.is_empty()))
        }
        Gesture::Receptivity { text, .. } => {
            let read = |text: &str| g7_syntax::parse_expr(text, FileId(0)).1;
            let form = mended(text.trim(), &read(text.trim()));
            (form != text.trim() && read(&form).is_empty()).then_some(form)
        }
        Gesture::Declare { with: Some(gesture), .. } => meant(gesture),
        _ => None,
    }
}

/// The text after all fixes that its problems carry.
fn mended(text: &str, problems: &[Problem]) -> String {
    let fixes: Vec<&Fix> = problems.iter().filter_map(|p| p.fixes.first()).collect();
    Fix::apply(text, FileId(0), &fixes).0
}

/// Other forms of an action, the likely ones first: with the qualifier and its time at their places, with a time
/// that was missing, with the sign of an assignment.
fn action_forms(text: &str) -> Vec<String> {
    let words: Vec<&str> = text.split_whitespace().map(|w| w.trim_end_matches([',', ';', ':'])).collect();
    let words = joined_times(&words);
    let qualifier = |w: &str| Qualifier::named(&w.to_ascii_uppercase());
    let named = words.iter().position(|w| qualifier(w).is_some());
    let timed = words.iter().position(|w| is_time(w));
    let others = |but: &[Option<usize>]| {
        let kept = words.iter().enumerate().filter(|(n, _)| !but.contains(&Some(*n)));
        kept.map(|(_, w)| w.as_str()).collect::<Vec<_>>().join(" ")
    };
    let mut forms = Vec::new();
    let time = timed.and_then(|n| words.get(n)).map(|w| with_unit(w));
    let mut form = |q: Qualifier, time: Option<String>, rest: String| {
        forms.push(Head { qualifier: Some(q), time, rest }.written());
    };
    match named.and_then(|n| words.get(n)).and_then(|w| qualifier(w)) {
        Some(q) if q.timed() || time.is_none() => {
            form(q, time.clone(), others(&[named, timed]));
            // `L motor if n > 3`: what looks like a time is none.
            if q.timed() && time.is_some() {
                form(q, None, others(&[named]));
            }
            // `L hold motor`: a variable as the time.
            if let (true, None, [_, variable, rest @ ..]) = (q.timed(), &time, words.as_slice())
                && named == Some(0)
                && !rest.is_empty()
            {
                form(q, Some(format!("({variable})")), rest.join(" "));
            }
        }
        // `N 5s motor`: the time tells that one with a time was meant.
        Some(q) => {
            let with = match q {
                Qualifier::N => Some(Qualifier::L),
                Qualifier::S => Some(Qualifier::SL),
                _ => None,
            };
            form(with.unwrap_or(q), time.clone(), others(&[named, timed]));
        }
        None if time.is_some() => form(Qualifier::L, time.clone(), others(&[timed])),
        None => {}
    }
    let plain = others(&[]);
    forms.push(plain.replacen(" = ", " := ", 1));
    forms.push(plain);
    forms
}

/// The words, with a number and the unit behind it as one: `5 s`.
fn joined_times(words: &[&str]) -> Vec<String> {
    let mut joined: Vec<String> = Vec::new();
    for word in words {
        match joined.last_mut() {
            Some(number) if number.parse::<f64>().is_ok() && UNITS.contains(word) => number.push_str(word),
            _ => joined.push((*word).to_owned()),
        }
    }
    joined
}

/// True for a number with or without a unit, and for `t#5s`.
fn is_time(word: &str) -> bool {
    let word = word.to_ascii_lowercase();
    let plain = word.strip_prefix("t#").or_else(|| word.strip_prefix("time#")).unwrap_or(&word);
    plain.starts_with(|c: char| c.is_ascii_digit())
}

/// A time, in seconds if it has no unit.
fn with_unit(time: &str) -> String {
    let lower = time.to_ascii_lowercase();
    if lower.parse::<f64>().is_ok() { format!("{lower}s") } else { lower }
}

fn split_word(text: &str) -> (&str, &str) {
    text.split_at(text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len()))
}

/// The time at the beginning of a text: one in parentheses, or a number with its units.
fn time_before(text: &str) -> Option<&str> {
    if text.starts_with('(') {
        let mut depth = 0_usize;
        for (n, c) in text.char_indices() {
            match c {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return text.get(..=n);
            }
        }
        return None;
    }
    let word = text.split_whitespace().next()?;
    is_time(word).then_some(word)
}

#[cfg(test)]
mod tests {
    use super::{Head, meant};
    use crate::gesture::Gesture;
    use crate::id::ItemId;
    use g7_model::Qualifier;

    #[test]
    fn a_head_is_its_qualifier_and_its_time() {
        for (text, qualifier, time, amount, rest) in [
            ("motor", None, None, None, "motor"),
            ("N motor", Some(Qualifier::N), None, None, "motor"),
            ("L 5s motor if a", Some(Qualifier::L), Some("5s"), Some(("5", "s")), "motor if a"),
            ("SD 1.5m lamp", Some(Qualifier::SD), Some("1.5m"), Some(("1.5", "m")), "lamp"),
            ("D 1m30s lamp", Some(Qualifier::D), Some("1m30s"), None, "lamp"),
            ("L (a + (b)) lamp", Some(Qualifier::L), Some("(a + (b))"), None, "lamp"),
            ("L lamp", Some(Qualifier::L), None, None, "lamp"),
            ("S := 1", None, None, None, "S := 1"),
            ("L.x", None, None, None, "L.x"),
            ("P1 n := n + 1", Some(Qualifier::P1), None, None, "n := n + 1"),
        ] {
            let head = Head::of(text);
            assert_eq!(
                (head.qualifier, head.time.as_deref(), head.rest.as_str()),
                (qualifier, time, rest),
                "{text}"
            );
            assert_eq!(head.amount(), amount, "{text}");
            if !head.qualifier.is_some_and(Qualifier::timed) || time.is_some() {
                assert_eq!(head.written(), text);
            }
        }
        let timed = Head { qualifier: Some(Qualifier::L), ..Head::of("N motor") };
        assert_eq!(timed.written(), "L 5s motor");
        let plain = Head { qualifier: Some(Qualifier::S), ..Head::of("L 3s motor") };
        assert_eq!(plain.written(), "S motor");
    }

    #[test]
    fn the_form_that_was_meant_is_found() {
        for (text, form) in [
            ("L motor", "L 5s motor"),
            ("L motor 3s", "L 3s motor"),
            ("motor L 3s", "L 3s motor"),
            ("l 3s motor", "L 3s motor"),
            ("L 3 s motor", "L 3s motor"),
            ("L 3 motor", "L 3s motor"),
            ("L hold motor", "L (hold) motor"),
            ("N 3s motor", "L 3s motor"),
            ("S 3s motor", "SL 3s motor"),
            ("R 3s motor", "R motor"),
            ("3s motor", "L 3s motor"),
            ("D motor if a", "D 5s motor if a"),
            ("L motor if n > 3", "L 5s motor if n > 3"),
        ] {
            let gesture = Gesture::Action { id: ItemId::step("G", "1"), index: None, text: text.to_owned() };
            assert_eq!(meant(&gesture).as_deref(), Some(form), "{text}");
        }
        for text in ["", "}", "N a } step 2 {", "((", "N motor"] {
            let gesture = Gesture::Action { id: ItemId::step("G", "1"), index: None, text: text.to_owned() };
            assert_eq!(meant(&gesture), None, "{text}");
        }
    }
}
