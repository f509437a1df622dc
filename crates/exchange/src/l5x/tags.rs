//! Tags: types, members of structures, aliases, values.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use g7_model::codes;
use g7_model::{Expr, Name, Type, VarDecl, VarKind, say};

use super::chart::{Xml, description, kid, kids};
use g7_iec::nodes;
use g7_iec::report::Report;
use g7_iec::st::{self, elementary};
use g7_iec::xml::attr;

/// The longest chain of aliases, and the deepest nesting of structures.
const DEEPEST: usize = 16;

/// The tags that a chart can name.
pub(super) struct Tags<'a> {
    /// The tags of the program, then those of the controller.
    scopes: Vec<BTreeMap<String, Xml<'a>>>,
    types: HashMap<String, Xml<'a>>,
}

fn by_name<'a>(node: Option<Xml<'a>>) -> BTreeMap<String, Xml<'a>> {
    let tags = node.into_iter().flat_map(|n| kids(n, "Tag"));
    tags.filter_map(|t| Some((t.attribute("Name")?.to_uppercase(), t))).collect()
}

impl<'a> Tags<'a> {
    pub(super) fn of(program: Option<Xml<'a>>, controller: Option<Xml<'a>>) -> Tags<'a> {
        let scope = |n: Option<Xml<'a>>| by_name(n.and_then(|n| kid(n, "Tags")));
        let types =
            controller.and_then(|n| kid(n, "DataTypes")).into_iter().flat_map(|n| kids(n, "DataType"));
        let types = types.filter_map(|t| Some((t.attribute("Name")?.to_uppercase(), t))).collect();
        Tags { scopes: vec![scope(program), scope(controller)], types }
    }

    fn tag(&self, name: &str) -> Option<Xml<'a>> {
        let key = name.split('[').next().unwrap_or(name).to_uppercase();
        self.scopes.iter().find_map(|s| s.get(&key)).copied()
    }

    /// The target of an alias as names; None for an alias of a module's point.
    pub(super) fn alias(&self, name: &str) -> Option<Vec<String>> {
        let mut here = name.to_string();
        let mut found = None;
        for _ in 0..DEEPEST {
            let target = self.tag(&here)?.attribute("AliasFor").map(nodes::line);
            match target {
                Some(target) if !target.contains(':') => {
                    let names: Vec<String> = target.split('.').map(str::to_string).collect();
                    here = names.first().cloned().unwrap_or_default();
                    found = Some(names);
                }
                _ => return found,
            }
        }
        found
    }

    /// The declaration of a tag, or of one member of it.
    pub(super) fn declare(&self, names: &[&str], report: &mut Report) -> Option<VarDecl> {
        let (first, members) = names.split_first()?;
        let tag = self.tag(first)?;
        let range = attr::head(tag);
        let at = report.span(&range);
        let text = names.join(".");
        let mut decl = nodes::variable(VarKind::Var, &text, Type::Bool, at);
        decl.comment = description(tag);
        if let Some(point) = attr::text(tag, "AliasFor") {
            let upper = point.text.to_uppercase();
            decl.kind = if upper.contains(":I") { VarKind::Input } else { VarKind::Output };
            decl.address =
                Some(Name::new(nodes::line(&point.text.replace('`', "'")), report.span(&point.at)));
            return Some(decl);
        }
        let ty = self.member_type(tag.attribute("DataType").unwrap_or("BOOL"), members);
        match ty {
            Some(ty) => decl.ty = ty,
            None => {
                let name = nodes::line(tag.attribute("DataType").unwrap_or(""));
                let what = say!("`{text}`: `{name}` has no counterpart here, it is taken for BOOL");
                report.say(&codes::DIFFERENT, &range, what);
            }
        }
        if members.is_empty() && !first.contains('[') {
            decl.init = value(tag, decl.ty, report);
            if tag.attribute("Constant") == Some("true") && decl.init.is_some() {
                decl.kind = VarKind::Const;
            }
        }
        Some(decl)
    }

    /// The type of a member, through the structures of the project and those of Logix.
    fn member_type(&self, ty: &str, members: &[&str]) -> Option<Type> {
        let mut ty = ty.to_uppercase();
        for member in members.iter().take(DEEPEST) {
            let member = member.split('[').next().unwrap_or(member);
            if let Some(structure) = self.types.get(&ty) {
                let all = kid(*structure, "Members").into_iter().flat_map(|n| kids(n, "Member"));
                let found = all
                    .into_iter()
                    .find(|m| m.attribute("Name").is_some_and(|n| n.eq_ignore_ascii_case(member)));
                ty = found?.attribute("DataType")?.to_uppercase();
                continue;
            }
            ty = match (ty.as_str(), member.to_ascii_uppercase().as_str()) {
                (
                    "TIMER" | "COUNTER" | "CONTROL" | "FBD_TIMER" | "FBD_COUNTER",
                    "PRE" | "ACC" | "LEN" | "POS",
                ) => "DINT".into(),
                ("TIMER" | "COUNTER" | "CONTROL" | "FBD_TIMER" | "FBD_COUNTER", _) => "BOOL".into(),
                ("SFC_ACTION", "PRE" | "T" | "COUNT") => "DINT".into(),
                ("SFC_ACTION" | "SFC_STOP", _) => "BOOL".into(),
                _ => return None,
            };
        }
        if ty == "BIT" {
            return Some(Type::Bool);
        }
        let found = elementary(&ty);
        found.filter(|t| !matches!(t, Type::Fb(_)))
    }
}

/// The value of a tag in the file; None for zero, which is the default.
fn value(tag: Xml, ty: Type, report: &mut Report) -> Option<Expr> {
    let data = kids(tag, "Data").find(|d| d.attribute("Format") == Some("Decorated"))?;
    let value = attr::text(kid(data, "DataValue")?, "Value")?;
    let text = value.text.trim();
    let zero = text.chars().all(|c| matches!(c, '0' | '.' | '_' | '#' | '+' | '-' | 'e' | 'E'))
        || text.starts_with("16#0000_0000") && text.len() == 12;
    if zero || text.is_empty() || matches!(ty, Type::String(_)) {
        return None;
    }
    let place = |part: Range<usize>| value.place(&part);
    if ty == Type::Bool {
        return Some(nodes::boolean(true, report.span(&value.at)));
    }
    Some(st::single::expression(&value.text, &place, report))
}

/// The presets of steps and actions, which the file stores as values of their tags.
pub(super) fn presets(tags: &Tags, into: &mut super::dialect::Presets) {
    for scope in tags.scopes.iter().rev() {
        for (name, tag) in scope {
            let list = match tag.attribute("DataType") {
                Some("SFC_STEP") => &mut into.steps,
                Some("SFC_ACTION") => &mut into.actions,
                _ => continue,
            };
            let member = tag
                .descendants()
                .find(|n| n.has_tag_name("DataValueMember") && n.attribute("Name") == Some("PRE"));
            let ms = member.and_then(|n| n.attribute("Value")).and_then(|v| v.trim().parse().ok());
            list.insert(name.clone(), ms.filter(|n: &i64| *n >= 0).unwrap_or(0));
        }
    }
}
