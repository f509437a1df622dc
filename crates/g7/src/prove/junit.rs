//! Answers as a JUnit report, for build servers.
//!
//! The format has no standard; the elements and attributes are those of the schema `junit-10.xsd` of Jenkins
//! (xUnit plugin), which other readers understand too: a suite for each file, a case for each question. What is
//! refuted is a failure, what is not decided is skipped, a file that cannot be asked is an error.

use g7_verify::Verdict;

use super::found::Found;
use super::output::{counts, trouble};
use crate::testing::escape;

pub(super) fn junit(all: &[Found]) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let (numbers, _) = numbers(all);
    out.push_str(&format!("<testsuites name=\"g7 prove\" {numbers}>\n"));
    all.iter().for_each(|found| suite(&mut out, found));
    out.push_str("</testsuites>\n");
    out
}

/// The counts of cases, as attributes; and that of the skipped ones, which only a suite has.
fn numbers(all: &[Found]) -> (String, usize) {
    let [proved, refuted, open] = counts(all);
    let errors = all.iter().filter(|f| f.tally.errors > 0).count();
    let unasked = all.iter().filter(|f| f.unasked.is_some()).count();
    let tests = proved + refuted + open + errors + unasked;
    let text = format!("tests=\"{tests}\" failures=\"{refuted}\" errors=\"{errors}\" time=\"0\"");
    (text, open + unasked)
}

fn suite(out: &mut String, found: &Found) {
    let name = escape(&found.name);
    let (numbers, skipped) = numbers(std::slice::from_ref(found));
    out.push_str(&format!("  <testsuite name=\"{name}\" {numbers} skipped=\"{skipped}\">\n"));
    let mut case = |title: &str, inner: &str| {
        let head = format!("    <testcase classname=\"{name}\" name=\"{}\" time=\"0\"", escape(title));
        match inner {
            "" => out.push_str(&format!("{head}/>\n")),
            inner => out.push_str(&format!("{head}>\n      {inner}\n    </testcase>\n")),
        }
    };
    let text = trouble(found).unwrap_or_default();
    if found.tally.errors > 0 {
        case("the questions", &format!("<error message=\"errors\">{}</error>", escape(text.trim())));
    } else if found.unasked.is_some() {
        case("the questions", &format!("<skipped message=\"{}\"/>", escape(&text)));
    }
    for a in &found.answers {
        let inner = match a.verdict {
            Verdict::Proved(_) => String::new(),
            Verdict::Refuted(_) => {
                let parts = [&*a.reason, a.chronogram.trim_end(), &*a.guilt, &*a.help];
                let body: Vec<&str> = parts.into_iter().filter(|p| !p.is_empty()).collect();
                let (message, body) = (format!("{}: refuted", a.place), body.join("\n"));
                format!("<failure message=\"{}\">{}</failure>", escape(&message), escape(&body))
            }
            Verdict::Open(_) => {
                format!(
                    "<skipped message=\"{}\"/>",
                    escape(&format!("{}: not decided: {}", a.place, a.reason))
                )
            }
        };
        case(&a.claim, &inner);
    }
    out.push_str("  </testsuite>\n");
}
