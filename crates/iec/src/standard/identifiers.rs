//! Identifiers of IEC 61131-3: letters, digits and single `_`; case is ignored. Names that a
//! program declares are visible only in it, all others everywhere.

use std::collections::{HashMap, HashSet};

use g7_model::{Function, Name, Span};

use crate::nodes::Taken;
use crate::scopes::{Scopes, StepKey};
use crate::words::identifier;

/// Members of steps, and of the blocks that actions are written with. In the code that matiec makes, each step
/// is a macro of C, which would stand for a member of its name as well.
const MEMBERS: [&str; 8] = ["X", "T", "IN", "PT", "Q", "ET", "CLK", "M"];

/// The names given so far.
pub(super) struct Names {
    reserved: HashSet<&'static str>,
    /// Names that all programs see, in upper case.
    global: HashSet<String>,
    /// Names of each program, in upper case.
    programs: Vec<HashSet<String>>,
    vars: HashMap<(Option<usize>, Box<str>), String>,
    /// The names of variables with a structure that stay one variable.
    wholes: HashMap<(Option<usize>, Box<str>), String>,
    steps: HashMap<StepKey, String>,
    /// Named actions and sections.
    parts: HashMap<(Option<usize>, Box<str>), String>,
    functions: HashMap<Box<str>, String>,
    /// The names of the parameters and local variables of a function.
    inner: HashMap<(Box<str>, Box<str>), String>,
    /// The names of variables and of steps, in upper case.
    of_vars: HashSet<(Owner, String)>,
    of_steps: HashSet<(Owner, String)>,
    /// Steps with the name of a variable.
    twins: HashSet<StepKey>,
    /// The last number given for each name, so that many equal names do not take quadratic time.
    counts: HashMap<(Owner, String), usize>,
    /// The names of programs that are units of their own.
    units: Taken,
    /// The same names, in upper case: no variable of all programs has one of them.
    of_units: HashSet<String>,
    /// Changed names: the place, the old and the new name.
    pub(super) renamed: Vec<(Span, Box<str>, String)>,
}

/// The owner of a name: a program, or None for all programs.
pub(super) type Owner = Option<usize>;

impl Names {
    /// No names yet, for a document with so many programs, none of which may have one of these words.
    pub(super) fn new(programs: usize, reserved: HashSet<&'static str>) -> Names {
        Names {
            reserved,
            global: HashSet::new(),
            programs: vec![HashSet::new(); programs],
            vars: HashMap::new(),
            wholes: HashMap::new(),
            steps: HashMap::new(),
            parts: HashMap::new(),
            functions: HashMap::new(),
            inner: HashMap::new(),
            of_vars: HashSet::new(),
            of_steps: HashSet::new(),
            twins: HashSet::new(),
            counts: HashMap::new(),
            units: Taken::default(),
            of_units: HashSet::new(),
            renamed: Vec::new(),
        }
    }

    /// True if a program or the file gives the name to something.
    fn declares(&self, owner: Owner, upper: &str) -> bool {
        let inside = owner.and_then(|p| self.programs.get(p)).is_some_and(|p| p.contains(upper));
        inside || self.global.contains(upper)
    }

    fn has(&self, owner: Owner, upper: &str) -> bool {
        let inside = match owner {
            Some(program) => self.programs.get(program).is_some_and(|p| p.contains(upper)),
            None => self.programs.iter().any(|p| p.contains(upper)),
        };
        let unit = owner.is_none() && self.of_units.contains(upper);
        inside || unit || self.reserved.contains(upper) || self.global.contains(upper)
    }

    /// Gives a name derived from `wish` that is not taken.
    pub(super) fn free(&mut self, owner: Owner, wish: &str) -> String {
        let wish = identifier(wish);
        let mut text = wish.clone();
        let key = (owner, wish.to_ascii_uppercase());
        let mut number = self.counts.get(&key).copied().unwrap_or(1);
        while self.has(owner, &text.to_ascii_uppercase()) {
            number += 1;
            text = format!("{}_{number}", wish.trim_end_matches('_'));
        }
        self.counts.insert(key, number);
        let upper = text.to_ascii_uppercase();
        match owner.and_then(|p| self.programs.get_mut(p)) {
            Some(program) => program.insert(upper),
            None => self.global.insert(upper),
        };
        text
    }

    /// Gives a name as close to the author's as possible.
    pub(super) fn give(&mut self, owner: Owner, name: &Name, prefix: &str, start: &str) -> String {
        let plain = identifier(&format!("{start}{}", name.text));
        let taken = self.has(owner, &plain.to_ascii_uppercase()) && !prefix.is_empty();
        let text =
            if taken { self.free(owner, &format!("{prefix}_{plain}")) } else { self.free(owner, &plain) };
        if *text != *name.text {
            self.renamed.push((name.at.0, name.text.clone(), text.clone()));
        }
        text
    }

    /// Takes a name that something else has already.
    pub(super) fn reserve(&mut self, name: &str) {
        self.global.insert(name.to_ascii_uppercase());
    }

