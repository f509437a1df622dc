//! The question whether a chart meets a fault, asked about each place by itself.
//!
//! ```text
//! sites (the places) -> slices (what each depends on) -> layers: no run meets a fault there
//!                    -> rounds: a way round that counts, as often as the type allows
//! ```
//!
//! The first fault of a run is at some place, and before it no other place plays a part. So if no
//! place has a fault in the slice of the chart that it depends on, the chart has none.
//!
//! A counter that nothing bounds overflows behind ten thousands of scans at the least, too many for any search.
//! But its slice needs no value of it: a run that comes back to a state in which it was, and has counted on the
//! way, can be repeated. The engine then makes the whole run. It need not be the shortest one.

use std::collections::HashMap;

use g7_engine::{Addr, Program, State, scan};

use crate::expand::{Expander, Here, Step};
use crate::explore::Move;
use crate::layer::{Budget, Layer};
use crate::look::replay;
use crate::model::Model;
use crate::question::{Claim, Question};
use crate::reason::Reason;
use crate::slices::Whole;
use crate::store::Store;
use crate::verdict::{Certificate, Evidence, Open, Run, Verdict, is_open};

/// Most scans of a run that is given.
const LONGEST: usize = 200_000;
/// Most scans of a search for the end of a counter that the situation does not depend on.
const COUNTED: usize = 40_000;
/// Most scans to find the way to the next count.
const WAY: usize = 20_000;
/// Most counts until the way round is closed.
const COUNTS: usize = 1_000;

/// Layers that are asked for the faults of a chart, place by place.
pub(crate) struct Faults<'l>(pub(crate) &'l [&'l dyn Layer]);

impl Layer for Faults<'_> {
    fn name(&self) -> &'static str {
        "faults"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        let asks = questions.iter().position(|q| q.claim == Claim::NoFault);
        let Some(i) = asks.filter(|i| answers.get(*i).is_some_and(is_open)) else { return };
        let Some(question) = questions.get(i) else { return };
        if (budget.stop)() {
            return;
        }
        let (Some(verdict), Some(answer)) = (self.decide(model, question, budget), answers.get_mut(i)) else {
            return;
        };
        *answer = Some(match (answer.take(), verdict) {
            (Some(Verdict::Open(old)), Verdict::Open(new)) => {
                let (scans, states) = (old.scans.max(new.scans), old.states.max(new.states));
                Verdict::Open(Open { scans, states, ..new })
            }
            (_, verdict) => verdict,
        });
    }
}

impl Faults<'_> {
    fn decide(&self, model: &Model<'_>, question: &Question, budget: &Budget<'_>) -> Option<Verdict> {
        let whole = Whole::new(model)?;
        let mut proved = [0usize; 2];
        let (mut counters, mut others) = (Vec::new(), false);
        for (slice, site) in whole.of_faults()? {
            let sliced = model.sliced(slice);
            let mut found = [None];
            // A counter that ends does so soon, or with the type.
            let is_free = site.counter.is_some_and(|c| whole.beside(c).is_some());
            let scans = if is_free { budget.scans.min(COUNTED) } else { budget.scans };
            let budget = Budget { scans, ..*budget };
            self.0.iter().for_each(|layer| {
                layer.answer(&sliced, std::slice::from_ref(question), &mut found, &budget);
            });
            match found {
                [Some(Verdict::Refuted(evidence))] => return Some(Verdict::Refuted(evidence)),
                [Some(Verdict::Proved(Evidence::Certificate(c)))] => {
                    let [states, scans] = size(&c);
                    proved = [proved[0] + states, proved[1] + scans];
                }
                _ => match site.counter {
                    Some(counter) => counters.push(counter),
                    None => others = true,
                },
            }
        }
        if counters.is_empty() && !others {
            let [states, scans] = proved;
            return Some(Verdict::Proved(Evidence::Certificate(Certificate::Search { states, scans })));
        }
        let mut shortest: Option<Run> = None;
        for counter in &counters {
            let Some((slice, place)) = whole.beside(*counter) else {
                others = true;
                continue;
            };
            let most = shortest.as_ref().map_or(LONGEST, |r| r.moves.len());
            let sliced = model.sliced(slice);
            let rounds = Rounds { model: &sliced, counter: *counter, place, most, budget };
            let run = rounds.run().filter(|run| replay(model, &Claim::NoFault, run));
            shortest = run.or(shortest);
        }
        if let Some(run) = shortest {
            return Some(Verdict::Refuted(Evidence::Run(run)));
        }
        // A counter on which the situation depends may have a bound that more work finds.
        let first = counters.first().filter(|_| !others)?;
        let name = model.compiled.symbols.variable_at(*first).map_or("", |v| &v.name).to_owned();
        Some(Verdict::Open(Open { scans: 0, states: proved[0], reason: Reason::Counter(name) }))
    }
}

