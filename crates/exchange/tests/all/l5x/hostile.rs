//! Files made to break the reader.

use crate::support::hostile::{changed, refused, survives};
use crate::support::own;

const FORMAT: &str = "l5x";

#[test]
fn what_is_no_chart_is_refused_with_words() {
    assert_eq!(refused(FORMAT, b"<RSLogix5000Content/>"), ["G0602"]);
    assert_eq!(refused(FORMAT, b"<RSLogix5000Content>"), ["G0601"]);
    let bomb = r#"<!DOCTYPE l [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><RSLogix5000Content>&b;</RSLogix5000Content>"#;
    assert_eq!(refused(FORMAT, bomb.as_bytes()), ["G0601"]);
    let deep =
        format!("{}{}", "<RSLogix5000Content>".repeat(100_000), "</RSLogix5000Content>".repeat(100_000));
    assert_eq!(refused(FORMAT, deep.as_bytes()), ["G0007"]);
    assert_eq!(refused(FORMAT, &vec![b'<'; 10 << 20]), ["G0008"]);
    assert_eq!(refused(FORMAT, b"<RSLogix5000Content a='\xE9'/>"), ["G0001"]);
}

#[test]
fn aliases_in_circles_come_to_an_end() {
    let file = "<RSLogix5000Content><Controller><Tags><Tag Name='a' TagType='Alias' AliasFor='b'/>\
                <Tag Name='b' TagType='Alias' AliasFor='a'/></Tags><SFCContent><Transition ID='1'><Condition><STContent><Line>a</Line>\
                </STContent></Condition></Transition></SFCContent></Controller></RSLogix5000Content>";
    let (document, _) = survives(FORMAT, file.as_bytes());
    assert_eq!(document.charts().count(), 1);
    let steps = "<Step ID='1'/>".repeat(30_000);
    let file = format!("<RSLogix5000Content><SFCContent>{steps}</SFCContent></RSLogix5000Content>");
    survives(FORMAT, file.as_bytes());
}

#[test]
fn a_changed_file_never_panics() {
    let files = ["filler.L5X", "wrong.L5X"].map(|f| own("l5x", f));
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
        "<SFCContent>",
        "<Step/>",
        "<Line>",
        "ID=\"2\"",
        "[:=]",
        "JSR(",
        "AliasFor=\"Go\"",
    ];
    changed(FORMAT, files.to_vec(), &words, 300);
}
