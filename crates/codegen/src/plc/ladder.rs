//! The equations as rungs of Ladder: contacts in series and parallel, coils,
//! and blocks for what is not Boolean. `ld` writes them as PLCopen XML,
//! `drawn` as a picture.

use std::collections::HashSet;

use g7_model::{Problem, Said, Span, StandardFunction, codes, say};

use super::form::{self, Declared, Ex, St};
use super::st::{FAULT_COMES, expression};
use super::variables::Variables;

/// An element that power flows through.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Net {
    Wire,
    Contact { name: String, negated: bool },
    Series(Vec<Net>),
    Parallel(Vec<Net>),
}

/// The effect of a coil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coil {
    Plain,
    Set,
    Reset,
}

/// A function or function block that power enables.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) ty: String,
    pub(crate) instance: Option<String>,
    pub(crate) inputs: Vec<(String, String)>,
    /// Where its result goes.
    pub(crate) output: Option<(String, String)>,
    /// The output of a function block, and the memory of a coil behind it, which nothing reads. The generator of
    /// Beremiz calls a block in its turn if a coil follows it, else behind all coils.
    pub(crate) behind: Option<(&'static str, String)>,
}

/// The element at the right end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum End {
    Coil(String, Coil),
    Block(Block),
}

/// One rung.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rung {
    pub(crate) title: String,
    pub(crate) note: String,
    pub(crate) net: Net,
    pub(crate) end: End,
}

/// The rungs with the declarations they need.
#[derive(Debug)]
pub(crate) struct Ladder {
    pub(crate) variables: Vec<Declared>,
    pub(crate) rungs: Vec<Rung>,
}

/// The search for stability, which has no form in Ladder, and the way out.
fn search() -> (Said, Option<Said>) {
    let one_pass = say!(
        "`--profile iec61131` prints the chart with one pass in a scan; \
         `g7 compare --profiles iec60848,iec61131` tells whether its outputs stay the same"
    );
    (say!("a search for stability, which is a loop, cannot be printed as Ladder"), Some(one_pass))
}

/// Equations as rungs. If `plain`, no branch has branches: what stands there gets a rung and a memory of its own,
/// because the generator of Beremiz cannot sort such ways.
///
/// # Errors
///
/// A construct that Ladder cannot say.
pub(crate) fn ladder(e: &form::Block, place: Span, plain: bool) -> Result<Ladder, Vec<Problem>> {
    let mut l = Maker {
        variables: Variables::new(e.variables.clone()),
        rungs: Vec::new(),
        when: Ex::Bool(true),
        title: String::new(),
        note: String::new(),
        kept: HashSet::new(),
        behind: None,
        plain,
        refused: None,
    };
    for part in &e.parts {
        // Not a RETURN, which the generator of Beremiz leaves out.
        let when = if e.safe.is_some() { Ex::var("FAULT").not() } else { Ex::Bool(true) };
        l.act(&when, part);
        if let Some(safe) = &e.safe {
            l.remark(&St::Note(FAULT_COMES.to_owned()));
            l.act(&Ex::var("FAULT"), safe);
        }
    }
    match l.refused {
        Some((what, help)) => {
            let mut problem = Problem::new(&codes::NOT_CARRIED, place, what);
            problem.help = help;
            Err(vec![problem])
        }
        None => Ok(Ladder { variables: l.variables.into_list(), rungs: l.rungs }),
    }
}

struct Maker {
    variables: Variables,
    rungs: Vec<Rung>,
    /// When the blocks of a value work: its divisor may be zero otherwise, or it may
    /// leave the range.
    when: Ex,
    /// Title and comment of the next rung.
    title: String,
    note: String,
    /// The memories of conditions, each of which one rung writes.
    kept: HashSet<String>,
    /// The memory of the coils behind function blocks.
    behind: Option<String>,
    /// No branch has branches.
    plain: bool,
    /// A construct without a form in Ladder, and the way out.
    refused: Option<(Said, Option<Said>)>,
}

impl Maker {
    fn remark(&mut self, s: &St) {
        match s {
            St::Title(text) => self.title.clone_from(text),
            St::Note(text) => self.note.clone_from(text),
            _ => {}
        }
    }

    fn push(&mut self, net: Net, end: End) {
        let (title, note) = (std::mem::take(&mut self.title), std::mem::take(&mut self.note));
        self.rungs.push(Rung { title, note, net, end });
    }

    fn coil(&mut self, e: &Ex, to: &str, coil: Coil) {
        let Some(net) = self.net(e, false) else {
            // Never any power: a plain coil is off, the others do nothing.
            if coil == Coil::Plain {
                self.push(Net::Wire, End::Coil(to.to_owned(), Coil::Reset));
            }
            return;
        };
        self.push(net, End::Coil(to.to_owned(), coil));
    }

