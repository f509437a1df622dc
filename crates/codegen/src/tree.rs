//! The code to be printed, as a tree that every language prints in its own way.
//!
//! It is what C99 and Rust have in common: scalars, arrays, plain structures,
//! functions, `if`, `while`, choice by number. No pointers but to a structure or
//! an array that is passed on, no recursion, no heap.

use std::collections::HashSet;

/// A type.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ty {
    /// A truth value.
    Bool,
    /// An integer.
    Int { signed: bool, bits: u8 },
    /// A real number.
    Real { bits: u8 },
    /// A number of a row or place.
    Size,
    /// A structure.
    Named(String),
    /// An array.
    Array(Box<Ty>, usize),
    /// A structure that is passed on.
    Ref(bool, Box<Ty>),
    /// An array that is passed on.
    Slice(bool, Box<Ty>),
}

impl Ty {
    pub(crate) const U8: Ty = Ty::Int { signed: false, bits: 8 };
    pub(crate) const I64: Ty = Ty::Int { signed: true, bits: 64 };
}

/// Operators with one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Un {
    /// Of truth values.
    Not,
    Neg,
}

/// Operators with two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bin {
    Mul,
    Div,
    Add,
    Sub,
    Shl,
    Shr,
    BitAnd,
    BitXor,
    BitOr,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
    And,
    Or,
}

impl Bin {
    /// As written in both languages.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Bin::Mul => "*",
            Bin::Div => "/",
            Bin::Add => "+",
            Bin::Sub => "-",
            Bin::Shl => "<<",
            Bin::Shr => ">>",
            Bin::BitAnd => "&",
            Bin::BitXor => "^",
            Bin::BitOr => "|",
            Bin::Eq => "==",
            Bin::Ne => "!=",
            Bin::Lt => "<",
            Bin::Le => "<=",
            Bin::Gt => ">",
            Bin::Ge => ">=",
            Bin::And => "&&",
            Bin::Or => "||",
        }
    }

    /// True for operators that an assignment can have.
    pub(crate) fn has_assignment(self) -> bool {
        !matches!(self, Bin::Eq | Bin::Ne | Bin::Lt | Bin::Le | Bin::Gt | Bin::Ge | Bin::And | Bin::Or)
    }

    /// How tightly it binds in Rust, whose order its printer goes by.
    pub(crate) fn tightness(self) -> u8 {
        match self {
            Bin::Mul | Bin::Div => 9,
            Bin::Add | Bin::Sub => 8,
            Bin::Shl | Bin::Shr => 7,
            Bin::BitAnd => 6,
            Bin::BitXor => 5,
            Bin::BitOr => 4,
            Bin::Eq | Bin::Ne | Bin::Lt | Bin::Le | Bin::Gt | Bin::Ge => 3,
            Bin::And => 2,
            Bin::Or => 1,
        }
    }

    /// True if its operands may stand without brackets beside the same operator.
    pub(crate) fn chains(self) -> bool {
        matches!(self, Bin::And | Bin::Or | Bin::Add | Bin::Mul | Bin::BitAnd | Bin::BitOr | Bin::BitXor)
    }
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expr {
    /// An integer, with its type where it matters.
    Int(i128, Option<Ty>),
    /// A real number by its bits, and how many they are.
    Real(u64, u8),
    Bool(bool),
    Name(String),
    Field(Box<Expr>, String),
    Index(Box<Expr>, Box<Expr>),
    Call(String, Vec<Expr>),
    Un(Un, Box<Expr>),
    Bin(Bin, Box<Expr>, Box<Expr>),
    Cast(Box<Expr>, Ty),
    /// Passes on a structure or an array.
    Ref(bool, Box<Expr>),
    Deref(Box<Expr>),
    /// The one or the other.
    If(Box<Expr>, Box<Expr>, Box<Expr>),
}

impl Expr {
    pub(crate) fn name(n: impl Into<String>) -> Expr {
        Expr::Name(n.into())
    }

    pub(crate) fn size(n: usize) -> Expr {
        Expr::Int(n as i128, None)
    }

    pub(crate) fn field(self, n: impl Into<String>) -> Expr {
        Expr::Field(Box::new(self), n.into())
    }

