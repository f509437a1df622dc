//! Reduces a failing chart and its script as long as they still fail.

use g7_model::{
    Action, ActionKind, Block, Body, ChartItem, Document, Expr, ExprKind, Item, Literal, Situation, Stmt,
    StmtKind, Target, Work,
};

use crate::generate::{Event, Script};

/// True if a chart still fails with a script.
pub type Fails<'a> = &'a dyn Fn(&Document, &Script) -> bool;

/// Removes everything that can be removed while `fails` holds.
pub fn shrink(doc: &Document, script: &Script, fails: Fails<'_>) -> (Document, Script) {
    let (mut doc, mut script) = (doc.clone(), script.clone());
    loop {
        let mut smaller = false;
        smaller |= shorter_script(&doc, &mut script, fails);
        for part in [Part::Items, Part::Statements, Part::Expressions] {
            smaller |= fewer(&mut doc, &script, fails, part);
        }
        if !smaller {
            return (doc, script);
        }
    }
}

fn shorter_script(doc: &Document, script: &mut Script, fails: Fails<'_>) -> bool {
    let mut smaller = false;
    // From the end, because the events after the failure do not matter.
    let mut chunk = script.len() / 2;
    while chunk > 0 {
        let mut at = script.len().saturating_sub(chunk);
        loop {
            let end = (at + chunk).min(script.len());
            let mut less = script.clone();
            less.drain(at..end);
            if at < end && fails(doc, &less) {
                *script = less;
                smaller = true;
            }
            if at == 0 {
                break;
            }
            at = at.saturating_sub(chunk);
        }
        chunk /= 2;
    }
    for i in 0..script.len() {
        let Event::Scan { inputs, .. } = &script[i] else { continue };
        for name in inputs.keys().cloned().collect::<Vec<_>>() {
            let mut less = script.clone();
            if let Event::Scan { inputs, .. } = &mut less[i] {
                inputs.remove(&name);
            }
            if fails(doc, &less) {
                *script = less;
                smaller = true;
            }
        }
    }
    smaller
}

#[derive(Clone, Copy)]
enum Part {
    Items,
    Statements,
    Expressions,
}

/// Tries each place once, from the last to the first.
fn fewer(doc: &mut Document, script: &Script, fails: Fails<'_>, part: Part) -> bool {
    let mut smaller = false;
    for variant in 0..3 {
        let mut at = cut(&mut doc.clone(), part, usize::MAX, variant);
        while at > 0 {
            at -= 1;
            let mut less = doc.clone();
            cut(&mut less, part, at, variant);
            if less != *doc && fails(&less, script) {
                *doc = less;
                smaller = true;
            }
        }
    }
    smaller
}

/// Cuts the place with this number in one of several ways; returns the number of places.
fn cut(doc: &mut Document, part: Part, number: usize, variant: usize) -> usize {
    let mut cutter = Cutter { at: 0, number, variant };
    match part {
        Part::Items => cutter.items(doc),
        Part::Statements => bodies(doc, &mut |b| cutter.statements(b)),
        Part::Expressions => expressions(doc, &mut |e| cutter.expression(e)),
    }
    cutter.at
}

struct Cutter {
    at: usize,
    number: usize,
    variant: usize,
}

impl Cutter {
    fn hit(&mut self) -> bool {
        self.at += 1;
        self.at == self.number.wrapping_add(1)
    }

    fn list<T>(&mut self, list: &mut Vec<T>) {
        let mut i = 0;
        while i < list.len() {
            if self.hit() {
                list.remove(i);
            } else {
                i += 1;
            }
        }
    }

    fn items(&mut self, doc: &mut Document) {
        self.list(&mut doc.items);
        for item in &mut doc.items {
            match item {
                Item::Chart(chart) => {
                    self.list(&mut chart.items);
                    for item in &mut chart.items {
                        match item {
                            ChartItem::Step(step) => {
                                self.list(&mut step.actions);
                                for action in &mut step.actions {
                                    self.action(action);
                                }
                            }
                            ChartItem::Transition(t) => {
                                if t.from.len() > 1 {
                                    self.list(&mut t.from);
                                }
                                if t.to.len() > 1 {
                                    self.list(&mut t.to);
                                }
                                if self.hit() {
                                    t.on_clearing = None;
                                }
                                if self.hit() {
                                    t.priority = None;
                                }
                            }
                            _ => {}
                        }
                    }
                    if self.hit() {
                        chart.every = None;
                    }
                }
                Item::Profile(p) => self.list(&mut p.switches),
                Item::Var(v) if v.names.len() > 1 => self.list(&mut v.names),
                Item::Var(v) => {
                    if self.hit() {
                        v.init = None;
                    }
                    if self.hit() {
                        v.safe = None;
                        v.retain = false;
                    }
                }
                _ => {}
            }
        }
    }

