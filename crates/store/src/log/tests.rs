//! The chain finds each change; a full disk loses nothing that is not counted.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::Connection;
use rusqlite::types::Value;

use super::*;

const LONG: Duration = Duration::from_secs(20);

fn now() -> u64 {
    1_700_000_000_000
}

fn path(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("g7-log-{name}-{}", std::process::id()));
    std::fs::remove_dir_all(&folder).ok();
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.join("log")
}

fn entry(k: u64) -> Entry {
    Entry {
        wall: now() + k,
        at: k.is_multiple_of(2).then_some(k as i64),
        level: "note".to_owned(),
        kind: format!("kind{k}"),
        who: "ana".to_owned(),
        from: "console".to_owned(),
        data: format!("{{\"k\":{k}}}"),
    }
}

/// Writes so many rows and ends.
fn written(path: &Path, rows: u64, keep: Keep) -> Mark {
    let Opened { log, .. } = Log::open(path, keep, now).expect("opened");
    let entrance = log.entrance().expect("a way in");
    for k in 1..=rows {
        entrance.deed(entry(k)).wait(LONG).expect("written");
    }
    entrance.state().newest
}

fn checked(path: &Path, known: Option<Mark>) -> Result<Checked, Broken> {
    Reader::open(path).expect("readable").check(known).expect("readable")
}

#[test]
fn a_log_goes_on_with_its_chain_after_a_new_start() {
    let path = path("goes-on");
    let first = written(&path, 3, Keep::default());
    assert_eq!(first.n, 3);
    let Opened { log, newest } = Log::open(&path, Keep::default(), now).expect("opened");
    assert_eq!(newest, first);
    drop(log);
    let second = written(&path, 2, Keep::default());
    assert_eq!(checked(&path, Some(first)), Ok(Checked { rows: 5, gone: 0, newest: second }));
    let rows = Reader::open(&path).expect("readable").rows(&Filter::default(), 2).expect("rows");
    assert_eq!(rows.iter().map(|row| row.n).collect::<Vec<_>>(), [5, 4], "the newest first");
    assert_eq!(rows[1].entry, entry(1));
}

#[test]
fn each_column_and_each_row_that_is_changed_is_found() {
    let path = path("changed");
    let newest = written(&path, 6, Keep::default());
    let whole = std::fs::read(&path).expect("there");
    let columns = ["n", "wall", "at", "level", "kind", "who", "origin", "data", "hash"];
    for n in 1..=6_i64 {
        for column in columns {
            std::fs::write(&path, &whole).expect("as it was");
            let file = Connection::open(&path).expect("open");
            let value: Value = file
                .query_row(&format!("SELECT {column} FROM row WHERE n = ?1"), [n], |r| r.get(0))
                .expect("there");
            let other = match value {
                Value::Integer(k) if column == "n" => Value::Integer(k + 100),
                Value::Integer(k) => Value::Integer(k ^ 1),
                Value::Text(text) => Value::Text(format!("{text} ")),
                Value::Blob(mut bytes) => {
                    bytes[7] ^= 1;
                    Value::Blob(bytes)
                }
                _ => Value::Integer(0),
            };
            file.execute(&format!("UPDATE row SET {column} = ?1 WHERE n = ?2"), (other, n)).expect("changed");
            drop(file);
            let broken = checked(&path, Some(newest)).expect_err(column);
            assert_eq!(broken.n, n as u64, "{column}: {broken}");
        }
        // Taken out; and put in, with the numbers behind moved on.
        std::fs::write(&path, &whole).expect("as it was");
        let file = Connection::open(&path).expect("open");
        file.execute("DELETE FROM row WHERE n = ?1", [n]).expect("removed");
        assert_eq!(checked(&path, Some(newest)).expect_err("removed").n, n as u64);
        file.execute("UPDATE row SET n = n - 1 WHERE n > ?1", [n]).expect("closed up");
        let broken = checked(&path, Some(newest)).expect_err("closed up");
        assert_eq!(broken.n, n as u64, "{broken}");
    }
    std::fs::write(&path, &whole).expect("as it was");
    assert!(checked(&path, Some(newest)).is_ok());
}

#[test]
fn rows_that_are_cut_off_are_found_by_a_mark_and_by_the_process_that_wrote_them() {
    let path = path("cut");
    let Opened { log, .. } = Log::open(&path, Keep::default(), now).expect("opened");
    let entrance = log.entrance().expect("a way in");
    for k in 1..=4 {
        entrance.deed(entry(k)).wait(LONG).expect("written");
    }
    let newest = entrance.state().newest;
    Connection::open(&path).expect("open").execute("DELETE FROM row WHERE n > 2", ()).expect("cut");
    assert!(checked(&path, None).is_ok(), "the chain alone does not know its end");
    assert_eq!(checked(&path, Some(newest)).expect_err("cut").n, 3);
    entrance.deed(entry(9)).wait(LONG).expect("written");
    let rows = Reader::open(&path).expect("readable").rows(&Filter::default(), 9).expect("rows");
    assert_eq!(rows[1].entry.kind, CUT);
    assert!(rows[1].entry.data.contains(&newest.to_string()), "{}", rows[1].entry.data);
}

