//! Assembles the resulting document: variables, bodies, charts.

use g7_model::codes;
use g7_model::{
    Action, Block, Body, Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Function, Item, Layout,
    Literal, Local, Name, NamedAction, Param, Placed, Problem, Profile, ProfileName, Qualifier, Said,
    Section, Span, Step, StepKind, Stmt, Target, Transition, VarDecl, VarKind, say,
};

use super::bodies::At;
use super::form::Form;
use super::lower::{DEEPEST, Lower};
use crate::nodes;
use crate::scopes::{Ref, StepKey};

impl<'d> Lower<'d> {
    /// The whole document.
    pub(super) fn document(&mut self) -> Document {
        self.rules();
        let document = self.document;
        let mut items = Vec::new();
        let mut functions = Vec::new();
        let mut pre = Vec::new();
        let mut post = Vec::new();
        let mut at = Span::default();
        for item in &document.items {
            match item {
                Item::Profile(p) => at = p.at.0,
                Item::Cycle(..) => items.push(item.clone()),
                Item::Var(v) => items.extend(self.variable_of(None, v, false).map(Item::Var)),
                // Numbers stand in the place of values, and `blocks` makes the function blocks that stay.
                Item::Composed(_) | Item::Type(_) => {}
                Item::Function(f) => functions.push(Item::Function(self.function(f))),
                Item::Pre(body, at) => self.processing(None, body, at.0, &mut pre),
                Item::Post(body, at) => self.processing(None, body, at.0, &mut post),
                Item::Action(_) | Item::Section(_) | Item::Layout(_) | Item::Chart(_) | Item::Instance(_) => {
                }
                Item::Target(_, at) => {
                    self.left_out(at.0, say!("the PLC whose limits are checked is left out"))
                }
                Item::Use(u) => self.lost(u.at.0, say!("a file that is used was not read")),
                Item::Plant(p) => self.left_out(p.at.0, say!("a plant is left out")),
                Item::Test(t) => self.left_out(t.at.0, say!("a test is left out")),
                Item::Prove(p) => self.left_out(p.at.0, say!("a property is left out")),
            }
        }
        let mut charts: Vec<(usize, Vec<ChartItem>)> = Vec::new();
        for (number, chart) in self.scopes.charts.clone().into_iter().enumerate() {
            if self.program_of(number).is_none() {
                self.lost(
                    chart.name.at.0,
                    say!("a task, or an expansion that no macro-step has: there is no counterpart"),
                );
                continue;
            }
            for item in &chart.items {
                match item {
                    ChartItem::Var(v) => {
                        items.extend(self.variable_of(Some(number), v, true).map(Item::Var));
                    }
                    ChartItem::Pre(body, at) => self.processing(Some(number), body, at.0, &mut pre),
                    ChartItem::Post(body, at) => self.processing(Some(number), body, at.0, &mut post),
                    _ => {}
                }
            }
            let parts = self.parts(number, chart);
            charts.push((number, parts));
        }
        self.of_file(&mut charts);
        self.hand_down(&mut charts);
        self.between_programs();
        self.show(&mut charts);
        let mut body = std::mem::take(&mut self.channels);
        body.append(&mut self.looking);
        if pre.iter().any(Stmt::returns) && !(self.copies.is_empty() && self.sections.is_empty()) {
            self.lost(
                at,
                say!("RETURN in a body before the charts: what is computed behind it would not run"),
            );
        }
        body.append(&mut pre);
        body.append(&mut self.sections);
        self.copied(&mut body);
        if let Some(name) = &self.started {
            let on = nodes::boolean(true, at);
            body.push(nodes::assign(nodes::name(&[name], at), on, at));
        }
        let mut all =
            vec![Item::Profile(Profile { name: ProfileName::Iec61131, switches: Vec::new(), at: at.into() })];
        all.append(&mut items);
        all.extend(std::mem::take(&mut self.new_globals).into_iter().map(Item::Var));
        all.append(&mut functions);
        if let Some(name) = &self.first {
            let off = nodes::boolean(false, at);
            post.insert(0, nodes::assign(nodes::name(&[name], at), off, at));
        }
        let body_of = |list: Vec<Stmt>| Body::St(nodes::block(list, at));
        if !body.is_empty() {
            all.push(Item::Pre(body_of(body), at.into()));
        }
        post.append(&mut self.closing);
        if !post.is_empty() {
            all.push(Item::Post(body_of(post), at.into()));
        }
        let charts = self.charts(charts);
        let layouts = self.layouts(&charts);
        all.extend(charts.into_iter().map(|c| Item::Chart(c.1)));
        all.extend(layouts.into_iter().map(Item::Layout));
        Document { items: all, notes: Vec::new() }
    }

