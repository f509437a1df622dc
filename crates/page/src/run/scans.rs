//! Runs as the page keeps and sends them: for each scan the inputs that change.

use g7_rig::testing::Defect;
use g7_verify::Move;
use serde::{Deserialize, Serialize};

/// A scan of a run.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ProofScan"))]
pub(crate) struct Scan {
    /// The time since the scan before, ns.
    wait_ns: i64,
    /// The input words that are not as in the scan before (in the first scan: not 0): number and value.
    /// The value is a text, because numbers of the page have 53 bits.
    set: Vec<(usize, String)>,
}

/// Most input words of a run that the page sends.
const WORDS: usize = 1 << 20;

impl Scan {
    /// The scans of a run.
    pub(crate) fn list(moves: &[Move]) -> Vec<Scan> {
        let mut before: &[u64] = &[];
        let mut scans = Vec::new();
        for m in moves {
            let old = |i: usize| before.get(i).copied().unwrap_or(0);
            let set = m.inputs.iter().enumerate().filter(|(i, word)| old(*i) != **word);
            let set = set.map(|(i, word)| (i, word.to_string())).collect();
            scans.push(Scan { wait_ns: m.wait, set });
            before = &m.inputs;
        }
        scans
    }

    /// The scans of a failed test up to its failure. None if the test also forces, writes or restarts: the inputs alone then do not
    /// repeat it.
    pub(crate) fn up_to(defect: &Defect) -> Option<Vec<Scan>> {
        let moves = defect.inputs.iter().map(|inputs| Move { inputs: inputs.clone(), wait: 0 });
        let moves: Vec<Move> = moves.collect();
        (!moves.is_empty()).then(|| Scan::list(&moves))
    }

    /// The same with all inputs of a program with so many input words.
    pub(crate) fn moves(scans: &[Scan], words: usize) -> Vec<Move> {
        let mut inputs = vec![0; words];
        let most = WORDS / words.max(1);
        let mut moves = Vec::new();
        for scan in scans.iter().take(most) {
            for (i, word) in &scan.set {
                if let (Some(place), Ok(word)) = (inputs.get_mut(*i), word.parse()) {
                    *place = word;
                }
            }
            moves.push(Move { inputs: inputs.clone(), wait: scan.wait_ns.max(0) });
        }
        moves
    }
}
