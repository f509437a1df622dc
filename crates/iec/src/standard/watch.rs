//! Values that are observed in every scan before the charts evolve. Edges and delays become
//! function blocks that a body before the charts calls; a step that others observe drives a
//! variable.

use g7_model::{Expr, ExprKind, FbKind, Literal, Nanos, Said, Section, Span, Type, VarKind, say};

use super::bodies::At;
use super::lower::{Lower, Watch, WatchKind};
use crate::nodes;
use crate::scopes::{Ref, StepKey};

impl<'d> Lower<'d> {
    /// `↑e`, `↓e`: the blocks R_TRIG and F_TRIG. In the first scan there is no edge.
    pub(super) fn edge(&mut self, rise: bool, e: &Expr, span: Span, at: &At<'d>) -> Expr {
        if !self.can_watch(span, at, say!("an edge")) {
            return nodes::boolean(false, span);
        }
        let value = self.expr(e, &At { program: None, condition: false, ..at.clone() });
        if let Some(known) = self.known(&WatchKind::Edge(rise), &value) {
            return nodes::name(&[&known], span);
        }
        let wish = format!("{}_{}", base(&value), if rise { "rise" } else { "fall" });
        let flag = self.fresh(None, &wish, Type::Bool, span);
        let kind = if rise { FbKind::RTrig } else { FbKind::FTrig };
        let block = self.fresh(None, &format!("{flag}_edge"), Type::Fb(kind), span);
        let started = self.started(span);
        let is = nodes::and(nodes::name(&[&block, "Q"], span), nodes::name(&[&started], span), span);
        self.looking.push(nodes::invoke(nodes::path(&[&block], span), vec![("CLK", value.clone())], span));
        self.looking.push(nodes::assign(nodes::name(&[&flag], span), is, span));
        self.watches.push(Watch { kind: WatchKind::Edge(rise), value, name: flag.clone() });
        nodes::name(&[&flag], span)
    }

    /// `t1/e/t2`: the blocks TON and TOF; of a step of the program alone its time.
    pub(super) fn timer(&mut self, t1: &Expr, e: &Expr, t2: Option<&Expr>, span: Span, at: &At<'d>) -> Expr {
        // The time of a step in another program runs from the end of the scan that activates it.
        let mut foreign = false;
        if let (ExprKind::Path(path), None) = (&e.kind, t2)
            && let Some(Ref::Active(step)) = self.scopes.refer(at.chart, &path.names)
            && !at.function
        {
            let own = self.program_of(step.0).is_some() && self.program_of(step.0) == at.program;
            if own && self.scopes.expansion(step).is_none() {
                let active = self.active(step, span, at, 0);
                let time = self.step_member(step, "T", span);
                let t1 = self.expr(t1, at);
                let over = nodes::binary(g7_model::BinaryOp::Ge, time, t1, span);
                return nodes::and(active, over, span);
            }
            foreign = true;
        }
        if !self.can_watch(span, at, say!("a time operator")) {
            return nodes::boolean(false, span);
        }
        let file = At { program: None, condition: false, ..at.clone() };
        let value = self.expr(e, &file);
        let kind = WatchKind::Delay(self.expr(t1, &file), t2.map(|t| self.expr(t, &file)));
        // After the evolution the step may have been left.
        let told = |flag: &str, value: Expr| {
            let flag = nodes::name(&[flag], span);
            if foreign { nodes::and(value, flag, span) } else { flag }
        };
        if let Some(known) = self.known(&kind, &value) {
            return told(&known, value);
        }
        let flag = self.fresh(None, &format!("{}_timed", base(&value)), Type::Bool, span);
        let first = self.looking.len();
        let is = self.delayed(&flag, &value, &kind, span);
        if foreign {
            self.closing.extend(self.looking.get(first..).unwrap_or(&[]).iter().cloned());
        }
        self.looking.push(nodes::assign(nodes::name(&[&flag], span), is, span));
        let told = told(&flag, value.clone());
        self.watches.push(Watch { kind, value, name: flag });
        told
    }

