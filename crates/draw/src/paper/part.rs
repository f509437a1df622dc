//! The part of a chart that stands on one sheet: symbols with the links between them, and a stub at each symbol whose
//! links lead to other sheets. A stub is laid out like a step or a transition, so it has room of its own.

use std::collections::{HashMap, HashSet};

use g7_model::{
    Chart, ChartItem, ChartKind, Document, Expr, LinkForm, Name, Place, PlaceAt, Placed, Span, Step,
    StepKind, Transition, Type,
};

use super::stub::{Stub, Token};
use crate::draw::{Symbols, places};
use crate::layout::forms::wanted;
use crate::layout::layout;
use crate::pages::{Cells, cells};
use crate::{Drawing, End, Item, Options, Part as Shown, Placement, Rect, Sizes};

/// A chart as the division into sheets sees it.
pub(super) struct Flow<'a> {
    pub(super) cells: Cells,
    /// The preceding transitions of each step.
    pub(super) into: Vec<Vec<u32>>,
    pub(super) symbols: Symbols<'a>,
    /// The forms that the layout section gives to links.
    forms: HashMap<(End, End), LinkForm>,
}

impl<'a> Flow<'a> {
    pub(super) fn new(document: &Document, chart: &'a Chart, options: &Options) -> Flow<'a> {
        let cells = cells(chart);
        let places = places(document, chart);
        let forms = wanted(chart, places);
        let mut into = vec![Vec::new(); cells.steps.len()];
        for (t, to) in (0..).zip(&cells.to) {
            for s in to {
                if let Some(list) = into.get_mut(*s as usize) {
                    list.push(t);
                }
            }
        }
        Flow { cells, into, symbols: Symbols::new(chart, places, options), forms }
    }

    pub(super) fn from(&self, t: u32) -> &[u32] {
        self.cells.from.get(t as usize).map_or(&[], Vec::as_slice)
    }

    pub(super) fn to(&self, t: u32) -> &[u32] {
        self.cells.to.get(t as usize).map_or(&[], Vec::as_slice)
    }

    /// The symbols to which a symbol is linked.
    pub(super) fn neighbours(&self, of: End) -> Vec<End> {
        match of {
            End::Step(s) => {
                let lists = [self.into.get(s as usize), self.cells.behind.get(s as usize)];
                lists.into_iter().flatten().flatten().map(|t| End::Transition(*t)).collect()
            }
            End::Transition(t) => self.from(t).iter().chain(self.to(t)).map(|s| End::Step(*s)).collect(),
        }
    }

    /// The name of the step at the other end of a link or, if that is a transition, of the step beyond it.
    fn named(&self, other: End, leaving: bool) -> &str {
        let step = match other {
            End::Step(s) => Some(s),
            End::Transition(t) if leaving => self.to(t).first().copied(),
            End::Transition(t) => self.from(t).first().copied(),
        };
        step.and_then(|s| self.symbols.steps.get(s as usize)).map_or("", |(s, _)| &s.name.text)
    }

    fn token(&self, from: End, to: End, leaving: bool) -> Token {
        let other = if leaving { to } else { from };
        Token { from, to, name: self.named(other, leaving).to_owned() }
    }
}

/// A symbol of the part: one of the chart, or a stub.
enum Member {
    Own(u32),
    Stub(Stub),
}

/// A part of a chart with the places of its symbols.
pub(super) struct Part {
    steps: Vec<Member>,
    transitions: Vec<Member>,
    placement: Placement,
    /// The box of everything.
    pub(super) area: Rect,
}

/// The symbols of the part while it is put together, as a chart of its own.
struct Making<'f, 'a> {
    flow: &'f Flow<'a>,
    digits: usize,
    within: HashSet<End>,
    steps: Vec<Member>,
    transitions: Vec<Member>,
    chart: Chart,
    sizes: Sizes,
}

impl Part {
    /// Lays the part with these symbols out. The numbers of other sheets may have so many digits.
    pub(super) fn new(flow: &Flow<'_>, members: &[End], digits: usize) -> Part {
        let mut making = Making {
            flow,
            digits,
            within: members.iter().copied().collect(),
            steps: Vec::new(),
            transitions: Vec::new(),
            chart: empty(),
            sizes: Sizes::default(),
        };
        let (mut steps, mut transitions) = (Vec::new(), Vec::new());
        for member in members {
            match member {
                End::Step(s) => steps.push(*s),
                End::Transition(t) => transitions.push(*t),
            }
        }
        // In the order of the text, on which the order of branches depends.
        steps.sort_unstable();
        transitions.sort_unstable();
        making.own_steps(&steps);
        making.own_transitions(&transitions);
        making.stubs_of_steps(&steps);
        making.done()
    }