    fn left_out(&mut self, at: Span, what: Said) {
        self.problems.push(Problem::new(&codes::LEFT_OUT, at, what));
    }

    /// A declaration with those of its names that several programs use (`shared`), or with the
    /// others.
    fn variable_of(&mut self, chart: Option<usize>, decl: &'d VarDecl, shared: bool) -> Option<VarDecl> {
        let mut made = decl.clone();
        made.names = decl
            .names
            .iter()
            .filter(|n| self.shared.contains(&(chart, &*n.text)) == shared)
            .map(|n| Name::new(self.names.var(chart, &n.text).unwrap_or(&n.text), n.at.0))
            .collect();
        if made.names.is_empty() {
            return None;
        }
        made.init = decl.init.as_ref().map(|e| self.initial_value(e, chart));
        self.blocks.instance(&mut made);
        for (low, high) in made.array.iter_mut().flat_map(|a| &mut a.dimensions) {
            (*low, *high) = (self.constant(low, chart), self.constant(high, chart));
        }
        if let Some(other) = decl.address.as_ref().filter(|a| !is_address(&a.text)) {
            let what = say!(
                "the channel `{}` is no address of the standard, such as %IX0.1; it is left out",
                other.text
            );
            self.left_out(other.at.0, what);
            made.address = None;
        }
        if decl.inverted {
            made.inverted = false;
            // Without a channel there is nothing to invert.
            if made.address.is_some() {
                self.inverted(&mut made);
            }
        }
        if let Some(safe) = &decl.safe {
            self.left_out(safe.at.0, say!("the value of an output after a fault is left out"));
            made.safe = None;
        }
        Some(made)
    }

    /// Gives a variable with an inverted channel a second one that holds the channel as it is. It is computed
    /// from that before all else, or that from it behind all else.
    fn inverted(&mut self, decl: &mut VarDecl) {
        let at = decl.at.0;
        let kind = std::mem::replace(&mut decl.kind, VarKind::Var);
        let address = decl.address.take();
        for name in &decl.names {
            let raw = self.names.free(None, &format!("{}_raw", name.text));
            let mut channel = nodes::variable(kind, &raw, decl.ty, at);
            channel.address.clone_from(&address);
            let own = nodes::name(&[&name.text], at);
            let other = nodes::name(&[&raw], at);
            if kind == VarKind::Input {
                self.channels.push(nodes::assign(own, nodes::not(other, at), at));
            } else {
                let on = decl.init.as_ref().is_some_and(|i| nodes::truth(i) == Some(true));
                channel.init = Some(nodes::boolean(!on, at));
                self.closing.push(nodes::assign(other, nodes::not(own, at), at));
            }
            self.new_globals.push(channel);
        }
    }

    /// Adds code before or behind the charts.
    fn processing(&mut self, chart: Option<usize>, body: &'d Body, span: Span, into: &mut Vec<Stmt>) {
        let slow = chart.and_then(|c| self.scopes.chart(c)).is_some_and(|c| self.pace(c).is_some());
        if slow {
            self.differs(span, say!("a body of a chart with a period of its own; it runs in every scan"));
        }
        let at = At { chart, ..At::default() };
        // Where no chart is, no other body has local variables, so these keep their names.
        let owner = if self.scopes.charts.is_empty() { "" } else { "Body" };
        let list = self.block(body.block(), &at, owner);
        if !into.is_empty() && into.iter().any(Stmt::returns) {
            self.lost(span, say!("RETURN in one of several bodies: those behind it would not run"));
        }
        into.extend(list);
    }

