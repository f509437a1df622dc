//! Refuses as a whole: other rules of evolution, other charts, steps that a section cannot have.

use g7_iec::nodes;
use g7_iec::scopes::Ref;
use g7_model::visit::Visitor;
use g7_model::{
    ActionKind, Chart, ChartKind, Expr, ExprKind, Name, Order, Place, ProfileName, Qualifier, Span, Step,
    StepKind, Switch, Target, Transition, UnaryOp, codes, say,
};

use super::Writer;

/// The switches of a profile; those of Control Expert are all false, but for `pulse_first`.
#[derive(Clone, Copy, Debug, Default)]
struct Switches {
    stable: bool,
    multi_token: bool,
    sequential: bool,
    parallel_actions: bool,
    final_scan: bool,
    zero_step_time: bool,
    scan_clock: bool,
    text_order: bool,
}

impl Switches {
    fn set(&mut self, switch: Switch) {
        match switch {
            Switch::Stable(on) => self.stable = on,
            Switch::MultiToken(on) => self.multi_token = on,
            Switch::Sequential(on) => self.sequential = on,
            Switch::ParallelActions(on) => self.parallel_actions = on,
            Switch::FinalScan(on) => self.final_scan = on,
            Switch::KeepStepTime(on) => self.zero_step_time = !on,
            Switch::ScanClock(on) => self.scan_clock = on,
            Switch::PulseFirst(on) => self.text_order = !on,
            Switch::Bound(_) => {}
        }
    }
}

