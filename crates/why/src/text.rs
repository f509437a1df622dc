//! Names of the rows of a program, and expressions as one writes them: with the names of the program, so that a part
//! of an instance shows the instance's own variables.

use std::borrow::Cow;

use g7_compile::Compiled;
use g7_compile::symbols::{Symbols, activity};
use g7_compile::tree::{Clock, Expr, ExprKind, Gate};
use g7_engine::{Addr, Arith, Cmp, GroupId, Receptivity, State, StepId, WatchId};
use g7_host::read_text;
use g7_model::{BinaryOp, Nanos, Said, Span, Type};

use crate::parts::watched;

/// Longest text of an expression.
const LONG: usize = 120;
/// Tighter than every operator between operands.
const TIGHT: u8 = u8::MAX;

pub(crate) struct Names<'a> {
    pub(crate) compiled: &'a Compiled,
}

impl<'a> Names<'a> {
    pub(crate) fn symbols(&self) -> &'a Symbols {
        &self.compiled.symbols
    }

    /// The name of the variable that lies at this address; with an index if it is an element of an array.
    pub(crate) fn word(&self, addr: Addr) -> String {
        let mut all = self.symbols().variables.iter();
        if let Some(v) = all.find(|v| v.addr == addr && v.words() == 1) {
            return v.name.to_string();
        }
        let Some(v) = self.symbols().variable_at(addr) else { return "…".to_owned() };
        let each = v.words().checked_div(v.elements).unwrap_or(1).max(1);
        match v.elements {
            0 | 1 => v.name.to_string(),
            _ => format!("{}[{}]", v.name, (addr.0 - v.addr.0) / each),
        }
    }

    /// Where the variable of a word is declared.
    pub(crate) fn word_place(&self, addr: Addr) -> Span {
        self.symbols().variable_at(addr).map(|v| v.at).unwrap_or_default()
    }

    /// The value of a word in a state, as one writes it.
    pub(crate) fn value(&self, addr: Addr, state: &State) -> Said {
        let own = self.symbols().variables.iter().find(|v| v.addr == addr && v.words() == 1);
        let Some(v) = own.or_else(|| self.symbols().variable_at(addr)) else { return Said::foreign("…") };
        if let Type::String(_) = v.ty {
            return Said::foreign(format!("'{}'", read_text(state.words(), v.addr.0)));
        }
        let word = state.word(addr);
        let named = v.held.as_ref().and_then(|held| held.name_of(i128::from(word as i64)));
        Said::foreign(named.map_or_else(|| value_text(v.ty, word), str::to_owned))
    }

    pub(crate) fn step(&self, step: StepId) -> &'a str {
        self.symbols().step_name(step)
    }

    /// The name of a macro-step or chart.
    pub(crate) fn group(&self, group: GroupId) -> (String, Span) {
        let s = self.symbols();
        let found = s.macro_steps.iter().find(|m| m.group == group).map(|m| (m.name.to_string(), m.at));
        found
            .or_else(|| s.charts.iter().find(|c| c.group == group).map(|c| (c.name.to_string(), c.at)))
            .unwrap_or_default()
    }

    /// The label of a transition, or `1 -> 2`.
    pub(crate) fn transition(&self, rank: u32) -> String {
        let s = self.symbols();
        s.label(rank).unwrap_or_else(|| s.transition_text(rank)).to_owned()
    }

    /// An expression.
    pub(crate) fn expr(&self, e: &Expr) -> String {
        let mut out = String::new();
        self.write(e, &mut out, 0);
        if out.chars().count() > LONG {
            out = out.chars().take(LONG - 1).chain(['…']).collect();
        }
        out
    }

    fn watched(&self, watch: WatchId) -> Option<&'a Expr> {
        watched(self.compiled, watch)
    }

    fn write(&self, e: &Expr, out: &mut String, tight: u8) {
        // A long expression is cut anyway.
        if out.len() > 4 * LONG {
            return;
        }
        match &e.kind {
            ExprKind::Const(ty, word) => out.push_str(&value_text(*ty, *word)),
            ExprKind::Word(_, addr) | ExprKind::Text(addr, _) => out.push_str(&self.word(*addr)),
            ExprKind::Element { base, index, .. } => {
                let name = self.symbols().variable_at(*base).map_or("…", |v| &v.name);
                out.push_str(name);
                out.push('[');
                self.write(index, out, 0);
                out.push(']');
            }
            ExprKind::Active(step) | ExprKind::WasActive(step) => self.active(*step, out),
            ExprKind::GroupActive(group) => self.group_active(*group, out),
            ExprKind::Time(clock) => match clock {
                Clock::Step(s) | Clock::StepAge(s) | Clock::StepScans(s) => {
                    self.active(*s, out);
                    out.push_str(".T");
                }
                Clock::Group(g) | Clock::GroupAge(g) | Clock::GroupScans(g) => {
                    self.group_active(*g, out);
                    out.push_str(".T");
                }
            },
            ExprKind::Tenths(step) => {
                self.active(*step, out);
                out.push_str(".T");
            }
            ExprKind::Rise(watch) => self.moment("↑", *watch, out),
            ExprKind::Fall(watch) => self.moment("↓", *watch, out),
            ExprKind::Timer(watch) => self.timer(*watch, out),
            ExprKind::Not(x) => {
                out.push_str("not ");
                self.write(x, out, TIGHT);
            }
            ExprKind::Gate(gate, a, b) => {
                let op = match gate {
                    Gate::And => BinaryOp::And,
                    Gate::Xor => BinaryOp::Xor,
                    Gate::Or => BinaryOp::Or,
                };
                self.infix((a, op, b), tight, out);
            }
            ExprKind::Neg(_, x) => {
                out.push('-');
                self.write(x, out, TIGHT);
            }
            ExprKind::Arith(op, _, a, b) => {
                let op = match op {
                    Arith::Add => BinaryOp::Add,
                    Arith::Sub => BinaryOp::Sub,
                    Arith::Mul => BinaryOp::Mul,
                    Arith::Div => BinaryOp::Div,
                    Arith::Mod => BinaryOp::Mod,
                    Arith::Pow => BinaryOp::Pow,
                };
                self.infix((a, op, b), tight, out);
            }
            ExprKind::Compare(c, _, a, b) | ExprKind::CompareText(c, a, b) => {
                let op = match c {
                    Cmp::Eq => BinaryOp::Eq,
                    Cmp::Ne => BinaryOp::Ne,
                    Cmp::Lt => BinaryOp::Lt,
                    Cmp::Le => BinaryOp::Le,
                    Cmp::Gt => BinaryOp::Gt,
                    Cmp::Ge => BinaryOp::Ge,
                };
                self.infix((a, op, b), tight, out);
            }
            ExprKind::Convert(_, _, x) | ExprKind::Trunc(_, _, x) | ExprKind::FromText(_, x) => {
                self.write(x, out, tight);
            }
            ExprKind::ToText { value, .. } => self.write(value, out, tight),
            ExprKind::Call(f, _, args) | ExprKind::TextCall { function: f, args, .. } => {
                out.push_str(&format!("{f:?}").to_uppercase());
                out.push('(');
                for (i, a) in args.iter().enumerate() {
                    out.push_str(if i > 0 { ", " } else { "" });
                    self.write(a, out, 0);
                }
                out.push(')');
            }
            ExprKind::After(_, value) => self.write(value, out, tight),
            ExprKind::Due(_) | ExprKind::ScanTime | ExprKind::Random(_) => out.push('…'),
        }
    }

    fn infix(&self, (a, op, b): (&Expr, BinaryOp, &Expr), tight: u8, out: &mut String) {
        let (sign, binds) = (op.row().sign, op.row().strength);
        let apart = binds < tight;
        out.push_str(if apart { "(" } else { "" });
        self.write(a, out, binds);
        out.push_str(&format!(" {sign} "));
        self.write(b, out, binds + 1);
        out.push_str(if apart { ")" } else { "" });
    }

    fn active(&self, step: StepId, out: &mut String) {
        out.push_str(&activity(self.step(step), false));
    }

    fn group_active(&self, group: GroupId, out: &mut String) {
        out.push_str(&activity(&self.group(group).0, true));
    }

    fn moment(&self, arrow: &str, watch: WatchId, out: &mut String) {
        out.push_str(arrow);
        match self.watched(watch) {
            Some(e) => self.write(e, out, TIGHT),
            None => out.push('…'),
        }
    }

    fn timer(&self, watch: WatchId, out: &mut String) {
        let times = self.compiled.program.tables().watches.get(watch.0 as usize).and_then(|w| w.times);
        let (on, off) = times
            .map_or((None, None), |(on, off)| (self.compiled.condition(on), self.compiled.condition(off)));
        if let Some(on) = on {
            self.write(on, out, TIGHT);
        }
        out.push('/');
        match self.watched(watch) {
            Some(e) => self.write(e, out, TIGHT),
            None => out.push('…'),
        }
        let zero = |e: &&Expr| !matches!(e.kind, ExprKind::Const(_, 0));
        if let Some(off) = off.filter(zero) {
            out.push('/');
            self.write(off, out, TIGHT);
        }
    }

    /// A timer as one writes it, and where its operand stands.
    pub(crate) fn timer_text(&self, watch: WatchId) -> (String, Span) {
        let mut out = String::new();
        self.timer(watch, &mut out);
        (out, self.watched(watch).map(|e| e.at).unwrap_or_default())
    }

    /// The tree of a receptivity; `None` for one that is always TRUE.
    pub(crate) fn receptivity(&self, rank: u32) -> Option<Cow<'a, Expr>> {
        let t = self.compiled.program.tables().transitions.get(rank as usize)?;
        let at = self.symbols().transition_place(rank);
        let word = |a: Addr| Expr::new(ExprKind::Word(Type::Bool, a), at);
        match t.receptivity {
            Receptivity::True => None,
            Receptivity::Word(a) => Some(Cow::Owned(word(a))),
            Receptivity::NotWord(a) => Some(Cow::Owned(word(a).negated())),
            Receptivity::Code(code) => self.compiled.condition(code).map(Cow::Borrowed),
        }
    }
}

/// A time for a reader.
pub(crate) fn at(now: Nanos) -> Said {
    Said::foreign(now.plain())
}

/// TRUE or FALSE.
pub(crate) fn truth(value: bool) -> Said {
    Said::foreign(if value { "TRUE" } else { "FALSE" })
}

fn value_text(ty: Type, word: u64) -> String {
    match ty {
        Type::Time => Nanos::new(word as i64).plain(),
        ty => Symbols::value_text(ty, &[word]),
    }
}
