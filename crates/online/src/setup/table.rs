//! Tables of TOML as they are read key by key: each value by its type, and what nobody asked for is a
//! problem.

use std::collections::BTreeSet;

use g7_model::{FileId, Nanos, Problem, Said, Span, codes, say};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The longest file that is read.
pub(super) const MOST: usize = 4 << 20;

/// A value with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Where it stands in the file.
    pub at: Span,
}

impl<T> At<T> {
    pub(super) fn new(value: T, at: Span) -> At<T> {
        At { value, at }
    }
}

/// The problems of a file.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) file: FileId,
    pub(super) problems: Vec<Problem>,
}

impl Found {
    pub(super) fn span(&self, range: std::ops::Range<usize>) -> Span {
        // A file is read only if its length fits (`read`).
        Span { file: self.file, start: range.start as u32, end: range.end as u32 }
    }

    pub(super) fn wrong(&mut self, at: Span, what: Said) -> &mut Problem {
        self.problems.push(Problem::new(&codes::BAD_WIRING, at, what));
        let last = self.problems.len() - 1;
        &mut self.problems[last]
    }
}

/// One table of the file.
pub(super) struct Table<'t> {
    table: &'t DeTable<'t>,
    /// The name of the table, or of what it describes.
    pub(super) at: Span,
    /// The thing that the table describes, for messages: `the device line1`.
    what: Said,
    asked: BTreeSet<&'static str>,
}

