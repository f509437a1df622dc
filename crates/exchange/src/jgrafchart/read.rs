//! From XML elements to workspaces.

use std::collections::hash_map::Entry;
use std::ops::Range;

use g7_model::codes;
use g7_model::{Type, VarKind};
use roxmltree::{Document, Node as Xml};

use super::sheet::{
    Link, Node, Plan, Post, Sheet, SheetKind, StepNode, StepSort, TransitionNode, Value, Var,
};
use crate::report::Report;
use crate::xml::attr::{self, Text};

/// Half the width of JGrafchart's step symbol: its axis, in pixels from its left.
const STEP_AXIS: i32 = 30;
/// The same of its transition symbol.
const TRANSITION_AXIS: i32 = 15;
/// Longest text that a string variable holds, in bytes.
pub(super) const STRING_BYTES: u16 = 255;

/// Whether a file with this first element is one of JGrafchart's.
pub(crate) fn is_root(name: &str) -> bool {
    matches!(name, "GCDocument" | "GCDocumentCollection")
}

/// All workspaces of the file.
pub(super) fn sheets(tree: &Document, report: &mut Report) -> Plan {
    let root = tree.root_element();
    let mut reader = Reader { plan: Plan { sheets: Vec::new(), at: attr::head(root) }, report };
    match root.tag_name().name() {
        "GCDocument" => reader.top(root),
        "GCDocumentCollection" => {
            for child in root.children().filter(Xml::is_element) {
                if child.tag_name().name() == "GCDocument" {
                    reader.top(child);
                } else {
                    reader.unknown(child);
                }
            }
        }
        other => {
            let what = format!("the first element is `{other}`; JGrafchart's is `GCDocument`");
            reader.report.say(&codes::NOT_JGRAFCHART, &reader.plan.at, what);
        }
    }
    reader.plan
}

struct Reader<'r> {
    plan: Plan,
    report: &'r mut Report,
}

