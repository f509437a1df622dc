//! Random statements of Structured Text, and random actions of steps.

use g7_model::{ProfileName, Type};

use super::rng::Rng;
use super::sight::{Sight, duration, is_chosen};

/// The variables and blocks that statements may change.
#[derive(Clone, Debug, Default)]
pub(super) struct Targets {
    pub(super) bools: Vec<String>,
    pub(super) ints: Vec<(String, Type)>,
    pub(super) reals: Vec<(String, Type)>,
    pub(super) times: Vec<String>,
    pub(super) strings: Vec<String>,
    /// Block instances that nothing calls yet.
    pub(super) blocks: Vec<(String, &'static str)>,
}

/// A Boolean variable driven by qualified actions.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    pub(super) name: String,
    /// The qualifiers that it may have, with their times.
    pub(super) qualifiers: Vec<String>,
}

/// A random assignment.
pub(super) fn assignment(rng: &mut Rng, sight: &Sight, to: &Targets) -> String {
    match rng.weighted(&[25, 50, 9, 8, 6]) {
        1 if !to.ints.is_empty() => {
            let (name, ty) = rng.pick(&to.ints).cloned().unwrap_or((String::new(), Type::Int));
            if rng.percent(35) {
                let wrap = rng.between(3, 9);
                return format!("{name} := ({name} + 1) mod {wrap}");
            }
            if rng.percent(4) {
                return format!("{name} := {name} + 1");
            }
            if sight.bits && rng.percent(8) && !is_chosen(&name) {
                return format!("{name}.{} := {}", rng.below(3), sight.boolean(rng, 1));
            }
            format!("{name} := {}", sight.int(rng, ty, 1))
        }
        2 if !to.reals.is_empty() => {
            let (name, ty) = rng.pick(&to.reals).cloned().unwrap_or((String::new(), Type::Real));
            format!("{name} := {}", sight.real(rng, ty, 1))
        }
        3 if !to.times.is_empty() => {
            let name = rng.pick(&to.times).cloned().unwrap_or_default();
            format!("{name} := {}", sight.time(rng))
        }
        4 if !to.strings.is_empty() => {
            let name = rng.pick(&to.strings).cloned().unwrap_or_default();
            format!("{name} := {}", sight.string(rng))
        }
        _ => match rng.pick(&to.bools).cloned() {
            Some(name) => format!("{name} := {}", sight.boolean(rng, 1)),
            None => format!("{} := 1", to.ints.first().map_or("k0", |i| &i.0)),
        },
    }
}

/// A random statement, with at most `depth` further levels of nesting.
pub(super) fn statement(rng: &mut Rng, sight: &Sight, to: &mut Targets, depth: usize) -> String {
    if depth == 0 {
        return assignment(rng, sight, to);
    }
    match rng.weighted(&[55, 16, 7, 7, 4, 4, 10]) {
        1 => {
            let first = statement(rng, sight, to, depth - 1);
            let mut text = format!("IF {} THEN {first};", sight.boolean(rng, 1));
            if rng.percent(30) {
                let more = statement(rng, sight, to, depth - 1);
                text += &format!(" ELSIF {} THEN {more};", sight.boolean(rng, 1));
            }
            if rng.percent(50) {
                text += &format!(" ELSE {};", statement(rng, sight, to, depth - 1));
            }
            text + " END_IF"
        }
        2 => {
            let arms = [assignment(rng, sight, to), assignment(rng, sight, to)];
            let other = assignment(rng, sight, to);
            let on = sight.int(rng, Type::Int, 1);
            format!("CASE {on} OF 0, 2: {}; 3..5: {}; ELSE {other}; END_CASE", arms[0], arms[1])
        }
        3 => loop_for(rng, sight, to),
        4 => match counter(rng, to) {
            Some((name, _)) => {
                let limit = rng.between(2, 6);
                format!("WHILE {name} < {limit} DO {name} := {name} + 1; END_WHILE")
            }
            None => assignment(rng, sight, to),
        },
        5 => match counter(rng, to) {
            Some((name, _)) => {
                let leave = if rng.percent(40) {
                    format!("IF {} THEN EXIT; END_IF; ", sight.atom(rng))
                } else {
                    String::new()
                };
                format!("REPEAT {leave}{name} := {name} / 2; UNTIL {name} = 0 END_REPEAT")
            }
            None => assignment(rng, sight, to),
        },
        6 if !to.blocks.is_empty() => call(rng, sight, to),
        _ => assignment(rng, sight, to),
    }
}

fn counter(rng: &mut Rng, to: &Targets) -> Option<(String, Type)> {
    let names: Vec<&(String, Type)> = to.ints.iter().filter(|(n, _)| !n.contains('[')).collect();
    rng.pick(&names).copied().cloned()
}

