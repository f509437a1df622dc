//! The functions, the function blocks without a chart, and the statements of all units, in the forms that the reader of
//! texts makes of them: calls with `EN`, functions with outputs, in-outs, `TIME()`.
//!
//! ```text
//! read (Project), types (Shapes) -> here (Code) -> units (names) -> bodies (statements) -> build
//!                                   sfc (rewrite)
//! ```
//!
//! Statements keep the names of the file; `bodies` gives those of charts and programs the names of the document.
//!
//! Three kinds of function block are not read here: those that have a chart, those that have actions, and those that
//! hold an instance of such a function block. `units` makes a chart of each instance of them.

use std::collections::{BTreeSet, HashMap, HashSet};

use g7_model::codes;
use g7_model::{Item, Name, Problem, Stmt, VarDecl, VarKind, say};
use roxmltree::NodeId;

use super::addresses::address;
use super::network;
use super::read::variables;
use super::read::{Pou, PouKind, Project, SectionKind};
use super::tree::{self, Language, Xml, head, kids, name_of, tag};
use super::types::{self, Known, Shapes};
use crate::il;
use crate::nodes::line;
use crate::report::Report;
use crate::sfc::{self, Part, Source, Unit, UnitKind};
use crate::st::{self, Section, Shape, Variable};
use crate::xml::attr;

/// The code of a project, as a document has it.
#[derive(Default)]
pub(super) struct Code {
    /// True for each unit of the project that is a function or a function block without a chart.
    pub(super) plain: Vec<bool>,
    /// Constants, types and function blocks.
    pub(super) items: Vec<Item>,
    pub(super) functions: Vec<Item>,
    /// The names of the function blocks among these, in upper case.
    pub(super) blocks: HashSet<String>,
    /// Variables of the file that the passes of `sfc` add, such as the timer for `TIME()`.
    pub(super) globals: Vec<VarDecl>,
    /// Statements that run before all others.
    pub(super) before: Vec<Stmt>,
    /// Variables that these passes add to a unit of the project, such as the instances of functions.
    pub(super) made: HashMap<usize, Vec<VarDecl>>,
    /// The functions that became function blocks, in upper case.
    pub(super) wide: HashSet<String>,
    /// The rewritten statements of each body.
    bodies: HashMap<NodeId, Vec<Stmt>>,
}

impl Code {
    /// The statements of a body in any language except SFC.
    pub(super) fn body(&self, language: Language, node: Xml, report: &mut Report) -> Vec<Stmt> {
        let known = self.bodies.get(&node.id()).cloned();
        known.unwrap_or_else(|| statements(language, node, report))
    }
}

/// Reads the code of a project.
pub(super) fn read<'a>(project: &Project<'a>, shapes: &mut Shapes<'a>, report: &mut Report) -> Code {
    let plain = plain(project);
    let used = used(project, &plain, report);
    let (mut source, origins) = Reader { project, shapes, report }.source(&plain, &used);
    let own_globals = source.globals.len();
    let functions = names(&source, UnitKind::Function);
    sfc::rewrite(&mut source, report);
    let mut code = Code { plain, ..Code::default() };
    code.wide = &names(&source, UnitKind::FunctionBlock) & &functions;
    code.items = sfc::types(&mut source, report);
    code.blocks = source.blocks.iter().map(|b| b.name.text.to_uppercase()).collect();
    code.globals = source.globals.drain(own_globals..).map(|v| v.decl).collect();
    code.globals.extend(externals(project, &source, report));
    code.before = std::mem::take(&mut source.before);
    code.keep_units(&source, origins, report);
    shapes.types = source.types;
    code
}

/// The names of all units of a kind, in upper case.
fn names(source: &Source, kind: UnitKind) -> HashSet<String> {
    source.units.iter().filter(|u| u.kind == kind).map(|u| u.name.text.to_uppercase()).collect()
}

/// Where a unit comes from: its number in the project, how many variables it declares, and its bodies.
struct Origin {
    index: usize,
    variables: usize,
    nodes: Vec<NodeId>,
}

/// The origins of units, by their names in upper case.
type Origins = HashMap<String, Origin>;

