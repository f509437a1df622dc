//! The skeleton of a random document: charts, steps, transitions, and the relations between charts.
//! Conditions and actions are added later, when all names are known.

use super::Weights;
use super::rng::Rng;

/// A step of the skeleton, with everything except its actions.
#[derive(Clone, Debug, Default)]
pub(super) struct SkeletonStep {
    pub(super) name: String,
    /// The text before the name: `initial step`, `entry step *`, `macro`, …
    pub(super) head: String,
    /// For a macro-step: `= Exp1`.
    pub(super) expansion: Option<String>,
    pub(super) linked: bool,
    /// The orders of the step: `force …`, `call …`, `enclose …`, `mask …`, `enable …`.
    pub(super) orders: Vec<String>,
}

/// A chart, expansion or task.
#[derive(Clone, Debug, Default)]
pub(super) struct SkeletonChart {
    /// `chart`, `macrochart`, `task`.
    pub(super) word: &'static str,
    pub(super) name: String,
    pub(super) every: Option<usize>,
    /// True if it has a period, or if it is an expansion in a chart with a period.
    pub(super) periodic: bool,
    pub(super) steps: Vec<SkeletonStep>,
    /// The transitions: preceding and succeeding steps.
    pub(super) arcs: Vec<(Vec<usize>, Vec<usize>)>,
    /// True if a step encloses it, so that it may be inactive for a while.
    pub(super) enclosed: bool,
    pub(super) forced: bool,
}

/// The whole skeleton.
#[derive(Clone, Debug, Default)]
pub(super) struct Skeleton {
    pub(super) charts: Vec<SkeletonChart>,
    /// The number of the next step; numbers are unique in the document.
    next: usize,
    weights: Weights,
}

/// Makes a random skeleton.
pub(super) fn skeleton(rng: &mut Rng, weights: &Weights, driven: &[String]) -> Skeleton {
    let mut skeleton = Skeleton { charts: Vec::new(), next: 1, weights: *weights };
    let count = 1 + rng.weighted(&[35, 35, 20, 10]);
    let mut mains = Vec::new();
    for _ in 0..count {
        mains.push(main_chart(rng, &mut skeleton));
    }
    if rng.percent(weights.periods) {
        let id = main_chart(rng, &mut skeleton);
        skeleton.charts[id].every = Some(rng.one([15, 20, 30, 50]));
        skeleton.charts[id..].iter_mut().for_each(|c| c.periodic = true);
    }
    link_charts(rng, &mut skeleton, &mains, driven);
    if rng.percent(weights.tasks) {
        task(rng, &mut skeleton, &mains);
    }
    skeleton
}

fn main_chart(rng: &mut Rng, skeleton: &mut Skeleton) -> usize {
    let name = format!("G{}", skeleton.charts.len());
    let id = skeleton.charts.len();
    skeleton.charts.push(SkeletonChart { word: "chart", name, ..SkeletonChart::default() });
    let count = rng.between(2, 6);
    for i in 0..count {
        let initial = i == 0 || rng.percent(12);
        let number = skeleton.next;
        skeleton.next += 1;
        let mut step = SkeletonStep { name: number.to_string(), ..SkeletonStep::default() };
        step.head = if initial { "initial step" } else { "step" }.to_owned();
        if rng.percent(skeleton.weights.macro_steps) && skeleton.charts.len() < 8 {
            step.name = format!("M{number}");
            step.head = if initial { "initial macro" } else { "macro" }.to_owned();
            step.expansion = Some(expansion(rng, skeleton, 1));
        }
        skeleton.charts[id].steps.push(step);
    }
    skeleton.charts[id].arcs = arcs(rng, count, 0, count);
    id
}

/// Adds an expansion: its first step is the entry step, its last the exit step.
fn expansion(rng: &mut Rng, skeleton: &mut Skeleton, depth: usize) -> String {
    let id = skeleton.charts.len();
    let name = format!("Exp{id}");
    skeleton.charts.push(SkeletonChart {
        word: "macrochart",
        name: name.clone(),
        ..SkeletonChart::default()
    });
    between_ends(rng, skeleton, id, depth);
    name
}

fn task(rng: &mut Rng, skeleton: &mut Skeleton, mains: &[usize]) {
    let id = skeleton.charts.len();
    let name = format!("Task{id}");
    skeleton.charts.push(SkeletonChart { word: "task", name: name.clone(), ..SkeletonChart::default() });
    between_ends(rng, skeleton, id, 2);
    // A task works for one caller at a time, so it has one token that goes from entry to exit.
    skeleton.charts[id].arcs = (1..skeleton.charts[id].steps.len()).map(|i| (vec![i - 1], vec![i])).collect();
    for _ in 0..rng.between(1, 3) {
        let Some(&chart) = rng.pick(mains) else { return };
        let count = skeleton.charts[chart].steps.len();
        let step = &mut skeleton.charts[chart].steps[rng.below(count)];
        let order = format!("call {name}");
        if !step.orders.contains(&order) {
            step.orders.push(order);
        }
    }
}

