//! Who is let in by the server of our own, and who may write.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use g7_online::setup::{Role, User};
use opcua::crypto::SecurityPolicy;
use opcua::server::ServerEndpoint;
use opcua::server::address_space::AccessLevel;
use opcua::server::authenticator::{AuthManager, Password, UserToken, user_pass_security_policy_id};
use opcua::types::{Error, NodeId, StatusCode, UAString, UserTokenPolicy, UserTokenType};

/// Those who know users.
pub trait Users: Send + Sync + 'static {
    /// The role of a user with this password; `None` where there is no such user, or the password is
    /// another one.
    fn check(&self, user: &str, password: &str) -> Option<Role>;

    /// The role of a user who was let in; `None` where there is none any more.
    fn role(&self, user: &str) -> Option<Role>;

    /// True if there is nobody.
    fn is_empty(&self) -> bool;
}

impl Users for Vec<User> {
    fn check(&self, user: &str, password: &str) -> Option<Role> {
        let found = self.iter().find(|u| u.name.value == user)?;
        let (is, should) = (password.as_bytes(), found.password.secret.bytes());
        // Each byte is looked at, so that the time tells nothing.
        let different =
            is.iter().zip(should).fold(is.len() ^ should.len(), |all, (a, b)| all | usize::from(a ^ b));
        (different == 0 && !should.is_empty()).then_some(found.role)
    }

    fn role(&self, user: &str) -> Option<Role> {
        self.iter().find(|u| u.name.value == user).map(|u| u.role)
    }

    fn is_empty(&self) -> bool {
        Vec::is_empty(self)
    }
}

/// Sentences that wait for the driver; the oldest are left out.
const NOTES: usize = 20;
/// Wrong passwords in a minute, from all clients together; behind them nobody new is let in.
const GUESSES: usize = 10;

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

/// The one at the door.
pub(crate) struct Guard<U> {
    pub(crate) users: U,
    pub(crate) anonymous: bool,
    pub(crate) notes: Notes,
    guesses: Mutex<Guesses>,
}

/// The token of a user; that of the library for nobody is another word.
const USER: &str = "user ";

impl<U: Users> Guard<U> {
    pub(crate) fn new(users: U, anonymous: bool, notes: Notes) -> Guard<U> {
        Guard { users, anonymous, notes, guesses: Mutex::default() }
    }

    fn guesses(&self) -> MutexGuard<'_, Guesses> {
        let mut guesses = self.guesses.lock().unwrap_or_else(PoisonError::into_inner);
        let now = guesses.clock.now();
        while guesses.at.front().is_some_and(|at| now - *at > Nanos::MINUTE) {
            guesses.at.pop_front();
        }
        guesses
    }

    fn refuse(&self, why: String) -> Error {
        self.notes.say(format!("refused {why}"));
        Error::new(StatusCode::BadUserAccessDenied, why)
    }

    fn writes(&self, token: &UserToken) -> bool {
        let user = token.0.strip_prefix(USER);
        user.and_then(|user| self.users.role(user)).is_some_and(Role::writes)
    }
}

#[async_trait::async_trait]
impl<U: Users> AuthManager for Guard<U> {
    async fn authenticate_anonymous_token(&self, _: &ServerEndpoint) -> Result<(), Error> {
        if self.anonymous { Ok(()) } else { Err(self.refuse("a client without a user".to_owned())) }
    }

    async fn authenticate_username_identity_token(
        &self,
        _: &ServerEndpoint,
        user: &str,
        password: &Password,
    ) -> Result<UserToken, Error> {
        let named: String = user.chars().filter(|c| !c.is_control()).take(40).collect();
        if self.guesses().at.len() >= GUESSES {
            return Err(self.refuse(format!("the user \"{named}\": too many wrong passwords in a minute")));
        }
        match self.users.check(user, password.get()) {
            Some(_) => Ok(UserToken(format!("{USER}{user}"))),
            None => {
                let mut guesses = self.guesses();
                let now = guesses.clock.now();
                guesses.at.push_back(now);
                drop(guesses);
                Err(self.refuse(format!("the user \"{named}\": unknown, or another password")))
            }
        }
    }

    fn effective_user_access_level(&self, token: &UserToken, level: AccessLevel, _: &NodeId) -> AccessLevel {
        if self.writes(token) { level } else { level - AccessLevel::CURRENT_WRITE }
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
        let anonymous = self
            .anonymous
            .then(|| policy(UserTokenType::Anonymous, UAString::from("anonymous"), UAString::null()));
        // A password is encrypted by itself where the connection is not.
        let named = (!self.users.is_empty()).then(|| {
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
    use super::*;

    struct Anna;

    impl Users for Anna {
        fn check(&self, user: &str, password: &str) -> Option<Role> {
            (password == "right").then(|| self.role(user))?
        }

        fn role(&self, user: &str) -> Option<Role> {
            match user {
                "anna" => Some(Role::Operator),
                "view" => Some(Role::Viewer),
                _ => None,
            }
        }

        fn is_empty(&self) -> bool {
            false
        }
    }

    fn guard() -> Guard<Anna> {
        Guard::new(Anna, true, Notes::default())
    }

    #[test]
    fn who_may_write_follows_the_role() {
        let guard = guard();
        let level = AccessLevel::CURRENT_READ | AccessLevel::CURRENT_WRITE;
        for (token, writes) in [
            ("user anna", true),
            ("user view", false),
            ("user gone", false),
            ("ANONYMOUS", false),
            ("anna", false),
        ] {
            let got = guard.effective_user_access_level(&UserToken(token.to_owned()), level, &NodeId::null());
            assert_eq!(got.contains(AccessLevel::CURRENT_WRITE), writes, "{token}");
            assert!(got.contains(AccessLevel::CURRENT_READ), "{token}");
        }
    }

    #[test]
    fn passwords_are_not_guessed_for_long() {
        let guard = guard();
        let endpoint = ServerEndpoint::new_none("/", &[]);
        let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
        let login = |password: &str| {
            let password = Password::new(password.to_owned());
            runtime.block_on(guard.authenticate_username_identity_token(&endpoint, "anna", &password))
        };
        assert!(login("right").is_ok());
        for _ in 0..GUESSES {
            assert!(login("wrong").is_err());
        }
        // Even the right one waits now, and it is said.
        assert!(login("right").is_err());
        let notes = guard.notes.take();
        assert!(notes.iter().any(|n| n.contains("\"anna\"") && n.contains("another password")), "{notes:?}");
        assert!(notes.iter().any(|n| n.contains("too many")), "{notes:?}");
        assert!(guard.notes.take().is_empty());
    }
}
