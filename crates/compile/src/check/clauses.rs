//! A question as clauses.
//!
//! A truth is a variable. A place among cuts, and a relation, is a row of variables, each of which says
//! that the place is not below a certain one: variable j implies variable j - 1, and a place that no value
//! has is left out. Each formula has a literal that is equal to it.

use std::cmp::Ordering;

use g7_sat::{Answer, Batsat, Literal, Solver};

use super::formula::{Atom, Formula, Part, Sort, Values, holds, is_taken};

/// Most work for one question, in ticks of the solver.
const TICKS: u64 = 200_000;

/// Tells whether all goals of a question can be true together; `None` if that takes too much work.
#[inline(never)]
pub(super) fn possible(atoms: &[Atom<'_>], parts: &[Formula<'_>], goals: &[Part]) -> Option<bool> {
    let mut coding = Coding::new(atoms);
    let parts: Vec<Literal> = parts.iter().fold(Vec::new(), |mut known, formula| {
        let literal = coding.formula(formula, &known);
        known.push(literal);
        known
    });
    for goal in goals {
        let literal = coding.of(&parts, *goal);
        coding.solver.add(&[literal]);
    }
    match coding.solver.solve(&[]) {
        Answer::Yes => Some(true),
        Answer::No => Some(false),
        Answer::Stopped => None,
    }
}

struct Coding<'q, 'e> {
    question: &'q [Atom<'e>],
    solver: Batsat<'static>,
    /// It is true.
    yes: Literal,
    /// For each atom its variables: of a truth one, else variable j - 1 says that its place is j or more.
    atoms: Vec<Vec<Literal>>,
}

impl<'q, 'e> Coding<'q, 'e> {
    #[inline(never)]
    fn new(question: &'q [Atom<'e>]) -> Coding<'q, 'e> {
        let mut solver = Batsat::new(&|| false);
        solver.stop_at(TICKS);
        let yes = solver.variable(true);
        solver.add(&[yes]);
        let mut coding = Coding { question, solver, yes, atoms: Vec::new() };
        for atom in question {
            let count = match &atom.sort {
                Sort::Truth => 1,
                Sort::Relation(_) => 2,
                Sort::Place(_, cuts) => 2 * cuts.len(),
            };
            let row: Vec<Literal> = (0..count).map(|_| coding.solver.variable(true)).collect();
            for (lower, higher) in row.iter().zip(row.iter().skip(1)) {
                coding.solver.add(&[!*higher, *lower]);
            }
            coding.atoms.push(row);
        }
        for (i, atom) in question.iter().enumerate() {
            let Sort::Place(ty, cuts) = &atom.sort else { continue };
            for place in (0..=2 * cuts.len()).filter(|p| !is_taken(*ty, cuts, *p)) {
                let (from, beyond) = (coding.at_least(i, place), coding.at_least(i, place + 1));
                coding.solver.add(&[!from, beyond]);
            }
        }
        coding
    }

    /// The place of an atom is this one or a higher one.
    fn at_least(&self, atom: usize, place: usize) -> Literal {
        let row = self.atoms.get(atom).map_or(&[][..], Vec::as_slice);
        match place.checked_sub(1) {
            None => self.yes,
            Some(k) => row.get(k).copied().unwrap_or(!self.yes),
        }
    }

    /// The literal of a formula whose operands have theirs. The rows of a question stand behind those
    /// they are made of.
    fn of(&self, parts: &[Literal], part: Part) -> Literal {
        parts.get(part.0).copied().unwrap_or(self.yes)
    }

    #[inline(never)]
    fn formula(&mut self, formula: &Formula<'e>, parts: &[Literal]) -> Literal {
        let of = |part: &Part| self.of(parts, *part);
        match formula {
            Formula::Const(v) => self.yes.negated_if(!v),
            Formula::Not(a) => !of(a),
            Formula::And(a, b) => {
                let (a, b) = (of(a), of(b));
                self.both(a, b)
            }
            Formula::Or(a, b) => {
                let (a, b) = (of(a), of(b));
                !self.both(!a, !b)
            }
            Formula::Xor(a, b) => {
                let (a, b) = (of(a), of(b));
                let (none, all) = (self.both(!a, !b), self.both(a, b));
                self.both(!none, !all)
            }
            Formula::Among(atom, values) => self.among(*atom, values),
            Formula::OneOf(list) => {
                self.one_of(list);
                self.yes
            }
        }
    }

    /// The literal of a conjunction.
    fn both(&mut self, a: Literal, b: Literal) -> Literal {
        let new = self.solver.variable(true);
        self.solver.add(&[!new, a]);
        self.solver.add(&[!new, b]);
        self.solver.add(&[new, !a, !b]);
        new
    }

    #[inline(never)]
    fn among(&mut self, atom: usize, values: &Values<'_>) -> Literal {
        let (op, equal) = match (values, self.question.get(atom).map(|a| &a.sort)) {
            (Values::Side(op, cut), Some(Sort::Place(_, cuts))) => {
                (*op, 2 * cuts.iter().position(|c| c == cut).unwrap_or(0) + 1)
            }
            (Values::Order(op), _) => (*op, 1),
            _ => return self.at_least(atom, 1),
        };
        let (from, beyond) = (self.at_least(atom, equal), self.at_least(atom, equal + 1));
        match [Ordering::Less, Ordering::Equal, Ordering::Greater].map(|order| holds(op, order)) {
            [true, false, false] => !from,
            [true, true, false] => !beyond,
            [false, false, true] => beyond,
            [false, true, true] => from,
            [false, true, false] => self.both(from, !beyond),
            [true, false, true] => !self.both(from, !beyond),
            [less, ..] => self.yes.negated_if(!less),
        }
    }

    /// At most one of these truths: what each adds to "one of them so far" is told on to the next.
    fn one_of(&mut self, list: &[usize]) {
        let mut before = !self.yes;
        for atom in list {
            let own = self.at_least(*atom, 1);
            let so_far = self.solver.variable(true);
            self.solver.add(&[!own, so_far]);
            self.solver.add(&[!before, so_far]);
            self.solver.add(&[!own, !before]);
            before = so_far;
        }
    }
}
