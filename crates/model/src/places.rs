//! Moves the places of a part of a document, when the text before that part becomes longer or shorter.
//!
//! `syntax` keeps what it has read of a text over a change of it; all behind the change only moves. Every
//! type is taken apart field by field, so that a new field does not compile before it is listed here.

use crate::{
    Action, ActionForm, ActionKind, Arg, Array, Arrivals, BinaryOp, Binding, Block, Body, BodyLang, CaseArm,
    Chart, ChartItem, ChartKind, Composed, Document, Drive, Expr, ExprKind, Fix, Function, Instance,
    InstanceNames, Item, Layout, Limits, LinkForm, Literal, Local, Moment, Name, NamedAction, Nanos, Note,
    Order, Param, Parts, Path, Place, PlaceAt, Placed, Plant, PlantItem, Profile, ProfileName, Property,
    PropertyKind, Qualifier, Rate, Said, Scenario, Section, Situation, Span, StateVar, Step, StepKind, Stmt,
    StmtKind, Switch, Target, TargetPlc, TestStmt, TestStmtKind, TextEdit, Transition, Type, UnaryOp, Use,
    ValueType, VarDecl, VarKind, View, Work,
};

/// A part of a document that has places in a text.
pub trait Shift {
    /// Moves all its places by so many bytes. A place stays within what a place can hold.
    fn shift(&mut self, by: i32);
}

impl Shift for Span {
    fn shift(&mut self, by: i32) {
        let Span { file: _, start, end } = self;
        *start = start.saturating_add_signed(by);
        *end = end.saturating_add_signed(by);
    }
}

impl Shift for Note {
    fn shift(&mut self, by: i32) {
        let Note { text: _, at, behind } = self;
        at.shift(by);
        *behind = behind.map(|byte| byte.saturating_add_signed(by));
    }
}

impl Shift for Place {
    fn shift(&mut self, by: i32) {
        self.0.shift(by);
    }
}

impl<T: Shift> Shift for Vec<T> {
    fn shift(&mut self, by: i32) {
        self.iter_mut().for_each(|part| part.shift(by));
    }
}

impl<T: Shift> Shift for Option<T> {
    fn shift(&mut self, by: i32) {
        self.iter_mut().for_each(|part| part.shift(by));
    }
}

impl<T: Shift> Shift for Box<T> {
    fn shift(&mut self, by: i32) {
        (**self).shift(by);
    }
}

impl<A: Shift, B: Shift> Shift for (A, B) {
    fn shift(&mut self, by: i32) {
        self.0.shift(by);
        self.1.shift(by);
    }
}

/// Types without a place.
macro_rules! placeless {
    ($($ty:ty),* $(,)?) => { $(impl Shift for $ty { fn shift(&mut self, _: i32) {} })* };
}

/// Structs by all their fields.
macro_rules! structs {
    ($($ty:ident { $($field:ident),* $(,)? })*) => { $(
        impl Shift for $ty {
            fn shift(&mut self, by: i32) {
                let $ty { $($field),* } = self;
                $($field.shift(by);)*
            }
        }
    )* };
}

/// Enums by all their variants; a variant may have names for its parts in either kind of bracket.
macro_rules! enums {
    ($($ty:ident {
        $($variant:ident $(($($part:ident),*))? $({ $($field:ident),* })?),* $(,)?
    })*) => { $(
        impl Shift for $ty {
            fn shift(&mut self, by: i32) {
                match self {
                    $($ty::$variant $(($($part),*))? $({ $($field),* })? => {
                        $($($part.shift(by);)*)?
                        $($($field.shift(by);)*)?
                    })*
                }
            }
        }
    )* };
}

placeless! {
    ActionForm, bool, i32, i128, u32, u64, Box<str>, String, Said, BinaryOp, BodyLang, ChartKind, LinkForm, Moment, Nanos, ProfileName, Qualifier,
    Switch, TargetPlc, Type, UnaryOp, VarKind,
}

