//! The types of the names in a text that is printed.

use std::collections::HashMap;

use g7_model::{Chart, Composed, Document, Function, Item, Name, Path, Type, VarDecl};

/// The types of names.
#[derive(Debug, Default)]
pub struct Types<'d> {
    names: HashMap<&'d str, Named<'d>>,
    functions: HashMap<&'d str, &'d Function>,
    /// The function blocks of the file, by their names.
    blocks: HashMap<&'d str, &'d Composed>,
}

/// The type of a name.
#[derive(Clone, Copy, Debug)]
enum Named<'d> {
    Of(Type),
    /// An instance of a function block of the file.
    Instance(&'d Composed),
}

impl<'d> Types<'d> {
    /// The types of the names of the file and, if given, of a chart.
    pub fn new(document: &'d Document, chart: Option<&'d Chart>) -> Types<'d> {
        let mut types = Types::default();
        for item in &document.items {
            match item {
                Item::Function(f) => _ = types.functions.insert(&f.name.text, f),
                Item::Composed(c) => _ = types.blocks.insert(&c.name.text, c),
                _ => {}
            }
        }
        let of_file = document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None });
        of_file.for_each(|v| types.declare(v));
        chart.into_iter().flat_map(Chart::vars).for_each(|v| types.declare(v));
        types
    }

    /// The types of the names in the body of a function block of the file.
    pub fn of_block(document: &'d Document, block: &'d Composed) -> Types<'d> {
        let mut types = Types::new(document, None);
        types.names.clear();
        block.members.iter().chain(&block.inouts).for_each(|v| types.declare(v));
        types
    }

    fn declare(&mut self, decl: &'d VarDecl) {
        let block = decl.of.as_ref().and_then(|of| self.blocks.get(&*of.text));
        let named = block.map_or(Named::Of(decl.ty), |block| Named::Instance(block));
        self.names.extend(decl.names.iter().map(|n| (&*n.text, named)));
    }

    /// Adds a name of a function, which hides all others.
    pub fn own(mut self, name: &'d str, ty: Type) -> Types<'d> {
        self.names.insert(name, Named::Of(ty));
        self
    }

    /// The type of a variable, of a member of an instance, or of the activity or the time of a step.
    pub(super) fn of(&self, names: &[Name]) -> Option<Type> {
        match names {
            [one] => match self.names.get(&*one.text)? {
                Named::Of(ty) => Some(*ty),
                Named::Instance(_) => None,
            },
            [first, second] if self.names.contains_key(&*first.text) => self.of_member(first, &second.text),
            [_, second] if second.text.eq_ignore_ascii_case("X") => Some(Type::Bool),
            [_, _] => Some(Type::Time),
            _ => None,
        }
    }

    /// The type of a member of an instance.
    fn of_member(&self, instance: &Name, member: &str) -> Option<Type> {
        match self.names.get(&*instance.text)? {
            Named::Of(Type::Fb(kind)) => kind.type_of(member),
            Named::Of(_) => None,
            Named::Instance(block) => {
                let named = |v: &&VarDecl| v.names.iter().any(|n| *n.text == *member);
                block.members.iter().chain(&block.inouts).find(named).map(|v| v.ty)
            }
        }
    }

    /// The type of a parameter of the function block that a path calls.
    pub(super) fn of_parameter(&self, called: &Path, name: &str) -> Option<Type> {
        let [instance] = called.names.as_slice() else { return None };
        self.of_member(instance, name)
    }

    /// A function of the file.
    pub(super) fn function(&self, name: &str) -> Option<&'d Function> {
        self.functions.get(name).copied()
    }
}
