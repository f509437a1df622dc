//! Reads the units and configurations of a file.

use g7_model::codes;
use g7_model::{Expr, ExprKind, Literal, Name, Nanos, Qualifier, Stmt, StmtKind, say};

use super::unit::{Association, Instance, Part, Resource, Source, Task, Transition, Unit, UnitKind};
use crate::st::{Kind, Parser};
use crate::words::closes;

/// Reads the whole file.
pub(super) fn source(p: &mut Parser) -> Source {
    let mut source = Source::default();
    while !p.at_end() {
        let before = p.mark();
        if p.at_word("TYPE") {
            p.type_block(&mut source.types);
        } else if !p.declarations(&mut source.types, &mut source.globals) {
            item(p, &mut source);
        }
        if p.mark() == before {
            p.expected(say!("PROGRAM, FUNCTION_BLOCK, FUNCTION, CONFIGURATION or TYPE"));
            p.bump();
            p.skip_to(&["PROGRAM", "FUNCTION_BLOCK", "FUNCTION", "CONFIGURATION", "TYPE", "VAR_GLOBAL"]);
        }
    }
    source
}

fn item(p: &mut Parser, source: &mut Source) {
    match p.word().as_str() {
        "PROGRAM" => unit(p, UnitKind::Program, source),
        "FUNCTION_BLOCK" => unit(p, UnitKind::FunctionBlock, source),
        "FUNCTION" => unit(p, UnitKind::Function, source),
        "CONFIGURATION" => configuration(p, source),
        "RESOURCE" => resource(p, source),
        "NAMESPACE" => {
            p.bump();
            p.name(say!("the name of a namespace"));
        }
        "END_NAMESPACE" | "END_PROGRAM" | "END_FUNCTION_BLOCK" | "END_FUNCTION" => {
            if p.word() != "END_NAMESPACE" {
                p.expected(say!("the beginning of a unit"));
            }
            p.bump();
            p.eat(";");
        }
        // Some tools write a chart without a unit around it.
        "INITIAL_STEP" | "STEP" | "TRANSITION" | "ACTION" => {
            let start = p.token().start;
            let name = Name::new("Chart", p.span_of(p.token()));
            let mut unit = Unit::new(UnitKind::Program, name, p.since(start));
            unit.vars = std::mem::take(&mut source.globals);
            while part(p, &mut unit) {}
            unit.at = p.since(start);
            source.units.push(unit);
        }
        _ => {}
    }
}

fn unit(p: &mut Parser, kind: UnitKind, source: &mut Source) {
    let start = p.bump().start;
    let closing = match kind {
        UnitKind::Program => "END_PROGRAM",
        UnitKind::FunctionBlock => "END_FUNCTION_BLOCK",
        UnitKind::Function => "END_FUNCTION",
    };
    while matches!(p.word().as_str(), "FINAL" | "ABSTRACT" | "PUBLIC" | "PRIVATE" | "INTERNAL")
        && p.ahead(1).kind == Kind::Word
    {
        p.bump();
    }
    let Some(name) = p.name(say!("the name of the unit")) else { return };
    let result =
        if kind == UnitKind::Function && p.eat(":") { p.result(&name, &mut source.types) } else { None };
    for word in ["EXTENDS", "IMPLEMENTS"] {
        if p.at_word(word) {
            let at = p.here();
            p.say(&codes::NOT_CARRIED, &at, say!("`{word}`: units that build on others have no counterpart"));
            p.bump();
            p.bump();
        }
    }
    let mut unit = Unit { result, ..Unit::new(kind, name, p.since(start)) };
    p.of_function = kind == UnitKind::Function;
    loop {
        let before = p.mark();
        while p.eat(";") {}
        if p.declarations(&mut source.types, &mut unit.vars) || part(p, &mut unit) {
            continue;
        }
        if p.at_end() || closes(&p.word()) {
            break;
        }
        body(p, &mut unit);
        if p.mark() == before {
            p.expected(say!("`{closing}`"));
            p.bump();
        }
    }
    p.of_function = false;
    unit.foreign = p.foreign(start);
    if p.word() != closing && closes(&p.word()) && !p.at_end() {
        p.expected(say!("`{closing}`"));
        p.skip_to(&[closing, "PROGRAM", "FUNCTION_BLOCK", "FUNCTION", "CONFIGURATION"]);
        p.eat_word(closing);
    } else {
        p.expect_word(closing);
    }
    p.eat(";");
    unit.at = p.since(start);
    source.units.push(unit);
}

