//! Checks the symbols against IEC 60848: what the reader sees, not how it is produced.
#![allow(missing_docs, reason = "a test")]

use g7_draw::{Drawing, Item, Look, Options, Part, Rect, draw};
use g7_model::{Document, FileId, Severity};

fn parse(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    let wrong = problems.iter().find(|p| p.severity() == Severity::Error);
    assert!(wrong.is_none(), "{}: {wrong:?}", text.chars().take(400).collect::<String>());
    document
}

fn picture(text: &str, options: &Options) -> Drawing {
    let document = parse(text);
    let chart = document.charts().next().expect("a chart");
    draw(&document, chart, options)
}

fn items<'a>(d: &'a Drawing, wanted: impl Fn(&Part) -> bool + 'a) -> Vec<&'a Item> {
    d.items.iter().filter(|i| wanted(&i.part)).collect()
}

/// Steps 1 (initial) and 2, one transition with this receptivity.
fn transition(receptivity: &str) -> Item {
    let d = picture(
        &format!("chart G {{ initial step 1 step 2 1 -> 2 when {receptivity} }}"),
        &Options::default(),
    );
    items(&d, |p| matches!(p, Part::Transition { .. }))[0].clone()
}

fn step(declaration: &str) -> Item {
    let d = picture(&format!("chart G {{ {declaration} }}"), &Options::default());
    items(&d, |p| matches!(p, Part::Step { .. }))[0].clone()
}

fn action(declaration: &str, look: Look) -> Item {
    let options = Options { look, ..Options::default() };
    let d = picture(&format!("chart G {{ initial step 2 {{ {declaration} }} }}"), &options);
    items(&d, |p| matches!(p, Part::Action { .. }))[0].clone()
}

fn texts(item: &Item) -> Vec<String> {
    let svg = item.picture.svg();
    let pieces = svg.split("<text").skip(1).filter_map(|p| p.split_once('>')?.1.split_once("</text>"));
    let plain =
        |t: &str| t.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    pieces.map(|(t, _)| plain(t)).collect()
}

/// The text of the receptivity on one line.
fn set(receptivity: &str) -> String {
    texts(&transition(receptivity)).join(" ")
}

/// Left end, right end and height of each overline, in px.
fn overlines(item: &Item) -> Vec<(f64, f64, f64)> {
    let number = |t: &str| t.parse::<f64>().expect("a number");
    let svg = item.picture.svg();
    let lines = svg.split("g7-over\" d=\"M").skip(1).filter_map(|p| p.split('"').next());
    lines
        .map(|d| {
            let (start, right) = d.split_once('H').expect("a horizontal line");
            let (x, y) = start.split_once(' ').expect("a point");
            (number(x), number(right), number(y))
        })
        .collect()
}

fn count(item: &Item, what: &str) -> usize {
    item.picture.svg().matches(what).count()
}

#[test]
fn the_complement_of_a_product_is_one_line_over_all_of_it() {
    let item = transition("not (a and b)");
    assert_eq!(texts(&item), ["a · b"]);
    let [(from, to, y)] = overlines(&item)[..] else { panic!("{}", item.picture.svg()) };
    let Part::Transition { text, .. } = item.part else { panic!("no transition") };
    let (left, right) = (f64::from(text.x) / 10.0, f64::from(text.x + text.w) / 10.0);
    assert!((from - left).abs() < 1.0 && (to - right).abs() < 1.0, "{from}..{to} over {left}..{right}");
    assert!(y >= f64::from(item.area.y) / 10.0, "inside the area of its item");
}

#[test]
fn a_complement_covers_only_what_is_complemented() {
    let item = transition("a · not b");
    let Part::Transition { text, .. } = item.part else { panic!("no transition") };
    let [(from, to, _)] = overlines(&item)[..] else { panic!("{}", item.picture.svg()) };
    let (left, right) = (f64::from(text.x) / 10.0, f64::from(text.x + text.w) / 10.0);
    assert!(from > left + 8.0 && (to - right).abs() < 1.0, "only b: {from}..{to} in {left}..{right}");
}

