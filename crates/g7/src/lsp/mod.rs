//! `g7 lsp`: a server of the Language Server Protocol (LSP 3.17) for the editors that people use.
//!
//! ```text
//! editor <- JSON-RPC on standard input and output -> lsp -> ide (what is asked about a text)
//!                                                     |<- follow <- g7 serve (what a run shows)
//! ```
//!
//! The server is a door: it converts places and words, and decides nothing about charts.
//!
//! # What must hold
//!
//! - Messages are handled in their order; problems are told when no message waits, so that typing is
//!   never behind.
//! - Whatever a client sends, the server goes on: what it cannot read is answered by an error.

mod actions;
mod answers;
mod beside;
mod follow;
mod heads;
mod open;
mod places;
mod shows;
mod used;

use g7_model::{Language, say};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{
    DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument, DidSaveTextDocument, Notification as _,
    PublishDiagnostics,
};
use lsp_types::request::{
    CodeActionRequest, CodeLensRequest, Completion, DocumentHighlightRequest, DocumentSymbolRequest,
    ExecuteCommand, FoldingRangeRequest, Formatting, GotoDefinition, HoverRequest, InlayHintRequest,
    PrepareRenameRequest, References, Rename, Request as _, SemanticTokensFullRequest,
    SemanticTokensRangeRequest,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::failure::{Failure, Verdict, raw};
use open::Open;
use shows::Shows;

/// Answers one editor until it sends `shutdown` and `exit`, or closes the connection.
///
/// `follow` is the address of a server whose runs are shown.
pub(crate) fn serve(follow: Option<&str>) -> Result<Verdict, Failure> {
    let (connection, threads) = Connection::stdio();
    let served = session(&connection, follow);
    // The threads end with the connection.
    drop(connection);
    threads.join()?;
    served.map(|()| Verdict::Fine)
}

fn session(connection: &Connection, follow: Option<&str>) -> Result<(), Failure> {
    let broken = |e: &dyn std::fmt::Display| Failure::Usage(say!("the editor broke off: {e}", e = raw(e)));
    let (id, asked) = connection.initialize_start().map_err(|e| broken(&e))?;
    let hello = serde_json::json!({
        "capabilities": answers::capabilities(),
        "serverInfo": { "name": "g7", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, hello).map_err(|e| broken(&e))?;
    // The client knows the language of its reader; else the surroundings do.
    let locale = asked.get("locale").and_then(serde_json::Value::as_str);
    let language = locale.map_or_else(crate::tongue::language, |l| Language::of(l).unwrap_or_default());
    let mut open = Open::in_language(language);
    let mut shows = Shows::new(&connection.sender, &asked);
    if let Some(address) = follow.or(asked["initializationOptions"]["follow"].as_str()) {
        shows.begin(address);
    }
    while let Some(message) = next(connection, &mut open)? {
        match message {
            Message::Request(request) => {
                if connection.handle_shutdown(&request).map_err(|e| broken(&e))? {
                    break;
                }
                send(connection, Message::Response(answer(&open, &mut shows, request)))?;
            }
            Message::Notification(told) => hear(&mut open, told),
            Message::Response(_) => {}
        }
    }
    Ok(())
}

/// The next message. Before the server waits for one, it tells the problems of what has changed.
fn next(connection: &Connection, open: &mut Open) -> Result<Option<Message>, Failure> {
    if let Ok(message) = connection.receiver.try_recv() {
        return Ok(Some(message));
    }
    for told in open.problems() {
        let told = Notification::new(PublishDiagnostics::METHOD.to_owned(), told);
        send(connection, Message::Notification(told))?;
    }
    Ok(connection.receiver.recv().ok())
}

fn send(connection: &Connection, message: Message) -> Result<(), Failure> {
    connection
        .sender
        .send(message)
        .map_err(|e| Failure::Usage(say!("the editor broke off: {e}", e = raw(&e))))
}

/// Reads a notification of the editor about its texts. A notification that is not known, or cannot be
/// read, is ignored, because the protocol has no answer to a notification.
fn hear(open: &mut Open, told: Notification) {
    match told.method.as_str() {
        DidOpenTextDocument::METHOD => {
            if let Ok(told) = serde_json::from_value(told.params) {
                open.begin(told);
            }
        }
        DidChangeTextDocument::METHOD => {
            if let Ok(told) = serde_json::from_value(told.params) {
                open.change(told);
            }
        }
        DidSaveTextDocument::METHOD => {
            if let Ok(told) = serde_json::from_value(told.params) {
                open.saved(&told);
            }
        }
        DidCloseTextDocument::METHOD => {
            if let Ok(told) = serde_json::from_value(told.params) {
                open.end(told);
            }
        }
        _ => {}
    }
}

fn answer(open: &Open, shows: &mut Shows, request: Request) -> Response {
    match request.method.as_str() {
        Completion::METHOD => of(request, |p| Ok(answers::completion(open, p))),
        HoverRequest::METHOD => of(request, |p| Ok(answers::hover(open, p))),
        GotoDefinition::METHOD => of(request, |p| Ok(answers::definition(open, p))),
        References::METHOD => of(request, |p| Ok(answers::references(open, p))),
        DocumentHighlightRequest::METHOD => of(request, |p| Ok(answers::highlights(open, p))),
        DocumentSymbolRequest::METHOD => of(request, |p| Ok(answers::outline(open, p))),
        FoldingRangeRequest::METHOD => of(request, |p| Ok(answers::folds(open, p))),
        SemanticTokensFullRequest::METHOD => of(request, |p| Ok(answers::tokens(open, p))),
        SemanticTokensRangeRequest::METHOD => of(request, |p| Ok(answers::tokens_between(open, p))),
        CodeLensRequest::METHOD => of(request, |p| Ok(answers::lenses(open, p))),
        CodeActionRequest::METHOD => of(request, |p| Ok(actions::fixes(open, p))),
        Formatting::METHOD => of(request, |p| Ok(actions::format(open, p))),
        PrepareRenameRequest::METHOD => of(request, |p| Ok(actions::changeable(open, p))),
        InlayHintRequest::METHOD => of(request, |p| Ok(shows.inlays(open, p))),
        ExecuteCommand::METHOD => of(request, |p| shows.command(p)),
        Rename::METHOD => of(request, |p| actions::rename(open, p)),
        other => {
            let what = format!("g7 does not know the request `{other}`");
            Response::new_err(request.id, ErrorCode::MethodNotFound as i32, what)
        }
    }
}

/// Reads the parameters of a request and writes its answer.
fn of<P: DeserializeOwned, R: Serialize>(
    request: Request,
    work: impl FnOnce(&P) -> Result<R, String>,
) -> Response {
    match serde_json::from_value(request.params) {
        Ok(params) => match work(&params) {
            Ok(result) => Response::new_ok(request.id, result),
            Err(no) => Response::new_err(request.id, ErrorCode::RequestFailed as i32, no),
        },
        Err(e) => Response::new_err(request.id, ErrorCode::InvalidParams as i32, e.to_string()),
    }
}
