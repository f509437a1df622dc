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

/// `prove …`, for the prover.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    /// The claim.
    pub kind: PropertyKind,
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
}

impl PropertyKind {
    /// The conditions in it, in the order of the text.
    pub fn claims(&self) -> impl Iterator<Item = &Expr> {
        let (first, second) = match self {
            PropertyKind::Always(e) | PropertyKind::Never(e) | PropertyKind::Reachable(e) => (e, None),
            PropertyKind::After(cause, _, effect) => (cause, Some(effect)),
        };
        std::iter::once(first).chain(second)
    }
}
