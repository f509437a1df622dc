//! Plants, tests, properties and the layout.

use super::{Printer, item::starts};
use crate::quote;
use g7_iec::constant;
use g7_model::{
    BinaryOp, Expr, Layout, Path, PlaceAt, Placed, Plant, PlantItem, Property, PropertyKind, Scenario, Span,
    TestStmt, TestStmtKind,
};

impl Printer<'_> {
    // Plants

    pub(super) fn plant(&mut self, plant: &Plant) {
        self.push("plant ");
        self.name(&plant.name.text);
        self.comment(plant.comment.as_deref());
        self.push(" ");
        let first = starts(plant.items.first().map(plant_place));
        self.braces(plant.at.0, first, |p| {
            for item in &plant.items {
                p.plant_item(item);
            }
        });
    }

    fn plant_item(&mut self, item: &PlantItem) {
        let at = plant_place(item);
        match item {
            PlantItem::On(event, block, _) => self.group(at, false, |p| {
                p.push("on ");
                p.expr(event);
                p.push(" ");
                p.block(block);
            }),
            PlantItem::Each(block, _) => self.group(at, false, |p| {
                p.push("each ");
                p.block(block);
            }),
            PlantItem::Arrivals(a) => self.group(at, false, |p| {
                p.push("arrivals ");
                p.name(&a.name.text);
                p.push(" every ");
                p.expr(&a.least);
                if let Some(most) = &a.most {
                    p.push(" .. ");
                    p.expr(most);
                }
                p.when(a.when.as_ref());
                p.push(" ");
                p.block(&a.body);
            }),
            PlantItem::View(v) => self.group(at, false, |p| p.view(v)),
            _ => self.line(at, false, |p| p.plant_line(item)),
        }
    }

    fn plant_line(&mut self, item: &PlantItem) {
        match item {
            PlantItem::Const { names, ty, value, comment, .. } => {
                self.push("const ");
                self.names(names);
                self.push(&format!(" : {ty}"));
                self.initial(Some(value));
                self.comment(comment.as_deref());
            }
            PlantItem::State(s) => {
                self.push("state ");
                self.names(&s.names);
                self.push(&format!(" : {}", s.ty));
                self.initial(s.init.as_ref());
                if let Some((least, most)) = &s.limits {
                    self.push(" in ");
                    self.expr(least);
                    self.push(" .. ");
                    self.expr(most);
                }
                self.comment(s.comment.as_deref());
            }
            PlantItem::Rate(r) => {
                self.push("rate ");
                self.name(&r.state.text);
                self.initial(Some(&r.value));
                self.when(r.when.as_ref());
            }
            PlantItem::Drive(d) => {
                self.push("drive ");
                self.expr(&d.input);
                self.initial(Some(&d.value));
            }
            PlantItem::Parts(parts) => self.parts(parts),
            PlantItem::On(..) | PlantItem::Each(..) | PlantItem::Arrivals(_) | PlantItem::View(_) => {}
        }
    }

    fn when(&mut self, condition: Option<&Expr>) {
        if let Some(condition) = condition {
            self.push(" when ");
            self.expr(condition);
        }
    }

    fn parts(&mut self, parts: &g7_model::Parts) {
        self.push("parts ");
        self.name(&parts.name.text);
        self.params(&parts.attributes);
        self.push(&format!(" max {}", parts.max));
        if let Some(length) = &parts.length {
            self.push(" length ");
            self.expr(length);
        }
        for (i, part) in parts.init.iter().enumerate() {
            self.push(if i > 0 { ", (" } else { " := (" });
            self.list(part);
            self.push(")");
        }
    }

    pub(super) fn list(&mut self, list: &[Expr]) {
        for (i, e) in list.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.expr(e);
        }
    }

    fn view(&mut self, view: &g7_model::View) {
        self.push("view ");
        self.push(&constant::quote_st(&view.file));
        let Some(first) = view.bindings.first() else { return };
        self.push(" ");
        self.braces(view.at.0, Some(first.element.at.0.start), |p| {
            for b in &view.bindings {
                let at = b.element.at.0.to(b.value.at.0);
                p.line(at, false, |p| {
                    let names = vec![b.element.clone(), b.attribute.clone()];
                    p.path(&Path { names });
                    p.initial(Some(&b.value));
                });
            }
        });
    }

    // Tests and properties

    pub(super) fn test(&mut self, test: &Scenario) {
        self.push("test");
        self.comment(Some(&test.title));
        if let Some(plant) = &test.plant {
            self.push(" with ");
            self.name(&plant.text);
        }
        if let Some(seed) = test.seed {
            self.push(&format!(" seed {seed}"));
        }
        self.push(" ");
        self.test_block(test.at.0, &test.body);
    }

    fn test_block(&mut self, at: Span, body: &[TestStmt]) {
        let first = body.first().map(|s| s.at.0.start);
        self.braces(at, first, |p| {
            for s in body {
                if matches!(s.kind, TestStmtKind::Always(..) | TestStmtKind::Repeat(..)) {
                    p.group(s.at.0, false, |p| p.test_statement(s));
                } else {
                    p.line(s.at.0, false, |p| p.test_statement(s));
                }
            }
        });
    }

    fn test_statement(&mut self, s: &TestStmt) {
        match &s.kind {
            TestStmtKind::Set(list) => {
                for (i, (target, value)) in list.iter().enumerate() {
                    self.push(if i > 0 { ", " } else { "set " });
                    self.expr(target);
                    self.initial(Some(value));
                }
            }
            TestStmtKind::Pulse(target, time) => {
                self.push("pulse ");
                self.expr(target);
                self.time_clause("for", *time, s.at.0);
            }
            TestStmtKind::Wait(time) => self.time_clause("wait", Some(*time), s.at.0),
            TestStmtKind::WaitUntil(e, within) => {
                self.push("wait until ");
                self.expr(e);
                self.time_clause("within", *within, s.at.0);
            }
            TestStmtKind::Scan(1) => self.push("scan"),
            TestStmtKind::Scan(n) => self.push(&format!("scan {n}")),
            TestStmtKind::Expect(list) => self.expect(list),
            TestStmtKind::ExpectFault(name) => {
                self.push("expect fault");
                if let Some(name) = name {
                    self.push(" ");
                    if g7_model::words::has(g7_model::words::TEST, &name.text)
                        || !name.text.starts_with(crate::lexer::name_start)
                    {
                        self.push(&quote::quote(&name.text, '`'));
                    } else {
                        self.name(&name.text);
                    }
                }
            }
            TestStmtKind::Always(list, body) => {
                self.push("always ");
                self.list(list);
                self.push(" ");
                self.test_block(s.at.0, body);
            }
            TestStmtKind::Force(target, value) => {
                self.push("force ");
                self.expr(target);
                self.initial(Some(value));
            }
            TestStmtKind::Release(target) => {
                self.push("release ");
                self.expr(target);
            }
            TestStmtKind::Restart { cold } => self.push(if *cold { "restart cold" } else { "restart" }),
            TestStmtKind::Repeat(n, body) => {
                self.push(&format!("repeat {n} "));
                self.test_block(s.at.0, body);
            }
            TestStmtKind::Comment(text) => self.push(&quote::quote(text, '"')),
        }
    }

    /// `expect …`; a variable called `fault` must not be read as that word.
    fn expect(&mut self, list: &[Expr]) {
        self.push("expect ");
        let length = self.out.len();
        self.list(list);
        let text = self.out.get(length..).unwrap_or_default();
        let word: String = text.chars().take_while(|c| crate::lexer::name_continue(*c)).collect();
        if word == "fault" {
            self.out.truncate(length);
            for (i, e) in list.iter().enumerate() {
                self.push(if i > 0 { ", " } else { "(" });
                self.expr(e);
                self.push(if i == 0 { ")" } else { "" });
            }
        }
    }

    pub(super) fn property(&mut self, property: &Property) {
        match &property.kind {
            PropertyKind::Always(e) => self.claim("prove always ", e),
            PropertyKind::Never(e) => self.claim("prove never ", e),
            PropertyKind::Reachable(e) => self.claim("prove reachable ", e),
            PropertyKind::Assume(e) => self.claim("assume ", e),
            PropertyKind::After(cause, time, effect) => {
                self.claim("prove after ", cause);
                self.time_clause("within", Some(*time), property.at.0);
                self.claim(" expect ", effect);
            }
            PropertyKind::Until(from, to, e) => {
                self.claim("prove after ", from);
                self.claim(" until ", to);
                self.claim(" expect ", e);
            }
            PropertyKind::Between(from, to, e) => {
                self.push("prove between ");
                self.operand_above(BinaryOp::And, from);
                self.claim(" and ", to);
                self.claim(" never ", e);
            }
            PropertyKind::LeadsTo(cause, effect) => {
                self.push("prove ");
                self.cause(cause);
                self.claim(" leads to ", effect);
            }
            PropertyKind::AtMost(count, list) => {
                self.push(&format!("prove at most {count} of ("));
                self.list(list);
                self.push(")");
            }
        }
        if let Some(plant) = &property.plant {
            self.push(" with ");
            self.name(&plant.text);
        }
        self.comment(property.comment.as_deref());
    }

    fn claim(&mut self, words: &str, e: &Expr) {
        self.push(words);
        self.expr(e);
    }

    /// A condition behind `prove`; one that begins with a name stands in parentheses where that
    /// name would be read as the form of another property.
    fn cause(&mut self, e: &Expr) {
        let length = self.out.len();
        self.expr(e);
        let text = self.out.get(length..).unwrap_or_default();
        let word: String = text.chars().take_while(|c| crate::lexer::name_continue(*c)).collect();
        if matches!(&*word, "always" | "never" | "reachable" | "after" | "between" | "at") {
            self.out.truncate(length);
            self.push("(");
            self.expr(e);
            self.push(")");
        }
    }

    // Layout

    pub(super) fn layout(&mut self, layout: &Layout) {
        self.push("layout ");
        self.name(&layout.chart.text);
        self.push(" ");
        let first = layout.places.first().map(|p| p.at.0.start);
        self.braces(layout.at.0, first, |p| {
            for place in &layout.places {
                p.line(place.at.0, false, |p| p.place_at(place));
            }
        });
    }

    pub(super) fn place_at(&mut self, place: &PlaceAt) {
        self.placed(&place.what);
        if !place.what.has_place() {
            return;
        }
        self.push(" at ");
        self.point((place.x, place.y));
        for bend in &place.then {
            self.push(", ");
            self.point(*bend);
        }
    }

    fn placed(&mut self, what: &Placed) {
        match what {
            Placed::Step(name) => {
                self.push("step ");
                self.name(&name.text);
            }
            Placed::Transition(name) => {
                self.push("transition ");
                self.name(&name.text);
            }
            Placed::TransitionNumber(n) => self.push(&format!("transition #{n}")),
            Placed::Comment(text) => {
                self.push("comment ");
                self.push(&quote::quote(text, '"'));
            }
            Placed::Link(ends) => self.link_ends(ends),
            Placed::Actions(step, form) => {
                self.push("actions ");
                if let Some(step) = step {
                    self.push("of ");
                    self.placed(step);
                    self.push(" ");
                }
                self.push("in ");
                self.push(form.word());
            }
            Placed::Sheet => self.push("sheet"),
            Placed::LinkForm(ends, form) => {
                self.link_ends(ends);
                self.push(" as ");
                self.push(form.word());
            }
        }
    }

    fn link_ends(&mut self, ends: &(Placed, Placed)) {
        self.push("link ");
        self.placed(&ends.0);
        self.push(" -> ");
        self.placed(&ends.1);
    }

    fn point(&mut self, (x, y): (i32, i32)) {
        self.push(&format!("({}, {})", hundredths(x), hundredths(y)));
    }
}

/// `150` as `1.5`.
fn hundredths(n: i32) -> String {
    let sign = if n < 0 { "-" } else { "" };
    let n = n.unsigned_abs();
    let text = format!("{sign}{}.{:02}", n / 100, n % 100);
    text.trim_end_matches('0').trim_end_matches('.').into()
}

fn plant_place(item: &PlantItem) -> Span {
    match item {
        PlantItem::Const { at, .. } | PlantItem::On(_, _, at) | PlantItem::Each(_, at) => at.0,
        PlantItem::State(s) => s.at.0,
        PlantItem::Rate(r) => r.at.0,
        PlantItem::Drive(d) => d.at.0,
        PlantItem::Parts(p) => p.at.0,
        PlantItem::Arrivals(a) => a.at.0,
        PlantItem::View(v) => v.at.0,
    }
}