impl Reader<'_> {
    /// A workspace that runs by itself.
    fn top(&mut self, xml: Xml) {
        let name = attr::text(xml, "name").unwrap_or_default();
        let mut sheet = Sheet::new(SheetKind::Top, name, None, attr::head(xml));
        sheet.speed = self.number::<i64>(xml, "threadSpeed").filter(|ms| {
            let fits = (1..=3_600_000).contains(ms);
            if !fits {
                let what = format!("`threadSpeed` is {ms}; a scan takes 1 to 3600000 ms");
                self.report.say(&codes::BAD_VALUE, &attr::head(xml), what);
            }
            fits
        });
        let index = self.plan.sheets.len();
        self.plan.sheets.push(sheet);
        self.content(xml, index);
    }

    /// The workspace inside an element, if it has one.
    fn inner(&mut self, xml: Xml, kind: SheetKind, parent: usize) -> Option<usize> {
        let inside = xml.children().find(|c| c.has_tag_name("GCDocument"))?;
        let name = attr::text(xml, "name").unwrap_or_default();
        let index = self.plan.sheets.len();
        self.plan.sheets.push(Sheet::new(kind, name, Some(parent), attr::head(inside)));
        self.content(inside, index);
        Some(index)
    }

    /// Everything in a workspace, or in a group within it.
    fn content(&mut self, xml: Xml, sheet: usize) {
        for child in xml.children() {
            if child.is_element() {
                self.element(child, sheet);
            } else if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
                let what = "text between the elements has no meaning in a chart";
                self.report.element(&codes::UNKNOWN_ELEMENT, "text", &child.range(), what);
            }
        }
    }

    fn element(&mut self, xml: Xml, sheet: usize) {
        let tag = xml.tag_name().name();
        match tag {
            "GCStep" => self.step(xml, sheet, StepSort::Plain),
            "GCInitialStep" => self.step(xml, sheet, StepSort::Initial),
            "EnterStep" => self.step(xml, sheet, StepSort::Enter),
            "ExitStep" => self.step(xml, sheet, StepSort::Exit),
            "MacroStep" => {
                let inner = self.inner(xml, SheetKind::Macro, sheet);
                self.step(xml, sheet, StepSort::Macro(inner));
            }
            "ProcedureStep" | "ProcessStep" => {
                let what = format!("a `{tag}` calls a procedure; it is read as a step that calls none");
                self.not_carried(xml, &what);
                self.step(xml, sheet, StepSort::Plain);
            }
            "GCTransition" => self.transition(xml, sheet),
            "ParallelSplit" => self.bar(xml, sheet, Node::Split),
            "ParallelJoin" => self.bar(xml, sheet, Node::Join),
            "ConnectionPostIn" => self.post(xml, sheet, true),
            "ConnectionPostOut" => self.post(xml, sheet, false),
            "GCLink" => self.link(xml, sheet),
            "GCGroup" => self.content(xml, sheet),
            "WorkspaceObject" => {
                let name = attr::text(xml, "name").unwrap_or_default().text;
                if let Some(index) = self.inner(xml, SheetKind::Object, sheet) {
                    self.with(sheet, |s| s.objects.push((name, index)));
                }
            }
            "DigitalIn" | "DigitalIn1" | "AnalogIn" | "DigitalOut" | "DigitalOut0" | "DigitalOut1"
            | "AnalogOut" => {
                self.channel(xml, sheet);
            }
            "BooleanVariable" => self.variable(xml, sheet, Type::Bool),
            "IntegerVariable" => self.variable(xml, sheet, Type::Dint),
            "RealVariable" => self.variable(xml, sheet, Type::Lreal),
            "StringVariable" => self.variable(xml, sheet, Type::String(STRING_BYTES)),
            "FreeText" => {
                if let Some(text) = attr::text(xml, "text").filter(|t| !t.text.trim().is_empty()) {
                    self.with(sheet, |s| s.texts.push(text));
                }
            }
            _ => self.stranger(xml, sheet),
        }
    }

    fn with(&mut self, sheet: usize, change: impl FnOnce(&mut Sheet)) {
        if let Some(sheet) = self.plan.sheets.get_mut(sheet) {
            change(sheet);
        }
    }

    /// Remembers what an identifier stands for; the first of two keeps it.
    fn identify(&mut self, xml: Xml, sheet: usize, node: Node) {
        let Some(id) = attr::text(xml, "id").filter(|id| !id.text.is_empty()) else { return };
        let Some(known) = self.plan.sheets.get_mut(sheet) else { return };
        if let Entry::Vacant(place) = known.ids.entry(id.text.clone()) {
            place.insert(node);
        } else {
            let what = format!("a second element has the id `{}`; lines lead to the first", shown(&id.text));
            self.report.say(&codes::BAD_LINK, &id.at, what);
        }
    }

    fn step(&mut self, xml: Xml, sheet: usize, sort: StepSort) {
        let step = StepNode {
            sort,
            name: attr::text(xml, "name").unwrap_or_default(),
            actions: attr::text(xml, "actionText").unwrap_or_default(),
            at: attr::head(xml),
            x: self.pixels(xml, "x").saturating_add(STEP_AXIS),
            y: self.pixels(xml, "y"),
        };
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.steps.len());
        self.identify(xml, sheet, Node::Step(index));
        self.with(sheet, |s| s.steps.push(step));
        // Some editors derived from JGrafchart keep more inside a step.
        for child in xml.children().filter(Xml::is_element) {
            if !child.has_tag_name("GCDocument") {
                self.unknown(child);
            }
        }
    }

    fn transition(&mut self, xml: Xml, sheet: usize) {
        let transition = TransitionNode {
            condition: attr::text(xml, "actionText").unwrap_or_default(),
            priority: self.number::<u32>(xml, "priority"),
            at: attr::head(xml),
            x: self.pixels(xml, "x").saturating_add(TRANSITION_AXIS),
            y: self.pixels(xml, "y"),
        };
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.transitions.len());
        self.identify(xml, sheet, Node::Transition(index));
        self.with(sheet, |s| s.transitions.push(transition));
    }

    fn bar(&mut self, xml: Xml, sheet: usize, node: fn(usize) -> Node) {
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.bars);
        self.identify(xml, sheet, node(index));
        self.with(sheet, |s| s.bars += 1);
    }

    fn post(&mut self, xml: Xml, sheet: usize, inward: bool) {
        let name = attr::text(xml, "name").unwrap_or_default().text;
        let remote = attr::text(xml, "remoteString").unwrap_or_default().text;
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.posts.len());
        self.identify(xml, sheet, if inward { Node::PostIn(index) } else { Node::PostOut(index) });
        let post = Post { name, remote, inward, at: attr::head(xml) };
        self.with(sheet, |s| s.posts.push(post));
    }

    fn link(&mut self, xml: Xml, sheet: usize) {
        let from = attr::text(xml, "fromObject").unwrap_or_default();
        let to = attr::text(xml, "toObject").unwrap_or_default();
        let link = Link { from, to, at: attr::head(xml) };
        self.with(sheet, |s| s.links.push(link));
    }

    /// A digital or analogue input or output.
    fn channel(&mut self, xml: Xml, sheet: usize) {
        let tag = xml.tag_name().name();
        let inverted = tag.ends_with('1');
        let kind = if tag.contains("Out") { VarKind::Output } else { VarKind::Input };
        if attr::text(xml, "cyclic").is_some_and(|c| c.text == "0") {
            let what = format!("a `{tag}` that is read only on demand; it is read in every scan");
            self.report.say(&codes::DIFFERENT, &attr::head(xml), what);
        }
        let var = Var {
            name: attr::text(xml, "name").unwrap_or_default(),
            kind,
            ty: if tag.starts_with("Digital") { Type::Bool } else { Type::Real },
            init: (kind == VarKind::Output && inverted).then_some(Value::Bool(true)),
            channel: attr::text(xml, "channel").filter(|c| !c.text.trim().is_empty()),
            inverted,
            retain: false,
            at: attr::head(xml),
        };
        self.declare(var, sheet);
    }

    fn variable(&mut self, xml: Xml, sheet: usize, ty: Type) {
        let on = |name: &str| attr::text(xml, name).is_some_and(|v| v.text == "1" || v.text == "true");
        let initial = attr::text(xml, "initialValue").filter(|v| !v.text.is_empty());
        let fresh = initial.is_some();
        let value = initial.or_else(|| attr::text(xml, "value").filter(|v| !v.text.is_empty()));
        let constant = on("constant");
        if on("updated") {
            let what = "a variable that follows an expression of its own; it keeps its value instead";
            self.not_carried(xml, what);
        }
        let var = Var {
            name: attr::text(xml, "name").unwrap_or_default(),
            kind: if constant { VarKind::Const } else { VarKind::Var },
            ty,
            init: value.and_then(|v| self.value(&v, ty)),
            channel: None,
            inverted: false,
            retain: !constant && !fresh,
            at: attr::head(xml),
        };
        self.declare(var, sheet);
    }

    fn declare(&mut self, var: Var, sheet: usize) {
        if var.name.text.trim().is_empty() {
            let what = "a variable without a name; nothing can refer to it, so it is left out";
            self.report.say(&codes::LEFT_OUT, &var.at, what);
        } else {
            self.with(sheet, |s| s.vars.push(var));
        }
    }

    fn value(&mut self, text: &Text, ty: Type) -> Option<Value> {
        let word = text.text.trim();
        let value = match ty {
            Type::Bool => match word {
                "1" | "true" => Some(Value::Bool(true)),
                "0" | "false" => Some(Value::Bool(false)),
                _ => None,
            },
            Type::Dint => word.parse().ok().map(Value::Int),
            Type::Lreal => word.parse().ok().filter(|v: &f64| v.is_finite()).map(Value::Real),
            _ if text.text.len() <= usize::from(STRING_BYTES) => Some(Value::Str(text.text.clone())),
            _ => None,
        };
        if value.is_none() {
            let what = format!("`{}` is no value of type {ty}", shown(word));
            self.report.say(&codes::BAD_VALUE, &text.at, what);
        }
        value
    }

    /// An element that is not carried over: reported, kept as a note, never dropped in silence.
    fn stranger(&mut self, xml: Xml, sheet: usize) {
        let tag = xml.tag_name().name();
        self.identify(xml, sheet, Node::Stranger);
        if let Some(name) = attr::text(xml, "name").filter(|n| !n.text.is_empty()) {
            self.with(sheet, |s| {
                s.strangers.insert(name.text, tag.to_string());
            });
        }
        match tag {
            "ExceptionTransition" => self.not_carried(
                xml,
                "an exception transition, which leaves a macro-step at any of its steps, is not carried over",
            ),
            "StepFusionSet" => {
                self.not_carried(xml, "a step fusion set, whose steps are one step, is not carried over");
            }
            "GrafcetProcedure" => {
                self.left_out(xml, "a procedure is left out; each step that calls one is reported")
            }
            "GraphicalButton" | "AssignmentButton" | "ActionButton" => {
                let what = format!("a `{tag}` is left out: nothing is set by a click on it");
                self.left_out(xml, &what);
            }
            _ if is_data(tag) => {
                let what = format!("a `{tag}` is left out; each use of it is reported");
                self.left_out(xml, &what);
            }
            _ if is_drawing(tag) => {
                let what = format!("a `{tag}` is drawing only and left out");
                self.left_out(xml, &what);
            }
            _ => self.unknown(xml),
        }
    }

    fn not_carried(&mut self, xml: Xml, what: &str) {
        self.put(xml, &codes::NOT_CARRIED, what);
    }

    fn left_out(&mut self, xml: Xml, what: &str) {
        self.put(xml, &codes::LEFT_OUT, what);
    }

    fn unknown(&mut self, xml: Xml) {
        let what = format!("`{}` is no element of a chart that is known here", shown(xml.tag_name().name()));
        self.put(xml, &codes::UNKNOWN_ELEMENT, &what);
    }

    fn put(&mut self, xml: Xml, code: &'static codes::Code, what: &str) {
        let at = attr::head(xml);
        self.report.element(code, xml.tag_name().name(), &at, what);
        self.report.keep(xml.document().input_text().get(at).unwrap_or(""));
    }

    /// A number from an attribute; absent is fine, unreadable is reported.
    fn number<N: std::str::FromStr>(&mut self, xml: Xml, name: &str) -> Option<N> {
        let text = attr::text(xml, name).filter(|t| !t.text.trim().is_empty())?;
        let number = text.text.trim().parse().ok();
        if number.is_none() {
            let what = format!("`{name}` is `{}`, which is no number that fits here", shown(&text.text));
            self.report.say(&codes::BAD_VALUE, &text.at, what);
        }
        number
    }

    /// A coordinate; drawings do without one, so an unreadable one is 0.
    fn pixels(&mut self, xml: Xml, name: &str) -> i32 {
        const FAR: f64 = 100_000.0;
        let value = xml.attribute(name).and_then(|v| v.trim().parse::<f64>().ok()).filter(|v| v.is_finite());
        value.map_or(0, |v| v.clamp(-FAR, FAR) as i32)
    }
}

