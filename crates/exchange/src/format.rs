//! The formats that are known, and how a file shows which one it is.

use crate::{classicladder, controlexpert, iectext, jgrafchart, l5x, plcopen, s7graph, xmi, xml};

/// The endings that files of the formats have, without the dot; some have none of these.
pub const ENDINGS: [&str; 11] =
    ["xml", "grafcet", "xmi", "st", "sfc", "exp", "xsf", "xef", "l5x", "clp", "clprj"];

/// A foreign format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Format {
    /// JGrafchart 2.x, `saveVersion` up to 8.
    Jgrafchart,
    /// PLCopen TC6 XML and IEC 61131-10 XML.
    Plcopen,
    /// EMF/XMI instances of the AGRAFE meta-model of IEC 60848.
    Xmi,
    /// ClassicLadder 0.7 to 0.9: a project, or its `sequential.csv` alone.
    ClassicLadder,
    /// Control Expert and Unity Pro: a chart (`.XSF`), or an application with charts (`.XEF`).
    ControlExpert,
    /// S7-GRAPH: a block exported by TIA Portal's Openness.
    S7Graph,
    /// Studio 5000 Logix Designer (`.L5X`): routines in SFC.
    L5x,
    /// IEC 61131-3 in text: charts with Structured Text and Instruction List.
    IecText,
}

impl Format {
    /// All of them, in the order in which a file is asked.
    pub const ALL: &[Format] = &[
        Format::Jgrafchart,
        Format::Plcopen,
        Format::Xmi,
        Format::ClassicLadder,
        Format::ControlExpert,
        Format::S7Graph,
        Format::L5x,
        Format::IecText,
    ];

    /// What messages call it.
    pub fn title(self) -> &'static str {
        match self {
            Format::Jgrafchart => "JGrafchart",
            Format::Plcopen => "PLCopen XML",
            Format::Xmi => "XMI",
            Format::ClassicLadder => "ClassicLadder",
            Format::ControlExpert => "Control Expert",
            Format::S7Graph => "S7-GRAPH",
            Format::L5x => "Logix L5X",
            Format::IecText => "IEC 61131-3 text",
        }
    }

    /// Whether a file is of this format: by its content first, else by its name's ending.
    ///
    /// True also for UTF-16, so that the reader can say what is wrong with it.
    pub(crate) fn fits(self, name: &str, bytes: &[u8]) -> bool {
        let root = xml::root_name(bytes);
        match self {
            Format::Jgrafchart => root.is_some_and(|name| jgrafchart::is_root(&name)),
            Format::Plcopen => root.is_some_and(|name| plcopen::is_root(&name)) && plcopen::fits(bytes),
            Format::Xmi => root.is_some_and(|name| xmi::is_root(&name)),
            Format::ClassicLadder => classicladder::fits(bytes),
            Format::ControlExpert => root.is_some_and(|name| controlexpert::is_root(&name)),
            Format::S7Graph => root.is_some_and(|name| s7graph::fits(&name, bytes)),
            Format::L5x => root.is_some_and(|name| l5x::is_root(&name)),
            Format::IecText => iectext::fits(name, bytes),
        }
    }
}

/// A form that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Outlet {
    /// A flowchart in the text of Mermaid, for documents; it is not read back.
    Mermaid,
    /// A project in PLCopen TC6 XML 2.01.
    Plcopen,
    /// An EMF/XMI instance of the AGRAFE meta-model of IEC 60848.
    Xmi,
    /// A program in IEC 61131-3 text: a sequential function chart with Structured Text.
    IecText,
    /// A workspace of JGrafchart 2.x, `saveVersion` 8.
    Jgrafchart,
}

impl Outlet {
    /// All of them, in the order in which they are listed.
    pub const ALL: &[Outlet] =
        &[Outlet::Mermaid, Outlet::Plcopen, Outlet::Xmi, Outlet::IecText, Outlet::Jgrafchart];

    /// The word for it on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Outlet::Mermaid => "mermaid",
            Outlet::Plcopen => "plcopen",
            Outlet::Xmi => "xmi",
            Outlet::IecText => "sfc",
            Outlet::Jgrafchart => "jgrafchart",
        }
    }

    /// What messages call it.
    pub fn title(self) -> &'static str {
        match self {
            Outlet::Mermaid => "Mermaid flowchart",
            Outlet::Plcopen => "PLCopen XML",
            Outlet::Xmi => "XMI",
            Outlet::IecText => "IEC 61131-3 text",
            Outlet::Jgrafchart => "JGrafchart",
        }
    }

    /// The ending of its files, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Outlet::Mermaid => "mmd",
            Outlet::Plcopen => "xml",
            Outlet::Xmi => "grafcet",
            Outlet::IecText => "st",
            Outlet::Jgrafchart => "xml",
        }
    }
}
