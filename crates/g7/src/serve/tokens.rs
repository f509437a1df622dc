//! The tokens that let pages in where nobody logs in: that of this start, and those of earlier starts of the same folder
//! at the same address, so that a page outlives its server (decision 71).
//!
//! ```text
//! guard -> Tokens::admits (by hash) -> Who
//! a page that lost its server -> GET /api/again -> proofs: whoever answers knows one of its tokens
//! rules' look -> Tokens::look -> file of the folder and the address, its owner's alone
//! ```
//!
//! # Invariants
//!
//! No token is written anywhere: the file has hashes. A token of an earlier start counts at its own address alone, for
//! 8 hours after its last use and 7 days after its start. A file that others could have written lets nobody in.

use std::fs;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::extract::{Query, State};
use axum::routing::get;
use axum::{Json, Router};
use g7_host::utc_millis;
use g7_model::say;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

use super::access::Lasts;
use super::refusal::Refusal;
use super::state;
use crate::failure::{Failure, raw};

/// The most tokens that are kept. If there are more, those that were used longest ago are dropped.
const MOST: usize = 16;
/// The time after which a new use of a token is written to the file, in ms.
const NOTED: u64 = 60_000;
/// The length of the number that a page sends, in hexadecimal digits.
const NUMBER: usize = 32;

/// A token, by its hash.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Row {
    hash: String,
    /// When the server with this token was started, and when the token was last used (0: never), in ms since 1970.
    made: u64,
    used: u64,
    /// The time of the last use as the file has it.
    #[serde(skip)]
    noted: u64,
    /// True for the token of this start. It counts as long as this server runs.
    #[serde(skip)]
    own: bool,
}

/// The contents of a file of tokens: those of one folder, served at one address.
#[derive(Deserialize, Serialize)]
struct Kept {
    /// The whole path of the folder. It is compared, because two folders could have the same name for their files.
    folder: String,
    at: SocketAddr,
    tokens: Vec<Row>,
}

/// Where the tokens of a folder are kept.
#[derive(Clone, Debug)]
pub(super) struct Shelf {
    root: String,
    folder: PathBuf,
}

impl Shelf {
    pub(super) fn of(root: &Path, state: &Path) -> Shelf {
        Shelf::below("pages", root, state)
    }

    /// The place for the tokens of guests.
    pub(super) fn of_guests(root: &Path, state: &Path) -> Shelf {
        Shelf::below("guests", root, state)
    }

    fn below(kind: &str, root: &Path, state: &Path) -> Shelf {
        let folder = state.join("g7").join(kind).join(state::name_of(root));
        Shelf { root: root.to_string_lossy().into_owned(), folder }
    }

    fn place(&self, at: SocketAddr) -> PathBuf {
        self.folder.join(format!("{}.json", at.to_string().replace([':', '[', ']'], "-")))
    }

    /// The tokens of a file that still let in.
    fn read(&self, place: &Path) -> Option<Kept> {
        if !state::is_private(&self.folder) {
            return None;
        }
        let mut kept: Kept = serde_json::from_slice(&fs::read(place).ok()?).ok()?;
        let now = utc_millis();
        kept.tokens.retain(|row| row.lasts(now));
        (kept.folder == self.root).then_some(kept)
    }

    /// The port at which pages of this folder may still wait for their server: the one that was used last.
    pub(super) fn port(&self, host: IpAddr) -> Option<u16> {
        let files = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let kept = files.filter_map(|file| self.read(&file.path())).filter(|kept| kept.at.ip() == host);
        let used = |kept: &Kept| kept.tokens.iter().map(|row| row.used).max();
        kept.filter_map(|kept| Some((used(&kept)?, kept.at.port()))).max().map(|(_, port)| port)
    }

    /// Deletes the files whose tokens all have ended; with `all`, every file.
    fn sweep(&self, all: bool) {
        if !state::is_private(&self.folder) {
            return;
        }
        for file in fs::read_dir(&self.folder).into_iter().flatten().flatten() {
            if all || self.read(&file.path()).is_none_or(|kept| kept.tokens.is_empty()) {
                fs::remove_file(file.path()).ok();
            }
        }
    }
}

impl Row {
    fn lasts(&self, now: u64) -> bool {
        let lasts = Lasts::of(None, None);
        self.own
            || (now.saturating_sub(self.used) < lasts.idle && now.saturating_sub(self.made) < lasts.whole)
    }
}

/// The tokens that let in.
#[derive(Debug)]
pub(super) struct Tokens {
    own: String,
    rows: Mutex<Vec<Row>>,
    file: Option<(Shelf, SocketAddr)>,
}

impl Tokens {
    /// A token for this start alone.
    pub(super) fn fresh() -> Result<Tokens, Failure> {
        let own = token()?;
        let row = Row { hash: hash(&own), made: utc_millis(), used: 0, noted: 0, own: true };
        Ok(Tokens { own, rows: Mutex::new(vec![row]), file: None })
    }

