//! Replaces the file's own function blocks without a chart: each instance becomes its variables,
//! each call the statements of the block.

use std::collections::{HashMap, HashSet};

use g7_model::codes;
use g7_model::{Arg, Expr, ExprKind, Name, Path, Span, Stmt, StmtKind, VarKind, say};

use super::unit::{Part, Source, Unit, UnitKind};
use crate::nodes;
use crate::report::Report;
use crate::st::{Section, Variable};
use g7_model::visit_mut::{self, Use, Visitor};

/// The deepest nesting of blocks.
const DEEPEST: usize = 20;
/// The most variables and statements after blocks have been replaced.
const MOST: usize = 200_000;

/// The declarations and the body of a block.
struct Block {
    name: Name,
    vars: Vec<Variable>,
    body: Vec<Stmt>,
}

/// Instances by their names in upper case.
type Instances = HashMap<String, (String, usize)>;

struct Expander<'r> {
    blocks: Vec<Block>,
    used: HashSet<usize>,
    left: usize,
    report: &'r mut Report,
}

/// Replaces blocks where they are used, and removes them from the units.
pub(super) fn expand(source: &mut Source, report: &mut Report) {
    let is_block = |u: &Unit| u.kind == UnitKind::FunctionBlock && !u.is_chart();
    let blocks: Vec<Block> = source
        .units
        .iter()
        .filter(|u| is_block(u))
        .map(|u| Block { name: u.name.clone(), vars: u.vars.clone(), body: u.body.clone() })
        .collect();
    if blocks.is_empty() {
        return;
    }
    let mut expander = Expander { blocks, used: HashSet::new(), left: MOST, report };
    let mut global = Instances::new();
    source.globals = expander.variables(std::mem::take(&mut source.globals), &mut global);
    for unit in source.units.iter_mut().filter(|u| !is_block(u)) {
        let mut instances = global.clone();
        unit.vars = expander.variables(std::mem::take(&mut unit.vars), &mut instances);
        if instances.is_empty() {
            continue;
        }
        unit.body = expander.statements(std::mem::take(&mut unit.body), &instances, 0);
        unit.behind = expander.statements(std::mem::take(&mut unit.behind), &instances, 0);
        for part in &mut unit.parts {
            if let Part::Action { body, .. } = part {
                *body = expander.statements(std::mem::take(body), &instances, 0);
            }
        }
    }
    let used: HashSet<String> = expander
        .used
        .iter()
        .filter_map(|b| expander.blocks.get(*b))
        .map(|b| b.name.text.to_uppercase())
        .collect();
    source.units.retain(|u| !is_block(u) || !used.contains(&u.name.text.to_uppercase()));
}

