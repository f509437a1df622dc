//! The values of a running chart beside its text, and the command that says which server's runs are shown.

use g7_ide::inlays::inlays;
use lsp_server::{Message, Notification, Request, RequestId};
use lsp_types::notification::{Notification as _, ShowMessage};
use lsp_types::request::{InlayHintRefreshRequest, Request as _};
use lsp_types::{
    ExecuteCommandParams, InlayHint, InlayHintKind, InlayHintLabel, InlayHintParams, MessageType,
    ShowMessageParams,
};
use serde_json::Value;

use super::follow::{Address, Follower, Shown};
use super::open::Open;
use super::places;

/// The command that follows the server at an address; without one it ends.
pub(super) const FOLLOW: &str = "g7.follow";

/// The way to the editor, for what no request asked.
type Sender = crossbeam_channel::Sender<Message>;

/// The values that are shown of a run.
pub(super) struct Shows {
    editor: Sender,
    /// True if the editor asks for the values again when it is told to.
    refreshes: bool,
    shown: Shown,
    follower: Option<Follower>,
}

impl Shows {
    /// Nothing, for an editor with these abilities.
    pub(super) fn new(editor: &Sender, asked: &Value) -> Shows {
        let refreshes = asked["capabilities"]["workspace"]["inlayHint"]["refreshSupport"] == true;
        Shows { editor: editor.clone(), refreshes, shown: Shown::default(), follower: None }
    }

    /// Follows the server at an address; the user is told where that is impossible.
    pub(super) fn begin(&mut self, address: &str) {
        if let Err(why) = self.follow(address) {
            tell(&self.editor, why);
        }
    }

    fn follow(&mut self, address: &str) -> Result<(), String> {
        // The one before ends first, so that its runs are not shown among the new ones.
        self.follower = None;
        self.refresh();
        if address.is_empty() {
            return Ok(());
        }
        let address = Address::read(address)?;
        let (refresh, editor) = (self.refresher(), self.editor.clone());
        let lost = move |why| tell(&editor, why);
        self.follower = Some(Follower::start(address, self.shown.clone(), refresh, lost)?);
        Ok(())
    }

    /// Carries out a command of the editor.
    pub(super) fn command(&mut self, p: &ExecuteCommandParams) -> Result<Value, String> {
        if p.command != FOLLOW {
            return Err(format!("g7 does not know the command `{}`", p.command));
        }
        let address = p.arguments.first().map_or(Some(""), Value::as_str);
        self.follow(address.ok_or("the address is a text, as `g7 serve` prints it")?).map(|()| Value::Null)
    }

    /// The values in a part of a text.
    pub(super) fn inlays(&self, open: &Open, p: &InlayHintParams) -> Option<Vec<InlayHint>> {
        let uri = &p.text_document.uri;
        let file = open.file(uri)?;
        let path = places::path(uri)?;
        let present = self.shown.of(&path.to_string_lossy())?;
        let hint = |inlay: g7_ide::inlays::Inlay| InlayHint {
            position: places::position(&file.positions, file.text(), inlay.at),
            label: InlayHintLabel::String(inlay.label),
            kind: Some(InlayHintKind::TYPE),
            text_edits: None,
            tooltip: None,
            padding_left: Some(true),
            padding_right: None,
            data: None,
        };
        Some(inlays(file, &places::bytes(file, p.range), &present).into_iter().map(hint).collect())
    }

    fn refresh(&self) {
        self.refresher()();
    }

    /// Tells the editor to ask for the values again.
    fn refresher(&self) -> impl Fn() + Send + 'static {
        let (editor, refreshes) = (self.editor.clone(), self.refreshes);
        move || {
            if refreshes {
                let id = RequestId::from("g7-values".to_owned());
                let method = InlayHintRefreshRequest::METHOD.to_owned();
                // The editor may be gone; then the session ends anyway.
                editor.send(Message::Request(Request { id, method, params: Value::Null })).ok();
            }
        }
    }
}

/// Shows a sentence to the user.
fn tell(editor: &Sender, message: String) {
    let told = ShowMessageParams { typ: MessageType::WARNING, message };
    let told = Notification::new(ShowMessage::METHOD.to_owned(), told);
    editor.send(Message::Notification(told)).ok();
}
