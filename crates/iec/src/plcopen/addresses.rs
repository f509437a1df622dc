//! The addresses of variables.

use g7_model::{Name, codes, say};

use super::tree::{Xml, kid, text};
use crate::nodes::line;
use crate::report::Report;
use crate::xml::attr::Text;

fn written(variable: Xml) -> Option<Text> {
    let inner = || kid(variable, "address").and_then(|a| text(a, "address").or_else(|| text(a, "value")));
    text(variable, "address").or_else(inner).filter(|t| !t.text.trim().is_empty())
}

/// The direction of an address: `I`, `Q` or `M`. An incomplete address (`%I*`) tells it too.
pub(super) fn channel(variable: Xml) -> Option<char> {
    written(variable)?.text.trim().chars().nth(1).map(|c| c.to_ascii_uppercase())
}

/// The address with its `%`. An incomplete address (`%I*`) counts as none.
pub(super) fn address(variable: Xml, report: &mut Report) -> Option<Name> {
    let text = written(variable)?;
    let word = line(text.text.trim());
    if let Some(kind) = word.strip_suffix('*') {
        let what = say!("an address that is given elsewhere (`{kind}*`); the variable has none");
        report.element(&codes::LEFT_OUT, "address", &text.at, what);
        return None;
    }
    Some(Name::new(word, report.span(&text.at)))
}