    /// The symbols of the chart in this part.
    pub(super) fn own(&self) -> impl Iterator<Item = End> {
        let of = |list: &[Member], end: fn(u32) -> End| {
            list.iter()
                .filter_map(|m| if let Member::Own(n) = m { Some(end(*n)) } else { None })
                .collect::<Vec<_>>()
        };
        of(&self.steps, End::Step).into_iter().chain(of(&self.transitions, End::Transition))
    }

    /// The links that lead to other sheets, as tokens of stubs, each with the direction.
    pub(super) fn away(&self) -> impl Iterator<Item = (&Token, bool)> {
        let stubs = self.steps.iter().chain(&self.transitions);
        stubs
            .filter_map(|m| if let Member::Stub(s) = m { Some(s) } else { None })
            .flat_map(|s| s.tokens.iter().map(|t| (t, s.leaving)))
    }

    /// Draws the part. `page` gives the number of the sheet on which a symbol stands.
    pub(super) fn draw(&self, flow: &Flow<'_>, chart: &Chart, page: &dyn Fn(End) -> usize) -> Drawing {
        let nowhere = Step { name: Name::new("", Span::default()), ..stub_step(String::new()) };
        let gap = stub_transition();
        let steps = self.steps.iter().filter_map(|m| match m {
            Member::Own(n) => flow.symbols.steps.get(*n as usize).cloned(),
            Member::Stub(stub) => Some((&nowhere, stub.as_step(page))),
        });
        let transitions = self.transitions.iter().filter_map(|m| match m {
            Member::Own(n) => flow.symbols.transitions.get(*n as usize).cloned(),
            Member::Stub(stub) => Some((&gap, stub.as_transition(page))),
        });
        let symbols =
            Symbols { steps: steps.collect(), transitions: transitions.collect(), sizes: Sizes::default() };
        let mut drawing = symbols.put(chart, &self.placement, Vec::new(), &[]);
        drawing.items.iter_mut().for_each(|item| self.rename(item));
        drawing
    }

    /// Gives an item the numbers that its symbol has in the whole chart.
    fn rename(&self, item: &mut Item) {
        item.part = match std::mem::replace(&mut item.part, Shown::Text) {
            Shown::Step { step, square } => match self.steps.get(step as usize) {
                Some(Member::Own(n)) => Shown::Step { step: *n, square },
                other => stub(other, step),
            },
            Shown::Action { step, index } => match self.steps.get(step as usize) {
                Some(Member::Own(n)) => Shown::Action { step: *n, index },
                other => stub(other, step),
            },
            Shown::Transition { transition, bar, text } => match self.transitions.get(transition as usize) {
                Some(Member::Own(n)) => Shown::Transition { transition: *n, bar, text },
                other => stub(other, transition),
            },
            Shown::Link { link, from, to, held, bends, form } => {
                Shown::Link { link, from: self.whole(from), to: self.whole(to), held, bends, form }
            }
            Shown::Connector { connector, from, to, leaving, form } => {
                Shown::Connector { connector, from: self.whole(from), to: self.whole(to), leaving, form }
            }
            other @ (Shown::Comment { .. } | Shown::Text) => other,
        };
    }

