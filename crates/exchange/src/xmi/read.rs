//! Reads the charts, steps, variables and actions of the file from XML elements.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::{Said, Type, codes, say};
use roxmltree::{Document, NodeId};

use super::refs::{self, Refs, Xml};
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The meta-model's name for a chart without a name.
pub(super) const DEFAULT_NAME: &str = "GRAFCETChart";

/// The content of a file.
pub(super) struct Plan<'a> {
    /// The name of the whole file, if it has one.
    pub(super) name: Option<String>,
    pub(super) vars: Vec<Var<'a>>,
    pub(super) sheets: Vec<Sheet<'a>>,
    pub(super) actions: Vec<Xml<'a>>,
    pub(super) refs: Refs<'a>,
    /// The meaning of each element of a chart.
    pub(super) things: HashMap<NodeId, Thing>,
    pub(super) at: Range<usize>,
}

/// The meaning of an element, by its index in the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thing {
    Var(usize),
    Sheet(usize),
    Step(usize, usize),
    Transition(usize, usize),
    Synchronisation(usize, usize),
    Action(usize),
}

/// A declaration.
pub(super) struct Var<'a> {
    pub(super) xml: Xml<'a>,
    pub(super) sort: VarSort,
    pub(super) ty: Type,
    /// The chart that declares it; None for the file.
    pub(super) sheet: Option<usize>,
}

/// The purpose of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VarSort {
    Input,
    Output,
    Internal,
    /// The activity of a step.
    Step,
}

/// A chart or the expansion of a macro-step.
pub(super) struct Sheet<'a> {
    pub(super) xml: Xml<'a>,
    pub(super) expansion: bool,
    pub(super) steps: Vec<StepNode<'a>>,
    pub(super) transitions: Vec<Xml<'a>>,
    pub(super) synchronisations: Vec<Xml<'a>>,
    pub(super) arcs: Vec<Xml<'a>>,
    pub(super) links: Vec<Xml<'a>>,
}

/// A step.
pub(super) struct StepNode<'a> {
    pub(super) xml: Xml<'a>,
    pub(super) sort: StepSort,
    pub(super) initial: bool,
    pub(super) linked: bool,
}

/// The kind of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepSort {
    Plain,
    Enclosing,
    Macro,
    Entry,
    Exit,
}

/// Reads the tree of the file.
pub(super) fn plan<'a>(tree: &'a Document<'a>, report: &mut Report) -> Plan<'a> {
    let root = tree.root_element();
    let name = attr::text(root, "name").map(|n| n.text);
    let plan = Plan {
        name,
        vars: Vec::new(),
        sheets: Vec::new(),
        actions: Vec::new(),
        refs: Refs::new(root),
        things: HashMap::new(),
        at: attr::head(root),
    };
    let mut reader = Reader { plan, report };
    reader.attributes(root, &["name"]);
    reader.sheet(root, true);
    reader.left_over_references(root);
    reader.plan
}

struct Reader<'a, 'r> {
    plan: Plan<'a>,
    report: &'r mut Report,
}

