//! The question of a run that a name asks: about a variable, a step, a macro-step or a transition.

use g7_model::{Said, say};
use g7_why::Question;

use crate::bench::near;
use crate::{Activity, Bench, Role};

/// The question about what has this name: an output or any other variable, the variable of a step (`X12`, `G.X12`), a
/// step (`G.12`), a transition by its label or as `1 -> 2`, with its chart where several have that name (`G.1 -> 2`).
///
/// # Errors
///
/// Nothing has this name, or several transitions have it.
pub fn question(bench: &Bench, name: &str) -> Result<Question, Said> {
    let name = name.trim();
    if let Some(step) = bench.steps.iter().find(|s| s.activity() == name || s.name == name) {
        return Ok(match step.id {
            Activity::Step(id) => Question::Step(id),
            Activity::Macro(group) => Question::Group(group),
        });
    }
    if let Some(item) = bench.item(name) {
        return match item.role {
            Role::Plant => Err(say!(
                "`{name}` is a state of the plant; a run keeps what comes to the charts: ask about an input"
            )),
            Role::Input(_) | Role::Output | Role::Variable => {
                Ok(Question::Variable(g7_engine::Addr(item.addr), item.words))
            }
        };
    }
    if let Some(id) = bench.compiled.symbols.step(name) {
        return Ok(Question::Step(id));
    }
    transition(bench, name)
}

fn transition(bench: &Bench, name: &str) -> Result<Question, Said> {
    let symbols = &bench.compiled.symbols;
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let asked = plain(name);
    let own = |rank: u32| plain(symbols.label(rank).unwrap_or_else(|| symbols.transition_text(rank)));
    let is_it = |rank: &u32| {
        let own = own(*rank);
        own == asked
            || plain(symbols.transition_text(*rank)) == asked
            || asked.strip_prefix(symbols.transition_chart(*rank)).and_then(|rest| rest.strip_prefix('.'))
                == Some(&own)
    };
    let mut found = (0..symbols.transitions()).filter(|rank| symbols.is_written(*rank)).filter(is_it);
    match (found.next(), found.next()) {
        (Some(rank), None) => Ok(Question::Transition(rank)),
        (Some(first), Some(second)) => {
            let of = |rank: u32| format!("{}.{}", symbols.transition_chart(rank), own(rank));
            Err(say!(
                "several transitions are called `{name}`: ask for one, as in `{}` or `{}`",
                of(first),
                of(second)
            ))
        }
        (None, _) => Err(unknown(bench, name)),
    }
}

fn unknown(bench: &Bench, name: &str) -> Said {
    let steps: Vec<String> = bench.steps.iter().map(crate::StepItem::activity).collect();
    let symbols = &bench.compiled.symbols;
    let items = bench.items.iter().filter(|i| i.role != Role::Plant).map(|i| i.name.as_str());
    let labels = (0..symbols.transitions()).filter_map(|rank| symbols.label(rank));
    let all = items.chain(steps.iter().map(String::as_str)).chain(labels);
    let help = near(name, all);
    let what = say!("there is no `{name}`");
    if help.is_empty() { what } else { say!("{what}; {help}") }
}
