//! How a chart is to be drawn.

/// The drawing style.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Look {
    /// GRAFCET: conditions on stubs, arrows for stored actions.
    #[default]
    Iec60848,
    /// SFC of IEC 61131-3: a box with the qualifier before each action.
    Sfc,
}

/// The options of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Options {
    /// The drawing style.
    pub look: Look,
    /// Show the actions.
    pub actions: bool,
    /// Divide the drawing into PL7 pages of 14 lines and 11 columns.
    pub pages: bool,
    /// Draw white on black, for a standalone picture.
    pub dark: bool,
    /// Embed the font in a standalone picture.
    pub font: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options { look: Look::Iec60848, actions: true, pages: false, dark: false, font: true }
    }
}
