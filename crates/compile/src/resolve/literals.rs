//! Conversions between STRING and the types whose values are written with a `#`: TIME, dates, times of day and bit strings
//! (IEC 61131-3:2003, 2.5.1.5.1, table 22).
//!
//! The compiler makes a function for each conversion at its first call. The function calls the standard functions of texts, so
//! that no later stage knows of these conversions (decision 65). A text is read in the form in which it is written; the word
//! before the `#` can be any one of its type. Any other text is the fault `range`.

use g7_engine::Builtin;
use g7_model::{Moment, Nanos, Span, Type};

use super::made::{binary, choice, compare, constant, unless};
use super::moments::DAY;
use super::resolver::Resolver;
use super::standard::result_type;
use super::types::{Typed, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, Value, VarId};

/// The type of a text that holds one value. The longest value is a TIME of 34 bytes.
const ROOM: Type = Type::String(64);
const SECOND: i128 = Nanos::SECOND.count() as i128;
const ERA: i128 = Moment::ERA as i128;
const CYCLE: i128 = Moment::CYCLE as i128;
const DIGITS: &str = "0123456789ABCDEF";

/// The assignments of a function that is made.
type List = Vec<(VarId, Expr)>;

impl Resolver<'_, '_> {
    /// The text of a date, a time of day or a bit string: its literal.
    pub(super) fn written_as_literal(&mut self, value: Expr, at: Span) -> Option<Typed> {
        let m = Make { at };
        let text = match value.ty {
            Type::Moment(moment) => {
                let [word, ..] = moment.words();
                let mut parts = vec![m.text(&format!("{word}#"))];
                match moment {
                    Moment::Date => parts.push(self.day_text(value, m)),
                    Moment::Tod => parts.push(self.clock_text(value, m)),
                    Moment::Dt => {
                        let day = self.day(value.clone(), at)?.expr;
                        let time = self.time_of_day(value, at)?.expr;
                        parts.extend([self.day_text(day, m), m.text("-"), self.clock_text(time, m)]);
                    }
                }
                m.joined(parts)
            }
            ty => {
                let digits = ty.elementary().map_or(0, |row| u32::from(row.bits) / 4);
                let f = self.made(&format!("@{ty}_TO_STRING"), (ty, ROOM), at, |_, input, result| {
                    let number = converted(m.var(input, ty), Type::Ulint);
                    let mut parts = vec![m.text("16#")];
                    parts.extend((0..digits).rev().map(|k| m.digit(&number, k)));
                    vec![(result, m.joined(parts))]
                });
                m.called(f, value, ROOM)
            }
        };
        Some(Typed { expr: text, literal: false })
    }

    /// The value of a text as a TIME, a date, a time of day or a bit string.
    pub(super) fn read_as_literal(&mut self, text: Expr, to: Type, at: Span) -> Option<Typed> {
        let m = Make { at };
        let moment = match to {
            Type::Moment(moment) => moment,
            Type::Time => return Some(self.text_as_time(text, m)),
            _ => return Some(self.text_as_bits(text, to, m)),
        };
        let plain = self.behind_word(text, moment.words(), m);
        let time = match moment {
            Moment::Date => self.text_day(plain, m),
            Moment::Tod => self.text_clock(plain, m),
            Moment::Dt => {
                let f = self.made("@text_DT", (ROOM, Type::Lint), at, |r, input, result| {
                    let t = || m.var(input, ROOM);
                    let places: Vec<VarId> =
                        (1..=3).map(|k| r.local(&format!("@text_DT.{k}"), Type::Lint, at)).collect();
                    let mut list = Vec::new();
                    let mut before = m.long(0);
                    for place in &places {
                        let next = m.find(m.behind(t(), before.clone()), m.text("-"));
                        list.push((*place, m.add(before, next)));
                        before = m.var(*place, Type::Lint);
                    }
                    // Without a third `-` the text of the day ends with the second one, and is none.
                    let day = m.left(t(), m.sub(before.clone(), m.long(1)));
                    let day = r.text_day(day, m);
                    let time = r.text_clock(m.behind(t(), before), m);
                    list.push((result, m.add(day, time)));
                    list
                });
                m.called(f, plain, Type::Lint)
            }
        };
        Some(Typed { expr: converted(converted(time, Type::Time), to), literal: false })
    }

