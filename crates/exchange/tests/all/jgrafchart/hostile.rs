//! Files made to break a reader: it ends soon, with words, never with a panic.

use crate::support;
use crate::support::recognise;
use g7_model::{Document, FileId, Problem};
use proptest::prelude::*;

use crate::jgrafchart::show::bytes;
use crate::support::hostile::{changed_for, within};

const FILES: [&str; 12] = [
    "bead-sorter.xml",
    "exceptions.xml",
    "fusion.xml",
    "lines.xml",
    "nested.xml",
    "not-carried.xml",
    "outside.xml",
    "procedures.xml",
    "texts.xml",
    "ways-out.xml",
    "workspaces.xml",
    "wrong.xml",
];

fn read(file: &[u8]) -> (Document, Vec<Problem>) {
    recognise("", file);
    let (document, problems) = support::import("jgrafchart", file, FileId(0));
    for p in &problems {
        assert!(p.at.start <= p.at.end, "{p:?}");
        assert!(p.at.end as usize <= file.len().max(1), "{p:?}");
    }
    (document, problems)
}

fn import(file: &[u8]) -> (Document, Vec<Problem>) {
    let (document, problems) = read(file);
    // The written form is well-formed, and soon there.
    let written = support::export("jgrafchart", &document);
    let (_, again) = support::import("jgrafchart", written.text.as_bytes(), FileId(1));
    assert!(again.iter().all(|p| p.code.id != "G0601"), "{again:?}");
    (document, problems)
}

/// The codes of a file that gives no chart, within a time that no bound lets pass.
fn refused(file: &[u8]) -> Vec<&'static str> {
    let (document, problems) = within(20, || import(file));
    assert_eq!(document.charts().count(), 0);
    problems.iter().map(|p| p.code.id).collect()
}