impl<'a> Reader<'a, '_> {
    /// Reads a chart and those within it.
    fn sheet(&mut self, xml: Xml<'a>, root: bool) {
        let of_chart = ["steps", "transitions", "synchronizations", "macrosteps", "arcs", "entryStep"];
        let elements = || xml.children().filter(Xml::is_element);
        let empty = match root {
            // The root holds the variables and the charts, and may itself be a chart.
            true => !elements().any(|c| of_chart.contains(&c.tag_name().name())),
            false => elements().next().is_none() && xml.attribute("name").is_none(),
        };
        let index = self.plan.sheets.len();
        let expansion = kind(xml) == Some("MacrostepExpansion");
        if empty && !root {
            let what = say!("an empty chart is left out");
            self.report.element(&codes::LEFT_OUT, "partialGrafcets", &attr::head(xml), what);
            return;
        }
        let here = (!empty).then_some(index);
        if !empty {
            self.plan.things.insert(xml.id(), Thing::Sheet(index));
            self.plan.sheets.push(Sheet {
                xml,
                expansion,
                steps: Vec::new(),
                transitions: Vec::new(),
                synchronisations: Vec::new(),
                arcs: Vec::new(),
                links: Vec::new(),
            });
        }
        for child in xml.children() {
            if child.is_element() {
                self.element(child, here, root);
            } else if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
                let what = say!("text between the elements has no meaning in a chart");
                self.report.element(&codes::UNKNOWN_ELEMENT, "text", &child.range(), what);
            }
        }
    }

    fn element(&mut self, xml: Xml<'a>, sheet: Option<usize>, root: bool) {
        const NODE: &[&str] = &["id"];
        let time = ["id", "delayTime", "resetTime", "unit", "timeConditionType"];
        match xml.tag_name().name() {
            "variableDeclarationContainer" => {
                self.attributes(xml, &[]);
                let holder = sheet.filter(|_| !root);
                xml.children().filter(Xml::is_element).for_each(|c| self.variable(c, holder));
            }
            "partialGrafcets" => {
                self.attributes(xml, &["name", "enclosingStep"]);
                self.sheet(xml, false);
            }
            "steps" => {
                let sort = match kind(xml) {
                    Some("EnclosingStep") => StepSort::Enclosing,
                    _ => StepSort::Plain,
                };
                self.attributes(xml, &["id", "initial", "activationLink", "partialGrafcets"]);
                self.step(xml, sheet, sort);
            }
            "macrosteps" => {
                self.attributes(xml, &["id", "expansion"]);
                self.step(xml, sheet, StepSort::Macro);
            }
            "entryStep" => {
                self.attributes(xml, NODE);
                self.step(xml, sheet, StepSort::Entry);
            }
            "exitStep" => {
                self.attributes(xml, NODE);
                self.step(xml, sheet, StepSort::Exit);
            }
            "transitions" => {
                self.attributes(xml, &time);
                self.put(xml, sheet, |s| &mut s.transitions, Some(Thing::Transition));
            }
            "synchronizations" => {
                self.attributes(xml, NODE);
                self.put(xml, sheet, |s| &mut s.synchronisations, Some(Thing::Synchronisation));
            }
            "arcs" => {
                self.attributes(xml, &["source", "target"]);
                self.put(xml, sheet, |s| &mut s.arcs, None);
            }
            "actionLinks" => {
                self.attributes(xml, &["step", "actionType"]);
                self.put(xml, sheet, |s| &mut s.links, None);
            }
            "actionTypes" => {
                let own = [
                    "storedActionType",
                    "continuousActionType",
                    "partialGrafcet",
                    "forcedSteps",
                    "forcingOrderType",
                ];
                self.attributes(xml, &[&time[..], &own[..]].concat());
                self.plan.things.insert(xml.id(), Thing::Action(self.plan.actions.len()));
                self.plan.actions.push(xml);
            }
            _ => self.unknown(xml),
        }
    }

    fn put(
        &mut self,
        xml: Xml<'a>,
        sheet: Option<usize>,
        list: for<'s> fn(&'s mut Sheet<'a>) -> &'s mut Vec<Xml<'a>>,
        thing: Option<fn(usize, usize) -> Thing>,
    ) {
        let Some(index) = sheet else { return self.outside(xml) };
        let Some(sheet) = self.plan.sheets.get_mut(index) else { return };
        let list = list(sheet);
        if let Some(thing) = thing {
            self.plan.things.insert(xml.id(), thing(index, list.len()));
        }
        list.push(xml);
    }

    fn step(&mut self, xml: Xml<'a>, sheet: Option<usize>, sort: StepSort) {
        let initial = self.flag(xml, "initial");
        let linked = self.flag(xml, "activationLink");
        let Some(index) = sheet else { return self.outside(xml) };
        let Some(sheet) = self.plan.sheets.get_mut(index) else { return };
        self.plan.things.insert(xml.id(), Thing::Step(index, sheet.steps.len()));
        sheet.steps.push(StepNode { xml, sort, initial, linked });
    }

    /// Reports a part of a chart that is outside of any chart.
    fn outside(&mut self, xml: Xml) {
        let tag = xml.tag_name().name();
        let what = say!("`{}` outside a chart is left out", shown(tag));
        self.report.element(&codes::LEFT_OUT, tag, &attr::head(xml), what);
    }

    fn variable(&mut self, xml: Xml<'a>, sheet: Option<usize>) {
        if xml.tag_name().name() != "variableDeclarations" {
            return self.unknown(xml);
        }
        self.attributes(xml, &["name", "variableDeclarationType", "step"]);
        let sort = match xml.attribute("variableDeclarationType") {
            None | Some("input") => VarSort::Input,
            Some("output") => VarSort::Output,
            Some("internal") => VarSort::Internal,
            Some("step") => VarSort::Step,
            Some(other) => {
                self.bad_value(
                    xml,
                    "variableDeclarationType",
                    other,
                    say!("input, output, internal or step"),
                );
                VarSort::Internal
            }
        };
        let ty = match xml.children().find(|c| c.has_tag_name("sort")).map(kind) {
            Some(Some("Bool")) => Type::Bool,
            Some(Some("Integer")) => Type::Dint,
            Some(other) => {
                let what = say!("a variable of the sort `{}`", shown(other.unwrap_or("")));
                self.report.say(&codes::BAD_VALUE, &attr::head(xml), what);
                Type::Bool
            }
            None => {
                let what = say!("a variable without a sort; it is read as a Boolean");
                self.report.say(&codes::DIFFERENT, &attr::head(xml), what);
                Type::Bool
            }
        };
        self.plan.things.insert(xml.id(), Thing::Var(self.plan.vars.len()));
        self.plan.vars.push(Var { xml, sort, ty, sheet });
    }

    /// A Boolean attribute; false if missing.
    fn flag(&mut self, xml: Xml, name: &str) -> bool {
        match xml.attribute(name).map(str::trim) {
            Some("true" | "1") => true,
            None | Some("false" | "0") => false,
            Some(other) => {
                self.bad_value(xml, name, other, say!("true or false"));
                false
            }
        }
    }

    fn bad_value(&mut self, xml: Xml, name: &str, value: &str, known: Said) {
        let at = attr::text(xml, name).map_or_else(|| attr::head(xml), |t| t.at);
        let what = say!("`{name}` is `{}`; it is {known}", shown(value));
        self.report.say(&codes::BAD_VALUE, &at, what);
    }

    /// Reports attributes that the meta-model does not have.
    fn attributes(&mut self, xml: Xml, known: &[&str]) {
        for attribute in xml.attributes() {
            let name = attribute.name();
            if attribute.namespace().is_none() && !known.contains(&name) {
                let what = say!("the meta-model has no attribute `{}` here; it is left out", shown(name));
                self.report.element(&codes::UNKNOWN_ELEMENT, name, &attribute.range(), what);
            }
        }
    }

    fn unknown(&mut self, xml: Xml) {
        let tag = xml.tag_name().name();
        let what = say!("the meta-model has no `{}` here; it is left out", shown(tag));
        self.report.element(&codes::UNKNOWN_ELEMENT, tag, &attr::head(xml), what);
        if let Some(text) = xml.document().input_text().get(attr::head(xml)) {
            self.report.keep(text);
        }
    }

    /// References to sorts repeat what the terms say; if one leads nowhere, the file is damaged
    /// nevertheless.
    fn left_over_references(&mut self, root: Xml<'a>) {
        for xml in root.descendants().filter(Xml::is_element) {
            for name in ["sort", "input"] {
                for reference in refs::list(xml, name) {
                    if let Err(what) = self.plan.refs.resolve(&reference.text) {
                        let what = say!("{what}; the chart does not need it");
                        self.report.element(&codes::LEFT_OUT, name, &reference.at, what);
                    }
                }
            }
        }
    }
}

