//! A sound instance means what the .g7 file beside it says.

use crate::support;
use crate::support::recognise;
use crate::xmi::show::{bytes, import, read};

#[test]
fn a_sound_instance_says_what_the_text_beside_it_says() {
    let file = bytes("mixer.grafcet");
    assert_eq!(recognise("", &file), Some("xmi"));
    let (document, problems) = import(&file);
    assert_eq!(problems, []);
    let text = String::from_utf8(bytes("mixer.g7")).expect("UTF-8");
    let wanted = read(&text);
    // As texts, so that a difference is read.
    assert_eq!(g7_syntax::print(&document, None), g7_syntax::print(&wanted, None));
    // The order in which a chart's items stand is the file's, by their sorts.
    assert_eq!(document.charts().count(), wanted.charts().count());
    assert_eq!(read(&g7_syntax::print(&document, None)), document);
}

#[test]
fn it_is_written_and_read_again() {
    let (document, _) = import(&bytes("mixer.grafcet"));
    let written = support::export("xmi", &document);
    assert_eq!(written.problems, []);
    assert_eq!(recognise("", written.text.as_bytes()), Some("xmi"));
    let (back, problems) = import(written.text.as_bytes());
    assert_eq!(problems, []);
    assert_eq!(g7_syntax::print(&back, None), g7_syntax::print(&document, None));
    assert_eq!(back, document);
}

/// The generator of the same project hands both times to one block, whatever the type.
#[test]
fn a_delay_with_a_reset_time_is_one_with_two_times() {
    let file = r#"<g:Grafcet xmlns:g="g" xmlns:xsi="x" xmlns:terms="t"><partialGrafcets>
        <transitions delayTime="4" resetTime="2" timeConditionType="timeDelayed">
        <term xsi:type="terms:BooleanConstant" value="true"/></transitions></partialGrafcets></g:Grafcet>"#;
    let (document, _) = import(file.as_bytes());
    let text = g7_syntax::print(&document, None);
    assert!(text.contains("() -> () when 4s/(TRUE)/2s"), "{text}");
    // A chart without a name has the one that the meta-model gives it.
    assert!(text.contains("chart GRAFCETChart"), "{text}");
}
