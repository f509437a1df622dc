//! Who is let in by the server of our own, and who may write: the users of G7, by the rules of its page.
//!
//! A user whose role or password is another one, who was removed or whose sessions were ended, is not known here any
//! more, and the server ends the sessions (`server`).

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use g7_store::users::{Role, User, UserError, Users};
use opcua::crypto::SecurityPolicy;
use opcua::server::ServerEndpoint;
use opcua::server::address_space::AccessLevel;
use opcua::server::authenticator::{AuthManager, Password, UserToken, user_pass_security_policy_id};
use opcua::types::{Error, NodeId, StatusCode, UAString, UserTokenPolicy, UserTokenType};
use tokio::sync::Semaphore;

/// Sentences that wait for the driver; the oldest are left out.
const NOTES: usize = 20;
/// Wrong passwords in a minute, from all clients together; behind them nobody new is let in.
const GUESSES: usize = 10;
/// Passwords that are checked at the same time: each takes 19 MiB.
const CHECKS: usize = 2;
/// The longest wait for a check.
const PATIENCE: Duration = Duration::from_secs(10);

/// Sentences for the driver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Notes(Arc<Mutex<VecDeque<String>>>);

impl Notes {
    pub(crate) fn say(&self, note: String) {
        let mut notes = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if notes.back() != Some(&note) {
            notes.push_back(note);
        }
        while notes.len() > NOTES {
            notes.pop_front();
        }
    }

    pub(crate) fn take(&self) -> Vec<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).drain(..).collect()
    }
}

/// The wrong passwords of the last minute.
#[derive(Debug, Default)]
struct Guesses {
    clock: WallClock,
    at: VecDeque<Nanos>,
}

/// The rights of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rights {
    None,
    Read,
    Write,
}

/// The one at the door.
pub(crate) struct Guard {
    users: Option<Arc<Users>>,
    anonymous: Rights,
    notes: Notes,
    guesses: Mutex<Guesses>,
    checks: Semaphore,
    held: Mutex<Held>,
}

/// The users who were let in, by name, as they were in the file.
#[derive(Default)]
struct Held {
    version: Option<i64>,
    users: BTreeMap<String, User>,
}

/// The token of a user; that of the library for nobody is another word.
const USER: &str = "user ";

/// The name of a user; `None` for a client without one.
pub(crate) fn name_of(token: &UserToken) -> Option<&str> {
    token.0.strip_prefix(USER)
}

/// The user, if the password is right: as the file has them before the password was looked at, so that no change
/// is missed.
fn check(users: &Users, name: &str, password: &str) -> Result<Option<User>, UserError> {
    let all = users.list()?;
    let Some((name, _)) = users.check(name, password)? else { return Ok(None) };
    Ok(all.into_iter().find(|user| user.name == name))
}

impl Guard {
    /// `anonymous` is what the io file says of clients without a user.
    pub(crate) fn new(users: Option<Arc<Users>>, anonymous: Option<bool>, notes: Notes) -> Guard {
        let anonymous = match (anonymous, &users) {
            (Some(true), _) => Rights::Read,
            (Some(false), _) | (None, Some(_)) => Rights::None,
            (None, None) => Rights::Write,
        };
        let (guesses, held) = (Mutex::default(), Mutex::default());
        Guard { users, anonymous, notes, guesses, checks: Semaphore::new(CHECKS), held }
    }

    fn guesses(&self) -> MutexGuard<'_, Guesses> {
        let mut guesses = self.guesses.lock().unwrap_or_else(PoisonError::into_inner);
        let now = guesses.clock.now();
        while guesses.at.front().is_some_and(|at| now - *at > Nanos::MINUTE) {
            guesses.at.pop_front();
        }
        guesses
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn refuse(&self, why: String) -> Error {
        self.notes.say(format!("refused {why}"));
        Error::new(StatusCode::BadUserAccessDenied, why)
    }

    /// Forgets those who were changed since they came in. A file that cannot be read lets nobody in.
    pub(crate) fn look(&self) {
        let Some(users) = &self.users else { return };
        let mut held = self.held();
        let version = users.version().ok();
        if version.is_some() && version == held.version {
            return;
        }
        held.version = version;
        let all = users.list().unwrap_or_default();
        let same = |now: &User, was: &User| {
            (&now.name, now.role, now.created, now.changes) == (&was.name, was.role, was.created, was.changes)
        };
        held.users.retain(|_, was| all.iter().any(|now| same(now, was)));
    }