    pub(crate) fn at(self, i: Expr) -> Expr {
        Expr::Index(Box::new(self), Box::new(i))
    }

    pub(crate) fn call(f: impl Into<String>, args: Vec<Expr>) -> Expr {
        Expr::Call(f.into(), args)
    }

    pub(crate) fn bin(self, op: Bin, other: Expr) -> Expr {
        Expr::Bin(op, Box::new(self), Box::new(other))
    }

    /// Conjunction, short where one side is known.
    pub(crate) fn and(self, other: Expr) -> Expr {
        match (&self, &other) {
            (Expr::Bool(true), _) | (_, Expr::Bool(false)) => other,
            (_, Expr::Bool(true)) | (Expr::Bool(false), _) => self,
            _ => self.bin(Bin::And, other),
        }
    }

    /// Disjunction, short where the left side is known or the right side is FALSE.
    pub(crate) fn or(self, other: Expr) -> Expr {
        match (&self, &other) {
            (Expr::Bool(false), _) => other,
            (Expr::Bool(true), _) | (_, Expr::Bool(false)) => self,
            _ => self.bin(Bin::Or, other),
        }
    }

    /// Joins operands in their order, if there are any. The tree is low, so that all that walks over
    /// it and puts texts together does little for each operand.
    pub(crate) fn joined(mut parts: Vec<Expr>, join: impl Fn(Expr, Expr) -> Expr) -> Option<Expr> {
        while parts.len() > 1 {
            let mut rest = parts.into_iter();
            parts = Vec::with_capacity(rest.len().div_ceil(2));
            while let Some(a) = rest.next() {
                parts.push(match rest.next() {
                    Some(b) => join(a, b),
                    None => a,
                });
            }
        }
        parts.pop()
    }

    /// The complement, without two of them in a row.
    pub(crate) fn not(self) -> Expr {
        match self {
            Expr::Bool(b) => Expr::Bool(!b),
            Expr::Un(Un::Not, e) => *e,
            Expr::Bin(Bin::Eq, a, b) => Expr::Bin(Bin::Ne, a, b),
            Expr::Bin(Bin::Ne, a, b) => Expr::Bin(Bin::Eq, a, b),
            other => Expr::Un(Un::Not, Box::new(other)),
        }
    }

    pub(crate) fn cast(self, ty: Ty) -> Expr {
        Expr::Cast(Box::new(self), ty)
    }

    pub(crate) fn passed(self) -> Expr {
        Expr::Ref(true, Box::new(self))
    }

    /// Every expression in it, itself included.
    pub(crate) fn walk(&self, f: &mut dyn FnMut(&Expr)) {
        f(self);
        match self {
            Expr::Int(..) | Expr::Real(..) | Expr::Bool(_) | Expr::Name(_) => {}
            Expr::Field(e, _) | Expr::Un(_, e) | Expr::Cast(e, _) | Expr::Ref(_, e) | Expr::Deref(e) => {
                e.walk(f);
            }
            Expr::Index(a, b) | Expr::Bin(_, a, b) => {
                a.walk(f);
                b.walk(f);
            }
            Expr::Call(_, args) => args.iter().for_each(|a| a.walk(f)),
            Expr::If(a, b, c) => {
                a.walk(f);
                b.walk(f);
                c.walk(f);
            }
        }
    }
}

/// Calls that the printers write as operators or literals.
pub(crate) fn is_operator(function: &str) -> bool {
    matches!(function, "inv" | "zeroed")
}

/// A run of statements.
pub(crate) type Block = Vec<Stmt>;

/// One choice of a [`Stmt::Match`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arm {
    /// A number or the name of one.
    pub(crate) label: Expr,
    pub(crate) note: String,
    pub(crate) body: Block,
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Stmt {
    Let {
        mutable: bool,
        name: String,
        ty: Ty,
        value: Expr,
    },
    /// `=`, or with an operator.
    Assign(Option<Bin>, Expr, Expr),
    If(Expr, Block, Block),
    While(Expr, Block),
    For(String, Expr, Expr, Block),
    Match(Expr, Vec<Arm>),
    Return(Option<Expr>),
    Break,
    Do(Expr),
    /// All zero and FALSE.
    Clear(Expr, Ty),
    Note(String),
}