    /// The name that a parameter or a local variable of a function has there.
    fn inner_name(&self, f: &Function, name: &Name) -> String {
        self.names.inner(&f.name.text, &name.text).unwrap_or(&name.text).to_owned()
    }

    fn function(&mut self, f: &'d Function) -> Function {
        let own = self.names.function(&f.name.text).unwrap_or(&f.name.text).to_string();
        let mut locals = vec![(f.name.text.clone(), own.clone())];
        let mut params = Vec::new();
        for p in &f.params {
            let text = self.inner_name(f, &p.name);
            locals.push((p.name.text.clone(), text.clone()));
            params.push(Param { name: Name::new(text, p.name.at.0), ty: p.ty.clone() });
        }
        let mut inner = Vec::new();
        for local in &f.body.locals {
            let names: Vec<Name> =
                local.names.iter().map(|n| Name::new(self.inner_name(f, n), n.at.0)).collect();
            locals.extend(local.names.iter().zip(&names).map(|(n, t)| (n.text.clone(), t.text.to_string())));
            let init = local.init.as_ref().map(|e| self.constant(e, None));
            inner.push(Local { names, ty: local.ty.clone(), init, at: local.at });
        }
        let at = At { locals, function: true, ..At::default() };
        let statements = self.stmts(&f.body.statements, &at);
        let body = Block { locals: inner, statements, at: f.body.at };
        Function { name: Name::new(own, f.name.at.0), params, result: f.result.clone(), body, at: f.at }
    }

    /// The items of a chart in its program.
    fn parts(&mut self, number: usize, chart: &'d Chart) -> Vec<ChartItem> {
        let at = At { chart: Some(number), program: self.program_of(number), ..At::default() };
        let mut items = Vec::new();
        let mut clearing: Vec<(StepKey, Action)> = Vec::new();
        let mut place = 0;
        for item in &chart.items {
            match item {
                ChartItem::Var(v) => {
                    items.extend(self.variable_of(Some(number), v, false).map(ChartItem::Var));
                }
                ChartItem::Step(step) => {
                    let key = (number, place);
                    place += 1;
                    items.extend(self.step(key, step, &at).map(ChartItem::Step));
                }
                ChartItem::Transition(t) => {
                    if let Some(block) = &t.on_clearing {
                        clearing.extend(self.on_clearing(t, block, number));
                    }
                    let made = self.transition(number, t, &at, &mut items);
                    items.push(ChartItem::Transition(made));
                }
                ChartItem::Action(a) => items.push(ChartItem::Action(self.named(Some(number), a, &at))),
                ChartItem::Section(s) => {
                    items.extend(self.section(Some(number), s, &at).map(ChartItem::Section))
                }
                ChartItem::Pre(..) | ChartItem::Post(..) => {}
            }
        }
        for (key, action) in clearing {
            let name = self.names.step(key);
            let step = items.iter_mut().find_map(|i| match i {
                ChartItem::Step(s) if *s.name.text == *name => Some(s),
                _ => None,
            });
            if let Some(step) = step {
                // Work on clearing runs before the actions of steps.
                step.actions.insert(0, action);
                step.braces = true;
            }
        }
        items
    }