    /// True while a client is let in.
    pub(crate) fn knows(&self, token: &UserToken) -> bool {
        self.may(token) != Rights::None
    }

    /// The rights of a client. Writing needs the role that a part of a panel needs.
    fn may(&self, token: &UserToken) -> Rights {
        let Some(user) = name_of(token) else {
            return if token.is_anonymous() { self.anonymous } else { Rights::None };
        };
        match self.held().users.get(user).map(|user| user.role) {
            None => Rights::None,
            Some(role) if role >= Role::Operator => Rights::Write,
            Some(_) => Rights::Read,
        }
    }
}

#[async_trait::async_trait]
impl AuthManager for Guard {
    async fn authenticate_anonymous_token(&self, _: &ServerEndpoint) -> Result<(), Error> {
        if self.anonymous == Rights::None {
            return Err(self.refuse("a client without a user".to_owned()));
        }
        Ok(())
    }

    async fn authenticate_username_identity_token(
        &self,
        _: &ServerEndpoint,
        user: &str,
        password: &Password,
    ) -> Result<UserToken, Error> {
        let named: String = user.chars().filter(|c| !c.is_control()).take(40).collect();
        let Some(users) = self.users.clone() else {
            return Err(self.refuse(format!("the user \"{named}\": there are no users")));
        };
        let Ok(Ok(permit)) = tokio::time::timeout(PATIENCE, self.checks.acquire()).await else {
            return Err(self.refuse(format!("the user \"{named}\": too many log in at this moment")));
        };
        if self.guesses().at.len() >= GUESSES {
            return Err(self.refuse(format!("the user \"{named}\": too many wrong passwords in a minute")));
        }
        let (user, password) = (user.to_owned(), password.get().to_owned());
        let checked = tokio::task::spawn_blocking(move || check(&users, &user, &password)).await;
        drop(permit);
        match checked {
            Ok(Ok(Some(user))) => {
                let token = UserToken(format!("{USER}{}", user.name));
                let mut held = self.held();
                // A change that came meanwhile is found by the next look.
                held.version = None;
                held.users.insert(user.name.clone(), user);
                drop(held);
                Ok(token)
            }
            Ok(Ok(None)) => {
                let mut guesses = self.guesses();
                let now = guesses.clock.now();
                guesses.at.push_back(now);
                drop(guesses);
                Err(self.refuse(format!("the user \"{named}\": unknown, or another password")))
            }
            Ok(Err(why)) => Err(self.refuse(format!("the user \"{named}\": {why}"))),
            Err(_) => Err(self.refuse(format!("the user \"{named}\": the password cannot be checked"))),
        }
    }

    fn effective_user_access_level(&self, token: &UserToken, level: AccessLevel, _: &NodeId) -> AccessLevel {
        match self.may(token) {
            Rights::None => AccessLevel::empty(),
            Rights::Read => level - AccessLevel::CURRENT_WRITE,
            Rights::Write => level,
        }
    }

    fn is_user_executable(&self, _: &UserToken, _: &NodeId) -> bool {
        // There are no methods of ours, and those of the library are for diagnosis.
        false
    }

    fn user_token_policies(&self, endpoint: &ServerEndpoint) -> Vec<UserTokenPolicy> {
        let policy = |token_type, id: UAString, uri: UAString| UserTokenPolicy {
            policy_id: id,
            token_type,
            issued_token_type: UAString::null(),
            issuer_endpoint_url: UAString::null(),
            security_policy_uri: uri,
        };
        let anonymous = (self.anonymous != Rights::None)
            .then(|| policy(UserTokenType::Anonymous, UAString::from("anonymous"), UAString::null()));
        // A password is encrypted by itself where the connection is not.
        let named = self.users.is_some().then(|| {
            let uri = UAString::from(endpoint.password_security_policy().to_uri());
            policy(UserTokenType::UserName, user_pass_security_policy_id(endpoint), uri)
        });
        anonymous.into_iter().chain(named).collect()
    }
}

