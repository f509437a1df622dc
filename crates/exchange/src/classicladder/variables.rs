//! Finds the meaning of a variable `type/number` in the document and declares the variables that
//! are used.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::ops::Range;

use g7_model::{BinaryOp, Expr, ExprKind, FbKind, Name, Nanos, Said, Span, say};
use g7_model::{Type, UnaryOp, VarDecl, VarKind, codes};

use super::project::{Block, Key, Plan};
use g7_iec::nodes::{self, binary, boolean, call, int, name, not, or};
use g7_iec::report::Report;

/// The kinds of ClassicLadder's variables, by their numbers in the file.
pub(super) mod kind {
    pub(crate) const BIT: u16 = 0;
    pub(crate) const TIMER_DONE: u16 = 10;
    pub(crate) const TIMER_RUNNING: u16 = 11;
    pub(crate) const IEC_DONE: u16 = 15;
    pub(crate) const MONOSTABLE_RUNNING: u16 = 20;
    pub(crate) const COUNTER_DONE: u16 = 25;
    pub(crate) const COUNTER_EMPTY: u16 = 26;
    pub(crate) const COUNTER_FULL: u16 = 27;
    pub(crate) const STEP: u16 = 30;
    pub(crate) const INPUT: u16 = 50;
    pub(crate) const OUTPUT: u16 = 60;
    pub(crate) const LED: u16 = 65;
    pub(crate) const SYSTEM: u16 = 70;
    pub(crate) const FIRST_WORD: u16 = 200;
    pub(crate) const WORD: u16 = 200;
    pub(crate) const STEP_TIME: u16 = 220;
    pub(crate) const TIMER_PRESET: u16 = 230;
    pub(crate) const TIMER_VALUE: u16 = 231;
    pub(crate) const MONOSTABLE_PRESET: u16 = 240;
    pub(crate) const MONOSTABLE_VALUE: u16 = 241;
    pub(crate) const COUNTER_PRESET: u16 = 250;
    pub(crate) const COUNTER_VALUE: u16 = 251;
    pub(crate) const IEC_PRESET: u16 = 260;
    pub(crate) const IEC_VALUE: u16 = 261;
    pub(crate) const WORD_INPUT: u16 = 270;
    pub(crate) const WORD_OUTPUT: u16 = 280;
    pub(crate) const SYSTEM_WORD: u16 = 290;
}

/// The variables used so far.
pub(super) struct Vars<'a> {
    pub(super) plan: &'a Plan,
    /// The steps, by the number that their variables have.
    steps: BTreeMap<u32, bool>,
    pub(super) names: BTreeMap<Key, String>,
    taken: HashSet<String>,
    pub(super) declared: BTreeMap<Key, VarDecl>,
    /// The presets that the program writes.
    presets: BTreeSet<Key>,
    more: Vec<VarDecl>,
    /// The kinds of variables that are read with an index.
    pub(super) tables: BTreeSet<u16>,
    fresh: BTreeMap<&'static str, usize>,
}

/// The letters before and behind the number, as ClassicLadder shows a variable: `%TM3.Q`.
pub(super) fn shown(key: Key) -> Option<(&'static str, &'static str)> {
    Some(match key.0 {
        kind::BIT => ("B", ""),
        kind::TIMER_DONE => ("T", ".D"),
        kind::TIMER_RUNNING => ("T", ".R"),
        kind::IEC_DONE => ("TM", ".Q"),
        kind::MONOSTABLE_RUNNING => ("M", ".R"),
        kind::COUNTER_DONE => ("C", ".D"),
        kind::COUNTER_EMPTY => ("C", ".E"),
        kind::COUNTER_FULL => ("C", ".F"),
        kind::STEP => ("X", ".A"),
        kind::INPUT => ("I", ""),
        kind::OUTPUT => ("Q", ""),
        kind::LED => ("QLED", ""),
        kind::SYSTEM => ("S", ""),
        80 => ("R", ".E"),
        81 => ("R", ".F"),
        kind::WORD => ("W", ""),
        kind::STEP_TIME => ("X", ".V"),
        kind::TIMER_PRESET => ("T", ".P"),
        kind::TIMER_VALUE => ("T", ".V"),
        kind::MONOSTABLE_PRESET => ("M", ".P"),
        kind::MONOSTABLE_VALUE => ("M", ".V"),
        kind::COUNTER_PRESET => ("C", ".P"),
        kind::COUNTER_VALUE => ("C", ".V"),
        kind::IEC_PRESET => ("TM", ".P"),
        kind::IEC_VALUE => ("TM", ".V"),
        kind::WORD_INPUT => ("IW", ""),
        kind::WORD_OUTPUT => ("QW", ""),
        kind::SYSTEM_WORD => ("SW", ""),
        300 => ("R", ".I"),
        301 => ("R", ".O"),
        302 => ("R", ".S"),
        _ => return None,
    })
}

