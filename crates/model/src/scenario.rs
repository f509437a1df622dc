//! Scenario tests and properties.

use crate::{Expr, Name, Nanos, Place};

/// `test "stops after five bottles" with Belt seed 3 { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scenario {
    /// Its title.
    pub title: Box<str>,
    /// The plant it runs against; without one the inputs move only by `set`.
    pub plant: Option<Name>,
    /// The seed of the plant's chance, 0 when absent.
    pub seed: Option<u64>,
    /// Its statements.
    pub body: Vec<TestStmt>,
    /// Where it stands.
    pub at: Place,
}

/// A statement of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TestStmt {
    /// Its kind.
    pub kind: TestStmtKind,
    /// Where it stands.
    pub at: Place,
}

/// The statements of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TestStmtKind {
    /// `set a := TRUE, %S21 := TRUE`: inputs, variables, system bits, or states of the plant;
    /// each a `Path` or `Direct` expression, here and below.
    Set(Vec<(Expr, Expr)>),
    /// `pulse a for 1s`: true for one scan, or for the time, then false for one scan.
    Pulse(Expr, Option<Nanos>),
    /// `wait 1s`.
    Wait(Nanos),
    /// `wait until e within 5s`; 10 s when absent.
    WaitUntil(Expr, Option<Nanos>),
    /// `scan 3`: so many scans.
    Scan(u32),
    /// `expect a, not b`.
    Expect(Vec<Expr>),
    /// `expect fault unstable`.
    ExpectFault(Option<Name>),
    /// `always e { … }`: holds at the end of each scan of the block.
    Always(Vec<Expr>, Vec<TestStmt>),
    /// `force motor := FALSE`.
    Force(Expr, Expr),
    /// `release motor`.
    Release(Expr),
    /// `restart`: warm (retained variables kept), or `restart cold`.
    Restart {
        /// Retained variables take their initial values too.
        cold: bool,
    },
    /// `repeat 4 { … }`.
    Repeat(u32, Vec<TestStmt>),
    /// A comment for the report.
    Comment(Box<str>),
}

/// `prove …` or `assume …`, for the prover.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    /// The claim, or what is assumed.
    pub kind: PropertyKind,
    /// `with Tank`: the plant that drives inputs; without one inputs take any values.
    pub plant: Option<Name>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Where it stands.
    pub at: Place,
}

/// The forms of a property.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PropertyKind {
    /// Holds after every scan.
    Always(Expr),
    /// Holds after no scan.
    Never(Expr),
    /// Some inputs lead to it.
    Reachable(Expr),
    /// Whenever the first holds, the second holds within the time.
    After(Expr, Nanos, Expr),
    /// `after a until b expect e`: from a scan with the first up to one with the second, the
    /// third holds.
    Until(Expr, Expr, Expr),
    /// `between a and b never e`: the third does not hold from a scan with the first up to
    /// the next one with the second.
    Between(Expr, Expr, Expr),
    /// `a leads to b`: whenever the first holds, the second comes at last.
    LeadsTo(Expr, Expr),
    /// `at most 1 of (a, b, c)`: after each scan at most so many of the conditions hold.
    AtMost(u32, Vec<Expr>),
    /// `assume e`: no claim, but what the environment keeps before every scan.
    Assume(Expr),
}

impl PropertyKind {
    /// The same conditions, to be changed.
    pub fn claims_mut(&mut self) -> Vec<&mut Expr> {
        match self {
            PropertyKind::Always(e)
            | PropertyKind::Never(e)
            | PropertyKind::Reachable(e)
            | PropertyKind::Assume(e) => vec![e],
            PropertyKind::After(a, _, b) | PropertyKind::LeadsTo(a, b) => vec![a, b],
            PropertyKind::Until(a, b, e) | PropertyKind::Between(a, b, e) => vec![a, b, e],
            PropertyKind::AtMost(_, list) => list.iter_mut().collect(),
        }
    }

    /// The conditions in it, in the order of the text.
    pub fn claims(&self) -> impl Iterator<Item = &Expr> {
        let (some, many): ([Option<&Expr>; 3], &[Expr]) = match self {
            PropertyKind::Always(e)
            | PropertyKind::Never(e)
            | PropertyKind::Reachable(e)
            | PropertyKind::Assume(e) => ([Some(e), None, None], &[]),
            PropertyKind::After(a, _, b) | PropertyKind::LeadsTo(a, b) => ([Some(a), Some(b), None], &[]),
            PropertyKind::Until(a, b, e) | PropertyKind::Between(a, b, e) => {
                ([Some(a), Some(b), Some(e)], &[])
            }
            PropertyKind::AtMost(_, list) => ([None; 3], list),
        };
        some.into_iter().flatten().chain(many)
    }
}
