//! Files made to break the reader.

use crate::support::hostile::{changed, refused, survives};
use crate::support::own;

const FORMAT: &str = "s7graph";

#[test]
fn what_is_no_chart_is_refused_with_words() {
    assert_eq!(refused(FORMAT, b"<Document><Engineering version='V17'/></Document>"), ["G0602"]);
    assert_eq!(refused(FORMAT, b"<Document>"), ["G0601"]);
    let bomb = r#"<!DOCTYPE l [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><Document>&b;</Document>"#;
    assert_eq!(refused(FORMAT, bomb.as_bytes()), ["G0601"]);
    let deep = format!("{}{}", "<Document>".repeat(100_000), "</Document>".repeat(100_000));
    assert_eq!(refused(FORMAT, deep.as_bytes()), ["G0007"]);
    assert_eq!(refused(FORMAT, &vec![b'<'; 10 << 20]), ["G0008"]);
    assert_eq!(refused(FORMAT, b"<Document a='\xE9'/>"), ["G0001"]);
}

#[test]
fn networks_in_circles_come_to_an_end() {
    // Each box has both inputs from the one before it: written out, 2 to the 60.
    let mut parts = String::new();
    let mut wires = String::new();
    for n in 1..60 {
        parts += &format!("<Part Name='A' UId='{n}'/>");
        wires += &format!(
            "<Wire><NameCon UId='{}' Name='out'/><NameCon UId='{n}' Name='in1'/><NameCon UId='{n}' Name='in2'/></Wire>",
            n - 1
        );
    }
    let circle = "<Part Name='A' UId='0'/><Part Name='TrCoil' UId='99'/>";
    let ends = "<Wire><NameCon UId='59' Name='out'/><NameCon UId='99' Name='in'/><NameCon UId='0' Name='in1'/></Wire>";
    let file = format!(
        "<Document><SW.Blocks.FB><Graph><Sequence><Steps><Step Number='1'/></Steps><Transitions><Transition Number='1'>\
         <FlgNet><Parts>{parts}{circle}</Parts><Wires>{wires}{ends}</Wires></FlgNet></Transition></Transitions></Sequence></Graph></SW.Blocks.FB></Document>"
    );
    let (_, problems) = survives(FORMAT, file.as_bytes());
    assert!(problems.iter().any(|p| matches!(p.code.id, "G0007" | "G0008")), "{problems:?}");
}

#[test]
fn a_changed_file_never_panics() {
    let files = ["press.xml", "wrong.xml"].map(|f| own("s7graph", f));
    let words = [
        "<",
        ">",
        "/>",
        "\"",
        "&",
        "&#0;",
        "<!--",
        "<![CDATA[",
        "]]>",
        "<?",
        "é",
        "\u{202e}",
        "(",
        ":=",
        "IF ",
        ";",
        "99999999999999999999",
        "-",
        ".",
        "`",
        "\0",
        "<Graph/>",
        "<Step/>",
        "UId=\"21\"",
        "<NameCon UId=\"25\" Name=\"out\"/>",
        "Name=\"in1\"",
    ];
    changed(FORMAT, files.to_vec(), &words, 300);
}
