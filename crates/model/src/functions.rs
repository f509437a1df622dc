//! The table of standard functions: the name of each, its inputs, what it does.
//!
//! The resolver, readers of other files, the editor and the book read this table.

use crate::BinaryOp;
use crate::words::Told;

/// A standard function (IEC 61131-3:2003, tables 23 to 30).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StandardFunction {
    /// The function that does what an operator does (tables 24, 26, 28): any but `·`.
    Operator(BinaryOp),
    /// NOT (table 26).
    Not,
    /// MOVE (table 24).
    Move,
    /// ABS (table 23).
    Abs,
    /// SQRT.
    Sqrt,
    /// LN.
    Ln,
    /// LOG, to base 10.
    Log,
    /// EXP.
    Exp,
    /// SIN, radians.
    Sin,
    /// COS.
    Cos,
    /// TAN.
    Tan,
    /// ASIN.
    Asin,
    /// ACOS.
    Acos,
    /// ATAN.
    Atan,
    /// TRUNC (table 22).
    Trunc,
    /// SHL (table 25).
    Shl,
    /// SHR.
    Shr,
    /// ROL.
    Rol,
    /// ROR.
    Ror,
    /// MIN (table 27).
    Min,
    /// MAX.
    Max,
    /// LIMIT.
    Limit,
    /// SEL.
    Sel,
    /// MUX.
    Mux,
    /// LEN (table 29).
    Len,
    /// LEFT.
    Left,
    /// RIGHT.
    Right,
    /// MID.
    Mid,
    /// CONCAT.
    Concat,
    /// INSERT.
    Insert,
    /// DELETE.
    Delete,
    /// REPLACE.
    Replace,
    /// FIND.
    Find,
    /// CONCAT_DATE_TOD (table 30).
    ConcatDateTod,
    /// DAY_OF_WEEK (IEC 61131-3:2013, table 36).
    DayOfWeek,
}

/// A row of the table of standard functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FunctionRow {
    /// The name as the standard has it.
    pub name: &'static str,
    /// The names of the inputs in their order; behind `…` the last one repeats.
    pub inputs: &'static [&'static str],
    /// In a few words, in the languages of the table of words.
    pub does: Told,
}

const ONE: &[&str] = &["IN"];
const TWO: &[&str] = &["IN1", "IN2"];
const MORE: &[&str] = &["IN1", "IN2", "…"];
const SHIFT: &[&str] = &["IN", "N"];

impl StandardFunction {
    /// Most inputs of a function whose last one repeats.
    pub const MOST: usize = 32;

    /// All of them, in the order of the standard's tables.
    pub const ALL: [StandardFunction; 49] = [
        StandardFunction::Trunc,
        StandardFunction::Abs,
        StandardFunction::Sqrt,
        StandardFunction::Ln,
        StandardFunction::Log,
        StandardFunction::Exp,
        StandardFunction::Sin,
        StandardFunction::Cos,
        StandardFunction::Tan,
        StandardFunction::Asin,
        StandardFunction::Acos,
        StandardFunction::Atan,
        StandardFunction::Operator(BinaryOp::Add),
        StandardFunction::Operator(BinaryOp::Mul),
        StandardFunction::Operator(BinaryOp::Sub),
        StandardFunction::Operator(BinaryOp::Div),
        StandardFunction::Operator(BinaryOp::Mod),
        StandardFunction::Operator(BinaryOp::Pow),
        StandardFunction::Move,
        StandardFunction::Shl,
        StandardFunction::Shr,
        StandardFunction::Ror,
        StandardFunction::Rol,
        StandardFunction::Operator(BinaryOp::And),
        StandardFunction::Operator(BinaryOp::Or),
        StandardFunction::Operator(BinaryOp::Xor),
        StandardFunction::Not,
        StandardFunction::Sel,
        StandardFunction::Max,
        StandardFunction::Min,
        StandardFunction::Limit,
        StandardFunction::Mux,
        StandardFunction::Operator(BinaryOp::Gt),
        StandardFunction::Operator(BinaryOp::Ge),
        StandardFunction::Operator(BinaryOp::Eq),
        StandardFunction::Operator(BinaryOp::Le),
        StandardFunction::Operator(BinaryOp::Lt),
        StandardFunction::Operator(BinaryOp::Ne),
        StandardFunction::Len,
        StandardFunction::Left,
        StandardFunction::Right,
        StandardFunction::Mid,
        StandardFunction::Concat,
        StandardFunction::Insert,
        StandardFunction::Delete,
        StandardFunction::Replace,
        StandardFunction::Find,
        StandardFunction::ConcatDateTod,
        StandardFunction::DayOfWeek,
    ];

