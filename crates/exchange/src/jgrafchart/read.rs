//! Reads workspaces from XML elements.

use std::collections::btree_map::Entry;
use std::ops::Range;

use g7_model::codes;
use g7_model::{Said, Type, VarKind, say};
use roxmltree::{Document, Node as Xml};

use super::other_elements::{is_data, is_drawing};
use super::sheet::{
    FreeText, Fusion, Link, Node, Plan, Post, Sheet, SheetKind, StepNode, StepSort, TransitionNode, Value,
    Var,
};
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr::{self, Text};

/// Half the width of JGrafchart's step symbol: the distance of its axis from its left side, in
/// pixels.
pub(super) const STEP_AXIS: i32 = 30;
/// The same distance for its transition symbol.
pub(super) const TRANSITION_AXIS: i32 = 15;
/// The longest string that a variable holds, in bytes.
pub(super) const STRING_BYTES: u16 = 255;

/// True if a file with this first element is one of JGrafchart's.
pub(crate) fn is_root(name: &str) -> bool {
    matches!(name, "GCDocument" | "GCDocumentCollection")
}

/// All workspaces of the file, and the procedures and steps that call them.
pub(super) fn sheets<'r, 'x>(tree: &'x Document<'x>, report: &'r mut Report) -> Reader<'r, 'x> {
    let root = tree.root_element();
    let plan = Plan { sheets: Vec::new(), at: attr::head(root) };
    let mut reader = Reader { plan, report, procedures: Vec::new(), callers: Vec::new(), chain: Vec::new() };
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
            let what = say!("the first element is `{other}`; JGrafchart's is `GCDocument`");
            reader.report.say(&codes::NOT_JGRAFCHART, &reader.plan.at, what);
        }
    }
    reader
}

/// A procedure of the file.
pub(super) struct Procedure<'x> {
    /// The workspace that contains it.
    pub(super) sheet: usize,
    pub(super) name: String,
    pub(super) xml: Xml<'x, 'x>,
}

/// A step that calls a procedure.
pub(super) struct Caller {
    pub(super) sheet: usize,
    pub(super) step: usize,
    pub(super) name: Text,
    pub(super) procedure: Text,
    pub(super) parameters: Text,
    pub(super) at: Range<usize>,
    /// The procedures in whose copies it is.
    pub(super) chain: Vec<usize>,
}

/// Reads workspaces one after the other.
pub(super) struct Reader<'r, 'x> {
    pub(super) plan: Plan,
    pub(super) report: &'r mut Report,
    /// The procedures of the file.
    pub(super) procedures: Vec<Procedure<'x>>,
    /// The steps that call a procedure and have not been handled yet.
    pub(super) callers: Vec<Caller>,
    /// The nested procedures that are being read.
    pub(super) chain: Vec<usize>,
}

