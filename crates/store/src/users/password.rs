//! Passwords as they are kept: argon2id with a salt of their own.
//!
//! Memory and passes are those that the OWASP cheat sheet on password storage asks for at least (19 MiB, 2
//! passes, 1 lane). They stand beside each hash, so that a later G7 can ask for more.

use argon2::{Algorithm, Argon2, Params, Version};
use g7_model::{Said, say};

use super::error::UserError;

/// Least number of letters of a password.
pub const LEAST: usize = 10;
/// Greatest number of bytes of a password.
const MOST: usize = 512;
/// KiB of memory, and passes over it.
const COST: (u32, u32) = (19 * 1024, 2);

/// A password as the file keeps it.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    /// Memory in KiB.
    pub(super) memory: u32,
    pub(super) passes: u32,
    pub(super) salt: [u8; 16],
    pub(super) hash: [u8; 32],
}

impl Kept {
    pub(super) fn of(password: &str) -> Result<Kept, UserError> {
        let mut salt = [0; 16];
        getrandom::fill(&mut salt).map_err(|e| UserError::Refused(no_chance(&e)))?;
        let (memory, passes) = COST;
        let hash = hashed(password, &salt, memory, passes)?;
        Ok(Kept { memory, passes, salt, hash })
    }

    /// True if it is this password. The time does not tell where they differ.
    pub(super) fn is(&self, password: &str) -> Result<bool, UserError> {
        if password.len() > MOST {
            return Ok(false);
        }
        let hash = hashed(password, &self.salt, self.memory, self.passes)?;
        Ok(hash.iter().zip(self.hash).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0)
    }
}

/// The system gives no random numbers.
pub(super) fn no_chance(error: &getrandom::Error) -> Said {
    say!("the system gives no random numbers: {}", Said::foreign(error.to_string()))
}

fn hashed(password: &str, salt: &[u8], memory: u32, passes: u32) -> Result<[u8; 32], UserError> {
    let broken = |e: argon2::Error| {
        UserError::Refused(say!("the password cannot be checked: {}", Said::foreign(e.to_string())))
    };
    // A file that asks for gigabytes is not served.
    if memory > 1 << 20 || passes > 64 {
        return Err(UserError::Refused(say!("the file of the users asks for too much memory")));
    }
    let params = Params::new(memory, passes, 1, Some(32)).map_err(broken)?;
    let mut hash = [0; 32];
    Argon2::new(Algorithm::Argon2id, Version::V0x13, params)
        .hash_password_into(password.as_bytes(), salt, &mut hash)
        .map_err(broken)?;
    Ok(hash)
}

/// Refuses a password that is guessed at once.
pub(super) fn fit(name: &str, password: &str) -> Result<(), UserError> {
    let why = if password.chars().count() < LEAST {
        say!("a password has at least {LEAST} letters")
    } else if password.len() > MOST {
        say!("a password has at most {MOST} bytes")
    } else if password.to_lowercase().contains(&name.to_lowercase())
        && !name.is_empty()
        && password.len() < 2 * LEAST
    {
        say!("the password must not contain the name")
    } else if password.chars().all(|c| password.starts_with(c)) {
        say!("one letter again and again is no password")
    } else {
        return Ok(());
    };
    Err(UserError::Refused(why))
}