impl Stmt {
    /// `while` with its condition where that comes first.
    pub(crate) fn repeated(body: Block) -> Stmt {
        match body.split_first() {
            Some((Stmt::If(c, then, other), rest)) if then[..] == [Stmt::Break] && other.is_empty() => {
                Stmt::While(c.clone().not(), rest.to_vec())
            }
            _ => Stmt::While(Expr::Bool(true), body),
        }
    }

    pub(crate) fn set(to: Expr, value: Expr) -> Stmt {
        Stmt::Assign(None, to, value)
    }

    /// `if` without `else`; the statements alone where the condition holds anyway.
    pub(crate) fn when(condition: Expr, then: Block) -> Block {
        match condition {
            Expr::Bool(true) => then,
            Expr::Bool(false) => Vec::new(),
            c => vec![Stmt::If(c, then, Vec::new())],
        }
    }

    /// Every expression in it.
    pub(crate) fn walk(&self, f: &mut dyn FnMut(&Expr)) {
        match self {
            Stmt::Let { value, .. } => value.walk(f),
            Stmt::Assign(_, to, value) => {
                to.walk(f);
                value.walk(f);
            }
            Stmt::If(c, a, b) => {
                c.walk(f);
                a.iter().chain(b).for_each(|s| s.walk(f));
            }
            Stmt::While(c, body) => {
                c.walk(f);
                body.iter().for_each(|s| s.walk(f));
            }
            Stmt::For(_, from, to, body) => {
                from.walk(f);
                to.walk(f);
                body.iter().for_each(|s| s.walk(f));
            }
            Stmt::Match(e, arms) => {
                e.walk(f);
                for arm in arms {
                    arm.label.walk(f);
                    arm.body.iter().for_each(|s| s.walk(f));
                }
            }
            Stmt::Return(Some(e)) | Stmt::Do(e) | Stmt::Clear(e, _) => e.walk(f),
            Stmt::Return(None) | Stmt::Break | Stmt::Note(_) => {}
        }
    }
}

/// A function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Function {
    pub(crate) public: bool,
    pub(crate) note: String,
    pub(crate) name: String,
    pub(crate) parameters: Vec<(String, Ty)>,
    pub(crate) result: Option<Ty>,
    pub(crate) body: Block,
}

/// A structure's field.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) ty: Ty,
    pub(crate) note: String,
    /// Taken for granted to be used.
    pub(crate) kept: bool,
}

/// A structure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Struct {
    pub(crate) public: bool,
    pub(crate) note: String,
    pub(crate) name: String,
    pub(crate) fields: Vec<Field>,
}

/// A value that is known beforehand.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Known {
    One(Expr),
    Many(Vec<Expr>),
    /// The same in lines, each with what it is for.
    Rows(Vec<(Vec<Expr>, String)>),
}

impl Known {
    /// Every expression in it.
    pub(crate) fn walk(&self, f: &mut dyn FnMut(&Expr)) {
        match self {
            Known::One(e) => e.walk(f),
            Known::Many(all) => all.iter().for_each(|e| e.walk(f)),
            Known::Rows(rows) => rows.iter().flat_map(|r| &r.0).for_each(|e| e.walk(f)),
        }
    }
}

/// A constant.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Const {
    pub(crate) public: bool,
    pub(crate) note: String,
    pub(crate) name: String,
    pub(crate) ty: Ty,
    pub(crate) value: Known,
}

/// Numbers with names: steps, faults.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Numbers {
    pub(crate) note: String,
    pub(crate) name: String,
    pub(crate) ty: Option<Ty>,
    pub(crate) public: bool,
    pub(crate) rows: Vec<(String, usize, String)>,
}

/// All of it, in the order in which it is printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Module {
    /// Fields of variables that say what steps say: where steps are the same, so are they.
    pub(crate) followers: HashSet<String>,
    pub(crate) numbers: Vec<Numbers>,
    pub(crate) structs: Vec<Struct>,
    pub(crate) consts: Vec<Const>,
    pub(crate) functions: Vec<Function>,
}