/// `%TM3.Q`.
pub(super) fn title(key: Key) -> String {
    match shown(key) {
        Some((before, behind)) => format!("%{before}{}{behind}", key.1),
        None => format!("{}/{}", key.0, key.1),
    }
}

impl<'a> Vars<'a> {
    pub(super) fn new(plan: &'a Plan, report: &mut Report) -> Vars<'a> {
        let mut vars = Vars {
            plan,
            steps: plan.steps.values().map(|s| (s.number, true)).collect(),
            names: BTreeMap::new(),
            taken: HashSet::new(),
            declared: BTreeMap::new(),
            presets: BTreeSet::new(),
            more: Vec::new(),
            tables: BTreeSet::new(),
            fresh: BTreeMap::new(),
        };
        vars.presets = presets(plan);
        vars.give_symbols(report);
        vars
    }

    /// Assigns the author's names and comments; other variables are named as in ClassicLadder.
    fn give_symbols(&mut self, report: &mut Report) {
        for symbol in &self.plan.symbols {
            let Some(key) = plain_key(&symbol.variable) else {
                if !symbol.variable.is_empty() && symbol.step().is_none() {
                    let what =
                        say!("the name of a variable that is no bit, word, input or output is left out");
                    report.element(&codes::LEFT_OUT, "symbol", &symbol.at, what);
                }
                continue;
            };
            let wanted = nodes::line(&symbol.name.replace('`', "'"));
            if !wanted.is_empty() && !is_step_name(&wanted) && self.taken.insert(wanted.clone()) {
                self.names.insert(key, wanted);
            } else if !wanted.is_empty() {
                let what =
                    say!("a second variable named `{wanted}`; it is called {}", Said::foreign(title(key)));
                report.say(&codes::RENAMED, &symbol.at, what);
            }
            let at = symbol.at.clone();
            self.declare(key, &at, report);
            let comment = nodes::line(&symbol.comment);
            if let Some(decl) = self.declared.get_mut(&key).filter(|_| !comment.is_empty()) {
                decl.comment = Some(comment.into());
            }
        }
    }

    /// A variable that the importer adds: `power_3`.
    pub(super) fn own(&mut self, stem: &'static str, ty: Type, at: Span) -> String {
        let count = self.fresh.entry(stem).or_insert(0);
        loop {
            *count += 1;
            let name = format!("{stem}_{count}");
            if self.taken.insert(name.clone()) {
                self.more.push(nodes::variable(VarKind::Var, &name, ty, at));
                return name;
            }
        }
    }

    /// All declarations: inputs, outputs and memory, then those of function blocks and of the
    /// importer.
    pub(super) fn finish(self) -> Vec<VarDecl> {
        let order = |d: &VarDecl| match d.kind {
            VarKind::Input => 0,
            VarKind::Output => 1,
            VarKind::Var | VarKind::Const => 2,
        };
        let mut all: Vec<VarDecl> = self.declared.into_values().collect();
        all.sort_by_key(order);
        all.extend(self.more);
        all
    }

    /// Declares a plain variable and returns its name.
    pub(super) fn declare(&mut self, key: Key, at: &Range<usize>, report: &mut Report) -> String {
        let plain = title(key).trim_start_matches('%').to_string();
        let name = self.names.get(&key).cloned().unwrap_or_else(|| {
            let mut name = plain.clone();
            while self.taken.contains(&name) {
                name.push('_');
            }
            self.taken.insert(name.clone());
            self.names.insert(key, name.clone());
            name
        });
        if let Entry::Vacant(place) = self.declared.entry(key) {
            let span = report.span(at);
            let (kind, ty) = match key.0 {
                kind::INPUT | kind::SYSTEM => (VarKind::Input, Type::Bool),
                kind::OUTPUT | kind::LED => (VarKind::Output, Type::Bool),
                kind::SYSTEM_WORD | kind::WORD_INPUT => (VarKind::Input, Type::Dint),
                kind::WORD_OUTPUT => (VarKind::Output, Type::Dint),
                kind::WORD => (VarKind::Var, Type::Dint),
                _ => (VarKind::Var, Type::Bool),
            };
            let mut decl = nodes::variable(kind, &name, ty, span);
            if matches!(key.0, kind::SYSTEM | kind::SYSTEM_WORD) {
                let what = say!("the system variable {} becomes an input", Said::foreign(title(key)));
                report.say(&codes::DIFFERENT, at, what);
                decl.address = Some(Name::new(plain, span));
            } else {
                decl.address = Some(Name::new(title(key), span));
            }
            place.insert(decl);
        }
        name
    }

    /// The function block of a timer or monostable.
    pub(super) fn block(
        &mut self,
        letters: &str,
        number: u32,
        ty: FbKind,
        at: &Range<usize>,
        report: &Report,
    ) -> String {
        let name = format!("{letters}{number}");
        if self.taken.insert(format!("block {name}")) {
            self.taken.insert(name.clone());
            self.more.push(nodes::variable(VarKind::Var, &name, Type::Fb(ty), report.span(at)));
        }
        name
    }

    /// A part of a counter, or a preset that the program changes: `C3_V`.
    pub(super) fn part(&mut self, name: &str, ty: Type, init: i64, at: Span) {
        if self.taken.insert(format!("part {name}")) {
            self.taken.insert(name.to_string());
            let mut decl = nodes::variable(VarKind::Var, name, ty, at);
            decl.init = (init != 0).then(|| int(init.into(), at));
            self.more.push(decl);
        }
    }

    /// The numbers of a timer, monostable or counter.
    pub(super) fn numbers(&self, key: Key) -> Block {
        let list = match key.0 {
            kind::TIMER_DONE | kind::TIMER_RUNNING | kind::TIMER_PRESET | kind::TIMER_VALUE => {
                &self.plan.timers
            }
            kind::MONOSTABLE_RUNNING | kind::MONOSTABLE_PRESET | kind::MONOSTABLE_VALUE => {
                &self.plan.monostables
            }
            kind::IEC_DONE | kind::IEC_PRESET | kind::IEC_VALUE => &self.plan.iec_timers,
            _ => &self.plan.counters,
        };
        list.get(&key.1).cloned().unwrap_or(Block { base: 1000, ..Block::default() })
    }

    /// The preset of a timer as TIME.
    pub(super) fn preset_time(&mut self, key: Key, at: &Range<usize>, report: &Report) -> Expr {
        let span = report.span(at);
        let numbers = self.numbers(key);
        let unit = Nanos::from_millis(numbers.base);
        if self.presets.contains(&key) {
            let preset = self.preset_part(key, at, report);
            let number = name(&[&preset], span);
            return binary(BinaryOp::Mul, nodes::time(unit, span), number, span);
        }
        nodes::time(unit * numbers.preset.max(0), span)
    }

    fn preset_part(&mut self, key: Key, at: &Range<usize>, report: &Report) -> String {
        let letters = shown(key).map_or("", |s| s.0);
        let preset = format!("{letters}{}_P", key.1);
        self.part(&preset, Type::Dint, self.numbers(key).preset, report.span(at));
        preset
    }

    /// The kind of function block of a timer.
    pub(super) fn timer_kind(&self, key: Key) -> FbKind {
        match (key.0, self.numbers(key).mode) {
            (kind::IEC_DONE | kind::IEC_PRESET | kind::IEC_VALUE, 1) => FbKind::Tof,
            (kind::IEC_DONE | kind::IEC_PRESET | kind::IEC_VALUE, 2) => FbKind::Tp,
            (kind::MONOSTABLE_RUNNING | kind::MONOSTABLE_PRESET | kind::MONOSTABLE_VALUE, _) => FbKind::Tp,
            _ => FbKind::Ton,
        }
    }

    /// The value of a variable as a Boolean.
    pub(super) fn boolean(&mut self, key: Key, at: &Range<usize>, report: &mut Report) -> Expr {
        let span = report.span(at);
        if key.0 >= kind::FIRST_WORD {
            let number = self.number(key, at, report);
            return binary(BinaryOp::Ne, number, int(0, span), span);
        }
        match key.0 {
            kind::BIT | kind::INPUT | kind::OUTPUT | kind::LED | kind::SYSTEM => {
                let variable = self.declare(key, at, report);
                name(&[&variable], span)
            }
            kind::STEP => self.step(key.1, None, at, report),
            kind::TIMER_DONE | kind::IEC_DONE | kind::MONOSTABLE_RUNNING => {
                let block = self.timer(key, at, report);
                name(&[&block, "Q"], span)
            }
            kind::TIMER_RUNNING => {
                let block = self.timer(key, at, report);
                let done = not(name(&[&block, "Q"], span), span);
                nodes::and(name(&[&block, "IN"], span), done, span)
            }
            kind::COUNTER_DONE | kind::COUNTER_EMPTY | kind::COUNTER_FULL => {
                let part = format!("C{}_{}", key.1, shown(key).map_or("", |s| s.1.trim_start_matches('.')));
                self.part(&part, Type::Bool, 0, span);
                name(&[&part], span)
            }
            _ => self.strange(key, at, report),
        }
    }

    fn timer(&mut self, key: Key, at: &Range<usize>, report: &Report) -> String {
        let letters = shown(key).map_or("T", |s| s.0);
        let ty = self.timer_kind(key);
        self.block(letters, key.1, ty, at, report)
    }

    pub(super) fn strange(&mut self, key: Key, at: &Range<usize>, report: &mut Report) -> Expr {
        report.say(
            &codes::NOT_CARRIED,
            at,
            say!("the variable {} has no counterpart", Said::foreign(title(key))),
        );
        nodes::bad(report.span(at))
    }

    /// The activity of a step or a member of it; a missing step is never active.
    fn step(&mut self, number: u32, member: Option<&str>, at: &Range<usize>, report: &mut Report) -> Expr {
        let span = report.span(at);
        if !self.steps.contains_key(&number) {
            let what = say!("there is no step {number}; its activity is FALSE and its time 0");
            report.say(&codes::LEFT_OUT, at, what);
            return if member.is_some() { nodes::time(Nanos::ZERO, span) } else { boolean(false, span) };
        }
        let step = format!("X{number}");
        match member {
            Some(member) => name(&[&step, member], span),
            None => name(&[&step], span),
        }
    }

    /// The value of a variable as a number.
    pub(super) fn number(&mut self, key: Key, at: &Range<usize>, report: &mut Report) -> Expr {
        let span = report.span(at);
        let divided = |time: Expr, base: i64| {
            let ms = call("TIME_TO_DINT", vec![time], span);
            if base <= 1 { ms } else { binary(BinaryOp::Div, ms, int(base.into(), span), span) }
        };
        match key.0 {
            kind::WORD | kind::WORD_INPUT | kind::WORD_OUTPUT | kind::SYSTEM_WORD => {
                let variable = self.declare(key, at, report);
                name(&[&variable], span)
            }
            kind::STEP_TIME => divided(self.step(key.1, Some("t"), at, report), 1000),
            kind::COUNTER_VALUE | kind::COUNTER_PRESET => {
                let part = self.counter_part(key, at, report);
                name(&[&part], span)
            }
            kind::TIMER_PRESET | kind::MONOSTABLE_PRESET | kind::IEC_PRESET => {
                if self.presets.contains(&key) {
                    let part = self.preset_part(key, at, report);
                    return name(&[&part], span);
                }
                int(self.numbers(key).preset.into(), span)
            }
            kind::IEC_VALUE => {
                let block = self.timer(key, at, report);
                divided(name(&[&block, "ET"], span), self.numbers(key).base)
            }
            // These values count down.
            kind::TIMER_VALUE | kind::MONOSTABLE_VALUE => {
                let block = self.timer(key, at, report);
                let preset = self.preset_time((key.0 - 1, key.1), at, report);
                let left = binary(BinaryOp::Sub, preset, name(&[&block, "ET"], span), span);
                divided(left, self.numbers(key).base)
            }
            k if k < kind::FIRST_WORD => call("BOOL_TO_DINT", vec![self.boolean(key, at, report)], span),
            _ => self.strange(key, at, report),
        }
    }

    /// `C3_V` or `C3_P`.
    pub(super) fn counter_part(&mut self, key: Key, at: &Range<usize>, report: &Report) -> String {
        let value = key.0 == kind::COUNTER_VALUE;
        let part = format!("C{}_{}", key.1, if value { 'V' } else { 'P' });
        let init = if value { 0 } else { self.numbers(key).preset };
        self.part(&part, Type::Dint, init, report.span(at));
        part
    }

    /// The target of an assignment to a variable; reports a problem if it cannot be written.
    pub(super) fn target(&mut self, key: Key, at: &Range<usize>, report: &mut Report) -> Option<Expr> {
        let span = report.span(at);
        match key.0 {
            kind::BIT | kind::OUTPUT | kind::LED | kind::WORD | kind::WORD_OUTPUT => {
                let variable = self.declare(key, at, report);
                Some(name(&[&variable], span))
            }
            kind::COUNTER_VALUE | kind::COUNTER_PRESET => {
                let part = self.counter_part(key, at, report);
                Some(name(&[&part], span))
            }
            kind::TIMER_PRESET | kind::MONOSTABLE_PRESET | kind::IEC_PRESET => {
                self.presets.insert(key);
                let part = self.preset_part(key, at, report);
                Some(name(&[&part], span))
            }
            _ => {
                report.say(
                    &codes::NOT_CARRIED,
                    at,
                    say!("writing {} has no counterpart", Said::foreign(title(key))),
                );
                None
            }
        }
    }
}

/// The presets that some expression writes.
fn presets(plan: &Plan) -> BTreeSet<Key> {
    let written = |text: &str| {
        let (kind, rest) = text.trim_start().strip_prefix('@')?.split_once('/')?;
        let (number, _) = rest.split_once('@')?;
        let key: Key = (kind.parse().ok()?, number.parse().ok()?);
        matches!(key.0, kind::TIMER_PRESET | kind::MONOSTABLE_PRESET | kind::IEC_PRESET).then_some(key)
    };
    let mut keys: BTreeSet<Key> = plan.expressions.values().filter_map(|(text, _)| written(text)).collect();
    // The preset of a timer is also looked up under the kind of its output.
    let more: Vec<Key> = keys
        .iter()
        .filter_map(|&(k, n)| match k {
            kind::TIMER_PRESET => Some((kind::TIMER_DONE, n)),
            kind::MONOSTABLE_PRESET => Some((kind::MONOSTABLE_RUNNING, n)),
            kind::IEC_PRESET => Some((kind::IEC_DONE, n)),
            _ => None,
        })
        .collect();
    keys.extend(more);
    keys
}

/// Reads `%I3` in a list of symbols, for plain variables.
fn plain_key(text: &str) -> Option<Key> {
    let name = text.strip_prefix('%')?;
    let digits = name.find(|c: char| c.is_ascii_digit())?;
    let (letters, number) = name.split_at(digits);
    let kind = match letters {
        "B" => kind::BIT,
        "I" => kind::INPUT,
        "Q" => kind::OUTPUT,
        "QLED" => kind::LED,
        "W" => kind::WORD,
        "IW" => kind::WORD_INPUT,
        "QW" => kind::WORD_OUTPUT,
        _ => return None,
    };
    Some((kind, number.parse().ok()?))
}

/// True if a name is `X12`, which means the activity of a step.
fn is_step_name(name: &str) -> bool {
    name.strip_prefix('X').is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

/// Collects the names of the variables that an expression reads.
pub(super) fn reads(e: &Expr, into: &mut BTreeSet<String>) {
    match &e.kind {
        ExprKind::Path(p) => {
            into.extend(p.names.first().map(|n| n.text.to_string()));
        }
        ExprKind::Unary(_, a) => reads(a, into),
        ExprKind::Binary(_, a, b) => {
            reads(a, into);
            reads(b, into);
        }
        ExprKind::Call(p, args) => {
            // A function that selects a variable reads all of its kind.
            into.insert(p.text());
            args.iter().for_each(|a| reads(&a.value, into));
        }
        _ => {}
    }
}

/// An edge as `v and not old`, without the language's own edge.
pub(super) fn changed(value: Expr, old: &str, rising: bool, at: Span) -> Expr {
    let before = name(&[old], at);
    if rising {
        nodes::and(value, nodes::unary(UnaryOp::Not, before, at), at)
    } else {
        nodes::and(nodes::unary(UnaryOp::Not, value, at), before, at)
    }
}

/// `a or b`, or `b` alone.
pub(super) fn either(a: Option<Expr>, b: Expr, at: Span) -> Expr {
    match a {
        Some(a) => or(a, b, at),
        None => b,
    }
}