impl<'x> Reader<'_, 'x> {
    /// A workspace that runs on its own.
    fn top(&mut self, xml: Xml<'x, 'x>) {
        let name = attr::text(xml, "name").unwrap_or_default();
        let mut sheet = Sheet::new(SheetKind::Top, name, None, attr::head(xml));
        sheet.speed = self.number::<i64>(xml, "threadSpeed").filter(|ms| {
            let fits = (1..=3_600_000).contains(ms);
            if !fits {
                let what = say!("`threadSpeed` is {ms}; a scan takes 1 to 3600000 ms");
                self.report.say(&codes::BAD_VALUE, &attr::head(xml), what);
            }
            fits
        });
        let index = self.plan.sheets.len();
        self.plan.sheets.push(sheet);
        self.content(xml, index);
    }

    /// The workspace within an element, if it has one.
    pub(super) fn inner(&mut self, xml: Xml<'x, 'x>, kind: SheetKind, parent: usize) -> Option<usize> {
        let inside = xml.children().find(|c| c.has_tag_name("GCDocument"))?;
        let name = attr::text(xml, "name").unwrap_or_default();
        let index = self.plan.sheets.len();
        let mut sheet = Sheet::new(kind, name, Some(parent), attr::head(inside));
        if kind == SheetKind::Macro {
            // The step of a macro-step is added after its workspace.
            sheet.owner = Some((parent, self.plan.sheets.get(parent).map_or(0, |s| s.steps.len())));
        }
        self.plan.sheets.push(sheet);
        self.content(inside, index);
        Some(index)
    }

    /// Everything in a workspace, or in a group within it.
    pub(super) fn content(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        for child in xml.children() {
            if child.is_element() {
                self.element(child, sheet);
            } else if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
                let what = say!("text between the elements has no meaning in a chart");
                self.report.element(&codes::UNKNOWN_ELEMENT, "text", &child.range(), what);
            }
        }
    }

    fn element(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
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
            "ProcedureStep" => {
                self.caller(xml, sheet);
                self.step(xml, sheet, StepSort::Macro(None));
            }
            "ProcessStep" => {
                let what = say!(
                    "a `ProcessStep` starts a procedure and does not wait for it, any number of times; \
                            it is read as a step that starts none"
                );
                self.not_carried(xml, what);
                self.step(xml, sheet, StepSort::Plain);
            }
            "GrafcetProcedure" => self.procedure(xml, sheet),
            "GCTransition" => self.transition(xml, sheet, false),
            "ExceptionTransition" => self.transition(xml, sheet, true),
            "StepFusionSet" => self.fusion(xml, sheet),
            "ParallelSplit" => self.bar(xml, sheet, Node::Split),
            "ParallelJoin" => self.bar(xml, sheet, Node::Join),
            "ConnectionPostIn" => self.post(xml, sheet, true),
            "ConnectionPostOut" => self.post(xml, sheet, false),
            "GCLink" => self.link(xml, sheet),
            "GCGroup" => self.content(xml, sheet),
            "WorkspaceObject" => {
                let name = attr::text(xml, "name").unwrap_or_default().text;
                let cycle = self.number::<i64>(xml, "scanCycle").filter(|n| (1..=1_000_000).contains(n));
                if attr::text(xml, "enabled").is_some_and(|e| e.text == "0") {
                    self.not_carried(xml, say!("a workspace object that stands still until it is enabled"));
                }
                if let Some(index) = self.inner(xml, SheetKind::Object, sheet) {
                    self.with(index, |s| s.cycle = cycle.unwrap_or(1));
                    self.with(sheet, |s| s.objects.push((name, index)));
                }
            }
            "DigitalIn" | "DigitalIn1" | "AnalogIn" | "DigitalOut" | "DigitalOut0" | "DigitalOut1"
            | "AnalogOut" => {
                self.channel(xml, sheet);
            }
            "SocketBooleanIn" | "SocketIntIn" | "SocketRealIn" | "SocketStringIn" | "SocketBooleanOut"
            | "SocketIntOut" | "SocketRealOut" | "SocketStringOut" => self.socket(xml, sheet),
            "BooleanVariable" => self.variable(xml, sheet, Type::Bool),
            "IntegerVariable" => self.variable(xml, sheet, Type::Dint),
            "RealVariable" => self.variable(xml, sheet, Type::Lreal),
            "StringVariable" => self.variable(xml, sheet, Type::String(STRING_BYTES)),
            "FreeText" => {
                if let Some(text) = attr::text(xml, "text").filter(|t| !t.text.trim().is_empty()) {
                    let (x, y) = (self.pixels(xml, "x"), self.pixels(xml, "y"));
                    self.with(sheet, |s| s.texts.push(FreeText { text, x, y }));
                }
            }
            _ => self.stranger(xml, sheet),
        }
    }

    pub(super) fn with(&mut self, sheet: usize, change: impl FnOnce(&mut Sheet)) {
        if let Some(sheet) = self.plan.sheets.get_mut(sheet) {
            change(sheet);
        }
    }

    /// Records a procedure; it is read where it is called.
    fn procedure(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let name = attr::text(xml, "name").unwrap_or_default().text;
        self.with(sheet, |s| {
            s.strangers.insert(name.clone(), "GrafcetProcedure".to_string());
        });
        self.procedures.push(Procedure { sheet, name, xml });
    }

    /// Records a step that calls a procedure; the reader adds the step itself.
    fn caller(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let caller = Caller {
            sheet,
            step: self.plan.sheets.get(sheet).map_or(0, |s| s.steps.len()),
            name: attr::text(xml, "name").unwrap_or_default(),
            procedure: attr::text(xml, "grafcetProcedure").unwrap_or_default(),
            parameters: attr::text(xml, "parameters").unwrap_or_default(),
            at: attr::head(xml),
            chain: self.chain.clone(),
        };
        self.callers.push(caller);
    }

    /// Records the object of an identifier; of two with the same one the first wins.
    fn identify(&mut self, xml: Xml<'x, 'x>, sheet: usize, node: Node) {
        let Some(id) = attr::text(xml, "id").filter(|id| !id.text.is_empty()) else { return };
        let Some(known) = self.plan.sheets.get_mut(sheet) else { return };
        if let Entry::Vacant(place) = known.ids.entry(id.text.clone()) {
            place.insert(node);
        } else {
            let what = say!("a second element has the id `{}`; lines lead to the first", shown(&id.text));
            self.report.say(&codes::BAD_LINK, &id.at, what);
        }
    }

    fn step(&mut self, xml: Xml<'x, 'x>, sheet: usize, sort: StepSort) {
        let step = StepNode {
            sort,
            name: attr::text(xml, "name").unwrap_or_default(),
            actions: vec![attr::text(xml, "actionText").unwrap_or_default()],
            fused: None,
            at: attr::head(xml),
            x: self.pixels(xml, "x").saturating_add(STEP_AXIS),
            y: self.pixels(xml, "y"),
        };
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.steps.len());
        self.identify(xml, sheet, Node::Step(index));
        self.with(sheet, |s| s.steps.push(step));
        // Some editors derived from JGrafchart store more within a step.
        for child in xml.children().filter(Xml::is_element) {
            if !child.has_tag_name("GCDocument") {
                self.unknown(child);
            }
        }
    }

    fn transition(&mut self, xml: Xml<'x, 'x>, sheet: usize, exception: bool) {
        let transition = TransitionNode {
            exception,
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

    fn bar(&mut self, xml: Xml<'x, 'x>, sheet: usize, node: fn(usize) -> Node) {
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.bars);
        self.identify(xml, sheet, node(index));
        self.with(sheet, |s| s.bars += 1);
    }

    fn post(&mut self, xml: Xml<'x, 'x>, sheet: usize, inward: bool) {
        let name = attr::text(xml, "name").unwrap_or_default().text;
        let remote = attr::text(xml, "remoteString").unwrap_or_default().text;
        let index = self.plan.sheets.get(sheet).map_or(0, |s| s.posts.len());
        self.identify(xml, sheet, if inward { Node::PostIn(index) } else { Node::PostOut(index) });
        let post = Post { name, remote, inward, at: attr::head(xml) };
        self.with(sheet, |s| s.posts.push(post));
    }

    fn link(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let from = attr::text(xml, "fromObject").unwrap_or_default();
        let to = attr::text(xml, "toObject").unwrap_or_default();
        let link = Link { from, to, at: attr::head(xml) };
        self.with(sheet, |s| s.links.push(link));
    }

    /// A step fusion set: texts in its workspace name the steps.
    fn fusion(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let inside = xml.children().find(|c| c.has_tag_name("GCDocument"));
        let mut members = Vec::new();
        for child in inside.into_iter().flat_map(|i| i.children()).filter(Xml::is_element) {
            if child.has_tag_name("FreeText") {
                members.extend(attr::text(child, "text").filter(|t| !t.text.trim().is_empty()));
            } else {
                self.unknown(child);
            }
        }
        let abortive = attr::text(xml, "abortive").is_some_and(|a| a.text == "1");
        self.with(sheet, |s| s.fusions.push(Fusion { members, abortive, at: attr::head(xml) }));
    }

    /// A variable that receives or sends messages on a socket.
    fn socket(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let tag = xml.tag_name().name();
        let kind = if tag.ends_with("Out") { VarKind::Output } else { VarKind::Input };
        let ty = match tag.trim_start_matches("Socket").trim_end_matches("Out").trim_end_matches("In") {
            "Boolean" => Type::Bool,
            "Int" => Type::Dint,
            "Real" => Type::Lreal,
            _ => Type::String(STRING_BYTES),
        };
        let way = if kind == VarKind::Input { say!("an input") } else { say!("an output") };
        let what = say!("a `{tag}` becomes {way} with its identifier as channel; the socket is not there");
        self.report.element(&codes::DIFFERENT, tag, &attr::head(xml), what);
        let var = Var {
            name: attr::text(xml, "name").unwrap_or_default(),
            kind,
            ty,
            init: None,
            channel: attr::text(xml, "identifier").filter(|c| !c.text.trim().is_empty()),
            inverted: false,
            retain: false,
            follows: None,
            at: attr::head(xml),
        };
        self.declare(var, sheet);
    }

    /// A digital or analogue input or output.
    fn channel(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let tag = xml.tag_name().name();
        let inverted = tag.ends_with('1');
        let kind = if tag.contains("Out") { VarKind::Output } else { VarKind::Input };
        if attr::text(xml, "cyclic").is_some_and(|c| c.text == "0") {
            let what = say!("a `{tag}` that is read only on demand; it is read in every scan");
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
            follows: None,
            at: attr::head(xml),
        };
        self.declare(var, sheet);
    }

    fn variable(&mut self, xml: Xml<'x, 'x>, sheet: usize, ty: Type) {
        let on = |name: &str| attr::text(xml, name).is_some_and(|v| v.text == "1" || v.text == "true");
        let initial = attr::text(xml, "initialValue").filter(|v| !v.text.is_empty());
        let fresh = initial.is_some();
        let value = initial.or_else(|| attr::text(xml, "value").filter(|v| !v.text.is_empty()));
        let constant = on("constant");
        let follows = attr::text(xml, "exp").filter(|_| on("updated") && !constant);
        let var = Var {
            name: attr::text(xml, "name").unwrap_or_default(),
            kind: if constant { VarKind::Const } else { VarKind::Var },
            ty,
            init: value.and_then(|v| self.value(&v, ty)),
            channel: None,
            inverted: false,
            retain: !constant && !fresh && follows.is_none(),
            follows,
            at: attr::head(xml),
        };
        self.declare(var, sheet);
    }

    fn declare(&mut self, var: Var, sheet: usize) {
        if var.name.text.trim().is_empty() {
            let what = say!("a variable without a name; nothing can refer to it, so it is left out");
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
            let what = say!("`{}` is no value of type {ty}", shown(word));
            self.report.say(&codes::BAD_VALUE, &text.at, what);
        }
        value
    }

    /// An element that is not carried over: reported and kept as a note.
    fn stranger(&mut self, xml: Xml<'x, 'x>, sheet: usize) {
        let tag = xml.tag_name().name();
        self.identify(xml, sheet, Node::Stranger);
        if let Some(name) = attr::text(xml, "name").filter(|n| !n.text.is_empty()) {
            self.with(sheet, |s| {
                s.strangers.insert(name.text, tag.to_string());
            });
        }
        match tag {
            "GraphicalButton" | "AssignmentButton" | "ActionButton" => {
                let what = say!("a `{tag}` is left out: nothing is set by a click on it");
                self.left_out(xml, what);
            }
            _ if is_data(tag) => {
                let what = say!("a `{tag}` is left out; each use of it is reported");
                self.left_out(xml, what);
            }
            _ if is_drawing(tag) => {
                let what = say!("a `{tag}` is drawing only and left out");
                self.left_out(xml, what);
            }
            _ => self.unknown(xml),
        }
    }

    pub(super) fn not_carried(&mut self, xml: Xml<'x, 'x>, what: Said) {
        self.put(xml, &codes::NOT_CARRIED, what);
    }

    fn left_out(&mut self, xml: Xml<'x, 'x>, what: Said) {
        self.put(xml, &codes::LEFT_OUT, what);
    }

    fn unknown(&mut self, xml: Xml<'x, 'x>) {
        let what = say!("`{}` is no element of a chart that is known here", shown(xml.tag_name().name()));
        self.put(xml, &codes::UNKNOWN_ELEMENT, what);
    }

    fn put(&mut self, xml: Xml<'x, 'x>, code: &'static codes::Code, what: Said) {
        let at = attr::head(xml);
        self.report.element(code, xml.tag_name().name(), &at, what);
        self.report.keep(xml.document().input_text().get(at).unwrap_or(""));
    }

    /// A number from an attribute. A missing one is None; one that cannot be read is reported.
    fn number<N: std::str::FromStr>(&mut self, xml: Xml<'x, 'x>, name: &str) -> Option<N> {
        let text = attr::text(xml, name).filter(|t| !t.text.trim().is_empty())?;
        let number = text.text.trim().parse().ok();
        if number.is_none() {
            let what = say!("`{name}` is `{}`, which is no number that fits here", shown(&text.text));
            self.report.say(&codes::BAD_VALUE, &text.at, what);
        }
        number
    }

    /// A coordinate. One that cannot be read is 0, because a drawing is not essential.
    fn pixels(&mut self, xml: Xml<'x, 'x>, name: &str) -> i32 {
        const FAR: f64 = 100_000.0;
        let value = xml.attribute(name).and_then(|v| v.trim().parse::<f64>().ok()).filter(|v| v.is_finite());
        value.map_or(0, |v| v.clamp(-FAR, FAR) as i32)
    }
}
