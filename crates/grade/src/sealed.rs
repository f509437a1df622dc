//! The hidden part of an exercise as one word of letters and digits, for a student's own program.
//!
//! A student who searches the files of a page finds no test in them. It is no secret: the program that opens it is in the
//! student's hands (decision 78).
//!
//! ```text
//! names that the exercise looks at, one a line; an empty line; plants, tests and properties
//!                          -> bytes, each mixed with a number of a fixed series -> hexadecimal digits
//! ```

/// The first line, by which a damaged word is known.
const HEAD: &str = "g7 hidden 1";
/// Where the series of numbers begins.
const SEED: u64 = 0x6737_2068_6964_6465;

/// Makes the word.
pub(crate) fn seal(needs: &[String], texts: &[&str]) -> String {
    let text = format!("{}\n\n{}\n", [&[HEAD.to_owned()], needs].concat().join("\n"), texts.join("\n\n"));
    mixed(text.bytes()).map(|byte| format!("{byte:02x}")).collect()
}

/// The names and the text of a word; nothing of a damaged one.
pub(crate) fn open(word: &str) -> Option<(Vec<String>, String)> {
    let digits: Option<Vec<u8>> = word.chars().map(|c| Some(c.to_digit(16)? as u8)).collect();
    let digits = digits.filter(|all| all.len().is_multiple_of(2))?;
    let bytes = digits.chunks_exact(2).map(|pair| pair.iter().fold(0, |byte, digit| byte << 4 | digit));
    let text = String::from_utf8(mixed(bytes).collect()).ok()?;
    let (needs, rest) = text.strip_prefix(HEAD)?.split_once("\n\n")?;
    Some((needs.lines().skip(1).map(str::to_owned).collect(), rest.to_owned()))
}

/// Bytes mixed with the series, or had back from that: the same step does both.
fn mixed(bytes: impl Iterator<Item = u8>) -> impl Iterator<Item = u8> {
    let mut state = SEED;
    bytes.map(move |byte| {
        // A step of xorshift, whose upper bits look like chance.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        byte ^ (state >> 56) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_sealed_opens_as_it_was_and_cannot_be_read() {
        let needs = ["step\tLamp\tOn".to_owned(), "variable\t\tbutton".to_owned()];
        let word = seal(&needs, &["test \"é\" {\n}", "prove never lamp"]);
        assert_eq!(open(&word), Some((needs.to_vec(), "test \"é\" {\n}\n\nprove never lamp\n".to_owned())));
        assert!(word.bytes().all(|b| b.is_ascii_hexdigit()));
        // Equal letters differ by their places.
        let same = seal(&[], &["aaaaaaaa"]);
        let pairs: Vec<&[u8]> = same.as_bytes().chunks(2).rev().skip(1).take(8).collect();
        assert!(pairs.windows(2).any(|two| two[0] != two[1]), "{same}");
    }

    #[test]
    fn without_names_it_opens_too() {
        assert_eq!(open(&seal(&[], &["x"])), Some((Vec::new(), "x\n".to_owned())));
    }

    #[test]
    fn a_damaged_word_is_nothing() {
        let word = seal(&[], &["test"]);
        let cut = word.get(..word.len() - 1).unwrap_or_default();
        let changed = format!("0{}", word.get(1..).unwrap_or_default());
        for damaged in ["", "zz", cut, &changed, &format!("00{word}")] {
            assert_eq!(open(damaged), None, "{damaged}");
        }
    }
}