    fn step(&mut self, key: StepKey, step: &'d Step, at: &At<'d>) -> Option<Step> {
        let macro_step = self.scopes.expansion(key).is_some();
        if matches!(step.kind, StepKind::Enclosing) {
            self.lost(
                step.name.at.0,
                say!("an enclosing step, which IEC 61131-3 does not have: it has no counterpart there"),
            );
        }
        let in_line = macro_step && self.form.in_line();
        if in_line {
            self.of_macro(key, step, at);
            self.left_out(
                step.name.at.0,
                say!("a macro-step is left out; its expansion stands in its place"),
            );
            return None;
        }
        let actions = self.actions(key, step, at);
        let kind = match (&step.kind, self.form) {
            (StepKind::Enclosing, _) => StepKind::Plain,
            (StepKind::Entry | StepKind::Exit, Form::Networks { .. }) => StepKind::Plain,
            (kind, _) => kind.clone(),
        };
        if step.initial && macro_step {
            self.lost(step.name.at.0, say!("an initial macro-step, which there is not"));
        }
        let initial = match self.form {
            Form::Networks { .. } => self.initial(key),
            Form::Charts | Form::Codesys { .. } => step.initial,
        };
        Some(Step {
            name: Name::new(self.names.step(key), step.name.at.0),
            kind,
            initial,
            linked: false,
            comment: step.comment.clone(),
            braces: !actions.is_empty(),
            actions,
            at: step.at,
        })
    }

    fn transition(
        &mut self,
        chart: usize,
        t: &'d Transition,
        at: &At<'d>,
        items: &mut Vec<ChartItem>,
    ) -> Transition {
        let span = t.at.0;
        let mut from: Vec<Name> = t.from.iter().map(|n| self.end(chart, n, false, 0)).collect();
        let mut to: Vec<Name> = t.to.iter().map(|n| self.end(chart, n, true, 0)).collect();
        if from.is_empty() {
            self.differs(span, say!("a source transition has a step before it there that is always active"));
            let name = Name::new(self.names.free(at.program, "Source"), span);
            items.push(ChartItem::Step(nodes::step(name.clone(), true, span)));
            to.insert(0, name.clone());
            from.push(name);
        }
        if to.is_empty() {
            self.differs(span, say!("a sink transition has a step behind it there that stays active"));
            let name = Name::new(self.names.free(at.program, "Sink"), span);
            items.push(ChartItem::Step(nodes::step(name.clone(), false, span)));
            to.push(name);
        }
        let label = t.label.as_ref().map(|l| Name::new(self.names.free(at.program, &l.text), l.at.0));
        Transition {
            label,
            from,
            to,
            receptivity: self.receptivity(&t.receptivity, at),
            priority: t.priority,
            comment: t.comment.clone(),
            on_clearing: None,
            chained: false,
            at: t.at,
        }
    }

    /// The step at an end of a transition; for a macro-step in line, its exit or entry step.
    fn end(&mut self, chart: usize, name: &Name, entry: bool, depth: usize) -> Name {
        let Some(key) = self.scopes.step_in(chart, &name.text) else { return name.clone() };
        let inner = self.scopes.expansion(key).filter(|_| self.form.in_line() && depth < DEEPEST);
        let Some(inner) = inner else { return Name::new(self.names.step(key), name.at.0) };
        let wanted = if entry { StepKind::Entry } else { StepKind::Exit };
        match self.scopes.steps_of(inner).find(|(_, s)| s.kind == wanted) {
            Some((_, step)) => self.end(inner, &step.name, entry, depth + 1),
            None => name.clone(),
        }
    }

    fn receptivity(&mut self, e: &Expr, at: &At<'d>) -> Expr {
        match &e.kind {
            ExprKind::Path(path) if !self.form.in_line() => {
                if let Some(Ref::Section(home, section)) = self.scopes.refer(at.chart, &path.names)
                    && let Some(name) = self.names.part(home, &section.name.text)
                {
                    return nodes::name(&[name], e.at.0);
                }
            }
            ExprKind::Literal(Literal::Int(n, None)) => return nodes::boolean(*n != 0, e.at.0),
            _ => {}
        }
        self.expr(e, at)
    }

