//! Constructors for nodes of the model, each with a place in the foreign file.

use std::collections::{HashMap, HashSet};

use g7_model::{
    Action, ActionKind, Arg, BinaryOp, Block, ChartItem, Document, Expr, ExprKind, Item, Literal, Name,
    Nanos, Path, Qualifier, Span, Step, StepKind, Stmt, StmtKind, Target, Transition, Type, UnaryOp, VarDecl,
    VarKind, Work,
};

/// The names given so far. Case is ignored unless `exact`.
#[derive(Debug, Default)]
pub struct Taken {
    exact: bool,
    names: HashSet<String>,
    /// The last number given for each name, so that many equal names do not take quadratic time.
    counts: HashMap<String, usize>,
}

impl Taken {
    /// Names that differ in case are different.
    pub fn exact() -> Taken {
        Taken { exact: true, ..Taken::default() }
    }

    /// The names of a document: variables, functions, charts, steps, named actions and labels of transitions. Not
    /// those of transition sections, which some forms write under other names.
    pub fn of(document: &Document) -> Taken {
        let mut taken = Taken::default();
        let mut take = |name: &Name| _ = taken.take(&name.text);
        for item in &document.items {
            match item {
                Item::Var(v) => v.names.iter().for_each(&mut take),
                Item::Function(f) => take(&f.name),
                Item::Composed(c) => take(&c.name),
                Item::Type(t) => t.type_names().for_each(&mut take),
                Item::Chart(c) => {
                    take(&c.name);
                    for item in &c.items {
                        match item {
                            ChartItem::Var(v) => v.names.iter().for_each(&mut take),
                            ChartItem::Step(s) => take(&s.name),
                            ChartItem::Action(a) => take(&a.name),
                            ChartItem::Transition(t) => t.label.iter().for_each(&mut take),
                            ChartItem::Section(_) | ChartItem::Pre(..) | ChartItem::Post(..) => {}
                        }
                    }
                }
                _ => {}
            }
        }
        taken
    }

    fn key(&self, name: &str) -> String {
        if self.exact { name.to_owned() } else { name.to_uppercase() }
    }

    /// True if the name has been given.
    pub fn has(&self, name: &str) -> bool {
        self.names.contains(&self.key(name))
    }

    /// Gives a name unchanged; returns false if it was already taken.
    pub fn take(&mut self, name: &str) -> bool {
        self.names.insert(self.key(name))
    }

    /// Gives the name, or the first of `name_2`, `name_3`, … that is free.
    pub fn give(&mut self, wanted: &str) -> String {
        let key = self.key(wanted);
        if self.names.insert(key.clone()) {
            return wanted.to_string();
        }
        let mut count = self.counts.get(&key).copied().unwrap_or(1);
        loop {
            count += 1;
            let name = format!("{wanted}_{count}");
            if self.take(&name) {
                self.counts.insert(key, count);
                return name;
            }
        }
    }
}

/// An expression at a place.
pub fn expr(kind: ExprKind, at: Span) -> Expr {
    Expr { kind, at: at.into() }
}

/// TRUE or FALSE.
pub fn boolean(value: bool, at: Span) -> Expr {
    expr(ExprKind::Literal(Literal::Bool(value)), at)
}

/// A whole number; a negative one is a sign before a literal, as it would be written.
pub fn int(value: i128, at: Span) -> Expr {
    let number = expr(ExprKind::Literal(Literal::Int(value.saturating_abs(), None)), at);
    if value < 0 { unary(UnaryOp::Neg, number, at) } else { number }
}

/// A duration.
pub fn time(time: Nanos, at: Span) -> Expr {
    expr(ExprKind::Literal(Literal::Time(time)), at)
}

/// Stands for an expression that could not be read.
pub fn bad(at: Span) -> Expr {
    expr(ExprKind::Bad, at)
}

/// Names joined by dots.
pub fn path(names: &[&str], at: Span) -> Path {
    Path { names: names.iter().map(|n| Name::new(*n, at)).collect() }
}

/// A path as an expression.
pub fn name(names: &[&str], at: Span) -> Expr {
    expr(ExprKind::Path(path(names, at)), at)
}

/// An operator before an operand.
pub fn unary(op: UnaryOp, e: Expr, at: Span) -> Expr {
    expr(ExprKind::Unary(op, Box::new(e)), at)
}

/// An operator between two operands.
pub fn binary(op: BinaryOp, a: Expr, b: Expr, at: Span) -> Expr {
    expr(ExprKind::Binary(op, Box::new(a), Box::new(b)), at)
}