#[test]
fn old_rows_go_and_the_chain_still_proves_the_rest() {
    let path = path("pruned");
    let small = Keep { bytes: 40_000, ..Keep::default() };
    let before = written(&path, 3, Keep::default());
    for _ in 0..8 {
        written(&path, 150, small);
    }
    let newest = written(&path, 1, small);
    let sure = checked(&path, Some(newest)).expect("it fits");
    assert!(sure.gone > 3 && sure.rows < 900, "{sure:?}");
    assert!(
        checked(&path, Some(before)).is_ok(),
        "a mark of a row that is gone proves nothing and refutes nothing"
    );
    let file = Connection::open(&path).expect("open");
    // The oldest rows are taken away by hand, with an anchor that fits.
    let (n, hash): (i64, Vec<u8>) = file
        .query_row("SELECT n, hash FROM row ORDER BY n LIMIT 1 OFFSET 5", (), |r| Ok((r.get(0)?, r.get(1)?)))
        .expect("there");
    file.execute("DELETE FROM row WHERE n <= ?1", [n]).expect("removed");
    file.execute("UPDATE anchor SET n = ?1, hash = ?2", (n, hash)).expect("set");
    assert_eq!(checked(&path, None).expect_err("told by no row").n, n as u64 + 1);
}

#[test]
fn rows_older_than_they_are_kept_go() {
    let path = path("days");
    written(&path, 20, Keep::default());
    fn later() -> u64 {
        now() + 11 * 86_400_000
    }
    let Opened { log, .. } = Log::open(&path, Keep { days: 10, ..Keep::default() }, later).expect("opened");
    let young = Entry { wall: later(), ..entry(1) };
    let entrance = log.entrance().expect("a way in");
    entrance.deed(young).wait(LONG).expect("written");
    drop((entrance, log));
    let sure = checked(&path, None).expect("it fits");
    assert_eq!((sure.gone, sure.rows), (20, 2), "the young one and the row that says it");
}

#[test]
fn what_is_wanted_is_found_by_time_level_and_text() {
    let path = path("filter");
    written(&path, 9, Keep::default());
    let reader = Reader::open(&path).expect("readable");
    let numbers =
        |filter: &Filter| reader.rows(filter, 100).expect("rows").iter().map(|row| row.n).collect::<Vec<_>>();
    let time = Filter { from: Some(now() + 3), until: Some(now() + 5), ..Filter::default() };
    assert_eq!(numbers(&time), [4, 3]);
    assert_eq!(numbers(&Filter { text: "KIND7".to_owned(), ..Filter::default() }), [7]);
    assert_eq!(numbers(&Filter { before: Some(3), ..Filter::default() }), [2, 1]);
    let levels = |word: &str| Filter { levels: vec![word.to_owned()], ..Filter::default() };
    assert_eq!(numbers(&levels("note")).len(), 9);
    assert!(numbers(&levels("alarm")).is_empty());
    let odd = Filter { text: "' OR 1 = 1 --".to_owned(), ..Filter::default() };
    assert!(numbers(&odd).is_empty());
}

#[test]
fn a_mark_is_read_as_it_is_written() {
    let mark = Mark { n: 7, hash: chained(&Hash::default(), 7, &entry(7)) };
    assert_eq!(mark.to_string().parse(), Ok(mark));
    for wrong in
        ["", "7", "7:", "7:00", "x:0", &format!("7:{}", "é".repeat(32)), &format!("7:{}", "g".repeat(64))]
    {
        assert!(wrong.parse::<Mark>().is_err(), "{wrong}");
    }
}

#[test]
fn while_the_file_cannot_be_written_deeds_are_refused_and_lost_events_are_counted() {
    let path = path("locked");
    let Opened { log, .. } = Log::open(&path, Keep { backlog: 3, ..Keep::default() }, now).expect("opened");
    let entrance = log.entrance().expect("a way in");
    entrance.deed(entry(1)).wait(LONG).expect("written");
    // A limit of pages stands for a full disk: SQLite answers the same.
    let other = Connection::open(&path).expect("open");
    other.execute_batch("BEGIN EXCLUSIVE").expect("locked");
    let refused = entrance.deed(entry(2));
    for k in 3..=9 {
        entrance.event(entry(k));
    }
    assert!(refused.wait(LONG).is_err());
    while entrance.state().lost == 0 {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(entrance.state().failing.is_some());
    other.execute_batch("ROLLBACK").expect("free");
    let after = entrance.deed(entry(10));
    after.wait(LONG).expect("written in the same process");
    let state = entrance.state();
    assert_eq!((state.failing, state.lost > 0), (None, true));
    let rows = Reader::open(&path).expect("readable").rows(&Filter::default(), 99).expect("rows");
    let gap = rows.iter().find(|row| row.entry.kind == GAP).expect("the count of those lost");
    assert_eq!(gap.entry.data, format!("{{\"count\":{}}}", state.lost));
    let events = rows.len() as u64 - 1;
    assert_eq!(events + state.lost, 9, "of 10, one deed was refused");
    assert!(checked(&path, Some(state.newest)).is_ok());
}