/// Statements of the unit itself.
fn body(p: &mut Parser, unit: &mut Unit) {
    let start = p.token().start as usize;
    let mut list = statements(p);
    let end = p.behind();
    if unit.body.is_empty() {
        unit.body_at = p.range(start, end);
    }
    unit.body.append(&mut list);
}

/// Structured Text or Instruction List.
fn statements(p: &mut Parser) -> Vec<Stmt> {
    if p.at_instruction() { p.il_statements() } else { p.statements() }
}

/// Reads an element of a chart; returns false if none stands here.
fn part(p: &mut Parser, unit: &mut Unit) -> bool {
    let start = p.token().start;
    if p.ahead_is(1, ":=") {
        return false;
    }
    let part = match p.word().as_str() {
        "INITIAL_STEP" => step(p, start, true),
        "STEP" => step(p, start, false),
        "TRANSITION" => transition(p, start),
        "ACTION" => action(p, start),
        _ => return false,
    };
    if part.is_none() {
        // The rest of the chart is read without this part.
        p.skip_to(&PARTS);
        for word in ["END_STEP", "END_TRANSITION", "END_ACTION"] {
            if p.eat_word(word) {
                break;
            }
        }
        p.eat(";");
    }
    unit.parts.extend(part);
    true
}

const PARTS: [&str; 9] = [
    "END_STEP",
    "END_TRANSITION",
    "END_ACTION",
    "INITIAL_STEP",
    "STEP",
    "TRANSITION",
    "ACTION",
    "END_PROGRAM",
    "END_FUNCTION_BLOCK",
];

/// Reads the word that ends a part. After a problem, skips the text before it.
fn close(p: &mut Parser, word: &str) {
    while p.eat(";") {}
    if !p.at_word(word) {
        p.expected(say!("`{word}`"));
        p.skip_to(&PARTS);
    }
    p.eat_word(word);
    p.eat(";");
}

fn step(p: &mut Parser, start: u32, initial: bool) -> Option<Part> {
    p.bump();
    let name = p.name(say!("the name of a step"))?;
    let mut associations = Vec::new();
    // The `:` may stand on the next line or be missing.
    p.eat(":");
    while !p.at_end() && !p.at_word("END_STEP") {
        let before = p.mark();
        associations.extend(association(p));
        if !p.eat(";") && !p.at_word("END_STEP") {
            p.expected(say!("`;`"));
            p.skip_to(&PARTS);
            break;
        }
        if p.mark() == before {
            break;
        }
    }
    close(p, "END_STEP");
    Some(Part::Step { name, initial, associations, at: p.since(start) })
}

/// `Pump(L, T#5s, Ready)`.
fn association(p: &mut Parser) -> Option<Association> {
    let start = p.token().start;
    let target = target(p)?;
    let mut qualifier = Qualifier::N;
    let mut time = None;
    if p.eat("(") {
        if p.token().kind == Kind::Word {
            qualifier = qualifier_of(p);
            if p.eat(",") {
                time = times(p, qualifier);
            }
            while p.eat(",") {
                indicator(p);
            }
        }
        p.expect(")");
    }
    if qualifier.timed() && time.is_none() {
        let at = p.range(start as usize, p.behind());
        p.say(&codes::BAD_TEXT, &at, say!("the qualifier {} needs a time", qualifier));
        qualifier = Qualifier::N;
    }
    Some(Association { target, qualifier, time, at: p.since(start) })
}

fn target(p: &mut Parser) -> Option<Expr> {
    match p.token().kind {
        Kind::Direct => Some(p.expr()),
        Kind::Word => Some(p.variable()),
        _ => {
            p.expected(say!("the name of an action"));
            None
        }
    }
}

