//! XMI, loaded by pyecore with the meta-model of the corpus.

use std::process::Command;

use crate::table::{Table, taken};

pub(crate) fn rows(table: &mut Table<'_>) {
    let meta = g7_peers::corpus("agrafe-metamodel/Project-AGRAFE/model");
    let Some((meta, python)) = meta.zip(g7_peers::python("pyecore")) else { return };
    let xmi = g7_exchange::named("xmi").expect("a format of the table");
    // A limit of ten minutes for all models together.
    let mut command = Command::new("timeout");
    command.arg("600").arg(python).arg(g7_peers::script("xmi_read.py")).arg(meta);
    let mut tried = Vec::new();
    for chart in table.charts {
        let Some(written) = xmi.write(&chart.document) else { continue };
        match taken(written.text, &written.problems) {
            Ok(text) => {
                command.arg(table.file(&format!("{}.grafcet", tried.len()), &text));
                tried.push(&chart.file);
            }
            Err(reason) => table.note(&format!("XMI, {reason}"), &chart.file),
        }
    }
    let said = command.output().map(|out| String::from_utf8_lossy(&out.stdout).into_owned());
    let said = said.unwrap_or_else(|e| panic!("{e}"));
    let mut lines = said.lines();
    let mut loaded = 0;
    for file in &tried {
        match lines.next() {
            Some(line) if line.parse::<usize>().is_ok() => loaded += 1,
            line => table.note(&format!("pyecore: {}", line.unwrap_or("it ended early")), file),
        }
    }
    table.row("pyecore on XMI", loaded, tried.len(), tried.len());
}
