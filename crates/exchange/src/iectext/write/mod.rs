//! A document written as one PROGRAM of IEC 61131-3 text.
//!
//! All charts of a document evolve together, so they are networks of one program:
//! each has an initial step of its own. What the standard has no form for is a
//! problem with its place in the document.

mod names;
mod text;

use std::collections::HashMap;

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Body, Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Function, Item, Literal,
    NamedAction, Problem, ProfileName, Qualifier, Span, Step, StepKind, Stmt, Target, Transition, Type,
    UnaryOp, VarDecl, VarKind, Work,
};

use crate::Written;
use names::{Names, Scope, give};
use text::{Writer, time};

/// Constants that are named by constants.
const MOST_CONSTANTS: usize = 20;

/// Writes a document.
pub(crate) fn export(document: &Document) -> Written {
    let names = give(document);
    let mut problems = Vec::new();
    if let Some((at, from, to)) = names.renamed.first() {
        let more = names.renamed.len() - 1;
        let tail = if more > 0 { format!("; {more} more names are changed as well") } else { String::new() };
        let what = format!("`{from}` is called `{to}` there{tail}");
        let mut problem = Problem::new(&codes::RENAMED, *at, what);
        for (at, _, to) in names.renamed.iter().skip(1).take(100) {
            problem.related.push((*at, format!("called `{to}`")));
        }
        problems.push(problem);
    }
    rules(document, &mut problems);
    let program = names.free(document.charts().next().map_or("Main", |c| &*c.name.text));
    let mut exporter =
        Exporter { document, names: &names, problems, functions: String::new(), sections: HashMap::new() };
    let mut text = exporter.program(&program);
    let functions = std::mem::take(&mut exporter.functions);
    if !functions.is_empty() {
        text = format!("{functions}\n{text}");
    }
    if let Some(interval) = exporter.interval() {
        text.push_str(&configuration(&names, &program, interval));
    }
    let mut problems = exporter.problems;
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    Written { text, problems }
}

/// What evolves by other rules there.
fn rules(document: &Document, problems: &mut Vec<Problem>) {
    let Some(profile) = document.profile() else {
        let at = document.charts().next().map_or(Span::default(), |c| c.name.at.0);
        return problems.push(different(at, ProfileName::Iec60848));
    };
    if profile.name != ProfileName::Iec61131 {
        problems.push(different(profile.at.0, profile.name));
    }
    for (_, at) in &profile.switches {
        let what = "this switch is not carried over; there the rules of the standard hold";
        problems.push(Problem::new(&codes::DIFFERENT, at.0, what));
    }
}

fn different(at: Span, profile: ProfileName) -> Problem {
    let what = format!(
        "the chart evolves by the rules of {} and there by those of IEC 61131-3: one transition after the other, one scan each",
        profile.name()
    );
    Problem::new(&codes::DIFFERENT, at, what)
}

/// The resource that runs the program.
fn configuration(names: &Names, program: &str, interval: i64) -> String {
    let name = |wish: &str| names.free(wish);
    let (config, resource, task, instance) = (name("Config"), name("Res"), name("Cycle"), name("Instance"));
    format!(
        "\nCONFIGURATION {config}\n  RESOURCE {resource} ON PLC\n    TASK {task}(INTERVAL := {}, PRIORITY := 0);\n    PROGRAM {instance} WITH {task} : {program};\n  END_RESOURCE\nEND_CONFIGURATION\n",
        time(interval)
    )
}

struct Exporter<'d, 'n> {
    document: &'d Document,
    names: &'n Names,
    problems: Vec<Problem>,
    functions: String,
    /// The conditions of transition sections, by their place and name.
    sections: HashMap<(Scope, Box<str>), Expr>,
}

