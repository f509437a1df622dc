//! Rows of the table of words, with places for names and numbers, and how the places are filled.

/// A sentence in English, French and Portuguese.
pub type Said = [String; 3];

/// A row of the table; each `{}` is a place for a name or a number.
pub(super) type Row = [&'static str; 3];

/// A thing that is counted: one of it, and more.
pub(super) type Counted = [Row; 2];
pub(super) const SCANS: Counted =
    [["{} scan", "{} cycle", "{} ciclo"], ["{} scans", "{} cycles", "{} ciclos"]];
pub(super) const STATES: Counted =
    [["{} state", "{} état", "{} estado"], ["{} states", "{} états", "{} estados"]];
pub(super) const PAIRS: Counted = [
    ["{} pair of states", "{} paire d’états", "{} par de estados"],
    ["{} pairs of states", "{} paires d’états", "{} pares de estados"],
];
pub(super) const NODES: Counted = [["{} node", "{} nœud", "{} nó"], ["{} nodes", "{} nœuds", "{} nós"]];
pub(super) const ZONES: Counted = [
    ["{} set of states", "{} ensemble d’états", "{} conjunto de estados"],
    ["{} sets of states", "{} ensembles d’états", "{} conjuntos de estados"],
];

/// A row with its places filled, each with its own language.
pub(super) fn say(row: Row, with: &[Said]) -> Said {
    std::array::from_fn(|i| {
        let mut parts = row.get(i).copied().unwrap_or_default().split("{}");
        let mut text = parts.next().unwrap_or_default().to_owned();
        let filled = with.iter().map(|w| w.get(i).map_or("", String::as_str)).chain(std::iter::repeat(""));
        for (part, word) in parts.zip(filled) {
            text.push_str(word);
            text.push_str(part);
        }
        text
    })
}

/// A word that is the same in each language, such as a name of the chart.
pub(super) fn same(word: &str) -> Said {
    std::array::from_fn(|_| word.to_owned())
}

pub(super) fn count(n: impl ToString, what: Counted) -> Said {
    let ([one, more], n) = (what, n.to_string());
    say(if n == "1" { one } else { more }, &[same(&n)])
}

#[cfg(test)]
mod tests {
    use super::{Row, SCANS, Said, count, same, say};

    const RUN: Row = ["a run of {}, {}", "une exécution de {}, {}", "uma execução de {}, {}"];

    #[test]
    fn places_are_filled_in_each_language() {
        let said: Said = say(RUN, &[count(1, SCANS), same("0s")]);
        assert_eq!(said[0], "a run of 1 scan, 0s");
        assert_eq!(said[1], "une exécution de 1 cycle, 0s");
        assert_eq!(said[2], "uma execução de 1 ciclo, 0s");
        assert_eq!(count(2, SCANS)[2], "2 ciclos");
    }
}