fn qualifier_of(p: &mut Parser) -> Qualifier {
    let word = p.word();
    let found = Qualifier::named(&word);
    if found.is_none() {
        p.expected(say!("a qualifier"));
    }
    p.bump();
    found.unwrap_or(Qualifier::N)
}

/// The part behind the qualifier: its time, or an indicator variable.
fn times(p: &mut Parser, qualifier: Qualifier) -> Option<Expr> {
    if !qualifier.timed() {
        indicator(p);
        return None;
    }
    Some(p.expr())
}

/// Skips the variable by which the action reports; it is only for the reader.
fn indicator(p: &mut Parser) {
    let at = p.here();
    p.report.element(
        &codes::LEFT_OUT,
        "indicator",
        &at,
        say!("an indicator variable is not kept; it is for the reader"),
    );
    p.expr();
}

fn transition(p: &mut Parser, start: u32) -> Option<Part> {
    p.bump();
    let named = p.token().kind == Kind::Word && !p.at_word("FROM");
    // A transition may be called FROM; then a second FROM follows.
    let called_from =
        p.at_word("FROM") && (p.ahead_word(1, "FROM") || p.ahead_is(1, "(") && p.ahead_word(2, "PRIORITY"));
    let label = if named || called_from { p.name(say!("the name of a transition")) } else { None };
    let priority = if p.at("(") { priority(p) } else { None };
    p.expect_word("FROM");
    let from = steps(p);
    p.expect_word("TO");
    let to = steps(p);
    let receptivity = if p.eat(":=") {
        let e = p.expr();
        if !p.eat(";") {
            p.expected(say!("`;`"));
        }
        e
    } else if p.eat(":") {
        if p.at_instruction() {
            p.il_expression()
        } else {
            let at = p.here();
            p.say(&codes::NOT_CARRIED, &at, say!("a receptivity behind `:` is written in Instruction List"));
            p.skip_to(&PARTS);
            p.bad(start)
        }
    } else {
        p.expected(say!("`:=` and the receptivity"));
        p.skip_to(&PARTS);
        p.bad(start)
    };
    close(p, "END_TRANSITION");
    let at = p.since(start);
    Some(Part::Transition(Box::new(Transition { label, priority, from, to, receptivity, at })))
}

/// `(PRIORITY := 1)`.
fn priority(p: &mut Parser) -> Option<u32> {
    p.bump();
    p.expect_word("PRIORITY");
    p.expect(":=");
    let at = p.here();
    let value = p.expr();
    p.expect(")");
    let number = match value.kind {
        ExprKind::Literal(Literal::Int(n, _)) => u32::try_from(n).ok(),
        _ => None,
    };
    if number.is_none() {
        p.say(&codes::BAD_VALUE, &at, say!("a priority is a whole number"));
    }
    number
}

/// `A` or `(A, B)`.
fn steps(p: &mut Parser) -> Vec<Name> {
    if !p.eat("(") {
        return p.name(say!("the name of a step")).into_iter().collect();
    }
    let mut names = Vec::new();
    while let Some(name) = p.name(say!("the name of a step")) {
        names.push(name);
        if !p.eat(",") {
            break;
        }
    }
    p.expect(")");
    names
}

fn action(p: &mut Parser, start: u32) -> Option<Part> {
    p.bump();
    let name = p.name(say!("the name of an action"))?;
    p.eat(":");
    let mut body = statements(p);
    if is_nothing(&body) {
        body.clear();
    }
    close(p, "END_ACTION");
    Some(Part::Action { name, body, at: p.since(start) })
}

/// True for `IF FALSE THEN RETURN; END_IF;`: the exporter writes an empty action so.
fn is_nothing(body: &[Stmt]) -> bool {
    let [Stmt { kind: StmtKind::If(arms, otherwise), .. }] = body else { return false };
    let [(Expr { kind: ExprKind::Literal(Literal::Bool(false)), .. }, then)] = arms.as_slice() else {
        return false;
    };
    otherwise.is_empty() && matches!(then.as_slice(), [Stmt { kind: StmtKind::Return, .. }])
}

