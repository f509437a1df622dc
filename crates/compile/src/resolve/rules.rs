//! Translates profile and switches to the engine's [`Rules`].

use std::mem::discriminant;

use g7_engine::Rules;
use g7_model::{Document, Item, Problem, Profile, ProfileName, Span, Switch, codes, say};

/// The rules that a profile starts from.
pub fn of_profile(name: ProfileName) -> Rules {
    match name {
        ProfileName::Iec60848 => Rules::IEC60848,
        ProfileName::Iec61131 => Rules::IEC61131,
        ProfileName::Pl7 => Rules::PL7,
        ProfileName::Unity => Rules::UNITY,
        ProfileName::Jgrafchart => Rules::JGRAFCHART,
    }
}

/// The system bits and words that a user sets beside the program, by the terminal of the PLC
/// (PL7 reference manual, system bits): those of `pl7`, upper case without `%`.
pub(super) fn of_terminal(name: ProfileName) -> &'static [&'static str] {
    match name {
        ProfileName::Pl7 => &["S0", "S21", "S22", "S23", "S24", "SW22", "SW23", "SW24", "SW25"],
        ProfileName::Iec60848 | ProfileName::Iec61131 | ProfileName::Unity | ProfileName::Jgrafchart => &[],
    }
}

/// The rules of the document's profile with its switches. Another profile replaces it together with
/// its switches.
pub(super) fn of_document(
    doc: &Document,
    instead: Option<ProfileName>,
    problems: &mut Vec<Problem>,
) -> (ProfileName, Rules) {
    let mut first: Option<&Profile> = None;
    for item in &doc.items {
        let Item::Profile(p) = item else { continue };
        match first {
            Some(f) => problems.push(
                Problem::new(&codes::DEFINED_TWICE, p.at.0, say!("the profile is given twice"))
                    .related(f.at.0, say!("given here first")),
            ),
            None => {
                first = Some(p);
                repeated_switches(p, problems);
            }
        }
    }
    let name = instead.or(first.map(|p| p.name)).unwrap_or_default();
    let mut rules = of_profile(name);
    if let (None, Some(p)) = (instead, first) {
        for (switch, _) in &p.switches {
            apply(&mut rules, *switch);
        }
    }
    (name, rules)
}

/// Reports two words for one switch: they contradict each other, or say it twice.
fn repeated_switches(p: &Profile, problems: &mut Vec<Problem>) {
    let mut seen: Vec<(Switch, Span)> = Vec::new();
    for (switch, at) in &p.switches {
        if matches!(switch, Switch::Bound(0)) {
            problems.push(Problem::new(&codes::OUT_OF_RANGE, at.0, say!("a scan needs at least one pass")));
        }
        match seen.iter().find(|(s, _)| discriminant(s) == discriminant(switch)) {
            Some((_, before)) => problems.push(
                Problem::new(&codes::DEFINED_TWICE, at.0, say!("this switch is set twice"))
                    .related(*before, say!("set here first")),
            ),
            None => seen.push((*switch, at.0)),
        }
    }
}

/// Rules with a switch set.
pub fn with_switch(mut rules: Rules, switch: Switch) -> Rules {
    apply(&mut rules, switch);
    rules
}

fn apply(rules: &mut Rules, switch: Switch) {
    match switch {
        Switch::Stable(b) => rules.stable = b,
        Switch::MultiToken(b) => rules.multi_token = b,
        Switch::Sequential(b) => rules.sequential = b,
        Switch::ParallelActions(b) => rules.parallel_actions = b,
        Switch::FinalScan(b) => rules.final_scan = b,
        Switch::KeepStepTime(b) => rules.keep_step_time = b,
        Switch::ScanClock(b) => rules.scan_clock = b,
        Switch::PulseFirst(b) => rules.pulse_first = b,
        Switch::Bound(n) => rules.bound = n.max(1),
    }
}
