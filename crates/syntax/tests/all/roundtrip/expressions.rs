//! Random names, expressions and statements.

use g7_model::{
    Arg, BinaryOp, Block, CaseArm, Expr, ExprKind, FbKind, Limits, Literal, Local, Moment, Name, Nanos, Path,
    Place, Span, Stmt, StmtKind, Type, UnaryOp, ValueType,
};
use proptest::prelude::*;

/// Names of all sorts: plain, numbers, words of the language, and those that need back-ticks.
pub(crate) fn name() -> impl Strategy<Value = Name> {
    let awkward = prop::sample::select(vec![
        "at",
        "retain",
        "on",
        "fault",
        "INIT",
        "every",
        "scan",
        "when",
        "not",
        "and",
        "MOD",
        "IF",
        "exit",
        "step",
        "TRUE",
        "delay",
        "st",
        "il",
        "N",
        "S",
        "cold",
        "set",
        "wait",
        "within",
        "in",
        "max",
        "length",
        "t",
        "T",
        "priority",
        "Vent på start",
        "a`b",
        "a\\b",
        "\\",
        "x y\nz",
        "2x",
        "1_0",
        "%I0.0",
        "ä",
        "e\u{301}",
        "a·b",
        "a.b",
        "'",
        "X12",
        "_",
        "12s",
        "entry",
        "BOOL",
        "//",
        "(*",
    ]);
    prop_oneof![
        4 => "[a-zA-Z_][a-zA-Z0-9_]{0,5}",
        2 => "[0-9]{1,4}",
        3 => awkward.prop_map(String::from),
    ]
    .prop_map(|text| Name::new(text, Span::default()))
}

/// The name of a chart where it is used; of an instance it has an index.
pub(crate) fn chart_name() -> impl Strategy<Value = Name> {
    let index = prop_oneof!["-?[0-9]{1,3}", "[a-z]{1,3}", "[a-z]{1,3} [-+] [0-9]{1,3}"];
    (name(), prop::option::of(index)).prop_map(|(name, index)| match index {
        // As it is read: without zeros at the start.
        Some(index) => match index.parse::<i64>() {
            Ok(number) => Name::new(format!("{}[{number}]", name.text), Span::default()),
            Err(_) => Name::new(format!("{}[{index}]", name.text), Span::default()),
        },
        None => name,
    })
}

/// The name of a chart in an order: that of an instance of a function block is a path.
pub(crate) fn chart_path() -> impl Strategy<Value = Name> {
    prop_oneof![
        4 => chart_name(),
        1 => ("[a-z]{1,3}(\\[-?[1-9][0-9]?\\])?", "[A-Z][a-z]{0,3}(\\[[1-9]\\])?")
            .prop_map(|(home, name)| Name::new(format!("{home}.{name}"), Span::default())),
    ]
}

pub(crate) fn path() -> impl Strategy<Value = Path> {
    let first = prop_oneof![3 => name(), 1 => chart_name()];
    (first, prop::collection::vec(name(), 0..3)).prop_map(|(first, mut names)| {
        names.insert(0, first);
        Path { names }
    })
}

pub(crate) fn text() -> impl Strategy<Value = Box<str>> {
    "[a-z \"'$\\\\`{}/*\n\r\té–%&0-9]{0,12}".prop_map(Box::from)
}

pub(crate) fn ty() -> impl Strategy<Value = Type> {
    prop_oneof![
        Just(Type::Bool),
        Just(Type::Int),
        Just(Type::Ulint),
        Just(Type::Lreal),
        Just(Type::Time),
        prop::sample::select(Moment::ALL.to_vec()).prop_map(Type::Moment),
        (0u16..300).prop_map(Type::String),
        prop::sample::select(FbKind::ALL.to_vec()).prop_map(Type::Fb),
    ]
}

pub(crate) fn duration() -> impl Strategy<Value = Nanos> {
    prop_oneof![
        0..10_000i64,
        (0..100_000i64).prop_map(|ms| ms * 1_000_000),
        (0..1_000_000i64).prop_map(|s| s * 1_000_000_000),
        any::<i64>(),
    ]
    .prop_map(Nanos::new)
}

fn literal() -> impl Strategy<Value = Literal> {
    prop_oneof![
        any::<bool>().prop_map(Literal::Bool),
        (0..100i128).prop_map(|v| Literal::Int(v, None)),
        any::<u64>().prop_map(|v| Literal::Int(v.into(), None)),
        any::<i8>().prop_map(|v| Literal::Int(v.into(), Some(Type::Sint))),
        any::<i64>().prop_map(|v| Literal::Int(v.into(), Some(Type::Lint))),
        any::<u64>().prop_map(|v| Literal::Int(v.into(), Some(Type::Ulint))),
        "[0-9]{1,4}\\.[0-9]{1,4}([eE][-+]?[0-9]{1,2})?".prop_map(|t| Literal::Real(t.into(), None)),
        "[0-9]{1,4}[eE][-+]?[0-9]{1,2}".prop_map(|t| Literal::Real(t.into(), None)),
        "-?[0-9]{1,4}(\\.[0-9]{1,4})?".prop_map(|t| Literal::Real(t.into(), Some(Type::Real))),
        duration().prop_map(Literal::Time),
        any::<i64>().prop_map(|v| Literal::Moment(Moment::Dt, Nanos::new(v))),
        (0..Nanos::DAY.count()).prop_map(|v| Literal::Moment(Moment::Tod, Nanos::new(v))),
        (-106_751..106_752i64).prop_map(|v| Literal::Moment(Moment::Date, Nanos::DAY * v)),
        text().prop_map(Literal::Str),
    ]
}

