//! The skeleton of a random document: charts, steps, arcs, and how charts hang
//! together. Conditions and actions are hung on later, when every name is known.

use super::Weights;
use super::rng::Rng;

/// What hangs at a step beside its actions.
#[derive(Clone, Debug, Default)]
pub(super) struct PlanStep {
    pub(super) name: String,
    /// `initial step`, `entry step *`, `macro`, …: what stands before the name.
    pub(super) head: String,
    /// `= Exp1` of a macro-step.
    pub(super) expansion: Option<String>,
    pub(super) linked: bool,
    /// `force …`, `call …`, `enclose …`, `mask …`, `enable …`.
    pub(super) orders: Vec<String>,
}

/// A chart, expansion or task.
#[derive(Clone, Debug, Default)]
pub(super) struct PlanChart {
    /// `chart`, `macrochart`, `task`.
    pub(super) word: &'static str,
    pub(super) name: String,
    pub(super) every: Option<usize>,
    /// It, or the chart that it is an expansion in, has a period.
    pub(super) periodic: bool,
    pub(super) steps: Vec<PlanStep>,
    /// Preceding and succeeding steps.
    pub(super) arcs: Vec<(Vec<usize>, Vec<usize>)>,
    /// Enclosed by a step: may be empty for a while.
    pub(super) enclosed: bool,
    pub(super) forced: bool,
}

/// The whole skeleton.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    pub(super) charts: Vec<PlanChart>,
    /// Number for the next step, unique in the document.
    next: usize,
    weights: Weights,
}

/// Draws a skeleton.
pub(super) fn plan(rng: &mut Rng, weights: &Weights, driven: &[String]) -> Plan {
    let mut plan = Plan { charts: Vec::new(), next: 1, weights: *weights };
    let count = 1 + rng.weighted(&[35, 35, 20, 10]);
    let mut mains = Vec::new();
    for _ in 0..count {
        mains.push(main_chart(rng, &mut plan));
    }
    if rng.percent(weights.periods) {
        let id = main_chart(rng, &mut plan);
        plan.charts[id].every = Some(rng.one([15, 20, 30, 50]));
        plan.charts[id..].iter_mut().for_each(|c| c.periodic = true);
    }
    link_charts(rng, &mut plan, &mains, driven);
    if rng.percent(weights.tasks) {
        task(rng, &mut plan, &mains);
    }
    plan
}

fn main_chart(rng: &mut Rng, plan: &mut Plan) -> usize {
    let name = format!("G{}", plan.charts.len());
    let id = plan.charts.len();
    plan.charts.push(PlanChart { word: "chart", name, ..PlanChart::default() });
    let count = rng.between(2, 6);
    for i in 0..count {
        let initial = i == 0 || rng.percent(12);
        let number = plan.next;
        plan.next += 1;
        let mut step = PlanStep { name: number.to_string(), ..PlanStep::default() };
        step.head = if initial { "initial step" } else { "step" }.to_owned();
        if rng.percent(plan.weights.macro_steps) && plan.charts.len() < 8 {
            step.name = format!("M{number}");
            step.head = if initial { "initial macro" } else { "macro" }.to_owned();
            step.expansion = Some(expansion(rng, plan, 1));
        }
        plan.charts[id].steps.push(step);
    }
    plan.charts[id].arcs = arcs(rng, count, 0, count);
    id
}

/// A macrochart with entry step 0 and exit step last.
fn expansion(rng: &mut Rng, plan: &mut Plan, depth: usize) -> String {
    let id = plan.charts.len();
    let name = format!("Exp{id}");
    plan.charts.push(PlanChart { word: "macrochart", name: name.clone(), ..PlanChart::default() });
    between_ends(rng, plan, id, depth);
    name
}

fn task(rng: &mut Rng, plan: &mut Plan, mains: &[usize]) {
    let id = plan.charts.len();
    let name = format!("Task{id}");
    plan.charts.push(PlanChart { word: "task", name: name.clone(), ..PlanChart::default() });
    between_ends(rng, plan, id, 2);
    // A task works for one caller at a time: one token, from entry to exit.
    plan.charts[id].arcs = (1..plan.charts[id].steps.len()).map(|i| (vec![i - 1], vec![i])).collect();
    for _ in 0..rng.between(1, 3) {
        let Some(&chart) = rng.pick(mains) else { return };
        let count = plan.charts[chart].steps.len();
        let step = &mut plan.charts[chart].steps[rng.below(count)];
        let order = format!("call {name}");
        if !step.orders.contains(&order) {
            step.orders.push(order);
        }
    }
}

fn between_ends(rng: &mut Rng, plan: &mut Plan, id: usize, depth: usize) {
    let inner = rng.weighted(&[25, 45, 30]);
    for i in 0..inner + 2 {
        let number = plan.next;
        plan.next += 1;
        let mut step = PlanStep { name: number.to_string(), ..PlanStep::default() };
        step.head = "step".to_owned();
        if i == 0 {
            step.head = "entry step".to_owned();
        } else if i == inner + 1 {
            step.head = "exit step".to_owned();
        } else if depth < 2 && rng.percent(plan.weights.macro_steps) && plan.charts.len() < 8 {
            step.name = format!("M{number}");
            step.head = "macro".to_owned();
            step.expansion = Some(expansion(rng, plan, depth + 1));
        }
        plan.charts[id].steps.push(step);
    }
    plan.charts[id].arcs = arcs(rng, inner + 2, 1, inner + 1);
}