impl Expander<'_> {
    fn block(&self, ty: &Name) -> Option<usize> {
        self.blocks.iter().position(|b| b.name.text.eq_ignore_ascii_case(&ty.text))
    }

    /// The declarations, with instances replaced by their variables.
    fn variables(&mut self, declared: Vec<Variable>, instances: &mut Instances) -> Vec<Variable> {
        let mut made = Vec::new();
        for variable in declared {
            let block = variable.unknown.as_ref().and_then(|ty| self.block(ty));
            match (block, variable.decl.names.first().cloned()) {
                (Some(block), Some(name)) => self.instance(&variable, &name, block, 0, instances, &mut made),
                _ => made.push(variable),
            }
        }
        made
    }

    fn instance(
        &mut self,
        variable: &Variable,
        name: &Name,
        block: usize,
        depth: usize,
        instances: &mut Instances,
        made: &mut Vec<Variable>,
    ) {
        self.used.insert(block);
        let external = variable.section == Section::External;
        if external && instances.contains_key(&name.text.to_uppercase()) {
            return;
        }
        if depth > DEEPEST {
            let what =
                say!("the block `{}` contains itself", variable.decl.names.first().map_or("", |n| &n.text));
            return self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, variable.decl.at.0, what));
        }
        instances.insert(name.text.to_uppercase(), (name.text.to_string(), block));
        let vars = self.blocks.get(block).map(|b| b.vars.clone()).unwrap_or_default();
        for inner in vars {
            if matches!(inner.section, Section::External | Section::InOut)
                || !self.spend(1, variable.decl.at.0)
            {
                continue;
            }
            let Some(own) = inner.decl.names.first() else { continue };
            let long = Name::new(format!("{}.{}", name.text, own.text), name.at.0);
            if let Some(deeper) = inner.unknown.as_ref().and_then(|ty| self.block(ty)) {
                self.instance(&inner, &long, deeper, depth + 1, instances, made);
                continue;
            }
            let mut decl = inner.decl.clone();
            decl.names = vec![long];
            decl.retain |= variable.decl.retain;
            if decl.kind != VarKind::Const {
                decl.kind = VarKind::Var;
            }
            decl.retain &= decl.kind == VarKind::Var;
            let section = if variable.section == Section::Global { Section::Global } else { Section::Local };
            made.push(Variable { section, decl, unknown: inner.unknown.clone() });
        }
    }

    /// Counts new variables and statements; reports once that the limit is exceeded.
    fn spend(&mut self, count: usize, at: Span) -> bool {
        if self.left < count {
            if self.left > 0 {
                let what = say!("more instances and calls of function blocks than are read");
                self.report.put(g7_model::Problem::new(&codes::TOO_LARGE, at, what));
            }
            self.left = 0;
            return false;
        }
        self.left -= count;
        true
    }

    fn statements(&mut self, list: Vec<Stmt>, instances: &Instances, depth: usize) -> Vec<Stmt> {
        let mut made = Vec::new();
        for mut stmt in list {
            match &mut stmt.kind {
                StmtKind::Call(path, args) => {
                    if let Some((name, block)) = instances.get(&path.text().to_uppercase()) {
                        let args = std::mem::take(args);
                        made.extend(self.call(name, *block, &args, stmt.at.0, instances, depth));
                        continue;
                    }
                }
                StmtKind::If(arms, otherwise) => {
                    for (_, body) in arms {
                        *body = self.statements(std::mem::take(body), instances, depth);
                    }
                    *otherwise = self.statements(std::mem::take(otherwise), instances, depth);
                }
                StmtKind::Case(_, arms, otherwise) => {
                    for arm in arms {
                        arm.body = self.statements(std::mem::take(&mut arm.body), instances, depth);
                    }
                    *otherwise = self.statements(std::mem::take(otherwise), instances, depth);
                }
                StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                    *body = self.statements(std::mem::take(body), instances, depth);
                }
                StmtKind::Assign { .. } | StmtKind::Exit | StmtKind::Return => {}
            }
            made.push(stmt);
        }
        made
    }

    /// The statements of a call: inputs, body, outputs.
    fn call(
        &mut self,
        name: &str,
        block: usize,
        args: &[Arg],
        at: Span,
        instances: &Instances,
        depth: usize,
    ) -> Vec<Stmt> {
        let Some((vars, body)) = self.blocks.get(block).map(|b| (b.vars.clone(), b.body.clone())) else {
            return Vec::new();
        };
        if depth > DEEPEST || !self.spend(1 + count(&body), at) {
            return Vec::new();
        }
        let variable = |own: &str| nodes::name(&[&format!("{name}.{own}")], at);
        let inputs: Vec<&Variable> =
            vars.iter().filter(|v| matches!(v.section, Section::Input | Section::InOut)).collect();
        let mut list = Vec::new();
        let mut behind = Vec::new();
        let mut links: HashMap<String, Path> = HashMap::new();
        for (number, arg) in args.iter().enumerate() {
            let meant = match &arg.name {
                Some(given) => vars.iter().find(|v| is(v, &given.text)),
                None => inputs.get(number).copied(),
            };
            let Some((meant, own)) = meant.and_then(|v| Some((v, v.decl.names.first()?))) else {
                let given = arg.name.as_ref().map_or("", |n| &*n.text);
                let what = say!("the function block of `{name}` has no input `{given}`");
                self.report.put(g7_model::Problem::new(&codes::UNKNOWN_OBJECT, arg.value.at.0, what));
                continue;
            };
            match (meant.section, &arg.value.kind) {
                (Section::InOut, ExprKind::Path(path)) => {
                    links.insert(own.text.to_uppercase(), path.clone());
                }
                (Section::InOut, _) => {
                    let what = say!("what a block changes is a variable");
                    self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, arg.value.at.0, what));
                }
                _ if arg.output => behind.push(nodes::assign(arg.value.clone(), variable(&own.text), at)),
                _ => list.push(nodes::assign(variable(&own.text), arg.value.clone(), at)),
            }
        }
        for temp in vars.iter().filter(|v| v.section == Section::Temp && v.unknown.is_none()) {
            let Some(own) = temp.decl.names.first() else { continue };
            let value = temp.decl.init.clone().unwrap_or_else(|| Expr::zero(temp.decl.ty, at.into()));
            list.push(nodes::assign(variable(&own.text), value, at));
        }
        let own = vars
            .iter()
            .filter(|v| !matches!(v.section, Section::External | Section::InOut))
            .filter_map(|v| v.decl.names.first())
            .map(|n| n.text.to_uppercase())
            .collect();
        let mut body = body;
        visit_mut::stmts(&mut body, &mut Inside { instance: name, own, links });
        let body = self.statements(body, instances, depth + 1);
        list.extend(self.ended(body, at));
        list.extend(behind);
        list
    }

    /// A body with RETURN is written as a loop that runs once, so that EXIT can leave it.
    fn ended(&mut self, mut body: Vec<Stmt>, at: Span) -> Vec<Stmt> {
        if !returns(&body, true) {
            return body;
        }
        if returns(&body, false) {
            let what = say!("RETURN within a loop of a function block");
            self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, at, what));
            return body;
        }
        leave(&mut body);
        vec![Stmt { kind: StmtKind::Repeat(body, nodes::boolean(true, at)), at: at.into() }]
    }
}

