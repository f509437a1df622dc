//! The problem codes: one row each, never reused.
//!
//! `G00xx` files and words, `G01xx` structure, `G02xx` names and types, `G03xx`
//! evolution and actions, `G04xx` limits of a target PLC, `G05xx` plants and
//! tests, `G06xx` imported files, `G07xx` io files. Each has a page `docs/book/src/problems/<id>.md`,
//! one in `docs/book/fr` and `docs/book/pt`, and a case in `tests/check`; tests hold us to all.

use crate::{Language, Said, Severity};

/// A problem code.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// The code that users search for and suppress: `G0301`.
    pub id: &'static str,
    /// Its effect on the chart.
    pub severity: Severity,
    /// A few words: the heading of its page.
    pub title: &'static str,
    /// The rule behind it.
    pub source: &'static str,
}

impl Code {
    /// Its title in a language.
    pub fn title_in(&self, language: Language) -> String {
        Said::plain(self.title, self.title).in_language(language)
    }
}

macro_rules! codes {
    ($($name:ident = $id:literal $severity:ident $title:literal $source:literal;)*) => {
        $(#[doc = $title] pub static $name: Code =
            Code { id: $id, severity: Severity::$severity, title: $title, source: $source };)*
        /// Every code, by number.
        pub static ALL: &[&Code] = &[$(&$name),*];
    };
}