structs! {
    Action { kind, at }
    Array { dimensions, at }
    Arg { name, output, inout, value }
    Arrivals { name, least, most, when, body, at }
    Binding { element, attribute, value }
    Block { locals, statements, at }
    CaseArm { labels, body }
    Chart { kind, name, params, block, comment, every, items, at }
    Document { items, notes }
    Drive { input, value, at }
    Expr { kind, at }
    Fix { label, edits, sure }
    Function { name, params, result, body, at }
    Instance { chart, names, args, comment, at }
    Composed { name, comment, members, inouts, block, body, at }
    Layout { chart, places, at }
    Local { names, ty, init, at }
    Name { text, at }
    NamedAction { name, comment, body, at }
    Param { name, ty }
    Parts { name, attributes, max, length, init, at }
    Path { names }
    PlaceAt { what, x, y, then, at }
    Plant { name, comment, items, at }
    Profile { name, switches, at }
    Property { kind, plant, comment, at }
    Rate { state, value, when, at }
    Scenario { title, plant, seed, body, at }
    Section { name, body, short, at }
    StateVar { names, ty, init, limits, comment, at }
    Step { name, kind, initial, linked, comment, actions, braces, at }
    Stmt { kind, at }
    TestStmt { kind, at }
    TextEdit { at, text }
    Transition { label, from, to, receptivity, priority, comment, on_clearing, chained, at }
    Use { name, library, at }
    ValueType { base, of, limits }
    VarDecl { kind, names, array, ty, of, part_of, limits, usual, init, address, inverted, retain, safe, comment, at }
    View { file, bindings, at }
}

enums! {
    ActionKind {
        Qualified { qualifier, time, target, condition },
        OnEvent { event, work },
        EachScan { work, condition },
        Order(order),
        Comment(text),
    }
    Body { St(block), Other(lang, text, block) }
    ChartItem {
        Var(part), Step(part), Transition(part), Pre(body, at), Post(body, at), Action(part), Section(part),
    }
    ExprKind {
        Literal(value),
        Path(path),
        Direct(text),
        Unary(op, e),
        Binary(op, a, b),
        Timer { t1, e, t2 },
        Call(path, args),
        Element(path, index, member),
        List(values),
        Bad,
    }
    Item {
        Profile(part), Cycle(time, at), Target(plc, at), Var(part), Chart(part), Action(part), Section(part),
        Function(part), Pre(body, at), Post(body, at), Plant(part), Test(part), Prove(part), Layout(part),
        Instance(part), Composed(part), Type(part), Use(part),
    }
    InstanceNames { One(name), Range(least, most) }
    Limits { Range(least, most), Values(values), Of(name) }
    Literal { Bool(value), Int(value, ty), Real(text, ty), Time(time), Moment(moment, time), Str(text) }
    Order { Force(name, situation), Enable(name), Mask(name), Call(name), Enclose(name) }
    Placed { Step(name), Transition(name), TransitionNumber(number), Comment(text), Link(ends), LinkForm(ends, form), Actions(step, form), Sheet }
    PlantItem {
        Const { names, ty, value, comment, at },
        State(part), Rate(part), Drive(part), On(event, block, at), Each(block, at), Parts(part),
        Arrivals(part), View(part),
    }
    PropertyKind {
        Always(e), Never(e), Reachable(e), After(a, time, b), Until(a, b, e), Between(a, b, e), LeadsTo(a, b),
        AtMost(count, list), Assume(e),
    }
    Situation { Init, Current, Steps(names) }
    StepKind { Plain, Entry, Exit, Macro(name), Enclosing }
    StmtKind {
        Assign { target, value },
        Call(path, args),
        If(arms, otherwise),
        Case(selector, arms, otherwise),
        For { var, from, to, by, body },
        While(condition, body),
        Repeat(body, condition),
        Exit,
        Return,
    }
    Target { Path(path), Element(e), Direct(text, at), Work(work) }
    TestStmtKind {
        Set(list), Pulse(target, time), Wait(time), WaitUntil(e, time), Scan(count), Expect(list),
        ExpectFault(name), Always(list, body), Force(target, value), Release(target), Restart { cold },
        Repeat(count, body), Comment(text),
    }
    Work { Single(stmt), Block(block) }
}
