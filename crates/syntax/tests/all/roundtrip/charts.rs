//! Random documents.

use crate::roundtrip::expressions::{
    args, block, chart_path, declared_type, direct, duration, element, expr, fields, name, path, simple_stmt,
    text, value_type, values,
};
use crate::roundtrip::world;
use g7_model::{
    Action, ActionKind, Array, Block, Body, BodyLang, Chart, ChartItem, ChartKind, Composed, Document, Expr,
    ExprKind, Function, Instance, InstanceNames, Item, Limits, Name, NamedAction, Note, Order, Param, Path,
    Place, Profile, ProfileName, Qualifier, Section, Situation, Span, Step, StepKind, Stmt, StmtKind, Switch,
    Target, TargetPlc, Transition, Type, Use, VarDecl, VarKind, Work,
};
use proptest::prelude::*;

pub(crate) fn at() -> Place {
    Place::default()
}

pub(crate) fn comment() -> impl Strategy<Value = Option<Box<str>>> {
    prop::option::of(text())
}

fn names(range: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Name>> {
    prop::collection::vec(name(), range)
}

fn switch() -> impl Strategy<Value = Switch> {
    (any::<bool>(), 0usize..9, any::<u32>()).prop_map(|(b, i, n)| match i {
        0 => Switch::Stable(b),
        1 => Switch::MultiToken(b),
        2 => Switch::Sequential(b),
        3 => Switch::ParallelActions(b),
        4 => Switch::FinalScan(b),
        5 => Switch::KeepStepTime(b),
        6 => Switch::ScanClock(b),
        7 => Switch::PulseFirst(b),
        _ => Switch::Bound(n),
    })
}

fn variable() -> impl Strategy<Value = VarDecl> {
    let kind = prop::sample::select(vec![VarKind::Input, VarKind::Output, VarKind::Var, VarKind::Const]);
    let address = prop_oneof![
        direct().prop_map(|d| Name::new(format!("%{d}"), Span::default())),
        name(),
        text().prop_map(|t| Name::new(t, Span::default())),
    ];
    let rest = (prop::option::of(address), any::<bool>(), prop::option::of(expr()), comment());
    let scalar = (Just(None), prop::option::of(expr()), expr());
    let dimensions = prop::collection::vec((expr(), expr()), 1..3);
    let array = dimensions.prop_map(|dimensions| Some(Box::new(Array { dimensions, at: at() })));
    let array = (array, prop::option::of(values()), values());
    let structure = (Just(None), prop::option::of(fields()), fields());
    let shape = prop_oneof![3 => scalar.boxed(), 1 => array.boxed(), 1 => structure.boxed()];
    (kind, names(1..4), declared_type(), shape, rest).prop_map(
        |(kind, names, (ty, of, limits), (array, init, value), (address, flag, safe, comment))| VarDecl {
            kind,
            names,
            array,
            of,
            limits: limits.map(Box::new),
            part_of: None,
            usual: None,
            ty,
            init: if kind == VarKind::Const { Some(value) } else { init },
            address: address.filter(|_| kind != VarKind::Const),
            inverted: flag && matches!(kind, VarKind::Input | VarKind::Output),
            retain: flag && kind == VarKind::Var,
            safe: safe.filter(|_| kind == VarKind::Output),
            comment,
            at: at(),
        },
    )
}

fn composed() -> impl Strategy<Value = Composed> {
    let member = || variable().prop_map(|v| VarDecl { address: None, inverted: false, safe: None, ..v });
    let of_structure = member().prop_map(|v| VarDecl { kind: VarKind::Var, retain: false, ..v });
    let inout = member().prop_map(|v| VarDecl { kind: VarKind::Var, retain: false, init: None, ..v });
    let structure =
        prop::collection::vec(of_structure, 0..3).prop_map(|members| (members, Vec::new(), false, None));
    let block =
        (prop::collection::vec(member(), 0..3), prop::collection::vec(inout, 0..2), prop::option::of(body()))
            .prop_map(|(members, inouts, body)| (members, inouts, true, body));
    (name(), comment(), prop_oneof![structure.boxed(), block.boxed()]).prop_map(
        |(name, comment, (members, inouts, block, body))| Composed {
            name,
            comment,
            members,
            inouts,
            block,
            body,
            at: at(),
        },
    )
}

fn body() -> impl Strategy<Value = Body> {
    prop_oneof![
        3 => block().prop_map(Body::St),
        1 => (any::<bool>(), "[ \n]{0,4}", any::<bool>()).prop_map(|(il, blanks, empty)| {
            let (lang, text) = match il {
                true => (BodyLang::Il, "LD a\nAND(\nLD b\n)\nST c"),
                false => (BodyLang::Ld, "--{ [a] | [/b]\n }--(c)"),
            };
            let text = if empty { "" } else { text };
            Body::Other(lang, format!("{blanks}{text}{blanks}").into(), Block::default())
        }),
    ]
}

fn work() -> impl Strategy<Value = Work> {
    prop_oneof![
        2 => simple_stmt().prop_map(|s| Work::Single(Box::new(s))),
        1 => block().prop_map(Work::Block),
    ]
}

fn order() -> impl Strategy<Value = Order> {
    let situation =
        prop_oneof![Just(Situation::Init), Just(Situation::Current), names(0..3).prop_map(Situation::Steps),];
    prop_oneof![
        (chart_path(), situation).prop_map(|(n, s)| Order::Force(n, s)),
        chart_path().prop_map(Order::Enable),
        chart_path().prop_map(Order::Mask),
        chart_path().prop_map(Order::Call),
        chart_path().prop_map(Order::Enclose),
    ]
}

fn action() -> impl Strategy<Value = Action> {
    let target = prop_oneof![
        2 => path().prop_map(Target::Path),
        1 => direct().prop_map(|d| Target::Direct(d, at())),
        1 => element(expr()).prop_map(|e| Target::Element(Box::new(e))),
        2 => work().prop_map(Target::Work),
    ];
    let qualified = (prop::sample::select(Qualifier::ALL.to_vec()), expr(), target, prop::option::of(expr()))
        .prop_map(|(qualifier, time, target, condition)| ActionKind::Qualified {
            qualifier,
            time: Some(time).filter(|_| qualifier.timed()),
            target,
            condition,
        });
    prop_oneof![
        5 => qualified,
        1 => (expr(), work()).prop_map(|(event, work)| ActionKind::OnEvent { event, work }),
        1 => (work(), prop::option::of(expr())).prop_map(|(work, condition)| ActionKind::EachScan { work, condition }),
        2 => order().prop_map(ActionKind::Order),
        1 => text().prop_map(ActionKind::Comment),
    ]
    .prop_map(|kind| Action { kind, at: at() })
}

fn step() -> impl Strategy<Value = Step> {
    let kind = prop_oneof![
        3 => Just(StepKind::Plain),
        1 => Just(StepKind::Entry),
        1 => Just(StepKind::Exit),
        1 => Just(StepKind::Enclosing),
        1 => name().prop_map(StepKind::Macro),
    ];
    let flags = (any::<bool>(), any::<bool>(), any::<bool>());
    (name(), kind, flags, comment(), prop::collection::vec(action(), 0..4)).prop_map(
        |(name, kind, (initial, linked, braces), comment, actions)| Step {
            name,
            kind,
            initial,
            linked,
            comment,
            braces: braces || !actions.is_empty(),
            actions,
            at: at(),
        },
    )
}

fn transition() -> impl Strategy<Value = Transition> {
    let rest = (prop::option::of(any::<u32>()), comment(), prop::option::of(block()), any::<bool>());
    (prop::option::of(name()), names(0..3), names(0..3), expr(), rest).prop_map(
        |(label, from, to, receptivity, (priority, comment, on_clearing, chained))| Transition {
            label,
            from,
            to,
            receptivity,
            priority,
            comment,
            on_clearing,
            chained,
            at: at(),
        },
    )
}

fn named_action() -> impl Strategy<Value = NamedAction> {
    (name(), comment(), body()).prop_map(|(name, comment, body)| NamedAction {
        name,
        comment,
        body,
        at: at(),
    })
}

fn section() -> impl Strategy<Value = Section> {
    (name(), block(), prop::option::of(expr())).prop_map(|(name, block, value)| match value {
        None => Section { name, body: block, short: false, at: at() },
        Some(value) => {
            let kind = ExprKind::Path(Path { names: vec![name.clone()] });
            let kind = StmtKind::Assign { target: Expr { kind, at: at() }, value };
            let statements = vec![Stmt { kind, at: at() }];
            Section { name, body: Block { locals: Vec::new(), statements, at: at() }, short: true, at: at() }
        }
    })
}

fn chart_item() -> impl Strategy<Value = ChartItem> {
    prop_oneof![
        1 => variable().prop_map(ChartItem::Var),
        4 => step().prop_map(ChartItem::Step),
        4 => transition().prop_map(ChartItem::Transition),
        1 => body().prop_map(|b| ChartItem::Pre(b, at())),
        1 => body().prop_map(|b| ChartItem::Post(b, at())),
        1 => named_action().prop_map(ChartItem::Action),
        1 => section().prop_map(ChartItem::Section),
    ]
}

fn chart() -> impl Strategy<Value = Chart> {
    let kind = prop::sample::select(vec![ChartKind::Chart, ChartKind::Expansion, ChartKind::Task]);
    let items = prop::collection::vec(chart_item(), 0..6);
    let params = (prop::collection::vec(param(), 0..3), prop::option::weighted(0.2, name()));
    (kind, name(), params, comment(), prop::option::of(duration()), items).prop_map(
        |(kind, name, (params, block), comment, every, mut items)| {
            chain(&mut items);
            let every = every.filter(|_| kind == ChartKind::Chart);
            Chart { kind, name, params, block, comment, every, items, at: at() }
        },
    )
}

/// Makes what claims to be chained follow the transition before it.
fn chain(items: &mut [ChartItem]) {
    let mut before: Option<Vec<Name>> = None;
    for item in items {
        let ChartItem::Transition(t) = item else {
            before = None;
            continue;
        };
        match before.filter(|_| t.chained) {
            Some(from) => {
                t.from = from;
                t.label = None;
            }
            None => t.chained = false,
        }
        before = Some(t.to.clone());
    }
}

pub(crate) fn param() -> impl Strategy<Value = Param> {
    (name(), value_type()).prop_map(|(name, ty)| Param { name, ty })
}

/// An enumeration, or what a variable can be of.
fn type_declaration() -> impl Strategy<Value = VarDecl> {
    let values = prop::collection::vec((name(), prop::option::of(expr())), 1..4);
    let head = || (name(), comment());
    let enumeration =
        (head(), values, prop::option::of(expr())).prop_map(|((name, comment), values, init)| VarDecl {
            limits: Some(Box::new(Limits::Values(values))),
            init,
            comment,
            ..VarDecl::new(VarKind::Var, vec![name], Type::Int, at())
        });
    let other = (head(), variable()).prop_map(|((name, comment), v)| VarDecl {
        kind: VarKind::Var,
        names: vec![name],
        address: None,
        inverted: false,
        retain: false,
        safe: None,
        comment,
        ..v
    });
    prop_oneof![enumeration, other]
}

fn instance() -> impl Strategy<Value = Instance> {
    let range = (expr(), expr()).prop_map(|(a, b)| InstanceNames::Range(Box::new(a), Box::new(b)));
    let names = prop_oneof![name().prop_map(InstanceNames::One), range];
    (name(), names, args(expr()), comment()).prop_map(|(chart, names, args, comment)| Instance {
        chart,
        names,
        args,
        comment,
        at: at(),
    })
}

/// A file by its path, which may be any text, or a part of the library by its name.
fn used() -> impl Strategy<Value = Use> {
    let path = text().prop_map(|path| (Name::new(path, Span::default()), false));
    let part = name().prop_map(|name| (name, true));
    prop_oneof![path, part].prop_map(|(name, library)| Use { name, library, at: at() })
}

fn item() -> impl Strategy<Value = Item> {
    let profile = (prop::sample::select(ProfileName::ALL.to_vec()), prop::collection::vec(switch(), 0..3))
        .prop_map(|(name, switches)| {
            let switches = switches.into_iter().map(|s| (s, at())).collect();
            Item::Profile(Profile { name, switches, at: at() })
        });
    let function = (name(), prop::collection::vec(param(), 0..3), value_type(), block()).prop_map(
        |(name, params, result, body)| Item::Function(Function { name, params, result, body, at: at() }),
    );
    prop_oneof![
        1 => profile,
        1 => duration().prop_map(|time| Item::Cycle(time, at())),
        1 => prop::sample::select(TargetPlc::ALL.to_vec()).prop_map(|t| Item::Target(t, at())),
        1 => used().prop_map(Item::Use),
        3 => variable().prop_map(Item::Var),
        4 => chart().prop_map(Item::Chart),
        2 => instance().prop_map(Item::Instance),
        2 => composed().prop_map(Item::Composed),
        2 => type_declaration().prop_map(Item::Type),
        1 => named_action().prop_map(Item::Action),
        1 => section().prop_map(Item::Section),
        1 => function,
        1 => body().prop_map(|b| Item::Pre(b, at())),
        1 => body().prop_map(|b| Item::Post(b, at())),
        2 => world::plant().prop_map(Item::Plant),
        2 => world::test().prop_map(Item::Test),
        1 => world::property().prop_map(Item::Prove),
        1 => world::layout().prop_map(Item::Layout),
    ]
}

/// Any document without `Bad` expressions.
pub(crate) fn document() -> impl Strategy<Value = Document> {
    let note = prop_oneof!["//[a-z]{0,5}", "/\\*[a-z\n]{0,5}\\*/"].prop_map(|text| Note {
        text: text.into(),
        at: Span::default(),
        behind: None,
    });
    (prop::collection::vec(item(), 0..4), prop::collection::vec(note, 0..2))
        .prop_map(|(items, notes)| Document { items, notes })
}
