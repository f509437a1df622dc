//! Who wants something: a user of the server, whoever has the token, or the terminal.

use g7_model::{Said, say};
use g7_store::users::{Role, SessionHash};

/// A person, as far as G7 knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Who {
    /// The name of the user; empty where there are no users.
    pub(crate) name: String,
    pub(crate) role: Role,
    /// The address that it comes from, or `console`.
    pub(crate) from: String,
    /// The session, where there are users.
    pub(crate) session: Option<SessionHash>,
    /// True for whoever has the address for guests.
    pub(crate) guest: bool,
}

impl Who {
    /// The one at the terminal, who has started it all.
    pub(crate) fn console() -> Who {
        Who {
            name: String::new(),
            role: Role::Admin,
            from: "console".to_owned(),
            session: None,
            guest: false,
        }
    }

    /// Whoever has the token of this start.
    pub(crate) fn with_token(from: String) -> Who {
        Who { name: String::new(), role: Role::Admin, from, session: None, guest: false }
    }

    /// A user of the server.
    pub(crate) fn user(name: String, role: Role, from: String, session: Option<SessionHash>) -> Who {
        Who { name, role, from, session, guest: false }
    }

    /// Whoever has the address for guests: looks at everything and changes nothing. No user has this name.
    pub(crate) fn guest(from: String) -> Who {
        Who { name: "(guest)".to_owned(), role: Role::Viewer, from, session: None, guest: true }
    }

    /// Refuses what needs a greater role.
    pub(crate) fn needs(&self, role: Role) -> Result<(), Said> {
        if self.role >= role {
            return Ok(());
        }
        Err(say!("this needs the role `{role}`; `{}` is `{}`", self.name, self.role))
    }
}

impl Default for Who {
    fn default() -> Who {
        Who::console()
    }
}
