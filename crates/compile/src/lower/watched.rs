//! The watches made so far: by what two are the same, and what each reads.
//!
//! `watches` makes them; this file only keeps them.

use std::collections::HashMap;

use g7_engine::{Addr, GroupId, Op, StepId as Number, WatchId};
use g7_model::Type;

use super::words::words_of;
use crate::tree::{Clock, Expr, ExprKind};

/// All that a watched expression reads.
#[derive(Default)]
pub(super) struct Reads {
    pub(super) words: Vec<Addr>,
    pub(super) steps: Vec<Number>,
    pub(super) groups: Vec<GroupId>,
    pub(super) watches: Vec<WatchId>,
    /// It reads a time or a random number, which may differ in each scan.
    pub(super) time: bool,
}

impl Reads {
    /// `locals`: the first word that is set anew at each run. A value left in
    /// such a word decides nothing.
    pub(super) fn add(&mut self, e: &Expr, locals: u32) {
        e.visit(&mut |e| match &e.kind {
            ExprKind::Word(_, addr) => self.range(*addr, 1, locals),
            ExprKind::Element { base, len, .. } => self.range(*base, *len, locals),
            ExprKind::Text(addr, cap) => self.range(*addr, words_of(Type::String(*cap)), locals),
            ExprKind::Active(step) | ExprKind::WasActive(step) => self.steps.push(*step),
            ExprKind::GroupActive(group) => self.groups.push(*group),
            // A time goes on by itself, and starts anew within a scan.
            ExprKind::Time(Clock::Step(step) | Clock::StepAge(step) | Clock::StepScans(step))
            | ExprKind::Tenths(step) => {
                self.steps.push(*step);
                self.time = true;
            }
            ExprKind::Time(Clock::Group(group) | Clock::GroupAge(group) | Clock::GroupScans(group)) => {
                self.groups.push(*group);
                self.time = true;
            }
            ExprKind::Rise(watch) | ExprKind::Fall(watch) | ExprKind::Timer(watch) => {
                self.watches.push(*watch);
            }
            ExprKind::ScanTime | ExprKind::Random(_) => self.time = true,
            _ => {}
        });
    }

    fn range(&mut self, base: Addr, len: u32, locals: u32) {
        if base.0 < locals {
            self.words.extend((base.0..base.0 + len).map(Addr));
        }
    }
}

/// Two watches with the same key are one.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct Key {
    pub(super) period: u32,
    pub(super) code: Vec<Op>,
    pub(super) times: Option<(Vec<Op>, Vec<Op>)>,
}

/// The watches made so far.
#[derive(Default)]
pub(super) struct Watches {
    pub(super) known: HashMap<Key, WatchId>,
    /// Edges of a single word, by far the most.
    pub(super) of_words: HashMap<(u32, Addr), WatchId>,
    /// By watch.
    pub(super) reads: Vec<Reads>,
}
