//! Named actions, PRE and POST, transition sections and functions.

use g7_model::{
    Body as WrittenBody, ChartItem, Document, Function as WrittenFunction, Item, NamedAction, Problem, Said,
    Section as WrittenSection, Span, Type, codes, say,
};

use super::resolver::{Frame, Resolver, Role};
use super::scopes::Entity;
use crate::circles::closing_calls;
use crate::ir::{Body, BodyId, ChartId, Function, FunctionId, Section, SectionId, Stmt, VarClass};

impl<'d> Resolver<'_, 'd> {
    /// Declares the row and the name of a named action.
    pub(super) fn declare_action(&mut self, chart: Option<ChartId>, action: &'d NamedAction) {
        let id = BodyId(self.unit.bodies.len() as u32);
        self.define(chart, &action.name, Entity::Body(id));
        let name = self.qualified(chart, &action.name.text);
        self.unit.bodies.push(Body { name, chart, statements: Vec::new(), at: action.name.at.0 });
    }

    /// Declares the row, the name and the output of a transition section.
    pub(super) fn declare_section(&mut self, chart: Option<ChartId>, section: &'d WrittenSection) {
        let id = SectionId(self.unit.sections.len() as u32);
        let name = self.qualified(chart, &section.name.text);
        let at = section.name.at.0;
        self.define(chart, &section.name, Entity::Section(id));
        let output = self.add_var(name.clone(), VarClass::Internal, Type::Bool, at);
        self.scopes.section_outputs.insert(output);
        self.unit.sections.push(Section { name, output, statements: Vec::new(), at });
    }

    /// Declares the row, the name, the inputs and the result of a function.
    pub(super) fn declare_function(&mut self, function: &'d WrittenFunction) {
        let id = FunctionId(self.unit.functions.len() as u32);
        let at = function.name.at.0;
        self.define(None, &function.name, Entity::Function(id));
        let name = &function.name.text;
        let mut params = Vec::new();
        for p in &function.params {
            self.plain_type(p.ty.base, p.name.at.0, say!("an input"));
            let qualified = format!("{name}.{}", p.name.text).into();
            params.push(self.add_var(qualified, VarClass::Local, p.ty.base, p.name.at.0));
        }
        self.plain_type(function.result.base, at, say!("the result"));
        let result = self.add_var(name.clone(), VarClass::Local, function.result.base, at);
        self.scopes.params.push(function.params.iter().map(|p| &*p.name.text).collect());
        self.unit.functions.push(Function { name: name.clone(), params, result, statements: Vec::new(), at });
    }

    fn plain_type(&mut self, ty: Type, at: Span, what: Said) {
        if let Type::Fb(kind) = ty {
            let what = say!("{what} of a function cannot be a {}", kind);
            self.problems.push(Problem::new(&codes::BAD_DECLARATION, at, what));
        } else {
            let _ = self.fitting_string(ty, at);
        }
    }

    /// Resolves all code outside of steps, in the order of declaration.
    #[inline(never)]
    pub(super) fn fill_bodies(&mut self, doc: &'d Document) {
        let mut next = Next::default();
        for item in &doc.items {
            match item {
                Item::Action(a) => self.fill_action(&mut next, None, a),
                Item::Section(s) => self.fill_section(&mut next, None, s),
                Item::Function(f) => self.fill_function(&mut next, f),
                Item::Pre(body, at) => self.fill_processing(None, body, at.0, true),
                Item::Post(body, at) => self.fill_processing(None, body, at.0, false),
                _ => {}
            }
        }
        for (k, chart) in doc.charts().enumerate() {
            let id = Some(ChartId(k as u32));
            for item in &chart.items {
                match item {
                    ChartItem::Action(a) => self.fill_action(&mut next, id, a),
                    ChartItem::Section(s) => self.fill_section(&mut next, id, s),
                    ChartItem::Pre(body, at) => self.fill_processing(id, body, at.0, true),
                    ChartItem::Post(body, at) => self.fill_processing(id, body, at.0, false),
                    ChartItem::Var(_) | ChartItem::Step(_) | ChartItem::Transition(_) => {}
                }
            }
        }
        self.in_text_order();
        self.forbid_recursion();
    }

    fn fill_action(&mut self, next: &mut Next, chart: Option<ChartId>, action: &NamedAction) {
        let id = BodyId(next.bodies);
        next.bodies += 1;
        let name = self.qualified(chart, &action.name.text);
        let statements = self.in_chart(chart, |r| r.body(&action.body, &name));
        if let Some(b) = self.unit.bodies.get_mut(id.index()) {
            b.statements = statements;
        }
    }

    fn fill_section(&mut self, next: &mut Next, chart: Option<ChartId>, section: &WrittenSection) {
        let id = SectionId(next.sections);
        next.sections += 1;
        let name = self.qualified(chart, &section.name.text);
        let frame = Frame { chart, role: Role::Section(id), ..Frame::default() };
        let statements = self.within(frame, |r| r.block(&section.body, &name));
        if let Some(s) = self.unit.sections.get_mut(id.index()) {
            s.statements = statements;
        }
    }

    fn fill_function(&mut self, next: &mut Next, function: &WrittenFunction) {
        let id = FunctionId(next.functions);
        next.functions += 1;
        let Some(row) = self.unit.functions.get(id.index()) else { return };
        let (params, result) = (row.params.clone(), row.result);
        let mut frame = Frame { role: Role::Function(id), ..Frame::default() };
        frame.locals.insert(function.name.text.clone(), result);
        for (p, v) in function.params.iter().zip(params) {
            if let Some(first) = frame.locals.insert(p.name.text.clone(), v).and_then(|f| self.var(f)) {
                let first = first.at;
                self.defined_twice(&p.name, first);
            }
        }
        let statements = self.within(frame, |r| r.block(&function.body, &function.name.text));
        if let Some(f) = self.unit.functions.get_mut(id.index()) {
            f.statements = statements;
        }
    }

    fn fill_processing(&mut self, chart: Option<ChartId>, body: &WrittenBody, at: Span, pre: bool) {
        let name = self.qualified(chart, if pre { "pre" } else { "post" });
        let statements = self.in_chart(chart, |r| {
            r.frame.pre = pre;
            r.body(body, &name)
        });
        let body = Body { name, chart, statements, at };
        if pre { self.unit.pre.push(body) } else { self.unit.post.push(body) }
    }

    /// PRE and POST sections of the file were read first; they run in the order of the text.
    fn in_text_order(&mut self) {
        self.unit.pre.sort_by_key(|b| b.at);
        self.unit.post.sort_by_key(|b| b.at);
    }

    fn body(&mut self, body: &WrittenBody, owner: &str) -> Vec<Stmt> {
        self.block(body.block(), owner)
    }

    /// Reports functions that call themselves, directly or through others: they would need an
    /// unbounded stack.
    fn forbid_recursion(&mut self) {
        let count = self.unit.functions.len();
        let mut callees: Vec<Vec<(usize, Span)>> = vec![Vec::new(); count];
        for (from, to, at) in std::mem::take(&mut self.calls) {
            if let Some(list) = callees.get_mut(from.index()) {
                list.push((to.index(), at));
            }
        }
        for (function, at) in closing_calls(&callees) {
            self.recursion(function, at);
        }
    }

    /// The function loses its statements, so that no later stage follows the circle.
    fn recursion(&mut self, function: usize, at: Span) {
        let Some(f) = self.unit.functions.get_mut(function) else { return };
        f.statements.clear();
        let (name, declared) = (f.name.clone(), f.at);
        self.problems.push(
            Problem::new(&codes::RECURSION, at, say!("`{name}` is called while it is being computed"))
                .related(declared, say!("declared here"))
                .help(say!("a function cannot call itself, nor one that calls it; use a loop")),
        );
    }

    /// Reports sections that no transition uses.
    #[inline(never)]
    pub(super) fn unused_sections(&mut self) {
        for (k, s) in self.unit.sections.iter().enumerate() {
            if self.section_uses.contains_key(&SectionId(k as u32)) {
                continue;
            }
            let read = self.unit.transitions.iter().find_map(|t| read_at(&t.receptivity, s.output));
            if let Some(at) = read {
                let what = say!("`{}` stays FALSE here: no transition runs this section", s.name);
                self.problems.push(
                    Problem::new(&codes::SECTION_READ, at, what)
                        .related(s.at, say!("the section is declared here"))
                        .help(say!("a section is the whole receptivity of one transition; write a `function`, or its expression")),
                );
                continue;
            }
            let what = say!("no transition uses the section `{}`, so it never runs", s.name);
            self.problems.push(
                Problem::new(&codes::SECTION_UNUSED, s.at, what)
                    .help(say!("name it as the receptivity of one transition: `when …`")),
            );
        }
    }
}

/// The place where an expression reads a variable.
fn read_at(e: &crate::ir::Expr, v: crate::ir::VarId) -> Option<Span> {
    match &e.kind {
        crate::ir::ExprKind::Var(x) if *x == v => Some(e.at),
        _ => e.operands().find_map(|e| read_at(e, v)),
    }
}

/// The rows to fill next; bodies are resolved in the order of their declaration.
#[derive(Default)]
struct Next {
    bodies: u32,
    sections: u32,
    functions: u32,
}
