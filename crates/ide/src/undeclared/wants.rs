//! The uses of names that nothing declares: where a document reads and writes them, and the types that its
//! expressions ask of them. It stands below `undeclared`, which makes declarations of the result.
//!
//! # What must hold
//!
//! A number without a point asks for INT, and yields to REAL or TIME where another use asks for that. Nothing is
//! decided by the order of the text: it is gone through until no type changes.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::resolve::conversion;
use g7_model::visit::Visitor;
use g7_model::{
    Action, ActionKind, Arg, BinaryOp, Block, Chart, ChartItem, Document, Expr, ExprKind, Function, Item,
    Name, Operands, Order, Path, PlantItem, Span, StandardFunction, Stmt, StmtKind, Target, TestStmt,
    TestStmtKind, Type, UnaryOp, VarDecl,
};

use super::types::{declared, joined, member, of_input, of_literal, step};

/// Times that a document is gone through: a type that comes from a name needs one more for each name between.
const ROUNDS: usize = 8;

/// The uses of one name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Facts {
    ty: Option<Type>,
    /// The greatest written index, and the number of indexes, if it is used as an array.
    array: Option<(i128, usize)>,
    read: bool,
    /// An assignment, a call or a loop gives it its value.
    written: bool,
    /// It is the variable of a qualifier.
    driven: bool,
    /// A plant or a test gives it its value.
    given: bool,
    /// A test reads it.
    expected: bool,
}

impl Facts {
    /// Its class in a declaration.
    pub(super) fn class(&self) -> &'static str {
        match self {
            Facts { driven: true, .. } | Facts { written: true, read: false, .. } => "output",
            Facts { written: true, .. } => "var",
            Facts { read: false, given: false, expected: true, .. } => "output",
            _ => "input",
        }
    }

    /// Its type as a declaration writes it.
    pub(super) fn ty(&self) -> String {
        let ty = self.ty.unwrap_or(Type::Bool);
        match self.array {
            None => ty.to_string(),
            Some((most, count)) => {
                let bounds = vec![format!("0..{}", most.clamp(9, 999)); count.max(1)];
                format!("ARRAY[{}] OF {ty}", bounds.join(", "))
            }
        }
    }

    fn seen(&mut self, in_test: bool) {
        if in_test {
            self.expected = true;
        } else {
            self.read = true;
        }
    }

    fn take(&mut self, ty: Type) {
        self.ty = Some(match self.ty {
            None => ty,
            Some(other) => joined(other, ty),
        });
    }
}

/// The uses of some names in a document.
pub(super) fn wanted(document: &Document, names: &BTreeSet<&str>) -> BTreeMap<String, Facts> {
    let mut walk = Walk {
        types: declared(document),
        found: names.iter().map(|n| ((*n).to_owned(), Facts::default())).collect(),
        document,
        in_test: false,
    };
    for _ in 0..ROUNDS {
        let before = walk.found.clone();
        walk.document(document);
        if walk.found == before {
            break;
        }
    }
    walk.found
}

struct Walk<'d> {
    types: BTreeMap<&'d str, Type>,
    found: BTreeMap<String, Facts>,
    document: &'d Document,
    in_test: bool,
}

impl<'d> Walk<'d> {
    fn facts(&mut self, path: &Path) -> Option<&mut Facts> {
        match path.names.as_slice() {
            [name] => self.found.get_mut(&*name.text),
            _ => None,
        }
    }

    /// The type of a path, as far as it is known.
    fn of_path(&self, path: &Path) -> Option<Type> {
        match path.names.as_slice() {
            [name] => match self.found.get(&*name.text) {
                Some(facts) => facts.ty,
                None => self.types.get(&*name.text).copied().or_else(|| step(&name.text)),
            },
            [first, last] => {
                let of = self.types.get(&*first.text).copied();
                member(of, &last.text)
                    .or_else(|| self.types.get(&*last.text).copied())
                    .or_else(|| step(&last.text))
            }
            _ => None,
        }
    }

