//! Names of the chart as identifiers of IEC 61131-3.

use std::collections::{HashMap, HashSet};

use crate::names::letters;

/// Words that one of the languages keeps for itself, and names of the standard
/// functions and blocks.
const TAKEN: &str = " ABS ACOS ACTION ADD AND ANDN ANY ARRAY ASIN AT ATAN BOOL BY BYTE CAL CALC CALCN CASE CD CLK CONCAT \
CONFIGURATION CONSTANT COS CTD CTU CTUD CU D DATE DATE_AND_TIME DELETE DINT DIV DO DS DT DWORD ELSE ELSIF EN \
ENO END_IF EQ ET EXIT EXP EXPT FALSE FIND FOR FROM FUNCTION FUNCTION_BLOCK F_EDGE F_TRIG GE GT IF IN INITIAL_STEP \
INSERT INT INTERVAL JMP JMPC JMPCN L LD LDN LE LEFT LEN LIMIT LINT LN LOG LREAL LT LWORD MAX MID MIN MOD MOVE \
MUL MUX N NE NEG NON_RETAIN NOT OF ON OR ORN P P0 P1 PRIORITY PROGRAM PT PV Q Q1 QD QU R R1 READ_ONLY READ_WRITE \
REAL REPEAT REPLACE RESOURCE RET RETAIN RETC RETCN RETURN RIGHT ROL ROR RS R_EDGE R_TRIG S S1 SD SEL SEMA SHL SHR \
SIN SINGLE SINT SL SQRT SR ST STEP STN STRING STRUCT SUB TAN TASK THEN TIME TIME_OF_DAY TO TOD TOF TON TP \
TRANSITION TRUE TRUNC TYPE UDINT UINT ULINT UNTIL USINT VAR VAR_INPUT VAR_OUTPUT WHILE WITH WORD WSTRING XOR XORN CV ";

/// Names that are given once, in any case.
#[derive(Debug, Default)]
pub(crate) struct Names {
    given: HashSet<String>,
    counts: HashMap<String, u32>,
}

impl Names {
    /// A variable's name.
    pub(crate) fn variable(&mut self, name: &str) -> String {
        let plain = letters(name);
        let taken = TAKEN.contains(&format!(" {} ", plain.to_uppercase()));
        self.once(if taken { format!("V_{plain}") } else { plain })
    }

    /// A name that begins with what it is for.
    pub(crate) fn with(&mut self, before: &str, name: &str) -> String {
        let plain = letters(&format!("a{name}"));
        self.once(format!("{before}_{}", plain.get(1..).unwrap_or("").trim_start_matches('_')))
    }

    /// A name with the first number that is free.
    pub(crate) fn counted(&mut self, before: &str) -> String {
        let count = self.counts.entry(before.to_owned()).or_default();
        *count += 1;
        let name = format!("{before}_{count}");
        self.once(name)
    }

    fn once(&mut self, name: String) -> String {
        let name = name.trim_end_matches('_').to_owned();
        let mut free = name.clone();
        let mut k = 2;
        while !self.given.insert(free.to_uppercase()) {
            free = format!("{name}_{k}");
            k += 1;
        }
        free
    }
}