    /// `2026-11-28` for a DATE.
    fn day_text(&mut self, day: Expr, m: Make) -> Expr {
        let f = self.made("@day_text", (Type::Time, ROOM), m.at, |r, input, result| {
            let mut local = |name: &str| r.local(&format!("@day_text.{name}"), Type::Lint, m.at);
            let (of_cycle, cycle, of_year, century) =
                (local("of_cycle"), local("cycle"), local("of_year"), local("century"));
            let month = local("month");
            let v = |v| m.var(v, Type::Lint);
            let days = m.add(m.div(converted(m.var(input, Type::Time), Type::Lint), DAY), m.long(ERA));
            // Each 4 years (1,460 days) end with a leap day; each 100 years (36,524 days) do not; each 400 years do.
            let leaps = |days: Expr| {
                let (few, some) = (m.div(days.clone(), 1_460), m.div(days.clone(), 36_524));
                m.sub(m.add(m.sub(days.clone(), few), some), m.div(days, 146_096))
            };
            let before = m.sub(m.add(m.mul(v(century), 365), m.div(v(century), 4)), m.div(v(century), 100));
            // Years begin in March here, so that the day of a leap year is their last.
            let from_march = m.div(m.add(m.mul(v(of_year), 5), m.long(2)), 153);
            let day = m.sub(v(of_year), m.div(m.add(m.mul(v(month), 153), m.long(2)), 5));
            let late = compare(BinaryOp::Ge, v(month), 10, m.at);
            let number = choice(late.clone(), m.add(v(month), m.long(3)), m.sub(v(month), m.long(9)), m.at);
            let year = m.add(v(century), m.mul(v(cycle), 400));
            let year = choice(late, year.clone(), m.add(year, m.long(1)), m.at);
            let text = vec![
                m.padded(year, 4),
                m.text("-"),
                m.padded(number, 2),
                m.text("-"),
                m.padded(m.add(day, m.long(1)), 2),
            ];
            vec![
                (cycle, m.div(days.clone(), CYCLE)),
                (of_cycle, m.rest(days, CYCLE)),
                (century, m.div(leaps(v(of_cycle)), 365)),
                (of_year, m.sub(v(of_cycle), before)),
                (month, from_march),
                (result, m.joined(text)),
            ]
        });
        m.called(f, converted(day, Type::Time), ROOM)
    }

    /// `15:36:55.36` for a TOD.
    fn clock_text(&mut self, time: Expr, m: Make) -> Expr {
        let f = self.made("@clock_text", (Type::Time, ROOM), m.at, |_, input, result| {
            let nanos = || converted(m.var(input, Type::Time), Type::Lint);
            let part = |unit: i128| m.padded(m.rest(m.div(nanos(), unit), 60), 2);
            let fraction = m.rest(nanos(), SECOND);
            let zeros = (1..=8).map(|k| {
                let ends = compare(BinaryOp::Eq, m.rest(nanos(), 10i128.pow(k)), 0, m.at);
                converted(ends, Type::Lint)
            });
            let kept = zeros.fold(m.long(9), |kept, zero| m.sub(kept, zero));
            let digits = m.joined(vec![m.text("."), m.left(m.padded(fraction.clone(), 9), kept)]);
            let whole = compare(BinaryOp::Eq, fraction, 0, m.at);
            let text = vec![
                m.padded(m.div(nanos(), 3600 * SECOND), 2),
                m.text(":"),
                part(60 * SECOND),
                m.text(":"),
                part(SECOND),
                m.pick(whole, digits, m.text("")),
            ];
            vec![(result, m.joined(text))]
        });
        m.called(f, converted(time, Type::Time), ROOM)
    }