/// The policy by which a password is encrypted where the connection is not.
pub(crate) fn password_policy() -> String {
    SecurityPolicy::Basic256Sha256.to_string()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    const PASSWORD: &str = "correct horse";

    /// Users in a file that no other test has.
    fn users() -> (Arc<Users>, PathBuf) {
        static NEXT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("g7-opcua-users-{}-{number}", std::process::id()));
        std::fs::remove_file(&path).ok();
        let users = Users::open(&path).expect("opened");
        for (name, role) in [("ana", Role::Operator), ("view", Role::Viewer), ("boss", Role::Admin)] {
            users.add(name, role, PASSWORD, 1, false).expect("added");
        }
        (Arc::new(users), path)
    }

    fn login(guard: &Guard, user: &str, password: &str) -> Result<UserToken, Error> {
        let endpoint = ServerEndpoint::new_none("/", &[]);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        let password = Password::new(password.to_owned());
        runtime.block_on(guard.authenticate_username_identity_token(&endpoint, user, &password))
    }

    /// Reads, writes.
    fn may(guard: &Guard, token: &str) -> (bool, bool) {
        let all = AccessLevel::CURRENT_READ | AccessLevel::CURRENT_WRITE;
        let got = guard.effective_user_access_level(&UserToken(token.to_owned()), all, &NodeId::null());
        (got.contains(AccessLevel::CURRENT_READ), got.contains(AccessLevel::CURRENT_WRITE))
    }

    #[test]
    fn who_may_write_follows_the_role() {
        let guard = Guard::new(Some(users().0), None, Notes::default());
        assert_eq!(login(&guard, "ANA", PASSWORD).expect("let in").0, "user ana", "the name of the file");
        login(&guard, "view", PASSWORD).expect("let in");
        for (token, rights) in [
            ("user ana", (true, true)),
            ("user view", (true, false)),
            ("user boss", (false, false)),
            ("ANONYMOUS", (false, false)),
            ("ana", (false, false)),
        ] {
            assert_eq!(may(&guard, token), rights, "{token}");
        }
    }

    #[test]
    fn without_users_everybody_here_writes_unless_the_file_says_another_thing() {
        for (users, setting, rights) in [
            (None, None, (true, true)),
            (None, Some(true), (true, false)),
            (None, Some(false), (false, false)),
            (Some(users().0), None, (false, false)),
            (Some(users().0), Some(true), (true, false)),
        ] {
            let guard = Guard::new(users, setting, Notes::default());
            assert_eq!(may(&guard, "ANONYMOUS"), rights, "{setting:?}");
            assert_eq!(login(&guard, "nobody", PASSWORD).map(|token| token.0).ok(), None);
        }
    }

    #[test]
    fn each_change_of_a_user_ends_what_the_user_may() {
        type Change = fn(&Users);
        let changes: [Change; 4] = [
            |users| users.revoke("ana").expect("ended"),
            |users| users.set_role("ana", Role::Viewer).expect("changed"),
            |users| users.set_password("ana", "another secret").expect("changed"),
            |users| users.remove("ana").expect("removed"),
        ];
        for change in changes {
            let (users, path) = users();
            let guard = Guard::new(Some(users), None, Notes::default());
            let ana = login(&guard, "ana", PASSWORD).expect("let in");
            let view = login(&guard, "view", PASSWORD).expect("let in");
            guard.look();
            assert!(guard.knows(&ana));
            change(&Users::open(&path).expect("another process"));
            guard.look();
            assert!(!guard.knows(&ana) && guard.knows(&view));
        }
    }

    #[test]
    fn passwords_are_not_guessed_for_long() {
        let guard = Guard::new(Some(users().0), None, Notes::default());
        assert!(login(&guard, "ana", PASSWORD).is_ok());
        for _ in 0..GUESSES {
            assert!(login(&guard, "ana", "wrong").is_err());
        }
        // Even the right one waits now, and it is said.
        assert!(login(&guard, "ana", PASSWORD).is_err());
        let notes = guard.notes.take();
        assert!(notes.iter().any(|n| n.contains("\"ana\"") && n.contains("another password")), "{notes:?}");
        assert!(notes.iter().any(|n| n.contains("too many")), "{notes:?}");
        assert!(guard.notes.take().is_empty());
    }
}
