//! The description of a chart for simulators: `modelDescription.xml` of FMI 2.0 and 3.0, and the
//! `buildDescription.xml` of FMI 3.0. Written from the list of `variables`; packed by the caller.

use g7_iec::xml::element::Element;

use super::variables::{Kind, Role, Variable, seconds};
use super::version::Version;

/// The chart that is described.
pub(super) struct Chart<'a> {
    pub(super) name: &'a str,
    pub(super) identifier: &'a str,
    pub(super) token: &'a str,
    /// Nanoseconds between two scans.
    pub(super) period: i64,
    /// The C files to compile.
    pub(super) sources: &'a [String],
    pub(super) variables: &'a [Variable],
    /// True if the code needs `<math.h>`.
    pub(super) math: bool,
}

impl Chart<'_> {
    pub(super) fn model(&self, version: Version) -> String {
        let two = version == Version::V2;
        let root = Element::new("fmiModelDescription")
            .with("fmiVersion", if two { "2.0" } else { "3.0" })
            .with("modelName", self.name)
            .with(if two { "guid" } else { "instantiationToken" }, self.token)
            .with("generationTool", concat!("G7 ", env!("CARGO_PKG_VERSION")))
            .with("variableNamingConvention", "flat");
        let second = Element::new("Unit").with("name", "s").child(Element::new("BaseUnit").with("s", 1));
        let category = Element::new("Category")
            .with("name", "logStatusError")
            .with("description", "wrong calls, and the faults of the chart");
        let experiment =
            Element::new("DefaultExperiment").with("startTime", "0.0").with("stepSize", seconds(self.period));
        let variables = self.variables.iter().enumerate();
        let variables =
            variables.map(|(i, v)| if two { scalar(i, v) } else { variable(i, v) }).collect::<Vec<_>>();
        printed(root.children([
            self.simulation(two),
            Element::new("UnitDefinitions").child(second),
            Element::new("LogCategories").child(category),
            experiment,
            Element::new("ModelVariables").children(variables),
            self.structure(two),
        ]))
    }

    fn simulation(&self, two: bool) -> Element {
        let kind = Element::new("CoSimulation")
            .with("modelIdentifier", self.identifier)
            .with("canHandleVariableCommunicationStepSize", true);
        if !two {
            return kind
                .with("canGetAndSetFMUState", true)
                .with("canSerializeFMUState", true)
                .with("fixedInternalStepSize", seconds(self.period));
        }
        let files = self.sources.iter().map(|name| Element::new("File").with("name", name));
        kind.with("canNotUseMemoryManagementFunctions", true)
            .with("canGetAndSetFMUstate", true)
            .with("canSerializeFMUstate", true)
            .child(Element::new("SourceFiles").children(files))
    }

    /// The outputs. They are those of a scan that is over, so no input reaches them within an instant.
    fn structure(&self, two: bool) -> Element {
        let outputs = self.variables.iter().enumerate().filter(|(_, v)| v.role == Role::Output);
        let structure = Element::new("ModelStructure");
        if !two {
            return structure
                .children(outputs.map(|(i, _)| {
                    Element::new("Output").with("valueReference", i).with("dependencies", "")
                }));
        }
        let unknowns: Vec<Element> = outputs
            .map(|(i, _)| Element::new("Unknown").with("index", i + 1).with("dependencies", ""))
            .collect();
        if unknowns.is_empty() {
            structure
        } else {
            structure.child(Element::new("Outputs").children(unknowns))
        }
    }

    pub(super) fn build(&self) -> String {
        let files = self.sources.iter().map(|name| Element::new("SourceFile").with("name", name));
        let mut configuration = Element::new("BuildConfiguration")
            .with("modelIdentifier", self.identifier)
            .child(Element::new("SourceFileSet").with("language", "C99").children(files));
        if self.math {
            configuration.push(Element::new("Library").with("name", "m").with("external", true));
        }
        printed(Element::new("fmiBuildDescription").with("fmiVersion", "3.0").child(configuration))
    }
}

