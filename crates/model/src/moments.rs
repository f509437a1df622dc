//! Dates and times of day: how their nanoseconds are written and read (IEC 61131-3:2003, 2.2.3.2).
//!
//! The calendar is the Gregorian one for all years; there are no zones and no leap seconds (decision 65).

use crate::{Nanos, Said, say};

/// The types of dates and times of day (IEC 61131-3:2003, table 10, ANY_DATE).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Moment {
    /// A day, as the nanoseconds from 1970-01-01 to its beginning.
    Date,
    /// A time of day, as the nanoseconds since midnight: at least 0, and less than 24 h.
    Tod,
    /// A day with a time, as the nanoseconds since 1970-01-01-00:00:00.
    Dt,
}

impl Moment {
    /// Days from 0000-03-01 to 1970-01-01.
    pub const ERA: i64 = 719_468;
    /// Days of 400 years.
    pub const CYCLE: i64 = 146_097;

    /// All of them, in the order of the standard's table.
    pub const ALL: [Moment; 3] = [Moment::Date, Moment::Tod, Moment::Dt];

    /// The name of the type; of the two that the standard has for a time of day and for a day with a time, the short one.
    pub const fn name(self) -> &'static str {
        match self {
            Moment::Date => "DATE",
            Moment::Tod => "TOD",
            Moment::Dt => "DT",
        }
    }

    /// The words before the `#` of a literal, in capitals, with the long ones of IEC 61131-3:2013. A text of the type begins
    /// with the first one.
    pub const fn words(self) -> [&'static str; 4] {
        match self {
            Moment::Date => ["D", "DATE", "LD", "LDATE"],
            Moment::Tod => ["TOD", "TIME_OF_DAY", "LTOD", "LTIME_OF_DAY"],
            Moment::Dt => ["DT", "DATE_AND_TIME", "LDT", "LDATE_AND_TIME"],
        }
    }

    /// The type of a literal by the word before its `#`, in capitals.
    pub fn of_literal(word: &str) -> Option<Moment> {
        Moment::ALL.into_iter().find(|moment| moment.words().contains(&word))
    }

    /// True if the type has this value: a DATE is a whole number of days, a TOD lies within one day.
    pub const fn admits(self, value: Nanos) -> bool {
        match self {
            Moment::Date => value.count() % Nanos::DAY.count() == 0,
            Moment::Tod => 0 <= value.count() && value.count() < Nanos::DAY.count(),
            Moment::Dt => true,
        }
    }

    /// The unit of a value as a number: seconds since 1970 of a date, milliseconds since midnight of a time of day.
    pub const fn unit(self) -> Nanos {
        match self {
            Moment::Date | Moment::Dt => Nanos::SECOND,
            Moment::Tod => Nanos::MILLISECOND,
        }
    }

    /// The value without its type: `2026-11-28`, `15:36:55.36`, `2026-11-28-15:36:55.36`.
    pub fn text(self, value: Nanos) -> String {
        let day = Nanos::DAY.count();
        let (days, rest) = (value.count().div_euclid(day), value.count().rem_euclid(day));
        match self {
            Moment::Date => date(days),
            Moment::Tod => clock(rest),
            Moment::Dt => format!("{}-{}", date(days), clock(rest)),
        }
    }

    /// The value as a literal: `DATE#2026-11-28`, `TOD#15:36:55.36`, `DT#2026-11-28-15:36:55.36`.
    pub fn literal(self, value: Nanos) -> String {
        format!("{}#{}", self.name(), self.text(value))
    }

    /// Reads a value as [`Moment::text`] writes it. The seconds of a time may be left out.
    ///
    /// # Errors
    ///
    /// The text is no such value; the day or the time does not exist; the day is not within 1677-09-22 to 2262-04-11; the
    /// time has a fraction of a nanosecond.
    pub fn read(self, text: &str) -> Result<Nanos, Said> {
        match self {
            Moment::Date => day_of(text).and_then(|days| sum(days, 0)),
            Moment::Tod => time_of(text).and_then(|time| sum(0, time)),
            Moment::Dt => {
                let cut = text.match_indices('-').nth(2).map(|(at, _)| at);
                let (day, time) =
                    cut.and_then(|at| text.split_at_checked(at)).ok_or_else(|| self.expected())?;
                sum(day_of(day)?, time_of(time.strip_prefix('-').unwrap_or(time))?)
            }
        }
    }

    /// The number of bytes at the beginning of a text that belong to a value of this type. There are only as many `-` in it as
    /// it can have: what follows is a minus.
    pub fn length(self, text: &str) -> usize {
        let bytes = text.as_bytes();
        let digit = |k: usize| bytes.get(k).is_some_and(u8::is_ascii_digit);
        let mut dashes = match self {
            Moment::Date => 2,
            Moment::Tod => 0,
            Moment::Dt => 3,
        };
        let mut length = 0;
        while let Some(byte) = bytes.get(length) {
            match byte {
                b'0'..=b'9' => {}
                b':' | b'.' if digit(length + 1) => {}
                b'-' if dashes > 0 && digit(length + 1) => dashes -= 1,
                _ => break,
            }
            length += 1;
        }
        length
    }

    /// How a value of the type is written, for a message.
    fn expected(self) -> Said {
        match self {
            Moment::Date => say!("a date is written `2026-11-28`"),
            Moment::Tod => say!("a time of day is written `15:36:55`"),
            Moment::Dt => say!("a date with a time is written `2026-11-28-15:36:55`"),
        }
    }
}