    /// The symbol of the chart that a symbol of the part is; of a stub the other end of its first link.
    fn whole(&self, end: End) -> End {
        let (list, n) = match end {
            End::Step(n) => (&self.steps, n),
            End::Transition(n) => (&self.transitions, n),
        };
        match (list.get(n as usize), end) {
            (Some(Member::Own(n)), End::Step(_)) => End::Step(*n),
            (Some(Member::Own(n)), End::Transition(_)) => End::Transition(*n),
            (Some(Member::Stub(stub)), _) => stub.other().unwrap_or(end),
            (None, _) => end,
        }
    }
}

/// A stub as a part of a drawing.
fn stub(member: Option<&Member>, connector: u32) -> Shown {
    match member {
        Some(Member::Stub(stub)) => match stub.tokens.first() {
            Some(t) => {
                Shown::Connector { connector, from: t.from, to: t.to, leaving: stub.leaving, form: None }
            }
            None => Shown::Text,
        },
        Some(Member::Own(_)) | None => Shown::Text,
    }
}

impl Making<'_, '_> {
    /// The name of a step of the part.
    fn name(n: usize) -> Name {
        Name::new(n.to_string(), Span::default())
    }

    fn own_steps(&mut self, steps: &[u32]) {
        for s in steps {
            let Some((step, _)) = self.flow.symbols.steps.get(*s as usize) else { continue };
            let name = Making::name(self.steps.len());
            let kind =
                if matches!(step.kind, StepKind::Macro(_)) { StepKind::Plain } else { step.kind.clone() };
            let shape =
                Step { kind, initial: step.initial, linked: step.linked, ..stub_step(name.text.to_string()) };
            self.chart.items.push(ChartItem::Step(shape));
            self.sizes
                .steps
                .push(self.flow.symbols.sizes.steps.get(*s as usize).copied().unwrap_or_default());
            let width = self.flow.symbols.sizes.connectors.get(*s as usize).copied().unwrap_or(0);
            self.sizes.connectors.push(width);
            self.steps.push(Member::Own(*s));
        }
    }

    fn step_stub(&mut self, stub: Stub) -> Name {
        let name = Making::name(self.steps.len());
        self.chart.items.push(ChartItem::Step(stub_step(name.text.to_string())));
        self.sizes.steps.push(stub.step_extent(self.digits));
        self.sizes.connectors.push(0);
        self.steps.push(Member::Stub(stub));
        name
    }

    fn transition(&mut self, member: Member, from: Vec<Name>, to: Vec<Name>) {
        let size = match &member {
            Member::Own(t) => {
                self.flow.symbols.sizes.transitions.get(*t as usize).copied().unwrap_or_default()
            }
            Member::Stub(stub) => stub.transition_extent(self.digits),
        };
        self.sizes.transitions.push(size);
        self.chart.items.push(ChartItem::Transition(Transition { from, to, ..stub_transition() }));
        self.transitions.push(member);
    }

    fn is_within(&self, end: End) -> bool {
        self.within.contains(&end)
    }

    fn own_transitions(&mut self, transitions: &[u32]) {
        let numbers: HashMap<u32, usize> = (0..)
            .zip(&self.steps)
            .filter_map(|(n, m)| if let Member::Own(s) = m { Some((*s, n)) } else { None })
            .collect();
        let mut shared: HashMap<u32, usize> = HashMap::new();
        let flow = self.flow;
        for t in transitions {
            let own = End::Transition(*t);
            let present = |list: &[u32]| -> Vec<Name> {
                list.iter().filter_map(|s| numbers.get(s)).map(|n| Making::name(*n)).collect()
            };
            let (mut from, mut to) = (present(flow.from(*t)), present(flow.to(*t)));
            let away = |list: &[u32]| -> Vec<u32> {
                list.iter().filter(|s| !numbers.contains_key(s)).copied().collect()
            };
            let (before, behind) = (away(flow.from(*t)), away(flow.to(*t)));
            if let [one] = *before
                && from.is_empty()
            {
                // Transitions behind one step are alternatives, and part at one stub.
                let token = flow.token(End::Step(one), own, false);
                let at = match shared.get(&one).copied() {
                    Some(at) => {
                        if let Some(Member::Stub(stub)) = self.steps.get_mut(at) {
                            stub.tokens.push(token);
                        }
                        at
                    }
                    None => {
                        let at = self.steps.len();
                        self.step_stub(Stub {
                            leaving: false,
                            double: false,
                            once: true,
                            tokens: vec![token],
                        });
                        shared.insert(one, at);
                        at
                    }
                };
                from.push(Making::name(at));
            } else if !before.is_empty() {
                let tokens = before.iter().map(|s| flow.token(End::Step(*s), own, false)).collect();
                let double = from.is_empty();
                from.push(self.step_stub(Stub { leaving: false, double, once: false, tokens }));
            }
            if !behind.is_empty() {
                let tokens: Vec<Token> =
                    behind.iter().map(|s| flow.token(own, End::Step(*s), true)).collect();
                let double = to.is_empty() && tokens.len() > 1;
                to.push(self.step_stub(Stub { leaving: true, double, once: false, tokens }));
            }
            self.transition(Member::Own(*t), from, to);
        }
    }