impl Writer<'_> {
    pub(super) fn rules(&mut self) {
        self.notes();
        self.evolution();
        self.charts();
        for index in self.order() {
            if let Some(chart) = self.speech.scopes.chart(index) {
                self.steps(chart, self.owners.contains_key(&index));
            }
        }
    }

    /// One warning for all notes of the file.
    fn notes(&mut self) {
        if let Some(first) = self.document.notes.first() {
            self.speech.leave_out(first.at.into(), say!("a note to the reader"));
        }
    }

    /// The rules of evolution must be those of Control Expert, or make no difference to this chart.
    fn evolution(&mut self) {
        let profile = self.document.profile();
        let (name, at) = profile.map_or((ProfileName::default(), Place::default()), |p| (p.name, p.at));
        let mut switches = match name {
            ProfileName::Unity => Switches::default(),
            ProfileName::Iec61131 => Switches { final_scan: true, text_order: true, ..Switches::default() },
            ProfileName::Iec60848 | ProfileName::Pl7 | ProfileName::Jgrafchart => {
                let what =
                    say!("the rules of evolution of `{}`; Control Expert has those of `unity`", name.name());
                return self.speech.say(&codes::NOT_CARRIED, at, what);
            }
        };
        profile.iter().flat_map(|p| &p.switches).for_each(|(s, _)| switches.set(*s));
        let bodies = self.bodies();
        let lasting = |q: &Qualifier| !matches!(q, Qualifier::P0 | Qualifier::P1);
        let turn = |q: &Qualifier| match q {
            Qualifier::P1 => 0,
            Qualifier::P0 => 2,
            _ => 1,
        };
        let mut times = Times(false);
        times.document(self.document);
        let matters = [
            ("stable", switches.stable),
            ("multi-token", switches.multi_token && !self.exclusive()),
            ("sequential", switches.sequential),
            ("parallel-actions", switches.parallel_actions && !bodies.is_empty()),
            ("final-scan", switches.final_scan && bodies.iter().any(lasting)),
            ("zero-step-time", switches.zero_step_time && times.0),
            ("scan-clock", switches.scan_clock && times.0),
            ("text-order", switches.text_order && !bodies.iter().map(turn).is_sorted()),
        ];
        for (word, _) in matters.into_iter().filter(|m| m.1) {
            let what =
                say!("the rule `{word}`, which this chart depends on; Control Expert has those of `unity`");
            self.speech.say(&codes::NOT_CARRIED, at, what);
        }
        self.several_initial();
    }

    /// The qualifiers of all bodies, in the order of the text.
    fn bodies(&self) -> Vec<Qualifier> {
        let mut list = Vec::new();
        for (index, chart) in self.speech.scopes.charts.iter().enumerate() {
            for action in chart.steps().flat_map(|s| &s.actions) {
                let ActionKind::Qualified { qualifier, target, .. } = &action.kind else { continue };
                let body = match target {
                    Target::Work(_) => true,
                    Target::Path(path) => {
                        matches!(self.speech.scopes.refer(Some(index), &path.names), Some(Ref::Action(..)))
                    }
                    Target::Direct(..) | Target::Element(_) => false,
                };
                list.extend(body.then_some(*qualifier));
            }
        }
        list
    }

    /// True if no two transitions behind one step can clear together.
    fn exclusive(&self) -> bool {
        self.speech.scopes.charts.iter().all(|chart| {
            chart.steps().all(|step| {
                let behind = |t: &&Transition| t.from.iter().any(|n| n.text == step.name.text);
                let list: Vec<&Transition> = chart.transitions().filter(behind).collect();
                let rest = |(i, a): (usize, &&Transition)| {
                    list.iter().skip(i + 1).all(|b| exclude(&a.receptivity, &b.receptivity))
                };
                list.len() <= MOST_BRANCHES && list.iter().enumerate().all(rest)
            })
        })
    }

    /// Several initial steps need an option of the project, under which branches are not looked at one after the other.
    fn several_initial(&mut self) {
        let Some(chart) = self.order().first().and_then(|i| self.speech.scopes.chart(*i)) else { return };
        let mut initial = chart.steps().filter(|s| s.initial);
        let Some(second) = initial.nth(1) else { return };
        if self.exclusive() {
            let what = say!(
                "a second initial step: Control Expert takes it with the option for several tokens alone, which changes nothing else in this chart"
            );
            self.speech.say(&codes::DIFFERENT, second.at, what);
        } else {
            let what = say!(
                "a second initial step: Control Expert takes it with the option for several tokens alone, under which branches of this chart would clear together"
            );
            self.speech.say(&codes::NOT_CARRIED, second.at, what);
        }
    }

    /// A file has one section, with one chart and the expansions in it.
    fn charts(&mut self) {
        let mut chart = false;
        let cycle = self.document.cycle();
        for (index, other) in self.speech.scopes.charts.clone().into_iter().enumerate() {
            let at = other.name.at;
            match other.kind {
                ChartKind::Chart if chart => {
                    let what = say!("a second chart `{}`: the file holds one section", other.name.text);
                    self.speech.say(&codes::NOT_CARRIED, at, what);
                }
                ChartKind::Chart => chart = true,
                ChartKind::Task => self.speech.cannot(at, say!("a task")),
                ChartKind::Expansion => self.expansion(index, other),
            }
            if other.every.is_some() && other.every != cycle {
                self.speech.cannot(at, say!("a period of such a chart"));
            }
        }
        if !chart {
            self.speech.say(&codes::NOT_CARRIED, Place::default(), say!("a document without a chart"));
        }
        self.in_order();
    }

    fn expansion(&mut self, index: usize, chart: &Chart) {
        let at = chart.name.at;
        let Some(owner) = self.owners.get(&index) else {
            return self.speech.leave_out(at, say!("an expansion without a macro-step"));
        };
        let name = self.speech.scopes.step(*owner).map_or("", |s| &*s.name.text);
        if *chart.name.text != *name {
            let what = say!("`{}` is called as its macro-step there: `{}`", chart.name.text, name);
            self.speech.say(&codes::RENAMED, at, what);
        }
        let count = |kind: StepKind| chart.steps().filter(|s| s.kind == kind).count();
        if (count(StepKind::Entry), count(StepKind::Exit)) != (1, 1) {
            self.speech.cannot(at, say!("an expansion without exactly one entry step and one exit step"));
        }
    }

    /// Actions run in the order of the file, and the chart stands before its expansions there.
    fn in_order(&mut self) {
        let order = self.order();
        let acts = |index: &usize| {
            let chart = self.speech.scopes.chart(*index);
            chart.is_some_and(|c| c.steps().any(|s| !s.actions.is_empty()))
        };
        let acting: Vec<usize> = order.into_iter().filter(acts).collect();
        let moved = acting.windows(2).find(|w| matches!(w, [a, b] if a > b));
        if let Some([first, _]) = moved
            && let Some(chart) = self.speech.scopes.chart(*first)
        {
            let what = say!(
                "`{}` stands before its expansions there; in a scan, its actions run before theirs",
                chart.name.text
            );
            self.speech.say(&codes::DIFFERENT, chart.name.at, what);
        }
    }

    fn steps(&mut self, chart: &Chart, inside: bool) {
        for step in chart.steps() {
            self.step_kind(step, inside);
        }
        if !inside && !chart.steps().any(|s| s.initial) {
            self.speech.say(
                &codes::NOT_CARRIED,
                chart.name.at,
                say!("a chart without an initial step: Control Expert takes none"),
            );
        }
    }

    fn step_kind(&mut self, step: &Step, inside: bool) {
        let macro_step = matches!(step.kind, StepKind::Macro(_));
        if step.kind == StepKind::Enclosing {
            self.speech.cannot(step.at, say!("an enclosing step"));
        }
        if step.linked {
            self.speech.cannot(step.at, say!("an activation link"));
        }
        if step.initial && (inside || macro_step) {
            self.speech
                .cannot(step.at, say!("an initial macro-step, enclosing step or step in a macro-step"));
        }
        if matches!(step.kind, StepKind::Entry | StepKind::Exit) && !inside {
            self.speech.cannot(step.at, say!("an entry or exit step outside of a macro-step"));
        }
        if macro_step && step.actions.iter().any(|a| !matches!(a.kind, ActionKind::Comment(_))) {
            self.speech.cannot(step.at, say!("an action of a macro-step"));
        }
    }
}