/// The class of an element, without its package.
pub(super) fn kind<'a>(xml: Xml<'a>) -> Option<&'a str> {
    let value = xml.attributes().find(|a| a.name() == "type" && a.namespace().is_some())?.value();
    Some(value.rsplit_once(':').map_or(value, |(_, name)| name))
}

impl<'a> Plan<'a> {
    pub(super) fn step(&self, sheet: usize, step: usize) -> Option<&StepNode<'a>> {
        self.sheets.get(sheet).and_then(|s| s.steps.get(step))
    }

    /// The object of an attribute's single reference; reports a problem if there is none.
    pub(super) fn thing(&self, xml: Xml, name: &str, report: &mut Report) -> Option<(Thing, Range<usize>)> {
        self.things(xml, name, report).into_iter().next()
    }

    /// The objects of an attribute's references.
    pub(super) fn things(&self, xml: Xml, name: &str, report: &mut Report) -> Vec<(Thing, Range<usize>)> {
        let mut found = Vec::new();
        for reference in refs::list(xml, name) {
            match self.refs.resolve(&reference.text) {
                Err(what) => report.say(&codes::UNKNOWN_OBJECT, &reference.at, what),
                Ok(target) => match self.things.get(&target.id()) {
                    Some(thing) => found.push((*thing, reference.at)),
                    None => {
                        let tag = shown(target.tag_name().name());
                        let what =
                            say!("`{}` means a `{tag}` that takes no part here", shown(&reference.text));
                        report.say(&codes::UNKNOWN_OBJECT, &reference.at, what);
                    }
                },
            }
        }
        found
    }
}