impl<'t> Table<'t> {
    pub(super) fn new(table: &'t DeTable<'t>, at: Span, what: Said) -> Table<'t> {
        Table { table, at, what, asked: BTreeSet::new() }
    }

    fn get(&mut self, key: &'static str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.asked.insert(key);
        self.table.get(key)
    }

    /// The value of a key as the reader makes it; where it makes nothing of it, a problem that says of the
    /// table what belongs there.
    fn read<T>(
        &mut self,
        found: &mut Found,
        key: &'static str,
        wanted: impl FnOnce(&Said) -> Said,
        reader: impl FnOnce(&DeValue<'t>) -> Option<T>,
    ) -> Option<At<T>> {
        let value = self.get(key)?;
        let at = found.span(value.span());
        match reader(value.get_ref()) {
            Some(read) => Some(At::new(read, at)),
            None => {
                found.wrong(at, wanted(&self.what));
                None
            }
        }
    }

    pub(super) fn text(&mut self, found: &mut Found, key: &'static str) -> Option<At<String>> {
        let wanted = |what: &Said| say!("`{key}` of {what} is a text in quotes");
        self.read(found, key, wanted, |v| v.as_str().map(str::to_owned))
    }

    /// A text that must be there.
    pub(super) fn needed(
        &mut self,
        found: &mut Found,
        key: &'static str,
        example: &str,
    ) -> Option<At<String>> {
        if self.table.get(key).is_none() {
            let (at, what) = (self.at, say!("{} has no `{key}`", self.what));
            found.wrong(at, what).help = Some(say!("write `{key} = \"{example}\"`"));
        }
        self.text(found, key)
    }

    pub(super) fn whole(
        &mut self,
        found: &mut Found,
        key: &'static str,
        within: std::ops::RangeInclusive<i64>,
    ) -> Option<At<i64>> {
        let (least, most) = (*within.start(), *within.end());
        let wanted = |what: &Said| say!("`{key}` of {what} is a whole number from {least} to {most}");
        self.read(found, key, wanted, |v| integer(v).filter(|n| within.contains(n)))
    }

    pub(super) fn number(&mut self, found: &mut Found, key: &'static str) -> Option<At<f64>> {
        self.read(found, key, |what| say!("`{key}` of {what} is a number"), number)
    }

    /// True or false.
    pub(super) fn flag(&mut self, found: &mut Found, key: &'static str) -> Option<At<bool>> {
        self.read(found, key, |what| say!("`{key}` of {what} is true or false"), DeValue::as_bool)
    }

    /// A duration within limits.
    pub(super) fn duration(
        &mut self,
        found: &mut Found,
        key: &'static str,
        least: Nanos,
        most: Nanos,
    ) -> Option<At<Nanos>> {
        let (from, to) = (Said::foreign(least.plain()), Said::foreign(most.plain()));
        let wanted =
            |what: &Said| say!("`{key}` of {what} is a duration from {from} to {to}, such as \"20ms\"");
        self.read(found, key, wanted, |v| {
            v.as_str().and_then(|t| g7_rig::values::duration(t).ok()).filter(|d| (least..=most).contains(d))
        })
    }

    /// One of some words.
    pub(super) fn word<T: Copy>(
        &mut self,
        found: &mut Found,
        key: &'static str,
        words: &[(&str, T)],
    ) -> Option<At<T>> {
        let all: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let all = Said::foreign(all.join(", "));
        self.read(
            found,
            key,
            |what| say!("`{key}` of {what} is one of {all}"),
            |v| {
                let text = v.as_str()?;
                words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value)
            },
        )
    }

    /// The value of a key as it stands.
    pub(super) fn value(&mut self, found: &Found, key: &'static str) -> Option<At<&'t DeValue<'t>>> {
        let value = self.get(key)?;
        Some(At::new(value.get_ref(), found.span(value.span())))
    }

    fn inner(&mut self, found: &mut Found, key: &'static str) -> Option<(&'t DeTable<'t>, Span)> {
        let value = self.get(key)?;
        let at = found.span(value.span());
        let table = value.get_ref().as_table();
        if table.is_none() {
            found.wrong(at, say!("`{key}` of {} is a table", self.what)).help =
                Some(say!("begin it by a line `[{key}]`"));
        }
        table.map(|table| (table, at))
    }

    /// The rows of a table within this one, in the order of the file.
    pub(super) fn rows(&mut self, found: &mut Found, key: &'static str) -> Vec<Row<'t>> {
        self.inner(found, key).map(|(table, _)| rows(table, found)).unwrap_or_default()
    }

    /// A table within this one.
    pub(super) fn table(&mut self, found: &mut Found, key: &'static str) -> Option<Table<'t>> {
        self.inner(found, key).map(|(table, at)| Table::new(table, at, Said::foreign(format!("[{key}]"))))
    }

    /// Ends the reading: other keys are problems.
    pub(super) fn end(self, found: &mut Found) {
        for row in rows(self.table, found) {
            if self.asked.contains(row.name) {
                continue;
            }
            let known: Vec<String> = self.asked.iter().map(|key| format!("`{key}`")).collect();
            found.wrong(row.at, say!("{} has no setting `{}`", self.what, row.name)).help =
                Some(say!("its settings are {}", Said::foreign(known.join(", "))));
        }
    }
}

/// A key with its value.
pub(super) struct Row<'t> {
    pub(super) name: &'t str,
    /// The place of the key.
    pub(super) at: Span,
    pub(super) value: &'t DeValue<'t>,
    pub(super) value_at: Span,
}

/// All rows of a table in the order of the file.
pub(super) fn rows<'t>(table: &'t DeTable<'t>, found: &Found) -> Vec<Row<'t>> {
    let row = |(key, value): (&'t Spanned<std::borrow::Cow<'t, str>>, &'t Spanned<DeValue<'t>>)| Row {
        name: key.get_ref(),
        at: found.span(key.span()),
        value: value.get_ref(),
        value_at: found.span(value.span()),
    };
    let mut rows: Vec<Row<'t>> = table.iter().map(row).collect();
    rows.sort_by_key(|row| (row.at.start, row.value_at.start));
    rows
}

/// A whole number, where it fits.
fn integer(value: &DeValue<'_>) -> Option<i64> {
    let number = value.as_integer()?;
    i64::from_str_radix(number.as_str(), number.radix()).ok()
}

/// A finite number, with a fraction or without.
pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    let float = || value.as_float().and_then(|f| f.as_str().parse::<f64>().ok());
    float().or_else(|| integer(value).map(|n| n as f64)).filter(|n| n.is_finite())
}
