//! Chance under a seed: random numbers and arrivals.

use super::support::run;

/// `x` at each of some ticks.
fn throws(items: &str, seed: u64) -> Vec<f64> {
    let mut p = run(items);
    p.seed(seed);
    (0..500).map(|_| p.ticks(1).lreal("x")).collect()
}

#[test]
fn random_lies_between_its_bounds_and_fills_them() {
    let plain = throws("state x : LREAL  each { x := random() }", 1);
    assert!(plain.iter().all(|x| (0.0..1.0).contains(x)));
    assert!(plain.iter().any(|x| *x < 0.05) && plain.iter().any(|x| *x > 0.95));
    let wide = throws("state x : LREAL  each { x := random(-3.0, 5.0) }", 1);
    assert!(wide.iter().all(|x| (-3.0..5.0).contains(x)));
    assert!(wide.iter().any(|x| *x < -2.5) && wide.iter().any(|x| *x > 4.5));
}

#[test]
fn the_same_seed_gives_the_same_run_and_another_one_another() {
    let items = "state x : LREAL  each { x := random() }";
    assert_eq!(throws(items, 7), throws(items, 7));
    assert_ne!(throws(items, 7), throws(items, 8));
}

/// The ticks at which something arrived.
fn arrivals(items: &str, ticks: u32, seed: Option<u64>) -> Vec<u32> {
    let mut p = run(items);
    p.output("V", true);
    if let Some(seed) = seed {
        p.seed(seed);
    }
    let mut before = 0;
    (0..ticks)
        .filter(|_| {
            let n = p.ticks(1).int("n");
            std::mem::replace(&mut before, n) != n
        })
        .collect()
}

#[test]
fn arrivals_at_a_fixed_time_come_at_that_time() {
    let at = arrivals("state n : INT  arrivals A every 50ms { n := n + 1 }", 21, None);
    assert_eq!(at, [5, 10, 15, 20]);
}

#[test]
fn arrivals_between_two_ticks_do_not_drift() {
    // Every 25 ms at ticks of 10 ms: due at 25, 50, 75, 100, seen at the next tick.
    let at = arrivals("state n : INT  arrivals A every 25ms { n := n + 1 }", 11, None);
    assert_eq!(at, [3, 5, 8, 10]);
}

#[test]
fn arrivals_by_chance_keep_their_times_apart() {
    let items = "state n : INT  arrivals A every 100ms .. 300ms { n := n + 1 }";
    let at = arrivals(items, 5000, Some(3));
    let gaps: Vec<u32> = at.windows(2).map(|w| w[1] - w[0]).collect();
    // A time is rounded up to a tick, and the rest of it counts for the next one.
    assert!(gaps.iter().all(|g| (10..=31).contains(g)), "{gaps:?}");
    assert!(gaps.iter().any(|g| *g <= 12) && gaps.iter().any(|g| *g >= 28), "{gaps:?}");
    let mean = f64::from(gaps.iter().sum::<u32>()) / gaps.len() as f64;
    assert!((18.0..22.0).contains(&mean), "{mean}");
    assert_eq!(at, arrivals(items, 5000, Some(3)));
    assert_ne!(at, arrivals(items, 5000, Some(4)));
}

#[test]
fn arrivals_wait_while_they_may_not() {
    let mut p = run("state n : INT  arrivals A every 50ms when V { n := n + 1 }");
    p.output("V", true).ticks(4);
    // 30 ms have passed, 20 are left.
    p.output("V", false).ticks(100);
    assert_eq!(p.int("n"), 0);
    p.output("V", true).ticks(1);
    assert_eq!(p.int("n"), 0);
    p.ticks(1);
    assert_eq!(p.int("n"), 1);
}