codes! {
    // Files and words
    BAD_ENCODING = "G0001" Error "not UTF-8 text" "the .g7 format";
    BAD_CHARACTER = "G0002" Error "a character that has no meaning here" "the .g7 format";
    UNCLOSED = "G0003" Error "a bracket, text or note that is never closed" "the .g7 format";
    EXPECTED = "G0004" Error "something else was expected here" "the .g7 format";
    BAD_NUMBER = "G0005" Error "a number that cannot be read" "IEC 61131-3:2003, 2.2.1";
    BAD_DURATION = "G0006" Error "a duration or a date that cannot be read" "IEC 61131-3:2003, 2.2.3";
    TOO_DEEP = "G0007" Error "nested too deeply" "the .g7 format";
    TOO_LARGE = "G0008" Error "the file is too large" "the .g7 format";
    UNKNOWN_WORD = "G0009" Error "a word the language does not have" "the .g7 format";
    TOO_MANY_PROBLEMS = "G0010" Error "too many problems to list" "the .g7 format";
    BAD_USE = "G0011" Error "a file that cannot be used" "the .g7 format";

    // Structure
    NEVER_STARTS = "G0101" Warning "a chart that never starts" "IEC 60848:2013, 4.5.2, rule 1";
    NO_ENDS = "G0102" Error "an expansion or task without its ends" "IEC 60848:2013, 7.5";
    UNREACHABLE = "G0103" Warning "a step that no way leads to" "IEC 60848:2013, 4.4";
    NO_STEPS = "G0104" Error "a transition without any step" "IEC 60848:2013, 4.4";
    STEP_TWICE = "G0105" Warning "a step twice on one side of a transition" "IEC 60848:2013, 4.4";
    SAME_TRANSITION = "G0106" Warning "a transition that stands there twice" "IEC 60848:2013, 4.4";
    TASK_END_ACTS = "G0107" Warning "an end of a task with an action" "Actions, counters, macro-steps and tasks";
    NEVER_CLEARS = "G0108" Warning "a receptivity that is never true" "IEC 60848:2013, 4.7";
    CHART_UNUSED = "G0109" Warning "a chart or function block that nothing uses" "IEC 60848:2013, 7.5";
    STARTS_EMPTY = "G0110" Warning "an initial enclosing step with no initial step inside" "IEC 60848:2013, 7.4";
    DEAD_END = "G0111" Warning "a step without a way out" "IEC 60848:2013, 4.4";
    NEVER_JOINS = "G0112" Warning "branches that never come together" "IEC 60848:2013, 4.4";

    // Names and types
    DEFINED_TWICE = "G0201" Error "one name is defined twice" "IEC 61131-3:2003, 2.7.1";
    UNKNOWN_NAME = "G0202" Error "a name that nothing has" "IEC 61131-3:2003, 2.4";
    AMBIGUOUS_STEP = "G0203" Error "a step name that several charts have" "IEC 60848:2013, 4.2";
    UNKNOWN_STEP = "G0204" Error "a step that is not there" "IEC 60848:2013, 4.2";
    UNKNOWN_CHART = "G0205" Error "a chart that is not there" "IEC 60848:2013, 7.3";
    UNKNOWN_MEMBER = "G0206" Error "a member that is not there" "IEC 61131-3:2003, 2.5.2";
    UNKNOWN_DIRECT = "G0207" Error "a direct address at which nothing is declared" "IEC 61131-3:2003, 2.4.1.1";
    WRONG_KIND = "G0208" Error "a name used as what it is not" "IEC 61131-3:2003, 2.5";
    WRONG_TYPE = "G0209" Error "a value of the wrong type" "IEC 61131-3:2003, 2.3.1";
    WRONG_OPERANDS = "G0210" Error "operands that do not go together" "IEC 61131-3:2003, 2.5.1.5";
    OUT_OF_RANGE = "G0211" Error "a constant that its type cannot hold" "IEC 61131-3:2003, 2.3.1, table 10";
    CONSTANT_FAULT = "G0212" Error "constant arithmetic without a result" "IEC 61131-3:2003, 2.5.1.5.2";
    NOT_CONSTANT = "G0213" Error "a constant is needed here" "IEC 61131-3:2003, 2.4.2";
    NOT_WRITABLE = "G0214" Error "something that cannot be written" "IEC 61131-3:2003, 2.4.3";
    WRONG_ARGUMENTS = "G0215" Error "a call with the wrong arguments" "IEC 61131-3:2003, 2.5.1.1";
    RECURSION = "G0216" Error "functions, tasks or types in a circle" "IEC 61131-3:2003, 2.5";
    NOT_HERE = "G0217" Error "something that cannot stand in this place" "IEC 61131-3:2003, 2.5.1";
    EXPANSION_SHARED = "G0218" Error "one expansion for two macro-steps" "IEC 60848:2013, 7.5";
    NESTED_IN_ITSELF = "G0219" Error "a chart nested in itself" "IEC 60848:2013, 7.4 and 7.5";
    ENCLOSED_TWICE = "G0220" Error "a chart enclosed by two steps" "IEC 60848:2013, 7.4";
    EXIT_OUTSIDE = "G0221" Error "EXIT outside a loop" "IEC 61131-3:2003, 3.3.2.4";
    LABELS_OVERLAP = "G0222" Warning "CASE labels that overlap" "IEC 61131-3:2003, 3.3.2.3";
    EMPTY_RANGE = "G0223" Error "a range that ends before it starts" "IEC 61131-3:2003, 3.3.2.3";
    SECTION_SHARED = "G0224" Error "one transition section for two transitions" "Unity Pro, transition sections";
    SECTION_UNUSED = "G0225" Warning "a transition section that no transition uses" "Unity Pro, transition sections";
    NESTED_TOO_DEEPLY = "G0226" Error "macro-steps nested too deeply" "the .g7 format";
    BODY_LANGUAGE = "G0227" Error "a part of a ladder or list that has no meaning" "IEC 61131-3:2003, 3.2 and 4.2";
    BAD_DECLARATION = "G0228" Error "a declaration that does not fit its type" "IEC 61131-3:2003, 2.4.3";
    ADDRESS_TWICE = "G0229" Error "one address for two variables" "IEC 61131-3:2003, 2.4.1.1";
    UNUSED_VARIABLE = "G0230" Warning "a variable that nothing names" "the .g7 format";
    INPUT_UNREAD = "G0231" Warning "an input that no chart reads" "the .g7 format";
    OUTPUT_UNDRIVEN = "G0232" Warning "an output that no chart drives" "the .g7 format";
    REMAINDER_LOST = "G0233" Warning "a division that loses its remainder" "IEC 61131-3:2003, 2.5.1.5.2";
    SECTION_READ = "G0234" Error "a transition section read where nothing runs it" "Unity Pro, transition sections";
    EMPTY_FILE = "G0235" Warning "a file with nothing in it" "the .g7 format";
    BAD_ALLOW = "G0236" Error "a note that allows nothing it can" "the .g7 format";
    NEEDLESS_ALLOW = "G0237" Warning "a note that allows what nothing reports" "the .g7 format";

    // Evolution and actions
    CONFLICT = "G0301" Warning "branches that can be true together" "GRAFCET course, conflicts";
    EVENT_WITHOUT_EDGE = "G0302" Error "a stored action on an event without an edge" "IEC 60848:2013, 4.8.3";
    EDGE_IN_CONDITION = "G0303" Error "a continuous action with an edge in its condition" "IEC 60848:2013, 4.8.2";
    FORCING_CIRCLE = "G0304" Error "charts that force each other in a circle" "IEC 60848:2013, 7.3";
    FORCED_AND_ENCLOSED = "G0305" Warning "a chart that is forced and enclosed" "IEC 60848:2013, 7.3 and 7.4";
    TWO_CLASSES = "G0306" Error "an output both continuous and stored" "IEC 60848:2013, 4.8";
    TWO_VALUES = "G0307" Error "two values for one variable at one moment" "IEC 60848:2013, 4.8.3";
    TWO_TIMES = "G0308" Error "two timed qualifiers on one action" "IEC 61131-3:2003, 2.6.4.4";
    PULSE_TWICE = "G0309" Warning "a pulse body that runs twice" "IEC 61131-3:2003, 2.6.4.5";
    RESTLESS_LOOP = "G0310" Warning "a loop that never rests" "IEC 60848:2013, 4.9";
    MACRO_ACTS = "G0311" Warning "a macro-step with actions of its own" "IEC 60848:2013, 7.5";
    PRIORITY_IGNORED = "G0312" Warning "a priority without effect" "IEC 61131-3:2003, 2.6.5";
    ALSO_WRITTEN = "G0313" Warning "a variable that an action drives and a statement writes" "IEC 61131-3:2003, 2.6.4.5";
    EVENT_LASTS = "G0314" Warning "an event that can be true without an edge" "IEC 60848:2013, 4.8.3";
    ORDERS_DISAGREE = "G0315" Warning "two forcing orders that disagree" "IEC 60848:2013, 7.3";
    WRITES_MEET = "G0316" Warning "two values for one variable when one transition clears" "IEC 60848:2013, 4.8.3";

    // Limits of a target
    TARGET_STEPS = "G0401" Error "more steps than the target holds" "GRAFCET course, TSX 37 and 57, characteristics";
    TARGET_MACROS = "G0402" Error "more macro-steps than the target holds" "GRAFCET course, TSX 37 and 57, characteristics";
    TARGET_TRANSITIONS = "G0403" Error "more transitions than the target holds" "GRAFCET course, TSX 37 and 57, transitions";
    TARGET_BRANCHES = "G0404" Error "more branches than the target draws" "GRAFCET course, TSX 37 and 57, transitions";
    TARGET_WORDS = "G0405" Warning "something the target has no word for" "GRAFCET course, TSX 37 and 57";
    TARGET_PAGES = "G0406" Error "a drawing larger than the target's pages" "GRAFCET course, TSX 37 and 57, editor";

    // Tests
    TEST_PLANT = "G0550" Error "a test or a proof with a plant that is not there" "the .g7 format";
    TEST_NAME = "G0551" Error "a test or a proof that sets, holds or asks something it cannot" "the .g7 format";
    TEST_TYPE = "G0552" Error "a value or condition of the wrong type in a test or a proof" "the .g7 format";
    ASSUMPTION = "G0553" Error "an assumption that says nothing about an input" "the .g7 format";

    // Imported files
    BAD_XML = "G0601" Error "a file that is no well-formed XML" "XML 1.0";
    NOT_JGRAFCHART = "G0602" Error "a file in which there is no chart" "the form of the file";
    UNKNOWN_ELEMENT = "G0603" Warning "an element that is not known" "the form of the file";
    NOT_CARRIED = "G0604" Error "a part with a meaning that cannot be carried over" "the language of the file";
    LEFT_OUT = "G0605" Warning "a part that is left out; the rest runs" "the language of the file";
    BAD_TEXT = "G0606" Error "an action or condition that cannot be read" "the language of the file";
    UNKNOWN_OBJECT = "G0607" Error "a name that nothing in the file has" "names and references of the file";
    UNKNOWN_FUNCTION = "G0608" Error "a function or method that is not known" "the language of the file";
    BAD_LINK = "G0609" Error "a line that cannot be in a chart" "IEC 60848:2013, 4.4";
    OPEN_LINK = "G0610" Warning "a line or transition that leads nowhere" "IEC 60848:2013, 4.4";
    RENAMED = "G0611" Warning "a name that had to be changed" "the form of the file";
    BAD_VALUE = "G0612" Error "a value that cannot be read" "the form of the file";
    BAD_MACRO = "G0613" Error "a macro-step without its inside" "IEC 60848:2013, 7.5";
    DIFFERENT = "G0614" Warning "a part that is carried over with a difference" "the language of the file";
    TWICE = "G0615" Error "two variables of one name in a workspace" "names and references of the file";

    // Io files
    BAD_WIRING = "G0701" Error "a part of an io file that cannot be read" "the io file";
    UNKNOWN_CHANNEL = "G0702" Error "a variable or device of an io file that is not there" "the io file";
    WRONG_CHANNEL = "G0703" Error "a point that cannot carry its variable" "the io file";
    WIRED_TWICE = "G0704" Error "a variable or point that is wired twice" "the io file";

    // Plants and tests
    BAD_DRIVE = "G0501" Error "a plant drives what is no free input" "the plant language";
    BAD_RATE = "G0502" Error "a rate on what cannot move" "the plant language";
    BAD_PARTS = "G0503" Error "parts or chance that are not well described" "the plant language";
    UNKNOWN_PART_MEMBER = "G0504" Error "something that parts do not have" "the plant language";
}

/// The code with this id (`G0101`, in any case), if there is one.
pub fn find(id: &str) -> Option<&'static Code> {
    ALL.iter().copied().find(|c| c.id.eq_ignore_ascii_case(id))
}
