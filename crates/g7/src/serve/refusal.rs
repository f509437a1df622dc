//! The answer to a request that cannot be fulfilled: a status and a sentence.

use std::io;

use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use g7_model::{Language, Said, say};

/// A refusal, for the user.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) status: StatusCode,
    pub(super) text: Said,
}

impl Refusal {
    pub(super) fn new(status: StatusCode, text: Said) -> Refusal {
        Refusal { status, text }
    }

    pub(super) fn forbidden(text: Said) -> Refusal {
        Refusal::new(StatusCode::FORBIDDEN, text)
    }

    pub(super) fn bad(text: Said) -> Refusal {
        Refusal::new(StatusCode::BAD_REQUEST, text)
    }

    /// The server was started to write nothing.
    pub(super) fn read_only() -> Refusal {
        Refusal::forbidden(say!("this server was started with --read-only: nothing is written"))
    }

    /// The refusal after an error of the system with a file.
    pub(super) fn io(path: &str, error: &io::Error) -> Refusal {
        let path = Said::foreign(path);
        let (status, text) = match error.kind() {
            io::ErrorKind::NotFound => (StatusCode::NOT_FOUND, say!("there is no file {path}")),
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                (StatusCode::FORBIDDEN, say!("{path} may not be read or written: the system protects it"))
            }
            io::ErrorKind::AlreadyExists => {
                (StatusCode::CONFLICT, say!("there is a file {path} already; it is left as it is"))
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => (
                StatusCode::INSUFFICIENT_STORAGE,
                say!("{path} cannot be written: the disk is full; nothing was changed"),
            ),
            _ => (
                StatusCode::INTERNAL_SERVER_ERROR,
                say!("{path}: {}; nothing was changed", crate::failure::plain(error)),
            ),
        };
        Refusal { status, text }
    }
}

impl IntoResponse for Refusal {
    /// In English; [`translate`] knows the language of the request and finds the sentence beside it.
    fn into_response(self) -> Response {
        let mut response = answer(self.status, self.text.to_string());
        response.extensions_mut().insert(Told(self.text));
        response
    }
}

/// The sentence of a refusal, beside its answer.
#[derive(Clone)]
struct Told(Said);

fn answer(status: StatusCode, text: String) -> Response {
    (status, [("content-type", "text/plain; charset=utf-8")], text).into_response()
}

/// Tells a refusal in the language that the client reads.
pub(super) async fn translate(request: Request, next: Next) -> Response {
    let language = language(request.headers());
    let mut response = next.run(request).await;
    match response.extensions_mut().remove::<Told>() {
        Some(Told(said)) if language != Language::English => {
            let mut told = answer(response.status(), said.in_language(language));
            // Headers of other layers stay.
            for (name, value) in response.headers() {
                if !told.headers().contains_key(name) && name != header::CONTENT_LENGTH {
                    told.headers_mut().append(name, value.clone());
                }
            }
            told
        }
        _ => response,
    }
}

/// The first language of `Accept-Language` that the program speaks. The page sends its own as the first one.
fn language(headers: &HeaderMap) -> Language {
    let named =
        headers.get(header::ACCEPT_LANGUAGE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    named.split([',', ';']).find_map(|tag| Language::of(tag.trim())).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::{HeaderMap, Language, header, language};

    #[test]
    fn the_first_language_that_is_spoken_is_taken() {
        let of = |value: &'static str| {
            language(&HeaderMap::from_iter([(header::ACCEPT_LANGUAGE, value.parse().expect("a header"))]))
        };
        assert_eq!(of("fr-CH, fr;q=0.9, en;q=0.8"), Language::French);
        assert_eq!(of("de, pt-PT;q=0.8, fr;q=0.5"), Language::Portuguese);
        assert_eq!(of("de"), Language::English);
        assert_eq!(language(&HeaderMap::new()), Language::English);
    }
}
