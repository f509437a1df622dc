//! The text styles of the terminal output.

use anstyle::{AnsiColor, Style};

/// Names and headings.
pub(crate) const STRONG: Style = Style::new().bold();
/// Success.
pub(crate) const GOOD: Style = AnsiColor::Green.on_default().bold();
/// Failure.
pub(crate) const BAD: Style = AnsiColor::Red.on_default().bold();
/// Warning.
pub(crate) const WARN: Style = AnsiColor::Yellow.on_default().bold();
/// Less important text.
pub(crate) const FAINT: Style = Style::new().dimmed();
