//! Actions of steps, and the transitions between steps.

use g7_model::{
    Action as WrittenAction, ActionKind as Written, Chart as WrittenChart, Expr as WrittenExpr,
    ExprKind as Form, Name, Order, Path, Problem, Qualifier, Situation as WrittenSituation, Span,
    Target as WrittenTarget, Transition as WrittenTransition, Type, codes, say,
};

use super::arrays::Element;
use super::refer::Ref;
use super::resolver::Resolver;
use super::scopes::Entity;
use crate::ir::{
    Action, ActionKind, BodyId, ChartId, ChartRole, Expr, ExprKind, SectionId, Situation, StepId, Transition,
    Value, VarClass, VarId,
};

/// The variable or named action that a qualifier drives.
enum Governed {
    Var(VarId),
    Body(BodyId),
}

impl Resolver<'_, '_> {
    /// Resolves the actions of all steps and all transitions of a chart.
    #[inline(never)]
    pub(super) fn fill_chart(&mut self, id: ChartId, chart: &WrittenChart) {
        let first = self.unit.charts.get(id.index()).map_or(0, |c| c.steps.start);
        for (step, written) in (first..).map(StepId).zip(chart.steps()) {
            let mut actions = Vec::with_capacity(written.actions.len());
            for a in &written.actions {
                if let Some(kind) = self.action(step, a) {
                    actions.push(Action { kind, at: a.at.0 });
                }
            }
            if let Some(s) = self.unit.steps.get_mut(step.index()) {
                s.actions = actions;
            }
        }
        let start = self.unit.transitions.len() as u32;
        self.unit.transitions.reserve(chart.transitions().count());
        let mut labels = std::collections::HashMap::new();
        for t in chart.transitions() {
            if let Some(label) = &t.label
                && let Some(first) = labels.insert(&*label.text, label.at.0)
            {
                self.defined_twice(label, first);
            }
            if let Some(t) = self.transition(id, t) {
                self.unit.transitions.push(t);
            }
        }
        let end = self.unit.transitions.len() as u32;
        if let Some(c) = self.unit.charts.get_mut(id.index()) {
            c.transitions = start..end;
        }
    }

    /// Resolves a transition whose steps all exist. A receptivity that cannot be resolved becomes
    /// FALSE, so that the structure can still be checked.
    #[inline(never)]
    fn transition(&mut self, chart: ChartId, t: &WrittenTransition) -> Option<Transition> {
        // In a chain the preceding steps are written once, as the succeeding steps of the
        // transition before it.
        let from = if t.chained {
            t.from.iter().map(|n| self.scopes.step(chart, &n.text)).collect()
        } else {
            self.steps_named(chart, &t.from)
        };
        let to = self.steps_named(chart, &t.to);
        let receptivity = self.receptivity(&t.receptivity);
        let on_clearing = t.on_clearing.as_ref().map(|b| self.block(b, "")).unwrap_or_default();
        if t.priority == Some(0) {
            let problem =
                Problem::new(&codes::OUT_OF_RANGE, t.at.0, say!("priorities start at 1, the first"));
            self.problems.push(problem);
        }
        Some(Transition {
            label: t.label.as_ref().map(|l| l.text.clone()),
            chart,
            from: from?,
            to: to?,
            receptivity: receptivity.unwrap_or(Expr {
                kind: ExprKind::Const(Value::Bool(false)),
                ty: Type::Bool,
                at: t.receptivity.at.0,
            }),
            priority: t.priority,
            on_clearing,
            at: t.at.0,
        })
    }

    fn steps_named(&mut self, chart: ChartId, names: &[Name]) -> Option<Vec<StepId>> {
        let mut found = Vec::with_capacity(names.len());
        // Every name is looked up, so that each unknown one is reported.
        names.iter().for_each(|n| found.extend(self.step_named(chart, n)));
        (found.len() == names.len()).then_some(found)
    }

