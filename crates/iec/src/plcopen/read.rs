//! Reads the units of a project from XML elements: its POUs, global variables and tasks.

use g7_model::{Nanos, codes, say};
use roxmltree::Document;

use super::tree::{self, Xml, head, kid, kids, tag, text, word};
use crate::report::Report;
use crate::xml::attr::Text;

/// The content of a project.
#[derive(Default)]
pub(super) struct Project<'a> {
    /// Programs, function blocks and functions, in the order of the file.
    pub(super) pous: Vec<Pou<'a>>,
    /// Variables of configurations, resources and lists of their own.
    pub(super) globals: Vec<Section<'a>>,
    /// Programs that run, with the interval of their task.
    pub(super) runs: Vec<Run<'a>>,
    /// The shortest interval of all tasks.
    pub(super) cycle: Option<Nanos>,
    /// The elements that declare types.
    pub(super) types: Vec<Xml<'a>>,
    /// The start tag of the project.
    pub(super) at: std::ops::Range<usize>,
}

/// The kind of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PouKind {
    /// Runs on its own.
    Program,
    /// Runs where an instance of it is called.
    Block,
    /// Has a result and no memory.
    Function,
}

/// A program organization unit.
pub(super) struct Pou<'a> {
    pub(super) name: Text,
    pub(super) kind: PouKind,
    /// The type of a function's result.
    pub(super) result: Option<Xml<'a>>,
    pub(super) sections: Vec<Section<'a>>,
    pub(super) actions: Vec<Xml<'a>>,
    pub(super) transitions: Vec<Xml<'a>>,
    pub(super) node: Xml<'a>,
}

/// The kind of a declaration section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SectionKind {
    Local,
    Temp,
    Input,
    Output,
    InOut,
    External,
    Global,
}

/// Variables that are declared together.
#[derive(Clone)]
pub(super) struct Section<'a> {
    pub(super) kind: SectionKind,
    /// The name of a list of global variables.
    pub(super) name: Option<String>,
    pub(super) constant: bool,
    pub(super) retain: bool,
    pub(super) variables: Vec<Xml<'a>>,
}

impl Section<'_> {
    /// True if its variables are constants.
    pub(super) fn is_constant(&self) -> bool {
        self.constant && self.kind != SectionKind::External
    }
}

/// A program that a task runs.
pub(super) struct Run<'a> {
    pub(super) name: String,
    pub(super) pou: String,
    pub(super) interval: Option<Nanos>,
    pub(super) node: Xml<'a>,
}

/// Reads all of the file, or reports why it cannot be read.
pub(super) fn project<'a>(tree: &'a Document<'a>, report: &mut Report) -> Project<'a> {
    let root = tree.root_element();
    let mut project = Project { at: head(root), ..Project::default() };
    if tag(root) != "project" {
        let what = say!("the first element is `{}`; that of TC6 XML is `project`", root.tag_name().name());
        report.say(&codes::NOT_JGRAFCHART, &project.at, what);
        return project;
    }
    let mut reader = Reader { project: &mut project, report };
    reader.within(root, None);
    project
}

struct Reader<'r, 'a> {
    project: &'r mut Project<'a>,
    report: &'r mut Report,
}

impl<'a> Reader<'_, 'a> {
    /// Reads all elements at any depth, because CODESYS stores units in `addData`.
    fn within(&mut self, node: Xml<'a>, interval: Option<Nanos>) {
        for child in kids(node) {
            match tag(child).as_str() {
                "pou" | "program" | "functionBlock" | "function" if word(child, "name").is_some() => {
                    self.pou(child);
                }
                "pouInstance" | "programInstance" => self.run(child, interval),
                "task" => {
                    let interval = self.interval(child);
                    let shorter = |known: Nanos| interval.map_or(known, |i| i.min(known));
                    self.project.cycle = self.project.cycle.map(shorter).or(interval);
                    self.within(child, interval);
                }
                "globalVars" => {
                    let section = section(child, SectionKind::Global);
                    self.project.globals.push(section);
                }
                "dataType" | "dataTypeDecl" | "userDefinedTypeDecl" => self.project.types.push(child),
                "accessVars" | "configVars" => {
                    let what = say!("access paths and configured addresses are left out");
                    self.report.element(&codes::LEFT_OUT, &tag(child), &head(child), what);
                }
                _ => self.within(child, interval),
            }
        }
    }

    fn pou(&mut self, node: Xml<'a>) {
        let kind = match (tag(node).as_str(), word(node, "pouType")) {
            ("functionBlock", _) | (_, Some("functionBlock")) => PouKind::Block,
            ("function", _) | (_, Some("function")) => PouKind::Function,
            ("program", _) | (_, Some("program") | None) => PouKind::Program,
            (_, Some(other)) => {
                let what = say!("`{other}` is no kind of unit; it is read as a program");
                self.report.say(&codes::BAD_VALUE, &head(node), what);
                PouKind::Program
            }
        };
        let mut pou = Pou {
            name: text(node, "name").unwrap_or_default(),
            kind,
            result: None,
            sections: Vec::new(),
            actions: Vec::new(),
            transitions: Vec::new(),
            node,
        };
        parts(node, &mut pou);
        if kids(node).filter(|n| tag(*n) == "body").count() > 1 {
            let what = say!("a unit with several bodies (worksheets); only the first is read");
            self.report.say(&codes::NOT_CARRIED, &head(node), what);
        }
        self.project.pous.push(pou);
    }

    fn run(&mut self, node: Xml<'a>, interval: Option<Nanos>) {
        let pou = word(node, "typeName").or_else(|| word(node, "name")).unwrap_or("").to_string();
        let name = word(node, "name").unwrap_or("").to_string();
        self.project.runs.push(Run { name, pou, interval, node });
    }

    fn interval(&mut self, node: Xml) -> Option<Nanos> {
        let word = text(node, "interval").filter(|t| !t.text.trim().is_empty())?;
        let time = duration(word.text.trim());
        if time.is_none() {
            let what = say!("`{}` is no interval that can be read", word.text.trim());
            self.report.say(&codes::DIFFERENT, &word.at, what);
        }
        time.filter(|t| *t > Nanos::ZERO)
    }
}

