//! Questions beside all values: random receptivities, of which it is counted out whether they can be true.

use g7_model::FileId;

use super::Question;
use crate::check::facts::Facts;
use crate::ir::StepId;
use crate::resolve::resolve;

struct Rng(u64);

impl Rng {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

const OPS: [&str; 6] = ["<", "<=", ">", ">=", "=", "<>"];
const NUMBERS: [(&str, i64, i64); 2] = [("n", -128, 127), ("u", 0, 255)];

fn compare(op: &str, a: i64, b: i64) -> bool {
    match op {
        "<" => a < b,
        "<=" => a <= b,
        ">" => a > b,
        ">=" => a >= b,
        "=" => a == b,
        _ => a != b,
    }
}

/// A condition, made without the types of the compiler.
enum Condition {
    Input(usize),
    /// A number beside a constant.
    Cut(usize, &'static str, i64),
    /// `p` beside `q`, or the other way round.
    Order(&'static str, bool),
    /// A step of a chart of which at most one step is active.
    Step(usize),
    Not(Box<Condition>),
    Both(&'static str, Box<Condition>, Box<Condition>),
}

/// Values of all that a condition reads.
#[derive(Clone, Copy)]
struct Values {
    inputs: u64,
    numbers: [i64; 2],
    order: i64,
    step: Option<usize>,
}

impl Condition {
    fn random(rng: &mut Rng, depth: u64) -> Condition {
        if depth == 0 || rng.below(8) == 0 {
            return match rng.below(6) {
                0 | 1 => Condition::Input(rng.below(3) as usize),
                2 | 3 => {
                    let i = rng.below(2) as usize;
                    let (_, low, high) = NUMBERS[i];
                    // The ends of the type are cuts as often as what lies between.
                    let at = [low, low + 1, 5, 6, 7, high - 1, high][rng.below(7) as usize];
                    Condition::Cut(i, OPS[rng.below(6) as usize], at)
                }
                4 => Condition::Order(OPS[rng.below(6) as usize], rng.below(2) == 0),
                _ => Condition::Step(rng.below(3) as usize),
            };
        }
        let part = |rng: &mut Rng| Box::new(Condition::random(rng, depth - 1));
        match rng.below(8) {
            0 => Condition::Not(part(rng)),
            1 => Condition::Both("xor", part(rng), part(rng)),
            2 => Condition::Both(OPS[rng.below(6) as usize], part(rng), part(rng)),
            3 | 4 => Condition::Both("or", part(rng), part(rng)),
            _ => Condition::Both("and", part(rng), part(rng)),
        }
    }

    fn text(&self) -> String {
        match self {
            Condition::Input(i) => ["a", "b", "c"][*i].to_owned(),
            Condition::Cut(i, op, at) => format!("{} {op} {at}", NUMBERS[*i].0),
            Condition::Order(op, true) => format!("p {op} q"),
            Condition::Order(op, false) => format!("q {op} p"),
            Condition::Step(i) => format!("H.X{}", 11 + i),
            Condition::Not(a) => format!("not ({})", a.text()),
            Condition::Both(op, a, b) => format!("({}) {op} ({})", a.text(), b.text()),
        }
    }

    fn holds(&self, v: &Values) -> bool {
        match self {
            Condition::Input(i) => v.inputs >> i & 1 != 0,
            Condition::Cut(i, op, at) => compare(op, v.numbers[*i], *at),
            Condition::Order(op, true) => compare(op, v.order, 0),
            Condition::Order(op, false) => compare(op, 0, v.order),
            Condition::Step(i) => v.step == Some(*i),
            Condition::Not(a) => !a.holds(v),
            Condition::Both(op, a, b) => {
                let (a, b) = (a.holds(v), b.holds(v));
                match *op {
                    "and" => a && b,
                    "or" => a || b,
                    "xor" => a != b,
                    op => compare(op, a.into(), b.into()),
                }
            }
        }
    }
}

/// True if some values make all of these true. Of the numbers those count that lie at or between cuts.
fn possible(list: &[Condition]) -> bool {
    let points = |i: usize| [NUMBERS[i].1, NUMBERS[i].1 + 1, 3, 5, 6, 7, 8, NUMBERS[i].2 - 1, NUMBERS[i].2];
    let orders = [-1, 0, 1];
    let steps = [None, Some(0), Some(1), Some(2)];
    (0..8).any(|inputs| {
        points(0).into_iter().any(|n| {
            points(1).into_iter().any(|u| {
                orders.into_iter().any(|order| {
                    steps.into_iter().any(|step| {
                        let v = Values { inputs, numbers: [n, u], order, step };
                        list.iter().all(|c| c.holds(&v))
                    })
                })
            })
        })
    })
}

/// Two branches of one step, each with a random receptivity.
#[test]
fn a_question_is_possible_if_some_values_are() {
    let mut rng = Rng(3);
    let mut counts = [0, 0];
    for round in 0..1000 {
        let pair: Vec<Condition> = (0..2).map(|_| Condition::random(&mut rng, 1 + round % 4)).collect();
        let text = format!(
            "profile iec60848\ninput a, b, c : BOOL\ninput n : SINT\ninput u : USINT\ninput p, q : INT\n\
             chart G {{ initial step 1 step 2 step 3 1 -> 2 when {} 1 -> 3 when {} 2 -> 1 when a 3 -> 1 when a }}\n\
             chart H {{ initial step 11 step 12 step 13 11 -> 12 when a 12 -> 13 when b 13 -> 11 when c }}\n",
            pair[0].text(),
            pair[1].text()
        );
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        assert!(problems.is_empty(), "{problems:?}\n{text}");
        let (unit, problems) = resolve(&document, None);
        assert!(problems.is_empty(), "{problems:?}\n{text}");
        let facts = Facts::of(&unit);
        let mut question = Question::new(&facts);
        unit.transitions.iter().take(2).for_each(|t| question.demand(&t.receptivity, true));
        question.with_active(&[StepId(0)]);
        let expected = possible(&pair);
        assert_eq!(question.possible(), Some(expected), "{text}");
        counts[usize::from(expected)] += 1;
    }
    assert!(counts.iter().all(|c| *c > 100), "{counts:?}");
}

/// Nine truths of which each is another's place: more values than a search tries one by one.
#[test]
fn a_question_of_many_parts_is_answered() {
    let mut names = Vec::new();
    let mut parts = Vec::new();
    let (rows, places) = (7, 6);
    for r in 0..rows {
        names.extend((0..places).map(|p| format!("x{r}_{p}")));
        parts
            .push(format!("({})", (0..places).map(|p| format!("x{r}_{p}")).collect::<Vec<_>>().join(" or ")));
    }
    for p in 0..places {
        for r in 0..rows {
            parts.extend((0..r).map(|s| format!("not (x{r}_{p} and x{s}_{p})")));
        }
    }
    let text = format!(
        "input {} : BOOL\nchart G {{ initial step 1 step 2 1 -> 2 when {} 2 -> 1 when x0_0 }}\n",
        names.join(", "),
        parts.join(" and ")
    );
    let (document, problems) = g7_syntax::parse(&text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (unit, _) = resolve(&document, None);
    let facts = Facts::of(&unit);
    let mut question = Question::new(&facts);
    question.demand(&unit.transitions[0].receptivity, true);
    assert_eq!(question.possible(), Some(false));
}
