//! Refuted claims as tests that fail, for the page and for `g7 prove --save`.
//!
//! A test states what the claim expects of the shortest run that breaks it. Whoever takes a test runs
//! it first: it is to fail where the claim does.

use g7_engine::{State, scan};
use g7_model::{BinaryOp, Expr, ExprKind, Name, Nanos, Path, Place, PropertyKind, Scenario};
use g7_rig::testing::script::{Script, activity, expr, join, not, value};
use g7_rig::{Bench, Source};
use g7_verify::{Claim, Model, Move, Query, Question, Run};

/// A sentence in English, French and Portuguese.
pub type Said = [&'static str; 3];

/// Why there is no test of a claim that some run does something.
pub const NO_RUN: Said = [
    "it says that some run does something, and none does",
    "elle dit qu’une exécution fait quelque chose, et aucune ne le fait",
    "diz que alguma execução faz algo, e nenhuma o faz",
];
/// Why there is no test where a made one does not fail in its last statement.
pub const UNSEEN: Said = [
    "a test sees the ends of scans, and they do not show it",
    "un essai voit les fins de cycle, et elles ne le montrent pas",
    "um teste vê os fins de ciclo, e eles não o mostram",
];
const SETTLED: Said = [
    "a test sees the ends of scans: one of the transitions was cleared, and the other one waits unseen",
    "un essai voit les fins de cycle : une des transitions a été franchie, et l’autre attend sans être vue",
    "um teste vê os fins de ciclo: uma das transições foi transposta, e a outra espera sem ser vista",
];
const TWICE: Said = [
    "a test does not see that an active step was activated once more",
    "un essai ne voit pas qu’une étape active a été activée encore une fois",
    "um teste não vê que uma etapa ativa foi ativada outra vez",
];
const WRITES: Said = [
    "a test sees the last of the values; `g7 test` notes such a pass in every scenario",
    "un essai voit la dernière des valeurs ; `g7 test` note un tel passage dans tout scénario",
    "um teste vê o último dos valores; `g7 test` anota tal passagem em cada cenário",
];
const CHANCE: Said = [
    "its plant draws random numbers, and no seed draws these",
    "sa partie opérative tire des nombres au hasard, et aucune graine ne tire ceux-ci",
    "a sua instalação tira números ao acaso, e nenhuma semente tira estes",
];
const FAULT: Said = [
    "a fault stops the scan that shows it",
    "un défaut arrête le cycle qui le montre",
    "uma falha para o ciclo que o mostra",
];

/// The title of the test of a claim; the same for the same claim, so that it is replaced.
pub fn title(claim: &str) -> String {
    let short = short(claim).replace('"', "'");
    if claim.starts_with("prove ") { short } else { format!("prove {short}") }
}

/// A claim without what explains it.
pub fn short(claim: &str) -> String {
    match claim.split_once(": ") {
        Some((short, _)) if !claim.starts_with("prove ") => short.to_owned(),
        _ => claim.to_owned(),
    }
}

/// A run that begins as tests do, with the initial values of the inputs: one scan more, if it
/// shows the same; else the run as it is.
fn as_tests_begin(model: &Model<'_>, question: &Question, run: &Run) -> Run {
    if model.plant.is_some() {
        // A scan more would be a tick of the plant more.
        return run.clone();
    }
    let initial: Vec<u64> = model.inputs.iter().map(|v| v.tried.first().copied().unwrap_or(0)).collect();
    let Some(first) = run.moves.first().filter(|m| m.inputs != initial) else { return run.clone() };
    let mut longer = run.clone();
    longer.moves.insert(0, Move { inputs: initial, wait: first.wait });
    if let Some(second) = longer.moves.get_mut(1) {
        second.wait = model.period;
    }
    let same = g7_verify::replay(model, &question.claim, &longer)
        && match question.claim {
            // Equal states cannot do the same any more.
            Claim::NoDeadlock | Claim::LeadsTo { .. } => image(model, run) == image(model, &longer),
            _ => true,
        };
    if same { longer } else { run.clone() }
}

/// The canonical image behind a run, which decides about its future.
fn image(model: &Model<'_>, run: &Run) -> Vec<u64> {
    let mut image = Vec::new();
    end(model, run).0.canonical(&model.compiled.program, &mut image);
    image
}

/// A refuted claim with its run.
pub struct Given<'a> {
    /// The file.
    pub source: &'a Source,
    /// Its charts, with the plant of a closed loop.
    pub bench: &'a Bench,
    /// The charts with their questions.
    pub model: &'a Model<'a>,
    /// The question.
    pub question: &'a Question,
    /// The run that refutes it.
    pub run: &'a Run,
}

/// The test of a refuted claim.
///
/// # Errors
///
/// A sentence that says why a test cannot show it.
pub fn of_run(given: &Given<'_>, title: &str) -> Result<Scenario, Said> {
    if !given.run.ways.is_empty() {
        return Err(CHANCE);
    }
    let run = &as_tests_begin(given.model, given.question, given.run);
    written(&Given { run, ..*given }, title)
}

