//! Files made to break the reader.

use crate::support::hostile::{changed, refused, survives};
use crate::support::own;

const FORMAT: &str = "controlexpert";

#[test]
fn what_is_no_chart_is_refused_with_words() {
    assert_eq!(refused(FORMAT, b"<SFCExchangeFile/>"), ["G0602"]);
    assert_eq!(refused(FORMAT, b"<SFCExchangeFile>"), ["G0601"]);
    let bomb =
        r#"<!DOCTYPE l [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><SFCExchangeFile>&b;</SFCExchangeFile>"#;
    assert_eq!(refused(FORMAT, bomb.as_bytes()), ["G0601"]);
    let deep = format!("{}{}", "<SFCExchangeFile>".repeat(100_000), "</SFCExchangeFile>".repeat(100_000));
    assert_eq!(refused(FORMAT, deep.as_bytes()), ["G0007"]);
    assert_eq!(refused(FORMAT, &vec![b'<'; 10 << 20]), ["G0008"]);
    assert_eq!(refused(FORMAT, b"<SFCExchangeFile a='\xE9'/>"), ["G0001"]);
}

#[test]
fn wide_and_long_charts_come_to_an_end() {
    let bars = "<altBranch width=\"1000\"/><parJoint width=\"1000\"/>".repeat(3000);
    let steps = "<step stepName=\"S\"/><transition/>".repeat(20_000);
    let chart = format!(
        "<SFCExchangeFile><SFCProgram><chartSource><networkSFC>{bars}{steps}</networkSFC></chartSource></SFCProgram></SFCExchangeFile>"
    );
    let (_, problems) = survives(FORMAT, chart.as_bytes());
    assert!(problems.iter().any(|p| p.code.id == "G0008"));
    // A structure within itself.
    let data = "<SFCExchangeFile><SFCProgram><chartSource><networkSFC/></chartSource></SFCProgram><DDTSource DDTName=\"T\">\
                <structure><variables name=\"a\" typeName=\"T\"/><variables name=\"b\" typeName=\"T\"/></structure></DDTSource>\
                <dataBlock><variables name=\"x\" typeName=\"T\"/></dataBlock></SFCExchangeFile>";
    let (_, problems) = survives(FORMAT, data.as_bytes());
    assert!(problems.iter().any(|p| p.code.id == "G0008"), "{problems:?}");
}

#[test]
fn a_changed_file_never_panics() {
    let files = ["mixer.xef", "cell.xsf", "wrong.xsf"].map(|f| own("controlexpert", f));
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
        "<step/>",
        "<SFCProgram>",
        "posX=\"7\"",
        "width=\"999999999\"",
        "re(",
        "set (",
    ];
    changed(FORMAT, files.to_vec(), &words, 300);
}