/// `not e`, without double negation.
pub fn not(e: Expr, at: Span) -> Expr {
    match e.kind {
        ExprKind::Literal(Literal::Bool(b)) => boolean(!b, at),
        ExprKind::Unary(UnaryOp::Not, inner) => *inner,
        _ => unary(UnaryOp::Not, e, at),
    }
}

/// `a and b`, simplified if an operand is TRUE or FALSE.
pub fn and(a: Expr, b: Expr, at: Span) -> Expr {
    match (truth(&a), truth(&b)) {
        (Some(false), _) | (_, Some(true)) => a,
        (Some(true), _) | (_, Some(false)) => b,
        _ => binary(BinaryOp::And, a, b, at),
    }
}

/// The parts of a condition that are joined by AND.
pub fn conjuncts(e: &Expr) -> Vec<&Expr> {
    match &e.kind {
        ExprKind::Binary(BinaryOp::And, a, b) => {
            let mut all = conjuncts(a);
            all.append(&mut conjuncts(b));
            all
        }
        _ => vec![e],
    }
}

/// `a or b`, simplified if an operand is TRUE or FALSE.
pub fn or(a: Expr, b: Expr, at: Span) -> Expr {
    match (truth(&a), truth(&b)) {
        (Some(true), _) | (_, Some(false)) => a,
        (Some(false), _) | (_, Some(true)) => b,
        _ if a == b => a,
        _ => binary(BinaryOp::Or, a, b, at),
    }
}

/// The value of a Boolean literal.
pub fn truth(e: &Expr) -> Option<bool> {
    match e.kind {
        ExprKind::Literal(Literal::Bool(b)) => Some(b),
        _ => None,
    }
}

/// `f(a, b)`.
pub fn call(function: &str, args: Vec<Expr>, at: Span) -> Expr {
    let args = args.into_iter().map(|value| Arg::input(None, value)).collect();
    expr(ExprKind::Call(path(&[function], at), args), at)
}

/// `target := value`.
pub fn assign(target: Expr, value: Expr, at: Span) -> Stmt {
    Stmt { kind: StmtKind::Assign { target, value }, at: at.into() }
}

/// `IF condition THEN body END_IF`.
pub fn when(condition: Expr, body: Vec<Stmt>, otherwise: Vec<Stmt>, at: Span) -> Stmt {
    Stmt { kind: StmtKind::If(vec![(condition, body)], otherwise), at: at.into() }
}

/// `block(a := x, b := y)`.
pub fn invoke(block: Path, args: Vec<(&str, Expr)>, at: Span) -> Stmt {
    let arg = |(n, value): (&str, Expr)| Arg::input(Some(Name::new(n, at)), value);
    Stmt { kind: StmtKind::Call(block, args.into_iter().map(arg).collect()), at: at.into() }
}

/// A variable with only a name and a type.
pub fn variable(kind: VarKind, name: &str, ty: Type, at: Span) -> VarDecl {
    VarDecl::new(kind, vec![Name::new(name, at)], ty, at.into())
}

/// A text on one line, for names and comments.
pub fn line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.chars().filter(|c| !c.is_control()).collect()
}

/// A plain step without actions.
pub fn step(name: Name, initial: bool, at: Span) -> Step {
    Step {
        name,
        kind: StepKind::Plain,
        initial,
        linked: false,
        comment: None,
        actions: Vec::new(),
        braces: false,
        at: at.into(),
    }
}

/// A transition with only its ends and its receptivity.
pub fn transition(from: Vec<Name>, to: Vec<Name>, receptivity: Expr, at: Span) -> Transition {
    Transition {
        label: None,
        from,
        to,
        receptivity,
        priority: None,
        comment: None,
        on_clearing: None,
        chained: false,
        at: at.into(),
    }
}

/// Statements as a block.
pub fn block(statements: Vec<Stmt>, at: Span) -> Block {
    Block { locals: Vec::new(), statements, at: at.into() }
}

/// The work of an action: a single assignment or call stands alone, other statements in a block.
pub fn work(mut statements: Vec<Stmt>, at: Span) -> Work {
    let alone =
        matches!(statements.as_slice(), [Stmt { kind: StmtKind::Assign { .. } | StmtKind::Call(..), .. }]);
    match statements.pop() {
        Some(only) if alone => Work::Single(Box::new(only)),
        last => {
            statements.extend(last);
            Work::Block(block(statements, at))
        }
    }
}

/// An action with a qualifier.
pub fn qualified(
    qualifier: Qualifier,
    time: Option<Expr>,
    target: Target,
    condition: Option<Expr>,
    at: Span,
) -> Action {
    Action { kind: ActionKind::Qualified { qualifier, time, target, condition }, at: at.into() }
}