fn written(given: &Given<'_>, title: &str) -> Result<Scenario, Said> {
    let mut script = Script::new(given.bench);
    let claim = &given.question.claim;
    let faults = matches!(claim, Claim::NoFault | Claim::NoInstability | Claim::NoOpposedOrders);
    if given.run.fault.is_some() && !faults {
        return Err(FAULT);
    }
    match claim {
        Claim::NoFault | Claim::NoInstability | Claim::NoOpposedOrders => {
            if let Some((last, before)) = given.run.moves.split_last() {
                scans(&mut script, before);
                script.comment("no fault may come up in the next scan");
                script.scan(&last.inputs);
            }
        }
        Claim::NoDeadlock => deadlock(given, &mut script)?,
        Claim::NoConflict => conflict(given, &mut script)?,
        Claim::NoUnsafe => return Err(TWICE),
        Claim::NoOpposedWrites => return Err(WRITES),
        _ => author(given, &mut script)?,
    }
    Ok(script.end(title))
}

fn scans(script: &mut Script<'_>, moves: &[Move]) {
    moves.iter().for_each(|m| script.scan(&m.inputs));
}

/// A claim of the author.
fn author(given: &Given<'_>, script: &mut Script<'_>) -> Result<(), Said> {
    let (claim, moves) = (&given.question.claim, &given.run.moves);
    let property = given.source.document.properties().find(|p| p.at.0 == given.question.at);
    let property = property.ok_or(UNSEEN)?;
    let seen = |q: &Query| g7_verify::seen(given.model, given.run, *q);
    match (&property.kind, claim) {
        (PropertyKind::Always(e), _) => {
            scans(script, moves);
            script.expect(vec![e.clone()]);
        }
        (PropertyKind::Never(e), _) => {
            scans(script, moves);
            script.expect(vec![not(e.clone())]);
        }
        (PropertyKind::AtMost(most, list), _) => {
            scans(script, moves);
            script.expect(vec![at_most(*most, list)]);
        }
        (PropertyKind::After(_, within, e), Claim::Within { cause, effect, .. }) => {
            let first = begins(&seen(cause), &seen(effect)).ok_or(UNSEEN)?;
            after(given, script, first, *within, e);
        }
        (PropertyKind::Until(a, b, e), Claim::Until { from, to, .. }) => {
            scans(script, moves);
            let begins_here = begins(&seen(from), &seen(to)) == moves.len().checked_sub(1);
            script.expect(vec![meanwhile(e.clone(), a, b, begins_here)]);
        }
        (PropertyKind::Between(a, b, e), Claim::Between { from, to, never }) => {
            let start = begins(&seen(from), &seen(to)).ok_or(UNSEEN)?;
            let at = seen(never).iter().skip(start).position(|on| *on).ok_or(UNSEEN)? + start;
            scans(script, moves.get(..=at).unwrap_or(moves));
            script.expect(vec![meanwhile(not(e.clone()), a, b, start == at)]);
        }
        (PropertyKind::LeadsTo(_, e), _) => {
            scans(script, moves);
            script.comment("from here on nothing brings it: write here what must");
            script.wait_until(e.clone(), None);
        }
        _ => return Err(NO_RUN),
    }
    Ok(())
}

/// The scan that the last one of a run looks back to: the first one with the beginning behind the
/// latest end before the last scan.
fn begins(starts: &[bool], ends: &[bool]) -> Option<usize> {
    let before = ends.split_last().map_or(&[][..], |(_, before)| before);
    let from = before.iter().rposition(|on| *on).map_or(0, |at| at + 1);
    Some(starts.iter().skip(from).position(|on| *on)? + from)
}

/// The condition at a scan between one with `a` and one with `b`: nothing is claimed at one with `b`, nor
/// where the time begins with this scan and `a` does not hold.
fn meanwhile(holds: Expr, a: &Expr, b: &Expr, begins_here: bool) -> Expr {
    let or = |x: Expr, y: Expr| expr(ExprKind::Binary(BinaryOp::Or, Box::new(x), Box::new(y)));
    let claimed = or(holds, b.clone());
    if begins_here { or(claimed, not(a.clone())) } else { claimed }
}

/// At most so many of the conditions hold.
fn at_most(most: u32, list: &[Expr]) -> Expr {
    let one = |e: &Expr| {
        let name = Name { text: "BOOL_TO_INT".into(), at: Place::default() };
        let arg = g7_model::Arg::input(None, e.clone());
        expr(ExprKind::Call(Path { names: vec![name] }, vec![arg]))
    };
    let count = join(BinaryOp::Add, list.iter().map(one)).unwrap_or_else(|| value(g7_model::Type::Int, &[0]));
    let most = value(g7_model::Type::Int, &[u64::from(most)]);
    expr(ExprKind::Binary(BinaryOp::Le, Box::new(count), Box::new(most)))
}

