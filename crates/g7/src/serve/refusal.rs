//! The answer to a request that cannot be fulfilled: a status and a sentence.

use std::io;

use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};

/// A refusal, for the user.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) status: StatusCode,
    pub(super) text: String,
}

impl Refusal {
    pub(super) fn new(status: StatusCode, text: impl Into<String>) -> Refusal {
        Refusal { status, text: text.into() }
    }

    pub(super) fn forbidden(text: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::FORBIDDEN, text)
    }

    pub(super) fn bad(text: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::BAD_REQUEST, text)
    }

    /// The refusal after an error of the system with a file.
    pub(super) fn io(path: &str, error: &io::Error) -> Refusal {
        let (status, text) = match error.kind() {
            io::ErrorKind::NotFound => (StatusCode::NOT_FOUND, format!("there is no file {path}")),
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                (StatusCode::FORBIDDEN, format!("{path} may not be read or written: the system protects it"))
            }
            io::ErrorKind::AlreadyExists => {
                (StatusCode::CONFLICT, format!("there is a file {path} already; it is left as it is"))
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => (
                StatusCode::INSUFFICIENT_STORAGE,
                format!("{path} cannot be written: the disk is full; nothing was changed"),
            ),
            _ => (
                StatusCode::INTERNAL_SERVER_ERROR,
                format!("{path}: {}; nothing was changed", crate::failure::plain(error)),
            ),
        };
        Refusal { status, text }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.status, [("content-type", "text/plain; charset=utf-8")], self.text).into_response()
    }
}