    /// A condition whose value is kept while statements run.
    fn kept(&mut self, e: &Ex) -> Ex {
        match e {
            Ex::Bool(_) => e.clone(),
            Ex::Var(name) if self.kept.contains(name) => e.clone(),
            e => {
                let name = self.variables.memory("BOOL");
                self.coil(e, &name, Coil::Plain);
                self.kept.insert(name.clone());
                Ex::Var(name)
            }
        }
    }

    fn act(&mut self, when: &Ex, body: &[St]) {
        let many = body.iter().filter(|s| !s.is_remark()).count() > 1;
        let when = if many { self.kept(when) } else { when.clone() };
        let always = when == Ex::Bool(true);
        for s in body {
            if let Some((c, name, on)) = s.latch().filter(|(c, ..)| always || !c.calculates()) {
                let coil = if on { Coil::Set } else { Coil::Reset };
                self.coil(&when.clone().and(c.clone()), name, coil);
                continue;
            }
            match s {
                St::Title(_) | St::Note(_) => self.remark(s),
                St::Assign(Ex::Var(name), e) if always && self.variables.type_of(name) == "BOOL" => {
                    let resets = *e == Ex::Bool(false);
                    let (e, coil) = if resets { (&Ex::Bool(true), Coil::Reset) } else { (e, Coil::Plain) };
                    self.coil(e, name, coil);
                }
                St::Assign(to, e) if e.calculates() && when != Ex::Bool(true) => {
                    let when = self.kept(&when);
                    self.within(&when, |l| l.assign(&when, &expression(to), to, e));
                }
                St::Assign(to, e) => self.assign(&when, &expression(to), to, e),
                St::If(c, then, other) => {
                    if then.iter().chain(other).all(St::is_remark) {
                        continue;
                    }
                    let outer = self.kept(&when);
                    let c = if c.calculates() { self.within(&outer, |l| l.kept(c)) } else { self.kept(c) };
                    self.act(&outer.clone().and(c.clone()), then);
                    self.act(&outer.and(c.not()), other);
                }
                St::Call(name, inputs) => {
                    let ty = self.variables.type_of(name).to_owned();
                    let mut operands = Vec::new();
                    for (formal, e) in inputs {
                        operands.push((formal.clone(), self.operand(e)));
                    }
                    let memory = self.behind.take().unwrap_or_else(|| self.variables.memory("BOOL"));
                    self.behind = Some(memory.clone());
                    let behind = Some((first_output(&ty), memory));
                    let instance = Some(name.clone());
                    let block = Block { ty, instance, inputs: operands, output: None, behind };
                    self.block(&when, block);
                }
                St::Until(..) => {
                    self.refused = Some(search());
                }
                St::Loop(_) | St::Exit => {
                    self.refused = Some((say!("a loop cannot be printed as Ladder"), None))
                }
            }
        }
    }

    /// Values that are worked out only where the condition, a contact, holds.
    fn within<R>(&mut self, when: &Ex, work: impl FnOnce(&mut Self) -> R) -> R {
        let outer = std::mem::replace(&mut self.when, when.clone());
        let result = work(self);
        self.when = outer;
        result
    }

    fn block(&mut self, when: &Ex, block: Block) {
        if let Some(net) = self.net(when, false) {
            self.push(net, End::Block(block));
        }
    }

    fn assign(&mut self, when: &Ex, to: &str, place: &Ex, e: &Ex) {
        if matches!(place, Ex::Var(n) if self.variables.type_of(n) == "BOOL") {
            return match e {
                Ex::Bool(on) => self.coil(when, to, if *on { Coil::Set } else { Coil::Reset }),
                e => {
                    let when = self.kept(when);
                    let holds = when.clone().not().and(place.clone());
                    self.coil(&when.and(e.clone()).or(holds), to, Coil::Plain);
                }
            };
        }
        let mut block = self.value(e);
        block.output = Some(("OUT".into(), to.to_owned()));
        self.block(when, block);
    }

    /// A value as a block; what it consists of comes before it.
    fn value(&mut self, e: &Ex) -> Block {
        let plain = |ty: &str, inputs: Vec<(String, String)>| Block {
            ty: ty.into(),
            instance: None,
            inputs,
            output: None,
            behind: None,
        };
        match e {
            Ex::Op(sign, a, b) => {
                let ty = match *sign {
                    "+" => "ADD",
                    "-" => "SUB",
                    "*" => "MUL",
                    "/" => "DIV",
                    "=" => "EQ",
                    "<>" => "NE",
                    "<" => "LT",
                    "<=" => "LE",
                    ">" => "GT",
                    ">=" => "GE",
                    other => other,
                };
                let (a, b) = (self.operand_of(e, a), self.operand_of(e, b));
                plain(ty, vec![("IN1".into(), a), ("IN2".into(), b)])
            }
            Ex::Neg(inner) => {
                let zero = if self.variables.type_name(inner).ends_with("REAL") { "0.0" } else { "0" };
                let inner = self.operand(inner);
                plain("SUB", vec![("IN1".into(), zero.into()), ("IN2".into(), inner)])
            }
            Ex::Call(name, args) => {
                let row = StandardFunction::named(name).map(StandardFunction::row);
                let formal = (0..args.len()).map(|k| row.and_then(|r| r.input(k)).unwrap_or("IN".into()));
                let mut inputs = Vec::new();
                for (formal, arg) in formal.zip(args) {
                    inputs.push((formal, self.operand_of(e, arg)));
                }
                plain(name, inputs)
            }
            e => plain("MOVE", vec![("IN".into(), expression(e))]),
        }
    }

