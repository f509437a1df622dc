//! The types of all messages as TypeScript: what `serde` makes of them, told by `ts-rs`.
//!
//! The tool that writes the page's `protocol.ts` reads it; no program that is shipped has it.

use std::any::TypeId;
use std::collections::BTreeMap;

use ts_rs::{Config, TS, TypeVisitor};

/// A message with the type of its answer.
#[derive(Clone, Debug)]
pub struct Row {
    /// The name of the message.
    pub name: &'static str,
    /// Its comment.
    pub docs: &'static str,
    /// The type of its contents.
    pub asked: String,
    /// The type of its answer.
    pub answer: String,
}

/// A named type.
#[derive(Clone, Debug)]
pub struct Declared {
    /// Its comment, as JSDoc.
    pub docs: String,
    /// Its declaration, `type Name = …;`.
    pub text: String,
    id: TypeId,
}

/// All messages, and the types that they name.
#[derive(Clone, Debug, Default)]
pub struct Types {
    /// The messages in their order.
    pub rows: Vec<Row>,
    /// The types by their names.
    pub declared: BTreeMap<String, Declared>,
    /// Names that two types have.
    pub twice: Vec<String>,
}

/// Numbers are those of JSON, which the page reads as `number`.
fn config() -> Config {
    Config::new().with_large_int("number")
}

impl Types {
    /// Adds a message with its answer, and all types that they name.
    pub(crate) fn row<Asked: TS + 'static, Answer: TS + 'static>(
        &mut self,
        name: &'static str,
        docs: &'static str,
    ) {
        let config = config();
        Asked::visit_dependencies(self);
        self.visit::<Answer>();
        self.rows.push(Row { name, docs, asked: Asked::inline(&config), answer: Answer::name(&config) });
    }
}

impl TypeVisitor for Types {
    fn visit<T: TS + 'static + ?Sized>(&mut self) {
        T::visit_generics(self);
        // A type without a file of its own is one of the language, or a list.
        if T::output_path().is_none() {
            T::visit_dependencies(self);
            return;
        }
        let (config, id) = (config(), TypeId::of::<T>());
        let name = T::ident(&config);
        match self.declared.get(&name) {
            Some(known) if known.id == id => {}
            Some(_) => self.twice.push(name),
            None => {
                let docs = T::docs().unwrap_or_default();
                self.declared.insert(name, Declared { docs, text: T::decl(&config), id });
                T::visit_dependencies(self);
            }
        }
    }
}
