//! The program of a plant, and how its words are coupled to those of the charts.

use g7_engine::{Addr, Code};
use g7_model::named::declared;
use g7_model::{Document, Expr, Plant, Problem, ProfileName, Severity, Type, codes};

use super::{document, driven, plants};
use crate::{Compiled, compile_with};

/// A plant that can be run beside the charts.
#[derive(Clone, Debug)]
pub struct PlantProgram {
    /// Its name.
    pub name: Box<str>,
    /// Its program. Its states are variables of these names (`level`, `Belt.count`); names with an
    /// `@` are internal.
    pub compiled: Compiled,
    /// From outputs of the charts to inputs of the plant.
    pub to_plant: Vec<Link>,
    /// From outputs of the plant to inputs of the charts.
    pub to_charts: Vec<Link>,
    /// Its picture, as written.
    pub view: Option<Box<str>>,
    /// The moving parts of the picture.
    pub bindings: Vec<Binding>,
    /// The questions asked, for `engine::eval` on the plant's state.
    pub queries: Vec<Code>,
}

/// Words that carry one value from one program to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// First word in the variable area of the giving program.
    pub from: Addr,
    /// First word in the variable area of the taking program.
    pub to: Addr,
    /// How many.
    pub words: u32,
}

/// `element.attribute := value` of a picture.
#[derive(Clone, Debug)]
pub struct Binding {
    /// The element.
    pub element: Box<str>,
    /// The attribute.
    pub attribute: Box<str>,
    /// Gives the value, on the plant's state.
    pub code: Code,
    /// Its type.
    pub ty: Type,
}

/// Compiles a plant for compiled charts.
///
/// `queries` are expressions over the plant's states and the charts' outputs; a query that the
/// plant cannot answer is a problem like any other.
pub fn compile_plant(
    doc: &Document,
    plant: &Plant,
    charts: &Compiled,
    queries: &[Expr],
) -> (Option<PlantProgram>, Vec<Problem>) {
    let (typed, _) = declared(doc); // Its problems are those of the charts.
    let plant = plants(&typed).find(|p| p.at.0 == plant.at.0).unwrap_or(plant);
    let (made, mut problems) = document(&typed, plant, &charts.unit, queries);
    let mut asked = made.queries;
    asked.extend(made.bindings.iter().map(|(_, _, value)| value.clone()));
    // A tick is one pass in every profile, because a plant has no charts.
    let (compiled, mut wrong) = compile_with(&made.document, Some(ProfileName::Iec61131), &asked);
    // A state that nothing reads is kept, because it can be watched.
    wrong.retain(|p| p.code != &codes::UNUSED_VARIABLE);
    problems.append(&mut wrong);
    let compiled = compiled.filter(|_| !problems.iter().any(|p| p.severity() == Severity::Error));
    let program = compiled.map(|compiled| {
        let (own, others) = (&compiled.symbols, &charts.symbols);
        let link =
            |giver: &crate::symbols::Symbols, from: &str, taker: &crate::symbols::Symbols, to: &str| {
                let (from, to) = (giver.variable(from)?, taker.variable(to)?);
                Some(Link { from: from.addr, to: to.addr, words: from.words().min(to.words()) })
            };
        let to_plant = made.reads.iter().filter_map(|n| link(others, n, own, n)).collect();
        let to_charts = made.drives.iter().filter_map(|n| link(own, &driven(n), others, n)).collect();
        let (first, last) = compiled.queries.split_at(queries.len().min(compiled.queries.len()));
        let types = compiled.query_types.iter().skip(queries.len());
        let bindings = made
            .bindings
            .iter()
            .zip(last)
            .zip(types)
            .map(|(((element, attribute, _), code), ty)| Binding {
                element: element.clone(),
                attribute: attribute.clone(),
                code: *code,
                ty: *ty,
            })
            .collect();
        let queries = first.to_vec();
        PlantProgram {
            name: plant.name.text.clone(),
            to_plant,
            to_charts,
            view: made.view,
            bindings,
            queries,
            compiled,
        }
    });
    (program, problems)
}