fn printed(root: Element) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    root.print(0, &mut text);
    text
}

fn causality(role: Role) -> &'static str {
    match role {
        Role::Input => "input",
        Role::Output => "output",
        Role::Local | Role::Step => "local",
        Role::Parameter => "parameter",
        Role::Time => "independent",
    }
}

fn variability(role: Role) -> &'static str {
    match role {
        Role::Parameter => "fixed",
        Role::Time => "continuous",
        Role::Input | Role::Output | Role::Local | Role::Step => "discrete",
    }
}

/// How the first value comes about; inputs and the time have no word for it.
fn initial(role: Role) -> Option<&'static str> {
    match role {
        Role::Output | Role::Local | Role::Parameter => Some("exact"),
        Role::Step => Some("calculated"),
        Role::Input | Role::Time => None,
    }
}

fn head(tag: &str, reference: usize, v: &Variable) -> Element {
    let mut element = Element::new(tag).with("name", &v.name).with("valueReference", reference);
    if !v.description.is_empty() {
        element = element.with("description", &v.description);
    }
    element = element.with("causality", causality(v.role)).with("variability", variability(v.role));
    match initial(v.role) {
        Some(initial) => element.with("initial", initial),
        None => element,
    }
}

/// The limits of a whole number that is narrower than its type in FMI 2.0.
fn limits(kind: Kind) -> Option<(i64, i64)> {
    Some(match kind {
        Kind::I8 => (i8::MIN.into(), i8::MAX.into()),
        Kind::I16 => (i16::MIN.into(), i16::MAX.into()),
        Kind::U8 => (0, u8::MAX.into()),
        Kind::U16 => (0, u16::MAX.into()),
        Kind::U32 => (0, u32::MAX.into()),
        _ => return None,
    })
}

/// A variable of FMI 2.0.
fn scalar(i: usize, v: &Variable) -> Element {
    let tag = match v.kind {
        Kind::Bool | Kind::Step => "Boolean",
        Kind::I8 | Kind::I16 | Kind::I32 | Kind::U8 | Kind::U16 => "Integer",
        Kind::U32 | Kind::I64 | Kind::U64 | Kind::F32 | Kind::F64 => "Real",
        Kind::Time | Kind::Period | Kind::Clock => "Real",
        Kind::Text(_) => "String",
    };
    let mut of_type = in_seconds(Element::new(tag), v.kind);
    if let Some((least, most)) = limits(v.kind) {
        of_type = of_type.with("min", least).with("max", most);
    }
    if let Some(start) = &v.start {
        of_type = of_type.with("start", start);
    }
    head("ScalarVariable", i, v).child(of_type)
}

fn in_seconds(element: Element, kind: Kind) -> Element {
    if matches!(kind, Kind::Time | Kind::Period | Kind::Clock) { element.with("unit", "s") } else { element }
}

/// A variable of FMI 3.0.
fn variable(i: usize, v: &Variable) -> Element {
    let tag = match v.kind {
        Kind::Bool | Kind::Step => "Boolean",
        Kind::I8 => "Int8",
        Kind::I16 => "Int16",
        Kind::I32 => "Int32",
        Kind::I64 => "Int64",
        Kind::U8 => "UInt8",
        Kind::U16 => "UInt16",
        Kind::U32 => "UInt32",
        Kind::U64 => "UInt64",
        Kind::F32 => "Float32",
        Kind::F64 | Kind::Time | Kind::Period | Kind::Clock => "Float64",
        Kind::Text(_) => "String",
    };
    let element = in_seconds(head(tag, i, v), v.kind);
    match (&v.start, v.kind) {
        (Some(start), Kind::Text(_)) => element.child(Element::new("Start").with("value", start)),
        (Some(start), _) => element.with("start", start),
        (None, _) => element,
    }
}
