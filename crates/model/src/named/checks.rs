//! The functions that check an assigned value against the bounds of the variable.

use std::collections::{HashMap, HashSet};

use crate::visit::Visitor;
use crate::{
    Arg, BinaryOp, Block, Document, Expr, ExprKind, Function, Item, Literal, Name, Order, Param, Path, Place,
    Span, Stmt, StmtKind, Type,
};

/// The functions that hold variables to their bounds, made for one document. Equal bounds share one.
#[derive(Default)]
pub(super) struct Checks {
    /// The names in the document. A new function must have another name.
    taken: HashSet<Box<str>>,
    /// The name of the function for each type and its bounds.
    made: HashMap<(Type, i128, i128), Name>,
    functions: Vec<Item>,
}

impl Checks {
    pub(super) fn of(document: &Document) -> Checks {
        let mut names = Names(HashSet::new());
        names.document(document);
        for item in &document.items {
            let declared: Vec<&Name> = match item {
                Item::Var(v) => v.names.iter().collect(),
                Item::Chart(c) => c.vars().flat_map(|v| &v.names).chain([&c.name]).collect(),
                Item::Function(f) => vec![&f.name],
                Item::Action(a) => vec![&a.name],
                Item::Section(s) => vec![&s.name],
                _ => Vec::new(),
            };
            names.0.extend(declared.into_iter().map(|n| n.text.clone()));
        }
        Checks { taken: names.0, made: HashMap::new(), functions: Vec::new() }
    }

    /// A call of the check function with the value: outside of the bounds it is the fault `range`. If the type has no values
    /// outside, the value comes back as it is.
    pub(super) fn held(&mut self, value: Expr, (low, high, ty): (i128, i128, Type), at: Place) -> Expr {
        if ty.bounds().is_some_and(|(least, most)| low <= least && most <= high) {
            return value;
        }
        let name = match self.made.get(&(ty, low, high)) {
            Some(name) => name.clone(),
            None => self.function(low, high, ty, at),
        };
        let place = value.at;
        let path = Path { names: vec![Name { text: name.text, at: place }] };
        Expr { kind: ExprKind::Call(path, vec![Arg::input(None, value)]), at: place }
    }

    /// Makes a function that returns its argument, or ends the scan with the fault `range`:
    ///
    /// ```text
    /// function INT_within_0_100(x : INT) : INT { INT_within_0_100 := MUX(SEL(x < 0 OR x > 100, 0, 2), x, 0) }
    /// ```
    ///
    /// This MUX has the inputs 0 and 1. Outside of the bounds the chosen input is 2, which is not there: the fault `range`
    /// (SEMANTICS, section 5).
    fn function(&mut self, low: i128, high: i128, ty: Type, at: Place) -> Name {
        let signed = |n: i128| n.to_string().replace('-', "m");
        let mut text = format!("{}_within_{}_{}", ty.name(), signed(low), signed(high));
        while self.taken.contains(&*text) {
            text.push('_');
        }
        self.taken.insert(text.clone().into());
        let name = Name { text: text.into(), at };
        let make = Make(at);
        let (least, most) = ty.bounds().unwrap_or((low, high));
        let below = (low > least).then(|| make.compare(BinaryOp::Lt, low));
        let above = (high < most).then(|| make.compare(BinaryOp::Gt, high));
        let outside = match (below, above) {
            (Some(a), Some(b)) => make.binary(BinaryOp::Or, a, b),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => make.expr(ExprKind::Literal(Literal::Bool(false))),
        };
        let choice = make.call("SEL", vec![outside, make.number(0), make.number(2)]);
        let value = make.call("MUX", vec![choice, make.x(), make.number(low)]);
        let target = make.expr(ExprKind::Path(Path { names: vec![name.clone()] }));
        let body = Block {
            locals: Vec::new(),
            statements: vec![Stmt { kind: StmtKind::Assign { target, value }, at }],
            at,
        };
        let params = vec![Param { name: Name { text: "x".into(), at }, ty: ty.into() }];
        self.functions.push(Item::Function(Function {
            name: name.clone(),
            params,
            result: ty.into(),
            body,
            at,
        }));
        self.made.insert((ty, low, high), name.clone());
        name
    }

    /// The functions made.
    pub(super) fn into_items(self) -> Vec<Item> {
        self.functions
    }
}

/// Makes expressions at one place.
struct Make(Place);

impl Make {
    fn expr(&self, kind: ExprKind) -> Expr {
        Expr { kind, at: self.0 }
    }

    fn x(&self) -> Expr {
        self.expr(ExprKind::Path(Path { names: vec![Name { text: "x".into(), at: self.0 }] }))
    }

    fn number(&self, n: i128) -> Expr {
        self.expr(ExprKind::Literal(Literal::Int(n, None)))
    }

    fn binary(&self, op: BinaryOp, a: Expr, b: Expr) -> Expr {
        self.expr(ExprKind::Binary(op, Box::new(a), Box::new(b)))
    }

    fn compare(&self, op: BinaryOp, n: i128) -> Expr {
        self.binary(op, self.x(), self.number(n))
    }

    fn call(&self, name: &str, values: Vec<Expr>) -> Expr {
        let path = Path { names: vec![Name { text: name.into(), at: self.0 }] };
        let args = values.into_iter().map(|value| Arg::input(None, value)).collect();
        self.expr(ExprKind::Call(path, args))
    }
}

/// All names that a document uses.
struct Names(HashSet<Box<str>>);

impl<'d> Visitor<'d> for Names {
    fn path(&mut self, names: &'d [Name]) {
        self.0.extend(names.iter().map(|n| n.text.clone()));
    }

    fn direct(&mut self, _: &'d str, _: Span) {}

    fn order(&mut self, _: &'d Order) {}
}
