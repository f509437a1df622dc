//! Retained values on a disk that loses power, is damaged or is full.

use crate::common;

use std::io;

use common::{Chance, Ill, Simulated};
use g7_online::{Slots, SlotsError};
use g7_peers::faults::row;

const LAYOUT: u64 = 77;

#[test]
fn row_2_after_a_loss_of_power_the_last_values_or_the_next_are_there() {
    let mut chance = Chance(1);
    let (mut lost, mut newer, mut torn) = (0, 0, 0);
    for seed in 0..10_000u64 {
        let words = [0, 1, 5, 600, 1500][(seed % 5) as usize];
        let disk = Simulated::default();
        let (mut slots, none) = Slots::open(disk.clone(), LAYOUT, words).expect("a new file");
        assert_eq!(none, None);
        let mut acknowledged = 0;
        for _ in 0..1 + chance.below(4) {
            disk.plates().left = Some(chance.below(20));
            let mut next = acknowledged + 1;
            while slots.save(&vec![next; words]).is_ok() {
                (acknowledged, next) = (next, next + 1);
            }
            disk.plates().fail(&mut chance);
            let (opened, loaded) =
                Slots::open(disk.clone(), LAYOUT, words).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
            let Some(loaded) = loaded else {
                assert_eq!(acknowledged, 0, "seed {seed}");
                slots = opened;
                lost += 1;
                continue;
            };
            let found = loaded.words.first().copied().unwrap_or(loaded.sequence);
            torn += u64::from(loaded.other_damaged);
            assert_eq!(loaded.words, vec![found; words], "seed {seed}: mixed");
            assert!(found == acknowledged || found == acknowledged + 1, "seed {seed}: {found}");
            newer += u64::from(found == acknowledged + 1);
            acknowledged = found;
            slots = opened;
        }
    }
    let counts = format!("{lost} first saves lost, {newer} unacknowledged saves kept, {torn} saves torn");
    assert!(lost > 100 && newer > 100 && torn > 100, "{counts}");
    row(2, "", 10_000, 0, format!("the acknowledged values or the next, whole ({counts})"));
}

#[test]
fn a_file_for_more_words_takes_the_place_of_the_old_one_with_its_first_values() {
    let disk = Simulated::default();
    let (mut slots, _) = Slots::open(disk.clone(), LAYOUT, 2).expect("a new file");
    slots.save(&[7, 8]).expect("the disk is well");
    slots.renew(1200);
    let load = |words| Slots::open(disk.copy(), LAYOUT, words);
    let (_, before) = load(2).expect("the old values");
    assert_eq!(before.map(|loaded| loaded.words), Some(vec![7, 8]), "nothing was saved since");
    disk.plates().ill = Ill::Full;
    assert!(slots.save(&[9; 1200]).is_err());
    let (_, before) = load(2).expect("the old values, since there is no room for others");
    assert_eq!(before.map(|loaded| loaded.words), Some(vec![7, 8]));
    disk.plates().ill = Ill::Well;
    for value in [9, 10, 11] {
        slots.save(&[value; 1200]).expect("the disk is well again");
        let (_, loaded) = load(1200).expect("values of the new length");
        assert_eq!(loaded.map(|loaded| loaded.words), Some(vec![value; 1200]));
    }
}

fn saved(times: u64) -> Vec<u8> {
    let disk = Simulated::default();
    let (mut slots, _) = Slots::open(disk.clone(), LAYOUT, 3).expect("a new file");
    (1..=times).for_each(|k| slots.save(&[k, 10 * k, 100 * k]).expect("the disk works"));
    std::mem::take(&mut disk.plates().safe)
}

fn load(bytes: &[u8]) -> Result<Option<g7_online::Loaded>, SlotsError> {
    Slots::open(Simulated::holding(bytes.to_vec()), LAYOUT, 3).map(|(_, loaded)| loaded)
}

#[test]
fn row_3_every_flipped_bit_and_every_length_is_noticed() {
    let good = saved(2);
    assert_eq!(load(&good).expect("whole").expect("saved").words, [2, 20, 200]);
    let (half, used) = (good.len() / 2, 32 + 3 * 8 + 4);
    let mut newest_hit = 0;
    for slot in [0, half] {
        for bit in 0..8 * used {
            let mut bad = good.clone();
            bad[slot + bit / 8] ^= 1 << (bit % 8);
            let loaded = load(&bad).expect("the other slot is whole").expect("saved");
            // The second save is in the second slot.
            let kept = if slot == half { [1, 10, 100] } else { [2, 20, 200] };
            assert_eq!(loaded.words, kept, "bit {bit} of the slot at {slot}");
            assert!(loaded.other_damaged, "bit {bit} of the slot at {slot}");
            newest_hit += u64::from(slot == half);
        }
    }
    assert_eq!(newest_hit, 8 * used as u64);
    for length in 1..good.len() {
        match load(&good[..length]) {
            Ok(Some(loaded)) => assert!([[1, 10, 100], [2, 20, 200]].contains(&[
                loaded.words[0],
                loaded.words[1],
                loaded.words[2]
            ])),
            Ok(None) => panic!("{length} bytes count as a new file"),
            Err(_) => assert!(length < half + used),
        }
    }
    let mut both = good.clone();
    (both[20], both[half + 20]) = (both[20] ^ 1, both[half + 20] ^ 1);
    assert!(matches!(load(&both), Err(SlotsError::Damaged)));
    let count = 2 * 8 * used + good.len() - 1;
    row(3, "", count as u64, 0, "the older values and a note; both slots bad: an error");
}

#[test]
fn a_file_of_other_variables_is_refused_and_left_as_it_is() {
    let disk = Simulated::default();
    disk.plates().safe = saved(2);
    let before = disk.plates().safe.clone();
    let other = |layout, words| match Slots::open(disk.clone(), layout, words) {
        Err(SlotsError::Layout(loaded)) => (loaded.layout, loaded.words.len()),
        other => panic!("{:?}", other.map(|(_, loaded)| loaded)),
    };
    assert_eq!(other(LAYOUT + 1, 3), (LAYOUT, 3));
    assert_eq!(other(LAYOUT, 4), (LAYOUT, 3));
    assert_eq!(disk.plates().safe, before);
}

#[test]
fn a_full_disk_is_noticed_at_the_start_and_stops_no_save() {
    let full = Simulated::default();
    full.plates().ill = Ill::Full;
    assert!(
        matches!(Slots::open(full, LAYOUT, 3), Err(SlotsError::Io(e)) if e.kind() == io::ErrorKind::StorageFull)
    );
    let disk = Simulated::default();
    let (mut slots, _) = Slots::open(disk.clone(), LAYOUT, 3).expect("a new file");
    disk.plates().ill = Ill::Full;
    slots.save(&[1, 2, 3]).expect("the room is there already");
}