    /// The part of a text behind the word and the `#` of a literal, or the whole text if there is no `#`. A text with a
    /// space or a `+` is refused here: the conversions to numbers, which read the parts later, would accept both.
    fn behind_word(&mut self, text: Expr, words: [&str; 4], m: Make) -> Expr {
        let [first, ..] = words;
        let name = format!("@behind_{first}");
        let f = self.made(&name, (ROOM, ROOM), m.at, |r, input, result| {
            let place = r.local(&format!("{name}.place"), Type::Lint, m.at);
            let t = || m.var(input, ROOM);
            let at = || m.var(place, Type::Lint);
            let mut known = String::from("||");
            for word in words {
                known.push_str(&format!("{word}#|{}#|", word.to_ascii_lowercase()));
            }
            let word = m.joined(vec![m.text("|"), m.left(t(), at()), m.text("|")]);
            let found = m.find(m.text(&known), word);
            let wrong = [m.find(t(), m.text(" ")), m.find(t(), m.text("+"))];
            let wrong = wrong.into_iter().map(|found| compare(BinaryOp::Gt, found, 0, m.at));
            let wrong = wrong.fold(compare(BinaryOp::Eq, found, 0, m.at), |a, b| m.or(a, b));
            // A longer text was cut.
            let wrong = m.or(wrong, compare(BinaryOp::Ge, m.length(t()), 64, m.at));
            let length = unless(wrong, at(), m.at);
            vec![(place, m.find(t(), m.text("#"))), (result, m.behind(t(), length))]
        });
        m.called(f, text, ROOM)
    }

    /// The nanoseconds from 1970 to the day `2026-11-28`.
    fn text_day(&mut self, text: Expr, m: Make) -> Expr {
        let f = self.made("@text_day", (ROOM, Type::Lint), m.at, |r, input, result| {
            let mut local = |name: &str, ty| r.local(&format!("@text_day.{name}"), ty, m.at);
            let rest = local("rest", ROOM);
            let [place, year, month, day] =
                ["place", "year", "month", "day"].map(|name| local(name, Type::Lint));
            let v = |v| m.var(v, Type::Lint);
            let t = |v| m.var(v, ROOM);
            let before = |text| m.number(m.left(text, m.sub(v(place), m.long(1))));
            // 31 days, 30 in April, June, September and November, fewer in February.
            let odd = m.rest(m.add(v(month), m.div(v(month), 8)), 2);
            let is_zero = |e| compare(BinaryOp::Eq, e, 0, m.at);
            let fourth = m.and(is_zero(m.rest(v(year), 4)), m.not_zero(m.rest(v(year), 100)));
            let leap = m.or(fourth, is_zero(m.rest(v(year), 400)));
            let february = compare(BinaryOp::Eq, v(month), 2, m.at);
            let short = choice(leap, m.long(28), m.long(29), m.at);
            let length = choice(february, m.add(m.long(30), odd), short, m.at);
            let late = binary(BinaryOp::Gt, v(day), length, Type::Bool, m.at);
            let wrong = [(year, 0, 9999), (month, 1, 12), (day, 1, 31)];
            let wrong = wrong.into_iter().map(|(n, least, most)| m.outside(v(n), least, most));
            let wrong = wrong.fold(late, |a, b| m.or(a, b));
            let early = compare(BinaryOp::Le, v(month), 2, m.at);
            let from_march = m.rest(m.add(v(month), m.long(9)), 12);
            let of_year = m.sub(m.add(m.div(m.add(m.mul(from_march, 153), m.long(2)), 5), v(day)), m.long(1));
            let y = || v(place);
            let leaps = m.add(m.sub(m.div(y(), 4), m.div(y(), 100)), m.div(y(), 400));
            let days = m.sub(m.add(m.add(m.mul(y(), 365), leaps), of_year), m.long(ERA));
            vec![
                (place, m.find(t(input), m.text("-"))),
                (year, before(t(input))),
                (rest, m.behind(t(input), v(place))),
                (place, m.find(t(rest), m.text("-"))),
                (month, before(t(rest))),
                (day, m.number(m.behind(t(rest), v(place)))),
                (place, choice(early, v(year), m.sub(v(year), m.long(1)), m.at)),
                (result, m.mul(unless(wrong, days, m.at), DAY)),
            ]
        });
        m.called(f, text, Type::Lint)
    }