/// The most transitions behind one step whose receptivities are compared.
const MOST_BRANCHES: usize = 100;

/// True if one condition asks for something and the other for its complement.
fn exclude(a: &Expr, b: &Expr) -> bool {
    let denied = |one: &Expr, other: &Expr| matches!(&one.kind, ExprKind::Unary(UnaryOp::Not, inner) if **inner == *other);
    let theirs = nodes::conjuncts(b);
    nodes::conjuncts(a).iter().any(|x| theirs.iter().any(|y| denied(x, y) || denied(y, x)))
}

/// Notes that the time of a step is read, or something that may be such a time.
struct Times(bool);

impl<'d> Visitor<'d> for Times {
    fn path(&mut self, names: &'d [Name]) {
        let last = names.last().filter(|_| names.len() > 1);
        self.0 |= last.is_some_and(|n| matches!(&*n.text, "t" | "T" | "s"));
    }

    fn direct(&mut self, text: &'d str, _: Span) {
        self.0 |= text.starts_with('X');
    }

    fn order(&mut self, _: &'d Order) {}

    fn expr(&mut self, e: &'d Expr) {
        match &e.kind {
            ExprKind::Timer { .. } => self.0 = true,
            ExprKind::Literal(_) | ExprKind::Bad => {}
            ExprKind::Direct(text) => self.direct(text, e.at.0),
            ExprKind::Path(path) => self.path(&path.names),
            ExprKind::Unary(_, a) => self.expr(a),
            ExprKind::Binary(_, a, b) => {
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Call(path, args) => self.call(path, args),
            ExprKind::Element(path, index, _) => {
                self.path(&path.names);
                self.exprs(index);
            }
            ExprKind::List(values) => self.exprs(values.iter().map(|(_, e)| e)),
        }
    }
}