fn between_ends(rng: &mut Rng, skeleton: &mut Skeleton, id: usize, depth: usize) {
    let inner = rng.weighted(&[25, 45, 30]);
    for i in 0..inner + 2 {
        let number = skeleton.next;
        skeleton.next += 1;
        let mut step = SkeletonStep { name: number.to_string(), ..SkeletonStep::default() };
        step.head = "step".to_owned();
        if i == 0 {
            step.head = "entry step".to_owned();
        } else if i == inner + 1 {
            step.head = "exit step".to_owned();
        } else if depth < 2 && rng.percent(skeleton.weights.macro_steps) && skeleton.charts.len() < 8 {
            step.name = format!("M{number}");
            step.head = "macro".to_owned();
            step.expansion = Some(expansion(rng, skeleton, depth + 1));
        }
        skeleton.charts[id].steps.push(step);
    }
    skeleton.charts[id].arcs = arcs(rng, inner + 2, 1, inner + 1);
}

/// Random transitions: a ring (or a path, if `first` is 1) and some more of every shape. Succeeding
/// steps are at least `first`, preceding steps are below `last`: no transition leads into an entry
/// step or out of an exit step.
fn arcs(rng: &mut Rng, count: usize, first: usize, last: usize) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut arcs = Vec::new();
    for i in 0..last {
        arcs.push((vec![i], vec![if first == 0 { (i + 1) % count } else { i + 1 }]));
    }
    let more = rng.below(count + 1);
    for _ in 0..more {
        // A source transition in an expansion would activate it without its macro-step.
        let sources = if first == 0 { 4 } else { 0 };
        let mut from = some(rng, 0, last, &[sources, 78 - sources, 18, 4]);
        let to = some(rng, first, count, &[5, 72, 19, 4]);
        if from.is_empty() && to.is_empty() {
            from.push(0);
        }
        arcs.push((from, to));
    }
    // AND divergences and convergences on the ring itself.
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

/// Adds enclosing, forcing, enabling and masking among the charts without a period. A chart gives
/// orders only to later charts, so no order is cyclic.
fn link_charts(rng: &mut Rng, skeleton: &mut Skeleton, mains: &[usize], driven: &[String]) {
    for (place, &target) in mains.iter().enumerate().skip(1) {
        let by = &mains[..place];
        let Some(&master) = rng.pick(by) else { continue };
        let w = skeleton.weights;
        match rng.weighted(&[40, w.enclosing, w.forcing, w.enabling]) {
            1 => enclose(rng, skeleton, master, target),
            2 => force(rng, skeleton, by, target),
            3 => {
                let order = format!("enable {}", skeleton.charts[target].name);
                order_of(rng, skeleton, master, order);
            }
            _ => {}
        }
        if rng.percent(w.masking) {
            let order = format!("mask {}", skeleton.charts[target].name);
            order_of(rng, skeleton, master, order);
        }
    }
    for name in driven {
        if rng.percent(skeleton.weights.masking / 2)
            && let Some(&master) = rng.pick(mains)
        {
            order_of(rng, skeleton, master, format!("mask {name}"));
        }
    }
}

fn order_of(rng: &mut Rng, skeleton: &mut Skeleton, chart: usize, order: String) {
    let count = skeleton.charts[chart].steps.len();
    let step = &mut skeleton.charts[chart].steps[rng.below(count)];
    if !step.orders.contains(&order) {
        step.orders.push(order);
    }
}

fn enclose(rng: &mut Rng, skeleton: &mut Skeleton, master: usize, target: usize) {
    let count = skeleton.charts[master].steps.len();
    let place = rng.below(count);
    let name = skeleton.charts[target].name.clone();
    let step = &mut skeleton.charts[master].steps[place];
    if step.expansion.is_some() {
        return;
    }
    let initial = step.head.starts_with("initial");
    step.head = if initial { "initial enclosing step" } else { "enclosing step" }.to_owned();
    step.orders.push(format!("enclose {name}"));
    let target = &mut skeleton.charts[target];
    target.enclosed = true;
    for (from, _) in target.arcs.iter_mut().filter(|(from, _)| from.is_empty()) {
        from.push(0); // nothing inside is active without the enclosing step
    }
    let linked = rng.below(target.steps.len());
    target.steps[linked].linked = true;
    if rng.percent(30) {
        let second = rng.below(target.steps.len());
        target.steps[second].linked = true;
    }
    for step in &mut target.steps {
        // Initial steps inside have a meaning only if the enclosing step is initial.
        if !initial && step.head.starts_with("initial ") {
            step.head = step.head.replacen("initial ", "", 1);
        }
    }
}

fn force(rng: &mut Rng, skeleton: &mut Skeleton, by: &[usize], target: usize) {
    skeleton.charts[target].forced = true;
    for _ in 0..rng.weighted(&[0, 80, 16, 4]) {
        let Some(&master) = rng.pick(by) else { return };
        let steps = &skeleton.charts[target].steps;
        let names: Vec<String> =
            some(rng, 0, steps.len(), &[0, 60, 40]).into_iter().map(|i| steps[i].name.clone()).collect();
        let situation = match rng.weighted(&[45, 25, 10, 20]) {
            0 => format!("{{{}}}", names.join(", ")),
            1 => "INIT".to_owned(),
            2 => "{}".to_owned(),
            _ => "{*}".to_owned(),
        };
        let order = format!("force {} := {situation}", skeleton.charts[target].name);
        order_of(rng, skeleton, master, order);
    }
}