    /// The nanoseconds of `15:36:55.36`; the seconds can be left out.
    fn text_clock(&mut self, text: Expr, m: Make) -> Expr {
        let f = self.made("@text_clock", (ROOM, Type::Lint), m.at, |r, input, result| {
            let mut local = |name: &str, ty| r.local(&format!("@text_clock.{name}"), ty, m.at);
            let (rest, seconds) = (local("rest", ROOM), local("seconds", ROOM));
            let [place, hour, minute] = ["place", "hour", "minute"].map(|name| local(name, Type::Lint));
            let v = |v| m.var(v, Type::Lint);
            let t = |v| m.var(v, ROOM);
            let found = || compare(BinaryOp::Gt, v(place), 0, m.at);
            let before = |text| m.left(text, m.least(m.sub(v(place), m.long(1)), 0));
            let minutes = m.pick(found(), t(rest), before(t(rest)));
            let (second, fraction, too_fine) = m.decimal(t(seconds), SECOND);
            let bad = m.or(too_fine, compare(BinaryOp::Gt, m.find(t(input), m.text("-")), 0, m.at));
            let wrong = [(v(hour), 23), (v(minute), 59), (second.clone(), 59)];
            let wrong = wrong.into_iter().map(|(n, most)| m.outside(n, 0, most));
            let wrong = wrong.fold(bad, |a, b| m.or(a, b));
            let whole = m.add(m.mul(m.add(m.mul(v(hour), 60), v(minute)), 60), second);
            let time = m.add(m.mul(whole, SECOND), fraction);
            vec![
                (place, m.find(t(input), m.text(":"))),
                (hour, m.number(before(t(input)))),
                (rest, m.behind(t(input), v(place))),
                (place, m.find(t(rest), m.text(":"))),
                (minute, m.number(minutes)),
                (seconds, m.pick(found(), m.text("0"), m.behind(t(rest), v(place)))),
                (result, unless(wrong, time, m.at)),
            ]
        });
        m.called(f, text, Type::Lint)
    }