fn at() -> Place {
    Place::default()
}

fn of(kind: ExprKind) -> Expr {
    Expr { kind, at: at() }
}

const UNARY: [UnaryOp; 4] = [UnaryOp::Not, UnaryOp::Neg, UnaryOp::Rise, UnaryOp::Fall];
const BINARY: [BinaryOp; 16] = [
    BinaryOp::Or,
    BinaryOp::Xor,
    BinaryOp::And,
    BinaryOp::Dot,
    BinaryOp::Eq,
    BinaryOp::Ne,
    BinaryOp::Lt,
    BinaryOp::Le,
    BinaryOp::Gt,
    BinaryOp::Ge,
    BinaryOp::Add,
    BinaryOp::Sub,
    BinaryOp::Mul,
    BinaryOp::Div,
    BinaryOp::Mod,
    BinaryOp::Pow,
];

pub(crate) fn direct() -> impl Strategy<Value = Box<str>> {
    "[IQMXS][A-Z]{0,1}[0-9]{1,2}(\\.[0-9T]{1,2}){0,2}".prop_map(Box::from)
}

/// Any expression without `Bad`.
pub(crate) fn expr() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        literal().prop_map(|l| of(ExprKind::Literal(l))),
        path().prop_map(|p| of(ExprKind::Path(p))),
        direct().prop_map(|d| of(ExprKind::Direct(d))),
    ];
    leaf.prop_recursive(5, 24, 3, |inner| {
        let boxed = inner.clone().prop_map(Box::new);
        let time = duration().prop_map(|time| Box::new(of(ExprKind::Literal(Literal::Time(time)))));
        let t = prop_oneof![2 => time, 1 => boxed.clone()];
        prop_oneof![
            2 => (prop::sample::select(UNARY.to_vec()), boxed.clone()).prop_map(|(op, e)| of(ExprKind::Unary(op, e))),
            5 => (prop::sample::select(BINARY.to_vec()), boxed.clone(), boxed.clone())
                .prop_map(|(op, a, b)| of(ExprKind::Binary(op, a, b))),
            2 => (t.clone(), boxed, prop::option::of(t))
                .prop_map(|(t1, e, t2)| of(ExprKind::Timer { t1, e, t2 })),
            1 => (path(), args(inner.clone())).prop_map(|(p, a)| of(ExprKind::Call(p, a))),
            1 => element(inner.clone()),
            1 => member(inner),
        ]
    })
}

/// An element of an array, or a bit of one.
pub(crate) fn element(index: impl Strategy<Value = Expr>) -> impl Strategy<Value = Expr> {
    let bit = prop::option::of(0..64_u8)
        .prop_map(|n| n.map(|n| Box::new(Name::new(n.to_string(), Span::default()))));
    (path(), prop::collection::vec(index, 1..3), bit)
        .prop_map(|(p, index, bit)| of(ExprKind::Element(Box::new(p), index, bit)))
}

/// A member of an element: `m[i + 1].t[j].x`. Behind the first name a number or a name alone would be read as the
/// index of an instance, and a number as a name would be that of a bit.
fn member(index: impl Strategy<Value = Expr>) -> impl Strategy<Value = Expr> {
    let plain = || {
        "[a-z_][a-zA-Z0-9_]{0,5}"
            .prop_filter("a word of the language", |n| !g7_model::words::reserved().contains(n))
    };
    let more = prop::collection::vec((plain(), 0..3_usize), 1..3);
    (plain(), more, prop::collection::vec(index, 8)).prop_map(|(first, more, index)| {
        let name = |text: String| Name::new(text, Span::default());
        let mut used = 2;
        let mut names = vec![name(format!("{first}[,]"))];
        let last = more.len() - 1;
        for (n, (text, slots)) in more.into_iter().enumerate() {
            used += slots;
            let slot =
                if slots > 0 && n < last { format!("[{}]", ",".repeat(slots - 1)) } else { String::new() };
            names.push(name(format!("{text}{slot}")));
        }
        let index = index.into_iter().take(used).collect();
        of(ExprKind::Element(Box::new(Path { names }), index, None))
    })
}

