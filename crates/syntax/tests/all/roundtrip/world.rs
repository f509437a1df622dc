//! Random plants, tests, properties and layouts.

use crate::roundtrip::charts::{at, comment, param};
use crate::roundtrip::expressions::{block, duration, expr, name, target, text, ty};
use g7_model::{
    ActionForm, Arrivals, Binding, Drive, Expr, ExprKind, Layout, LinkForm, Parts, Path, PlaceAt, Placed,
    Plant, PlantItem, Property, PropertyKind, Rate, Scenario, StateVar, TestStmt, TestStmtKind, View,
};
use proptest::prelude::*;

fn plant_item() -> impl Strategy<Value = PlantItem> {
    let names = || prop::collection::vec(name(), 1..3);
    let state = (names(), ty(), prop::option::of(expr()), prop::option::of((expr(), expr())), comment())
        .prop_map(|(names, ty, init, limits, comment)| {
            PlantItem::State(StateVar { names, ty, init, limits, comment, at: at() })
        });
    let constant = (names(), ty(), expr(), comment())
        .prop_map(|(names, ty, value, comment)| PlantItem::Const { names, ty, value, comment, at: at() });
    let init = prop::collection::vec(prop::collection::vec(expr(), 0..3), 0..3);
    let parts = (name(), prop::collection::vec(param(), 0..3), any::<u32>(), prop::option::of(expr()), init)
        .prop_map(|(name, attributes, max, length, init)| {
            PlantItem::Parts(Parts { name, attributes, max, length, init, at: at() })
        });
    let arrivals = (name(), expr(), prop::option::of(expr()), prop::option::of(expr()), block()).prop_map(
        |(name, least, most, when, body)| {
            PlantItem::Arrivals(Arrivals { name, least, most, when, body, at: at() })
        },
    );
    let binding = (name(), name(), expr()).prop_map(|(element, attribute, value)| Binding {
        element,
        attribute,
        value,
    });
    let view = (text(), prop::collection::vec(binding, 0..3))
        .prop_map(|(file, bindings)| PlantItem::View(View { file, bindings, at: at() }));
    prop_oneof![
        state,
        constant,
        (name(), expr(), prop::option::of(expr())).prop_map(|(state, value, when)| PlantItem::Rate(Rate {
            state,
            value,
            when,
            at: at()
        })),
        (name(), expr()).prop_map(|(input, value)| {
            let kind = ExprKind::Path(Path { names: vec![input] });
            PlantItem::Drive(Drive { input: Expr { kind, at: at() }, value, at: at() })
        }),
        (expr(), block()).prop_map(|(e, b)| PlantItem::On(e, b, at())),
        block().prop_map(|b| PlantItem::Each(b, at())),
        parts,
        arrivals,
        view,
    ]
}

pub(crate) fn plant() -> impl Strategy<Value = Plant> {
    (name(), comment(), prop::collection::vec(plant_item(), 0..4)).prop_map(|(name, comment, items)| Plant {
        name,
        comment,
        items,
        at: at(),
    })
}

fn test_stmt() -> impl Strategy<Value = TestStmt> {
    let list = || prop::collection::vec(expr(), 1..3);
    let leaf = prop_oneof![
        prop::collection::vec((target(), expr()), 1..3).prop_map(TestStmtKind::Set),
        (target(), prop::option::of(duration())).prop_map(|(p, t)| TestStmtKind::Pulse(p, t)),
        duration().prop_map(TestStmtKind::Wait),
        (expr(), prop::option::of(duration())).prop_map(|(e, t)| TestStmtKind::WaitUntil(e, t)),
        any::<u32>().prop_map(TestStmtKind::Scan),
        list().prop_map(TestStmtKind::Expect),
        prop::option::of(name()).prop_map(TestStmtKind::ExpectFault),
        (target(), expr()).prop_map(|(p, e)| TestStmtKind::Force(p, e)),
        target().prop_map(TestStmtKind::Release),
        any::<bool>().prop_map(|cold| TestStmtKind::Restart { cold }),
        text().prop_map(TestStmtKind::Comment),
    ];
    leaf.prop_map(|kind| TestStmt { kind, at: at() }).prop_recursive(2, 8, 3, move |inner| {
        let body = prop::collection::vec(inner, 0..3);
        prop_oneof![
            (list(), body.clone()).prop_map(|(e, b)| TestStmtKind::Always(e, b)),
            (any::<u32>(), body).prop_map(|(n, b)| TestStmtKind::Repeat(n, b)),
        ]
        .prop_map(|kind| TestStmt { kind, at: at() })
    })
}

pub(crate) fn test() -> impl Strategy<Value = Scenario> {
    let body = prop::collection::vec(test_stmt(), 0..5);
    (text(), prop::option::of(name()), prop::option::of(any::<u64>()), body)
        .prop_map(|(title, plant, seed, body)| Scenario { title, plant, seed, body, at: at() })
}

pub(crate) fn property() -> impl Strategy<Value = Property> {
    let kind = prop_oneof![
        expr().prop_map(PropertyKind::Always),
        expr().prop_map(PropertyKind::Never),
        expr().prop_map(PropertyKind::Reachable),
        (expr(), duration(), expr()).prop_map(|(a, t, b)| PropertyKind::After(a, t, b)),
        (expr(), expr(), expr()).prop_map(|(a, b, e)| PropertyKind::Until(a, b, e)),
        (expr(), expr(), expr()).prop_map(|(a, b, e)| PropertyKind::Between(a, b, e)),
        (expr(), expr()).prop_map(|(a, b)| PropertyKind::LeadsTo(a, b)),
        (any::<u32>(), prop::collection::vec(expr(), 1..4))
            .prop_map(|(n, list)| PropertyKind::AtMost(n, list)),
        expr().prop_map(PropertyKind::Assume),
    ];
    (kind, prop::option::of(name()), comment()).prop_map(|(kind, plant, comment)| {
        let plant = plant.filter(|_| !matches!(kind, PropertyKind::Assume(_)));
        Property { kind, plant, comment, at: at() }
    })
}

pub(crate) fn layout() -> impl Strategy<Value = Layout> {
    let symbol = || {
        prop_oneof![
            name().prop_map(Placed::Step),
            name().prop_map(Placed::Transition),
            any::<u32>().prop_map(Placed::TransitionNumber),
        ]
    };
    let what = prop_oneof![
        symbol(),
        text().prop_map(Placed::Comment),
        (symbol(), symbol()).prop_map(|ends| Placed::Link(Box::new(ends))),
        (symbol(), symbol(), prop::sample::select(&LinkForm::ALL[..]))
            .prop_map(|(from, to, form)| Placed::LinkForm(Box::new((from, to)), form)),
        (prop::option::of(name()), prop::sample::select(&ActionForm::ALL[..]))
            .prop_map(|(step, form)| Placed::Actions(step.map(|s| Box::new(Placed::Step(s))), form)),
        Just(Placed::Sheet),
    ];
    let point = || (-1_000_000..=1_000_000i32, any::<i32>().prop_map(|y| y.max(-i32::MAX)));
    let place = (what, point(), prop::collection::vec(point(), 0..3)).prop_map(|(what, (x, y), then)| {
        let (x, y) = if what.has_place() { (x, y) } else { (0, 0) };
        let then = if matches!(what, Placed::Link(_)) { then } else { Vec::new() };
        PlaceAt { what, x, y, then, at: at() }
    });
    (name(), prop::collection::vec(place, 0..4)).prop_map(|(chart, places)| Layout {
        chart,
        places,
        at: at(),
    })
}
