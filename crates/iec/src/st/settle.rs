//! Gives each name the spelling of its declaration.
//!
//! A value of an enumeration with its type, `Mode#Auto` or `Mode.Auto`, becomes the one name `Mode#Auto`; without such an
//! enumeration the type before the `#` is dropped.
//!
//! IEC 61131-3 ignores case, a .g7 document does not. An element of a structure or array can be one variable with a
//! name such as `a[1]` or `s.x`, or a member of a type of the file.

use std::collections::{HashMap, HashSet};

use g7_model::{
    Action, ActionKind, Arg, Block, Body, Chart, ChartItem, Composed, Document, Expr, ExprKind, Item, Limits,
    Name, Path, Stmt, StmtKind, Target, VarDecl, Work,
};

use g7_model::bare;

/// Gives every name in a document the spelling of its declaration.
pub fn settle(document: &mut Document) {
    let mut file = Spelling::default();
    let mut types = Types::new();
    for item in &document.items {
        match item {
            Item::Var(v) => file.variables(v),
            Item::Action(a) => file.declare(&a.name, None),
            Item::Section(s) => file.declare(&s.name, None),
            Item::Function(f) => {
                file.declare(&f.name, None);
                let mut own = Spelling::default();
                f.params.iter().for_each(|p| own.declare(&p.name, None));
                types.insert(upper(&f.name), (f.name.text.clone(), own));
            }
            Item::Chart(c) => file.declare(&c.name, None),
            Item::Composed(c) => _ = types.insert(upper(&c.name), (c.name.text.clone(), of_type(c))),
            _ => {}
        }
    }
    // Variables and functions come first: they hide the bare names of values.
    document.items.iter().for_each(|i| {
        if let Item::Type(t) = i {
            file.values(t)
        }
    });
    let mut steps = Spelling::default();
    for chart in document.charts() {
        chart.steps().for_each(|s| steps.declare(&s.name, None));
    }
    let charts: HashMap<String, (Spelling, Spelling)> =
        document.charts().map(|c| (upper(&c.name), of_chart(c))).collect();
    for item in &mut document.items {
        let mut settler = Settler { names: vec![&file], steps: vec![&steps], types: &types };
        match item {
            Item::Var(v) | Item::Type(v) => settler.declaration(v),
            Item::Action(a) => settler.body(&mut a.body),
            Item::Section(s) => settler.block(&mut s.body),
            Item::Function(f) => {
                let mut own = Spelling::default();
                own.declare(&f.name, None);
                f.params.iter().for_each(|p| own.declare(&p.name, None));
                own.locals(&f.body);
                Settler { names: vec![&own, &file], steps: Vec::new(), types: &types }.block(&mut f.body);
            }
            Item::Composed(c) => {
                let own = of_type(c);
                Settler { names: vec![&own, &file], steps: Vec::new(), types: &types }.composed(c);
            }
            Item::Pre(body, _) | Item::Post(body, _) => settler.body(body),
            Item::Chart(c) => {
                if let Some((own, own_steps)) = charts.get(&upper(&c.name)) {
                    settler =
                        Settler { names: vec![own, &file], steps: vec![own_steps, &steps], types: &types };
                }
                settler.chart(c);
            }
            _ => {}
        }
    }
}

fn upper(name: &Name) -> String {
    name.text.to_uppercase()
}

/// The types and functions of the file by their upper-case names: their spelling, and their members or inputs.
type Types = HashMap<String, (Box<str>, Spelling)>;

/// A declared name.
#[derive(Debug)]
struct Entry {
    text: Box<str>,
    /// Its type in upper case, if that is one of the file.
    of: Option<String>,
}

/// Declared names by their upper-case forms.
#[derive(Debug, Default)]
struct Spelling {
    names: HashMap<String, Entry>,
    /// The enumerations, as they stand before their values: `MODE#`.
    enumerations: HashSet<String>,
}

impl Spelling {
    fn declare(&mut self, name: &Name, of: Option<&Name>) {
        self.names.entry(upper(name)).or_insert_with(|| Entry { text: name.text.clone(), of: of.map(upper) });
    }

