//! Decision diagrams of Boolean functions. Two equal functions are the same diagram.
//!
//! The library removes unused nodes in a thread of its own; [`Diagrams::tidy`] does it at once.

use std::cell::Cell;

use oxidd::bcdd::{BCDDFunction, BCDDManagerRef, new_manager};
use oxidd::util::{OptBool, OutOfMemory};
use oxidd::{
    BooleanFunction, BooleanFunctionQuant, BooleanOperator, Function as _, FunctionSubst, HasLevel, Manager,
    ManagerRef, Node, Subst, VarNo,
};

/// There is no room for more nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

impl From<OutOfMemory> for Full {
    fn from(_: OutOfMemory) -> Full {
        Full
    }
}

/// A place for diagrams, with variables in a fixed order.
pub struct Diagrams {
    manager: BCDDManagerRef,
    room: usize,
    /// Number of nodes after the last removal.
    left: Cell<usize>,
}

/// A function of the variables.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Function(BCDDFunction);

/// Other names for variables.
pub struct Renaming(Subst<BCDDFunction>);

impl Diagrams {
    /// Bytes for each node, about: the node itself, its entry in a table, and its share of the cache of results.
    pub const BYTES: usize = 40;

    /// A place for so many variables, and for so many nodes.
    pub fn new(variables: u32, room: usize) -> Diagrams {
        let room = room.max(1 << 10);
        let manager = new_manager(room, room / 2, 1);
        manager.with_manager_exclusive(|m| m.add_vars(variables));
        Diagrams { manager, room, left: Cell::new(0) }
    }

    /// A constant.
    pub fn constant(&self, value: bool) -> Function {
        Function(
            self.manager.with_manager_shared(|m| if value { BCDDFunction::t(m) } else { BCDDFunction::f(m) }),
        )
    }

    /// A variable, by its place in the order.
    pub fn variable(&self, place: u32) -> Result<Function, Full> {
        Ok(Function(self.manager.with_manager_shared(|m| BCDDFunction::var(m, place))?))
    }

    /// Other names for variables: each pair has the old name and the new one.
    pub fn renaming(&self, pairs: &[(u32, u32)]) -> Result<Renaming, Full> {
        let to: Result<Vec<_>, Full> = pairs.iter().map(|(_, new)| Ok(self.variable(*new)?.0)).collect();
        let from: Vec<VarNo> = pairs.iter().map(|(old, _)| *old).collect();
        Ok(Renaming(Subst::new(from, to?)))
    }

    /// Removes unused nodes if more than half of the room is taken, and many nodes were added since the last removal.
    pub fn tidy(&self) {
        self.manager.with_manager_shared(|m| {
            if m.num_inner_nodes() > (self.room / 2).max(self.left.get() + self.room / 8) {
                m.gc();
                self.left.set(m.num_inner_nodes());
            }
        });
    }
}

impl Function {
    /// 1 where both are 1.
    pub fn and(&self, other: &Function) -> Result<Function, Full> {
        Ok(Function(self.0.and(&other.0)?))
    }

    /// 1 where one of both is 1.
    pub fn or(&self, other: &Function) -> Result<Function, Full> {
        Ok(Function(self.0.or(&other.0)?))
    }

    /// 1 where this is 1 and the other is 0.
    pub fn without(&self, other: &Function) -> Result<Function, Full> {
        Ok(Function(other.0.imp_strict(&self.0)?))
    }

    /// The first where this is 1, else the second.
    pub fn choose(&self, then: &Function, other: &Function) -> Result<Function, Full> {
        Ok(Function(self.0.ite(&then.0, &other.0)?))
    }

    /// 1 where some values of the variables of a list (their conjunction) make this 1.
    pub fn exists(&self, list: &Function) -> Result<Function, Full> {
        Ok(Function(self.0.exists(&list.0)?))
    }

    /// 1 where some values of the variables of a list make this and another function 1.
    pub fn and_exists(&self, other: &Function, list: &Function) -> Result<Function, Full> {
        Ok(Function(self.0.apply_exists(BooleanOperator::And, &other.0, &list.0)?))
    }