    /// The row of a function.
    pub const fn row(self) -> FunctionRow {
        let (name, inputs, does): (_, &'static [&'static str], _) = match self {
            StandardFunction::Operator(op) => {
                let (inputs, does) = of_operator(op);
                (op.row().function, inputs, does)
            }
            StandardFunction::Not => ("NOT", ONE, ["complement", "complément", "complemento"]),
            StandardFunction::Move => {
                ("MOVE", ONE, ["the value itself", "la valeur même", "o próprio valor"])
            }
            StandardFunction::Abs => ("ABS", ONE, ["absolute value", "valeur absolue", "valor absoluto"]),
            StandardFunction::Sqrt => ("SQRT", ONE, ["square root", "racine carrée", "raiz quadrada"]),
            StandardFunction::Ln => {
                ("LN", ONE, ["natural logarithm", "logarithme naturel", "logaritmo natural"])
            }
            StandardFunction::Log => {
                ("LOG", ONE, ["logarithm to base 10", "logarithme décimal", "logaritmo decimal"])
            }
            StandardFunction::Exp => ("EXP", ONE, ["power of e", "puissance de e", "potência de e"]),
            StandardFunction::Sin => {
                ("SIN", ONE, ["sine of radians", "sinus de radians", "seno de radianos"])
            }
            StandardFunction::Cos => {
                ("COS", ONE, ["cosine of radians", "cosinus de radians", "cosseno de radianos"])
            }
            StandardFunction::Tan => {
                ("TAN", ONE, ["tangent of radians", "tangente de radians", "tangente de radianos"])
            }
            StandardFunction::Asin => {
                ("ASIN", ONE, ["arc sine, radians", "arc sinus, en radians", "arco seno, em radianos"])
            }
            StandardFunction::Acos => {
                ("ACOS", ONE, ["arc cosine, radians", "arc cosinus, en radians", "arco cosseno, em radianos"])
            }
            StandardFunction::Atan => (
                "ATAN",
                ONE,
                ["arc tangent, radians", "arc tangente, en radians", "arco tangente, em radianos"],
            ),
            StandardFunction::Trunc => ("TRUNC", ONE, ["whole part", "partie entière", "parte inteira"]),
            StandardFunction::Shl => (
                "SHL",
                SHIFT,
                ["bits moved to the left", "bits décalés à gauche", "bits deslocados para a esquerda"],
            ),
            StandardFunction::Shr => (
                "SHR",
                SHIFT,
                ["bits moved to the right", "bits décalés à droite", "bits deslocados para a direita"],
            ),
            StandardFunction::Rol => (
                "ROL",
                SHIFT,
                ["bits moved to the left in a ring", "bits tournés à gauche", "bits rodados para a esquerda"],
            ),
            StandardFunction::Ror => (
                "ROR",
                SHIFT,
                ["bits moved to the right in a ring", "bits tournés à droite", "bits rodados para a direita"],
            ),
            StandardFunction::Min => ("MIN", MORE, ["the least", "le plus petit", "o menor"]),
            StandardFunction::Max => ("MAX", MORE, ["the greatest", "le plus grand", "o maior"]),
            StandardFunction::Limit => (
                "LIMIT",
                &["MN", "IN", "MX"],
                ["held between two bounds", "gardé entre deux bornes", "mantido entre dois limites"],
            ),
            StandardFunction::Sel => {
                ("SEL", &["G", "IN0", "IN1"], ["one of two", "l’un de deux", "um de dois"])
            }
            StandardFunction::Mux => {
                ("MUX", &["K", "IN0", "IN1", "…"], ["one of several", "l’un de plusieurs", "um de vários"])
            }
            StandardFunction::Len => {
                ("LEN", ONE, ["length of a text", "longueur d’un texte", "comprimento de um texto"])
            }
            StandardFunction::Left => (
                "LEFT",
                &["IN", "L"],
                [
                    "first characters of a text",
                    "premiers caractères d’un texte",
                    "primeiros caracteres de um texto",
                ],
            ),
            StandardFunction::Right => (
                "RIGHT",
                &["IN", "L"],
                [
                    "last characters of a text",
                    "derniers caractères d’un texte",
                    "últimos caracteres de um texto",
                ],
            ),
            StandardFunction::Mid => (
                "MID",
                &["IN", "L", "P"],
                [
                    "characters from a place in a text",
                    "caractères à partir d’une place d’un texte",
                    "caracteres a partir de um lugar de um texto",
                ],
            ),
            StandardFunction::Concat => {
                ("CONCAT", MORE, ["texts joined", "textes mis bout à bout", "textos unidos"])
            }
            StandardFunction::Insert => (
                "INSERT",
                &["IN1", "IN2", "P"],
                ["a text put into a text", "un texte inséré dans un texte", "um texto inserido num texto"],
            ),
            StandardFunction::Delete => (
                "DELETE",
                &["IN", "L", "P"],
                [
                    "a text without some characters",
                    "un texte sans certains caractères",
                    "um texto sem alguns caracteres",
                ],
            ),
            StandardFunction::Replace => (
                "REPLACE",
                &["IN1", "IN2", "L", "P"],
                [
                    "a text in place of some characters",
                    "un texte à la place de certains caractères",
                    "um texto em lugar de alguns caracteres",
                ],
            ),
            StandardFunction::Find => (
                "FIND",
                TWO,
                [
                    "place of a text in a text",
                    "place d’un texte dans un texte",
                    "lugar de um texto num texto",
                ],
            ),
            StandardFunction::ConcatDateTod => (
                "CONCAT_DATE_TOD",
                TWO,
                ["a day with a time of day", "un jour et une heure du jour", "um dia com uma hora do dia"],
            ),
            StandardFunction::DayOfWeek => (
                "DAY_OF_WEEK",
                ONE,
                [
                    "day of the week, 0 for Sunday",
                    "jour de la semaine, 0 pour dimanche",
                    "dia da semana, 0 para domingo",
                ],
            ),
        };
        FunctionRow { name, inputs, does }
    }

    /// The function of this name, in upper or lower case. Sums and products of TIME, and sums and differences of dates and
    /// times of day, have names of their own besides (table 30; IEC 61131-3:2013, table 35).
    pub fn named(name: &str) -> Option<StandardFunction> {
        const OF_TIME: [(&str, BinaryOp); 13] = [
            ("ADD_TOD_TIME", BinaryOp::Add),
            ("ADD_DT_TIME", BinaryOp::Add),
            ("SUB_DATE_DATE", BinaryOp::Sub),
            ("SUB_TOD_TIME", BinaryOp::Sub),
            ("SUB_TOD_TOD", BinaryOp::Sub),
            ("SUB_DT_TIME", BinaryOp::Sub),
            ("SUB_DT_DT", BinaryOp::Sub),
            ("ADD_TIME", BinaryOp::Add),
            ("SUB_TIME", BinaryOp::Sub),
            ("MULTIME", BinaryOp::Mul),
            ("MUL_TIME", BinaryOp::Mul),
            ("DIVTIME", BinaryOp::Div),
            ("DIV_TIME", BinaryOp::Div),
        ];
        let of_time = || OF_TIME.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, op)| *op);
        let all = StandardFunction::ALL.into_iter();
        let mut found = all.filter(|f| f.row().name.eq_ignore_ascii_case(name));
        found.next().or_else(|| of_time().map(StandardFunction::Operator))
    }

    /// The operator that does the same, by the name of a function.
    pub fn operator(name: &str) -> Option<BinaryOp> {
        match StandardFunction::named(name)? {
            StandardFunction::Operator(op) => Some(op),
            _ => None,
        }
    }
}