    fn action(&mut self, action: &mut Action) {
        match &mut action.kind {
            ActionKind::Qualified { condition, .. } | ActionKind::EachScan { condition, .. }
                if self.hit() =>
            {
                *condition = None;
            }
            ActionKind::Order(g7_model::Order::Force(_, Situation::Steps(names))) => self.list(names),
            _ => {}
        }
    }

    /// Removes a statement, or replaces it by a part of it.
    fn statements(&mut self, list: &mut Vec<Stmt>) {
        let mut i = 0;
        while i < list.len() {
            if self.hit() {
                let inner = match (&list[i].kind, self.variant) {
                    (StmtKind::If(branches, _), 1) => branches.first().map(|b| b.1.clone()),
                    (StmtKind::If(_, otherwise), 2) => Some(otherwise.clone()),
                    (StmtKind::Case(_, arms, _), 1) => arms.first().map(|a| a.body.clone()),
                    (StmtKind::Case(.., otherwise), 2) => Some(otherwise.clone()),
                    (
                        StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _),
                        1,
                    ) => Some(body.clone()),
                    _ => None,
                };
                list.splice(i..=i, inner.unwrap_or_default());
            } else {
                i += 1;
            }
        }
    }

    /// Replaces an operation by an operand or a constant.
    fn expression(&mut self, e: &mut Expr) {
        if !self.hit() {
            return;
        }
        let inner = match (&e.kind, self.variant) {
            (ExprKind::Unary(_, a), 0) | (ExprKind::Binary(_, a, _), 0) => Some((**a).clone()),
            (ExprKind::Binary(_, _, b), 1) => Some((**b).clone()),
            (ExprKind::Timer { e, .. }, 0) => Some((**e).clone()),
            (ExprKind::Call(_, args), 0) => args.first().map(|a| a.value.clone()),
            (ExprKind::Unary(..) | ExprKind::Binary(..) | ExprKind::Path(_) | ExprKind::Timer { .. }, 2) => {
                Some(Expr { kind: ExprKind::Literal(Literal::Bool(true)), at: e.at })
            }
            _ => None,
        };
        if let Some(inner) = inner {
            *e = inner;
        }
    }
}

type OnStatements<'a> = &'a mut dyn FnMut(&mut Vec<Stmt>);
type OnExpr<'a> = &'a mut dyn FnMut(&mut Expr);

fn bodies(doc: &mut Document, visit: OnStatements<'_>) {
    each_block(doc, &mut |b| nested(b, visit));
}

fn nested(list: &mut Vec<Stmt>, visit: OnStatements<'_>) {
    visit(list);
    for s in list {
        match &mut s.kind {
            StmtKind::If(branches, otherwise) => {
                branches.iter_mut().for_each(|b| nested(&mut b.1, visit));
                nested(otherwise, visit);
            }
            StmtKind::Case(_, arms, otherwise) => {
                arms.iter_mut().for_each(|a| nested(&mut a.body, visit));
                nested(otherwise, visit);
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                nested(body, visit)
            }
            StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit | StmtKind::Return => {}
        }
    }
}

