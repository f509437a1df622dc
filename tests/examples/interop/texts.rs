//! Text of IEC 61131-3: matiec compiles it, IronPLC checks it.

use g7_codegen::plc;
use g7_peers::ironplc;

use crate::charts::Chart;
use crate::table::{Table, Written, taken};

/// Writes a chart, or nothing where it cannot be asked.
type Write = fn(&Chart) -> Option<Written>;

pub(crate) fn rows(table: &mut Table<'_>) {
    let forms: [(&str, Write); 3] = [
        ("SFC text", sfc),
        ("flat ST", |chart| flat(chart, plc::Form::St)),
        ("IL", |chart| flat(chart, plc::Form::Il)),
    ];
    for (name, write) in forms {
        if let Some(matiec) = table.matiec.clone() {
            let written = |chart: &Chart| Some(write(chart)?.map_err(|why| format!("{name}, {why}")));
            table.tries(&format!("matiec on {name}"), written, |table, text| table.compiles(&matiec, text));
        }
    }
    // IronPLC reads no Instruction List.
    let Some(ironplc) = ironplc::find() else { return };
    for (name, write) in &forms[..2] {
        let written = |chart: &Chart| write(chart)?.ok().map(Ok);
        table.tries(&format!("IronPLC on {name}"), written, |table, text| {
            ironplc.checks(&table.file("checked.st", text))
        });
    }
}

fn sfc(chart: &Chart) -> Option<Written> {
    let written = g7_exchange::named("sfc")?.write(&chart.document)?;
    Some(taken(written.text, &written.problems))
}

fn flat(chart: &Chart, form: plc::Form) -> Option<Written> {
    Some(match plc::print(chart.compiled.as_ref()?, form, "chart", "") {
        Ok(printed) => Ok(printed.text),
        Err(lost) => taken(String::new(), &lost),
    })
}
