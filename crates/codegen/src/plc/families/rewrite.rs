//! The equations in the words of a maker: each expression rewritten, from the inside out, and what cannot be said
//! collected for one refusal.

use std::collections::BTreeSet;

use g7_model::{Problem, Said, Span, codes, say};

use crate::plc::form::{Block, Ex, St};

/// The parts that a language cannot say, once each.
#[derive(Debug, Default)]
pub(super) struct Refused(BTreeSet<Said>);

impl Refused {
    pub(super) fn add(&mut self, what: Said) {
        self.0.insert(what);
    }

    /// The problems, all at `place`.
    pub(super) fn problems(self, place: Span) -> Result<(), Vec<Problem>> {
        if self.0.is_empty() {
            return Ok(());
        }
        Err(self.0.into_iter().map(|what| Problem::new(&codes::NOT_CARRIED, place, what)).collect())
    }
}

/// A TIME in milliseconds, where it is a whole number of them that 32 bits hold.
pub(super) fn millis(e: &Ex) -> Option<i32> {
    let Ex::Time(time) = e else { return None };
    let nanos = time.count();
    i32::try_from(nanos / 1_000_000).ok().filter(|_| nanos % 1_000_000 == 0)
}

/// Refuses a TIME that a count of milliseconds cannot hold.
pub(super) fn timed(e: Ex, refused: &mut Refused) -> Ex {
    if matches!(e, Ex::Time(_)) && millis(&e).is_none() {
        refused.add(say!("a TIME below a millisecond or above 24 days: TIME counts milliseconds there"));
    }
    e
}

/// The block with its expressions rewritten by `f`; a place that is assigned to is one of them.
pub(super) fn block(e: &Block, f: &mut dyn FnMut(Ex) -> Ex) -> Block {
    let mut out = e.clone();
    out.parts.iter_mut().chain(out.safe.as_mut()).for_each(|list| statements(list, f));
    for v in &mut out.variables {
        v.init.iter_mut().for_each(|e| expression(e, f));
    }
    out
}

fn statements(list: &mut [St], f: &mut dyn FnMut(Ex) -> Ex) {
    for s in list {
        match s {
            St::Title(_) | St::Note(_) | St::Exit => {}
            St::Assign(to, e) => {
                expression(to, f);
                expression(e, f);
            }
            St::If(c, a, b) => {
                expression(c, f);
                statements(a, f);
                statements(b, f);
            }
            St::Loop(a) => statements(a, f),
            St::Until(a, c) => {
                statements(a, f);
                expression(c, f);
            }
            St::Call(name, inputs) => {
                if let Ex::Var(own) = f(Ex::var(&**name)) {
                    *name = own;
                }
                inputs.iter_mut().for_each(|(_, e)| expression(e, f));
            }
        }
    }
}

fn expression(e: &mut Ex, f: &mut dyn FnMut(Ex) -> Ex) {
    e.inner_mut().into_iter().for_each(|inner| expression(inner, f));
    let own = std::mem::replace(e, Ex::Bool(false));
    *e = f(own);
}