#[test]
fn nested_complements_stand_at_different_heights() {
    let lines = overlines(&transition("not (a + not b)"));
    let [inner, outer] = lines[..] else { panic!("{lines:?}") };
    assert!(outer.2 < inner.2 - 2.0, "the outer one is higher");
    assert!(outer.0 <= inner.0 && outer.1 >= inner.1, "and longer");
    let twice = overlines(&transition("not not a"));
    assert!(twice.len() == 2 && (twice[0].2 - twice[1].2).abs() > 2.0, "{twice:?}");
}

#[test]
fn receptivities_read_as_grafcet_writes_them() {
    let cases = [
        ("TRUE", "1"),
        ("=1", "1"),
        ("FALSE", "0"),
        ("a and b or c", "a · b + c"),
        ("a and (b or c)", "a · (b + c)"),
        ("(a or b) and (c or d)", "(a + b) · (c + d)"),
        ("a xor b", "a ⊕ b"),
        ("rise(a) and fall(b)", "↑a · ↓b"),
        ("↑(a · b)", "↑(a · b)"),
        ("p > 3", "[p > 3]"),
        ("p >= 3 and q <> 4", "[p ≥ 3] · [q ≠ 4]"),
        ("p + 1 <= 2 * q", "[p + 1 ≤ 2 · q]"),
        ("p - (q - 1) = 0", "[p − (q − 1) = 0]"),
        ("3s/X2", "3s/X2"),
        ("3s/X2/1s", "3s/X2/1s"),
        ("500ms/(a · b)", "500ms/(a · b)"),
        ("delay(2s, a)", "2s/a"),
        ("%I0.1", "%I0.1"),
        ("Full(3, n := 4)", "Full(3, n := 4)"),
        ("s = 'a<b'", "[s = 'a<b']"),
    ];
    for (written, shown) in cases {
        assert_eq!(set(written), shown, "{written}");
    }
}

#[test]
fn the_complement_of_an_edge_and_the_edge_of_a_complement_differ() {
    let [of_edge, of_name] = ["not ↑a", "↑(not a)"].map(|t| {
        let item = transition(t);
        assert_eq!(texts(&item), ["↑a"]);
        overlines(&item)[0].0
    });
    assert!(of_name > of_edge + 4.0, "the arrow is under the line, or not");
}

#[test]
fn a_long_receptivity_goes_on_in_the_next_line() {
    let names: Vec<String> = (0..30).map(|i| format!("sensor{i}")).collect();
    let item = transition(&names.join(" or "));
    let shown = texts(&item);
    assert!(shown.len() > 2, "{shown:?}");
    assert!(shown[1..].iter().all(|l| l.starts_with("+ ")), "{shown:?}");
    assert_eq!(shown.join(" "), names.join(" + "));
    assert!(item.area.w < 4500, "{:?}", item.area);
}

#[test]
fn steps_show_what_they_are() {
    let rects = |declaration: &str| count(&step(declaration), "<rect");
    assert_eq!(rects("step 1"), 1);
    assert_eq!(rects("initial step 1"), 2, "a double square");
    let inner = |declaration: &str| count(&step(declaration), "<path class=\"g7-inner\"");
    assert_eq!(inner("step 1"), 0);
    assert_eq!(inner("macro M3 = M3"), 2, "two lines");
    assert_eq!(inner("enclosing step 1"), 4, "four cut corners");
    assert_eq!(texts(&step("step 5*")), ["5", "*"]);
    assert_eq!(texts(&step("macro M3 = Dose")), ["M3", "= Dose"]);
    assert_eq!(texts(&step("step 5 \"wait\"")), ["5", "“wait”"]);
}

