//! Times of day in UTC, as text: `2026-11-25T10:00:00.25Z`.

/// Microseconds of a day.
const DAY: i64 = 86_400_000_000;

/// A time in us since 1970 as text, with as many decimals as it needs.
pub(crate) fn show(utc: i64) -> String {
    let (day, rest) = (utc.div_euclid(DAY), utc.rem_euclid(DAY));
    let (year, month, day) = date(day);
    let (seconds, micros) = (rest / 1_000_000, rest % 1_000_000);
    let fraction = format!(".{micros:06}");
    let fraction = fraction.trim_end_matches('0').trim_end_matches('.');
    let (hour, minute, second) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{fraction}Z")
}

/// Year, month and day of a number of days since 1970.
fn date(days: i64) -> (i64, i64, i64) {
    // Years begin on the first of March here, so that a leap day is the last of its year: 146,097 days
    // are 400 years, 1461 are four.
    let days = days.saturating_add(719_468);
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (era * 400 + year + i64::from(month <= 2), month, day)
}

/// The number of days since 1970 of a date.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = year - i64::from(month <= 2);
    let (era, year) = (year.div_euclid(400), year.rem_euclid(400));
    let month = if month > 2 { month - 3 } else { month + 9 };
    era * 146_097 + year * 365 + year / 4 - year / 100 + (153 * month + 2) / 5 + day - 1 - 719_468
}

/// Reads a time, in us since 1970: a date, with a time of day or without.
pub(crate) fn read(text: &str) -> Option<i64> {
    let text = text.strip_suffix('Z').unwrap_or(text);
    let (date_text, clock) = text.split_once(['T', ' ']).unwrap_or((text, "00:00"));
    let number = |text: &str, digits| {
        let plain = text.len() == digits && text.bytes().all(|b| b.is_ascii_digit());
        text.parse::<i64>().ok().filter(|_| plain)
    };
    let mut parts = date_text.split('-');
    let (year, month, day) =
        (number(parts.next()?, 4)?, number(parts.next()?, 2)?, number(parts.next()?, 2)?);
    let whole = days(year, month, day);
    if parts.next().is_some() || date(whole) != (year, month, day) {
        return None;
    }
    let mut parts = clock.split(':');
    let (hour, minute) = (number(parts.next()?, 2)?, number(parts.next()?, 2)?);
    let (second, fraction) = parts
        .next()
        .unwrap_or("00")
        .split_once('.')
        .unwrap_or((clock.split(':').nth(2).unwrap_or("00"), "0"));
    let second = number(second, 2)?;
    let micros = number(fraction, fraction.len()).filter(|_| (1..=6).contains(&fraction.len()))?;
    let micros = micros * 10i64.pow(6 - fraction.len() as u32);
    let fits = hour < 24 && minute < 60 && second < 60 && parts.next().is_none();
    fits.then_some(whole * DAY + ((hour * 60 + minute) * 60 + second) * 1_000_000 + micros)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_they_are_shown() {
        // Times of the calendar that date(1) gives.
        for (text, seconds) in [
            ("1970-01-01T00:00:00Z", 0),
            ("2000-02-29T12:00:00Z", 951_825_600),
            ("2038-01-19T03:14:08Z", 2_147_483_648),
            ("2026-11-25T03:30:00Z", 1_795_577_400),
            ("1969-12-31T23:59:59Z", -1),
            ("2100-03-01T00:00:00Z", 4_107_542_400),
        ] {
            assert_eq!(show(seconds * 1_000_000), text);
            assert_eq!(read(text), Some(seconds * 1_000_000), "{text}");
        }
        for k in 0..200_000_i64 {
            let at = k * 1_234_567_890_123 - 100_000_000_000_000_000;
            if (0..9999).contains(&date(at.div_euclid(DAY)).0) {
                assert_eq!(read(&show(at)), Some(at), "{}", show(at));
            }
        }
        assert_eq!(read("2026-11-25"), read("2026-11-25 00:00:00.000"));
        assert_eq!(show(1_250_000), "1970-01-01T00:00:01.25Z");
        for wrong in [
            "",
            "now",
            "2026-02-29",
            "2026-13-01",
            "2026-11-25T24:00",
            "2026-11-25T1:00",
            "26-11-25",
            "2026-11-25T10:00:00.1234567",
            "2026-11-25T10:00:00.",
            "2026-11-25T10:00:00:00",
            "2026-11-25-01",
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