    /// A value as a variable or literal.
    fn operand(&mut self, e: &Ex) -> String {
        let ty = self.variables.type_name(e).to_owned();
        self.operand_as(e, &ty)
    }

    /// An input of a block, the same way.
    fn operand_of(&mut self, of: &Ex, e: &Ex) -> String {
        let ty = self.variables.operand_type(of, e).to_owned();
        self.operand_as(e, &ty)
    }

    fn operand_as(&mut self, e: &Ex, ty: &str) -> String {
        match e {
            Ex::Bool(_)
            | Ex::Int(_)
            | Ex::Bits(..)
            | Ex::Real(_)
            | Ex::Time(_)
            | Ex::Var(_)
            | Ex::Index(..) => expression(e),
            Ex::And(_) | Ex::Or(_) | Ex::Not(_) | Ex::Xor(..) => expression(&self.kept(e)),
            e => {
                let name = self.variables.memory(ty);
                let mut block = self.value(e);
                block.output = Some(("OUT".into(), name.clone()));
                let when = self.when.clone();
                self.block(&when, block);
                name
            }
        }
    }

    /// Contacts; `None` where no power ever comes through.
    fn net(&mut self, e: &Ex, negated: bool) -> Option<Net> {
        match e {
            Ex::Bool(b) => (*b != negated).then_some(Net::Wire),
            Ex::Not(e) => self.net(e, !negated),
            Ex::And(list) | Ex::Or(list) if matches!(e, Ex::And(_)) != negated => {
                let parts: Option<Vec<Net>> = list.iter().map(|e| self.net(e, negated)).collect();
                Some(series(parts?))
            }
            Ex::And(list) | Ex::Or(list) => {
                let mut parts = Vec::new();
                for e in list {
                    match self.net(e, negated) {
                        Some(Net::Parallel(inner)) => parts.extend(inner),
                        net => parts.extend(net.map(|net| self.branch(net))),
                    }
                }
                if parts.is_empty() { None } else { Some(parallel(parts)) }
            }
            Ex::Xor(a, b) => {
                let (a0, a1) = (self.net(a, false)?, self.net(a, true)?);
                let (b0, b1) = (self.net(b, negated)?, self.net(b, !negated)?);
                let one = self.branch(series(vec![a0, b1]));
                Some(Net::Parallel(vec![one, self.branch(series(vec![a1, b0]))]))
            }
            Ex::Var(_) | Ex::Index(..) => Some(Net::Contact { name: expression(e), negated }),
            other => {
                let name = self.operand(other);
                Some(Net::Contact { name, negated })
            }
        }
    }

    /// A network as a branch.
    fn branch(&mut self, net: Net) -> Net {
        if !self.plain || !has_branches(&net) {
            return net;
        }
        let name = self.variables.memory("BOOL");
        self.push(net, End::Coil(name.clone(), Coil::Plain));
        Net::Contact { name, negated: false }
    }
}

/// The first Boolean output of a kind of function block.
fn first_output(kind: &str) -> &'static str {
    match kind {
        "CTUD" => "QU",
        "SR" | "RS" => "Q1",
        _ => "Q",
    }
}

fn has_branches(net: &Net) -> bool {
    match net {
        Net::Wire | Net::Contact { .. } => false,
        Net::Series(list) => list.iter().any(has_branches),
        Net::Parallel(_) => true,
    }
}

/// Parts of a series, without a series in it.
fn series(parts: Vec<Net>) -> Net {
    let mut list = Vec::new();
    for part in parts {
        match part {
            Net::Wire => {}
            Net::Series(inner) => list.extend(inner),
            other => list.push(other),
        }
    }
    match list.len() {
        0 => Net::Wire,
        1 => list.remove(0),
        _ => Net::Series(list),
    }
}

/// Branches, which are a wire if one of them is.
fn parallel(mut list: Vec<Net>) -> Net {
    match list.len() {
        _ if list.contains(&Net::Wire) => Net::Wire,
        1 => list.remove(0),
        _ => Net::Parallel(list),
    }
}