#[test]
fn a_long_name_stays_in_its_square() {
    for name in
        ["Filling", "WaitForBead", "`Vent på start`", "a_very_long_name_of_a_step", "Unzerbrechlichkeit"]
    {
        let item = step(&format!("step {name}"));
        let Part::Step { square, .. } = item.part else { panic!("no step") };
        assert!(item.area.x >= square.x && item.area.w == square.w, "{name}: {:?} {square:?}", item.area);
        assert_eq!(square.h, 500);
        let letters: String = texts(&item).concat();
        assert_eq!(letters.replace(' ', ""), name.replace(['`', ' '], ""), "nothing is lost");
    }
}

#[test]
fn actions_show_when_they_act() {
    let text = |a: &str| texts(&action(a, Look::Iec60848)).join("|");
    assert_eq!(text("N motor"), "motor");
    assert_eq!(text("N motor if a and b"), "motor|a · b");
    assert_eq!(text("D 3s motor"), "motor|3s/X2");
    let limited = action("L 3s motor", Look::Iec60848);
    assert_eq!(texts(&limited), ["motor", "3s/X2"]);
    assert_eq!(overlines(&limited).len(), 1, "until then: the complement of the delay");
    assert_eq!(text("S motor"), "motor := 1");
    assert_eq!(text("R motor"), "motor := 0");
    assert_eq!(text("P1 n := n + 1"), "n := n + 1");
    assert_eq!(text("on ↑a: n := 0"), "n := 0|↑a");
    assert_eq!(text("SL 2s motor"), "SL 2s|motor");
    assert_eq!(text("call Wash"), "Wash");
}

#[test]
fn stored_actions_have_an_arrow_up_or_down() {
    let tip = |a: &str| {
        let item = action(a, Look::Iec60848);
        let svg = item.picture.svg();
        let d = svg.split("g7-mark\" d=\"M").nth(1).and_then(|p| p.split(['L', 'H']).next());
        let y: f64 = d.and_then(|d| d.split(' ').nth(1)).and_then(|y| y.parse().ok()).expect("an arrow");
        y - f64::from(item.area.y + item.area.h / 2) / 10.0
    };
    assert!(tip("P1 n := 1") < 0.0, "up: on activation");
    assert!(tip("P0 n := 1") > 0.0, "down: on deactivation");
    assert_eq!(count(&action("N motor", Look::Iec60848), "g7-mark"), 0, "none on a continuous action");
}

#[test]
fn orders_stand_in_double_rectangles() {
    let cases = [("INIT", "G1{INIT}"), ("{*}", "G1{*}"), ("{}", "G1{}"), ("{3, 5}", "G1{3, 5}")];
    for (written, shown) in cases {
        let item = action(&format!("force G1 := {written}"), Look::Iec60848);
        assert_eq!(texts(&item), [shown]);
        assert_eq!(count(&item, "<rect"), 2);
    }
    assert_eq!(count(&action("N motor", Look::Iec60848), "<rect"), 1);
}

#[test]
fn the_sfc_look_has_a_box_for_every_qualifier() {
    for (written, q) in [("N motor", "N"), ("S motor", "S"), ("L 2s motor", "L 2s"), ("P1 motor", "P1")] {
        assert_eq!(
            texts(&action(written, Look::Sfc)),
            ["motor", q].map(str::to_owned).to_vec().into_iter().rev().collect::<Vec<_>>()
        );
    }
}

#[test]
fn a_long_body_is_cut_and_told_in_full_by_its_title() {
    let body: String = (0..20).map(|i| format!("v{i} := {i};")).collect();
    let item = action(&format!("P1 {{ {body} }}"), Look::Iec60848);
    let shown = texts(&item);
    assert!(shown.len() <= 6 && shown.last().is_some_and(|l| l == "…"), "{shown:?}");
    let svg = item.picture.svg();
    let title = svg.split("<title>").nth(1).and_then(|t| t.split("</title>").next()).expect("a title");
    assert!(title.contains("v19 := 19"), "{title}");
}