impl<'d> Exporter<'d, '_> {
    fn lost(&mut self, at: Span, what: &str) {
        self.problems.push(Problem::new(&codes::NOT_CARRIED, at, what));
    }

    fn writer(&mut self, scope: Scope) -> Writer<'_> {
        Writer { names: self.names, scope, locals: Vec::new(), problems: &mut self.problems }
    }

    /// The time of a scan, where the document states it.
    fn interval(&self) -> Option<i64> {
        self.document.items.iter().find_map(|i| if let Item::Cycle(t, _) = i { Some(*t) } else { None })
    }

    fn program(&mut self, name: &str) -> String {
        let document = self.document;
        let mut declarations = Declarations::default();
        let mut body = String::new();
        for item in &document.items {
            self.item(item, &mut declarations, &mut body);
        }
        for (index, chart) in document.charts().enumerate() {
            self.chart(index, chart, &mut declarations, &mut body);
        }
        if body.is_empty() {
            body.push_str("  ;\n");
        }
        format!("PROGRAM {name}\n{}\n{body}END_PROGRAM\n", declarations.text())
    }

    fn item(&mut self, item: &'d Item, declarations: &mut Declarations, body: &mut String) {
        match item {
            Item::Var(decl) => self.declare(None, decl, declarations),
            Item::Action(action) => self.named_action(None, action, body),
            Item::Function(function) => self.function(function),
            Item::Section(s) => self.section(None, s),
            Item::Pre(code, at) | Item::Post(code, at) => self.processing(code, at.0, body),
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Chart(_) | Item::Layout(_) => {}
            Item::Plant(_) | Item::Test(_) | Item::Prove(_) => {}
        }
    }

    /// Without a chart, the program is its statements.
    fn processing(&mut self, code: &Body, at: Span, body: &mut String) {
        if self.document.charts().next().is_some() {
            let what = "processing before and after the charts has no place in a program that is a chart";
            return self.lost(at, what);
        }
        let block = code.block();
        self.writer(None).statements(&block.statements, 1, body);
    }

    fn section(&mut self, scope: Scope, section: &g7_model::Section) {
        match section.body.statements.as_slice() {
            [Stmt { kind: g7_model::StmtKind::Assign { value, .. }, .. }] => {
                self.sections.insert((scope, section.name.text.clone()), value.clone());
            }
            _ => self.lost(section.name.at.0, "a transition section with more than one assignment"),
        }
    }

    fn declare(&mut self, scope: Scope, decl: &VarDecl, out: &mut Declarations) {
        for name in &decl.names {
            let Some(variable) = self.names.variable_of(scope, &name.text) else { continue };
            let (text, ty) = (variable.text.clone(), decl.ty);
            let init = decl.init.as_ref().map(|e| {
                let constant = self.constant(e, MOST_CONSTANTS);
                self.writer(scope).value(&constant, ty)
            });
            let address = decl.address.as_ref().map(|a| &*a.text);
            if let Some(other) = address.filter(|a| !a.starts_with('%')) {
                let what = format!("the channel `{other}` of `{}` is no address of the standard", name.text);
                self.problems.push(Problem::new(&codes::LEFT_OUT, decl.at.0, what));
            }
            if decl.inverted {
                self.lost(decl.at.0, "an inverted channel; write `NOT` where the variable is used");
            }
            if let Some(safe) = &decl.safe {
                let what = "the value after a fault is left out";
                self.problems.push(Problem::new(&codes::LEFT_OUT, safe.at.0, what));
            }
            let address = address.filter(|a| a.starts_with('%'));
            let section = match (decl.kind, address) {
                (VarKind::Const, _) => "VAR CONSTANT",
                (VarKind::Var, Some(_)) if decl.retain => "VAR RETAIN (* at addresses *)",
                (_, Some(_)) => "VAR (* at addresses *)",
                (VarKind::Input, None) => "VAR_INPUT",
                (VarKind::Output, None) => "VAR_OUTPUT",
                (VarKind::Var, None) if decl.retain => "VAR RETAIN",
                (VarKind::Var, None) => "VAR",
            };
            let at = address.map_or(String::new(), |a| format!(" AT {a}"));
            let init = init.map_or(String::new(), |e| format!(" := {e}"));
            let comment = decl.comment.as_ref().map_or(String::new(), |c| format!(" (* {} *)", clean(c)));
            out.add(section, format!("{text}{at} : {}{init};{comment}", type_name(ty)));
        }
    }

    /// An initial value as the standard takes it: a literal.
    fn constant(&mut self, e: &Expr, depth: usize) -> Expr {
        match &e.kind {
            ExprKind::Path(path) if depth > 0 => {
                let named = |v: &&VarDecl| {
                    v.names.iter().any(|n| path.names.last().is_some_and(|p| n.text == p.text))
                };
                let of_file = self
                    .document
                    .items
                    .iter()
                    .filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None });
                let all = of_file.chain(self.document.charts().flat_map(Chart::vars));
                let found =
                    all.filter(|v| v.kind == VarKind::Const).find(named).and_then(|v| v.init.as_ref());
                match found {
                    Some(value) => self.constant(value, depth - 1),
                    None => e.clone(),
                }
            }
            ExprKind::Literal(_) => e.clone(),
            ExprKind::Unary(UnaryOp::Neg, inner) if matches!(inner.kind, ExprKind::Literal(_)) => e.clone(),
            _ => {
                self.lost(e.at.0, "an initial value is one number, text or name of a constant there");
                e.clone()
            }
        }
    }

    fn function(&mut self, function: &'d Function) {
        let Some(own) = self.names.function(&function.name.text) else { return };
        let mut text = format!("FUNCTION {} : {}\n", own.text, type_name(function.result));
        let mut locals: Vec<(Box<str>, Type)> = vec![(own.text.clone().into(), function.result)];
        locals.extend(function.params.iter().map(|p| (p.name.text.clone(), p.ty)));
        if !function.params.is_empty() {
            text.push_str("  VAR_INPUT\n");
            for p in &function.params {
                text.push_str(&format!("    {} : {};\n", p.name.text, type_name(p.ty)));
            }
            text.push_str("  END_VAR\n");
        }
        let own_locals = &function.body.locals;
        if !own_locals.is_empty() {
            text.push_str("  VAR\n");
            for l in own_locals {
                let init = l.init.as_ref().map(|e| self.writer(None).value(e, l.ty));
                for name in &l.names {
                    let init = init.as_ref().map_or(String::new(), |e| format!(" := {e}"));
                    text.push_str(&format!("    {} : {}{init};\n", name.text, type_name(l.ty)));
                    locals.push((name.text.clone(), l.ty));
                }
            }
            text.push_str("  END_VAR\n");
        }
        let mut writer = self.writer(None);
        writer.locals = locals;
        writer.statements(&function.body.statements, 1, &mut text);
        text.push_str("END_FUNCTION\n\n");
        self.functions.push_str(&text);
    }

    fn named_action(&mut self, scope: Scope, action: &'d NamedAction, body: &mut String) {
        let Some(name) = self.names.action_of(scope, &action.name.text).map(str::to_string) else { return };
        let block = action.body.block();
        if let Some(local) = block.locals.first() {
            self.lost(local.at.0, "an action has no variables of its own there");
        }
        self.action_block(scope, &name, &block.statements, None, body);
    }

    /// `ACTION name: … END_ACTION`.
    fn action_block(
        &mut self,
        scope: Scope,
        name: &str,
        list: &[Stmt],
        condition: Option<&Expr>,
        out: &mut String,
    ) {
        out.push_str(&format!("  ACTION {name}:\n"));
        let mut writer = self.writer(scope);
        match condition {
            Some(c) => {
                let c = writer.condition(c);
                out.push_str(&format!("    IF {c} THEN\n"));
                writer.statements(list, 3, out);
                out.push_str("    END_IF;\n");
            }
            None if list.is_empty() => out.push_str("    ;\n"),
            None => writer.statements(list, 2, out),
        }
        out.push_str("  END_ACTION\n");
    }

    fn chart(&mut self, index: usize, chart: &'d Chart, declarations: &mut Declarations, out: &mut String) {
        let scope = Some(index);
        if chart.kind != ChartKind::Chart {
            self.lost(chart.name.at.0, "expansions and tasks have no counterpart there");
        }
        if let Some(every) = chart.every.filter(|e| Some(*e) != self.interval()) {
            let what = format!("the chart's own period, {}, is not carried over", time(every));
            self.lost(chart.name.at.0, &what);
        }
        for item in &chart.items {
            match item {
                ChartItem::Var(decl) => self.declare(scope, decl, declarations),
                ChartItem::Section(s) => self.section(scope, s),
                _ => {}
            }
        }
        if let Some(comment) = &chart.comment {
            out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        for item in &chart.items {
            match item {
                ChartItem::Step(step) => self.step(index, step, out),
                ChartItem::Transition(t) => self.transition(index, t, out),
                ChartItem::Action(a) => self.named_action(scope, a, out),
                ChartItem::Pre(code, at) | ChartItem::Post(code, at) => self.processing(code, at.0, out),
                ChartItem::Var(_) | ChartItem::Section(_) => {}
            }
        }
    }

    fn step(&mut self, index: usize, step: &'d Step, out: &mut String) {
        let Some(name) = self.names.step_in(index, &step.name.text).map(str::to_string) else { return };
        match &step.kind {
            StepKind::Plain => {}
            StepKind::Entry | StepKind::Exit => {}
            StepKind::Macro(_) => self.lost(step.name.at.0, "a macro-step has no counterpart there"),
            StepKind::Enclosing => self.lost(step.name.at.0, "an enclosing step has no counterpart there"),
        }
        if let Some(comment) = &step.comment {
            out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
        let mut lines = String::new();
        let mut bodies = String::new();
        for (number, action) in step.actions.iter().enumerate() {
            self.action(index, &name, number, action, &mut lines, &mut bodies);
        }
        out.push_str(&format!("  {word} {name}:\n{lines}  END_STEP\n{bodies}"));
    }

    fn action(
        &mut self,
        index: usize,
        step: &str,
        number: usize,
        action: &'d Action,
        lines: &mut String,
        bodies: &mut String,
    ) {
        let at = action.at.0;
        let scope = Some(index);
        match &action.kind {
            ActionKind::Qualified { qualifier, time, target, condition } => {
                let time = time.as_ref().map(|t| self.writer(scope).text(t).text);
                let name = match target {
                    Target::Path(path) => self.target(scope, path, condition.as_ref()),
                    Target::Direct(name, at) => self.direct_target(name, at.0, condition.as_ref()),
                    Target::Work(work) => {
                        Some(self.anonymous(scope, step, number, work, condition.as_ref(), bodies))
                    }
                };
                if let Some(name) = name {
                    lines.push_str(&association(&name, *qualifier, time.as_deref()));
                }
            }
            ActionKind::EachScan { work, condition } => {
                let name = self.anonymous(scope, step, number, work, condition.as_ref(), bodies);
                lines.push_str(&association(&name, Qualifier::N, None));
            }
            ActionKind::OnEvent { .. } => {
                self.lost(at, "an action on an event has no form in an SFC of the standard")
            }
            ActionKind::Order(_) => {
                self.lost(at, "an order to another chart has no form in an SFC of the standard")
            }
            ActionKind::Comment(text) => lines.push_str(&format!("    (* {} *)\n", clean(text))),
        }
    }

    /// A named action, or a Boolean variable.
    fn target(&mut self, scope: Scope, path: &g7_model::Path, condition: Option<&Expr>) -> Option<String> {
        if let Some(c) = condition {
            self.lost(c.at.0, "a condition of an action has no form in an SFC of the standard");
        }
        if let [name] = path.names.as_slice()
            && let Some(action) = self.names.action_of(scope, &name.text)
        {
            return Some(action.to_string());
        }
        let at = path.names.first().map_or(Span::default(), |n| n.at.0);
        let e = Expr { kind: ExprKind::Path(path.clone()), at: at.into() };
        let text = self.writer(scope).text(&e).text;
        if text.contains('.') {
            self.lost(at, "what a step drives is a variable or a named action");
            return None;
        }
        Some(text)
    }

    fn direct_target(&mut self, name: &str, at: Span, condition: Option<&Expr>) -> Option<String> {
        if let Some(c) = condition {
            self.lost(c.at.0, "a condition of an action has no form in an SFC of the standard");
        }
        match self.names.at_address(name) {
            Some(variable) => Some(variable.to_string()),
            None => {
                self.lost(at, "what a step drives has a name; declare a variable at this address");
                None
            }
        }
    }

    /// An action without a name gets that of its step.
    fn anonymous(
        &mut self,
        scope: Scope,
        step: &str,
        number: usize,
        work: &'d Work,
        condition: Option<&Expr>,
        bodies: &mut String,
    ) -> String {
        let name = self.names.free(&format!("{step}_{}", number + 1));
        if let Work::Block(block) = work
            && let Some(local) = block.locals.first()
        {
            self.lost(local.at.0, "an action has no variables of its own there");
        }
        self.action_block(scope, &name, work.statements(), condition, bodies);
        name
    }

    fn transition(&mut self, index: usize, t: &'d Transition, out: &mut String) {
        let scope = Some(index);
        if t.from.is_empty() || t.to.is_empty() {
            return self.lost(t.at.0, "a source or sink transition has no form in the standard");
        }
        if let Some(block) = &t.on_clearing {
            self.lost(block.at.0, "an action on clearing has no form in the standard");
        }
        if let Some(comment) = &t.comment {
            out.push_str(&format!("  (* {} *)\n", clean(comment)));
        }
        let label = t.label.as_ref().map_or(String::new(), |l| format!(" {}", self.names.free(&l.text)));
        let priority = t.priority.map_or(String::new(), |p| format!(" (PRIORITY := {p})"));
        let steps = |list: &[g7_model::Name]| -> String {
            let names: Vec<&str> =
                list.iter().map(|n| self.names.step_in(index, &n.text).unwrap_or(&n.text)).collect();
            match names.as_slice() {
                [one] => (*one).to_string(),
                _ => format!("({})", names.join(", ")),
            }
        };
        let (from, to) = (steps(&t.from), steps(&t.to));
        let receptivity = self.receptivity(scope, &t.receptivity);
        let condition = self.writer(scope).condition(&receptivity);
        out.push_str(&format!(
            "  TRANSITION{label}{priority} FROM {from} TO {to}\n    := {condition};\n  END_TRANSITION\n"
        ));
    }

    /// A receptivity that is the name of a section is that section's condition.
    fn receptivity(&self, scope: Scope, e: &Expr) -> Expr {
        if let ExprKind::Path(path) = &e.kind
            && let [name] = path.names.as_slice()
        {
            let of = |scope: Scope| self.sections.get(&(scope, name.text.clone()));
            if let Some(section) = of(scope).or_else(|| of(None)) {
                return section.clone();
            }
        }
        if let ExprKind::Literal(Literal::Int(n, None)) = e.kind {
            return Expr { kind: ExprKind::Literal(Literal::Bool(n != 0)), at: e.at };
        }
        e.clone()
    }
}

fn association(name: &str, qualifier: Qualifier, time: Option<&str>) -> String {
    let time = time.map_or(String::new(), |t| format!(", {t}"));
    format!("    {name}({}{time});\n", qualifier.name())
}

/// A comment cannot end within itself.
fn clean(text: &str) -> String {
    text.replace("*)", "* )").replace("(*", "( *").replace(['\n', '\r'], " ")
}

fn type_name(ty: Type) -> String {
    match ty {
        Type::String(80) => "STRING".to_string(),
        Type::String(n) => format!("STRING[{n}]"),
        other => other.to_string(),
    }
}

/// The sections of declarations, in the order in which they were met.
#[derive(Default)]
struct Declarations {
    sections: Vec<(&'static str, Vec<String>)>,
}

impl Declarations {
    fn add(&mut self, section: &'static str, line: String) {
        match self.sections.last_mut().filter(|(s, _)| *s == section) {
            Some((_, lines)) => lines.push(line),
            None => self.sections.push((section, vec![line])),
        }
    }

    fn text(&self) -> String {
        let mut out = String::new();
        for (section, lines) in &self.sections {
            out.push_str(&format!("  {section}\n"));
            for line in lines {
                out.push_str(&format!("    {line}\n"));
            }
            out.push_str("  END_VAR\n");
        }
        out
    }
}