    /// A receptivity: a BOOL expression, or the name of a transition section.
    fn receptivity(&mut self, e: &WrittenExpr) -> Option<Expr> {
        let section = match &e.kind {
            Form::Path(p) => self.section_named(p),
            _ => None,
        };
        let Some(section) = section else { return self.condition(e) };
        let at = e.at.0;
        if let Some(first) = self.section_uses.get(&section).copied() {
            let what = say!("this transition section stands at two transitions");
            return self.report(
                Problem::new(&codes::SECTION_SHARED, at, what)
                    .related(first, say!("it stands here first"))
                    .help(say!("read its output in an expression, or write a section for each")),
            );
        }
        self.section_uses.insert(section, at);
        Some(Expr { kind: ExprKind::Section(section), ty: Type::Bool, at })
    }

    fn section_named(&self, p: &Path) -> Option<SectionId> {
        match self.named(&p.names) {
            Some(Entity::Section(s)) => Some(s),
            _ => None,
        }
    }

    #[inline(never)]
    fn action(&mut self, step: StepId, action: &WrittenAction) -> Option<ActionKind> {
        match &action.kind {
            Written::Qualified { qualifier, time, target, condition } => {
                self.qualified_action(*qualifier, time.as_ref(), target, condition.as_ref())
            }
            Written::OnEvent { event, work } => {
                let event = self.condition(event);
                let work = self.work(work);
                Some(ActionKind::OnEvent { event: event?, work })
            }
            Written::EachScan { work, condition } => {
                let work = self.work(work);
                let condition = self.optional(condition.as_ref(), Type::Bool);
                Some(ActionKind::EachScan { work, condition: condition? })
            }
            Written::Order(order) => self.order(step, order, action.at.0),
            Written::Comment(_) => None,
        }
    }

    /// Resolves an expression that may be absent; the outer `None` means that it was written but is
    /// wrong.
    #[allow(clippy::option_option, reason = "absent, or present and wrong")]
    fn optional(&mut self, e: Option<&WrittenExpr>, ty: Type) -> Option<Option<Expr>> {
        match e {
            None => Some(None),
            Some(e) => self.value(e, ty).map(Some),
        }
    }

    fn qualified_action(
        &mut self,
        qualifier: Qualifier,
        time: Option<&WrittenExpr>,
        target: &WrittenTarget,
        condition: Option<&WrittenExpr>,
    ) -> Option<ActionKind> {
        // The parser has reported a time that is missing or not allowed.
        let timed = (time.is_some() == qualifier.timed()).then_some(());
        let time = self.optional(time, Type::Time);
        let condition = self.optional(condition, Type::Bool);
        let governed = match target {
            WrittenTarget::Path(p) => self.governed(p)?,
            WrittenTarget::Element(element) if element.kind == Form::Bad => return None,
            WrittenTarget::Element(element) => {
                let (Form::Element(path, index, None), place) = (&element.kind, element.at.0) else {
                    let what = say!("a bit of an element cannot be driven by an action");
                    let help = say!("assign it: `N w[1].3 := …`");
                    return self.report(Problem::new(&codes::WRONG_KIND, element.at.0, what).help(help));
                };
                match self.element(path, index, place)? {
                    Element::Known(v) => self.boolean_target(v, place)?,
                    Element::Chosen(_, ty, _) => return self.needs_known(ty, place),
                }
            }
            WrittenTarget::Direct(text, place) => {
                let Ref::Var(v) = self.refer_direct(text, place.0)? else {
                    let what = say!("the state of a step cannot be assigned");
                    return self.report(Problem::new(&codes::NOT_WRITABLE, place.0, what));
                };
                self.boolean_target(v, place.0)?
            }
            WrittenTarget::Work(work) => {
                let work = self.work(work);
                timed?;
                let (time, condition) = (time?, condition?);
                return Some(ActionKind::Work { qualifier, time, work, condition });
            }
        };
        timed?;
        let (time, condition) = (time?, condition?);
        Some(match governed {
            Governed::Var(var) => ActionKind::Variable { qualifier, time, var, condition },
            Governed::Body(body) => ActionKind::Named { qualifier, time, body, condition },
        })
    }