/// Arcs: a ring (or a path, where `first` is 1) and some more of every shape.
/// `first` is the lowest step that may succeed, `last` bounds those that may
/// precede: no arc leads into an entry step or out of an exit step.
fn arcs(rng: &mut Rng, count: usize, first: usize, last: usize) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut arcs = Vec::new();
    for i in 0..last {
        arcs.push((vec![i], vec![if first == 0 { (i + 1) % count } else { i + 1 }]));
    }
    let more = rng.below(count + 1);
    for _ in 0..more {
        // A source within an expansion would make it active without its macro-step.
        let sources = if first == 0 { 4 } else { 0 };
        let mut from = some(rng, 0, last, &[sources, 78 - sources, 18, 4]);
        let to = some(rng, first, count, &[5, 72, 19, 4]);
        if from.is_empty() && to.is_empty() {
            from.push(0);
        }
        arcs.push((from, to));
    }
    // AND divergences and convergences put on the ring itself.
    for arc in &mut arcs {
        if rng.percent(10) && count > first {
            let extra = rng.between(first, count - 1);
            if !arc.1.contains(&extra) {
                arc.1.push(extra);
            }
        }
    }
    for i in (1..arcs.len()).rev() {
        arcs.swap(i, rng.below(i + 1));
    }
    arcs
}

fn some(rng: &mut Rng, from: usize, to: usize, weights: &[usize]) -> Vec<usize> {
    let mut all = Vec::new();
    for _ in 0..rng.weighted(weights) {
        let step = from + rng.below(to - from);
        if !all.contains(&step) {
            all.push(step);
        }
    }
    all
}

/// Enclosing, forcing, enabling and masking among the charts without a period.
/// A chart may order only those that stand behind it, so no order is cyclic.
fn link_charts(rng: &mut Rng, plan: &mut Plan, mains: &[usize], driven: &[String]) {
    for (place, &target) in mains.iter().enumerate().skip(1) {
        let by = &mains[..place];
        let Some(&master) = rng.pick(by) else { continue };
        let w = plan.weights;
        match rng.weighted(&[40, w.enclosing, w.forcing, w.enabling]) {
            1 => enclose(rng, plan, master, target),
            2 => force(rng, plan, by, target),
            3 => {
                let order = format!("enable {}", plan.charts[target].name);
                order_of(rng, plan, master, order);
            }
            _ => {}
        }
        if rng.percent(w.masking) {
            let order = format!("mask {}", plan.charts[target].name);
            order_of(rng, plan, master, order);
        }
    }
    for name in driven {
        if rng.percent(plan.weights.masking / 2)
            && let Some(&master) = rng.pick(mains)
        {
            order_of(rng, plan, master, format!("mask {name}"));
        }
    }
}

fn order_of(rng: &mut Rng, plan: &mut Plan, chart: usize, order: String) {
    let count = plan.charts[chart].steps.len();
    let step = &mut plan.charts[chart].steps[rng.below(count)];
    if !step.orders.contains(&order) {
        step.orders.push(order);
    }
}

fn enclose(rng: &mut Rng, plan: &mut Plan, master: usize, target: usize) {
    let count = plan.charts[master].steps.len();
    let place = rng.below(count);
    let name = plan.charts[target].name.clone();
    let step = &mut plan.charts[master].steps[place];
    if step.expansion.is_some() {
        return;
    }
    let initial = step.head.starts_with("initial");
    step.head = if initial { "initial enclosing step" } else { "enclosing step" }.to_owned();
    step.orders.push(format!("enclose {name}"));
    let target = &mut plan.charts[target];
    target.enclosed = true;
    for (from, _) in target.arcs.iter_mut().filter(|(from, _)| from.is_empty()) {
        from.push(0); // nothing within is active without the enclosing step
    }
    let linked = rng.below(target.steps.len());
    target.steps[linked].linked = true;
    if rng.percent(30) {
        let second = rng.below(target.steps.len());
        target.steps[second].linked = true;
    }
    for step in &mut target.steps {
        // Initial steps within have a meaning only where the enclosing one is initial.
        if !initial && step.head.starts_with("initial ") {
            step.head = step.head.replacen("initial ", "", 1);
        }
    }
}

fn force(rng: &mut Rng, plan: &mut Plan, by: &[usize], target: usize) {
    plan.charts[target].forced = true;
    for _ in 0..rng.weighted(&[0, 80, 16, 4]) {
        let Some(&master) = rng.pick(by) else { return };
        let steps = &plan.charts[target].steps;
        let names: Vec<String> =
            some(rng, 0, steps.len(), &[0, 60, 40]).into_iter().map(|i| steps[i].name.clone()).collect();
        let situation = match rng.weighted(&[45, 25, 10, 20]) {
            0 => format!("{{{}}}", names.join(", ")),
            1 => "INIT".to_owned(),
            2 => "{}".to_owned(),
            _ => "{*}".to_owned(),
        };
        let order = format!("force {} := {situation}", plan.charts[target].name);
        order_of(rng, plan, master, order);
    }
}