impl Code {
    /// Keeps the functions, and what became of the other units.
    fn keep_units(&mut self, source: &Source, mut origins: Origins, report: &mut Report) {
        for unit in &source.units {
            match unit.kind {
                UnitKind::Function => self.functions.extend(function(source, unit, report)),
                UnitKind::FunctionBlock => {
                    let what = say!("the function block `{}` is not used; it is left out", unit.name.text);
                    report.put(Problem::new(&codes::LEFT_OUT, unit.name.at.0, what));
                }
                UnitKind::Program => {
                    if let Some(origin) = origins.remove(&unit.name.text.to_uppercase()) {
                        self.keep(unit, origin);
                    }
                }
            }
        }
    }

    /// Keeps the rewritten statements of a unit and the variables that they need.
    fn keep(&mut self, unit: &Unit, origin: Origin) {
        let made: Vec<VarDecl> = unit.vars.iter().skip(origin.variables).map(|v| v.decl.clone()).collect();
        if !made.is_empty() {
            self.made.insert(origin.index, made);
        }
        for (part, node) in unit.parts.iter().zip(origin.nodes) {
            if let Part::Action { body, .. } = part {
                self.bodies.insert(node, body.clone());
            }
        }
    }
}

fn function(source: &Source, unit: &Unit, report: &mut Report) -> Option<Item> {
    let made = sfc::function(source, unit, report);
    if made.is_none() {
        let what = say!("the function `{}` has no result that can be carried over", unit.name.text);
        report.put(Problem::new(&codes::NOT_CARRIED, unit.name.at.0, what));
    }
    made.map(Item::Function)
}

/// The variables that function blocks expect in the file and nobody declares.
fn externals(project: &Project, source: &Source, report: &mut Report) -> Vec<VarDecl> {
    let globals = project.globals.iter().flat_map(|s| &s.variables).filter_map(|v| name_of(*v));
    let mut known: HashSet<String> = globals.map(|n| n.to_uppercase()).collect();
    let mut made = Vec::new();
    for Variable { decl, .. } in &source.externals {
        let Some(name) = decl.names.first() else { continue };
        if known.insert(name.text.to_uppercase()) {
            let what = say!("no global variable is called `{}`; it is one of its own", name.text);
            report.put(Problem::new(&codes::OPEN_LINK, decl.at.0, what));
            made.push(decl.clone());
        }
    }
    made
}

/// The units that are functions, or function blocks with nothing but statements.
fn plain(project: &Project) -> Vec<bool> {
    let charts = |pou: &Pou| {
        let body = |node: &Xml| matches!(tree::body(*node), Some((Language::Sfc, _)));
        body(&pou.node) || !pou.actions.is_empty() || !pou.transitions.is_empty()
    };
    // The only function block of a file without programs runs as a program.
    let alone = project.pous.iter().filter(|p| p.kind != PouKind::Function).count() == 1;
    let mut holders: HashMap<String, Vec<usize>> = HashMap::new();
    for (index, pou) in project.pous.iter().enumerate() {
        for name in contained(pou) {
            holders.entry(name).or_default().push(index);
        }
    }
    let mut plain: Vec<bool> = project.pous.iter().map(|p| p.kind != PouKind::Program).collect();
    let blocks = project.pous.iter().enumerate().filter(|(_, p)| p.kind == PouKind::Block);
    let mut open: Vec<usize> = blocks.filter(|(_, p)| alone || charts(p)).map(|(i, _)| i).collect();
    while let Some(index) = open.pop() {
        if plain.get_mut(index).is_some_and(|p| std::mem::replace(p, false)) {
            let name = project.pous.get(index).map(|p| p.name.text.trim().to_uppercase());
            open.extend(name.and_then(|n| holders.remove(&n)).unwrap_or_default());
        }
    }
    plain
}

/// The types of a unit's variables that the file may declare, in upper case, also those of arrays.
fn contained(pou: &Pou) -> BTreeSet<String> {
    variables(pou).filter_map(super::read::type_of).flat_map(named_within).collect()
}

