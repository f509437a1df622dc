//! Variables: their place in the name spaces, their types, their initial values.

use g7_model::{
    Expr as Written, ExprKind as Form, Literal, Name, Problem, Said, Span, Type, VarDecl, VarKind, codes,
    normal_address, say,
};

use super::resolver::{Frame, Resolver, Role};
use super::scopes::Entity;
use crate::held::held;
use crate::ir::{ChartId, ExprKind, Value, VarClass, VarId};

impl<'d> Resolver<'_, 'd> {
    /// Gives a name its meaning, unless the name space has that name already.
    pub(super) fn define(&mut self, chart: Option<ChartId>, name: &'d Name, entity: Entity) -> bool {
        if name.text.is_empty() {
            return false; // The name could not be read; the parser has reported it.
        }
        let names = match chart {
            None => &mut self.scopes.names,
            Some(c) => match self.scopes.charts.get_mut(c.index()) {
                Some(scope) => &mut scope.names,
                None => return false,
            },
        };
        if let Some(before) = names.get(&*name.text).copied() {
            let first = self.defined_at(before);
            self.defined_twice(name, first);
            return false;
        }
        names.insert(&name.text, entity);
        true
    }

    /// Where something was declared.
    fn defined_at(&self, entity: Entity) -> Span {
        match entity {
            Entity::Var(v) => self.var(v).map(|v| v.at),
            Entity::Array(n) => self.scopes.arrays.get(n as usize).map(|a| a.at),
            Entity::Body(b) => self.unit.bodies.get(b.index()).map(|b| b.at),
            Entity::Section(s) => self.unit.sections.get(s.index()).map(|s| s.at),
            Entity::Function(f) => self.unit.functions.get(f.index()).map(|f| f.at),
        }
        .unwrap_or_default()
    }

    /// Declares the names of a declaration; values are resolved after all names are known.
    #[inline(never)]
    pub(super) fn declare(&mut self, chart: Option<ChartId>, decl: &'d VarDecl) -> Vec<VarId> {
        if !self.sensible(decl) {
            return Vec::new();
        }
        let class = match decl.kind {
            VarKind::Input => VarClass::Input,
            VarKind::Output => VarClass::Output,
            VarKind::Var => VarClass::Internal,
            VarKind::Const => VarClass::Const,
        };
        if decl.array.is_some() {
            return self.declare_arrays(chart, decl, class);
        }
        let held = held(decl, &self.scopes.enumerations);
        let mut ids = Vec::new();
        for name in &decl.names {
            let qualified = self.qualified(chart, &name.text);
            let id = VarId(self.unit.vars.len() as u32);
            if !self.define(chart, name, Entity::Var(id)) {
                continue;
            }
            self.add_var(qualified, class, decl.ty, name.at.0);
            if class == VarClass::Const {
                self.pending.insert(id);
                self.known_bound(id, decl);
            }
            self.place_at_address(id, decl);
            if let Some(v) = self.unit.vars.get_mut(id.index()) {
                v.held.clone_from(&held);
                v.retain = decl.retain;
                v.inverted = decl.inverted;
                v.comment.clone_from(&decl.comment);
                v.address = decl.address.as_ref().map(|a| a.text.clone());
            }
            ids.push(id);
        }
        ids
    }

    /// A whole number as the value of a constant is known at once, since bounds of arrays may name it.
    fn known_bound(&mut self, id: VarId, decl: &VarDecl) {
        if let Some(Form::Literal(Literal::Int(n, _))) = decl.init.as_ref().map(|e| &e.kind)
            && let Some(v) = self.unit.vars.get_mut(id.index())
            && v.ty.is_integer()
        {
            v.init = Value::Int(*n);
        }
    }

    /// Function blocks are variables of a chart and have no initial value.
    fn sensible(&mut self, decl: &VarDecl) -> bool {
        let at = decl.names.first().map_or(decl.at.0, |n| n.at.0);
        if let Type::Fb(kind) = decl.ty {
            let wrong = match decl.kind {
                VarKind::Input => Some(say!("an input")),
                VarKind::Output => Some(say!("an output")),
                VarKind::Const => Some(say!("a constant")),
                VarKind::Var if decl.init.is_some() => Some(say!("given an initial value")),
                VarKind::Var if decl.address.is_some() => Some(say!("placed at an address")),
                VarKind::Var => None,
            };
            if let Some(wrong) = wrong {
                let what = say!("an instance of {} cannot be {wrong}", kind);
                self.problems.push(
                    Problem::new(&codes::BAD_DECLARATION, at, what)
                        .help(say!("declare it plainly: `var name : {}`", kind.name())),
                );
                return false;
            }
        }
        self.fitting_string(decl.ty, at).is_some()
    }

    /// A text holds at least one byte, and at most as many as the engine supports.
    pub(super) fn fitting_string(&mut self, ty: Type, at: Span) -> Option<()> {
        match ty {
            Type::String(n) if n == 0 || n > g7_engine::TEXT => {
                let what = say!("a STRING holds 1 to {} bytes, not {n}", g7_engine::TEXT);
                self.report(Problem::new(&codes::BAD_DECLARATION, at, what))
            }
            _ => Some(()),
        }
    }

    /// A variable with a direct address is found by that address too.
    fn place_at_address(&mut self, id: VarId, decl: &VarDecl) {
        let Some(address) = decl.address.as_ref().filter(|a| a.text.starts_with('%')) else { return };
        let normal = normal_address(&address.text);
        let area = match normal.as_bytes().first() {
            Some(b'I') => Some((VarKind::Input, say!("an input"))),
            Some(b'Q') => Some((VarKind::Output, say!("an output"))),
            Some(b'X' | b'S') => None,
            _ => Some((decl.kind, Said::default())),
        };
        let written = &address.text;
        match area {
            None => {
                let what = say!("`{written}` belongs to the system; no variable can stand there");
                self.problems.push(Problem::new(&codes::BAD_DECLARATION, address.at.0, what));
            }
            Some((kind, area)) if kind != decl.kind => {
                let what = say!("`{written}` is the address of {area}");
                self.problems.push(Problem::new(&codes::BAD_DECLARATION, address.at.0, what));
            }
            Some(_) => match self.scopes.addresses.get(&normal).copied() {
                Some(before) => {
                    let what = say!("`{written}` is the address of two variables");
                    let mut problem = Problem::new(&codes::ADDRESS_TWICE, address.at.0, what);
                    if let Some(v) = self.var(before) {
                        problem = problem.related(v.at, say!("`{}` is there already", v.name));
                    }
                    self.problems.push(problem);
                }
                None => {
                    self.scopes.addresses.insert(normal, id);
                }
            },
        }
    }

    /// Resolves the values that a declaration gives to its names.
    #[inline(never)]
    pub(super) fn give_values(&mut self, chart: Option<ChartId>, decl: &VarDecl, ids: &[VarId]) {
        if matches!(decl.ty, Type::Fb(_)) {
            return;
        }
        if decl.array.is_some() {
            return self.give_elements(chart, decl, ids);
        }
        let init = decl.init.as_ref().and_then(|e| self.constant(chart, e, decl.ty));
        let safe = decl.safe.as_ref().and_then(|e| self.constant(chart, e, decl.ty));
        for id in ids {
            self.pending.remove(id);
            let Some(v) = self.unit.vars.get_mut(id.index()) else { continue };
            if let Some(value) = &init {
                v.init = value.clone();
            }
            if let Some(value) = &safe {
                v.safe = value.clone();
            }
        }
    }

    /// Resolves a value that is known before the chart runs.
    pub(super) fn constant(&mut self, chart: Option<ChartId>, e: &Written, ty: Type) -> Option<Value> {
        let frame = Frame { chart, role: Role::Constant, ..Frame::default() };
        let value = self.within(frame, |r| r.value(e, ty))?;
        match value.kind {
            ExprKind::Const(v) => Some(v),
            _ => {
                let what = say!("a value that is known before the chart runs is needed here");
                self.report(Problem::new(&codes::NOT_CONSTANT, value.at, what))
            }
        }
    }
}