    /// The type of an expression, as far as it is known without a look at what surrounds it.
    fn type_of(&self, e: &Expr) -> Option<Type> {
        match &e.kind {
            ExprKind::Literal(literal) => Some(of_literal(literal)),
            ExprKind::Path(path) => self.of_path(path),
            ExprKind::Element(path, _, None) => self.of_path(path),
            ExprKind::Unary(UnaryOp::Neg, inner) => self.type_of(inner),
            ExprKind::Unary(UnaryOp::Not, inner) => {
                self.type_of(inner).filter(|t| t.is_bits()).or(Some(Type::Bool))
            }
            ExprKind::Unary(UnaryOp::Rise | UnaryOp::Fall, _) | ExprKind::Timer { .. } => Some(Type::Bool),
            ExprKind::Binary(op, a, b) => match op.row().operands {
                Operands::Comparison => Some(Type::Bool),
                Operands::Logic => self.of_both(a, b).filter(|t| t.is_bits()).or(Some(Type::Bool)),
                Operands::Arithmetic => self.of_both(a, b),
            },
            ExprKind::Call(path, args) => self.of_call(path, args),
            ExprKind::Element(_, _, Some(_)) => Some(Type::Bool),
            ExprKind::Direct(_) | ExprKind::List(_) | ExprKind::Bad => None,
        }
    }

    fn of_both(&self, a: &Expr, b: &Expr) -> Option<Type> {
        match (self.type_of(a), self.type_of(b)) {
            (Some(a), Some(b)) => Some(joined(a, b)),
            (one, other) => one.or(other),
        }
    }

    fn of_call(&self, path: &Path, args: &[Arg]) -> Option<Type> {
        let [name] = path.names.as_slice() else { return None };
        if let Some(f) = self.function(name) {
            return Some(f.result.base);
        }
        if let Some((_, to)) = conversion(&name.text) {
            return Some(to);
        }
        match StandardFunction::named(&name.text)? {
            StandardFunction::Len | StandardFunction::Find | StandardFunction::DayOfWeek => Some(Type::Int),
            StandardFunction::Sel | StandardFunction::Mux => args.get(1).and_then(|a| self.type_of(&a.value)),
            StandardFunction::Operator(op) if op.row().operands == Operands::Comparison => Some(Type::Bool),
            _ => args.first().and_then(|a| self.type_of(&a.value)),
        }
    }

