//! TwinCAT 3: a POU in a file of its own (`.TcPOU`), its text in CDATA.

use g7_model::{Problem, Span};

use super::rewrite::{self, Refused};
use crate::plc::form::Block;
use crate::plc::st;

/// The file.
///
/// # Errors
///
/// Parts that TwinCAT cannot say, at `place`.
pub(crate) fn print(e: &Block, place: Span) -> Result<String, Vec<Problem>> {
    let mut refused = Refused::default();
    let own = rewrite::block(e, &mut |e| rewrite::timed(e, &mut refused));
    refused.problems(place)?;
    let head = st::declarations(&own);
    // The attributes are letters, digits and signs that need no escape.
    Ok(format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<TcPlcObject Version=\"1.1.0.1\" ProductVersion=\"3.1.4024.0\">\n  \
         <POU Name=\"{name}\" Id=\"{{{id}}}\" SpecialFunc=\"None\">\n    \
         <Declaration><![CDATA[{head}]]></Declaration>\n    <Implementation>\n      \
         <ST><![CDATA[{body}]]></ST>\n    </Implementation>\n  </POU>\n</TcPlcObject>\n",
        name = e.name,
        id = identity(&e.name),
        head = whole(head.trim_end()),
        body = whole(&st::body(&own, "FAULT")),
    ))
}

/// A text in CDATA cannot hold its end: it is begun anew within it.
fn whole(text: &str) -> String {
    text.replace("]]>", "]]]]><![CDATA[>")
}

/// The identity of an object: the same for the same name, so that a file that is printed anew replaces itself.
fn identity(name: &str) -> String {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    // FNV-1a with 128 bits.
    let sum = name.bytes().fold(BASIS, |sum, byte| (sum ^ u128::from(byte)).wrapping_mul(PRIME));
    // Version 8 of RFC 9562: made in a way of one's own.
    let sum = sum & !(0xF000 << 64) & !(0xC << 60) | (0x8000 << 64) | (0x8 << 60);
    let hex = format!("{sum:032x}");
    let part = |from: usize, to: usize| hex.get(from..to).unwrap_or("").to_owned();
    [part(0, 8), part(8, 12), part(12, 16), part(16, 20), part(20, 32)].join("-")
}