#[test]
fn priorities_and_names_of_transitions_are_left_of_the_link() {
    let d = picture(
        "chart G { initial step 1 step 2 step 3 t7: 1 -> 2 when a priority 1 1 -> 3 when b }",
        &Options::default(),
    );
    let t = items(&d, |p| matches!(p, Part::Transition { transition: 0, .. }))[0];
    assert_eq!(texts(t), ["a", "(t7)", "1"]);
    assert_eq!(count(t, "<circle"), 1);
    let Part::Transition { bar, .. } = t.part else { panic!("no transition") };
    assert!(t.area.x < bar.x);
}

#[test]
fn a_chart_without_actions_keeps_its_steps() {
    let text = "chart G { initial step 1 { N a } step 2 { N b } 1 -> 2 when c }";
    let bare = picture(text, &Options { actions: false, ..Options::default() });
    assert_eq!(items(&bare, |p| matches!(p, Part::Action { .. })).len(), 0);
    assert_eq!(items(&bare, |p| matches!(p, Part::Step { .. })).len(), 2);
    assert_eq!(items(&picture(text, &Options::default()), |p| matches!(p, Part::Action { .. })).len(), 2);
}

#[test]
fn every_item_is_inside_the_drawing_and_knows_its_text() {
    let text = "chart G { initial step 1 { N a if b P1 n := 1 } step 2 1 -> 2 when c 2 -> 1 when not c }";
    let d = picture(text, &Options::default());
    for item in &d.items {
        let Rect { x, y, w, h } = item.area;
        let all = d.area;
        assert!(x >= all.x && y >= all.y && x + w <= all.x + all.w && y + h <= all.y + all.h, "{item:?}");
        assert!(item.at.end > item.at.start, "{item:?}");
    }
}

#[test]
fn no_chart_is_too_odd_to_be_drawn() {
    let long = "a".repeat(50_000);
    let seams = "aB".repeat(50_000);
    let words = "x ".repeat(100_000);
    let args = vec!["a"; 50_000].join(", ");
    let sum = vec!["not a"; 200].join(" or ");
    let deep = format!("{}a{}", "not (".repeat(100), ")".repeat(100));
    let body: String = (0..3000).map(|i| format!("v{i} := {sum};")).take(50).collect();
    let odd = "`\u{202e}مرحبا 🦀 e\u{301}\u{0301} \u{200d}`";
    let text = format!(
        "chart G \"{words}\" {{
           initial step {long} \"{words}\" {{ N {long} if {sum} P1 {{ {body} }} \"{words}\" }}
           step {seams}
           step {odd} {{ force {odd} := {{{long}, {seams}}} }}
           {long} -> {seams} when f({args}) priority 4294967295 \"{words}\" on clearing {{ {body} }}
           {seams} -> {odd} when {deep} + {sum}
           () -> {odd} when a
           {odd} -> () when b
         }}"
    );
    for options in [Options::default(), Options { look: Look::Sfc, pages: true, ..Options::default() }] {
        let d = picture(&text, &options);
        assert_eq!(items(&d, |p| matches!(p, Part::Step { .. })).len(), 3);
        assert!(d.area.w < 60_000 && d.area.h < 60_000, "{:?}", d.area);
    }
}

#[test]
fn comments_of_the_layout_stand_at_their_places_in_quotes() {
    let d = picture(
        "chart G { initial step 1 }\nlayout G { comment \"one\" at (10, 2) step 1 at (0, 0) comment \"two\" at (10, 8) }\n",
        &Options::default(),
    );
    let found = items(&d, |p| matches!(p, Part::Comment { .. }));
    let numbers: Vec<u32> = found
        .iter()
        .filter_map(|i| if let Part::Comment { comment, .. } = i.part { Some(comment) } else { None })
        .collect();
    assert_eq!(numbers, [0, 1], "numbered among the comments");
    assert_eq!((found[0].area.x, found[0].area.y), (1000, 200), "the upper left corner");
    assert_eq!((found[1].area.x, found[1].area.y), (1000, 800));
    assert_eq!(texts(found[1]), ["“two”"]);
    assert!(d.area.x + d.area.w >= found[1].area.x + found[1].area.w, "the drawing covers them");
}

