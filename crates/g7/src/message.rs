//! Messages for the user, on the standard error.
//!
//! Every command talks through here, so that the standard output holds data alone. It uses no other
//! file.

/// Prints a message to the standard error; a closed standard error is ignored.
macro_rules! talk {
    ($($arg:tt)*) => {{
        use std::io::Write as _;
        writeln!(anstream::stderr(), $($arg)*).ok();
    }};
}

pub(crate) use talk;
