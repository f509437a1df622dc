//! The table of types: each name once, and no type within itself.

use std::collections::HashMap;

use super::base::{Composition, MOST};
use crate::{Composed, Document, Name, Problem, Span, Type, VarDecl, codes, say};

/// How deep types can stand in each other.
pub const DEEP: usize = 64;

impl<'d> Composition<'d> {
    /// Collects the types. A type that is wrong as such has no members for what follows.
    pub(super) fn types(&mut self, document: &'d Document) {
        let composed = || document.composed();
        for c in composed().filter(|c| !c.name.text.is_empty()) {
            let name = &c.name.text;
            if let Some(problem) = of_language(&c.name) {
                self.problems.push(problem);
                continue;
            }
            if let Some(first) = self.types.get(&**name).map(|t| t.name.at.0) {
                self.twice(&c.name, first);
                continue;
            }
            self.members(c);
            self.types.insert(name, c);
        }
        let mut depths = HashMap::new();
        for c in composed() {
            let mut on_the_way = Vec::new();
            self.depth(c, &mut on_the_way, &mut depths);
        }
        let wrong = |name: &&str| depths.get(name).is_none_or(|d| *d >= DEEP);
        self.wrong = self.types.keys().copied().filter(wrong).collect();
        self.types.retain(|name, _| !wrong(name));
        let named = composed().flat_map(|c| c.members.iter().chain(&c.inouts)).filter_map(|m| m.of.as_ref());
        for of in named {
            if !self.types.contains_key(&*of.text) && !self.wrong.contains(&*of.text) {
                self.unknown_type(of);
            }
        }
    }

    fn twice(&mut self, name: &Name, first: Span) {
        self.problems.push(defined_twice(name, first));
    }

    fn members(&mut self, c: &'d Composed) {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        let locals = c.body.iter().flat_map(|b| &b.block().locals).flat_map(|l| &l.names);
        let members = c.members.iter().chain(&c.inouts).flat_map(|m| &m.names);
        for name in members.chain(locals).filter(|n| !n.text.is_empty()) {
            match seen.get(&*name.text).copied() {
                Some(first) => self.twice(name, first),
                None => _ = seen.insert(&name.text, name.at.0),
            }
        }
    }

    /// How deep the types stand in each other below this one; reports those that stand in themselves.
    fn depth(
        &mut self,
        c: &'d Composed,
        way: &mut Vec<&'d Composed>,
        depths: &mut HashMap<&'d str, usize>,
    ) -> usize {
        let name = &*c.name.text;
        if let Some(depth) = depths.get(name) {
            return *depth;
        }
        if let Some(place) = way.iter().position(|on| *on.name.text == *name) {
            let what = say!("`{name}` has a variable of its own type");
            let mut problem = Problem::new(&codes::RECURSION, c.name.at.0, what);
            for on in way.iter().skip(place + 1) {
                problem = problem.related(on.name.at.0, say!("by way of `{}`", on.name.text));
            }
            self.problems.push(problem.help(say!(
                "a variable of a type holds all of its members, so none can be of the type itself"
            )));
            return DEEP;
        }
        if way.len() >= DEEP {
            self.too_deep(c);
            return DEEP;
        }
        way.push(c);
        let charts = self.owned.get(name).into_iter().flatten().flat_map(|chart| chart.vars());
        let of: Vec<&VarDecl> = c.members.iter().chain(charts).filter(|m| m.of.is_some()).collect();
        let inner: Vec<&'d Composed> = of.iter().filter_map(|m| self.type_of(m)).collect();
        let deepest = inner.into_iter().map(|t| self.depth(t, way, depths)).max();
        way.pop();
        let held = |m: &VarDecl| match &m.of {
            Some(of) => self.blocks.contains(&*of.text),
            None => matches!(m.ty, Type::Fb(_)),
        };
        if c.block || c.members.iter().any(held) {
            self.blocks.insert(name);
        }
        // Types that stand before those that have variables of them are not on one way.
        if deepest == Some(DEEP - 1) {
            self.too_deep(c);
        }
        let depth = deepest.map_or(0, |d| d + 1).min(DEEP);
        depths.insert(name, depth);
        depth
    }

    fn too_deep(&mut self, c: &Composed) {
        let what = say!("types stand in each other at most {DEEP} deep");
        self.problems.push(Problem::new(&codes::TOO_DEEP, c.name.at.0, what));
    }

    /// Reports a name that is no type.
    pub(super) fn unknown_type(&mut self, of: &Name) {
        let name = &of.text;
        if name.is_empty() {
            return; // The name could not be read; the parser has reported it.
        }
        let mut names: Vec<&str> = Type::names().collect();
        names.extend(self.types.keys().chain(&self.enumerations).copied());
        names.sort_unstable();
        self.problems.push(unknown_type(of, &names));
    }

    pub(super) fn too_large(&mut self, at: Span) {
        let most = MOST;
        let what = say!(
            "the members of all variables and the statements of all calls together are more than {most}"
        );
        self.problems.push(Problem::new(&codes::TOO_LARGE, at, what));
    }
}

/// The problem of a type that does not exist; `names` are those that do.
pub(crate) fn unknown_type(of: &Name, names: &[&str]) -> Problem {
    let name = &of.text;
    let problem = Problem::new(&codes::UNKNOWN_WORD, of.at.0, say!("there is no type `{name}`"));
    match crate::similar(name, names) {
        Some(near) => problem.meant(near),
        None => problem.help(say!(
            "types are those of IEC 61131-3, and those that `struct`, `function block` and `type` declare"
        )),
    }
}

/// The problem of a type that has the name of one of the language.
pub(crate) fn of_language(name: &Name) -> Option<Problem> {
    Type::named(&name.text.to_ascii_uppercase())?;
    let what = say!("`{}` is a type of the language", name.text);
    Some(Problem::new(&codes::DEFINED_TWICE, name.at.0, what).help(say!("choose another name")))
}

/// The problem of a name that is declared a second time; `first` is the place of the first one.
pub(crate) fn defined_twice(name: &Name, first: Span) -> Problem {
    let problem = Problem::new(&codes::DEFINED_TWICE, name.at.0, say!("`{}` is defined twice", name.text));
    problem.related(first, say!("defined here first"))
}
