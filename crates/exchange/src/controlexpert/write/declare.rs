//! Writes the variables.

use g7_iec::scopes::VarKey;
use g7_iec::xml::element::Element;
use g7_model::{Type, VarDecl, VarKind, codes, say};

use super::Writer;
use super::text::constant;
use crate::controlexpert::dialect;

impl<'d> Writer<'d> {
    pub(super) fn variables(&mut self, list: &[(VarKey<'d>, &'d VarDecl)]) -> Vec<Element> {
        self.without_address(list);
        list.iter().map(|(key, decl)| self.variable(*key, decl)).collect()
    }

    /// Every variable is seen from everywhere there; only an address makes it an input or an output.
    fn without_address(&mut self, list: &[(VarKey<'d>, &'d VarDecl)]) {
        let outside = |d: &VarDecl| matches!(d.kind, VarKind::Input | VarKind::Output) && d.address.is_none();
        let mut found = list.iter().filter(|(_, d)| outside(d));
        let Some((key, decl)) = found.next() else { return };
        let more = found.count();
        let what = if more == 0 {
            say!("`{}` has no address such as %I0.1.0: it is a plain variable there", key.1)
        } else {
            say!(
                "`{}` and {more} more have no address such as %I0.1.0: they are plain variables there",
                key.1
            )
        };
        self.speech.say(&codes::DIFFERENT, decl.at, what);
    }

    fn variable(&mut self, key: VarKey<'d>, decl: &'d VarDecl) -> Element {
        let ty = self.type_of(key, decl);
        let mut element =
            Element::new("variables").with("name", self.speech.names.var(key)).with("typeName", ty);
        if let Some(address) = &decl.address {
            if dialect::is_address(&address.text) {
                element = element.with("topologicalAddress", address.text.to_uppercase());
            } else {
                let what = say!(
                    "`{}` is no address of Control Expert, such as %I0.1.0; it is left out",
                    address.text
                );
                self.speech.say(&codes::LEFT_OUT, address.at, what);
            }
        }
        if decl.inverted {
            self.speech.cannot(decl.at, say!("an inverted channel"));
        }
        if decl.retain {
            self.speech.leave_out(decl.at, say!("the word `retain`"));
        }
        if let Some(safe) = &decl.safe {
            self.speech.leave_out(safe.at, say!("a value after a fault"));
        }
        if decl.kind == VarKind::Const {
            self.speech.say(&codes::DIFFERENT, decl.at, say!("the constant `{}` is a variable there", key.1));
        }
        element.extend(decl.comment.iter().map(|c| Element::with_text("comment", c)));
        element.extend(self.initial(decl));
        element
    }

    fn type_of(&mut self, key: VarKey<'d>, decl: &VarDecl) -> String {
        let history = decl.address.is_some() || self.speech.edges.contains(&key);
        match dialect::type_name(decl.ty) {
            Some(_) if decl.ty == Type::Bool && history => dialect::WITH_HISTORY.to_string(),
            Some(name) => name,
            None => {
                let ty = decl.ty;
                self.speech.cannot(decl.at, say!("a variable of the type {ty}"));
                ty.name().to_string()
            }
        }
    }

    fn initial(&mut self, decl: &VarDecl) -> Option<Element> {
        let init = decl.init.as_ref()?;
        if decl.kind == VarKind::Input && decl.address.is_none() {
            self.speech.leave_out(init.at, say!("the initial value of an input without an address"));
            return None;
        }
        if !constant(init) {
            self.speech.cannot(init.at, say!("an initial value that is worked out"));
            return None;
        }
        let value = self.speech.value(init, decl.ty);
        Some(Element::new("variableInit").with("value", value))
    }
}