    /// The name of a program whose own names may be equal to it.
    pub(super) fn give_unit(&mut self, name: &Name) -> String {
        let wish = identifier(&name.text);
        let text = loop {
            let text = self.units.give(&wish);
            let upper = text.to_ascii_uppercase();
            if !self.reserved.contains(upper.as_str()) && !self.global.contains(&upper) {
                self.of_units.insert(upper);
                break text;
            }
        };
        if *text != *name.text {
            self.renamed.push((name.at.0, name.text.clone(), text.clone()));
        }
        text
    }

    pub(super) fn give_var(&mut self, owner: Owner, chart: Option<usize>, name: &Name, prefix: &str) {
        let text = self.give(owner, name, prefix, "");
        self.of_vars.insert((owner, text.to_ascii_uppercase()));
        self.vars.insert((chart, name.text.clone()), text);
    }

    /// The name of a member of a structure: `behind` that of its variable, which has one name for all its members.
    pub(super) fn give_member(
        &mut self,
        owner: Owner,
        chart: Option<usize>,
        name: &Name,
        (variable, slot, behind): (&str, &str, &str),
        prefix: &str,
    ) {
        let key = (chart, variable.into());
        let whole = match self.wholes.get(&key) {
            Some(whole) => whole.clone(),
            None => {
                let whole = self.give(owner, &Name { text: variable.into(), at: name.at }, prefix, "");
                self.of_vars.insert((owner, whole.to_ascii_uppercase()));
                self.wholes.insert(key, whole.clone());
                whole
            }
        };
        self.vars.insert((chart, name.text.clone()), format!("{whole}{slot}{behind}"));
    }

    pub(super) fn give_part(&mut self, owner: Owner, chart: Option<usize>, name: &Name, prefix: &str) {
        let text = self.give(owner, name, prefix, "");
        self.parts.insert((chart, name.text.clone()), text);
    }

    /// The name of a function, and those that only it sees.
    pub(super) fn give_function(&mut self, f: &Function) {
        let text = self.give(None, &f.name, "", "");
        let mut taken = Taken::default();
        taken.take(&text);
        self.functions.insert(f.name.text.clone(), text);
        let locals = f.body.locals.iter().flat_map(|l| &l.names);
        for name in f.params.iter().map(|p| &p.name).chain(locals) {
            let wish = identifier(&name.text);
            let own = loop {
                let own = taken.give(&wish);
                if !self.reserved.contains(own.to_ascii_uppercase().as_str()) {
                    break own;
                }
            };
            self.inner.insert((f.name.text.clone(), name.text.clone()), own);
        }
    }

    /// Names of steps. A step of which `Fill.X` or `Fill.T` is read shares one name space with
    /// variables, because `Fill` would be the variable there. Any other step may have the name of a
    /// variable, if `apart` says that it is not read. `macros` says that steps are macros of C there.
    pub(super) fn give_steps(
        &mut self,
        owner: Owner,
        chart: usize,
        prefix: &str,
        scopes: &Scopes,
        macros: bool,
        apart: impl Fn(StepKey) -> bool,
    ) {
        for (key, step) in scopes.steps_of(chart) {
            let digit = step.name.text.starts_with(|c: char| c.is_ascii_digit());
            let member = macros && MEMBERS.contains(&step.name.text.to_ascii_uppercase().as_str());
            let start = match (digit, member) {
                (true, _) => "Step",
                (false, true) => "Step_",
                (false, false) => "",
            };
            let plain = identifier(&format!("{start}{}", step.name.text));
            let upper = plain.to_ascii_uppercase();
            let of_var = self.of_vars.contains(&(owner, upper.clone()))
                || self.of_vars.contains(&(None, upper.clone()));
            // A step is never called, so it may have the name of a standard function as well.
            let of_function = crate::words::is_function(&upper) && !self.declares(owner, &upper);
            let free = (of_var || of_function) && !self.of_steps.contains(&(owner, upper));
            let text = if free && apart(key) {
                self.twins.insert(key);
                if *plain != *step.name.text {
                    self.renamed.push((step.name.at.0, step.name.text.clone(), plain.clone()));
                }
                plain
            } else {
                self.give(owner, &step.name, prefix, start)
            };
            self.of_steps.insert((owner, text.to_ascii_uppercase()));
            self.steps.insert(key, text);
        }
    }

    /// True if a step has the name of a variable.
    pub(super) fn is_twin(&self, key: StepKey) -> bool {
        self.twins.contains(&key)
    }

    pub(super) fn var(&self, chart: Option<usize>, name: &str) -> Option<&str> {
        self.vars.get(&(chart, name.into())).map(String::as_str)
    }

    pub(super) fn part(&self, chart: Option<usize>, name: &str) -> Option<&str> {
        self.parts.get(&(chart, name.into())).map(String::as_str)
    }

    pub(super) fn step(&self, key: StepKey) -> &str {
        self.steps.get(&key).map_or("", String::as_str)
    }

    pub(super) fn function(&self, name: &str) -> Option<&str> {
        self.functions.get(name).map(String::as_str)
    }

    /// A name that only its function sees; `None` for one that it does not have.
    pub(super) fn inner(&self, function: &str, name: &str) -> Option<&str> {
        self.inner.get(&(function.into(), name.into())).map(String::as_str)
    }
}