    /// A token for this start, and those of earlier starts at this address; with `forget` they end.
    pub(super) fn kept(shelf: Shelf, at: SocketAddr, forget: bool) -> Result<Tokens, Failure> {
        let mut tokens = Tokens::fresh()?;
        shelf.sweep(forget);
        let earlier = shelf.read(&shelf.place(at)).map(|kept| kept.tokens).unwrap_or_default();
        tokens.rows().extend(earlier.into_iter().map(|row| Row { noted: row.used, ..row }));
        tokens.file = Some((shelf, at));
        Ok(tokens)
    }

    /// The token of this start.
    pub(super) fn own(&self) -> &str {
        &self.own
    }

    fn rows(&self) -> MutexGuard<'_, Vec<Row>> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True if a token lets in. This counts as a use.
    pub(super) fn admits(&self, given: &str) -> bool {
        let (now, given) = (utc_millis(), hash(given));
        let mut rows = self.rows();
        let found = rows.iter_mut().find(|row| row.hash == given && row.lasts(now));
        found.is_some_and(|row| {
            row.used = now;
            true
        })
    }

    /// A proof for each token that lets in: only who knows the hash of the token can make it.
    fn proofs(&self, at: SocketAddr, number: &str) -> Vec<String> {
        let now = utc_millis();
        let rows = self.rows();
        rows.iter().filter(|row| row.lasts(now)).map(|row| proof(&row.hash, at.port(), number)).collect()
    }