/// Text from the file, short enough for a message.
pub(super) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// The place of a name, or of the element when it has none.
pub(super) fn name_place(name: &Text, at: &Range<usize>) -> Range<usize> {
    if name.text.is_empty() { at.clone() } else { name.at.clone() }
}

/// Elements that hold data: without effect until something names them.
fn is_data(tag: &str) -> bool {
    matches!(
        tag,
        "BooleanList"
            | "IntegerList"
            | "RealList"
            | "StringList"
            | "IndexVariable"
            | "IntegerAttributeVariable"
            | "RealAttributeVariable"
            | "StringAttributeVariable"
            | "ByteStreamIn"
            | "ByteStreamOut"
            | "DPWSObject"
            | "LabCommObject"
            | "GCClass"
    ) || tag.starts_with("Socket")
        || tag.starts_with("XML")
}

/// Elements that are only looked at.
fn is_drawing(tag: &str) -> bool {
    matches!(
        tag,
        "GCRectangle"
            | "GC3DRect"
            | "GCEllipse"
            | "GCPolygon"
            | "GCStroke"
            | "GCLine"
            | "GCSpline"
            | "GCImage"
            | "Icon"
            | "LUCASLogo"
            | "Browser"
            | "SFCPlotter"
            | "ShowWorkspaceButton"
    )
}