/// The nanoseconds of days and a time.
fn sum(days: i64, time: i64) -> Result<Nanos, Said> {
    let all = i128::from(days) * i128::from(Nanos::DAY.count()) + i128::from(time);
    i64::try_from(all).map(Nanos::new).map_err(|_| say!("dates go from 1677-09-22 to 2262-04-11"))
}

/// A number of decimal digits, at most `most` of them.
fn digits(text: &str, most: usize) -> Option<i64> {
    let written = !text.is_empty() && text.len() <= most && text.bytes().all(|b| b.is_ascii_digit());
    text.parse().ok().filter(|_| written)
}

/// The days from 1970-01-01 to `2026-11-28`.
fn day_of(text: &str) -> Result<i64, Said> {
    let mut parts = text.split('-');
    let mut part = |most| parts.next().and_then(|p| digits(p, most));
    let (Some(year), Some(month), Some(day), None) = (part(4), part(2), part(2), parts.next()) else {
        return Err(Moment::Date.expected());
    };
    let days = days_from(year, month, day);
    // A day that does not exist comes back as another one.
    if !(1..=12).contains(&month) || civil(days) != (year, month, day) {
        return Err(say!("there is no day {}", Said::foreign(text)));
    }
    Ok(days)
}

/// The nanoseconds of `15:36:55.36`.
fn time_of(text: &str) -> Result<i64, Said> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let mut parts = whole.split(':');
    let (hours, minutes) = (parts.next(), parts.next());
    let seconds = parts.next();
    let number = |part: Option<&str>| part.and_then(|p| digits(p, 2));
    let (Some(hour), Some(minute), Some(second), None) =
        (number(hours), number(minutes), number(seconds.or(Some("0"))), parts.next())
    else {
        return Err(Moment::Tod.expected());
    };
    let pointed = text.contains('.');
    if pointed && (seconds.is_none() || !fraction.bytes().all(|b| b.is_ascii_digit()) || fraction.is_empty())
    {
        return Err(Moment::Tod.expected());
    }
    let fraction = fraction.trim_end_matches('0');
    if fraction.len() > 9 {
        return Err(say!("the time of day is finer than one nanosecond"));
    }
    let nanos = digits(&format!("{fraction:0<9}"), 9).unwrap_or(0);
    if hour > 23 || minute > 59 || second > 59 {
        return Err(say!("there is no time of day {}", Said::foreign(text)));
    }
    Ok(((hour * 60 + minute) * 60 + second) * Nanos::SECOND.count() + nanos)
}

/// Days from 1970-01-01 to a day of a year from 0. Years begin in March here, so that the day of a leap year is their last.
fn days_from(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    year * 365 + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + of_year - Moment::ERA
}

/// Year, month and day of a day that is so many days after 1970-01-01.
fn civil(days: i64) -> (i64, i64, i64) {
    let days = days + Moment::ERA;
    let (cycle, of_cycle) = (days.div_euclid(Moment::CYCLE), days.rem_euclid(Moment::CYCLE));
    // Each 4 years (1,460 days) end with a leap day; each 100 years (36,524 days) do not; each 400 years (146,096 days) do.
    let of_century = (of_cycle - of_cycle / 1_460 + of_cycle / 36_524 - of_cycle / 146_096) / 365;
    let of_year = of_cycle - (365 * of_century + of_century / 4 - of_century / 100);
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = of_century + 400 * cycle + i64::from(month <= 2);
    (year, month, day)
}