    /// A named action in a program.
    fn named(&mut self, home: Option<usize>, action: &'d NamedAction, at: &At<'d>) -> NamedAction {
        let name = self.names.part(home, &action.name.text).unwrap_or(&action.name.text).to_string();
        let span = action.at.0;
        let mut list = self.block(action.body.block(), at, &name);
        let uses = self.uses.get(&(home, &*action.name.text)).cloned().unwrap_or_default();
        if self.form == (Form::Codesys { bare: true }) {
            // The step runs the body alone, as CODESYS does.
        } else if !self.final_scan && uses.iter().all(|u| u.1 == Qualifier::N) {
            let mut is = nodes::boolean(false, span);
            for (step, _) in &uses {
                if self.program_of(step.0) != at.program {
                    continue;
                }
                let one = self.active(*step, span, at, 0);
                is = nodes::or(is, one, span);
            }
            list = vec![nodes::when(is, list, Vec::new(), span)];
        } else if !self.final_scan && uses.len() > 1 {
            self.differs(span, say!("the body runs once more when its action ends, as in IEC 61131-3"));
        }
        let body = Body::St(nodes::block(list, span));
        NamedAction {
            name: Name::new(name, action.name.at.0),
            comment: action.comment.clone(),
            body,
            at: action.at,
        }
    }

    /// A section of a program. In text its value is written where it is named.
    fn section(&mut self, home: Option<usize>, section: &'d Section, at: &At<'d>) -> Option<Section> {
        if self.form.in_line() {
            return None;
        }
        let name = self.names.part(home, &section.name.text).unwrap_or(&section.name.text).to_string();
        let inner = At { section: Some(&section.name.text), ..at.clone() };
        let statements = self.block(&section.body, &inner, &name);
        let body = Block { locals: Vec::new(), statements, at: section.body.at };
        Some(Section { name: Name::new(name, section.name.at.0), body, short: section.short, at: section.at })
    }

    /// Adds named actions and sections of the file to each program that uses them.
    fn of_file(&mut self, charts: &mut [(usize, Vec<ChartItem>)]) {
        let document = self.document;
        for item in &document.items {
            for (number, items) in charts.iter_mut() {
                let at = At { program: self.program_of(*number), ..At::default() };
                if self.heads.get(at.program.unwrap_or(usize::MAX)) != Some(number) {
                    continue;
                }
                match item {
                    Item::Action(a) => {
                        let uses = self.uses.get(&(None, &*a.name.text)).cloned().unwrap_or_default();
                        let here = uses.iter().any(|u| self.program_of(u.0.0) == at.program);
                        if here || uses.is_empty() {
                            items.push(ChartItem::Action(self.named(None, a, &at)));
                        }
                    }
                    Item::Section(s) => items.extend(self.section(None, s, &at).map(ChartItem::Section)),
                    _ => {}
                }
            }
        }
    }

    /// Makes steps that other programs observe drive a variable.
    fn show(&mut self, charts: &mut [(usize, Vec<ChartItem>)]) {
        for (key, name) in &self.mirrors {
            let own = self.names.step(*key);
            let items = charts.iter_mut().find(|c| c.0 == key.0).map(|c| &mut c.1);
            for item in items.into_iter().flatten() {
                if let ChartItem::Step(step) = item
                    && *step.name.text == *own
                {
                    let target = Target::Path(nodes::path(&[name], step.at.0));
                    let action = nodes::qualified(Qualifier::N, None, target, None, step.at.0);
                    step.actions.push(action);
                    step.braces = true;
                }
            }
        }
    }

