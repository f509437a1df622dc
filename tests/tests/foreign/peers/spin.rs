//! Spin searches a model of a small chart, written here from the rules of `docs/spec/semantics.md`, sections 3 and 4:
//! it reaches the situations that the prover reaches, and clears the same transitions.
//!
//! The model is synchronous: one turn of its loop is one scan, in one atomic step. Its C parts write down what a
//! search meets; they are no part of its states.

use std::collections::BTreeSet;

use g7_model::{FileId, ProfileName};
use g7_peers::checkers::Spin;
use g7_tests::generate::Rng;
use g7_verify::{Asked, Budget, Claim, Explicit, Kind, Layer, Model, Verdict, ask, situations};

/// Random charts of each profile.
const CHARTS: u64 = 3;
/// Inputs of a chart.
const INPUTS: [&str; 3] = ["a", "b", "c"];
/// Passes after which a search for stability has come back to a situation: a chart has at most 2^6 of them, and an
/// edge is used in the first pass.
const PASSES: usize = 70;
/// The bound of Spin on the depth of its search.
const DEPTH: usize = 200_000;

/// A part of a receptivity.
#[derive(Clone, Copy, Debug)]
enum Atom {
    Input(usize),
    Rising(usize),
    Step(usize),
}

/// A transition: steps by number, and a conjunction of atoms, each negated or not.
#[derive(Clone, Debug)]
struct Transition {
    from: Vec<usize>,
    to: Vec<usize>,
    when: Vec<(bool, Atom)>,
}

/// A chart of steps, transitions and inputs alone.
#[derive(Clone, Debug)]
struct Small {
    profile: ProfileName,
    initial: Vec<bool>,
    transitions: Vec<Transition>,
}

impl Small {
    fn random(profile: ProfileName, rng: &mut Rng) -> Small {
        let steps = rng.between(3, 6);
        let initial = (0..steps).map(|s| s == 0 || rng.percent(20)).collect();
        let some = |rng: &mut Rng| {
            let mut list = vec![rng.below(steps)];
            if rng.percent(30) {
                list.push(rng.below(steps));
            }
            list.sort_unstable();
            list.dedup();
            list
        };
        let when = |rng: &mut Rng| {
            let atom = |rng: &mut Rng| match rng.below(6) {
                0 => (false, Atom::Rising(rng.below(INPUTS.len()))),
                1 => (rng.percent(50), Atom::Step(rng.below(steps))),
                _ => (rng.percent(40), Atom::Input(rng.below(INPUTS.len()))),
            };
            (0..rng.between(1, 2)).map(|_| atom(rng)).collect()
        };
        let count = rng.between(steps, steps + 2);
        let transitions = (0..count).map(|k| {
            // Every step has a way out.
            let mut from = some(rng);
            if k < steps && !from.contains(&k) {
                from[0] = k;
                from.sort_unstable();
                from.dedup();
            }
            Transition { from, to: some(rng), when: when(rng) }
        });
        let transitions = transitions.collect();
        Small { profile, initial, transitions }
    }

    /// The chart as text.
    fn text(&self) -> String {
        let mut text =
            format!("profile {}\ninput {} : BOOL\nchart G {{\n", self.profile.name(), INPUTS.join(", "));
        for (s, initial) in self.initial.iter().enumerate() {
            text += &format!("  {}step {}\n", if *initial { "initial " } else { "" }, s + 1);
        }
        let list = |steps: &[usize]| {
            let names: Vec<String> = steps.iter().map(|s| (s + 1).to_string()).collect();
            if names.len() == 1 { names.concat() } else { format!("({})", names.join(", ")) }
        };
        for t in &self.transitions {
            let when = t.when.iter().map(|(negated, atom)| {
                let atom = match atom {
                    Atom::Input(i) => INPUTS[*i].to_owned(),
                    Atom::Rising(i) => format!("↑{}", INPUTS[*i]),
                    Atom::Step(s) => format!("X{}", s + 1),
                };
                if *negated { format!("not {atom}") } else { atom }
            });
            let when = when.collect::<Vec<_>>().join(" and ");
            text += &format!("  {} -> {} when {when}\n", list(&t.from), list(&t.to));
        }
        text + "}\n"
    }

