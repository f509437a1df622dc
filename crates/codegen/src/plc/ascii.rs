//! Comments of printed code in ASCII alone, for tools that take no other letters. Names are ASCII
//! anyway.

/// Signs and letters with what stands for them.
const SIGNS: &[(&str, &str)] = &[
    ("↑", "rise of "),
    ("↓", "fall of "),
    ("·", "*"),
    ("×", "*"),
    ("¬", "not "),
    ("≤", "<="),
    ("≥", ">="),
    ("≠", "<>"),
    ("→", "->"),
    ("…", "..."),
    ("–", "-"),
    ("—", "-"),
    ("’", "'"),
    ("‘", "'"),
    ("“", "\""),
    ("”", "\""),
    ("°", "deg "),
    ("µ", "u"),
    ("àáâãåÀÁÂÃÅ", "aaaaaAAAAA"),
    ("èéêëÈÉÊË", "eeeeEEEE"),
    ("ìíîïÌÍÎÏ", "iiiiIIII"),
    ("òóôõÒÓÔÕ", "ooooOOOO"),
    ("ùúûÙÚÛ", "uuuUUU"),
    ("çÇñÑýÿ", "cCnNyy"),
    ("ä", "ae"),
    ("ö", "oe"),
    ("ü", "ue"),
    ("Ä", "Ae"),
    ("Ö", "Oe"),
    ("Ü", "Ue"),
    ("ß", "ss"),
    ("œ", "oe"),
    ("Œ", "OE"),
    ("æ", "ae"),
    ("Æ", "AE"),
];

/// The same text in ASCII; a letter without a counterpart becomes its number, `U+03A9`.
pub fn ascii(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_ascii() {
            out.push(c);
            continue;
        }
        let row = SIGNS.iter().find_map(|(from, to)| {
            let at = from.chars().position(|f| f == c)?;
            // A row of several letters has one for each.
            if from.chars().nth(1).is_some() { to.get(at..=at) } else { Some(*to) }
        });
        match row {
            Some(to) => out.push_str(to),
            None => out.push_str(&format!("U+{:04X}", u32::from(c))),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::ascii;

    #[test]
    fn every_letter_becomes_ascii() {
        assert_eq!(ascii("↑départ · ¬plein ≥ 3 Ω"), "rise of depart * not plein >= 3 U+03A9");
        assert_eq!(ascii("Tür ÃÇ"), "Tuer AC");
    }
}