#[test]
fn receptivities_side_by_side_are_set_narrower_than_one_alone() {
    let long = "[count_of_parts > 10] and ready and not empty and [level < 20]";
    let condition = long.replace('[', "(").replace(']', ")");
    let widths = |branches: usize| {
        let mut text = String::from("chart G { initial step 0 ");
        for n in 1..=branches {
            text.push_str(&format!("step {n} 0 -> {n} when {condition} "));
        }
        text.push('}');
        let d = picture(&text, &Options::default());
        let found = items(&d, |p| matches!(p, Part::Transition { .. }));
        found.iter().map(|i| i.area.w).max().unwrap_or(0)
    };
    let (one, two, three) = (widths(1), widths(2), widths(3));
    assert!(three < two && two < one, "{one} {two} {three}");
}

/// The actions of a step of this text, by their boxes and pictures.
fn side_by_side(actions: &str, layout: &str, look: Look) -> (Drawing, Vec<Item>) {
    let options = Options { look, ..Options::default() };
    let text = format!("chart G {{ initial step 2 {{ {actions} }} }} layout G {{ {layout} }}");
    let d = picture(&text, &options);
    let mut found: Vec<Item> = items(&d, |p| matches!(p, Part::Action { .. })).into_iter().cloned().collect();
    found.sort_by_key(|i| if let Part::Action { index, .. } = i.part { index } else { 0 });
    (d, found)
}

#[test]
fn actions_in_a_row_touch_each_other_and_have_one_height() {
    let actions = "N a; N b if c_long_condition and another_one; on ↑e: { x := 1 }";
    for look in [Look::Iec60848, Look::Sfc] {
        let (_, row) = side_by_side(actions, "actions in row", look);
        assert_eq!(row.len(), 3);
        for pair in row.windows(2) {
            let rect = |i: &Item| frame(i);
            let ([ax, ay, aw, ah], [bx, by, _, bh]) = (rect(&pair[0]), rect(&pair[1]));
            assert!((ax + aw - bx).abs() < 0.01, "the rectangles touch");
            assert_eq!((ay, ah), (by, bh), "they have one height");
            // A condition stands over its own rectangle, so the pictures do not overlap.
            let (a, b) = (pair[0].area, pair[1].area);
            assert!(a.x + a.w <= b.x + 1, "{a:?} {b:?}");
        }
        // One line joins them to the step: that of the first action.
        let edge = 25.0;
        assert!(frame(&row[0])[0] > edge && row[0].area.x <= 250, "{:?}", row[0].area);
        let (_, column) = side_by_side(actions, "", look);
        assert!(column.windows(2).all(|p| frame(&p[0])[1] < frame(&p[1])[1]), "a column goes down");
    }
}

#[test]
fn a_step_has_a_form_of_its_own() {
    let below = |layout: &str| {
        let (_, found) = side_by_side("N a; N b", layout, Look::Iec60848);
        frame(&found[1])[1] > frame(&found[0])[1]
    };
    assert!(below(""));
    assert!(below("actions in column"));
    assert!(!below("actions in row"));
    assert!(!below("actions of step 2 in row"));
    assert!(below("actions in row actions of step 2 in column"));
    assert!(below("actions of step 9 in row"));
}

#[test]
fn comments_among_actions_stand_behind_the_row() {
    let (_, found) = side_by_side("\"first of all\"; N a; N b", "actions in row", Look::Iec60848);
    let right = found[1..].iter().map(|i| i.area.x + i.area.w).max().expect("actions");
    assert!(found[0].area.x >= right, "{:?}", found[0].area);
}

/// Left edge, upper edge, width and height of the rectangle of an action, in px.
fn frame(item: &Item) -> [f64; 4] {
    let svg = item.picture.svg();
    let tag = svg.split('<').find(|t| t.starts_with("rect") && t.contains("g7-action")).expect("a rectangle");
    ["x", "y", "width", "height"].map(|name| {
        let value = tag.split(&format!(" {name}=\"")).nth(1).expect(name);
        value.split('"').next().expect(name).parse().expect("a number")
    })
}