fn date(days: i64) -> String {
    let (year, month, day) = civil(days);
    format!("{year:04}-{month:02}-{day:02}")
}

fn clock(nanos: i64) -> String {
    let (seconds, part) = (nanos / Nanos::SECOND.count(), nanos % Nanos::SECOND.count());
    let text = format!("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
    if part == 0 {
        return text;
    }
    let part = format!("{part:09}");
    format!("{text}.{}", part.trim_end_matches('0'))
}

#[cfg(test)]
mod tests {
    use super::{Moment, civil, days_from};
    use crate::Nanos;

    #[test]
    fn each_day_has_one_number_and_follows_the_day_before() {
        let mut last = civil(-106_752);
        for days in -106_751..=106_751 {
            let (year, month, day) = civil(days);
            assert_eq!(days_from(year, month, day), days);
            let leap = year % 4 == 0 && year % 100 != 0 || year % 400 == 0;
            let most = [31, if leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
            let follows = match last {
                (y, 12, 31) => (y + 1, 1, 1),
                (y, m, d) if d == most[m as usize - 1] => (y, m + 1, 1),
                (y, m, d) => (y, m, d + 1),
            };
            assert_eq!((year, month, day), follows);
            last = (year, month, day);
        }
        assert_eq!((civil(0), civil(20_785)), ((1970, 1, 1), (2026, 11, 28)));
    }

    #[test]
    fn values_are_read_as_they_are_written() {
        let second = Nanos::SECOND.count();
        let cases = [
            (Moment::Date, "1970-01-01", 0),
            (Moment::Date, "1984-06-25", 5_289 * 86_400 * second),
            (Moment::Date, "1969-12-31", -86_400 * second),
            (Moment::Date, "2262-04-11", 106_751 * 86_400 * second),
            (Moment::Tod, "00:00:00", 0),
            (Moment::Tod, "15:36:55.36", 56_215 * second + 360_000_000),
            (Moment::Tod, "23:59:59.999999999", 86_400 * second - 1),
            (Moment::Dt, "1984-06-25-15:36:55.36", (5_289 * 86_400 + 56_215) * second + 360_000_000),
            (Moment::Dt, "2262-04-11-23:47:16.854775807", i64::MAX),
            (Moment::Dt, "1677-09-21-00:12:43.145224192", i64::MIN),
        ];
        for (moment, text, count) in cases {
            assert_eq!(moment.read(text), Ok(Nanos::new(count)), "{text}");
            assert_eq!(moment.text(Nanos::new(count)), text);
            assert!(moment.admits(Nanos::new(count)), "{text}");
        }
        assert_eq!(Moment::Tod.read("7:05"), Ok(Nanos::MINUTE * 425));
        assert_eq!((Moment::Tod.length("15:36:55-2s"), Moment::Date.length("2026-11-28-1")), (8, 10));
        assert_eq!(Moment::Dt.literal(Nanos::ZERO), "DT#1970-01-01-00:00:00");
        assert!(!Moment::Date.admits(Nanos::new(1)) && !Moment::Tod.admits(Nanos::DAY));
    }

    #[test]
    fn what_does_not_exist_is_refused() {
        for text in ["2026-02-29", "1900-02-29", "2026-04-31", "2026-13-01", "2026-00-01", "2026-1-0"] {
            assert!(Moment::Date.read(text).is_err_and(|why| why.contains("no day")), "{text}");
        }
        for text in ["2262-04-12", "1677-09-21"] {
            assert!(Moment::Date.read(text).is_err_and(|why| why.contains("1677-09-22")), "{text}");
        }
        for text in ["", "2026", "2026-11", "2026-11-28-", "26-11-28x", "-1-1-1", "20261-1-1", "2026-011-1"] {
            assert!(Moment::Date.read(text).is_err(), "{text}");
        }
        for text in [
            "24:00:00",
            "00:60:00",
            "00:00:60",
            "1:2:3:4",
            "12",
            "12:00.5",
            "12:00:0.",
            "12:00:00.1234567891",
        ] {
            assert!(Moment::Tod.read(text).is_err(), "{text}");
        }
        for text in ["2026-11-28", "2026-11-28-", "2026-11-28 15:36:55", "15:36:55", "2026-02-30-00:00:00"] {
            assert!(Moment::Dt.read(text).is_err(), "{text}");
        }
        assert!(Moment::Date.read("2000-02-29").is_ok() && Moment::Tod.read("12:00:00.1234567890").is_ok());
    }
}