    fn stubs_of_steps(&mut self, steps: &[u32]) {
        let flow = self.flow;
        for (n, s) in steps.iter().enumerate() {
            let (own, name) = (End::Step(*s), || vec![Making::name(n)]);
            let away = |list: Option<&Vec<u32>>, leaving: bool| -> Vec<Token> {
                let all = list.map_or(&[][..], Vec::as_slice).iter().map(|t| End::Transition(*t));
                let away = all.filter(|t| !self.is_within(*t));
                let token = |t| if leaving { flow.token(own, t, true) } else { flow.token(t, own, false) };
                away.map(token).collect()
            };
            let before = away(flow.into.get(*s as usize), false);
            let behind = away(flow.cells.behind.get(*s as usize), true);
            if !before.is_empty() {
                let stub = Stub { leaving: false, double: false, once: false, tokens: before };
                self.transition(Member::Stub(stub), Vec::new(), name());
            }
            if !behind.is_empty() {
                let stub = Stub { leaving: true, double: false, once: false, tokens: behind };
                self.transition(Member::Stub(stub), name(), Vec::new());
            }
        }
    }

    /// The forms of the links between symbols of the part.
    fn forms(&self) -> Vec<PlaceAt> {
        if self.flow.forms.is_empty() {
            return Vec::new();
        }
        let own = |list: &[Member]| -> HashMap<u32, usize> {
            let number = |(n, m): (usize, &Member)| if let Member::Own(s) = m { Some((*s, n)) } else { None };
            list.iter().enumerate().filter_map(number).collect()
        };
        let (steps, transitions) = (own(&self.steps), own(&self.transitions));
        let symbol = |end: &End| match end {
            End::Step(n) => steps.get(n).map(|n| Placed::Step(Making::name(*n))),
            End::Transition(n) => transitions.get(n).map(|n| Placed::TransitionNumber(*n as u32)),
        };
        let entry = |((from, to), form): (&(End, End), &LinkForm)| {
            let what = Placed::LinkForm(Box::new((symbol(from)?, symbol(to)?)), *form);
            Some(PlaceAt { what, x: 0, y: 0, then: Vec::new(), at: Place::default() })
        };
        self.flow.forms.iter().filter_map(entry).collect()
    }

    fn done(self) -> Part {
        let forms = self.forms();
        let Making { steps, transitions, chart, sizes, .. } = self;
        let placement = layout(&chart, &sizes, &forms);
        let boxes = placement
            .steps
            .iter()
            .zip(&sizes.steps)
            .chain(placement.transitions.iter().zip(&sizes.transitions))
            .map(|(at, extent)| Rect::around(*at, *extent));
        let area = boxes.fold(placement.area, |all, b| all.union(&b));
        Part { steps, transitions, placement, area }
    }
}

fn empty() -> Chart {
    Chart {
        kind: ChartKind::Chart,
        name: Name::new("", Span::default()),
        params: Vec::new(),
        block: None,
        comment: None,
        every: None,
        items: Vec::new(),
        at: Place::default(),
    }
}

fn stub_step(name: String) -> Step {
    Step {
        name: Name::new(name, Span::default()),
        kind: StepKind::Plain,
        initial: false,
        linked: false,
        comment: None,
        actions: Vec::new(),
        braces: false,
        at: Place::default(),
    }
}

fn stub_transition() -> Transition {
    Transition {
        label: None,
        from: Vec::new(),
        to: Vec::new(),
        receptivity: Expr::zero(Type::Bool, Place::default()),
        priority: None,
        comment: None,
        on_clearing: None,
        chained: false,
        at: Place::default(),
    }
}
