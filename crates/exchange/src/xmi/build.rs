//! Builds the document from the content of the file.

use g7_model::{
    Action, ActionKind, Chart, ChartItem, ChartKind, Document, Item, Name, Note, Order, Profile, ProfileName,
    Said, Step, StepKind, Transition, VarDecl, VarKind, codes, say,
};

use super::actions::{self, OfSteps};
use super::arcs::{self, Ends, MOST_ENDS};
use super::naming::{self, Names};
use super::nesting::{self, Nesting};
use super::read::{Plan, Sheet, StepNode, StepSort, VarSort};
use super::refs::Xml;
use super::terms::{Delay, MOST_TERMS, Terms, bad};
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The beginning of a note that keeps the name of the whole file.
pub(super) const NAME_NOTE: &str = "// name: ";

/// The document of a file.
pub(super) fn document(plan: &Plan, report: &mut Report) -> Document {
    let at = report.span(&plan.at);
    let names = naming::give(plan, report);
    let nesting = nesting::read(plan, &names, report);
    let mut left = MOST_TERMS;
    let actions = actions::of_steps(plan, &names, &mut left, report);
    let mut builder = Builder { plan, names: &names, nesting, actions, left, ends: MOST_ENDS, report };
    let mut items =
        vec![Item::Profile(Profile { name: ProfileName::Iec60848, switches: Vec::new(), at: at.into() })];
    items.extend(builder.vars(None).map(Item::Var));
    items.extend((0..plan.sheets.len()).filter_map(|i| builder.chart(i)).map(Item::Chart));
    let name = plan.name.as_ref().filter(|n| !n.trim().is_empty());
    let mut notes: Vec<Note> = name
        .map(|n| Note { text: format!("{NAME_NOTE}{}", shown(n).trim()).into(), at, behind: None })
        .into_iter()
        .collect();
    notes.extend(report.take_notes());
    Document { items, notes }
}

struct Builder<'p, 'a> {
    plan: &'p Plan<'a>,
    names: &'p Names,
    nesting: Nesting,
    actions: OfSteps,
    /// The number of terms and ends of transitions that may still be read.
    left: usize,
    ends: usize,
    report: &'p mut Report,
}

impl<'a> Builder<'_, 'a> {
    /// The variables of the file or of a chart; the activity of a step needs none.
    fn vars(&self, sheet: Option<usize>) -> impl Iterator<Item = VarDecl> {
        let of = self.plan.vars.iter().enumerate().filter(move |(_, v)| v.sheet == sheet);
        let of = of.filter(|(number, _)| !self.names.is_timed(*number));
        of.filter_map(|(number, var)| {
            let kind = match var.sort {
                VarSort::Input => VarKind::Input,
                VarSort::Output => VarKind::Output,
                VarSort::Internal => VarKind::Var,
                VarSort::Step => return None,
            };
            let at = self.report.span(&attr::head(var.xml));
            let names = vec![Name::new(self.names.var(number), at)];
            Some(VarDecl::new(kind, names, var.ty, at.into()))
        })
    }

    fn chart(&mut self, index: usize) -> Option<Chart> {
        let sheet = self.plan.sheets.get(index)?;
        let at = self.report.span(&attr::head(sheet.xml));
        let mut items: Vec<ChartItem> = self.vars(Some(index)).map(ChartItem::Var).collect();
        for (number, step) in sheet.steps.iter().enumerate() {
            items.push(ChartItem::Step(self.step((index, number), step)));
        }
        let ends = arcs::ends(self.plan, index, self.names, &mut self.ends, self.report);
        for (number, ends) in ends.iter().enumerate() {
            items.extend(self.transition(index, number, sheet, ends).map(ChartItem::Transition));
        }
        Some(Chart {
            params: Vec::new(),
            block: None,
            kind: if sheet.expansion { ChartKind::Expansion } else { ChartKind::Chart },
            name: Name::new(self.names.chart(index), at),
            comment: None,
            every: None,
            items,
            at: at.into(),
        })
    }

    fn step(&mut self, place: (usize, usize), node: &StepNode) -> Step {
        let at = self.report.span(&attr::head(node.xml));
        let enclosed = self.nesting.enclosed.remove(&place).unwrap_or_default();
        let kind = match node.sort {
            StepSort::Entry => StepKind::Entry,
            StepSort::Exit => StepKind::Exit,
            StepSort::Macro => match self.nesting.expansions.get(&place) {
                Some(chart) => StepKind::Macro(Name::new(self.names.chart(*chart), at)),
                None => StepKind::Plain,
            },
            StepSort::Plain | StepSort::Enclosing if !enclosed.is_empty() => {
                if node.sort == StepSort::Plain {
                    let what = say!("a step of the class `Step` encloses a chart; it is an enclosing step");
                    self.report.say(&codes::DIFFERENT, &attr::head(node.xml), what);
                }
                StepKind::Enclosing
            }
            StepSort::Enclosing => {
                let what = say!("an enclosing step that encloses no chart; it is read as a step");
                self.report.say(&codes::DIFFERENT, &attr::head(node.xml), what);
                StepKind::Plain
            }
            StepSort::Plain => StepKind::Plain,
        };
        let enclose = |chart: &usize| {
            let name = Name::new(self.names.chart(*chart), at);
            Action { kind: ActionKind::Order(Order::Enclose(name)), at: at.into() }
        };
        let mut actions: Vec<Action> = enclosed.iter().map(enclose).collect();
        actions.extend(self.actions.remove(&place).unwrap_or_default());
        Step {
            name: Name::new(self.names.step(place.0, place.1), at),
            kind,
            initial: node.initial,
            linked: node.linked,
            comment: None,
            braces: !actions.is_empty(),
            actions,
            at: at.into(),
        }
    }

    fn transition(
        &mut self,
        index: usize,
        number: usize,
        sheet: &Sheet<'a>,
        ends: &Ends,
    ) -> Option<Transition> {
        let xml: Xml = *sheet.transitions.get(number)?;
        let head = attr::head(xml);
        let at = self.report.span(&head);
        let left = &mut self.left;
        let mut terms = Terms { plan: self.plan, names: self.names, report: self.report, left, sheet: index };
        let delay = terms.delay(xml);
        let receptivity = match terms.of(xml, "term") {
            Some(e) => delay.around(e, at),
            None => {
                let with = if delay == Delay::None { Said::default() } else { say!(" to delay") };
                let what = say!("a transition without a term{with}: its receptivity is missing");
                self.report.say(&codes::BAD_TEXT, &head, what);
                bad(at)
            }
        };
        let name = |step: &usize| Name::new(self.names.step(index, *step), at);
        Some(Transition {
            label: self.names.label(index, number).map(|l| Name::new(l, at)),
            from: ends.from.iter().map(name).collect(),
            to: ends.to.iter().map(name).collect(),
            receptivity,
            priority: None,
            comment: None,
            on_clearing: None,
            chained: false,
            at: at.into(),
        })
    }
}