/// The declarations, actions and transitions of a unit.
fn parts<'a>(node: Xml<'a>, pou: &mut Pou<'a>) {
    for child in kids(node) {
        let kind = match tag(child).as_str() {
            "interface" => {
                parts(child, pou);
                continue;
            }
            "returnType" => {
                pou.result = Some(child);
                continue;
            }
            "actions" => {
                pou.actions.extend(kids(child).filter(|n| tag(*n) == "action"));
                continue;
            }
            "transitions" => {
                pou.transitions.extend(kids(child).filter(|n| tag(*n) == "transition"));
                continue;
            }
            "addData" => {
                hidden(child, pou);
                continue;
            }
            "localVars" => SectionKind::Local,
            "tempVars" => SectionKind::Temp,
            "inputVars" => SectionKind::Input,
            "outputVars" => SectionKind::Output,
            "inOutVars" | "inoutVars" => SectionKind::InOut,
            "externalVars" => SectionKind::External,
            "globalVars" => SectionKind::Global,
            _ => continue,
        };
        pou.sections.push(section(child, kind));
    }
}

/// Actions that CODESYS stores in `addData`.
fn hidden<'a>(node: Xml<'a>, pou: &mut Pou<'a>) {
    for data in kids(node).filter(|n| tag(*n) == "data") {
        pou.actions.extend(kids(data).filter(|n| tag(*n) == "action" && tree::body(*n).is_some()));
    }
}

fn section(node: Xml<'_>, kind: SectionKind) -> Section<'_> {
    Section {
        kind,
        name: word(node, "name").map(str::to_string),
        constant: tree::flag(node, "constant"),
        retain: tree::flag(node, "retain") || tree::flag(node, "persistent"),
        variables: kids(node).filter(|n| tag(*n) == "variable").collect(),
    }
}

/// The written type of a variable. None if it is a parameter of a block.
pub(super) fn type_of(variable: Xml<'_>) -> Option<Xml<'_>> {
    kid(variable, "type")
}

/// `00:00:00.100000`, as some tools write intervals.
fn clock(word: &str) -> Option<Nanos> {
    let mut parts = word.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next()?);
    let whole =
        3600.0 * f64::from(hours.parse::<u16>().ok()?) + 60.0 * f64::from(minutes.parse::<u16>().ok()?);
    let seconds: f64 = seconds.parse().ok().filter(|s: &f64| (0.0..60.0).contains(s))?;
    let count = format!("{:.0}", (whole + seconds) * 1e9).parse().ok()?;
    parts.next().is_none().then_some(Nanos::new(count))
}

/// A duration as IEC 61131-3 or ISO 8601 writes it.
pub(super) fn duration(word: &str) -> Option<Nanos> {
    let upper = word.to_ascii_uppercase();
    if let Some(time) = clock(word) {
        return Some(time);
    }
    let rest = ["T#", "TIME#", "LT#", "LTIME#", "PT"].iter().find_map(|p| upper.strip_prefix(p));
    let text = rest.unwrap_or(&upper).replace('_', "");
    let mut left = text.as_str();
    let mut total: f64 = 0.0;
    while !left.is_empty() {
        let digits = left.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(left.len());
        let number: f64 = left.get(..digits)?.parse().ok()?;
        left = left.get(digits..)?;
        let letters = left.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(left.len());
        let unit = match left.get(..letters)? {
            "D" => 86_400e9,
            "H" => 3_600e9,
            "M" => 60e9,
            "S" => 1e9,
            "MS" | "" => 1e6,
            "US" => 1e3,
            "NS" => 1.0,
            _ => return None,
        };
        total += number * unit;
        left = left.get(letters..)?;
    }
    (total <= 9.2e18 && rest.or(Some(&upper)).is_some_and(|r| !r.is_empty()))
        .then(|| format!("{total:.0}").parse().ok())
        .flatten()
        .map(Nanos::new)
}

/// Every declared variable of a unit.
pub(super) fn variables<'p, 'a>(pou: &'p Pou<'a>) -> impl Iterator<Item = Xml<'a>> + use<'p, 'a> {
    pou.sections.iter().filter(|s| s.kind != SectionKind::External).flat_map(|s| s.variables.iter().copied())
}