    fn delayed(&mut self, flag: &str, value: &Expr, kind: &WatchKind, span: Span) -> Expr {
        let WatchKind::Delay(t1, t2) = kind else { return value.clone() };
        let mut is = value.clone();
        let none = |t: &Expr| matches!(t.kind, ExprKind::Literal(Literal::Time(Nanos::ZERO)));
        let delay = !none(t1);
        if delay {
            let on = self.fresh(None, &format!("{flag}_on"), Type::Fb(FbKind::Ton), span);
            let args = vec![("IN", value.clone()), ("PT", t1.clone())];
            self.looking.push(nodes::invoke(nodes::path(&[&on], span), args, span));
            is = nodes::name(&[&on, "Q"], span);
        }
        if let Some(t2) = t2.as_ref().filter(|t| !none(t)) {
            let off = self.fresh(None, &format!("{flag}_off"), Type::Fb(FbKind::Tof), span);
            let q = nodes::name(&[&off, "Q"], span);
            // If the value returns before the end, it continues without the first delay.
            if delay {
                is = nodes::or(is, nodes::and(q.clone(), value.clone(), span), span);
            }
            let args = vec![("IN", is), ("PT", t2.clone())];
            self.looking.push(nodes::invoke(nodes::path(&[&off], span), args, span));
            is = q;
        }
        is
    }

    fn known(&self, kind: &WatchKind, value: &Expr) -> Option<String> {
        self.watches.iter().find(|w| w.kind == *kind && w.value == *value).map(|w| w.name.clone())
    }

    pub(super) fn can_watch(&mut self, span: Span, at: &At, what: Said) -> bool {
        let slow = at.chart.and_then(|c| self.scopes.chart(c)).is_some_and(|c| self.pace(c).is_some());
        if at.function {
            self.lost(span, say!("{what} in a function"));
        } else if slow {
            self.lost(span, say!("{what} in a chart with a period of its own"));
        }
        !at.function && !slow
    }

    /// A variable that is FALSE in the first scan.
    pub(super) fn started(&mut self, span: Span) -> String {
        if let Some(name) = &self.started {
            return name.clone();
        }
        let name = self.fresh(None, "Started", Type::Bool, span);
        self.started = Some(name.clone());
        name
    }

    /// A variable that is TRUE in the first scan until the charts have evolved.
    pub(super) fn first(&mut self, span: Span) -> String {
        if let Some(name) = &self.first {
            return name.clone();
        }
        let name = self.fresh(None, "First", Type::Bool, span);
        if let Some(decl) = self.new_globals.last_mut() {
            decl.init = Some(nodes::boolean(true, span));
        }
        self.first = Some(name.clone());
        name
    }

    /// The variable that a step drives, so that others can tell that it is active.
    pub(super) fn mirror(&mut self, step: StepKey, span: Span) -> String {
        if let Some(name) = self.mirrors.get(&step) {
            return name.clone();
        }
        let wish = format!("{}_active", self.names.step(step));
        let name = self.fresh(None, &wish, Type::Bool, span);
        self.mirrors.insert(step, name.clone());
        name
    }

    /// The variable of a section with more than one assignment; a body before the charts computes
    /// it.
    pub(super) fn section_variable(&mut self, chart: Option<usize>, section: &'d Section) -> String {
        let key = (chart, &*section.name.text);
        if let Some((_, name)) = self.computed.iter().find(|(k, _)| *k == key) {
            return name.clone();
        }
        let span = section.name.at.0;
        let name = self.names.part(chart, &section.name.text).unwrap_or(&section.name.text).to_string();
        let name = self.fresh(None, &format!("{name}_is"), Type::Bool, span);
        self.computed.push((key, name.clone()));
        let locals = vec![(section.name.text.clone(), name.clone())];
        let at = At { chart, locals, ..At::default() };
        let list = self.block(&section.body, &at, &name);
        self.sections.extend(list);
        name
    }

    /// A new variable of a program or of the file.
    pub(super) fn fresh(&mut self, program: Option<usize>, wish: &str, ty: Type, span: Span) -> String {
        let name = self.names.free(program, wish);
        let decl = nodes::variable(VarKind::Var, &name, ty, span);
        match program.and_then(|p| self.new_vars.get_mut(p)) {
            Some(vars) => vars.push(decl),
            None => self.new_globals.push(decl),
        }
        name
    }
}

/// The beginning of a name for an observed value.
fn base(value: &Expr) -> String {
    match &value.kind {
        ExprKind::Path(path) => path.text().replace('.', "_"),
        _ => "Event".into(),
    }
}
