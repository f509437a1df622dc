//! Engines that are broken on purpose: each defect changes the tables, so that the same scan
//! follows another rule. A conformance case counts if it fails on one of them; `tests/laws/broken.rs`
//! names the case for each defect.

use std::cell::{Cell, RefCell};

use g7_engine::{Code, INPUTS, NONE, Op, Program, Rules, Situation, StepId, Tables};
use g7_model::{Document, Expr, ProfileName};

use crate::engine::with_program;
use crate::subject::Subject;

/// A change that breaks a program.
pub type Break = fn(&mut Tables);

thread_local! {
    static DEFECT: Cell<Option<Break>> = const { Cell::new(None) };
    static LEFT_OUT: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Sets the defect for all engines that [`engine`] makes from now on in this thread.
pub fn set(defect: Option<Break>) {
    DEFECT.with(|d| d.set(defect));
}

/// The engine with the present defect.
///
/// # Errors
///
/// The first problem of the document, or tables that are no longer a valid program.
pub fn engine(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> Result<Box<dyn Subject>, String> {
    with_program(doc, profile, queries, |program| {
        let Some(defect) = DEFECT.with(Cell::get) else { return Ok(program) };
        let mut tables = program.tables().clone();
        defect(&mut tables);
        Program::new(tables).map_err(|e| format!("{e:?}"))
    })
}

/// The equations of the tables with the defect that is set.
///
/// # Errors
///
/// As [`engine`].
pub fn equations(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> Result<Box<dyn Subject>, String> {
    let defect = DEFECT.with(Cell::get);
    let left_out = LEFT_OUT.with(|l| l.borrow().clone());
    crate::equations::changed(
        doc,
        profile,
        queries,
        |tables| {
            if let Some(defect) = defect {
                defect(tables);
            }
        },
        |e| {
            for list in [&mut e.begin, &mut e.pass, &mut e.finish] {
                list.retain(|s| Some(s.title) != left_out.as_deref());
            }
        },
    )
}

/// True if a defect is one of the instructions, which the equations do not read.
pub fn is_of_instructions(defect: Break, tables: &Tables) -> bool {
    let mut broken = tables.clone();
    defect(&mut broken);
    let same = |a: &Tables, b: &Tables| format!("{a:?}") == format!("{b:?}");
    if same(&broken, tables) {
        return false;
    }
    broken.code.clone_from(&tables.code);
    same(&broken, tables)
}

/// Leaves the sections with this title out of all equations that [`equations`]
/// makes from now on, in this thread.
pub fn leave_out(title: Option<&str>) {
    LEFT_OUT.with(|l| *l.borrow_mut() = title.map(str::to_owned));
}

/// Moves the contributions of one block input to another input.
fn input(t: &mut Tables, from: &str, to: &str) {
    let place = |name: &str| INPUTS.iter().position(|i| *i == name).unwrap_or(0) as u8;
    for b in &mut t.blocks {
        b.plain = false;
    }
    for c in t.contributions.iter_mut().filter(|c| c.input == place(from)) {
        c.input = place(to);
    }
}

fn code(t: &mut Tables, change: impl Fn(Op) -> Op) {
    for op in &mut t.code {
        *op = change(*op);
    }
}

fn rules(t: &mut Tables, change: impl Fn(&mut Rules)) {
    change(&mut t.rules);
}

/// A defect: its name, a case that must fail on it, and the change.
pub type Defect = (&'static str, &'static str, Break);

/// All defects.
pub const DEFECTS: &[Defect] = &[
    // The five rules.
    ("rule 1: no initial situation", "iec60848/action-delay-function", |t| t.initial.clear()),
    ("rule 1: every step is initial", "iec60848/action-delay-function", |t| {
        t.initial = (0..t.steps.len() as u32).map(StepId).collect()
    }),
    ("rule 2: one preceding step is enough", "iec60848/macro-in-fork-and-join", |t| {
        t.transitions.iter_mut().for_each(|t| t.more_from = g7_engine::Rows::default());
    }),
    ("rule 2: receptivities are not looked at", "iec60848/action-delay-function", |t| {
        t.transitions.iter_mut().for_each(|t| t.receptivity = g7_engine::Receptivity::True);
    }),
    ("rule 3: one succeeding step is activated", "iec60848/macro-in-fork-and-join", |t| {
        t.transitions.iter_mut().for_each(|t| t.more_to = g7_engine::Rows::default());
    }),
    ("rule 3: nothing is activated", "iec60848/action-delay-function", |t| {
        t.transitions.iter_mut().for_each(|t| t.to = StepId(NONE));
    }),
    ("rules 4 and 5: one transition after the other", "iec60848/action-reads-step-time", |t| {
        rules(t, |r| r.sequential = true)
    }),
    ("rule 4 under JGrafchart: all at once", "jgrafchart/exit-action-in-active-step", |t| {
        rules(t, |r| r.sequential = false)
    }),
    // The switches.
    ("switch: one pass", "iec60848/counter-of-bottles", |t| rules(t, |r| r.stable = false)),
    ("switch: until stable", "iec60848/switch-one-pass", |t| rules(t, |r| r.stable = true)),
    ("switch: single-token", "iec60848/rule-4-joins-that-share-a-step", |t| {
        rules(t, |r| r.multi_token = false)
    }),
    ("switch: multi-token", "iec60848/switch-single-token", |t| rules(t, |r| r.multi_token = true)),
    ("switch: numbers do not exclude", "jgrafchart/priorities", |t| {
        rules(t, |r| r.numbered_exclusive = false)
    }),
    ("switch: ordered actions", "iec60848/action-reads-step-time", |t| {
        rules(t, |r| r.parallel_actions = false)
    }),
    ("switch: parallel actions", "iec60848/ordered-actions", |t| rules(t, |r| r.parallel_actions = true)),
    ("switch: pulses within the pass", "iec61131/pulse-first", |t| rules(t, |r| r.late_actions = false)),
    ("switch: no final scan", "iec61131/final-scan-condition", |t| rules(t, |r| r.final_scan = false)),
    ("switch: final scan", "iec61131/final-scan-off", |t| rules(t, |r| r.final_scan = true)),
    ("switch: step times fall to zero", "iec60848/action-reads-step-time", |t| {
        rules(t, |r| r.keep_step_time = false)
    }),
    ("switch: step times are kept", "iec60848/step-time-zeroed", |t| rules(t, |r| r.keep_step_time = true)),
    ("switch: step times count scans", "iec60848/action-delay-function", |t| {
        rules(t, |r| r.scan_clock = true)
    }),
    ("switch: step times count time", "jgrafchart/exit-action-in-active-step", |t| {
        rules(t, |r| r.scan_clock = false)
    }),
    ("switch: periodic actions in the scan of activation", "jgrafchart/periodic-in-leaving-step", |t| {
        rules(t, |r| r.periodic_first = false)
    }),
    ("switch: no bound that matters", "iec60848/switch-bound-small", |t| rules(t, |r| r.bound = 2_000_000)),
    ("priorities: numbers are lost", "jgrafchart/priorities", |t| {
        t.transitions.iter_mut().for_each(|t| t.priority = NONE)
    }),
    ("priorities: nobody shares a step", "iec60848/switch-single-token", |t| {
        t.transitions.iter_mut().for_each(|t| (t.shares, t.simple) = (false, false));
    }),
    // The qualifiers.
    ("qualifier N: like S", "iec60848/action-delay-function", |t| input(t, "N", "S")),
    ("qualifier S: like N", "iec61131/actions-of-two-charts", |t| input(t, "S", "N")),
    ("qualifier R: without effect", "iec60848/set-in-control-block", |t| {
        for b in &mut t.blocks {
            b.plain = false;
        }
        t.contributions
            .iter_mut()
            .filter(|c| c.input == 2)
            .for_each(|c| (c.input, c.condition) = (5, Code::default()));
    }),
    ("qualifier L: like N", "iec61131/n-several-variables", |t| input(t, "L", "N")),
    ("qualifier D: like N", "iec61131/data-const", |t| input(t, "D", "N")),
    ("qualifier P: like N", "iec61131/final-scan-off", |t| input(t, "P", "N")),
    ("qualifier P1: like N", "iec61131/pair-p1-n", |t| input(t, "P1", "N")),
    ("qualifier P0: like P1", "iec61131/n-several-variables", |t| input(t, "P0", "P1")),
    ("qualifier SD: like D", "iec60848/set-in-control-block", |t| input(t, "SD", "D")),
    ("qualifier DS: like D", "iec61131/pair-ds-n", |t| input(t, "DS", "D")),
    ("qualifier DS: like SD", "iec60848/timed-stores-in-stable-situation", |t| input(t, "DS", "SD")),
    ("qualifier SL: like L", "iec60848/timed-stores-in-stable-situation", |t| input(t, "SL", "L")),
    ("conditions of actions are not looked at", "iec60848/action-delay-function", |t| {
        t.contributions.iter_mut().for_each(|c| c.condition = Code::default());
    }),
    ("mask: Q is not held back", "iec60848/mask-an-output", |t| {
        t.blocks.iter_mut().for_each(|b| b.gate = Code::default())
    }),
    // Stored actions.
    ("stored actions: none on activation", "iec60848/action-maintained-memorised", |t| {
        t.extras.iter_mut().for_each(|e| e.on = g7_engine::Rows::default())
    }),
    ("stored actions: none on deactivation", "iec60848/action-maintained-memorised", |t| {
        t.extras.iter_mut().for_each(|e| e.off = g7_engine::Rows::default());
    }),
    (
        "stored actions: activation and deactivation change places",
        "iec60848/action-maintained-memorised",
        |t| {
            t.extras.iter_mut().for_each(|e| std::mem::swap(&mut e.on, &mut e.off));
        },
    ),
    ("stored actions: none on event", "iec60848/conflict-across-kinds", |t| {
        t.extras.iter_mut().for_each(|e| e.events = g7_engine::Rows::default())
    }),
    ("stored actions: none on clearing", "iec60848/clearing-two-at-once", |t| {
        t.transitions.iter_mut().for_each(|t| t.on_clearing = NONE)
    }),
    ("stored actions: conditions are not looked at", "iec60848/each-scan-condition", |t| {
        t.actions.iter_mut().for_each(|a| a.condition = Code::default());
    }),
    ("each scan: never", "iec60848/each-scan-condition", |t| {
        t.extras.iter_mut().for_each(|e| e.periodics = g7_engine::Rows::default())
    }),
    // Edges and times.
    ("edges: rising ones fall", "iec60848/conflict-across-kinds", |t| {
        code(t, |op| if let Op::Rise(w) = op { Op::Fall(w) } else { op });
    }),
    ("edges: falling ones rise", "iec60848/edge-falling", |t| {
        code(t, |op| if let Op::Fall(w) = op { Op::Rise(w) } else { op });
    }),
    ("edges: watches do not see steps", "iec60848/edge-in-the-second-pass", |t| {
        t.extras.iter_mut().for_each(|e| e.watches = g7_engine::Rows::default());
    }),
    ("edges: watches do not see variables", "iec60848/action-time-operator-on-input", |t| {
        t.word_watches.clear()
    }),
    ("edges: edges of edges are not seen", "iec60848/edge-nested", |t| {
        t.watches.iter_mut().for_each(|w| w.watches = g7_engine::Rows::default());
    }),
    ("time operator: t1 and t2 change places", "iec60848/action-time-operator-on-input", |t| {
        t.watches.iter_mut().for_each(|w| w.times = w.times.map(|(a, b)| (b, a)));
    }),
    ("step times: twice as fast", "iec60848/action-delay-function", |t| {
        code(t, |op| if let Op::StepTime(s) = op { Op::StepTenths(s) } else { op });
    }),
    // Hierarchy.
    ("macro-steps: nobody counts in them", "iec60848/macro-left-and-entered-at-once", |t| {
        t.extras.iter_mut().for_each(|e| e.groups = g7_engine::Rows::default());
    }),
    ("enclosing steps: enclosed charts are not emptied", "iec60848/enclosing-activation-links", |t| {
        t.extras.iter_mut().for_each(|e| e.encloses = g7_engine::Rows::default());
    }),
    ("enclosing steps: links are not followed", "iec60848/enclosing-activation-links", |t| {
        t.extras.iter_mut().for_each(|e| e.links = g7_engine::Rows::default());
    }),
    ("forcing: no order acts", "iec60848/enclosing-forced", |t| {
        t.extras.iter_mut().for_each(|e| e.orders = g7_engine::Rows::default())
    }),
    ("forcing: every order freezes", "iec60848/enclosing-forced", |t| {
        t.orders.iter_mut().for_each(|o| o.situation = Situation::Current);
    }),
    ("forcing: every order empties", "iec60848/enclosing-forced", |t| {
        t.orders.iter_mut().for_each(|o| o.situation = Situation::Steps(g7_engine::Rows::default()));
    }),
    ("periods: every chart in every scan", "iec61131/every-edges-and-outputs", |t| {
        t.periods.iter_mut().for_each(|p| *p = 0)
    }),
    // PRE, POST, bodies, and the frame of a scan.
    ("PRE does not run", "iec60848/stability-pre-runs-once", |t| t.pre = Code::default()),
    ("POST does not run", "iec60848/stability-pre-runs-once", |t| t.post = Code::default()),
    ("system bits do nothing", "pl7/s21-initialise", |t| t.services = Code::default()),
    ("system bits do not fall back", "pl7/s0-and-s1", |t| t.tail = Code::default()),
    ("the target has no limits", "pl7/s25-table-overflow", |t| t.limits = None),
    ("outputs have no safe values", "iec60848/unstable-safe-outputs", |t| {
        t.safe.iter_mut().for_each(|s| *s = 0)
    }),
    ("initial values are lost", "iec60848/body-sees-own-writes", |t| t.init.iter_mut().for_each(|w| *w = 0)),
];
