//! `g7 check --fix`: applies the fixes that problems carry, round after round, because one may show the next.

use g7_model::{FileId, Fix, Problem};

use crate::failure::Failure;
use crate::report::Tally;
use crate::sources::Source;

/// Most rounds; each applies at least one fix.
const ROUNDS: usize = 20;

/// A file behind its fixes.
pub(super) struct Fixed {
    pub(super) source: Source,
    /// The problems that are left.
    pub(super) problems: Vec<Problem>,
    /// The number of fixes that were applied.
    pub(super) count: usize,
}

/// Applies the sure fixes, and the first likely one of a problem that has no sure one if `likely`. A round that
/// would leave more errors than it found is not taken.
pub(super) fn applied(
    source: Source,
    problems: Vec<Problem>,
    likely: bool,
    check: impl Fn(Source) -> Result<(Source, Vec<Problem>), Failure>,
) -> Result<Fixed, Failure> {
    let mut now = Fixed { source, problems, count: 0 };
    for _ in 0..ROUNDS {
        // Text that is no UTF-8 would not be written as it was read.
        let Ok(text) = std::str::from_utf8(&now.source.bytes) else { break };
        let chosen = |p: &'_ Problem| {
            let sure = p.fixes.iter().position(|f| f.sure);
            sure.or((likely && !p.fixes.is_empty()).then_some(0))
        };
        let fixes: Vec<&Fix> =
            now.problems.iter().filter_map(|p| chosen(p).and_then(|at| p.fixes.get(at))).collect();
        let (text, done) = Fix::apply(text, FileId(0), &fixes);
        let count = done.into_iter().filter(|done| *done).count();
        if count == 0 {
            break;
        }
        let made = Source::new(&now.source.name, text.into_bytes(), 0).linked_like(&now.source);
        let (source, problems) = check(made)?;
        if Tally::of(&problems).errors > Tally::of(&now.problems).errors {
            break;
        }
        now = Fixed { source, problems, count: now.count + count };
    }
    Ok(now)
}
