//! The conformance cases that explain a rule: the files of `tests/spec` themselves, so that what is explained is
//! what is tested.

/// A rule with a chart that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// The heading.
    pub title: &'static str,
    /// The rule in words.
    pub rule: &'static str,
    /// The clauses of standards and documents that it is taken from.
    pub source: &'static str,
    /// The chart.
    pub chart: &'static str,
}

macro_rules! cases {
    ($($name:literal)*) => {
        /// The texts of the cases, by name.
        const TEXTS: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../tests/spec/", $name, ".md")))),*];
    };
}

cases! {
    "iec60848/edge-falling"
    "iec60848/edge-with-a-condition"
    "iec60848/enable"
    "iec60848/enclosing-activation-links"
    "iec60848/enclosing-initial"
    "iec60848/forcing-agreement"
    "iec60848/forcing-given-steps"
    "iec60848/linked-charts-alternation"
    "iec60848/macro-entry-and-exit"
    "iec60848/mask-a-chart"
    "iec60848/rule-1-initial-situation"
    "iec60848/rule-2-join-waits"
    "iec60848/rule-2-only-enabled-transitions"
    "iec60848/rule-3-fork"
    "iec60848/rule-3-or-divergence"
    "iec60848/sink-transition"
    "iec60848/source-transition"
    "iec60848/task-called-twice-in-turn"
    "iec60848/time-on-a-condition"
    "litmus/04-unstable-loop"
    "litmus/10-reset-dominates"
    "pl7/pre-of-charts"
    "side-by-side/event"
    "side-by-side/on-clearing"
    "side-by-side/priorities"
    "side-by-side/qualifier-d"
    "side-by-side/qualifier-ds"
    "side-by-side/qualifier-l"
    "side-by-side/qualifier-n"
    "side-by-side/qualifier-p"
    "side-by-side/qualifier-p0"
    "side-by-side/qualifier-p1"
    "side-by-side/qualifier-s"
    "side-by-side/qualifier-sd"
    "side-by-side/qualifier-sl"
    "unity/transition-section"
}

/// The case of this name, `iec60848/rule-3-fork`.
pub fn find(name: &str) -> Option<Case> {
    let (_, text) = TEXTS.iter().find(|(n, _)| *n == name)?;
    let (title, rest) = text.strip_prefix("# ")?.split_once("\n\n")?;
    let (rule, rest) = rest.split_once("\n\nsource: ")?;
    let (source, rest) = rest.split_once('\n')?;
    let (_, rest) = rest.split_once("```g7\n")?;
    let (chart, _) = rest.split_once("\n```")?;
    Some(Case { title, rule, source, chart })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::{OF_CODES, OF_QUALIFIERS, OF_TRANSITIONS, OF_WORDS};

    #[test]
    fn each_rule_has_its_case_and_each_case_is_asked_for() {
        let words = OF_WORDS.iter().chain(OF_CODES).map(|(_, case)| *case);
        let asked: Vec<&str> =
            words.chain(OF_QUALIFIERS.iter().map(|(_, case)| *case)).chain(OF_TRANSITIONS).collect();
        for name in &asked {
            let case = find(name).unwrap_or_else(|| panic!("{name} is no case"));
            assert!(case.chart.contains("chart "), "{name}");
        }
        for (name, _) in TEXTS {
            assert!(asked.contains(name), "nothing asks for {name}");
        }
        for (code, _) in OF_CODES {
            assert!(g7_model::codes::find(code).is_some(), "{code}");
        }
        for (word, _) in OF_WORDS {
            assert!(g7_model::words::rows(word).next().is_some(), "{word}");
        }
        let fork = find("iec60848/rule-3-fork").expect("a case");
        assert_eq!(fork.title, "A fork activates all its branches");
        assert!(fork.rule.ends_with("go on independently."), "{}", fork.rule);
        assert!(fork.source.starts_with("IEC 60848:2013, 4.5 evolution rule 3;"), "{}", fork.source);
        assert!(fork.chart.ends_with("4 -> 6 when c\n}"), "{}", fork.chart);
    }
}