    /// STRING_TO_TIME: `T#1h20m`, `T#-1.5s`; each unit once, in their order.
    fn text_as_time(&mut self, text: Expr, m: Make) -> Typed {
        let plain = self.behind_word(text, Nanos::WORDS, m);
        let f = self.made("@STRING_TO_TIME", (ROOM, Type::Time), m.at, |r, input, result| {
            let mut local = |name: &str, ty| r.local(&format!("@STRING_TO_TIME.{name}"), ty, m.at);
            let (rest, given) = (local("rest", ROOM), local("given", ROOM));
            let [sign, sum, place, units] =
                ["sign", "sum", "place", "units"].map(|name| local(name, Type::Lint));
            let wrong = local("wrong", Type::Bool);
            let v = |v| m.var(v, Type::Lint);
            let t = || m.var(rest, ROOM);
            let minus = compare(BinaryOp::Eq, m.find(m.var(input, ROOM), m.text("-")), 1, m.at);
            let mut list: List = vec![
                // Nanoseconds are counted down: there is one more below zero than above.
                (sign, choice(minus, m.long(-1), m.long(1), m.at)),
                (rest, m.behind(m.var(input, ROOM), m.div(m.add(v(sign), m.long(1)), 2))),
                (wrong, compare(BinaryOp::Gt, m.find(t(), m.text("-")), 0, m.at)),
                (sum, m.long(0)),
                (units, m.long(0)),
            ];
            for (unit, nanos) in Nanos::UNITS.map(|(unit, size)| (unit, i128::from(size.count()))) {
                list.push((place, m.unit_in(t(), unit)));
                let found = || compare(BinaryOp::Gt, v(place), 0, m.at);
                let number = m.left(t(), m.least(m.sub(v(place), m.long(1)), 0));
                list.push((given, m.pick(found(), m.text("0"), number)));
                let (whole, fraction, too_fine) = m.decimal(m.var(given, ROOM), nanos);
                list.push((wrong, m.or(m.var(wrong, Type::Bool), too_fine)));
                list.push((sum, m.sub(m.sub(v(sum), m.mul(whole, nanos)), fraction)));
                let end = m.add(v(place), m.long(unit.len() as i128 - 1));
                list.push((units, m.add(v(units), converted(found(), Type::Lint))));
                list.push((rest, m.behind(t(), choice(found(), m.long(0), end, m.at))));
            }
            let left = compare(BinaryOp::Gt, m.length(t()), 0, m.at);
            let none = compare(BinaryOp::Eq, v(units), 0, m.at);
            let wrong = m.or(m.or(m.var(wrong, Type::Bool), left), none);
            let sum = binary(BinaryOp::Mul, unless(wrong, v(sum), m.at), v(sign), Type::Lint, m.at);
            list.push((result, converted(sum, Type::Time)));
            list
        });
        Typed { expr: m.called(f, plain, Type::Time), literal: false }
    }

    /// STRING_TO_WORD and its like: `16#00FF`, or a decimal number.
    fn text_as_bits(&mut self, text: Expr, to: Type, m: Make) -> Typed {
        let most = to.bounds().map_or(0, |(_, most)| most);
        let name = format!("@STRING_TO_{to}");
        let f = self.made(&name, (ROOM, to), m.at, |r, input, result| {
            let mut local = |part: &str, ty| r.local(&format!("{name}.{part}"), ty, m.at);
            let (digits, one) = (local("digits", ROOM), local("digit", ROOM));
            let (sum, value, wrong) =
                (local("sum", Type::Ulint), local("value", Type::Lint), local("wrong", Type::Bool));
            let t = |v| m.var(v, ROOM);
            let number = || m.var(sum, Type::Ulint);
            let based = || compare(BinaryOp::Eq, m.find(t(input), m.text("16#")), 1, m.at);
            let decimal = m.pick(based(), t(input), m.text("0"));
            let long = compare(BinaryOp::Gt, m.length(t(digits)), 16, m.at);
            let empty = m.and(based(), compare(BinaryOp::Eq, m.length(t(digits)), 0, m.at));
            let mut list: List = vec![
                (digits, m.pick(based(), m.text(""), m.behind(t(input), m.long(3)))),
                (wrong, m.or(long, empty)),
                (sum, Expr { kind: ExprKind::Convert(Box::new(decimal)), ty: Type::Ulint, at: m.at }),
            ];
            for k in 1..=16 {
                let there = || compare(BinaryOp::Gt, m.length(t(one)), 0, m.at);
                let capital = m.find(m.text(DIGITS), t(one));
                let small = m.find(m.text(&DIGITS.to_ascii_lowercase()), t(one));
                let place = Expr {
                    kind: ExprKind::Builtin(Builtin::Max, vec![capital, small]),
                    ty: Type::Lint,
                    at: m.at,
                };
                let digit = converted(m.least(m.sub(m.var(value, Type::Lint), m.long(1)), 0), Type::Ulint);
                let sixteen = constant(16, Type::Ulint, m.at);
                let shifted = choice(there(), constant(1, Type::Ulint, m.at), sixteen, m.at);
                let more = binary(BinaryOp::Mul, number(), shifted, Type::Ulint, m.at);
                let missing = m.and(there(), compare(BinaryOp::Eq, m.var(value, Type::Lint), 0, m.at));
                list.push((one, m.call(Builtin::Mid, vec![t(digits), m.long(1), m.long(k)])));
                list.push((value, choice(there(), m.long(0), place, m.at)));
                list.push((wrong, m.or(m.var(wrong, Type::Bool), missing)));
                list.push((sum, binary(BinaryOp::Add, more, digit, Type::Ulint, m.at)));
            }
            let mut wrong = m.var(wrong, Type::Bool);
            // No ULINT is too large for an LWORD.
            if Type::Ulint.bounds().is_some_and(|(_, largest)| most < largest) {
                wrong = m.or(wrong, compare(BinaryOp::Gt, number(), most, m.at));
            }
            list.push((result, converted(unless(wrong, number(), m.at), to)));
            list
        });
        Typed { expr: m.called(f, text, to), literal: false }
    }
}

