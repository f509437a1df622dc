//! The assumption that the environment does not do what refutes a claim: the inputs of the last scan of
//! the run, those on which it depends, do not come together.
//!
//! It is offered only if the text with it has no errors and the run does not keep it.

use g7_compile::ir::VarClass;
use g7_edit::Splice;
use g7_engine::{State, StepId, scan};
use g7_ide::File;
use g7_model::Type;
use g7_verify::{Claim, Model, Move, Question, Run, blame, replay};

use super::asked::{changed, closed};
use super::cures::both;
use super::place::{Sort, place};

/// Most inputs that are looked at; each takes a repetition of the run.
const MOST: usize = 256;
/// Most inputs in an assumption of several, each of which alone is enough for the run.
const FEW: usize = 4;

/// A refuted claim.
pub(super) struct Refuted<'a> {
    pub(super) file: &'a File,
    pub(super) model: &'a Model<'a>,
    pub(super) question: &'a Question,
    pub(super) run: &'a Run,
    /// The number of the plant among the closed loops, and that of the question there; for a question
    /// about charts alone the number of the question.
    pub(super) place: (Option<usize>, usize),
}

impl Refuted<'_> {
    /// The assumption, as it is written, with its place in the text.
    pub(super) fn assumed(&self) -> Option<(String, Splice)> {
        let condition = match self.question.claim {
            // Edges and situations are the chart's own: such a conflict is cured there.
            Claim::NoConflict => both(self.file, self.model, self.run)?,
            _ => self.condition()?,
        };
        let text = match condition.strip_prefix("not ") {
            Some(plain) if !plain.contains(' ') => format!("assume {plain}"),
            None if !condition.contains(' ') => format!("assume not {condition}"),
            _ => format!("assume not ({condition})"),
        };
        let splice = place(self.file, Sort::Property, &text);
        self.excludes(&splice).then_some((text, splice))
    }

    /// True if the text with this change has no errors, and the run breaks its assumptions.
    fn excludes(&self, splice: &Splice) -> bool {
        let Some((source, asked)) = changed(self.file, std::slice::from_ref(splice)) else { return false };
        let (plant, number) = self.place;
        let shows = |model: &Model<'_>, questions: &[Question]| {
            // An assumption is no question: the numbers stay.
            questions.get(number).map(|q| replay(model, &q.claim, self.run))
        };
        let shown = match plant {
            Some(plant) => closed(&source).get(plant).and_then(|c| shows(&c.model(), &c.questions)),
            None => shows(&Model::new(&asked.compiled, asked.assume.clone()), &asked.questions),
        };
        shown == Some(false)
    }

    /// The inputs of the last scan on which the run depends, as a condition.
    fn condition(&self) -> Option<String> {
        let last = self.run.moves.last()?;
        let free = self.free();
        let relevant: Vec<&(usize, String)> = free.iter().filter(|(i, _)| !self.shows_without(*i)).collect();
        let literal = |(i, name): &(usize, String)| match last.inputs.get(*i) {
            Some(0) | None => format!("not {name}"),
            Some(_) => name.clone(),
        };
        match relevant.as_slice() {
            // Each of several inputs alone is enough: none of them may come.
            [] => {
                let on = free.iter().filter(|(i, _)| last.inputs.get(*i).is_some_and(|w| *w != 0));
                let on: Vec<String> = on.map(literal).collect();
                (!on.is_empty() && on.len() <= FEW).then(|| on.join(" or "))
            }
            // Without this input altogether it would be another machine, so it is only excluded in this situation.
            [one] => match self.step() {
                Some(step) => Some(format!("{step} and {}", literal(one))),
                None => Some(literal(one)),
            },
            more => Some(more.iter().map(|l| literal(l)).collect::<Vec<_>>().join(" and ")),
        }
    }

    /// The inputs of one bit that the environment gives, with their names.
    fn free(&self) -> Vec<(usize, String)> {
        let model = self.model;
        let first = model.compiled.program.tables().inputs.start;
        let plain = model.compiled.symbols.variables.iter().filter(|v| {
            v.class == VarClass::Input && v.ty == Type::Bool && v.elements <= 1 && v.words() == 1
        });
        let placed = plain.map(|v| ((v.addr.0 - first) as usize, v.name.to_string()));
        placed.filter(|(i, _)| !model.is_driven(*i)).take(MOST).collect()
    }

    /// True if the run shows the same with the other value of an input in the last scan, also the same fault.
    fn shows_without(&self, place: usize) -> bool {
        let mut run = self.run.clone();
        let word = run.moves.last_mut().and_then(|m: &mut Move| m.inputs.get_mut(place));
        let Some(word) = word else { return true };
        *word = u64::from(*word == 0);
        replay(self.model, &self.question.claim, &run)
    }

    /// The activity of a step before the last scan, from which a guilty transition leads.
    fn step(&self) -> Option<String> {
        let found = blame(self.model, &self.question.claim, self.run);
        let p = &self.model.compiled.program;
        let mut s = State::new(p);
        for m in self.run.moves.split_last()?.1 {
            let now = s.now().saturating_add(m.wait);
            scan(p, &mut s, &m.inputs, now).ok()?;
        }
        let symbols = &self.model.compiled.symbols;
        let from = found.transitions.iter().filter_map(|rank| p.tables().transitions.get(*rank as usize));
        let step = from.map(|t| t.from).find(|step| s.is_active(*step) && symbols.is_listed(*step))?;
        self.activity(step)
    }

    /// The name of the variable of a step.
    fn activity(&self, step: StepId) -> Option<String> {
        let symbols = &self.model.compiled.symbols;
        let (chart, name) = symbols.step_path(step).rsplit_once('.')?;
        let name = if name.starts_with(|c: char| c.is_ascii_digit()) {
            format!("X{name}")
        } else {
            format!("{name}.X")
        };
        let many = self.model.compiled.unit.charts.len() > 1;
        Some(if many { format!("{chart}.{name}") } else { name })
    }
}