/// Visits every list of statements in braces.
fn each_block(doc: &mut Document, visit: OnStatements<'_>) {
    let of_body = |b: &mut Body, visit: OnStatements<'_>| {
        if let Body::St(b) = b {
            visit(&mut b.statements);
        }
    };
    for item in &mut doc.items {
        match item {
            Item::Action(a) => of_body(&mut a.body, visit),
            Item::Section(s) => visit(&mut s.body.statements),
            Item::Function(f) => visit(&mut f.body.statements),
            Item::Pre(b, _) | Item::Post(b, _) => of_body(b, visit),
            Item::Chart(chart) => {
                for item in &mut chart.items {
                    match item {
                        ChartItem::Step(step) => {
                            step.actions
                                .iter_mut()
                                .filter_map(work_of)
                                .for_each(|b| visit(&mut b.statements));
                        }
                        ChartItem::Transition(t) => {
                            t.on_clearing.iter_mut().for_each(|b| visit(&mut b.statements));
                        }
                        ChartItem::Pre(b, _) | ChartItem::Post(b, _) => of_body(b, visit),
                        ChartItem::Action(a) => of_body(&mut a.body, visit),
                        ChartItem::Section(s) => visit(&mut s.body.statements),
                        ChartItem::Var(_) => {}
                    }
                }
            }
            _ => {}
        }
    }
}

fn work_of(action: &mut Action) -> Option<&mut Block> {
    match &mut action.kind {
        ActionKind::Qualified { target: Target::Work(Work::Block(b)), .. }
        | ActionKind::OnEvent { work: Work::Block(b), .. }
        | ActionKind::EachScan { work: Work::Block(b), .. } => Some(b),
        _ => None,
    }
}

/// Visits every expression, outer ones before those inside.
fn expressions(doc: &mut Document, visit: OnExpr<'_>) {
    each_block(doc, &mut |list| list.iter_mut().for_each(|s| statement(s, visit)));
    for item in &mut doc.items {
        let Item::Chart(chart) = item else { continue };
        for item in &mut chart.items {
            match item {
                ChartItem::Transition(t) => expr(&mut t.receptivity, visit),
                ChartItem::Step(step) => {
                    for action in &mut step.actions {
                        match &mut action.kind {
                            ActionKind::Qualified { condition, target, .. } => {
                                condition.iter_mut().for_each(|e| expr(e, visit));
                                if let Target::Work(Work::Single(s)) = target {
                                    statement(s, visit);
                                }
                            }
                            ActionKind::EachScan { condition, work } => {
                                condition.iter_mut().for_each(|e| expr(e, visit));
                                if let Work::Single(s) = work {
                                    statement(s, visit);
                                }
                            }
                            ActionKind::OnEvent { event, work } => {
                                expr(event, visit);
                                if let Work::Single(s) = work {
                                    statement(s, visit);
                                }
                            }
                            ActionKind::Order(_) | ActionKind::Comment(_) => {}
                        }
                    }
                }
                _ => {}
            }
        }
    }
}

fn statement(s: &mut Stmt, visit: OnExpr<'_>) {
    let all = |list: &mut Vec<Stmt>, visit: OnExpr<'_>| list.iter_mut().for_each(|s| statement(s, visit));
    match &mut s.kind {
        StmtKind::Assign { value, .. } => expr(value, visit),
        StmtKind::Call(_, args) => {
            args.iter_mut().filter(|a| !a.output).for_each(|a| expr(&mut a.value, visit))
        }
        StmtKind::If(branches, otherwise) => {
            for (condition, body) in branches {
                expr(condition, visit);
                all(body, visit);
            }
            all(otherwise, visit);
        }
        StmtKind::Case(selector, arms, otherwise) => {
            expr(selector, visit);
            arms.iter_mut().for_each(|a| all(&mut a.body, visit));
            all(otherwise, visit);
        }
        StmtKind::For { from, to, body, .. } => {
            expr(from, visit);
            expr(to, visit);
            all(body, visit);
        }
        StmtKind::While(condition, body) => {
            expr(condition, visit);
            all(body, visit);
        }
        StmtKind::Repeat(body, until) => {
            all(body, visit);
            expr(until, visit);
        }
        StmtKind::Exit | StmtKind::Return => {}
    }
}

fn expr(e: &mut Expr, visit: OnExpr<'_>) {
    visit(e);
    match &mut e.kind {
        ExprKind::Unary(_, a) => expr(a, visit),
        ExprKind::Binary(_, a, b) => {
            expr(a, visit);
            expr(b, visit);
        }
        ExprKind::Timer { e, .. } => expr(e, visit),
        ExprKind::Call(_, args) => args.iter_mut().for_each(|a| expr(&mut a.value, visit)),
        ExprKind::Element(_, index, _) => index.iter_mut().for_each(|e| expr(e, visit)),
        ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| expr(e, visit)),
        ExprKind::Literal(_) | ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
    }
}