fn loop_for(rng: &mut Rng, sight: &Sight, to: &Targets) -> String {
    let Some((name, ty)) = counter(rng, to) else { return assignment(rng, sight, to) };
    let others =
        Targets { ints: to.ints.iter().filter(|(n, _)| *n != name).cloned().collect(), ..to.clone() };
    let body = assignment(rng, sight, &others);
    let most = rng.between(1, 5);
    match rng.below(3) {
        0 if matches!(ty, Type::Sint | Type::Int | Type::Dint | Type::Lint) => {
            format!("FOR {name} := {most} TO 0 BY -2 DO {body}; END_FOR")
        }
        1 => format!("FOR {name} := 0 TO {most} BY 2 DO {body}; END_FOR"),
        _ => format!("FOR {name} := 1 TO {most} DO {body}; END_FOR"),
    }
}

/// A call of a block instance; each instance is called at one place only.
fn call(rng: &mut Rng, sight: &Sight, to: &mut Targets) -> String {
    let at = rng.below(to.blocks.len());
    let (name, kind) = to.blocks.remove(at);
    let b = |rng: &mut Rng| sight.boolean(rng, 1);
    let n = rng.below(5);
    match kind {
        "TON" | "TOF" | "TP" => format!("{name}(IN := {}, PT := {})", b(rng), duration(rng)),
        "CTU" => format!("{name}(CU := {}, R := {}, PV := {n})", b(rng), b(rng)),
        "CTD" => format!("{name}(CD := {}, LD := {}, PV := {n})", b(rng), b(rng)),
        "CTUD" => {
            format!(
                "{name}(CU := {}, CD := {}, R := {}, LD := {}, PV := {n})",
                b(rng),
                b(rng),
                b(rng),
                b(rng)
            )
        }
        "SR" => format!("{name}(S1 := {}, R := {})", b(rng), b(rng)),
        "RS" => format!("{name}(S := {}, R1 := {})", b(rng), b(rng)),
        _ => match rng.pick(&to.bools).cloned() {
            Some(out) => format!("{name}(CLK := {}, Q => {out})", b(rng)),
            None => format!("{name}({})", b(rng)),
        },
    }
}

/// A body of a few statements, in braces.
pub(super) fn block(rng: &mut Rng, sight: &Sight, to: &mut Targets) -> String {
    let mut text = String::from("{ ");
    for _ in 0..rng.between(1, 3) {
        text += &statement(rng, sight, to, 2);
        text += "; ";
    }
    text + "}"
}

/// A random action of a step.
pub(super) fn action(
    rng: &mut Rng,
    profile: ProfileName,
    sight: &Sight,
    to: &mut Targets,
    driven: &mut Vec<Driven>,
    named: &mut Vec<(String, String)>,
) -> Option<String> {
    let condition = |rng: &mut Rng, sight: &Sight| {
        if rng.percent(25) { format!(" if {}", sight.plain().boolean(rng, 1)) } else { String::new() }
    };
    Some(match rng.weighted(&[40, 14, 7, 12, 10, 6, 5]) {
        0 => {
            // A variable occurs once in a step, because it can take one value at a time.
            let at = rng.below(driven.len());
            if driven.is_empty() {
                return None;
            }
            let variable = driven.remove(at);
            let q = rng.pick(&variable.qualifiers)?.clone();
            format!("{q} {}{}", variable.name, condition(rng, sight))
        }
        1 => {
            let q = rng.one(["P1", "P1", "P0"]);
            format!("{q} {}{}", assignment(rng, sight, to), condition(rng, sight))
        }
        2 => {
            let q = rng.one(["P1", "P0", "N"]);
            format!("{q} {}{}", block(rng, sight, to), condition(rng, sight))
        }
        3 => {
            let event = match rng.below(3) {
                0 => format!("({} and {})", sight.edge(rng, 0), sight.plain().atom(rng)),
                _ => sight.edge(rng, 0),
            };
            let work = if rng.percent(75) { assignment(rng, sight, to) } else { block(rng, sight, to) };
            format!("on {event}: {work}")
        }
        4 => format!("each scan: {}{}", assignment(rng, sight, to), condition(rng, sight)),
        5 => {
            let at = rng.below(named.len());
            if named.is_empty() {
                return None;
            }
            let (name, qualifiers) = named.remove(at);
            let all: Vec<&str> = qualifiers.split(',').collect();
            let q = *rng.pick(&all)?;
            format!("{q} {name}{}", condition(rng, sight))
        }
        _ => {
            let t = duration(rng);
            let q = match rng.below(9) {
                0 => "S".to_owned(),
                1 => "P".to_owned(),
                2 => format!("L {t}"),
                3 => format!("D {t}"),
                4 => format!("SD {t}"),
                5 => format!("DS {t}"),
                6 => format!("SL {t}"),
                _ => "N".to_owned(),
            };
            if profile == ProfileName::Iec60848 && rng.percent(50) {
                return Some(format!("N {}", assignment(rng, sight, to)));
            }
            format!("{q} {}", assignment(rng, sight, to))
        }
    })
}
