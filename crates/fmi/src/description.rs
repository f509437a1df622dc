//! The description of an FMU (`modelDescription.xml` of FMI 2.0 and 3.0), as far as a plant needs it.

use roxmltree::Node;

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    V2,
    /// FMI 3.0.
    V3,
}

/// The type of a variable, with the functions that read and write it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// Truth values.
    Boolean,
    /// Reals of 64 bits: `Real`, `Float64`.
    Double,
    /// Reals of 32 bits.
    Single,
    /// Whole numbers.
    Int {
        /// 8, 16, 32 or 64.
        bits: u8,
        /// True for two's complement.
        signed: bool,
    },
    /// Texts.
    String,
    /// Arrays, binary values and clocks, which cannot be connected.
    Other,
}

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set from outside.
    Input,
    /// Meant for others.
    Output,
    /// Anything else.
    Other,
}

/// A variable.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its number in the functions.
    pub reference: u32,
    /// Its type.
    pub ty: Type,
    /// Its role.
    pub causality: Causality,
}

/// The description.
#[derive(Clone, Debug)]
pub struct Description {
    /// The version that the FMU keeps.
    pub version: Version,
    /// The name of the library.
    pub identifier: String,
    /// The GUID or token.
    pub token: String,
    /// A step has to be a multiple of these seconds.
    pub fixed_step: Option<f64>,
    /// All variables in order.
    pub variables: Vec<Variable>,
}

impl Description {
    /// Reads it.
    ///
    /// # Errors
    ///
    /// The text is no description of an FMU for Co-Simulation of these versions; with the line where there is one.
    pub fn read(text: &str) -> Result<Description, String> {
        let options =
            roxmltree::ParsingOptions { nodes_limit: 4_000_000, ..roxmltree::ParsingOptions::default() };
        let tree = roxmltree::Document::parse_with_options(text, options)
            .map_err(|e| format!("modelDescription.xml: {e}"))?;
        let root = tree.root_element();
        let place = |node: Node, what: &str| {
            let line = tree.text_pos_at(node.range().start).row;
            format!("modelDescription.xml:{line}: {what}")
        };
        let said = root.attribute("fmiVersion").unwrap_or("none");
        let version = match said {
            "2.0" => Version::V2,
            v if v == "3.0" || v.starts_with("3.0-") || v.starts_with("3.0.") => Version::V3,
            other => return Err(place(root, &format!("FMI {other}; read are 2.0 and 3.0"))),
        };
        let Some(simulation) = root.children().find(|n| n.has_tag_name("CoSimulation")) else {
            return Err(place(root, "the FMU is not for Co-Simulation"));
        };
        let of = |node: Node, name: &str| {
            node.attribute(name).map(str::to_owned).ok_or_else(|| place(node, &format!("no `{name}`")))
        };
        let identifier = of(simulation, "modelIdentifier")?;
        if !identifier.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return Err(place(simulation, "`modelIdentifier` is no name of C"));
        }
        let token = of(root, if version == Version::V2 { "guid" } else { "instantiationToken" })?;
        let fixed_step = simulation.attribute("fixedInternalStepSize").and_then(|s| s.parse().ok());
        let all = root.children().find(|n| n.has_tag_name("ModelVariables"));
        let mut variables = Vec::new();
        for node in all.iter().flat_map(|n| n.children()).filter(Node::is_element) {
            let reference = of(node, "valueReference")?;
            let reference = reference.parse().map_err(|_| place(node, "`valueReference` is no number"))?;
            let causality = match node.attribute("causality") {
                Some("input") => Causality::Input,
                Some("output") => Causality::Output,
                _ => Causality::Other,
            };
            variables.push(Variable { name: of(node, "name")?, reference, ty: ty(node, version), causality });
        }
        Ok(Description { version, identifier, token, fixed_step, variables })
    }

    /// The variable of this name.
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|v| v.name == name)
    }
}

fn ty(node: Node, version: Version) -> Type {
    let int = |signed, bits| Type::Int { bits, signed };
    if version == Version::V2 {
        let inner = node.children().find(Node::is_element).map_or("", |n| n.tag_name().name());
        return match inner {
            "Real" => Type::Double,
            "Integer" | "Enumeration" => int(true, 32),
            "Boolean" => Type::Boolean,
            "String" => Type::String,
            _ => Type::Other,
        };
    }
    if node.children().any(|n| n.has_tag_name("Dimension")) {
        return Type::Other;
    }
    match node.tag_name().name() {
        "Float64" => Type::Double,
        "Float32" => Type::Single,
        "Int8" => int(true, 8),
        "Int16" => int(true, 16),
        "Int32" => int(true, 32),
        "Int64" | "Enumeration" => int(true, 64),
        "UInt8" => int(false, 8),
        "UInt16" => int(false, 16),
        "UInt32" => int(false, 32),
        "UInt64" => int(false, 64),
        "Boolean" => Type::Boolean,
        "String" => Type::String,
        _ => Type::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_told_with_its_line() {
        let text = "<fmiModelDescription fmiVersion='2.0' guid='g'>\n<CoSimulation modelIdentifier='m'/>\n\
                    <ModelVariables>\n<ScalarVariable name='x'><Real/></ScalarVariable></ModelVariables></fmiModelDescription>";
        let error = Description::read(text).expect_err("no reference");
        assert_eq!(error, "modelDescription.xml:4: no `valueReference`");
        let fine = text.replace("name='x'", "name='x' valueReference='7' causality='input'");
        let read = Description::read(&fine).expect("a description");
        let x = read.variable("x").expect("a variable");
        assert_eq!((x.reference, x.ty, x.causality), (7, Type::Double, Causality::Input));
        for bad in [fine.replace("2.0", "1.0"), fine.replace("CoSimulation", "ModelExchange"), "<a>".into()] {
            assert!(Description::read(&bad).is_err());
        }
        assert!(Description::read(&fine.replace("'m'", "'../m'")).is_err());
    }

    #[test]
    fn deep_elements_and_a_document_type_are_no_harm() {
        let deep = "<a>".repeat(300_000) + &"</a>".repeat(300_000);
        assert!(Description::read(&deep).is_err());
        let bomb = "<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>";
        assert!(Description::read(bomb).is_err());
    }
}