fn configuration(p: &mut Parser, source: &mut Source) {
    p.bump();
    p.name(say!("the name of the configuration"));
    while !p.at_end() && !p.at_word("END_CONFIGURATION") {
        let before = p.mark();
        if !inside(p, source, false) || p.mark() == before {
            p.expected(say!("a resource, a task, a program or `END_CONFIGURATION`"));
            p.skip_to(&["END_CONFIGURATION"]);
        }
    }
    p.expect_word("END_CONFIGURATION");
    p.eat(";");
}

/// Reads an element of a configuration.
fn inside(p: &mut Parser, source: &mut Source, in_resource: bool) -> bool {
    if p.declarations(&mut source.types, &mut source.globals) {
        return true;
    }
    match p.word().as_str() {
        // A resource has none within it.
        "RESOURCE" if !in_resource => resource(p, source),
        "TASK" => task(p, source),
        "PROGRAM" => instance(p, source),
        _ => return false,
    }
    true
}

fn resource(p: &mut Parser, source: &mut Source) {
    p.bump();
    let at = p.span_of(p.token());
    let name = p.name(say!("the name of the resource")).unwrap_or_else(|| Name::new("Resource", at));
    if p.eat_word("ON") {
        p.name(say!("the type of the resource"));
    }
    let mut own = Source { types: std::mem::take(&mut source.types), ..Source::default() };
    while !p.at_end() && !p.at_word("END_RESOURCE") {
        let before = p.mark();
        if !inside(p, &mut own, true) || p.mark() == before {
            p.expected(say!("a task, a program or `END_RESOURCE`"));
            p.skip_to(&["END_RESOURCE", "END_CONFIGURATION"]);
            break;
        }
    }
    p.expect_word("END_RESOURCE");
    p.eat(";");
    source.types = own.types;
    source.resources.push(Resource {
        name,
        globals: own.globals,
        tasks: own.tasks,
        instances: own.instances,
    });
}

/// `TASK fast(INTERVAL := T#10ms, PRIORITY := 1);`.
fn task(p: &mut Parser, source: &mut Source) {
    p.bump();
    let Some(name) = p.name(say!("the name of the task")) else { return };
    let mut interval = None;
    p.expect("(");
    while !p.at(")") && !p.at_end() {
        let at = p.here();
        let word = p.word();
        p.bump();
        p.expect(":=");
        let value = p.expr();
        match (word.as_str(), value.kind) {
            ("INTERVAL", ExprKind::Literal(Literal::Time(t))) if t > Nanos::ZERO => interval = Some(t),
            ("INTERVAL", _) => {
                p.say(&codes::NOT_CARRIED, &at, say!("the interval of a task is written as a time"))
            }
            ("SINGLE", _) => {
                p.say(&codes::NOT_CARRIED, &at, say!("a task that an event starts has no counterpart"))
            }
            _ => {}
        }
        if !p.eat(",") {
            break;
        }
    }
    p.expect(")");
    p.eat(";");
    source.tasks.push(Task { name, interval });
}

/// `PROGRAM main WITH fast : Main(IN := %I0.0, OUT => %Q0.0);`.
fn instance(p: &mut Parser, source: &mut Source) {
    let start = p.bump().start;
    if matches!(p.word().as_str(), "RETAIN" | "NON_RETAIN") && p.ahead(1).kind == Kind::Word {
        p.bump();
    }
    let name = p.name(say!("the name of the program"));
    let task = if p.eat_word("WITH") { p.name(say!("the name of a task")) } else { None };
    p.expect(":");
    let Some(unit) = p.name(say!("the type of the program")) else { return };
    let mut links = Vec::new();
    if p.eat("(") {
        while !p.at(")") && !p.at_end() {
            let Some(name) = p.name(say!("a variable of the program")) else { break };
            if !p.eat(":=") && !p.eat("=>") {
                p.expected(say!("`:=` or `=>`"));
                break;
            }
            links.push((name, p.expr()));
            if !p.eat(",") {
                break;
            }
        }
        p.expect(")");
    }
    p.eat(";");
    let name = name.unwrap_or_else(|| unit.clone());
    source.instances.push(Instance { name, task, unit, links, at: p.since(start) });
}
