//! Prints durations in the units that people use.

/// Nanoseconds as `1m30s`, `2.5s`, `500ms`, `10us`.
pub(crate) fn duration(ns: i64) -> String {
    let sign = if ns < 0 { "−" } else { "" };
    let ns = ns.unsigned_abs();
    let units = [("d", 86_400_000_000_000), ("h", 3_600_000_000_000), ("m", 60_000_000_000)];
    let mut text = sign.to_owned();
    let mut rest = ns;
    for (unit, size) in units {
        if rest >= size {
            text.push_str(&format!("{}{unit}", rest / size));
            rest %= size;
        }
    }
    if rest == 0 && ns > 0 {
        return text;
    }
    let small = [("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1000), ("ns", 1)];
    // After minutes, a fraction of a second is still printed in seconds: `1m0.5s`.
    let (unit, size) = if ns >= 1_000_000_000 || ns == 0 {
        ("s", 1_000_000_000)
    } else {
        small.into_iter().find(|(_, size)| rest >= *size).unwrap_or(("ns", 1))
    };
    let fraction = format!("{:0width$}", rest % size, width = size.ilog10() as usize);
    text.push_str(&(rest / size).to_string());
    if !rest.is_multiple_of(size) {
        text.push('.');
        text.push_str(fraction.trim_end_matches('0'));
    }
    text.push_str(unit);
    text
}

#[cfg(test)]
mod tests {
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
            (60_500_000_000, "1m0.5s"),
            (86_400_000_000_000, "1d"),
            (-5_000_000_000, "−5s"),
        ];
        for (ns, text) in cases {
            assert_eq!(duration(ns), text);
        }
    }
}