/// The values of a structure.
pub(crate) fn fields() -> impl Strategy<Value = Expr> {
    let value = prop_oneof![3 => expr().boxed(), 1 => values().boxed()];
    let field = (name(), value).prop_map(|(name, value)| Arg::input(Some(name), value));
    prop::collection::vec(field, 1..3)
        .prop_map(|fields| of(ExprKind::Call(Path { names: Vec::new() }, fields)))
}

/// The values of an array.
pub(crate) fn values() -> impl Strategy<Value = Expr> {
    let one = (prop_oneof![3 => Just(1_u32), 1 => 0..9_u32], expr());
    prop::collection::vec(one, 1..4).prop_map(|list| of(ExprKind::List(list)))
}

pub(crate) fn args(value: impl Strategy<Value = Expr>) -> impl Strategy<Value = Vec<Arg>> {
    let plain = (prop::option::of(name()), value).prop_map(|(name, value)| Arg::input(name, value));
    let output = (name(), path())
        .prop_map(|(n, p)| Arg { output: true, ..Arg::input(Some(n), of(ExprKind::Path(p))) });
    prop::collection::vec(prop_oneof![3 => plain, 1 => output], 0..4)
}

fn small_expr() -> impl Strategy<Value = Expr> {
    expr()
}

/// The target of an assignment.
pub(crate) fn target() -> impl Strategy<Value = Expr> {
    prop_oneof![
        3 => path().prop_map(|p| of(ExprKind::Path(p))),
        1 => direct().prop_map(|d| of(ExprKind::Direct(d))),
        1 => element(expr()),
    ]
}

pub(crate) fn simple_stmt() -> impl Strategy<Value = Stmt> {
    prop_oneof![
        3 => (target(), small_expr()).prop_map(|(target, value)| StmtKind::Assign { target, value }),
        1 => (path(), args(small_expr())).prop_map(|(p, a)| StmtKind::Call(p, a)),
    ]
    .prop_map(|kind| Stmt { kind, at: at() })
}

fn stmt() -> impl Strategy<Value = Stmt> {
    let leaf = prop_oneof![
        6 => simple_stmt(),
        1 => Just(Stmt { kind: StmtKind::Exit, at: at() }),
        1 => Just(Stmt { kind: StmtKind::Return, at: at() }),
    ];
    leaf.prop_recursive(3, 12, 3, |inner| {
        let list = prop::collection::vec(inner, 0..3);
        let e = small_expr;
        prop_oneof![
            (prop::collection::vec((e(), list.clone()), 1..3), list.clone())
                .prop_map(|(a, o)| StmtKind::If(a, o)),
            (e(), prop::collection::vec(arm(list.clone()), 0..3), list.clone())
                .prop_map(|(s, a, o)| StmtKind::Case(s, a, o)),
            (name(), e(), e(), prop::option::of(e()), list.clone())
                .prop_map(|(var, from, to, by, body)| StmtKind::For { var, from, to, by, body }),
            (e(), list.clone()).prop_map(|(c, b)| StmtKind::While(c, b)),
            (list, e()).prop_map(|(b, c)| StmtKind::Repeat(b, c)),
        ]
        .prop_map(|kind| Stmt { kind, at: at() })
    })
}

fn arm(body: impl Strategy<Value = Vec<Stmt>>) -> impl Strategy<Value = CaseArm> {
    let label = (small_expr(), prop::option::of(small_expr()));
    (prop::collection::vec(label, 1..3), body).prop_map(|(labels, body)| CaseArm { labels, body })
}

pub(crate) fn block() -> impl Strategy<Value = Block> {
    let local = (prop::collection::vec(name(), 1..3), value_type(), prop::option::of(small_expr()))
        .prop_map(|(names, ty, init)| Local { names, ty, init, at: at() });
    (prop::collection::vec(local, 0..2), prop::collection::vec(stmt(), 0..4))
        .prop_map(|(locals, statements)| Block { locals, statements, at: at() })
}

/// A type of the language, the name of one that the file declares, or one with bounds.
pub(crate) fn declared_type() -> impl Strategy<Value = (Type, Option<Box<Name>>, Option<Limits>)> {
    let own = name().prop_filter("a type of the language", |n| {
        g7_iec::constant::type_named(&n.text).is_none() && !n.text.starts_with(|c: char| c.is_ascii_digit())
    });
    let whole: Vec<Type> = Type::ELEMENTARY.into_iter().filter(|ty| ty.is_integer()).collect();
    let bounded = (prop::sample::select(whole), expr(), expr());
    prop_oneof![
        4 => ty().prop_map(|ty| (ty, None, None)),
        1 => own.prop_map(|of| (Type::Bool, Some(Box::new(of)), None)),
        1 => bounded.prop_map(|(ty, least, most)| (ty, None, Some(Limits::Range(least, most)))),
    ]
}

/// The type of a parameter, of a local variable or of a result.
pub(crate) fn value_type() -> impl Strategy<Value = ValueType> {
    declared_type().prop_map(|(base, of, limits)| ValueType { base, of, limits: limits.map(Box::new) })
}
