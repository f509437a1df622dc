//! Declarations: variables and user-defined structures.

use std::collections::HashMap;

use g7_model::codes;
use g7_model::{Document, Name, Said, Type, VarDecl, VarKind, say};
use roxmltree::Node;

use super::read::{kid, kids, line};
use g7_iec::nodes;
use g7_iec::report::Report;
use g7_iec::st::{self, elementary};
use g7_iec::xml::attr;

/// The most variables of one application.
const MOST: usize = 50_000;
/// The deepest nesting of structures.
const DEEPEST: usize = 16;

/// Reads the declarations of a file.
pub(super) struct Data<'a> {
    structures: HashMap<String, Node<'a, 'a>>,
    pub(super) vars: Vec<VarDecl>,
    /// Variables whose type is missing in the file, by names in upper case, with the name of the
    /// type.
    pub(super) open: HashMap<String, (String, VarDecl)>,
}

/// A type by its name, including those that only Control Expert has.
fn simple(name: &str) -> Option<Type> {
    let upper = name.trim().to_ascii_uppercase();
    if upper == "EBOOL" {
        return Some(Type::Bool);
    }
    let text = upper.strip_prefix("STRING[").and_then(|n| n.strip_suffix(']'));
    if let Some(length) = text.and_then(|n| n.parse().ok()) {
        return Some(Type::String(length));
    }
    elementary(&upper)
}

pub(super) fn data<'a>(root: Node<'a, 'a>, report: &mut Report) -> Data<'a> {
    let structures = root.descendants().filter(|n| n.has_tag_name("DDTSource"));
    let structures = structures
        .filter_map(|n| Some((n.attribute("DDTName")?.to_ascii_uppercase(), kid(n, "structure")?)))
        .collect();
    let mut data = Data { structures, vars: Vec::new(), open: HashMap::new() };
    for block in root.descendants().filter(|n| n.has_tag_name("dataBlock")) {
        for node in kids(block, "variables") {
            let name = nodes::line(&node.attribute("name").unwrap_or("").replace('`', "'"));
            if !name.is_empty() {
                data.variable(node, &name, 0, report);
            }
        }
    }
    data
}

impl<'a> Data<'a> {
    fn variable(&mut self, node: Node<'a, 'a>, name: &str, depth: usize, report: &mut Report) {
        let at = attr::head(node);
        if self.vars.len() >= MOST || depth > DEEPEST {
            report.element(&codes::TOO_LARGE, "variables", &at, say!("more variables than are read"));
            return;
        }
        let ty = node.attribute("typeName").unwrap_or("BOOL");
        let mut decl = nodes::variable(VarKind::Var, name, Type::Bool, report.span(&at));
        let comment = line(kid(node, "comment"));
        decl.comment = (!comment.is_empty()).then(|| comment.into());
        self.address(node, &mut decl, report);
        match (simple(ty), self.structures.get(&ty.trim().to_ascii_uppercase()).copied()) {
            (Some(known), _) => {
                decl.ty = known;
                if matches!(known, Type::Fb(_)) {
                    presets(node, name, report);
                } else {
                    initial(node, &mut decl, report);
                }
                self.vars.push(decl);
            }
            (None, Some(structure)) => {
                for member in kids(structure, "variables") {
                    let own = nodes::line(&member.attribute("name").unwrap_or("").replace('`', "'"));
                    self.variable(member, &format!("{name}.{own}"), depth + 1, report);
                }
            }
            (None, None) => {
                self.open.insert(name.to_uppercase(), (nodes::line(ty), decl));
            }
        }
    }

    fn address(&mut self, node: Node, decl: &mut VarDecl, report: &Report) {
        let address = attr::text(node, "topologicalAddress").filter(|a| !a.text.trim().is_empty());
        let Some(address) = address else { return };
        let text = address.text.trim().to_ascii_uppercase();
        decl.kind = match text.as_bytes() {
            [b'%', b'I', ..] => VarKind::Input,
            [b'%', b'Q', ..] => VarKind::Output,
            _ => VarKind::Var,
        };
        decl.address = Some(Name::new(text, report.span(&address.at)));
    }
}

fn initial(node: Node, decl: &mut VarDecl, report: &mut Report) {
    let Some(init) = node.children().find(|n| n.has_tag_name("variableInit")) else { return };
    let Some(value) = attr::text(init, "value").filter(|v| !v.text.trim().is_empty()) else { return };
    let place = |part: std::ops::Range<usize>| value.place(&part);
    decl.init = Some(st::single::expression(&value.text, &place, report));
}

/// Inputs of an instance that have an initial value.
fn presets(node: Node, name: &str, report: &mut Report) {
    for element in node.children().filter(|n| n.has_tag_name("instanceElementDesc")) {
        let member = nodes::line(element.attribute("name").unwrap_or(""));
        let value = line(element.children().find(|n| n.has_tag_name("value")));
        let what = say!(
            "`{name}.{member}` does not start with {}; give it where `{name}` is called",
            Said::foreign(value)
        );
        report.say(&codes::DIFFERENT, &attr::head(element), what);
    }
}

/// A variable whose type is missing in the file: one variable for each member that is used.
pub(super) fn members(
    document: &Document,
    open: &HashMap<String, (String, VarDecl)>,
    report: &mut Report,
) -> Vec<VarDecl> {
    let mut copy = document.clone();
    let mut found = Found { open, members: Vec::new() };
    g7_model::visit_mut::document(&mut copy, &mut found);
    let mut list = found.members;
    list.sort_by_cached_key(|(name, _)| {
        let name = name.to_uppercase();
        (name.split('.').next().unwrap_or("").to_string(), name)
    });
    list.dedup_by_key(|(name, _)| name.to_uppercase());
    let mut used: Vec<&(String, VarDecl)> = open.values().collect();
    used.sort_by_key(|(_, v)| v.at.0.start);
    for (ty, decl) in used {
        let name = decl.names.first().map_or("", |n| &*n.text);
        let first = |(n, _): &(String, VarDecl)| n.split('.').next().unwrap_or("").to_uppercase();
        let key = name.to_uppercase();
        let from = list.partition_point(|m| first(m) < key);
        let count = list.get(from..).unwrap_or(&[]).iter().take_while(|m| first(m) == key).count();
        let what = say!(
            "`{name}` is of the type `{ty}`, which is not in the file; {count} members that are named are taken for BOOL"
        );
        report.put(g7_model::Problem::new(&codes::DIFFERENT, decl.at.0, what));
    }
    list.into_iter().map(|(_, decl)| decl).collect()
}

struct Found<'a> {
    open: &'a HashMap<String, (String, VarDecl)>,
    members: Vec<(String, VarDecl)>,
}

impl g7_model::visit_mut::Visitor for Found<'_> {
    fn path(&mut self, path: &mut g7_model::Path, _: g7_model::visit_mut::Use, _: g7_model::Span) {
        let Some((first, _)) = path.names.split_first() else { return };
        let Some((_, decl)) = self.open.get(&first.text.to_uppercase()) else { return };
        let rest: Vec<&str> = path.names.iter().skip(1).map(|n| &*n.text).collect();
        let own = decl.names.first().map_or("", |n| &*n.text);
        let name = std::iter::once(own).chain(rest).collect::<Vec<_>>().join(".");
        let mut member = decl.clone();
        member.names = vec![Name::new(name.as_str(), decl.at.0)];
        if self.members.len() < MOST {
            self.members.push((name, member));
        }
    }
}
