//! Resolves paths and direct names, from the innermost scope outward (grammar, "Expressions").

use g7_model::{ChartKind, Name, Path, Type};

use super::model::{FILE, Model, ScopeId, StepId, VarId};

/// The meaning of a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ref {
    Var(VarId),
    Member(VarId, String),
    Bit(VarId, u32),
    Active(StepId),
    Time(StepId),
    Seconds(StepId),
    /// `%X12.T`: the step time in units of 100 ms.
    Tenths(StepId),
    Section(ScopeId, String),
    /// A value of an enumeration.
    Value(i128),
}

impl Model {
    /// Resolves a path that does not name a local variable of a body.
    pub(super) fn resolve(&self, scope: ScopeId, path: &Path) -> Option<Ref> {
        let names: Vec<&str> = path.names.iter().map(|n| &*n.text).collect();
        if let Some((home, names)) = self.of_block(scope, &names) {
            let name = |n: &String| Name::new(n.as_str(), path.names[0].at.0);
            return self.resolve(home, &Path { names: names.iter().map(name).collect() });
        }
        let chain = self.chain(scope);
        if let Some(found) = chain.iter().find_map(|&s| self.variable_in(s, &names)) {
            return Some(found);
        }
        if let Some(found) = chain.iter().find_map(|&s| self.step_in(s, &names)) {
            return Some(found);
        }
        if let Some((chart, taken)) = self.block_chart(scope, &names)
            && let rest @ [_, ..] = &names[taken..]
        {
            return self.variable_in(chart, rest).or_else(|| self.step_in(chart, rest));
        }
        // Linked charts read each other's steps by number alone (A17): the only such step of the
        // charts, otherwise the only one of expansions and tasks.
        let found = |of_charts: bool| {
            let scopes = FILE + 1..self.scopes.len();
            let mut all = scopes
                .filter(|&s| (self.scopes[s].kind == ChartKind::Chart) == of_charts)
                .filter_map(|s| self.step_in(s, &names));
            match (all.next(), all.next()) {
                (Some(only), None) => Some(Some(only)),
                (None, _) => None,
                _ => Some(None),
            }
        };
        found(true).or_else(|| found(false)).flatten().or_else(|| self.value_named(&names))
    }

    /// The scopes in which a name is searched: this one, the charts around an expansion, the file.
    pub(super) fn chain(&self, scope: ScopeId) -> Vec<ScopeId> {
        let mut chain = vec![scope];
        let mut at = scope;
        while let Some(m) = self.scopes[at].macro_step {
            at = self.steps[m].scope;
            chain.push(at);
        }
        if scope != FILE {
            chain.push(FILE);
        }
        chain
    }

    fn variable_in(&self, scope: ScopeId, names: &[&str]) -> Option<Ref> {
        let s = &self.scopes[scope];
        let (last, before) = names.split_last()?;
        if let Some(&v) = s.vars.get(&names.join(".")) {
            return Some(Ref::Var(v));
        }
        if before.is_empty() {
            return s.sections.contains_key(*last).then(|| Ref::Section(scope, (*last).to_owned()));
        }
        let &v = s.vars.get(&before.join("."))?;
        let ty = self.vars[v].ty;
        if ty.is_bits() || ty.is_integer() {
            return last.parse().ok().map(|k| Ref::Bit(v, k));
        }
        matches!(ty, Type::Fb(_)).then(|| Ref::Member(v, (*last).to_owned()))
    }

    fn step_in(&self, scope: ScopeId, names: &[&str]) -> Option<Ref> {
        match *names {
            [x] => self.step_behind_x(scope, x).map(Ref::Active),
            [step, what @ ("t" | "T" | "x" | "X" | "s")] => {
                let by_name = self.scopes[scope].by_name.get(step).copied();
                let id = by_name.or_else(|| self.step_behind_x(scope, step))?;
                Some(match what {
                    "t" | "T" => Ref::Time(id),
                    "s" => Ref::Seconds(id),
                    _ => Ref::Active(id),
                })
            }
            [macro_step, ref rest @ ..] => {
                let &id = self.scopes[scope].by_name.get(macro_step)?;
                let (inner, ..) = self.steps[id].expansion?;
                self.variable_in(inner, rest).or_else(|| self.step_in(inner, rest))
            }
            [] => None,
        }
    }

    /// The step of `X12`, `XFill` or `XM3` (macro-step `M3` or `3`).
    fn step_behind_x(&self, scope: ScopeId, text: &str) -> Option<StepId> {
        let name = text.strip_prefix('X')?;
        let s = &self.scopes[scope];
        s.by_name.get(name).copied().or_else(|| {
            let id = *s.by_name.get(name.strip_prefix('M')?)?;
            self.steps[id].expansion.is_some().then_some(id)
        })
    }

    /// The step of `G.X12`, `X12` or `G.Fill` as the argument of a service.
    pub(super) fn resolve_step(&self, scope: ScopeId, path: &Path) -> Option<StepId> {
        if let Some(Ref::Active(id)) = self.resolve(scope, path) {
            return Some(id);
        }
        match &path.names[..] {
            [step] => self.scopes[scope].by_name.get(&*step.text).copied(),
            [chart, step] => {
                let chart = self.chart_named(scope, &chart.text)?;
                self.scopes[chart].by_name.get(&*step.text).copied()
            }
            _ => None,
        }
    }

    /// Resolves a direct name, given without its `%`.
    pub(super) fn resolve_direct(&self, name: &str) -> Option<Ref> {
        let name = name.to_ascii_uppercase();
        if let Some(&v) = self.addresses.get(&name) {
            return Some(Ref::Var(v));
        }
        if let Some((word, bit)) = name.split_once(":X") {
            return Some(Ref::Bit(*self.addresses.get(word)?, bit.parse().ok()?));
        }
        let (body, time) = match name.strip_suffix(".T") {
            Some(body) => (body, true),
            None => (&*name, false),
        };
        let step = self.direct_step(body.strip_prefix('X')?)?;
        Some(if time { Ref::Tenths(step) } else { Ref::Active(step) })
    }

    fn direct_step(&self, text: &str) -> Option<StepId> {
        let main = (FILE + 1..self.scopes.len()).find(|&s| self.scopes[s].kind == ChartKind::Chart)?;
        if let Some(number) = text.strip_prefix('M') {
            return self.numbered_macro(main, number);
        }
        let Some((number, inner)) = text.split_once('.') else {
            return self.scopes[main].by_name.get(text).copied();
        };
        let (scope, entry, exit) = self.steps[self.numbered_macro(main, number)?].expansion?;
        match inner {
            "IN" => Some(entry),
            "OUT" => Some(exit),
            _ => self.scopes[scope].by_name.get(inner).copied(),
        }
    }

    /// The macro-step with number 3, whose name is `3` or `M3`.
    pub(super) fn numbered_macro(&self, scope: ScopeId, number: &str) -> Option<StepId> {
        let by_name = &self.scopes[scope].by_name;
        let names = [format!("M{number}"), number.to_owned()];
        names.iter().filter_map(|n| by_name.get(n).copied()).find(|&s| self.steps[s].expansion.is_some())
    }
}
