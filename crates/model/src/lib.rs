//! The chart as data, and the problems that can be reported about it.
//!
//! # Where this sits
//!
//! ```text
//! .g7 text, XML -> syntax -> model::Document -> compile -> engine::Program
//! ```
//!
//! A [`Document`] is what an author wrote, in the author's order, with names
//! still names: nothing is resolved, typed or lowered here. Everything carries a
//! [`Span`], so that text, drawing and message can point at the same thing.
//! No I/O, no parser, no meaning.
//!
//! # Invariants
//!
//! - Two documents that differ only in spans and notes are equal: `Place` never
//!   takes part in a comparison, so `parse(print(d)) == d` can be tested as is.
//! - A text for a reader is a [`Said`], with a row in each language.
//! - A [`Problem`]'s code is one of [`codes::ALL`], each with a page in the book.
#![forbid(unsafe_code)]

// `say!` names this crate, also within it.
extern crate self as g7_model;

mod action;
mod chart;
pub mod codes;
pub mod composed;
mod expr;
mod fix;
mod functions;
pub mod instances;
mod language;
mod layout;
mod limits;
pub mod linked;
mod moments;
mod name;
pub mod named;
mod nanos;
mod operators;
mod param;
pub mod places;
mod plant;
mod problem;
mod qualifier;
pub mod said;
mod scenario;
mod severity;
mod similar;
mod span;
mod types;
mod uses;
pub mod visit;
pub mod visit_mut;
pub mod words;

pub use action::{
    Action, ActionKind, Block, Body, BodyLang, CaseArm, Local, Order, Situation, Stmt, StmtKind, Target, Work,
};
pub use chart::{
    Array, Chart, ChartItem, ChartKind, Composed, Document, Function, Instance, InstanceNames, Item,
    NamedAction, Note, Profile, ProfileName, Section, Step, StepKind, Switch, TargetPlc, Transition, VarDecl,
    VarKind,
};
pub use expr::{Arg, Expr, ExprKind, Literal, Path, element_name, element_parts, filled};
pub use fix::{Fix, TextEdit};
pub use functions::{FunctionRow, StandardFunction};
pub use g7_say::say;
pub use language::Language;
pub use layout::{ActionForm, Layout, LinkForm, PlaceAt, Placed};
pub use limits::Limits;
pub use moments::Moment;
pub use name::{Index, Name, bare, chart_in, instance_of, normal_address, slot_of, with_slot};
pub use nanos::Nanos;
pub use operators::{BinaryOp, Operands, Operator, UnaryOp};
pub use param::{Param, ValueType};
pub use plant::{Arrivals, Binding, Drive, Parts, Plant, PlantItem, Rate, StateVar, View};
pub use problem::Problem;
pub use qualifier::{Lasting, Qualifier};
pub use said::{Part, Said};
pub use scenario::{Property, PropertyKind, Scenario, TestStmt, TestStmtKind};
pub use severity::Severity;
pub use similar::similar;
pub use span::{FileId, Place, Span};
pub use types::{Elementary, FbKind, Holds, Type};
pub use uses::Use;