fn is(variable: &Variable, name: &str) -> bool {
    variable.decl.names.first().is_some_and(|n| n.text.eq_ignore_ascii_case(name))
}

/// Renames the variables of a block to those of one instance.
struct Inside<'n> {
    instance: &'n str,
    own: HashSet<String>,
    links: HashMap<String, Path>,
}

impl Visitor for Inside<'_> {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        let Some(first) = path.names.first_mut() else { return };
        let upper = first.text.to_uppercase();
        // An element of an array or structure: the name and the part behind it.
        let head = upper.split(['[', '.']).next().unwrap_or("");
        if let Some(link) = self.links.get(head) {
            let behind = path.names.split_off(1);
            path.names = link.names.iter().cloned().chain(behind).collect();
        } else if self.own.contains(&upper)
            || self.own.iter().any(|o| o.split(['[', '.']).next() == Some(head))
        {
            first.text = format!("{}.{}", self.instance, first.text).into();
        }
    }
}

/// The number of statements, including nested ones.
fn count(list: &[Stmt]) -> usize {
    list.iter()
        .map(|s| match &s.kind {
            StmtKind::If(arms, otherwise) => {
                1 + arms.iter().map(|a| count(&a.1)).sum::<usize>() + count(otherwise)
            }
            StmtKind::Case(_, arms, otherwise) => {
                1 + arms.iter().map(|a| count(&a.body)).sum::<usize>() + count(otherwise)
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                1 + count(body)
            }
            _ => 1,
        })
        .sum()
}

/// True if a RETURN occurs: outside of loops, or within one.
pub(super) fn returns(list: &[Stmt], outside: bool) -> bool {
    list.iter().any(|s| match &s.kind {
        StmtKind::Return => outside,
        StmtKind::If(arms, otherwise) => {
            arms.iter().any(|a| returns(&a.1, outside)) || returns(otherwise, outside)
        }
        StmtKind::Case(_, arms, otherwise) => {
            arms.iter().any(|a| returns(&a.body, outside)) || returns(otherwise, outside)
        }
        StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
            returns(body, true)
        }
        _ => false,
    })
}

/// RETURN outside of loops becomes EXIT.
fn leave(list: &mut [Stmt]) {
    for stmt in list {
        match &mut stmt.kind {
            StmtKind::Return => stmt.kind = StmtKind::Exit,
            StmtKind::If(arms, otherwise) => {
                arms.iter_mut().for_each(|a| leave(&mut a.1));
                leave(otherwise);
            }
            StmtKind::Case(_, arms, otherwise) => {
                arms.iter_mut().for_each(|a| leave(&mut a.body));
                leave(otherwise);
            }
            _ => {}
        }
    }
}