    /// The same function of other variables.
    pub fn renamed(&self, names: &Renaming) -> Result<Function, Full> {
        Ok(Function(self.0.substitute(&names.0)?))
    }

    /// True if it is 0 for all values.
    pub fn is_none(&self) -> bool {
        !self.0.satisfiable()
    }

    /// Number of its nodes.
    pub fn nodes(&self) -> usize {
        self.0.node_count()
    }

    /// The first variable in the order that it depends on, and the functions where this is 1 and where it is 0;
    /// nothing for a constant.
    pub fn branches(&self) -> Option<(u32, Function, Function)> {
        let (one, zero) = self.0.cofactors()?;
        let variable = self.0.with_manager_shared(|m, e| match m.get_node(e) {
            Node::Inner(n) => Some(m.level_to_var(n.level())),
            Node::Terminal(_) => None,
        })?;
        Some((variable, Function(one), Function(zero)))
    }

    /// Values of all variables that make it 1, 0 for those that make no difference; nothing if it is 0.
    pub fn pick(&self) -> Option<Vec<bool>> {
        let values = self.0.pick_cube(|_, _, _| false)?;
        Some(values.into_iter().map(|v| v == OptBool::True).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Functions of four variables, beside their truth tables.
    #[test]
    fn functions_have_their_truth_tables() {
        let d = Diagrams::new(5, 1 << 12);
        let table = |k: u32| (0..16u32).filter(|p| p >> k & 1 != 0).fold(0, |w, p| w | 1 << p);
        let mut known: Vec<(Function, u32)> = (0..4).map(|k| (d.variable(k).unwrap(), table(k))).collect();
        let mut x = 7u64;
        for _ in 0..2000 {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let pick = |at: u32| known[(x >> at) as usize % known.len()].clone();
            let ((a, ta), (b, tb), (c, tc)) = (pick(20), pick(31), pick(42));
            let new = match x >> 61 {
                0 | 1 => (a.and(&b).unwrap(), ta & tb),
                2 | 3 => (a.or(&b).unwrap(), ta | tb),
                4 | 5 => (a.without(&b).unwrap(), ta & !tb),
                _ => (a.choose(&b, &c).unwrap(), ta & tb | !ta & tc),
            };
            let place = x as usize % 40;
            if known.len() < 40 { known.push(new) } else { known[place] = new }
        }
        for (f, truth) in &known {
            assert_eq!(f.is_none(), *truth == 0);
            for (g, other) in &known {
                assert_eq!(f == g, truth == other, "equal functions are the same");
            }
            if let Some(values) = f.pick() {
                let pattern = (0..4).fold(0, |p, k| p | u32::from(values[k]) << k);
                assert!(truth >> pattern & 1 == 1);
            }
        }
    }

    #[test]
    fn a_variable_is_left_out_or_gets_another_name() {
        let d = Diagrams::new(3, 1 << 10);
        let [a, b, c] = [0, 1, 2].map(|k| d.variable(k).unwrap());
        let both = a.and(&b).unwrap();
        assert!(both.exists(&b).unwrap() == a);
        assert!(both.and_exists(&c, &c).unwrap() == both);
        assert!(both.renamed(&d.renaming(&[(1, 2)]).unwrap()).unwrap() == a.and(&c).unwrap());
        let (top, one, zero) = both.branches().unwrap();
        assert!((top, one == b, zero.is_none()) == (0, true, true));
        assert!(zero.branches().is_none());
    }

    #[test]
    fn a_room_that_is_full_is_an_error() {
        let d = Diagrams::new(40, 0);
        // x0 = x20, x1 = x21, … in an order that makes it large.
        let made = (0..20).try_fold(d.constant(true), |all, k| {
            let (a, b) = (d.variable(k)?, d.variable(k + 20)?);
            let none = d.constant(true).without(&b)?;
            all.and(&a.choose(&b, &none)?)
        });
        assert!(made.is_err());
    }
}