    fn variables(&mut self, decl: &VarDecl) {
        decl.names.iter().for_each(|n| self.declare(n, decl.of.as_deref()));
    }

    /// The values of an enumeration, alone and with their type.
    fn values(&mut self, decl: &VarDecl) {
        let Some(of) = decl.names.first().filter(|_| !decl.values().is_empty()) else { return };
        self.enumerations.insert(format!("{}#", upper(of)));
        for (value, _) in decl.values() {
            self.declare(&Name { text: format!("{}#{}", of.text, value.text).into(), at: value.at }, None);
            self.declare(value, None);
        }
    }

    fn locals(&mut self, block: &Block) {
        block.locals.iter().flat_map(|l| &l.names).for_each(|n| self.declare(n, None));
    }
}

/// The variables and actions of a chart, and its steps. They are separate because a step and a
/// variable may have the same name.
fn of_chart(chart: &Chart) -> (Spelling, Spelling) {
    let mut own = Spelling::default();
    let mut steps = Spelling::default();
    for item in &chart.items {
        match item {
            ChartItem::Var(v) => own.variables(v),
            ChartItem::Action(a) => own.declare(&a.name, None),
            ChartItem::Section(s) => own.declare(&s.name, None),
            ChartItem::Step(s) => steps.declare(&s.name, None),
            ChartItem::Transition(_) | ChartItem::Pre(..) | ChartItem::Post(..) => {}
        }
    }
    (own, steps)
}

/// The members and parameters of a type, and the local variables of its body.
fn of_type(composed: &Composed) -> Spelling {
    let mut own = Spelling::default();
    composed.members.iter().chain(&composed.inouts).for_each(|v| own.variables(v));
    composed.body.iter().for_each(|b| own.locals(b.block()));
    own
}

struct Settler<'a> {
    /// The scopes of variables, actions, functions and charts, the innermost first.
    names: Vec<&'a Spelling>,
    steps: Vec<&'a Spelling>,
    types: &'a Types,
}

fn find<'a>(spellings: &[&'a Spelling], upper: &str) -> Option<&'a Entry> {
    spellings.iter().find_map(|s| s.names.get(upper))
}

impl<'a> Settler<'a> {
    fn name(&self, name: &mut Name) {
        if let Some(entry) = find(&self.names, &upper(name)) {
            name.text = entry.text.clone();
        }
    }

    fn step(&self, name: &mut Name) {
        if let Some(entry) = find(&self.steps, &upper(name)) {
            name.text = entry.text.clone();
        }
    }

    /// Gives `Step.X` and `Step.t` their spelling; the name of a chart may stand before the step. False for other paths.
    fn step_path(&self, path: &mut Path) -> bool {
        let (chart, step, member) = match path.names.as_mut_slice() {
            [step, member] => (None, step, member),
            [chart, step, member] => (Some(chart), step, member),
            _ => return false,
        };
        let capital = upper(member);
        if !matches!(capital.as_str(), "X" | "T") || find(&self.steps, &upper(step)).is_none() {
            return false;
        }
        chart.into_iter().for_each(|c| self.name(c));
        self.step(step);
        member.text = if capital == "T" { "t" } else { "X" }.into();
        true
    }