    /// Writes the new uses to the file. It waits for the disk, so it must not run on a thread that answers requests.
    pub(super) fn look(&self) {
        let Some((shelf, at)) = &self.file else { return };
        let mut rows = self.rows();
        if !rows.iter().any(|row| row.used.saturating_sub(row.noted) >= NOTED) {
            return;
        }
        let now = utc_millis();
        rows.retain(|row| row.lasts(now));
        rows.sort_by_key(|row| (std::cmp::Reverse(row.own), std::cmp::Reverse(row.used)));
        rows.truncate(MOST);
        rows.iter_mut().for_each(|row| row.noted = row.used);
        let kept = Kept { folder: shelf.root.clone(), at: *at, tokens: rows.clone() };
        drop(rows);
        // Where nothing can be kept, the pages of this start end with it.
        let Ok(bytes) = serde_json::to_vec(&kept) else { return };
        if state::make(&shelf.folder).is_ok() && state::is_private(&shelf.folder) {
            g7_host::write_private(&shelf.place(*at), &bytes).ok();
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// Tokens are compared by their hashes: how long the comparison takes tells nothing about a token.
fn hash(token: &str) -> String {
    hex(&Sha256::digest(token.as_bytes()))
}

/// The proof contains the port. If the server has moved, a stranger at the old port cannot use a proof made at the new one.
fn proof(hash: &str, port: u16, number: &str) -> String {
    hex(&Sha256::digest(format!("{hash}:{port}:{number}").as_bytes()))
}

fn token() -> Result<String, Failure> {
    let mut bytes = [0u8; 24];
    getrandom::fill(&mut bytes)
        .map_err(|e| Failure::Usage(say!("the system gives no random numbers: {e}", e = raw(e))))?;
    Ok(hex(&bytes))
}

/// A page asks this before it shows its token, since somebody else may answer at the address of its server.
pub(super) fn routes(tokens: Vec<Arc<Tokens>>, bound: SocketAddr) -> Router {
    Router::new().route("/api/again", get(again)).with_state((tokens, bound))
}

#[derive(Deserialize)]
struct Asks {
    number: String,
}

async fn again(
    State((tokens, bound)): State<(Vec<Arc<Tokens>>, SocketAddr)>,
    Query(asks): Query<Asks>,
) -> Result<Json<Value>, Refusal> {
    let plain = asks.number.len() == NUMBER && asks.number.bytes().all(|b| b.is_ascii_hexdigit());
    if !plain {
        return Err(Refusal::bad(say!("this request means nothing")));
    }
    let proofs: Vec<String> = tokens.iter().flat_map(|of| of.proofs(bound, &asks.number)).collect();
    Ok(Json(json!({ "proofs": proofs })))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const NUMBER: &str = "00112233445566778899aabbccddeeff";

    /// A place for the tokens of a folder, deleted after the test.
    struct Place(PathBuf);

    impl Place {
        fn new(name: &str) -> Place {
            let path = std::env::temp_dir().join(format!("g7-tokens-{name}-{}", std::process::id()));
            fs::remove_dir_all(&path).ok();
            Place(path)
        }

        fn shelf(&self) -> Shelf {
            Shelf::of(Path::new("/charts/line"), &self.0)
        }

        /// The token of a start that a page has used; the server has ended since.
        fn used(&self, at: SocketAddr) -> String {
            let tokens = Tokens::kept(self.shelf(), at, false).expect("a token");
            assert!(tokens.admits(tokens.own()));
            tokens.look();
            tokens.own().to_owned()
        }

        fn lets_in(&self, at: SocketAddr, token: &str) -> bool {
            Tokens::kept(self.shelf(), at, false).expect("a token").admits(token)
        }

        fn file(&self, at: SocketAddr) -> PathBuf {
            self.shelf().place(at)
        }

        /// Makes all times of the file older.
        fn age(&self, at: SocketAddr, used: Duration, made: Duration) {
            let mut kept: Kept =
                serde_json::from_slice(&fs::read(self.file(at)).expect("a file")).expect("tokens");
            for row in &mut kept.tokens {
                row.used -= u64::try_from(used.as_millis()).expect("a time");
                row.made -= u64::try_from(made.as_millis()).expect("a time");
            }
            let bytes = serde_json::to_vec(&kept).expect("JSON");
            g7_host::write_private(&self.file(at), &bytes).expect("written");
        }
    }

    impl Drop for Place {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.0).ok();
        }
    }

    fn at(port: u16) -> SocketAddr {
        SocketAddr::from(([127, 0, 0, 1], port))
    }

    #[test]
    fn a_token_lets_in_after_a_restart_of_its_folder_at_its_address_alone() {
        let place = Place::new("again");
        let token = place.used(at(4700));
        assert!(place.lets_in(at(4700), &token));
        assert!(!place.lets_in(at(4701), &token), "at another port");
        let other = Shelf::of(Path::new("/charts/other"), &place.0);
        assert!(!Tokens::kept(other, at(4700), false).expect("a token").admits(&token), "another folder");
        // It lets in after many starts as well, each of which has a token of its own.
        let later: Vec<String> = (0..3).map(|_| place.used(at(4700))).collect();
        assert!(later.iter().chain([&token]).all(|token| place.lets_in(at(4700), token)));
        let forgetful = Tokens::kept(place.shelf(), at(4700), true).expect("a token");
        assert!(!forgetful.admits(&token));
        assert!(forgetful.admits(forgetful.own()));
        assert!(!place.lets_in(at(4700), &token), "it is forgotten for good");
    }

    #[test]
    fn a_token_ends_without_use_and_by_its_age() {
        const HOUR: Duration = Duration::from_secs(3_600);
        let place = Place::new("ends");
        for (used, made, lets_in) in [(7, 7, true), (9, 9, false), (1, 167, true), (1, 169, false)] {
            let token = place.used(at(4700));
            place.age(at(4700), HOUR * used, HOUR * made);
            assert_eq!(place.lets_in(at(4700), &token), lets_in, "{used} {made}");
        }
    }

    #[test]
    fn no_token_is_written_and_no_one_else_reads_or_writes_the_file() {
        let place = Place::new("private");
        let unused = Tokens::kept(place.shelf(), at(4700), false).expect("a token");
        unused.look();
        assert!(!place.file(at(4700)).exists(), "a token that nobody has used is not kept");
        let token = place.used(at(4700));
        let text = String::from_utf8(fs::read(place.file(at(4700))).expect("a file")).expect("JSON");
        assert!(!text.contains(&token) && text.contains(&hash(&token)), "{text}");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            let mode = |path: &Path| fs::metadata(path).expect("it is there").permissions().mode() & 0o777;
            assert_eq!(mode(&place.file(at(4700))), 0o600);
            assert_eq!(mode(&place.shelf().folder), 0o700);
            // A folder in which others could have put a file lets nobody in, and nothing in it is deleted.
            let others = fs::Permissions::from_mode(0o777);
            fs::set_permissions(&place.shelf().folder, others).expect("it is ours");
            assert!(!place.lets_in(at(4700), &token));
            assert!(place.file(at(4700)).exists());
            assert_eq!(place.shelf().port(at(0).ip()), None);
        }
    }

    #[test]
    fn the_port_where_a_page_was_last_is_tried_again() {
        let place = Place::new("port");
        assert_eq!(place.shelf().port(at(0).ip()), None);
        place.used(at(4700));
        place.used(at(5000));
        place.age(at(4700), Duration::from_secs(60), Duration::ZERO);
        assert_eq!(place.shelf().port(at(0).ip()), Some(5000));
        assert_eq!(place.shelf().port("::1".parse().expect("an address")), None);
        place.age(at(5000), Duration::from_secs(9 * 3_600), Duration::ZERO);
        assert_eq!(place.shelf().port(at(0).ip()), Some(4700));
    }

    #[test]
    fn only_who_knows_the_hash_at_this_port_can_prove_it() {
        let place = Place::new("proof");
        let token = place.used(at(4700));
        let of = |port| {
            let tokens = Tokens::kept(place.shelf(), at(port), false).expect("a token");
            tokens.proofs(at(port), NUMBER)
        };
        let awaited = proof(&hash(&token), 4700, NUMBER);
        assert!(of(4700).contains(&awaited));
        assert!(!of(4701).contains(&awaited), "another port does not know it");
        assert_ne!(proof(&hash(&token), 4701, NUMBER), awaited, "and could not pass it on");
        assert!(of(4700).iter().all(|proof| *proof != token && *proof != hash(&token)));
    }
}