/// The names of types that stand within an element, in upper case.
fn named_within<'a>(node: Xml<'a>) -> impl Iterator<Item = String> + use<'a> {
    let named = |n: &Xml| n.is_element() && matches!(&*tag(*n), "derived" | "typeName");
    node.descendants().filter(named).filter_map(|n| match types::plain(n) {
        Known::Derived(name) => Some(name.to_uppercase()),
        Known::Type(_) | Known::None => None,
    })
}

/// The function blocks without a chart that are used. Reports the others.
fn used(project: &Project, plain: &[bool], report: &mut Report) -> HashSet<usize> {
    let is_block = |i: usize| {
        plain.get(i) == Some(&true) && project.pous.get(i).is_some_and(|p| p.kind == PouKind::Block)
    };
    let mut by_name: HashMap<String, usize> = HashMap::new();
    for (index, pou) in project.pous.iter().enumerate().rev() {
        by_name.insert(pou.name.text.trim().to_uppercase(), index);
    }
    let globals = project.globals.iter().flat_map(|s| &s.variables);
    let mut open: Vec<String> = globals.chain(&project.types).flat_map(|node| named_within(*node)).collect();
    let running = project.pous.iter().enumerate().filter(|(i, _)| !is_block(*i));
    open.extend(running.flat_map(|(_, pou)| contained(pou)));
    let mut used = HashSet::new();
    while let Some(name) = open.pop() {
        let Some(index) = by_name.get(&name).copied().filter(|i| is_block(*i)) else { continue };
        if used.insert(index) {
            open.extend(project.pous.get(index).map(contained).unwrap_or_default());
        }
    }
    for (index, pou) in project.pous.iter().enumerate() {
        if is_block(index) && !used.contains(&index) {
            let what = say!("the function block `{}` is not used; it is left out", line(&pou.name.text));
            report.say(&codes::LEFT_OUT, &head(pou.node), what);
        }
    }
    used
}

/// The statements of a body, with the names of the file.
fn statements(language: Language, node: Xml, report: &mut Report) -> Vec<Stmt> {
    let text = attr::content(node);
    match language {
        Language::St => st::statements(&text.text, &|r| text.place(&r), report),
        Language::Il => il::statements(&text.text, &|r| text.place(&r), report),
        Language::Ld | Language::Fbd => network::statements(node, report),
        Language::Sfc => Vec::new(),
    }
}

struct Reader<'r, 'a> {
    project: &'r Project<'a>,
    shapes: &'r mut Shapes<'a>,
    report: &'r mut Report,
}

