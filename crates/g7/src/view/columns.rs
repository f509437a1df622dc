//! The widths of the lists: names, values and times come first, comments get the rest.

use super::app::{App, Panel};
use super::lines::{item_line, step_line};

/// Greatest width of a list before comments are considered.
const MOST: u16 = 32;
/// Least useful width of a list.
const LEAST: u16 = 12;
/// Width down to which a list is made narrower before another is left out.
const NARROW: u16 = 15;
/// Width of the list of steps at which the other lists start to grow.
const GOOD: u16 = 40;
/// Room for the time of an active step: `1m23.45s`.
const TIME: usize = 11;
/// Room for a value, so that changing values do not move the lists.
const VALUE: usize = 9;

/// A list; `None` is the list of steps.
type List = Option<Panel>;

/// The widths that a list asks for.
#[derive(Clone, Copy)]
struct Wish {
    /// The width without comments.
    need: u16,
    /// The width with comments.
    want: u16,
}

/// The lists that are shown, and their widths. If there is no room for all, the list of steps and
/// the focused list are kept.
pub(super) fn share(app: &App<'_>, width: u16) -> (Vec<List>, Vec<u16>) {
    let mut lists: Vec<List> = vec![None];
    lists.extend(Panel::ALL.into_iter().filter(|p| !app.listed(*p).is_empty()).map(Some));
    let mut wishes: Vec<(List, Wish)> = lists.into_iter().map(|l| (l, wish(app, l))).collect();
    // A list goes only if the others cannot be made narrow enough: on 80 columns all five are there.
    let narrow = |(list, w): &(List, Wish)| if list.is_some() { w.need.min(NARROW) } else { w.need };
    let total = |wishes: &[(List, Wish)]| wishes.iter().map(narrow).fold(0, u16::saturating_add);
    while total(&wishes) > width && wishes.len() > 2 {
        let Some(last) = wishes.iter().rposition(|(l, _)| l.is_some() && *l != Some(app.panel)) else {
            break;
        };
        wishes.remove(last);
    }
    if width < 2 * LEAST + 16 {
        wishes.truncate(1);
    }
    let (lists, wishes): (Vec<List>, Vec<Wish>) = wishes.into_iter().unzip();
    (lists, widths(&wishes, width))
}

/// Gives each list what it needs; if that is too much, takes from the widest, from the list of steps last. The rest goes to the
/// list of steps up to a good width, then to the narrowest list that can use more; the list of
/// steps stays wider than any other.
fn widths(wishes: &[Wish], width: u16) -> Vec<u16> {
    let mut got: Vec<u16> = wishes.iter().map(|w| w.need).collect();
    let total = |got: &[u16]| got.iter().copied().fold(0, u16::saturating_add);
    while total(&got) > width {
        // The list of steps goes last: the others give what they have above the least width.
        let other = got.iter().skip(1).copied().max().filter(|g| *g > NARROW);
        let widest = other.or(got.iter().copied().max()).filter(|g| *g > 0);
        let from = usize::from(other.is_some());
        let slot = got.iter_mut().skip(from).rev().find(|g| Some(**g) == widest);
        let Some(slot) = slot else { break };
        *slot -= 1;
    }
    // Where nothing is left over, comments of steps go before what other lists have above the least width.
    if total(&got) == width {
        let want = wishes.first().map_or(0, |w| w.want.min(MOST));
        while got.first().is_some_and(|steps| *steps < want) {
            let Some(slot) = got.iter_mut().skip(1).max().filter(|g| **g > NARROW) else { break };
            *slot -= 1;
            if let Some(steps) = got.first_mut() {
                *steps += 1;
            }
        }
    }
    for turn in 0..usize::from(width.saturating_sub(total(&got))) {
        let next = next(&got, wishes, turn);
        if let Some(slot) = got.get_mut(next) {
            *slot += 1;
        }
    }
    got
}

/// The list that grows next by one cell.
fn next(got: &[u16], wishes: &[Wish], turn: usize) -> usize {
    let lacks =
        |i: usize, most: u16| got.get(i).zip(wishes.get(i)).is_some_and(|(g, w)| *g < w.want.min(most));
    if lacks(0, GOOD) {
        return 0;
    }
    let others = (1..got.len()).filter(|i| lacks(*i, u16::MAX));
    let free = turn.checked_rem(got.len()).filter(|_| !lacks(0, u16::MAX)).unwrap_or(0);
    let next = others.min_by_key(|i| got.get(*i).copied()).unwrap_or(free);
    let stays_below = got.get(next).zip(got.first()).is_some_and(|(g, steps)| g + 1 < *steps);
    if stays_below { next } else { 0 }
}

fn wish(app: &App<'_>, list: List) -> Wish {
    let (mut need, mut want, title) = match list {
        None => steps(app),
        Some(panel) => items(app, panel),
    };
    need = need.max(title) + 2;
    want += 2;
    let need = u16::try_from(need).unwrap_or(u16::MAX).clamp(LEAST, MOST);
    Wish { need, want: u16::try_from(want).unwrap_or(u16::MAX).max(need) }
}

/// The width without comments, with comments, and of the title.
fn steps(app: &App<'_>) -> (usize, usize, usize) {
    let name = |s: &g7_rig::StepItem| 2 + s.name.chars().count() + TIME;
    let all = app.bench.steps.iter();
    let with = |s| name(s).max(step_line(app, s).width());
    (all.clone().map(name).max().unwrap_or(0), all.map(with).max().unwrap_or(0), 5)
}

fn items(app: &App<'_>, panel: Panel) -> (usize, usize, usize) {
    let (mut need, mut want) = (0, 0);
    for (number, at) in app.listed(panel).into_iter().enumerate() {
        let Some(item) = app.bench.items.get(at) else { continue };
        let number = (panel == Panel::Inputs).then_some(number);
        let Some(line) = item_line(app, at, number, usize::MAX) else { continue };
        let comment = item.comment.as_ref().map_or(0, |c| c.chars().count() + 1);
        let value = if item.kind == g7_host::Kind::Bool { 2 } else { 3 + VALUE };
        let key = if panel == Panel::Inputs { 4 } else { 0 };
        let steady = key + value + item.name.chars().count();
        let bare = line.width().saturating_sub(comment).max(steady);
        need = need.max(bare);
        want = want.max(bare + comment);
    }
    (need, want, 9)
}

#[cfg(test)]
mod tests {
    use super::{Wish, widths};

    fn of(wishes: &[(u16, u16)], width: u16) -> Vec<u16> {
        let wishes: Vec<Wish> = wishes.iter().map(|(need, want)| Wish { need: *need, want: *want }).collect();
        widths(&wishes, width)
    }

    #[test]
    fn needs_go_first_then_the_steps_then_the_narrowest() {
        assert_eq!(of(&[(20, 20), (12, 12)], 32), [20, 12]);
        assert_eq!(of(&[(20, 40), (12, 60)], 50), [38, 12]);
        assert_eq!(of(&[(20, 90), (12, 30)], 80), [50, 30]);
        // The list of steps has all it can use: the others grow, but stay narrower.
        assert_eq!(of(&[(20, 30), (12, 60), (12, 20)], 62), [30, 16, 16]);
        // Even a list of steps with little text is the widest.
        assert_eq!(of(&[(14, 14), (20, 60)], 60), [31, 29]);
        // The excess is taken from the widest.
        assert_eq!(of(&[(30, 30), (12, 12)], 30), [18, 12]);
        assert_eq!(of(&[(30, 30)], 0), [0]);
        assert!(of(&[], 9).is_empty());
    }
}