/// `after a within t expect e`, where `a` came at the scan `first` and `e` did not come in time.
fn after(given: &Given<'_>, script: &mut Script<'_>, first: usize, within: Nanos, e: &Expr) {
    let (model, run) = (given.model, given.run);
    let whole = Nanos::new(within.count() / model.period * model.period);
    // Inputs that stay as they were with the cause, if that breaks the claim too: then one can wait.
    let mut held = run.clone();
    let cause = held.moves.get(first).map(|m| m.inputs.clone()).unwrap_or_default();
    held.moves.iter_mut().skip(first + 1).for_each(|m| m.inputs.clone_from(&cause));
    if g7_verify::replay(model, &given.question.claim, &held) {
        scans(script, held.moves.get(..=first).unwrap_or(&held.moves));
        if whole == Nanos::ZERO {
            script.expect(vec![e.clone()]);
        } else {
            script.wait_until(e.clone(), Some(whole));
        }
    } else {
        // The last scan of the run is the first one behind the time.
        let last = run.moves.len().saturating_sub(1);
        scans(script, run.moves.get(..last).unwrap_or(&run.moves));
        script.comment("the time is over with this scan; it may have come before");
        script.expect(vec![e.clone()]);
    }
}

/// From the last situation nothing leads on: the test waits that it changes.
fn deadlock(given: &Given<'_>, script: &mut Script<'_>) -> Result<(), Said> {
    scans(script, &given.run.moves);
    let (state, _) = end(given.model, given.run);
    let symbols = &given.bench.compiled.symbols;
    let active = state.active().filter(|s| symbols.is_listed(*s)).filter_map(|s| activity(given.bench, s));
    let situation = join(BinaryOp::And, active).ok_or(UNSEEN)?;
    script.comment("from here on no input leads on: write here what must");
    script.wait_until(not(situation), None);
    Ok(())
}

/// Both transitions were cleared: then steps behind both are active.
fn conflict(given: &Given<'_>, script: &mut Script<'_>) -> Result<(), Said> {
    scans(script, &given.run.moves);
    let (state, cleared) = end(given.model, given.run);
    let t = given.bench.compiled.program.tables();
    let ends = |rank: u32, before: bool| -> Vec<u32> {
        let Some(tr) = t.transitions.get(rank as usize) else { return Vec::new() };
        let (first, more) = if before { (tr.from, tr.more_from) } else { (tr.to, tr.more_to) };
        let more = t.arcs.get(more.start as usize..more.end as usize).unwrap_or(&[]);
        std::iter::once(first.0).chain(more.iter().map(|s| s.0)).collect()
    };
    let active = |rank: u32| ends(rank, false).into_iter().find(|s| state.is_active(g7_engine::StepId(*s)));
    let pairs = cleared.iter().flat_map(|a| cleared.iter().map(move |b| (*a, *b))).filter(|(a, b)| a < b);
    let both = pairs
        .filter(|(a, b)| ends(*a, true).iter().any(|s| ends(*b, true).contains(s)))
        .find_map(|(a, b)| Some((active(a)?, active(b)?)).filter(|(a, b)| a != b));
    let (a, b) = both.ok_or(SETTLED)?;
    let steps = [a, b].map(|s| activity(given.bench, g7_engine::StepId(s)));
    let both = join(BinaryOp::And, steps.into_iter().flatten()).ok_or(SETTLED)?;
    script.expect(vec![not(both)]);
    Ok(())
}

/// The state behind the run, and the transitions that its last scan cleared.
fn end(model: &Model<'_>, run: &Run) -> (State, Vec<u32>) {
    let p = &model.compiled.program;
    let mut s = State::new(p);
    for m in &run.moves {
        let now = s.now().saturating_add(m.wait);
        if scan(p, &mut s, &m.inputs, now).is_err() {
            break;
        }
    }
    let cleared = s.cleared().to_vec();
    (s, cleared)
}

#[cfg(test)]
mod tests {
    use super::{begins, title};

    #[test]
    fn the_beginning_is_the_first_one_behind_the_latest_end() {
        let scans = |text: &str| text.chars().map(|c| c == '1').collect::<Vec<_>>();
        assert_eq!(begins(&scans("01010"), &scans("00000")), Some(1));
        assert_eq!(begins(&scans("01010"), &scans("00100")), Some(3));
        // A scan with both ends it; the end in the last scan comes too late to count.
        assert_eq!(begins(&scans("01010"), &scans("01001")), Some(3));
        assert_eq!(begins(&scans("01000"), &scans("00100")), None);
    }

    #[test]
    fn titles_are_short_and_of_one_kind() {
        assert_eq!(title("no conflict: no two transitions of one step are clearable"), "prove no conflict");
        assert_eq!(title("prove never X1 and X2 \"apart\""), "prove never X1 and X2 'apart'");
    }
}