    fn function(&self, name: &Name) -> Option<&'d Function> {
        self.document.items.iter().find_map(|i| match i {
            Item::Function(f) if f.name.text == name.text => Some(f),
            _ => None,
        })
    }

    /// Goes through an expression that is read where a type is asked for.
    fn read(&mut self, e: &'d Expr, want: Option<Type>) {
        match &e.kind {
            ExprKind::Path(path) => self.use_of(path, want),
            ExprKind::Element(path, index, bit) => {
                self.element(path, index, if bit.is_some() { Some(Type::Word) } else { want });
                self.use_of(path, None);
            }
            ExprKind::Unary(op, inner) => {
                let bits = self.type_of(inner).filter(|t| t.is_bits());
                self.read(
                    inner,
                    match op {
                        UnaryOp::Neg => want.or(Some(Type::Int)),
                        UnaryOp::Not => bits.or(want).or(Some(Type::Bool)),
                        UnaryOp::Rise | UnaryOp::Fall => Some(Type::Bool),
                    },
                );
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, want),
            ExprKind::Timer { t1, e, t2 } => {
                self.read(t1, Some(Type::Time));
                self.read(e, Some(Type::Bool));
                if let Some(t2) = t2 {
                    self.read(t2, Some(Type::Time));
                }
            }
            ExprKind::Call(path, args) => self.arguments(path, args, want),
            ExprKind::List(values) => values.iter().for_each(|(_, e)| self.read(e, want)),
            ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
        }
    }

    fn binary(&mut self, op: BinaryOp, a: &'d Expr, b: &'d Expr, want: Option<Type>) {
        let (left, right) = (self.type_of(a), self.type_of(b));
        let (for_a, for_b) = match op.row().operands {
            Operands::Comparison => {
                let number = if left.is_none() && right.is_none() { Some(Type::Int) } else { None };
                (right.or(number), left.or(number))
            }
            Operands::Logic => {
                let bits = left.or(right).or(want).filter(|t| t.is_bits()).or(Some(Type::Bool));
                (bits, bits)
            }
            // `+` and `*` join Booleans as well, and a time is multiplied by a number.
            Operands::Arithmetic => {
                let scaled = matches!(op, BinaryOp::Mul | BinaryOp::Div);
                let beside = |other: Option<Type>| match (other, want) {
                    (Some(other), Some(want)) if want.is_number() => Some(joined(other, want)),
                    (other, want) => other.or(want).or(Some(Type::Int)),
                };
                match (left, right) {
                    (_, Some(r)) if scaled && want == Some(Type::Time) && r.is_number() => (want, None),
                    (Some(Type::Time), _) if scaled => (left, None),
                    _ => (beside(right), beside(left)),
                }
            }
        };
        self.read(a, for_a);
        self.read(b, for_b);
    }

    fn use_of(&mut self, path: &Path, want: Option<Type>) {
        let in_test = self.in_test;
        if let Some(facts) = self.facts(path) {
            facts.seen(in_test);
            if let Some(ty) = want {
                facts.take(ty);
            }
        }
    }

    /// The array of an element, and its indexes, which are whole numbers.
    fn element(&mut self, path: &Path, index: &'d [Expr], want: Option<Type>) {
        if let Some(facts) = self.facts(path) {
            let most = index.iter().filter_map(|e| e.kind.whole()).max().unwrap_or(0);
            let (before, _) = facts.array.unwrap_or_default();
            facts.array = Some((most.max(before), index.len()));
            if let Some(ty) = want {
                facts.take(ty);
            }
        }
        index.iter().for_each(|e| self.read(e, Some(Type::Int)));
    }

    /// A variable, or an element of an array, that is given a value.
    fn write(&mut self, target: &'d Expr, ty: Option<Type>) {
        let path = match &target.kind {
            ExprKind::Path(path) => path,
            ExprKind::Element(path, index, bit) => {
                self.element(path, index, if bit.is_some() { Some(Type::Word) } else { ty });
                path
            }
            _ => return,
        };
        let whole = matches!(target.kind, ExprKind::Path(_));
        if let Some(facts) = self.facts(path) {
            facts.written = true;
            if let Some(ty) = ty.filter(|_| whole) {
                facts.take(ty);
            }
        }
    }

    fn assign(&mut self, target: &'d Expr, value: &'d Expr) {
        let ty = self.type_of(value);
        self.write(target, ty);
        let want = self.type_of(target);
        self.read(value, want);
    }

    fn arguments(&mut self, path: &'d Path, args: &'d [Arg], want: Option<Type>) {
        let name = path.names.first();
        let function = name.and_then(|n| self.function(n));
        let block = name.and_then(|n| self.types.get(&*n.text)).copied();
        let standard = name.and_then(|n| StandardFunction::named(&n.text));
        let from = name.and_then(|n| conversion(&n.text)).map(|(from, _)| from);
        let known = args.iter().filter_map(|a| self.type_of(&a.value)).reduce(joined);
        for (n, arg) in args.iter().enumerate() {
            let named = |f: &Function| match &arg.name {
                Some(name) => f.params.iter().find(|p| p.name.text == name.text).map(|p| p.ty.base),
                None => f.params.get(n).map(|p| p.ty.base),
            };
            let parameter = match (function, block, standard) {
                (Some(f), _, _) => named(f),
                (None, Some(of), _) => arg.name.as_ref().and_then(|name| member(Some(of), &name.text)),
                (None, None, Some(f)) => of_input(f, n, known, want),
                (None, None, None) => from,
            };
            if arg.writes() {
                self.write(&arg.value, parameter);
            } else {
                self.read(&arg.value, parameter);
            }
        }
    }

    fn drive(&mut self, target: &'d Target) {
        let path = match target {
            Target::Path(path) => path,
            Target::Element(e) => {
                self.write(e, Some(Type::Bool));
                match &e.kind {
                    ExprKind::Element(path, ..) => path,
                    _ => return,
                }
            }
            Target::Work(work) => return self.work(work),
            Target::Direct(..) => return,
        };
        if let Some(facts) = self.facts(path) {
            facts.driven = true;
            facts.take(Type::Bool);
        }
    }

    fn truths(&mut self, list: &'d [Expr]) {
        list.iter().for_each(|e| self.read(e, Some(Type::Bool)));
    }

    /// A plant or a test gives a variable this value.
    fn give(&mut self, target: &'d Expr, value: Option<&'d Expr>) {
        let ty = value.map_or(Some(Type::Bool), |e| self.type_of(e));
        if let ExprKind::Path(path) = &target.kind
            && let Some(facts) = self.facts(path)
        {
            facts.given = true;
            if let Some(ty) = ty {
                facts.take(ty);
            }
        }
        if let Some(value) = value {
            let want = self.type_of(target);
            self.read(value, want);
        }
    }
}