    /// A Boolean variable or a named action.
    fn governed(&mut self, p: &Path) -> Option<Governed> {
        if let Some(Entity::Body(b)) = self.named(&p.names) {
            return Some(Governed::Body(b));
        }
        let at = p.names.iter().map(|n| n.at.0).reduce(Span::to).unwrap_or_default();
        match self.refer(&p.names)? {
            Ref::Var(v) => self.boolean_target(v, at),
            Ref::Bit(v, bit) => self.no_bit_here(v, bit, at),
            Ref::Member(..) => {
                let what = say!("`{}` is part of a function block; an action needs a variable", p.text());
                self.report(
                    Problem::new(&codes::WRONG_KIND, at, what)
                        .help(say!("assign it: `N member := TRUE`, or call the block")),
                )
            }
            Ref::Active(_) | Ref::Time(..) => {
                let what = say!("the state of a step cannot be assigned");
                let problem = Problem::new(&codes::NOT_WRITABLE, at, what);
                self.report(problem.help(say!("transitions and forcing orders change it")))
            }
        }
    }

    fn boolean_target(&mut self, v: VarId, at: Span) -> Option<Governed> {
        let var = self.var(v)?;
        let (class, ty, name, declared) = (var.class, var.ty, var.name.clone(), var.at);
        if ty != Type::Bool {
            let what = say!("`{name}` is {ty}; without an assignment an action needs a BOOL");
            let problem = Problem::new(&codes::WRONG_TYPE, at, what).related(declared, say!("declared here"));
            return self.report(problem.help(say!("assign a value: `{name} := …`")));
        }
        self.may_write(v, class, at)?;
        if class == VarClass::Local {
            let what = say!("`{name}` ends with its block; an action needs a variable of the chart");
            return self.report(Problem::new(&codes::NOT_WRITABLE, at, what));
        }
        Some(Governed::Var(v))
    }

    fn order(&mut self, step: StepId, order: &Order, at: Span) -> Option<ActionKind> {
        match order {
            Order::Force(name, situation) => {
                let chart = self.chart_named(name)?;
                Some(ActionKind::Force(chart, self.situation(chart, situation)?))
            }
            Order::Enable(name) => self.chart_named(name).map(ActionKind::Enable),
            Order::Mask(name) => self.mask(name),
            Order::Call(name) => {
                let chart = self.chart_named(name)?;
                let (role, declared) = self.unit.charts.get(chart.index()).map(|c| (c.role.clone(), c.at))?;
                if role != ChartRole::Task {
                    let what = say!("`{}` is not a task", name.text);
                    return self.report(
                        Problem::new(&codes::WRONG_KIND, name.at.0, what)
                            .related(declared, say!("declared here"))
                            .help(say!("a task is written `task {} {{ … }}`", name.text)),
                    );
                }
                if let Some(s) = self.unit.steps.get_mut(step.index()) {
                    s.calls.push((chart, at));
                }
                None
            }
            // Charts were linked earlier.
            Order::Enclose(_) => None,
        }
    }

    fn situation(&mut self, chart: ChartId, situation: &WrittenSituation) -> Option<Situation> {
        Some(match situation {
            WrittenSituation::Init => Situation::Init,
            WrittenSituation::Current => Situation::Current,
            WrittenSituation::Steps(names) => Situation::Steps(self.steps_named(chart, names)?),
        })
    }

    /// Looks for a chart first, then for a variable.
    fn mask(&mut self, name: &Name) -> Option<ActionKind> {
        if let Some(chart) = self.scopes.chart(&name.text) {
            return Some(ActionKind::MaskChart(chart));
        }
        let Ref::Var(v) = self.refer(std::slice::from_ref(name))? else {
            let what = say!("`{}` is no chart and no output", name.text);
            return self.report(Problem::new(&codes::WRONG_KIND, name.at.0, what));
        };
        match self.boolean_target(v, name.at.0)? {
            Governed::Var(v) => Some(ActionKind::MaskVar(v)),
            Governed::Body(_) => None,
        }
    }
}
