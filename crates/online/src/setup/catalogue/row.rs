//! The shape of a row, and the settings that several kinds have in common.

/// A kind of device.
#[derive(Clone, Copy, Debug)]
pub struct KindRow {
    /// The word of the file: `kind = "…"`.
    pub word: &'static str,
    /// Its meaning, in a few words.
    pub about: &'static str,
    /// Its settings; `kind` itself is not among them.
    pub settings: &'static [&'static [Setting]],
    /// The points that a channel can name.
    pub points: &'static [Point],
    /// True if `[shown]` can name its points.
    pub shows: bool,
}

/// A setting of a device or of a channel.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The key of the file.
    pub key: &'static str,
    /// The values that it takes.
    pub form: Form,
    /// Its value where the file says nothing.
    pub usual: Usual,
    /// Its meaning, in a few words.
    pub about: &'static str,
}

/// The values that a setting takes.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// A text.
    Text,
    /// A whole number within limits.
    Whole(i64, i64),
    /// A number.
    Number,
    /// A duration within limits, each as the file writes it.
    Duration(&'static str, &'static str),
    /// One of some words.
    Words(&'static [&'static str]),
    /// True or false.
    Flag,
    /// The policy for an input while it is bad: `"hold"`, `"fault"`, or a value of the variable.
    Bad,
    /// A table with settings of its own; a text alone is the first of them, where that one is needed.
    Table(&'static [Setting]),
    /// True or false, or a table with settings of its own.
    FlagOrTable(&'static [Setting]),
}

/// The value of a setting where the file says nothing.
#[derive(Clone, Copy, Debug)]
pub enum Usual {
    /// The file must say it; this is an example.
    Needed(&'static str),
    /// This, as the file would write it.
    Is(&'static str),
    /// There is none; this is an example.
    None(&'static str),
}

/// A point of a device.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Its word.
    pub word: &'static str,
    /// The contents of its brackets.
    pub argument: Argument,
    /// The kind of value that it carries.
    pub carries: Carries,
    /// An input of the chart can be wired to it.
    pub input: bool,
    /// An output of the chart, or something shown, can be wired to it.
    pub output: bool,
    /// The settings of a channel beside the point: of an input.
    pub of_input: &'static [&'static [Setting]],
    /// The settings of a channel beside the point: of an output, or of something shown.
    pub of_output: &'static [&'static [Setting]],
    /// Its meaning, in a few words.
    pub about: &'static str,
}

/// The contents of the brackets of a point.
#[derive(Clone, Copy, Debug)]
pub enum Argument {
    /// Nothing.
    Nothing,
    /// An address from 0 to this.
    Address(u16),
    /// An address from 0 to this, a dot, and a bit from 0 to 15.
    Bit(u16),
    /// A text; this is an example.
    Text(&'static str),
    /// A text, or nothing for the name of the variable; this is an example.
    TextOrName(&'static str),
    /// One of some words; the first where nothing stands there.
    Word(&'static [&'static str]),
    /// Some words, separated by commas; this is an example.
    List(&'static str),
    /// There are no brackets and no word: the point is this text; this is an example.
    Alone(&'static str),
}

/// The variables that a point carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carries {
    /// A BOOL.
    Bit,
    /// A number or a TIME.
    Number,
    /// A whole number.
    Whole,
    /// A BOOL, a number or a TIME.
    Any,
}

pub(super) const fn setting(key: &'static str, form: Form, usual: Usual, about: &'static str) -> Setting {
    Setting { key, form, usual, about }
}

/// The times of a device that is asked, with the usual longest time of an answer.
pub(super) const fn times(timeout: &'static str) -> [Setting; 4] {
    [
        setting("poll", Form::Duration("1ms", "1h"), Usual::Is("\"20ms\""), "the time between two exchanges"),
        setting("timeout", Form::Duration("1ms", "1h"), Usual::Is(timeout), "the longest time of an answer"),
        setting(
            "refresh",
            Form::Duration("1ms", "1h"),
            Usual::Is("\"1s\""),
            "outputs that did not change are written again after this time",
        ),
        setting(
            "retry",
            Form::Duration("10ms", "1h"),
            Usual::Is("\"2s\""),
            "the longest time between two attempts to reach it",
        ),
    ]
}

pub(super) const PASSWORD_FILE: Setting = setting(
    "password-file",
    Form::Text,
    Usual::None("hub.password"),
    "the file beside the io file that has the password",
);

pub(super) const PASSWORD_VARIABLE: Setting = setting(
    "password-env",
    Form::Text,
    Usual::None("HUB_PASSWORD"),
    "the variable of the environment that has the password",
);

pub(super) const BAD: &[Setting] =
    &[setting("bad", Form::Bad, Usual::Is("\"hold\""), "its value while the device gives none")];

pub(super) const SCALE: &[Setting] = &[
    setting("scale", Form::Number, Usual::Is("1.0"), "the value is this times the number of the device"),
    setting("offset", Form::Number, Usual::Is("0.0"), "and this is added"),
];

/// The point that each device has which can be gone.
pub(super) const GOOD: Point = Point {
    word: "good",
    argument: Argument::Nothing,
    carries: Carries::Bit,
    input: true,
    output: false,
    of_input: &[],
    of_output: &[],
    about: "TRUE while the device answers",
};
