//! The messages of pages about files that several people edit at once, and their bounds.

use g7_model::{Said, say};
use serde::{Deserialize, Serialize};

/// Greatest length of the path of a file, of a name and of an id, in bytes.
const PATH: usize = 1_024;
const NAME: usize = 120;
/// Greatest number of selected symbols that are told, and of splices in a change.
const SELECTED: usize = 64;
const SPLICES: usize = 4_096;

/// A wish of a page.
#[derive(Debug, Deserialize)]
#[serde(tag = "do")]
pub(super) enum Wish {
    /// At which files people are.
    #[serde(rename = "together_list")]
    List,
    /// Joins those at a file, to edit or to look. `text` is that of the page; it counts if nobody edits there yet.
    #[serde(rename = "together_join")]
    Join {
        file: String,
        #[serde(default)]
        name: String,
        #[serde(default)]
        text: String,
        edits: bool,
        /// The key of a change whose answer the page has not heard, because its connection broke.
        key: Option<String>,
    },
    #[serde(rename = "together_leave")]
    Leave { file: String },
    /// A change of the text of this version. No other change has its key.
    #[serde(rename = "together_change")]
    Change { file: String, version: u64, splices: Vec<Splice>, key: String },
    /// The place of the person.
    #[serde(rename = "together_here")]
    Here { file: String, here: Here },
    /// The page has saved the file, or taken over what another program wrote; `tag` is the hash of what the disk has now.
    #[serde(rename = "together_saved")]
    Saved { file: String, tag: String },
}

/// Replaces the UTF-16 units `from..to` of the text.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Splice {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) insert: String,
}

/// The place of a person: the chart, the pointer in its units, the selected symbols, and the selection in the text.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct Here {
    #[serde(skip_serializing_if = "Option::is_none")]
    chart: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<(f64, f64)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    select: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<(usize, usize)>,
}

impl Wish {
    /// Refuses what is too long.
    pub(super) fn judge(&self) -> Result<(), Said> {
        let fits = match self {
            Wish::List => true,
            Wish::Join { file, name, key, .. } => {
                let plain = name.len() <= NAME && !name.chars().any(char::is_control);
                plain && file.len() <= PATH && key.as_ref().is_none_or(|key| key.len() <= NAME)
            }
            Wish::Leave { file } => file.len() <= PATH,
            Wish::Change { file, splices, key, .. } => {
                file.len() <= PATH && splices.len() <= SPLICES && key.len() <= NAME
            }
            Wish::Here { file, here } => file.len() <= PATH && here.fits(),
            Wish::Saved { file, tag } => file.len() <= PATH && tag.len() <= NAME,
        };
        if fits { Ok(()) } else { Err(say!("this message is too long for what it means")) }
    }
}

impl Here {
    fn fits(&self) -> bool {
        let finite = self.point.is_none_or(|(x, y)| x.is_finite() && y.is_finite());
        finite
            && self.chart.as_ref().is_none_or(|name| name.len() <= PATH)
            && self.select.len() <= SELECTED
            && self.select.iter().all(|id| id.len() <= PATH)
    }
}