#[test]
fn entities_are_neither_defined_nor_fetched() {
    let bomb = r#"<?xml version="1.0"?><!DOCTYPE l [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>
        <GCDocument name="&b;"/>"#;
    assert_eq!(refused(bomb.as_bytes()), ["G0601"]);
    let fetch = r#"<!DOCTYPE x SYSTEM "file:///etc/passwd"><GCDocument/>"#;
    assert_eq!(refused(fetch.as_bytes()), ["G0601"]);
    assert_eq!(refused(br#"<GCDocument name="&who;"/>"#), ["G0601"]);
}

#[test]
fn encodings_other_than_utf_8_are_named() {
    let text = "<?xml version=\"1.0\" encoding=\"UTF-16\"?><GCDocument name=\"J1\"/>";
    let wide = |join: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(join).collect::<Vec<u8>>();
    for body in [wide(u16::to_le_bytes), wide(u16::to_be_bytes)] {
        assert_eq!(recognise("", &body), Some("jgrafchart"));
        let (_, problems) = import(&body);
        assert_eq!(
            problems.iter().map(|p| &*p.what).collect::<Vec<_>>(),
            ["the file is UTF-16; save it as UTF-8"]
        );
    }
    let mut marked = vec![0xFF, 0xFE];
    marked.extend(wide(u16::to_le_bytes));
    assert_eq!(recognise("", &marked), Some("jgrafchart"));
    assert_eq!(refused(&marked), ["G0001"]);
    let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><GCDocument name=\"\xE5\"/>";
    let (_, problems) = import(latin);
    assert_eq!(problems[0].code.id, "G0001");
    assert!(problems[0].what.contains("ISO-8859-1"), "{}", problems[0].what);
    // The same without a letter beyond ASCII is UTF-8 as well.
    let (document, _) = import(b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><GCDocument name=\"J1\"/>");
    assert_eq!(document.charts().count(), 1);
    // With a mark of UTF-8, places count the mark.
    let (document, problems) = import(b"\xEF\xBB\xBF<GCDocument name=\"J1\"/>");
    assert_eq!((document.charts().count(), problems.len()), (1, 0));
}

#[test]
fn depth_and_size_are_bounded() {
    let deep = format!("{}{}", "<GCDocument>".repeat(100_000), "</GCDocument>".repeat(100_000));
    assert_eq!(refused(deep.as_bytes()), ["G0007"]);
    let macros = "<MacroStep><GCDocument>".repeat(49) + &"</GCDocument></MacroStep>".repeat(49);
    let (document, _) = import(format!("<GCDocument>{macros}</GCDocument>").as_bytes());
    assert_eq!(document.charts().count(), 50);
    assert_eq!(refused(&vec![b'<'; 7 << 20]), ["G0007"]);
    assert_eq!(refused(&vec![b'<'; 10 << 20]), ["G0008"]);
    assert_eq!(refused(&vec![0; 1 << 20]), ["G0601"]);
    let wide: String = (0..100_000).map(|n| format!(" a{n}=''")).collect();
    assert_eq!(refused(format!("<GCDocument{wide}/>").as_bytes()), ["G0008"]);
    let many = format!("<GCDocument>{}</GCDocument>", "<a/>".repeat(900_000));
    assert_eq!(refused(many.as_bytes()), ["G0008"]);
}

#[test]
fn work_is_bounded_too() {
    within(60, heavy_files);
}

fn heavy_files() {
    // A chain of joins with a transition at each: every walk goes back to its start.
    let mut joins = String::from("<GCDocument><GCStep id='s'/>");
    for n in 0..8000 {
        joins += &format!("<ParallelJoin id='j{n}'/><GCTransition id='t{n}' actionText='1'/>");
    }
    for n in 1..8000 {
        joins += &format!(
            "<GCLink fromObject='j{}' toObject='j{n}L'/><GCLink fromObject='j{n}' toObject='t{n}'/>",
            n - 1
        );
    }
    let (_, problems) = read((joins + "</GCDocument>").as_bytes());
    assert!(problems.iter().any(|p| p.code.id == "G0008"));
    // Long chains and deep brackets in a text.
    for text in [
        "a|".repeat(20_000) + "a",
        "(".repeat(60_000),
        "!".repeat(60_000) + "a",
        "/".repeat(60_000),
        "a.".repeat(30_000) + "a",
        "a?".repeat(30_000),
        "a".repeat(70_000),
    ] {
        let file = format!("<GCDocument><GCTransition id='t' actionText='{text}'/></GCDocument>");
        let (_, problems) = read(file.as_bytes());
        assert!(problems.iter().any(|p| matches!(p.code.id, "G0606" | "G0008")), "{}", &text[..20]);
    }
    // More actions than anyone writes, many steps of one name.
    let step = format!("<GCStep name='x' actionText='{}'/>", "S a=1;".repeat(10_000));
    let (_, problems) =
        read(format!("<GCDocument><IntegerVariable name='a'/>{}</GCDocument>", step.repeat(100)).as_bytes());
    assert!(problems.iter().any(|p| p.code.id == "G0008"));
    let names = "<GCStep name='x'/>".repeat(50_000);
    let (document, problems) = read(format!("<GCDocument>{names}</GCDocument>").as_bytes());
    assert_eq!(document.charts().map(|c| c.steps().count()).sum::<usize>(), 50_000);
    assert!(problems.iter().any(|p| p.code.id == "G0010"));
}

/// Put into files besides bytes and pieces of their own.
const WORDS: &[&str] = &[
    "<",
    ">",
    "/>",
    "\"",
    "&",
    "&#0;",
    "&#10;",
    "<!--",
    "<![CDATA[",
    "]]>",
    "<?",
    "&#x10FFFF;",
    "é",
    "\u{202e}",
    "<GCDocument>",
    "</GCDocument>",
    "<GCGroup>",
    "<MacroStep>",
    "S",
    "S x=",
    "(",
    "!",
    "/",
    "\\",
    "?",
    ":",
    "1e999",
    "99999999999999999999",
    "-",
    ".",
    "`",
    "\0",
];

#[test]
fn a_changed_file_never_panics() {
    changed_for(FILES.map(bytes).to_vec(), WORDS, (400, 12), |file| _ = import(file));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_of_an_action_or_condition_never_panics(text in "[a-zA-Z0-9_.;=!&|<>+*/%()?:\\\\ \n\"'#åø-]{0,80}") {
        let quoted = text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('\n', "&#10;");
        let file = format!(
            "<GCDocument><IntegerVariable name=\"a\"/><RealVariable name=\"b\"/><StringVariable name=\"c\"/>\
             <GCStep name=\"s\" actionText=\"S {quoted}\"/><GCTransition actionText=\"{quoted}\"/></GCDocument>"
        );
        import(file.as_bytes());
    }

    #[test]
    fn any_bytes_never_panic(file in prop::collection::vec(any::<u8>(), 0..300)) {
        import(&file);
    }
}

/// The codes of a workspace, found within a time that no bound lets pass.
fn codes(body: &str) -> Vec<&'static str> {
    let file = format!("<GCDocument name='J' saveVersion='8'>{body}</GCDocument>");
    let (_, problems) = within(60, || import(file.as_bytes()));
    problems.iter().map(|p| p.code.id).collect()
}

#[test]
fn procedures_that_call_each_other_end() {
    let call = |n: usize, of: usize| {
        format!(
            "<ProcedureStep id='c{n}' name='c{n}' grafcetProcedure='p{of}' parameters='R v = v;' actionText=''/>"
        )
    };
    let procedure = |n: usize, body: &str| {
        format!(
            "<GrafcetProcedure name='p{n}'><GCDocument><IntegerVariable name='v' initialValue='0'/>\
             <EnterStep id='e' name='e'/>{body}</GCDocument></GrafcetProcedure>"
        )
    };
    // One that calls itself, by another.
    let circle = format!("{}{}{}", procedure(0, &call(0, 1)), procedure(1, &call(0, 0)), call(9, 0));
    assert!(codes(&circle).contains(&"G0604"));
    // Each calls the next one ten times: without a bound, 10^12 copies.
    let mut tower: String =
        (0..12).map(|n| procedure(n, &(0..10).map(|c| call(c, n + 1)).collect::<String>())).collect();
    tower += &procedure(12, "");
    tower += &call(9, 0);
    assert!(codes(&tower).contains(&"G0008"));
    // A long chain of references.
    let mut chain: String = (0..200).map(|n| procedure(n, &call(0, n + 1))).collect();
    chain += &procedure(200, "<GCStep id='s' name='s' actionText='S v = 1;'/>");
    chain += "<IntegerVariable name='v' initialValue='0'/>";
    chain += &call(9, 0);
    codes(&chain);
}

#[test]
fn hundreds_of_exceptions_and_fusions_are_soon_read_and_written() {
    let mut body = String::new();
    for n in 0..300 {
        body += &format!(
            "<MacroStep id='m{n}' name='m' actionText='A v = 1;'><GCDocument><EnterStep id='e{n}'/></GCDocument></MacroStep>\
             <ExceptionTransition id='x{n}' actionText='1'/><GCLink fromObject='m{n}E' toObject='x{n}'/>\
             <GCLink fromObject='x{n}' toObject='m{n}'/>"
        );
    }
    codes(&body);
    // One exception of many macro-steps, one macro-step with many ways out.
    let many: String = (0..300).map(|n| format!("<GCLink fromObject='m{n}E' toObject='x0'/>")).collect();
    codes(&(body + &many));
    let exits: String = (0..300).map(|n| format!("<ExitStep id='x{n}' x='{n}'/>")).collect();
    let ways: String = (0..300)
        .map(|n| {
            format!("<GCTransition id='t{n}' actionText='1'/><GCLink fromObject='m_{n}' toObject='t{n}'/>")
        })
        .collect();
    codes(&format!(
        "<MacroStep id='m'><GCDocument><EnterStep id='e'/>{exits}</GCDocument></MacroStep>{ways}"
    ));
    let steps: String = (0..1000).map(|n| format!("<GCStep id='s{n}' name='s{n}'/>")).collect();
    let texts: String = (0..1000).map(|n| format!("<FreeText text='s{n}'/>")).collect();
    let set = format!("<StepFusionSet><GCDocument>{texts}</GCDocument></StepFusionSet>");
    assert!(codes(&format!("{steps}{set}{set}")).contains(&"G0604"));
}

#[test]
fn texts_of_any_sort_go_out() {
    for text in ["&#10;", "a&#9;b", "\u{FFFD}", "&quot;&lt;&amp;", "`\\"] {
        let body = format!(
            "<FreeText text='{text}'/><StringVariable name='s' initialValue='{text}'/>\
             <GCInitialStep id='a' name='{text}' actionText='S s = &quot;x&quot;;'/>"
        );
        assert!(!codes(&body).contains(&"G0601"), "{text}");
    }
}
