//! The words that IEC 61131-3 keeps for itself. Names of charts that are one of them get another
//! name in what is written for other tools.

/// The words of the textual languages and of SFC, the standard functions and function blocks.
const EVERYWHERE: &str = "ABS ACOS ACTION ADD AND ANY ANY_BIT ANY_DATE ANY_INT ANY_NUM ANY_REAL ARRAY ASIN AT ATAN BOOL BY \
BYTE CASE CONCAT CONFIGURATION CONSTANT COS CTD CTU CTUD DATE DATE_AND_TIME DELETE DINT DIV DO DT \
DWORD ELSE ELSIF EN END_ACTION END_CASE END_CONFIGURATION END_FOR END_FUNCTION END_FUNCTION_BLOCK \
END_IF END_PROGRAM END_REPEAT END_RESOURCE END_STEP END_STRUCT END_TRANSITION END_TYPE END_VAR \
END_WHILE ENO EQ EXIT EXP EXPT FALSE FIND FOR FROM FUNCTION FUNCTION_BLOCK F_EDGE F_TRIG GE GT IF \
INITIAL_STEP INSERT INT LE LEFT LEN LIMIT LINT LN LOG LREAL LT LWORD MAX MID MIN MOD MOVE MUL MUX \
NE NON_RETAIN NOT OF ON OR PROGRAM READ_ONLY READ_WRITE REAL REPEAT REPLACE RESOURCE RETAIN RETURN \
RIGHT ROL ROR RS R_TRIG SEL SHL SHR SIN SINT SQRT SR STEP STRING STRUCT SUB TAN TASK THEN TIME \
TIME_OF_DAY TO TOD TOF TON TP TRANSITION TRUE TRUNC TYPE UDINT UINT ULINT UNTIL USINT VAR \
VAR_ACCESS VAR_CONFIG VAR_EXTERNAL VAR_GLOBAL VAR_INPUT VAR_IN_OUT VAR_OUTPUT VAR_TEMP WHILE WITH \
WORD WSTRING XOR";

/// Those of them that are standard functions and function blocks.
const FUNCTIONS: &str = "ABS ACOS ADD ASIN ATAN CONCAT COS CTD CTU CTUD DELETE DIV EQ EXP EXPT FIND F_TRIG GE GT INSERT LE \
LEFT LEN LIMIT LN LOG LT MAX MID MIN MOVE MUL MUX NE REPLACE RIGHT ROL ROR RS R_TRIG SEL SHL SHR SIN SQRT \
SR SUB TAN TOF TON TP TRUNC";

/// The function blocks of Annex F of the standard (2003), which matiec has in its library.
const EXAMPLES: &str = "DERIVATIVE HYSTERESIS INTEGRAL PID RAMP RTC SEMA";

/// Words with a meaning in their own places: operators of Instruction List, qualifiers, formal
/// parameters of function blocks and tasks. Some compilers refuse them anywhere.
const IN_PLACES: &str = "ANDN CAL CALC CALCN CD CLK CU CV D DS ET IN INTERVAL JMP JMPC JMPCN L LD LDN N NEG ORN P P0 P1 \
PRIORITY PT PV Q Q1 QD QU R R1 RET RETC RETCN R_EDGE S S1 SD SEMA SINGLE SL ST STN XORN";

/// Closing words of the third edition and of SCL.
const CLOSING: [&str; 8] = [
    "END_CLASS",
    "END_DATA_BLOCK",
    "END_INTERFACE",
    "END_METHOD",
    "END_NAMESPACE",
    "END_ORGANIZATION_BLOCK",
    "END_PROPERTY",
    "END_REGION",
];

/// The words that no program of the standard may give to anything.
pub fn everywhere() -> impl Iterator<Item = &'static str> {
    EVERYWHERE.split_whitespace()
}

/// The words that no program for matiec may give to anything.
pub(crate) fn of_matiec() -> impl Iterator<Item = &'static str> {
    everywhere().chain(EXAMPLES.split_whitespace())
}

/// True if a word in upper case is the name of a standard function or function block, which matiec takes as the
/// name of a step, but not of a variable.
pub(crate) fn is_function(upper: &str) -> bool {
    FUNCTIONS.split_whitespace().chain(EXAMPLES.split_whitespace()).any(|word| word == upper)
}

/// True if a word, in any case, has a meaning of its own somewhere in the standard.
pub fn is_word(name: &str) -> bool {
    everywhere().chain(IN_PLACES.split_whitespace()).any(|word| word.eq_ignore_ascii_case(name))
}

/// True for a word that closes what another one opened, in any case: `END_IF`, `End_Var`. A name
/// like `End_Position` is none.
pub(crate) fn closes(word: &str) -> bool {
    let closing = everywhere().filter(|word| word.starts_with("END_")).chain(CLOSING);
    word.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("END_"))
        && closing.into_iter().any(|end| end.eq_ignore_ascii_case(word))
}

/// An identifier of letters, digits and single `_` that begins with a letter or `_`.
pub fn identifier(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match fold(c) {
            "" if c.is_ascii_alphanumeric() => out.push(c),
            "" if !out.ends_with('_') => out.push('_'),
            "" => {}
            folded => out.push_str(folded),
        }
    }
    let out = if out.len() > 1 { out.trim_end_matches('_').to_string() } else { out };
    match out.chars().next() {
        Some(c) if c.is_ascii_digit() => format!("N{out}"),
        Some('_') | None => format!("v{out}"),
        Some(_) => out,
    }
}

/// A number as a part of an identifier: `m2` for -2.
pub fn number(n: i128) -> String {
    format!("{}{}", if n < 0 { "m" } else { "" }, n.unsigned_abs())
}

/// The usual spelling of letters outside ASCII.
fn fold(c: char) -> &'static str {
    match c {
        'ä' | 'å' | 'á' | 'à' | 'â' => "a",
        'Ä' | 'Å' | 'Á' | 'À' => "A",
        'ö' | 'ó' | 'ô' | 'ø' => "o",
        'Ö' | 'Ø' => "O",
        'ü' | 'ú' | 'ù' | 'û' => "u",
        'Ü' => "U",
        'é' | 'è' | 'ê' | 'ë' => "e",
        'É' | 'È' => "E",
        'í' | 'ì' | 'î' | 'ï' => "i",
        'ç' => "c",
        'ñ' => "n",
        'ß' => "ss",
        'æ' => "ae",
        '+' => "plus",
        '-' => "minus",
        _ => "",
    }
}