impl<'d> Visitor<'d> for Walk<'d> {
    fn path(&mut self, names: &'d [Name]) {
        let in_test = self.in_test;
        if let [name] = names
            && let Some(facts) = self.found.get_mut(&*name.text)
        {
            facts.seen(in_test);
        }
    }

    fn direct(&mut self, _text: &'d str, _at: Span) {}

    fn order(&mut self, _order: &'d Order) {}

    fn chart(&mut self, chart: &'d Chart) {
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => self.variable(v),
                ChartItem::Step(s) => s.actions.iter().for_each(|a| self.action(a)),
                ChartItem::Transition(t) => {
                    self.read(&t.receptivity, Some(Type::Bool));
                    t.on_clearing.iter().for_each(|b| self.block(b));
                }
                ChartItem::Pre(b, _) | ChartItem::Post(b, _) => self.body(b),
                ChartItem::Action(a) => self.body(&a.body),
                ChartItem::Section(s) => self.block(&s.body),
            }
        }
    }

    fn variable(&mut self, v: &'d VarDecl) {
        v.init.iter().chain(&v.safe).for_each(|e| self.read(e, Some(v.ty)));
        v.array.iter().flat_map(|a| a.bounds()).for_each(|e| self.read(e, Some(Type::Int)));
    }

    fn expr(&mut self, e: &'d Expr) {
        self.read(e, None);
    }

    fn call(&mut self, path: &'d Path, args: &'d [Arg]) {
        self.arguments(path, args, None);
    }

    fn block(&mut self, block: &'d Block) {
        for local in &block.locals {
            local.init.iter().for_each(|e| self.read(e, Some(local.ty.base)));
        }
        self.statements(&block.statements);
    }

    fn statement(&mut self, s: &'d Stmt) {
        match &s.kind {
            StmtKind::Assign { target, value } => self.assign(target, value),
            StmtKind::Call(path, args) => self.call(path, args),
            StmtKind::If(arms, rest) => {
                for (e, body) in arms {
                    self.read(e, Some(Type::Bool));
                    self.statements(body);
                }
                self.statements(rest);
            }
            StmtKind::Case(e, arms, rest) => {
                self.read(e, Some(Type::Int));
                arms.iter().for_each(|arm| self.statements(&arm.body));
                self.statements(rest);
            }
            StmtKind::For { var, from, to, by, body } => {
                if let Some(facts) = self.found.get_mut(&*var.text) {
                    (facts.written, facts.read) = (true, true);
                    facts.take(Type::Int);
                }
                [Some(from), Some(to), by.as_ref()]
                    .into_iter()
                    .flatten()
                    .for_each(|e| self.read(e, Some(Type::Int)));
                self.statements(body);
            }
            StmtKind::While(e, body) | StmtKind::Repeat(body, e) => {
                self.read(e, Some(Type::Bool));
                self.statements(body);
            }
            StmtKind::Exit | StmtKind::Return => {}
        }
    }

    fn action(&mut self, action: &'d Action) {
        match &action.kind {
            ActionKind::Qualified { time, target, condition, .. } => {
                time.iter().for_each(|t| self.read(t, Some(Type::Time)));
                self.drive(target);
                condition.iter().for_each(|e| self.read(e, Some(Type::Bool)));
            }
            ActionKind::OnEvent { event, work } => {
                self.read(event, Some(Type::Bool));
                self.work(work);
            }
            ActionKind::EachScan { work, condition } => {
                self.work(work);
                condition.iter().for_each(|e| self.read(e, Some(Type::Bool)));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
    }

    fn plant_item(&mut self, item: &'d PlantItem) {
        match item {
            PlantItem::Drive(d) => self.give(&d.input, Some(&d.value)),
            PlantItem::On(e, block, _) => {
                self.read(e, Some(Type::Bool));
                self.block(block);
            }
            PlantItem::Each(block, _) => self.block(block),
            PlantItem::Rate(r) => {
                self.read(&r.value, None);
                r.when.iter().for_each(|e| self.read(e, Some(Type::Bool)));
            }
            // A picture and the beginnings of parts say nothing about the type of a name.
            PlantItem::Const { .. }
            | PlantItem::State(_)
            | PlantItem::Parts(_)
            | PlantItem::Arrivals(_)
            | PlantItem::View(_) => {}
        }
    }

    fn item(&mut self, item: &'d Item) {
        self.in_test = matches!(item, Item::Test(_) | Item::Prove(_) | Item::Plant(_));
        match item {
            Item::Var(v) => self.variable(v),
            Item::Chart(c) => self.chart(c),
            Item::Action(a) => self.body(&a.body),
            Item::Section(s) => self.block(&s.body),
            Item::Function(f) => self.block(&f.body),
            Item::Pre(b, _) | Item::Post(b, _) => self.body(b),
            Item::Plant(p) => p.items.iter().for_each(|i| self.plant_item(i)),
            Item::Test(t) => t.body.iter().for_each(|s| self.test(s)),
            Item::Prove(p) => p.kind.claims().for_each(|e| self.read(e, Some(Type::Bool))),
            Item::Instance(i) => self.instance(i),
            Item::Composed(_)
            | Item::Type(_)
            | Item::Profile(_)
            | Item::Cycle(..)
            | Item::Target(..)
            | Item::Use(_)
            | Item::Layout(_) => {}
        }
    }

    fn test(&mut self, s: &'d TestStmt) {
        match &s.kind {
            TestStmtKind::Set(list) => list.iter().for_each(|(target, e)| self.give(target, Some(e))),
            TestStmtKind::Force(target, e) => self.give(target, Some(e)),
            TestStmtKind::Pulse(target, _) => self.give(target, None),
            TestStmtKind::WaitUntil(e, _) => self.read(e, Some(Type::Bool)),
            TestStmtKind::Expect(list) => self.truths(list),
            TestStmtKind::Always(list, body) => {
                self.truths(list);
                body.iter().for_each(|s| self.test(s));
            }
            TestStmtKind::Repeat(_, body) => body.iter().for_each(|s| self.test(s)),
            TestStmtKind::Release(_)
            | TestStmtKind::Wait(_)
            | TestStmtKind::Scan(_)
            | TestStmtKind::ExpectFault(_)
            | TestStmtKind::Restart { .. }
            | TestStmtKind::Comment(_) => {}
        }
    }
}
