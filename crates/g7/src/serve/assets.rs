//! The web page: contained in the binary, or read from a folder during its development.

use std::borrow::Cow;
use std::path::Path;

use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use rust_embed::RustEmbed;

use super::fingerprint;
use super::shared::Shared;

/// The built page; empty if the page was not built before the binary.
#[derive(RustEmbed)]
#[folder = "../../web/dist"]
#[allow_missing = true]
struct Built;

/// The answer to `/` if there is no page.
const NONE: &str = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>G7</title>\
    <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
    <style>body{font:16px/1.5 system-ui,sans-serif;max-width:36em;margin:4em auto;padding:0 1em;\
    color-scheme:light dark}code{font-size:1.05em}</style>\
    <h1>The page is not in this binary</h1>\
    <p>This <code>g7</code> was built without the editor. In the folder of its sources:</p>\
    <p><code>make web</code> builds the page; then build <code>g7</code> again, \
    or <code>make run</code> does both.</p>";

/// Answers with a file of the page.
pub(super) async fn asset(State(shared): State<Shared>, uri: Uri, headers: HeaderMap) -> Response {
    let path = match uri.path().trim_start_matches('/') {
        "" => "index.html",
        path => path,
    };
    let bytes = match &shared.page {
        Some(folder) => on_disk(folder, path).map(Cow::Owned),
        None => Built::get(path).map(|f| f.data),
    };
    let Some(bytes) = bytes else {
        if path == "index.html" {
            let html = [(header::CONTENT_TYPE, "text/html; charset=utf-8")];
            return (StatusCode::SERVICE_UNAVAILABLE, html, NONE).into_response();
        }
        return (StatusCode::NOT_FOUND, "there is nothing at this address").into_response();
    };
    let tag = format!("\"{}\"", fingerprint::hash(&bytes));
    // Names below `assets` change with their contents.
    let keep = if path.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
    let head = [
        (header::CONTENT_TYPE, kind(path).to_owned()),
        (header::CACHE_CONTROL, keep.to_owned()),
        (header::ETAG, tag.clone()),
    ];
    if headers.get(header::IF_NONE_MATCH).is_some_and(|known| known.as_bytes() == tag.as_bytes()) {
        return (StatusCode::NOT_MODIFIED, head).into_response();
    }
    (head, bytes.into_owned()).into_response()
}

fn on_disk(folder: &Path, path: &str) -> Option<Vec<u8>> {
    let path = folder.join(path).canonicalize().ok()?;
    if !path.starts_with(folder) || !path.is_file() {
        return None;
    }
    std::fs::read(path).ok()
}

fn kind(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "json" | "webmanifest" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ico" => "image/x-icon",
        "ttf" => "font/ttf",
        "woff2" => "font/woff2",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
