//! What a picture is to show.

/// The manner of drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Look {
    /// GRAFCET: conditions on stubs, arrows for stored actions.
    #[default]
    Iec60848,
    /// SFC of IEC 61131-3: a box with the qualifier before each action.
    Sfc,
}

/// How to draw a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Options {
    /// The manner of drawing.
    pub look: Look,
    /// Whether actions are shown.
    pub actions: bool,
    /// On PL7 pages of 14 lines and 11 columns.
    pub pages: bool,
    /// White on black, for a standalone picture.
    pub dark: bool,
    /// A standalone picture brings its font.
    pub font: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options { look: Look::Iec60848, actions: true, pages: false, dark: false, font: true }
    }
}