/// Builds expressions that all have the same place in the text.
#[derive(Clone, Copy)]
struct Make {
    at: Span,
}

impl Make {
    fn var(self, v: VarId, ty: Type) -> Expr {
        Expr { kind: ExprKind::Var(v), ty, at: self.at }
    }

    fn long(self, n: i128) -> Expr {
        constant(n, Type::Lint, self.at)
    }

    fn text(self, text: &str) -> Expr {
        let room = u16::try_from(text.len()).unwrap_or(g7_engine::TEXT);
        Expr { kind: ExprKind::Const(Value::Str(text.into())), ty: Type::String(room), at: self.at }
    }

    fn add(self, a: Expr, b: Expr) -> Expr {
        binary(BinaryOp::Add, a, b, Type::Lint, self.at)
    }

    fn sub(self, a: Expr, b: Expr) -> Expr {
        binary(BinaryOp::Sub, a, b, Type::Lint, self.at)
    }

    fn mul(self, a: Expr, by: i128) -> Expr {
        binary(BinaryOp::Mul, a, self.long(by), Type::Lint, self.at)
    }

    fn div(self, a: Expr, by: i128) -> Expr {
        binary(BinaryOp::Div, a, self.long(by), Type::Lint, self.at)
    }

    fn rest(self, a: Expr, by: i128) -> Expr {
        binary(BinaryOp::Mod, a, self.long(by), Type::Lint, self.at)
    }

    fn and(self, a: Expr, b: Expr) -> Expr {
        binary(BinaryOp::And, a, b, Type::Bool, self.at)
    }

    fn or(self, a: Expr, b: Expr) -> Expr {
        binary(BinaryOp::Or, a, b, Type::Bool, self.at)
    }

    fn not_zero(self, a: Expr) -> Expr {
        compare(BinaryOp::Ne, a, 0, self.at)
    }

    fn outside(self, a: Expr, least: i128, most: i128) -> Expr {
        let low = compare(BinaryOp::Lt, a.clone(), least, self.at);
        self.or(low, compare(BinaryOp::Gt, a, most, self.at))
    }

    /// The number, or this one where that is less.
    fn least(self, a: Expr, least: i128) -> Expr {
        let values = vec![a, self.long(least)];
        Expr { kind: ExprKind::Builtin(Builtin::Max, values), ty: Type::Lint, at: self.at }
    }

    /// SEL of two texts.
    fn pick(self, condition: Expr, no: Expr, yes: Expr) -> Expr {
        Expr { ty: ROOM, ..choice(condition, no, yes, self.at) }
    }

    fn call(self, f: Builtin, values: Vec<Expr>) -> Expr {
        let ty = result_type(f, &values);
        Expr { kind: ExprKind::Builtin(f, values), ty, at: self.at }
    }

    fn called(self, f: crate::ir::FunctionId, value: Expr, ty: Type) -> Expr {
        Expr { kind: ExprKind::Call(f, vec![value]), ty, at: self.at }
    }

    fn joined(self, parts: Vec<Expr>) -> Expr {
        let all = parts.into_iter().reduce(|a, b| self.call(Builtin::Concat, vec![a, b]));
        all.unwrap_or_else(|| self.text(""))
    }

