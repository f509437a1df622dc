//! Times of day as people write them, in UTC (ISO 8601): for logs and messages, never for a chart.

const DAY: u64 = 86_400;

/// Year, month and day of a day since 1970. The years of this calendar repeat after 400, which begin with March
/// here, so that a leap day is the last of its year.
fn civil(day: u64) -> (u64, u64, u64) {
    let day = day + 719_468;
    let (era, of_era) = (day / 146_097, day % 146_097);
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let date = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (era * 400 + year + u64::from(month <= 2), month, date)
}

/// The day since 1970 of a date; `None` where there is none, or one before 1970.
fn day_of(year: u64, month: u64, date: u64) -> Option<u64> {
    let shifted = if month <= 2 { year.checked_sub(1)? } else { year };
    let months = if month > 2 { month.checked_sub(3)? } else { month.checked_add(9)? };
    let (era, of_era) = (shifted / 400, shifted % 400);
    let of_year = (153 * months + 2) / 5 + date.checked_sub(1)?;
    let day = (era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year).checked_sub(719_468)?;
    (civil(day) == (year, month, date)).then_some(day)
}

/// The day of a second since 1970, UTC: `2026-11-25`.
pub fn utc_day(second: u64) -> String {
    let (year, month, date) = civil(second.min(u64::MAX / 1_000) / DAY);
    format!("{year:04}-{month:02}-{date:02}")
}

/// A time of day in ms since 1970, UTC: `2026-11-25 13:05:09.250`.
pub fn utc_text(millis: u64) -> String {
    let second = millis / 1_000;
    let (hour, minute) = (second % DAY / 3_600, second % 3_600 / 60);
    format!("{} {hour:02}:{minute:02}:{:02}.{:03}", utc_day(second), second % 60, millis % 1_000)
}

/// Reads `2026-11-25`, `2026-11-25 13:05` or `2026-11-25 13:05:09`, in UTC, as ms since 1970.
///
/// # Errors
///
/// A sentence that says what is expected.
pub fn utc_of(text: &str) -> Result<u64, String> {
    let wrong = || format!("`{text}` is no time: expected 2026-11-25 or \"2026-11-25 13:05:09\", in UTC");
    let (day, time) = text.trim().split_once([' ', 'T']).unwrap_or((text.trim(), ""));
    let numbers =
        |text: &str, sign: char, count: std::ops::RangeInclusive<usize>| -> Result<Vec<u64>, String> {
            let all: Result<Vec<u64>, _> = text.split(sign).map(str::parse).collect();
            all.ok().filter(|all| count.contains(&all.len())).ok_or_else(wrong)
        };
    let date = numbers(day, '-', 3..=3)?;
    let [year, month, date] = date.as_slice() else { return Err(wrong()) };
    if *year > 9_999 || *month > 12 || *date > 31 {
        return Err(wrong());
    }
    let day = day_of(*year, *month, *date).ok_or_else(wrong)?;
    let time = if time.is_empty() { vec![0, 0] } else { numbers(time.trim_end_matches('Z'), ':', 2..=3)? };
    let (hour, minute, second) = match time.as_slice() {
        [hour, minute] => (*hour, *minute, 0),
        [hour, minute, second] => (*hour, *minute, *second),
        _ => return Err(wrong()),
    };
    if hour > 23 || minute > 59 || second > 59 {
        return Err(wrong());
    }
    Ok((day * DAY + hour * 3_600 + minute * 60 + second) * 1_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_day_are_those_of_the_calendar() {
        // As `date -u -d @…` prints them.
        for (millis, text) in [
            (0, "1970-01-01 00:00:00.000"),
            (951_782_399_999, "2000-02-28 23:59:59.999"),
            (951_782_400_000, "2000-02-29 00:00:00.000"),
            (951_868_800_000, "2000-03-01 00:00:00.000"),
            (1_709_251_199_000, "2024-02-29 23:59:59.000"),
            (2_147_483_648_000, "2038-01-19 03:14:08.000"),
            (4_107_542_400_000, "2100-03-01 00:00:00.000"),
        ] {
            assert_eq!(utc_text(millis), text);
            if millis % 1_000 == 0 {
                assert_eq!(utc_of(&text[..19]), Ok(millis));
            }
        }
        utc_text(u64::MAX);
    }

    #[test]
    fn what_is_no_time_is_refused() {
        assert_eq!(utc_of("2026-11-25"), utc_of("2026-11-25T00:00Z"));
        let long = "9".repeat(30);
        for wrong in [
            "",
            "now",
            "2026-02-29",
            "2026-13-01",
            "2026-00-01",
            "2026-1-0",
            "1969-12-31",
            "2026-11-25 24:00",
            "2026-11-25 1",
            &long,
        ] {
            assert!(utc_of(wrong).is_err(), "{wrong}");
        }
    }
}
