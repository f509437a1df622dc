//! Prints durations in the units that people use.

use g7_model::Nanos;

/// A duration as .g7 text writes it, `1m30s`, `2.5s`, `500ms`, `10us`; a negative one has the sign
/// of the font before it.
pub(crate) fn duration(time: Nanos) -> String {
    time.plain().replace('-', "−")
}

#[cfg(test)]
mod tests {
    use g7_model::Nanos;

    use super::duration;

    #[test]
    fn durations_read_as_written() {
        let cases = [
            (0, "0s"),
            (5_000_000_000, "5s"),
            (90_000_000_000, "1m30s"),
            (2_500_000_000, "2.5s"),
            (500_000_000, "500ms"),
            (1_500_000, "1.5ms"),
            (40, "40ns"),
            (60_500_000_000, "1m500ms"),
            (86_400_000_000_000, "1d"),
            (-5_000_000_000, "−5s"),
        ];
        for (count, text) in cases {
            assert_eq!(duration(Nanos::new(count)), text);
        }
    }
}
