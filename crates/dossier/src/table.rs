//! Tables that go on over sheets: the head is repeated, cells wrap, and a row that is higher than a sheet is divided.

use g7_draw::width;

use crate::flow::{Flow, LEADING, TEXT, wrap};

/// Size of the texts in a table.
const SIZE: i32 = 112;
/// Distance from the edge of a cell to its text.
const PAD: i32 = 50;

/// A table.
#[derive(Default)]
pub(crate) struct Table {
    /// The share of the width that each column has.
    widths: Vec<i32>,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table: for each column its heading and its share of the width.
    pub(crate) fn new(columns: &[(&str, i32)]) -> Table {
        Table {
            widths: columns.iter().map(|(_, w)| *w).collect(),
            head: columns.iter().map(|(h, _)| (*h).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    pub(crate) fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The left edge and the width of each column.
    fn columns(&self, left: i32, room: i32) -> Vec<(i32, i32)> {
        let all: i32 = self.widths.iter().sum::<i32>().max(1);
        let mut x = left;
        let mut columns = Vec::new();
        for w in &self.widths {
            let w = room * w / all;
            columns.push((x, w));
            x += w;
        }
        columns
    }

    /// Writes the table, or a sentence in the place of one without rows.
    pub(crate) fn write_or(&self, flow: &mut Flow, none: &str) {
        if self.is_empty() { flow.text(none) } else { self.write(flow) }
    }

    pub(crate) fn write(&self, flow: &mut Flow) {
        let columns = self.columns(flow.inside.x, flow.inside.w);
        let wrapped = |cells: &[String]| -> Vec<Vec<String>> {
            let cells = cells.iter().zip(&columns);
            cells
                .map(|(text, (_, w))| text.lines().flat_map(|l| wrap(l, SIZE, w - 2 * PAD)).collect())
                .collect()
        };
        let head = wrapped(&self.head);
        let first = self.rows.first().map_or(0, |r| height(&wrapped(r)));
        flow.need(height(&head) + first.min(flow.inside.h / 2));
        self.part(flow, &columns, &head, true);
        for row in &self.rows {
            let mut cells = wrapped(row);
            if height(&cells) > flow.left() && height(&cells) + height(&head) <= flow.inside.h {
                flow.need(flow.inside.h);
                self.part(flow, &columns, &head, true);
            }
            // A row that is higher than a sheet goes on on the next one.
            while height(&cells) > flow.left() {
                let lines = ((flow.left() - 2 * PAD) / leading()).max(1) as usize;
                let now = cells.iter_mut().map(|cell| {
                    let rest = cell.split_off(lines.min(cell.len()));
                    std::mem::replace(cell, rest)
                });
                let now: Vec<Vec<String>> = now.collect();
                self.part(flow, &columns, &now, false);
                flow.need(flow.inside.h);
                self.part(flow, &columns, &head, true);
            }
            self.part(flow, &columns, &cells, false);
        }
        flow.skip(TEXT);
    }

    /// Writes a row, or the head.
    fn part(&self, flow: &mut Flow, columns: &[(i32, i32)], cells: &[Vec<String>], head: bool) {
        let (top, high) = (flow.height(), height(cells));
        let (left, right) = (flow.inside.x, flow.inside.x + flow.inside.w);
        let ink = flow.ink();
        for (lines, (x, _)) in cells.iter().zip(columns) {
            for (n, line) in (0..).zip(lines) {
                let y = top + PAD + SIZE * 80 / 100 + n * leading();
                debug_assert!(width(line, SIZE) <= right - left);
                ink.text(if head { "g7-cond" } else { "g7-name" }, x + PAD, y, SIZE, line);
            }
        }
        let class = if head { "g7-link" } else { "g7-grid" };
        ink.line(class, &[(left, top + high), (right, top + high)]);
        flow.skip(high);
    }
}

fn leading() -> i32 {
    SIZE * LEADING / 100 * 90 / 100
}

fn height(cells: &[Vec<String>]) -> i32 {
    let lines = cells.iter().map(Vec::len).max().unwrap_or(0).max(1);
    2 * PAD + leading() * i32::try_from(lines).unwrap_or(i32::MAX / 1000)
}
