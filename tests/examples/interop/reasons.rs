//! Who is right where something was not taken, reason by reason.

/// The beginning of a reason, without the names of one chart, so that equal reasons are counted together.
pub(crate) fn nameless(reason: &str) -> String {
    let parts = reason.split('`').enumerate();
    let parts: String = parts.map(|(i, part)| if i % 2 == 1 { "`…`" } else { part }).collect();
    let placeless: Vec<&str> = parts.split_whitespace().filter(|word| !word.starts_with('/')).collect();
    placeless.join(" ").replace('|', "/").chars().take(120).collect()
}

/// Words of a reason or of the file, and who is right. The first row that fits counts.
const RIGHT: [(&[&str], &str); 23] = [
    (&["refused by G7", "which IEC 61131-3 does not have"], "G7: the language has no such construct"),
    (&["refused by G7", "the meta-model"], "G7: the meta-model has no such thing"),
    (&["refused by G7", "stability"], "G7: Ladder has no loop"),
    (&["refused by G7", "loop"], "G7: Ladder has no loop"),
    (&["refused by G7"], "a limit of G7: a form could be found"),
    (
        &["IronPLC on SFC text", "'END_STEP'"],
        "G7: the standard has steps without actions, and a `;` behind the last action of an initial step",
    ),
    (&["IronPLC on SFC text", "')'"], "G7: IronPLC asks for a time at P1 and P0"),
    (&["IronPLC on SFC text", "'#'"], "G7: IronPLC reads no time at L and D"),
    (&["IronPLC on SFC text", "P4007"], "G7: IronPLC knows no S.X and S.T of a step"),
    (&["IronPLC on SFC text"], "G7: IronPLC reads a part of SFC text and runs none of it"),
    (
        &["matiec on IL", "push-back overflow"],
        "G7: the scanner of matiec has no room for so long a body of IL",
    ),
    (&["matiec", "Initial value has incompatible"], "G7: matiec takes no LREAL beyond the range of REAL"),
    (&["matiec on SFC text", "it says nothing"], "G7: matiec ends with a signal at a STRING with a length"),
    (&["matiec on SFC text", "not declared in this scope"], "G7: matiec loses a STRING with a length"),
    (&["matiec", "unknown error"], "not judged: matiec names no reason"),
    (
        &["run:", "it ends with a signal"],
        "G7: the chart divides by zero or does not end, which is a fault here; C of matiec is ended by the system",
    ),
    (&["run:", "no name to compare"], "not compared: the chart has nothing but texts and real numbers"),
    (&["run:", "st-f"], "G7: matiec leaves out a FOR loop of one iteration (`WHILE i < last`)"),
    (
        &["run:", "string-length"],
        "G7: a character of UTF-8 is one character here, and several in C of matiec",
    ),
    (&["run:", "example_sequential"], "nobody: TIME_TO_DINT counts in seconds there, of which G7 warns"),
    (&["run:"], "a difference that is not explained"),
    (&["missing"], "nobody: it is not installed"),
    (&[], "a form of G7 that the tool does not take, or a fault of the tool"),
];

/// Who is right where something was not taken.
pub(crate) fn who(reason: &str, file: &std::path::Path) -> &'static str {
    let file = file.to_string_lossy();
    let fits = |words: &&[&str]| words.iter().all(|w| reason.contains(w) || file.contains(w));
    RIGHT.iter().find(|(words, _)| fits(words)).map_or("", |(_, who)| who)
}