    /// The resulting charts: one for each program, or each with its expansions.
    fn charts(&mut self, parts: Vec<(usize, Vec<ChartItem>)>) -> Vec<(usize, Chart)> {
        let mut out: Vec<(usize, Chart)> = Vec::new();
        let mut places: Vec<Option<usize>> = vec![None; self.heads.len()];
        for (number, mut items) in parts {
            let (Some(chart), Some(program)) = (self.scopes.chart(number), self.program_of(number)) else {
                continue;
            };
            let place = places.get(program).copied().flatten();
            let expansion = chart.kind == ChartKind::Expansion;
            if let Some(known) = place.filter(|_| self.form.in_line())
                && let Some((_, there)) = out.get_mut(known)
            {
                if let Some(comment) = &chart.comment {
                    let before = there.comment.as_ref().map_or(String::new(), |c| format!("{c}; "));
                    there.comment = Some(format!("{before}{comment}").into());
                }
                there.items.append(&mut items);
                continue;
            }
            let inner = expansion && !self.form.in_line();
            if inner && let Some(vars) = self.new_vars.get_mut(program) {
                // Variables of an expansion belong to the program.
                let (own, rest) = items.into_iter().partition(|i| matches!(i, ChartItem::Var(_)));
                items = rest;
                let own: Vec<ChartItem> = own;
                vars.extend(
                    own.into_iter().filter_map(|i| if let ChartItem::Var(v) = i { Some(v) } else { None }),
                );
            }
            let head = self.heads.get(program).and_then(|h| self.scopes.chart(*h)).unwrap_or(chart);
            let name = if inner {
                chart.name.clone()
            } else {
                let text = match self.form {
                    // Compilers treat the name as visible within the program as well.
                    Form::Networks { .. } => self.names.give(None, &head.name, "", ""),
                    Form::Charts => self.names.give_unit(&head.name),
                    Form::Codesys { .. } => {
                        self.units.get(program).cloned().unwrap_or_else(|| head.name.text.to_string())
                    }
                };
                Name::new(text, chart.name.at.0)
            };
            if !inner && let Some(slot) = places.get_mut(program) {
                *slot = Some(out.len());
            }
            let made = Chart {
                kind: if inner { ChartKind::Expansion } else { ChartKind::Chart },
                name,
                params: Vec::new(),
                block: None,
                comment: chart.comment.clone(),
                every: self.pace(head),
                items,
                at: chart.at,
            };
            out.push((number, made));
        }
        for (program, place) in places.iter().enumerate() {
            let new = self.new_vars.get_mut(program).map(std::mem::take).unwrap_or_default();
            if let Some((_, chart)) = place.and_then(|p| out.get_mut(p)) {
                // Declarations come before the steps.
                let first = chart.items.iter().position(|i| !matches!(i, ChartItem::Var(_)));
                let at = first.unwrap_or(chart.items.len());
                chart.items.splice(at..at, new.into_iter().map(ChartItem::Var));
            }
        }
        out
    }

    /// The places of the symbols, for charts that are carried over whole.
    fn layouts(&self, charts: &[(usize, Chart)]) -> Vec<Layout> {
        if self.form.in_line() {
            return Vec::new();
        }
        let of_item = |i: &'d Item| if let Item::Layout(l) = i { Some(l) } else { None };
        let mut layouts = Vec::new();
        for layout in self.document.items.iter().filter_map(of_item) {
            let Some(chart) = self.scopes.chart_named(&layout.chart.text) else { continue };
            let mut made = layout.clone();
            if let Some(there) = charts.iter().find(|c| c.0 == chart) {
                made.chart = there.1.name.clone();
            }
            for symbol in made.places.iter_mut().flat_map(|p| p.what.symbols_mut()) {
                if let Placed::Step(name) = symbol
                    && let Some(key) = self.scopes.step_in(chart, &name.text)
                {
                    *name = Name::new(self.names.step(key), name.at.0);
                }
            }
            layouts.push(made);
        }
        layouts
    }
}

/// True if a text is an address of the standard: `%IX0.1`, `%QW3`, `%M12`.
fn is_address(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('%') else { return false };
    let Some(rest) = rest.to_ascii_uppercase().strip_prefix(['I', 'Q', 'M']).map(str::to_owned) else {
        return false;
    };
    let digits = rest.strip_prefix(['X', 'B', 'W', 'D', 'L']).unwrap_or(&rest);
    digits == "*"
        || digits.split('.').all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()))
}