    /// The chart as a model of Spin.
    fn promela(&self) -> String {
        let (steps, count) = (self.initial.len(), self.transitions.len());
        let mut text = String::from(
            "c_decl {\n  static unsigned char met[64], active[8], cleared[16], twice, endless;\n\
             #define NOTE(x, ...) if (!(x)) { x = 1; printf(__VA_ARGS__); }\n}\n",
        );
        for (s, initial) in self.initial.iter().enumerate() {
            text += &format!("bit s{s} = {};\n", u8::from(*initial));
        }
        for i in INPUTS {
            text += &format!("bit {i}, o{i};\n");
        }
        (0..count).for_each(|t| text += &format!("bit t{t};\n"));
        text += "bit started, dead;\nbyte n, was;\nactive proctype chart() {\n  do\n  :: !dead -> atomic {\n";
        for i in INPUTS {
            text += &format!("    if :: {i} = 0 :: {i} = 1 fi;\n");
        }
        text += "    d_step {\n      if :: !started -> started = 1;";
        INPUTS.iter().for_each(|i| text += &format!(" o{i} = {i};"));
        text += &format!(" :: else -> skip fi;\n      do\n      :: n < {PASSES} ->\n");
        text += &self.pass();
        text += "      :: else -> dead = 1; c_code { NOTE(endless, \"endless 0\\n\") }; break\n      od;\n";
        let bits: Vec<String> = (0..steps).map(|s| format!("now.s{s} << {s}")).collect();
        text += &format!(
            "      c_code {{ if (!now.dead) {{ NOTE(met[{0}], \"situation %d\\n\", {0}) }} }}\n      n = 0; was = 0;",
            bits.join(" | ")
        );
        INPUTS.iter().for_each(|i| text += &format!(" {i} = 0;"));
        (0..count).for_each(|t| text += &format!(" t{t} = 0;"));
        // All runs behind a fault are alike.
        text += " if :: dead -> ";
        (0..steps).for_each(|s| text += &format!("s{s} = 0; "));
        INPUTS.iter().for_each(|i| text += &format!("o{i} = 0; "));
        text + ":: else -> skip fi\n    }\n  }\n  od\n}\n"
    }

    /// One pass: which transitions clear, then the new situation.
    fn pass(&self) -> String {
        // A pass that changes no step ends the search for stability (section 4).
        let bits: Vec<String> = (0..self.initial.len()).map(|s| format!("s{s} * {}", 1 << s)).collect();
        let mut text = format!("         was = {};\n", bits.join(" + "));
        let single = matches!(self.profile, ProfileName::Iec61131 | ProfileName::Unity);
        for (k, t) in self.transitions.iter().enumerate() {
            let mut all: Vec<String> = t.from.iter().map(|s| format!("s{s}")).collect();
            all.extend(t.when.iter().map(|(negated, atom)| {
                let atom = match atom {
                    Atom::Input(i) => INPUTS[*i].to_owned(),
                    Atom::Rising(i) => format!("({0} && !o{0})", INPUTS[*i]),
                    Atom::Step(s) => format!("s{s}"),
                };
                if *negated { format!("!{atom}") } else { atom }
            }));
            // Single-token: not with one that was chosen before it and shares a step.
            let before = self.transitions.iter().take(k).enumerate();
            let rivals = before.filter(|(_, o)| single && o.from.iter().any(|s| t.from.contains(s)));
            all.extend(rivals.map(|(j, _)| format!("!t{j}")));
            text += &format!("         t{k} = {};\n", all.join(" && "));
        }
        INPUTS.iter().for_each(|i| text += &format!("         o{i} = {i};\n"));
        let any: Vec<String> = (0..self.transitions.len()).map(|k| format!("t{k}")).collect();
        text += &format!("         if :: !({}) -> break :: else -> skip fi;\n", any.join(" || "));
        text += &if self.profile == ProfileName::Jgrafchart { self.in_turn() } else { self.at_once() };
        text += "         c_code {\n";
        for k in 0..self.transitions.len() {
            text += &format!("           if (now.t{k}) NOTE(cleared[{k}], \"cleared {k}\\n\")\n");
        }
        for s in 0..self.initial.len() {
            text += &format!("           if (now.s{s}) NOTE(active[{s}], \"active {s}\\n\")\n");
        }
        text += "         }\n         n++;\n";
        // One pass a scan, or until the situation is stable.
        text + &if self.profile == ProfileName::Iec60848 {
            format!("         if :: was == {} -> break :: else -> skip fi\n", bits.join(" + "))
        } else {
            "         break\n".to_owned()
        }
    }