/// The inputs of the function of an operator: AND, ADD, GT and their like take two and more.
const fn of_operator(op: BinaryOp) -> (&'static [&'static str], Told) {
    match op {
        BinaryOp::Or => (MORE, ["one of the conditions", "l’une des conditions", "uma das condições"]),
        BinaryOp::Xor => (
            MORE,
            [
                "an odd number of the conditions",
                "un nombre impair de conditions",
                "um número ímpar das condições",
            ],
        ),
        BinaryOp::And | BinaryOp::Dot => {
            (MORE, ["all of the conditions", "toutes les conditions", "todas as condições"])
        }
        BinaryOp::Eq => (MORE, ["all equal", "toutes égales", "todos iguais"]),
        BinaryOp::Ne => (TWO, ["not equal", "différentes", "diferentes"]),
        BinaryOp::Lt => (
            MORE,
            ["each less than the next", "chacune inférieure à la suivante", "cada um menor que o seguinte"],
        ),
        BinaryOp::Le => (
            MORE,
            [
                "each at most the next",
                "chacune au plus égale à la suivante",
                "cada um no máximo igual ao seguinte",
            ],
        ),
        BinaryOp::Gt => (
            MORE,
            [
                "each greater than the next",
                "chacune supérieure à la suivante",
                "cada um maior que o seguinte",
            ],
        ),
        BinaryOp::Ge => (
            MORE,
            [
                "each at least the next",
                "chacune au moins égale à la suivante",
                "cada um pelo menos igual ao seguinte",
            ],
        ),
        BinaryOp::Add => (MORE, ["sum", "somme", "soma"]),
        BinaryOp::Sub => (TWO, ["difference", "différence", "diferença"]),
        BinaryOp::Mul => (MORE, ["product", "produit", "produto"]),
        BinaryOp::Div => (TWO, ["quotient", "quotient", "quociente"]),
        BinaryOp::Mod => (TWO, ["remainder", "reste", "resto"]),
        BinaryOp::Pow => (TWO, ["power", "puissance", "potência"]),
    }
}