/// The states and scans of a proof by search.
fn size(certificate: &Certificate) -> [usize; 2] {
    match certificate {
        Certificate::Search { states, scans } | Certificate::Zones { zones: states, scans } => {
            [*states, *scans]
        }
        Certificate::Invariant { .. } | Certificate::Induction { .. } | Certificate::Diagram { .. } => [0, 0],
    }
}

/// A way that counts.
struct Way {
    moves: Vec<Move>,
    /// The image behind it, with the inputs of its last scan.
    to: (Vec<u64>, Vec<u64>),
}

/// The search for a way round that counts, in the slice of a chart that leaves the counter out.
struct Rounds<'m, 'c> {
    model: &'m Model<'c>,
    counter: Addr,
    /// The place of the counter in an image.
    place: usize,
    /// Fewer scans than these are looked for.
    most: usize,
    budget: &'m Budget<'m>,
}

impl Rounds<'_, '_> {
    /// A run that goes round until a fault ends it.
    fn run(&self) -> Option<Run> {
        let mut here = Expander::new(self.model, &[]).start();
        let mut met: HashMap<Vec<u64>, usize> = HashMap::new();
        let mut moves: Vec<Move> = Vec::new();
        for _ in 0..COUNTS {
            if let Some(from) = met.get(&here.0) {
                return self.repeated(&moves, *from);
            }
            met.insert(here.0.clone(), moves.len());
            let way = self.way(&here, moves.is_empty())?;
            moves.extend(way.moves);
            here = way.to;
        }
        None
    }

    /// A shortest way from a state to a scan that counts.
    fn way(&self, (image, inputs): &(Vec<u64>, Vec<u64>), first: bool) -> Option<Way> {
        let mut expander = Expander::new(self.model, &[]);
        let mut store = Store::new();
        store.insert(image);
        let mut before: Vec<(usize, Move)> = vec![(0, Move { inputs: inputs.clone(), wait: 0 })];
        let (mut at, mut scans) = (0usize, 0usize);
        let mut end: Option<(Move, Vec<u64>)> = None;
        while at < store.len() && end.is_none() && scans < WAY && !(self.budget.stop)() {
            let image = store.image(at);
            let inputs = before.get(at).map(|b| b.1.inputs.clone())?;
            let here = Here { image: &image, inputs: &inputs, first: first && at == 0 };
            let value = image.get(self.place).copied().unwrap_or(0) as i64;
            expander.expand(here, |step: Step<'_>| {
                scans += 1;
                let Some(next) = step.next else { return true };
                if step.state.word(self.counter) as i64 > value {
                    end = Some((step.m.clone(), next.to_vec()));
                    return false;
                }
                if store.find_or_insert(next).is_none() {
                    before.push((at, step.m.clone()));
                }
                scans < WAY
            });
            if end.is_none() {
                at += 1;
            }
        }
        let (last, next) = end?;
        let mut moves = vec![last.clone()];
        while at > 0 {
            let (from, m) = before.get(at)?;
            moves.push(m.clone());
            at = *from;
        }
        moves.reverse();
        Some(Way { moves, to: (next, last.inputs) })
    }

    /// The engine makes these scans, those from this one on again and again, until a fault ends them.
    fn repeated(&self, moves: &[Move], from: usize) -> Option<Run> {
        let p: &Program = &self.model.compiled.program;
        let round = moves.get(from..).filter(|r| !r.is_empty())?;
        let mut s = State::new(p);
        let mut run = Run::default();
        for m in moves.iter().chain(round.iter().cycle()).take(self.most.saturating_sub(1)) {
            let now = s.now().saturating_add(m.wait);
            run.fault = scan(p, &mut s, &m.inputs, now).err();
            run.moves.push(m.clone());
            if run.fault.is_some() {
                return Some(run);
            }
        }
        None
    }
}