    /// The first characters of a text.
    fn left(self, text: Expr, count: Expr) -> Expr {
        self.call(Builtin::Left, vec![text, count])
    }

    /// The part of a text behind its first characters.
    fn behind(self, text: Expr, count: Expr) -> Expr {
        self.call(Builtin::Delete, vec![text, count, self.long(1)])
    }

    fn measured(self, f: Builtin, values: Vec<Expr>) -> Expr {
        converted(Expr { kind: ExprKind::Builtin(f, values), ty: Type::Int, at: self.at }, Type::Lint)
    }

    fn length(self, text: Expr) -> Expr {
        self.measured(Builtin::Len, vec![text])
    }

    /// The place of a part in a text, from 1; 0 where it is not in there.
    fn find(self, text: Expr, part: Expr) -> Expr {
        self.measured(Builtin::Find, vec![text, part])
    }

    fn number(self, text: Expr) -> Expr {
        Expr { kind: ExprKind::Convert(Box::new(text)), ty: Type::Lint, at: self.at }
    }

    /// The last digits of a number, with zeros before them.
    fn padded(self, n: Expr, digits: usize) -> Expr {
        let text = Expr { kind: ExprKind::Convert(Box::new(n)), ty: Type::String(20), at: self.at };
        let text = self.joined(vec![self.text(&"0".repeat(digits)), text]);
        self.call(Builtin::Right, vec![text, self.long(digits as i128)])
    }

    /// The digit number `k` of a ULINT to the base 16, from the right.
    fn digit(self, number: &Expr, k: u32) -> Expr {
        let whole = |n| constant(n, Type::Ulint, self.at);
        let shifted = match k {
            0 => number.clone(),
            k => binary(BinaryOp::Div, number.clone(), whole(1 << (4 * k)), Type::Ulint, self.at),
        };
        let digit = binary(BinaryOp::Mod, shifted, whole(16), Type::Ulint, self.at);
        let place = self.add(converted(digit, Type::Lint), self.long(1));
        self.call(Builtin::Mid, vec![self.text(DIGITS), self.long(1), place])
    }

    /// A decimal number: its whole part, its fraction as the nanoseconds of so long a unit, and where it is finer than
    /// nine digits.
    fn decimal(self, text: Expr, unit: i128) -> (Expr, Expr, Expr) {
        let point = self.find(text.clone(), self.text("."));
        let pointed = || compare(BinaryOp::Gt, point.clone(), 0, self.at);
        let before = self.left(text.clone(), self.least(self.sub(point.clone(), self.long(1)), 0));
        let whole = self.number(self.pick(pointed(), text.clone(), before));
        let digits = self.pick(pointed(), self.text(""), self.behind(text, point.clone()));
        let fine = compare(BinaryOp::Gt, self.length(digits.clone()), 9, self.at);
        let nine = self.number(self.left(self.joined(vec![digits, self.text("000000000")]), self.long(9)));
        let nanos =
            if unit >= SECOND { self.mul(nine, unit / SECOND) } else { self.div(nine, SECOND / unit) };
        (whole, nanos, fine)
    }

    /// The place of a unit of time in a text, and 0 where these letters are part of another unit.
    fn unit_in(self, text: Expr, unit: &str) -> Expr {
        let place = self.find(text.clone(), self.text(unit));
        let other = match unit {
            "m" => self.call(Builtin::Mid, vec![text, self.long(1), self.add(place.clone(), self.long(1))]),
            "s" => {
                let before = self.least(self.sub(place.clone(), self.long(1)), 1);
                self.call(Builtin::Mid, vec![text, self.long(1), before])
            }
            _ => return place,
        };
        let letters = if unit == "m" { "s" } else { "mun" };
        let found = self.find(self.text(letters), other);
        choice(compare(BinaryOp::Gt, found, 0, self.at), place, self.long(0), self.at)
    }
}