impl FunctionRow {
    /// True if the last input repeats.
    pub fn repeats(&self) -> bool {
        self.inputs.last() == Some(&"…")
    }

    /// The number of inputs that must be given.
    pub fn least(&self) -> usize {
        self.inputs.len() - usize::from(self.repeats())
    }

    /// The number of inputs that can be given.
    pub fn most(&self) -> usize {
        if self.repeats() { StandardFunction::MOST } else { self.least() }
    }

    /// The name of the input at a place, from 0.
    pub fn input(&self, place: usize) -> Option<String> {
        match self.inputs.get(place) {
            Some(name) if *name != "…" => Some((*name).to_owned()),
            _ if place >= self.most() => None,
            _ if self.counts_from_zero() => Some(format!("IN{}", place - 1)),
            _ => Some(format!("IN{}", place + 1)),
        }
    }

    fn counts_from_zero(&self) -> bool {
        self.inputs.contains(&"IN0")
    }

    /// The place of a named input, from 0: `IN4` of MUX is place 5.
    pub fn place(&self, name: &str) -> Option<usize> {
        if let Some(k) = self.inputs.iter().position(|p| p.eq_ignore_ascii_case(name)) {
            return Some(k);
        }
        let upper = name.to_ascii_uppercase();
        let number: usize = upper.strip_prefix("IN")?.parse().ok()?;
        let place = if self.counts_from_zero() { number.checked_add(1)? } else { number.checked_sub(1)? };
        (self.repeats() && place < self.most()).then_some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::StandardFunction as F;
    use crate::BinaryOp;

    #[test]
    fn every_function_is_found_by_its_name_in_any_case() {
        for f in F::ALL {
            assert_eq!(F::named(f.row().name), Some(f));
            assert_eq!(F::named(&f.row().name.to_lowercase()), Some(f));
        }
        assert_eq!(F::operator("mul_time"), Some(BinaryOp::Mul));
        assert_eq!((F::named("NAND"), F::operator("ABS")), (None, None));
    }

    #[test]
    fn every_operator_but_the_dot_is_a_function() {
        for op in BinaryOp::ALL.into_iter().filter(|op| *op != BinaryOp::Dot) {
            assert!(F::ALL.contains(&F::Operator(op)), "{op:?}");
            assert_eq!(F::operator(op.row().function), Some(op));
        }
    }

    #[test]
    fn inputs_are_found_by_their_names() {
        let place = |f: F, name: &str| f.row().place(name);
        assert_eq!((place(F::Mux, "K"), place(F::Mux, "in4")), (Some(0), Some(5)));
        assert_eq!(
            (place(F::Min, "IN1"), place(F::Min, "IN9"), place(F::Min, "IN33")),
            (Some(0), Some(8), None)
        );
        assert_eq!((place(F::Shl, "N"), place(F::Operator(BinaryOp::Sub), "IN3")), (Some(1), None));
        assert_eq!(place(F::Operator(BinaryOp::Gt), "IN3"), Some(2));
        for (f, k) in [(F::Mux, 0), (F::Mux, 5), (F::Min, 4), (F::Shl, 1), (F::Limit, 2)] {
            assert_eq!(f.row().input(k).and_then(|name| place(f, &name)), Some(k));
        }
        assert_eq!((F::Limit.row().input(3), F::Mux.row().input(32)), (None, None));
        assert_eq!((F::Limit.row().least(), F::Limit.row().most(), F::Mux.row().least()), (3, 3, 3));
    }
}