impl<'a> Reader<'_, 'a> {
    /// All units but function blocks that nothing uses, with the global variables and the types; and the origins of the
    /// units.
    fn source(mut self, plain: &[bool], used: &HashSet<usize>) -> (Source, Origins) {
        let project = self.project;
        let mut source = Source { globals: self.globals(), ..Source::default() };
        let mut origins = Origins::new();
        for (index, pou) in project.pous.iter().enumerate() {
            let plain = plain.get(index) == Some(&true);
            if plain && pou.kind == PouKind::Block && !used.contains(&index) {
                continue;
            }
            let (unit, nodes) = self.unit(pou, plain);
            let origin = Origin { index, variables: unit.vars.len(), nodes };
            origins.insert(unit.name.text.to_uppercase(), origin);
            source.units.push(unit);
        }
        source.types = std::mem::take(&mut self.shapes.types);
        (source, origins)
    }

    fn globals(&mut self) -> Vec<Variable> {
        let project = self.project;
        let variables = project.globals.iter().flat_map(|s| &s.variables);
        variables.filter_map(|v| self.typed(*v, Section::Global)).collect()
    }

    /// The name and the type of a variable.
    fn shape(&mut self, variable: Xml<'a>) -> Option<(Name, Shape)> {
        let name = types::name(variable, self.report)?;
        let shape = self.shapes.shape(variable, &name, self.report)?;
        Some((name, shape))
    }

    /// A variable without its initial value, for the passes that only look at types.
    fn typed(&mut self, variable: Xml<'a>, section: Section) -> Option<Variable> {
        let (name, shape) = self.shape(variable)?;
        Some(self.without_value(&name, &shape, section, variable))
    }

    fn without_value(&self, name: &Name, shape: &Shape, section: Section, node: Xml) -> Variable {
        let (decl, _) = st::declared(name, shape, None, self.report.span(&head(node)).into());
        Variable { section, decl, unknown: shape.unknown().cloned() }
    }

    /// A unit. The bodies of a unit that is not plain become actions of it; their elements are given as well.
    fn unit(&mut self, pou: &Pou<'a>, plain: bool) -> (Unit, Vec<NodeId>) {
        let at = self.report.span(&head(pou.node));
        let name = Name::new(line(pou.name.text.trim()), self.report.span(&pou.name.at));
        let kind = match pou.kind {
            _ if !plain => UnitKind::Program,
            PouKind::Function => UnitKind::Function,
            PouKind::Block | PouKind::Program => UnitKind::FunctionBlock,
        };
        let mut unit = Unit::new(kind, name, at);
        let mut nodes = Vec::new();
        unit.vars = self.variables(pou, plain);
        if !plain {
            for (language, node) in bodies(pou) {
                let body = statements(language, node, self.report);
                unit.parts.push(Part::Action { name: unit.name.clone(), body, at });
                nodes.push(node.id());
            }
            return (unit, nodes);
        }
        unit.result = pou.result.and_then(|node| {
            let shape = self.shapes.shape(node, &unit.name, self.report)?;
            Some(self.without_value(&unit.name, &shape, Section::Output, node))
        });
        match tree::body(pou.node) {
            Some((Language::Sfc, node)) => {
                let what = say!("a function whose body is a chart");
                self.report.say(&codes::NOT_CARRIED, &head(node), what);
            }
            Some((language, node)) => {
                unit.body = statements(language, node, self.report);
                unit.body_at = node.range();
            }
            None => {}
        }
        (unit, nodes)
    }

    fn variables(&mut self, pou: &Pou<'a>, plain: bool) -> Vec<Variable> {
        let mut made = Vec::new();
        for section in &pou.sections {
            let kind = match section.kind {
                SectionKind::Local => Section::Local,
                SectionKind::Temp => Section::Temp,
                SectionKind::Input => Section::Input,
                SectionKind::Output => Section::Output,
                SectionKind::InOut => Section::InOut,
                SectionKind::External => Section::External,
                SectionKind::Global => Section::Global,
            };
            for variable in &section.variables {
                made.extend(if plain {
                    self.declared(*variable, section, kind, pou.kind == PouKind::Function)
                } else {
                    self.typed(*variable, kind)
                });
            }
        }
        made
    }

    /// A variable of a function or function block with its whole declaration. Inputs of a function keep their limits.
    fn declared(
        &mut self,
        variable: Xml<'a>,
        of: &super::read::Section,
        section: Section,
        function: bool,
    ) -> Option<Variable> {
        let (name, shape) = self.shape(variable)?;
        let mut decl = self.shapes.declaration(variable, &name, &shape, self.report);
        decl.kind = match section {
            _ if of.is_constant() => VarKind::Const,
            Section::Input => VarKind::Input,
            Section::Output => VarKind::Output,
            _ => VarKind::Var,
        };
        decl.retain = of.retain && decl.kind == VarKind::Var;
        decl.address = address(variable, self.report);
        if !(function && section == Section::Input) {
            st::fit(&mut decl).into_iter().for_each(|p| self.report.put(p));
        }
        Some(Variable { section, decl, unknown: shape.unknown().cloned() })
    }
}

/// The bodies of a unit in statements: its own, those of its actions, and those of the action blocks of steps.
fn bodies<'a>(pou: &Pou<'a>) -> Vec<(Language, Xml<'a>)> {
    let action = |n: &Xml| n.is_element() && tag(*n) == "action";
    let inline = pou.node.descendants().filter(action).flat_map(|n| kids(n).filter(|k| tag(*k) == "inline"));
    let all = std::iter::once(pou.node).chain(pou.actions.iter().copied()).chain(inline);
    all.filter_map(tree::body).filter(|(language, _)| *language != Language::Sfc).collect()
}