    /// Gives a path its spelling: joins elements of structures and arrays into one name, and drops the list of globals
    /// before a name, unless the name alone means another variable. Returns the type of what the path names, if that is a
    /// type of the file.
    fn path(&self, path: &mut Path) -> Option<&'a str> {
        if self.step_path(path) {
            return None;
        }
        self.untyped(path);
        for from in 0..path.names.len().min(3) {
            let rest = path.names.get(from..).unwrap_or(&[]);
            let first = rest.first()?;
            let joined = (1..=rest.len().min(8)).rev().find_map(|n| {
                let joined: Vec<String> = rest.iter().take(n).map(upper).collect();
                find(&self.names, &joined.join(".")).map(|entry| (n, entry, ""))
            });
            let (plain, index) = bare(&first.text);
            let array = || find(&self.names, &plain.to_uppercase()).map(|entry| (1, entry, index));
            let value = || {
                let typed = format!("{}#{}", upper(first), upper(rest.get(1)?));
                find(&self.names, &typed).map(|entry| (2, entry, ""))
            };
            let Some((n, entry, index)) = joined.or_else(array).or_else(value) else { continue };
            if from > 0 && self.is_hidden(&plain.to_uppercase()) {
                return None;
            }
            let name = Name { text: format!("{}{}", entry.text, self.index(index)).into(), at: first.at };
            let mut behind: Vec<Name> = rest.iter().skip(n).cloned().collect();
            let of = self.members(entry.of.as_deref(), &mut behind);
            path.names = std::iter::once(name).chain(behind).collect();
            return of;
        }
        None
    }

    /// Drops the type before the `#` of a value that no enumeration has.
    fn untyped(&self, path: &mut Path) {
        let [name] = path.names.as_mut_slice() else { return };
        let Some((of, value)) = name.text.split_once('#') else { return };
        let of = format!("{}#", of.to_uppercase());
        let known = self.names.last().is_some_and(|file| file.enumerations.contains(&of));
        if !known {
            name.text = value.into();
        }
    }

    /// True if a variable of the file cannot be named without a prefix, because one of the unit has its name.
    fn is_hidden(&self, upper: &str) -> bool {
        let Some((file, own)) = self.names.split_last() else { return false };
        file.names.contains_key(upper) && find(own, upper).is_some()
    }

    /// Gives the names of members of a type their spelling. Returns the type of the last one.
    fn members(&self, mut of: Option<&'a str>, names: &mut [Name]) -> Option<&'a str> {
        for name in names {
            let entry = self.member(of?, name)?;
            of = entry.of.as_deref();
        }
        of
    }

    fn member(&self, of: &str, name: &mut Name) -> Option<&'a Entry> {
        let (_, members) = self.types.get(of)?;
        let (plain, index) = bare(&name.text);
        let entry = members.names.get(&plain.to_uppercase())?;
        name.text = format!("{}{}", entry.text, self.index(index)).into();
        Some(entry)
    }

    /// The index in the name of an instance: `[i + 1]`.
    fn index(&self, index: &str) -> String {
        let end = index.find([' ', ']']).unwrap_or(index.len());
        let name = index.get(1..end).unwrap_or("");
        match find(&self.names, &name.to_uppercase()) {
            Some(entry) => format!("[{}{}", entry.text, index.get(end..).unwrap_or("")),
            None => index.to_owned(),
        }
    }

    fn declaration(&self, decl: &mut VarDecl) {
        let of = decl.of.as_ref().map(|of| upper(of));
        if let (Some(name), Some((text, _))) = (&mut decl.of, of.as_ref().and_then(|of| self.types.get(of))) {
            name.text = text.clone();
        }
        for (low, high) in decl.array.iter_mut().flat_map(|a| &mut a.dimensions) {
            self.expr(low);
            self.expr(high);
        }
        if let Some(Limits::Range(least, most)) = decl.limits.as_deref_mut() {
            self.expr(least);
            self.expr(most);
        }
        decl.init.iter_mut().for_each(|e| self.value(e, of.as_deref()));
    }

    /// An initial value. The names in that of a structure are those of the members.
    fn value(&self, e: &mut Expr, of: Option<&str>) {
        match &mut e.kind {
            ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| self.value(e, of)),
            ExprKind::Call(path, args) if path.names.is_empty() => {
                for arg in args {
                    let entry = of.zip(arg.name.as_mut()).and_then(|(of, name)| self.member(of, name));
                    self.value(&mut arg.value, entry.and_then(|e| e.of.as_deref()));
                }
            }
            _ => self.expr(e),
        }
    }

    fn composed(&self, composed: &mut Composed) {
        composed.members.iter_mut().chain(&mut composed.inouts).for_each(|v| self.declaration(v));
        composed.body.iter_mut().for_each(|b| self.body(b));
    }

    fn chart(&self, chart: &mut Chart) {
        for item in &mut chart.items {
            match item {
                ChartItem::Var(v) => self.declaration(v),
                ChartItem::Step(s) => s.actions.iter_mut().for_each(|a| self.action(a)),
                ChartItem::Transition(t) => {
                    t.from.iter_mut().chain(&mut t.to).for_each(|n| self.step(n));
                    self.expr(&mut t.receptivity);
                    t.on_clearing.iter_mut().for_each(|b| self.block(b));
                }
                ChartItem::Pre(body, _) | ChartItem::Post(body, _) => self.body(body),
                ChartItem::Action(a) => self.body(&mut a.body),
                ChartItem::Section(s) => self.block(&mut s.body),
            }
        }
    }

    fn action(&self, action: &mut Action) {
        match &mut action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter_mut().chain(condition).for_each(|e| self.expr(e));
                match target {
                    Target::Path(path) => _ = self.path(path),
                    Target::Work(work) => self.work(work),
                    Target::Element(element) => self.expr(element),
                    Target::Direct(..) => {}
                }
            }
            ActionKind::OnEvent { event, work } => {
                self.expr(event);
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                condition.iter_mut().for_each(|e| self.expr(e));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
    }

    fn work(&self, work: &mut Work) {
        match work {
            Work::Single(stmt) => self.stmt(stmt),
            Work::Block(block) => self.block(block),
        }
    }

    fn body(&self, body: &mut Body) {
        if let Body::St(block) = body {
            self.block(block);
        }
    }

    fn block(&self, block: &mut Block) {
        block.locals.iter_mut().filter_map(|l| l.init.as_mut()).for_each(|e| self.expr(e));
        self.stmts(&mut block.statements);
    }

    fn stmts(&self, list: &mut [Stmt]) {
        list.iter_mut().for_each(|s| self.stmt(s));
    }

    fn stmt(&self, stmt: &mut Stmt) {
        match &mut stmt.kind {
            StmtKind::Assign { target, value } => {
                self.expr(target);
                self.expr(value);
            }
            StmtKind::Call(path, args) => {
                let of = self.path(path);
                for name in args.iter_mut().filter_map(|a| a.name.as_mut()) {
                    of.and_then(|of| self.member(of, name));
                }
                self.args(args);
            }
            StmtKind::If(arms, otherwise) => {
                for (condition, body) in arms {
                    self.expr(condition);
                    self.stmts(body);
                }
                self.stmts(otherwise);
            }
            StmtKind::Case(selector, arms, otherwise) => {
                self.expr(selector);
                for arm in arms {
                    for (from, to) in &mut arm.labels {
                        self.expr(from);
                        to.iter_mut().for_each(|e| self.expr(e));
                    }
                    self.stmts(&mut arm.body);
                }
                self.stmts(otherwise);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.name(var);
                self.expr(from);
                self.expr(to);
                by.iter_mut().for_each(|e| self.expr(e));
                self.stmts(body);
            }
            StmtKind::While(condition, body) => {
                self.expr(condition);
                self.stmts(body);
            }
            StmtKind::Repeat(body, condition) => {
                self.stmts(body);
                self.expr(condition);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn args(&self, args: &mut [Arg]) {
        for arg in args {
            self.expr(&mut arg.value);
        }
    }

    fn expr(&self, e: &mut Expr) {
        match &mut e.kind {
            ExprKind::Path(path) => _ = self.path(path),
            ExprKind::Unary(_, a) => self.expr(a),
            ExprKind::Binary(_, a, b) => {
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Timer { t1, e, t2 } => {
                self.expr(t1);
                self.expr(e);
                t2.iter_mut().for_each(|t| self.expr(t));
            }
            ExprKind::Call(path, args) => {
                self.function(path);
                let called = path.names.first().map(upper);
                for name in args.iter_mut().filter_map(|a| a.name.as_mut()) {
                    called.as_ref().and_then(|of| self.member(of, name));
                }
                self.args(args);
            }
            ExprKind::Element(path, index, _) => {
                self.path(path);
                index.iter_mut().for_each(|e| self.expr(e));
            }
            ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| self.expr(e)),
            ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
        }
    }

    /// Settles a declared function, or a standard one in upper case.
    fn function(&self, path: &mut Path) {
        let [name] = path.names.as_mut_slice() else {
            self.path(path);
            return;
        };
        let capitals = upper(name);
        if let Some(entry) = find(&self.names, &capitals) {
            name.text = entry.text.clone();
        } else {
            name.text = capitals.into();
        }
    }
}