    /// All chosen transitions clear at once.
    fn at_once(&self) -> String {
        let with = |s: usize, side: fn(&Transition) -> &Vec<usize>| {
            let of = self.transitions.iter().enumerate().filter(|(_, t)| side(t).contains(&s));
            let list: Vec<String> = of.map(|(k, _)| format!("t{k}")).collect();
            if list.is_empty() { "0".to_owned() } else { format!("({})", list.join(" || ")) }
        };
        let mut text = String::new();
        for s in 0..self.initial.len() {
            let (leaves, enters) = (with(s, |t| &t.from), with(s, |t| &t.to));
            let in_c = |e: &str| e.replace('t', "now.t");
            text += &format!(
                "         c_code {{ if (now.s{s} && {} && !{}) NOTE(twice, \"twice 0\\n\") }}\n",
                in_c(&enters),
                in_c(&leaves)
            );
            text += &format!("         s{s} = (s{s} && !{leaves}) || {enters};\n");
        }
        text
    }

    /// Each chosen transition deactivates and activates by itself.
    fn in_turn(&self) -> String {
        let mut text = String::new();
        for (k, t) in self.transitions.iter().enumerate() {
            let off: String = t.from.iter().map(|s| format!("s{s} = 0; ")).collect();
            let on: String = t.to.iter().map(|s| format!("s{s} = 1; ")).collect();
            text += &format!("         if :: t{k} -> {off}{on} :: else -> skip fi;\n");
        }
        text
    }
}

/// The things that a search met.
#[derive(Debug, Default, PartialEq, Eq)]
struct Met {
    /// Situations at the ends of scans, step `k` as bit `k`.
    situations: BTreeSet<u32>,
    /// Steps that were active, if only within a scan.
    active: BTreeSet<u32>,
    cleared: BTreeSet<u32>,
    /// A step was activated while active, and not deactivated in the same pass.
    twice: bool,
    endless: bool,
}

/// The words that the model of Spin writes.
fn told(text: &str) -> Met {
    let mut met = Met::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let (Some(word), Some(Ok(number))) = (words.next(), words.next().map(str::parse::<u32>)) else {
            continue;
        };
        _ = match word {
            "situation" => met.situations.insert(number),
            "active" => met.active.insert(number),
            "cleared" => met.cleared.insert(number),
            "twice" => std::mem::replace(&mut met.twice, true),
            "endless" => std::mem::replace(&mut met.endless, true),
            _ => false,
        };
    }
    met
}

/// The answers of the prover for the chart.
fn proved(small: &Small, asked: &Asked) -> Met {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget { states: 100_000, scans: usize::MAX, bytes: 256 << 20, stop: &|| false };
    let mut met = Met::default();
    let graph = situations(&model, &budget);
    assert!(graph.open.is_none(), "{:?}", graph.open);
    for node in graph.nodes.iter().filter(|n| n.kind == Kind::Situation) {
        met.situations.insert(node.steps.iter().map(|s| 1 << s.0).sum());
    }
    let mut answers = vec![None; asked.questions.len()];
    Explicit.answer(&model, &asked.questions, &mut answers, &budget);
    for (q, a) in asked.questions.iter().zip(answers) {
        let holds = match a {
            Some(Verdict::Proved(_)) => true,
            Some(Verdict::Refuted(_)) => false,
            _ => panic!("{:?}: {a:?}", q.claim),
        };
        match q.claim {
            Claim::Active(s) if holds => _ = met.active.insert(s.0),
            Claim::Clears(rank) if holds => _ = met.cleared.insert(rank),
            Claim::NoUnsafe => met.twice = !holds && small.profile != ProfileName::Jgrafchart,
            Claim::NoInstability => met.endless = !holds,
            _ => {}
        }
    }
    met
}

#[test]
fn spin_reaches_what_the_prover_reaches() {
    let Some(spin) = Spin::find() else { return };
    let (mut charts, mut count) = (0, 0);
    for profile in ProfileName::ALL {
        let mut rng = Rng::new(7 + profile.name().len() as u64);
        let mut left = CHARTS;
        while left > 0 {
            let small = Small::random(profile, &mut rng);
            let text = small.text();
            let (document, problems) = g7_syntax::parse(&text, FileId(0));
            assert!(problems.is_empty(), "{problems:?}\n{text}");
            let Some(asked) = ask(&document, None).0 else { continue };
            left -= 1;
            let model = small.promela();
            let searched = spin.search(&model, &[], DEPTH, 60).unwrap_or_else(|e| panic!("{e}\n{model}"));
            let mut theirs = told(&searched.text);
            // Initial steps are active before the first pass.
            theirs.active.extend((0..).zip(&small.initial).filter(|(_, i)| **i).map(|(s, _)| s));
            let ours = proved(&small, &asked);
            assert_eq!(theirs, ours, "Spin left, prover right\n{text}\n{model}");
            charts += 1;
            count += ours.situations.len();
        }
    }
    println!("{charts} charts, {count} situations");
    assert!(count > 30, "{count} situations");
}
